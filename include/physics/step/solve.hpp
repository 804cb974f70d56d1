// How a step moves the world: islands in batches, solved one by one or in parallel, and what becomes of it.
#pragma once

#include "physics/step/integrate.hpp"
#include "physics/step/warm_impulses.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// How a step moves the world, batch by batch. Nothing of the world changes before update_boxes.
template <class Plan>
class step_solver {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;
    static constexpr bool rotates = Plan::rotates;

public:
    step_solver(state<Plan>& s, S h, task_runner& tasks)
        : state_(s), batches_(batches_of(s, tasks)), step_(h), warm_(s, h) {
        moved_ = {s.step.scratch.template allocate<solver_body<S, D, rotates>>(batches_.slots),
                  s.step.scratch.template allocate<moving_body<S, D, rotates>>(batches_.slots), batches_.slot_of};
    }

    /// Solves all batches: large islands one by one on all workers, the others in parallel. False on overflow.
    bool solve(task_runner& tasks) {
        warm_.before_solve();
        bool* solved = state_.step.scratch.template allocate<bool>(batches_.count);
        for (std::uint32_t k = 0; k < batches_.count; ++k) solved[k] = false;
        const auto is_large = [&](std::uint32_t k) {
            return !tasks.is_serial() && batches_.first[k].weight() > large_factor * graph_builder::target_weight;
        };
        task_runner alone;
        for (std::uint32_t k = 0; k < batches_.count; ++k)
            if (is_large(k)) solved[k] = solve(batches_.first[k], state_.step.batch_scratch[0], tasks);
        tasks.parallel_tasks(batches_.count, [&](std::uint32_t k, std::uint32_t worker) {
            if (!is_large(k)) solved[k] = solve(batches_.first[k], state_.step.batch_scratch[worker], alone);
        });
        for (std::uint32_t k = 0; k < batches_.count; ++k)
            if (!solved[k]) return false;
        return true;
    }
    /// Where bodies have come.
    [[nodiscard]] moved_bodies<S, D, rotates> moved() const { return moved_; }

    /// Puts shapes where their bodies are now, and tells the broadphase, and where they are heading; bodies with a
    /// target are there, to the bit. False, and all shapes where they were, if a box is beyond the scalar's range, or
    /// the executor fails.
    bool update_boxes(task_runner& tasks) {
        const std::uint32_t count = state_.awake.size();
        bool fit = true;
        if (tasks.is_serial()) {
            for (std::uint32_t k = 0; k < count && fit; ++k)
                update_shape_poses(k, [&](std::uint32_t n, const aabb<S, D>& box) {
                    if (fit = fit && is_box(box); fit) move_box(k, n, box);
                });
        } else {
            // Boxes that are left move one by one: what the broadphase makes of them may depend on their order.
            enum : std::uint8_t { stays = 0, leaves = 1, lost = 2 };
            auto* box_changes = state_.step.scratch.template allocate<std::uint8_t>(count);
            tasks.parallel_for(count, 128, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
                for (std::uint32_t k = first; k < end; ++k) {
                    box_changes[k] = stays;
                    update_shape_poses(k, [&](std::uint32_t n, const aabb<S, D>& box) {
                        if constexpr (requires { state_.broadphase.holds(n, box); })
                            if (state_.broadphase.holds(n, box)) return;
                        box_changes[k] = !is_box(box) || box_changes[k] == lost ? lost : leaves;
                    });
                }
            });
            fit = tasks.ran_all_tasks();
            for (std::uint32_t k = 0; k < count; ++k) fit = fit && box_changes[k] != lost;
            for (std::uint32_t k = 0; k < count && fit; ++k)
                if (box_changes[k] == leaves)
                    each_shape(state_, state_.awake[k], [&](std::uint32_t n, const auto& shape) {
                        move_box(k, n, query_bounds(state_, shape));
                    });
        }
        if (!fit)
            for (const std::uint32_t i : state_.awake) refresh_boxes(state_, i);
        else update_broadphase(state_);
        return fit;
    }

    /// Stores what the step found: poses, velocities, contacts with their impulses. Forces act for one step, and so do
    /// targets.
    void finish() {
        if (std::exchange(state_.awake_changed, false))
            state_.bodies.each([&](std::uint32_t i, const auto& b) {
                if (!state_.is_asleep(i)) state_.contact_starts[i] = {b.center, b.rotation};
            });
        for (std::uint32_t k = 0; k < state_.awake.size(); ++k) {
            const std::uint32_t i = state_.awake[k];
            auto& b = state_.bodies[i];
            state_.contact_starts[i] = {b.center, b.rotation};
            b.center = moved_[k].center;
            if constexpr (rotates) b.rotation = moved_[k].rotation;
            b.velocity = moved_.velocity(k);
            b.force = {};
            b.torque = {};
            b.at_target = b.has_target;
            if (!b.has_target) continue;
            b.set_pose(b.target);
            b.has_target = false;
        }
        warm_.after_solve();
        state_.contacts.swap(state_.step.new_contacts);
        state_.surfaces = state_.step.new_material;
        if constexpr (Plan::remembers) state_.step.pair_cache_changes.finish(state_.memories);
        ++state_.steps;
        state_.step_lengths = {warm_.next_usual_step(), step_};
        if constexpr (Plan::sleeps) {
            commit_woken(state_);
            for (const std::uint32_t i : state_.awake) wake_ahead(i);
            sleep_update<Plan>(state_, step_);
        }
    }

private:
    /// Puts the shapes of a body where it is now, and calls f(shape's number, box) for each.
    template <class F>
    void update_shape_poses(std::uint32_t k, F&& f) {
        const std::uint32_t i = state_.awake[k];
        const auto& b = state_.bodies[i];
        const transform<S, D> pose = pose_of(k);
        const vec<S, D> center = b.has_target ? pose * b.mass.center : moved_[k].center;
        each_shape(state_, i, [&](std::uint32_t n, auto& shape) {
            update_pose(shape, pose, center);
            f(n, query_bounds(state_, shape));
        });
    }
    void move_box(std::uint32_t k, std::uint32_t n, const aabb<S, D>& box) {
        state_.broadphase.move(n, box, moved_.velocity(k).linear * step_);
    }
    /// Wakes what a kinematic body is going to run into.
    void wake_ahead(std::uint32_t i) {
        const auto& b = state_.bodies[i];
        if (b.is_dynamic() || b.at_target || b.velocity == twist_of<S, D, rotates>{}) return;
        rotation<S, D> turn = b.rotation;
        if constexpr (rotates) turn = turned(turn, b.velocity.angular * step_);
        wake_near(state_, i, {b.center + b.velocity.linear * step_ - turn * b.mass.center, turn});
    }
    static batches batches_of(state<Plan>& s, task_runner& tasks) {
        // On one thread, what goes into the second cache is not worth taking apart.
        const std::uint32_t batch_limit = graph_builder::target_weight * (tasks.is_serial() ? (D == 2 ? 8 : 2) : 1);

        const std::uint32_t count = s.awake.size();
        bool* has_external_force = s.step.scratch.template allocate<bool>(count + 1);
        for (std::uint32_t k = 0; k < count; ++k)
            has_external_force[k] = s.bodies[s.awake[k]].inverse_mass > inverse_of<S>(0);
        has_external_force[count] = false;
        return graph_builder(s.step.edges, s.awake_index.begin(), has_external_force, count, s.step.scratch,
                             batch_limit, &tasks)
            .result();
    }
    bool solve(const batch& one, arena& scratch, task_runner& tasks) {
        scratch.reset();
        for (std::uint32_t k = 1; k < tasks.workers(); ++k) state_.step.batch_scratch[k].reset();
        batch_integrator<Plan> moving(state_, batches_, one, moved_, step_, scratch, tasks);
        const contact_constraints<S, D, typename Plan::features> contacts(
            state_.step.new_contacts.begin(), batches_.order + one.edges, batches_.ends + one.edges,
            one.end - one.edges, state_.step.new_material);
        const auto& with = state_.settings.solver;
        if constexpr (requires { Plan::solver::solve(moving.bodies(), contacts, with, step_, scratch, moving, tasks); })
            Plan::solver::solve(moving.bodies(), contacts, with, step_, scratch, moving, tasks);
        else Plan::solver::solve(moving.bodies(), contacts, with, step_, scratch, moving);
        return moving.finish();
    }
    [[nodiscard]] transform<S, D> pose_of(std::uint32_t k) const {
        const auto& b = state_.bodies[state_.awake[k]];
        if (b.has_target) return b.target;
        const rotation<S, D>& turn = rotation_after(moved_[k], b);
        return {moved_[k].center - turn * b.mass.center, turn};
    }

    /// An island that is so many times as large as a batch is wide enough for several workers.
    static constexpr std::uint32_t large_factor = 4;

    state<Plan>& state_;
    batches batches_;
    moved_bodies<S, D, rotates> moved_;
    S step_;
    warm_impulses<Plan> warm_;
};

}  // namespace detail

PHYSICS_HPP_END
