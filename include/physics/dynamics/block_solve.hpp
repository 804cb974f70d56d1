// All points of a contact at once.
#pragma once

#include "physics/dynamics/contact_pass.hpp"
#include "physics/dynamics/soft_prepare.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// True if a Gauss-Seidel pass would change nothing in the given lanes (1 in these, 0 in others): no point has an
/// impulse, and none closes its gap within the substep or has closed it.
template <class P, class Point, class Pass, class At, class SpeedAt>
PHYSICS_HPP_ALWAYS_INLINE bool are_inactive(const Point* points, int count, const Pass& pass, const P& lanes, At&& at,
                                            SpeedAt&& speed_at) {
    const P zero = P::broadcast(typename P::scalar(0)), per_step = P::broadcast(pass.inverse_step);
    P busy = zero;
    for (int k = 0; k < count; ++k) {
        const P gap = P::load(points[k].separation) + at(k), closing = speed_at(k) + gap * per_step;
        // Where a gap is exactly closed, all points at once may still stop an approach.
        P ahead = -min(gap, closing);
        if (!pass.use_bias) ahead = select_greater(gap, zero, zero, ahead);
        const P needed = max(P::load(points[k].impulse), ahead);
        // Of points that only other lanes have nothing is asked.
        busy = max(busy, select_greater(P::load(points[k].mass), zero, needed, zero));
#if defined(__GNUC__) && !defined(__clang__)
        // No instruction. -floop-nest-optimize of g++ 12 joins this loop with others, and gets it wrong.
        asm volatile("");
#endif
    }
    return greater(lanes * busy, zero).bits() == 0;
}

/// One point of W contacts.
template <class S, int D, int W>
struct soft_point {
    S mass[W];
    S separation[W];
    /// What the contact's D speeds ask of it where all points are answered at once.
    S share[D][W];
    /// Of this substep, after its last round what the next one begins with; and of the whole step.
    S impulse[W], total[W];
};

/// How the D speeds of W contacts answer to impulses at their middles.
template <class S, int D, int W>
struct k_matrix_lanes {
    inverse_of<S> rows[D == 2 ? 3 : 6][W];

    template <class P>
    PHYSICS_HPP_ALWAYS_INLINE lane_vec<P, D> operator*(const lane_vec<P, D>& impulse) const {
        return lane_symmetric<kernel_pack<inverse_of<S>, W>, D>::load(rows) * impulse;
    }
    /// Of one contact.
    vec<S, D> times(int lane, vec<S, D> impulse) const {
        constexpr int row[3][3] = {{0, D, 4}, {D, 1, 5}, {4, 5, 2}};
        vec<S, D> by;
        for (int i = 0; i < D; ++i) {
            by[i] = mul<S>(rows[row[i][0]][lane], impulse.x) + mul<S>(rows[row[i][1]][lane], impulse.y);
            if constexpr (D == 3) by[i] += mul<S>(rows[row[i][2]][lane], impulse.z);
        }
        return by;
    }
};

/// The speeds of a contact's points follow from D numbers, so that the impulses that stop all of them do too: where
/// every point touches and goes on pushing, that is the answer, exact and without iterations. Elsewhere points are
/// visited one by one. It carries heavy loads and keeps columns from swaying, which visits do not. Source: the first
/// case of the block solver of Catto's Box2D 2, for any number of points.
template <class S, int D, int W>
struct block_solve {
    using P = kernel_pack<S, W>;
    using vector = lane_vec<P, D>;
    template <class K>
    using vectors = lane_vec<K, D>[manifold<S, D>::capacity];

    /// The separation at the middle and its slopes, of the plane that fits the points best.
    S separation[D][W];
    /// Less than 0 where points have to be visited.
    S valid[W];

    static constexpr int capacity = manifold<S, D>::capacity;

    void clear() {
        for (S& lane : valid) lane = S(-1);
    }
    /// Precomputes the direct solve of contacts with two points: `jacobians` are the rows of J (along the normal and
    /// about the tangents), `k_rows` those of J K, `own` the diagonal of J K J^T.
    template <class K, class Point>
    PHYSICS_HPP_ALWAYS_INLINE void prepare_edge(Point* points, const vectors<K>& jacobians, const vectors<K>& k_rows,
                                                const K (&own)[capacity], const K& count) {
        using C = typename K::scalar;
        const K zero = K::broadcast(C(0)), half = K::broadcast(C(0.5)), other = dot(jacobians[0], k_rows[1]);
        // The middle of the points is the origin: but for the sign both lie as far from it.
        const lane_vec<K, D> away = (jacobians[0] - jacobians[1]) * half;
        const K gaps[] = {lanes_from<K>(points[0].separation), lanes_from<K>(points[1].separation)};
        lane_vec<K, D> plane = away * lane_quotient(half * (gaps[0] - gaps[1]), dot(away, away)), shares[capacity];
        plane.x = half * (gaps[0] + gaps[1]);
        const K square = own[0] * own[1], determinant = square - other * other;
        for (int k = 0; k < 2; ++k)
            shares[k] = lane_quotient(jacobians[k] * own[1 - k] - jacobians[1 - k] * other, determinant);
        // Points that are all but one would share a turn out in huge impulses.
        K ok = select_greater(determinant, K::broadcast(C(1e-4)) * square, K::broadcast(C(1)), zero);
        ok = select_greater(K::broadcast(C(2.5)), count, select_greater(count, K::broadcast(C(1.5)), ok, zero), zero);
        write(points, 2, ok, plane, shares);
    }
    /// The same for more points, which span the plane of the contact: what stops its speeds, shared out with the least
    /// squares. `speeds` tells how these answer to an impulse along the normal at the middle and to angular ones.
    template <class K, class Point>
    PHYSICS_HPP_ALWAYS_INLINE void prepare_face(Point* points, int maximum, const vectors<K>& jacobians,
                                                const K (&there)[capacity], const lane_symmetric<K, D>& speeds,
                                                const K& count) {
        using C = typename K::scalar;
        const K zero = K::broadcast(C(0)), one = K::broadcast(C(1)), share = lane_reciprocal(count);
        K xx = zero, xy = zero, yy = zero;
        for (int k = 0; k < maximum; ++k) {
            xx = xx + jacobians[k].y * jacobians[k].y;
            xy = xy + jacobians[k].y * jacobians[k].z;
            yy = yy + jacobians[k].z * jacobians[k].z;
        }
        const K determinant = xx * yy - xy * xy, small = K::broadcast(C(1e-3)) * speeds.xx;
        K ok = select_greater(determinant, K::broadcast(C(1e-4)) * xx * yy, one, zero);
        ok = select_greater(xx * speeds.yy, small, select_greater(yy * speeds.zz, small, ok, zero), zero);
        ok = select_greater(count, K::broadcast(C(2.5)), ok, zero);
        const lane_symmetric<K, 3> stop = lane_inverse(speeds);
        const auto tell_apart = [&](const K& k, const K& stopped) PHYSICS_HPP_INLINE_LAMBDA {
            ok = select_greater(K::broadcast(C(1e4)), k * stopped, select_greater(stopped, zero, ok, zero), zero);
        };
        tell_apart(speeds.xx, stop.xx);
        tell_apart(speeds.yy, stop.yy);
        tell_apart(speeds.zz, stop.zz);
        lane_vec<K, D> plane = {zero, zero, zero}, shares[capacity];
        for (int k = 0; k < maximum; ++k) {
            const K &y = jacobians[k].y, &z = jacobians[k].z;
            const lane_vec<K, D> weights = {there[k] * share, lane_quotient(yy * y - xy * z, determinant),
                                            lane_quotient(xx * z - xy * y, determinant)};
            plane = plane + weights * lanes_from<K>(points[k].separation);
            shares[k] = stop * weights;
        }
        write(points, maximum, ok, plane, shares);
    }
    /// Answers the speeds, and adds what that comes to to the sum. `left` is 1 in lanes that are left to visits, where
    /// nothing changes; returns whether any is. `at(k)` is the way at point k.
    template <class Point, class At, class SpeedAt>
    PHYSICS_HPP_ALWAYS_INLINE bool solve(Point* points, int count, const contact_pass<S, D>& pass,
                                         const vector& unbiased, const vector& displacement, P& left, vector& sum,
                                         At&& at, SpeedAt&& speed_at) const {
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1));
        left = one;
        if (count == 1) return true;
        P ok = P::load(valid), kept = one, strength = one, changes[capacity];
        P calm = P::broadcast(scalar_traits<S>::max()), smallest = calm, sum_of_changes = zero, there = zero;
        vector speed = unbiased;
        if (pass.use_bias) {
            speed = unbiased + (vector::load(separation) + displacement) * P::broadcast(pass.spring.rate);
            kept = P::broadcast(S(1) - pass.spring.impulse_scale);
            strength = P::broadcast(pass.spring.mass_scale);
        }
        for (int k = 0; k < count; ++k) {
            const P before = P::load(points[k].impulse), gap = P::load(points[k].separation) + at(k);
            const P asked = asked_of(points[k], speed);
            changes[k] = pass.use_bias ? kept * before - strength * asked - before : zero - asked;
            P good = min(before + changes[k], -gap);
            // Where the limit of the push binds, what the springs ask for is not flat.
            if (pass.use_bias)
                good = min(good, gap * P::broadcast(pass.spring.rate) + P::broadcast(pass.max_depenetration_speed));
            // Of points that only other lanes have nothing is asked.
            ok = min(ok, select_greater(P::load(points[k].mass), zero, good, zero));
            if (!pass.over_relaxes) continue;
            const P is = P::load(points[k].mass), lasts = before - lane_abs(changes[k]) * P::broadcast(S(32));
            calm = select_greater(is, zero, min(calm, lasts), calm);
            smallest = select_greater(is, zero, min(smallest, before + changes[k]), smallest);
            sum_of_changes = sum_of_changes + select_greater(is, zero, changes[k], zero);
            there = there + select_greater(is, zero, one, zero);
        }
        // Loads that last are over-relaxed by 1.7, all points alike: those of tall piles travel faster so. From 2 on,
        // rounds end in a limit cycle. No point pulls. Impacts, and what turns the bodies, are answered as they are.
        // Source: Golub, Van Loan, Matrix Computations, 11.2.
        P more = zero;
        if (pass.over_relaxes)
            more = select_greater(calm, zero, max(sum_of_changes * P::broadcast(S(0.7)) / max(there, one), -smallest),
                                  zero);
        left = select_greater(zero, ok, one, zero);
        const bool any_left = greater(zero, ok).bits() != 0 && !are_inactive(points, count, pass, left, at, speed_at);
        for (int k = 0; k < count; ++k) {
            const P by = changes[k] + select_greater(P::load(points[k].mass), zero, more, zero);
            const P change = select_greater(zero, ok, zero, by);
            max(P::load(points[k].impulse) + change, zero).store(points[k].impulse);
            sum = sum + points[k].at_middle(change);
        }
        return any_left;
    }
    /// The same for lanes that are left to visits, and land: that bore nothing as the substep began, or meet or part
    /// fast, and whose gaps all close within it. What lands flat is stopped without a turn, which friction would make a
    /// slide of. Not where the middle's way is longer than the contact is wide: needles turn by more than their gaps
    /// are good for before the substep ends.
    template <class Point, class At, class SpeedAt>
    PHYSICS_HPP_ALWAYS_INLINE void solve_landing(Point* points, int count, const contact_pass<S, D>& pass,
                                                 const vector& speed, const vector& displacement, S* start_load,
                                                 const P& half_width, P& left, vector& sum, At&& at,
                                                 SpeedAt&& speed_at) const {
        if (count == 1) return;
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1)), per_step = P::broadcast(pass.inverse_step);
        const P half_way = lane_abs(speed.x) * P::broadcast(pass.substep * S(0.5));
        const P rests = select_greater(lane_abs(speed.x), P::broadcast(pass.impact_speed), zero, P::load(start_load));
        P lands = select_greater(max(rests, -P::load(valid)), zero, zero, left);
        lands = select_greater(half_way, half_width, zero, lands);
        // No early return where no lane lands: g++ 11 and 12 fail to compile it (in gimple_expand_vec_cond_expr).
        const vector closing = speed + (vector::load(separation) + displacement) * per_step;
        P changes[capacity];
        for (int k = 0; k < count; ++k) {
            changes[k] = zero - asked_of(points[k], closing);
            const P before = P::load(points[k].impulse), gap = P::load(points[k].separation) + at(k);
            // Gaps that are all but closed may be overlaps by rounding.
            const P rounding = lane_abs(speed_at(k)) * P::broadcast(pass.substep * S(1.0 / 1024));
            P good = min(gap + rounding, before + changes[k]);
            // As visits do.
            if (!pass.use_bias) good = min(good, before);
            lands = select_greater(P::load(points[k].mass), zero, select_greater(good, zero, lands, zero), lands);
        }
        for (int k = 0; k < count; ++k) {
            const P change = select_greater(lands, zero, changes[k], zero);
            (P::load(points[k].impulse) + change).store(points[k].impulse);
            sum = sum + points[k].at_middle(change);
        }
        left = left - lands;
        if (!pass.use_bias) return;
        const P impact = select_greater(-speed.x, P::broadcast(pass.impact_speed), lands, zero);
        select_greater(impact, zero, -one, P::load(start_load)).store(start_load);
    }

private:
    /// What speeds ask of a point. Each product is rounded, which those of dot are not.
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE static P asked_of(const Point& p, const vector& speed) {
        const vector share = vector::load(p.share);
        if constexpr (D == 2) return share.x * speed.x + share.y * speed.y;
        else return share.x * speed.x + share.y * speed.y + share.z * speed.z;
    }
    /// Writes the lanes that are good (1, else 0), but for those whose shares the scalar cannot hold.
    template <class K, class Point>
    PHYSICS_HPP_ALWAYS_INLINE void write(Point* points, int count, const K& good, const lane_vec<K, D>& plane,
                                         const vectors<K>& shares) {
        using C = typename K::scalar;
        const K zero = K::broadcast(C(0)), maximum = K::broadcast(C(to_double(scalar_traits<S>::max()) / 4));
        K ok = good;
        const auto hold = [&](const K& share)
                              PHYSICS_HPP_INLINE_LAMBDA { ok = select_greater(maximum, lane_abs(share), ok, zero); };
        for (int k = 0; k < count; ++k) {
            hold(shares[k].x);
            hold(shares[k].y);
            if constexpr (D == 3) hold(shares[k].z);
        }
        if (greater(ok, zero).bits() == 0) return;
        put_lanes(select_greater(ok, zero, zero, lanes_from<K>(valid)), valid);
        const auto put = [&](const lane_vec<K, D>& value, S(&to)[D][W]) PHYSICS_HPP_INLINE_LAMBDA {
            select_greater(ok, zero, value, lane_vec<K, D>::load(to)).store(to);
        };
        put(plane, separation);
        for (int k = 0; k < count; ++k) put(shares[k], points[k].share);
    }
};

}  // namespace detail

PHYSICS_HPP_END
