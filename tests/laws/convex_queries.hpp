// Laws of distance, overlap and penetration for all pairs of convex kinds, against closed forms and many directions.
#pragma once

#include "convex_bodies.hpp"

namespace {

using closest = physics::closest_points<S, D>;
using physics::gjk_cache;

/// Calls f with both shapes in their own types, if they are a pair that has queries.
template <class F>
void with_shapes(const convex_encounter& e, F&& f) {
    e.a.shape.visit([&](const auto& a) {
        e.b.shape.visit([&](const auto& b) {
            if constexpr (requires { separation(a, b, e.b_in_a); }) f(a, b);
        });
    });
}
inline closest separation_of(const convex_encounter& e, gjk_cache* cache = nullptr) {
    closest c;
    with_shapes(e, [&](const auto& a, const auto& b) {
        c = cache ? separation(a, b, e.b_in_a, *cache) : separation(a, b, e.b_in_a);
    });
    return c;
}

/// How much rounding may cost, and what the kernel leaves on purpose: a quarter of a spacing of the sizes. GJK between
/// round shapes may stall at 1e-10 of them.
inline double query_tolerance(const convex_encounter& e) {
    return (e.a.round || e.b.round ? 64 * std::fmax(epsilon, 1e-11) : 24 * std::fmax(epsilon, 1e-14)) * e.reach();
}
/// The same of a distance, or with `points` of points: between round shapes their error goes with the root of the
/// distance's. Where the limit of iterations ended the search, a circle has become a polygon of dozens of corners.
inline double query_tolerance(const convex_encounter& e, const closest& c, bool points = false) {
    const bool limited = c.status == physics::query_status::iteration_limit;
    const double more = limited ? 2e-3 : points && (e.a.round || e.b.round) ? 4e-9 : 0;
    return (points ? 2 : 1) * query_tolerance(e) + more * e.reach();
}

/// The first law that an answer breaks. What n says is proven: they can be parted so. Where they are apart the points
/// prove the rest; where they overlap no other direction may do better.
inline std::string broken_law(const convex_encounter& e, const closest& c, cell::dice& dice, bool search = true) {
    const oracle::frame at = to_frame(e.b_in_a);
    const double tolerance = query_tolerance(e), of_points = query_tolerance(e, c, true), d = cell::number(c.distance);
    const oracle::point n = wide(c.normal), a = wide(c.on_a), b = wide(c.on_b);
    if (!(std::abs(double(size(n)) - 1) <= 32 * epsilon)) return "the normal is no unit vector";
    const double proven = along(e.a, e.b, at, n * (1 / size(n)));
    // Across a small gap a normal turns by the roundings of the points over the gap.
    if (!(std::abs(proven - d) <= 2 * tolerance)) return text_of_pair("the normal parts them worse", proven, d);
    const double off_a = e.a.distance(a), off_b = e.b.distance(at.undo(b));
    if (!(std::abs(off_a) <= of_points)) return text_of_pair("the point on A is not on it", off_a, d);
    if (!(std::abs(off_b) <= of_points)) return text_of_pair("the point on B is not on it", off_b, d);
    const reals across = to_reals(c.on_b) - to_reals(c.on_a) - to_reals(c.normal) * d;
    if (!(size(across) <= 4 * of_points)) return text_of_pair("the points do not lie across", size(across), d);
    if (d > 0 || !search) return "";
    const double best = best_along(e.a, e.b, at, dice);
    if (!(d >= best - query_tolerance(e, c))) return text_of_pair("there is a shorter way out", d, best);
    return "";
}
inline std::string complaint(const convex_encounter& e, cell::dice& dice, bool search = true) {
    const std::string law = broken_law(e, separation_of(e), dice, search);
    return law.empty() ? law : law + text_of(e);
}

/// Calls f with encounters of all pairs of kinds in all states.
template <class F>
void each_encounter(std::uint64_t seed, int times, F&& f) {
    cell::dice dice(seed);
    for (int a = of::ball; a < convex_set::kinds; ++a)
        for (int b = of::ball; b < convex_set::kinds; ++b)
            for (int in = 0; in < meetings; ++in)
                for (int i = 0; i < times; ++i) f(random_encounter(a, b, meeting(in), dice), meeting(in), dice);
}

CELL_CASE("convex shapes: distances and ways out are proven, and no other direction does better") {
    int limits = 0, on_axis = 0, all = 0;
    each_encounter(210, cell::draws(6), [&](const convex_encounter& e, meeting in, cell::dice& dice) {
        const std::string law = complaint(e, dice);
        CHECK_MESSAGE(law.empty(), name_of(in) << ": " << law);
        ++all;
        if (separation_of(e).status == physics::query_status::converged) return;
        // Coaxial solids of revolution have as many shortest ways out as a circle has points; EPA stops among them.
        ++limits;
        on_axis += in == meeting::coincident && (e.a.round || e.b.round);
    });
    CHECK(limits - on_axis <= 1);
    CHECK(limits * 100 <= all);
}

CELL_CASE("convex shapes: swapping them mirrors the answer, and distance, overlap and separation agree") {
    each_encounter(211, 3, [&](const convex_encounter& e, meeting, cell::dice&) {
        const closest c = separation_of(e);
        const convex_encounter turned_round{e.b, e.a, inverse(e.b_in_a)};
        const closest m = separation_of(turned_round);
        const double tolerance = 2 * query_tolerance(e, c), d = cell::number(c.distance);
        CHECK_MESSAGE(std::abs(d - cell::number(m.distance)) <= tolerance + query_tolerance(e, m), text_of(e));
        with_shapes(e, [&](const auto& a, const auto& b) {
            const closest apart = distance(a, b, e.b_in_a);
            CHECK(std::abs(cell::number(apart.distance) - std::fmax(d, 0)) <= tolerance);
            if (std::abs(d) > tolerance) CHECK(overlap(a, b, e.b_in_a) == (d < 0));
        });
    });
}

CELL_CASE("convex shapes: what a cache holds costs time, never an answer") {
    each_encounter(212, 2, [&](const convex_encounter& e, meeting in, cell::dice& dice) {
        const closest cold = separation_of(e);
        static gjk_cache of_another_pair;
        for (int i = 0; i < 5; ++i) {
            gjk_cache cache = of_another_pair;
            if (i < 3) {
                for (std::uint32_t& v : cache.vertex) v = std::uint32_t(dice.bits());
                const double scale = std::pow(10, dice.number(-9, 9));
                for (float& x : cache.axis) x = i ? float(dice.number(-1, 1) * scale) : 0;
                cache.count = std::uint8_t(i < 2 ? dice.below(5) : dice.below(256));
            }
            const closest warm = separation_of(e, &cache);
            const std::string law = broken_law(e, warm, dice, false);
            CHECK_MESSAGE(law.empty(), name_of(in) << " with a cache: " << law << text_of(e));
            const double apart = std::abs(cell::number(warm.distance) - cell::number(cold.distance));
            CHECK_MESSAGE(apart <= query_tolerance(e, warm) + query_tolerance(e, cold), text_of(e));
            // Again with what that left, as in the next step.
            const closest next = separation_of(e, &cache);
            CHECK(std::abs(cell::number(next.distance) - cell::number(warm.distance)) <= 2 * query_tolerance(e, next));
            if (i == 4) of_another_pair = cache;
        }
    });
}

CELL_CASE("convex shapes: queries of a halfspace are exact, in both orders") {
    cell::dice dice(213);
    for (int kind = of::ball; kind < convex_set::kinds; ++kind)
        for (int i = 0; i < 200; ++i) {
            const double scale = i % 4 == 3 ? 100 : 1;
            const convex_body a = random_body(kind, dice, scale, {.thin = i % 8 == 7});
            const halfspace ground{from_reals(random_direction(dice)), dice.real(-scale, scale)};
            const transform at{from_reals(random_direction(dice) * scale), random_rotation(dice)};
            const oracle::frame frame = to_frame(at);
            oracle::point up = wide(ground.normal);
            up = up * (1 / size(up));
            const double allowed = 32 * std::fmax(epsilon, 1e-15) * (6 * scale + (cell::is_fixed ? 1 : 0));
            a.shape.visit([&](const auto& shape) {
                if constexpr (physics::detail::has_core<std::remove_cvref_t<decltype(shape)>>) {
                    // The ground as A, then the body as A and the ground where it is seen from there.
                    const double exact = -a.reach(oracle::point{-dot(frame.axis[0], up), -dot(frame.axis[1], up),
                                                                -dot(frame.axis[2], up)}) +
                                         double(dot(frame.origin, up)) - cell::number(ground.offset);
                    const closest c = separation(ground, shape, at), m = separation(shape, ground, inverse(at));
                    REQUIRE(std::abs(cell::number(c.distance) - exact) <= allowed);
                    REQUIRE(std::abs(cell::number(m.distance) - exact) <= 2 * allowed);
                    REQUIRE(size(narrow(wide(c.normal) - up)) <= 8 * epsilon);
                    REQUIRE(size(narrow(frame.rotate(wide(m.normal)) + up)) <= 32 * epsilon);
                    REQUIRE(std::abs(double(dot(wide(c.on_a), up)) - cell::number(ground.offset)) <= allowed);
                    REQUIRE(std::abs(a.distance(frame.undo(wide(c.on_b)))) <= allowed);
                    REQUIRE(std::abs(a.distance(wide(m.on_a))) <= allowed);
                    REQUIRE(size(to_reals(c.on_b - c.on_a) - to_reals(c.normal) * cell::number(c.distance)) <= allowed);
                    REQUIRE(size(to_reals(m.on_b - m.on_a) - to_reals(m.normal) * cell::number(m.distance)) <= allowed);
                    gjk_cache cache;
                    REQUIRE(separation(ground, shape, at, cache).distance == c.distance);
                    REQUIRE(distance(ground, shape, at, cache).distance == physics::max(c.distance, S(0)));
                    REQUIRE(distance(shape, ground, inverse(at)).distance == physics::max(m.distance, S(0)));
                    if (std::abs(exact) <= allowed) return;
                    REQUIRE(overlap(ground, shape, at) == (exact < 0));
                    REQUIRE(overlap(shape, ground, inverse(at), cache) == (exact < 0));
                }
            });
        }
}

CELL_CASE("convex shapes: a ball beside a triangle, in all the regions of its corners, edges and faces") {
    const vec corner[] = {from_reals({0, 0, 0}), from_reals({2, 0, 0}), from_reals({0, 1, 0})};
    const triangle t{corner[0], corner[1], corner[2]};
    const double root = std::sqrt(5.0);
    struct region {
        reals at;
        double distance;
        reals nearest;
    };
    std::vector<region> regions{{{-3, -4, 0}, 5, {0, 0, 0}},    {{5, -4, 0}, 5, {2, 0, 0}},
                                {{-3, 5, 0}, 5, {0, 1, 0}},     {{1, -2, 0}, 2, {1, 0, 0}},
                                {{-2, 0.5, 0}, 2, {0, 0.5, 0}}, {{1 + 1 / root, 0.5 + 2 / root, 0}, 1, {1, 0.5, 0}}};
    if (cell::is_3d) {
        for (region& r : regions) r = {r.at + reals{0, 0, 12}, std::hypot(r.distance, 12), r.nearest};
        regions.push_back({{0.5, 0.25, 3}, 3, {0.5, 0.25, 0}});
        regions.push_back({{0.5, 0.25, -0.75}, 0.75, {0.5, 0.25, 0}});
    }
    for (const region& r : regions) {
        const transform at{from_reals(r.at), {}};
        const closest c = separation(t, ball{S(0.25)}, at);
        CHECK(near(cell::number(c.distance), r.distance - 0.25, 8));
        CHECK(near(c.on_a, r.nearest, 16));
        // In the other winding and with a rounding.
        const triangle thick{corner[1], corner[0], corner[2], S(0.5)};
        CHECK(near(cell::number(separation(thick, ball{S(0.25)}, at).distance), r.distance - 0.75, 8));
    }
}

#if CELL_DIMENSION == 3
CELL_CASE("convex shapes: cylinders and cones in places that geometry tells") {
    const auto at = [](double x, double y, double z = 0) { return transform{from_reals({x, y, z}), {}}; };
    const auto is = [](const closest& c, double d) { return near(cell::number(c.distance), d, 32); };
    const cylinder<> drum{S(1), S(0.5), S(0)}, soft{S(1), S(0.5), S(0.25)};
    const ball b{S(0.25)};
    // Off the side, the cap and the rim; from within by the side and by the cap.
    CHECK(is(separation(drum, b, at(0.3, 0, 2)), 1.25));
    CHECK(is(separation(drum, b, at(3, 0.1)), 1.75));
    CHECK(is(separation(drum, b, at(4, 4.5)), 4.75));
    CHECK(is(separation(soft, b, at(4, 4.5)), 4.5));
    CHECK(is(separation(drum, b, at(0, 0.3)), -0.45));
    CHECK(is(separation(drum, b, at(0.9, 0.1)), -0.35));
    // Coaxial, side by side, standing on each other, and lying across.
    CHECK(is(separation(drum, drum, at(5, 0)), 3));
    CHECK(is(separation(drum, drum, at(1.75, 0)), -0.25));
    CHECK(is(separation(drum, drum, at(0.3, 2)), 1));
    CHECK(is(separation(drum, soft, at(0.3, 0.6, 0.8)), -0.25));
    const transform across{from_reals({0, 0, 1.5}), rotation_about({0, 0, 1}, M_PI / 2)};
    CHECK(near(cell::number(separation(drum, drum, across).distance), 0.5, 64));
    // A cone's tip, its side at 45 degrees, and its base.
    const cone<> hat{S(1), S(2), S(0), S(0)};
    CHECK(is(separation(hat, b, at(3, 0)), 1.75));
    CHECK(is(separation(hat, b, at(3, 4)), 3 * std::sqrt(2.0) - 0.25));
    CHECK(is(separation(hat, b, at(-4, 1)), 2.75));
    CHECK(is(separation(hat, b, at(-4, 6)), 4.75));
    CHECK(is(separation(halfspace{from_reals({1, 0, 0}), S(0)}, hat, at(0.5, 0)), -0.5));
    CHECK(is(separation(halfspace{from_reals({-1, 0, 0}), S(0)}, hat, at(-2, 0)), 1));
}
#endif

}  // namespace
