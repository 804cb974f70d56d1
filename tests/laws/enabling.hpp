// Bodies that are taken out of the simulation and put back, and islands: against worlds where they were never there.
#pragma once

#include <algorithm>
#include <set>
#include <vector>

#include "events.hpp"

namespace {
namespace enabling_laws {

using events_laws::add;
using events_laws::add_floor;
using events_laws::world;
using physics::error;
using physics::query_filter;
constexpr double step = 1.0 / 64;

template <class World>
void run(World& w, int steps) {
    for (int i = 0; i < steps; ++i) w.step(S(step));
}
bool is_found(const world& w, body_id b) {
    bool found = false;
    for (const query_filter& filter : {query_filter{}, query_filter{.any_category = true, .sensors = true},
                                       query_filter{.mask = ~0u, .kinds = physics::all_bodies}}) {
        const auto see = [&](shape_id s) { found = found || w.body(s) == b; };
        w.each_overlapping(world::ball{S(0.25)}, w.pose(b), filter, see);
        w.each_at(w.position(b), filter, see);
        const auto hit = w.cast_ray(w.position(b) + along(0, -4), along(0, 8), filter);
        if (hit) see(hit.shape);
        const auto swept = w.cast_shape(world::ball{S(0.1)}, {w.position(b) + along(0, -4), {}}, along(0, 8), filter);
        if (swept) see(swept.shape);
        const auto near = w.closest_shape(w.position(b), S(0.5), filter);
        if (near) see(near.shape);
    }
    return found;
}

CELL_CASE("enabling: a disabled body stands, is found by nothing, and goes on as if no time had passed") {
    world w, twin;
    const auto add_to = [](world& to) {
        const body_id one = to.create_body(
            {.position = at(0, 4), .linear_velocity = at(1, 2), .angular_velocity = skew(1), .user_data = 7});
        to.create_shape(one, world::ball{S(0.5)});
        return one;
    };
    const body_id b = add_to(w), other = add_to(twin);
    run(w, 10);
    run(twin, 10);
    CHECK(is_found(w, b));
    const auto pose = w.pose(b);
    const auto velocity = w.linear_velocity(b);
    w.set_enabled(b, false);
    CHECK(!w.enabled(b));
    CHECK(w.awake_count() == 0);
    run(w, 100);
    CHECK(w.pose(b) == pose);
    CHECK(w.linear_velocity(b) == velocity);
    CHECK(w.type(b) == body_type::dynamic_body);
    CHECK(w.user_data(b) == 7);
    CHECK(w.mass(b).mass == twin.mass(other).mass);
    CHECK(!is_found(w, b));
    w.set_enabled(b, true);
    CHECK(is_found(w, b));
    run(w, 30);
    run(twin, 30);
    CHECK(w.pose(b) == twin.pose(other));
    CHECK(w.linear_velocity(b) == twin.linear_velocity(other));
    CHECK(w.angular_velocity(b) == twin.angular_velocity(other));
}

/// Balls and boxes of all types, every other one with a sensor.
std::vector<body_id> add_heap(world& w, cell::dice& dice) {
    std::vector<body_id> all{add_floor(w)};
    for (int i = 0; i < 24; ++i) {
        const int kind = dice.below(6);
        const vec where = at(dice.number(-1.5, 1.5), dice.number(0.5, 4));
        const body_type type = kind == 0   ? body_type::static_body
                               : kind == 1 ? body_type::kinematic_body
                                           : body_type::dynamic_body;
        all.push_back(w.create_body({.type = type, .position = where, .user_data = std::uint64_t(i)}));
        if (kind == 1) w.set_linear_velocity(all.back(), dice.vec<vec>(-0.25, 0.25));
        if (i % 2) w.create_shape(all.back(), world::ball{S(0.3)});
        else w.create_shape(all.back(), world::box{vec::filled(S(0.25))});
        if (i % 3 == 0) w.create_shape(all.back(), world::ball{S(0.5)}, {.sensor = true});
    }
    return all;
}
CELL_CASE("enabling: to others a disabled body is one that was destroyed") {
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        CAPTURE(seed);
        cell::dice dice(seed), again(seed);
        world w, without;
        const auto all = add_heap(w, dice);
        add_heap(without, again);
        run(w, 48);
        run(without, 48);
        std::set<body_id> gone;
        for (int i = 0; i < 6; ++i) gone.insert(all[static_cast<std::size_t>(dice.below(int(all.size())))]);
        for (const body_id b : gone) {
            w.set_enabled(b, false);
            without.destroy_body({b.index, b.generation, (*without.bodies().begin()).world});
        }
        for (int i = 0; i < 32; ++i) {
            run(w, 1);
            run(without, 1);
            // What ended because they went is told of once, in the first step.
            CHECK(w.contact_end_events().size() == without.contact_end_events().size());
            CHECK(w.contact_begin_events().size() == without.contact_begin_events().size());
            CHECK(w.sensor_end_events().size() == without.sensor_end_events().size());
            CHECK(w.sensor_begin_events().size() == without.sensor_begin_events().size());
            for (const body_id b : without.bodies()) {
                const body_id same{b.index, b.generation, all[0].world};
                CHECK(w.pose(same) == without.pose(b));
                CHECK(w.linear_velocity(same) == without.linear_velocity(b));
                CHECK(w.is_asleep(same) == without.is_asleep(b));
            }
        }
    }
}
CELL_CASE("enabling: what stood on it falls, and what lies where it comes back is pushed away") {
    world w;
    const body_id shelf = w.create_body({.type = body_type::static_body, .position = at(0, 1)});
    w.create_shape(shelf, world::box{vec::filled(S(0.5))});
    add_floor(w);
    const body_id ball = add(w, at(0, 2));
    run(w, 128);
    CHECK(w.is_asleep(ball));
    w.set_enabled(shelf, false);
    CHECK(!w.is_asleep(ball));
    run(w, 192);
    CHECK(number(w.position(ball).y) == doctest::Approx(0.5).epsilon(0.02));
    CHECK(w.is_asleep(ball));
    w.set_pose(shelf, at(0.75, 1), {});
    CHECK(w.is_asleep(ball));
    w.set_enabled(shelf, true);
    CHECK(!w.is_asleep(ball));
    run(w, 64);
    CHECK(number(w.position(ball).x) < -0.2);
}
CELL_CASE("enabling: a body may be changed while it is disabled, and comes back as it is then") {
    world w;
    const body_id b = w.create_body({.type = body_type::kinematic_body, .linear_velocity = at(3, 0), .enabled = false});
    CHECK(!w.enabled(b));
    CHECK(w.type(b) == body_type::kinematic_body);
    w.create_shape(b, world::ball{S(0.5)});
    run(w, 8);
    CHECK(w.position(b) == vec{});
    CHECK(w.linear_velocity(b) == at(3, 0));
    w.set_type(b, body_type::dynamic_body);
    const shape_id box = w.create_shape(b, world::box{vec::filled(S(0.25))}, {.position = at(1, 0)});
    const auto both = w.mass(b);
    w.destroy_shape(box);
    CHECK(number(w.mass(b).mass) < number(both.mass));
    w.set_pose(b, at(5, 5), {});
    w.set_linear_velocity(b, at(-1, 0));
    w.set_gravity_scale(b, S(0));
    for (const shape_id s : w.shapes(b)) w.set_filter(s, {.category = 2});
    CHECK(!is_found(w, b));
    run(w, 8);
    CHECK(w.position(b) == at(5, 5));
    w.set_enabled(b, true);
    run(w, 64);
    CHECK(number(w.position(b).x) == doctest::Approx(4).epsilon(0.001));
    CHECK(number(w.position(b).y) == doctest::Approx(5).epsilon(0.001));
    w.set_enabled(b, false);
    w.set_type(b, body_type::static_body);
    CHECK(w.linear_velocity(b) == vec{});
    w.set_enabled(b, true);
    run(w, 8);
    CHECK(w.type(b) == body_type::static_body);
    w.set_enabled(b, false);
    w.destroy_body(b);
    CHECK(w.bodies().begin() == w.bodies().end());
}
CELL_CASE("enabling: what would act on a disabled body is refused by name, and changes nothing") {
    world w;
    const body_id b = add(w, at(0, 1)), lift = w.create_body({.type = body_type::kinematic_body});
    w.apply_force(b, at(5, 0));
    w.set_enabled(b, false);
    w.set_enabled(lift, false);
    const auto before = w.state_hash();
    const auto refused = [&](const std::string& name, auto&& call) {
        std::string text;
        try {
            call();
        } catch (const error& e) {
            text = e.what();
        }
        CHECK(text == "physics: " + name + ": body is disabled; it must be enabled");
        CHECK(w.state_hash() == before);
    };
    refused("apply_force", [&] { w.apply_force(b, at(1, 0)); });
    refused("apply_impulse_at", [&] { w.apply_impulse_at(b, at(1, 0), vec{}); });
    refused("apply_torque", [&] { w.apply_torque(b, skew(1)); });
    refused("apply_angular_impulse", [&] { w.apply_angular_impulse(b, skew(1)); });
    refused("move_to", [&] { w.move_to(lift, at(1, 0), {}); });
    // The force that waited is forgotten.
    w.set_enabled(b, true);
    run(w, 1);
    CHECK(w.linear_velocity(b).x == S(0));
}

CELL_CASE("islands: they are what touches, directly or through others, and what fell asleep together") {
    for (const std::uint64_t seed : {5u, 6u, 7u}) {
        CAPTURE(seed);
        cell::dice dice(seed);
        world w;
        const auto all = add_heap(w, dice);
        for (int i = 0; i < 10; ++i) {
            run(w, 24);
            for (const body_id b : all) {
                std::set<body_id> flood;
                if (w.type(b) == body_type::dynamic_body) flood.insert(b);
                for (std::size_t size = 0; size != flood.size();) {
                    size = flood.size();
                    for (const body_id x : all)
                        for (const body_id y : std::set<body_id>(flood))
                            if (w.type(x) == body_type::dynamic_body && w.is_asleep(x) == w.is_asleep(y) &&
                                w.touching(x, y))
                                flood.insert(x);
                }
                const auto island = w.island(b);
                CHECK(std::is_sorted(island.begin(), island.end()));
                const std::set<body_id> told(island.begin(), island.end());
                if (w.is_asleep(b)) CHECK(std::includes(told.begin(), told.end(), flood.begin(), flood.end()));
                else CHECK(told == flood);
            }
        }
    }
}

}  // namespace enabling_laws
}  // namespace
