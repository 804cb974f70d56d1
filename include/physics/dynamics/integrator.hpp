// How velocities and poses advance by a step.
#pragma once

#include "physics/base/stage.hpp"
#include "physics/dynamics/body.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Turns a body on which no torque acts for a time h, by the midpoint rule on a constant angular momentum:
/// that is kept to rounding, whatever the spin; the energy errs with the third power of h.
template <class S>
constexpr void turn_freely(moving_body<S, 3>& b, vec<S, 3>& angular_velocity, S h) {
    const rotation<S, 3> start = b.rotation;
    const vec<S, 3> momentum = start * times(b.top->mass.inertia, inverse_rotate(start, angular_velocity));
    const auto spin = [&](const rotation<S, 3>& r) {
        return r * times(b.top->inverse_inertia, inverse_rotate(r, momentum));
    };
    const rotation<S, 3> half_way = turned(start, angular_velocity * (h * S(0.5)));
    b.rotation = turned(start, spin(half_way) * h);
    angular_velocity = spin(b.rotation);
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
