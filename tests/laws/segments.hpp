// Laws of closest points on segments, and of cutting them.
#pragma once

#include "distances.hpp"

namespace {

CELL_CASE("segment: the closest parameter is where no other point is closer") {
    cell::dice dice(70);
    for (int i = 0; i < 3000; ++i) {
        const double length = std::pow(10, dice.number(-2, 1));
        const vec a = dice.vec<vec>(-1, 1), p = dice.vec<vec>(-2, 2);
        vec b = a + from_reals(random_direction(dice) * length);
        if (i % 50 == 0) b = a;
        const double t = cell::number(physics::closest_parameter(a, b, p));
        REQUIRE(t >= 0);
        REQUIRE(t <= 1);
        const reals from = to_reals(a), along = to_reals(b) - from;
        const double there = size(to_reals(p) - from - along * t);
        for (int k = 0; k <= 40; ++k) REQUIRE(there <= size(to_reals(p) - from - along * (k / 40.0)) + 16 * epsilon);
    }
    CHECK(physics::closest_parameter(vec{}, vec{}, vec::filled(S(1))) == S(0));
}

CELL_CASE("segment: closest points hold their precision where segments are nearly parallel or cross") {
    cell::dice dice(71);
    using vec3 = physics::vec<S, 3>;
    const auto in_space = [](vec3 v) { return reals{cell::number(v.x), cell::number(v.y), cell::number(v.z)}; };
    for (int i = 0; i < 4000; ++i) {
        const int axis = dice.below(3);
        const S half_a = dice.real(0.1, 1), half_b = dice.real(0.1, 1);
        const double lean = i % 4 == 0 ? 2 : std::pow(10, dice.number(-7, -1)), away = std::pow(10, dice.number(-6, 0));
        vec3 b{dice.real(-lean, lean), dice.real(-lean, lean), dice.real(-lean, lean)},
            center = dice.vec<vec3>(-away, away);
        b[axis] += S(1);
        b = normalized(b);
        if (i % 10 == 0) b = {S(axis == 0 ? 1 : 0), S(axis == 1 ? 1 : 0), S(axis == 2 ? 1 : 0)};
        center[axis] = dice.real(-1.5, 1.5);
        const auto found = physics::closest_to_axis(axis, half_a, center, b, half_b);
        REQUIRE(-half_a <= found.on_a);
        REQUIRE(found.on_a <= half_a);
        REQUIRE(-half_b <= found.on_b);
        REQUIRE(found.on_b <= half_b);
        reals along;
        along[axis] = 1;
        const auto distance = [&](double s, double t) { return size(in_space(center) + in_space(b) * t - along * s); };
        const double there = distance(cell::number(found.on_a), cell::number(found.on_b));
        // Along B the distance to A is convex, and the nearest point of A is known.
        const double most_a = cell::number(half_a), most_b = cell::number(half_b);
        const auto to_a = [&](double t) {
            const double s = in_space(center)[axis] + in_space(b)[axis] * t;
            return distance(std::fmax(-most_a, std::fmin(most_a, s)), t);
        };
        double low = -most_b, high = most_b;
        for (int k = 0; k < 200; ++k) {
            const double third = (high - low) / 3;
            if (to_a(low + third) < to_a(high - third)) high -= third;
            else low += third;
        }
        REQUIRE(there <= to_a((low + high) / 2) + 16 * epsilon);
    }
}

CELL_CASE("segment: cut to a strip") {
    cell::dice dice(72);
    for (int i = 0; i < 3000; ++i) {
        const S middle = dice.real(-2, 2), limit = dice.real(0.1, 1);
        S direction = dice.real(-1, 1);
        if (i % 20 == 0) direction = S(0);
        if (i % 20 == 1) direction = cell::tolerance(4);
        const S from = dice.real(-2, 0), to = dice.real(0, 2);
        S start = from, stop = to;
        const bool left = physics::clip_segment(middle, direction, limit, start, stop);
        for (int k = 0; k <= 20; ++k) {
            const double t = cell::number(from) + cell::number(to - from) * k / 20;
            const double p = cell::number(middle) + cell::number(direction) * t, most = cell::number(limit);
            const double low = cell::number(start), high = cell::number(stop), hair = 8 * epsilon;
            // What is within the strip stays and what is beyond goes, but for rounding.
            if (std::abs(p) < most - 32 * epsilon) REQUIRE((left && t >= low - hair && t <= high + hair));
            if (std::abs(p) > most + 32 * epsilon) REQUIRE(!(left && t > low + hair && t < high - hair));
        }
        if (left) REQUIRE(from <= start);
        if (left) REQUIRE(stop <= to);
    }
}

}  // namespace
