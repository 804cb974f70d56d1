// Shapes of all sizes meet as those of one metre do; in double larger ones than numbers allow are refused.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "world_momenta.hpp"

namespace {

/// Two bodies of some size, of which one is in the other, or flies at it so fast that a step takes it through.
struct sized_pair {
    world w;
    body_id still, flying;

    sized_pair(double size, int kinds, vec offset, double angle, bool flies) {
        world::settings_type with{.gravity = {}};
        with.contact_margin = S(0.02 * size);
        with.broadphase.margin = S(0.05 * size);
        w.set_settings(with);
        still = w.create_body({.type = body_type::static_body});
        world::body_def def{.position = offset * S(size), .rotation = turned_about_z(angle), .rotation_locked = true};
        if (flies) {
            def.position = offset * S(8 * size);
            def.linear_velocity = offset * S(-16 * 64 * size);
            def.continuous = true;
        }
        flying = w.create_body(def);
        add(still, kinds % 3, size);
        add(flying, kinds / 3, size);
    }
    void add(body_id to, int kind, double size) {
        const world::shape_def light{.density = S(0)};
        if (kind == 0) w.create_shape(to, world::ball{S(size)}, light);
        else if (kind == 1) w.create_shape(to, world::box{vec::filled(S(size))}, light);
        else w.create_shape(to, world::capsule{S(size), S(size)}, light);
    }
};

CELL_CASE("limits: shapes of 1e-21 to 1e18 m, in double to 1e70, meet as those of one metre do") {
    if (cell::is_fixed) return;
    cell::dice dice(8);
    const bool is_double = std::is_same_v<S, double>;
    int met = 0;
    for (int i = 0; i < 300; ++i) {
        // By powers of two nothing is rounded in another way.
        const double size = std::ldexp(1, dice.below(is_double ? 471 : 131) - (is_double ? 240 : 70));
        const int kinds = dice.below(9);
        const double angle = dice.number(-3, 3);
        const double aside = dice.number(-1.5, 1.5);
        const vec offset = at(aside, dice.number(0.5, 1.5));
        CAPTURE(size);
        CAPTURE(kinds);
        sized_pair one(1, kinds, offset, angle, false), other(size, kinds, offset, angle, false);
        one.w.step(S(1.0 / 64));
        other.w.step(S(1.0 / 64));
        REQUIRE(one.w.contacts().size() == other.w.contacts().size());
        for (const auto& a : one.w.contacts())
            for (const auto& b : other.w.contacts()) {
                ++met;
                REQUIRE(a.count == b.count);
                REQUIRE(length(a.normal - b.normal) < S(1e-5));
                for (int k = 0; k < a.count; ++k) {
                    const double depth = number(b.points[k].separation) / size;
                    REQUIRE(std::abs(number(a.points[k].separation) - depth) < 1e-5);
                }
            }
        const vec origin = along(1, 8 * size), way = along(1, -16 * size);
        const auto hit = other.w.cast_ray(origin, way, {.except = other.flying});
        REQUIRE(hit);
        REQUIRE(std::abs(number(hit.fraction -
                                one.w.cast_ray(along(1, 8), along(1, -16), {.except = one.flying}).fraction)) < 1e-5);
        sized_pair fast(size, kinds, offset, angle, true);
        fast.w.step(S(1.0 / 64));
        // It is on the side that it came from.
        REQUIRE(dot(fast.w.position(fast.flying) / S(size), offset) > S(0));
    }
    CHECK(met > 100);
}

CELL_CASE("limits: in double what is beyond 1e75 is refused") {
    if (!std::is_same_v<S, double>) return;
    scenery s;
    world& w = s.w;
    const std::string rule = "must not be above 1e75";
    const auto face = [&](auto&& call) { CHECK(refusal(call).find(rule) != std::string::npos); };
    const vec far = along(0, 1.001e75), near = along(0, 0.999e75);
    for (const vec& at : {far, far * S(1e100), -far}) {
        face([&] { w.create_body({.position = at}); });
        face([&] { w.create_body({.linear_velocity = at}); });
        face([&] { w.set_pose(s.ball, at, {}); });
        face([&] { w.apply_force(s.ball, at); });
        face([&] { w.create_shape(s.ground, world::ball{S(1)}, {.position = at}); });
        face([&] { w.create_shape(s.ground, world::ball{physics::abs(at[0])}); });
        face([&] { (void)w.cast_ray(at, -at); });
        face([&] { (void)w.closest_shape(at, S(1)); });
        face([&] { w.each_at(at, {}, [](shape_id) {}); });
        face([&] { w.shift_origin(at); });
    }
    CHECK(w.create_body({.position = near}));
    CHECK(w.create_shape(s.ground, world::ball{near[0]}));
    w.step(S(1.0 / 64));
}

}  // namespace
