// The faces of two boxes in 3D, clipped to what they share.
#pragma once

#include "physics/collide/box_axes3.hpp"
#include "physics/collide/reduce3.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The coordinate that follows another, round and round.
inline constexpr int next_coordinate[3] = {1, 2, 0};

/// x by magnitude, without a branch.
template <class S>
constexpr S magnitude_of(S x) {
    return max(x, -x);
}
/// -1 or 1; by address, since signs are hard to predict.
template <class S>
S sign_of(bool positive) {
    const S signs[2] = {S(-1), S(1)};
    return signs[positive];
}

/// The normal across an edge of A and one of B, from A to B, both given by their axes.
template <class S>
struct edge_normal {
    int a, b;
    S normal[3];
};

/// A face as seen along a normal from the reference face: where on that it lies, and how far beyond it.
template <class S>
struct seen_face {
    /// Each by u, v and separation: the middle, and what one metre along each of two sides adds.
    S middle[3], along[2][3];
    S half[2];
};

/// What is left of a face within limits: where its edges start (0-3) and where they were cut off (4-7), and the corners
/// of the limits (8-11).
template <class S>
struct clipped_face {
    S u[12], v[12], separation[12];
    /// A point's name: two of the face's edges 0-3 and of the limits 4-7.
    S name[12];
    /// Which points exist within the margin, and whether any is as deep as it must be.
    std::uint32_t within = 0;
    bool deep = false;

    PHYSICS_HPP_ALWAYS_INLINE void put(int at, const pack<S, 4>& pu, const pack<S, 4>& pv, const pack<S, 4>& depth,
                                       const pack<S, 4>& names, std::uint32_t exist, S maximum, S margin) {
        using P = pack<S, 4>;
        pu.store(u + at);
        pv.store(v + at);
        depth.store(separation + at);
        names.store(name + at);
        within |= (exist & ~greater(depth, P::broadcast(margin)).bits()) << at;
        deep = deep || (exist & ~greater(depth, P::broadcast(maximum)).bits()) != 0;
    }
};

/// Eight of the points that are left of a face, by number.
template <class S>
struct picked_points {
    /// Of vectors of 16 bytes at most, which scalars fill.
    using lanes = pack < S, 8, vector_bytes<16 ? vector_bytes : 16>;
    static constexpr int max_packs = 1;

    flat_points<lanes> all;
    S at_u[8], at_v[8];

    PHYSICS_HPP_ALWAYS_INLINE picked_points(const clipped_face<S>& face, const int (&numbers)[12])
        : all{row(face.u, numbers), row(face.v, numbers), row(face.separation, numbers)} {
        all.u.store(at_u);
        all.v.store(at_v);
    }
    PHYSICS_HPP_ALWAYS_INLINE static lanes row(const S* from, const int* n) {
        using half = typename lanes::half;
        return {lanes_of<half>(from[n[0]], from[n[1]], from[n[2]], from[n[3]]),
                lanes_of<half>(from[n[4]], from[n[5]], from[n[6]], from[n[7]])};
    }
    S u(int i) const { return at_u[i]; }
    S v(int i) const { return at_v[i]; }
    PHYSICS_HPP_ALWAYS_INLINE const flat_points<lanes>& points(int) const { return all; }
};

/// Four corners, from the middle along +a +b, -a +b, -a -b, +a -b.
template <class S>
PHYSICS_HPP_ALWAYS_INLINE pack<S, 4> corners_of(S middle, S a, S b) {
    using P = pack<S, 4>;
    if constexpr (native_width < S >> 1) {
        constexpr S outer[4] = {1, -1, -1, 1}, upper[4] = {1, 1, -1, -1};
        return P::broadcast(middle) + P::broadcast(a) * P::load(outer) + P::broadcast(b) * P::load(upper);
    } else {
        const S high = middle + a, low = middle - a;
        return lanes_of<P>(high + b, low + b, low - b, high - b);
    }
}
/// In each lane what the next one holds, round and round.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P next_of(const P& x) {
    return lanes_of<P>(x.lane(1), x.lane(2), x.lane(3), x.lane(0));
}

/// Cuts a face down to |u| <= limit_u, |v| <= limit_v, and keeps what is within the margin. Each edge goes for itself,
/// all four in lanes. Source: Liang, Barsky, A new concept and method for line clipping (1984).
template <class S>
PHYSICS_HPP_ALWAYS_INLINE void clip_face(const seen_face<S>& face, S limit_u, S limit_v, S rounding, S maximum,
                                         S margin, clipped_face<S>& out) {
    using P = pack<S, 4>;
    const auto &m = face.middle, &x = face.along[0], &y = face.along[1];
    const S xu = x[0] * face.half[0], xv = x[1] * face.half[0], xs = x[2] * face.half[0];
    const S yu = y[0] * face.half[1], yv = y[1] * face.half[1], ys = y[2] * face.half[1];
    const P u = corners_of(m[0], xu, yu), v = corners_of(m[1], xv, yv), s = corners_of(m[2], xs, ys);
    const P corner = lanes_of<P>(S(0), S(0x11), S(0x22), S(0x33));
    const S beyond_u = magnitude_of(m[0]) + magnitude_of(xu) + magnitude_of(yu) - limit_u,
            beyond_v = magnitude_of(m[1]) + magnitude_of(xv) + magnitude_of(yv) - limit_v;
    if (!(max(beyond_u, beyond_v) > S(0))) {
        out.put(0, u, v, s, corner, 0xfu, maximum, margin);
        return;
    }

    const P zero = P::broadcast(S(0)), one = P::broadcast(S(1)), hair = P::broadcast(rounding);
    const P reach_u = P::broadcast(limit_u), reach_v = P::broadcast(limit_v);
    const P du = next_of(u) - u, dv = next_of(v) - v, ds = next_of(s) - s;
    // How far the ends lie beyond the limits, as shares of the edge's extent across them. The two shares of an edge
    // that lies beyond make more than the whole.
    const P extent_u = max(lane_abs(du), hair), extent_v = max(lane_abs(dv), hair);
    const P over_u = max(lane_abs(u) - reach_u, zero), over_v = max(lane_abs(v) - reach_v, zero);
    const P start_u = over_u / extent_u, start_v = over_v / extent_v;
    const P stop_u = next_of(over_u) / extent_u, stop_v = next_of(over_v) / extent_v;
    const P start = min(max(start_u, start_v), one), rest = min(max(stop_u, stop_v), one), stop = one - rest;
    const P name_u = select_greater(zero, u, P::broadcast(S(5)), P::broadcast(S(4))),
            name_v = select_greater(zero, v, P::broadcast(S(7)), P::broadcast(S(6)));
    const P start_name =
        select_greater(start_u, start_v, name_u, name_v) * P::broadcast(S(0x10)) + lanes_of<P>(S(0), S(1), S(2), S(3));
    const P stop_name =
        select_greater(stop_u, stop_v, next_of(name_u), next_of(name_v)) + lanes_of<P>(S(0), S(0x10), S(0x20), S(0x30));
    const std::uint32_t left = greater(stop, start).bits(), cut = greater(rest, zero).bits();
    out.put(0, u + du * start, v + dv * start, s + ds * start, select_greater(start, zero, start_name, corner),
            left | (~greater(start, zero).bits() & 0xfu), maximum, margin);
    out.put(4, u + du * stop, v + dv * stop, s + ds * stop, stop_name, left & cut, maximum, margin);

    // The corners of the limits, by how far along the face's sides they lie. Those that miss the face by a hair count:
    // the edge that passes there may have been lost to rounding.
    const P corner_u = corners_of(S(0), limit_u, S(0)), corner_v = corners_of(S(0), S(0), limit_v);
    const P from_u = corner_u - P::broadcast(m[0]), from_v = corner_v - P::broadcast(m[1]);
    const P scale = P::broadcast(S(1) / difference_of_products(x[0], y[1], x[1], y[0]));
    const P at_x = lane_difference(from_u, P::broadcast(y[1]), from_v, P::broadcast(y[0])) * scale;
    const P at_y = lane_difference(from_v, P::broadcast(x[0]), from_u, P::broadcast(x[1])) * scale;
    const P half_x = P::broadcast(face.half[0]), half_y = P::broadcast(face.half[1]);
    const P outside = max(lane_abs(at_x) - half_x, lane_abs(at_y) - half_y);
    const P depth = P::broadcast(m[2]) + lane_sum(P::broadcast(x[2]), max(-half_x, min(half_x, at_x)),
                                                  P::broadcast(y[2]), max(-half_y, min(half_y, at_y)));
    out.put(8, corner_u, corner_v, depth, lanes_of<P>(S(0x46), S(0x56), S(0x57), S(0x47)),
            ~greater(outside, hair + hair).bits() & 0xfu, maximum, margin);
}

/// Clips the face of the other box that faces the best face of the reference box to the latter's sides, and adds what
/// is left within the margin. The reference box is A (0) or B (1). The normal is its face's, or the `lean` if that is
/// not null (the reference is A then); gap is how far it parts the boxes. False, with nothing added, if the point in
/// which it finds the other box closest was cut off: then the boxes do not touch face to face.
template <class S, int W>
bool clip_faces(const box_axes<S, W>& boxes, int lane, int reference, const edge_normal<S>* lean, S gap, S margin,
                manifold<S, 3>& out) {
    const int w = boxes.whole(boxes.face[reference][lane]), u = next_coordinate[w], v = next_coordinate[u];
    const auto& center = boxes.center[reference];
    const auto &half = boxes.half[reference], &other = boxes.half[1 - reference];
    const S sign = sign_of<S>(!(center[w][lane] < S(0))), slack = boxes.slack[lane];
    const auto &turn_u = boxes.turn[reference][u], &turn_v = boxes.turn[reference][v],
               &turn_w = boxes.turn[reference][w];
    // A lower number wins unless another face is clearly better, so that rounding does not choose.
    const S facing[3] = {magnitude_of(turn_w[0][lane]), magnitude_of(turn_w[1][lane]), magnitude_of(turn_w[2][lane])};
    int across = facing[1] > facing[0] + S(1.0 / 1024) ? 1 : 0;
    across = facing[2] > facing[across] + S(1.0 / 1024) ? 2 : across;
    const bool upper = !(turn_w[across][lane] * sign > S(0));
    const S depth = sign_of<S>(upper) * other[across][lane];

    seen_face<S> face;
    const int x = next_coordinate[across], y = next_coordinate[x];
    face.middle[0] = center[u][lane] + turn_u[across][lane] * depth;
    face.middle[1] = center[v][lane] + turn_v[across][lane] * depth;
    face.middle[2] = (center[w][lane] + turn_w[across][lane] * depth) * sign - half[w][lane];
    face.along[0][0] = turn_u[x][lane];
    face.along[0][1] = turn_v[x][lane];
    face.along[0][2] = turn_w[x][lane] * sign;
    face.along[1][0] = turn_u[y][lane];
    face.along[1][1] = turn_v[y][lane];
    face.along[1][2] = turn_w[y][lane] * sign;
    face.half[0] = other[x][lane];
    face.half[1] = other[y][lane];
    S normal[3];
    normal[u] = normal[v] = S(0);
    normal[w] = sign;
    if (lean != nullptr) {
        for (int k = 0; k < 3; ++k) normal[k] = lean->normal[k];
        const S steep = S(1) / (normal[w] * sign), lean_u = normal[u] * steep, lean_v = normal[v] * steep;
        const auto lean_back = [&](S(&place)[3]) {
            place[0] -= lean_u * place[2];
            place[1] -= lean_v * place[2];
            place[2] *= steep;
        };
        lean_back(face.middle);
        lean_back(face.along[0]);
        lean_back(face.along[1]);
    }
    // A little beyond the face, so that rounding does not decide whether the corners of equal boxes are cut, and named
    // anew, in each step.
    clipped_face<S> left;
    clip_face(face, half[u][lane] + slack, half[v][lane] + slack, boxes.rounding[lane], gap + slack + slack, margin,
              left);
    if (!left.deep) return false;

    int count = 0, numbers[12] = {}, chosen[4] = {};
    for (std::uint32_t bits = left.within; bits != 0; bits &= bits - 1) numbers[count++] = std::countr_zero(bits);
    if (count > 4) {
        // More than eight there are only where rounding makes two of one.
        for (int i = count; i < 8; ++i) numbers[i] = numbers[0];
        choose_four(picked_points<S>(left, numbers), count < 8 ? count : 8, slack, chosen);
        count = 4;
    } else {
        for (int k = 0; k < count; ++k) chosen[k] = k;
    }
    for (int& k : chosen) k = numbers[k];
    using P = pack<S, 4>;
    const auto picked = [&](const S* from) {
        return lanes_of<P>(from[chosen[0]], from[chosen[1]], from[chosen[2]], from[chosen[3]]);
    };
    const P separations = picked(left.separation), halfway = separations * P::broadcast(S(0.5));
    P p[3];
    p[u] = picked(left.u);
    p[v] = picked(left.v);
    p[w] = P::broadcast(half[w][lane] * sign) + halfway * P::broadcast(normal[w]);
    if (lean != nullptr) {
        p[u] += halfway * P::broadcast(normal[u]);
        p[v] += halfway * P::broadcast(normal[v]);
    }
    if (reference != 0) {
        const P q[3] = {p[0], p[1], p[2]};
        for (int k = 0; k < 3; ++k) {
            const auto& axes = boxes.turn[0][k];
            normal[k] = -axes[w][lane] * sign;
            p[k] = P::broadcast(boxes.center[0][k][lane]) +
                   lane_dot(q, P::broadcast(axes[0][lane]), P::broadcast(axes[1][lane]), P::broadcast(axes[2][lane]));
        }
    }
    S at[4][4];
    for (int k = 0; k < 3; ++k) p[k].store(at[k]);
    separations.store(at[3]);
    out.normal = {normal[0], normal[1], normal[2]};
    const auto faces =
        static_cast<std::uint32_t>(reference << 16 | (2 * w + int{sign > S(0)}) << 12 | (2 * across + int{upper}) << 8);
    for (int k = 0; k < count; ++k) {
        const auto name = static_cast<std::uint32_t>(boxes.whole(left.name[chosen[k]]));
        out.points[out.count + k] = {{at[0][k], at[1][k], at[2][k]}, at[3][k], faces | name};
    }
    out.count += count;
    return true;
}

}  // namespace detail

PHYSICS_HPP_END
