// Contact of two boxes in space: separating axes, then clipping or a pair of edges.
#pragma once

#include "physics/collide/manifold.hpp"
#include "physics/collide/reduce3.hpp"
#include "physics/collide/segment.hpp"
#include "physics/shape/shapes.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A box by its centre, unit axes and half extents.
template <class S>
struct oriented_box {
    vec<S, 3> center;
    mat<S, 3> axes;
    vec<S, 3> half;

    constexpr vec<S, 3> axis(int i) const { return axes.column[i]; }
    /// Half of the box's extent along a direction.
    constexpr S reach(vec<S, 3> n) const { return dot(abs(transposed_times(axes, n)), half); }
};

/// Corners of a face being clipped; each remembers the two planes that it lies between.
template <class S>
struct clip_polygon {
    struct corner {
        vec<S, 3> position;
        std::uint32_t before, after;
    };
    corner corners[8];
    int count = 0;
};

/// Cuts off what lies beyond the plane. Source: Sutherland, Hodgman, Reentrant polygon clipping (1974).
template <class S>
constexpr clip_polygon<S> clipped(const clip_polygon<S>& in, vec<S, 3> normal, S offset, std::uint32_t plane) {
    clip_polygon<S> out;
    for (int i = 0; i < in.count; ++i) {
        const auto& a = in.corners[i];
        const auto& b = in.corners[i + 1 < in.count ? i + 1 : 0];
        const S da = dot(normal, a.position) - offset, db = dot(normal, b.position) - offset;
        const bool keep_a = !(da > S(0)), keep_b = !(db > S(0));
        if (keep_a && out.count < 8) out.corners[out.count++] = a;
        if (keep_a != keep_b && out.count < 8) {
            const vec<S, 3> cut = a.position + (b.position - a.position) * (da / (da - db));
            out.corners[out.count++] = keep_a ? typename clip_polygon<S>::corner{cut, a.after, plane}
                                              : typename clip_polygon<S>::corner{cut, plane, b.before};
        }
    }
    return out;
}

/// Clips the face of `incident` that faces the reference face against the reference face's sides. All in
/// one frame; sign tells which of the two faces across the axis is meant.
template <class S>
constexpr void clip_faces(const oriented_box<S>& reference, int axis, S sign, const oriented_box<S>& incident, bool flip,
                          S margin, manifold<S, 3>& out) {
    const vec<S, 3> n = reference.axis(axis) * sign;
    const vec<S, 3> facing = transposed_times(incident.axes, n);
    int across = 0;
    for (int i = 1; i < 3; ++i)
        if (abs(facing[i]) > abs(facing[across])) across = i;
    const S side = facing[across] > S(0) ? S(-1) : S(1);
    const int u = across == 2 ? 0 : across + 1, v = across == 0 ? 2 : across - 1;
    const vec<S, 3> middle = incident.center + incident.axis(across) * (incident.half[across] * side);
    const vec<S, 3> du = incident.axis(u) * incident.half[u], dv = incident.axis(v) * incident.half[v];

    clip_polygon<S> face;
    face.count = 4;
    face.corners[0] = {middle + du + dv, 3, 0};
    face.corners[1] = {middle - du + dv, 0, 1};
    face.corners[2] = {middle - du - dv, 1, 2};
    face.corners[3] = {middle + du - dv, 2, 3};
    std::uint32_t plane = 4;
    for (int i = 0; i < 3; ++i) {
        if (i == axis) continue;
        const vec<S, 3> a = reference.axis(i);
        const S c = dot(a, reference.center);
        // A little beyond the face, so that rounding does not decide whether the corners of equal boxes are
        // cut, and named anew, in each step.
        const S edge = reference.half[i] + min(reference.half[i], min(incident.half[u], incident.half[v])) * S(1.0 / 256);
        face = clipped(face, a, c + edge, plane++);
        face = clipped(face, -a, edge - c, plane++);
    }

    const S top = dot(n, reference.center) + reference.half[axis];
    const std::uint32_t faces = static_cast<std::uint32_t>(axis << 1 | int{sign > S(0)}) << 12 |
                                static_cast<std::uint32_t>(across << 1 | int{side > S(0)}) << 8 |
                                static_cast<std::uint32_t>(flip) << 16;
    out.normal = flip ? -n : n;
    manifold_point<S, 3> candidates[8];
    int count = 0;
    for (int i = 0; i < face.count; ++i) {
        const auto& corner = face.corners[i];
        const S gap = dot(n, corner.position) - top;
        if (gap > margin) continue;
        candidates[count++] = {corner.position - n * (gap * S(0.5)), gap, faces | corner.before << 4 | corner.after};
    }
    reduce(candidates, count, n, out);
}

/// The middle of the edge of a box that lies farthest along n, among the edges along one axis.
template <class S>
constexpr vec<S, 3> supporting_edge(const oriented_box<S>& b, int along, vec<S, 3> n, std::uint32_t& name) {
    vec<S, 3> p = b.center;
    name = static_cast<std::uint32_t>(along);
    for (int i = 0; i < 3; ++i) {
        if (i == along) continue;
        const bool positive = dot(b.axis(i), n) > S(0);
        p += b.axis(i) * (positive ? b.half[i] : -b.half[i]);
        name = name << 1 | std::uint32_t{positive};
    }
    return p;
}

}  // namespace detail

/// Contact of two boxes: 15 separating axes, then face clipping with reduction to four points, or one point
/// between two edges. Source: Gottschalk, Lin, Manocha, OBBTree (1996), section 5.
template <class S>
constexpr void collide(const box<S, 3>& shape_a, const box<S, 3>& shape_b, const transform<S, 3>& b_in_a, S margin,
                       manifold<S, 3>& out) {
    const detail::oriented_box<S> a{{}, mat<S, 3>::identity(), shape_a.half_extents};
    const detail::oriented_box<S> b{b_in_a.position, matrix(b_in_a.rotation), shape_b.half_extents};
    const vec<S, 3> offset = b.center;

    S best_a = S(0), best_b = S(0);
    int axis_a = 0, axis_b = 0;
    for (int i = 0; i < 3; ++i) {
        const S gap = abs(offset[i]) - a.half[i] - b.reach(a.axis(i));
        if (gap > margin) return;
        if (i == 0 || gap > best_a) best_a = gap, axis_a = i;
    }
    const vec<S, 3> offset_in_b = transposed_times(b.axes, offset);
    for (int i = 0; i < 3; ++i) {
        const S gap = abs(offset_in_b[i]) - b.half[i] - dot(abs(b.axis(i)), a.half);
        if (gap > margin) return;
        if (i == 0 || gap > best_b) best_b = gap, axis_b = i;
    }
    S best_edge = S(0);
    int edge_a = -1, edge_b = 0;
    vec<S, 3> edge_normal;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const vec<S, 3> across = cross(a.axis(i), b.axis(j));
            const S size = length(across);
            // Within 0.06 degrees of parallel a face says the same.
            if (size < S(1.0 / 1024)) continue;
            const vec<S, 3> n = across / size;
            const S along = dot(n, offset);
            const S gap = abs(along) - dot(abs(n), a.half) - b.reach(n);
            if (gap > margin) return;
            if (edge_a >= 0 && !(gap > best_edge)) continue;
            best_edge = gap;
            edge_a = i;
            edge_b = j;
            edge_normal = along < S(0) ? -n : n;
        }

    // Faces before edges and a before b where they are alike, so that the choice does not flicker.
    const S smallest = min(min(a.half.x, min(a.half.y, a.half.z)), min(b.half.x, min(b.half.y, b.half.z)));
    const S preference = smallest * S(1.0 / 256);
    const bool use_b = best_b > best_a + preference;
    const S best_face = use_b ? best_b : best_a;
    if (edge_a < 0 || best_edge <= best_face + preference) {
        if (use_b) {
            clip_faces(b, axis_b, offset_in_b[axis_b] > S(0) ? S(-1) : S(1), a, true, margin, out);
        } else {
            clip_faces(a, axis_a, offset[axis_a] < S(0) ? S(-1) : S(1), b, false, margin, out);
        }
        if (out.count > 0 || edge_a < 0) return;
    }

    std::uint32_t name_a = 0, name_b = 0;
    const vec<S, 3> pa = detail::supporting_edge(a, edge_a, edge_normal, name_a);
    const vec<S, 3> pb = detail::supporting_edge(b, edge_b, -edge_normal, name_b);
    const vec<S, 3> da = a.axis(edge_a) * a.half[edge_a], db = b.axis(edge_b) * b.half[edge_b];
    const auto closest = closest_points(pa - da, pa + da, pb - db, pb + db);
    const S gap = dot(edge_normal, closest.on_b - closest.on_a);
    if (gap > margin) return;
    out.normal = edge_normal;
    out.add((closest.on_a + closest.on_b) * S(0.5), gap, 0x20000u | name_a << 4 | name_b);
}

PHYSICS_HPP_END
