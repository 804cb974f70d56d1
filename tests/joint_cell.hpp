// The worlds in which joints are tried, and short spellings for them.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "cell.hpp"

/// Of a user's, in a namespace that is the same in all units.
namespace own_joints {

/// A kind of joint of a user's own: a point of one body stays at a point of the other.
template <class T, int N>
struct pin {
    physics::vec<T, N> anchor_a{}, anchor_b{};
    static constexpr int row_count = N;
    PHYSICS_HPP_MEMBERS(anchor_a, anchor_b)

    void rows(const physics::joint_frames<T, N>& at, physics::joint_row<T, N>* row) const {
        const auto r_a = at.r_a(anchor_a), r_b = at.r_b(anchor_b), gap = at.between + (r_b - r_a);
        for (int i = 0; i < N; ++i) {
            physics::vec<T, N> axis;
            axis[i] = T(1);
            row[i] = at.along(axis, r_a, r_b).equality(gap[i]);
        }
    }
};
template <class T, int N>
bool check(const pin<T, N>& p, const char* function) {
    return physics::detail::check_finite(function, "anchor_a", p.anchor_a) &&
           physics::detail::check_finite(function, "anchor_b", p.anchor_b);
}

}  // namespace own_joints

/// The worlds of the laws of joints: few shapes, all kinds of joints. Named alike in all units of a cell, so that they
/// share what is compiled of them (cell_kernels.cpp.in).
template <int D>
struct all_joints {
    using type =
        physics::joints<physics::ball_joint, physics::distance_joint, physics::revolute_joint, physics::prismatic_joint,
                        physics::weld_joint, physics::wheel_joint, physics::filter_joint, physics::motor_joint,
                        physics::target_joint, physics::gear_joint, physics::rack_joint, physics::pulley_joint,
                        physics::six_degrees_joint>;
};
template <>
struct all_joints<3> {
    using type =
        physics::joints<physics::ball_joint, physics::distance_joint, physics::revolute_joint, physics::prismatic_joint,
                        physics::weld_joint, physics::wheel_joint, physics::filter_joint, physics::motor_joint,
                        physics::target_joint, physics::gear_joint, physics::rack_joint, physics::pulley_joint,
                        physics::six_degrees_joint, physics::cone_joint, physics::swing_twist_joint>;
};
template <class S, int D, class... Policies>
struct joined_of
    : physics::recipe<S, D, physics::shapes<physics::ball, physics::capsule, physics::box, physics::halfspace>,
                      typename all_joints<D>::type, Policies...> {};
PHYSICS_HPP_EXTERN(joined_of<CELL_SCALAR, CELL_DIMENSION>)
PHYSICS_HPP_EXTERN(joined_of<CELL_SCALAR, CELL_DIMENSION, physics::sequential_impulse>)

namespace {
namespace joint_laws {

using S = cell::scalar;
constexpr int D = cell::dimension;
using physics::body_id;
using physics::body_type;
using physics::joint_id;
using vec = physics::vec<S, D>;
using distance_joint = physics::distance_joint<S, D>;
using transform = physics::transform<S, D>;
using rotation = physics::rotation<S, D>;
constexpr double gravity = 10, pi = 3.141592653589793;

using few = physics::shapes<physics::ball, physics::box, physics::halfspace>;
template <class... Policies>
using joined = joined_of<S, D, Policies...>;
using soft = joined<>;
using hard = joined<physics::sequential_impulse>;
struct unturned : physics::recipe<S, D, few, physics::joints<physics::distance_joint>,
                                  physics::without<physics::feature::rotation>> {};
using world = physics::world<soft>;

inline double number(S x) { return cell::number(x); }
inline vec at(double x, double y = 0, double z = 0) {
    vec v;
    v[0] = S(x);
    v[1] = S(y);
    if constexpr (D == 3) v[2] = S(z);
    return v;
}
inline double length_of(const vec& v) {
    double sum = 0;
    for (int i = 0; i < D; ++i) sum += number(v[i]) * number(v[i]);
    return std::sqrt(sum);
}
template <class World>
double distance_of(const World& w, body_id a, body_id b) {
    return length_of(w.position(b) - w.position(a));
}

template <class World>
World falling(int substeps = 4, double g = gravity) {
    typename World::settings_type settings;
    settings.gravity = at(0, -g);
    settings.solver.substeps = substeps;
    return World(settings);
}
/// Whose joints are solved directly, or by iterations.
template <class World>
World falling_by(int substeps, bool direct) {
    World w = falling<World>(substeps);
    auto settings = w.settings();
    if (!direct) settings.solver.max_direct_cost = 0;
    w.set_settings(settings);
    return w;
}
template <class World>
body_id add_anchor(World& w, const vec& where) {
    return w.create_body({.type = body_type::static_body, .position = where});
}
/// A ball of 1 kg.
template <class World>
body_id add_ball(World& w, const vec& where, double radius = 0.1) {
    const body_id b = w.create_body({.position = where});
    const double volume = D == 2 ? 3.141592653589793 * radius * radius : 4.1887902047863905 * radius * radius * radius;
    w.create_shape(b, typename World::ball{S(radius)}, {.density = S(1 / volume)});
    return b;
}
/// A chain of balls of 1 kg, each 0.5 m from the last, level from an anchor on.
template <class World>
std::vector<body_id> add_chain(World& w, int length, const vec& from) {
    std::vector<body_id> all{add_anchor(w, from)};
    for (int i = 1; i <= length; ++i) {
        all.push_back(add_ball(w, from + at(0.5 * i)));
        w.create_joint(all[all.size() - 2], all.back(), distance_joint{.length = S(0.5)});
    }
    return all;
}
template <class World>
void run(World& w, int steps, double h = 1.0 / 64) {
    for (int i = 0; i < steps; ++i) w.step(S(h));
}

using inverse = physics::inverse_of<S>;
inline void set_inertia(inverse& to, double size) { to = inverse(size); }
inline void set_inertia(physics::symmetric<inverse>& to, double size) {
    to = {inverse(4 * size), inverse(6 * size), inverse(5 * size), inverse(size), inverse(0), inverse(-size)};
}

inline double size_of(S x) { return std::abs(number(x)); }
inline double size_of(const physics::vec<S, 3>& v) { return std::sqrt(number(v.x * v.x + v.y * v.y + v.z * v.z)); }
inline double about_z(S inertia) { return number(inertia); }
inline double about_z(const physics::symmetric<S>& inertia) { return number(inertia.zz); }

/// A box of 1 kg.
template <class World>
body_id add_box(World& w, const vec& where, double half_x, double half_y) {
    const body_id b = w.create_body({.position = where});
    vec half = vec::filled(S(0.125));
    half[0] = S(half_x);
    half[1] = S(half_y);
    const double size = 4 * half_x * half_y * (D == 2 ? 1 : 0.25);
    w.create_shape(b, typename World::box{half}, {.density = S(1 / size)});
    return b;
}
/// Planks of 1 kg and 1 m that just fill their span between two anchors, with friction in their hinges (N m).
template <class World>
std::vector<body_id> add_taut_bridge(World& w, int count, double friction) {
    std::vector<body_id> planks;
    body_id last = add_anchor(w, at(0, 0));
    const auto pin = [&](body_id b, double far_a, double far_b) {
        physics::revolute_joint<S, D> joint{.max_motor_torque = S(friction)};
        joint.frame_a.position = at(far_a);
        joint.frame_b.position = at(far_b);
        w.create_joint(last, b, joint);
        last = b;
    };
    for (int i = 0; i < count; ++i) {
        planks.push_back(add_box(w, at(i + 0.5), 0.5, 0.125));
        w.set_can_sleep(planks.back(), false);
        pin(planks.back(), i == 0 ? 0 : 0.5, -0.5);
    }
    pin(add_anchor(w, at(count)), 0.5, 0);
    return planks;
}
template <class World>
double widest_gap(const World& w, const std::vector<body_id>& planks) {
    double gap = 0;
    for (std::size_t k = 1; k < planks.size(); ++k)
        gap = std::max(gap, length_of(w.pose(planks[k - 1]) * at(0.5) - w.pose(planks[k]) * at(-0.5)));
    return gap;
}
/// One whose moment of inertia about z is 1 kg m^2.
template <class World>
body_id add_flywheel(World& w, const vec& where) {
    return add_box(w, where, 1, std::sqrt(2.0));
}
inline double z_of(S w) { return number(w); }
inline double z_of(const physics::vec<S, 3>& w) { return number(w.z); }
inline vec spin_of(S) { return {}; }
inline const physics::vec<S, 3>& spin_of(const physics::vec<S, 3>& w) { return w; }
inline void set_z(S& w, double x) { w = S(x); }
inline void set_z(physics::vec<S, 3>& w, double x) { w = {S(0), S(0), S(x)}; }
template <class World>
void set_spin(World& w, body_id b, double x) {
    typename World::angular v{};
    set_z(v, x);
    w.set_angular_velocity(b, v);
}
inline auto turned_by(physics::rotation<S, 2>, double angle) { return physics::rotation<S, 2>::from_angle(S(angle)); }
inline auto turned_by(physics::rotation<S, 3>, double angle) {
    return physics::rotation<S, 3>::from_axis_angle({S(0), S(0), S(1)}, S(angle));
}
inline void stretch(physics::rotation<S, 2>& r) { r.cosine = S(2); }
inline void stretch(physics::rotation<S, 3>& r) { r.w = S(2); }
inline rotation turn(double angle) { return turned_by(rotation{}, angle); }
inline transform frame(double x, double y = 0, double angle = 0) { return {at(x, y), turn(angle)}; }

/// What a call is refused with.
template <class F>
std::string refusal(F&& call) {
    try {
        call();
    } catch (const physics::error& error) {
        return error.what();
    }
    return "";
}
/// Holds a world to refusing its first joint, by the name of a field.
template <class World, class Joint>
void is_refused(World& w, body_id a, body_id b, const char* field, const Joint& joint,
                const physics::joint_def& def = {}) {
    const std::string text = refusal([&] { w.create_joint(a, b, joint, def); });
    CAPTURE(text);
    CHECK(text.find(field) != text.npos);
    CHECK(w.joint_count() == 0);
}

}  // namespace joint_laws
}  // namespace
