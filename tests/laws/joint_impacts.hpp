// Laws of what joints hold together and what it lands on: it stays there, and so does what is drawn together there.
#pragma once

#include "joint_cell.hpp"

namespace {
namespace joint_impact_laws {

using namespace joint_laws;
using ball_joint = physics::ball_joint<S, D>;
using weld_joint = physics::weld_joint<S, D>;
using plain = physics::world<joined<>>;
using hard = physics::world<joined<physics::sequential_impulse>>;

/// Boxes of 1 kg that are welded to each other, one upon the other; the lowest begins at that height.
template <class World>
std::vector<body_id> add_column(World& w, int count, double x, double height) {
    std::vector<body_id> all;
    for (int i = 0; i < count; ++i) {
        all.push_back(add_box(w, at(x, height + 0.25 + 0.5 * i), 0.25, 0.25));
        w.set_can_sleep(all.back(), false);
        if (i == 0) continue;
        weld_joint joint;
        joint.frame_a.position = at(0, 0.25);
        joint.frame_b.position = at(0, -0.25);
        w.create_joint(all[all.size() - 2], all.back(), joint);
    }
    return all;
}
template <class World>
void add_ground(World& w) {
    w.create_shape(w.create_body({.type = body_type::static_body}), typename World::halfspace{});
}
template <class World>
vec mean_velocity(const World& w, const std::vector<body_id>& bodies) {
    vec sum{};
    for (const body_id b : bodies) sum = sum + w.linear_velocity(b);
    return sum * S(1.0 / double(bodies.size()));
}
template <class World>
double fastest_rise(World& w, const std::vector<body_id>& bodies, int steps) {
    double fastest = 0;
    for (int i = 0; i < steps; ++i) {
        w.step(S(1.0 / 64));
        fastest = std::max(fastest, number(mean_velocity(w, bodies)[1]));
    }
    return fastest;
}

/// How fast a column that has fallen on the ground at 10 m/s leaves it. Without restitution it would not.
template <class World>
double rebound(int count, int substeps, bool direct) {
    World w = falling_by<World>(substeps, direct);
    add_ground(w);
    const auto column = add_column(w, count, 0, 0.05);
    for (const body_id b : column) w.set_linear_velocity(b, at(0, -10));
    const double result = fastest_rise(w, column, 48);
    if (direct)
        for (std::size_t i = 1; i < column.size(); ++i)
            CHECK(std::abs(distance_of(w, column[i - 1], column[i]) - 0.5) < (substeps == 1 ? 0.2 : 0.02));
    return result;
}
CELL_CASE("joint impacts: what lands in one piece does not leave the ground again") {
    for (const int substeps : {1, 4, 16, 64})
        for (const int count : {1, 2, 6}) {
            CAPTURE(substeps);
            CAPTURE(count);
            const double most = count == 1 ? 0.1 : count == 2 ? 1.5 : 3.5;
            CHECK(rebound<plain>(count, substeps, true) < most);
            CHECK(rebound<hard>(count, substeps, true) < most);
            CHECK(rebound<hard>(count, substeps, false) < most);
            if (substeps < 64) CHECK(rebound<plain>(count, substeps, false) < 1.5 * most);
        }
}

/// A box is put where its weld does not hold it: into the one below, above its place, or beside it.
template <class World>
void is_drawn_back(const vec& by, int substeps, bool direct) {
    World w = falling_by<World>(substeps, direct);
    add_ground(w);
    const auto column = add_column(w, 2, 0, 0);
    run(w, 32);
    w.set_pose(column[1], {w.position(column[1]) + by, w.pose(column[1]).rotation});
    CHECK(fastest_rise(w, column, 32) < 3);
    run(w, 32);
    CHECK(std::abs(distance_of(w, column[0], column[1]) - 0.5) < 0.02);
}
CELL_CASE("joint impacts: what is drawn together on the ground is not thrown") {
    for (const int substeps : {1, 4, 16, 64})
        for (const bool direct : {true, false})
            for (const vec& by : {at(0, -0.2), at(0, 0.2), at(0.2, 0)}) {
                CAPTURE(substeps);
                CAPTURE(direct);
                CAPTURE(number(by[0]));
                CAPTURE(number(by[1]));
                is_drawn_back<plain>(by, substeps, direct);
                is_drawn_back<hard>(by, substeps, direct);
            }
}

/// How far a bridge that is taut opens under boxes that fall on it, and how far it is open in the end (m).
struct opening {
    double largest = 0, last = 0;
};
template <class World>
opening bridge_under_boxes(int substeps, double friction, double mass) {
    World w = falling_by<World>(substeps, true);
    const std::vector<body_id> planks = add_taut_bridge(w, 24, friction);
    for (const double x : {6.0, 11.5, 12.5}) {
        const body_id box = w.create_body({.position = at(x, 2 + x / 8)});
        w.create_shape(box, typename World::box{vec::filled(S(0.25))}, {.density = S(mass * (D == 2 ? 4 : 8))});
    }
    opening result;
    for (int i = 0; i < 256; ++i) {
        w.step(S(1.0 / 64));
        result.last = widest_gap(w, planks);
        result.largest = std::max(result.largest, result.last);
    }
    return result;
}
CELL_CASE("joint impacts: what falls on a bridge does not open it") {
    for (const int substeps : {4, 16})
        for (const double friction : {0.0, 20.0})
            for (const double mass : {1.0, 20.0}) {
                if (substeps > 4 && mass == 1) continue;  // For time: heavy ones open it more.
                CAPTURE(substeps);
                CAPTURE(friction);
                CAPTURE(mass);
                const opening open = bridge_under_boxes<plain>(substeps, friction, mass);
                CHECK(open.largest < 0.01);
                CHECK(open.last < 1e-3);
            }
}

/// Where bodies are that have landed: a column, a pile of boxes, or both far from each other.
template <class World>
std::vector<vec> landed(bool column, bool pile) {
    World w = falling<World>();
    add_ground(w);
    std::vector<body_id> all;
    if (column) all = add_column(w, 5, -40, 0.5);
    if (pile) {
        for (int i = 0; i < 6; ++i) all.push_back(add_box(w, at(40 + 0.0625 * i, 0.5 + 0.75 * i), 0.25, 0.25));
        // One lies on a pair that a joint holds together.
        all.push_back(add_box(w, at(60, 0.25), 0.25, 0.25));
        all.push_back(add_box(w, at(60.75, 0.25), 0.25, 0.25));
        w.create_joint(all[all.size() - 2], all.back(), ball_joint{.anchor_a = at(0.375), .anchor_b = at(-0.375)});
        all.push_back(add_box(w, at(60.375, 0.875), 0.25, 0.25));
    }
    run(w, 96);
    std::vector<vec> places;
    for (const body_id b : all) places.push_back(w.position(b));
    return places;
}
template <class World>
void others_change_no_bit() {
    std::vector<vec> apart = landed<World>(true, false);
    for (const vec& place : landed<World>(false, true)) apart.push_back(place);
    CHECK(apart == landed<World>(true, true));
}
CELL_CASE("joint impacts: what lands elsewhere changes no bit") {
    others_change_no_bit<plain>();
    others_change_no_bit<hard>();
}

template <class World>
void heavy_bodies_are_pulled_as_light_ones(bool direct) {
    const auto scale = [](World& w, body_id b, double mass) {
        auto m = w.mass(b);
        m.mass = S(mass);
        m.inertia = m.inertia * S(mass);
        w.set_mass(b, m);
    };
    for (const double mass : {0.01, 1.0, 1e2, 1e4, 1e6, 1e7})
        for (const double speed : {0.1, 1.0, 10.0, 100.0, 1e4}) {
            CAPTURE(mass);
            CAPTURE(speed);
            auto w = falling_by<World>(4, direct);
            auto settings = w.settings();
            settings.gravity = {};
            w.set_settings(settings);
            const body_id at_rest = add_ball(w, at(0)), pulls = add_ball(w, at(2));
            scale(w, at_rest, mass);
            scale(w, pulls, 3 * mass);
            const joint_id joint = w.create_joint(at_rest, pulls, ball_joint{.anchor_a = at(1), .anchor_b = at(-1)});
            w.set_linear_velocity(pulls, at(speed));
            const double momentum = 0.75 * mass * speed, most = number(cell::traits::max());
            if (cell::is_fixed && momentum > most / 8) {
                CHECK_THROWS(w.step(S(1.0 / 64)));
                CHECK(w.linear_velocity(pulls) == at(speed));
                continue;
            }
            w.step(S(1.0 / 64));
            for (const body_id b : {at_rest, pulls})
                CHECK(number(w.linear_velocity(b)[0]) == doctest::Approx(0.75 * speed).epsilon(2e-3));
            const double force = std::min(momentum * 64, most);
            CHECK(number(w.reaction(joint).force[0]) == doctest::Approx(-force).epsilon(0.02));
        }
}
CELL_CASE("joint impacts: heavy bodies are pulled along as light ones, or the step is refused") {
    for (const bool direct : {true, false}) {
        CAPTURE(direct);
        heavy_bodies_are_pulled_as_light_ones<plain>(direct);
        heavy_bodies_are_pulled_as_light_ones<hard>(direct);
    }
}

}  // namespace joint_impact_laws
}  // namespace
