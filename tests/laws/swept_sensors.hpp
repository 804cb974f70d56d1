// What passes through sensors within a step: against ways that are cut into small parts.
#pragma once

#include <algorithm>
#include <vector>

#include "sensors.hpp"

namespace {
namespace swept_sensors_laws {

using events_laws::pair;
using events_laws::world;
using physics::sweep;
using physics::transform;
using sensors_laws::listener;
using pose = transform<S, cell::dimension>;

world at_rest() { return world(world::settings_type{.gravity = vec{}}); }
shape_id add_shape(world& w, body_id b, cell::dice& dice, const world::shape_def& def) {
    switch (dice.below(3)) {
        case 0: return w.create_shape(b, world::ball{S(dice.number(0.1, 0.5))}, def);
        case 1: {
            vec half = vec::filled(S(dice.number(0.1, 0.5)));
            half[0] = S(0.02);
            return w.create_shape(b, world::box{half}, def);
        }
        default: return w.create_shape(b, world::box{vec::filled(S(dice.number(0.1, 0.5)))}, def);
    }
}
/// How near two shapes come on ways between poses of their bodies, which turn evenly about their origins.
double nearest(const world& w, shape_id a, const pose& from_a, shape_id b, const pose& from_b, double h) {
    const auto on_way = [&](body_id body, const pose& from, double part) {
        const vec centre = from.position + (w.position(body) - from.position) * S(part);
        const auto turn = w.angular_velocity(body) * S(h * part);
        return pose{centre, physics::turned(from.rotation, turn)};
    };
    double least = 1e9;
    for (int i = 0; i <= 4000; ++i) {
        const pose at_a = on_way(w.body(a), from_a, i / 4000.0) * w.local_pose(a),
                   at_b = on_way(w.body(b), from_b, i / 4000.0) * w.local_pose(b);
        w.shape(a).visit([&](const auto& x) {
            w.shape(b).visit([&](const auto& y) {
                if constexpr (requires { physics::separation(x, y, relative(at_a, at_b)); })
                    least = std::min(least, number(physics::separation(x, y, relative(at_a, at_b)).distance));
                else FAIL("shapes that have no distance");
            });
        });
    }
    return least;
}

CELL_CASE("swept sensors: what passes through them within a step is in them for that step, and nothing else is") {
    int passed = 0, missed = 0;
    const double h = 1.0 / 32;
    for (int seed = 0; seed < 120; ++seed) {
        CAPTURE(seed);
        cell::dice dice(static_cast<std::uint64_t>(9000 + seed));
        world w = at_rest();
        const auto add = [&](body_type type, const vec& where, const vec& velocity, bool is_sensor) {
            const body_id b = w.create_body({.type = type, .position = where, .rotation = random_rotation(dice)});
            const shape_id s = add_shape(w, b, dice, {.sensor = is_sensor});
            if (type != body_type::static_body) w.set_linear_velocity(b, velocity);
            return s;
        };
        // Of the sensor and the visitor one goes far, or both do.
        const int who = dice.below(3);
        const vec velocity = along(0, dice.number(60, 180)) + dice.vec<vec>(-8, 8);
        const body_type kinds[] = {body_type::static_body, body_type::kinematic_body, body_type::dynamic_body};
        const body_type kind = kinds[who == 0 ? dice.below(3) : 1 + dice.below(2)];
        const vec before = along(0, -dice.number(1.6, 1.8)) + dice.vec<vec>(-0.7, 0.7);
        const shape_id sensor = add(kind, who == 0 ? vec{} : before, who == 0 ? vec{} : velocity, true);
        const shape_id visitor = add(kinds[1 + dice.below(2)],
                                     who == 0   ? before
                                     : who == 1 ? vec{}
                                                : along(0, 1),
                                     who == 0   ? velocity
                                     : who == 1 ? vec{}
                                                : -velocity,
                                     false);
        if (dice.below(3) == 0 && kind != body_type::static_body && who != 0)
            w.set_angular_velocity(w.body(sensor), skew(dice.number(-60, 60)));
        const pose from_a = w.pose(w.body(sensor)), from_b = w.pose(w.body(visitor));
        listener told;
        w.step(S(h));
        told.hear(w);
        const double near = nearest(w, sensor, from_a, visitor, from_b, h);
        const bool is_in = told.inside.count({sensor, visitor}) == 1;
        if (std::abs(near) < 2e-3) continue;
        CAPTURE(near);
        CHECK(is_in == (near < 0));
        int visitors = 0;
        w.each_visitor(sensor, [&](shape_id) { ++visitors; });
        CHECK(visitors == is_in);
        passed += is_in;
        missed += !is_in;
        w.step(S(h));
        told.hear(w);
        w.step(S(h));
        told.hear(w);
        CHECK(told.inside.empty());
        CHECK(told.begins == told.ends);
    }
    CHECK(passed > 20);
    CHECK(missed > 5);
}
CELL_CASE("swept sensors: a bullet is seen by each of a row, of any thickness, at any speed") {
    for (const double speed : {30.0, 300.0, 900.0})
        for (const double thickness : {0.5, 0.01}) {
            CAPTURE(speed);
            CAPTURE(thickness);
            world w = at_rest();
            std::vector<shape_id> row;
            for (int i = 0; i < 5; ++i) {
                const body_id b = w.create_body({.type = body_type::static_body, .position = along(0, 1 + i)});
                vec half = vec::filled(S(0.5));
                half[0] = S(thickness / 2);
                row.push_back(w.create_shape(b, world::box{half}, {.sensor = true}));
            }
            const body_id bullet = events_laws::add(w, vec{}, 0.1);
            w.set_linear_velocity(bullet, along(0, speed));
            listener told;
            for (int i = 0; number(w.position(bullet).x) < 8; ++i) {
                w.step(S(1.0 / 64));
                told.hear(w);
            }
            w.step(S(1.0 / 64));
            told.hear(w);
            CHECK(told.begins == 5);
            CHECK(told.ends == 5);
        }
}
CELL_CASE("swept sensors: what is stopped before a sensor does not pass it") {
    world w = at_rest();
    const body_id wall = w.create_body({.type = body_type::static_body, .position = along(0, 2)});
    vec half = vec::filled(S(1));
    half[0] = S(0.05);
    w.create_shape(wall, world::box{half});
    const body_id behind = w.create_body({.type = body_type::static_body, .position = along(0, 3)});
    w.create_shape(behind, world::box{half}, {.sensor = true});
    const body_id before = w.create_body({.type = body_type::static_body, .position = along(0, 1)});
    const shape_id seen = w.create_shape(before, world::box{half}, {.sensor = true});
    const body_id bullet = events_laws::add(w, vec{}, 0.1);
    w.set_linear_velocity(bullet, along(0, 200));
    w.step(S(1.0 / 32));
    REQUIRE(w.sensor_begin_events().size() == 1);
    CHECK((*w.sensor_begin_events().begin()).sensor == seen);
    // A teleport is no way.
    w.set_pose(bullet, along(0, 8), {});
    w.set_linear_velocity(bullet, vec{});
    w.step(S(1.0 / 32));
    CHECK(w.sensor_begin_events().size() == 0);
    CHECK(w.sensor_end_events().size() == 1);
}

CELL_CASE("swept sensors: steps go on where a sensor is at the end of the range") {
    world w = at_rest();
    vec end;
    end[1] = cell::is_fixed ? cell::largest() * S(0.5) : cell::largest();
    const body_id far = w.create_body({.position = end, .linear_velocity = along(0, 100)});
    w.create_shape(far, world::ball{S(0.25)}, {.sensor = true});
    w.step(S(0.125));
    CHECK(w.position(far)[0] > S(12));
}

}  // namespace swept_sensors_laws
}  // namespace
