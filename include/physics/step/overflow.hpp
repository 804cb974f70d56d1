// Whether numbers stay in range in a step.
#pragma once

#include "physics/dynamics/convert.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The number of substeps of a solver; 1 if it has no such setting.
template <class Settings>
int substeps_of(const Settings& settings) {
    if constexpr (requires { settings.substeps; }) return settings.substeps;
    else return 1;
}

/// Whether a body's velocity and displacement keep within half of the scalar's range in a step of h seconds, by the
/// forces on it: in double, since fixed-point numbers wrap. The whole step's force may act in the first substep.
template <class S, int D, bool Rotates>
bool stays_in_range(const vec<S, D>& gravity, const body<S, D, Rotates>& b, const solver_body<S, D, Rotates>& now, S h,
                    int substeps) {
    const double maximum = static_cast<double>(scalar_traits<S>::max()) / 2, step = static_cast<double>(h);
    const auto size = [](double x) { return x < 0 ? -x : x; };
    const auto fits = [&](double velocity, double force, double drive) {
        const double speed = size(velocity) + drive * step;
        return force * substeps <= maximum && drive * substeps <= maximum && speed <= maximum &&
               speed * step <= maximum;
    };
    bool good = true;
    for (int i = 0; i < D; ++i) {
        const double force = size(static_cast<double>(b.force[i]));
        double drive = force * static_cast<double>(b.inverse_mass);
        if (b.is_dynamic()) drive += size(static_cast<double>(gravity[i]) * static_cast<double>(b.gravity_scale));
        good = good && fits(static_cast<double>(now.velocity.linear[i]), force, drive);
    }
    if constexpr (Rotates)
        good =
            good && fits(largest_magnitude(now.velocity.angular), largest_magnitude(b.torque),
                         largest_magnitude(times(converted<double>(now.inverse_inertia), converted<double>(b.torque))));
    return good;
}

/// Whether a body's position and velocity are in range.
template <class S, int D, bool Rotates>
bool is_in_range(const moving_body<S, D, Rotates>& at, const twist_of<S, D, Rotates>& velocity) {
    if (!is_in_range(at.center) || !is_in_range(velocity.linear)) return false;
    if constexpr (Rotates) return is_finite(at.rotation) && is_in_range(velocity.angular);
    else return true;
}

}  // namespace detail

PHYSICS_HPP_END
