// Laws of the contacts of convex shapes: what touches flat, along a line, and at a rim.
#pragma once

#include <algorithm>

#include "convex_queries.hpp"

namespace {

using convex_manifold = physics::manifold<S, D>;

inline convex_manifold touch(const convex_encounter& e, double margin) {
    return convex_set::collide<physics::gjk_epa>(e.a.shape, e.b.shape, e.b_in_a, margin);
}
inline double deepest_of(const convex_manifold& m) {
    double least = HUGE_VAL;
    for (int i = 0; i < m.count; ++i) least = std::fmin(least, cell::number(m.points[i].separation));
    return least;
}
inline std::vector<std::uint32_t> feature_list(const convex_manifold& m) {
    std::vector<std::uint32_t> all;
    for (int i = 0; i < m.count; ++i) all.push_back(m.points[i].feature);
    std::sort(all.begin(), all.end());
    return all;
}

/// The first law that a manifold breaks, where `exact` is the signed distance. Contacts at rest may deviate by 1/256
/// of the smaller one's thickness, those that are carried along by `further` (m) more.
inline std::string broken_law(const convex_encounter& e, const convex_manifold& m, double margin, double exact,
                              double further = 0) {
    const oracle::frame at = to_frame(e.b_in_a);
    const double rounding = 64 * std::fmax(epsilon, 1e-11) * e.reach();
    const double allowed = rounding + std::fmin(e.a.thin(), e.b.thin()) / 256 + further;
    if (m.count < 0 || m.count > convex_manifold::capacity) return text_of_pair("count", m.count, 0);
    if (exact > margin + allowed && m.count > 0) return text_of_pair("a contact beyond the margin", exact, margin);
    if (exact < margin - allowed && m.count == 0) return text_of_pair("a contact is missing", exact, margin);
    if (m.count == 0) return "";
    const oracle::point n = wide(m.normal);
    if (!(std::abs(double(size(n)) - 1) <= 32 * epsilon)) return "the normal is no unit vector";
    const double proven = along(e.a, e.b, at, n * (1 / size(n)));
    if (!(std::abs(proven - exact) <= allowed)) return text_of_pair("the normal parts them worse", proven, exact);
    if (!(std::abs(deepest_of(m) - exact) <= allowed))
        return text_of_pair("the deepest is not the distance", deepest_of(m), exact);
    for (int i = 0; i < m.count; ++i) {
        const double gap = cell::number(m.points[i].separation);
        const oracle::point p = wide(m.points[i].position);
        if (!(gap <= margin + rounding)) return text_of_pair("a point beyond the margin", gap, margin);
        // A round side that lies nearly flat is taken for flat.
        const double on_a = e.a.distance(p - n * (gap / 2)), on_b = e.b.distance(at.undo(p + n * (gap / 2)));
        const double lies = (e.a.thin() + e.b.thin()) / 128;
        if (!(std::abs(on_a) <= allowed + lies)) return text_of_pair("a point is not on A", on_a, gap);
        if (!(std::abs(on_b) <= allowed + lies)) return text_of_pair("a point is not on B", on_b, gap);
        for (int k = 0; k < i; ++k)
            if (m.points[k].feature == m.points[i].feature) return "two points of one feature";
    }
    return "";
}

/// By the queries, which have laws of their own; NaN where they end at their limit.
inline double exact_gap(const convex_encounter& e) {
    const closest c = separation_of(e);
    return c.status == physics::query_status::converged ? cell::number(c.distance) : NAN;
}

CELL_CASE("convex shapes: manifolds agree with distances") {
    cell::dice dice(220);
    for (int a = of::ball; a < convex_set::kinds; ++a)
        for (int b = of::ball; b < convex_set::kinds; ++b)
            for (int in = 0; in < meetings; ++in)
                for (int i = 0; i < 6; ++i) {
                    const convex_encounter e = random_encounter(a, b, meeting(in), dice);
                    const double margin = 0.04 * std::fmin(e.a.extent(), e.b.extent());
                    const double exact = exact_gap(e);
                    if (std::isnan(exact)) continue;
                    const std::string law = broken_law(e, touch(e, margin), margin, exact);
                    CHECK_MESSAGE(law.empty(), name_of(meeting(in)) << ": " << law << text_of(e));
                }
}

/// A body at rest on another along y, overlapping a little: how many points it has, and what they span, an area or of
/// two points a length.
struct convex_rest {
    std::string name;
    convex_encounter pair;
    int points;
    double extent;
};
inline convex_body body_of(const halfspace& h) {
    convex_body b;
    b.kind = 0;
    b.shape = h;
    return b;
}
inline std::vector<convex_rest> convex_rests() {
    const double sunk = 1.0 / 1024;
    std::vector<convex_rest> all;
    const auto add = [&](const char* name, const auto& a, const auto& b, double height, int points, double extent,
                         double aside = 0, const rotation& turned_by = {}) {
        const transform at{from_reals({aside, height - sunk, 0}), turned_by};
        all.push_back({name, {body_of(a), body_of(b), at}, points, extent});
    };
    const halfspace ground{};
    const box table{from_reals({3, 0.5, 3})};
    const rounded_box soft{from_reals({0.5, 0.25, 0.5}), S(0.125)};
    const triangle slice{from_reals({-1, 0, -1}), from_reals({1, 0, -1}), from_reals({0, cell::is_2d ? 1 : 0, 1})};
    const segment beam{from_reals({-1, 0, 0}), from_reals({1, 0, 0}), S(0.25)};
    add("a rounded box on the ground", ground, soft, 0.375, cell::is_2d ? 2 : 4, 1);
    add("a rounded box on a table", table, soft, 0.875, cell::is_2d ? 2 : 4, 1);
    add("a beam on the ground", ground, beam, 0.25, 2, 2);
    add("a beam on a table", table, beam, 0.75, 2, 2, 0.5);
    add("a beam on a rounded box", soft, beam, 0.625, 2, 1, 0.125);
    if (cell::is_2d) {
        add("a triangle on the ground", ground, slice, 0, 2, 2);
        add("a triangle on a table", table, slice, 0.5, 2, 2, 1);
        add("a rounded box on a beam", beam, soft, 0.625, 2, 1);
    }
#if CELL_DIMENSION == 3
    {
        const rotation up = rotation_about({0, 0, 1}, M_PI / 2), down = rotation_about({0, 0, 1}, -M_PI / 2);
        const cylinder<> drum{S(0.5), S(0.5), S(0)}, coin{S(1.0 / 64), S(1), S(0)}, pill{S(0.5), S(0.375), S(0.125)};
        const cone<> hat{S(0.5), S(0.75), S(0.25), S(0)}, tip{S(0.5), S(0.5), S(0), S(0)};
        // Four corners of sixteen that lie on a circle span a square.
        const auto square = [](double r) { return 2 * r * r; };
        add("a drum on the ground", ground, drum, 0.5, 4, square(0.5), 0, up);
        add("a drum on a table", table, drum, 1, 4, square(0.5), 1, up);
        add("a table on a drum", drum, box{from_reals({0.5, 3, 3})}, 0, 4, square(0.5));
        all.back().pair.b_in_a = {from_reals({1 - sunk, 0.25, 0.125}), {}};
        add("a drum on a drum", drum, drum, 0, 4, square(0.5));
        all.back().pair.b_in_a = {from_reals({1 - sunk, 0, 0}), {}};
        add("a coin on the ground", ground, coin, 1.0 / 64, 4, square(1), 0, down);
        add("a coin on a table", table, coin, 0.5 + 1.0 / 64, 4, square(1), 0.25, down);
        add("a pill on a table", table, pill, 1.125, 4, square(0.375), 0.25, down);
        add("a drum that lies on the ground", ground, drum, 0.5, 2, 1);
        add("a drum that lies on a table", table, drum, 1, 2, 1, 0.75);
        add("a pill that lies on a table", table, pill, 1, 2, 1, 0.75, rotation_about({0, 1, 0}, 0.5));
        add("drums side by side", drum, drum, 1, 2, 0.75, 0.25);
        add("drums across each other", drum, drum, 1, 1, 0, 0.125, rotation_about({0, 1, 0}, 1));
        add("a hat on the ground", ground, hat, 0.5, 4, square(0.75), 0, up);
        add("a hat on a table", table, hat, 1, 4, square(0.75), 0.5, up);
        add("a hat upside down", table, hat, 1, 4, square(0.25), 0.5, down);
        add("a cone on its tip", table, tip, 1, 1, 0, 0.5, down);
        add("a cone on the ground", ground, tip, 0.5, 4, square(0.5), 0, up);
        // By half of the angle at its tip, whose sine and cosine are 1 and 2 parts of the root of 5.
        const double slope = std::atan2(0.5, 1.0);
        add("a cone that lies on the ground", ground, tip, 0.25 * std::cos(slope), 2, std::sqrt(1.25), 0,
            rotation_about({0, 0, 1}, -slope));
        add("a cone that lies on a table", table, tip, 0.5 + 0.25 * std::cos(slope), 2, std::sqrt(1.25), 0.25,
            rotation_about({0, 0, 1}, -slope));
        add("a sheet on the ground", ground, slice, 0, 3, 2);
        add("a sheet on a table", table, slice, 0.5, 3, 2, 0.5);
        add("a rounded box on a sheet", slice, rounded_box{from_reals({0.125, 0.25, 0.125}), S(0.125)}, 0.375, 4,
            1.0 / 16);
        add("a sheet on its edge", table,
            triangle{from_reals({-1, 0, 0}), from_reals({1, 0, 0}), from_reals({0, 1, 0.125})}, 0.5, 2, 2, 0.5);
        const triangle thick{slice.a, slice.b, slice.c, S(0.125)};
        add("a drum on a thick sheet", thick, cylinder<>{S(0.5), S(0.25), S(0)}, 0.625, 4, square(0.25), 0, up);
    }
#endif
    return all;
}
/// The area that points around a middle span, or the distance of two.
inline double span_of(const convex_manifold& m) {
    if (m.count < 2) return 0;
    if (m.count == 2) return size(to_reals(m.points[0].position) - to_reals(m.points[1].position));
    // As the order is any: the widest of all ways to go round.
    double most = 0;
    const auto at = [&](int i) { return to_reals(m.points[i].position); };
    const int orders[3][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 1, 3, 2}};
    for (const auto& o : orders) {
        if (m.count == 3) return 0.5 * size(cross(at(1) - at(0), at(2) - at(0)));
        most = std::fmax(most, 0.5 * size(cross(at(o[2]) - at(o[0]), at(o[3]) - at(o[1]))));
    }
    return most;
}

CELL_CASE("convex shapes: what lies flat has points that span what it lies on, and keeps them as it trembles") {
    cell::dice dice(221);
    for (const convex_rest& r : convex_rests()) {
        CAPTURE(r.name);
        const convex_manifold first = touch(r.pair, 0.02);
        CHECK(first.count == r.points);
        CHECK(span_of(first) >= 0.97 * r.extent);
        CHECK(span_of(first) <= 1.03 * r.extent + 1e-3);
        CHECK(std::abs(deepest_of(first) + 1.0 / 1024) <= 1e-4);
        for (int i = 0; i < 100; ++i) {
            convex_encounter e = r.pair;
            const double jitter = i % 2 ? 1e-6 : 1e-5;
            e.b_in_a.position += from_reals(random_direction(dice) * jitter);
            e.b_in_a.rotation = turned(e.b_in_a.rotation, to_angular(random_axis(dice) * jitter));
            const convex_manifold m = touch(e, 0.02);
            CHECK(feature_list(m) == feature_list(first));
            for (int k = 0; k < m.count; ++k)
                for (int j = 0; j < first.count; ++j)
                    if (m.points[k].feature == first.points[j].feature)
                        CHECK(size(to_reals(m.points[k].position) - to_reals(first.points[j].position)) <= 2e-3);
        }
    }
}

CELL_CASE("convex shapes: swapping them mirrors the contact") {
    cell::dice dice(222);
    for (int a = of::ball; a < convex_set::kinds; ++a)
        for (int b = of::ball; b < a; ++b)
            for (int i = 0; i < 60; ++i) {
                const meeting in = meeting(dice.below(meetings));
                const convex_encounter e = random_encounter(a, b, in, dice);
                convex_encounter turned_round{e.b, e.a, inverse(e.b_in_a)};
                // Through the inverse of the inverse, so that both start from the same bits.
                convex_encounter again = e;
                again.b_in_a = inverse(turned_round.b_in_a);
                const convex_manifold n = touch(turned_round, 0.02), m = touch(again, 0.02);
                if (m.count == 0 && n.count == 0) continue;
                const transform at = again.b_in_a;
                CHECK_MESSAGE(m.count == n.count, text_of(e));
                if (m.count != n.count) continue;
                const double allowed = 256 * std::fmax(epsilon, 1e-9) * e.reach();
                // Where they lie in one another, or one within a plate, the opposite way may be as short.
                if (in != meeting::coincident && in != meeting::thin)
                    CHECK_MESSAGE(size(to_reals(m.normal) + to_reals(at.rotation * n.normal)) <= 64 * epsilon + 1e-3,
                                  name_of(in) << text_of(e));
                CHECK(std::abs(deepest_of(m) - deepest_of(n)) <= allowed);
            }
}

#if CELL_DIMENSION == 3
CELL_CASE("convex shapes: rims touch where they are lowest, at every tilt") {
    cell::dice dice(223);
    const convex_body wheels[] = {body_of(cylinder<>{S(1.0 / 64), S(1), S(0)}),
                                  body_of(cylinder<>{S(0.5), S(0.5), S(0)}),
                                  body_of(cone<>{S(0.5), S(1), S(0.25), S(0)})};
    const convex_any grounds[] = {halfspace{}, box{from_reals({9, 1, 9})}};
    for (const convex_body& w : wheels)
        for (const convex_any& ground : grounds)
            for (int i = 0; i < 400; ++i) {
                const double tilt = i % 2 ? dice.number(0, M_PI) : std::pow(10, -dice.number(0, 6));
                // Rolled about its own axis, set up, tilted.
                const rotation rolled = rotation_about({1, 0, 0}, dice.number(-3, 3));
                const rotation r = rotation_about({1, 0, 0}, tilt) * rotation_about({0, 0, 1}, M_PI / 2) * rolled;
                const transform at{{}, normalized(r)};
                const oracle::frame frame = to_frame(at);
                const double lowest = -w.reach({-frame.axis[0].y, -frame.axis[1].y, -frame.axis[2].y});
                const double top = ground.kind() == of::box ? 1 : 0;
                const transform there{from_reals({0, top - lowest - 0.001, 0}), at.rotation};
                const convex_manifold m = convex_set::collide<physics::gjk_epa>(ground, w.shape, there, 0.02);
                REQUIRE(m.count > 0);
                CHECK(std::abs(deepest_of(m) + 0.001) <= w.thin() / 256 + 1e-5);
                CHECK(cell::number(m.normal.y) >= 0.9999);
            }
}

CELL_CASE("convex shapes: a coin that barely tilts keeps a patch, a beam beside a sheet's edge its two ends") {
    cell::dice dice(224);
    const cylinder<> coin{S(1.0 / 64), S(1), S(0)};
    for (const convex_any& ground : {convex_any(halfspace{}), convex_any(box{from_reals({9, 1, 9})})})
        for (int i = 0; i < 50; ++i) {
            const rotation rolled = rotation_about({1, 0, 0}, dice.number(-3, 3));
            const rotation turn = rotation_about({1, 0, 0}, 0.008) * rotation_about({0, 0, 1}, M_PI / 2) * rolled;
            const double top = (ground.kind() == of::box ? 1 : 0) + std::sin(0.008) + std::cos(0.008) / 64 - 0.001;
            const transform at{from_reals({0, top, 0}), normalized(turn)};
            const convex_manifold m = convex_set::collide<physics::gjk_epa>(ground, coin, at, 0.02);
            CHECK(m.count == 4);
            CHECK(span_of(m) >= 1.8);
            CHECK(std::abs(deepest_of(m) + 0.001) <= 1e-4);
        }
    // Seen from the edge of the sheet at 45 degrees, along x, with the sheet in the plane of x and z.
    const convex_body sheet = body_of(triangle{from_reals({-1, 0, 0}), from_reals({1, 0, 0}), from_reals({0, 0, 2})});
    const convex_body beam = body_of(segment{from_reals({-0.5, 0, 0}), from_reals({0.5, 0, 0}), S(0.25)});
    const double off = 0.249 * std::sqrt(0.5);
    const convex_manifold m = touch({sheet, beam, {from_reals({0, off, -off}), {}}}, 0.02);
    CHECK(m.count == 2);
    CHECK(std::abs(span_of(m) - 1) <= 1e-3);
}
#endif

}  // namespace
