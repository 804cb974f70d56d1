// Contact of two boxes in 3D: separating axes, then clipping, a pair of edges, or the nearest corner.
#pragma once

#include "physics/collide/clip3.hpp"
#include "physics/shape/shapes.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Adds the closest points of an edge of A and an edge of B. False, with nothing added, if they are not what the
/// normal found closest.
template <class S, int W>
bool touch_edges(const box_axes<S, W>& boxes, int lane, const edge_normal<S>& e, S gap, manifold<S, 3>& out) {
    // A's edge lies along w, B's along its axis z.
    const int w = e.a, u = next_coordinate[w], v = next_coordinate[u];
    const int z = e.b, x = next_coordinate[z], y = next_coordinate[x];
    const S nu = e.normal[u], nv = e.normal[v];
    const auto turn = [&](int i, int j) { return boxes.turn[0][i][j][lane]; };
    const bool u_up = nu > S(0), v_up = nv > S(0);
    const bool x_up = sum_of_products(turn(u, x), nu, turn(v, x), nv) < S(0),
               y_up = sum_of_products(turn(u, y), nu, turn(v, y), nv) < S(0);
    const S half_a = boxes.half[0][w][lane], half_b = boxes.half[1][z][lane];
    const S on_u = sign_of<S>(u_up) * boxes.half[0][u][lane], on_v = sign_of<S>(v_up) * boxes.half[0][v][lane];
    const S on_x = sign_of<S>(x_up) * boxes.half[1][x][lane], on_y = sign_of<S>(y_up) * boxes.half[1][y][lane];
    // From the middle of A's edge to that of B's, and the direction of B's.
    const auto offset = [&](int i) {
        return boxes.center[0][i][lane] + sum_of_products(turn(i, x), on_x, turn(i, y), on_y);
    };
    const S ow = offset(w), ou = offset(u) - on_u, ov = offset(v) - on_v;
    const S dw = turn(w, z), du = turn(u, z), dv = turn(v, z);
    // Seen along A's edge, a point and a line: this keeps its precision where the edges are nearly parallel.
    const S scale = boxes.scale[3 * w + z][lane], su = du * scale, sv = dv * scale;
    const S maximum = half_b * sum_of_products(du, su, dv, sv), along = -sum_of_products(ou, su, ov, sv);
    const auto within = [](S value, S limit) { return max(-limit, min(limit, value)); };
    S t = within(along, maximum) * scale;
    S s = within(ow + dw * t, half_a);
    t = within(dw * s - narrow<S>(product(dw, ow) + product(du, ou) + product(dv, ov)), half_b);
    s = within(ow + dw * t, half_a);
    const S bw = ow + dw * t - s, bu = ou + du * t, bv = ov + dv * t;
    const S apart = max(magnitude_of(bw), max(magnitude_of(bu - nu * gap), magnitude_of(bv - nv * gap)));
    if (apart > boxes.slack[lane]) return false;
    S p[3];
    p[w] = s + bw * S(0.5);
    p[u] = on_u + bu * S(0.5);
    p[v] = on_v + bv * S(0.5);
    out.normal = {e.normal[0], e.normal[1], e.normal[2]};
    const int name_a = w << 2 | int{u_up} << 1 | int{v_up}, name_b = z << 2 | int{x_up} << 1 | int{y_up};
    out.add({p[0], p[1], p[2]}, gap, static_cast<std::uint32_t>(0x20000 | name_a << 4 | name_b));
    return true;
}

/// A corner of one box and the point of another box that is closest to it.
template <class S>
struct corner_distance {
    /// In the other box's frame: the corner, and how far beyond the other box it lies.
    vec<S, 3> corner, offset;
    vec<S, 3> direction;
    S gap{};
    std::uint32_t number = 0;

    /// Where the other box is closest: along each axis inside (0), at its lower end (1) or at its upper (2).
    std::uint32_t region(int k) const { return offset[k] > S(0) ? 2u : offset[k] < S(0) ? 1u : 0u; }
};
/// Of a box by its centre, axes and half extents, seen from another.
template <class S>
corner_distance<S> closest_corner(vec<S, 3> center, const mat<S, 3>& axes, vec<S, 3> half, vec<S, 3> whole) {
    corner_distance<S> best;
    wide_of<S> minimum{};
    for (std::uint32_t i = 0; i < 8; ++i) {
        vec<S, 3> p = center;
        for (int k = 0; k < 3; ++k) p += axes.column[k] * ((i >> k & 1u) != 0 ? half[k] : -half[k]);
        const vec<S, 3> beyond = p - max(-whole, min(whole, p));
        const wide_of<S> distance = length_squared(beyond);
        if (i > 0 && !(distance < minimum)) continue;
        minimum = distance;
        best.corner = p;
        best.offset = beyond;
        best.number = i;
    }
    const auto [direction, gap] = direction_and_length_of(best.offset);
    best.direction = direction;
    best.gap = gap;
    return best;
}

/// Adds the closest pair of a corner of one box and a point of the other, for boxes that do not overlap. `n` is
/// the best separating axis, from A to B, and `axis_gap` how far it parts them.
template <class S, int W>
void touch_corner(const box_axes<S, W>& boxes, int lane, vec<S, 3> n, S axis_gap, S margin, manifold<S, 3>& out) {
    const auto row = [&](const auto& from) { return vec<S, 3>{from[0][lane], from[1][lane], from[2][lane]}; };
    const vec<S, 3> half_a = row(boxes.half[0]), half_b = row(boxes.half[1]), offset = row(boxes.center[0]);
    const mat<S, 3> to_b{{row(boxes.turn[0][0]), row(boxes.turn[0][1]), row(boxes.turn[0][2])}},
        axes = transposed(to_b);
    const corner_distance<S> of_a = closest_corner(row(boxes.center[1]), to_b, half_a, half_b),
                             of_b = closest_corner(offset, axes, half_b, half_a);
    const auto separation = [&](vec<S, 3> m) {
        return dot(m, offset) - dot(abs(m), half_a) - dot(abs(to_b * m), half_b);
    };
    // Where both are as close, one of the normals may be chance; and so may both where all but coincides.
    const vec<S, 3> from_a = -(axes * of_a.direction);
    const S by_a = separation(from_a), by_b = separation(of_b.direction);
    const bool use_a = by_a > by_b;
    const corner_distance<S>& best = use_a ? of_a : of_b;
    const bool clear = best.gap > S(0) && !(max(by_a, by_b) < axis_gap - boxes.rounding[lane]);
    out.normal = !clear ? n : use_a ? from_a : best.direction;
    const S gap = clear ? best.gap : axis_gap;
    if (gap > margin) return;
    vec<S, 3> corner = best.corner;
    if (use_a)
        for (int k = 0; k < 3; ++k) corner[k] = sign_of<S>((best.number >> k & 1u) != 0) * half_a[k];
    // Two corners have one name, whichever was found.
    const std::uint32_t x = best.region(0), y = best.region(1), z = best.region(2);
    std::uint32_t feature = 0x80000u | std::uint32_t{use_a} << 12 | (x * 9 + y * 3 + z) << 4 | best.number;
    if (x != 0 && y != 0 && z != 0) {
        const std::uint32_t other = (x - 1) | (y - 1) << 1 | (z - 1) << 2;
        feature = 0x40000u | (use_a ? best.number << 4 | other : other << 4 | best.number);
    }
    out.add(corner + out.normal * ((use_a ? gap : -gap) * S(0.5)), gap, feature);
}

/// Adds the contact of the boxes of a lane, which no axis parts by more than the margin.
template <class S, int W>
void touch_boxes(const box_axes<S, W>& boxes, int lane, S margin, manifold<S, 3>& out) {
    const S gap_a = boxes.face_gap[0][lane], gap_b = boxes.face_gap[1][lane];
    S gap_edges = boxes.edge_gap[lane];
    const S hair = boxes.slack[lane] + boxes.slack[lane];
    const auto meet_at_face = [&](int by) {
        return clip_faces<S>(boxes, lane, by, nullptr, boxes.face_gap[by][lane], margin, out);
    };
    // Faces before edges and A's before B's where they are alike, so that the choice does not flicker.
    const int preferred = gap_b > gap_a + hair ? 1 : 0, better = gap_b > gap_a ? 1 : 0;
    if (!(gap_edges > boxes.face_gap[preferred][lane] + hair) && meet_at_face(preferred)) return;

    if (gap_edges > boxes.face_gap[better][lane]) {
        const int number = boxes.whole(boxes.edges[lane]);
        edge_normal<S> e{number / 3, number % 3, {}};
        const int u = next_coordinate[e.a], v = next_coordinate[u];
        S su = boxes.turn[0][u][e.b][lane] * boxes.scale[number][lane],
          sv = boxes.turn[0][v][e.b][lane] * boxes.scale[number][lane];
        if constexpr (is_fixed<S>)
            if (boxes.scale[number][lane] > S(8)) {
                // What rounding the sine did to the normal's length, it did to the gap.
                const auto [direction, length] = direction_and_length_of(vec<S, 2>{su, sv});
                su = direction.x;
                sv = direction.y;
                gap_edges = gap_edges / length;
            }
        const S sign =
            sign_of<S>(!(difference_of_products(boxes.center[0][v][lane], su, boxes.center[0][u][lane], sv) < S(0)));
        e.normal[u] = -sv * sign;
        e.normal[v] = su * sign;
        // Faces that all but face each other keep their points where an edge gives the normal.
        const int face = boxes.whole(boxes.face[0][lane]);
        const S upright = boxes.center[0][face][lane] < S(0) ? -e.normal[face] : e.normal[face];
        if (upright > S(0.9986) && clip_faces(boxes, lane, 0, &e, gap_edges, margin, out)) return;
        if (touch_edges(boxes, lane, e, gap_edges, out)) return;
        touch_corner(boxes, lane, {e.normal[0], e.normal[1], e.normal[2]}, gap_edges, margin, out);
        return;
    }
    if (better != preferred && meet_at_face(better)) return;
    const int axis = boxes.whole(boxes.face[better][lane]);
    const S sign = sign_of<S>(!(boxes.center[better][axis][lane] < S(0)));
    vec<S, 3> n;
    n[axis] = sign;
    if (better == 1) {
        const auto& towards = boxes.turn[1][axis];
        n = {-towards[0][lane] * sign, -towards[1][lane] * sign, -towards[2][lane] * sign};
    }
    touch_corner(boxes, lane, n, boxes.face_gap[better][lane], margin, out);
}

/// out[i] becomes what collide() of pair i gives from an empty manifold, bit for bit, whatever `count` is.
/// `separating_axes`, where it is not null, gets the number of the axis that parts pair i by more than the margin, for
/// separation_along(); -1 where none does.
template <class S>
void collide_boxes(const box_pair<S, 3>* pairs, std::uint32_t count, S margin, manifold<S, 3>* out,
                   int* separating_axes = nullptr) {
    constexpr std::uint32_t width = native_width<S>;
    for (std::uint32_t first = 0; first < count; first += width) {
        const std::uint32_t here = count - first < width ? count - first : width;
        box_axes<S, static_cast<int>(width)> found;
        for (std::uint32_t i = 0; i < width; ++i) found.put(static_cast<int>(i), pairs[i < here ? first + i : first]);
        find_axes(margin, found);
        for (std::uint32_t i = 0; i < here; ++i) {
            const int lane = static_cast<int>(i);
            const bool meet = (found.meet >> i & 1u) != 0;
            out[first + i] = {};
            if (separating_axes != nullptr) separating_axes[first + i] = meet ? -1 : found.parting(lane, margin);
            if (meet) touch_boxes(found, lane, margin, out[first + i]);
        }
    }
}

}  // namespace detail

/// Contact of two boxes: 15 separating axes, then face clipping with reduction to four points, one point between
/// two edges, or the nearest corner. To keep the features of bodies at rest, contacts may deviate by 1/256 of the
/// smallest half extent, never more. Source: Gottschalk, Lin, Manocha, OBBTree (1996), section 5.
template <class S>
void collide(const box<S, 3>& a, const box<S, 3>& b, const transform<S, 3>& b_in_a, S margin, manifold<S, 3>& out) {
    detail::box_axes<S, detail::native_width<S>> found;
    found.put_everywhere({&a, &b, &b_in_a});
    detail::find_axes(margin, found);
    if (found.meet != 0) detail::touch_boxes(found, 0, margin, out);
}

PHYSICS_HPP_END
