// Vectors and poses in double, for oracles: the plane lies in space at z = 0, so that one oracle serves both.
#pragma once

#include <cmath>
#include <vector>

#include "cell.hpp"

namespace {

using S = cell::scalar;
constexpr int D = cell::dimension;
using vec = cell::space::vec;
using rotation = cell::space::rotation;
using transform = cell::space::transform;
const double epsilon = cell::number(cell::traits::epsilon());

struct reals {
    double x = 0, y = 0, z = 0;

    double& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
    double operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
    friend reals operator+(reals a, reals b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend reals operator-(reals a, reals b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend reals operator-(reals a) { return {-a.x, -a.y, -a.z}; }
    friend reals operator*(reals a, double s) { return {a.x * s, a.y * s, a.z * s}; }
    friend double dot(reals a, reals b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    friend reals cross(reals a, reals b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
};
inline double size(reals a) { return std::hypot(a.x, a.y, a.z); }
inline reals unit(reals a) { return a * (1 / size(a)); }

inline reals to_reals(physics::vec<S, 2> v) { return {cell::number(v.x), cell::number(v.y), 0}; }
inline reals to_reals(physics::vec<S, 3> v) { return {cell::number(v.x), cell::number(v.y), cell::number(v.z)}; }
inline vec from_reals(reals p) {
    vec v;
    for (int i = 0; i < D; ++i) v[i] = S(p[i]);
    return v;
}

/// Angular quantities lie along z in the plane.
inline reals to_reals(S w) { return {0, 0, cell::number(w)}; }
template <class Angular = cell::space::angular>
Angular to_angular(reals w) {
    if constexpr (cell::is_2d) return S(w.z);
    else return from_reals(w);
}

/// v, turned by an angle about a unit axis (Rodrigues' formula).
inline reals turn(reals v, reals axis, double angle) {
    const double s = std::sin(angle), c = std::cos(angle);
    return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

/// A rigid motion by the axes and the origin of the frame that it leads from.
struct pose {
    reals axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    reals origin;

    reals rotate(reals v) const { return axis[0] * v.x + axis[1] * v.y + axis[2] * v.z; }
    reals unrotate(reals v) const { return {dot(axis[0], v), dot(axis[1], v), dot(axis[2], v)}; }
    reals apply(reals p) const { return rotate(p) + origin; }
    reals undo(reals p) const { return unrotate(p - origin); }
};

inline pose to_pose(physics::transform<S, 2> t) {
    const reals x = unit({cell::number(t.rotation.cosine), cell::number(t.rotation.sine), 0});
    return {{x, {-x.y, x.x, 0}, {0, 0, 1}}, to_reals(t.position)};
}
inline pose to_pose(physics::transform<S, 3> t) {
    const reals v = to_reals(t.rotation.imaginary());
    const double length = size(v);
    const reals axis = length > 0 ? v * (1 / length) : reals{1, 0, 0};
    const double angle = 2 * std::atan2(length, cell::number(t.rotation.w));
    return {{turn({1, 0, 0}, axis, angle), turn({0, 1, 0}, axis, angle), turn({0, 0, 1}, axis, angle)},
            to_reals(t.position)};
}

/// A direction evenly spread over the circle or the sphere.
inline reals random_direction(cell::dice& dice) {
    for (;;) {
        const reals v{dice.number(-1, 1), dice.number(-1, 1), cell::is_3d ? dice.number(-1, 1) : 0};
        if (size(v) > 0.1 && size(v) < 1) return unit(v);
    }
}
/// Of a turn: in the plane z or its opposite.
inline reals random_axis(cell::dice& dice) {
    return cell::is_2d ? reals{0, 0, dice.below(2) ? 1.0 : -1.0} : random_direction(dice);
}
/// The numbers that a rotation is made of.
inline std::vector<S> parts_of(const physics::rotation<S, 2>& r) { return {r.cosine, r.sine}; }
inline std::vector<S> parts_of(const physics::rotation<S, 3>& r) { return {r.x, r.y, r.z, r.w}; }
template <int N = D>
physics::rotation<S, N> rotation_of(const std::vector<S>& parts) {
    if constexpr (N == 2) return {parts[0], parts[1]};
    else return {parts[0], parts[1], parts[2], parts[3]};
}
template <int N = D>
physics::rotation<S, N> random_rotation(cell::dice& dice) {
    return normalized(rotation_of<N>({dice.real(-1, 1), dice.real(-1, 1), dice.real(-1, 1), dice.real(-1, 1)}));
}
/// The rotation by an angle about a unit axis, through sine and cosine.
template <class Rotation = rotation>
Rotation rotation_about(reals axis, double angle) {
    if constexpr (cell::is_2d) return Rotation::from_angle(S(axis.z < 0 ? -angle : angle));
    else return Rotation::from_axis_angle(from_reals(axis), S(angle));
}
inline transform random_transform(cell::dice& dice, double far) {
    return {dice.vec<vec>(-far, far), random_rotation(dice)};
}

/// Whether a and b are at most n spacings apart, of numbers next to 1 or next to the longer of them.
inline bool near(reals a, reals b, double n) {
    return size(a - b) <= n * epsilon * std::fmax(1, std::fmax(size(a), size(b)));
}
inline bool near(vec a, reals b, double n) { return near(to_reals(a), b, n); }
inline bool near(double a, double b, double n) {
    return std::abs(a - b) <= n * epsilon * std::fmax(1, std::fmax(std::abs(a), std::abs(b)));
}
/// Whether two rotations lead to the same place.
inline bool near_rotation(const rotation& a, const rotation& b, double n) {
    const pose p = to_pose(physics::transform<S, D>{{}, a}), q = to_pose(physics::transform<S, D>{{}, b});
    return near(p.axis[0], q.axis[0], n) && near(p.axis[1], q.axis[1], n) && near(p.axis[2], q.axis[2], n);
}

}  // namespace
