// Bodies as they move through a step: copies in tight arrays, which become the world's when the step has succeeded.
#pragma once

#include "physics/dynamics/graph.hpp"
#include "physics/step/awake.hpp"
#include "physics/step/overflow.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Whether an integrator advances poses in lanes: not one that derives from such, and may have poses of its own.
template <class Integrator, bool Rotates>
concept advances_in_lanes = requires {
    requires std::same_as<typename Integrator::owner_of_lanes, Integrator>;
    requires Integrator::template lanes<Rotates>::serves;
};
template <class Integrator, bool Rotates>
struct pose_lanes_of {
    struct type {};
};
template <class Integrator, bool Rotates>
    requires advances_in_lanes<Integrator, Rotates>
struct pose_lanes_of<Integrator, Rotates> {
    using type = typename Integrator::template lanes<Rotates>;
};

/// What the solver reads of a world's bodies.
template <class Plan>
struct solve_input {
    const pool<typename Plan::body>& bodies;
    const awake_list& awake;
    const typename Plan::settings& settings;
    /// Of this step, and how long steps usually take (s).
    typename Plan::scalar h, usual;
};

/// How the solver moves a batch: it asks for velocities and poses to advance, once or in substeps.
template <class Plan>
class batch_integrator {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;
    static constexpr bool rotates = Plan::rotates;
    using integrator = typename Plan::integrator;
    static constexpr bool in_lanes = advances_in_lanes<integrator, rotates>;
    using lanes = typename pose_lanes_of<integrator, rotates>::type;

public:
    /// Copies the bodies of a part into their slots.
    batch_integrator(const solve_input<Plan>& in, const batches& all, const batch& one,
                     moved_bodies<S, D, rotates> slots, arena& scratch, task_runner& tasks)
        : in_(in),
          members_(all.body_at + one.bodies),
          bodies_(slots.solved + one.bodies),
          moving_(slots.moved + one.bodies),
          count_(one.static_slot - one.bodies),
          step_(in.h),
          tasks_(tasks),
          counts_(scratch.template allocate<std::uint32_t>(tasks.workers())) {
        free_count_ = count_of([&](std::uint32_t k) { return gather(k); });
        if constexpr (is_fixed<S>)
            starts_in_range_ = count_of([&](std::uint32_t k) {
                                   return !stays_in_range(in.settings.gravity, member(k), bodies_[k], in.h,
                                                          substeps_of(in.settings.solver));
                               }) == 0;
        for (std::uint32_t k = count_; k < one.static_slot - one.bodies + 2; ++k)
            new (bodies_ + k) solver_body<S, D, rotates>{};
        if (free_count_ > 0) find_free_bodies(all, one, scratch);
        if constexpr (in_lanes) lanes_ = new (scratch.template allocate<lanes>(1)) lanes(bodies(), moving_, scratch);
    }

    /// The bodies as the solver sees them; the last two are the static body and a dummy.
    [[nodiscard]] solver_bodies<S, D, rotates> bodies() const { return {bodies_, count_ + 2}; }

    /// By gravity and forces (m/s^2); nothing drives what is not dynamic.
    [[nodiscard]] const vec<S, D>& acceleration(std::uint32_t k) const { return moving_[k].acceleration; }

    /// How long steps usually take (s), or this one, if that is longer: contacts are no stiffer in a shorter one.
    [[nodiscard]] S usual_step() const { return max(step_, in_.usual); }

    void integrate_velocities(S h) {
        if (free_count_ > 0) set_free_forces(step_ / h);
        each([&](std::uint32_t k) { integrate_velocity(k, h); });
        if (free_count_ > 0) set_free_forces(S(0));
    }
    /// The same; also reapplies what contacts gave in the last substep, v - start_velocity, and sets start_velocity
    /// to the velocity before that.
    void integrate_velocities(S h, twist_of<S, D, rotates>* start_velocity) {
        if (free_count_ > 0) set_free_forces(step_ / h);
        each([&](std::uint32_t k) {
            auto& v = bodies_[k].velocity;
            const auto got = v - start_velocity[k];
            integrate_velocity(k, h);
            start_velocity[k] = v;
            v = v + got;
        });
        if (free_count_ > 0) set_free_forces(S(0));
    }
    void integrate_positions(S h) { integrate_positions(h, nullptr); }
    /// The same; what velocities change by as bodies turn, they change in `start_velocity` too.
    void integrate_positions(S h, twist_of<S, D, rotates>* start_velocity) {
        if constexpr (in_lanes) {
            lanes_->advance(h, start_velocity, tasks_);
            return;
        }
        each([&](std::uint32_t k) {
            pose_velocity<S, D, rotates>& v = bodies_[k].velocity;
            const auto before = v;
            integrator::integrate_pose(moving_[k], v, bodies_[k].displacement, h);
            if constexpr (D == 3 && rotates)
                if (start_velocity != nullptr && !(v == before)) start_velocity[k] = start_velocity[k] + (v - before);
        });
    }

    /// Writes how body k is turned, or with a velocity how it will be after h, into a pose that has its displacement.
    template <class Pose>
    void find_rotation(std::uint32_t k, Pose& to, const twist_of<S, D, rotates>* v, S h) const {
        to.is_known = true;
        if constexpr (in_lanes) {
            lanes_->find_rotation(k, to, v, h);
        } else if constexpr (D == 2) {
            to.rotation = turned(moving_[k].rotation, to.displacement.angular);
        } else {
            moving_body<S, D, rotates> moved = moving_[k];
            twist_of<S, D, rotates> velocity = v != nullptr ? *v : twist_of<S, D, rotates>{}, displacement;
            if (v != nullptr) integrator::integrate_pose(moved, velocity, displacement, h);
            to.rotation = moved.rotation;
        }
    }

    /// Ends the step. False if something that moved is where numbers do not reach.
    [[nodiscard]] bool finish() {
        const std::uint32_t lost = count_of([&](std::uint32_t k) {
            if constexpr (in_lanes) lanes_->finish(k, k + 1);
            const auto& by = bodies_[k].displacement;
            moving_[k].center += by.linear;
            if constexpr (D == 2 && rotates)
                if (by.angular != S(0)) moving_[k].rotation = turned(moving_[k].rotation, by.angular);
            return !is_in_range(moving_[k], bodies_[k].velocity);
        });
        return lost == 0 && starts_in_range_;
    }

private:
    /// Calls f(k) for all bodies.
    template <class F>
    void each(F&& f) {
        tasks_.parallel_for(count_, min_per_task, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
            for (std::uint32_t k = first; k < end; ++k) f(k);
        });
    }
    /// For how many of them f(k) is true.
    template <class F>
    std::uint32_t count_of(F&& f) {
        for (std::uint32_t k = 0; k < tasks_.workers(); ++k) counts_[k] = 0;
        tasks_.parallel_for(count_, min_per_task, [&](std::uint32_t first, std::uint32_t end, std::uint32_t worker) {
            std::uint32_t count = 0;
            for (std::uint32_t k = first; k < end; ++k) count += f(k);
            counts_[worker] += count;
        });
        for (std::uint32_t k = 1; k < tasks_.workers(); ++k) counts_[0] += counts_[k];
        return counts_[0];
    }
    void integrate_velocity(std::uint32_t k, S h) {
        if (!(bodies_[k].inverse_mass > inverse_of<S>(0))) return;
        integrator::integrate_velocity(bodies_[k].velocity, moving_[k], h);
        // -0 becomes 0, which no impulse of 0 changes: so the bits are the same whether solvers give it or not.
        bodies_[k].velocity.linear += vec<S, D>{};
        if constexpr (rotates) bodies_[k].velocity.angular += angular<S, D>{};
    }
    [[nodiscard]] const typename Plan::body& member(std::uint32_t k) const {
        return in_.bodies[in_.awake[members_[k]]];
    }
    /// Says whether a force acts on it.
    bool gather(std::uint32_t k) {
        const auto& b = member(k);
        auto& seen = *new (bodies_ + k) solver_body<S, D, rotates>{b.velocity_ahead(step_), {}, b.inverse_mass, {}};
        auto& m = *new (moving_ + k) moving_body<S, D, rotates>{};
        m.center = b.center;
        if constexpr (rotates) {
            seen.inverse_inertia = in_world(b.inverse_inertia, b.rotation);
            m.rotation = b.rotation;
        }
        if (!b.is_dynamic()) return false;
        m.acceleration = in_.settings.gravity * b.gravity_scale;
        m.linear_damping = b.linear_damping;
        if constexpr (rotates) {
            m.angular_damping = b.angular_damping;
            if (b.is_gyroscopic) m.gyroscopic = &b;
        }
        if (!b.has_external_force()) return false;
        add_force(k, S(1));
        return true;
    }
    /// Lets `share` of the force on a body act.
    void add_force(std::uint32_t k, S share) {
        const auto& b = member(k);
        for (int i = 0; i < D; ++i) moving_[k].acceleration[i] += mul<S>(b.inverse_mass, b.force[i] * share);
        if constexpr (rotates) moving_[k].angular_acceleration += times(bodies_[k].inverse_inertia, b.torque * share);
    }
    /// Bodies that are pushed and touch nothing.
    void find_free_bodies(const batches& all, const batch& one, arena& scratch) {
        auto* touches = scratch.template allocate<bool>(count_ + 1);
        for (std::uint32_t k = 0; k <= count_; ++k) touches[k] = false;
        for (std::uint32_t n = one.edges; n < one.end; ++n) touches[all.ends[n].a] = touches[all.ends[n].b] = true;
        free_ = scratch.template allocate<std::uint32_t>(free_count_);
        free_count_ = 0;
        for (std::uint32_t k = 0; k < count_; ++k)
            if (!touches[k] && member(k).has_external_force()) free_[free_count_++] = k;
    }
    /// Free bodies get the whole impulse of a user force in the first substep: spread over substeps, explicit user
    /// springs would gain energy. With it they get that of gravity: else what a force holds up would rest at a speed.
    void set_free_forces(S share) {
        for (std::uint32_t n = 0; n < free_count_; ++n) {
            const std::uint32_t k = free_[n];
            moving_[k].acceleration = in_.settings.gravity * (member(k).gravity_scale * share);
            if constexpr (rotates) moving_[k].angular_acceleration = {};
            if (share > S(0)) add_force(k, share);
        }
        if (!(share > S(0))) free_count_ = 0;
    }

    solve_input<Plan> in_;
    const std::uint32_t* members_;
    solver_body<S, D, rotates>* bodies_;
    moving_body<S, D, rotates>* moving_;
    std::uint32_t count_;
    S step_;
    task_runner& tasks_;
    std::uint32_t* counts_;  ///< What each worker has counted.
    std::uint32_t* free_ = nullptr;
    std::uint32_t free_count_ = 0;
    bool starts_in_range_ = true;
    lanes* lanes_ = nullptr;
    static constexpr std::uint32_t min_per_task = 128;  ///< The smallest number of bodies that makes a task.
};

}  // namespace detail

PHYSICS_HPP_END
