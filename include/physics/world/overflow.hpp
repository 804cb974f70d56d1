// Whether numbers stay in range in a step.
#pragma once

#include "physics/world/check.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Into how many parts a solver cuts a step.
template <class Settings>
int parts_of_step(const Settings& with) {
    if constexpr (requires { with.substeps; }) return with.substeps;
    else return 1;
}

/// Whether a body's velocity and way keep within half of the scalar's range in a step of h seconds, by what drives it:
/// in double, since fixed-point numbers wrap. The whole step's force may act in its first part of so many.
template <class S, int D, bool Turns>
bool stays_in_range(const vec<S, D>& gravity, const body<S, D, Turns>& b, const solver_body<S, D, Turns>& now, S h,
                    int parts) {
    const double most = static_cast<double>(scalar_traits<S>::max()) / 2, step = static_cast<double>(h);
    const auto size = [](double x) { return x < 0 ? -x : x; };
    const auto fits = [&](double velocity, double force, double drive) {
        const double speed = size(velocity) + drive * step;
        return force * parts <= most && drive * parts <= most && speed <= most && speed * step <= most;
    };
    bool good = true;
    for (int i = 0; i < D; ++i) {
        const double force = size(static_cast<double>(b.force[i]));
        double drive = force * static_cast<double>(b.inverse_mass);
        if (b.is_dynamic()) drive += size(static_cast<double>(gravity[i]) * static_cast<double>(b.gravity_scale));
        good = good && fits(static_cast<double>(now.velocity.linear[i]), force, drive);
    }
    if constexpr (Turns)
        good = good && fits(size_of(now.velocity.angular), size_of(b.torque),
                            size_of(times(converted<double>(now.inverse_inertia), converted<double>(b.torque))));
    return good;
}

/// Whether a body has come to where numbers reach, and is as fast.
template <class S, int D, bool Turns>
bool is_where_numbers_reach(const moving_body<S, D, Turns>& at, const twist_of<S, D, Turns>& velocity) {
    if (!is_in_range(at.center) || !is_in_range(velocity.linear)) return false;
    if constexpr (Turns) return is_finite(at.rotation) && is_in_range(velocity.angular);
    else return true;
}

}  // namespace detail

PHYSICS_HPP_END
