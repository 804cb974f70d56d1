// The default world of a cell, and short spellings that hold in the plane and in space.
#pragma once

#include <cmath>

#include "cell.hpp"

/// Named alike in all units of a cell, so that they share one compiled world (cell_kernels.cpp.in).
template <class S, int D>
struct scene_of : physics::recipe<S, D> {};
PHYSICS_HPP_EXTERN(scene_of<CELL_SCALAR, CELL_DIMENSION>)

namespace {

using scene = scene_of<cell::scalar, cell::dimension>;
using world = physics::world<scene>;
using S = world::scalar;
using vec = world::vec;
using angular = world::angular;
using physics::body_id;
using physics::body_type;
using physics::shape_id;

inline double number(S x) { return cell::number(x); }
inline vec along(int axis, double size) {
    vec v;
    v[axis] = S(size);
    return v;
}
inline vec at(double x, double y) { return along(0, x) + along(1, y); }
/// An angular quantity that turns x towards y, and one in general position.
template <class Angular = angular>
Angular about_z(double size) {
    if constexpr (cell::is_2d) return S(size);
    else return {S(0), S(0), S(size)};
}
template <class Angular = angular>
Angular skew(double size) {
    if constexpr (cell::is_2d) return S(size);
    else return {S(-0.5 * size), S(0.75 * size), S(size)};
}
/// The rotation by an angle about z, and one in general position.
template <class Rotation = world::rotation_type>
Rotation turned_about_z(double angle) {
    if constexpr (cell::is_2d) return Rotation::from_angle(S(angle));
    else return Rotation::from_axis_angle({S(0), S(0), S(1)}, S(angle));
}
inline world::rotation_type random_rotation(cell::dice& dice) {
    return turned(turned_about_z(dice.number(-3, 3)), skew(dice.number(-1, 1)));
}
/// How far apart two vectors or angular quantities are.
inline double gap(S a, S b) { return std::abs(number(a) - number(b)); }
template <int D>
double gap(physics::vec<S, D> a, physics::vec<S, D> b) {
    double sum = 0;
    for (int i = 0; i < D; ++i) sum += (number(a[i]) - number(b[i])) * (number(a[i]) - number(b[i]));
    return std::sqrt(sum);
}
/// How far apart the axes of two frames point.
inline double gap(const world::rotation_type& a, const world::rotation_type& b) {
    double most = 0;
    for (int i = 0; i < cell::dimension; ++i) most = std::max(most, gap(a * along(i, 1), b * along(i, 1)));
    return most;
}
/// Rounding of n operations on numbers as large as size.
inline double rounding(double n, double size = 1) { return n * std::max(1.0, size) * number(cell::traits::epsilon()); }

/// Nothing pulls; everything bounces, however slowly.
inline world::settings_type weightless() {
    world::settings_type settings;
    settings.gravity = {};
    settings.solver.restitution_threshold = S(0);
    return settings;
}
inline body_id add_ground(world& w) {
    const body_id ground = w.create_body({.type = body_type::static_body});
    w.create_shape(ground, world::halfspace{});
    return ground;
}
inline body_id add_box(world& w, vec position, double half = 0.5) {
    const body_id box = w.create_body({.position = position});
    w.create_shape(box, world::box{vec::filled(S(half))});
    return box;
}
inline body_id add_ball(world& w, vec position, double radius = 0.5) {
    const body_id ball = w.create_body({.position = position});
    w.create_shape(ball, world::ball{S(radius)});
    return ball;
}
/// Takes n steps of 1/64 s, which is exact in every scalar.
inline void run(world& w, int n) {
    for (int i = 0; i < n; ++i) w.step(S(1.0 / 64));
}

}  // namespace
