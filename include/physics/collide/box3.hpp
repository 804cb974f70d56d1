// Contact of two boxes in space: separating axes, then clipping, a pair of edges, or the nearest corner.
#pragma once

#include "physics/collide/clip3.hpp"
#include "physics/collide/segment.hpp"
#include "physics/shape/shapes.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

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

/// Adds the closest points of an edge of a, which lies at the origin along the coordinate axes, and an edge of b.
/// False, with nothing added, if they are not what the normal found closest.
template <class S>
constexpr bool touch_edges(const oriented_box<S>& a, int edge_a, const oriented_box<S>& b, int edge_b, vec<S, 3> n,
                           S gap, S slack, S margin, manifold<S, 3>& out) {
    std::uint32_t name_a = 0, name_b = 0;
    vec<S, 3> on_a = supporting_edge(a, edge_a, n, name_a), on_b = supporting_edge(b, edge_b, -n, name_b);
    const auto at = closest_to_axis(edge_a, a.half[edge_a], on_b - on_a, b.axis(edge_b), b.half[edge_b]);
    on_a[edge_a] += at.on_a;
    on_b += b.axis(edge_b) * at.on_b;
    if (largest(on_b - on_a - n * gap) > slack) return false;
    out.normal = n;
    if (!(gap > margin)) out.add((on_a + on_b) * S(0.5), gap, 0x20000u | name_a << 4 | name_b);
    return true;
}

/// A corner of one box and the point of another box that is closest to it.
template <class S>
struct corner_distance {
    vec<S, 3> corner;
    /// From the other box to the corner.
    vec<S, 3> direction;
    S gap{};
    std::uint32_t number = 0;
    /// Where the other box is closest: for each axis inside (0), at its lower end (1) or at its upper (2).
    std::uint32_t region[3] = {};
};
template <class S>
constexpr corner_distance<S> closest_corner(const oriented_box<S>& whole, const oriented_box<S>& pointed) {
    corner_distance<S> best;
    vec<S, 3> offset;
    wide_of<S> least{};
    for (std::uint32_t i = 0; i < 8; ++i) {
        vec<S, 3> p = pointed.center - whole.center;
        for (int k = 0; k < 3; ++k) p += pointed.axis(k) * (i >> k & 1u ? pointed.half[k] : -pointed.half[k]);
        const vec<S, 3> local = transposed_times(whole.axes, p);
        const vec<S, 3> beyond = local - max(-whole.half, min(whole.half, local));
        const wide_of<S> distance = length_squared(beyond);
        if (i > 0 && !(distance < least)) continue;
        least = distance;
        offset = beyond;
        best.corner = whole.center + p;
        best.number = i;
    }
    const auto [direction, gap] = split(offset);
    best.direction = whole.axes * direction;
    best.gap = gap;
    for (int k = 0; k < 3; ++k) best.region[k] = offset[k] > S(0) ? 2u : offset[k] < S(0) ? 1u : 0u;
    return best;
}

/// Adds the closest pair of a corner of one box and a point of the other, for boxes that do not overlap. `n` is
/// the best separating axis, from a to b, and `parted` how far it parts them.
template <class S>
constexpr void touch_corner(const oriented_box<S>& a, const oriented_box<S>& b, vec<S, 3> n, S parted, S rounding,
                            S margin, manifold<S, 3>& out) {
    const corner_distance<S> of_a = closest_corner(b, a), of_b = closest_corner(a, b);
    const auto parts = [&](vec<S, 3> m) { return dot(m, b.center - a.center) - a.reach(m) - b.reach(m); };
    // Where both are as close, one of the normals may be chance; and so may both where all but coincides.
    const S by_a = parts(-of_a.direction), by_b = parts(of_b.direction);
    const bool use_a = by_a > by_b;
    const corner_distance<S>& best = use_a ? of_a : of_b;
    const bool clear = best.gap > S(0) && !(max(by_a, by_b) < parted - rounding);
    out.normal = !clear ? n : use_a ? -best.direction : best.direction;
    const S gap = clear ? best.gap : parted;
    if (gap > margin) return;
    // Two corners have one name, whichever was found.
    const auto& r = best.region;
    std::uint32_t feature = 0x80000u | std::uint32_t{use_a} << 12 | (r[0] * 9 + r[1] * 3 + r[2]) << 4 | best.number;
    if (r[0] != 0 && r[1] != 0 && r[2] != 0) {
        const std::uint32_t other = (r[0] - 1) | (r[1] - 1) << 1 | (r[2] - 1) << 2;
        feature = 0x40000u | (use_a ? best.number << 4 | other : other << 4 | best.number);
    }
    out.add(best.corner + out.normal * ((use_a ? gap : -gap) * S(0.5)), gap, feature);
}

}  // namespace detail

/// Contact of two boxes: 15 separating axes, then face clipping with reduction to four points, one point between
/// two edges, or the nearest corner. To keep the features of bodies at rest, contacts may deviate by 1/256 of the
/// smallest half extent, never more. Source: Gottschalk, Lin, Manocha, OBBTree (1996), section 5.
template <class S>
constexpr void collide(const box<S, 3>& shape_a, const box<S, 3>& shape_b, const transform<S, 3>& b_in_a, S margin,
                       manifold<S, 3>& out) {
    const detail::oriented_box<S> a{{}, mat<S, 3>::identity(), shape_a.half_extents};
    const detail::oriented_box<S> b{b_in_a.position, matrix(b_in_a.rotation), shape_b.half_extents};
    const vec<S, 3> offset = b.center, offset_in_b = transposed_times(b.axes, offset);
    const S smallest = min(min(a.half.x, min(a.half.y, a.half.z)), min(b.half.x, min(b.half.y, b.half.z)));
    const S rounding = detail::rounding_of(largest(a.half) + largest(b.half) + largest(offset));
    const S slack = max(smallest * S(1.0 / 512), rounding);

    S best_a = S(0), best_b = S(0), best_edge = S(0);
    int axis_a = 0, axis_b = 0, edge_a = -1, edge_b = 0;
    for (int i = 0; i < 3; ++i) {
        const S gap = abs(offset[i]) - a.half[i] - b.reach(a.axis(i));
        if (gap > margin) return;
        if (i == 0 || gap > best_a) best_a = gap, axis_a = i;
    }
    for (int i = 0; i < 3; ++i) {
        const S gap = abs(offset_in_b[i]) - b.half[i] - dot(abs(b.axis(i)), a.half);
        if (gap > margin) return;
        if (i == 0 || gap > best_b) best_b = gap, axis_b = i;
    }
    vec<S, 3> edge_normal;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const vec<S, 3> across = cross(a.axis(i), b.axis(j));
            const S sine = length(across);
            // Edges so nearly parallel that a face says the same.
            if (!(sine * (a.half[i] + b.half[j]) > slack)) continue;
            const S scale = S(1) / sine;
            const vec<S, 3> n = across * scale;
            const S along = dot(n, offset);
            // Across two axes of b that n is made of; where it is short, rounding asks for n itself.
            const int k = j < 2 ? j + 1 : 0, l = j > 0 ? j - 1 : 2;
            const S reach =
                sine < S(0.25) ? b.reach(n) : (b.half[k] * abs(b.axis(l)[i]) + b.half[l] * abs(b.axis(k)[i])) * scale;
            const S gap = abs(along) - dot(abs(n), a.half) - reach;
            if (gap > margin) return;
            if (edge_a >= 0 && !(gap > best_edge)) continue;
            best_edge = gap;
            edge_a = i;
            edge_b = j;
            edge_normal = along < S(0) ? -n : n;
        }

    const S sign_a = offset[axis_a] < S(0) ? S(-1) : S(1), sign_b = offset_in_b[axis_b] > S(0) ? S(-1) : S(1);
    const auto face_of_a = [&] {
        return clip_faces(a, axis_a, sign_a, a.axis(axis_a) * sign_a, best_a, b, false, slack, margin, out);
    };
    const auto face_of_b = [&] {
        return clip_faces(b, axis_b, sign_b, b.axis(axis_b) * sign_b, best_b, a, true, slack, margin, out);
    };
    // Faces that all but face each other keep their points where an edge gives the normal.
    const auto edges = [&] {
        if (abs(edge_normal[axis_a]) > S(0.9986) && edge_normal[axis_a] * sign_a > S(0) &&
            clip_faces(a, axis_a, sign_a, edge_normal, best_edge, b, false, slack, margin, out))
            return true;
        return touch_edges(a, edge_a, b, edge_b, edge_normal, best_edge, slack, margin, out);
    };

    // Faces before edges and a before b where they are alike, so that the choice does not flicker.
    const bool use_b = best_b > best_a + slack + slack, edge_leads = edge_a >= 0 && best_edge > max(best_a, best_b);
    const S preferred = (use_b ? best_b : best_a) + slack + slack;
    if (!(edge_leads && best_edge > preferred) && (use_b ? face_of_b() : face_of_a())) return;
    if (edge_leads ? edges() : best_b > best_a ? face_of_b() : face_of_a()) return;
    const S best_face = max(best_a, best_b);
    const vec<S, 3> face_normal = best_b > best_a ? b.axis(axis_b) * -sign_b : a.axis(axis_a) * sign_a;
    touch_corner(a, b, edge_leads ? edge_normal : face_normal, edge_leads ? best_edge : best_face, rounding, margin,
                 out);
}

PHYSICS_HPP_END
