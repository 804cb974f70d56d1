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
/// Calls f(list, i) for the contacts of a body: list[i] is one of those that can be pushed, or of those of sleepers.
template <class Plan, class F>
void each_contact(const world_data<Plan>& s, std::uint32_t body, F&& f) {
    const buffer<typename Plan::contact>* asleep = nullptr;
    if constexpr (Plan::sleeps) asleep = &s.sleep.contacts;
    s.step.contacts_of.each(s.bodies.slots(), s.contacts, asleep, body, [&](std::uint32_t n) {
        const bool is_asleep = n >= s.contacts.size();
        const std::uint32_t at = is_asleep ? n - s.contacts.size() : n;
        const auto& list = is_asleep ? *asleep : s.contacts;
        if (!s.removed.in(list[at])) f(list, at);
    });
}
/// Bodies change, for which each(f) calls f(body): wakes the islands of those that are
/// dynamic, and of what touches others or is held to them by joints.
template <class Plan, class Each>
void wake_affected(world_data<Plan>& s, Each&& each) {
    if constexpr (Plan::sleeps) {
        auto& affected = s.step.near;
        affected.clear();
        each([&](std::uint32_t body) {
            if (s.bodies[body].is_dynamic()) {
                affected.push_back(body);
                return;
            }
            const auto add = [&](std::uint32_t other) { affected.push_back(other); };
            each_connected(s.joints, body, add);
            if (s.sleep.contacts.empty()) return;
            each_contact(s, body, [&](const auto& in, std::uint32_t at) {
                if (&in == &s.sleep.contacts)
                    add(in[at].bodies.body_a == body ? in[at].bodies.body_b : in[at].bodies.body_a);
            });
        });
        wake_listed(to_wake<Plan>(s, s.step));
    }
}
template <class Plan>
void wake_affected(world_data<Plan>& s, std::uint32_t body) {
    wake_affected(s, [&](auto&& f) { f(body); });
}
template <class Plan>
void wake_near(world_data<Plan>& s, std::uint32_t body, const transform<typename Plan::scalar, Plan::dimension>& to) {
    if constexpr (Plan::sleeps)
        if (s.bodies[body].enabled) wake_near(to_wake<Plan>(s, s.step), body, to);
}
template <class Plan>
void wake_near(world_data<Plan>& s, std::uint32_t body) {
    wake_near(s, body, s.bodies[body].pose());
}
/// Wakes those that lie where a shape is, if it meets them.
template <class Plan>
void wake_near_shape(world_data<Plan>& s, std::uint32_t shape) {
    if constexpr (Plan::sleeps)
        if (s.sleep.sleepers != 0 && s.bodies[s.shapes[shape].body].enabled &&
            (!s.shapes[shape].sensor || s.bodies[s.shapes[shape].body].type == body_type::static_body)) {
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
    s.bodies.each([&](std::uint32_t i, const auto& b) {
        if (!b.enabled) return;
        const bool moves = b.has_target || !(b.at_target || b.velocity == decltype(b.velocity){});
        count += b.is_dynamic() ? !s.is_asleep(i) : moves;
    });
    return count;
}

}  // namespace detail

PHYSICS_HPP_END
