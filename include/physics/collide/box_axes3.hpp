// The search for the axis that parts two boxes in 3D best, in lanes across pairs.
#pragma once

#include "physics/base/lane_math.hpp"
#include "physics/collide/box_pair.hpp"
#include "physics/collide/manifold.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Pairs of boxes in lanes: the arithmetic of their 15 axes, the same bits at any width.
template <class P>
struct box_lanes {
    using S = typename P::scalar;

    P half_a[3], half_b[3];
    /// From A's centre to B's, in A's frame and in B's.
    P offset[3], offset_in_b[3];
    /// Coordinate i of B's axis j.
    P turn[3][3];
    /// What a few roundings may come to, and what deviation is small (m).
    P rounding, slack;

    /// Fills in what follows from the half extents, the offset and B's rotation.
    PHYSICS_HPP_ALWAYS_INLINE void prepare(const P& x, const P& y, const P& z, const P& w) {
        const P one = P::broadcast(S(1)), x2 = x + x, y2 = y + y, z2 = z + z;
        turn[0][0] = one - lane_sum(y, y2, z, z2);
        turn[1][0] = lane_sum(x, y2, w, z2);
        turn[2][0] = lane_difference(x, z2, w, y2);
        turn[0][1] = lane_difference(x, y2, w, z2);
        turn[1][1] = one - lane_sum(x, x2, z, z2);
        turn[2][1] = lane_sum(y, z2, w, x2);
        turn[0][2] = lane_sum(x, z2, w, y2);
        turn[1][2] = lane_difference(y, z2, w, x2);
        turn[2][2] = one - lane_sum(x, x2, y, y2);
        for (int j = 0; j < 3; ++j) offset_in_b[j] = lane_dot(offset, turn[0][j], turn[1][j], turn[2][j]);
        const P smallest = min(min(half_a[0], min(half_a[1], half_a[2])), min(half_b[0], min(half_b[1], half_b[2])));
        P size = max(half_a[0], max(half_a[1], half_a[2])) + max(half_b[0], max(half_b[1], half_b[2])) +
                 max(lane_abs(offset[0]), max(lane_abs(offset[1]), lane_abs(offset[2])));
        if constexpr (is_fixed<S>) size = max(size, one);
        rounding = P::broadcast(rounding_of(S(1))) * size;
        slack = max(smallest * P::broadcast(S(1.0 / 512)), rounding);
    }
    /// How far the faces of A across axis i part the boxes.
    PHYSICS_HPP_ALWAYS_INLINE P gap_of_a(int i) const {
        return lane_abs(offset[i]) - half_a[i] -
               lane_dot(half_b, lane_abs(turn[i][0]), lane_abs(turn[i][1]), lane_abs(turn[i][2]));
    }
    PHYSICS_HPP_ALWAYS_INLINE P gap_of_b(int j) const {
        return lane_abs(offset_in_b[j]) - half_b[j] -
               lane_dot(half_a, lane_abs(turn[0][j]), lane_abs(turn[1][j]), lane_abs(turn[2][j]));
    }
    /// How far the normal across axis i of A and axis j of B parts the boxes; `scale` becomes 1 / sine of their angle.
    /// Edges so nearly parallel that a face says the same part nothing.
    PHYSICS_HPP_ALWAYS_INLINE P gap_of_edges(int i, int j, P& scale) const {
        const int u = i < 2 ? i + 1 : 0, v = i > 0 ? i - 1 : 2, k = j < 2 ? j + 1 : 0, l = j > 0 ? j - 1 : 2;
        const P sine = lane_length(turn[u][j], turn[v][j]);
        // No sine that counts is smaller, since the slack is not.
        scale = P::broadcast(S(1)) / max(sine, P::broadcast(rounding_of(S(1))));
        // The normal's coordinates, at v and, negated, at u.
        const P p = turn[u][j] * scale, q = turn[v][j] * scale;
        const P along = lane_difference(offset[v], p, offset[u], q);
        const P reach_a = lane_sum(half_a[u], lane_abs(q), half_a[v], lane_abs(p));
        // B's axis j lies across it. By the true products, since sums of entries err by more where the sine is small.
        const P reach_b = lane_sum(half_b[k], lane_abs(lane_difference(turn[v][k], p, turn[u][k], q)), half_b[l],
                                   lane_abs(lane_difference(turn[v][l], p, turn[u][l], q)));
        return select_greater(sine * (half_a[i] + half_b[j]), slack, lane_abs(along) - reach_a - reach_b,
                              P::broadcast(-scalar_traits<S>::max()));
    }
};

/// The best of some axes: the first of those that part the boxes the farthest.
template <class P>
struct best_axis {
    using S = typename P::scalar;

    P gap = P::broadcast(-scalar_traits<S>::max()), number = P::broadcast(S(0)), next = number;

    PHYSICS_HPP_ALWAYS_INLINE void weigh(const P& other) {
        number = select_greater(other, gap, next, number);
        gap = max(gap, other);
        next = next + P::broadcast(S(1));
    }
};

/// What the search finds of W pairs. Axes have numbers: 0-2 the faces of A, 3-5 those of B, from 6 on A's axis times 3
/// plus B's axis, of two edges.
template <class S, int W>
struct box_axes {
    using lanes = pack<S, W>;

    /// Of A and of B: the half extents, and the other's centre in its frame.
    alignas(lanes) S half[2][3][W];
    S center[2][3][W];
    /// How B is turned, as a quaternion.
    S rotation[4][W];
    /// In each one's frame, coordinate i of the other's axis j.
    S turn[2][3][3][W];
    S rounding[W], slack[W];
    /// The best face of each and how far it parts the boxes, and the best two edges.
    S face[2][W], face_gap[2][W], edges[W], edge_gap[W];
    /// 1 / sine of the angle of two edges.
    S scale[9][W];
    /// Bit i is set where no gap of lane i is above the margin.
    std::uint32_t meet = 0;

    /// Puts each number of a pair that the search starts from into its row.
    template <class Put>
    PHYSICS_HPP_ALWAYS_INLINE void each_input(const box_pair<S, 3>& pair, const Put& put) {
        for (int i = 0; i < 3; ++i) {
            put(half[0][i], pair.a->half_extents[i]);
            put(half[1][i], pair.b->half_extents[i]);
            put(center[0][i], pair.b_in_a->position[i]);
        }
        const physics::rotation<S, 3>& turned = pair.b_in_a->rotation;
        put(rotation[0], turned.x);
        put(rotation[1], turned.y);
        put(rotation[2], turned.z);
        put(rotation[3], turned.w);
    }
    void put(int lane, const box_pair<S, 3>& pair) {
        each_input(pair, [lane](S(&row)[W], S x) { row[lane] = x; });
    }
    void put_everywhere(const box_pair<S, 3>& pair) {
        each_input(pair, [](S(&row)[W], S x) { lanes::broadcast(x).store(row); });
    }
    static int whole(S number) { return static_cast<int>(static_cast<double>(number)); }
    /// Which axis parts the boxes of a lane that do not meet: of faces the best, and edges only where no face does.
    int parting(int lane, S margin) const {
        const int by = face_gap[1][lane] > face_gap[0][lane] ? 1 : 0;
        return face_gap[by][lane] > margin ? 3 * by + whole(face[by][lane]) : 6 + whole(edges[lane]);
    }
};

/// One search for all lanes, whose pairs have been put in.
template <class S, int W>
void find_axes(S margin, box_axes<S, W>& out) {
    using P = pack<S, W>;
    box_lanes<P> box;
    for (int i = 0; i < 3; ++i) {
        box.half_a[i] = P::load(out.half[0][i]);
        box.half_b[i] = P::load(out.half[1][i]);
        box.offset[i] = P::load(out.center[0][i]);
    }
    box.prepare(P::load(out.rotation[0]), P::load(out.rotation[1]), P::load(out.rotation[2]), P::load(out.rotation[3]));
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            box.turn[i][j].store(out.turn[0][i][j]);
            box.turn[i][j].store(out.turn[1][j][i]);
        }
        (-box.offset_in_b[i]).store(out.center[1][i]);
    }
    box.rounding.store(out.rounding);
    box.slack.store(out.slack);

    const P limit = P::broadcast(margin);
    P scale[3];
    best_axis<P> face_a, face_b, edges;
    face_a.weigh(box.gap_of_a(0));
    face_a.weigh(box.gap_of_a(1));
    face_a.weigh(box.gap_of_a(2));
    face_b.weigh(box.gap_of_b(0));
    face_b.weigh(box.gap_of_b(1));
    face_b.weigh(box.gap_of_b(2));
    constexpr std::uint32_t all = (std::uint32_t{1} << W) - 1;
    const P faces = max(face_a.gap, face_b.gap);
    // A shortcut only: edges do not matter where a face parts the boxes.
    if (greater(faces, limit).bits() != all)
        for (int i = 0; i < 3; ++i) {
            edges.weigh(box.gap_of_edges(i, 0, scale[0]));
            edges.weigh(box.gap_of_edges(i, 1, scale[1]));
            edges.weigh(box.gap_of_edges(i, 2, scale[2]));
            for (int j = 0; j < 3; ++j) scale[j].store(out.scale[3 * i + j]);
        }
    face_a.number.store(out.face[0]);
    face_b.number.store(out.face[1]);
    edges.number.store(out.edges);
    face_a.gap.store(out.face_gap[0]);
    face_b.gap.store(out.face_gap[1]);
    edges.gap.store(out.edge_gap);
    out.meet = ~greater(max(faces, edges.gap), limit).bits() & all;
}

/// True if the axis of that number parts the boxes by more than margin; any number is safe. Cost: 20 ns.
template <class S>
bool separation_along(const box<S, 3>& a, const box<S, 3>& b, const transform<S, 3>& b_in_a, int axis, S margin) {
    if (axis < 0 || axis > 14) return false;
    using P = pack<S, 1>;
    box_lanes<P> box;
    for (int i = 0; i < 3; ++i) {
        box.half_a[i] = {a.half_extents[i]};
        box.half_b[i] = {b.half_extents[i]};
        box.offset[i] = {b_in_a.position[i]};
    }
    const rotation<S, 3>& r = b_in_a.rotation;
    box.prepare({r.x}, {r.y}, {r.z}, {r.w});
    P scale;
    const P gap = axis < 3   ? box.gap_of_a(axis)
                  : axis < 6 ? box.gap_of_b(axis - 3)
                             : box.gap_of_edges((axis - 6) / 3, (axis - 6) % 3, scale);
    return gap.value > margin;
}

}  // namespace detail

PHYSICS_HPP_END
