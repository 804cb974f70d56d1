// All points of a contact at once.
#pragma once

#include "physics/base/pack_mask.hpp"
#include "physics/collide/manifold.hpp"
#include "physics/dynamics/soft_round.hpp"
#include "physics/space/mat.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The speeds of a contact's points follow from D numbers, so that the impulses that stop all of them do too: where
/// every point touches and goes on pushing, that is the answer, exact and without iterations. Elsewhere points are
/// visited one by one. It carries heavy loads and keeps columns from swaying, which visits do not. Source: the first
/// case of the block solver of Catto's Box2D 2, for any number of points.
template <class S, int D, int W>
struct soft_whole {
    using P = pack<S, W>;

    /// The separation at the middle and its slopes, of the plane that fits the points best.
    S separation[D][W];
    /// Less than 0 where points have to be visited.
    S able[W];

    static constexpr int capacity = manifold<S, D>::capacity;
    using row = vec<double, D>;

    /// Two points: `levers` are what an impulse at each is at the middle, along the normal and about the tangents;
    /// `answers` how the speeds answer to it.
    template <class Point>
    void put_edge(int lane, Point* points, const row (&levers)[capacity], const row (&answers)[capacity]) {
        const double own[] = {dot(levers[0], answers[0]), dot(levers[1], answers[1])};
        const double other = dot(levers[0], answers[1]), determinant = own[0] * own[1] - other * other;
        // Points that are all but one would share a turn out in huge impulses.
        if (!(determinant > 1e-4 * own[0] * own[1])) return;
        // The middle of the points is the origin: but for the sign both lie as far from it.
        const row half = (levers[0] - levers[1]) * 0.5;
        const double gaps[] = {to_double(points[0].separation[lane]), to_double(points[1].separation[lane])};
        row plane = half * ((gaps[0] - gaps[1]) / (2 * dot(half, half)));
        plane[0] = 0.5 * (gaps[0] + gaps[1]);
        row shares[capacity];
        for (int k = 0; k < 2; ++k) shares[k] = (levers[k] * own[1 - k] - levers[1 - k] * other) / determinant;
        write(lane, points, 2, plane, shares);
    }
    /// More points, which span the plane of the contact: what stops its speeds, shared out with the least squares.
    /// `answers` tells how the speeds answer to an impulse along the normal at the middle and to angular ones.
    template <class Point>
    void put_face(int lane, Point* points, int count, const row (&levers)[capacity], const symmetric<double>& answers) {
        double xx = 0, xy = 0, yy = 0;
        for (int k = 0; k < count; ++k) {
            xx += levers[k].y * levers[k].y;
            xy += levers[k].y * levers[k].z;
            yy += levers[k].z * levers[k].z;
        }
        const double determinant = xx * yy - xy * xy, small = 1e-3 * answers.xx;
        if (!(xx * answers.yy > small && yy * answers.zz > small && determinant > 1e-4 * xx * yy)) return;
        const symmetric<double> stop = inverse<double>(answers);
        const auto is_apart = [](double answer, double stopped) { return stopped > 0 && answer * stopped < 1e4; };
        if (!is_apart(answers.xx, stop.xx) || !is_apart(answers.yy, stop.yy) || !is_apart(answers.zz, stop.zz)) return;
        row plane{}, shares[capacity];
        for (int k = 0; k < count; ++k) {
            const row part = {1.0 / count, (yy * levers[k].y - xy * levers[k].z) / determinant,
                              (xx * levers[k].z - xy * levers[k].y) / determinant};
            plane += part * to_double(points[k].separation[lane]);
            shares[k] = times(stop, part);
        }
        write(lane, points, count, plane, shares);
    }
    /// Answers the speeds, and adds what that comes to to the sum. `left` is 1 in lanes that are left to visits, where
    /// nothing changes; returns whether any is. `at(k)` is the way at point k.
    template <class Point, class Sum, class At>
    PHYSICS_HPP_ALWAYS_INLINE bool push(Point* points, int count, const soft_round<S>& how, P (&speed)[D],
                                        const P (&way)[D], P& left, Sum& sum, At&& at) const {
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1));
        left = one;
        if (count == 1) return true;
        P ok = P::load(able), kept = one, strength = one, changes[capacity];
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
            const P change = select_greater(zero, ok, zero, changes[k]);
            (P::load(points[k].impulse) + change).store(points[k].impulse);
            sum.add(points[k], change);
        }
        return greater(zero, ok).bits() != 0;
    }

private:
    template <class Point>
    void write(int lane, Point* points, int count, const row& plane, const row (&shares)[capacity]) {
        const double most = to_double(scalar_traits<S>::max()) / 4;
        for (int k = 0; k < count; ++k)
            for (int i = 0; i < D; ++i)
                if (!(shares[k][i] < most && shares[k][i] > -most)) return;
        able[lane] = S(0);
        for (int i = 0; i < D; ++i) {
            separation[i][lane] = static_cast<S>(plane[i]);
            for (int k = 0; k < count; ++k) points[k].share[i][lane] = static_cast<S>(shares[k][i]);
        }
    }
};

}  // namespace detail

PHYSICS_HPP_END
