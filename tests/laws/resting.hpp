// Laws of rest: stacks come to rest at any number of substeps; and what moves on, however slowly, stays awake.
#pragma once

#include <functional>

#include "world_cell.hpp"

namespace {
namespace resting_laws {

inline world::settings_type pulled(bool sleeps, int substeps = 4) {
    world::settings_type settings;
    settings.gravity = along(1, -10);
    settings.sleeping.enabled = sleeps;
    settings.solver.substeps = substeps;
    return settings;
}

CELL_CASE("towers rest below 0.1 mm/s at every number of substeps") {
    for (const int height : {8, 20})
        for (const int substeps : {2, 4, 6, 8, 16, 32}) {
            CAPTURE(height);
            CAPTURE(substeps);
            world w(pulled(false, substeps));
            add_ground(w);
            for (int i = 0; i < height; ++i) add_box(w, at(0, 0.5 + i));
            run(w, 10 * 64);
            double fastest = 0;
            for (int i = 0; i < 64; ++i) {
                run(w, 1);
                for (const body_id body : w.bodies())
                    fastest = std::max(fastest, number(length(w.linear_velocity(body))));
            }
            CHECK(fastest <= 1e-4);
        }
}

/// How far the body that `build` makes goes along x in some seconds, and how far without sleep.
struct ways {
    double with_sleep, without;
};
inline ways ways_of(const std::function<body_id(world&)>& build, int seconds,
                    const std::function<void(world&, body_id)>& push = {}) {
    double way[2];
    for (const bool sleeps : {false, true}) {
        world w(pulled(sleeps));
        const body_id body = build(w);
        const double start = number(w.center_of_mass(body).x);
        for (int i = 0; i < seconds * 64; ++i) {
            if (push) push(w, body);
            run(w, 1);
        }
        way[sleeps] = number(w.center_of_mass(body).x) - start;
    }
    return {way[1], way[0]};
}
/// Sleep changes nothing.
inline void check_same(const ways& way) { CHECK(way.with_sleep == way.without); }

/// The velocity of a surface that runs along x.
template <class Motion>
Motion running(double speed) {
    if constexpr (cell::is_2d) return S(speed);
    else return {S(speed), S(0), S(0)};
}
inline void add_belt(world& w, double speed) {
    world::shape_def belt;
    belt.material.surface_velocity = running<physics::surface_motion<S, cell::dimension>>(speed);
    w.create_shape(w.create_body({.type = body_type::static_body}), world::halfspace{}, belt);
}
inline body_id add_rolling_ball(world& w, double height, double speed) {
    const body_id ball = add_ball(w, at(0, height));
    w.set_linear_velocity(ball, along(0, speed));
    w.set_angular_velocity(ball, about_z(-2 * speed));
    return ball;
}

CELL_CASE("sleep: what a belt carries at 2 mm/s and more stays awake") {
    for (const double speed : {0.002, 0.01, 0.03}) {
        CAPTURE(speed);
        const auto way = ways_of(
            [&](world& w) {
                add_belt(w, speed);
                return add_box(w, at(0, 0.5));
            },
            10);
        check_same(way);
        CHECK(std::abs(way.with_sleep - 10 * speed) <= 0.1 * speed + rounding(4096));
    }
}
CELL_CASE("sleep: what rolls at 2 mm/s and more stays awake") {
    for (const double speed : {0.002, 0.02, 0.04}) {
        CAPTURE(speed);
        const auto way = ways_of(
            [&](world& w) {
                add_ground(w);
                return add_rolling_ball(w, 0.5, speed);
            },
            10);
        check_same(way);
        CHECK(std::abs(way.with_sleep - 10 * speed) <= 0.02 * speed + rounding(4096));
    }
}
CELL_CASE("sleep: what goes along with others, as steadily, stays awake") {
    for (const double speed : {0.002, 0.01, 0.03}) {
        CAPTURE(speed);
        // A stack on a belt; a ball that rolls over a plank.
        check_same(ways_of(
            [&](world& w) {
                add_belt(w, speed);
                for (int i = 0; i < 3; ++i) add_box(w, at(0, 0.5 + i));
                return add_box(w, at(0, 3.5));
            },
            6));
        const auto rolls = ways_of(
            [&](world& w) {
                add_ground(w);
                vec half = vec::filled(S(5));
                half.y = S(0.5);
                w.create_shape(w.create_body({.position = at(0, 0.5)}), world::box{half});
                return add_rolling_ball(w, 1.5, speed);
            },
            6);
        check_same(rolls);
        CHECK(std::abs(rolls.with_sleep - 6 * speed) <= 0.02 * speed + rounding(4096));
    }
}
#if CELL_DIMENSION == 2
CELL_CASE("sleep: a pile breathes as it comes to rest, which keeps it awake no longer than its rows slip") {
    world w(pulled(true, 2));
    add_ground(w);
    const int rows = 50;
    for (int row = 0; row < rows; ++row)
        for (int i = row; i < rows; ++i) add_box(w, at(0.5 * (row + 1) + (i - row) - 0.5 * rows, row + 0.5));
    run(w, 9 * 64);
    CHECK(w.awake_count() == 0);
}
#endif
CELL_CASE("sleep: what begins to slip or to tip stays awake") {
    // Pushed by 1 % more than friction holds.
    check_same(ways_of(
        [](world& w) {
            add_ground(w);
            return add_box(w, at(0, 0.5));
        },
        5, [](world& w, body_id body) { w.apply_force(body, along(0, 1.01 * 0.6 * 10 * number(w.mass(body).mass))); }));
    for (const double beyond : {0.001, 0.002, 0.01}) {
        CAPTURE(beyond);
        // A slab that stands on its edge, out of balance by so many radians.
        const double lean = std::atan(0.1) + beyond;
        const auto way = ways_of(
            [&](world& w) {
                add_ground(w);
                vec half = vec::filled(S(0.5));
                half.x = S(0.1);
                half.y = S(1);
                const body_id slab = w.create_body(
                    {.position = at(0, std::cos(lean) + 0.1 * std::sin(lean)), .rotation = turned_about_z(-lean)});
                w.create_shape(slab, world::box{half});
                return slab;
            },
            8);
        CHECK(way.with_sleep > 0.5);
        CHECK(std::abs(way.with_sleep - way.without) <= 0.05);
    }
}

CELL_CASE("resting: what comes beside a sleeper wakes it, whatever has slept, woken and gone before") {
    world::settings_type settings;
    settings.gravity = along(1, -10);
    world w(settings);
    add_ground(w);
    cell::dice dice(11);
    const auto place = [](int i) { return at(2.5 * i - 10, 0.5); };
    std::vector<body_id> boxes;
    for (int i = 0; i < 8; ++i) boxes.push_back(add_box(w, place(i)));
    int woken = 0;
    for (int round = 0; round < 60; ++round) {
        const int i = dice.below(8), done = dice.below(6);
        const body_id box = boxes[static_cast<std::size_t>(i)];
        if (done == 0) w.wake(box);
        if (done == 1) w.apply_impulse(box, at(0.5, 0));
        if (done == 2) w.set_pose(box, {place(i), {}});
        if (done == 3) {
            w.destroy_body(box);
            boxes[static_cast<std::size_t>(i)] = add_box(w, place(i));
        }
        run(w, done == 4 ? 1 : 96);
        const world before = w;
        for (const body_id b : boxes) {
            if (!w.is_asleep(b)) continue;
            world copy = before;
            add_ball(copy, w.position(b) + at(0, 0.9));
            CHECK(!copy.is_asleep(b));
            ++woken;
        }
        if (done == 5) w = before;
    }
    CHECK(woken > 100);
}

}  // namespace resting_laws
}  // namespace
