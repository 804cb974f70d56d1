// Bodies as they move through a step: copies in tight arrays, which become the world's when the step has succeeded.
#pragma once

#include "physics/world/edit.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The number of each body among those that move.
template <class Plan>
void find_numbers(state<Plan>& s) {
    s.mover_of.clear();
    s.mover_of.resize(s.bodies.slots(), s.movers.size());
    for (std::uint32_t k = 0; k < s.movers.size(); ++k) s.mover_of[s.movers[k]] = k;
}
/// Finds which bodies move, where that has changed.
template <class Plan>
void number_movers(state<Plan>& s) {
    if (!s.movers_changed) return;
    s.movers.clear();
    s.bodies.each([&](std::uint32_t i, const auto& b) {
        if (b.type != body_type::static_body && !s.is_asleep(i)) s.movers.push(i);
    });
    find_numbers(s);
}

/// How the solver moves the world: it asks for velocities and poses to advance, once or in substeps. Nothing of the
/// world changes before place_shapes.
template <class Plan>
class motion {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;
    using integrator = typename Plan::integrator;

public:
    /// What the solver sees of the bodies that move; the last one is nobody.
    solver_bodies<S, D> bodies;

    motion(state<Plan>& s, S h)
        : bodies{s.scratch.template take<solver_body<S, D>>(s.movers.size() + 1), s.movers.size() + 1},
          state_(s),
          moving_(s.scratch.template take<moving_body<S, D>>(s.movers.size())),
          step_(h) {
        for (std::uint32_t k = 0; k < s.movers.size(); ++k) gather(k);
        new (&bodies[s.movers.size()]) solver_body<S, D>{};
        find_free();
    }

    void advance_velocities(S h) {
        if (free_count_ > 0) thrust(step_ / h);
        for (std::uint32_t k = 0; k < state_.movers.size(); ++k)
            if (bodies[k].inverse_mass > inverse_of<S>(0))
                integrator::advance_velocity(bodies[k].velocity, moving_[k], h);
        if (free_count_ > 0) thrust(S(0));
    }
    void advance_poses(S h) {
        for (std::uint32_t k = 0; k < state_.movers.size(); ++k)
            integrator::advance_pose(moving_[k], bodies[k].velocity, h);
    }

    /// Where bodies have come.
    [[nodiscard]] moving_body<S, D>* moved() { return moving_; }
    /// Whether all that moved is where numbers reach.
    [[nodiscard]] bool is_finite() const {
        for (std::uint32_t k = 0; k < state_.movers.size(); ++k)
            if (!physics::is_finite(moving_[k].center) || !physics::is_finite(moving_[k].rotation) ||
                !physics::is_finite(bodies[k].velocity.linear) || !physics::is_finite(bodies[k].velocity.angular))
                return false;
        return true;
    }

    /// Puts shapes where their bodies are now, and tells the broadphase, and where they are heading; bodies with a
    /// target are there, to the bit. False, and all shapes where they were, if a box is beyond the scalar's range.
    bool place_shapes() {
        bool fit = true;
        for (std::uint32_t k = 0; k < state_.movers.size() && fit; ++k) {
            const std::uint32_t i = state_.movers[k];
            const body<S, D>& b = state_.bodies[i];
            const transform<S, D> pose = pose_of(k);
            const vec<S, D> center = b.has_target ? pose * b.mass.center : moving_[k].center;
            const vec<S, D> way = bodies[k].velocity.linear * step_;
            each_shape(state_, i, [&](std::uint32_t n, auto& shape) {
                locate(shape, pose, center);
                const auto box = needed_box(state_, shape);
                if (fit = fit && is_box(box); fit) state_.broadphase.move(n, box, way);
            });
        }
        if (!fit)
            for (const std::uint32_t i : state_.movers) refresh_boxes(state_, i);
        else update_broadphase(state_);
        return fit;
    }

    /// Stores what the step found: poses, velocities, contacts with their impulses. Forces act for one step, and bodies
    /// that had a target stand still.
    void finish() {
        if (std::exchange(state_.movers_changed, false))
            state_.bodies.each([&](std::uint32_t i, const auto& b) {
                if (!state_.is_asleep(i)) state_.contact_starts[i] = {b.center, b.rotation};
            });
        for (std::uint32_t k = 0; k < state_.movers.size(); ++k) {
            const std::uint32_t i = state_.movers[k];
            body<S, D>& b = state_.bodies[i];
            state_.contact_starts[i] = {b.center, b.rotation};
            b.center = moving_[k].center;
            b.rotation = moving_[k].rotation;
            b.velocity = bodies[k].velocity;
            b.force = {};
            b.torque = {};
            if (!b.has_target) continue;
            b.set_pose(b.target);
            b.velocity = {};
            b.has_target = false;
        }
        state_.contacts.swap(state_.found);
        state_.memories.swap(state_.found_memories);
        ++state_.steps;
        if constexpr (Plan::sleeps) {
            wake_disturbed(state_);
            for (const std::uint32_t i : state_.movers) rouse_ahead(i);
            falling_asleep<Plan>(state_, step_);
        }
    }

private:
    /// Wakes what a kinematic body is going to run into.
    void rouse_ahead(std::uint32_t i) {
        const body<S, D>& b = state_.bodies[i];
        if (b.is_dynamic() || b.velocity == twist<S, D>{}) return;
        const rotation<S, D> turn = turned(b.rotation, b.velocity.angular * step_);
        rouse_near(state_, i, {b.center + b.velocity.linear * step_ - turn * b.mass.center, turn});
    }
    void gather(std::uint32_t k) {
        const body<S, D>& b = state_.bodies[state_.movers[k]];
        solver_body<S, D>& seen = *new (&bodies[k])
            solver_body<S, D>{b.velocity, {}, b.inverse_mass, in_world(b.inverse_inertia, b.rotation)};
        moving_body<S, D>& m = *new (moving_ + k) moving_body<S, D>{b.center, b.rotation, {}};
        if (b.has_target) {
            seen.velocity.linear = (b.target * b.mass.center - b.center) / step_;
            seen.velocity.angular = rotation_vector(b.target.rotation * inverse(b.rotation)) / step_;
        }
        if (!b.is_dynamic()) return;
        m.acceleration = state_.settings.gravity * b.gravity_scale;
        m.linear_damping = b.linear_damping;
        m.angular_damping = b.angular_damping;
        if (b.is_gyroscopic) m.top = &b;
        if (!b.is_pushed()) return;
        ++free_count_;
        add_force(k, S(1));
    }
    [[nodiscard]] transform<S, D> pose_of(std::uint32_t k) const {
        const body<S, D>& b = state_.bodies[state_.movers[k]];
        if (b.has_target) return b.target;
        return {moving_[k].center - moving_[k].rotation * b.mass.center, moving_[k].rotation};
    }
    /// Lets `share` of the force on a body act.
    void add_force(std::uint32_t k, S share) {
        const body<S, D>& b = state_.bodies[state_.movers[k]];
        for (int i = 0; i < D; ++i) moving_[k].acceleration[i] += mul<S>(b.inverse_mass, b.force[i] * share);
        moving_[k].angular_acceleration += times(bodies[k].inverse_inertia, b.torque * share);
    }
    /// Bodies that are pushed and touch nothing.
    void find_free() {
        if (free_count_ == 0) return;
        auto* touches = state_.scratch.template take<bool>(bodies.count);
        for (std::uint32_t k = 0; k < bodies.count; ++k) touches[k] = false;
        for (const auto& c : state_.found) touches[c.body_a] = touches[c.body_b] = true;
        free_ = state_.scratch.template take<std::uint32_t>(free_count_);
        free_count_ = 0;
        for (std::uint32_t k = 0; k < state_.movers.size(); ++k)
            if (!touches[k] && state_.bodies[state_.movers[k]].is_pushed()) free_[free_count_++] = k;
    }
    /// Forces on them act at once, as the solver's first part of the step begins: spread over the parts, springs that
    /// users make of forces would gain energy.
    void thrust(S share) {
        for (std::uint32_t n = 0; n < free_count_; ++n) {
            const std::uint32_t k = free_[n];
            moving_[k].acceleration = state_.settings.gravity * state_.bodies[state_.movers[k]].gravity_scale;
            moving_[k].angular_acceleration = {};
            if (share > S(0)) add_force(k, share);
        }
        if (!(share > S(0))) free_count_ = 0;
    }

    state<Plan>& state_;
    moving_body<S, D>* moving_;
    S step_;
    std::uint32_t* free_ = nullptr;
    std::uint32_t free_count_ = 0;
};

}  // namespace detail

PHYSICS_HPP_END
