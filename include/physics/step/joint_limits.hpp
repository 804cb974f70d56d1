// Which joints are at their limits, and what a step tells of that.
#pragma once

#include "physics/base/sort.hpp"
#include "physics/step/events.hpp"
#include "physics/step/joints.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Whether a joint is at a limit: a row that pushes in one direction only has done so in the last step, or has no more
/// than this room (m, rad) and was at it before.
template <class Joint, class S, int D, bool Rotates>
bool is_at_limit(const stored_joint<Joint, S>& j, const body<S, D, Rotates>& a, const body<S, D, Rotates>& b,
                 bool was_before, S room) {
    bool any = was_before;
    for (int k = 0; k < Joint::row_count; ++k) any = any || !(j.sum[k] == S(0));
    if (!any) return false;
    auto at = frames_between<Joint>(a, b);
    at.turned = j.turned.begin();
    row_list<S, D, Joint::row_count, has_two_directions<Joint>()> rows;
    rows_of(j.joint, at, rows.target());
    for (int k = 0; k < Joint::row_count; ++k) {
        const auto& row = rows.row[k];
        const bool is_one_sided = (row.min_force == S(0)) != (row.max_force == S(0));
        if (!is_one_sided || row.is_motor) continue;
        const S left = row.min_force == S(0) ? row.error : -row.error;
        if (!(j.sum[k] == S(0)) || (was_before && left <= room)) return true;
    }
    return false;
}

/// The ids and the bodies of a joint, without the world's tag.
template <class S, int D, class Joints, bool Rotates>
joint_limit_event limit_event_of(const joint_set<S, D, Joints>& all, const pool<body<S, D, Rotates>>& bodies,
                                 std::uint32_t number) {
    const joint_record& record = all.records[number];
    joint_limit_event e;
    e.joint = {number, all.records.generation(number), 0};
    e.body_a = {record.body_a, bodies.generation(record.body_a), 0};
    e.body_b = {record.body_b, bodies.generation(record.body_b), 0};
    e.user_data = record.user_data;
    return e;
}
/// A joint is about to be destroyed.
template <class S, int D, class Joints, bool Rotates>
void drop_limit(const joint_set<S, D, Joints>& all, const pool<body<S, D, Rotates>>& bodies, std::uint32_t number,
                joint_limit_state& limits) {
    auto& at_limit = limits.at_limit;
    const std::uint32_t at = count_before(at_limit, [&](std::uint32_t i) { return i < number; });
    if (at == at_limit.size() || at_limit[at] != number) return;
    limits.dropped.push_back(limit_event_of(all, bodies, number));
    limits.dropped.back().gone = true;
    for (std::uint32_t i = at + 1; i < at_limit.size(); ++i) at_limit[i - 1] = at_limit[i];
    at_limit.pop_back();
}

/// Takes the memory for update_limits, of so many joints of a step.
template <class S, int D>
void reserve_limits(std::uint32_t joints, std::uint32_t slots, const joint_limit_state& limits, step_events<S, D>& to) {
    const std::uint32_t before = limits.at_limit.size();
    to.now_at_limit.reserve(before + joints);
    to.looked_at.reserve(slots);
    to.limit_begin.reserve(joints);
    to.limit_end.reserve(before + limits.dropped.size());
}
/// What the joints of a step gave -> which have come to limits, and which have left them. O(joints of the step).
template <class S, int D, class Joints, bool Rotates, class Sleep>
void update_limits(const step_joints<S, D, Joints>& found, const joint_set<S, D, Joints>& all,
                   const pool<body<S, D, Rotates>>& bodies, const Sleep& sleep, S room, std::uint16_t tag,
                   joint_limit_state& limits, step_events<S, D>& to) {
    to.limit_begin.clear();
    to.limit_end.clear();
    auto &before = limits.at_limit, &now = to.now_at_limit;
    auto& is_in_step = to.looked_at;
    now.clear();
    is_in_step.grow(all.records.slots());
    all.each_kind(all, [&]<class Joint>(std::uint32_t, const pool<stored_joint<Joint, S>>& of_kind) {
        for (const auto& j : found.template of_kind<Joint>()) {
            const auto& stored = of_kind[j.slot];
            const joint_record& record = all.records[stored.number];
            is_in_step.set(stored.number);
            const std::uint32_t at = count_before(before, [&](std::uint32_t i) { return i < stored.number; });
            const bool was_before = at < before.size() && before[at] == stored.number;
            if (record.holds() && is_at_limit(stored, bodies[record.body_a], bodies[record.body_b], was_before, room))
                now.push_back(stored.number);
        }
    });
    // What sleeps is as it was.
    for (const std::uint32_t i : before) {
        const joint_record& record = all.records[i];
        if (!is_in_step[i] && record.holds() && (sleep.is_asleep(record.body_a) || sleep.is_asleep(record.body_b)))
            now.push_back(i);
    }
    is_in_step.clear();
    const auto is_less = [](std::uint32_t a, std::uint32_t b) { return a < b; };
    sort_in_place(now.begin(), now.size(), is_less);
    for (std::uint32_t i = 0, k = 0; i < before.size() || k < now.size();) {
        const bool ends = k == now.size() || (i < before.size() && before[i] < now[k]);
        const bool begins = i == before.size() || (k < now.size() && now[k] < before[i]);
        if (ends) to.limit_end.push_back(limit_event_of(all, bodies, before[i]));
        if (begins) to.limit_begin.push_back(limit_event_of(all, bodies, now[k]));
        i += !begins;
        k += !ends;
    }
    before.swap(now);
    for (const joint_limit_event& e : limits.dropped) to.limit_end.push_back(e);
    if (!limits.dropped.empty())
        sort_in_place(
            to.limit_end.begin(), to.limit_end.size(),
            [](const joint_limit_event& x, const joint_limit_event& y) { return x.joint.index < y.joint.index; });
    limits.dropped.clear();
    for (auto* events : {&to.limit_begin, &to.limit_end})
        for (joint_limit_event& e : *events) e.joint.world = e.body_a.world = e.body_b.world = tag;
}

}  // namespace detail

PHYSICS_HPP_END
