// How the soft solver goes over its contacts.
#pragma once

#include "physics/base/arena.hpp"
#include "physics/dynamics/body.hpp"
#include "physics/dynamics/contact.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A damped spring as a constraint: which share of its error is removed a second, and what is left of impulses. Source:
/// Catto, Soft constraints (GDC 2011).
template <class S>
struct softness {
    S rate{}, mass_scale = S(1), impulse_scale{};

    /// Of a frequency (Hz), a damping ratio and a time step (s).
    static softness of(S frequency, S damping_ratio, S h) {
        const S omega = S(6.283185307179586) * frequency;
        const S a = S(2) * damping_ratio + h * omega, b = h * omega * a, c = S(1) / (S(1) + b);
        return {omega / a, b * c, c};
    }
};

/// The velocities with which bodies began a substep, before contacts gave them anything. What bodies have got since,
/// they get again as the next one begins: a round over the bodies instead of one over the contacts.
template <class S, int D, bool Turns>
class substep_start {
    using twist = twist_of<S, D, Turns>;

public:
    substep_start(solver_bodies<S, D, Turns> bodies, arena& scratch)
        : bodies_(bodies), begun_(scratch.template take<twist>(bodies.count)) {
        for (std::uint32_t k = 0; k < bodies.count; ++k) new (begun_ + k) twist(bodies[k].velocity);
    }
    twist* velocities() { return begun_; }

    /// Lets velocities advance, and gives bodies what they have got since the last substep began.
    template <class Motion>
    void advance_velocities(Motion& motion, S h) {
        // In one go where that can be: bodies are many.
        if constexpr (requires { motion.advance_velocities(h, begun_); }) {
            motion.advance_velocities(h, begun_);
        } else {
            turn_over();
            motion.advance_velocities(h);
            for (std::uint32_t k = 0; k < bodies_.nobody(); ++k) {
                const twist before = bodies_[k].velocity;
                bodies_[k].velocity = before + begun_[k];
                begun_[k] = before;
            }
        }
    }
    /// Lets poses advance. What bodies change their spin by as they turn no contact gave them.
    template <class Motion>
    void advance_poses(Motion& motion, S h) {
        if constexpr (std::is_const_v<turning_velocity<S, D, Turns>>) {
            motion.advance_poses(h);
        } else if constexpr (requires { motion.advance_poses(h, begun_); }) {
            motion.advance_poses(h, begun_);
        } else {
            turn_over();
            motion.advance_poses(h);
            turn_over();
        }
    }

private:
    /// Notes what bodies have got since for the velocities with which they began, and the other way round.
    void turn_over() {
        for (std::uint32_t k = 0; k < bodies_.nobody(); ++k) begun_[k] = bodies_[k].velocity - begun_[k];
    }

    solver_bodies<S, D, Turns> bodies_;
    twist* begun_;
};

/// How a round over the contacts goes.
template <class S, int D, bool Turns = true>
struct soft_round {
    /// 1 / s: gaps may close within a substep.
    S inverse_step;
    softness<S> spring;
    /// At most as fast are overlaps pushed apart (m/s).
    S push_speed;
    /// Contacts whose middle approaches faster than this (m/s) start the next substep with what they held before: what
    /// stopped them is no lasting load. All points alike: a pile that lost the load of single corners would lean.
    S impact_speed;
    /// Approaches slower than this do not bounce (m/s), and the length of a substep (s).
    S bounce_slop, substep;
    /// Whether overlaps are pushed apart at all.
    bool pushes;
    /// Whether loads that last are over-relaxed: in rounds without springs, but for the step's last one, which leaves
    /// the velocities that users see.
    bool over_relaxes;
    /// See substep_start.
    twist_of<S, D, Turns>* begun;
};

/// What contacts are written with.
template <class S, int D, class Features>
struct soft_start {
    /// Which part of the step's impulses a substep begins with.
    S share;
    /// Surfaces that have overlapped by more do not bounce (m).
    S overlap{};
    /// Of each body what drives it (m/s^2); null if that is not known.
    const vec<S, D>* accelerations = nullptr;
    [[no_unique_address]] mixture<S, Features> surfaces{};

    /// How fast a contact's bodies are drawn together.
    [[nodiscard]] S closing(const contact<S, D, Features>& c) const {
        if (accelerations == nullptr) return S(0);
        return dot(c.normal, accelerations[c.body_a]) - dot(c.normal, accelerations[c.body_b]);
    }
};

}  // namespace detail

PHYSICS_HPP_END
