// Laws of joints that leave bodies several ways to move: of six degrees of freedom, and of swing and twist.
#pragma once

#include "joint_cell.hpp"

namespace {
namespace axis_laws {

using namespace joint_laws;
using frames = physics::joint_frames<S, D>;
using row = physics::joint_row<S, D>;
using angular = physics::angular<S, D>;
using joint_axis = physics::joint_axis<S>;
using six_degrees_joint = physics::six_degrees_joint<S, D>;

using plain = physics::world<joined<>>;
using iterative = physics::world<joined<physics::sequential_impulse>>;

inline void turn_by(physics::rotation<S, 2>& r, int axis, double angle) {
    if (axis == 2) r = r * physics::rotation<S, 2>::from_angle(S(angle));
}
inline void turn_by(physics::rotation<S, 3>& r, int axis, double angle) {
    r = r * physics::rotation<S, 3>::from_axis_angle(physics::joint_frames<S, 3>::axis(axis), S(angle));
}
/// Turned by Cardan angles.
inline rotation by_angles(double x, double y, double z) {
    rotation r;
    turn_by(r, 0, x);
    turn_by(r, 1, y);
    turn_by(r, 2, z);
    return r;
}
inline rotation random_rotation(cell::dice& dice) {
    return by_angles(dice.number(-3, 3), dice.number(-3, 3), dice.number(-3, 3));
}
inline void set_random(S& w, cell::dice& dice) { w = S(dice.number(-1, 1)); }
inline void set_random(physics::vec<S, 3>& w, cell::dice& dice) { w = dice.vec<physics::vec<S, 3>>(-1, 1); }
inline S times(S a, S b) { return a * b; }
inline S times(const physics::vec<S, 3>& a, const physics::vec<S, 3>& b) { return dot(a, b); }
/// Rows tell how fast what they measure changes, wherever the bodies are and however these move.
template <class Joint>
void rows_are_derivatives(const Joint& joint, cell::dice& dice, const rotation& relative,
                          bool are_points_held = false) {
    if constexpr (std::is_same_v<S, double>) {
        frames at;
        at.rotation_a = random_rotation(dice);
        at.rotation_b = at.rotation_a * joint.frame_a.rotation * relative * physics::inverse(joint.frame_b.rotation);
        at.center_a = dice.vec<vec>(-1, 1);
        at.center_b = dice.vec<vec>(-1, 1);
        at.between =
            are_points_held ? at.r_a(joint.frame_a.position) - at.r_b(joint.frame_b.position) : dice.vec<vec>(-1, 1);
        const vec v = dice.vec<vec>(-1, 1);
        angular w_a{}, w_b{};
        set_random(w_a, dice);
        set_random(w_b, dice);
        physics::detail::angle_list<Joint, S> none;
        const auto turned = physics::detail::count_turns(joint, at, none);
        const auto rows = [&](double h, row* to) {
            frames moved = at;
            moved.rotation_a = physics::turned(at.rotation_a, w_a * S(h));
            moved.rotation_b = physics::turned(at.rotation_b, w_b * S(h));
            moved.between += v * S(h);
            const auto now = physics::detail::count_turns(joint, moved, turned);
            moved.turned = now.begin();
            joint.rows(moved, to);
        };
        row here[Joint::row_count], before[Joint::row_count], after[Joint::row_count];
        rows(0, here);
        rows(-1e-6, before);
        rows(1e-6, after);
        for (int k = 0; k < Joint::row_count; ++k) {
            CAPTURE(k);
            CHECK(here[k].is_on() == before[k].is_on());
            if (!here[k].is_on() || here[k].is_motor) continue;
            const double speed =
                number(dot(here[k].direction, v) + times(here[k].angular_a, w_a) + times(here[k].angular_b, w_b));
            CHECK(std::abs(number(after[k].error - before[k].error) / 2e-6 - speed) < 1e-7 * (1 + std::abs(speed)));
            // A pair of forces has no moment.
            const auto moment = here[k].angular_a + here[k].angular_b + physics::cross(at.between, here[k].direction);
            CHECK(size_of(moment) < 1e-12 * (1 + size_of(here[k].angular_a)));
        }
    }
}
inline void set_all(physics::six_degrees_joint<S, 2>& j, const joint_axis& axis) { j.x = j.y = j.angle_z = axis; }
inline void set_all(physics::six_degrees_joint<S, 3>& j, const joint_axis& axis) {
    j.x = j.y = j.z = j.angle_x = j.angle_y = j.angle_z = axis;
}
inline six_degrees_joint all_driven(cell::dice& dice) {
    six_degrees_joint j;
    j.frame_a = {dice.vec<vec>(-1, 1), random_rotation(dice)};
    j.frame_b = {dice.vec<vec>(-1, 1), random_rotation(dice)};
    set_all(j, {.min = S(-0.5), .max = S(0.5), .frequency = S(1)});
    return j;
}
CELL_CASE("joint axes: rows of six degrees are the derivatives of what they measure, and have no moment") {
    cell::dice dice(3);
    for (int i = 0; i < 200; ++i)
        rows_are_derivatives(all_driven(dice), dice,
                             by_angles(dice.number(-3, 3), dice.number(-1.5, 1.5), dice.number(-3, 3)));
}
CELL_CASE("joint axes: angles of six degrees are those by which a frame is turned") {
    cell::dice dice(4);
    for (int i = 0; i < 200; ++i) {
        const double angle[] = {dice.number(-3, 3), dice.number(-1.5, 1.5), dice.number(-3, 3)};
        six_degrees_joint j;
        set_all(j, joint_axis::locked());
        frames at;
        at.rotation_a = random_rotation(dice);
        at.rotation_b = at.rotation_a * by_angles(angle[0], angle[1], angle[2]);
        const auto turned = physics::detail::count_turns(j, at, physics::detail::angle_list<six_degrees_joint, S>{});
        at.turned = turned.begin();
        row rows[six_degrees_joint::row_count];
        j.rows(at, rows);
        for (int k = D == 2 ? 2 : 0; k < 3; ++k)
            CHECK(std::abs(number(rows[six_degrees_joint::row_count - 4 * (3 - k) + 2].error) - angle[k]) <
                  number(cell::tolerance(64)) * 8);
    }
}

inline six_degrees_joint all_locked() {
    six_degrees_joint j;
    set_all(j, joint_axis::locked());
    return j;
}
template <class World>
void what_is_locked_holds_and_what_is_free_moves(int substeps, bool swapped) {
    const auto join = [&](World& w, body_id a, body_id b, six_degrees_joint j) {
        if (!swapped) return w.create_joint(a, b, j);
        std::swap(j.frame_a, j.frame_b);
        return w.create_joint(b, a, j);
    };
    {
        // All locked: it bears its weight and the moment of that.
        World w = falling<World>(substeps);
        const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0.5, 0), 0.5, 0.125);
        six_degrees_joint j = all_locked();
        j.frame_b = frame(-0.5);
        const joint_id weld = join(w, a, b, j);
        w.set_can_sleep(b, false);
        run(w, 128);
        CHECK(length_of(w.position(b) - at(0.5, 0)) < 1e-4);
        CHECK(std::abs(std::abs(number(w.reaction(weld).force[1])) - gravity) < 1e-3);
        // All free: nothing.
        World alone = falling<World>(substeps);
        const body_id c = add_box(alone, at(0.5, 0), 0.5, 0.125);
        w.set_pose(b, at(0.5, 0), {});
        w.set_linear_velocity(b, at(0, 0));
        set_spin(w, b, 1);
        set_spin(alone, c, 1);
        w.set_joint(weld, six_degrees_joint{});
        run(w, 32);
        run(alone, 32);
        CHECK(length_of(w.position(b) - alone.position(c)) < number(cell::tolerance(64)));
    }
    {
        // A length is free: it slides down its slope.
        World w = falling<World>(substeps);
        const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0, 0), 0.125, 0.125);
        six_degrees_joint j = all_locked();
        j.frame_a.rotation = j.frame_b.rotation = turn(-pi / 6);
        j.x = {};
        const joint_id slider = join(w, a, b, j);
        run(w, 64);
        CHECK(std::abs(length_of(w.linear_velocity(b)) - gravity / 2) < 2e-3);
        CHECK(std::abs(length_of(w.reaction(slider).force) - gravity * std::cos(pi / 6)) < 2e-3);
    }
    {
        // An angle is free: a rod swings from its hinge.
        World w = falling<World>(substeps);
        const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0.5, 0), 0.5, 1.0 / 128);
        six_degrees_joint j = all_locked();
        j.frame_b = frame(-0.5);
        j.angle_z = {};
        join(w, a, b, j);
        double fastest = 0;
        for (int i = 0; i < 60; ++i) {
            run(w, 1, 1.0 / 60);
            fastest = std::max(fastest, std::abs(z_of(w.angular_velocity(b))));
            CHECK(length_of(w.pose(b) * at(-0.5)) < 1e-3 / (substeps * substeps));
        }
        CHECK(std::abs(fastest - std::sqrt(3 * gravity)) < 0.02);
    }
}
CELL_CASE("joint axes: what is locked holds, and what is free moves") {
    for (const int substeps : {1, 4})
        for (const bool swapped : {false, true}) {
            CAPTURE(substeps);
            CAPTURE(swapped);
            what_is_locked_holds_and_what_is_free_moves<plain>(substeps, swapped);
            what_is_locked_holds_and_what_is_free_moves<iterative>(substeps, swapped);
        }
}
CELL_CASE("joint axes: lengths and angles are limited, driven and sprung by themselves") {
    for (const int substeps : {1, 4})
        for (const double sign : {1.0, -1.0}) {
            CAPTURE(substeps);
            CAPTURE(sign);
            plain w = falling<plain>(substeps, 0);
            const body_id a = add_anchor(w, at(0, 0)), b = add_flywheel(w, at(0, 0));
            six_degrees_joint j = all_locked();
            j.x = {.motor_speed = S(sign), .max_motor = S(2)};
            j.y = {.frequency = S(1), .rest = S(sign)};
            j.angle_z = {.min = S(-1), .max = S(8)};
            const joint_id all = w.create_joint(a, b, j);
            set_spin(w, b, 5 * sign);
            run(w, 32);
            CHECK(std::abs(number(w.position(b)[1]) - 2 * sign) < 0.02);
            run(w, 224);
            // It drives up to its speed within half a second.
            CHECK(std::abs(number(w.position(b)[0]) - sign * 3.75) < 0.02);
            CHECK(std::abs(number(w.position(b)[1])) < 0.02 + 0.5 / (substeps * substeps));
            const vec x = w.pose(b).rotation * at(1);
            const double end = sign > 0 ? 8 : -1;
            CHECK(length_of(x - at(std::cos(end), std::sin(end))) < 1e-3);
            if constexpr (D == 2) CHECK(std::abs(number(w.joint_angle(all)) - end) < 1e-3);
            CHECK(std::abs(z_of(w.angular_velocity(b))) < 1e-3);
        }
}
template <class Joint>
void a_cross_turns_two_ways() {
    if constexpr (D == 3) {
        plain w = falling<plain>(4, 0);
        const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0, 0), 0.25, 0.5);
        Joint j = all_locked();
        j.angle_x = {.motor_speed = S(4), .max_motor = S(100)};
        j.angle_z = {.motor_speed = S(1), .max_motor = S(100)};
        const joint_id cross = w.create_joint(a, b, j);
        run(w, 256);
        CHECK(std::abs(number(w.joint_angle(cross)) - 16) < 0.02);
        // y stays: the z axis of B across the x axis of A.
        CHECK(std::abs(number((w.pose(b).rotation * at(0, 0, 1))[0])) < 1e-3);
        CHECK(std::abs(number((w.pose(b).rotation * at(1))[0]) - std::cos(4.0)) < 0.02);
    }
}
CELL_CASE("joint axes: a universal joint leaves two angles free, over any number of turns") {
    a_cross_turns_two_ways<six_degrees_joint>();
}

template <class Joint, class F>
void refuses_angles(F&& refuses) {
    if constexpr (D == 3) {
        refuses("z.min", Joint{.z = {.min = S(1), .max = S(0)}});
        refuses("angle_x.max_motor", Joint{.angle_x = {.max_motor = S(-1)}});
        refuses("angle_y.min", Joint{.angle_x = joint_axis::locked()});
        refuses("angle_y.max", Joint{.angle_x = joint_axis::locked(), .angle_y = {.min = S(-1)}});
        refuses("angle_y.min", Joint{.angle_y = {.frequency = S(1)}});
    }
}
CELL_CASE("joint axes: bad ones are refused by name") {
    plain w = falling<plain>();
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(1));
    const auto refuses = [&](const char* field, const auto& joint) { is_refused(w, a, b, field, joint); };
    refuses("x.min", six_degrees_joint{.x = {.min = S(1), .max = S(0)}});
    refuses("y.max_motor", six_degrees_joint{.y = {.max_motor = S(-1)}});
    refuses("y.frequency", six_degrees_joint{.y = {.frequency = S(-1)}});
    refuses("angle_z.damping_ratio", six_degrees_joint{.angle_z = {.damping_ratio = S(-1)}});
    refuses_angles<six_degrees_joint>(refuses);
    if constexpr (!cell::is_fixed) {
        const S bad = S(0) / S(0);
        refuses("x.rest", six_degrees_joint{.x = {.rest = bad}});
        refuses("x.min", six_degrees_joint{.x = {.min = bad}});
        refuses("y.max", six_degrees_joint{.y = {.max = bad}});
        refuses("angle_z.motor_speed", six_degrees_joint{.angle_z = {.motor_speed = bad}});
    }
}

}  // namespace axis_laws
}  // namespace
