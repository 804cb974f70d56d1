// Laws of what joints bear where the answer is known: chains, beams, doors, swings, and what is heavy on what is light.
#pragma once

#include "laws/joint_scenes.hpp"

namespace {
namespace joint_load_laws {

using namespace joint_scene_laws;

/// A rod of 1 kg between two points.
template <class World>
body_id add_rod(World& w, const vec& from, const vec& to) {
    const vec along = to - from;
    const body_id b = add_box(w, at(0, 0), length_of(along) / 2, 0.02);
    w.set_pose(b, {from + along * S(0.5), turn(std::atan2(number(along[1]), number(along[0])))});
    return b;
}

/// Twelve rods between two walls. Each bears half the difference of what its ends do, so that they hang in slopes
/// (i + 1/2 - n/2) l / a, with a horizontal tension of m g a / l.
template <class World>
void a_chain_hangs(int substeps) {
    constexpr int count = 12;
    const double length = 0.5, a = 2;
    World w = falling<World>(substeps);
    std::vector<vec> ends{at(0, 0)};
    for (int i = 0; i < count; ++i) {
        const double angle = std::atan((i + 0.5 - count / 2) * length / a);
        ends.push_back(ends.back() + at(length * std::cos(angle), length * std::sin(angle)));
    }
    const body_id left = add_anchor(w, ends.front()), right = add_anchor(w, ends.back());
    std::vector<body_id> rods;
    std::vector<joint_id> joints;
    for (std::size_t i = 0; i < count; ++i) {
        rods.push_back(add_rod(w, ends[i], ends[i + 1]));
        w.set_damping(rods[i], S(4), S(4));
        w.set_can_sleep(rods[i], false);
        joints.push_back(w.create_joint_at(i == 0 ? left : rods[i - 1], rods[i], transform{ends[i], {}}, ball_joint{}));
    }
    joints.push_back(w.create_joint_at(rods.back(), right, transform{ends.back(), {}}, ball_joint{}));
    w.set_linear_velocity(rods[3], at(1, 2, 1));
    run(w, 192);
    // Damping takes of the weight too what it acts on in a substep.
    for (const body_id b : rods) w.set_damping(b, S(0), S(0));
    run(w, 8);
    // The curve of an even chain through its middle and with its tension.
    const double middle = number(ends.back()[0]) / 2, lowest = number(ends[count / 2][1]);
    for (std::size_t i = 0; i < count; ++i) {
        const vec place = w.pose(rods[i]) * at(-length / 2);
        CHECK(length_of(place - ends[i]) < 2e-3);
        const double x = number(place[0]) - middle, curve = lowest + a * (std::cosh(x / a) - 1);
        CHECK(std::abs(number(place[1]) - curve) < length * length / (8 * a) + 2e-3);
    }
    for (std::size_t i = 0; i <= count; ++i) {
        const vec force = w.reaction(joints[i]).force;
        CHECK(number(force[0]) == doctest::Approx(-gravity * a / length).epsilon(0.01));
        CHECK(std::abs(number(force[1]) - gravity * (count / 2 - double(i))) < 0.3);
    }
}
CELL_CASE("joint loads: a chain hangs as it should, and pulls at both ends") { a_chain_hangs<plain>(2); }

/// Taut, it cannot sag, and only rounding and substeps let it.
template <class World>
double taut_bridge(int count, int substeps, double friction) {
    World w = falling<World>(substeps);
    const std::vector<body_id> planks = add_taut_bridge(w, count, friction);
    double gap = 0;
    for (int i = 0; i < (substeps > 4 ? 128 : 256); ++i) {
        w.step(S(1.0 / 64));
        gap = std::max(gap, widest_gap(w, planks));
    }
    return gap;
}
CELL_CASE("joint loads: a taut bridge does not open, with friction in its hinges or without") {
    for (const int substeps : {1, 4, 16})
        for (const int count : {20, 64})
            for (const double friction : {0.0, 4.0, 200.0}) {
                // For time, long ones with one friction alone.
                if (count == 64 && friction != 4) continue;
                CAPTURE(substeps);
                CAPTURE(count);
                CAPTURE(friction);
                CHECK(taut_bridge<plain>(count, substeps, friction) < (substeps == 1 ? 0.02 : 1e-3));
            }
}

template <class World>
void loads_are_split(int substeps) {
    World w = falling<World>(substeps);
    const body_id a = add_anchor(w, at(0, 0));
    // A beam on pins 1 m to either side, that is 0.5 m off the middle; along it both may bear what they like.
    const body_id beam = add_box(w, at(0.5, 0), 2, 0.125);
    const joint_id left = w.create_joint(a, beam, ball_joint{at(-1), at(-1.5)}),
                   right = w.create_joint(a, beam, ball_joint{at(1), at(0.5)});
    run(w, 64);
    const vec of_left = w.reaction(left).force, of_right = w.reaction(right).force;
    CHECK(std::abs(number(of_left[1]) - gravity / 4) < 0.01);
    CHECK(std::abs(number(of_right[1]) - 3 * gravity / 4) < 0.01);
    CHECK(std::abs(number(of_left[0]) + number(of_right[0])) < 0.01);
    if constexpr (D == 3) {
        // A door whose weight is 0.5 m off its hinges, which are 1.6 m apart: they bear its moment, and both its
        // weight; hinges bear moments too, so that of them it is the sum that is known.
        const auto moment_about = [&](joint_id j, double high) {
            const auto r = w.reaction(j);
            return number(r.torque[2]) - high * number(r.force[0]);
        };
        for (const bool are_hinges : {false, true}) {
            CAPTURE(are_hinges);
            const body_id door = add_box(w, at(0.5, 5, are_hinges ? 3 : 0), 0.5, 1);
            joint_id hinge[2];
            for (int i = 0; i < 2; ++i) {
                // Their z axis is the vertical.
                const transform at_hinge{
                    at(0, i == 0 ? 4.2 : 5.8, are_hinges ? 3 : 0),
                    World::rotation_type::from_axis_angle({S(1), S(0), S(0)}, S(-pi / 2)),
                };
                hinge[i] = are_hinges ? w.create_joint_at(a, door, at_hinge, revolute_joint{})
                                      : w.create_joint_at(a, door, at_hinge, ball_joint{});
            }
            run(w, 64);
            const vec low = w.reaction(hinge[0]).force, high = w.reaction(hinge[1]).force;
            CHECK(std::abs(number(low[1]) + number(high[1]) - gravity) < 0.01);
            CHECK(std::abs(number(low[0]) + number(high[0])) < 0.01);
            // About the lower hinge.
            CHECK(std::abs(moment_about(hinge[0], 0) + moment_about(hinge[1], 1.6) - 0.5 * gravity) < 0.02);
            if (!are_hinges) CHECK(std::abs(number(low[0]) - gravity * 0.5 / 1.6) < 0.01);
        }
    }
}
CELL_CASE("joint loads: pins of a beam and hinges of a door share its load by their places") {
    for (const int substeps : {1, 4}) {
        CAPTURE(substeps);
        loads_are_split<plain>(substeps);
        loads_are_split<bouncing>(substeps);
    }
}

CELL_CASE("joint loads: a string pulls by m g cos + m v^2 / l all the way") {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        plain w = falling<plain>(substeps);
        const double h = 1.0 / 60, omega = std::sqrt(gravity);
        const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(std::sin(1.2), -std::cos(1.2)));
        const joint_id string = w.create_joint(a, b, distance_joint{.length = S(1), .min_length = S(0)});
        const auto pull = [&] {
            const double v = length_of(w.linear_velocity(b));
            return -gravity * number(w.position(b)[1]) + v * v;
        };
        double worst = 0, before = pull();
        for (int i = 0; i < 120; ++i) {
            run(w, 1, h);
            const double after = pull();
            worst = std::max(worst, std::abs(length_of(w.reaction(string).force) - (before + after) / 2));
            before = after;
        }
        // It is that of velocities half a substep late: 3/2 m g omega h at most; and steps are seen at their ends.
        CHECK(worst < 1.5 * gravity * omega * h / substeps + gravity * omega * omega * h * h);
    }
}

/// What is heavy, on or below one link of 1 kg.
template <class World>
void light_bears_heavy(double ratio, int substeps) {
    CAPTURE(ratio);
    CAPTURE(substeps);
    World w = falling<World>(substeps);
    const body_id a = add_anchor(w, at(0, 0));
    const auto add_heavy = [&](const vec& where) {
        const body_id b = w.create_body({.position = where, .can_sleep = false});
        w.create_shape(b, typename World::box{vec::filled(S(0.5))}, {.density = S(ratio)});
        return b;
    };
    const body_id post = add_box(w, at(5, 0.5), 0.125, 0.5), above = add_heavy(at(5, 1.5)),
                  link = add_ball(w, at(0, -1)), below = add_heavy(at(0, -2.5));
    const joint_id foot = w.create_joint(a, post, weld_joint{.frame_a = frame(5), .frame_b = frame(0, -0.5)});
    w.create_joint(post, above, weld_joint{.frame_a = frame(0, 0.5), .frame_b = frame(0, -0.5)});
    const joint_id hook = w.create_joint(a, link, ball_joint{.anchor_b = at(0, 1)});
    w.create_joint(link, below, ball_joint{.anchor_b = at(0, 1.5)});
    double worst = 0;
    for (int i = 0; i < 64; ++i) {
        run(w, 1);
        worst =
            std::max({worst, length_of(w.position(above) - at(5, 1.5)), length_of(w.position(below) - at(0, -2.5))});
    }
    CHECK(worst < number(cell::tolerance(256)) + 1e-12);
    for (const joint_id j : {foot, hook})
        CHECK(number(w.reaction(j).force[1]) == doctest::Approx((ratio + 1) * gravity).epsilon(1e-4));
}
CELL_CASE("joint loads: what is light bears what is heavy up to 1,000,000 : 1, and does not give") {
    for (const double ratio : {1e2, 1e4, 1e6})
        for (const int substeps : {1, 4}) light_bears_heavy<plain>(ratio, substeps);
    light_bears_heavy<bouncing>(1e4, 4);
}
/// The widest gap in a chain of 20 rods of 1 kg that swings a ball of 100 kg at its end for 6 s, at 30 Hz.
template <class World>
double widest_gap_round_by_round(int substeps) {
    World w = falling_by<World>(substeps, false);
    body_id last = add_anchor(w, at(0, 0));
    vec end = at(0, 0);
    std::vector<std::pair<body_id, vec>> pins;
    const auto hang = [&](body_id next, const vec& far_end, const vec& pin) {
        w.create_joint(last, next, ball_joint{pins.empty() ? at(0, 0) : pins.back().second, pin});
        pins.emplace_back(next, far_end);
        last = next;
    };
    for (int i = 0; i < 20; ++i, end += at(0.5)) hang(add_rod(w, end, end + at(0.5)), at(0.25), at(-0.25));
    const body_id load = add_ball(w, end + at(0.5), 0.5);
    w.set_mass(load, [&] {
        auto heavy = w.mass(load);
        heavy.mass = S(100);
        return heavy;
    }());
    hang(load, at(0), at(-0.5));
    double widest = 0;
    for (int i = 0; i < 180; ++i) {
        w.step(S(1.0 / 30));
        for (std::size_t k = 1; k < pins.size(); ++k)
            widest = std::max(widest, length_of(w.pose(pins[k].first) * (k + 1 < pins.size() ? at(-0.25) : at(-0.5)) -
                                                w.pose(pins[k - 1].first) * at(0.25)));
    }
    return widest;
}
// Without more inertia for bodies that are pulled at (raise_inertias) links whirl off by more than the chain's 10 m.
CELL_CASE("joint loads: a heavy load does not tear off light links that are solved round by round") {
    const double widest = widest_gap_round_by_round<plain>(1), widest_of_4 = widest_gap_round_by_round<plain>(4);
    CHECK(widest < 10);
    CHECK(widest_of_4 < 1);
}

}  // namespace joint_load_laws
}  // namespace
