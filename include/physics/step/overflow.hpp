// Whether numbers stay in range in a step.
#pragma once

#include "physics/dynamics/constraints.hpp"
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

/// Half of a fixed-point scalar's range: what may be part of a state, of which the sum of two shows whether it is.
template <class S>
constexpr double half_range = static_cast<double>(scalar_traits<S>::max()) / 2;

/// Whether the momentum that two bodies have against each other is in range, with B at that velocity, as seen from A:
/// what holds them may have to take all of it, and solvers multiply masses with speeds.
template <class S, int D, bool Rotates>
bool is_momentum_in_range(const solver_body<S, D, Rotates>& a, const solver_body<S, D, Rotates>& b,
                          const vec<double, D>& velocity, double limit = half_range<S> / 2) {
    const double inverse_mass = static_cast<double>(a.inverse_mass) + static_cast<double>(b.inverse_mass);
    return inverse_mass == 0 || largest(velocity) <= limit * inverse_mass;
}
/// The same of what a joint may have to take, about its own axes too.
template <class S, int D, bool Rotates>
bool is_momentum_in_range(const solver_body<S, D, Rotates>& a, const solver_body<S, D, Rotates>& b) {
    const double limit = to_double(joint_row<S, D>::unlimited());
    const auto by = converted<double>(b.velocity - a.velocity);
    if (!is_momentum_in_range(a, b, by.linear, limit)) return false;
    if constexpr (Rotates) {
        const auto fits = [limit](double spin, double of_a, double of_b) {
            return of_a + of_b == 0 || abs(spin) <= limit * (of_a + of_b);
        };
        const auto &i = a.inverse_inertia, &k = b.inverse_inertia;
        if constexpr (D == 2) return fits(by.angular, to_double(i), to_double(k));
        else
            return fits(by.angular.x, to_double(i.xx), to_double(k.xx)) &&
                   fits(by.angular.y, to_double(i.yy), to_double(k.yy)) &&
                   fits(by.angular.z, to_double(i.zz), to_double(k.zz));
    }
    return true;
}
template <class S, int D, bool Rotates>
vec<double, D> velocity_at(const solver_body<S, D, Rotates>& b, [[maybe_unused]] const vec<S, D>& r) {
    vec<double, D> v = converted<double>(b.velocity.linear);
    if constexpr (Rotates) v += cross(converted<double>(b.velocity.angular), converted<double>(r));
    return v;
}
/// The same of the surfaces at each point of a contact.
template <class S, int D, class Features, bool Rotates>
bool is_momentum_in_range(const contact<S, D, Features>& c, const solver_body<S, D, Rotates>& a,
                          const solver_body<S, D, Rotates>& b) {
    for (int k = 0; k < c.count; ++k) {
        const anchors<S, D> to = c.anchors(k);
        if (!is_momentum_in_range(a, b, velocity_at(b, to.b) - velocity_at(a, to.a))) return false;
    }
    return true;
}

/// Whether what a contact gave in a step is in range, and its moment about both bodies.
template <class S, int D, class Features, bool Rotates>
bool is_impulse_in_range(const contact<S, D, Features>& c, const solver_body<S, D, Rotates>& a,
                         const solver_body<S, D, Rotates>& b) {
    double load = 0, moment = 0;
    for (int k = 0; k < c.count; ++k) {
        const auto& p = c.points[k];
        const double of_point = static_cast<double>(p.normal_impulse);
        if (of_point < 0) return false;
        load += of_point;
        if constexpr (Features::friction)
            if (largest_magnitude(p.friction_impulse) > half_range<S>) return false;
        const anchors<S, D> to = c.anchors(k);
        const auto arm = [](const auto& body, const vec<S, D>& r) {
            return body.inverse_mass > inverse_of<S>(0) ? largest_magnitude(r) : 0.0;
        };
        if constexpr (Rotates) moment += of_point * (arm(a, to.a) + arm(b, to.b));
    }
    return load <= half_range<S> && moment <= half_range<S>;
}

/// The same of joints.
template <class S, int D, class Features, template <class, int> class... Joints>
bool are_impulses_in_range(const constraints<S, D, Features, joints<Joints...>>& of) {
    const auto fit = []<class List>(const List& list) {
        for (std::uint32_t i = 0; i < list.size(); ++i)
            for (const S given : list[i].sum)
                if (!(largest_magnitude(given) < to_double(joint_row<S, D>::unlimited()))) return false;
        return true;
    };
    return (fit(of.template joints_of_kind<Joints<S, D>>()) && ...);
}

}  // namespace detail

PHYSICS_HPP_END
