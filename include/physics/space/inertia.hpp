// Mass, centre and rotational inertia: a scalar in 2D, a symmetric tensor in 3D.
#pragma once

#include "physics/space/transform.hpp"

PHYSICS_HPP_BEGIN

/// Rotational inertia: kg m^2 about the axis out of the plane in 2D, a symmetric tensor in 3D.
template <class S, int D>
using inertia = std::conditional_t<D == 2, S, symmetric<S>>;
/// The inverse of an inertia, in the scalar's inverse format.
template <class S, int D>
using inverse_inertia = std::conditional_t<D == 2, inverse_of<S>, symmetric<inverse_of<S>>>;

/// Mass (kg), centre of mass (m) and inertia about that centre (kg m^2).
template <class S, int D>
struct mass_properties {
    S mass{};
    vec<S, D> center;
    physics::inertia<S, D> inertia{};
};

/// The inertia of a point mass at r: what the parallel-axis theorem adds.
template <class S>
constexpr S point_inertia(S mass, vec<S, 2> r) {
    return mass * dot(r, r);
}
template <class S>
constexpr symmetric<S> point_inertia(S mass, vec<S, 3> r) {
    const S xx = r.x * r.x, yy = r.y * r.y, zz = r.z * r.z;
    return symmetric<S>{yy + zz, xx + zz, xx + yy, -(r.x * r.y), -(r.x * r.z), -(r.y * r.z)} * mass;
}

/// The mass properties as seen from the frame that t leads to.
template <class S>
constexpr mass_properties<S, 2> transformed(const mass_properties<S, 2>& m, const transform<S, 2>& t) {
    return {m.mass, t * m.center, m.inertia};
}
template <class S>
constexpr mass_properties<S, 3> transformed(const mass_properties<S, 3>& m, const transform<S, 3>& t) {
    return {m.mass, t * m.center, rotated(m.inertia, matrix(t.rotation))};
}

/// Two rigidly joined masses as one. Source: the parallel-axis (Huygens-Steiner) theorem.
template <class S, int D>
constexpr mass_properties<S, D> combined(const mass_properties<S, D>& a, const mass_properties<S, D>& b) {
    const S mass = a.mass + b.mass;
    if (!(mass > S(0))) return a;
    const vec<S, D> center = a.center + (b.center - a.center) * (b.mass / mass);
    return {
        mass, center,
        a.inertia + point_inertia(a.mass, a.center - center) + b.inertia + point_inertia(b.mass, b.center - center)};
}

/// The inverse inertia; zero if the inertia is not positive (definite).
template <class S>
constexpr inverse_of<S> inverted_inertia(S inertia) {
    return inertia > S(0) ? reciprocal<inverse_of<S>>(inertia) : inverse_of<S>(0);
}
template <class S>
constexpr symmetric<inverse_of<S>> inverted_inertia(const symmetric<S>& inertia) {
    return inverse<inverse_of<S>>(inertia);
}

/// True if the inertia is the same about every axis.
template <class S>
constexpr bool is_isotropic(S) {
    return true;
}
template <class S>
constexpr bool is_isotropic(const symmetric<S>& m) {
    return m.xx == m.yy && m.yy == m.zz && m.xy == S(0) && m.xz == S(0) && m.yz == S(0);
}

/// The inverse inertia of a body with the given rotation, in world axes.
template <class S>
constexpr inverse_of<S> in_world(inverse_of<S> local, const rotation<S, 2>&) {
    return local;
}
template <class S>
constexpr symmetric<inverse_of<S>> in_world(const symmetric<inverse_of<S>>& local, const rotation<S, 3>& r) {
    return rotated(local, matrix(r));
}

/// Inverse inertia times an angular impulse: the change of angular velocity.
template <class I, class S>
    requires std::same_as<I, inverse_of<S>>
constexpr S times(I inverse_inertia, S moment) { return mul<S>(inverse_inertia, moment); }

namespace detail {

/// Twice the kinetic energy of what turns at w in world axes (J), with the given rotation.
template <class S>
double twice_spin_energy(S inertia, const rotation<S, 2>&, S w) {
    return to_double(inertia) * to_double(w) * to_double(w);
}
template <class S>
double twice_spin_energy(const symmetric<S>& m, const rotation<S, 3>& turned, const vec<S, 3>& w) {
    const vec<S, 3> seen = inverse_rotate(turned, w);
    const double x = to_double(seen.x), y = to_double(seen.y), z = to_double(seen.z);
    return to_double(m.xx) * x * x + to_double(m.yy) * y * y + to_double(m.zz) * z * z +
           2 * (to_double(m.xy) * x * y + to_double(m.xz) * x * z + to_double(m.yz) * y * z);
}

}  // namespace detail

PHYSICS_HPP_END
