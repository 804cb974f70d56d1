// How velocities and poses advance by a step.
#pragma once

#include "physics/base/stage.hpp"
#include "physics/dynamics/body.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Turns a body on which no torque acts for a time h, by the midpoint rule on a constant angular momentum:
/// that is kept to rounding, whatever the spin; the energy errs with the third power of h.
template <class S>
constexpr void turn_freely(body<S, 3>& b, vec<S, 3>& angular_velocity, S h) {
    const rotation<S, 3> start = b.rotation;
    const vec<S, 3> momentum = start * times(b.mass.inertia, inverse_rotate(start, angular_velocity));
    const auto spin = [&](const rotation<S, 3>& r) {
        return r * times(b.inverse_inertia, inverse_rotate(r, momentum));
    };
    const rotation<S, 3> half_way = turned(start, angular_velocity * (h * S(0.5)));
    b.rotation = turned(start, spin(half_way) * h);
    angular_velocity = spin(b.rotation);
}
/// In the plane nothing precesses.
template <class S>
constexpr void turn_freely(body<S, 2>&, S, S) {}

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

        /// Advances the velocity of a dynamic body by gravity (m/s^2), force, torque and damping.
        static constexpr void advance_velocity(solver_body<S, D>& v, const body<S, D>& b, vec<S, D> gravity, S h) {
            vec<S, D> acceleration = gravity * b.gravity_scale;
            for (int i = 0; i < D; ++i) acceleration[i] += mul<S>(v.inverse_mass, b.force[i]);
            v.velocity.linear = (v.velocity.linear + acceleration * h) * damped(b.linear_damping, h);
            v.velocity.angular =
                (v.velocity.angular + times(v.inverse_inertia, b.torque) * h) * damped(b.angular_damping, h);
        }
        /// Advances the pose of a body by its velocity, and the angular velocity of a free top with it.
        static constexpr void advance_pose(body<S, D>& b, twist<S, D>& v, S h) {
            b.center += v.linear * h;
            if (b.is_gyroscopic) detail::turn_freely(b, v.angular, h);
            else b.rotation = turned(b.rotation, v.angular * h);
        }

    private:
        static constexpr S damped(S damping, S h) {
            return damping == S(0) ? S(1) : S(1) / (S(1) + damping * h);
        }
    };
};

PHYSICS_HPP_END
