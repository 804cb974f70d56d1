// Laws of swing-twist joints: cones beyond a right angle and of 0, ellipses, twists, motors and springs.
#pragma once

#include "laws/joint_axes.hpp"

#if CELL_DIMENSION == 3

namespace {
namespace swing_laws {

using namespace axis_laws;
using vec3 = physics::vec<S, 3>;
using rotation3 = physics::rotation<S, 3>;

using joint = physics::swing_twist_joint<S, 3>;
using cone_joint = physics::cone_joint<S, 3>;
using world = physics::world<joined<>>;

inline void set_cone(joint& j, double angle) { j.max_swing_y = j.max_swing_z = S(angle); }
inline void set_cone(cone_joint& j, double angle) { j.half_angle = S(angle); }

inline rotation3 about(const vec3& axis, double angle) { return rotation3::from_axis_angle(axis, S(angle)); }

CELL_CASE("joint swings: rows are the derivatives of what they measure, and have no moment") {
    cell::dice dice(8);
    for (int i = 0; i < 300; ++i) {
        joint j;
        j.frame_a = {dice.vec<vec3>(-1, 1), random_rotation(dice)};
        j.frame_b = {dice.vec<vec3>(-1, 1), random_rotation(dice)};
        j.max_swing_y = S(dice.number(0.1, 3));
        j.max_swing_z = i % 3 == 0 ? j.max_swing_y : S(dice.number(0.1, 3));
        j.min_twist = S(-1);
        j.max_twist = S(1);
        const double direction = dice.number(-3, 3);
        const vec3 axis{S(0), S(std::cos(direction)), S(std::sin(direction))};
        rows_are_derivatives(j, dice,
                             about(axis, dice.number(0.05, 2.9)) * about({S(1), S(0), S(0)}, dice.number(-3, 3)), true);
    }
}

CELL_CASE("joint swings: a swing is no twist, however far and whereto") {
    cell::dice dice(9);
    for (int i = 0; i < 300; ++i) {
        const double direction = dice.number(-3, 3), twist = dice.number(-3, 3);
        frames at;
        at.rotation_a = random_rotation(dice);
        at.rotation_b = at.rotation_a *
                        about({S(0), S(std::cos(direction)), S(std::sin(direction))}, dice.number(0, 2.8)) *
                        about({S(1), S(0), S(0)}, twist);
        CHECK(std::abs(number(joint{}.angle(at, 0)) - twist) < number(cell::tolerance(128)) * 8);
    }
}

template <class Joint, class World>
void a_cone_bears(double cone, int substeps, bool swapped) {
    World w = falling<World>(substeps);
    const body_id a = add_anchor(w, {}), b = add_box(w, {}, 0.5, 0.125);
    // An arm whose end is held, a little within the cone.
    const rotation3 arm = about({S(0), S(0), S(1)}, pi / 2 - (cone - 0.05));
    w.set_pose(b, {arm * vec3{S(0.5), S(0), S(0)}, arm});
    w.set_damping(b, S(0), S(2));
    w.set_can_sleep(b, false);
    Joint j{.frame_a = {{}, about({S(0), S(0), S(1)}, pi / 2)}, .frame_b = {{S(-0.5), S(0), S(0)}, {}}};
    set_cone(j, cone);
    if (swapped) std::swap(j.frame_a, j.frame_b);
    const joint_id id = swapped ? w.create_joint(b, a, j) : w.create_joint(a, b, j);
    run(w, 512);
    const vec3 x = w.pose(b).rotation * vec3{S(1), S(0), S(0)};
    CHECK(std::abs(std::acos(number(x.y)) - cone) < 2e-3);
    CHECK(std::abs(length_of(w.reaction(id).torque) - 0.5 * gravity * std::sin(cone)) < 0.02);
    CHECK(std::abs(length_of(w.reaction(id).force) - gravity) < 0.02);
}

inline void what_is_thrown_stays_within(double y, double z, int substeps) {
    // Up to a twentieth of a radian in a substep: it may pass by two of them, since what bounds it is a tangent.
    cell::dice dice(6);
    const double h = 1.0 / 64 / substeps, way = 8 * substeps * h;
    for (int i = 0; i < 6; ++i) {
        CAPTURE(i);
        world w = falling<world>(substeps, 0);
        const body_id a = add_anchor(w, {}), b = add_ball(w, {}, 0.5);
        w.create_joint(a, b, joint{.max_swing_y = S(y), .max_swing_z = S(z), .min_twist = S(-0.5), .max_twist = S(1)});
        w.set_angular_velocity(b, dice.vec<vec3>(-2, 2) * S(substeps));
        double farthest = 0, least = 0, most = 0;
        for (int k = 0; k < 256; ++k) {
            run(w, 1);
            const rotation3 r = w.pose(b).rotation;
            const vec3 x = r * vec3{S(1), S(0), S(0)};
            const double swing = std::atan2(std::hypot(number(x.y), number(x.z)), number(x.x)),
                         direction = std::atan2(number(x.y), -number(x.z));
            const double part = swing * std::hypot(std::cos(direction) / y, std::sin(direction) / z);
            farthest = std::max(farthest, part);
            const double twist = 2 * std::atan2(number(r.x), number(r.w));
            least = std::min(least, twist > pi ? twist - 2 * pi : twist < -pi ? twist + 2 * pi : twist);
            most = std::max(most, twist > pi ? twist - 2 * pi : twist < -pi ? twist + 2 * pi : twist);
        }
        CHECK(farthest < 1 + way / std::min(y, z));
        CHECK(farthest > 0.5);
        CHECK(least > -0.5 - way);
        CHECK(most < 1 + way);
        CHECK(length_of(w.position(b)) < 1e-3);
    }
}

inline void a_cone_of_0_is_a_fixed_axis(int substeps) {
    world w = falling<world>(substeps);
    const body_id a = add_anchor(w, {}), b = add_box(w, {S(0.5), S(0), S(0)}, 0.5, 0.125);
    const joint_id j =
        w.create_joint(a, b, joint{.frame_b = {{S(-0.5), S(0), S(0)}, {}}, .max_swing_y = S(0), .max_swing_z = S(0)});
    w.set_angular_velocity(b, {S(1), S(0), S(0)});
    run(w, 128);
    const vec3 x = w.pose(b).rotation * vec3{S(1), S(0), S(0)};
    CHECK(length_of(x - vec3{S(1), S(0), S(0)}) < 1e-4);
    CHECK(std::abs(number(w.joint_angle(j)) - 2) < 0.01);
    CHECK(std::abs(length_of(w.reaction(j).torque) - 0.5 * gravity) < 0.01);
}

inline void a_swing_of_0_is_a_hinge(bool about_z, int substeps) {
    world w = falling<world>(substeps, 0);
    const body_id a = add_anchor(w, {}), b = add_box(w, {}, 0.5, 0.125);
    joint j{.min_twist = S(0), .max_twist = S(0)};
    (about_z ? j.max_swing_y : j.max_swing_z) = S(0);
    (about_z ? j.max_swing_z : j.max_swing_y) = S(2);
    w.create_joint(a, b, j);
    for (const double sign : {1.0, -1.0}) {
        w.set_angular_velocity(b, about_z ? vec3{S(0), S(0), S(4 * sign)} : vec3{S(0), S(4 * sign), S(0)});
        run(w, 128);
        const rotation3 end = about(about_z ? vec3{S(0), S(0), S(1)} : vec3{S(0), S(1), S(0)}, 2 * sign);
        CHECK(length_of(w.pose(b).rotation * vec3{S(1), S(0), S(0)} - end * vec3{S(1), S(0), S(0)}) < 2e-3);
        CHECK(length_of(w.pose(b).rotation * vec3{S(0), S(1), S(0)} - end * vec3{S(0), S(1), S(0)}) < 2e-3);
    }
}

inline void a_motor_is_friction_and_a_spring_poses(int substeps) {
    world w = falling<world>(substeps, 0);
    const body_id a = add_anchor(w, {}), b = add_ball(w, {}, 0.5);
    const double inertia = 0.4 * 0.25;
    const joint_id j = w.create_joint(a, b, joint{.max_motor_torque = S(0.1)});
    const vec3 n{S(0.48), S(0.64), S(0.6)};
    w.set_angular_velocity(b, n * S(3));
    run(w, 64);
    CHECK(length_of(w.angular_velocity(b) - n * S(3 - 0.1 / inertia)) < 1e-2);
    CHECK(length_of(w.reaction(j).torque + n * S(0.1)) < 1e-3);
    run(w, 192);
    CHECK(length_of(w.angular_velocity(b)) < 1e-4);
    w.set_joint(j, joint{.motor_velocity = n * S(2), .max_motor_torque = S(10)});
    run(w, 16);
    CHECK(length_of(w.angular_velocity(b) - n * S(2)) < 1e-3);
    const rotation3 pose = about(n, 2) * about({S(1), S(0), S(0)}, 0.5);
    w.set_joint(j, joint{.frequency = S(2), .damping_ratio = S(1), .rest_rotation = pose});
    run(w, 128);
    CHECK(size_of(rotation_vector(w.pose(b).rotation * physics::inverse(pose))) < 1e-3);
}

CELL_CASE("joint swings: bad ones are refused by name") {
    world w = falling<world>();
    const body_id a = add_anchor(w, {}), b = add_ball(w, {});
    const auto refuses = [&](const char* field, const joint& j) { is_refused(w, a, b, field, j); };
    rotation3 stretched;
    stretched.w = S(2);
    refuses("frame_b.rotation", {.frame_b = {{}, stretched}});
    refuses("max_swing_y", {.max_swing_y = S(-1)});
    refuses("max_swing_z", {.max_swing_z = S(3.2)});
    refuses("min_twist", {.max_swing_y = S(1), .max_swing_z = S(1), .min_twist = S(1), .max_twist = S(0)});
    refuses("max_swing_y", {.max_twist = S(1)});
    refuses("max_swing_z", {.max_swing_y = S(1), .max_twist = S(1)});
    refuses("max_motor_torque", {.max_motor_torque = S(-1)});
    refuses("frequency", {.frequency = S(-1)});
    refuses("damping_ratio", {.frequency = S(1), .damping_ratio = S(-1)});
    refuses("rest_rotation", {.rest_rotation = stretched});
    is_refused(w, a, b, "half_angle is 3.2", cone_joint{.half_angle = S(3.2)});
    is_refused(w, a, b, "half_angle is -1", cone_joint{.half_angle = S(-1)});
    is_refused(w, a, b, "frame_a.rotation", cone_joint{.frame_a = {{}, stretched}});
    if constexpr (!cell::is_fixed) {
        const S bad = S(0) / S(0);
        is_refused(w, a, b, "half_angle is nan", cone_joint{.half_angle = bad});
        refuses("max_swing_y", {.max_swing_y = bad});
        refuses("min_twist", {.min_twist = bad});
        refuses("motor_velocity.x", {.motor_velocity = {bad, S(0), S(0)}});
    }
}

CELL_CASE("joint swings: an arm leans on its cone, beyond a right angle too") {
    for (const double cone : {0.7, 2.2})
        for (const int substeps : {1, 4})
            for (const bool swapped : {false, true}) {
                CAPTURE(cone);
                CAPTURE(substeps);
                CAPTURE(swapped);
                using hard = physics::world<joined<physics::sequential_impulse>>;
                a_cone_bears<joint, world>(cone, substeps, swapped);
                a_cone_bears<joint, hard>(cone, substeps, swapped);
                a_cone_bears<cone_joint, world>(cone, substeps, swapped);
                a_cone_bears<cone_joint, hard>(cone, substeps, swapped);
            }
}
CELL_CASE("joint swings: what is thrown at cones, ellipses and twists stays within them") {
    for (const int substeps : {1, 4})
        for (const double y : {0.5, 2.5})
            for (const double z : {0.5, 1.0}) {
                CAPTURE(substeps);
                CAPTURE(y);
                CAPTURE(z);
                what_is_thrown_stays_within(y, z, substeps);
            }
}
CELL_CASE("joint swings: a cone joint moves as a swing-twist joint with the same swings to all sides") {
    for (const double angle : {0.0, 0.5, 2.5, pi}) {
        CAPTURE(angle);
        const auto moved = [&]<class Joint>(Joint j) {
            world w = falling<world>();
            const body_id a = add_anchor(w, {}), b = add_box(w, {S(0.5), S(0), S(0)}, 0.5, 0.125);
            j.frame_b.position.x = S(-0.5);
            set_cone(j, angle);
            w.create_joint(a, b, j);
            w.set_angular_velocity(b, {S(1), S(2), S(3)});
            run(w, 100);
            return w.pose(b);
        };
        const auto by_cone = moved(cone_joint{}), by_swings = moved(joint{});
        CHECK(by_cone.position == by_swings.position);
        CHECK(by_cone.rotation == by_swings.rotation);
    }
}
CELL_CASE("joint swings: a cone of 0 is a fixed axis, and a swing of 0 leaves a hinge") {
    for (const int substeps : {1, 4}) {
        CAPTURE(substeps);
        a_cone_of_0_is_a_fixed_axis(substeps);
        a_swing_of_0_is_a_hinge(false, substeps);
        a_swing_of_0_is_a_hinge(true, substeps);
    }
}
CELL_CASE("joint swings: a motor is the same in all directions, and a spring turns to its pose") {
    for (const int substeps : {1, 4}) {
        CAPTURE(substeps);
        a_motor_is_friction_and_a_spring_poses(substeps);
    }
}

}  // namespace swing_laws
}  // namespace

#endif
