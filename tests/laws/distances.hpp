// The slow, obviously right twin of the narrowphase: signed distances in double, and what they say of a manifold.
#pragma once

#include <cstdio>
#include <string>

#include "figures.hpp"

// Which policy the laws hold for.
#ifndef CELL_NARROWPHASE
#define CELL_NARROWPHASE physics::best_per_pair
#endif

namespace {

using manifold = physics::manifold<S, D>;

/// A pair of shapes to collide: B as seen from A.
struct encounter {
    any_shape a, b;
    transform b_in_a;
    S margin;
};

inline manifold collide(const encounter& e) {
    using query = physics::narrowphase_query<S, D, physics::ball, physics::capsule, physics::box, physics::halfspace>;
    const query q{&e.a, &e.b, e.b_in_a};
    physics::manifold_list<S, D> found;
    CELL_NARROWPHASE::in<S, D, physics::ball, physics::capsule, physics::box, physics::halfspace>::collide(
        &q, 1, e.margin, found);
    return found.empty() ? manifold{} : found[0].contact;
}

/// How far apart A and B are along a unit vector from A to B; negative where they overlap. The signed
/// distance is the largest of these over all directions.
inline double separation_along(const figure& a, const figure& b, const pose& at, reals n) {
    if (b.endless)
        return dot(at.rotate(b.normal), n) < -1 + 1e-6 ? -dot(at.origin, at.rotate(b.normal)) - b.offset - a.reach(n)
                                                       : -HUGE_VAL;
    if (a.endless)
        return dot(a.normal, n) > 1 - 1e-6 ? dot(at.origin, a.normal) - a.offset - b.reach(at.unrotate(n)) : -HUGE_VAL;
    return dot(at.origin, n) - a.reach(n) - b.reach(at.unrotate(n));
}

/// The distance of the segment p-q and the box |x_i| <= half_i: convex along the segment, so a golden
/// section finds its minimum.
inline double segment_to_box(reals p, reals q, const figure& core) {
    const auto at = [&](double t) { return std::fmax(0, core.distance(p + (q - p) * t)); };
    const double ratio = (std::sqrt(5.0) - 1) / 2;
    double low = 0, high = 1, x = 1 - ratio, y = ratio, at_x = at(x), at_y = at(y);
    for (int i = 0; i < 76; ++i) {
        if (at_x < at_y) {
            high = y, y = x, at_y = at_x;
            x = high - ratio * (high - low), at_x = at(x);
        } else {
            low = x, x = y, at_x = at_y;
            y = low + ratio * (high - low), at_y = at(y);
        }
    }
    return std::fmin(std::fmin(at(0), at(1)), std::fmin(at_x, at_y));
}

/// The least distance of the edges of one box from the other box; zero if one of them enters it.
template <class ToOther>
double edges_to_box(reals half, const figure& other, ToOther&& to_other) {
    double least = HUGE_VAL;
    for (int along = 0; along < D; ++along) {
        if (half[along] == 0 && along > 0) continue;
        for (int corner = 0; corner < (1 << D); ++corner) {
            reals p;
            bool skip = (corner >> along & 1) != 0;
            for (int i = 0; i < D; ++i) {
                p[i] = corner >> i & 1 ? half[i] : -half[i];
                skip = skip || ((corner >> i & 1) != 0 && half[i] == 0);
            }
            if (skip) continue;
            reals q = p;
            q[along] = half[along];
            least = std::fmin(least, segment_to_box(to_other(p), to_other(q), other));
        }
    }
    return least;
}

/// The signed distance of A and B: how far apart they are, or minus the least way to part them.
inline double signed_distance(const figure& a, const figure& b, const pose& at) {
    if (a.endless) return separation_along(a, b, at, a.normal);
    if (b.endless) return separation_along(a, b, at, -at.rotate(b.normal));
    // Apart: the closest points lie on an edge of one of the cores, a corner counting as an edge.
    figure core_a = a, core_b = b;
    core_a.radius = core_b.radius = 0;
    const double apart = std::fmin(edges_to_box(a.half, core_b, [&](reals p) { return at.undo(p); }),
                                   edges_to_box(b.half, core_a, [&](reals p) { return at.apply(p); }));
    // Overlapping: the nearest face of the Minkowski difference has the normal of a face of one of them, or
    // is made of two edges.
    double best = -HUGE_VAL;
    const auto consider = [&](reals n) {
        if (!(size(n) > 1e-12)) return;
        n = unit(n);
        best = std::fmax(best, separation_along(core_a, core_b, at, n));
        best = std::fmax(best, separation_along(core_a, core_b, at, -n));
    };
    const pose frame;
    for (int i = 0; i < D; ++i) {
        consider(frame.axis[i]);
        consider(at.axis[i]);
        for (int j = 0; j < D && cell::is_3d; ++j) consider(cross(frame.axis[i], at.axis[j]));
    }
    // The search above ends a hair from zero where the cores cross.
    const bool cross_over = best <= 0 && apart <= 1e-14 * (core_a.largest() + core_b.largest());
    return (cross_over ? best : apart) - a.radius - b.radius;
}

/// What the narrowphase may deviate by on purpose, so that contacts at rest keep their features: 1/256 of the
/// smallest size where flat sides meet, nothing elsewhere.
inline double deliberate(const encounter& e, const figure& a, const figure& b) {
    const bool flat = e.a.kind() > 0 && e.b.kind() > 0 && e.a.kind() < 3 && e.b.kind() < 3;
    return flat ? std::fmin(a.smallest(), b.smallest()) / 256 : 0;
}
/// How much rounding may cost: the sizes of the shapes and of what they are computed from decide.
inline double rounding(const encounter& e, const figure& a, const figure& b) {
    double reach = a.largest() + b.largest() + size(to_reals(e.b_in_a.position));
    if (a.endless) reach += std::abs(a.offset);
    if (b.endless) reach += std::abs(b.offset);
    return 32 * std::fmax(epsilon, 1e-15) * (reach + (cell::is_fixed ? 1 : 0));
}

/// The distance of a point from the surface of the balls at the corners of a shape.
inline double ball_distance(const figure& f, reals p) {
    double least = HUGE_VAL;
    for (int corner = 0; corner < 8; ++corner) {
        reals c = f.half;
        for (int i = 0; i < 3; ++i)
            if (corner >> i & 1) c[i] = -c[i];
        const double distance = size(p - c) - f.radius;
        if (std::abs(distance) < std::abs(least)) least = distance;
    }
    return least;
}

inline std::string text_of(const char* what, double x, double y) {
    char text[160];
    std::snprintf(text, sizeof text, "%s: %.12g, %.12g", what, x, y);
    return text;
}
inline std::string text_of(const char* name, const figure& f) {
    char text[200];
    std::snprintf(text, sizeof text, "%s: half (%.9g, %.9g, %.9g), radius %.9g, normal (%.9g, %.9g, %.9g), offset %.9g",
                  name, f.half.x, f.half.y, f.half.z, f.radius, f.normal.x, f.normal.y, f.normal.z, f.offset);
    return text;
}
inline std::string text_of(const encounter& e) {
    std::string text = text_of("\nA", to_figure(e.a)) + text_of("\nB", to_figure(e.b)) + "\nB in A:";
    const reals p = to_reals(e.b_in_a.position);
    std::vector<double> numbers{p.x, p.y, p.z};
    for (const S part : parts_of(e.b_in_a.rotation)) numbers.push_back(cell::number(part));
    numbers.push_back(cell::number(e.margin));
    for (const double x : numbers) {
        char part[40];
        std::snprintf(part, sizeof part, " %.17g", x);
        text += part;
    }
    return text;
}

inline double deepest(const manifold& m) {
    double least = HUGE_VAL;
    for (int i = 0; i < m.count; ++i) least = std::fmin(least, cell::number(m.points[i].separation));
    return least;
}

/// The first law that a manifold breaks; empty if it keeps them all.
inline std::string broken_law(const encounter& e, const manifold& m) {
    const figure a = to_figure(e.a), b = to_figure(e.b);
    const pose at = to_pose(e.b_in_a);
    const double margin = cell::number(e.margin), exact = signed_distance(a, b, at);
    const double tolerance = rounding(e, a, b), allowed = tolerance + deliberate(e, a, b);
    if (m.count < 0 || m.count > manifold::capacity) return text_of("count", m.count, 0);
    if (exact > margin + allowed && m.count > 0) return text_of("a contact beyond the margin", exact, margin);
    if (exact < margin - allowed && m.count == 0) return text_of("a contact is missing", exact, margin);
    if (m.count == 0) return "";

    const reals n = to_reals(m.normal);
    if (!(std::abs(size(n) - 1) <= 32 * epsilon)) return text_of("the normal is no unit vector", size(n), 0);
    const double along = separation_along(a, b, at, unit(n));
    if (!(std::abs(along - exact) <= allowed))
        return text_of("the normal parts them worse than it could", along, exact);
    // A round side that lies nearly flat is taken for flat.
    const bool lies = deliberate(e, a, b) > 0;
    const double round_a = lies ? a.radius / 256 : 0, round_b = lies ? b.radius / 256 : 0;
    for (int i = 0; i < m.count; ++i) {
        const double gap = cell::number(m.points[i].separation);
        if (!(gap <= margin + tolerance)) return text_of("a point beyond the margin", gap, margin);
        const reals p = to_reals(m.points[i].position);
        double from_a = a.distance(p - n * (gap / 2)), from_b = b.distance(at.undo(p + n * (gap / 2)));
        // On a halfspace it is the balls at a capsule's ends that touch.
        if (b.endless) from_a = ball_distance(a, p - n * (gap / 2));
        if (a.endless) from_b = ball_distance(b, at.undo(p + n * (gap / 2)));
        if (!(std::abs(from_a) <= allowed + round_a))
            return text_of("half the gap from a point is not the surface of A", from_a, gap);
        if (!(std::abs(from_b) <= allowed + round_b))
            return text_of("half the gap from a point is not the surface of B", from_b, gap);
        for (int k = 0; k < i; ++k)
            if (m.points[k].feature == m.points[i].feature) return text_of("two points of one feature", k, i);
    }
    if (!(std::abs(deepest(m) - exact) <= allowed))
        return text_of("the deepest point is not the signed distance", deepest(m), exact);
    return "";
}
/// The same, with the pair; for messages.
inline std::string complaint(const encounter& e) {
    const manifold m = collide(e);
    const std::string law = broken_law(e, m);
    if (law.empty()) return law;
    std::string text = law + text_of(e);
    text += text_of("\nnormal", cell::number(m.normal[0]), cell::number(m.normal[1]));
    for (int i = 0; i < m.count && i < manifold::capacity; ++i) {
        const reals p = to_reals(m.points[i].position);
        text += text_of("\n  point", p.x, p.y) + text_of(", ", p.z, cell::number(m.points[i].separation));
    }
    return text;
}

}  // namespace
