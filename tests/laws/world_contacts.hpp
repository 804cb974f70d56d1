// What happens between bodies: what collisions conserve, and what the list of contacts tells.
#pragma once

#include <algorithm>
#include <vector>

#include "world_real.hpp"

namespace {

inline double size_of_friction(S along) { return std::abs(number(along)); }
inline double size_of_friction(physics::vec<S, 2> along) { return number(physics::length(along)); }

CELL_CASE("contacts: collisions conserve momentum, and angular momentum but for what bodies move within a step") {
    cell::dice dice(1);
    for (int round = 0; round < 6; ++round) {
        CAPTURE(round);
        world w(weightless());
        const physics::material<S, cell::dimension> surface{.friction = S(0.25 * round), .restitution = S(0.2 * round)};
        double mass = 0;
        for (int i = 0; i < 12; ++i) {
            world::body_def def;
            def.position = at(1.1 * (i % 4), 1.1 * (i / 4)) + dice.vec<vec>(-0.25, 0.25);
            def.rotation = random_rotation(dice);
            def.linear_velocity = dice.vec<vec>(-2, 2) - (def.position - at(1.6, 1)) * S(1);
            def.angular_velocity = skew(dice.number(-1, 1));
            const body_id id = w.create_body(def);
            const world::shape_def with{.density = dice.real(0.5, 2), .material = surface};
            if (i % 3 == 0) w.create_shape(id, world::ball{S(0.5)}, with);
            else if (i % 3 == 1) w.create_shape(id, world::box{vec::filled(S(0.4))}, with);
            else w.create_shape(id, world::capsule{S(0.3), S(0.25)}, with);
            mass += number(w.mass(id).mass);
        }
        const momentum before = momentum_of(w);
        int steps = 0;
        std::uint32_t contacts = 0;
        double slip = 0;
        for (; steps < 96; ++steps) {
            double fastest = 0;
            for (const body_id id : w.bodies())
                fastest = std::max(fastest, number(physics::length(w.linear_velocity(id))));
            run(w, 1);
            contacts += w.contacts().size();
            // Contacts stay where they were as the step began, while the bodies go on past each other.
            for (const auto& c : w.contacts())
                for (int k = 0; k < c.count; ++k)
                    slip += 2 * fastest / 64 *
                            (number(c.points[k].normal_impulse) + size_of_friction(c.points[k].friction_impulse));
        }
        CHECK(contacts > 24);
        // Every impulse acts on both bodies. Rounding: some operations a body and step.
        const momentum change = momentum_of(w) - before;
        const double tolerance = rounding(16 * steps, 8 * mass);
        CHECK(spread(change.linear, {}) <= tolerance);
        CHECK(spread(change.angular, real_angular{}) <= 8 * tolerance + slip);
    }
}

/// The impulse of a contact on its body B.
vec impulse_of(const world::contact_view& c) {
    vec sum;
    for (int k = 0; k < c.count; ++k)
        sum += c.normal * c.points[k].normal_impulse + c.tangents.combine(c.points[k].friction_impulse);
    return sum;
}

CELL_CASE("contacts: at rest the impulses carry the weight, on the level and on a slope that friction holds") {
    for (const double angle : {0.0, 0.3}) {
        CAPTURE(angle);
        world::settings_type settings;
        settings.gravity = at(-8 * std::sin(angle), -8 * std::cos(angle));
        world w(settings);
        const body_id ground = add_ground(w), box = add_box(w, at(0, 0.5));
        run(w, 128);
        const double weight = number(w.mass(box).mass) * 8 / 64;
        vec sum;
        int points = 0;
        for (const auto& c : w.contacts()) {
            CHECK((c.body_a == box ? c.body_b : c.body_a) == ground);
            CHECK((c.body_a == box || c.body_b == box));
            sum += c.body_b == box ? impulse_of(c) : -impulse_of(c);
            points += c.count;
            for (int k = 0; k < c.count; ++k) CHECK(c.points[k].persisted);
        }
        CHECK(points == (cell::is_2d ? 2 : 4));
        CHECK(gap(sum, at(weight * std::sin(angle), weight * std::cos(angle))) <= 0.01 * weight);
        CHECK(number(physics::length(w.linear_velocity(box))) <= 1e-3);
    }
}

CELL_CASE("contacts: each tells its bodies, a unit normal from A to B, and points that both bodies know") {
    cell::dice dice(2);
    world w(weightless());
    for (int i = 0; i < 16; ++i) {
        const body_id id = w.create_body({.position = dice.vec<vec>(-1, 1), .rotation = random_rotation(dice)});
        world::shape_def def;
        def.position = dice.vec<vec>(-0.2, 0.2);
        def.rotation = random_rotation(dice);
        if (i % 3 == 0) w.create_shape(id, world::ball{S(0.4)}, def);
        else if (i % 3 == 1) w.create_shape(id, world::box{vec::filled(S(0.3))}, def);
        else w.create_shape(id, world::capsule{S(0.3), S(0.2)}, def);
    }
    // The poses as the step begins are those for which the points of both bodies agree.
    const world before = w;
    run(w, 1);
    REQUIRE(w.contacts().size() > 10);
    std::uint32_t count = 0;
    for (const auto& c : w.contacts()) {
        ++count;
        CHECK(w.contains(c.shape_a));
        CHECK(w.contains(c.shape_b));
        CHECK(w.body(c.shape_a) == c.body_a);
        CHECK(w.body(c.shape_b) == c.body_b);
        CHECK(c.body_a != c.body_b);
        CHECK(std::abs(number(physics::length(c.normal)) - 1) <= rounding(16));
        REQUIRE(c.count > 0);
        REQUIRE(c.count <= physics::manifold<S, cell::dimension>::capacity);
        for (int k = 0; k < c.count; ++k) {
            const auto& p = c.points[k];
            CHECK(gap(before.pose(c.body_a) * p.local_a, before.pose(c.body_b) * p.local_b) <= rounding(32, 4));
            CHECK(gap(w.pose(c.body_a) * p.local_a, p.position) <= rounding(32, 4));
            CHECK(number(p.separation) <= number(w.settings().contact_margin));
            CHECK(number(p.normal_impulse) >= 0);
            CHECK_FALSE(p.persisted);
        }
    }
    CHECK(count == w.contacts().size());
    run(w, 1);
    int persisted_mask = 0;
    for (const auto& c : w.contacts())
        for (int k = 0; k < c.count; ++k) persisted_mask += c.points[k].persisted;
    CHECK(persisted_mask > 0);

    // Balls tell the normal without doubt.
    world two(weightless());
    const body_id low = add_ball(two, {}), high = add_ball(two, at(0.3, 0.4));
    run(two, 1);
    const auto c = *two.contacts().begin();
    CHECK(gap(c.normal, c.body_a == low ? at(0.6, 0.8) : at(-0.6, -0.8)) <= rounding(8));
    CHECK(gap(c.points[0].separation, S(-0.5)) <= rounding(8));
    CHECK(gap(c.points[0].local_b + (c.body_b == high ? at(0.15, 0.2) : at(-0.15, -0.2)), {}) <= rounding(8));
}

CELL_CASE("contacts: surfaces mix, friction by the mean of their squares, bounce by the larger, and may change") {
    world w;
    const body_id ground = w.create_body({.type = body_type::static_body});
    const shape_id floor =
        w.create_shape(ground, world::halfspace{}, {.material = {.friction = S(0.25), .restitution = S(0.5)}});
    const body_id box = w.create_body({.position = at(0, 0.5), .linear_velocity = at(4, 0)});
    const shape_id block = w.create_shape(box, world::box{}, {.material = {.friction = S(1), .restitution = S(0)}});
    run(w, 1);
    REQUIRE(w.contacts().size() == 1);
    CHECK((*w.contacts().begin()).friction == S(0.5));
    CHECK((*w.contacts().begin()).restitution == S(0.5));
    CHECK(w.material(floor).friction == S(0.25));
    w.set_material(block, {.friction = S(0), .restitution = S(1)});
    CHECK(w.material(block).restitution == S(1));
    const vec v = w.linear_velocity(box);
    run(w, 32);
    CHECK(gap(w.linear_velocity(box).x, v.x) <= rounding(200, 4));
    CHECK((*w.contacts().begin()).restitution == S(1));
    w.set_material(floor, {.friction = S(0.5)});
    w.set_material(block, {.friction = S(0.5)});
    run(w, 96);
    CHECK(number(physics::length(w.linear_velocity(box))) <= 0.02);
}

CELL_CASE("contacts: what they hold may be destroyed; the rest goes on as if it had never been there") {
    world::settings_type settings;
    settings.gravity = along(1, -8);
    world w(settings);
    const body_id ground = add_ground(w);
    std::vector<body_id> tower;
    for (int i = 0; i < 4; ++i) tower.push_back(add_box(w, at(0, 0.5 + i)));
    run(w, 32);
    CHECK(w.contacts().size() == 4);
    w.destroy_body(tower[1]);
    CHECK(w.contacts().size() == 2);
    run(w, 1);
    // What the springs had still to push lets go of them.
    CHECK(gap(w.linear_velocity(tower[2]).y, S(-0.125)) <= 0.005);
    for (const shape_id s : w.shapes(tower[0])) w.destroy_shape(s);
    CHECK(w.contacts().size() == 1);
    run(w, 64);
    CHECK(number(w.position(tower[0]).y) < -1);
    w.destroy_body(ground);
    CHECK(w.contacts().size() == 1);
    const S speed = w.linear_velocity(tower[3]).y;
    run(w, 64);
    CHECK(gap(w.linear_velocity(tower[3]).y, speed - S(8)) <= 1e-3);
    w.destroy_body(tower[2]);
    CHECK(w.contacts().size() == 0);
    run(w, 1);
    CHECK(w.body_count() == 2);
}

CELL_CASE("contacts: two static or kinematic bodies have none, nor have the shapes of one body") {
    world w;
    const body_id ground = add_ground(w);
    w.create_shape(ground, world::ball{});
    for (int i = 0; i < 2; ++i) {
        const body_id mover = w.create_body({.type = body_type::kinematic_body, .position = at(0.1 * i, 0)});
        w.create_shape(mover, world::box{});
    }
    const body_id pair = w.create_body({.position = at(0, 20)});
    w.create_shape(pair, world::box{});
    w.create_shape(pair, world::ball{});
    run(w, 2);
    CHECK(w.contacts().size() == 0);
}

CELL_CASE("contacts: a shape that takes the place and the number of another is met anew") {
    world w;
    const body_id table = w.create_body({.type = body_type::static_body}),
                  guest = w.create_body({.position = at(0, 1)});
    w.create_shape(table, world::box{});
    const shape_id tall = w.create_shape(guest, world::box{});
    run(w, 8);
    CHECK(w.contacts().size() == 1);
    const vec rest = w.position(guest);
    w.destroy_shape(tall);
    const shape_id flat = w.create_shape(guest, world::box{at(0.5, 0.25) + (vec::filled(S(0.5)) - at(0.5, 0.5))});
    CHECK(flat.index == tall.index);
    w.set_pose(guest, rest, {});
    run(w, 1);
    CHECK(w.contacts().size() == 0);
}

CELL_CASE("contacts: a wider margin is heeded at once, by pairs that do not move too") {
    world w({.gravity = {}});
    const body_id table = w.create_body({.type = body_type::static_body});
    w.create_shape(table, world::box{});
    // Tilted, so that one side is within the first margin and the other within the second one only.
    const double half = 0.5, tilt = 0.04;
    const body_id lid =
        w.create_body({.position = at(0, 2 * half + 0.01 + half * tilt), .rotation = turned_about_z(tilt)});
    w.create_shape(lid, world::box{});
    run(w, 2);
    REQUIRE(w.contacts().size() == 1);
    for (const auto& c : w.contacts()) CHECK(c.count == cell::dimension - 1);
    auto wider = w.settings();
    wider.contact_margin = S(0.1);
    w.set_settings(wider);
    run(w, 1);
    for (const auto& c : w.contacts()) CHECK(c.count == 2 * (cell::dimension - 1));
}

}  // namespace
