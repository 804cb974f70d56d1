// Laws of executors: whoever does the work, the bits are the same; and what an executor must not do is refused.
#pragma once

#include <atomic>
#include <functional>
#include <thread>

#include "refusal.hpp"
#include "world_cell.hpp"

namespace {
namespace executors_laws {

/// The last part first, by one worker after the other.
struct backwards {
    std::uint32_t count = 4;

    [[nodiscard]] std::uint32_t workers() const { return count; }
    void run(std::uint32_t parts, const physics::task_set& what) {
        for (std::uint32_t k = parts; k-- > 0;) what(k, k % count);
    }
};
/// A thread for each worker, made anew for each piece of work: the parts in stripes.
struct fresh_threads {
    [[nodiscard]] std::uint32_t workers() const { return 3; }
    void run(std::uint32_t parts, const physics::task_set& what) {
        const auto stripe = [&](std::uint32_t worker) {
            for (std::uint32_t k = worker; k < parts; k += workers()) what(k, worker);
        };
        std::thread one(stripe, 1), two(stripe, 2);
        stripe(0);
        one.join();
        two.join();
    }
};
struct faulty {
    std::function<void(std::uint32_t, const physics::task_set&)> run;
    std::uint32_t count = 2;

    [[nodiscard]] std::uint32_t workers() const { return count; }
};

/// A pyramid that is wide enough to be shared out, many small stacks, a slab that pushes several of them, and a ball
/// that is faster than its size allows.
struct busy_place {
    world w{{.gravity = along(1, -10)}};

    explicit busy_place(int base) {
        const body_id ground = w.create_body({.type = body_type::static_body, .position = along(1, -1)});
        vec half;
        for (int i = 0; i < cell::dimension; ++i) half[i] = S(i == 1 ? 1 : 400);
        w.create_shape(ground, world::box{half});
        for (int row = 0; row < base; ++row)
            for (int i = 0; i < base - row; ++i) add_box(at(i * 1.1 + row * 0.55, 0.5 + row));
        for (int stack = 0; stack < 60; ++stack)
            for (int i = 0; i < 4; ++i) add_box(at(-3.0 - stack * 2, 0.5 + i));
        const body_id slab = w.create_body({.type = body_type::kinematic_body, .position = at(-60, 0.75)});
        w.create_shape(slab, world::box{along_all(0.125) + along(0, 60)});
        w.set_linear_velocity(slab, along(2 % cell::dimension, cell::is_2d ? 0.125 : 0) + along(0, 0.5));
        const body_id ball = w.create_body({.position = at(-140, 1), .linear_velocity = along(0, 200)});
        w.create_shape(ball, world::ball{S(0.125)});
    }
    static vec along_all(double size) {
        vec v;
        for (int i = 0; i < cell::dimension; ++i) v[i] = S(size);
        return v;
    }
    void add_box(vec where) { w.create_shape(w.create_body({.position = where}), world::box{along_all(0.5)}); }
};

template <class Executor>
void compare_with_serial(Executor& by, int steps) {
    busy_place alone(40), shared(40);
    for (int i = 0; i < steps; ++i) {
        alone.w.step(S(1.0 / 64));
        shared.w.step(S(1.0 / 64), by);
        REQUIRE(alone.w.state_hash() == shared.w.state_hash());
    }
}

CELL_CASE("executors: any order, any number of workers and any threads give the bits of one") {
    backwards four, one{1};
    compare_with_serial(four, 24);
    compare_with_serial(one, 4);
    fresh_threads fresh;
    compare_with_serial(fresh, 6);
    for (const std::uint32_t workers : {1u, 2u, 3u}) {
        physics::thread_pool pool(workers);
        REQUIRE(pool.workers() == workers);
        compare_with_serial(pool, 24);
    }
}

CELL_CASE("executors: workers may change from step to step, worlds may share a pool, and copies need none") {
    physics::thread_pool pool(2);
    backwards three{3};
    busy_place alone(12), shared(12), other(8);
    for (int i = 0; i < 8; ++i) {
        alone.w.step(S(1.0 / 64));
        if (i % 3 == 0) shared.w.step(S(1.0 / 64));
        else if (i % 3 == 1) shared.w.step(S(1.0 / 64), pool);
        else shared.w.step(S(1.0 / 64), three);
        other.w.step(S(1.0 / 64), pool);
        const world copy = shared.w;
        shared.w = copy;
        REQUIRE(alone.w.state_hash() == shared.w.state_hash());
    }
}

CELL_CASE("executors: one that leaves out parts, or has no workers, is refused, and the world is as it was") {
    busy_place place(12);
    for (int i = 0; i < 3; ++i) place.w.step(S(1.0 / 64));
    const auto before = place.w.state_hash();
    faulty lazy{[](std::uint32_t parts, const physics::task_set& what) {
        for (std::uint32_t k = 1; k < parts; ++k) what(k, 0);
    }};
    faulty idle{[](std::uint32_t, const physics::task_set&) {}};
    faulty strange{[](std::uint32_t parts, const physics::task_set& what) {
        for (std::uint32_t k = 0; k < parts; ++k) what(k, 2);
    }};
    faulty empty{[](std::uint32_t, const physics::task_set&) {}, 0};
    for (faulty* by : {&lazy, &idle, &strange, &empty}) {
        CHECK(refusal([&] { place.w.step(S(1.0 / 64), *by); }).find("executor") != std::string::npos);
        CHECK(place.w.state_hash() == before);
    }
    // Also one that begins to in the midst of a step.
    int rounds = 0;
    faulty counting{[&rounds](std::uint32_t parts, const physics::task_set& what) {
        ++rounds;
        for (std::uint32_t k = 0; k < parts; ++k) what(k, k % 2);
    }};
    world(place.w).step(S(1.0 / 64), counting);
    REQUIRE(rounds > 2);
    for (int good = 0; good < rounds; ++good) {
        int rest = good;
        faulty tired{[&rest](std::uint32_t parts, const physics::task_set& what) {
            for (std::uint32_t k = rest-- == 0; k < parts; ++k) what(k, k % 2);
        }};
        CHECK(refusal([&] { place.w.step(S(1.0 / 64), tired); }).find("executor") != std::string::npos);
        CHECK(place.w.state_hash() == before);
    }
    // So is one that does a part twice, at once or later.
    for (int twice = 0; twice < rounds; ++twice) {
        int rest = twice;
        faulty eager{[&rest](std::uint32_t parts, const physics::task_set& what) {
            for (std::uint32_t k = 0; k < parts; ++k) what(k, k % 2);
            if (rest-- == 0) what(parts / 2, 1);
        }};
        CHECK(refusal([&] { place.w.step(S(1.0 / 64), eager); }).find("executor") != std::string::npos);
        CHECK(place.w.state_hash() == before);
    }
    // Calls with parts that there are not do nothing.
    busy_place alone(12);
    for (int i = 0; i < 4; ++i) alone.w.step(S(1.0 / 64));
    faulty keen{[](std::uint32_t parts, const physics::task_set& what) {
        for (std::uint32_t k = 0; k < parts + 3; ++k) what(k, 1);
    }};
    place.w.step(S(1.0 / 64), keen);
    CHECK(place.w.state_hash() == alone.w.state_hash());
    CHECK(refusal([] { physics::thread_pool crowd(257); }).find("workers") != std::string::npos);
}

CELL_CASE("executors: the pool calls every part once, by one worker at a time") {
    physics::thread_pool pool(3);
    for (const std::uint32_t parts : {0u, 1u, 2u, 7u, 1000u}) {
        std::vector<int> times(parts), busy(3);
        auto count = [&](std::uint32_t part, std::uint32_t worker) {
            ++busy[worker];
            if (busy[worker] == 1) ++times[part];
            --busy[worker];
        };
        std::vector<unsigned char> done(parts);
        for (int round = 0; round < 200; ++round) pool.run(parts, physics::task_set(count, done.data(), parts, 3));
        for (const int n : times) REQUIRE(n == 200);
    }
}

CELL_CASE("executors: a worker of the pool begins with parts of its own, and one that is stuck delays only its part") {
    constexpr std::uint32_t parts = 16;
    physics::thread_pool pool(2);
    std::vector<unsigned char> notes(parts);
    std::atomic<int> begun[parts], ended{0}, of_second{1};
    std::atomic<bool> keeps_to_its_own{true}, was_stuck{false};
    // One that got nothing in a round may still be looking for parts to steal when the next round begins.
    bool may_be_late = false;
    auto watch = [&](std::uint32_t part, std::uint32_t worker) {
        begun[part] = 1;
        if (worker == 1) ++of_second;
        const std::uint32_t first = worker * parts / 2;
        if ((part < first || part >= first + parts / 2) && !(worker == 1 && may_be_late)) {
            // Of its own the other one may be about to begin with one.
            int waiting = 0;
            for (std::uint32_t k = first; k < first + parts / 2; ++k) waiting += begun[k] == 0;
            if (waiting > 1) keeps_to_its_own = false;
        }
        // Where nobody takes the others, this one never ends, and the run of the test is stopped.
        if (worker == 1 && !was_stuck.exchange(true))
            while (ended < static_cast<int>(parts) - 1) std::this_thread::yield();
        for (int k = 0; k < 200; ++k) static_cast<void>(begun[part].load());
        ++ended;
    };
    int watched = 0;
    for (int round = 0; round < 2000; ++round) {
        for (auto& of : begun) of = 0;
        ended = 0;
        may_be_late = of_second.exchange(0) == 0;
        watched += !may_be_late;
        pool.run(parts, physics::task_set(watch, notes.data(), parts, 2));
        if (ended != static_cast<int>(parts)) FAIL("parts were left out");
    }
    CHECK(watched > 0);
    CHECK(keeps_to_its_own);
}

CELL_CASE("executors: an accumulator hands them on") {
    backwards two{2};
    busy_place alone(6), shared(6);
    physics::accumulator<world> first, second;
    for (int i = 0; i < 4; ++i) {
        CHECK(first.advance(alone.w, S(0.03125)).steps == second.advance(shared.w, S(0.03125), two).steps);
        CHECK(alone.w.state_hash() == shared.w.state_hash());
    }
}

CELL_CASE("executors: many rays and casts at once hit what they hit one by one, whoever does them") {
    busy_place place(8);
    world& w = place.w;
    run(w, 5);
    cell::dice dice(311);
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{64}, std::size_t{500}}) {
        CAPTURE(count);
        std::vector<world::ray_query> rays(count);
        std::vector<world::shape_query> casts(count);
        for (std::size_t i = 0; i < count; ++i) {
            vec from = dice.vec<vec>(-20, 20), way = dice.vec<vec>(-20, 20);
            from.y = dice.real(0, 10);
            rays[i] = {from, way, {.kinds = i % 3 ? physics::all_bodies : physics::dynamic_bodies}};
            casts[i] = {{from, {}}, way, rays[i].filter};
        }
        const world::ball ball{S(0.25)};
        // Room for more is left as it is.
        std::vector<world::world_hit> by_rays(count + 1), by_casts(count + 1);
        by_rays.back().fraction = S(0.5);
        const auto is_same = [](const world::world_hit& a, const world::world_hit& b) {
            return a.shape == b.shape && a.body == b.body && a.fraction == b.fraction && a.point == b.point &&
                   a.normal == b.normal;
        };
        int found = 0;
        const auto compare = [&] {
            for (std::size_t i = 0; i < count; ++i) {
                const auto r = w.cast_ray(rays[i].origin, rays[i].translation, rays[i].filter);
                const auto c = w.cast_shape(ball, casts[i].pose, casts[i].translation, casts[i].filter);
                CHECK((is_same(by_rays[i], r) && is_same(by_casts[i], c)));
                found += static_cast<bool>(r);
                by_rays[i] = by_casts[i] = {};
            }
            CHECK(by_rays.back().fraction == S(0.5));
        };
        const auto by = [&](auto&& workers) {
            w.cast_rays(rays, by_rays, workers);
            w.cast_shapes(ball, casts, by_casts, workers);
            compare();
        };
        w.cast_rays(rays, by_rays);
        w.cast_shapes(ball, casts, by_casts);
        compare();
        by(backwards{});
        by(fresh_threads{});
        physics::thread_pool pool(3);
        by(pool);
        if (count == 500) CHECK(found > 100);
    }
}
CELL_CASE("executors: of many rays none is cast where one is bad, by name") {
    busy_place place(3);
    world& w = place.w;
    std::vector<world::ray_query> rays(3);
    std::vector<world::shape_query> casts(3);
    for (auto& r : rays) r = {along(1, 20), along(1, -40), {}};
    for (auto& c : casts) c = {{along(1, 20), {}}, along(1, -40), {}};
    std::vector<world::world_hit> hits(3);
    backwards by;
    refuses(w, "cast_rays", "hits", "2", [&] { w.cast_rays(rays, std::vector<world::world_hit>(2)); });
    const body_id gone = w.create_body();
    w.destroy_body(gone);
    rays[2].filter.except = casts[2].filter.except = gone;
    refuses(w, "cast_rays", "except", "", [&] { w.cast_rays(rays, hits, by); });
    refuses(w, "cast_shapes", "except", "", [&] { w.cast_shapes(world::ball{}, casts, hits, by); });
    casts[2].filter.except = {};
    refuses(w, "cast_shapes", "radius", "-1", [&] { w.cast_shapes(world::ball{S(-1)}, casts, hits); });
    rays[2].filter.except = {};
    rays[1].origin = place.along_all(0.75 * number(cell::largest()));
    rays[1].translation = rays[1].origin;
    refuses(w, "cast_rays", "end of the way.x", "", [&] { w.cast_rays(rays, hits); });
    rays[1] = rays[0];
    for (const auto& hit : hits) CHECK(!hit);
    backwards nobody{0};
    refuses(w, "cast_rays", "executor", "without workers", [&] { w.cast_rays(rays, hits, nobody); });
    w.cast_rays(rays, hits, by);
    for (const auto& hit : hits) CHECK(hit);
}

}  // namespace executors_laws
}  // namespace
