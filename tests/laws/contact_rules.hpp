// Contact rules: platforms that hold from above only, and rules of users against filters.
#pragma once

#include <algorithm>
#include <vector>

#include "refusal.hpp"
#include "world_cell.hpp"

namespace {
namespace contact_rules_laws {

/// What users say of a shape in its data.
constexpr std::uint64_t slippery = 8, bad = 16;
/// Shapes of teams that are not 0 and equal let each other pass; what is slippery has no friction.
struct game_rules {
    using stage = physics::stage::contact_rule;
    template <class Candidate>
    static bool accept(Candidate& c) {
        const auto a = c.a(), b = c.b();
        if ((a.shape_data & 7) != 0 && (a.shape_data & 7) == (b.shape_data & 7)) return false;
        if (((a.shape_data | b.shape_data) & slippery) != 0) c.set_friction({});
        if (((a.shape_data | b.shape_data) & bad) != 0) c.set_restitution(typename Candidate::scalar(-1));
        return physics::one_way_platforms::accept(c);
    }
};
struct game : physics::recipe<S, cell::dimension, game_rules, physics::events<physics::event::contact>> {};
struct discrete
    : physics::recipe<S, cell::dimension, physics::one_way_platforms, physics::without<physics::feature::continuous>> {
};
using world = physics::world<game>;

vec half(double x, double y) {
    vec v = vec::filled(S(3));
    v.x = S(x);
    v.y = S(y);
    return v;
}
/// The ground, and a plank whose upper side is 2.1 m high.
template <class World>
struct level {
    World w{typename World::settings_type{.gravity = along(1, -10)}};
    body_id ground = w.create_body({.type = body_type::static_body}), plank;

    explicit level(body_type type = body_type::static_body, bool has_plank = true) {
        w.create_shape(ground, typename World::halfspace{});
        if (!has_plank) return;
        plank = w.create_body({.type = type, .position = at(0, 2), .gravity_scale = S(0)});
        w.create_shape(plank, typename World::box{half(3, 0.1)}, {.one_way = true});
    }
    body_id add_box(double x, double y, double speed) {
        const body_id b = w.create_body({.position = at(x, y), .linear_velocity = at(0, speed)});
        w.create_shape(b, typename World::box{vec::filled(S(0.5))});
        return b;
    }
    double height(body_id b) const { return number(w.position(b).y); }
    void run(double seconds, int rate) {
        for (int i = 0; i < seconds * rate; ++i) w.step(S(1.0 / rate));
    }
};

/// Thrown up from the ground it falls back through the plank, unless its feet came out of it.
template <class World>
void check_throws(int rate, double maximum) {
    for (double speed = 2; speed < maximum; speed *= 1.07) {
        CAPTURE(rate);
        CAPTURE(speed);
        level<World> l, empty(body_type::static_body, false);
        const body_id b = l.add_box(0, 0.5, speed), free = empty.add_box(0, 0.5, speed);
        double top = 0, top_of_free = 0;
        for (int i = 0; i < 6 * rate; ++i) {
            l.w.step(S(1.0 / rate));
            top = std::max(top, l.height(b));
            if (i > rate * speed / 10 + 2) continue;
            empty.w.step(S(1.0 / rate));
            top_of_free = std::max(top_of_free, empty.height(free));
        }
        CHECK(top == top_of_free);
        if (top < 2.6 - 0.02) CHECK(std::abs(l.height(b) - 0.5) < 0.01);
        else if (top > 2.6 + 0.01) CHECK(std::abs(l.height(b) - 2.6) < 0.01);
    }
}
CELL_CASE("contact rules: a platform lets pass from below and holds from above, at any rate") {
    for (const int rate : {30, 60, 240}) check_throws<world>(rate, 25);
    check_throws<physics::world<discrete>>(60, 20);
    check_throws<physics::world<discrete>>(240, 20);
}

CELL_CASE("contact rules: a platform stops what falls at any speed, and what flies up at any speed passes it") {
    for (const double speed : {20.0, 100.0, 400.0})
        for (const int rate : {30, 60, 240}) {
            CAPTURE(speed);
            CAPTURE(rate);
            level<world> l;
            const body_id falls = l.add_box(-1.5, 6, -speed), flies = l.add_box(1.5, 0.5, speed);
            // As a plank that lets nothing pass.
            level<world> solid;
            solid.w.destroy_shape(*solid.w.shapes(solid.plank).begin());
            solid.w.create_shape(solid.plank, world::box{half(3, 0.1)});
            const body_id stopped = solid.add_box(-1.5, 6, -speed);
            l.w.step(S(1.0 / rate));
            CHECK(l.height(flies) > 0.49 + (speed - 1) / rate);
            l.run(1, rate);
            solid.w.step(S(1.0 / rate));
            solid.run(1, rate);
            CHECK(l.height(falls) == solid.height(stopped));
            CHECK(l.height(falls) > 2.59);
            CHECK(l.height(flies) > 0.9 * (speed - 10));
        }
}

CELL_CASE("contact rules: what crosses a platform from the side or from below keeps its velocity to the bit") {
    for (const auto type : {body_type::static_body, body_type::kinematic_body, body_type::dynamic_body})
        for (const int way : {0, 1, 2}) {
            CAPTURE(way);
            level<world> l(type);
            l.w.set_settings({.gravity = {}});
            const vec v = way == 0 ? at(3, 0) : way == 1 ? at(0, 3) : at(2, 1);
            const body_id b = l.w.create_body({.position = at(0, 2) - v, .linear_velocity = v});
            l.w.create_shape(b, world::ball{S(0.25)});
            for (int i = 0; i < 160; ++i) l.w.step(S(1.0 / 64));
            CHECK(l.w.linear_velocity(b) == v);
            CHECK(l.w.linear_velocity(l.plank) == vec{});
        }
}

CELL_CASE("contact rules: platforms hold by their own upper side, however they are turned and moved") {
    for (const double angle : {0.0, 0.3, -0.3, 3.1}) {
        CAPTURE(angle);
        level<world> l(body_type::kinematic_body);
        l.w.set_pose(l.plank, at(0, 4), turned_about_z(angle));
        const body_id b = l.w.create_body({.position = at(0, 6)});
        l.w.create_shape(b, world::ball{S(0.25)}, {.material = {.friction = S(2), .rolling_resistance = S(0.25)}});
        l.run(4, 60);
        // Turned over, it holds nothing that falls.
        CHECK((l.height(b) > 3) == (angle < 3));
    }
    // A lift carries what stands on it, and passes through what hangs in its way.
    level<world> l(body_type::kinematic_body);
    const body_id rider = l.add_box(-1, 2.6, 0), obstacle = l.add_box(1, 4, 0);
    l.w.set_type(obstacle, body_type::kinematic_body);
    for (int i = 0; i < 240; ++i) {
        l.w.move_to(l.plank, at(0, 2 + (i + 1) / 60.0), {});
        l.w.step(S(1.0 / 60));
    }
    CHECK(std::abs(l.height(rider) - 6.6) < 0.02);
    CHECK(l.height(obstacle) == 4);
}

CELL_CASE("contact rules: what a platform holds it holds under any load, asleep and awake, until it is left") {
    level<world> l;
    std::vector<body_id> tower;
    for (int i = 0; i < 8; ++i) tower.push_back(l.add_box(0, 2.6 + i, 0));
    l.w.set_mass(tower.back(), {S(4), {}, l.w.mass(tower.back()).inertia});
    l.run(5, 60);
    for (int i = 0; i < 8; ++i) {
        CHECK(std::abs(l.height(tower[static_cast<std::size_t>(i)]) - 2.6 - i) < 0.05);
        CHECK(l.w.is_asleep(tower[static_cast<std::size_t>(i)]));
    }
    l.w.wake(tower[0]);
    l.w.apply_impulse(tower[0], at(0, -20));
    l.run(2, 60);
    CHECK(std::abs(l.height(tower[0]) - 2.6) < 0.02);
    // It falls as soon as its filter lets it, and is not caught again.
    const shape_id foot = *l.w.shapes(tower[0]).begin();
    for (std::size_t i = 1; i < tower.size(); ++i) l.w.destroy_body(tower[i]);
    l.w.set_filter(foot, {.mask = 0});
    l.run(0.25, 60);
    l.w.set_filter(foot, {});
    l.run(2, 60);
    CHECK(std::abs(l.height(tower[0]) - 0.5) < 0.02);
}

/// Balls and boxes of teams in a bowl, let apart by a rule or by filters.
template <class Let>
world crowd(std::uint64_t seed, Let&& let) {
    cell::dice dice(seed);
    world w;
    const body_id ground = w.create_body({.type = body_type::static_body});
    w.create_shape(ground, world::halfspace{});
    for (int i = 0; i < 30; ++i) {
        const body_id b = w.create_body({.position = at(0, 2) + dice.vec<vec>(-1.5, 1.5),
                                         .linear_velocity = dice.vec<vec>(-20, 20),
                                         .continuous = dice.below(3) == 0});
        physics::shape_def<S, cell::dimension> def;
        let(def, dice.below(4));
        if (dice.below(2)) w.create_shape(b, world::ball{S(0.25)}, def);
        else w.create_shape(b, world::box{vec::filled(S(0.25))}, def);
    }
    return w;
}
CELL_CASE("contact rules: a rule that parts teams moves bodies as filters that do, to the bit") {
    for (std::uint64_t seed = 1; seed < 6; ++seed) {
        world by_rule = crowd(seed, [](auto& def, int team) { def.user_data = static_cast<std::uint64_t>(team); });
        world by_filter = crowd(seed, [](auto& def, int team) { def.filter.group = -team; });
        physics::thread_pool pool(2);
        for (int i = 0; i < 120; ++i) {
            by_filter.step(S(1.0 / 60));
            if (i % 2) by_rule.step(S(1.0 / 60), pool);
            else by_rule.step(S(1.0 / 60));
            CHECK(by_rule.contacts().size() == by_filter.contacts().size());
        }
        for (const body_id b : by_rule.bodies()) {
            const body_id other = [&] {
                for (const body_id o : by_filter.bodies())
                    if (o.index == b.index) return o;
                return body_id();
            }();
            CHECK(by_rule.position(b) == by_filter.position(other));
            CHECK(by_rule.linear_velocity(b) == by_filter.linear_velocity(other));
        }
    }
}

CELL_CASE("contact rules: coefficients that a rule sets act, and bad ones refuse the step") {
    world w{world::settings_type{.gravity = along(1, -10)}};
    w.create_shape(w.create_body({.type = body_type::static_body}), world::halfspace{});
    const auto slide = [&](double x, std::uint64_t data) {
        const body_id b = w.create_body({.position = at(x, 0.5), .linear_velocity = at(2, 0)});
        w.create_shape(b, world::box{vec::filled(S(0.5))}, {.user_data = data});
        return b;
    };
    const body_id rough = slide(-9, 0), smooth = slide(9, slippery);
    for (int i = 0; i < 60; ++i) w.step(S(1.0 / 60));
    CHECK(std::abs(number(w.linear_velocity(rough).x)) < 0.01);
    CHECK(std::abs(number(w.linear_velocity(smooth).x) - 2) < 0.01);
    const body_id wrong = slide(0, bad);
    const std::uint64_t before = w.state_hash();
    CHECK_THROWS_AS(w.step(S(1.0 / 60)), physics::error);
    CHECK(w.state_hash() == before);
    w.destroy_body(wrong);
    w.step(S(1.0 / 60));
}

CELL_CASE("contact rules: begins and ends of contacts with platforms are paired, and what passes has none") {
    level<world> l;
    const body_id passes = l.add_box(-1.5, 0.5, 6), lands = l.add_box(1.5, 0.5, 9);
    int begins = 0, ends = 0;
    for (int i = 0; i < 240; ++i) {
        l.w.step(S(1.0 / 60));
        for (const auto& e : l.w.contact_begin_events()) {
            if (e.body_a != l.plank && e.body_b != l.plank) continue;
            CHECK((e.body_a == lands || e.body_b == lands));
            ++begins;
        }
        for (const auto& e : l.w.contact_end_events()) ends += e.body_a == l.plank || e.body_b == l.plank;
        CHECK(!l.w.touching(passes, l.plank));
    }
    CHECK(begins == 1);
    CHECK(ends == 0);
}

CELL_CASE("contact rules: queries meet platforms from above only where they are told to") {
    level<world> l;
    const world::ball ball{S(0.25)};
    const physics::query_filter as_body{.kinds = physics::static_bodies, .one_way = true};
    const auto cast = [&](double from, double to, const physics::query_filter& filter) {
        const auto hit = l.w.cast_shape(ball, {at(0, from), {}}, at(0, to - from), filter);
        return hit && hit.body == l.plank;
    };
    CHECK(cast(1, 4, {}));
    CHECK(!cast(1, 4, as_body));
    CHECK(cast(4, 1, as_body));
    // From within, and from the surface.
    CHECK(!cast(2.2, 1, as_body));
    CHECK(cast(2.35, 1, as_body));
    const auto collides = [&](double y, const physics::query_filter& filter) {
        bool found = false;
        l.w.collide_shape(ball, {at(0, y), {}}, S(0.125), filter,
                          [&](const auto& c) { found = found || c.body == l.plank; });
        return found;
    };
    CHECK(collides(2, {}));
    CHECK(!collides(2, as_body));
    CHECK(!collides(1.7, as_body));
    CHECK(collides(2.35, as_body));
}

CELL_CASE("contact rules: a character jumps up through planks and lands on them") {
    for (const int rate : {60, 240}) {
        CAPTURE(rate);
        level<world> l;
        physics::character<world> hero(world::capsule::upright(S(1.8), S(0.3)), {}, along(1, 1));
        double top = 0;
        const auto run = [&](double seconds) {
            for (int i = 0; i < seconds * rate; ++i) {
                l.w.step(S(1.0 / rate));
                hero.move(l.w, {}, S(1.0 / rate));
                top = std::max(top, number(hero.feet().y));
            }
        };
        run(0.5);
        // Not high enough: its feet stay below the upper side.
        hero.jump(S(6));
        run(2);
        CHECK(std::abs(top - 1.8) < 0.1);
        CHECK(std::abs(number(hero.feet().y)) < 0.001);
        hero.jump(S(7));
        run(2);
        CHECK(std::abs(number(hero.feet().y) - 2.1) < 0.001);
        CHECK(hero.ground().body == l.plank);
        CHECK(!hero.is_stuck());
    }
}

CELL_CASE("contact rules: a shape is one-way only where a rule asks for it") {
    ::world plain;
    const body_id b = plain.create_body({.type = body_type::static_body});
    refuses(plain, "create_shape", "one_way", "true",
            [&] { plain.create_shape(b, ::world::box{vec::filled(S(1))}, {.one_way = true}); });
    level<world> l;
    CHECK(l.w.is_one_way(*l.w.shapes(l.plank).begin()));
    CHECK(!l.w.is_one_way(*l.w.shapes(l.ground).begin()));
}

}  // namespace contact_rules_laws
}  // namespace
