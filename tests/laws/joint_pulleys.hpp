// Laws of pulleys: known accelerations and tensions, slack ropes, turning bodies, heavy loads, and what is refused.
#pragma once

#include "laws/joint_axes.hpp"

namespace {
namespace pulley_laws {

using namespace axis_laws;
using pulley_joint = physics::pulley_joint<S, D>;
using ball_joint = physics::ball_joint<S, D>;

using plain = physics::world<joined<>>;
using hard = physics::world<joined<physics::sequential_impulse>>;

CELL_CASE("joint pulleys: rows are the derivatives of what they measure, and moments those of their forces") {
    if constexpr (std::is_same_v<S, double>) {
        cell::dice dice(11);
        for (int i = 0; i < 300; ++i) {
            pulley_joint j;
            for (vec* v : {&j.anchor_a, &j.anchor_b, &j.ground_a, &j.ground_b}) *v = dice.vec<vec>(-1, 1);
            j.ratio = S(dice.number(0.25, 4));
            j.min_length = S(1);
            j.max_length = i % 2 == 0 ? S(1) : S(2);
            physics::grounded_frames<S, D> at;
            at.rotation_a = random_rotation(dice);
            at.rotation_b = random_rotation(dice);
            for (vec* v : {&at.center_a, &at.center_b, &at.between, &at.place_a}) *v = dice.vec<vec>(-1, 1);
            const vec v_a = dice.vec<vec>(-1, 1), v_b = dice.vec<vec>(-1, 1);
            angular w_a{}, w_b{};
            set_random(w_a, dice);
            set_random(w_b, dice);
            struct found {
                row rows[4];
                vec of_a[4];
            };
            const auto rows = [&](double h) {
                auto moved = at;
                moved.rotation_a = physics::turned(at.rotation_a, w_a * S(h));
                moved.rotation_b = physics::turned(at.rotation_b, w_b * S(h));
                moved.between += (v_b - v_a) * S(h);
                moved.place_a += v_a * S(h);
                found f;
                j.rows(moved, f.rows, f.of_a);
                return f;
            };
            const found here = rows(0), before = rows(-1e-6), after = rows(1e-6);
            for (int k = 0; k < 4; ++k) {
                const row& r = here.rows[k];
                if (!r.is_on()) continue;
                const double speed = number(dot(r.direction, v_b) - dot(here.of_a[k], v_a) + times(r.angular_a, w_a) +
                                            times(r.angular_b, w_b));
                const double found_speed = number(after.rows[k].error - before.rows[k].error) / 2e-6;
                CHECK(std::abs(found_speed - speed) < 1e-6 * (1 + std::abs(speed)));
                CHECK(size_of(r.angular_a + physics::cross(r.r_a, here.of_a[k])) < 1e-12);
                CHECK(size_of(r.angular_b - physics::cross(r.r_b, r.direction)) < 1e-12);
            }
        }
    }
}

/// Two balls of these masses that hang from one rope, side by side.
template <class World>
struct atwood {
    World w;
    double mass_a, mass_b, ratio;
    bool swapped;
    body_id a, b;
    joint_id rope;
    atwood(int substeps, double of_a, double of_b, double ratio_ = 1, bool swapped_ = false, bool rigid = false,
           bool direct = true)
        : w(falling_by<World>(substeps, direct)), mass_a(of_a), mass_b(of_b), ratio(ratio_), swapped(swapped_) {
        a = add_load(at(-1, -3), mass_a);
        b = add_load(at(1, -3), mass_b);
        pulley_joint j{.ground_a = at(-1), .ground_b = at(1), .ratio = S(ratio)};
        if (swapped) {
            std::swap(j.ground_a, j.ground_b);
            j.ratio = S(1 / ratio);
        }
        if (rigid) j.min_length = pulley_joint::as_it_stands;
        rope = swapped ? w.create_joint(b, a, j) : w.create_joint(a, b, j);
    }
    body_id add_load(const vec& where, double mass) {
        const body_id load = w.create_body({.position = where});
        const double volume = D == 2 ? pi / 16 : pi / 48;
        w.create_shape(load, typename World::ball{S(0.25)}, {.density = S(mass / volume)});
        return load;
    }
    /// Of the rope at A.
    [[nodiscard]] double tension() const { return gravity * (1 + ratio) / (1 / mass_a + ratio * ratio / mass_b); }
    [[nodiscard]] double length() const {
        return length_of(w.position(a) - at(-1)) + ratio * length_of(w.position(b) - at(1));
    }
};
template <class World>
void it_falls_as_atwoods(int substeps, double ratio, bool swapped, bool rigid, bool direct) {
    atwood<World> m(substeps, 3, 2, ratio, swapped, rigid, direct);
    const double speed = -gravity + m.tension() / 3;
    run(m.w, 16);
    const double t = 16.0 / 64, slack = direct ? 1e-3 : 0.02;
    CHECK(std::abs(number(m.w.linear_velocity(m.a)[1]) - speed * t) < slack);
    CHECK(std::abs(number(m.w.linear_velocity(m.b)[1]) + speed * t / ratio) < slack);
    CHECK(std::abs(m.length() - 3 * (1 + ratio)) < 1e-4);
    // It tells what it gives the second body, in the rope's direction.
    const vec force = m.w.reaction(m.rope).force;
    const double expected = swapped ? m.tension() : m.tension() * ratio;
    CHECK(std::abs(number(force[1]) - expected) < slack * expected);
}
CELL_CASE("joint pulleys: two loads fall as Atwood's do, by the ratio of a block and tackle") {
    for (const int substeps : {1, 2, 4, 16})
        for (const double ratio : {1.0, 2.0, 0.5, 5.0})
            for (int bits = 0; bits < 8; ++bits) {
                const bool swapped = (bits & 1) != 0, rigid = (bits & 2) != 0, direct = (bits & 4) != 0;
                CAPTURE(substeps);
                CAPTURE(ratio);
                CAPTURE(swapped);
                CAPTURE(rigid);
                CAPTURE(direct);
                it_falls_as_atwoods<plain>(substeps, ratio, swapped, rigid, direct);
                it_falls_as_atwoods<hard>(substeps, ratio, swapped, rigid, direct);
            }
}

CELL_CASE("joint pulleys: wheels move along where the world's origin is shifted") {
    for (const bool direct : {true, false}) {
        atwood<plain> still(4, 3, 2, 1, false, false, direct), moved(4, 3, 2, 1, false, false, direct);
        run(still.w, 8);
        run(moved.w, 8);
        const vec to = at(5, -3);
        moved.w.shift_origin(to);
        run(still.w, 8);
        run(moved.w, 8);
        for (const body_id* load : {&still.a, &still.b}) {
            const body_id other = load == &still.a ? moved.a : moved.b;
            CHECK(length_of(moved.w.position(other) + to - still.w.position(*load)) < 1e-3);
        }
    }
}

CELL_CASE("joint pulleys: a thousand times as heavy a load falls as it should, and a static end holds") {
    for (const int substeps : {1, 4})
        for (const double ratio : {1.0, 3.0})
            for (const double heavy : {1000.0, 0.001}) {
                CAPTURE(substeps);
                CAPTURE(ratio);
                CAPTURE(heavy);
                atwood<plain> m(substeps, heavy > 1 ? 1 : 1000, heavy > 1 ? 1000 : 1, ratio);
                run(m.w, 16);
                const double speed = (m.tension() / m.mass_a - gravity) * 0.25;
                CHECK(std::abs(number(m.w.linear_velocity(m.a)[1]) - speed) < 2e-3 * (1 + ratio));
                CHECK(std::abs(m.length() - 3 * (1 + ratio)) < 2e-4 * (1 + ratio));
            }
    plain w = falling<plain>();
    const body_id winch = w.create_body({.type = body_type::kinematic_body, .position = at(-1, -3)}),
                  load = add_ball(w, at(1, -3));
    const joint_id rope =
        w.create_joint(winch, load, pulley_joint{.ground_a = at(-1), .ground_b = at(1), .ratio = S(2)});
    run(w, 128);
    CHECK(length_of(w.position(load) - at(1, -3)) < 1e-3);
    CHECK(std::abs(number(w.reaction(rope).force[1]) - gravity) < 0.01);
    // It hauls half as fast as the rope comes in.
    w.set_linear_velocity(winch, at(0, -1));
    run(w, 64);
    CHECK(length_of(w.position(load) - at(1, -2.5)) < 5e-3);
}

/// Swinging Atwood machine: distance from the wheel, angle, and their speeds, by small steps of Runge and Kutta.
struct swinging {
    double r, angle, v = 0, spin = 0, mass_ratio;
    struct rate {
        double r, angle, v, spin;
    };
    [[nodiscard]] rate rates() const {
        return {v, spin, (r * spin * spin + gravity * (std::cos(angle) - mass_ratio)) / (1 + mass_ratio),
                (-2 * v * spin - gravity * std::sin(angle)) / r};
    }
    [[nodiscard]] swinging moved(const rate& by, double h) const {
        return {r + h * by.r, angle + h * by.angle, v + h * by.v, spin + h * by.spin, mass_ratio};
    }
    void advance(double h) {
        const rate k1 = rates(), k2 = moved(k1, h / 2).rates(), k3 = moved(k2, h / 2).rates(),
                   k4 = moved(k3, h).rates();
        *this = moved(k1, h / 6).moved(k2, h / 3).moved(k3, h / 3).moved(k4, h / 6);
    }
};
template <class World>
void it_swings_as_it_should(int substeps, bool swapped) {
    atwood<World> m(substeps, 1, 2, 1, swapped, true);
    m.w.destroy_joint(m.rope);
    swinging exact{.r = 3, .angle = 1, .mass_ratio = 2};
    m.w.set_pose(m.a, {at(-1 + 3 * std::sin(1.0), -3 * std::cos(1.0)), {}});
    pulley_joint j{.ground_a = at(-1), .ground_b = at(1), .min_length = pulley_joint::as_it_stands};
    if (swapped) std::swap(j.ground_a, j.ground_b);
    m.rope = swapped ? m.w.create_joint(m.b, m.a, j) : m.w.create_joint(m.a, m.b, j);
    double off = 0, longest = 0;
    for (int i = 0; i < 96; ++i) {
        run(m.w, 1);
        for (int k = 0; k < 16; ++k) exact.advance(1.0 / 1024);
        const vec there = at(-1 + exact.r * std::sin(exact.angle), -exact.r * std::cos(exact.angle));
        off = std::max(off, length_of(m.w.position(m.a) - there));
        longest = std::max(longest, std::abs(m.length() - 6));
    }
    // Forces of joints act from the start of a substep on: of first order, as those of motors.
    CHECK(off < 0.1 / substeps);
    // Direct solves leave to the next one what is below 16 roundings of what they measure.
    CHECK(longest < 1e-4 / substeps + number(cell::tolerance(512)));
}
CELL_CASE("joint pulleys: a load that swings goes up and down as it should") {
    for (const int substeps : {1, 4, 16})
        for (const bool swapped : {false, true}) {
            CAPTURE(substeps);
            CAPTURE(swapped);
            it_swings_as_it_should<plain>(substeps, swapped);
            it_swings_as_it_should<hard>(substeps, swapped);
        }
}

template <class World>
void a_slack_rope_lets_go_and_catches(int substeps, double ratio) {
    World w = falling<World>(substeps, 0);
    const body_id a = add_ball(w, at(-1, -3)), b = add_ball(w, at(1, -3));
    w.create_joint(
        a, b, pulley_joint{.ground_a = at(-1), .ground_b = at(1), .ratio = S(ratio), .max_length = S(4 + 3 * ratio)});
    w.set_linear_velocity(a, at(0, -2));
    run(w, 30);
    CHECK(length_of(w.position(a) - at(-1, -3 - 2 * 30.0 / 64)) < 1e-4);
    CHECK(length_of(w.position(b) - at(1, -3)) == 0);
    run(w, 4);
    // The rope's speed is gone, by one impulse.
    const double impulse = 2 / (1 + ratio * ratio);
    CHECK(std::abs(number(w.linear_velocity(a)[1]) + 2 - impulse) < 2e-3);
    CHECK(std::abs(number(w.linear_velocity(b)[1]) - ratio * impulse) < 2e-3);
    for (int i = 0; i < 16; ++i) {
        run(w, 1);
        CHECK(length_of(w.position(a) - at(-1)) + ratio * length_of(w.position(b) - at(1)) < 4 + 3 * ratio + 1e-4);
    }
}
CELL_CASE("joint pulleys: a slack rope lets bodies go, and catches them") {
    for (const int substeps : {1, 4, 16})
        for (const double ratio : {1.0, 2.0}) {
            CAPTURE(substeps);
            CAPTURE(ratio);
            a_slack_rope_lets_go_and_catches<plain>(substeps, ratio);
            a_slack_rope_lets_go_and_catches<hard>(substeps, ratio);
        }
}

template <class World>
void a_beam_hangs_between_weights(int substeps, bool direct) {
    World w = falling_by<World>(substeps, direct);
    // A beam of 1 kg whose ends hang from ropes, of which one pulls it as A and the other as B.
    const body_id beam = add_box(w, at(0, -2), 1, 0.125), left = add_ball(w, at(-3, -2)),
                  right = add_ball(w, at(3, -2));
    // Below the weights hang others.
    const body_id below = add_ball(w, at(-3, -3));
    w.create_joint(left, below, ball_joint{.anchor_b = at(0, 1)});
    const joint_id ropes[] = {
        w.create_joint(beam, left,
                       pulley_joint{.anchor_a = at(-1), .ground_a = at(-1), .ground_b = at(-3), .ratio = S(4)}),
        w.create_joint(right, beam,
                       pulley_joint{.anchor_b = at(1), .ground_a = at(3), .ground_b = at(1), .ratio = S(0.5)})};
    run(w, 512);
    const double off = direct ? 2e-3 : 0.02 / substeps;
    CHECK(length_of(w.position(beam) - at(0, -2)) < off);
    CHECK(size_of(w.angular_velocity(beam)) < 1e-3);
    CHECK(std::abs(number(w.reaction(ropes[1]).force[1]) - gravity / 2) < 0.01);
    CHECK(std::abs(number(w.reaction(ropes[0]).force[1]) - 2 * gravity) < 0.01);
}

CELL_CASE("joint pulleys: ropes at both ends of a beam, with a chain below, hold it in balance") {
    for (const int substeps : {1, 4})
        for (const bool direct : {true, false}) {
            CAPTURE(substeps);
            CAPTURE(direct);
            a_beam_hangs_between_weights<plain>(substeps, direct);
            a_beam_hangs_between_weights<hard>(substeps, direct);
        }
}

CELL_CASE("joint pulleys: what breaks a rope is what B bears") {
    for (const double limit : {39.0, 41.0}) {
        atwood<plain> m(4, 2, 4, 2);
        m.w.destroy_joint(m.rope);
        m.rope = m.w.create_joint(m.a, m.b, pulley_joint{.ground_a = at(-1), .ground_b = at(1), .ratio = S(2)},
                                  {.break_force = limit});
        run(m.w, 16);
        CHECK(m.w.joint_enabled(m.rope) == (limit > 40));
    }
}
CELL_CASE("joint pulleys: loads in balance sleep, and wake together") {
    atwood<plain> m(4, 1, 2, 2);
    for (int i = 0; i < 256; ++i) run(m.w, 1);
    CHECK(m.w.is_asleep(m.a));
    CHECK(m.w.is_asleep(m.b));
    CHECK(length_of(m.w.position(m.a) - at(-1, -3)) < 1e-3);
    m.w.apply_impulse(m.b, at(0, 1));
    run(m.w, 1);
    CHECK_FALSE(m.w.is_asleep(m.a));
}

template <class World>
void boxes_turn_on_their_ropes(int substeps) {
    World w = falling<World>(substeps);
    const body_id a = add_box(w, at(-1, -3), 0.5, 0.25), b = add_box(w, at(1, -3), 0.25, 0.5);
    const pulley_joint j{.anchor_a = at(0.5, 0.25),
                         .anchor_b = at(-0.25, 0.5),
                         .ground_a = at(-1),
                         .ground_b = at(1),
                         .min_length = pulley_joint::as_it_stands};
    const joint_id rope = w.create_joint(a, b, j);
    const double length = number(w.template joint<pulley_joint>(rope).max_length);
    const auto energy = [&] { return w.energy().kinetic + w.energy().potential; };
    const double before = energy();
    double longest = 0, gained = 0;
    for (int i = 0; i < 256; ++i) {
        run(w, 1);
        const double now = length_of(w.pose(a) * j.anchor_a - at(-1)) + length_of(w.pose(b) * j.anchor_b - at(1));
        longest = std::max(longest, std::abs(now - length));
        gained = std::max(gained, energy() - before);
    }
    // Of first order: 20 J go to and fro.
    CHECK(gained < 0.4 / substeps);
    CHECK(std::abs(energy() - before) < 0.1 / substeps);
    CHECK(longest < 2e-3 / (substeps * substeps) + number(cell::tolerance(64)));
}
CELL_CASE("joint pulleys: boxes turn on ropes that hold their corners") {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        boxes_turn_on_their_ropes<plain>(substeps);
        boxes_turn_on_their_ropes<hard>(substeps);
    }
}
CELL_CASE("joint pulleys: a load that is drawn up to its wheel stays there, and stops the other") {
    for (const int substeps : {1, 4, 16})
        for (const bool direct : {true, false}) {
            CAPTURE(substeps);
            CAPTURE(direct);
            atwood<plain> m(substeps, 1, 100, 1, false, false, direct);
            double longest = 0, fastest = 0;
            for (int i = 0; i < 512; ++i) {
                run(m.w, 1);
                if (i == 384) fastest = 0;
                longest = std::max(longest, m.length() - 6);
                fastest = std::max(fastest, length_of(m.w.linear_velocity(m.a)));
            }
            CHECK(longest < 0.06 / substeps);
            CHECK(fastest < 1e-3);
            CHECK(length_of(m.w.position(m.a) - at(-1)) < 1e-4);
            // What is held at its wheel holds the other by a spring of a fifth of the substeps' rate.
            const double omega = 2 * pi * 0.2 * 64 * substeps, sag = direct ? 0 : gravity / (omega * omega);
            CHECK(std::abs(length_of(m.w.position(m.b) - at(1)) - 6) < 1.01 * sag + 1e-3);
        }
}

}  // namespace pulley_laws
}  // namespace
