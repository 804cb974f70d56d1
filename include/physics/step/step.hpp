// One step of a world: the page to read first.
#pragma once

#include "physics/step/collide.hpp"
#include "physics/step/edges.hpp"
#include "physics/step/seams.hpp"
#include "physics/step/solve.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Broadphase: pairs of shapes whose boxes overlap, of two bodies of which one at least can be pushed: the filters that
/// shapes were inserted with say so.
template <class Plan>
const buffer<proxy_pair>& find_pairs(state<Plan>& s) {
    const auto all = [](std::uint32_t, std::uint32_t) { return true; };
    if constexpr (requires { s.broadphase.pairs(all, s.step.scratch); }) return s.broadphase.pairs(all, s.step.scratch);
    else return s.broadphase.pairs(all);
}

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
    if (!combine_common_materials(s)) return step_result::bad_mixing_rule;
    watch_fast_bodies(s, h);            // velocities        -> boxes of bodies that look ahead
    list_awake(s);                      // bodies            -> which of them move
    const auto& pairs = find_pairs(s);  // boxes             -> pairs, in order
    done(step_stage::find_pairs);
    // Pairs, poses, last step's contacts -> contacts with feature ids and warm impulses.
    const collide_result found = find_contacts(s, pairs, s.contacts, s.step_lengths, h, tasks);
    if (!found.materials_valid) return step_result::bad_mixing_rule;
    if constexpr (Plan::sleeps)
        // Contacts with sleeping bodies -> contacts of the islands that they wake.
        if (list_woken(s, found.near_sleeper, h) && !find_contacts_of_woken(s, h, tasks))
            return step_result::bad_mixing_rule;
    const seam_contacts seams(s, h);  // contacts          -> without those at flush edges
    list_edges(s, tasks);             // contacts          -> which bodies they hold together
    done(step_stage::find_contacts);
    step_solver<Plan> solver(s, h, tasks);  // edges             -> islands, in batches
    done(step_stage::make_batches);
    const bool solved = solver.solve(tasks);  // bodies, contacts  -> velocities, poses
    done(step_stage::solve);
    if (!tasks.ran_all_tasks()) return step_result::bad_executor;
    if (!solved) return step_result::out_of_range;
    sweep_fast_bodies(s, solver.moved(), h);  // poses             -> poses short of what stops bodies
    // Poses -> boxes of what has moved.
    if (!solver.update_boxes(tasks))
        return tasks.ran_all_tasks() ? step_result::out_of_range : step_result::bad_executor;
    done(step_stage::update_boxes);
    solver.finish();  // results           -> bodies and contacts
    done(step_stage::finish);
    return step_result::done;
}

}  // namespace detail

PHYSICS_HPP_END
