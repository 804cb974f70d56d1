// Speculative contacts: found as far ahead of fast bodies as those may come in the step.
#pragma once

#include "physics/step/sweep.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Makes the boxes of fast bodies as large as the contacts that are looked for ahead of them.
template <class Plan>
void look_ahead(state<Plan>& s, typename Plan::scalar h) {
    if constexpr (Plan::looks_ahead) {
        using S = typename Plan::scalar;
        constexpr int D = Plan::dimension;
        s.step.sweep.ahead.resize(s.bodies.slots());
        bool any = false;
        s.bodies.each([&](std::uint32_t i, const auto& b) {
            S& ahead = s.step.sweep.ahead[i];
            ahead = S(0);
            if (s.is_asleep(i)) return;
            if (b.type == body_type::static_body) return;
            const auto before = b.velocity_ahead(h);
            vec<S, D> v = before.linear;
            if (b.is_dynamic()) v += s.settings.gravity * b.gravity_scale * h;
            const auto& extent = s.continuous.extents[i];
            ahead = Plan::continuous::ahead({v * h, value_of(before.angular) * h, extent.reach, extent.thickness, S(0),
                                             b.continuous, s.settings.contact_margin});
            if (!(ahead > S(0))) return;
            any = true;
            each_shape(s, i, [&](std::uint32_t k, const auto& shape) {
                const auto box = grown(query_bounds(s, shape), ahead);
                if (is_box(box)) s.broadphase.move(k, box, {});
            });
        });
        if (any) update_broadphase(s);
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
void collide_ahead(state<Plan>& s, const Query* queries, typename Plan::pair_memory* memories, const proxy_pair* pairs,
                   std::uint32_t count, Manifolds& manifolds, Collide&& collide) {
    using S = typename Plan::scalar;
    const S margin = s.settings.contact_margin;
    const auto farther = [&](std::uint32_t i) {
        return s.step.sweep.ahead[s.shapes[pairs[i].a].body] + s.step.sweep.ahead[s.shapes[pairs[i].b].body];
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

/// What the step has to know of fast bodies before it looks for contacts.
template <class Plan>
void watch_fast_bodies(state<Plan>& s, typename Plan::scalar h) {
    clear_depths(s);
    look_ahead(s, h);
}

}  // namespace detail

PHYSICS_HPP_END
