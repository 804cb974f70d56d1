// One step of a world: the page to read first.
#pragma once

#include "physics/step/collide.hpp"
#include "physics/step/edges.hpp"
#include "physics/step/fall_asleep.hpp"
#include "physics/step/find_pairs.hpp"
#include "physics/step/publish.hpp"
#include "physics/step/seams.hpp"
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
    d.pair_cache_changes.by.prepare(tasks.workers());
}

/// How a step went; if not well, the world is as it was.
enum class step_result { done, bad_mixing_rule, out_of_range, bad_executor };

/// What a step consists of, for whoever measures it.
enum class step_stage { find_pairs, find_contacts, make_batches, solve, update_boxes, finish };

/// Called after each stage; this one does nothing.
struct no_watch {
    void operator()(step_stage) const {}
};

/// Advances a world by h seconds. Each stage reads and writes plain arrays; only this function knows their
/// order. Refused if surfaces do not mix, or if a velocity or a position would leave the range of numbers.
/// Not inlined, so that no arithmetic moves out of the caller's float_control_scope.
template <class Plan, class Watch = no_watch>
PHYSICS_HPP_NOINLINE step_result step(state<Plan>& s, typename Plan::scalar h, task_runner tasks, Watch done = {}) {
    if (tasks.workers() == 0) return step_result::bad_executor;
    step_data<Plan>& d = s.step;
    start_step(d, tasks);
    // Settings -> what all surfaces make of each other, where no shape has a material of its own.
    if (!combine_common_materials<Plan>(s.settings, d.new_material)) return step_result::bad_mixing_rule;
    clear_depths<Plan>(s.bodies.slots(), d.sweep);
    // Velocities -> boxes of bodies that look ahead.
    look_ahead<Plan>(s.bodies, s.shapes, s.sleep, s.continuous, s.settings, h, s.broadphase, d.sweep);
    list_awake(s.bodies, s.sleep, s.awake);                   // bodies            -> which of them move
    const auto& pairs = find_pairs(s.broadphase, d.scratch);  // boxes             -> pairs, in order
    done(step_stage::find_pairs);
    const collide_input<Plan> to_collide{
        s.bodies, s.shapes, s.awake, s.sleep, d.new_material, s.settings.contact_margin, h, s.steps};
    // Pairs, poses, last step's contacts -> contacts with feature ids and warm impulses.
    const collide_result found = find_contacts(pairs, to_collide, s.contacts, s.step_lengths, s.memories, d, tasks);
    if (!found.materials_valid) return step_result::bad_mixing_rule;
    if constexpr (Plan::sleeps)
        // Contacts with sleeping bodies -> contacts of the islands that they wake.
        if (found.near_sleeper &&
            list_woken<Plan>(d.new_contacts, s.bodies, s.sleep, s.settings.gravity, h, s.awake, d.woken) &&
            !find_contacts_of_woken(to_collide, s.memories, d, tasks))
            return step_result::bad_mixing_rule;
    drop_seam_contacts(to_collide, s.continuous, d);  // contacts          -> without those at flush edges
    list_edges(d.new_contacts, d.edges, tasks);       // contacts          -> which bodies they hold together
    done(step_stage::find_contacts);
    // Edges -> islands, in batches.
    const batches graph = build_graph(d.edges, s.bodies, s.awake, d.scratch, tasks);
    done(step_stage::make_batches);
    warm_impulses<typename Plan::scalar> warm(s.step_lengths, s.steps, h);
    warm.before_solve(d.new_contacts, d.scratch);
    const solve_input<Plan> to_solve{s.bodies, s.awake, s.settings, h, s.step_lengths.usual};
    const auto moved = place_bodies<typename Plan::scalar, Plan::dimension, Plan::rotates>(graph, d.scratch);
    // Bodies, contacts -> velocities, poses, impulses.
    const bool solved = batch_solver<Plan>(graph, to_solve, d.new_contacts, d.new_material, moved)
                            .run(d.batch_scratch, d.scratch, tasks);
    done(step_stage::solve);
    if (!tasks.ran_all_tasks()) return step_result::bad_executor;
    if (!solved) return step_result::out_of_range;
    sweep_fast_bodies(s, moved, h);  // poses             -> poses short of what stops bodies
    // Poses -> boxes of what has moved.
    if (!update_boxes<Plan>(s.bodies, s.awake, moved, s.settings.contact_margin, h, s.shapes, s.broadphase, d.scratch,
                            tasks))
        return tasks.ran_all_tasks() ? step_result::out_of_range : step_result::bad_executor;
    done(step_stage::update_boxes);
    publish(s, moved, warm, h);  // results           -> bodies and contacts
    if constexpr (Plan::sleeps) {
        commit_woken(s);   // bodies            -> who is awake for good
        wake_ahead(s, h);  // kinematic bodies  -> who is woken before they come
        // Bodies, contacts -> who falls asleep, with their contacts.
        if (fall_asleep<Plan>(s.contacts, s.settings, h, s.shapes, s.awake, s.bodies, s.sleep, s.broadphase,
                              d.scratch)) {
            move_contacts_to_sleepers<Plan>(s.bodies, s.step_lengths, s.contacts, s.sleep, d.new_contacts);
            if constexpr (Plan::remembers)
                s.memories.drop([&](std::uint32_t shape) { return s.is_asleep(s.shapes[shape].body); });
        }
    }
    done(step_stage::finish);
    return step_result::done;
}

}  // namespace detail

PHYSICS_HPP_END
