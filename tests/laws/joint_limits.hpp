// Laws of what is told of joints that come to their limits and leave them.
#pragma once

#include <map>

#include "joint_cell.hpp"

namespace {
namespace joint_limit_laws {

using namespace joint_laws;
using revolute_joint = physics::revolute_joint<S, D>;
using prismatic_joint = physics::prismatic_joint<S, D>;
using namespace physics::event;
template <class... Policies>
struct limited : physics::recipe<S, D, few,
                                 physics::joints<physics::revolute_joint, physics::prismatic_joint,
                                                 physics::distance_joint, physics::gear_joint>,
                                 physics::events<joint_limit>, Policies...> {};
using world = physics::world<limited<>>;

/// Which joints are at a limit, by what has been told; each begin is followed by one end.
template <class World>
struct tally {
    std::map<joint_id, int> at_limit;
    int begun = 0, ended = 0, gone = 0;

    void note(const World& w) {
        for (const auto& e : w.joint_limit_end_events()) {
            CHECK(--at_limit[e.joint] == 0);
            CHECK(e.gone == !w.contains(e.joint));
            CHECK(e.user_data == e.joint.index + 5);
            gone += e.gone;
            ++ended;
        }
        for (const auto& e : w.joint_limit_begin_events()) {
            CHECK(++at_limit[e.joint] == 1);
            CHECK_FALSE(e.gone);
            CHECK((e.body_a == w.body_a(e.joint) && e.body_b == w.body_b(e.joint)));
            ++begun;
        }
    }
    [[nodiscard]] bool is(int b, int e) const { return begun == b && ended == e; }
};
template <class World, class Joint>
joint_id join(World& w, body_id a, body_id b, const Joint& joint) {
    const joint_id j = w.create_joint(a, b, joint);
    w.set_user_data(j, j.index + 5);
    return j;
}
template <class World>
void turn_by(World& w, body_id b, double torque) {
    typename World::angular t{};
    set_z(t, torque);
    w.apply_torque(b, t);
}

/// A door that is pushed to and fro between its stops.
template <class World>
void tells_of_stops() {
    for (const int substeps : {1, 4, 16})
        for (const double rate : {30.0, 60.0, 240.0}) {
            CAPTURE(substeps);
            CAPTURE(rate);
            World w = falling<World>(substeps, 0);
            const body_id frame_of = add_anchor(w, at(0, 0)), door = add_box(w, at(0.5), 0.5, 0.125);
            const joint_id hinge = join(
                w, frame_of, door,
                revolute_joint{.frame_b = frame(-0.5), .min_angle = -cell::real(0.5), .max_angle = cell::real(0.5)});
            tally<World> told;
            const auto push = [&](double torque) {
                for (int i = 0; i < rate; ++i) {
                    turn_by(w, door, torque);
                    w.step(S(1 / rate));
                    told.note(w);
                }
            };
            push(4);
            CHECK(told.is(1, 0));
            CHECK(std::abs(number(w.joint_angle(hinge)) - 0.5) < 0.02);
            // It is let go: nothing presses, but it stays there.
            push(0);
            CHECK(told.is(1, 0));
            push(-4);
            CHECK(told.is(2, 1));
            push(4);
            CHECK(told.is(3, 2));
            turn_by(w, door, 4);
            w.destroy_joint(hinge);
            w.step(S(1 / rate));
            told.note(w);
            CHECK(told.is(3, 3));
            CHECK(told.gone == 1);
            w.step(S(1 / rate));
            CHECK(w.joint_limit_end_events().size() == 0);
        }
}
CELL_CASE("joint limits: a door tells of its stops once each, and of leaving them, at any rate") {
    SUBCASE("soft_step") { tells_of_stops<world>(); }
    SUBCASE("sequential_impulse") { tells_of_stops<physics::world<limited<physics::sequential_impulse>>>(); }
}

CELL_CASE("joint limits: ropes that become taut and sliders at their ends tell of it, motors and springs do not") {
    world w = falling<world>();
    const body_id sky = add_anchor(w, at(0, 0));
    tally<world> told;
    const body_id roped = add_ball(w, at(0, -0.5)), slid = add_ball(w, at(2)), held = add_ball(w, at(4)),
                  driven = add_ball(w, at(6));
    const joint_id rope = join(w, sky, roped, distance_joint{.length = S(1), .min_length = S(0)});
    const joint_id slider = join(
        w, sky, slid,
        prismatic_joint{.frame_a = frame(2, 0, -pi / 2), .frame_b = frame(0, 0, -pi / 2), .max_translation = S(0.5)});
    join(w, sky, held,
         prismatic_joint{.frame_a = frame(4, 0, -pi / 2), .frame_b = frame(0, 0, -pi / 2), .frequency = S(2)});
    join(w, sky, driven,
         prismatic_joint{.frame_a = frame(6, 0, -pi / 2),
                         .frame_b = frame(0, 0, -pi / 2),
                         .motor_speed = S(1),
                         .max_motor_force = S(5)});
    for (int i = 0; i < 240; ++i) {
        w.step(S(1.0 / 60));
        told.note(w);
    }
    CHECK(told.at_limit[rope] == 1);
    CHECK(told.at_limit[slider] == 1);
    CHECK(told.begun - told.ended == 2);
    CHECK(told.at_limit.size() == 2);
}

/// An arm that hangs on its stop.
struct hanging {
    world w = falling<world>();
    body_id anchor, arm;
    joint_id hinge;
    tally<world> told;

    hanging() {
        anchor = add_anchor(w, at(0, 0));
        arm = add_box(w, at(0.5), 0.5, 0.125);
        hinge = join(w, anchor, arm, revolute_joint{.frame_b = frame(-0.5), .min_angle = S(-0.125)});
        step(30);
        REQUIRE(told.is(1, 0));
    }
    void step(int count) {
        for (int i = 0; i < count; ++i) {
            w.step(S(1.0 / 60));
            told.note(w);
        }
    }
};
CELL_CASE("joint limits: sleep ends none, and what takes a joint away does, by whatever call") {
    SUBCASE("sleep") {
        hanging h;
        h.step(300);
        REQUIRE(h.w.is_asleep(h.arm));
        CHECK(h.told.is(1, 0));
        h.w.wake(h.arm);
        h.step(5);
        CHECK(h.told.is(1, 0));
        h.step(300);
        h.w.destroy_joint(h.hinge);
        h.step(1);
        CHECK(h.told.is(1, 1));
        CHECK(h.told.gone == 1);
    }
    SUBCASE("disabled joint") {
        hanging h;
        h.w.set_joint_enabled(h.hinge, false);
        h.step(1);
        CHECK(h.told.is(1, 1));
    }
    SUBCASE("disabled body") {
        hanging h;
        h.w.set_enabled(h.arm, false);
        h.step(1);
        CHECK(h.told.is(1, 1));
        h.w.set_enabled(h.arm, true);
        h.step(2);
        CHECK(h.told.is(2, 1));
    }
    SUBCASE("a body that stands from now on") {
        hanging h;
        h.w.set_type(h.arm, body_type::static_body);
        h.step(1);
        CHECK(h.told.is(1, 1));
    }
    SUBCASE("destroyed body") {
        hanging h;
        h.w.destroy_body(h.anchor);
        CHECK(h.w.joint_limit_end_events().size() == 0);
        h.step(1);
        CHECK(h.told.is(1, 1));
        CHECK(h.told.gone == 1);
    }
    SUBCASE("other limits") {
        hanging h;
        h.w.set_joint(h.hinge, revolute_joint{.frame_b = frame(-0.5), .min_angle = S(-1.5)});
        h.step(2);
        CHECK(h.told.is(1, 1));
    }
    SUBCASE("destroyed, and another under its number") {
        hanging h;
        h.w.destroy_joint(h.hinge);
        h.hinge = join(h.w, h.anchor, h.arm, revolute_joint{.frame_b = frame(-0.5), .min_angle = S(-0.125)});
        h.step(3);
        CHECK(h.told.is(2, 1));
        CHECK(h.told.at_limit[h.hinge] == 1);
    }
}

CELL_CASE("joint limits: each begin has its end, whatever is done to many arms, and copies go on alike") {
    cell::dice dice(77);
    world w = falling<world>();
    std::vector<body_id> arms;
    const auto add = [&](double x) {
        const body_id sky = add_anchor(w, at(x, 0)), arm = add_box(w, at(x + 0.5), 0.5, 0.125);
        join(w, sky, arm,
             revolute_joint{.frame_b = frame(-0.5),
                            .min_angle = dice.real(-1, -0.25),
                            .max_angle = dice.real(0.1, 1),
                            .motor_speed = dice.real(-4, 4),
                            .max_motor_torque = dice.real(0, 20)});
        arms.push_back(arm);
    };
    for (int i = 0; i < 12; ++i) add(8 * i);
    tally<world> told;
    for (int i = 0; i < 400; ++i) {
        const auto k = static_cast<std::size_t>(dice.below(static_cast<int>(arms.size())));
        const body_id arm = arms[k];
        switch (dice.below(10)) {
            case 0: w.set_enabled(arm, !w.enabled(arm)); break;
            case 1:
                for (const joint_id j : w.joints())
                    if (w.body_b(j) == arm) w.set_joint_enabled(j, !w.joint_enabled(j));
                break;
            case 2:
                w.destroy_body(arm);
                arms.erase(arms.begin() + static_cast<std::ptrdiff_t>(k));
                add(8 * dice.below(12));
                break;
            case 3:
                if (w.enabled(arm)) turn_by(w, arm, dice.number(-100, 100));
                break;
            case 4: w.set_gravity_scale(arm, dice.real(-2, 2)); break;
            default: break;
        }
        world copy = w;
        copy.step(S(1.0 / 60));
        w.step(S(1.0 / 60));
        told.note(w);
        REQUIRE(copy.joint_limit_begin_events().size() == w.joint_limit_begin_events().size());
        REQUIRE(copy.joint_limit_end_events().size() == w.joint_limit_end_events().size());
    }
    CHECK(told.begun > 40);
    CHECK(told.gone > 5);
    for (const auto& [j, n] : told.at_limit) {
        if (n == 0) continue;
        CHECK(w.contains(j));
        CHECK(w.joint_enabled(j));
        CHECK(w.enabled(w.body_b(j)));
    }
}

}  // namespace joint_limit_laws
}  // namespace
