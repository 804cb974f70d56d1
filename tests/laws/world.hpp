// How bodies and shapes come and go, and what a world as a value is worth: copies, moves, hashes, handles.
#pragma once

#include <algorithm>
#include <cfenv>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "world_bodies.hpp"
#include "world_cell.hpp"
#include "world_contacts.hpp"

// Compiles every member, in every cell.
template class physics::world<scene>;

namespace {
namespace world_laws {

/// What a world should hold.
struct model_body {
    std::uint64_t user_data;
    std::vector<shape_id> shapes;  // in descending order of their numbers
};
template <class Handle>
struct by_index {
    bool operator()(Handle a, Handle b) const { return a.index < b.index; }
};
using model = std::map<body_id, model_body, by_index<body_id>>;

void check_against(const world& w, const model& expected, const std::vector<body_id>& dead_bodies,
                   const std::vector<shape_id>& dead_shapes) {
    std::size_t shapes = 0;
    auto next = expected.begin();
    for (const body_id id : w.bodies()) {
        REQUIRE(next != expected.end());
        const auto& [name, body] = *next++;
        REQUIRE(id == name);
        REQUIRE(w.contains(id));
        REQUIRE(w.user_data(id) == body.user_data);
        auto shape = body.shapes.begin();
        for (const shape_id s : w.shapes(id)) {
            REQUIRE(shape != body.shapes.end());
            REQUIRE(s == *shape++);
            REQUIRE(w.contains(s));
            REQUIRE(w.body(s) == id);
            REQUIRE(w.user_data(s) == body.user_data + 1);
        }
        REQUIRE(shape == body.shapes.end());
        shapes += body.shapes.size();
    }
    REQUIRE(next == expected.end());
    REQUIRE(w.body_count() == expected.size());
    REQUIRE(w.shape_count() == shapes);
    for (const body_id id : dead_bodies) REQUIRE_FALSE(w.contains(id));
    for (const shape_id id : dead_shapes) REQUIRE_FALSE(w.contains(id));
    for (const auto& c : w.contacts()) {
        REQUIRE(w.contains(c.shape_a));
        REQUIRE(w.contains(c.shape_b));
        REQUIRE(w.body(c.shape_a) == c.body_a);
        REQUIRE(w.body(c.shape_b) == c.body_b);
    }
}

/// Any shape of the default set that fits within half a metre.
shape_id add_any_shape(world& w, body_id id, cell::dice& dice, const world::shape_def& def) {
    switch (dice.below(w.type(id) == body_type::dynamic_body ? 3 : 4)) {
        case 0: return w.create_shape(id, world::ball{dice.real(0.1, 0.5)}, def);
        case 1: return w.create_shape(id, world::capsule{dice.real(0.1, 0.25), dice.real(0.1, 0.25)}, def);
        case 2: return w.create_shape(id, world::box{dice.vec<vec>(0.1, 0.5)}, def);
        default: return w.create_shape(id, world::halfspace{}, def);
    }
}

CELL_CASE("world: bodies and shapes come and go in any order, in contact too") {
    cell::dice dice(1);
    for (int round = 0; round < 4; ++round) {
        world w;
        model expected;
        std::vector<body_id> dead_bodies;
        std::vector<shape_id> dead_shapes;
        std::size_t contacts = 0;
        for (int i = 0; i < 400; ++i) {
            const auto any_body = [&] {
                auto which = expected.begin();
                std::advance(which, dice.below(static_cast<int>(expected.size())));
                return which;
            };
            const int action = expected.empty() ? 0 : dice.below(8);
            if (action < 2) {
                world::body_def def;
                def.position = dice.vec<vec>(-1.5, 1.5);
                def.rotation = random_rotation(dice);
                def.type = static_cast<body_type>(dice.below(8) < 6 ? 2 : dice.below(2));
                def.user_data = dice.bits();
                const body_id id = w.create_body(def);
                REQUIRE(expected.emplace(id, model_body{def.user_data, {}}).second);
            } else if (action < 5) {
                const auto b = any_body();
                world::shape_def def;
                def.position = dice.vec<vec>(-0.25, 0.25);
                def.user_data = b->second.user_data + 1;
                auto& shapes = b->second.shapes;
                const shape_id made = add_any_shape(w, b->first, dice, def);
                shapes.insert(
                    std::find_if(shapes.begin(), shapes.end(), [&](shape_id s) { return s.index < made.index; }), made);
            } else if (action == 5) {
                const auto b = any_body();
                auto& shapes = b->second.shapes;
                if (shapes.empty()) continue;
                const auto s = shapes.begin() + dice.below(static_cast<int>(shapes.size()));
                w.destroy_shape(*s);
                dead_shapes.push_back(*s);
                shapes.erase(s);
            } else if (action == 6 && dice.below(2) == 0) {
                const auto b = any_body();
                w.destroy_body(b->first);
                dead_bodies.push_back(b->first);
                dead_shapes.insert(dead_shapes.end(), b->second.shapes.begin(), b->second.shapes.end());
                expected.erase(b);
            } else if (action == 7) {
                run(w, 1);
                contacts += w.contacts().size();
            }
            if (i % 16 == 0) check_against(w, expected, dead_bodies, dead_shapes);
        }
        check_against(w, expected, dead_bodies, dead_shapes);
        CHECK(contacts > 100);
        for (const auto& entry : expected) w.destroy_body(entry.first);
        CHECK(w.body_count() + w.shape_count() + w.contacts().size() == 0);
        run(w, 1);
    }
}

CELL_CASE("world: a loop over bodies may destroy the body that it is at") {
    world w;
    for (int i = 0; i < 10; ++i) add_ball(w, at(0.5 * i, 0));
    run(w, 1);
    std::uint32_t index = 0;
    for (const body_id id : w.bodies()) {
        CHECK(id.index == index++);
        if (id.index % 3 == 0) w.destroy_body(id);
    }
    CHECK(index == 10);
    CHECK(w.body_count() == 6);
    run(w, 1);
}

CELL_CASE("world: a slot that is used again has a new handle, and the old one stays stale") {
    world w;
    std::vector<body_id> old;
    for (int i = 0; i < 100; ++i) {
        const body_id id = w.create_body();
        CHECK(id.index == 0);
        for (const body_id stale : old) REQUIRE_FALSE(w.contains(stale));
        old.push_back(id);
        w.destroy_body(id);
    }
    CHECK_FALSE(w.contains(body_id{}));
    CHECK_FALSE(w.contains(shape_id{}));
    world other;
    CHECK_FALSE(w.contains(other.create_body()));
}

/// A few bodies of all types that meet at once.
struct crowd {
    world w;
    body_id ground, platform, box, ball;
    shape_id face;

    explicit crowd(const world::settings_type& settings = {}) : w(settings) {
        ground = add_ground(w);
        platform = w.create_body(
            {.type = body_type::kinematic_body, .position = at(3, 0.25), .linear_velocity = along(0, -1)});
        w.create_shape(platform, world::box{vec::filled(S(0.25))});
        box = add_box(w, at(0, 0.5));
        ball = w.create_body({.position = at(0.25, 1.5), .angular_velocity = about_z(2)});
        face = w.create_shape(ball, world::ball{S(0.5)}, {.material = {.restitution = S(0.5)}});
    }
};

CELL_CASE("world: the same history gives the same hash, step by step") {
    crowd a, b;
    CHECK(a.w.state_hash() == b.w.state_hash());
    std::vector<std::uint64_t> seen;
    for (int i = 0; i < 100; ++i) {
        if (i % 10 == 0)
            for (world* w : {&a.w, &b.w}) {
                w->apply_impulse(w == &a.w ? a.ball : b.ball, at(0.5, 1));
                w->destroy_body(add_ball(*w, at(5, 5)));
            }
        run(a.w, 1);
        run(b.w, 1);
        REQUIRE(a.w.state_hash() == b.w.state_hash());
        REQUIRE(std::find(seen.begin(), seen.end(), a.w.state_hash()) == seen.end());
        seen.push_back(a.w.state_hash());
    }
}

/// The number next to x.
S next_to(S x) {
    if constexpr (cell::is_fixed) return x + cell::traits::epsilon();
    else return S(number(x) + number(cell::traits::epsilon()) * std::max(1.0, std::abs(number(x))));
}

CELL_CASE("world: every change of a bit that matters changes the hash; user data does not matter") {
    crowd start;
    run(start.w, 20);
    CHECK(start.w.contacts().size() > 0);
    const std::uint64_t before = start.w.state_hash();
    int which = 0;
    const auto check = [&](auto&& change) {
        CAPTURE(which);
        ++which;
        crowd c = start;
        CHECK(c.w.state_hash() == before);
        change(c);
        CHECK(c.w.state_hash() != before);
    };
    check([](crowd& c) { c.w.set_pose(c.box, c.w.position(c.box) + along(0, 1), c.w.rotation(c.box)); });
    check([](crowd& c) { c.w.set_pose(c.box, c.w.position(c.box), turned_about_z(0.25)); });
    check([](crowd& c) {
        vec v = c.w.linear_velocity(c.box);
        v.x = next_to(v.x);
        c.w.set_linear_velocity(c.box, v);
    });
    check([](crowd& c) {
        c.w.set_angular_velocity(c.box, c.w.angular_velocity(c.box) + about_z(2 * number(cell::traits::epsilon())));
    });
    check([](crowd& c) { c.w.apply_force(c.box, along(1, number(cell::traits::epsilon()))); });
    check([](crowd& c) { c.w.apply_torque(c.box, about_z(number(cell::traits::epsilon()))); });
    check([](crowd& c) { c.w.move_to(c.platform, c.w.pose(c.platform)); });
    check([](crowd& c) { c.w.set_type(c.platform, body_type::static_body); });
    check([](crowd& c) {
        auto mass = c.w.mass(c.box);
        mass.mass = next_to(mass.mass);
        c.w.set_mass(c.box, mass);
    });
    check([](crowd& c) { c.w.set_mass(c.box, c.w.mass(c.box)); });
    check([](crowd& c) { c.w.set_damping(c.box, cell::traits::epsilon(), S(0)); });
    check([](crowd& c) { c.w.set_damping(c.box, S(0), cell::traits::epsilon()); });
    check([](crowd& c) { c.w.set_gravity_scale(c.box, next_to(S(1))); });
    check([](crowd& c) { c.w.set_rotation_locked(c.box, true); });
    check([](crowd& c) { c.w.set_material(c.face, {.friction = next_to(S(0.6)), .restitution = S(0.5)}); });
    check([](crowd& c) { c.w.set_material(c.face, {.restitution = next_to(S(0.5))}); });
    check([](crowd& c) {
        c.w.set_material(c.face, {.restitution = S(0.5), .rolling_resistance = cell::traits::epsilon()});
    });
    check([](crowd& c) {
        c.w.set_material(c.face, {.restitution = S(0.5), .surface_velocity = about_z(number(cell::traits::epsilon()))});
    });
    check([](crowd& c) { c.w.create_body(); });
    check([](crowd& c) { c.w.create_shape(c.ground, world::ball{}); });
    check([](crowd& c) { c.w.destroy_shape(c.face); });
    check([](crowd& c) { c.w.destroy_body(c.ball); });
    check([](crowd& c) { run(c.w, 1); });
    check([](crowd& c) {
        c.w.destroy_shape(c.w.create_shape(c.ground, world::ball{})), c.w.create_shape(c.ground, world::ball{});
    });

    crowd other = start;
    start.w.move_to(start.platform, at(1, 2), {});
    other.w.move_to(other.platform, at(1, 3), {});
    CHECK(start.w.state_hash() != other.w.state_hash());
    other.w.move_to(other.platform, at(1, 2), {});
    CHECK(start.w.state_hash() == other.w.state_hash());

    const std::uint64_t with_target = start.w.state_hash();
    start.w.set_user_data(start.box, 5);
    start.w.set_user_data(start.face, 6);
    CHECK(start.w.user_data(start.box) == 5);
    CHECK(start.w.user_data(start.face) == 6);
    CHECK(start.w.state_hash() == with_target);
}

CELL_CASE("world: a copy serves the same handles, goes the same way, and is separate") {
    crowd c;
    run(c.w, 10);
    world copy = c.w;
    CHECK(copy.contains(c.box));
    CHECK(copy.contains(c.face));
    for (int i = 0; i < 40; ++i) {
        run(c.w, 1);
        run(copy, 1);
        REQUIRE(copy.state_hash() == c.w.state_hash());
    }
    const std::uint64_t before = c.w.state_hash();
    copy.destroy_body(c.box);
    copy.apply_impulse(c.ball, along(0, 5));
    run(copy, 5);
    CHECK(c.w.state_hash() == before);
    CHECK(c.w.contains(c.box));
    copy = c.w;
    CHECK(copy.contains(c.box));
    CHECK(copy.state_hash() == before);
    run(copy, 5);
    run(c.w, 5);
    CHECK(copy.state_hash() == c.w.state_hash());
}

CELL_CASE("world: a moved world goes on, a moved-from world is empty and serves again") {
    crowd c;
    run(c.w, 10);
    world twin = c.w;
    world moved = std::move(c.w);
    CHECK(moved.contains(c.box));
    CHECK(moved.state_hash() == twin.state_hash());
    run(moved, 10);
    run(twin, 10);
    CHECK(moved.state_hash() == twin.state_hash());
    CHECK(c.w.body_count() + c.w.shape_count() + c.w.contacts().size() == 0);
    for (int i = 0; i < 3; ++i) add_box(c.w, at(0, i));
    run(c.w, 10);
    CHECK(c.w.body_count() == 3);
    CHECK(c.w.contacts().size() == 2);
    c.w = std::move(moved);
    CHECK(c.w.state_hash() == twin.state_hash());
    CHECK(moved.body_count() + moved.shape_count() == 0);
    add_box(moved, at(0, 0));
    run(moved, 1);
    run(c.w, 10);
    run(twin, 10);
    CHECK(c.w.state_hash() == twin.state_hash());
}

CELL_CASE("world: worlds that step in turns go the way that each goes alone") {
    world::settings_type moon;
    moon.gravity = along(1, -1.62);
    crowd alone, alone_on_moon(moon);
    run(alone.w, 50);
    run(alone_on_moon.w, 50);
    CHECK(alone.w.state_hash() != alone_on_moon.w.state_hash());
    crowd a, b(moon);
    for (int i = 0; i < 50; ++i) {
        run(a.w, 1);
        run(b.w, 1);
    }
    CHECK(a.w.state_hash() == alone.w.state_hash());
    CHECK(b.w.state_hash() == alone_on_moon.w.state_hash());
    CHECK(a.w.steps() == 50);
}

#if defined(__SSE__) || defined(__aarch64__)
CELL_CASE("world: the caller's rounding mode does not enter a step, and stays the caller's") {
    crowd plain, upward;
    run(plain.w, 50);
    for (int i = 0; i < 50; ++i) {
        std::fesetround(FE_UPWARD);
        run(upward.w, 1);
        const int mode = std::fegetround();
        std::fesetround(FE_TONEAREST);
        REQUIRE(mode == FE_UPWARD);
    }
    CHECK(upward.w.state_hash() == plain.w.state_hash());
}
#endif

CELL_CASE("world: settings hold from the next step on") {
    world w(weightless());
    const body_id ball = add_ball(w, {});
    run(w, 4);
    CHECK(w.linear_velocity(ball) == vec{});
    world::settings_type settings = w.settings();
    settings.gravity = along(0, 8);
    w.set_settings(settings);
    CHECK(w.settings().gravity == along(0, 8));
    run(w, 4);
    CHECK(w.linear_velocity(ball) == along(0, 0.5));

    // The margin decides what counts as a contact, at once and for shapes that do not move.
    const body_id wall = w.create_body({.type = body_type::static_body, .position = at(3, 0)});
    w.create_shape(wall, world::ball{S(0.5)});
    w.set_linear_velocity(ball, {});
    settings.gravity = {};
    w.set_settings(settings);
    w.set_pose(ball, at(1.5, 0), {});
    run(w, 1);
    CHECK(w.contacts().size() == 0);
    settings.contact_margin = S(0.75);
    settings.broadphase.margin = S(0);
    w.set_settings(settings);
    run(w, 1);
    CHECK(w.contacts().size() == 1);
    settings.contact_margin = S(0.25);
    w.set_settings(settings);
    run(w, 1);
    CHECK(w.contacts().size() == 0);
}

}  // namespace world_laws
}  // namespace
