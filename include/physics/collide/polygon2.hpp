// Contact of rounded polygons in the plane: boxes and capsules.
#pragma once

#include "physics/collide/manifold.hpp"
#include "physics/collide/segment.hpp"
#include "physics/shape/shapes.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A convex polygon, counter-clockwise, grown by a radius; edge i leads from vertex i to the next. Two
/// vertices make a segment with two opposite edges.
template <class S>
struct rounded_polygon {
    vec<S, 2> vertex[4];
    vec<S, 2> normal[4];
    int count = 0;
    S radius{};
    S size{};

    constexpr int next(int i) const { return i + 1 < count ? i + 1 : 0; }
};

template <class S>
constexpr rounded_polygon<S> polygon_of(const box<S, 2>& b, const transform<S, 2>& at) {
    const mat<S, 2> m = matrix(at.rotation);
    const vec<S, 2> x = m.column[0] * b.half_extents.x, y = m.column[1] * b.half_extents.y, p = at.position;
    return {{p - x - y, p + x - y, p + x + y, p - x + y},
            {-m.column[1], m.column[0], m.column[1], -m.column[0]},
            4, S(0), min(b.half_extents.x, b.half_extents.y)};
}
template <class S>
constexpr rounded_polygon<S> polygon_of(const capsule<S, 2>& c, const transform<S, 2>& at) {
    const mat<S, 2> m = matrix(at.rotation);
    const vec<S, 2> x = m.column[0] * c.half_length;
    return {{at.position - x, at.position + x}, {-m.column[1], m.column[1]}, 2, c.radius, c.radius};
}

/// The edge of a from which b lies farthest, and how far.
template <class S>
struct edge_distance {
    int edge = 0;
    S distance{};
};
template <class S>
constexpr edge_distance<S> farthest_edge(const rounded_polygon<S>& a, const rounded_polygon<S>& b) {
    edge_distance<S> best;
    for (int i = 0; i < a.count; ++i) {
        S nearest = dot(a.normal[i], b.vertex[0] - a.vertex[i]);
        for (int j = 1; j < b.count; ++j) nearest = min(nearest, dot(a.normal[i], b.vertex[j] - a.vertex[i]));
        if (i == 0 || nearest > best.distance) best = {i, nearest};
    }
    return best;
}

/// The closest pair of a vertex of one polygon and an edge of the other, for cores that do not overlap;
/// flips where the vertex belongs to a.
template <class S>
constexpr bool collide_nearest(const rounded_polygon<S>& a, const rounded_polygon<S>& b, S margin, manifold<S, 2>& out) {
    vec<S, 2> best_a, best_b;
    wide_of<S> best{};
    std::uint32_t feature = 0;
    bool found = false;
    const auto consider = [&](const rounded_polygon<S>& edges, const rounded_polygon<S>& vertices, bool flip) {
        for (int i = 0; i < edges.count; ++i) {
            const vec<S, 2> from = edges.vertex[i], to = edges.vertex[edges.next(i)];
            for (int j = 0; j < vertices.count; ++j) {
                const vec<S, 2> v = vertices.vertex[j];
                const S t = closest_parameter(from, to, v);
                const vec<S, 2> p = from + (to - from) * t;
                const wide_of<S> distance = length_squared(v - p);
                if (found && !(distance < best)) continue;
                found = true;
                best = distance;
                best_a = flip ? v : p;
                best_b = flip ? p : v;
                feature = 0x10000u | static_cast<std::uint32_t>(i << 8 | j << 4 | int{flip});
            }
        }
    };
    consider(a, b, false);
    consider(b, a, true);
    const auto [direction, gap] = split(best_b - best_a);
    if (!(gap > S(0))) return false;
    if (gap > a.radius + b.radius + margin) return true;
    out.normal = direction;
    add_rounded(out, best_a, a.radius, best_b, b.radius, gap, feature);
    return true;
}

/// Clips the edge of `incident` that faces the reference edge against the reference edge's ends.
template <class S>
constexpr void clip_edges(const rounded_polygon<S>& reference, int edge, const rounded_polygon<S>& incident, bool flip,
                          S margin, manifold<S, 2>& out) {
    const vec<S, 2> n = reference.normal[edge];
    const vec<S, 2> from = reference.vertex[edge], to = reference.vertex[reference.next(edge)];
    int facing = 0;
    for (int i = 1; i < incident.count; ++i)
        if (dot(incident.normal[i], n) < dot(incident.normal[facing], n)) facing = i;

    // Along the reference edge the incident edge runs backwards: its end comes first.
    const vec<S, 2> first = incident.vertex[incident.next(facing)], last = incident.vertex[facing];
    const vec<S, 2> t = normalized(to - from);
    const S length_t = dot(to - from, t), at_first = dot(first - from, t), at_last = dot(last - from, t);
    const S span = at_last - at_first;
    const auto point_at = [&](S at) {
        return span > S(0) ? first + (last - first) * clamp((at - at_first) / span, S(0), S(1)) : first;
    };
    if (at_first > length_t || at_last < S(0)) return;
    const vec<S, 2> ends[2] = {at_first < S(0) ? point_at(S(0)) : first, at_last > length_t ? point_at(length_t) : last};

    out.normal = flip ? -n : n;
    for (int k = 0; k < 2; ++k) {
        const S gap = dot(n, ends[k] - from);
        if (gap - reference.radius - incident.radius > margin) continue;
        const vec<S, 2> on_reference = ends[k] - n * gap;
        // Whether the end is a corner or a cut stays out of the name: of equal boxes it changes with rounding.
        const std::uint32_t feature = static_cast<std::uint32_t>(edge << 12 | facing << 8 | k << 4 | int{flip});
        if (flip) add_rounded(out, ends[k], incident.radius, on_reference, reference.radius, gap, feature);
        else add_rounded(out, on_reference, reference.radius, ends[k], incident.radius, gap, feature);
    }
}

/// Adds the corner of `incident` that lies deepest behind the reference edge.
template <class S>
constexpr void add_corner(const rounded_polygon<S>& reference, int edge, const rounded_polygon<S>& incident, int corner,
                          bool flip, manifold<S, 2>& out) {
    const vec<S, 2> n = reference.normal[edge], v = incident.vertex[corner];
    const S gap = dot(n, v - reference.vertex[edge]);
    const std::uint32_t feature = 0x20000u | static_cast<std::uint32_t>(edge << 8 | corner << 4 | int{flip});
    out.normal = flip ? -n : n;
    if (flip) add_rounded(out, v, incident.radius, v - n * gap, reference.radius, gap, feature);
    else add_rounded(out, v - n * gap, reference.radius, v, incident.radius, gap, feature);
}

}  // namespace detail

/// Contact of two rounded convex polygons: separating axes over the edges, then clipping; nearest features
/// where the cores are apart and a corner leads. The result lies in the frame of a and b's vertices.
template <class S>
constexpr void collide_polygons(const detail::rounded_polygon<S>& a, const detail::rounded_polygon<S>& b, S margin,
                                manifold<S, 2>& out) {
    const S reach = a.radius + b.radius + margin;
    const auto from_a = detail::farthest_edge(a, b);
    if (from_a.distance > reach) return;
    const auto from_b = detail::farthest_edge(b, a);
    if (from_b.distance > reach) return;

    // A preference for a's edge keeps the reference from flipping between two that are alike.
    const S preference = min(a.size, b.size) * S(1.0 / 1024);
    const bool flip = from_b.distance > from_a.distance + preference;
    const auto& reference = flip ? b : a;
    const auto& incident = flip ? a : b;
    const auto chosen = flip ? from_b : from_a;
    const vec<S, 2> n = reference.normal[chosen.edge], from = reference.vertex[chosen.edge];
    int nearest = 0;
    for (int i = 1; i < incident.count; ++i)
        if (dot(n, incident.vertex[i] - incident.vertex[nearest]) < S(0)) nearest = i;

    // Cores apart: an edge's normal is the direction of least distance only where the nearest corner lies
    // beside the edge, which a corner against a corner does not.
    if (chosen.distance > S(0) || (a.count == 2 && b.count == 2 && chosen.distance == S(0))) {
        const vec<S, 2> along = reference.vertex[reference.next(chosen.edge)] - from;
        const wide_of<S> at = wide_dot(incident.vertex[nearest] - from, along);
        const bool beside = !(at < wide_of<S>{}) && !(at > length_squared(along));
        if (!beside) {
            // Parallel edges still touch along a line; two points keep such a pair from rocking.
            detail::clip_edges(reference, chosen.edge, incident, flip, margin, out);
            if (out.count == 2 && abs(out.points[0].separation - out.points[1].separation) <= preference) return;
            out.count = 0;
            if (detail::collide_nearest(a, b, margin, out)) return;
        }
    }
    detail::clip_edges(reference, chosen.edge, incident, flip, margin, out);
    // Where rounding puts the facing edge beside the reference edge, its deepest corner remains.
    if (out.count == 0) detail::add_corner(reference, chosen.edge, incident, nearest, flip, out);
}

PHYSICS_HPP_END
