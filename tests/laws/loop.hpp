// The accumulator against exact arithmetic: how many steps, what is left, what is drawn, and what mistakes do to it.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "refusal.hpp"

using accumulator = physics::accumulator<world>;
template class physics::accumulator<world>;

namespace {
namespace loop_laws {

/// Step and longest frame in 1/1024 s: exact in every scalar, as is any sum of few.
accumulator clock_of(int step, int longest_frame) {
    accumulator::settings_type settings;
    settings.step = S(step / 1024.0);
    settings.longest_frame = S(longest_frame / 1024.0);
    return accumulator(settings);
}

CELL_CASE("loop: steps, carried time and dropped time are those of exact arithmetic, for any frames") {
    cell::dice dice(1);
    for (int round = 0; round < 20; ++round) {
        const int step = 1 + dice.below(40), longest = step + dice.below(200);
        accumulator clock = clock_of(step, longest);
        world w;
        int rest = 0;
        std::uint64_t steps = 0;
        for (int i = 0; i < 200; ++i) {
            const int elapsed = dice.below(4) == 0 ? 0 : dice.below(dice.below(8) == 0 ? 2000 : 2 * step);
            const auto report = clock.advance(w, S(elapsed / 1024.0));
            const int used = elapsed < longest ? elapsed : longest;
            rest += used;
            REQUIRE(report.steps == rest / step);
            REQUIRE(report.dropped == S((elapsed - used) / 1024.0));
            steps += static_cast<std::uint64_t>(rest / step);
            rest %= step;
            REQUIRE(clock.rest() == S(rest / 1024.0));
            REQUIRE(w.steps() == steps);
            REQUIRE(clock.factor() >= S(0));
            REQUIRE(clock.factor() < S(1));
            REQUIRE(gap(clock.factor(), S(double(rest) / step)) <= rounding(1));
        }
    }
}

CELL_CASE("loop: over many frames of any length no time is lost, and the motion is that of the steps alone") {
    cell::dice dice(2);
    accumulator clock;
    world w, plain;
    const body_id ball = add_ball(w, {});
    add_ball(plain, {});
    double real_time = 0;
    int steps = 0;
    for (int i = 0; i < 1000; ++i) {
        const S elapsed = dice.real(0, 0.05);
        real_time += number(elapsed);
        steps += clock.advance(w, elapsed).steps;
    }
    const double step = number(clock.settings().step);
    CHECK(std::abs(steps * step + number(clock.rest()) - real_time) <= rounding(2000, 1));
    for (int i = 0; i < steps; ++i) plain.step(clock.settings().step);
    CHECK(w.state_hash() == plain.state_hash());
    CHECK(w.contains(ball));
}

CELL_CASE("loop: hooks run before and after each step, in order") {
    accumulator clock = clock_of(16, 256);
    world w;
    std::string order;
    std::vector<std::uint64_t> seen;
    const auto before = [&](world& now) {
        order += "b";
        seen.push_back(now.steps());
    };
    const auto after = [&](world& now) {
        order += "a";
        seen.push_back(now.steps());
    };
    CHECK(clock.advance(w, S(15.0 / 1024), before, after).steps == 0);
    CHECK(order.empty());
    CHECK(clock.advance(w, S(33.0 / 1024), before, after).steps == 3);
    CHECK(order == "bababa");
    CHECK((seen == std::vector<std::uint64_t>{0, 1, 1, 2, 2, 3}));
    clock.advance(w, S(16.0 / 1024), before);
    CHECK(order == "bababab");
}

CELL_CASE("loop: a force in the hook acts in every step") {
    world w(weightless());
    const body_id ball = w.create_body();
    accumulator clock = clock_of(16, 256);
    clock.advance(w, S(160.0 / 1024), [&](world& now) { now.apply_force(ball, along(0, 64)); });
    CHECK(w.linear_velocity(ball) == along(0, 10));
}

CELL_CASE("loop: what is drawn lies between the last two poses, turns the shorter way, and keeps its length") {
    cell::dice dice(3);
    for (int round = 0; round < 20; ++round) {
        world w(weightless());
        world::body_def def;
        def.position = dice.vec<vec>(-4, 4);
        def.rotation = random_rotation(dice);
        def.linear_velocity = dice.vec<vec>(-8, 8);
        // Up to a step of almost half a turn, beyond which the shorter way is the other one.
        const double turn = dice.number(-3, 3);
        def.angular_velocity = about_z(turn * 8);
        const body_id id = w.create_body(def);
        const world::transform start = w.pose(id);
        accumulator clock = clock_of(128, 512);
        clock.advance(w, S(130.0 / 1024));
        const world::transform end = w.pose(id);
        for (const int rest : {2, 34, 66, 127}) {
            const auto drawn = clock.interpolated(w, id);
            const double t = rest / 128.0;
            CHECK(gap(drawn.position, start.position + (end.position - start.position) * S(t)) <= rounding(8, 8));
            // The way from pose to pose is measured exactly, turned() is off by less than 1e-8 of an angle.
            CHECK(gap(drawn.rotation, turned(start.rotation, about_z(turn * t))) <= rounding(64) + 6e-8);
            CHECK(number(norm_error(drawn.rotation)) <= rounding(16));
            if (rest < 127) clock.advance(w, S((rest == 66 ? 61 : 32) / 1024.0));
        }
        clock.advance(w, S(1.0 / 1024));
        CHECK(clock.factor() == S(0));
        CHECK(clock.interpolated(w, id).position == end.position);
        CHECK(gap(clock.interpolated(w, id).rotation, end.rotation) <= rounding(16));
    }
}

CELL_CASE("loop: bodies that come, go and change places between steps are drawn where they are") {
    world w(weightless());
    accumulator clock = clock_of(16, 256);
    const auto mover = [](double x) {
        return world::body_def{.position = along(0, x), .linear_velocity = along(0, 64)};
    };
    const body_id first = w.create_body(mover(0));
    CHECK(clock.interpolated(w, first).position == vec{});
    clock.advance(w, S(24.0 / 1024));
    CHECK(clock.interpolated(w, first).position == along(0, 0.5));
    // A body that is newer than the step, in a new slot and in one that another body had.
    const body_id second = w.create_body(mover(10));
    CHECK(clock.interpolated(w, second).position == along(0, 10));
    w.destroy_body(first);
    const body_id third = w.create_body(mover(20));
    REQUIRE(third.index == first.index);
    CHECK(clock.interpolated(w, third).position == along(0, 20));
    CHECK(refusal([&] { (void)clock.interpolated(w, first); }).find("destroyed") != std::string::npos);
    CHECK(refusal([&] { (void)clock.interpolated(w, {}); }).find("null") != std::string::npos);
    // The same in hooks: what is made before the step moves in it, what is made after it does not.
    body_id early, late;
    const auto report = clock.advance(
        w, S(8.0 / 1024),
        [&](world& now) {
            now.destroy_body(second);
            early = now.create_body(mover(30));
        },
        [&](world& now) {
            now.destroy_body(third);
            late = now.create_body(mover(40));
        });
    CHECK(report.steps == 1);
    clock.advance(w, S(8.0 / 1024));
    CHECK(clock.interpolated(w, early).position == along(0, 30.5));
    CHECK(clock.interpolated(w, late).position == along(0, 40));
    // Another world's bodies have other poses, whatever their numbers are.
    world other(weightless());
    const body_id stranger = other.create_body(mover(50));
    CHECK(clock.interpolated(other, stranger).position == along(0, 50));
}

CELL_CASE("loop: teleports, worlds that are brought back and resets are drawn as no way") {
    world w(weightless());
    accumulator clock = clock_of(16, 256);
    const body_id a = w.create_body({.linear_velocity = along(0, 64)}), b = w.create_body({.position = along(0, 8)});
    const world start = w;
    clock.advance(w, S(24.0 / 1024));
    CHECK(clock.interpolated(w, a).position == along(0, 0.5));
    w.set_pose(a, along(0, 100), {});
    CHECK(clock.interpolated(w, a).position == along(0, 100));
    CHECK(clock.interpolated(w, b).position == along(0, 8));
    clock.advance(w, S(16.0 / 1024));
    CHECK(clock.interpolated(w, a).position == along(0, 100.5));
    w = start;
    CHECK(clock.interpolated(w, a).position == vec{});
    CHECK(clock.rest() == S(8.0 / 1024));
    clock.reset();
    CHECK(clock.rest() == S(0));
    CHECK(clock.advance(w, S(8.0 / 1024)).steps == 0);
    CHECK(clock.interpolated(w, a).position == vec{});
}

CELL_CASE("loop: settings and times out of range are refused, and the clock stands still") {
    world w;
    accumulator clock = clock_of(16, 256);
    clock.advance(w, S(20.0 / 1024));
    refuses_number(w, "advance", "elapsed", rule::not_negative, [&](S bad) { clock.advance(w, bad); });
    CHECK(clock.rest() == S(4.0 / 1024));
    refuses_number(w, "accumulator", "step", rule::positive, [&](S bad) { accumulator refused({.step = bad}); });
    refuses_number(w, "accumulator", "longest_frame", rule::positive,
                   [&](S bad) { accumulator refused({.longest_frame = bad}); });
    refuses(w, "accumulator", "longest_frame", "0.25", [&] { accumulator refused({.step = S(0.5)}); });
    refuses(w, "accumulator", "longest_frame", "0.25", [&] { accumulator refused({.step = S(1.0 / 1048576)}); });
    accumulator finest({.step = S(1.0 / 262144)});
    CHECK(finest.advance(w, S(1)).steps == 65536);
}

CELL_CASE("loop: a hook or a step that throws ends the call; the time that was due is gone, the rest is kept") {
    accumulator clock = clock_of(16, 256);
    world w(weightless());
    const body_id ball = w.create_body({.linear_velocity = along(0, 64)});
    int calls = 0;
    const auto stumble = [&](world&) {
        if (++calls == 2) throw std::runtime_error("stumble");
    };
    const auto check_rest = [&](std::uint64_t steps) {
        CHECK(w.steps() == steps);
        CHECK(clock.rest() == S(4.0 / 1024));
        CHECK(clock.factor() == S(0.25));
        CHECK(clock.advance(w, S(0)).steps == 0);
    };
    CHECK_THROWS_AS(clock.advance(w, S(52.0 / 1024), stumble), std::runtime_error);
    check_rest(1);
    calls = 0;
    CHECK_THROWS_AS(clock.advance(w, S(48.0 / 1024), physics::no_hook{}, stumble), std::runtime_error);
    check_rest(3);
    CHECK(clock.interpolated(w, ball).position == along(0, 2.25));
    if constexpr (!cell::is_fixed) {
        const auto overload = [&](world& now) {
            now.set_pose(ball, along(0, number(cell::largest())), {});
            now.set_linear_velocity(ball, along(0, number(cell::largest())));
        };
        CHECK_THROWS_AS(clock.advance(w, S(48.0 / 1024), overload), physics::error);
        check_rest(3);
        w.set_pose(ball, {}, {});
        w.set_linear_velocity(ball, along(0, 64));
    }
    CHECK(clock.advance(w, S(12.0 / 1024)).steps == 1);
    CHECK(w.steps() == 4);
}

}  // namespace loop_laws
}  // namespace
