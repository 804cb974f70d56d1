// What is woken by what happens to a world between steps.
#pragma once

#include "physics/step/sleep.hpp"
#include "physics/world/world_data.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

template <class Plan>
void wake(world_data<Plan>& s, std::uint32_t body) {
    if constexpr (Plan::sleeps) wake_islands(to_wake<Plan>(s, s.step), [&](auto&& f) { f(body); });
}
/// Wakes those that touch a body, or that joints hold to it.
template <class Plan>
void wake_touching(world_data<Plan>& s, std::uint32_t body) {
    if constexpr (Plan::sleeps) {
        auto& touching = s.step.near;
        touching.clear();
        for (const auto& c : s.sleep.contacts) {
            if (c.bodies.body_a == body) touching.push_back(c.bodies.body_b);
            if (c.bodies.body_b == body) touching.push_back(c.bodies.body_a);
        }
        each_connected(s.joints, body, [&](std::uint32_t other) { touching.push_back(other); });
        wake_islands(to_wake<Plan>(s, s.step), [&](auto&& f) {
            for (const std::uint32_t i : touching) f(i);
        });
    }
}
/// A body has changed: wakes its island if it is dynamic, else the islands that touch it.
template <class Plan>
void wake_affected(world_data<Plan>& s, std::uint32_t body) {
    if (s.bodies[body].is_dynamic()) wake(s, body);
    else wake_touching(s, body);
}
template <class Plan>
void wake_near(world_data<Plan>& s, std::uint32_t body, const transform<typename Plan::scalar, Plan::dimension>& to) {
    if constexpr (Plan::sleeps) wake_near(to_wake<Plan>(s, s.step), body, to);
}
template <class Plan>
void wake_near(world_data<Plan>& s, std::uint32_t body) {
    wake_near(s, body, s.bodies[body].pose());
}
/// Wakes those that lie where a shape is, if it meets them.
template <class Plan>
void wake_near_shape(world_data<Plan>& s, std::uint32_t shape) {
    if constexpr (Plan::sleeps)
        if (s.sleep.sleepers != 0) {
            const wake_input<Plan> w = to_wake<Plan>(s, s.step);
            w.step.near.clear();
            list_near(w, s.shapes[shape], query_bounds(s, s.shapes[shape]));
            wake_listed(w);
        }
}
template <class Plan>
void wake_all(world_data<Plan>& s) {
    if constexpr (Plan::sleeps)
        wake_islands(to_wake<Plan>(s, s.step),
                     [&](auto&& f) { s.bodies.each([&](std::uint32_t i, const auto&) { f(i); }); });
}

template <class Plan>
std::uint32_t count_awake(const state<Plan>& s) {
    std::uint32_t count = 0;
    s.bodies.each(
        [&](std::uint32_t i, const auto& b) { count += b.type != body_type::static_body && !s.is_asleep(i); });
    return count;
}

}  // namespace detail

PHYSICS_HPP_END
