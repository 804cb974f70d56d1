// What the contacts of a step tell the sweeps: which bodies are near static ones, and how deep in them.
#pragma once

#include "physics/step/awake.hpp"
#include "physics/step/step_data.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Forgets the last step's, of so many bodies that there may be.
template <class Plan>
void clear_depths([[maybe_unused]] std::uint32_t slots, [[maybe_unused]] sweep_data_of<Plan>& to) {
    if constexpr (Plan::sweeps) {
        for (const std::uint32_t i : to.deep) to.depths[i] = {};
        to.deep.clear();
        to.depths.resize(slots);
        to.near_static.clear();
        to.near_static.resize(slots);
    }
}
/// Notes which of two bodies whose boxes overlap is near one that is not awake.
template <class Plan>
void note_near([[maybe_unused]] const awake_list& awake, [[maybe_unused]] const edge& of,
               [[maybe_unused]] sweep_data_of<Plan>& to) {
    if constexpr (Plan::sweeps) {
        // Several workers may note the same body.
        const auto note = [&](std::uint32_t i) {
#if defined(__GNUC__)
            __atomic_store_n(&to.near_static[i], true, __ATOMIC_RELAXED);
#else
            to.near_static[i] = true;
#endif
        };
        if (!awake.has(of.body_a)) note(of.body_b);
        if (!awake.has(of.body_b)) note(of.body_a);
    }
}
/// Whether a contact with a body that is not awake is deep.
template <class Plan, class Contact>
bool is_deep([[maybe_unused]] const awake_list& awake, [[maybe_unused]] typename Plan::scalar margin,
             [[maybe_unused]] const Contact& c) {
    if constexpr (Plan::sweeps) {
        if (awake.has(c.bodies.body_a) == awake.has(c.bodies.body_b)) return false;
        for (int k = 0; k < c.count; ++k)
            if (-c.points[k].separation > margin * typename Plan::scalar(0.125)) return true;
    }
    return false;
}
/// Notes how deep the body of such a contact is in a static one.
template <class Plan, class Contact>
void note_depth([[maybe_unused]] const pool<typename Plan::body>& bodies, [[maybe_unused]] const Contact& c,
                [[maybe_unused]] sweep_data_of<Plan>& to) {
    if constexpr (Plan::sweeps) {
        typename Plan::scalar depth{};
        for (int k = 0; k < c.count; ++k) depth = max(depth, -c.points[k].separation);
        const auto [a, b] = c.bodies;
        const auto note = [&](std::uint32_t i) {
            to.depths[i] = max(to.depths[i], depth);
            to.deep.push_back(i);
        };
        if (bodies[a].type == body_type::static_body) note(b);
        if (bodies[b].type == body_type::static_body) note(a);
    }
}

}  // namespace detail

PHYSICS_HPP_END
