// Laws of what joints bear: whole steps, breaking, and motors that are driven into limits.
#pragma once

#include "joint_cell.hpp"

namespace {
namespace force_laws {

using namespace joint_laws;

using plain = physics::world<joined<>>;
using split = physics::world<joined<physics::sequential_impulse>>;
using ball_joint = physics::ball_joint<S, D>;
using revolute_joint = physics::revolute_joint<S, D>;

/// A ball of 1 kg that hangs from an anchor.
template <class World>
struct hanging {
    World w = falling<World>();
    body_id top = add_anchor(w, at(0, 0)), ball = add_ball(w, at(0, -1));
    joint_id joint;
    explicit hanging(const physics::joint_def& def) {
        joint = w.create_joint(top, ball, ball_joint{.anchor_b = at(0, 1)}, def);
    }
};

template <class World>
void a_reaction_is_of_the_whole_step() {
    hanging<World> h({});
    // Steps of all lengths: what hangs still weighs as much in each.
    const double lengths[] = {1.0 / 30, 1.0 / 120, 1.0 / 60, 1.0 / 240};
    for (int i = 0; i < 200; ++i) {
        h.w.step(S(lengths[i % 4]));
        if (i > 100) CHECK(number(h.w.reaction(h.joint).force[1]) == doctest::Approx(gravity).epsilon(0.001));
    }
}
CELL_CASE("joint forces: a reaction is that of the whole step, however long it is") {
    SUBCASE("soft_step") { a_reaction_is_of_the_whole_step<plain>(); }
    SUBCASE("sequential_impulse") { a_reaction_is_of_the_whole_step<split>(); }
}

template <class World>
void a_joint_breaks_by_more_than_it_bears() {
    hanging<World> h({.break_force = 15, .user_data = 7});
    run(h.w, 100);
    CHECK(h.w.joint_enabled(h.joint));
    CHECK(h.w.broken_joints().size() == 0);
    // 4 N more do not break it, and 6 do.
    h.w.apply_force(h.ball, at(0, -4));
    run(h.w, 1);
    CHECK(h.w.joint_enabled(h.joint));
    h.w.apply_force(h.ball, at(0, -6));
    run(h.w, 1);
    CHECK_FALSE(h.w.joint_enabled(h.joint));
    REQUIRE(h.w.broken_joints().size() == 1);
    for (const auto& broken : h.w.broken_joints()) {
        CHECK(broken.joint == h.joint);
        CHECK(h.w.user_data(broken.joint) == 7);
        CHECK(number(broken.reaction.force[1]) == doctest::Approx(16).epsilon(0.001));
    }
    run(h.w, 64);
    CHECK(h.w.broken_joints().size() == 0);
    // It falls for a second, but for the step in which it broke.
    CHECK(number(h.w.position(h.ball)[1]) == doctest::Approx(-1 - gravity / 2).epsilon(0.05));
}
CELL_CASE("joint forces: a joint breaks by more than it bears in a step, and tells it") {
    SUBCASE("soft_step") { a_joint_breaks_by_more_than_it_bears<plain>(); }
    SUBCASE("sequential_impulse") { a_joint_breaks_by_more_than_it_bears<split>(); }
}

CELL_CASE("joint forces: what broke is told by copies too, and never of a later joint") {
    hanging<plain> h({.break_force = 15});
    h.w.apply_force(h.ball, at(0, -20));
    run(h.w, 1);
    plain copy = h.w, assigned = falling<plain>();
    assigned = h.w;
    for (const plain* w : {&copy, &assigned}) {
        REQUIRE(w->broken_joints().size() == 1);
        for (const auto& broken : w->broken_joints()) CHECK(w->contains(broken.joint));
    }
    // Another joint in its place is not the one that broke.
    copy.destroy_joint((*copy.broken_joints().begin()).joint);
    copy.create_joint(h.top, h.ball, ball_joint{});
    for (const auto& broken : copy.broken_joints()) CHECK_FALSE(copy.contains(broken.joint));
    assigned = plain();
    CHECK(assigned.broken_joints().size() == 0);
}

CELL_CASE("joint forces: what breaks is refused where it makes no sense") {
    plain w = falling<plain>();
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(0, -1));
    is_refused(w, a, b, "break_force", ball_joint{}, {.break_force = -1});
    is_refused(w, a, b, "break_torque", ball_joint{}, {.break_torque = std::nan("")});
}

CELL_CASE("joint forces: frames may be given in the world as it stands") {
    plain w = falling<plain>();
    const body_id a = add_box(w, at(1, 2), 0.5, 0.5), b = add_box(w, at(3, 2), 0.5, 0.5);
    transform frame{at(2, 2.5), {}};
    const joint_id hinge = w.create_joint_at(a, b, frame, revolute_joint{.max_angle = S(1)});
    const joint_id pin = w.create_joint_at(a, b, frame, ball_joint{});
    CHECK(length_of(w.template joint<revolute_joint>(hinge).frame_a.position - at(1, 0.5)) < 1e-6);
    CHECK(length_of(w.template joint<revolute_joint>(hinge).frame_b.position - at(-1, 0.5)) < 1e-6);
    CHECK(w.template joint<revolute_joint>(hinge).max_angle == S(1));
    CHECK(length_of(w.template joint<ball_joint>(pin).anchor_b - at(-1, 0.5)) < 1e-6);
}

/// A flywheel that a motor drives into a limit stops there, and the hinge bears the motor's torque.
template <class World>
void a_motor_stops_at_its_limit(int substeps, int max_direct_cost) {
    World w = falling<World>(substeps, 0);
    auto settings = w.settings();
    settings.solver.max_direct_cost = max_direct_cost;
    w.set_settings(settings);
    const body_id a = add_anchor(w, at(0, 0)), b = add_flywheel(w, at(0, 0));
    const joint_id j = w.create_joint(
        a, b, revolute_joint{.min_angle = S(-1), .max_angle = S(2), .motor_speed = S(5), .max_motor_torque = S(20)});
    for (int i = 0; i < 200; ++i) {
        w.step(S(1.0 / 64));
        CHECK(number(w.joint_angle(j)) < 2.01);
    }
    CHECK(number(w.joint_angle(j)) == doctest::Approx(2).epsilon(0.005));
    CHECK(std::abs(z_of(w.angular_velocity(b))) < 0.001);
}
CELL_CASE("joint forces: a motor stops at the limit of its joint") {
    for (const int n : {1, 2, 4, 16})
        for (const int cost : {0, 256}) {
            CAPTURE(n);
            CAPTURE(cost);
            SUBCASE("soft_step") { a_motor_stops_at_its_limit<plain>(n, cost); }
            SUBCASE("sequential_impulse") { a_motor_stops_at_its_limit<split>(n, cost); }
        }
}

CELL_CASE("joint forces: limits that are moved draw along what has come to lie beyond them") {
    for (const int n : {1, 4}) {
        CAPTURE(n);
        plain w = falling<plain>(n);
        const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0.5), 0.5, 0.125);
        revolute_joint hinge{.frame_b = frame(-0.5), .min_angle = S(-0.1), .max_angle = S(0.1)};
        const joint_id j = w.create_joint(a, b, hinge);
        run(w, 32);
        hinge.min_angle = S(1);
        hinge.max_angle = S(2);
        w.set_joint(j, hinge);
        double fastest = 0;
        for (int i = 0; i < 64; ++i) {
            run(w, 1);
            fastest = std::max(fastest, std::abs(z_of(w.angular_velocity(b))));
        }
        // Drawn, not thrown.
        CHECK(number(w.joint_angle(j)) == doctest::Approx(1).epsilon(0.001));
        CHECK(fastest < 1);
    }
}

/// Arms in a row on a wall, with friction in their hinges and limits that their weight drives them into.
CELL_CASE("joint forces: arms with friction sink to their limits, and stay there") {
    struct row {
        int arms;
        double friction;
    };
    for (const int n : {1, 4, 16})
        for (const row& of : {row{4, 0}, row{4, 0.5}, row{4, 5}, row{4, 20}, row{8, 5}, row{8, 20}}) {
            const int arms = of.arms;
            const double friction = of.friction;
            CAPTURE(n);
            CAPTURE(arms);
            CAPTURE(friction);
            plain w = falling<plain>(n);
            body_id last = add_anchor(w, at(0, 0));
            std::vector<joint_id> all;
            for (int i = 0; i < arms; ++i) {
                const body_id arm = add_box(w, at(0.4 * i + 0.2), 0.15, 0.06);
                transform frame{at(0.4 * i), {}};
                all.push_back(w.create_joint_at(
                    last, arm, frame,
                    revolute_joint{.min_angle = S(-0.25), .max_angle = S(0.25), .max_motor_torque = S(friction)}));
                last = arm;
            }
            for (int i = 0; i < 300; ++i) {
                w.step(S(1.0 / 60));
                for (const joint_id j : all) CHECK(std::abs(number(w.joint_angle(j))) < 0.26);
                CHECK(length_of(w.linear_velocity(last)) < 2 * arms);
            }
            CHECK(length_of(w.linear_velocity(last)) < 0.001);
            // The first one bears all of them.
            CHECK(number(w.reaction(all[0]).force[1]) == doctest::Approx(arms * gravity).epsilon(0.01));
        }
}

/// Arms in a row that are struck, with friction in their hinges and limits: neither drives them, so that they only
/// slow.
CELL_CASE("joint forces: friction and limits do not drive what is struck") {
    for (const int n : {1, 4, 16})
        for (int seed = 0; seed < 24; ++seed) {
            CAPTURE(n);
            CAPTURE(seed);
            cell::dice dice(static_cast<std::uint64_t>(seed));
            plain w = falling<plain>(n, 0);
            body_id last = add_anchor(w, at(0, 0));
            for (int i = 0; i < 3 + seed % 10; ++i) {
                const body_id arm = add_box(w, at(0.4 * i + 0.2), 0.15, 0.06);
                w.set_can_sleep(arm, false);
                w.set_linear_velocity(arm, at(0, dice.number(-3, 3)));
                set_spin(w, arm, dice.number(-9, 9));
                const double limit = dice.number(0.02, 0.5), friction = dice.number(0, 20);
                w.create_joint_at(
                    last, arm, transform{at(0.4 * i), {}},
                    revolute_joint{.min_angle = S(-limit), .max_angle = S(limit), .max_motor_torque = S(friction)});
                last = arm;
            }
            run(w, 1);
            double energy = w.energy().kinetic;
            for (int i = 0; i < 64; ++i) {
                run(w, 1);
                const double next = w.energy().kinetic;
                // In one substep a limit that is found too late pushes back.
                CHECK(next < 1.01 * energy + (n == 1 ? 1 : 0.01));
                energy = next;
            }
        }
}

}  // namespace force_laws
}  // namespace
