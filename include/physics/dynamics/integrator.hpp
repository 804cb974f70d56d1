// How velocities and poses advance by a step.
#pragma once

#include "physics/base/stage.hpp"
#include "physics/dynamics/body.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Turns a body on which no torque acts for a time h. Its energy of motion is split into parts whose motions are known:
/// a turn about the angular momentum, as if all moments were the first, and turns about two principal axes for what is
/// left of these. Momentum is kept to rounding, whatever the spin and however thin the body; the energy errs with the
/// square of h and does not drift; exact for symmetric tops. Source: McLachlan, Explicit Lie-Poisson integration and
/// the Euler equations (1993); Hairer, Lubich, Wanner, Geometric Numerical Integration, VII.5.
template <class S>
constexpr void turn_freely(moving_body<S, 3>& b, vec<S, 3>& angular_velocity, S h) {
    const body<S, 3>& top = *b.top;
    const vec<S, 3> momentum = b.rotation * times(top.mass.inertia, inverse_rotate(b.rotation, angular_velocity));
    rotation<S, 3> axes = b.rotation * top.spin.axes;
    vec<S, 3> seen = inverse_rotate(axes, momentum);
    const auto turn_about = [&](int axis, inverse_of<S> by, S time) {
        if (by == inverse_of<S>(0)) return;
        vec<S, 3> angle;
        angle[axis] = mul<S>(by, seen[axis]) * time;
        const rotation<S, 3> turn = turned(rotation<S, 3>{}, angle);
        axes = axes * turn;
        seen = inverse_rotate(turn, seen);
    };
    turn_about(1, top.spin.second, h * S(0.5));
    turn_about(2, top.spin.third, h);
    turn_about(1, top.spin.second, h * S(0.5));
    vec<S, 3> angle;
    for (int i = 0; i < 3; ++i) angle[i] = mul<S>(top.spin.first, momentum[i]) * h;
    b.rotation = turned(axes, angle) * inverse(top.spin.axes);
    angular_velocity = b.rotation * times(top.inverse_inertia, inverse_rotate(b.rotation, momentum));
}
/// In the plane nothing precesses.
template <class S>
constexpr void turn_freely(moving_body<S, 2>&, S, S) {}

}  // namespace detail

/// Semi-implicit (symplectic) Euler: velocities from forces first, then poses from the new velocities. Bodies
/// in space whose inertia depends on the axis keep their angular momentum as they turn (gyroscopic motion).
/// Error of order h, energy of an oscillator bounded while w h < 2; in free fall the position is short of
/// the exact one by g t h / 2. Damping is implicit, v / (1 + c h), and stays stable for any c h.
/// Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1.2.
struct semi_implicit_euler {
    using stage = physics::stage::integrator;

    template <class Space>
    struct in {
        using S = typename Space::scalar;
        static constexpr int D = Space::dimension;

        /// Advances the velocity of a body by what drives it, and by damping.
        static constexpr void advance_velocity(twist<S, D>& v, const moving_body<S, D>& b, S h) {
            v.linear = (v.linear + b.acceleration * h) * damped(b.linear_damping, h);
            v.angular = (v.angular + b.angular_acceleration * h) * damped(b.angular_damping, h);
        }
        /// Advances the pose of a body by its velocity, and the angular velocity of a free top with it.
        static constexpr void advance_pose(moving_body<S, D>& b, twist<S, D>& v, S h) {
            b.center += v.linear * h;
            if (b.top) detail::turn_freely(b, v.angular, h);
            else b.rotation = turned(b.rotation, v.angular * h);
        }

    private:
        static constexpr S damped(S damping, S h) {
            return damping == S(0) ? S(1) : S(1) / (S(1) + damping * h);
        }
    };
};

PHYSICS_HPP_END
