// One step of a world: the page to read first.
#pragma once

#include "physics/step/collide.hpp"
#include "physics/step/edges.hpp"
#include "physics/step/fall_asleep.hpp"
#include "physics/step/find_pairs.hpp"
#include "physics/step/joint_limits.hpp"
#include "physics/step/publish.hpp"
#include "physics/step/reserve.hpp"
#include "physics/step/seams.hpp"
#include "physics/step/sensor_sweep.hpp"
#include "physics/step/sensors.hpp"
#include "physics/step/solve.hpp"
#include "physics/step/sweep.hpp"
#include "physics/step/update_boxes.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Makes ready what a step works with.
template <class Plan>
void start_step(step_data<Plan>& d, const task_runner& tasks) {
    d.woken.clear();
    d.scratch.reset();
    d.batch_scratch.prepare(tasks.workers());
    d.manifolds.prepare(tasks.workers());
    d.contacts_by_worker.prepare(tasks.workers());
    d.passing_by_worker.prepare(tasks.workers());
    d.passing.take(d.passing_by_worker, tasks.workers());
    d.pair_cache_changes.by.prepare(tasks.workers());
}

/// What is removed, and what has woken up, since the last step -> contacts and memories without the one, and with the
/// other among those that can be pushed.
template <class Plan>
void update_contacts(state<Plan>& s, step_data<Plan>& d) {
    if (s.removed.any()) {
        s.removed.take_out(s.contacts);
        if constexpr (Plan::sleeps)
            if (s.sleep.has_woken_contacts) s.removed.take_out(s.sleep.contacts);
        s.memories.drop([&](std::uint32_t shape) { return s.removed.has(shape); });
        s.removed.clear();
        d.contacts_of.is_stale = true;
    }
    if constexpr (Plan::sleeps)
        if (s.sleep.has_woken_contacts) return_woken_contacts(to_wake(s, d));
}
/// Boxes -> pairs of shapes that may touch.
template <class Plan>
const buffer<proxy_pair>& find_solid_pairs(state<Plan>& s, step_data<Plan>& d) {
    if constexpr (Plan::events::sensors)
        return without_sensors(find_pairs<Plan>(s.bodies, s.shapes, s.sleep, s.sensors, s.broadphase, d.scratch),
                               s.sensors, d.events.solid_pairs);
    else return find_pairs(s.broadphase, d.scratch);
}
template <class Plan>
void update_sensors(state<Plan>& s, step_data<Plan>& d, [[maybe_unused]] typename Plan::scalar h) {
    if constexpr (Plan::sweeps)
        sensor_sweep<Plan>({s.bodies, s.shapes, s.broadphase, s.awake, s.sleep, s.joints, s.continuous.extents,
                            s.settings, s.contact_starts},
                           h)
            .run(s.sensors, d.events.far, d.events.passed);
    const sensor_input<Plan> in{s.bodies, s.shapes, s.awake, s.joints, s.sleep, s.settings, s.broadphase, s.tag};
    // The next step has less to search for.
    const auto& pairs = find_pairs<Plan>(s.bodies, s.shapes, s.sleep, s.sensors, s.broadphase, d.scratch);
    sensor_update<Plan>(in, d.manifolds[0]).run(pairs, s.sensors, d.events);
}

/// How a step went; if not well, the world is as it was.
enum class step_result { done, bad_mixing_rule, out_of_range, bad_executor };

/// What a step consists of, for whoever measures it.
enum class step_stage { find_pairs, find_contacts, make_batches, solve, update_boxes, finish };

/// Called after each stage; this one does nothing.
struct no_watch {
    void operator()(step_stage) const {}
};

/// Advances a world by h seconds: each stage takes what it reads and gives what it makes, only this function knows
/// their order. Refused if surfaces do not mix, if a velocity or a position would leave the range of numbers, or if the
/// executor fails. Not inlined, so that no arithmetic moves out of the caller's float_control_scope.
template <class Plan, class Watch = no_watch>
PHYSICS_HPP_NOINLINE step_result step(state<Plan>& s, step_data<Plan>& d, typename Plan::scalar h, task_runner tasks,
                                      Watch done = {}) {
    using S = typename Plan::scalar;
    if (tasks.workers() == 0) return step_result::bad_executor;
    start_step(d, tasks);
    clear_depths<Plan>(s.bodies.slots(), d.sweep);
    // Settings -> what all surfaces make of each other, where no shape has a material of its own.
    if (!combine_common_materials<Plan>(s.settings, d.new_material)) return step_result::bad_mixing_rule;
    // What has changed since the last step -> its contacts, and memories of pairs, that are left.
    update_contacts(s, d);
    // Velocities -> boxes in the broadphase, of bodies that look ahead; how far, in d.sweep.
    look_ahead<Plan>(s.bodies, s.shapes, s.sleep, s.continuous, s.settings, h, s.broadphase, d.sweep);
    // Bodies -> which of them move.
    list_awake(s.bodies, s.sleep, s.awake);
    // Boxes -> pairs of shapes, in order; joints -> those whose bodies none keeps apart.
    const auto& overlapping = find_solid_pairs(s, d);
    const auto& pairs = without_connected(overlapping, s.joints, s.shapes, d.joints);
    done(step_stage::find_pairs);

    // Pairs, poses, the last step's contacts -> d.new_contacts, with feature ids and warm impulses.
    const collide_input<Plan> to_collide{
        s.bodies, s.shapes, s.awake, s.sleep, d.new_material, s.settings.contact_margin, h, s.steps, s.tag};
    const collide_result found = find_contacts(pairs, to_collide, s.contacts, s.step_lengths, s.memories, d, tasks);
    if (!found.materials_valid) return step_result::bad_mixing_rule;
    // Contacts with sleeping bodies -> islands that they wake, at the end of s.awake; their contacts, in
    // d.new_contacts.
    if constexpr (Plan::sleeps)
        if (found.near_sleeper &&
            list_woken<Plan>(d.new_contacts, s.bodies, s.sleep, s.settings.gravity, h, s.awake, d.woken) &&
            !find_contacts_of_woken(to_collide, s.memories, d, tasks))
            return step_result::bad_mixing_rule;
    // What the recipe's contact rule lets pass, in d.passing.
    d.passing.take(d.passing_by_worker, tasks.workers());
    // d.new_contacts -> those that are not at flush edges.
    drop_seam_contacts(to_collide, s.continuous, d);
    // Contacts, joints -> which bodies they hold together, in d.edges.
    list_edges(d.new_contacts, d.edges, tasks);
    if constexpr (Plan::has_joints) list_joints(s.joints, s.bodies, s.awake, d.edges, d.joints);
    done(step_stage::find_contacts);

    // Edges -> islands, in batches.
    const batches graph = build_graph(d.edges, s.bodies, s.awake, d.scratch, tasks);
    done(step_stage::make_batches);

    // Bodies, contacts, joints -> velocities and poses, in `moved`; impulses, in d.new_contacts and d.joints.
    warm_impulses<S> warm(s.step_lengths, s.steps, h);
    warm.before_solve(d.new_contacts, d.scratch);
    const auto moved = place_bodies<S, Plan::dimension, Plan::rotates>(graph, d.scratch);
    const solve_input<Plan> to_solve{s.bodies, s.awake, s.settings, h, s.step_lengths.usual};
    const bool solved =
        solve(graph, to_solve, d.new_contacts, d.new_material, d.joints, moved, d.batch_scratch, d.scratch, tasks);
    done(step_stage::solve);
    if (!tasks.ran_all_tasks()) return step_result::bad_executor;
    if (!solved) return step_result::out_of_range;

    // Poses -> poses short of what stops bodies, in `moved`.
    [[maybe_unused]] continuous_report<S> sweep_report;
    if constexpr (Plan::sweeps) {
        const auto& extents = s.continuous.extents;
        const sweep_input<Plan> to_sweep{s.bodies, s.shapes,   s.broadphase, s.awake,        s.sleep, s.joints,
                                         extents,  s.settings, d.passing,    d.new_contacts, s.tag};
        sweep_report = sweep(to_sweep, moved, h, d.sweep);
    }
    // Poses -> poses of shapes, and boxes in the broadphase of those that left theirs; put back unless they are kept.
    box_update<Plan> boxes(s.bodies, s.awake, moved, s.settings.contact_margin, h, s.shapes, s.broadphase);
    if (!boxes.run(d.scratch, tasks))
        return tasks.ran_all_tasks() ? step_result::out_of_range : step_result::bad_executor;
    done(step_stage::update_boxes);

    // All memory that is needed once results are published.
    reserve_results<Plan>(s.awake, s.joints, s.joint_limits, s.memories, tasks.workers(), d);
    if constexpr (Plan::sleeps) reserve_sleep(to_wake(s, d), h);
    [[maybe_unused]] auto judge =
        make_sleep_judge<Plan>(s.contacts, joint_edges(d), s.settings, h, s.awake, s.bodies, s.sleep, d.scratch);
    // Contacts, how bodies have moved -> which shapes touch, and what is told of that, in d.events.
    if constexpr (Plan::events::contacts || Plan::events::hits) {
        const touch_input<Plan> to_touch{
            s.bodies, s.shapes, s.awake, s.sleep, s.contacts, d.woken, s.settings.contact_margin, h, s.tag};
        touch_events<Plan, decltype(moved)> events(to_touch, moved, d.events);
        if constexpr (Plan::events::contacts) events.find_touching(s.dropped.list, d.new_contacts);
        if constexpr (Plan::events::hits) events.find_hits(d.new_contacts, s.settings.events.hit_speed);
        if constexpr (Plan::events::contacts) events.keep(s.dropped.list);
        else events.keep();
    }
    // Results -> bodies and contacts. From here on nothing fails.
    boxes.keep();
    publish(s, d, moved, warm, h);
    if constexpr (Plan::events::moves) list_moved(s.bodies, s.contact_starts, s.awake, s.tag, d.events.moved);
    if constexpr (Plan::has_joints) break_joints(d.joints, s.bodies, s.joints, s.sleep);
    // What joints gave -> which have come to limits, and left them, in d.events.
    if constexpr (Plan::has_joints && Plan::events::joint_limits)
        update_limits(d.joints, s.joints, s.bodies, s.sleep, s.settings.contact_margin * S(release_margin), s.tag,
                      s.joint_limits, d.events);
    if constexpr (Plan::sweeps) s.continuous.report = sweep_report;
    if constexpr (Plan::sleeps) {
        // What was woken is awake for good, and so is what kinematic bodies are going to run into.
        commit_woken(to_wake(s, d));
    }
    // Poses, boxes -> what has come into sensors and left them, in d.events; without memory the next step tells of it.
    if constexpr (Plan::events::sensors)
        if (!run_if_memory_lasts([&] { update_sensors(s, d, h); })) d.events.clear_sensor_events();
    if constexpr (Plan::sleeps) {
        wake_ahead(to_wake(s, d), h);
        // Contacts, joints, and how bodies move -> islands that fall asleep, with their contacts.
        if (fall_asleep<Plan>(judge, s.settings, s.shapes, s.awake, s.bodies, s.sleep, s.broadphase)) {
            move_contacts_to_sleepers<Plan>(s.bodies, s.step_lengths, s.contacts, s.sleep, d.new_contacts);
            if constexpr (Plan::remembers)
                s.memories.drop([&](std::uint32_t shape) { return s.is_asleep(s.shapes[shape].body); });
            d.note_contacts_moved();
        }
        if constexpr (Plan::events::sleep) publish_sleep_changes(s.sleep.changes, s.tag, d.events);
        if constexpr (Plan::events::moves)
            for (move_event& e : d.events.moved) e.fell_asleep = s.is_asleep(e.body.index);
    }
    d.contacts_of.is_stale = true;
    done(step_stage::finish);
    return step_result::done;
}

}  // namespace detail

PHYSICS_HPP_END
