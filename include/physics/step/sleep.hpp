// Sleep: islands that are still leave the step until something happens to them.
#pragma once

#include "physics/dynamics/islands.hpp"
#include "physics/step/nearby.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Keeps, in order, the contacts for which stays(contact) is true, and hands the others to out.
template <class Contacts, class Stays, class Out>
void partition_contacts(Contacts& contacts, Stays&& stays, Out&& out) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < contacts.size(); ++i) {
        if (!stays(contacts[i])) {
            out(contacts[i]);
            continue;
        }
        if (kept != i) contacts[kept] = contacts[i];
        ++kept;
    }
    while (contacts.size() > kept) contacts.pop_back();
}
/// Adds contacts to others; both lists, and the result, are in ascending order of their pairs.
template <class Contact>
void merge_contacts(buffer<Contact>& to, const buffer<Contact>& more) {
    std::uint32_t i = to.size(), j = more.size();
    if (j == 0) return;
    to.resize(i + j, more[0]);
    for (std::uint32_t at = to.size(); j > 0;) {
        const bool is_last = i > 0 && more[j - 1].key() < to[i - 1].key();
        to[--at] = is_last ? to[--i] : more[--j];
    }
}

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

/// Brings bodies back that were asleep, listed in s.step.woken: they can be pushed again, and what touches them is
/// looked at again.
template <class Plan>
void finish_waking(state<Plan>& s) {
    for (const std::uint32_t i : s.step.woken) {
        s.sleep.island_next[i] = no_sleeper;
        s.sleep.sleep_time[i] = {};
        reinsert_proxies(s, i);
    }
    if (!s.step.woken.empty()) s.awake.is_stale = true;
    s.step.woken.clear();
}
/// True if neither body of the contact is dynamic and awake.
template <class Plan, class Contact>
bool touches_no_awake_body(const state<Plan>& s, const Contact& c) {
    return !s.is_awake_dynamic(c.bodies.body_a) && !s.is_awake_dynamic(c.bodies.body_b);
}
/// Wakes the islands of those that each(f) calls f(body) for, at once, with their contacts. O(contacts of sleepers).
template <class Plan, class Each>
void wake_islands(state<Plan>& s, Each&& each) {
    // A step that was refused may have left its list.
    s.step.woken.clear();
    bool any = false;
    each([&](std::uint32_t body) {
        if (!s.is_asleep(body)) return;
        any = true;
        each_of_island(s.sleep, body, [&](std::uint32_t i) { s.step.woken.push_back(i); });
        finish_waking(s);
    });
    if (!any) return;
    s.step.new_contacts.clear();
    partition_contacts(
        s.sleep.contacts, [&](const auto& c) { return touches_no_awake_body(s, c); },
        [&](const auto& c) { s.step.new_contacts.push_back(c); });
    rescale_impulses(s.step.new_contacts.begin(), s.step.new_contacts.end(), {s.sleep.step, s.sleep.step},
                     s.step_lengths);
    merge_contacts(s.contacts, s.step.new_contacts);
}
/// Wakes those that lie where a body is, or on its way to another pose, and those that joints hold to it.
template <class Plan>
void wake_near(state<Plan>& s, std::uint32_t body, const transform<typename Plan::scalar, Plan::dimension>& to) {
    if constexpr (Plan::sleeps) {
        auto& near = s.step.near;
        near.clear();
        each_shape(s, body, [&](std::uint32_t, const auto& shape) {
            const auto box = merged(query_bounds(s, shape), bounds(shape.shape, to * shape.local));
            each_near(s, box, query_filter{}, [&](std::uint32_t other) {
                if (s.is_asleep(s.shapes[other].body)) near.push_back(s.shapes[other].body);
                return true;
            });
        });
        each_connected(s.joints, body, [&](std::uint32_t other) { near.push_back(other); });
        wake_islands(s, [&](auto&& f) {
            for (const std::uint32_t i : near) f(i);
        });
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
        each_of_island(sleep, sleeper, [&](std::uint32_t i) {
            awake.index_of[i] = 0;
            woken.push_back(i);
        });
    }
    if (woken.empty()) return false;
    for (const std::uint32_t i : woken) awake.bodies.push_back(i);
    awake.number(bodies.slots());
    awake.is_stale = true;
    return true;
}

/// The step has succeeded: they are awake for good.
template <class Plan>
void commit_woken(state<Plan>& s) {
    if (s.step.woken.empty()) return;
    finish_waking(s);
    partition_contacts(
        s.sleep.contacts, [&](const auto& c) { return touches_no_awake_body(s, c); }, [](const auto&) {});
}

}  // namespace detail

PHYSICS_HPP_END
