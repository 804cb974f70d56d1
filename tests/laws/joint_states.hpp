// Laws of joints that sleep and wake under load, and of mechanisms side by side in lanes.
#pragma once

#include "laws/joint_drives.hpp"
#include "laws/joint_gears.hpp"
#include "laws/joint_kinds.hpp"
#include "laws/joint_swings.hpp"

namespace {
namespace joint_state_laws {

using namespace joint_laws;
using ball_joint = physics::ball_joint<S, D>;
using revolute_joint = physics::revolute_joint<S, D>;
using prismatic_joint = physics::prismatic_joint<S, D>;
using weld_joint = physics::weld_joint<S, D>;
using wheel_joint = physics::wheel_joint<S, D>;

/// Arms that differ in how far their limits are, how hard motors drive and how stiff springs are, so that limits are
/// met and motors slip at other times in each.
template <class World>
std::vector<body_id> add_arm(World& w, int number) {
    cell::dice dice(static_cast<std::uint64_t>(number));
    const double x = 32 * number;
    const body_id a = add_anchor(w, at(x, 0)), b = add_box(w, at(x + 0.5), 0.5, 0.125),
                  c = add_box(w, at(x + 1), 0.25, 0.25), d = add_box(w, at(x + 1, -0.5), 0.25, 0.25),
                  e = add_box(w, at(x + 1.5), 0.25, 0.125);
    w.create_joint(a, b,
                   revolute_joint{.frame_b = frame(-0.5),
                                  .min_angle = dice.real(-1, -0.25),
                                  .max_angle = dice.real(0.1, 1),
                                  .motor_speed = dice.real(-4, 4),
                                  .max_motor_torque = dice.real(1, 20)});
    w.create_joint(b, c,
                   prismatic_joint{.frame_a = frame(0.5),
                                   .min_translation = dice.real(-0.5, -0.1),
                                   .max_translation = dice.real(0.1, 0.5),
                                   .motor_speed = dice.real(-2, 2),
                                   .max_motor_force = dice.real(1, 10),
                                   .frequency = dice.real(1, 3),
                                   .damping_ratio = dice.real(0, 1)});
    w.create_joint(b, d,
                   wheel_joint{.frame_a = frame(0.5, 0, -pi / 2),
                               .min_translation = dice.real(0, 0.3),
                               .max_translation = dice.real(0.6, 1),
                               .frequency = dice.real(1, 3),
                               .damping_ratio = S(0.5),
                               .rest_translation = S(0.5),
                               .motor_speed = dice.real(-9, 9),
                               .max_motor_torque = dice.real(0.1, 5)});
    w.create_joint(c, e,
                   weld_joint{.frame_a = frame(0.25),
                              .frame_b = frame(-0.25),
                              .angular_frequency = dice.real(2, 5),
                              .angular_damping_ratio = S(0.25)});
    w.set_linear_velocity(e, dice.vec<vec>(-2, 2));
    return {b, c, d, e};
}
template <class World>
void arms_have_the_bits_of_one(int count, int steps) {
    World many = falling<World>();
    std::vector<std::vector<body_id>> all;
    for (int n = 0; n < count; ++n) all.push_back(add_arm(many, n));
    run(many, steps);
    for (int n = 0; n < count; ++n) {
        CAPTURE(n);
        World one = falling<World>();
        const std::vector<body_id> arm = add_arm(one, n);
        run(one, steps);
        for (std::size_t i = 0; i < arm.size(); ++i) {
            const body_id there = all[static_cast<std::size_t>(n)][i];
            CHECK(one.position(arm[i]) == many.position(there));
            CHECK(one.pose(arm[i]).rotation == many.pose(there).rotation);
            CHECK(one.linear_velocity(arm[i]) == many.linear_velocity(there));
            CHECK(one.angular_velocity(arm[i]) == many.angular_velocity(there));
        }
    }
}
CELL_CASE("joint states: arms with limits, motors and springs side by side have the bits of each alone") {
    SUBCASE("soft_step") {
        arms_have_the_bits_of_one<kind_laws::plain>(cell::is_fixed ? 2 : 5, cell::is_fixed ? 8 : 20);
    }
    SUBCASE("sequential_impulse") {
        arms_have_the_bits_of_one<physics::world<kind_laws::joined<physics::sequential_impulse>>>(3, 8);
    }
}

/// Has a mechanism that bears a load rest until it sleeps, wakes it, and holds it to going on as it slept. `build`
/// gives its last body, the top of which is 0.125 m above its middle.
template <class World, class Build>
void wakes_as_it_slept(const std::string& name, const Build& build) {
    CAPTURE(name);
    for (const int max_direct_cost : {1024, 0}) {
        CAPTURE(max_direct_cost);
        World w = falling<World>();
        auto settings = w.settings();
        settings.solver.max_direct_cost = max_direct_cost;
        // Long enough for springs to come to rest but for some micrometres.
        settings.sleeping.time = S(1.5);
        w.set_settings(settings);
        const body_id tip = build(w);
        for (const body_id b : w.bodies()) w.set_damping(b, S(1), S(1));
        for (int i = 0; i < 600 && !w.is_asleep(tip); ++i) run(w, 1, 1.0 / 60);
        REQUIRE(w.is_asleep(tip));
        std::vector<vec> places;
        std::vector<double> forces;
        for (const body_id b : w.bodies()) places.push_back(w.position(b));
        for (const joint_id j : w.joints()) forces.push_back(length_of(w.reaction(j).force));
        // How far bodies go from there, and how fast.
        double far = 0, fast = 0;
        const auto go_on = [&](World& from, int steps) {
            far = fast = 0;
            for (int step = 0; step < steps; ++step) {
                run(from, 1, 1.0 / 60);
                std::size_t i = 0;
                for (const body_id b : from.bodies()) {
                    if (i == places.size()) break;
                    far = std::max(far, length_of(from.position(b) - places[i++]));
                    fast = std::max(fast, length_of(from.linear_velocity(b)));
                }
            }
        };
        go_on(w, 5);
        CHECK(far == 0);
        // A grain of 1 g falls on it.
        World touched = w;
        const body_id grain = touched.create_body({.position = w.position(tip) + at(0, 0.15)});
        touched.create_shape(grain, typename World::ball{S(0.02)}, {.density = S(D == 2 ? 0.8 : 30)});
        go_on(touched, 15);
        CHECK_FALSE(touched.is_asleep(tip));
        CHECK(far < 2e-4);
        CHECK(fast < 1e-3);
        w.wake(tip);
        go_on(w, 1);
        std::size_t k = 0;
        for (const joint_id j : w.joints()) {
            const double force = length_of(w.reaction(j).force);
            CHECK(std::abs(force - forces[k]) < 1e-3 * (1 + forces[k]));
            ++k;
        }
        go_on(w, 20);
        CHECK_FALSE(w.is_asleep(tip));
        CHECK(far < number(cell::tolerance(64)) + 1e-5);
        CHECK(fast < number(cell::tolerance(64)) + 5e-5);
        if (cell::is_fixed) break;
    }
}
CELL_CASE("joint states: each kind under load wakes as it slept") {
    using World = kind_laws::plain;
    const auto arm = [](World& w, double x = 0.5) { return add_box(w, at(x), 0.5, 0.125); };
    wakes_as_it_slept<World>("chain", [&](World& w) {
        const body_id a = add_anchor(w, at(0, 2)), b = add_ball(w, at(0, 1)), c = add_box(w, at(0, 0), 0.125, 0.125);
        w.create_joint(a, b, ball_joint{.anchor_b = at(0, 1)});
        w.create_joint(b, c, distance_joint{.anchor_b = at(0, 0.0625), .length = S(0.9375)});
        return c;
    });
    wakes_as_it_slept<World>("rope and spring", [&](World& w) {
        const body_id a = add_anchor(w, at(0, 2)), b = add_ball(w, at(0, 1)), c = add_box(w, at(0, 0), 0.125, 0.125);
        w.create_joint(a, b, distance_joint{.length = S(1), .min_length = S(0)});
        w.create_joint(b, c, distance_joint{.length = S(0.9), .frequency = S(3), .damping_ratio = S(1)});
        return c;
    });
    wakes_as_it_slept<World>("hinge on its limit", [&](World& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = arm(w);
        w.create_joint(a, b, revolute_joint{.frame_b = frame(-0.5), .min_angle = S(-0.125)});
        return b;
    });
    wakes_as_it_slept<World>("hinge with friction", [&](World& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = arm(w);
        w.create_joint(a, b, revolute_joint{.frame_b = frame(-0.5), .max_motor_torque = S(8)});
        return b;
    });
    wakes_as_it_slept<World>("hinge with a spring", [&](World& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = arm(w);
        w.create_joint(a, b, revolute_joint{.frame_b = frame(-0.5), .frequency = S(3), .damping_ratio = S(1)});
        return b;
    });
    wakes_as_it_slept<World>("slider on its limit", [&](World& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = arm(w);
        w.create_joint(
            a, b,
            prismatic_joint{
                .frame_a = frame(0, 0, -pi / 2), .frame_b = frame(0.25, 0, -pi / 2), .max_translation = S(0.125)});
        return b;
    });
    wakes_as_it_slept<World>("slider with friction", [&](World& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = arm(w);
        w.create_joint(
            a, b,
            prismatic_joint{
                .frame_a = frame(0, 0, -pi / 2), .frame_b = frame(0.25, 0, -pi / 2), .max_motor_force = S(12)});
        return b;
    });
    wakes_as_it_slept<World>("welds", [&](World& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = arm(w), c = arm(w, 1.5);
        w.create_joint(a, b, weld_joint{.frame_b = frame(-0.5)});
        w.create_joint(b, c,
                       weld_joint{.frame_a = frame(0.5),
                                  .frame_b = frame(-0.5),
                                  .angular_frequency = S(3),
                                  .angular_damping_ratio = S(1)});
        return c;
    });
    wakes_as_it_slept<World>("wheel", [&](World& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = arm(w);
        w.create_joint(a, b,
                       wheel_joint{.frame_a = frame(0, 0, -pi / 2),
                                   .frame_b = frame(0, 0),
                                   .frequency = S(2),
                                   .damping_ratio = S(1),
                                   .max_motor_torque = S(8)});
        return b;
    });
    wakes_as_it_slept<World>("target", [&](World& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0), 0.125, 0.125);
        w.create_joint(a, b, physics::target_joint<S, D>{.target = at(0, 0.5), .anchor_b = at(0, 0.125)});
        return b;
    });
}
inline void lock_others(physics::six_degrees_joint<S, 2>&) {}
inline void lock_others(physics::six_degrees_joint<S, 3>& j) {
    j.z = j.angle_x = j.angle_y = axis_laws::joint_axis::locked();
}
CELL_CASE("joint states: so do those of axes, motors, gears and racks") {
    wakes_as_it_slept<drive_laws::plain>("motor", [](auto& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0.5), 0.5, 0.125);
        w.create_joint(a, b,
                       physics::motor_joint<S, D>{.frame_b = frame(-0.5), .max_force = S(20), .max_torque = S(20)});
        return b;
    });
    wakes_as_it_slept<axis_laws::plain>("six degrees", [](auto& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0.5), 0.5, 0.125);
        physics::six_degrees_joint<S, D> joint{.frame_b = frame(-0.5)};
        const auto locked = axis_laws::joint_axis::locked();
        joint.x = joint.angle_z = locked;
        joint.y = {S(-0.125), S(1)};
        lock_others(joint);
        w.create_joint(a, b, joint);
        return b;
    });
    wakes_as_it_slept<gear_laws::plain>("gear", [](auto& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0, 0), 0.25, 0.25),
                      c = add_box(w, at(2.5, 0), 0.5, 0.125);
        w.create_joint(a, b, revolute_joint{.max_motor_torque = S(20)});
        w.create_joint(a, c, revolute_joint{.frame_a = frame(2), .frame_b = frame(-0.5)});
        w.create_joint(b, c, physics::gear_joint<S, D>{.frame_b = frame(-0.5), .ratio = S(2)});
        return c;
    });
    wakes_as_it_slept<gear_laws::plain>("rack", [](auto& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0, 0), 0.25, 0.25),
                      c = add_box(w, at(1, 0), 0.5, 0.125);
        w.create_joint(a, b, revolute_joint{.max_motor_torque = S(20)});
        w.create_joint(a, c, prismatic_joint{.frame_a = frame(1, 0, pi / 2), .frame_b = frame(0, 0, pi / 2)});
        w.create_joint(b, c, physics::rack_joint<S, D>{.frame_b = frame(0, 0, pi / 2), .radius = S(0.5)});
        return c;
    });
}
#if CELL_DIMENSION == 3
CELL_CASE("joint states: so does an arm on its cone") {
    wakes_as_it_slept<swing_laws::world>("swing", [](auto& w) {
        const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0.5), 0.5, 0.125);
        w.create_joint(a, b,
                       swing_laws::joint{.frame_b = frame(-0.5),
                                         .max_swing_y = S(0.125),
                                         .max_swing_z = S(0.125),
                                         .min_twist = S(-0.1),
                                         .max_twist = S(0.1)});
        return b;
    });
}
#endif

template <class World>
void joints_of_disabled_bodies_hold_nothing() {
    World w = falling<World>(), twin = falling<World>();
    const auto chain = add_chain(w, 3, at(0));
    const body_id free = add_ball(twin, at(1.5));
    std::vector<joint_id> all;
    for (std::size_t i = 1; i < 4; ++i)
        all.push_back(
            w.create_joint(chain[i - 1], chain[i], ball_joint{at(i == 1 ? 0 : 0.25), at(-0.25 - 0.25 * (i == 1))}));
    w.set_enabled(chain[2], false);
    const auto stands = w.pose(chain[2]);
    const auto step_both = [&](int steps) {
        for (int i = 0; i < steps; ++i) {
            w.step(S(1.0 / 64));
            twin.step(S(1.0 / 64));
        }
    };
    step_both(16);
    CHECK(w.pose(chain[2]) == stands);
    // The last one falls, the first one swings on.
    CHECK(w.pose(chain[3]) == twin.pose(free));
    CHECK(number(w.position(chain[1])[1]) < -0.1);
    CHECK(length_of(w.position(chain[1])) == doctest::Approx(0.5).epsilon(0.01));
    CHECK(w.joint_enabled(all[2]));
    // A joint that is made to one that is disabled waits too.
    w.destroy_joint(all[2]);
    const joint_id late = w.create_joint(chain[2], chain[3], ball_joint{at(0.25), at(-0.25)});
    step_both(16);
    CHECK(w.pose(chain[3]) == twin.pose(free));
    w.set_enabled(chain[2], true);
    step_both(256);
    CHECK(distance_of(w, chain[1], chain[2]) < 0.55);
    CHECK(distance_of(w, chain[2], chain[3]) < 0.55);
    CHECK(w.joint_enabled(late));
    // What hangs asleep falls when its anchor goes.
    for (std::size_t i = 1; i < 4; ++i) w.set_damping(chain[i], S(4), S(4));
    step_both(1500);
    CHECK(w.is_asleep(chain[3]));
    CHECK(w.island(chain[3]).size() == 3);
    w.set_enabled(chain[0], false);
    CHECK(!w.is_asleep(chain[3]));
    CHECK(w.island(chain[3]).size() == 3);
    const S before = w.position(chain[1])[1];
    step_both(32);
    // By g / c (t - (1 - e^(-c t)) / c) with the damping c.
    CHECK(number(before - w.position(chain[1])[1]) == doctest::Approx(0.71).epsilon(0.02));
}
CELL_CASE("joint states: a joint holds nothing while one of its bodies is disabled") {
    SUBCASE("soft_step") { joints_of_disabled_bodies_hold_nothing<physics::world<kind_laws::joined<>>>(); }
    SUBCASE("sequential_impulse") {
        joints_of_disabled_bodies_hold_nothing<physics::world<kind_laws::joined<physics::sequential_impulse>>>();
    }
}

}  // namespace joint_state_laws
}  // namespace
