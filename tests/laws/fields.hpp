// Laws of fields, water and explosions: against exact answers, and integrals by grids.
#pragma once

#include <algorithm>
#include <vector>

#include "refusal.hpp"
#include "world_cell.hpp"

namespace {
namespace fields_laws {

constexpr int D = cell::dimension;
using well = physics::gravity_well<S, D>;
using wind = physics::wind<S, D>;
using water = physics::water<S, D>;
using explosion = physics::explosion<S, D>;

world empty(double gravity) { return world(world::settings_type{.gravity = along(1, gravity)}); }
template <class Shape>
body_id add(world& w, vec position, const Shape& shape, double density = 1) {
    const body_id b = w.create_body({.position = position});
    w.create_shape(b, shape, {.density = S(density)});
    return b;
}

/// Whether a point is in a shape, in its frame.
bool holds(const world::ball& b, const vec& p) { return number(length(p)) < number(b.radius); }
bool holds(const world::box& b, const vec& p) {
    for (int i = 0; i < D; ++i)
        if (std::abs(number(p[i])) > number(b.half_extents[i])) return false;
    return true;
}
bool holds(const world::capsule& c, const vec& p) {
    vec rest = p;
    rest.x -= std::min(std::max(rest.x, -c.half_length), c.half_length);
    return number(length(rest)) < number(c.radius);
}
/// What is below the water by a grid of points.
template <class Shape>
void check_displacement(const Shape& shape, cell::dice& dice) {
    for (int k = 0; k < 12; ++k) {
        water w;
        w.up = physics::normalized(along(1, 1) + dice.vec<vec>(-0.5, 0.5));
        w.height = S(dice.number(-0.5, 0.5));
        const world::transform pose{dice.vec<vec>(-0.25, 0.25), random_rotation(dice)};
        const auto found = physics::detail::displaced_by(shape, pose, w);
        constexpr int count = cell::is_2d ? 48 : 24;
        double volume = 0, whole = 0;
        vec sum;
        int places[3] = {};
        const int total = cell::is_2d ? count * count : count * count * count;
        for (int i = 0; i < total; ++i) {
            places[0] = i % count;
            places[1] = i / count % count;
            places[2] = i / count / count;
            vec p;
            for (int axis = 0; axis < D; ++axis) p[axis] = S((places[axis] + 0.5) * 1.5 / count - 0.75);
            if (!holds(shape, p)) continue;
            ++whole;
            const vec at = pose * p;
            if (number(dot(w.up, at)) > number(w.height)) continue;
            ++volume;
            sum += (at - sum) / S(volume);
        }
        const double cells = std::pow(1.5 / count, D);
        CAPTURE(whole * cells);
        CHECK(std::abs(found.volume - volume * cells) < 0.035 * whole * cells);
        if (volume > 0.1 * whole)
            for (int i = 0; i < D; ++i) CHECK(std::abs(found.first[i] - number(sum[i])) < 0.03);
        // What is below and what is above are the whole.
        water above = w;
        above.up = -w.up;
        above.height = -w.height;
        const auto other = physics::detail::displaced_by(shape, pose, above);
        const auto mass = mass_of(shape, S(1));
        const double both = found.volume + other.volume, exact = number(mass.mass);
        CHECK(both == doctest::Approx(exact).epsilon(1e-3));
        const vec center = pose * mass.center;
        for (int i = 0; i < D; ++i)
            CHECK(std::abs((found.volume * found.first[i] + other.volume * other.first[i]) / both - number(center[i])) <
                  1e-3);
    }
}
CELL_CASE("water: what is below the surface is what a grid of points counts, and the rest is above") {
    cell::dice dice(1);
    vec half = vec::filled(S(0.25));
    half.x = S(0.5);
    check_displacement(world::box{half}, dice);
    check_displacement(world::ball{S(0.5)}, dice);
    check_displacement(world::capsule{S(0.25), S(0.375)}, dice);
}
CELL_CASE("water: hulls and compounds displace what their boxes do") {
    cell::dice dice(2);
    std::vector<vec> corners;
    for (int i = 0; i < (cell::is_2d ? 4 : 8); ++i) {
        vec v;
        for (int k = 0; k < D; ++k) v[k] = S(i >> k & 1 ? 0.5 : -0.5);
        corners.push_back(v);
    }
    const auto hull = world::hull_geometry::build(corners.data(), static_cast<std::uint32_t>(corners.size()), {});
    const auto pair = world::compound_geometry::build(
        {{world::box{vec::filled(S(0.5))}, along(0, -1)}, {world::box{vec::filled(S(0.5))}, along(0, 1)}});
    for (int k = 0; k < 20; ++k) {
        water w;
        w.height = S(dice.number(-0.5, 0.5));
        const world::transform pose{dice.vec<vec>(-0.25, 0.25), random_rotation(dice)};
        const auto box = [&](vec at) {
            return physics::detail::displaced_by(world::box{vec::filled(S(0.5))},
                                                 world::transform{pose * at, pose.rotation}, w);
        };
        const auto one = box({}), of_hull = physics::detail::displaced_by(hull.shape(), pose, w);
        CHECK(std::abs(one.volume - of_hull.volume) < 1e-3);
        if (one.volume > 0.01) CHECK(largest(one.first - of_hull.first) < 1e-2);
        CHECK(std::abs(box(along(0, -1)).volume + box(along(0, 1)).volume -
                       physics::detail::displaced_by(pair.shape(), pose, w).volume) < 1e-3);
    }
}

/// Lets things come to rest in water, 1,000 times as dense as they are by default.
void float_for(world& w, const water& of, double seconds, int rate = 60) {
    for (int i = 0; i < seconds * rate; ++i) {
        apply_buoyancy(w, of, S(1.0 / rate));
        w.step(S(1.0 / rate));
    }
}
CELL_CASE("water: bodies float as deep as Archimedes says, at any rate, and rest") {
    for (const int rate : {30, 60, 240}) {
        CAPTURE(rate);
        world w = empty(-10);
        const water of{.height = S(2), .density = S(1), .drag = S(2)};
        vec flat = vec::filled(S(0.5));
        flat.y = S(0.25);
        // A raft stays flat; half of a ball is below.
        const body_id raft = add(w, at(-3, 3), world::box{flat}, 0.4),
                      ball = add(w, at(0, 3), world::ball{S(0.5)}, 0.5),
                      stone = add(w, at(3, 3), world::ball{S(0.25)}, 2);
        w.set_can_sleep(stone, false);
        float_for(w, of, 20, rate);
        CHECK(std::abs(number(w.position(raft).y) - (2 + 0.25 - 0.2)) < 0.005);
        CHECK(std::abs(number(w.position(ball).y) - 2) < 0.005);
        CHECK(largest(w.linear_velocity(raft)) < S(1e-3));
        CHECK(largest(w.linear_velocity(ball)) < S(1e-3));
        // It sinks at the speed at which drag carries what water does not: (m - m_w) g = drag m_w v.
        CHECK(std::abs(number(w.linear_velocity(stone).y) + 5) < 0.05);
    }
}
CELL_CASE("water: a box that is turned rights itself, one that flows is taken along, no drag throws back") {
    world w = empty(-10);
    vec flat = vec::filled(S(1));
    flat.y = S(0.25);
    const body_id raft = add(w, {}, world::box{flat}, 0.5);
    w.set_pose(raft, {}, turned_about_z(0.4));
    const water river{.density = S(1), .velocity = along(0, 2), .drag = S(3)};
    float_for(w, river, 20);
    CHECK(std::abs(number(w.linear_velocity(raft).x) - 2) < 0.01);
    const vec up = w.rotation(raft) * along(1, 1);
    CHECK(number(up.y) > 0.9999);
    // A drag of any size, in a step of any length.
    const water honey{.height = S(100), .density = S(1), .drag = S(1000)};
    for (const double step : {1.0 / 15, 1.0 / 60, 1.0 / 1000}) {
        w.set_settings({.gravity = {}});
        w.set_linear_velocity(raft, along(0, 4));
        w.set_angular_velocity(raft, skew(4));
        for (int i = 0; i < 5; ++i) {
            apply_buoyancy(w, honey, S(step));
            w.step(S(step));
            CHECK(number(w.linear_velocity(raft).x) > -1e-4);
            CHECK(number(w.linear_velocity(raft).x) < 4);
        }
    }
}

CELL_CASE("water: what is light comes to rest as deep as it belongs, and drag of any size only slows") {
    for (const int rate : {30, 60, 240})
        for (const double density : {0.005, 0.02, 0.1, 0.5})
            for (const double drag : {2.0, 20.0, 100.0}) {
                if (rate == 240 && drag != 2) continue;
                CAPTURE(rate);
                CAPTURE(density);
                CAPTURE(drag);
                world w = empty(-10);
                const water of{.density = S(1), .drag = S(drag)};
                vec flat = vec::filled(S(1));
                flat.y = S(0.25);
                const body_id raft = add(w, at(-5, 0.5), world::box{flat}, density),
                              ball = add(w, at(0, 0.5 * (1 - density)), world::ball{S(0.5)}, density),
                              log = add(w, at(5, 0.5), world::capsule{S(0.75), S(0.25)}, density);
                w.set_linear_velocity(ball, along(0, 0.5));
                const double seconds = 4 + 24 / std::min(drag, 6.0);
                for (int i = 0; i < seconds * rate; ++i) {
                    float_for(w, of, 1.0 / rate, rate);
                    REQUIRE(std::abs(number(w.linear_velocity(ball).x)) < 0.501);
                }
                CHECK(std::abs(number(w.position(raft).y) - (0.25 - 0.5 * density)) < 0.005);
                for (const body_id b : {raft, ball, log}) CHECK(largest(w.linear_velocity(b)) < S(0.01));
            }
}
CELL_CASE("fields: a body circles a gravity well in the time that Newton says") {
    world w = empty(0);
    const well planet{.center = at(1, 2), .radius = S(2), .acceleration = S(8)};
    // At twice the radius the acceleration is 2, and v^2 = 2 * 4.
    const body_id moon = add(w, at(5, 2), world::ball{S(0.125)});
    const double speed = std::sqrt(8.0), period = 2 * 3.14159265358979 * 4 / speed;
    w.set_linear_velocity(moon, along(1, speed));
    const int steps = 2000;
    for (int i = 0; i < steps; ++i) {
        apply_gravity_well(w, planet);
        w.step(S(period / steps));
        CHECK(std::abs(gap(w.position(moon), planet.center) - 4) < 0.05);
    }
    CHECK(gap(w.position(moon), at(5, 2)) < 0.05);
    // Inside, it swings about the centre as on a spring: a quarter of 2 pi sqrt(radius / acceleration).
    const body_id fallen = add(w, at(1, 3), world::ball{S(0.125)});
    const double quarter = 3.14159265358979 / 2 * std::sqrt(2.0 / 8);
    w.destroy_body(moon);
    for (int i = 0; i < 400; ++i) {
        apply_gravity_well(w, planet);
        w.step(S(quarter / 400));
    }
    CHECK(gap(w.position(fallen), planet.center) < 0.01);
    CHECK(std::abs(number(w.linear_velocity(fallen).y) + 2) < 0.02);
}
CELL_CASE("fields: bodies come to rest all around a planet, and sleep") {
    world w = empty(0);
    const well planet{.radius = S(4), .acceleration = S(10)};
    w.create_shape(w.create_body({.type = body_type::static_body}), world::ball{S(4)});
    std::vector<body_id> bodies;
    for (int i = 0; i < 12; ++i)
        bodies.push_back(add(w, turned_about_z(i * 0.5236) * along(0, 5), world::ball{S(0.25)}));
    for (int i = 0; i < 600; ++i) {
        apply_gravity_well(w, planet);
        w.step(S(1.0 / 60));
    }
    for (const body_id b : bodies) {
        CHECK(std::abs(gap(w.position(b), {}) - 4.25) < 0.01);
        CHECK(w.is_asleep(b));
    }
}

CELL_CASE("fields: wind takes bodies along to its own speed, and holds up what falls, at any rate") {
    for (const double step : {1.0 / 15, 1.0 / 60, 1.0 / 240}) {
        CAPTURE(step);
        world w = empty(0);
        const body_id leaf = add(w, {}, world::box{vec::filled(S(0.5))});
        double before = 0;
        for (int i = 0; i * step < 20; ++i) {
            apply_wind(w, wind{.velocity = along(0, 10), .drag = S(0.5)}, S(step));
            w.step(S(step));
            const double speed = number(w.linear_velocity(leaf).x);
            CHECK(speed >= before - 1e-4);
            CHECK(speed < 10.001);
            before = speed;
        }
        // dv/dt = k (u - v)^2: v = u - u / (1 + k u t).
        CHECK(before == doctest::Approx(10 - 10 / (1 + 0.5 * 10 * 20)).epsilon(0.002));
        world falling = empty(-10);
        const body_id stone = add(falling, {}, world::box{vec::filled(S(0.5))}, 2);
        for (int i = 0; i * step < 20; ++i) {
            apply_wind(falling, wind{.drag = S(0.5)}, S(step));
            falling.step(S(step));
        }
        // 2 kg * 10 = 0.5 v^2.
        CHECK(number(falling.linear_velocity(stone).y) == doctest::Approx(-std::sqrt(40.0)).epsilon(0.01));
    }
}

CELL_CASE("explosions: what faces them is thrown by its area, less and less over the falloff, and wakes") {
    world w = empty(0);
    const vec center = at(1, 1);
    std::vector<body_id> bodies;
    for (const double x : {2.0, 4.0, 5.0, 6.5})
        bodies.push_back(add(w, center + along(0, x), world::box{vec::filled(S(0.5))}));
    const body_id wall = w.create_body({.type = body_type::static_body, .position = center + along(1, 2)});
    w.create_shape(wall, world::box{vec::filled(S(0.5))});
    const body_id ghost = w.create_body({.position = center - along(0, 2)});
    w.create_shape(ghost, world::box{vec::filled(S(0.5))}, {.filter = {.category = 2}});
    for (int i = 0; i < 60; ++i) w.step(S(1.0 / 60));
    CHECK(w.is_asleep(bodies[0]));
    explode(w, explosion{.center = center, .radius = S(3), .falloff = S(2), .impulse = S(4), .filter = {.mask = 1}});
    // Their near faces are 1.5, 3.5, 4.5 and 6 m away, and 1 m^2 large.
    const double expected[] = {4, 3, 1, 0};
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(std::abs(number(w.linear_velocity(bodies[i]).x) - expected[i]) < 1e-3);
        CHECK(largest(w.linear_velocity(bodies[i]) - along(0, number(w.linear_velocity(bodies[i]).x))) < S(1e-3));
        CHECK(w.is_asleep(bodies[i]) == (i == 3));
    }
    CHECK(w.linear_velocity(ghost) == vec{});
    // Beside its middle it is spun too; an implosion draws it in; from within it is thrown by its middle, or stays.
    w.clear();
    const body_id box = add(w, at(2, 0.25), world::box{vec::filled(S(0.5))});
    explode(w, explosion{.radius = S(3)});
    CHECK(number(w.linear_velocity(box).x) > 0.5);
    CHECK(!(w.angular_velocity(box) == angular{}));
    explode(w, explosion{.radius = S(3), .impulse = S(-2)});
    CHECK(number(w.linear_velocity(box).x) < -0.5);
    w.clear();
    const body_id around = add(w, at(0.25, 0), world::ball{S(0.5)}), about = add(w, {}, world::ball{S(0.25)});
    explode(w, explosion{});
    CHECK(number(w.linear_velocity(around).x) > 0);
    CHECK(w.linear_velocity(about) == vec{});
}

CELL_CASE("fields: what is disabled feels none of them") {
    world w = empty(-10);
    const body_id out = add(w, along(1, 1), world::ball{S(0.5)}), in = add(w, along(0, 2), world::ball{S(0.5)});
    w.set_enabled(out, false);
    const auto pose = w.pose(out);
    for (int i = 0; i < 8; ++i) {
        physics::apply_gravity_well(w, well{.center = along(0, 8), .acceleration = S(5)});
        physics::apply_wind(w, wind{.velocity = along(0, 5)}, S(1.0 / 64));
        physics::apply_buoyancy(w, water{.height = S(4)}, S(1.0 / 64));
        physics::explode(w, explosion{.center = vec{}, .radius = S(4), .impulse = S(1)});
        w.step(S(1.0 / 64));
    }
    CHECK(w.pose(out) == pose);
    CHECK(w.linear_velocity(out) == vec{});
    CHECK(w.linear_velocity(in) != vec{});
}
CELL_CASE("fields: bad numbers are refused by name, and nothing is changed") {
    world w = empty(-10);
    add(w, {}, world::ball{S(0.5)});
    refuses(w, "apply_gravity_well", "radius", "0", [&] { apply_gravity_well(w, well{.radius = S(0)}); });
    refuses(w, "apply_wind", "drag", "-1", [&] { apply_wind(w, wind{.drag = S(-1)}, S(1)); });
    refuses(w, "apply_wind", "dt", "0", [&] { apply_wind(w, wind{}, S(0)); });
    refuses(w, "explode", "radius", "-1", [&] { explode(w, explosion{.radius = S(-1)}); });
    refuses(w, "explode", "falloff", "-1", [&] { explode(w, explosion{.falloff = S(-1)}); });
    refuses(w, "apply_buoyancy", "density", "-1", [&] { apply_buoyancy(w, water{.density = S(-1)}, S(1)); });
    refuses(w, "apply_buoyancy", "drag", "-1", [&] { apply_buoyancy(w, water{.drag = S(-1)}, S(1)); });
    refuses(w, "apply_buoyancy", "length of up", "2", [&] { apply_buoyancy(w, water{.up = along(1, 2)}, S(1)); });
}

}  // namespace fields_laws
}  // namespace
