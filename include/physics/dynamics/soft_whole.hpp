// All points of a contact at once.
#pragma once

#include "physics/base/pack_mask.hpp"
#include "physics/collide/manifold.hpp"
#include "physics/dynamics/soft_round.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The inverse of a symmetric matrix; false where it is nearly singular, and then nothing is written.
inline bool invert(const double (&m)[2][2], double (&to)[2][2]) {
    const double det = m[0][0] * m[1][1] - m[0][1] * m[0][1];
    if (!(det > 1e-4 * m[0][0] * m[1][1])) return false;
    to[0][0] = m[1][1] / det;
    to[1][1] = m[0][0] / det;
    to[0][1] = to[1][0] = -m[0][1] / det;
    return true;
}
inline bool invert(const double (&m)[3][3], double (&to)[3][3]) {
    const double c0 = m[1][1] * m[2][2] - m[1][2] * m[1][2];
    const double c1 = m[0][2] * m[1][2] - m[0][1] * m[2][2];
    const double c2 = m[0][1] * m[1][2] - m[0][2] * m[1][1];
    const double det = m[0][0] * c0 + m[0][1] * c1 + m[0][2] * c2;
    if (!(det > 1e-4 * m[0][0] * m[1][1] * m[2][2])) return false;
    const double share = 1 / det;
    to[0][0] = c0 * share;
    to[0][1] = to[1][0] = c1 * share;
    to[0][2] = to[2][0] = c2 * share;
    to[1][1] = (m[0][0] * m[2][2] - m[0][2] * m[0][2]) * share;
    to[1][2] = to[2][1] = (m[0][1] * m[0][2] - m[0][0] * m[1][2]) * share;
    to[2][2] = (m[0][0] * m[1][1] - m[0][1] * m[0][1]) * share;
    return true;
}

/// The speeds of a contact's points follow from D numbers, so that the impulses that stop all of them do too: where
/// every point touches and goes on pushing, that is the answer, exact and without iterations. Elsewhere points are
/// visited one by one. It carries heavy loads and keeps columns from swaying, which visits do not. Source: the first
/// case of Catto's block solver (Box2D, 2006), for any number of points.
template <class S, int D, int W>
struct soft_whole {
    using P = pack<S, W>;

    /// The separation at the middle and its slopes, of the plane that fits the points best.
    S separation[D][W];
    /// Less than 0 where points have to be visited.
    S able[W];

    /// How a contact's points answer to impulses: its D speeds to an impulse along the normal at the middle and to
    /// angular ones, and what of these an impulse at a point is.
    struct answers {
        double speeds[D][D];
        double levers[manifold<S, D>::capacity][D];
    };
    template <class Point>
    void put(int lane, Point* points, int count, const answers& of) {
        able[lane] = S(-1);
        if (count < 2) return;
        // The middle of the points is the origin of their levers, so that the first speed is no matter of slopes.
        double fit[D] = {}, spread[D - 1][D - 1] = {};
        for (int k = 0; k < count; ++k) {
            const double* lever = of.levers[k];
            const double gap = to_double(points[k].separation[lane]);
            fit[0] += gap;
            for (int i = 1; i < D; ++i) {
                fit[i] += lever[i] * gap;
                for (int j = 1; j < D; ++j) spread[i - 1][j - 1] += lever[i] * lever[j];
            }
        }
        fit[0] /= count;
        double shares[manifold<S, D>::capacity][D];
        if (!(count < D ? edge(of, fit, spread, shares) : face(count, of, fit, spread, shares))) return;
        const double most = to_double(scalar_traits<S>::max()) / 4;
        for (int k = 0; k < count; ++k)
            for (int i = 0; i < D; ++i)
                if (!(shares[k][i] < most && shares[k][i] > -most)) return;
        able[lane] = S(0);
        for (int i = 0; i < D; ++i) {
            separation[i][lane] = static_cast<S>(fit[i]);
            for (int k = 0; k < count; ++k) points[k].share[i][lane] = static_cast<S>(shares[k][i]);
        }
    }
    /// The changes of the points' impulses that the speeds ask for. `left` is 1 in lanes that are left to visits, and
    /// nothing changes there; returns whether any is. `at(k)` is the way at point k.
    template <class Point, class At>
    PHYSICS_HPP_ALWAYS_INLINE bool next(Point* points, int count, const soft_round<S>& how, P (&speed)[D],
                                        const P (&way)[D], P& left, P* changes, At&& at) const {
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1));
        P ok = P::load(able), kept = one, strength = one;
        if (how.pushes) {
            const P rate = P::broadcast(how.spring.rate);
            for (int i = 0; i < D; ++i) speed[i] = speed[i] + rate * (P::load(separation[i]) + way[i]);
            kept = P::broadcast(S(1) - how.spring.impulse_scale);
            strength = P::broadcast(how.spring.mass_scale);
        }
        for (int k = 0; k < count; ++k) {
            const P before = P::load(points[k].impulse), gap = P::load(points[k].separation) + at(k);
            P asked = P::load(points[k].share[0]) * speed[0];
            for (int i = 1; i < D; ++i) asked = asked + P::load(points[k].share[i]) * speed[i];
            changes[k] = how.pushes ? kept * before - strength * asked - before : zero - asked;
            P good = min(before + changes[k], -gap);
            // Where the limit of the push binds, what the springs ask for is not flat.
            if (how.pushes) good = min(good, gap * P::broadcast(how.spring.rate) + P::broadcast(how.push_speed));
            // Of points that only other lanes have nothing is asked.
            ok = min(ok, select_greater(P::load(points[k].mass), zero, good, zero));
        }
        left = select_greater(zero, ok, one, zero);
        for (int k = 0; k < count; ++k) {
            changes[k] = select_greater(zero, ok, zero, changes[k]);
            (P::load(points[k].impulse) + changes[k]).store(points[k].impulse);
        }
        return greater(zero, ok).bits() != 0;
    }

private:
    /// Of points that span the plane of the contact: what stops its D speeds, shared out with the least squares.
    static bool face(int count, const answers& of, double (&fit)[D], const double (&spread)[D - 1][D - 1],
                     double (&shares)[manifold<S, D>::capacity][D]) {
        double stop[D][D], level[D - 1][D - 1];
        // Points that are all but one would share a turn out in huge impulses.
        for (int i = 1; i < D; ++i)
            if (!(spread[i - 1][i - 1] * of.speeds[i][i] > 1e-3 * of.speeds[0][0])) return false;
        if (!invert(of.speeds, stop) || !flatten(spread, level)) return false;
        double slopes[D - 1] = {}, rows[D][D];
        for (int j = 0; j < D; ++j) rows[0][j] = stop[0][j] / count;
        for (int i = 1; i < D; ++i)
            for (int k = 1; k < D; ++k) slopes[i - 1] += level[i - 1][k - 1] * fit[k];
        for (int i = 1; i < D; ++i) {
            fit[i] = slopes[i - 1];
            for (int j = 0; j < D; ++j) {
                rows[i][j] = 0;
                for (int k = 1; k < D; ++k) rows[i][j] += level[i - 1][k - 1] * stop[k][j];
            }
        }
        for (int k = 0; k < count; ++k)
            for (int j = 0; j < D; ++j) {
                shares[k][j] = 0;
                for (int i = 0; i < D; ++i) shares[k][j] += of.levers[k][i] * rows[i][j];
            }
        return true;
    }
    /// Of two points in space.
    static bool edge(const answers& of, double (&fit)[D], const double (&spread)[D - 1][D - 1],
                     double (&shares)[manifold<S, D>::capacity][D]) {
        double answer[2][2] = {}, stop[2][2], length = 0;
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b)
                for (int i = 0; i < D; ++i)
                    for (int j = 0; j < D; ++j) answer[a][b] += of.levers[a][i] * of.speeds[i][j] * of.levers[b][j];
        for (int i = 1; i < D; ++i) length += spread[i - 1][i - 1];
        if (!(length > 0) || !invert(answer, stop)) return false;
        for (int i = 1; i < D; ++i) fit[i] /= length;
        for (int k = 0; k < 2; ++k)
            for (int j = 0; j < D; ++j) shares[k][j] = stop[k][0] * of.levers[0][j] + stop[k][1] * of.levers[1][j];
        return true;
    }
    static bool flatten(const double (&spread)[1][1], double (&to)[1][1]) {
        to[0][0] = 1 / spread[0][0];
        return true;
    }
    static bool flatten(const double (&spread)[2][2], double (&to)[2][2]) { return invert(spread, to); }
};

}  // namespace detail

PHYSICS_HPP_END
