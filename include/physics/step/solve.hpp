// The solver of a step: islands in batches, solved one by one or side by side.
#pragma once

#include "physics/step/integrate.hpp"
#include "physics/step/step_data.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Where the bodies of all batches are while they are solved.
template <class S, int D, bool Rotates>
moved_bodies<S, D, Rotates> place_bodies(const batches& graph, arena& scratch) {
    return {scratch.template allocate<solver_body<S, D, Rotates>>(graph.slots),
            scratch.template allocate<moving_body<S, D, Rotates>>(graph.slots), graph.slot_of};
}

template <class Plan>
class batch_solver {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;
    using contact = typename Plan::contact;
    using combined_material = detail::combined_material<S, typename Plan::features>;

public:
    batch_solver(const batches& graph, const solve_input<Plan>& in, buffer<contact>& contacts,
                 const combined_material& material, step_joints_of<Plan>& joints,
                 const moved_bodies<S, D, Plan::rotates>& moved)
        : graph_(graph), in_(in), contacts_(contacts), material_(material), joints_(joints), moved_(moved) {}

    /// Large islands one by one on all workers, the others in parallel. False on overflow.
    bool run(per_worker<arena>& scratch_of, arena& scratch, task_runner& tasks) const {
        bool* solved = scratch.template allocate<bool>(graph_.count);
        for (std::uint32_t k = 0; k < graph_.count; ++k) solved[k] = false;
        const auto is_large = [&](std::uint32_t k) {
            return !tasks.is_serial() && graph_.first[k].weight() > large_factor * graph_builder::target_weight;
        };
        task_runner alone;
        for (std::uint32_t k = 0; k < graph_.count; ++k) {
            if (!is_large(k)) continue;
            for (std::uint32_t worker = 1; worker < tasks.workers(); ++worker) scratch_of[worker].reset();
            solved[k] = solve(graph_.first[k], scratch_of[0], tasks);
        }
        tasks.parallel_tasks(graph_.count, [&](std::uint32_t k, std::uint32_t worker) {
            if (!is_large(k)) solved[k] = solve(graph_.first[k], scratch_of[worker], alone);
        });
        for (std::uint32_t k = 0; k < graph_.count; ++k)
            if (!solved[k]) return false;
        return true;
    }

private:
    bool solve(const batch& one, arena& scratch, task_runner& tasks) const {
        scratch.reset();
        batch_integrator<Plan> motion(in_, graph_, one, moved_, scratch, tasks);
        const auto all = constraints_of(one);
        const auto& with = in_.settings.solver;
        if constexpr (is_fixed<S>)
            if (!starts_in_range(all, one, motion.bodies())) return false;
        if constexpr (requires { Plan::solver::solve(motion.bodies(), all, with, in_.h, scratch, motion, tasks); })
            Plan::solver::solve(motion.bodies(), all, with, in_.h, scratch, motion, tasks);
        else Plan::solver::solve(motion.bodies(), all, with, in_.h, scratch, motion);
        if (!motion.finish()) return false;
        if constexpr (is_fixed<S>) return ends_in_range(all, motion.bodies());
        else return true;
    }
    /// In fixed point, which wraps: whether the bodies of each contact and joint meet with momenta in range,
    template <class Constraints, class Bodies>
    bool starts_in_range(const Constraints& all, const batch& one, const Bodies& bodies) const {
        for (std::uint32_t i = 0; i < one.end - one.edges; ++i) {
            const body_pair& pair = graph_.ends[one.edges + i];
            const auto &a = bodies[pair.a], &b = bodies[pair.b];
            if (!(i < all.size() ? is_momentum_in_range(all[i], a, b) : is_momentum_in_range(a, b))) return false;
        }
        return true;
    }
    /// and whether they gave impulses in range.
    template <class Constraints, class Bodies>
    bool ends_in_range(const Constraints& all, const Bodies& bodies) const {
        for (std::uint32_t i = 0; i < all.size(); ++i)
            if (!is_impulse_in_range(all[i], bodies[all.bodies(i).a], bodies[all.bodies(i).b])) return false;
        if constexpr (Plan::has_joints) return are_impulses_in_range(all);
        else return true;
    }
    /// A batch's edges are in ascending order, contacts first.
    auto constraints_of(const batch& one) const {
        const std::uint32_t* const order = graph_.order + one.edges;
        const body_pair* const ends = graph_.ends + one.edges;
        const std::uint32_t count = one.end - one.edges;
        std::uint32_t contact_count = count;
        if constexpr (Plan::has_joints)
            while (contact_count > 0 && order[contact_count - 1] >= contacts_.size()) --contact_count;
        const contact_constraints<S, D, typename Plan::features> contacts(contacts_.begin(), order, ends, contact_count,
                                                                          material_);
        if constexpr (Plan::has_joints) return joints_.add_to(contacts, order, ends, count);
        else return contacts;
    }

    /// An island that is so many times as large as a batch is wide enough for several workers.
    static constexpr std::uint32_t large_factor = 4;

    const batches& graph_;
    const solve_input<Plan>& in_;
    buffer<contact>& contacts_;
    const combined_material& material_;
    step_joints_of<Plan>& joints_;
    const moved_bodies<S, D, Plan::rotates>& moved_;
};

/// Bodies, contacts, joints and their batches -> velocities, poses and impulses. False if a number leaves its range.
template <class Plan, class Material, class Moved>
bool solve(const batches& graph, const solve_input<Plan>& in, buffer<typename Plan::contact>& contacts,
           const Material& material, step_joints_of<Plan>& joints, const Moved& moved, per_worker<arena>& scratch_of,
           arena& scratch, task_runner& tasks) {
    return batch_solver<Plan>(graph, in, contacts, material, joints, moved).run(scratch_of, scratch, tasks);
}

}  // namespace detail

PHYSICS_HPP_END
