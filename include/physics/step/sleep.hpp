// Sleep: islands that are still leave the step until something happens to them.
#pragma once

#include "physics/dynamics/islands.hpp"
#include "physics/step/nearby.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Calls f(body) for all of a sleeper's island, itself included; f may wake them.
template <class Plan, class F>
void each_of_island(const sleep_state<Plan>& sleep, std::uint32_t body, F&& f) {
    std::uint32_t i = body;
    do {
        const std::uint32_t next = sleep.island_next[i];
        f(i);
        i = next;
    } while (i != body);
}

/// What waking reads and changes of a world.
template <class Plan>
struct wake_input {
    const pool<typename Plan::body>& bodies;
    const shape_pool<Plan>& shapes;
    const joints_of<Plan>& joints;
    const typename Plan::settings& settings;
    const solver_api::step_lengths<typename Plan::scalar>& step_lengths;
    sleep_of<Plan>& sleep;
    awake_list& awake;
    buffer<typename Plan::contact>& contacts;
    typename Plan::broadphase& broadphase;
    step_data<Plan>& step;
};
template <class Plan>
wake_input<Plan> to_wake(state<Plan>& s, step_data<Plan>& d) {
    return {s.bodies, s.shapes, s.joints, s.settings, s.step_lengths, s.sleep, s.awake, s.contacts, s.broadphase, d};
}

/// Takes the memory to wake the bodies that are listed in step.woken, and for so many changes of the broadphase more.
template <class Plan>
PHYSICS_HPP_NOINLINE void reserve_waking(const wake_input<Plan>& w, std::uint32_t slots, std::uint32_t changes) {
    if constexpr (Plan::events::sleep)
        w.sleep.changes.woken.reserve(w.sleep.changes.woken.size() + w.step.woken.size());
    for (const std::uint32_t i : w.step.woken)
        each_shape(w.bodies, w.shapes, i, [&](std::uint32_t, const auto&) { ++changes; });
    if (changes > 0) reserve_changes(w.broadphase, slots, changes);
}
/// Brings bodies back that were asleep, listed in step.woken: they can be pushed again, and what touches them is looked
/// at again. With the memory of reserve_waking nothing fails.
template <class Plan>
PHYSICS_HPP_NOINLINE void wake_bodies(const wake_input<Plan>& w) {
    for (const std::uint32_t i : w.step.woken) {
        if (w.sleep.is_asleep(i)) {
            --w.sleep.sleepers;
            if constexpr (Plan::events::sleep) w.sleep.changes.woken.push_back({i, w.bodies.generation(i), 0});
        }
        w.sleep.island_next[i] = no_sleeper;
        w.sleep.sleep_time[i] = {};
        reinsert_proxies<Plan>(w.bodies, w.shapes, w.sleep, w.settings.contact_margin, w.broadphase, i);
    }
    if (!w.step.woken.empty()) w.awake.is_stale = true;
    w.step.woken.clear();
}
/// Takes the contacts of sleepers, of which a body can be pushed again, out of their list.
template <class Plan>
void take_woken_contacts(const wake_input<Plan>& w) {
    partition_contacts(
        w.sleep.contacts, [&](const auto& c) { return !can_be_pushed(c, w.bodies, w.sleep); }, [](const auto&) {});
}
/// Begins a list of islands to wake, in step.woken.
template <class Plan>
void start_waking(const wake_input<Plan>& w) {
    // What was refused may have left its list.
    w.step.woken.clear();
    w.step.is_listed.clear();
}
/// Lists the island of a body, if it sleeps and is not there.
template <class Plan>
PHYSICS_HPP_NOINLINE void list_island(const wake_input<Plan>& w, std::uint32_t body) {
    auto& is_listed = w.step.is_listed;
    if (!w.sleep.is_asleep(body) || is_listed.has(body)) return;
    is_listed.grow(w.bodies.slots());
    each_of_island(w.sleep, body, [&](std::uint32_t i) {
        w.step.woken.push_back(i);
        is_listed.set(i);
    });
}
/// Wakes the islands that are listed, with the memory of reserve_waking: nothing fails. Their contacts stay where they
/// are until return_woken_contacts.
template <class Plan>
void finish_waking(const wake_input<Plan>& w) {
    if (w.step.woken.empty()) return;
    wake_bodies(w);
    w.sleep.has_woken_contacts = true;
}
/// Brings the contacts of bodies that have woken up since the last step to those that can be pushed. O(contacts), if
/// there are any.
template <class Plan>
PHYSICS_HPP_NOINLINE void return_woken_contacts(const wake_input<Plan>& w) {
    auto& returning = w.step.new_contacts;
    returning.clear();
    for (const auto& c : w.sleep.contacts)
        if (can_be_pushed(c, w.bodies, w.sleep)) returning.push_back(c);
    w.contacts.reserve(w.contacts.size() + returning.size());
    take_woken_contacts(w);
    rescale_impulses(returning.begin(), returning.end(), {w.sleep.step, w.sleep.step}, w.step_lengths);
    merge_contacts(w.contacts, returning);
    w.sleep.has_woken_contacts = false;
    w.step.note_contacts_moved();
}
/// Lists those asleep in a box that a shape meets.
template <class Plan>
PHYSICS_HPP_NOINLINE void list_near(const wake_input<Plan>& w, const shape_record<Plan>& shape,
                                    const aabb<typename Plan::scalar, Plan::dimension>& box) {
    each_near(w, box, query_filter{.any_category = true}, [&](std::uint32_t other) {
        const auto& there = w.shapes[other];
        if (w.sleep.is_asleep(there.body) && may_meet(shape.filter, there.filter)) list_island(w, there.body);
        return true;
    });
}
/// Lists those asleep that lie where a body is, or on its way to another pose, if it meets them, and those that joints
/// hold to it.
template <class Plan>
void list_near(const wake_input<Plan>& w, std::uint32_t body,
               const transform<typename Plan::scalar, Plan::dimension>& to) {
    if (w.sleep.sleepers == 0) return;
    each_shape(w.bodies, w.shapes, body, [&](std::uint32_t, const auto& shape) {
        // What comes into a sensor that moves is seen though it sleeps.
        if (shape.sensor && w.bodies[body].type != body_type::static_body) return;
        const auto there = bounds(shape.shape, to * shape.local);
        // Out of the range of numbers no step takes it; where a step asks, nothing may fail.
        if (is_box(there)) list_near(w, shape, merged(query_bounds(w, shape), there));
    });
    each_connected(w.joints, body, [&](std::uint32_t other) { list_island(w, other); });
}
/// Wakes what kinematic bodies are going to run into.
template <class Plan>
void wake_ahead(const wake_input<Plan>& w, typename Plan::scalar h) {
    for (const std::uint32_t i : w.awake) {
        const auto& b = w.bodies[i];
        if (b.is_dynamic() || b.at_target ||
            b.velocity == twist_of<typename Plan::scalar, Plan::dimension, Plan::rotates>{})
            continue;
        auto turn = b.rotation;
        if constexpr (Plan::rotates) turn = turned(turn, b.velocity.angular * h);
        start_waking(w);
        list_near(w, i, {b.center + b.velocity.linear * h - turn * b.mass.center, turn});
        reserve_waking(w, w.shapes.slots(), 0);
        finish_waking(w);
    }
}

/// How far gravity draws bodies together within a step, at most.
template <class S, int D>
S gravity_slack(const vec<S, D>& gravity, S h) {
    return length(gravity) * h * h;
}

/// Contacts with sleeping bodies -> the islands of those that a body will touch in this step: they are added to the
/// awake list, and wake for good when the step has succeeded. True if there are any.
template <class Plan>
bool list_woken(const buffer<typename Plan::contact>& contacts, const pool<typename Plan::body>& bodies,
                const sleep_state<Plan>& sleep, const vec<typename Plan::scalar, Plan::dimension>& gravity,
                typename Plan::scalar h, awake_list& awake, buffer<std::uint32_t>& woken) {
    const auto slack = gravity_slack(gravity, h);
    for (const auto& c : contacts) {
        const auto [a, b] = c.bodies;
        const bool of_a = sleep.is_asleep(a);
        if (of_a == sleep.is_asleep(b)) continue;
        const std::uint32_t sleeper = of_a ? a : b;
        if (awake.has(sleeper) || !will_touch(c, bodies[a].velocity_ahead(h), bodies[b].velocity_ahead(h), h, slack))
            continue;
        // Before the list changes, so that a step which finds no memory leaves none to the next one.
        awake.is_stale = true;
        each_of_island(sleep, sleeper, [&](std::uint32_t i) {
            awake.index_of[i] = 0;
            woken.push_back(i);
        });
    }
    if (woken.empty()) return false;
    for (const std::uint32_t i : woken) awake.bodies.push_back(i);
    awake.number(bodies.slots());
    return true;
}

/// The step has succeeded: they are awake for good.
template <class Plan>
void commit_woken(const wake_input<Plan>& w) {
    if (w.step.woken.empty()) return;
    wake_bodies(w);
    take_woken_contacts(w);
}

}  // namespace detail

PHYSICS_HPP_END
