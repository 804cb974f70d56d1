// Speculative contacts: found as far ahead of fast bodies as those may come in the step.
#pragma once

#include "physics/step/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Velocities -> how far each body looks ahead, and boxes as large as that asks for. O(bodies).
template <class Plan, class Continuous>
void look_ahead([[maybe_unused]] const pool<typename Plan::body>& bodies,
                [[maybe_unused]] const shape_pool<Plan>& shapes, [[maybe_unused]] const sleep_of<Plan>& sleep,
                [[maybe_unused]] const Continuous& continuous, [[maybe_unused]] const typename Plan::settings& settings,
                [[maybe_unused]] typename Plan::scalar h, [[maybe_unused]] typename Plan::broadphase& broadphase,
                [[maybe_unused]] sweep_data_of<Plan>& to) {
    if constexpr (Plan::looks_ahead) {
        using S = typename Plan::scalar;
        constexpr int D = Plan::dimension;
        to.ahead.resize(bodies.slots());
        bool any = false;
        bodies.each([&](std::uint32_t i, const auto& b) {
            S& ahead = to.ahead[i];
            ahead = S(0);
            if (sleep.is_asleep(i)) return;
            if (b.type == body_type::static_body) return;
            const auto before = b.velocity_ahead(h);
            vec<S, D> v = before.linear;
            if (b.is_dynamic()) v += settings.gravity * b.gravity_scale * h;
            const auto& extent = continuous.extents[i];
            ahead = Plan::continuous::ahead({v * h, value_of(before.angular) * h, extent.reach, extent.thickness, S(0),
                                             b.continuous, settings.contact_margin});
            if (!(ahead > S(0))) return;
            any = true;
            each_shape(bodies, shapes, i, [&](std::uint32_t k, const auto& shape) {
                const auto box = grown(box_within(settings.contact_margin, shape), ahead);
                if (is_box(box)) broadphase.move(k, box, {});
            });
        });
        if constexpr (requires { broadphase.update(); })
            if (any) broadphase.update();
    }
}

/// What is remembered of a pair serves no other step.
template <class Memory>
void forget_pair(Memory& m) {
    m = {};
    if constexpr (requires { m.changed; }) m.changed = true;
}

/// The narrowphase of some pairs, where some of them are looked at farther ahead: as one batch those in between.
template <class Plan, class Query, class Manifolds, class Collide>
void collide_ahead(const shape_pool<Plan>& shapes, const buffer<typename Plan::scalar>& ahead,
                   typename Plan::scalar margin, const Query* queries, typename Plan::pair_memory* memories,
                   const proxy_pair* pairs, std::uint32_t count, Manifolds& manifolds, Collide&& collide) {
    using S = typename Plan::scalar;
    const auto farther = [&](std::uint32_t i) {
        return ahead[shapes[pairs[i].a].body] + ahead[shapes[pairs[i].b].body];
    };
    for (std::uint32_t i = 0; i < count;) {
        const S more = farther(i);
        std::uint32_t end = i + 1;
        if (!(more > S(0)))
            while (end < count && !(farther(end) > S(0))) ++end;
        // What is found farther ahead serves no other step.
        const auto forget = [&] {
            if constexpr (Plan::remembers)
                if (more > S(0) && queries[i].memory != Query::no_memory) forget_pair(memories[queries[i].memory]);
        };
        const std::uint32_t before = manifolds.size();
        forget();
        collide(queries + i, end - i, margin + more);
        forget();
        for (std::uint32_t k = before; k < manifolds.size(); ++k) manifolds[k].query += i;
        i = end;
    }
}

}  // namespace detail

PHYSICS_HPP_END
