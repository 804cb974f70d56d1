// One step of a world: the page to read first.
#pragma once

#include "physics/step/collide.hpp"
#include "physics/step/edges.hpp"
#include "physics/step/find_pairs.hpp"
#include "physics/step/publish.hpp"
#include "physics/step/seams.hpp"
#include "physics/step/solve.hpp"
#include "physics/step/update_boxes.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Makes ready what a step works with.
template <class Plan>
void start_step(state<Plan>& s, const task_runner& tasks) {
    s.step.scratch.reset();
    s.step.batch_scratch.prepare(tasks.workers());
    s.step.manifolds.prepare(tasks.workers());
    s.step.contacts_by_worker.prepare(tasks.workers());
    s.step.pair_cache_changes.by.prepare(tasks.workers());
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
    start_step(s, tasks);
    // Settings -> what all surfaces make of each other, where no shape has a material of its own.
    if (!combine_common_materials<Plan>(s.settings, s.step.new_material)) return step_result::bad_mixing_rule;
    watch_fast_bodies(s, h);                 // velocities        -> boxes of bodies that look ahead
    list_awake(s.bodies, s.sleep, s.awake);  // bodies            -> which of them move
    const auto& pairs = find_pairs(s.broadphase, s.step.scratch);  // boxes             -> pairs, in order
    done(step_stage::find_pairs);
    // Pairs, poses, last step's contacts -> contacts with feature ids and warm impulses.
    const collide_result found = find_contacts(s, pairs, s.contacts, s.step_lengths, h, tasks);
    if (!found.materials_valid) return step_result::bad_mixing_rule;
    if constexpr (Plan::sleeps)
        // Contacts with sleeping bodies -> contacts of the islands that they wake.
        if (list_woken(s, found.near_sleeper, h) && !find_contacts_of_woken(s, h, tasks))
            return step_result::bad_mixing_rule;
    const seam_contacts seams(s, h);                       // contacts          -> without those at flush edges
    list_edges(s.step.new_contacts, s.step.edges, tasks);  // contacts          -> which bodies they hold together
    done(step_stage::find_contacts);
    // Edges -> islands, in batches.
    const batches graph = build_graph(s.step.edges, s.bodies, s.awake, s.step.scratch, tasks);
    done(step_stage::make_batches);
    warm_impulses<typename Plan::scalar> warm(s.step_lengths, s.steps, h);
    warm.before_solve(s.step.new_contacts, s.step.scratch);
    const solve_input<Plan> in{s.bodies, s.awake, s.settings, h, s.step_lengths.usual};
    const auto moved = place_bodies<typename Plan::scalar, Plan::dimension, Plan::rotates>(graph, s.step.scratch);
    // Bodies, contacts -> velocities, poses, impulses.
    const bool solved = batch_solver<Plan>(graph, in, s.step.new_contacts, s.step.new_material, moved)
                            .run(s.step.batch_scratch, s.step.scratch, tasks);
    done(step_stage::solve);
    if (!tasks.ran_all_tasks()) return step_result::bad_executor;
    if (!solved) return step_result::out_of_range;
    sweep_fast_bodies(s, moved, h);  // poses             -> poses short of what stops bodies
    // Poses -> boxes of what has moved.
    if (!update_boxes<Plan>(s.bodies, s.awake, moved, s.settings.contact_margin, h, s.shapes, s.broadphase,
                            s.step.scratch, tasks))
        return tasks.ran_all_tasks() ? step_result::out_of_range : step_result::bad_executor;
    done(step_stage::update_boxes);
    publish(s, moved, warm, h);  // results           -> bodies and contacts
    if constexpr (Plan::sleeps) {
        commit_woken(s);           // bodies            -> who is awake for good
        wake_ahead(s, h);          // kinematic bodies  -> who is woken before they come
        sleep_update<Plan>(s, h);  // bodies, contacts  -> who falls asleep
    }
    done(step_stage::finish);
    return step_result::done;
}

}  // namespace detail

PHYSICS_HPP_END
