// Manifolds of shapes at rest: how many points, how far apart, and that their features last.
#pragma once

#include <algorithm>

#include "distances.hpp"

namespace {

/// A pair at rest on a flat side: B on A along a normal, with what the contact should cover.
struct rest {
    std::string name;
    encounter pair;
    int points;
    /// Length of the contact in 2D, its area (of a capsule its length) in 3D.
    double extent;
};

inline vec extents(double x, double y, double z) { return from_reals({x, y, z}); }
/// At a place, turned about the vertical axis.
inline transform lying(double x, double y, double z, double angle = 0) {
    return {from_reals({x, y, z}), rotation_about({0, 1, 0}, cell::is_2d ? 0 : angle)};
}

/// Pairs at rest, one on top of the other along y, overlapping a little.
inline std::vector<rest> rests() {
    const S margin = cell::real(0.02);
    const double sunk = 1.0 / 1024;
    const box cube{vec::filled(S(0.5))}, plank{extents(2, 0.125, 0.25)}, table{extents(4, 0.5, 4)};
    const capsule log{S(0.5), S(0.25)};
    std::vector<rest> all;
    const auto add = [&](const char* name, const any_shape& a, const any_shape& b, transform at, int flat, int points,
                         double length, double area) {
        at.position.y -= S(sunk);
        all.push_back({name, {a, b, at, margin}, cell::is_2d ? flat : points, cell::is_2d ? length : area});
    };
    add("equal cubes", cube, cube, lying(0, 1, 0), 2, 4, 1, 1);
    add("cubes, one pushed aside", cube, cube, lying(0.25, 1, 0.25), 2, 4, 0.75, 0.5625);
    add("cubes, one half over the edge", cube, cube, lying(0.5, 1, 0), 2, 4, 0.5, 0.5);
    add("a cube on a table", table, cube, lying(1, 1, 1), 2, 4, 1, 1);
    add("a table on a cube", cube, table, lying(1, 1, 1), 2, 4, 1, 1);
    add("planks", plank, plank, lying(0, 0.25, 0), 2, 4, 4, 2);
    add("a plank on a cube", cube, plank, lying(0, 0.625, 0), 2, 4, 1, 0.5);
    if (cell::is_3d) {
        add("cubes, one turned by 30 degrees", cube, cube, lying(0, 1, 0, M_PI / 6), 0, 4, 0, 0.845);
        add("cubes, one turned by 45 degrees", cube, cube, lying(0, 1, 0, M_PI / 4), 0, 4, 0, 0.828);
        add("crossed planks", plank, plank, lying(0, 0.25, 0, M_PI / 2), 0, 4, 0, 0.25);
        add("a cube beside a cube", cube, cube, {extents(1 - sunk, sunk, 0), {}}, 0, 4, 0, 1);
    }
    add("a cube on the ground", cube, halfspace{}, lying(0, -0.5 + 2 * sunk, 0), 2, 4, 1, 1);
    add("a plank on the ground", plank, halfspace{}, lying(0, -0.125 + 2 * sunk, 0), 2, 4, 4, 2);
    add("a log on the ground", log, halfspace{}, lying(0, -0.25 + 2 * sunk, 0), 2, 2, 1, 1);
    add("a log on a table", log, table, lying(0.25, -0.75 + 2 * sunk, 0.125, 0.3), 2, 2, 1, 1);
    add("a log across a cube", capsule{S(1), S(0.25)}, cube, lying(0.25, -0.75 + 2 * sunk, 0), 2, 2, 1, 1);
    add("equal logs", log, log, lying(0, 0.5, 0), 2, 2, 1, 1);
    add("logs, one pushed along", log, log, lying(0.5, 0.5, 0), 2, 2, 0.5, 0.5);
    return all;
}

/// The area that four points around a middle span, or the distance of two.
inline double extent_of(const manifold& m) {
    std::vector<reals> p;
    reals middle;
    for (int i = 0; i < m.count; ++i) {
        p.push_back(to_reals(m.points[i].position));
        middle = middle + p.back() * (1.0 / m.count);
    }
    if (m.count < 2) return 0;
    if (m.count == 2) return size(p[1] - p[0]);
    const reals n = to_reals(m.normal), u = unit(p[0] - middle), v = cross(n, u);
    std::sort(p.begin(), p.end(), [&](reals a, reals b) {
        return std::atan2(dot(a - middle, v), dot(a - middle, u)) < std::atan2(dot(b - middle, v), dot(b - middle, u));
    });
    double twice = 0;
    for (std::size_t i = 0; i < p.size(); ++i) twice += dot(n, cross(p[i] - middle, p[(i + 1) % p.size()] - middle));
    return std::abs(twice) / 2;
}
inline std::vector<std::uint32_t> features_of(const manifold& m) {
    std::vector<std::uint32_t> all;
    for (int i = 0; i < m.count; ++i) all.push_back(m.points[i].feature);
    std::sort(all.begin(), all.end());
    return all;
}

CELL_CASE("manifold: what lies flat has its points at the ends of what is shared") {
    for (const rest& r : rests()) {
        CAPTURE(r.name);
        const std::string law = complaint(r.pair);
        CHECK_MESSAGE(law.empty(), law);
        const manifold m = collide(r.pair);
        CHECK(m.count == r.points);
        CHECK(std::abs(deepest(m) + 1.0 / 1024) <= 1e-5);
        // An octagon's widest four corners span 0.707 of it; slack at the edges is below one percent.
        const bool octagon = r.extent > 0.8 && r.extent < 0.9;
        CHECK(extent_of(m) >= r.extent * (octagon ? 0.7 : 0.99));
        CHECK(extent_of(m) <= r.extent * 1.02);
    }
}

CELL_CASE("manifold: features outlast the jitter of a body at rest") {
    cell::dice dice(40);
    for (const rest& r : rests()) {
        CAPTURE(r.name);
        const manifold first = collide(r.pair);
        for (int i = 0; i < 200; ++i) {
            encounter e = r.pair;
            const double jitter = i % 2 ? 1e-6 : 1e-5;
            const reals shift = random_direction(dice) * jitter, twist = random_axis(dice) * jitter;
            e.b_in_a.position += from_reals(shift);
            e.b_in_a.rotation = turned(e.b_in_a.rotation, to_angular(twist));
            const manifold m = collide(e);
            REQUIRE(features_of(m) == features_of(first));
            // The same feature is in the same place.
            for (int k = 0; k < m.count; ++k)
                for (int j = 0; j < first.count; ++j)
                    if (m.points[k].feature == first.points[j].feature)
                        REQUIRE(size(to_reals(m.points[k].position) - to_reals(first.points[j].position)) <= 1e-3);
        }
    }
}

CELL_CASE("manifold: a body that rocks or slides keeps most of its features from step to step") {
    const box cube{vec::filled(S(0.5))};
    cell::dice dice(41);
    int kept = 0, all = 0;
    for (int run = 0; run < 40; ++run) {
        const double angle = dice.number(-0.5, 0.5), speed = dice.number(-0.002, 0.002);
        const double rock = dice.number(0, 0.01), from = dice.number(-0.3, 0.3);
        std::vector<std::uint32_t> before;
        for (int i = 0; i < 50; ++i) {
            transform at = lying(from + speed * i, 1 - 1.0 / 1024, 0, cell::is_2d ? 0 : angle);
            at.rotation = turned(at.rotation, to_angular(reals{0, 0, 1} * (rock * std::sin(0.3 * i))));
            const std::vector<std::uint32_t> now = features_of(collide({cube, cube, at, S(0.02)}));
            for (const std::uint32_t f : now) {
                if (i > 0) ++all;
                if (i > 0) kept += std::count(before.begin(), before.end(), f) > 0;
            }
            before = now;
        }
    }
    CHECK(all > 2000);
    CHECK(kept >= all * 95 / 100);
}

CELL_CASE("manifold: of many points the deepest stays, however small the tilt") {
    if (cell::is_2d) return;
    const box cube{vec::filled(S(0.5))};
    cell::dice dice(42);
    for (int i = 0; i < 2000; ++i) {
        transform at = lying(0, 1, 0, dice.number(0.2, 1.3));
        const double tilt = dice.number(0.003, 0.02);
        at.rotation = turned(at.rotation, to_angular(random_axis(dice) * tilt));
        at.position.y -= S(0.01);
        const encounter e{cube, cube, at, S(0.04)};
        const manifold m = collide(e);
        REQUIRE(m.count == 4);
        const std::string law = complaint(e);
        REQUIRE_MESSAGE(law.empty(), law);
    }
}

CELL_CASE("manifold: a short contact of capsules keeps to where they are") {
    if (cell::is_2d) return;
    // Long thin rods that cross at one degree touch in one place, not at their ends.
    const capsule rod{S(5), S(0.01)};
    const manifold m = collide({rod, rod, lying(0, 0.019, 0, M_PI / 180), S(0.005)});
    CHECK(m.count == 1);
    CHECK(size(to_reals(m.points[0].position) - reals{0, 0.0095, 0}) <= 1e-3);
    // Side by side they touch along all of their length.
    const manifold along = collide({rod, rod, lying(0, 0.019, 0, 1e-6), S(0.005)});
    CHECK(along.count == 2);
    CHECK(std::abs(extent_of(along) - 10) <= 1e-3);
}

}  // namespace
