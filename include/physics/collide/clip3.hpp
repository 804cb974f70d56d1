// The faces of two boxes in space, clipped to what they share.
#pragma once

#include "physics/collide/reduce3.hpp"

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

/// Clips the face of `incident` that faces a face of `reference` to the latter's sides, seen along the unit vector
/// n, and adds what is left within the margin. All in one frame; n points out of the reference face, at which it
/// may lean, sign tells which of the two faces across the axis is meant, gap is how far n parts the boxes. False,
/// with nothing added, if the point in which n finds `incident` closest was cut off: then the boxes do not touch
/// face to face.
template <class S>
constexpr bool clip_faces(const oriented_box<S>& reference, int axis, S sign, vec<S, 3> n, S gap,
                          const oriented_box<S>& incident, bool flip, S slack, S margin, manifold<S, 3>& out) {
    const vec<S, 3> up = reference.axis(axis) * sign;
    const vec<S, 3> facing = transposed_times(incident.axes, up);
    int across = 0;
    // A lower number wins unless another face is clearly better, so that rounding does not choose.
    for (int i = 1; i < 3; ++i)
        if (abs(facing[i]) > abs(facing[across]) + S(1.0 / 1024)) across = i;
    const S side = facing[across] > S(0) ? S(-1) : S(1);
    const int u = across == 2 ? 0 : across + 1, v = across == 0 ? 2 : across - 1;
    const vec<S, 3> middle =
        incident.center - reference.center + incident.axis(across) * (incident.half[across] * side);
    const vec<S, 3> du = incident.axis(u) * incident.half[u], dv = incident.axis(v) * incident.half[v];

    clip_polygon<S> face;
    face.count = 4;
    face.corners[0] = {middle + du + dv, 3, 0};
    face.corners[1] = {middle - du + dv, 0, 1};
    face.corners[2] = {middle - du - dv, 1, 2};
    face.corners[3] = {middle + du - dv, 2, 3};
    const S top = reference.half[axis], steep = S(1) / dot(n, up);
    std::uint32_t plane = 4;
    for (int i = 0; i < 3; ++i) {
        if (i == axis) continue;
        const S lean = dot(reference.axis(i), n) * steep;
        const vec<S, 3> a = reference.axis(i) - up * lean;
        // A little beyond the face, so that rounding does not decide whether the corners of equal boxes are
        // cut, and named anew, in each step.
        const S edge = reference.half[i] + slack;
        face = clipped(face, a, edge - lean * top, plane++);
        face = clipped(face, -a, edge + lean * top, plane++);
    }

    const std::uint32_t faces = static_cast<std::uint32_t>(axis << 1 | int{sign > S(0)}) << 12 |
                                static_cast<std::uint32_t>(across << 1 | int{side > S(0)}) << 8 |
                                static_cast<std::uint32_t>(flip) << 16;
    manifold_point<S, 3> candidates[8];
    int count = 0;
    const S most = gap + slack + slack;
    S deepest = most + slack;
    for (int i = 0; i < face.count; ++i) {
        const auto& corner = face.corners[i];
        const S separation = (dot(up, corner.position) - top) * steep;
        deepest = min(deepest, separation);
        if (separation > margin) continue;
        candidates[count++] = {reference.center + corner.position - n * (separation * S(0.5)), separation,
                               faces | corner.before << 4 | corner.after};
    }
    if (deepest > most) return false;
    out.normal = flip ? -n : n;
    reduce(candidates, count, n, slack, out);
    return true;
}

}  // namespace detail

PHYSICS_HPP_END
