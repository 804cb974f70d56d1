// Removing several bodies at once: as one by one, but in one pass.
#pragma once

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "refusal.hpp"
#include "world_cell.hpp"

namespace {
namespace removal_laws {

using access = physics::detail::world_access;

struct linked : physics::recipe<cell::scalar, cell::dimension, physics::joints<physics::distance_joint>> {};

/// Columns of crates on the ground and on shelves, some of them asleep by then; joints where the recipe has them.
template <class World>
struct warehouse {
    World w;
    std::vector<body_id> bodies;

    explicit warehouse(int steps, typename World::settings_type settings = {}) : w(pulled(settings)) {
        bodies.push_back(w.create_body({.type = body_type::static_body}));
        w.create_shape(bodies.back(), typename World::halfspace{});
        for (int i = 0; i < 8; ++i) {
            bodies.push_back(w.create_body(
                {.type = i % 2 ? body_type::static_body : body_type::kinematic_body, .position = at(3 * i, 1)}));
            w.create_shape(bodies.back(), typename World::box{vec::filled(S(1))});
            for (int k = 0; k < 3; ++k) {
                bodies.push_back(w.create_body({.position = at(3 * i, 2.5 + k)}));
                w.create_shape(bodies.back(), typename World::box{vec::filled(S(0.5))});
            }
            const body_id roller = w.create_body({.position = at(3 * i + 1.5, 4), .can_sleep = i % 4 != 0});
            w.create_shape(roller, typename World::ball{S(0.25)});
            bodies.push_back(roller);
            if constexpr (requires(World & world) { world.joints(); })
                w.create_joint(roller, bodies[bodies.size() - 2], physics::distance_joint<S, cell::dimension>{});
        }
        for (int i = 0; i < steps; ++i) w.step(S(1.0 / 64));
    }
    static typename World::settings_type pulled(typename World::settings_type settings) {
        settings.gravity = along(1, -10);
        return settings;
    }
};

template <class World>
void as_one_by_one() {
    cell::dice dice(4100);
    for (const int steps : {0, 1, 40, 300})
        for (int i = 0; i < 12; ++i) {
            const warehouse<World> from(steps);
            std::vector<body_id> left = from.bodies, gone;
            while (!left.empty() && static_cast<int>(gone.size()) <= 4 * i) {
                const auto k = left.begin() + dice.below(static_cast<int>(left.size()));
                gone.push_back(*k);
                left.erase(k);
            }
            World one_by_one = from.w, at_once = from.w;
            for (const body_id id : gone) one_by_one.destroy_body(id);
            at_once.destroy_bodies(gone);
            CAPTURE(steps);
            CAPTURE(gone.size());
            REQUIRE(at_once.state_hash() == one_by_one.state_hash());
            REQUIRE(at_once.awake_count() == one_by_one.awake_count());
            for (int n = 0; n < 20; ++n) {
                one_by_one.step(S(1.0 / 64));
                at_once.step(S(1.0 / 64));
            }
            REQUIRE(at_once.state_hash() == one_by_one.state_hash());
            for (const body_id id : gone) CHECK(!at_once.contains(id));
            for (const body_id id : left) CHECK(at_once.contains(id));
        }
}
CELL_CASE("removal: several at once leave what they leave one by one, to the bit") { as_one_by_one<world>(); }
CELL_CASE("removal: so they do with joints") { as_one_by_one<physics::world<linked>>(); }

CELL_CASE("removal: what is null, foreign, gone or listed twice is refused before anything goes") {
    warehouse<world> of(10);
    world& w = of.w;
    const body_id gone = of.bodies[5];
    w.destroy_body(gone);
    world other;
    const auto refuses_list = [&](std::vector<body_id> list, const char* value) {
        refuses(w, "destroy_bodies", "body", value, [&] { w.destroy_bodies(list); });
    };
    refuses_list({of.bodies[1], body_id{}}, "null");
    refuses_list({of.bodies[1], gone}, "#5");
    refuses_list({of.bodies[1], other.create_body()}, "#0");
    refuses_list({of.bodies[3], of.bodies[1], of.bodies[3]}, "3");
    refuses(w, "destroy_bodies", "ids", "null", [&] { w.destroy_bodies(nullptr, 3); });
    const facts before = facts_of(w);
    w.destroy_bodies(nullptr, 0);
    w.destroy_bodies(std::vector<body_id>{});
    CHECK((facts_of(w) == before));
}
/// The pairs of shapes that a world has contacts of, by handle: of all, or of one body.
template <class Range>
std::vector<std::pair<physics::shape_id, physics::shape_id>> pairs_in(const Range& contacts) {
    std::vector<std::pair<physics::shape_id, physics::shape_id>> pairs;
    for (const auto& c : contacts) pairs.push_back({c.shape_a, c.shape_b});
    CHECK(pairs.size() == contacts.size());
    return pairs;
}
/// Where the first points of contacts are.
std::map<std::pair<physics::shape_id, physics::shape_id>, vec> points_in(const world& w) {
    std::map<std::pair<physics::shape_id, physics::shape_id>, vec> found;
    for (const auto& c : w.contacts()) found[{c.shape_a, c.shape_b}] = c.points[0].position;
    return found;
}

CELL_CASE("removal: contacts that are left are those of what is left, also where numbers come again before a step") {
    cell::dice dice(4200);
    for (const int steps : {1, 40, 300})
        for (int i = 0; i < 12; ++i) {
            warehouse<world> of(steps);
            world& w = of.w;
            auto expected = pairs_in(w.contacts());
            std::vector<body_id> left = of.bodies, disabled;
            for (int n = 0; n < 21; ++n) {
                const auto k = left.begin() + dice.below(static_cast<int>(left.size()));
                const body_id id = *k;
                const auto places = points_in(w);
                const auto forget = [&](auto&& gone) {
                    std::erase_if(expected, [&](const auto& p) {
                        const body_id a = w.body(p.first), b = w.body(p.second);
                        return (a == id || b == id) && gone(a, b);
                    });
                };
                const auto all = [](body_id, body_id) { return true; };
                switch (n % 7) {
                    case 0:
                        left.erase(k);
                        forget(all);
                        w.destroy_body(id);
                        // In its place, under its number.
                        left.push_back(add_box(w, at(3 * dice.below(8), 9 + n)));
                        break;
                    case 1:
                        left.erase(k);
                        forget(all);
                        w.set_enabled(id, false);
                        disabled.push_back(id);
                        break;
                    case 2:
                        left.erase(k);
                        forget(all);
                        w.destroy_shape(*w.shapes(id).begin());
                        break;
                    case 3:
                        if (w.shapes(id).begin() == w.shapes(id).end()) break;
                        forget(all);
                        w.set_filter(*w.shapes(id).begin(), {.mask = 0});
                        break;
                    case 4: {
                        const auto type = dice.below(2) == 0 ? body_type::static_body : body_type::kinematic_body;
                        w.set_type(id, type);
                        const auto stands = [&](body_id b) { return w.type(b) != body_type::dynamic_body; };
                        forget([&](body_id a, body_id b) { return stands(a) && stands(b); });
                        break;
                    }
                    case 5:
                        if (w.type(id) == body_type::dynamic_body) {
                            auto mass = w.mass(id);
                            mass.center += along(0, 0.25);
                            w.set_mass(id, mass);
                        }
                        break;
                    default: w.wake(id); break;
                }
                REQUIRE(pairs_in(w.contacts()) == expected);
                CHECK(w.contacts().size() == expected.size());
                for (const auto& [pair, point] : points_in(w))
                    CHECK(cell::near(length(point - places.at(pair)), S(0), 64));
                for (const body_id b : w.bodies()) {
                    auto own = expected;
                    std::erase_if(own, [&](const auto& p) { return w.body(p.first) != b && w.body(p.second) != b; });
                    REQUIRE(pairs_in(w.contacts(b)) == own);
                }
                world copy = w;
                world refused = w;
                const S fast = cell::largest() * S(0.375);
                refused.create_body({.linear_velocity = vec::filled(fast)});
                const std::uint64_t hash = refused.state_hash();
                // What a refused step has found out of its contacts is no change.
                CHECK(refusal([&] { refused.step(S(16)); }) != "");
                CHECK(refused.state_hash() == hash);
                CHECK(pairs_in(refused.contacts()) == expected);
                physics::detail::raw_snapshot<physics::detail::plan_of<scene>::type> image;
                image.save(access::state_of(w));
                world other = of.w;
                for (int m = 0; m < 3; ++m) copy.step(S(1.0 / 64));
                REQUIRE(image.restore(access::data_of(other)));
                CHECK(other.state_hash() == w.state_hash());
                CHECK(pairs_in(other.contacts()) == expected);
                for (int m = 0; m < 3; ++m) other.step(S(1.0 / 64));
                CHECK(other.state_hash() == copy.state_hash());
            }
            for (const body_id id : disabled)
                if (!w.enabled(id)) w.set_enabled(id, true);
            w.step(S(1.0 / 64));
            for (const auto& c : w.contacts()) CHECK((w.contains(c.shape_a) && w.contains(c.shape_b)));
        }
}
struct told : physics::recipe<S, cell::dimension, physics::events<physics::event::contact>> {};
CELL_CASE("removal: contacts of what is destroyed end once, whatever is done to what comes under its number") {
    for (const bool by_type : {false, true}) {
        physics::world<told> w{{.gravity = along(1, -10)}};
        w.create_shape(w.create_body({.type = body_type::static_body}), world::halfspace{});
        const body_id first = w.create_body({.position = at(0, 0.5), .can_sleep = false});
        const shape_id ball = w.create_shape(first, world::ball{S(0.5)});
        w.step(S(1.0 / 64));
        REQUIRE(w.contact_begin_events().size() == 1);
        w.destroy_body(first);
        const body_id next = w.create_body({.position = at(0, 0.5)});
        const shape_id other = w.create_shape(next, world::ball{S(0.5)});
        REQUIRE(other.index == ball.index);
        CHECK(w.contacts().size() + w.contacts(next).size() == 0);
        // There and back, so that the step finds it touching.
        if (by_type) {
            w.set_type(next, body_type::static_body);
            w.set_type(next, body_type::dynamic_body);
        } else {
            w.set_filter(other, {.mask = 0});
            w.set_filter(other, {});
        }
        w.step(S(1.0 / 64));
        REQUIRE(w.contact_end_events().size() == 1);
        CHECK((w.contact_end_events()[0].shape_b == ball && w.contact_end_events()[0].gone));
        REQUIRE(w.contact_begin_events().size() == 1);
        CHECK(w.contact_begin_events()[0].shape_b == other);
        w.step(S(1.0 / 64));
        CHECK(w.contact_end_events().size() + w.contact_begin_events().size() == 0);
    }
}
CELL_CASE("removal: a world that has been cleared is empty and serves again") {
    for (const int steps : {0, 300}) {
        warehouse<world> of(steps);
        world& w = of.w;
        w.clear();
        CHECK(w.body_count() + w.shape_count() + w.awake_count() + w.contacts().size() == 0);
        for (const body_id id : of.bodies) CHECK(!w.contains(id));
        CHECK(w.steps() == static_cast<std::uint64_t>(steps));
        run(w, 2);
        w.clear();
        add_ground(w);
        const body_id box = add_box(w, at(0, 1));
        run(w, 128);
        CHECK(std::abs(number(w.position(box).y) - 0.5) <= 0.01);
        CHECK(w.body_count() == 2);
    }
}

}  // namespace removal_laws
}  // namespace
