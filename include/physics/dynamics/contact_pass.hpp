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

/// Body velocities at the start of a substep, before contact impulses. What contacts changed since is applied again at
/// the start of the next substep: warm starting by one pass over bodies instead of one over contacts.
template <class S, int D, bool Rotates>
class substep_start {
    using twist = twist_of<S, D, Rotates>;

public:
    substep_start(solver_bodies<S, D, Rotates> bodies, arena& scratch)
        : bodies_(bodies), start_velocities_(scratch.template allocate<twist>(bodies.count)) {
        for (std::uint32_t k = 0; k < bodies.count; ++k) new (start_velocities_ + k) twist(bodies[k].velocity);
    }
    twist* velocities() { return start_velocities_; }

    /// Lets velocities advance, and gives bodies what they have got since the last substep began.
    template <class Motion>
    void integrate_velocities(Motion& motion, S h) {
        // In one go where that can be: bodies are many.
        if constexpr (requires { motion.integrate_velocities(h, start_velocities_); }) {
            motion.integrate_velocities(h, start_velocities_);
        } else {
            swap_start_and_change();
            motion.integrate_velocities(h);
            for (std::uint32_t k = 0; k < bodies_.static_body(); ++k) {
                const twist before = bodies_[k].velocity;
                bodies_[k].velocity = before + start_velocities_[k];
                start_velocities_[k] = before;
            }
        }
    }
    /// Lets poses advance. What bodies change their spin by as they turn no contact gave them.
    template <class Motion>
    void integrate_positions(Motion& motion, S h) {
        if constexpr (std::is_const_v<pose_velocity<S, D, Rotates>>) {
            motion.integrate_positions(h);
        } else if constexpr (requires { motion.integrate_positions(h, start_velocities_); }) {
            motion.integrate_positions(h, start_velocities_);
        } else {
            swap_start_and_change();
            motion.integrate_positions(h);
            swap_start_and_change();
        }
    }

private:
    /// Swaps start velocities and velocity changes by contacts (v - start).
    void swap_start_and_change() {
        for (std::uint32_t k = 0; k < bodies_.static_body(); ++k)
            start_velocities_[k] = bodies_[k].velocity - start_velocities_[k];
    }

    solver_bodies<S, D, Rotates> bodies_;
    twist* start_velocities_;
};

/// How a round over the contacts goes.
template <class S, int D, bool Rotates = true>
struct contact_pass {
    /// 1 / s: gaps may close within a substep.
    S inverse_step;
    softness<S> spring;
    /// At most as fast are overlaps pushed apart (m/s).
    S max_depenetration_speed;
    /// Contacts whose middle approaches faster than this (m/s) start the next substep with what they held before: what
    /// stopped them is no lasting load. All points alike: a pile that lost the load of single corners would lean.
    S impact_speed;
    /// Approaches slower than this do not bounce (m/s), and the length of a substep (s).
    S bounce_slop, substep;
    /// Whether overlaps are pushed apart at all.
    bool use_bias;
    /// Whether loads that last are over-relaxed: in rounds without springs, but for the step's last one, which leaves
    /// the velocities that users see.
    bool over_relaxes;
    /// See substep_start.
    twist_of<S, D, Rotates>* start_velocity;
    /// From the beginning of the step to the middle of the substep (s): of both its rounds, so that friction which
    /// lasts gives the same in each.
    S elapsed{};
};

/// What contacts are written with.
template <class S, int D, class Features>
struct prepare_input {
    /// Which part of the step's impulses a substep begins with, and the length of the step (s).
    S share, step;
    /// Surfaces that have overlapped by more do not bounce (m).
    S overlap{};
    /// Of each body what drives it (m/s^2); null if that is not known.
    const vec<S, D>* accelerations = nullptr;
    [[no_unique_address]] combined_material<S, Features> surfaces{};

    /// How fast a contact's bodies are drawn together.
    [[nodiscard]] S closing(const contact<S, D, Features>& c, const body_pair& bodies) const {
        if (accelerations == nullptr) return S(0);
        return dot(c.normal, accelerations[bodies.a]) - dot(c.normal, accelerations[bodies.b]);
    }
};

}  // namespace detail

PHYSICS_HPP_END
