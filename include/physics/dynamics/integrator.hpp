// How velocities and poses advance by a step.
#pragma once

#include "physics/base/stage.hpp"
#include "physics/dynamics/pose_lanes.hpp"

PHYSICS_HPP_BEGIN

/// Semi-implicit (symplectic) Euler: velocities from forces first, then poses from the new velocities. Bodies
/// in 3D whose inertia depends on the axis keep their angular momentum as they turn (gyroscopic motion).
/// Error of order h, energy of an oscillator bounded while w h < 2; in free fall the position is short of
/// the exact one by g t h / 2. Damping is implicit, v / (1 + c h), and stays stable for any c h.
/// Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1.2.
struct semi_implicit_euler {
    using stage = physics::stage::integrator;

    template <class Space>
    struct in {
        using S = typename Space::scalar;
        static constexpr int D = Space::dimension;
        /// Does to many bodies at once what integrate_pose does to one; for this integrator, not for what derives from
        /// it.
        template <bool Rotates>
        using lanes = detail::pose_lanes<S, D, Rotates>;
        using owner_of_lanes = in;

        /// Advances the velocity of a body by what drives it, and by damping.
        template <bool Rotates>
        static constexpr void integrate_velocity(solver_api::twist_of<S, D, Rotates>& v,
                                                 const solver_api::moving_body<S, D, Rotates>& b, S h) {
            v.linear = (v.linear + b.acceleration * h) * damped(b.linear_damping, h);
            if constexpr (Rotates) v.angular = (v.angular + b.angular_acceleration * h) * damped(b.angular_damping, h);
        }
        /// Advances a body by its velocity: adds to its way, turns it in 3D, and the angular velocity of a free top
        /// with it. In 2D angles add up, so that one turn by the way serves all parts of a step.
        template <bool Rotates>
        static constexpr void integrate_pose([[maybe_unused]] solver_api::moving_body<S, D, Rotates>& b,
                                             solver_api::pose_velocity<S, D, Rotates>& v,
                                             solver_api::twist_of<S, D, Rotates>& displacement, S h) {
            displacement.linear += v.linear * h;
            if constexpr (Rotates) displacement.angular += v.angular * h;
            if constexpr (D == 3 && Rotates) {
                if (b.gyroscopic) detail::turn_freely(b, v.angular, h);
                else b.rotation = turned(b.rotation, v.angular * h);
            }
        }

    private:
        static constexpr S damped(S damping, S h) { return damping == S(0) ? S(1) : S(1) / (S(1) + damping * h); }
    };
};

PHYSICS_HPP_END
