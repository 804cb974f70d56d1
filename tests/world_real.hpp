// The state of a cell's world in double: what laws of conservation are checked with.
#pragma once

#include "world_cell.hpp"

namespace {

// The same things in double, to compute what ought to be.
using real_vec = physics::vec<double, cell::dimension>;
using real_angular = physics::angular<double, cell::dimension>;
using real_mass = physics::mass_properties<double, cell::dimension>;

inline double real(S x) { return number(x); }
inline physics::vec<double, 2> real(physics::vec<S, 2> v) { return {number(v.x), number(v.y)}; }
inline physics::vec<double, 3> real(physics::vec<S, 3> v) { return {number(v.x), number(v.y), number(v.z)}; }
inline physics::rotation<double, 2> real(const physics::rotation<S, 2>& r) {
    return {number(r.cosine), number(r.sine)};
}
inline physics::rotation<double, 3> real(const physics::rotation<S, 3>& r) {
    return {number(r.x), number(r.y), number(r.z), number(r.w)};
}
inline physics::symmetric<double> real(const physics::symmetric<S>& m) {
    return {number(m.xx), number(m.yy), number(m.zz), number(m.xy), number(m.xz), number(m.yz)};
}
inline real_mass real(const world::mass_properties& m) { return {number(m.mass), real(m.center), real(m.inertia)}; }

inline double spread(double a, double b) { return std::abs(a - b); }
template <int D>
double spread(physics::vec<double, D> a, physics::vec<double, D> b) {
    return physics::length(a - b);
}
inline double spread(const physics::symmetric<double>& a, const physics::symmetric<double>& b) {
    return std::abs(a.xx - b.xx) + std::abs(a.yy - b.yy) + std::abs(a.zz - b.zz) + std::abs(a.xy - b.xy) +
           std::abs(a.xz - b.xz) + std::abs(a.yz - b.yz);
}
inline double spin(double inertia, const physics::rotation<double, 2>&, double w) { return inertia * w; }
inline physics::vec<double, 3> spin(const physics::symmetric<double>& inertia, const physics::rotation<double, 3>& r,
                                    physics::vec<double, 3> w) {
    return r * times(inertia, inverse_rotate(r, w));
}
inline double inertia_about_z(double inertia) { return inertia; }
inline double inertia_about_z(const physics::symmetric<double>& inertia) { return inertia.zz; }

/// Linear momentum, and angular momentum about the origin.
struct momentum {
    real_vec linear;
    real_angular angular{};
};
inline momentum operator-(const momentum& a, const momentum& b) { return {a.linear - b.linear, a.angular - b.angular}; }
inline momentum momentum_of(const world& w, body_id id) {
    const real_mass m = real(w.mass(id));
    const auto r = real(w.rotation(id));
    const real_vec p = real(w.linear_velocity(id)) * m.mass;
    return {p, spin(m.inertia, r, real(w.angular_velocity(id))) + physics::cross(real(w.center_of_mass(id)), p)};
}
inline momentum momentum_of(const world& w) {
    momentum sum;
    for (const body_id id : w.bodies()) {
        if (w.type(id) != body_type::dynamic_body) continue;
        const momentum m = momentum_of(w, id);
        sum.linear += m.linear;
        sum.angular += m.angular;
    }
    return sum;
}

}  // namespace
