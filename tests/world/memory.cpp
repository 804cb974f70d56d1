// Where memory runs out, a call is refused and the world is as it was: every request of every call is refused in turn,
// once, or it and all that follow.
#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "refused_memory.hpp"

namespace {

using namespace physics;

/// An executor whose workers take turns.
struct turns {
    static std::uint32_t workers() { return 3; }
    static void run(std::uint32_t parts, const task_set& what) {
        for (std::uint32_t k = 0; k < parts; ++k) what(k, k % 3);
    }
};

template <class Recipe>
struct scene {
    using world = physics::world<Recipe>;
    using S = typename world::scalar;
    static constexpr int D = world::dimension;
    using vec = typename world::vec;
    using plan = typename physics::detail::plan_of<Recipe>::type;
    static constexpr bool has_sensors = plan::events::sensors, has_joints = plan::has_joints;

    static vec at(double x, double y, double z = 0) {
        vec v;
        v[0] = S(x);
        v[1] = S(y);
        if constexpr (D == 3) v[2] = S(z);
        return v;
    }
    static void step(world& w) { w.step(S(1.0 / 64)); }
    static body_id last(const world& w) {
        body_id body;
        for (const body_id b : w.bodies()) body = b;
        return body;
    }
    static body_id first(const world& w) { return *w.bodies().begin(); }

    /// Rows of piles with joints between them, sensors in them, and a lift beside them.
    static world make(int count, int steps) {
        typename world::settings_type with;
        if constexpr (plan::sleeps) with.sleeping.time = S(0.25);
        world w(with);
        w.create_shape(w.create_body({.type = body_type::static_body}), typename world::box{at(40, 0.5, 40)},
                       {.position = at(0, -0.5)});
        const body_id lift = w.create_body({.type = body_type::kinematic_body, .position = at(12, 0.25)});
        w.create_shape(lift, typename world::box{at(1, 0.25, 1)});
        body_id before;
        for (int i = 0; i < count; ++i) {
            const body_id b = w.create_body({.position = at(1.125 * (i % 8), 0.5 + i / 8)});
            w.create_shape(b, typename world::box{vec::filled(S(0.5))});
            if constexpr (has_joints)
                if (i % 5 == 4) w.create_joint(before, b, typename world::ball_joint{.anchor_a = at(0.5, 0.5)});
            if constexpr (has_sensors)
                if (i % 7 == 0) w.create_shape(b, typename world::ball{S(1)}, {.sensor = true});
            before = b;
        }
        if constexpr (has_sensors)
            w.create_shape(first(w), typename world::box{at(2, 2, 2)}, {.position = at(4, 2), .sensor = true});
        for (int i = 0; i < steps; ++i) {
            w.set_linear_velocity(lift, at(i % 64 < 32 ? -0.25 : 0.25, 0));
            step(w);
        }
        // It runs into the piles, which are woken ahead of it.
        if (steps == 91) w.set_linear_velocity(lift, at(-100, 0));
        // It is about to fall onto sleepers, which the step wakes that meets them.
        if (steps == 92) {
            w.create_shape(w.create_body({.position = at(0, 2.39), .linear_velocity = at(0, -8)}),
                           typename world::ball{S(0.25)});
            step(w);
        }
        return w;
    }

    struct call {
        const char* name;
        void (*run)(world&);
    };
    static std::vector<call> all_calls() {
        std::vector<call> all = {
            {"create_body", [](world& w) { w.create_body({.position = at(20, 1)}); }},
            {"create_shape",
             [](world& w) {
                 w.create_shape(first(w), typename world::box{vec::filled(S(0.5))}, {.position = at(3, 2)});
             }},
            {"create_shape on what is dynamic",
             [](world& w) { w.create_shape(last(w), typename world::ball{S(0.75)}); }},
            {"destroy_body", [](world& w) { w.destroy_body(last(w)); }},
            {"destroy_body of the ground", [](world& w) { w.destroy_body(first(w)); }},
            {"destroy_bodies",
             [](world& w) {
                 const body_id bodies[] = {last(w), first(w)};
                 w.destroy_bodies(bodies, 2);
             }},
            {"destroy_shape", [](world& w) { w.destroy_shape(*w.shapes(last(w)).begin()); }},
            {"clear", [](world& w) { w.clear(); }},
            {"set_pose",
             [](world& w) {
                 w.set_pose(last(w), {at(3, 1), {}});
             }},
            {"set_pose of the ground",
             [](world& w) {
                 w.set_pose(first(w), {at(1, 0.25), {}});
             }},
            {"set_type", [](world& w) { w.set_type(last(w), body_type::static_body); }},
            {"set_type of the ground", [](world& w) { w.set_type(first(w), body_type::kinematic_body); }},
            {"set_enabled", [](world& w) { w.set_enabled(last(w), false); }},
            {"set_enabled of the ground",
             [](world& w) {
                 w.set_enabled(first(w), false);
                 w.set_enabled(first(w), true);
             }},
            {"set_filter", [](world& w) { w.set_filter(*w.shapes(first(w)).begin(), {.category = 4, .mask = 1}); }},
            {"set_material", [](world& w) { w.set_material(*w.shapes(last(w)).begin(), {.friction = S(0.25)}); }},
            {"set_linear_velocity", [](world& w) { w.set_linear_velocity(last(w), at(1, 2)); }},
            {"apply_impulse", [](world& w) { w.apply_impulse(last(w), at(1, 2)); }},
            {"apply_force", [](world& w) { w.apply_force(last(w), at(1, 200)); }},
            {"set_mass",
             [](world& w) {
                 w.set_mass(last(w), {S(2), {}, w.mass(last(w)).inertia});
             }},
            {"set_settings",
             [](world& w) {
                 auto with = w.settings();
                 with.gravity = at(0, -5);
                 w.set_settings(with);
             }},
            {"set_settings, of the margin too",
             [](world& w) {
                 auto with = w.settings();
                 with.contact_margin *= S(4);
                 w.set_settings(with);
             }},
            {"shift_origin", [](world& w) { w.shift_origin(at(7, 3)); }},
            {"step", [](world& w) { step(w); }},
            {"step by workers",
             [](world& w) {
                 turns by;
                 w.step(S(1.0 / 64), by);
             }},
        };
        if constexpr (plan::sleeps) all.push_back({"wake", [](world& w) { w.wake(last(w)); }});
        if constexpr (has_joints) {
            all.push_back({"create_joint", [](world& w) {
                               w.create_joint(first(w), last(w), typename world::ball_joint{.anchor_a = at(1, 1)});
                           }});
            all.push_back({"destroy_joint", [](world& w) {
                               if (w.joint_count() > 0) w.destroy_joint(*w.joints().begin());
                           }});
        }
        return all;
    }

    /// What can be asked of a world, as numbers.
    static std::vector<std::uint64_t> answers(const world& w) {
        std::vector<std::uint64_t> all = {w.state_hash(), w.body_count(), w.shape_count(), w.awake_count()};
        for (const auto& c : w.contacts())
            for (const shape_id s : {c.shape_a, c.shape_b}) all.push_back(s.index);
        if constexpr (has_joints) all.push_back(w.joint_count());
        return all;
    }
    static std::vector<std::uint64_t> found(const world& w) {
        std::vector<std::uint64_t> all;
        for (int x = -2; x < 14; x += 3) {
            std::uint64_t sum = 0;
            w.each_overlapping(typename world::ball{S(1.5)}, {at(x, 1), {}}, {},
                               [&](shape_id s) { sum += 1 + s.index; });
            all.push_back(sum);
            const auto hit = w.cast_ray(at(x, 30), at(0, -40));
            all.push_back(hit ? hit.shape.index : ~0u);
        }
        return all;
    }
    /// What it tells of the last step.
    static std::vector<std::uint64_t> told(const world& w) {
        std::vector<std::uint64_t> all;
        const auto add = [&](const auto& events) { all.push_back(events.size()); };
        if constexpr (plan::events::contacts) {
            add(w.contact_begin_events());
            add(w.contact_end_events());
        }
        if constexpr (plan::events::sleep) {
            add(w.sleep_events());
            add(w.wake_events());
        }
        if constexpr (plan::events::moves) add(w.move_events());
        if constexpr (plan::events::hits) add(w.hit_events());
        return all;
    }
    /// What came into sensors and left them in all: of a step without memory the next one tells.
    static void count_visits(const world& w, std::int64_t& balance) {
        if constexpr (has_sensors) {
            balance += w.sensor_begin_events().size();
            balance -= w.sensor_end_events().size();
        }
    }
};

struct full : recipe<float, 3, joints<ball_joint>,
                     events<event::contact, event::hit, event::sensor, event::sleep, event::move, event::joint_limit>,
                     user_types<int, int, int>> {};
struct impulses : recipe<fixed32, 2, joints<ball_joint>, sequential_impulse, events<event::contact, event::sensor>> {};
struct bare : recipe<double, 2, without<feature::sleeping>> {};
struct hashed : recipe<float, 2, hash_grid, events<event::contact, event::sleep>> {};
struct swept_boxes : recipe<double, 3, sweep_and_prune, events<event::sensor>> {};

/// Refuses each request of a call in turn; returns how many calls were refused for it.
template <class Recipe>
int refuse_each(const typename scene<Recipe>::call& call, int count, int steps, bool all) {
    int refusals = 0;
    using of = scene<Recipe>;
    using world = typename of::world;
    const world from = of::make(count, steps);
    // Copies have no room to spare.
    const world plain = from;
    const auto answers = of::answers(plain), found = of::found(plain);
    for (long k = 0;; ++k) {
        world w = plain;
        bool refused = false;
        all_are_refused_then = all;
        calls_until_refused = k;
        try {
            call.run(w);
        } catch (const out_of_memory&) {
            refused = true;
        }
        const bool is_done = calls_until_refused > 0 || (calls_until_refused == 0 && !refused);
        calls_until_refused = -1;
        if (is_done) return refusals;
        // Else it was not needed, or the next step makes up for it.
        if (refused) {
            ++refusals;
            REQUIRE(of::answers(w) == answers);
            REQUIRE(of::found(w) == found);
            call.run(w);
        }
        world expected = plain;
        call.run(expected);
        REQUIRE(of::answers(w) == of::answers(expected));
        std::int64_t visits = 0, expected_visits = 0;
        of::count_visits(w, visits);
        of::count_visits(expected, expected_visits);
        for (int i = 0; i < 3; ++i) {
            of::step(w);
            of::step(expected);
            of::count_visits(w, visits);
            of::count_visits(expected, expected_visits);
            REQUIRE(of::told(w) == of::told(expected));
        }
        REQUIRE(visits == expected_visits);
        REQUIRE(of::answers(w) == of::answers(expected));
        REQUIRE(of::found(w) == of::found(expected));
    }
}

TEST_CASE_TEMPLATE_DEFINE("memory: what finds none is refused, and the world as it was", Recipe, recipes) {
    int refusals = 0;
    for (const std::pair<int, int>& size : {std::pair(10, 0), {10, 90}, {10, 91}, {62, 6}})
        for (const auto& call : scene<Recipe>::all_calls())
            for (const bool all : {false, true}) {
                INFO(std::string(call.name));
                CAPTURE(size.first);
                CAPTURE(size.second);
                CAPTURE(all);
                refusals += refuse_each<Recipe>(call, size.first, size.second, all);
            }
    CHECK(refusals > 500);
}
TEST_CASE_TEMPLATE_INVOKE(recipes, full, impulses, bare, hashed, swept_boxes);
TEST_CASE_TEMPLATE("memory: a step that was refused wakes what it meets as it is taken again", Recipe, full, hashed) {
    int refusals = 0;
    for (const auto& call : scene<Recipe>::all_calls())
        if (std::string(call.name).rfind("step", 0) == 0)
            for (const bool all : {false, true}) refusals += refuse_each<Recipe>(call, 10, 92, all);
    CHECK(refusals > 10);
}

}  // namespace
