// Contact of rounded polygons in 2D: boxes, capsules, small hulls.
#pragma once

#include "physics/base/lane_math.hpp"
#include "physics/collide/manifold.hpp"
#include "physics/collide/segment.hpp"
#include "physics/shape/shapes.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A convex polygon, counter-clockwise, grown by a radius; edge i leads from vertex i to the next. Two
/// vertices make a segment with two opposite edges. N: room for vertices, 4 or 8.
template <class S, int N = 4>
struct rounded_polygon {
    /// Vertices and the normals of edges, in rows that are filled up with the last ones.
    S vertices[2][N];
    S normals[2][N];
    int count = 0;
    S radius{};
    S size{};

    PHYSICS_HPP_ALWAYS_INLINE vec<S, 2> vertex(int i) const { return {vertices[0][i], vertices[1][i]}; }
    PHYSICS_HPP_ALWAYS_INLINE vec<S, 2> normal(int i) const { return {normals[0][i], normals[1][i]}; }
    PHYSICS_HPP_ALWAYS_INLINE int next(int i) const { return i + 1 < count ? i + 1 : 0; }
    PHYSICS_HPP_ALWAYS_INLINE void set(int i, vec<S, 2> vertex, vec<S, 2> normal) {
        vertices[0][i] = vertex.x;
        vertices[1][i] = vertex.y;
        normals[0][i] = normal.x;
        normals[1][i] = normal.y;
    }
    PHYSICS_HPP_ALWAYS_INLINE void fill_up() {
        for (int i = count; i < N; ++i) set(i, vertex(count - 1), normal(count - 1));
    }

    /// As many edges as are looked at together.
    static constexpr int width = native_width<S> < N ? native_width<S> : N;
    using lanes = pack<S, width>;
    /// Calls f(first, x, y) for groups of edges with their normals.
    template <class F>
    PHYSICS_HPP_ALWAYS_INLINE void each_normals(F&& f) const {
        for (int i = 0; i < count; i += width) f(i, lanes::load(normals[0] + i), lanes::load(normals[1] + i));
    }
};

template <int N = 4, class S>
rounded_polygon<S, N> polygon_of(const box<S, 2>& b, const transform<S, 2>& at) {
    const mat<S, 2> m = matrix(at.rotation);
    const vec<S, 2> x = m.column[0] * b.half_extents.x, y = m.column[1] * b.half_extents.y, p = at.position;
    rounded_polygon<S, N> result;
    result.set(0, p - x - y, -m.column[1]);
    result.set(1, p + x - y, m.column[0]);
    result.set(2, p + x + y, m.column[1]);
    result.set(3, p - x + y, -m.column[0]);
    result.count = 4;
    result.size = min(b.half_extents.x, b.half_extents.y);
    result.fill_up();
    return result;
}
template <int N = 4, class S>
rounded_polygon<S, N> polygon_of(const capsule<S, 2>& c, const transform<S, 2>& at) {
    const mat<S, 2> m = matrix(at.rotation);
    const vec<S, 2> x = m.column[0] * c.half_length;
    rounded_polygon<S, N> result;
    result.set(0, at.position - x, -m.column[1]);
    result.set(1, at.position + x, m.column[1]);
    result.count = 2;
    result.radius = result.size = c.radius;
    result.fill_up();
    return result;
}
/// In its own frame.
template <int N = 4, class Shape>
auto polygon_of(const Shape& shape) {
    return polygon_of<N>(shape, {});
}

/// The edge of a from which b lies farthest, and how far.
template <class S>
struct edge_distance {
    int edge = 0;
    S distance{};
};
template <class S, int N>
edge_distance<S> farthest_edge(const rounded_polygon<S, N>& a, const rounded_polygon<S, N>& b) {
    using P = typename rounded_polygon<S, N>::lanes;
    S distances[N] = {};
    a.each_normals([&](int first, const P& x, const P& y) {
        const P from_x = P::load(a.vertices[0] + first), from_y = P::load(a.vertices[1] + first);
        const auto height = [&](int j) {
            return lane_sum(x, P::broadcast(b.vertices[0][j]) - from_x, y, P::broadcast(b.vertices[1][j]) - from_y);
        };
        P nearest = height(0);
        for (int j = 1; j < b.count; ++j) nearest = min(nearest, height(j));
        nearest.store(distances + first);
    });
    edge_distance<S> best{0, distances[0]};
    for (int i = 1; i < a.count; ++i)
        if (distances[i] > best.distance) best = {i, distances[i]};
    return best;
}
/// The edge of a that faces a unit vector most. A lower number wins unless another edge is clearly better, so that
/// rounding does not choose.
template <class S, int N>
int facing_edge(const rounded_polygon<S, N>& a, vec<S, 2> n) {
    using P = typename rounded_polygon<S, N>::lanes;
    S along[N] = {};
    a.each_normals([&](int first, const P& x, const P& y) {
        lane_sum(x, P::broadcast(n.x), y, P::broadcast(n.y)).store(along + first);
    });
    int facing = 0;
    for (int i = 1; i < a.count; ++i)
        if (along[i] < along[facing] - S(1.0 / 1024)) facing = i;
    return facing;
}
/// How far apart the cores are along a unit vector from a to b.
template <class S, int N>
S distance_along(const rounded_polygon<S, N>& a, const rounded_polygon<S, N>& b, vec<S, 2> n) {
    S last = dot(n, a.vertex(0)), first = dot(n, b.vertex(0));
    for (int i = 1; i < a.count; ++i) last = max(last, dot(n, a.vertex(i)));
    for (int i = 1; i < b.count; ++i) first = min(first, dot(n, b.vertex(i)));
    return first - last;
}

/// Clips the edge of `incident` that faces the reference edge to the length of the latter, and adds the ends
/// that are left. False, with nothing added, if the point in which the edge finds `incident` closest was cut
/// off: then the edge's normal is not the direction of least distance.
template <class S, int N>
bool clip_edges(const rounded_polygon<S, N>& reference, edge_distance<S> found, const rounded_polygon<S, N>& incident,
                bool flip, S slack, S margin, manifold<S, 2>& out) {
    const int edge = found.edge;
    const vec<S, 2> n = reference.normal(edge), t{-n.y, n.x}, from = reference.vertex(edge);
    const int facing = facing_edge(incident, n);

    // Along the reference edge the incident edge runs backwards: its end comes first.
    const vec<S, 2> first = incident.vertex(incident.next(facing)) - from, last = incident.vertex(facing) - from;
    const S at_first = dot(first, t), at_last = dot(last, t), span = at_last - at_first;
    // Reference ends are a little farther out, so that rounding does not cut the corners of equal boxes.
    const S low = -slack, high = dot(reference.vertex(reference.next(edge)) - from, t) + slack;
    if (at_first > high || at_last < low) return false;
    const auto point_at = [&](S at) {
        return span > S(0) ? first + (last - first) * clamp((at - at_first) / span, S(0), S(1)) : first;
    };
    const vec<S, 2> ends[2] = {at_first < low ? point_at(low) : first, at_last > high ? point_at(high) : last};
    const S gaps[2] = {dot(n, ends[0]), dot(n, ends[1])};
    const int deeper = gaps[1] < gaps[0] ? 1 : 0;
    if (gaps[deeper] > found.distance + slack + slack) return false;
    // A round edge leads its surface along its own normal: beyond five degrees of tilt only the deeper end touches.
    const bool flat = !(incident.radius > S(0)) || dot(incident.normal(facing), n) < S(-1 + 1.0 / 256);

    out.normal = flip ? -n : n;
    for (int k = 0; k < 2; ++k) {
        if (gaps[k] - reference.radius - incident.radius > margin || (k != deeper && !flat)) continue;
        const vec<S, 2> on_incident = from + ends[k], on_reference = on_incident - n * gaps[k];
        // Whether the end is a corner or a cut stays out of the name: of equal boxes it changes with rounding.
        const std::uint32_t feature = static_cast<std::uint32_t>(edge << 12 | facing << 8 | k << 4 | int{flip});
        if (flip) add_rounded(out, on_incident, incident.radius, on_reference, reference.radius, gaps[k], feature);
        else add_rounded(out, on_reference, reference.radius, on_incident, incident.radius, gaps[k], feature);
    }
    return true;
}

/// Adds the closest pair of a vertex of one polygon and an edge or vertex of the other; of cores that overlap, how
/// deep. `parting` is the best of the edges' normals, from a to b, and `axis_gap` how far it parts the cores.
template <class S, int N>
void collide_nearest(const rounded_polygon<S, N>& a, const rounded_polygon<S, N>& b, vec<S, 2> parting, S axis_gap,
                     S rounding, S margin, manifold<S, 2>& out) {
    vec<S, 2> on_a, on_b;
    wide_of<S> best{};
    std::uint32_t feature = 0;
    for (int flip = 0; flip < 2; ++flip) {
        const rounded_polygon<S, N>& edges = flip ? b : a;
        const rounded_polygon<S, N>& vertices = flip ? a : b;
        for (int i = 0; i < edges.count; ++i) {
            const vec<S, 2> from = edges.vertex(i), to = edges.vertex(edges.next(i));
            for (int j = 0; j < vertices.count; ++j) {
                const vec<S, 2> v = vertices.vertex(j);
                const S t = closest_parameter(from, to, v);
                const vec<S, 2> p = t < S(1) ? from + (to - from) * t : to;
                const wide_of<S> distance = length_squared(v - p);
                if (feature != 0 && !(distance < best)) continue;
                best = distance;
                on_a = flip ? v : p;
                on_b = flip ? p : v;
                // Two vertices have one name, whichever edge found them.
                const bool inside = t > S(0) && t < S(1);
                const int vertex = t > S(0) ? edges.next(i) : i;
                feature = static_cast<std::uint32_t>(inside ? 0x20000 | i << 8 | j << 4 | flip
                                                            : 0x10000 | (flip ? j << 4 | vertex : vertex << 4 | j));
            }
        }
    }
    auto [n, gap] = direction_and_length_of(on_b - on_a);
    // Of points that all but coincide the direction is chance; where cores overlap, another vertex may be near.
    if (!(gap > S(0)) || axis_gap < S(0) || distance_along(a, b, n) < axis_gap - rounding) {
        n = parting;
        gap = axis_gap;
    }
    if (gap - a.radius - b.radius > margin) return;
    out.normal = n;
    add_rounded(out, on_a, a.radius, on_b, b.radius, gap, feature);
}

}  // namespace detail

/// Contact of two rounded convex polygons: separating axes over the edges and clipping, or the nearest features
/// where a corner meets a corner. The result lies in the frame of a and b's vertices. To keep the features of
/// bodies at rest, contacts may deviate by 1/512 of the smaller size, never more.
template <class S, int N>
void collide_polygons(const detail::rounded_polygon<S, N>& a, const detail::rounded_polygon<S, N>& b, S margin,
                      manifold<S, 2>& out) {
    const S reach = a.radius + b.radius + margin;
    const auto from_a = detail::farthest_edge(a, b);
    if (from_a.distance > reach) return;
    const auto from_b = detail::farthest_edge(b, a);
    if (from_b.distance > reach) return;

    // A preference for a's edge keeps the reference from flipping between two that are alike.
    const S rounding = detail::rounding_of(largest(a.vertex(0)) + largest(b.vertex(0)));
    const S slack = max(min(a.size, b.size) * S(1.0 / 1024), rounding);
    const bool better_b = from_b.distance > from_a.distance;
    if (!(from_b.distance > from_a.distance + slack + slack) &&
        detail::clip_edges(a, from_a, b, false, slack, margin, out))
        return;
    if (better_b && detail::clip_edges(b, from_b, a, true, slack, margin, out)) return;
    detail::collide_nearest(a, b, better_b ? -b.normal(from_b.edge) : a.normal(from_a.edge),
                            better_b ? from_b.distance : from_a.distance, rounding, margin, out);
}

PHYSICS_HPP_END
