// Laws of the world's origin: what moves all of a world changes nothing in it.
#pragma once

#include <vector>

#include "refusal.hpp"
#include "world_cell.hpp"

namespace {
namespace shifting_laws {

/// A stack that sleeps, one that is awake, a rope of balls, something that flies, and a lift.
struct yard {
    world w{world::settings_type{.gravity = along(1, -10)}};
    std::vector<body_id> bodies;
    body_id ground, lift, stone;

    yard() {
        ground = w.create_body({.type = body_type::static_body, .position = at(0, -0.5)});
        vec half = vec::filled(S(16));
        half.y = S(0.5);
        w.create_shape(ground, world::box{half});
        for (int i = 0; i < 4; ++i) add(at(-3, 0.5 + i));
        run(2);
        for (int i = 0; i < 4; ++i) add(at(3, 0.5 + i));
        lift =
            w.create_body({.type = body_type::kinematic_body, .position = at(0, 1), .linear_velocity = along(1, 0.25)});
        w.create_shape(lift, world::box{vec::filled(S(0.5))});
        stone = add(at(-30, 12));
        w.set_linear_velocity(stone, at(4, 2));
    }
    body_id add(vec at) {
        bodies.push_back(w.create_body({.position = at}));
        w.create_shape(bodies.back(), world::box{vec::filled(S(0.5))});
        return bodies.back();
    }
    void run(double seconds) {
        for (int i = 0; i < 64 * seconds; ++i) w.step(S(1.0 / 64));
    }
};

CELL_CASE("origin: what is shifted goes on as it did, keeps its contacts and sleeps on") {
    yard still, moved;
    const vec to = at(64, -32);
    moved.run(0.25);
    still.run(0.25);
    const auto contacts = moved.w.contacts().size();
    const body_id sleeper = moved.bodies[0];
    CHECK(moved.w.is_asleep(sleeper));
    moved.w.move_to(moved.lift, at(0, 1.5), {});
    still.w.move_to(still.lift, at(0, 1.5), {});
    moved.w.shift_origin(to);
    CHECK(moved.w.contacts().size() == contacts);
    CHECK(moved.w.is_asleep(sleeper));
    for (int i = 0; i < 64; ++i) {
        moved.w.step(S(1.0 / 64));
        still.w.step(S(1.0 / 64));
        // Impulses are warm all the time.
        if (i == 0)
            for (const auto& c : moved.w.contacts()) CHECK(c.points[0].persisted);
        for (std::size_t k = 0; k < still.bodies.size(); ++k) {
            CHECK(gap(moved.w.position(moved.bodies[k]) + to, still.w.position(still.bodies[k])) < 2e-3);
            CHECK(gap(moved.w.linear_velocity(moved.bodies[k]), still.w.linear_velocity(still.bodies[k])) < 2e-2);
        }
        CHECK(gap(moved.w.position(moved.lift) + to, still.w.position(still.lift)) < 1e-4);
    }
    CHECK(moved.w.is_asleep(sleeper));
    // Back again, and queries find things where they are.
    moved.w.shift_origin(-to);
    const auto hit = moved.w.cast_ray(at(-3, 9), along(1, -8));
    CHECK(hit.body == moved.bodies[3]);
    CHECK(std::abs(number(hit.point.y) - 4) < 0.01);
    CHECK(moved.w.closest_shape(at(-3, 4.5), S(1)).body == moved.bodies[3]);
}
CELL_CASE("origin: it may move again and again") {
    yard y;
    std::vector<vec> before;
    for (const body_id b : y.bodies) before.push_back(y.w.position(b));
    for (int i = 0; i < 128; ++i) {
        y.w.shift_origin(i % 2 ? at(5, 3) : at(-5, -3));
        y.w.step(S(1.0 / 64));
    }
    // Those that sleep.
    for (std::size_t i = 0; i < 4; ++i) CHECK(gap(y.w.position(y.bodies[i]), before[i]) < 1e-3);
}
CELL_CASE("origin: refused where anything would leave the range, with nothing changed") {
    yard y;
    const double maximum = number(cell::largest()), far = (cell::is_fixed ? 0.4 : 0.9) * maximum;
    if constexpr (cell::is_fixed) {
        refuses(y.w, "shift_origin", "to.x", "", [&] { y.w.shift_origin(along(0, 0.75 * maximum)); });
    } else {
        vec bad;
        bad.y = S(std::nan(""));
        refuses(y.w, "shift_origin", "to.y", "", [&] { y.w.shift_origin(bad); });
    }
    y.w.set_pose(y.stone, along(0, far), {});
    refuses(y.w, "shift_origin", "shifted centre of mass.x", "", [&] { y.w.shift_origin(along(0, -far)); });
}

}  // namespace shifting_laws
}  // namespace
