// The memory that the end of a step needs.
#pragma once

#include "physics/step/joint_limits.hpp"
#include "physics/step/sleep.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// What may wake or fall asleep at the end of a step.
template <class Plan>
void reserve_sleep(const wake_input<Plan>& w, typename Plan::scalar h) {
    using S = typename Plan::scalar;
    std::uint32_t changes = 0;
    const auto count_shapes = [&](std::uint32_t body) {
        each_shape(w.bodies, w.shapes, body, [&](std::uint32_t, const auto&) { ++changes; });
    };
    // What kinematic bodies run into, which may be all that sleeps.
    bool may_run = false;
    if (w.sleep.sleepers > 0)
        for (const std::uint32_t i : w.awake) may_run = may_run || !w.bodies[i].is_dynamic();
    if (may_run) {
        w.step.woken.reserve(w.bodies.slots());
        w.step.is_listed.grow(w.bodies.slots());
        changes = w.shapes.slots();
    }
    reserve_waking(w, w.shapes.slots(), changes);
    if constexpr (Plan::events::sleep)
        if (may_run) w.sleep.changes.woken.reserve(w.sleep.changes.woken.size() + w.sleep.sleepers);
    // Those that may have been still for long enough by the end of the step, and contacts of none but these.
    const auto& with = w.settings.sleeping;
    if (!with.enabled) return;
    const S long_ago = with.time - h;
    const auto may_sleep = [&](std::uint32_t i) {
        return w.bodies[i].is_dynamic() && !(w.sleep.sleep_time[i] < long_ago);
    };
    std::uint32_t bodies = 0, contacts = 0;
    for (const std::uint32_t i : w.awake) {
        if (!may_sleep(i)) continue;
        ++bodies;
        count_shapes(i);
    }
    if (bodies == 0) return;
    for (const auto& c : w.step.new_contacts)
        contacts += (may_sleep(c.bodies.body_a) || !w.bodies[c.bodies.body_a].is_dynamic()) &&
                    (may_sleep(c.bodies.body_b) || !w.bodies[c.bodies.body_b].is_dynamic());
    w.contacts.reserve(contacts);
    w.sleep.contacts.reserve(w.sleep.contacts.size() + contacts);
    if constexpr (Plan::events::sleep) w.sleep.changes.slept.reserve(w.sleep.changes.slept.size() + bodies);
    reserve_changes(w.broadphase, w.shapes.slots(), changes);
}

/// Takes the memory for what a step has to tell of its bodies and joints, and to remember.
template <class Plan, class Limits>
void reserve_results(const awake_list& awake, const joints_of<Plan>& joints, const Limits& limits,
                     pair_cache<Plan>& memories, std::uint32_t workers, step_data<Plan>& d) {
    if constexpr (Plan::remembers) d.pair_cache_changes.reserve(memories, workers);
    if constexpr (Plan::events::moves) d.events.moved.reserve(awake.size());
    if constexpr (Plan::has_joints && Plan::events::joint_limits)
        reserve_limits(d.joints.edge_count(), joints.records.slots(), limits, d.events);
}

}  // namespace detail

PHYSICS_HPP_END
