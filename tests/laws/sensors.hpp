// Sensors: what is in them, against the distances of all shapes.
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "events.hpp"
#include "refusal.hpp"

namespace {
namespace sensors_laws {

using events_laws::add;
using events_laws::add_floor;
using events_laws::pair;
using events_laws::run;
using events_laws::world;
using filter = physics::collision_filter;

/// What is in which sensor, as far as events have told.
struct listener {
    std::map<pair, std::pair<std::uint64_t, std::uint64_t>> inside;
    int begins = 0, ends = 0, gone = 0;

    void hear(const world& w) {
        const auto is_ordered = [](const auto& x, const auto& y) {
            return std::pair(x.sensor.index, x.visitor.index) < std::pair(y.sensor.index, y.visitor.index);
        };
        const auto &begin = w.sensor_begin_events(), &end = w.sensor_end_events();
        CHECK(std::is_sorted(begin.begin(), begin.end(), is_ordered));
        CHECK(std::is_sorted(end.begin(), end.end(), is_ordered));
        for (const auto& e : end) {
            const auto known = inside.find({e.sensor, e.visitor});
            REQUIRE(known != inside.end());
            CHECK(known->second == std::pair(e.sensor_data, e.visitor_body_data));
            CHECK(e.gone == !(w.contains(e.sensor) && w.contains(e.visitor)));
            inside.erase(known);
            ++ends;
            gone += e.gone;
        }
        for (const auto& e : begin) {
            CHECK(w.body(e.sensor) == e.sensor_body);
            CHECK(w.body(e.visitor) == e.visitor_body);
            CHECK(w.is_sensor(e.sensor));
            CHECK(!e.gone);
            CHECK(inside.try_emplace({e.sensor, e.visitor}, e.sensor_data, e.visitor_body_data).second);
            ++begins;
        }
    }
};

inline double spin_of(S w) { return std::abs(number(w)); }
inline double spin_of(const physics::vec<S, 3>& w) { return number(length(w)); }
double distance(const world& w, shape_id a, shape_id b) {
    const auto at_a = w.pose(w.body(a)) * w.local_pose(a), at_b = w.pose(w.body(b)) * w.local_pose(b);
    const auto of_a = w.shape(a), of_b = w.shape(b);
    double found = 0;
    of_a.visit([&](const auto& x) {
        of_b.visit([&](const auto& y) {
            if constexpr (requires { physics::separation(x, y, relative(at_a, at_b)); })
                found = number(physics::separation(x, y, relative(at_a, at_b)).distance);
            else FAIL("shapes that have no distance");
        });
    });
    return found;
}
bool should_see(const world& w, shape_id sensor, shape_id visitor) {
    const filter a = w.filter(sensor), b = w.filter(visitor);
    const bool meets =
        a.group != 0 && a.group == b.group ? a.group > 0 : (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
    const bool both = w.enabled(w.body(sensor)) && w.enabled(w.body(visitor));
    return both && meets && w.is_sensor(sensor) && !w.is_sensor(visitor) && w.body(sensor) != w.body(visitor) &&
           (w.senses_static(sensor) || w.type(w.body(visitor)) != body_type::static_body);
}

/// Balls and boxes of all types, on a floor or in free space, every other one with a sensor.
struct crowd {
    world w;
    listener told;
    std::vector<body_id> bodies;
    std::uint64_t next_data = 1;

    explicit crowd(double gravity) : w(world::settings_type{.gravity = along(1, gravity)}) {
        // No halfspace: all have distances.
        bodies.push_back(w.create_body({.type = body_type::static_body, .position = at(0, -4)}));
        w.create_shape(bodies[0], world::box{vec::filled(S(4))});
    }
    void add_shape(body_id b, cell::dice& dice) {
        const vec local = dice.vec<vec>(-0.25, 0.25);
        const bool sensor = dice.below(2) == 0;
        const world::shape_def def{.position = local,
                                   .filter = {.mask = dice.below(8) ? 1u : 2u, .group = dice.below(8) ? 0 : 1},
                                   .sensor = sensor,
                                   .senses_static = sensor && dice.below(2) == 0,
                                   .user_data = next_data++};
        if (dice.below(2)) w.create_shape(b, world::ball{S(dice.number(0.2, 0.7))}, def);
        else w.create_shape(b, world::box{vec::filled(S(dice.number(0.2, 0.6)))}, def);
    }
    body_id any(cell::dice& dice) const {
        return bodies[static_cast<std::size_t>(dice.below(static_cast<int>(bodies.size())))];
    }
    void change(cell::dice& dice) {
        const int what = dice.below(15);
        if (bodies.size() < 6 || what < 4) {
            vec where = dice.vec<vec>(-1.5, 1.5);
            where.y = S(dice.number(0, 2.5));
            const int type = dice.below(6);
            bodies.push_back(w.create_body({.type = type == 0   ? body_type::static_body
                                                    : type == 1 ? body_type::kinematic_body
                                                                : body_type::dynamic_body,
                                            .position = where,
                                            .user_data = next_data++}));
            if (type == 1) w.set_linear_velocity(bodies.back(), dice.vec<vec>(-1, 1));
            for (int k = dice.below(3); k >= 0; --k) add_shape(bodies.back(), dice);
            return;
        }
        const body_id b = any(dice);
        if (b == bodies[0]) return;
        if (what < 6) {
            w.destroy_body(b);
            bodies.erase(std::find(bodies.begin(), bodies.end(), b));
        } else if (what == 6) {
            if (w.shapes(b).begin() != w.shapes(b).end()) w.destroy_shape(*w.shapes(b).begin());
        } else if (what == 7) {
            add_shape(b, dice);
        } else if (what == 8) {
            w.set_pose(b, dice.vec<vec>(-2, 2), random_rotation(dice));
        } else if (what == 9) {
            w.set_type(b, static_cast<body_type>(dice.below(3)));
        } else if (what == 10) {
            for (const shape_id s : w.shapes(b)) w.set_filter(s, {.mask = dice.below(2) ? 2u : 1u});
        } else if (what == 11) {
            w.wake(b);
        } else if (what > 13) {
            w.set_enabled(b, !w.enabled(b));
        } else if (w.type(b) == body_type::kinematic_body) {
            w.set_linear_velocity(b, dice.below(2) ? vec{} : dice.vec<vec>(-1, 1));
        }
    }
    /// What is thrown by more than it is thick may pass through them.
    void step() {
        std::map<body_id, vec> before;
        for (const body_id b : w.bodies()) before[b] = w.position(b);
        w.step(S(1.0 / 64));
        told.hear(w);
        // No shape reaches farther than 1.3 m from where its body turns.
        const auto goes = [&](shape_id s) {
            const body_id b = w.body(s);
            return number(length(w.position(b) - before[b])) + 1.3 / 64 * spin_of(w.angular_velocity(b));
        };
        std::vector<shape_id> all;
        for (const body_id b : w.bodies())
            for (const shape_id s : w.shapes(b)) all.push_back(s);
        std::size_t inside = 0;
        for (const shape_id sensor : all) {
            std::vector<shape_id> visitors;
            if (w.is_sensor(sensor)) w.each_visitor(sensor, [&](shape_id v) { visitors.push_back(v); });
            CHECK(std::is_sorted(visitors.begin(), visitors.end()));
            inside += visitors.size();
            for (const shape_id visitor : all) {
                const bool is_inside = std::binary_search(visitors.begin(), visitors.end(), visitor);
                CHECK(told.inside.count({sensor, visitor}) == is_inside);
                if (!should_see(w, sensor, visitor)) {
                    CHECK(!is_inside);
                    continue;
                }
                const double apart = distance(w, sensor, visitor);
                const bool may_pass = is_inside && goes(sensor) + goes(visitor) > 0.1;
                if (std::abs(apart) > rounding(256, 8) && !may_pass) CHECK(is_inside == (apart < 0));
            }
        }
        CHECK(told.inside.size() == inside);
    }
};
CELL_CASE("sensors: what is in them is what overlaps them, whatever moves, sleeps, changes and goes") {
    int begins = 0, gone = 0;
    std::uint32_t asleep = 0;
    for (int seed = 0; seed < 10; ++seed) {
        cell::dice dice(static_cast<std::uint64_t>(7400 + seed));
        crowd t(seed % 2 ? -10 : 0);
        for (int i = 0; i < 140; ++i) {
            if (i < 40 || i % 40 == 0)
                for (int k = dice.below(4); k > 0; --k) t.change(dice);
            t.step();
        }
        asleep += t.w.body_count() - t.w.awake_count();
        t.w.clear();
        t.step();
        CHECK(t.told.inside.empty());
        CHECK(t.told.begins == t.told.ends);
        begins += t.told.begins;
        gone += t.told.gone;
    }
    CHECK(begins > 150);
    CHECK(gone > 20);
    CHECK(asleep > 4);
}

CELL_CASE("sensors: bodies move as if there were none, to the bit") {
    const auto fill = [](auto& w, bool with) {
        add_floor(w);
        std::vector<body_id> bodies;
        for (int i = 0; i < 10; ++i) bodies.push_back(add(w, at(0.3 * (i % 3), 0.6 + 0.9 * i), 0.5, 0.25));
        const body_id lift = w.create_body({.type = body_type::kinematic_body, .position = at(2, 0)});
        w.create_shape(lift, world::box{vec::filled(S(0.5))});
        w.set_linear_velocity(lift, along(0, -0.5));
        bodies.push_back(lift);
        if (!with) return bodies;
        for (const body_id b : bodies) w.create_shape(b, world::box{vec::filled(S(0.75))}, {.sensor = true});
        const body_id still = w.create_body({.type = body_type::static_body, .position = at(0, 2)});
        w.create_shape(still, world::ball{S(1)}, {.sensor = true});
        return bodies;
    };
    world with, without;
    const auto a = fill(with, true), b = fill(without, false);
    for (int i = 0; i < 250; ++i) {
        with.step(S(1.0 / 64));
        without.step(S(1.0 / 64));
        for (std::size_t k = 0; k < a.size(); ++k) {
            CHECK(with.position(a[k]) == without.position(b[k]));
            CHECK(with.linear_velocity(a[k]) == without.linear_velocity(b[k]));
            CHECK(with.is_asleep(a[k]) == without.is_asleep(b[k]));
        }
    }
    CHECK(number(with.mass(a[0]).mass) == number(without.mass(b[0]).mass));
}

/// Steps until a body sleeps, which tells nothing.
void let_sleep(world& w, body_id b) {
    for (int i = 0; i < 400 && !w.is_asleep(b); ++i) {
        w.step(S(1.0 / 64));
        CHECK(w.sensor_begin_events().empty());
        CHECK(w.sensor_end_events().empty());
    }
    REQUIRE(w.is_asleep(b));
}
CELL_CASE("sensors: one that stands sees what sleeps, as soon as it is there, changes or goes") {
    world w;
    add_floor(w);
    const body_id ball = add(w, at(0, 0.5));
    let_sleep(w, ball);
    const body_id still = w.create_body({.type = body_type::static_body, .position = at(0, 0.5)});
    const shape_id zone = w.create_shape(still, world::box{vec::filled(S(1))}, {.sensor = true});
    const auto expect = [&](std::uint32_t begins, std::uint32_t ends) {
        w.step(S(1.0 / 64));
        CHECK(w.sensor_begin_events().size() == begins);
        CHECK(w.sensor_end_events().size() == ends);
        let_sleep(w, ball);
    };
    expect(1, 0);
    w.set_pose(still, at(8, 0), {});
    expect(0, 1);
    w.set_pose(still, at(0, 1), {});
    expect(1, 0);
    w.set_filter(zone, {.mask = 0});
    expect(0, 1);
    w.set_filter(zone, {});
    expect(1, 0);
    w.set_filter(*w.shapes(ball).begin(), {.category = 2});
    expect(0, 0);
    w.set_type(still, body_type::kinematic_body);
    expect(0, 0);
    w.set_linear_velocity(still, along(0, 128));
    expect(0, 1);
    w.set_linear_velocity(still, {});
    w.set_type(still, body_type::static_body);
    w.set_pose(still, at(0, 1), {});
    expect(1, 0);
    w.destroy_shape(zone);
    expect(0, 1);
}
CELL_CASE("sensors: surfaces without mass may be sensors of what moves") {
    world w(world::settings_type{.gravity = {}});
    const body_id cart = w.create_body(), ball = add(w, at(0, -3));
    const shape_id below = w.create_shape(cart, world::halfspace{}, {.position = at(0, -1), .sensor = true});
    w.set_type(cart, body_type::kinematic_body);
    w.set_type(cart, body_type::dynamic_body);
    w.step(S(1.0 / 64));
    REQUIRE(w.sensor_begin_events().size() == 1);
    CHECK(w.sensor_begin_events()[0].sensor == below);
    CHECK(w.sensor_begin_events()[0].visitor_body == ball);
    CHECK_THROWS_AS(w.create_shape(cart, world::halfspace{}), physics::error);
}

CELL_CASE("sensors: a recipe that does not name them refuses them") {
    ::world w;
    const body_id b = w.create_body();
    refuses(w, "create_shape", "sensor", "true", [&] { w.create_shape(b, world::ball{}, {.sensor = true}); });
}

CELL_CASE("sensors: queries see them only if they ask to, and fast bodies pass through them") {
    world w(world::settings_type{.gravity = {}});
    const body_id still = w.create_body({.type = body_type::static_body, .position = at(2, 0)});
    const shape_id gate = w.create_shape(still, world::box{vec::filled(S(0.5))}, {.sensor = true});
    CHECK(w.is_sensor(gate));
    CHECK(!w.cast_ray({}, along(0, 4)));
    CHECK(w.cast_ray({}, along(0, 4), {.sensors = true}).shape == gate);
    CHECK(!w.closest_shape({}, S(4)));
    CHECK(w.closest_shape({}, S(4), {.sensors = true}).shape == gate);
    int seen = 0;
    w.each_at(at(2, 0), {}, [&](shape_id) { ++seen; });
    w.each_at(at(2, 0), {.sensors = true}, [&](shape_id) { ++seen; });
    CHECK(seen == 1);
    const body_id ball = add(w, {}, 0.25);
    w.set_linear_velocity(ball, along(0, 96));
    w.step(S(1.0 / 16));
    CHECK(number(w.position(ball).x) == 6);
    CHECK(w.contacts().size() == 0);
}
CELL_CASE("sensors: a body of sensors alone is a point, and one that holds itself up by nothing falls") {
    world w;
    add_floor(w);
    const body_id ghost = w.create_body({.position = at(0, 0.25)});
    w.create_shape(ghost, world::ball{S(0.5)}, {.sensor = true});
    CHECK(number(w.mass(ghost).mass) == 1);
    run(w, 64);
    CHECK(number(w.position(ghost).y) < -4);
    CHECK(w.contacts().size() == 0);
}
CELL_CASE("sensors: a thousand on one body, and what is in many of them at once") {
    world w;
    add_floor(w);
    const body_id still = w.create_body({.type = body_type::static_body});
    for (int i = 0; i < 1000; ++i)
        w.create_shape(still, world::ball{S(0.5)}, {.position = at(2 * (i % 32), 2 * (i / 32)), .sensor = true});
    for (int i = 0; i < 4; ++i) w.step(S(1.0 / 64));
    CHECK(w.sensor_begin_events().empty());
    // One that comes into many.
    const body_id ball = add(w, at(1, 1), 20);
    w.step(S(1.0 / 64));
    CHECK(w.sensor_begin_events().size() > 100);
    const auto entered = w.sensor_begin_events().size();
    w.destroy_body(ball);
    w.step(S(1.0 / 64));
    CHECK(w.sensor_end_events().size() == entered);
}

CELL_CASE("sensors: what is removed has left at once, and others that get its number come in as others") {
    cell::dice dice(5);
    world w{{.gravity = {}}};
    listener heard;
    std::vector<body_id> zones, guests;
    const auto add_zone = [&] {
        zones.push_back(w.create_body({.type = body_type::static_body}));
        w.create_shape(zones.back(), world::ball{S(4)}, {.sensor = true});
    };
    const auto add_guest = [&] {
        guests.push_back(w.create_body({.position = at(dice.number(-6, 6), dice.number(-6, 6))}));
        w.create_shape(guests.back(), world::ball{S(0.25)}, {.filter = {.group = -1}});
    };
    const auto drop_any = [&](std::vector<body_id>& from) {
        const std::size_t which = std::size_t(dice.below(int(from.size())));
        w.destroy_body(from[which]);
        from.erase(from.begin() + long(which));
    };
    for (int i = 0; i < 3; ++i) add_zone();
    for (int i = 0; i < 40; ++i) add_guest();
    for (int round = 0; round < 30; ++round) {
        w.step(S(1.0 / 64));
        heard.hear(w);
        // As long as nothing steps, visitors are those of the step that are left.
        std::map<pair, std::pair<std::uint64_t, std::uint64_t>> left = heard.inside;
        for (int i = dice.below(12); i > 0; --i) {
            const int what = dice.below(8);
            if (what == 0 && zones.size() > 1) drop_any(zones), add_zone();
            else if (what < 4) drop_any(guests), add_guest();
            else if (guests.size() > 4) drop_any(guests);
            const world copy = w;
            for (const world* each : {static_cast<const world*>(&w), &copy}) {
                std::set<pair> seen, expected;
                for (const body_id zone : zones)
                    for (const shape_id sensor : each->shapes(zone))
                        each->each_visitor(sensor, [&](shape_id visitor) { seen.insert({sensor, visitor}); });
                for (const auto& [key, data] : left)
                    if (w.contains(key.first) && w.contains(key.second)) expected.insert(key);
                CHECK(seen.size() == expected.size());
                if (each == &w) CHECK((seen == expected));
            }
        }
        while (guests.size() < 40) add_guest();
    }
    CHECK(heard.gone > 50);
}

}  // namespace sensors_laws
}  // namespace
