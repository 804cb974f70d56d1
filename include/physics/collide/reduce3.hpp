// Four of many contact points that span what all of them hold.
#pragma once

#include <bit>

#include "physics/base/lane_math.hpp"
#include "physics/collide/manifold.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The most points that reduce() chooses from.
inline constexpr int max_candidates = 72;

/// Points of a plane in lanes, each with a depth.
template <class P>
struct flat_points {
    P u, v, separation;
};

/// Takes points one by one, by score. `Source` has the points from about their middle, in packs, of which the last is
/// filled up with copies of others.
template <class Source>
struct point_choice {
    using P = typename Source::lanes;
    using S = typename P::scalar;
    static constexpr bool one = Source::max_packs == 1;

    const Source& source;
    int packs;
    P scores[Source::max_packs];
    /// Which points are not taken.
    std::uint32_t free[Source::max_packs];

    PHYSICS_HPP_ALWAYS_INLINE point_choice(const Source& from, int count)
        : source(from), packs(one ? 1 : (count + P::width - 1) / P::width) {
        for (int i = 0; i < packs; ++i) free[i] = (1u << P::width) - 1;
        free[packs - 1] >>= packs * P::width - count;
    }
    /// The highest of all scores, of points taken as well.
    template <class Score>
    PHYSICS_HPP_ALWAYS_INLINE S weigh(const Score& score) {
        P high = scores[0] = score(source.points(0));
        for (int i = 1; i < packs; ++i) {
            scores[i] = score(source.points(i));
            high = max(high, scores[i]);
        }
        return largest_lane(high);
    }
    /// Takes the first point whose score is about that high, or where all of these are taken the first that is not.
    PHYSICS_HPP_ALWAYS_INLINE int pick(S highest) {
        const P minimum = P::broadcast(highest * S(31.0 / 32));
        int best = 0, first = 0;
        std::uint32_t bits = 0;
        for (int i = packs - 1; i >= 0; --i) {
            const std::uint32_t here = free[i] & ~greater(minimum, scores[i]).bits();
            if (one || here != 0) bits = here, best = i;
            if (one || free[i] != 0) first = i;
        }
        if (bits == 0) bits = free[best = first];
        free[best] &= ~(bits & (0u - bits));
        return P::width * best + std::countr_zero(bits);
    }
};

/// The point that lies the farthest beyond a side of a triangle, whose corners go clockwise, times that side's length.
template <class S, class Source>
int beyond_triangle(const Source& source, int count, const int (&corner)[3]) {
    int best = -1;
    S highest{};
    for (int i = 0; i < count; ++i) {
        S score = -scalar_traits<S>::max();
        for (int k = 0; k < 3; ++k) {
            const int from = corner[k], to = corner[k < 2 ? k + 1 : 0];
            const S u = source.u(i) - source.u(from), v = source.v(i) - source.v(from);
            score =
                max(score, difference_of_products(v, source.u(to) - source.u(from), u, source.v(to) - source.v(from)));
        }
        const bool taken = i == corner[0] || i == corner[1] || i == corner[2];
        if (taken || (best >= 0 && !(score > highest + abs(highest) * S(1.0 / 32)))) continue;
        best = i;
        highest = score;
    }
    return best;
}

/// Four of at least as many points, by number: the deepest, the farthest beside it, then the points that open the
/// widest triangles on the sides of what the others span. Depth counts before distance, so that no overlap is left
/// without a point near it. Among points that are alike, depths within `slack` and distances within a few percent, the
/// first wins: rounding would choose others in each step.
template <class Source, class S>
void choose_four(const Source& source, int count, S slack, int (&chosen)[4]) {
    using P = typename Source::lanes;
    using points = flat_points<P>;
    struct place {
        P u, v;
    };
    const auto at = [&](int i) { return place{P::broadcast(source.u(i)), P::broadcast(source.v(i))}; };
    point_choice<Source> left(source, count);
    P low = source.points(0).separation;
    for (int i = 1; i < left.packs; ++i) low = min(low, source.points(i).separation);
    const P maximum = P::broadcast(slack - largest_lane(-low)), none = P::broadcast(S(-1));
    // The first is one of the deepest; of those that are alike the one farthest out.
    chosen[0] = left.pick(left.weigh(
        [&](const points& p) { return select_greater(p.separation, maximum, none, lane_sum(p.u, p.u, p.v, p.v)); }));
    const place a = at(chosen[0]);
    chosen[1] = left.pick(left.weigh([&](const points& p) {
        const P du = p.u - a.u, dv = p.v - a.v;
        return lane_sum(du, du, dv, dv);
    }));
    // How far on the right of the line from one place to another, times their distance.
    const auto beside = [](const place& from, const place& to, const points& p) {
        return lane_difference(p.u - from.u, to.v - from.v, p.v - from.v, to.u - from.u);
    };
    const place b = at(chosen[1]);
    point_choice<Source> right = left;
    const S on_left = left.weigh([&](const points&p) { return -beside(a, b, p); }),
            on_right = right.weigh([&](const points&p) { return beside(a, b, p); });
    chosen[2] = right.pick(on_right);
    chosen[3] = left.pick(on_left);
    // Where one side holds next to nothing, there may be more beyond the triangle's others.
    if (S(8) * min(on_left, on_right) > max(on_left, on_right)) return;
    const bool clockwise = on_right > on_left;
    if (!clockwise) chosen[2] = chosen[3];
    const int triangle[3] = {chosen[0], chosen[clockwise ? 1 : 2], chosen[clockwise ? 2 : 1]};
    chosen[3] = beyond_triangle<S>(source, count, triangle);
}

/// Contact points as seen along a normal, from their middle.
template <class S>
struct seen_points {
    /// There may be many, and few pairs have them: scalars compile faster.
    using lanes = pack<S, 1>;
    static constexpr int max_packs = max_candidates;

    flat_points<lanes> all[max_candidates];

    seen_points(const manifold_point<S, 3>* candidates, int count, vec<S, 3> normal) {
        const vec<S, 3> first = candidates[0].position, u_axis = perpendicular(normal), v_axis = cross(normal, u_axis);
        vec<S, 3> middle;
        for (int i = 0; i < count; ++i) middle += (candidates[i].position - first) / S(count);
        for (int i = 0; i < count; ++i) {
            const vec<S, 3> from = candidates[i].position - first - middle;
            all[i] = {{dot(u_axis, from)}, {dot(v_axis, from)}, {candidates[i].separation}};
        }
    }
    S u(int i) const { return all[i].u.value; }
    S v(int i) const { return all[i].v.value; }
    const flat_points<lanes>& points(int i) const { return all[i]; }
};

/// Adds up to four of the candidates to the manifold, which choose_four() chooses across the normal.
template <class S>
void reduce(const manifold_point<S, 3>* candidates, int count, vec<S, 3> normal, S slack, manifold<S, 3>& out) {
    if (count <= manifold<S, 3>::capacity) {
        for (int i = 0; i < count; ++i) out.points[out.count++] = candidates[i];
        return;
    }
    int chosen[4];
    choose_four(seen_points<S>(candidates, count, normal), count, slack, chosen);
    for (const int i : chosen) out.points[out.count++] = candidates[i];
}

}  // namespace detail

PHYSICS_HPP_END
