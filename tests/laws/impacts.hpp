// Laws of sequential_impulse in whole worlds: what bounces keeps energy, momentum and symmetry; nothing makes energy.
#pragma once

#include <algorithm>
#include <vector>

#include "../../samples/scenes.hpp"
#include "world_cell.hpp"

namespace {
namespace impacts_laws {

constexpr int D = cell::dimension;
#if CELL_DIMENSION == 3
struct rigid : physics::recipe<S, 3, physics::sequential_impulse,
                               physics::shapes<physics::ball, physics::box, physics::halfspace, physics::cylinder>> {};
#else
struct rigid : physics::recipe<S, 2, physics::sequential_impulse,
                               physics::shapes<physics::ball, physics::box, physics::halfspace>> {};
#endif
using arena = physics::world<rigid>;
using material = physics::material<S, D>;

/// Nobody sleeps; all that approaches bounces, unless it rests.
arena under_gravity(double g, double restitution_threshold = 0) {
    arena::settings_type settings;
    settings.gravity = along(1, -g);
    settings.sleeping.enabled = false;
    settings.solver.restitution_threshold = S(restitution_threshold);
    return arena(settings);
}
material elastic(double restitution = 1, double friction = 0) {
    return {.friction = S(friction), .restitution = S(restitution)};
}
body_id add_ball(arena& w, vec at, double radius, vec velocity, const material& of) {
    const body_id ball = w.create_body({.position = at, .linear_velocity = velocity});
    w.create_shape(ball, arena::ball{S(radius)}, {.material = of});
    return ball;
}
body_id add_crate(arena& w, vec at, double half, const material& of, double angle = 0, double density = 1) {
    const body_id crate = w.create_body({.position = at, .rotation = turned_about_z(angle)});
    w.create_shape(crate, arena::box{vec::filled(S(half))}, {.density = S(density), .material = of});
    return crate;
}
void add_wall(arena& w, vec at, vec half, const material& of) {
    w.create_shape(w.create_body({.type = body_type::static_body, .position = at}), arena::box{half}, {.material = of});
}
void add_floor(arena& w, const material& of) {
    w.create_shape(w.create_body({.type = body_type::static_body}), arena::halfspace{}, {.material = of});
}
/// Kinetic and potential.
double energy_of(const arena& w) {
    double sum = scenes::kinetic_energy(w);
    for (const body_id id : w.bodies())
        if (w.type(id) == body_type::dynamic_body)
            sum -= number(w.mass(id).mass) * number(dot(w.settings().gravity, w.center_of_mass(id)));
    return sum;
}
double fastest_of(const arena& w) {
    double most = 0;
    for (const body_id id : w.bodies())
        if (w.type(id) == body_type::dynamic_body) most = std::max(most, gap(w.linear_velocity(id), vec{}));
    return most;
}
/// In fixed point what is lost or gained is of the size of its spacing, whatever the mass.
const double small = cell::is_fixed ? 1e-6 : 512 * number(cell::traits::epsilon());

CELL_CASE("impacts: the velocity of a cradle's first ball goes to the last one, whether the others touch or not") {
    for (const double space : {0.0, 0.001, 0.02, 0.3})
        for (const int rate : {30, 60, 1000}) {
            CAPTURE(space);
            CAPTURE(rate);
            arena w = under_gravity(0);
            std::vector<body_id> balls;
            for (int i = 0; i < 5; ++i)
                balls.push_back(
                    add_ball(w, along(0, (1 + space) * i - (i == 0)), 0.5, along(0, i == 0 ? 7 : 0), elastic()));
            for (int i = 0; i < rate; ++i) w.step(S(1.0 / rate));
            for (int i = 0; i < 5; ++i) {
                const auto k = static_cast<std::size_t>(i);
                CHECK(gap(w.linear_velocity(balls[k]), along(0, i == 4 ? 7 : 0)) <= 7 * small);
            }
        }
}

CELL_CASE("impacts: a break of 15 balls keeps energy, momentum and its mirror symmetry") {
    for (const double space : {0.0, 0.002})
        for (const bool fenced : {false, true})
            for (const int rate : {60, 250}) {
                CAPTURE(space);
                CAPTURE(fenced);
                CAPTURE(rate);
                arena w = under_gravity(0);
                const double pitch = 0.5 + space;
                std::vector<body_id> balls{add_ball(w, along(0, -3), 0.25, along(0, 10), elastic())};
                std::vector<std::size_t> twins{0};
                for (int row = 0; row < 5; ++row)
                    for (int i = 0; i <= row; ++i) {
                        twins.push_back(balls.size() + static_cast<std::size_t>(row - 2 * i));
                        balls.push_back(
                            add_ball(w, at(0.8660254 * pitch * row, pitch * (i - 0.5 * row)), 0.25, {}, elastic()));
                    }
                if (fenced)
                    for (const double side : {-1.0, 1.0}) {
                        add_wall(w, at(0, 4 * side), vec::filled(S(1)) + along(0, 20), elastic());
                        add_wall(w, at(1 + 7 * side, 0), vec::filled(S(1)) + along(1, 20), elastic());
                    }
                const double before = energy_of(w);
                for (int i = 0; i < 2 * rate; ++i) {
                    w.step(S(1.0 / rate));
                    REQUIRE(std::abs(energy_of(w) / before - 1) <= small);
                }
                double momentum = 0;
                for (std::size_t k = 0; k < balls.size(); ++k) {
                    const vec p = w.position(balls[k]), twin = w.position(balls[twins[k]]);
                    momentum += number(w.linear_velocity(balls[k]).x) / 10;
                    // To the bit, else chaos would make what is left grow.
                    CHECK(p.x == twin.x);
                    CHECK(p.y == -twin.y);
                }
                if (!fenced) CHECK(std::abs(momentum - 1) <= small);
            }
}

CELL_CASE("impacts: a crowd of elastic balls under gravity keeps its energy") {
    arena w = under_gravity(10);
    add_floor(w, elastic());
    cell::dice dice(5);
    for (int i = 0; i < 27; ++i) {
        vec p = at(0.21 * (i % 3), 0.6 + 0.21 * (i / 3 % 3)) + dice.vec<vec>(0, 0.001);
        if (D == 3) p[D - 1] += S(0.21 * (i / 9));
        else p.x += S(0.21 * 3 * (i / 9));
        add_ball(w, p, 0.1, {}, elastic());
    }
    const double before = energy_of(w);
    double squares = 0;
    for (int i = 0; i < 1000; ++i) {
        w.step(S(0.001));
        const double off = energy_of(w) / before - 1;
        squares += off * off;
        REQUIRE(off <= 1e-3);
    }
    // Velocities are those of half a substep earlier.
    CHECK(std::sqrt(squares / 1000) <= 5e-4);
    CHECK(std::abs(energy_of(w) / before - 1) <= 1e-3);
}

CELL_CASE("impacts: elastic boxes between walls gain no energy, and lose little") {
    for (const double slop : {0.0, 0.5}) {
        arena w = under_gravity(10, slop);
        cell::dice dice(7);
        add_wall(w, at(0, -1), vec::filled(S(1)) + along(0, 9), elastic());
        for (const double side : {-1.0, 1.0}) {
            add_wall(w, at(4 * side, 10), vec::filled(S(1)) + along(1, 19), elastic());
            if (D == 3) add_wall(w, at(0, 10) + along(D - 1, 2 * side), vec::filled(S(1)) + at(9, 19), elastic());
        }
        for (int i = 0; i < 12; ++i) {
            const body_id id =
                add_crate(w, at(-1.6 + 1.6 * (i % 3), 1.5 + 1.5 * (i / 3)), 0.4, elastic(), dice.number(-1, 1));
            w.set_linear_velocity(id, at(dice.number(-2, 2), dice.number(-2, 2)));
        }
        const double before = energy_of(w);
        for (int i = 0; i < 900; ++i) {
            w.step(S(1.0 / 60));
            REQUIRE(energy_of(w) <= 1.01 * before);
        }
        CHECK(energy_of(w) >= 0.95 * before);
    }
}

CELL_CASE("impacts: a bounce gives back its share in any phase of the step") {
    for (const double restitution : {1.0, 0.5})
        for (const double rate : {30.0, 60.0, 240.0})
            for (int phase = 0; phase < 8; ++phase) {
                CAPTURE(restitution);
                CAPTURE(rate);
                CAPTURE(phase);
                for (const double speed : {1.0, 4.0}) {
                    arena w = under_gravity(0);
                    add_floor(w, elastic(restitution));
                    const body_id ball = add_ball(w, at(0, 0.5 + speed / rate * (2 + 0.125 * phase)), 0.5,
                                                  along(1, -speed), elastic(restitution));
                    for (int i = 0; i < 5; ++i) w.step(S(1 / rate));
                    CHECK(gap(w.linear_velocity(ball), along(1, restitution * speed)) <= 4 * small);
                }
                // In free fall too: to the height from which it came, again and again.
                if (restitution < 1 || rate < 60) continue;
                arena w = under_gravity(10);
                add_floor(w, elastic());
                const body_id ball = add_ball(w, at(0, 1.5 + 0.01 * phase), 0.5, {}, elastic());
                double highest = 0;
                for (int i = 0; i < 4 * rate; ++i) {
                    w.step(S(1 / rate));
                    if (i > 3 * rate) highest = std::max(highest, number(w.position(ball).y) - 0.5);
                }
                CHECK(highest == doctest::Approx(1 + 0.01 * phase).epsilon(0.005));
            }
}

CELL_CASE("impacts: what spins rubs as it bounces, and gains no energy by that") {
    for (const double restitution : {0.5, 1.0}) {
        arena w = under_gravity(10);
        add_floor(w, elastic(restitution, 0.5));
        const body_id ball = add_ball(w, at(0, 1), 0.5, at(0, -3), elastic(restitution, 0.5));
        w.set_angular_velocity(ball, about_z<arena::angular>(-20));
        const double before = energy_of(w);
        for (int i = 0; i < 240; ++i) {
            w.step(S(1.0 / 60));
            REQUIRE(energy_of(w) <= 1.01 * before);
        }
        // Slip to the left drives it to the right.
        CHECK(number(w.linear_velocity(ball).x) > 1);
    }
}

CELL_CASE("impacts: overlaps part no faster than the settings say, and nobody keeps that speed") {
    for (const double overlap : {0.25, 0.5, 0.9}) {
        CAPTURE(overlap);
        arena w = under_gravity(10, 0.5);
        add_floor(w, elastic(0, 0.6));
        for (int row = 0; row < 4; ++row)
            for (int i = 0; i < 4 - row; ++i)
                add_crate(w, at((1 - overlap) * (i - 0.5 * (3 - row)), 0.5 + (1 - overlap) * row), 0.5,
                          elastic(0, 0.6));
        const double push = number(w.settings().solver.max_depenetration_speed);
        for (int i = 0; i < 72; ++i) {
            std::vector<vec> before;
            for (const body_id id : w.bodies()) before.push_back(w.position(id));
            w.step(S(1.0 / 60));
            std::size_t k = 0;
            for (const body_id id : w.bodies()) REQUIRE(60 * gap(w.position(id), before[k++]) <= 1.25 * push);
            REQUIRE(fastest_of(w) <= 0.5 * push);
        }
        CHECK(scenes::deepest_overlap(w) <= 0.0075);
    }
}

CELL_CASE("impacts: a squeeze throws nobody much faster than what squeezes, or than overlaps are pushed") {
    for (const int steps : {8, 40})
        for (const double rate : {60.0, 480.0}) {
            for (const double restitution : {0.0, 1.0}) {
                CAPTURE(restitution);
                CAPTURE(steps);
                CAPTURE(rate);
                arena w = under_gravity(10, 0.5);
                add_floor(w, elastic(restitution, 0.5));
                for (int i = 0; i < 6; ++i) add_crate(w, at(i % 3 - 1, 0.5 + i / 3), 0.5, elastic(restitution, 0.5));
                std::vector<body_id> jaws;
                for (const double side : {-1.0, 1.0}) {
                    jaws.push_back(w.create_body({.type = body_type::kinematic_body, .position = at(2 * side, 2)}));
                    w.create_shape(jaws.back(), arena::box{vec::filled(S(3)) - along(0, 2.5)},
                                   {.material = elastic(restitution)});
                }
                const double speed = 0.8 / steps * rate;
                double fastest = 0;
                for (int i = 0; i < steps + 60; ++i) {
                    for (int k = 0; k < 2 && i < steps; ++k)
                        w.move_to(jaws[static_cast<std::size_t>(k)], at((2 - 0.8 * (i + 1) / steps) * (2 * k - 1), 2),
                                  arena::rotation_type{});
                    w.step(S(i < steps ? 1 / rate : 1.0 / 60));
                    fastest = std::max(fastest, fastest_of(w));
                }
                // Elastic jaws strike each body once a step, from both sides.
                const double strikes = restitution > 0 ? 5 : 2;
                CHECK(fastest <= std::max(speed, number(w.settings().solver.max_depenetration_speed)) * strikes + 2);
            }
        }
}

CELL_CASE("impacts: at the defaults a column of 20 crates stands, and a crate bears a hundred times its mass") {
    arena w = under_gravity(10, 0.5);
    add_floor(w, elastic(0, 0.6));
    body_id top;
    for (int i = 0; i < 20; ++i) top = add_crate(w, at(0, 0.5 + i), 0.5, elastic(0, 0.6));
    const body_id light = add_crate(w, at(9, 0.5), 0.5, elastic(0, 0.6));
    const body_id heavy = add_crate(w, at(9, 1.5), 0.5, elastic(0, 0.6), 0, 100);
    for (int i = 0; i < 600; ++i) w.step(S(1.0 / 60));
    CHECK(gap(w.position(top), at(0, 19.5)) <= 0.03);
    CHECK(gap(w.position(light), at(9, 0.5)) <= 0.02);
    CHECK(gap(w.position(heavy), at(9, 1.5)) <= 0.03);
    CHECK(fastest_of(w) <= 0.02);
}

#if CELL_DIMENSION == 3
CELL_CASE("impacts: a coin that spins on its edge, rolls or wobbles, gains no energy") {
    for (const double tilt : {0.0, 0.1, 0.3})
        for (const bool rolls : {false, true}) {
            CAPTURE(tilt);
            CAPTURE(rolls);
            arena w = under_gravity(10, 0.5);
            add_floor(w, elastic(0, 0.5));
            const double height = 0.5 * std::cos(tilt) + 0.02 * std::sin(tilt);
            const body_id coin = w.create_body({.position = at(0, height + 0.05),
                                                .rotation = turned_about_z(tilt),
                                                .linear_velocity = along(2, rolls ? 4 : 0),
                                                .angular_velocity = {S(rolls ? 8 : 0), S(rolls ? 0 : 8), S(0.5)}});
            w.create_shape(coin, arena::cylinder{S(0.02), S(0.5)}, {.material = elastic(0, 0.5)});
            const double start = energy_of(w);
            for (int i = 0; i < 1200; ++i) {
                w.step(S(1.0 / 60));
                REQUIRE(energy_of(w) <= 1.01 * start);
            }
        }
}
#endif

}  // namespace impacts_laws
}  // namespace
