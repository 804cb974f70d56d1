// A step that needs no more memory than an earlier one allocates nothing: every call for memory is counted.
//
// Arrays of a world grow by doubling and never shrink, so what a step may need is what any step before it needed. Where
// the same motion runs again, the promise is exact: no call at all, in any step.
#include <doctest/doctest.h>

#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "counted_memory.hpp"

namespace {

using physics::body_id;
using physics::body_type;
using physics::fixed32;

/// An executor whose workers take turns: as with threads, each has memory of its own, but always for the same parts.
struct turns {
    std::uint32_t workers() const { return 3; }
    void run(std::uint32_t parts, const physics::task_set& what) const {
        for (std::uint32_t k = 0; k < parts; ++k) what(k, k % 3);
    }
};

template <class Recipe>
struct playground {
    using world = physics::world<Recipe>;
    using S = typename world::scalar;
    static constexpr int D = world::dimension;
    using vec = typename world::vec;
    using angular = typename world::angular;
    using box = typename world::box;
    using ball = typename world::ball;
    using capsule = typename world::capsule;

    static vec at(double x, double y, double z = 0) {
        vec v;
        v[0] = S(x);
        v[1] = S(y);
        if constexpr (D == 3) v[2] = S(z);
        return v;
    }
    static angular about_z(double size) {
        if constexpr (D == 2) return S(size);
        else return {S(0), S(0), S(size)};
    }
    static vec cube(double half) { return vec::filled(S(half)); }

    world arena;
    std::vector<body_id> piles;
    body_id drum, lift, hammer, dart;

    static typename world::settings_type settings(bool sleep) {
        typename world::settings_type with;
        with.sleeping.enabled = sleep;
        with.sleeping.time = S(0.25);
        return with;
    }
    body_id add(body_type type, vec position) { return arena.create_body({.type = type, .position = position}); }

    explicit playground(bool sleep) : arena(settings(sleep)) {
        static_cast<void>(arena.create_shape(add(body_type::static_body, at(0, -1)), box{at(60, 1, 60)}));
        add_drum();
        add_piles();
        // A ball so fast that it is swept, against everything.
        dart = arena.create_body({.position = at(-30, 3), .linear_velocity = at(50, 0), .continuous = true});
        static_cast<void>(arena.create_shape(dart, ball{S(0.1)}, {.material = {.restitution = S(0.9)}}));
        for (const double x : {-35.0, -25.0})
            static_cast<void>(arena.create_shape(add(body_type::static_body, at(x, 3)), box{at(0.1, 3, 3)}));
    }
    /// Boxes, balls and capsules that never come to rest.
    void add_drum() {
        drum = arena.create_body(
            {.type = body_type::kinematic_body, .position = at(0, 8), .angular_velocity = about_z(1.5)});
        for (int axis = 0; axis < D; ++axis)
            for (const double side : {-3.25, 3.25}) {
                vec half = cube(3.5), place;
                half[axis] = S(0.25);
                place[axis] = S(side);
                static_cast<void>(arena.create_shape(drum, box{half}, {.position = place}));
            }
        for (int i = 0; i < 24; ++i) {
            const body_id it = add(body_type::dynamic_body, at(i % 5 - 2.0, 6 + i / 5 + 0.125 * (i % 3), i % 4 - 1.5));
            if (i % 3 == 0) static_cast<void>(arena.create_shape(it, ball{S(0.4)}));
            else if (i % 3 == 1) static_cast<void>(arena.create_shape(it, box{cube(0.4)}));
            else static_cast<void>(arena.create_shape(it, capsule{S(0.3), S(0.2)}));
        }
    }
    /// Piles that fall asleep, on the ground, on a lift, and in a hammer's way.
    void add_piles() {
        lift = add(body_type::kinematic_body, at(12, 0.25));
        static_cast<void>(arena.create_shape(lift, box{at(2, 0.25, 2)}));
        hammer = add(body_type::kinematic_body, at(24, 0.5));
        static_cast<void>(arena.create_shape(hammer, box{at(0.5, 0.4, 2)}));
        for (const auto& [x, y] : {std::pair(-12.0, 0.0), {-16.0, 0.0}, {12.0, 0.5}, {20.0, 0.0}})
            for (int i = 0; i < 4; ++i) {
                piles.push_back(add(body_type::dynamic_body, at(x, y + 0.5 + i)));
                static_cast<void>(arena.create_shape(piles.back(), box{cube(0.5)}));
            }
    }

    /// What the user does before step i; sleepers are woken by each of these ways.
    void act(int i) {
        if (i % 80 == 40) arena.apply_impulse(piles[3], at(0, 4));
        if (i % 80 == 50) arena.set_pose(piles[7], at(-16, 4.5), {});
        arena.set_linear_velocity(lift, at(0, i % 80 < 40 ? 0 : i % 80 < 60 ? 0.5 : -0.5));
        arena.move_to(hammer, at(24 - 0.05 * (i % 80 < 40 ? i % 80 : 80 - i % 80), 0.5), {});
        arena.apply_force(piles[0], at(0, 0));
    }
    int ask(int i) {
        int hits = static_cast<bool>(arena.cast_ray(at(-40, 0.5), at(80, 0)));
        hits += static_cast<bool>(arena.cast_shape(ball{S(0.25)}, {at(0.1 * i, 30), {}}, at(0, -40)));
        arena.each_overlapping(box{cube(2)}, {at(0, 6), {}}, {}, [&](auto) { ++hits; });
        hits += static_cast<bool>(arena.closest_shape(at(0, 8), S(8)));
        for (const auto& c : arena.contacts()) hits += c.count > 0;
        return hits;
    }

    /// What steps did, and what they called for.
    struct record {
        unsigned long calls = 0;
        int steps_with_calls = 0, falls_asleep = 0, wakes = 0, begun = 0, hits = 0;
        std::uint32_t swept = 0, most_contacts = 0;
        std::uint64_t hash = 0;
    };
    /// Kinematic ones never sleep.
    std::uint32_t awake_bodies() const {
        std::uint32_t count = 0;
        for (const physics::body_id b : arena.bodies()) count += !arena.is_asleep(b);
        return count;
    }
    record play(int steps, bool shared = false) {
        turns tasks;
        record r;
        std::uint32_t awake = awake_bodies(), touching = 0;
        for (int i = 0; i < steps; ++i) {
            const unsigned long made = calls_of([&] {
                act(i);
                if (shared) arena.step(S(1.0 / 64), tasks);
                else arena.step(S(1.0 / 64));
                r.hits += ask(i);
            });
            r.calls += made;
            r.steps_with_calls += made > 0;
            r.swept += arena.continuous_report().swept;
            const std::uint32_t now = awake_bodies();
            r.falls_asleep += now < awake;
            r.wakes += now > awake;
            awake = now;
            std::uint32_t count = 0;
            for (const auto& c : arena.contacts()) count += c.count > 0;
            r.begun += count > touching;
            touching = count;
            if (count > r.most_contacts) r.most_contacts = count;
        }
        r.hash = arena.state_hash();
        return r;
    }
};

template <class S, int D>
struct cell : physics::recipe<S, D> {};
/// What is not the default.
struct others : physics::recipe<float, 3, physics::sequential_impulse, physics::speculative,
                                physics::incremental_manifolds, physics::hash_grid> {};

/// Whether the steps were worth watching.
template <class Recipe, class Record>
void is_lively(const Record& r, bool sleep) {
    CHECK(r.most_contacts > 30);
    CHECK(r.begun > 20);
    CHECK((r.swept > 100) == !std::is_same_v<Recipe, others>);
    CHECK(r.hits > 1000);
    CHECK((r.falls_asleep > 1) == sleep);
    CHECK((r.wakes > 1) == sleep);
}

TEST_CASE_TEMPLATE_DEFINE("allocations: none in steps that an earlier run of them made room for", Recipe, steps) {
    constexpr int count = 160;
    for (const auto& mode : {std::pair(true, false), {false, false}, {true, true}}) {
        const bool sleep = mode.first, shared = mode.second;
        CAPTURE(sleep);
        CAPTURE(shared);
        playground<Recipe> p(sleep);
        const auto start = p.arena;
        const auto first = p.play(count, shared);
        is_lively<Recipe>(first, sleep);
        CHECK(first.calls > 0);
        // Stages swap arrays with those of the step before: after two runs both have grown.
        p.arena = start;
        CHECK(p.play(count, shared).hash == first.hash);
        CHECK(calls_of([&] { p.arena = start; }) == 0);
        CHECK(calls_of([&] {
                  auto taken = std::move(p.arena);
                  p.arena = std::move(taken);
              }) == 0);
        const auto again = p.play(count, shared);
        CHECK(again.calls == 0);
        CHECK(again.hash == first.hash);
        // What goes on in the same way seldom needs more.
        CHECK(p.play(count, shared).calls < 12);
    }
    // A copy has room of its own to make.
    playground<Recipe> p(true);
    p.play(40);
    auto twin = p;
    const auto start = twin.arena;
    const auto first = twin.play(count);
    CHECK(first.calls > 0);
    twin.arena = start;
    twin.play(count);
    twin.arena = start;
    CHECK(twin.play(count).calls == 0);
    CHECK(p.play(count).hash == first.hash);
}

TEST_CASE_TEMPLATE_DEFINE("allocations: none while things rest", Recipe, rest) {
    playground<Recipe> p(false);
    p.arena.set_angular_velocity(p.drum, {});
    p.arena.destroy_body(p.dart);
    for (const body_id body : p.arena.bodies())
        for (const physics::shape_id shape : p.arena.shapes(body))
            p.arena.set_material(shape, {.rolling_resistance = typename playground<Recipe>::S(0.0625)});
    const auto steps = [&](int count) {
        for (int i = 0; i < count; ++i) p.arena.step(typename playground<Recipe>::S(1.0 / 64));
    };
    steps(300);
    CHECK(calls_of([&] { steps(100); }) == 0);
}

TEST_CASE_TEMPLATE_DEFINE("allocations: none to save and to restore where there was room", Recipe, snapshots) {
    constexpr int count = 120;
    using physics::detail::world_access;
    playground<Recipe> p(true);
    p.play(30);
    physics::detail::raw_snapshot<typename physics::detail::plan_of<Recipe>::type> first, last;
    CHECK(calls_of([&] { first.save(world_access::state_of(p.arena)); }) > 0);
    p.play(count);
    last.save(world_access::state_of(p.arena));
    const std::uint64_t end = p.arena.state_hash();
    // Stages swap arrays with those of the step before: after two runs both have grown.
    for (const bool grown : {false, true}) {
        CHECK(calls_of([&] { CHECK(first.restore(world_access::data_of(p.arena))); }) == 0);
        const auto again = p.play(count);
        is_lively<Recipe>(again, true);
        CHECK(again.hash == end);
        if (grown) CHECK(again.calls == 0);
        // Forth and back: to where there is less, and to where there is more.
        for (int i = 0; i < 3; ++i) {
            CHECK(calls_of([&] { CHECK(first.restore(world_access::data_of(p.arena))); }) == 0);
            CHECK(calls_of([&] { CHECK(last.restore(world_access::data_of(p.arena))); }) == 0);
            CHECK(p.arena.state_hash() == end);
        }
    }
    // A snapshot that has been as large makes room for none again.
    for (int i = 0; i < 3; ++i) {
        CHECK(calls_of([&] { last.save(world_access::state_of(p.arena)); }) == 0);
        p.play(8);
        CHECK(calls_of([&] { CHECK(last.restore(world_access::data_of(p.arena))); }) == 0);
    }
    physics::world<Recipe> fresh;
    for (const bool grown : {false, true})
        for (const auto* of : {&first, &last})
            CHECK((calls_of([&] { CHECK(of->restore(world_access::data_of(fresh))); }) == 0) == grown);
    CHECK(fresh.state_hash() == p.arena.state_hash());
}

TEST_CASE_TEMPLATE_DEFINE("allocations: a body that finds no memory is refused, and the world as it was", Recipe,
                          bodies) {
    using world = physics::world<Recipe>;
    playground<Recipe> p(true);
    p.play(30);
    // A copy has no room to spare.
    const world from = p.arena;
    world expected = from;
    expected.create_body();
    expected.step(typename world::scalar(1.0 / 64));
    int refused = 0;
    for (bool is_done = false; !is_done;) {
        world w = from;
        calls_until_refused = refused;
        try {
            w.create_body();
            is_done = true;
        } catch (const physics::error&) {
            ++refused;
        }
        calls_until_refused = -1;
        CHECK(w.body_count() == from.body_count() + is_done);
        if (is_done) break;
        CHECK(w.state_hash() == from.state_hash());
        w.create_body();
        w.step(typename world::scalar(1.0 / 64));
        CHECK(w.state_hash() == expected.state_hash());
    }
    CHECK(refused > 4);
}

template <class Broadphase, class S, int D>
void moves_in_place() {
    using space = physics::space<S, D>;
    typename Broadphase::template in<space> proxies;
    const auto box_of = [](std::uint32_t id, double phase) {
        physics::vec<S, D> v;
        for (int i = 0; i < D; ++i) {
            const double part = phase * (1 + (id + static_cast<std::uint32_t>(i)) % 5) + 0.37 * id;
            const double saw = part - static_cast<int>(part);
            v[i] = S(12 * (saw < 0.5 ? saw : 1 - saw) + 0.01 * id);
        }
        return physics::aabb<S, D>{v, v + physics::vec<S, D>::filled(S(0.5 + 0.125 * (id % 4)))};
    };
    for (std::uint32_t id = 0; id < 200; ++id) proxies.insert(id, box_of(id, 0), {.movable = id % 9 > 0});
    const auto start = proxies;
    std::uint32_t begun = 0, found = 0;
    const auto run = [&] {
        for (std::uint32_t step = 0; step < 120; ++step) {
            for (std::uint32_t id = 0; id < 200; ++id)
                if (id % 9 > 0 && (id + step / 30) % 3 > 0)
                    proxies.move(id, box_of(id, step / 240.0), physics::vec<S, D>::filled(S(0.05)));
            // Bodies that fall asleep, or are woken, come anew as proxies of the other kind.
            const std::uint32_t id = 1 + step % 8;
            proxies.erase(id);
            proxies.insert(id, box_of(id, step / 240.0), {.movable = step / 8 % 2 > 0});
            found += proxies.pairs([](std::uint32_t, std::uint32_t) { return true; }).size();
            begun += proxies.begun().size();
        }
    };
    run();
    proxies = start;
    run();
    CHECK(calls_of([&] { proxies = start; }) == 0);
    CHECK(calls_of(run) == 0);
    CHECK(begun > 3000);
    CHECK(found > 30000);
}
TEST_CASE_TEMPLATE("allocations: none in searches of a broadphase that earlier ones made room for", Broadphase,
                   physics::dynamic_tree, physics::sweep_and_prune, physics::grid, physics::hash_grid,
                   physics::all_pairs) {
    moves_in_place<Broadphase, float, 2>();
    moves_in_place<Broadphase, float, 3>();
}

TEST_CASE_TEMPLATE_INVOKE(steps, cell<float, 2>, cell<float, 3>, cell<fixed32, 2>, others);
TEST_CASE_TEMPLATE_INVOKE(bodies, cell<float, 2>, cell<fixed32, 3>);
TEST_CASE_TEMPLATE_INVOKE(snapshots, cell<float, 2>, cell<float, 3>, cell<fixed32, 2>, others);
TEST_CASE_TEMPLATE_INVOKE(rest, cell<float, 2>, cell<float, 3>, cell<fixed32, 2>);

}  // namespace
