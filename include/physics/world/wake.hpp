// What is woken by what happens to a world between steps.
#pragma once

#include "physics/step/sleep.hpp"
#include "physics/world/world_data.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Begins a list of islands that wake by one change: list_affected and list_near add to it, prepare_waking takes all
/// memory and finish_waking wakes them, so that what is refused before that has changed nothing.
template <class Plan>
void start_waking(world_data<Plan>& s) {
    if constexpr (Plan::sleeps) start_waking(to_wake<Plan>(s, s.step));
}
template <class Plan>
void list_island(world_data<Plan>& s, std::uint32_t body) {
    if constexpr (Plan::sleeps) list_island(to_wake<Plan>(s, s.step), body);
}
/// For a change of so many shapes in the broadphase, of numbers below `slots`.
template <class Plan>
void prepare_waking(world_data<Plan>& s, std::uint32_t slots, std::uint32_t changes) {
    if constexpr (Plan::sleeps) reserve_waking(to_wake<Plan>(s, s.step), slots, changes);
    else reserve_changes(s.broadphase, slots, changes);
}
template <class Plan>
void prepare_waking(world_data<Plan>& s, std::uint32_t changes = 0) {
    prepare_waking(s, s.shapes.slots(), changes);
}
template <class Plan>
void finish_waking(world_data<Plan>& s) {
    if constexpr (Plan::sleeps) finish_waking(to_wake<Plan>(s, s.step));
}
/// To wake the island of a body.
template <class Plan>
void prepare_waking_of(world_data<Plan>& s, std::uint32_t body) {
    start_waking(s);
    if (!s.is_asleep(body)) return;
    list_island(s, body);
    prepare_waking(s);
}
/// Wakes the islands of two bodies.
template <class Plan>
void wake(world_data<Plan>& s, std::uint32_t body, std::uint32_t other) {
    if (!s.is_asleep(body) && !s.is_asleep(other)) return;
    start_waking(s);
    for (const std::uint32_t i : {body, other}) list_island(s, i);
    prepare_waking(s);
    finish_waking(s);
}
/// Lists what joints hold to a body.
template <class Plan>
void list_connected(world_data<Plan>& s, std::uint32_t body) {
    if constexpr (Plan::sleeps) each_connected(s.joints, body, [&](std::uint32_t other) { list_island(s, other); });
}
/// Lists those asleep that touch a body, or are held to it by joints.
template <class Plan>
PHYSICS_HPP_NOINLINE void list_touching(world_data<Plan>& s, std::uint32_t body) {
    list_connected(s, body);
    if constexpr (Plan::sleeps) {
        if (s.sleep.contacts.empty()) return;
        each_contact(s, body, [&](const auto& in, std::uint32_t at) {
            const auto [a, b] = in[at].bodies;
            if (&in == &s.sleep.contacts) list_island(s, a == body ? b : a);
        });
    }
}
/// Bodies change, for which each(f) calls f(body): lists those that are dynamic, and what touches others or is held to
/// them by joints.
template <class Plan, class Each>
void list_affected(world_data<Plan>& s, Each&& each) {
    if constexpr (Plan::sleeps)
        each([&](std::uint32_t body) {
            if (s.bodies[body].is_dynamic()) list_island(s, body);
            else list_touching(s, body);
        });
}
template <class Plan>
PHYSICS_HPP_NOINLINE void list_affected(world_data<Plan>& s, std::uint32_t body) {
    list_affected(s, [&](auto&& f) { f(body); });
}
template <class Plan>
void wake_affected(world_data<Plan>& s, std::uint32_t body) {
    start_waking(s);
    list_affected(s, body);
    prepare_waking(s);
    finish_waking(s);
}
/// Lists those asleep that lie where a body is, or on its way to another pose.
template <class Plan>
void list_near(world_data<Plan>& s, std::uint32_t body, const transform<typename Plan::scalar, Plan::dimension>& to) {
    if constexpr (Plan::sleeps)
        if (s.bodies[body].enabled) list_near(to_wake<Plan>(s, s.step), body, to);
}
/// Lists those that lie where a shape is, or is going to be, on an enabled body of that type, if it meets them.
template <class Plan>
void list_near_shape(world_data<Plan>& s, const shape_record<Plan>& shape, body_type type) {
    if constexpr (Plan::sleeps)
        if (s.sleep.sleepers != 0 && (!shape.sensor || type == body_type::static_body))
            list_near(to_wake<Plan>(s, s.step), shape, query_bounds(s, shape));
}
template <class Plan>
void list_all(world_data<Plan>& s) {
    if constexpr (Plan::sleeps) s.bodies.each([&](std::uint32_t i, const auto&) { list_island(s, i); });
}

template <class Plan>
std::uint32_t count_awake(const state<Plan>& s) {
    std::uint32_t count = 0;
    s.bodies.each([&](std::uint32_t i, const auto& b) {
        if (!b.enabled) return;
        const bool moves = b.has_target || !(b.at_target || b.velocity == decltype(b.velocity){});
        count += b.is_dynamic() ? !s.is_asleep(i) : moves;
    });
    return count;
}

}  // namespace detail

PHYSICS_HPP_END
