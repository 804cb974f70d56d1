// Laws of joints that drive and limit: filters, motors, and what turns in several ways.
#pragma once

#include "joint_cell.hpp"

namespace {
namespace drive_laws {

using namespace joint_laws;

using plain = physics::world<joined<>>;
using iterative = physics::world<joined<physics::sequential_impulse>>;
using filter_joint = physics::filter_joint<S, D>;
using motor_joint = physics::motor_joint<S, D>;
using target_joint = physics::target_joint<S, D>;

/// Has all joints solved one row after the other.
template <class World>
void solve_by_iterations(World& w) {
    auto settings = w.settings();
    settings.solver.max_direct_cost = 0;
    w.set_settings(settings);
}

template <class World>
void a_filter_only_keeps_bodies_from_colliding() {
    World w = falling<World>(4, 0);
    const body_id a = add_ball(w, at(0, 0), 0.25), b = add_ball(w, at(1, 0), 0.25), c = add_ball(w, at(2, 0), 0.25);
    const joint_id filter = w.create_joint(a, b, filter_joint{});
    w.set_linear_velocity(a, at(2, 0));
    run(w, 64);
    // Through one ball into the next.
    CHECK(number(w.position(a)[0]) > 1.25);
    CHECK(length_of(w.position(b) - at(1, 0)) == 0);
    CHECK(length_of(w.linear_velocity(c)) > 0.1);
    CHECK(length_of(w.reaction(filter).force) == 0);
    // Without it they push each other.
    w.destroy_joint(filter);
    w.set_pose(a, at(0, 0), {});
    w.set_linear_velocity(a, at(2, 0));
    run(w, 64);
    CHECK(number(w.position(b)[0] - w.position(a)[0]) > 0.49);
}
CELL_CASE("joint drives: a filter keeps its bodies from colliding, and is no force") {
    SUBCASE("soft_step") { a_filter_only_keeps_bodies_from_colliding<plain>(); }
    SUBCASE("sequential_impulse") { a_filter_only_keeps_bodies_from_colliding<iterative>(); }
}
CELL_CASE("joint drives: bodies of a filter sleep and wake apart, and go apart") {
    plain w = falling<plain>();
    vec up;
    up[1] = S(1);
    w.create_shape(add_anchor(w, at(0, 0)), plain::halfspace{up});
    const body_id a = add_box(w, at(0, 0.25), 0.25, 0.25), b = add_box(w, at(3, 0.25), 0.25, 0.25),
                  c = add_box(w, at(6, 0.25), 0.25, 0.25);
    w.create_joint(a, b, filter_joint{});
    w.create_joint(b, c, filter_joint{});
    w.set_can_sleep(a, false);
    run(w, 128);
    CHECK(!w.is_asleep(a));
    CHECK(w.is_asleep(b));
    CHECK(w.is_asleep(c));
    w.wake(b);
    CHECK(!w.is_asleep(b));
    CHECK(w.is_asleep(c));
    // A change wakes both: they may lie on each other.
    run(w, 128);
    const std::uint64_t before = w.state_hash();
    const joint_id filter = w.create_joint(a, c, filter_joint{});
    CHECK(!w.is_asleep(c));
    CHECK(w.state_hash() != before);
    w.destroy_body(a);
    CHECK(!w.contains(filter));
    CHECK(w.joint_count() == 1);
}

/// A direction in space, none of the axes'.
inline vec slanting() { return D == 2 ? at(0.6, 0.8) : at(0.48, 0.64, 0.6); }

template <class World>
void friction_stops_what_slides(bool directly, int substeps, const vec& n) {
    World w = falling<World>(substeps, 0);
    if (!directly) solve_by_iterations(w);
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(0, 0));
    const joint_id motor = w.create_joint(a, b, motor_joint{.max_force = S(2)});
    w.set_linear_velocity(b, n * S(3));
    run(w, 32);
    // 2 N stop 1 kg at 3 m/s after 1.5 s and 2.25 m.
    CHECK(length_of(w.reaction(motor).force + n * S(2)) < 1e-3);
    CHECK(length_of(w.linear_velocity(b) - n * S(2)) < 1e-3);
    run(w, 64);
    CHECK(length_of(w.linear_velocity(b)) < 1e-4);
    CHECK(length_of(w.position(b) - n * S(2.25)) < 3.0 / 64 / substeps);
}
CELL_CASE("joint drives: a motor's force is the same in all directions") {
    for (const int substeps : {1, 4})
        for (const bool directly : {true, false})
            for (const vec& n : {at(1), at(0, -1), slanting()}) {
                CAPTURE(substeps);
                CAPTURE(directly);
                friction_stops_what_slides<plain>(directly, substeps, n);
                friction_stops_what_slides<iterative>(directly, substeps, n);
            }
}
CELL_CASE("joint drives: friction that bears its load does not creep") {
    for (const int substeps : {1, 4})
        for (const bool directly : {true, false})
            for (const bool swapped : {false, true}) {
                CAPTURE(substeps);
                CAPTURE(directly);
                plain w = falling<plain>(substeps);
                if (!directly) solve_by_iterations(w);
                const body_id a = add_anchor(w, at(0, 0)), b = add_flywheel(w, at(0.25, 0));
                motor_joint motor{.frame_b = frame(-0.25), .max_force = S(10.1), .max_torque = S(2.6)};
                if (swapped) std::swap(motor.frame_a, motor.frame_b);
                const joint_id j = swapped ? w.create_joint(b, a, motor) : w.create_joint(a, b, motor);
                w.set_can_sleep(b, false);
                // Iterations find what it bears within some steps.
                run(w, 64);
                const auto from = w.pose(b);
                CHECK(length_of(from.position - at(0.25, 0)) < (directly ? 1e-4 : 1e-3));
                run(w, 640);
                CHECK(length_of(w.position(b) - from.position) < 1e-4);
                CHECK(length_of(w.pose(b).rotation * at(1) - from.rotation * at(1)) < 1e-4);
                CHECK(std::abs(number(w.reaction(j).force[1]) - (swapped ? -gravity : gravity)) < 1e-2);
                CHECK(std::abs(std::abs(z_of(w.reaction(j).torque)) - 0.25 * gravity) < 1e-2);
                // What is more than it gives it does not hold.
                motor.max_force = S(9.9);
                w.set_joint(j, motor);
                run(w, 64);
                CHECK(number(w.position(b)[1]) < -0.02);
            }
}
CELL_CASE("joint drives: a motor drives as seen from its A, wherever that goes") {
    for (const int substeps : {1, 4}) {
        CAPTURE(substeps);
        plain w = falling<plain>(substeps, 0);
        const body_id a = w.create_body({.type = body_type::kinematic_body}), b = add_ball(w, at(0, 1));
        set_spin(w, a, 0.5);
        motor_joint motor{.linear_velocity = at(-1), .max_force = S(1000), .max_torque = S(100)};
        set_z(motor.angular_velocity, 2);
        w.create_joint(a, b, motor);
        run(w, 128);
        const vec seen = inverse_transform(w.pose(a), w.position(b));
        CHECK(length_of(seen - at(-2, 1)) < 0.05 / substeps);
        CHECK(std::abs(z_of(w.angular_velocity(b)) - 2.5) < 1e-3);
    }
}
CELL_CASE("joint drives: a motor's springs draw frame to frame, by no more than they may") {
    for (const int substeps : {1, 4}) {
        CAPTURE(substeps);
        plain w = falling<plain>(substeps, 0);
        const body_id a = add_anchor(w, at(0, 0)), b = add_flywheel(w, at(1, 1));
        motor_joint motor{.frame_a = frame(0, 1, 2),
                          .linear_frequency = S(2),
                          .linear_damping_ratio = S(1),
                          .angular_frequency = S(1),
                          .angular_damping_ratio = S(1)};
        const joint_id j = w.create_joint(a, b, motor);
        run(w, 256);
        CHECK(length_of(w.position(b) - at(0, 1)) < 1e-3);
        CHECK(length_of(w.pose(b).rotation * at(1) - turn(2) * at(1)) < 2e-3);
        motor.frame_a.position = at(0, 1) + slanting() * S(100);
        motor.max_spring_force = S(2);
        w.set_joint(j, motor);
        run(w, 64);
        CHECK(length_of(w.position(b) - at(0, 1) - slanting()) < 0.02);
        CHECK(length_of(w.reaction(j).force - slanting() * S(2)) < 1e-2);
    }
}
CELL_CASE("joint drives: a target draws by the same force in all directions") {
    for (const int substeps : {1, 4})
        for (const bool directly : {true, false})
            for (const vec& n : {at(-1), slanting()}) {
                CAPTURE(substeps);
                CAPTURE(directly);
                plain w = falling<plain>(substeps, 0);
                if (!directly) solve_by_iterations(w);
                const body_id world = add_anchor(w, at(0, 0)), b = add_ball(w, at(1, 0));
                const joint_id mouse =
                    w.create_joint(world, b, target_joint{.target = at(1) + n * S(50), .max_force = S(2)});
                run(w, 64);
                CHECK(length_of(w.position(b) - at(1) - n) < 0.02);
                CHECK(length_of(w.reaction(mouse).force - n * S(2)) < 1e-3);
            }
}
CELL_CASE("joint drives: what hangs on a motor that slips comes along as one") {
    plain w = falling<plain>(4);
    body_id last = add_anchor(w, at(0, 0)), all[3];
    for (int i = 0; i < 3; ++i) {
        all[i] = add_ball(w, at(0.5 * (i + 1)));
        w.set_can_sleep(all[i], false);
        w.create_joint(last, all[i],
                       motor_joint{.frame_a = frame(i == 0 ? 0 : 0.25),
                                   .frame_b = frame(-0.25),
                                   .max_force = S(i == 0 ? 24 : 100),
                                   .max_torque = S(1000)});
        last = all[i];
    }
    run(w, 64);
    // Of 30 N it bears 24.
    for (int i = 0; i < 3; ++i) CHECK(length_of(w.position(all[i]) - at(0.5 * (i + 1), -1)) < 0.01);
}

CELL_CASE("joint drives: motors side by side give the bits of each alone") {
    cell::dice dice(5);
    vec speeds[9];
    for (vec& v : speeds) v = dice.vec<vec>(-3, 3);
    const auto add = [&](plain& w, int n) {
        // Far apart from each other, but at the same place in its own world.
        const body_id a = add_ball(w, at(1 + n * 64, 0)), b = add_ball(w, at(2 + n * 64, 0.5));
        w.create_joint(a, b,
                       motor_joint{.frame_a = frame(0.5),
                                   .linear_velocity = speeds[n] * S(0.25),
                                   .max_force = S(n + 0.5),
                                   .max_torque = S(0.01),
                                   .linear_frequency = S(1),
                                   .max_spring_force = S(1)});
        w.set_linear_velocity(a, speeds[n]);
        return b;
    };
    plain many = falling<plain>();
    std::vector<body_id> all;
    for (int n = 0; n < 9; ++n) all.push_back(add(many, n));
    run(many, 32);
    for (int n = 0; n < 9; ++n) {
        CAPTURE(n);
        plain one = falling<plain>();
        const body_id b = add(one, n);
        run(one, 32);
        CHECK(one.position(b) == many.position(all[static_cast<std::size_t>(n)]));
        CHECK(one.pose(b).rotation == many.pose(all[static_cast<std::size_t>(n)]).rotation);
    }
}

CELL_CASE("joint drives: bad ones are refused by name") {
    plain w = falling<plain>();
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(1));
    const auto refuses = [&](const char* field, const auto& joint) { is_refused(w, a, b, field, joint); };
    rotation stretched = turn(0);
    stretch(stretched);
    refuses("frame_a.rotation", motor_joint{.frame_a = {{}, stretched}});
    refuses("max_force", motor_joint{.max_force = S(-1)});
    refuses("max_torque", motor_joint{.max_torque = S(-1)});
    refuses("linear_frequency", motor_joint{.linear_frequency = S(-1)});
    refuses("linear_damping_ratio", motor_joint{.linear_damping_ratio = S(-1)});
    refuses("angular_frequency", motor_joint{.angular_frequency = S(-1)});
    refuses("angular_damping_ratio", motor_joint{.angular_damping_ratio = S(-1)});
    refuses("max_spring_force", motor_joint{.max_spring_force = S(-1)});
    refuses("max_spring_torque", motor_joint{.max_spring_torque = S(-1)});
    if constexpr (!cell::is_fixed) {
        motor_joint bad;
        bad.linear_velocity[1] = S(0) / S(0);
        refuses("linear_velocity.y", bad);
        bad = {};
        set_z(bad.angular_velocity, number(S(0) / S(0)));
        refuses("angular_velocity", bad);
    }
}

}  // namespace drive_laws
}  // namespace
