// Laws of continuous collision: nothing passes through, nothing that slides or rolls is stopped.
#pragma once

#include <vector>

#include "world_cell.hpp"

namespace {
namespace continuous_laws {

struct flags : physics::recipe<S, cell::dimension, physics::soft_step> {};
struct unguarded : physics::recipe<S, cell::dimension, physics::without<physics::feature::continuous>> {};
struct foresight : physics::recipe<S, cell::dimension, physics::speculative> {};
constexpr int D = cell::dimension;

/// Without gravity, as all shots are.
template <class World>
World range() {
    typename World::settings_type settings;
    settings.gravity = {};
    return World(settings);
}
/// A plate across x, so thick, at 0.
template <class World>
body_id add_plate(World& w, double thickness, body_type type = body_type::static_body) {
    const body_id plate = w.create_body({.type = type});
    auto half = World::vec::filled(S(60));
    half.x = S(thickness / 2);
    w.create_shape(plate, typename World::box{half}, {.density = S(1.0 / 8)});
    return plate;
}
/// Gives a body the same inertia about all axes, so that a spin about one of them stays about it.
template <class World>
void calm(World& w, body_id b) {
    if constexpr (cell::is_3d) {
        auto mass = w.mass(b);
        auto& i = mass.inertia;
        i.xx = i.yy = i.zz = physics::max(i.xx, physics::max(i.yy, i.zz));
        i.xy = i.xz = i.yz = S(0);
        w.set_mass(b, mass);
    }
}
/// Where a point of the world is in the frame of a body, along x.
template <class World>
double side_of(const World& w, body_id body, vec point) {
    return number(inverse_transform(w.pose(body), point).x);
}

/// Balls of radius 0.1 against a plate, at 16 phases of the step; how many end up beyond its middle.
template <class World>
int balls_through(double speed, double thickness, body_type type, bool flagged) {
    int passed = 0;
    for (int phase = 0; phase < 16; ++phase) {
        World w = range<World>();
        const body_id plate = add_plate(w, thickness, type);
        const body_id ball = w.create_body({.position = at(-1 - speed / 64 * (phase + 0.25) / 16, 0.25),
                                            .linear_velocity = along(0, speed),
                                            .continuous = flagged});
        w.create_shape(ball, typename World::ball{S(0.1)});
        for (int i = 0; i < 16 + 64 * 2 / speed; ++i) w.step(S(1.0 / 64));
        passed += side_of(w, plate, w.position(ball)) > 0;
    }
    return passed;
}
template <class World>
void shoot_at_plates() {
    for (const double speed : {10.0, 40.0, 150.0, 390.0, 1000.0})
        for (const double thickness : {0.1, 0.01, 0.001}) {
            CAPTURE(speed);
            CAPTURE(thickness);
            CHECK(balls_through<World>(speed, thickness, body_type::static_body, false) == 0);
            if (speed < 400) CHECK(balls_through<World>(speed, thickness, body_type::dynamic_body, true) == 0);
        }
}
CELL_CASE("X1: no ball passes a plate, still up to 1000 m/s, movable up to 400 m/s") {
    shoot_at_plates<world>();
    shoot_at_plates<physics::world<flags>>();
    // Without the feature they do, so that the scene proves something; and the flag is needed.
    CHECK(balls_through<physics::world<flags>>(390, 0.001, body_type::dynamic_body, false) > 0);
    int passed = 0;
    for (int phase = 0; phase < 16; ++phase) {
        auto w = range<physics::world<unguarded>>();
        const body_id plate = add_plate(w, 0.01);
        const body_id ball =
            w.create_body({.position = at(-1 - 6.0 * phase / 16, 0), .linear_velocity = along(0, 384)});
        w.create_shape(ball, world::ball{S(0.1)});
        for (int i = 0; i < 16; ++i) w.step(S(1.0 / 64));
        passed += side_of(w, plate, w.position(ball)) > 0;
        CHECK((w.continuous_report().swept == 0));
    }
    CHECK(passed > 8);
}

template <class Shape>
int solids_through(const Shape& shape, double speed, double spin, int seed, double thickness = 0.01) {
    cell::dice dice(static_cast<std::uint64_t>(seed));
    int passed = 0;
    for (int phase = 0; phase < 16; ++phase) {
        world w = range<world>();
        const body_id plate = add_plate(w, thickness);
        const body_id body = w.create_body({.position = at(-2.5 - speed / 64 * (phase + 0.25) / 16, 0.25),
                                            .rotation = random_rotation(dice),
                                            .linear_velocity = along(0, speed),
                                            .angular_velocity = skew(spin)});
        w.create_shape(body, shape);
        calm(w, body);
        for (int i = 0; i < 20 + 64 * 3 / speed; ++i) w.step(S(1.0 / 64));
        passed += side_of(w, plate, w.position(body)) > 0;
    }
    return passed;
}
CELL_CASE("X1: no rod, box or capsule passes, however it is turned and spins") {
    vec rod = vec::filled(S(0.02));
    rod[cell::is_2d ? 1 : 2] = S(2);
    for (const double speed : {5.0, 40.0, 300.0})
        for (const double spin : {0.0, 8.0, 100.0}) {
            CAPTURE(speed);
            CAPTURE(spin);
            CHECK(solids_through(world::box{rod}, speed, spin, 500) == 0);
            CHECK(solids_through(world::box{vec::filled(S(0.1))}, speed, spin, 501) == 0);
            CHECK(solids_through(world::capsule{S(0.3), S(0.05)}, speed, spin, 502) == 0);
        }
}

CELL_CASE("what grazes, slides or rolls is not stopped") {
    // Just above the ground, then along it.
    for (const double height : {0.001, 0.004, 0.015, 0.03}) {
        world w = range<world>();
        add_ground(w);
        const body_id ball = w.create_body({.position = at(0, 0.1 + height), .linear_velocity = along(0, 300)});
        w.create_shape(ball, world::ball{S(0.1)});
        run(w, 64);
        CHECK(w.continuous_report().swept == 1);
        CHECK(std::abs(number(w.position(ball).x) - 300) <= 0.01);
    }
    // Over the joints of many boxes in a row: the very path that it takes without sweeps.
    world swept_one;
    physics::world<unguarded> other;
    const auto build = [](auto& w) {
        const body_id ground = w.create_body({.type = body_type::static_body});
        for (int i = -4; i < 60; ++i)
            w.create_shape(ground, world::box{vec::filled(S(0.5))},
                           {.position = at(i, -0.5), .material = {.friction = S(0)}});
        const body_id body = w.create_body({.position = at(0, 0.1)});
        w.create_shape(body, world::box{vec::filled(S(0.1))}, {.material = {.friction = S(0)}});
        for (int i = 0; i < 30; ++i) w.step(S(1.0 / 64));
        w.set_linear_velocity(body, along(0, 50));
        return body;
    };
    const body_id box = build(swept_one);
    build(other);
    for (int i = 0; i < 64; ++i) {
        run(swept_one, 1);
        other.step(S(1.0 / 64));
        REQUIRE(swept_one.continuous_report().swept == 1);
        REQUIRE(swept_one.continuous_report().stopped == 0);
        REQUIRE(swept_one.state_hash() == other.state_hash());
    }
    CHECK(std::abs(number(swept_one.position(box).x) - 50) <= 0.1);
}

CELL_CASE("a swept ball bounces as high as it fell") {
    for (const double height : {5.0, 20.0, 80.0}) {
        world::settings_type settings;
        settings.gravity = along(1, -10);
        settings.solver.restitution_threshold = S(0);
        world w(settings);
        const body_id ground = w.create_body({.type = body_type::static_body});
        w.create_shape(ground, world::box{vec::filled(S(1))},
                       {.position = at(0, -1), .material = {.restitution = S(1)}});
        const body_id ball = w.create_body({.position = at(0, height + 0.05)});
        w.create_shape(ball, world::ball{S(0.05)});
        double highest = 0, lost = 0;
        int bounces = 0;
        for (int i = 0; i < 2000 && bounces < 2; ++i) {
            const double before = number(w.linear_velocity(ball).y);
            run(w, 1);
            const double now = number(w.linear_velocity(ball).y);
            bounces += before < 0 && now > 0;
            if (bounces == 1) highest = std::max(highest, number(w.position(ball).y) - 0.05);
            lost = std::max(lost, number(w.continuous_report().lost));
        }
        CAPTURE(height);
        CAPTURE(lost);
        CAPTURE(highest / height);
        CHECK(highest <= height * 1.01);
        CHECK(highest >= height * 0.9);
    }
}

/// A closed room of plates 0.02 m thick, its inside from -half to half.
template <class World>
void add_room(World& w, double half) {
    const body_id room = w.create_body({.type = body_type::static_body});
    for (int axis = 0; axis < D; ++axis)
        for (const double side : {-1.0, 1.0}) {
            auto extents = World::vec::filled(S(half + 1));
            extents[axis] = S(0.01);
            w.create_shape(room, typename World::box{extents}, {.position = along(axis, side * (half + 0.01))});
        }
}
template <class World>
bool all_within(const World& w, double half) {
    for (const body_id b : w.bodies())
        for (int i = 0; i < D; ++i)
            if (std::abs(number(w.center_of_mass(b)[i])) > half) return false;
    return true;
}
template <class World>
void fill_and_shoot(World& w, cell::dice& dice, int count, bool flagged) {
    for (int i = 0; i < count; ++i) {
        typename World::body_def def;
        def.position = dice.vec<vec>(-1.5, 1.5);
        def.rotation = random_rotation(dice);
        def.linear_velocity = dice.vec<vec>(100, 300);
        def.angular_velocity = skew(dice.number(-50, 50));
        def.continuous = flagged;
        const body_id b = w.create_body(def);
        const S size = dice.real(0.05, 0.1);
        // So that fixed point holds the inverse inertia.
        const typename World::shape_def heavy{.density = S(64)};
        if (i % 3 == 0) w.create_shape(b, typename World::ball{size}, heavy);
        else if (i % 3 == 1) w.create_shape(b, typename World::box{vec::filled(size)}, heavy);
        else w.create_shape(b, typename World::capsule{size, size * S(0.5)}, heavy);
        calm(w, b);
    }
}
CELL_CASE("200 fast bodies shot into a corner, over one another: none leaves the room, and each is swept once a step") {
    for (const bool flagged : {false, true}) {
        auto w = range<physics::world<flags>>();
        add_room(w, 2);
        cell::dice dice(510);
        fill_and_shoot(w, dice, 200, flagged);
        std::uint32_t stopped = 0;
        for (int i = 0; i < 90; ++i) {
            w.step(S(1.0 / 64));
            const auto report = w.continuous_report();
            REQUIRE(report.swept <= 200);
            REQUIRE(report.stopped <= report.swept);
            REQUIRE(number(report.lost) <= 1.0 / 64);
            stopped += report.stopped;
            REQUIRE(all_within(w, 2));
        }
        CHECK(stopped >= 200);
    }
}

CELL_CASE("sweeps: a copy steps alike, and the order in which bodies came does not matter") {
    auto w = range<physics::world<flags>>();
    add_room(w, 2);
    cell::dice dice(511);
    fill_and_shoot(w, dice, 40, true);
    for (int i = 0; i < 3; ++i) w.step(S(1.0 / 64));
    auto copy = w;
    CHECK(copy.state_hash() == w.state_hash());
    for (int i = 0; i < 20; ++i) {
        w.step(S(1.0 / 64));
        copy.step(S(1.0 / 64));
        REQUIRE(copy.state_hash() == w.state_hash());
        REQUIRE(copy.continuous_report().stopped == w.continuous_report().stopped);
    }
    // The first step of bodies that do not touch yet; each ends where it does whatever its number.
    std::vector<vec> places[2];
    for (const bool back : {false, true}) {
        auto v = range<physics::world<flags>>();
        if (!back) add_room(v, 4);
        std::vector<body_id> ids(30);
        for (int n = 0; n < 30; ++n) {
            const int i = back ? 29 - n : n;
            ids[std::size_t(i)] =
                v.create_body({.position = at(-3 + 0.2 * i, -3 + 0.2 * ((7 * i) % 30)),
                               .linear_velocity = at(30.0 * ((3 * i) % 7 - 3), 200.0 * ((5 * i) % 3 - 1)),
                               .continuous = i % 2 == 0});
            v.create_shape(ids[std::size_t(i)], world::ball{S(0.08)});
        }
        if (back) add_room(v, 4);
        v.step(S(1.0 / 64));
        CHECK(v.continuous_report().stopped > 3);
        for (const body_id id : ids) places[back].push_back(v.position(id));
    }
    for (std::size_t i = 0; i < 30; ++i) CHECK(places[0][i] == places[1][i]);
}

CELL_CASE("two flagged bodies that meet both stop where they meet; a kinematic one takes along what it catches") {
    for (const bool both : {true, false}) {
        auto w = range<physics::world<flags>>();
        const body_id left =
            w.create_body({.position = at(-1, 0), .linear_velocity = along(0, 128), .continuous = true});
        const body_id right =
            w.create_body({.position = at(1, 0), .linear_velocity = along(0, -128), .continuous = both});
        for (const body_id b : {left, right}) w.create_shape(b, world::ball{S(0.1)});
        w.step(S(1.0 / 64));
        CHECK(w.continuous_report().stopped == 2);
        CHECK(number(w.position(left).x) < -0.1);
        CHECK(number(w.position(left).x) > -0.12);
        CHECK(gap(w.position(left), -w.position(right)) <= rounding(8));
        for (int i = 0; i < 4; ++i) w.step(S(1.0 / 64));
        CHECK(number(w.position(left).x) < number(w.position(right).x));
    }
    auto w = range<physics::world<flags>>();
    const body_id paddle =
        w.create_body({.type = body_type::kinematic_body, .position = at(2, 0), .linear_velocity = along(0, -128)});
    w.create_shape(paddle, world::box{vec::filled(S(0.25))});
    const body_id ball = w.create_body({.position = at(-1, 0), .linear_velocity = along(0, 64), .continuous = true});
    w.create_shape(ball, world::ball{S(0.1)});
    for (int i = 0; i < 8; ++i) {
        w.step(S(1.0 / 64));
        REQUIRE(number(w.position(ball).x) < number(w.position(paddle).x) - 0.3);
    }
}

CELL_CASE("X5: spinning costs no time where nothing is near, at any rate, and gains no energy") {
    for (const double spin : {100.0, 1000.0, 10000.0}) {
        world w = range<world>();
        add_plate(w, 0.1);
        vec half = vec::filled(S(0.25));
        half.x = S(0.5);
        const body_id box = w.create_body({.position = at(3, 0), .angular_velocity = about_z(spin)});
        w.create_shape(box, world::box{half});
        const body_id ball = w.create_body({.position = at(-0.2, 0), .angular_velocity = about_z(spin)});
        w.create_shape(ball, world::ball{S(0.1)});
        for (int i = 0; i < 32; ++i) {
            run(w, 1);
            REQUIRE(w.continuous_report().swept == 1);
            REQUIRE(w.continuous_report().stopped == 0);
        }
        CHECK(gap(w.angular_velocity(box), about_z(spin)) <= rounding(2000, spin));
    }
}

/// What each shape's own convex pieces are apart, in the world.
template <class A, class B>
double apart(const A& a, const world::transform& at_a, const B& b, const world::transform& at_b) {
    return number(separation(a, b, relative(at_a, at_b)).distance);
}
template <class Shape>
world::transform pose_at(const physics::sweep<S, D>& path, double time, const Shape&) {
    return path.at(S(time));
}

/// Follows a body's path in 256 parts: how deep it comes, and how deep it has come up to a time.
template <class A, class B>
void compare_with_small_parts(cell::dice& dice, const A& obstacle, const B& shape, double inside, double spin = 60) {
    for (int run = 0; run < 40; ++run) {
        world w = range<world>();
        physics::world<unguarded> free;
        auto settings = free.settings();
        settings.gravity = {};
        free.set_settings(settings);
        world::body_def still{.type = body_type::static_body, .position = dice.vec<vec>(-0.2, 0.2)};
        if (run % 2) still.rotation = random_rotation(dice);
        world::body_def moving;
        moving.position = dice.vec<vec>(-1, 1);
        moving.position[run % D] = S(run % 4 < 2 ? -2.5 : 2.5);
        moving.rotation = random_rotation(dice);
        moving.linear_velocity = (dice.vec<vec>(-0.8, 0.8) - moving.position) * S(dice.number(50, 400));
        moving.angular_velocity = skew(dice.number(-spin, spin));
        w.create_shape(w.create_body(still), obstacle);
        free.create_shape(free.create_body(still), obstacle);
        const body_id body = w.create_body(moving);
        free.create_body(moving);
        w.create_shape(body, shape);
        free.create_shape(body_id{body.index, body.generation, (*free.bodies().begin()).world}, shape);
        const world::transform start = w.pose(body), wall{still.position, still.rotation};
        if (apart(obstacle, wall, shape, start) < 0.05) continue;
        w.step(S(1.0 / 64));
        free.step(S(1.0 / 64));
        const body_id twin{body.index, body.generation, (*free.bodies().begin()).world};
        const physics::sweep<S, D> path = physics::sweep_between<S, D>(start, free.pose(twin));
        const double whole = number(length(path.end - path.start));
        const bool stopped = w.continuous_report().stopped == 1;
        const double until = stopped ? 1 - 64 * number(w.continuous_report().lost) : 1;
        double least = 1e9, before = 1e9, last = 0;
        for (int i = 0; i <= 256; ++i) {
            const double t = i / 256.0;
            last = apart(obstacle, wall, shape, pose_at(path, t, shape));
            least = std::min(least, last);
            if (t <= until) before = std::min(before, last);
        }
        // In a part of the path the shapes come at most as much closer.
        const double between = (whole + 60.0 / 64) / 256;
        const double margin = number(w.settings().contact_margin), blur = rounding(64, 8);
        CAPTURE(run);
        CAPTURE(inside);
        CAPTURE(until);
        if (stopped) {
            REQUIRE(w.continuous_report().unconverged == 0);
            REQUIRE(before >= margin / 64 - blur);
            // It goes on along the surface, or past it.
            REQUIRE(apart(obstacle, wall, shape, w.pose(body)) >= margin / 64 - blur);
            REQUIRE((last <= 0 || least <= -0.5 * inside * (14.0 / 16) + between));
        } else {
            REQUIRE(least >= -0.5 * inside - blur);
            REQUIRE(last >= -margin / 4 - blur);
            REQUIRE(w.pose(body) == free.pose(twin));
        }
    }
}
CELL_CASE("sweeps stop what passes in deep, at the surface, and nothing else: as 256 small parts of the path show") {
    cell::dice dice(520);
    const world::box cube{vec::filled(S(0.5))}, plank{along(0, 0.98) + vec::filled(S(0.02))};
    const world::ball ball{S(0.3)};
    const world::capsule rod{S(0.6), S(0.05)};
    compare_with_small_parts(dice, cube, ball, 0.3);
    compare_with_small_parts(dice, cube, cube, 0.5);
    // In space long things tumble: their path between two poses is known where they turn little.
    const double spin = cell::is_2d ? 60 : 4;
    compare_with_small_parts(dice, cube, plank, 0.02, spin);
    compare_with_small_parts(dice, plank, cube, 0.5);
    compare_with_small_parts(dice, plank, plank, 0.02, spin);
    compare_with_small_parts(dice, rod, plank, 0.02, spin);
    compare_with_small_parts(dice, rod, rod, 0.05, spin);
    compare_with_small_parts(dice, ball, rod, 0.05, spin);
    compare_with_small_parts(dice, world::halfspace{}, cube, 0.5);
    compare_with_small_parts(dice, world::halfspace{}, rod, 0.05, spin);
}

/// A user's policy: sweeps all, whatever they do, and looks a little ahead.
struct zealous {
    using stage = physics::stage::continuous;
    template <class Space>
    struct in {
        using T = typename Space::scalar;
        static physics::sweep_target sweep_against(const physics::body_motion<T, Space::dimension>&) {
            return physics::sweep_target::everything;
        }
        static T ahead(const physics::body_motion<T, Space::dimension>& s) { return s.bound() * T(0.25); }
    };
};
struct guarded : physics::recipe<S, cell::dimension, zealous> {};
CELL_CASE("policies of users: one that sweeps everything, always") {
    auto w = range<physics::world<guarded>>();
    const body_id plate = add_plate(w, 0.01);
    const body_id ball = w.create_body({.position = at(-1, 0), .linear_velocity = along(0, 1)});
    w.create_shape(ball, world::ball{S(0.1)});
    w.step(S(1.0 / 64));
    CHECK(w.continuous_report().swept == 1);
    CHECK(w.continuous_report().stopped == 0);
    w.set_linear_velocity(ball, along(0, 500));
    for (int i = 0; i < 8; ++i) w.step(S(1.0 / 64));
    CHECK(side_of(w, plate, w.position(ball)) < 0);
}

CELL_CASE("speculative contacts stop balls at still plates, without sweeps and without losing time") {
    for (const double speed : {10.0, 40.0, 150.0, 390.0})
        for (int phase = 0; phase < 16; ++phase) {
            auto w = range<physics::world<foresight>>();
            const body_id plate = add_plate(w, 0.01);
            const body_id ball =
                w.create_body({.position = at(-1 - speed / 64 * phase / 16, 0.25), .linear_velocity = along(0, speed)});
            w.create_shape(ball, world::ball{S(0.1)});
            for (int i = 0; i < 16 + 64 * 2 / speed; ++i) w.step(S(1.0 / 64));
            REQUIRE(side_of(w, plate, w.position(ball)) < -0.09);
            REQUIRE(w.continuous_report().swept == 0);
        }
    // A pile takes no harm.
    physics::world<foresight> w;
    w.create_shape(w.create_body({.type = body_type::static_body}), world::halfspace{});
    body_id top;
    for (int i = 0; i < 5; ++i) {
        top = w.create_body({.position = at(0, 0.5 + i)});
        w.create_shape(top, world::box{vec::filled(S(0.5))});
    }
    for (int i = 0; i < 200; ++i) w.step(S(1.0 / 64));
    CHECK(gap(w.position(top), at(0, 4.5)) <= 0.05);
}

CELL_CASE("the flag of a body: kept, copied, hashed, refused where nobody looks after it") {
    world w;
    const body_id plain = w.create_body(), flagged = w.create_body({.continuous = true});
    CHECK_FALSE(w.continuous(plain));
    CHECK(w.continuous(flagged));
    const std::uint64_t before = w.state_hash();
    w.set_continuous(plain, true);
    CHECK(w.continuous(plain));
    CHECK(w.state_hash() != before);
    CHECK(world(w).continuous(plain));
    w.set_continuous(plain, false);
    CHECK(w.state_hash() == before);
    w.destroy_body(plain);
    CHECK_THROWS_AS(w.set_continuous(plain, true), physics::error);
    CHECK_THROWS_AS((void)w.continuous(plain), physics::error);

    physics::world<unguarded> none;
    const body_id body = none.create_body();
    CHECK_THROWS_AS(none.create_body({.continuous = true}), physics::error);
    CHECK_THROWS_AS(none.set_continuous(body, true), physics::error);
    none.set_continuous(body, false);
    CHECK(none.body_count() == 1);
}

}  // namespace continuous_laws
}  // namespace
