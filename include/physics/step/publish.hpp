// The end of a step: what it has found becomes the world's.
#pragma once

#include "physics/base/sort.hpp"
#include "physics/step/sleep.hpp"
#include "physics/step/warm_impulses.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Where bodies have come, and how fast they are -> bodies, and where they were as the step began. Forces act for one
/// step, and so do targets.
template <class S, int D, bool Rotates>
void publish_bodies(const moved_bodies<S, D, Rotates>& moved, const awake_list& awake,
                    pool<body<S, D, Rotates>>& bodies, buffer<transform<S, D>>& starts) {
    for (std::uint32_t k = 0; k < awake.size(); ++k) {
        const std::uint32_t i = awake[k];
        auto& b = bodies[i];
        starts[i] = {b.center, b.rotation};
        b.center = moved[k].center;
        if constexpr (Rotates) b.rotation = moved[k].rotation;
        b.velocity = moved.velocity(k);
        b.force = {};
        b.torque = {};
        b.at_target = b.has_target;
        if (!b.has_target) continue;
        b.set_pose(b.target);
        b.has_target = false;
    }
}

/// Stores what the step found: poses, velocities, contacts with their impulses. Nothing fails from here on.
template <class Plan, class Moved>
void publish(state<Plan>& s, step_data<Plan>& d, const Moved& moved, const warm_impulses<typename Plan::scalar>& warm,
             typename Plan::scalar h) {
    if (std::exchange(s.awake.is_stale, false))
        s.bodies.each([&](std::uint32_t i, const auto& b) {
            if (!s.is_asleep(i)) s.contact_starts[i] = {b.center, b.rotation};
        });
    publish_bodies(moved, s.awake, s.bodies, s.contact_starts);
    warm.after_solve(d.new_contacts);
    s.contacts.swap(d.new_contacts);
    s.surfaces = d.new_material;
    if constexpr (Plan::has_joints) publish_joints(d.joints, h, s.joints);
    if constexpr (Plan::remembers) d.pair_cache_changes.finish(s.memories);
    ++s.steps;
    s.step_lengths = {warm.next_usual_step(s.steps), h};
}

/// Where bodies are, and were as the step began -> which of them it has moved, in ascending order.
template <class S, int D, bool Rotates>
void list_moved(const pool<body<S, D, Rotates>>& bodies, const buffer<transform<S, D>>& starts, const awake_list& awake,
                std::uint16_t tag, buffer<move_event>& to) {
    to.clear();
    for (const std::uint32_t i : awake) {
        const auto& b = bodies[i];
        const auto& start = starts[i];
        if (b.center == start.position && b.rotation == start.rotation) continue;
        to.push_back({{i, bodies.generation(i), tag}, b.user_data, false});
    }
    sort_in_place(to.begin(), to.size(),
                  [](const move_event& a, const move_event& b) { return a.body.index < b.body.index; });
}

}  // namespace detail

PHYSICS_HPP_END
