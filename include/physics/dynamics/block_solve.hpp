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

/// The speeds of a contact's points follow from D numbers, so that the impulses that stop all of them do too: where
/// every point touches and goes on pushing, that is the answer, exact and without iterations. Elsewhere points are
/// visited one by one. It carries heavy loads and keeps columns from swaying, which visits do not. Source: the first
/// case of the block solver of Catto's Box2D 2, for any number of points.
template <class S, int D, int W>
struct block_solve {
    using P = kernel_pack<S, W>;

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
    PHYSICS_HPP_ALWAYS_INLINE void prepare_edge(Point* points, const K (&jacobians)[capacity][D],
                                                const K (&k_rows)[capacity][D], const K (&own)[capacity],
                                                const K& count) {
        using C = typename K::scalar;
        const K zero = K::broadcast(C(0)), half = K::broadcast(C(0.5));
        K other = k_rows[1][0], apart = zero, plane[D], shares[capacity][D];
        for (int i = 1; i < D; ++i) {
            other = other + jacobians[0][i] * k_rows[1][i];
            plane[i] = half * (jacobians[0][i] - jacobians[1][i]);
            apart = apart + plane[i] * plane[i];
        }
        // The middle of the points is the origin: but for the sign both lie as far from it.
        const K gaps[] = {lanes_from<K>(points[0].separation), lanes_from<K>(points[1].separation)};
        const K slope = lane_quotient(half * (gaps[0] - gaps[1]), apart);
        plane[0] = half * (gaps[0] + gaps[1]);
        for (int i = 1; i < D; ++i) plane[i] = slope * plane[i];
        const K square = own[0] * own[1], determinant = square - other * other;
        for (int k = 0; k < 2; ++k)
            for (int i = 0; i < D; ++i)
                shares[k][i] = lane_quotient(jacobians[k][i] * own[1 - k] - jacobians[1 - k][i] * other, determinant);
        // Points that are all but one would share a turn out in huge impulses.
        K ok = select_greater(determinant, K::broadcast(C(1e-4)) * square, K::broadcast(C(1)), zero);
        ok = select_greater(K::broadcast(C(2.5)), count, select_greater(count, K::broadcast(C(1.5)), ok, zero), zero);
        write(points, 2, ok, plane, shares);
    }
    /// The same for more points, which span the plane of the contact: what stops its speeds, shared out with the least
    /// squares. `speeds` tells how these answer to an impulse along the normal at the middle and to angular ones.
    template <class K, class Point>
    PHYSICS_HPP_ALWAYS_INLINE void prepare_face(Point* points, int maximum, const K (&jacobians)[capacity][D],
                                                const K (&there)[capacity], const lane_symmetric<K, 3>& speeds,
                                                const K& count) {
        using C = typename K::scalar;
        const K zero = K::broadcast(C(0)), one = K::broadcast(C(1)), share = lane_reciprocal(count);
        K xx = zero, xy = zero, yy = zero;
        for (int k = 0; k < maximum; ++k) {
            xx = xx + jacobians[k][1] * jacobians[k][1];
            xy = xy + jacobians[k][1] * jacobians[k][2];
            yy = yy + jacobians[k][2] * jacobians[k][2];
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
        K plane[D] = {zero, zero, zero}, shares[capacity][D];
        for (int k = 0; k < maximum; ++k) {
            const K y = jacobians[k][1], z = jacobians[k][2], gap = lanes_from<K>(points[k].separation);
            const lane_vec3<K> weights = {there[k] * share, lane_quotient(yy * y - xy * z, determinant),
                                          lane_quotient(xx * z - xy * y, determinant)};
            plane[0] = plane[0] + weights.x * gap;
            plane[1] = plane[1] + weights.y * gap;
            plane[2] = plane[2] + weights.z * gap;
            const lane_vec3<K> of = stop * weights;
            shares[k][0] = of.x;
            shares[k][1] = of.y;
            shares[k][2] = of.z;
        }
        write(points, maximum, ok, plane, shares);
    }
    /// Answers the speeds, and adds what that comes to to the sum. `left` is 1 in lanes that are left to visits, where
    /// nothing changes; returns whether any is. `at(k)` is the way at point k.
    template <class Point, class Sum, class At, class SpeedAt>
    PHYSICS_HPP_ALWAYS_INLINE bool solve(Point* points, int count, const contact_pass<S, D>& pass,
                                         const P (&unbiased)[D], const P (&displacement)[D], P& left, Sum& sum, At&& at,
                                         SpeedAt&& speed_at) const {
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1));
        left = one;
        if (count == 1) return true;
        P ok = P::load(valid), kept = one, strength = one, changes[capacity];
        P calm = P::broadcast(scalar_traits<S>::max()), sum_of_changes = zero, there = zero, speed[D];
        for (int i = 0; i < D; ++i) speed[i] = unbiased[i];
        if (pass.use_bias) {
            const P rate = P::broadcast(pass.spring.rate);
            for (int i = 0; i < D; ++i) speed[i] = unbiased[i] + rate * (P::load(separation[i]) + displacement[i]);
            kept = P::broadcast(S(1) - pass.spring.impulse_scale);
            strength = P::broadcast(pass.spring.mass_scale);
        }
        for (int k = 0; k < count; ++k) {
            const P before = P::load(points[k].impulse), gap = P::load(points[k].separation) + at(k);
            P asked = P::load(points[k].share[0]) * speed[0];
            for (int i = 1; i < D; ++i) asked = asked + P::load(points[k].share[i]) * speed[i];
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
            sum_of_changes = sum_of_changes + select_greater(is, zero, changes[k], zero);
            there = there + select_greater(is, zero, one, zero);
        }
        // Loads that last are over-relaxed by 1.7, all points alike: those of tall piles travel faster so. From 2 on,
        // rounds end in a limit cycle. Impacts, and what turns the bodies, are answered as they are. Source: Golub,
        // Van Loan, Matrix Computations, 11.2.
        P more = zero;
        if (pass.over_relaxes)
            more = select_greater(calm, zero, sum_of_changes * P::broadcast(S(0.7)) / max(there, one), zero);
        left = select_greater(zero, ok, one, zero);
        const bool any_left = greater(zero, ok).bits() != 0 && !are_inactive(points, count, pass, left, at, speed_at);
        for (int k = 0; k < count; ++k) {
            const P by = changes[k] + select_greater(P::load(points[k].mass), zero, more, zero);
            const P change = select_greater(zero, ok, zero, by);
            (P::load(points[k].impulse) + change).store(points[k].impulse);
            sum.add(points[k], change);
        }
        return any_left;
    }
    /// The same for lanes that are left to visits, and land: that bore nothing as the substep began, or meet or part
    /// fast, and whose gaps all close within it. What lands flat is stopped without a turn, which friction would make a
    /// slide of. Not where the middle's way is longer than the contact is wide: needles turn by more than their gaps
    /// are good for before the substep ends.
    template <class Point, class Sum, class At, class SpeedAt>
    PHYSICS_HPP_ALWAYS_INLINE void solve_landing(Point* points, int count, const contact_pass<S, D>& pass,
                                                 const P (&speed)[D], const P (&displacement)[D], S* start_load,
                                                 const P& half_width, P& left, Sum& sum, At&& at,
                                                 SpeedAt&& speed_at) const {
        if (count == 1) return;
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1)), per_step = P::broadcast(pass.inverse_step);
        const P half_way = lane_abs(speed[0]) * P::broadcast(pass.substep * S(0.5));
        const P rests = select_greater(lane_abs(speed[0]), P::broadcast(pass.impact_speed), zero, P::load(start_load));
        P lands = select_greater(max(rests, -P::load(valid)), zero, zero, left);
        lands = select_greater(half_way, half_width, zero, lands);
        // No early return where no lane lands: g++ 11 and 12 fail to compile it (in gimple_expand_vec_cond_expr).
        P closing[D], changes[capacity];
        for (int i = 0; i < D; ++i) closing[i] = speed[i] + per_step * (P::load(separation[i]) + displacement[i]);
        for (int k = 0; k < count; ++k) {
            changes[k] = P::load(points[k].share[0]) * closing[0];
            for (int i = 1; i < D; ++i) changes[k] = changes[k] + P::load(points[k].share[i]) * closing[i];
            changes[k] = zero - changes[k];
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
            sum.add(points[k], change);
        }
        left = left - lands;
        if (!pass.use_bias) return;
        const P impact = select_greater(-speed[0], P::broadcast(pass.impact_speed), lands, zero);
        select_greater(impact, zero, -one, P::load(start_load)).store(start_load);
    }

private:
    /// Writes the lanes that are good (1, else 0), but for those whose shares the scalar cannot hold.
    template <class K, class Point>
    PHYSICS_HPP_ALWAYS_INLINE void write(Point* points, int count, const K& good, const K (&plane)[D],
                                         const K (&shares)[capacity][D]) {
        using C = typename K::scalar;
        const K zero = K::broadcast(C(0)), maximum = K::broadcast(C(to_double(scalar_traits<S>::max()) / 4));
        K ok = good;
        for (int k = 0; k < count; ++k)
            for (int i = 0; i < D; ++i) ok = select_greater(maximum, lane_abs(shares[k][i]), ok, zero);
        if (greater(ok, zero).bits() == 0) return;
        const auto put = [&](const K& value, S* to) PHYSICS_HPP_INLINE_LAMBDA {
            put_lanes(select_greater(ok, zero, value, lanes_from<K>(to)), to);
        };
        put(zero, valid);
        for (int i = 0; i < D; ++i) {
            put(plane[i], separation[i]);
            for (int k = 0; k < count; ++k) put(shares[k][i], points[k].share[i]);
        }
    }
};

}  // namespace detail

PHYSICS_HPP_END
