// Friction of the soft solver's contacts, in lanes: of a whole patch at its middle, or of each point.
#pragma once

#include "physics/dynamics/soft_extras.hpp"

PHYSICS_HPP_BEGIN

/// Friction acts once a contact: at the middle of its points by their whole load, and against twisting by the mean
/// distance of the points from there. Exact where the load is even; costs less than friction at each point.
struct patch_friction {};
/// Friction acts at each point by the point's own load: a spin or an uneven load slows each corner by what it carries.
/// In the plane all points of a contact slip alike, and patch_friction is taken.
struct point_friction {};

namespace detail {

/// Without friction.
struct no_soft_friction {};

/// In the plane: an impulse along the tangent at the middle.
template <class S, int W>
struct soft_friction2 {
    using P = pack<S, W>;

    S coefficient[W], stop[W];
    /// Of this substep, and of the whole step.
    S impulse[W], total[W];

    /// The change of the impulse where the surfaces slip by v at the middle, under a load of which that share lasts.
    PHYSICS_HPP_ALWAYS_INLINE P next(const P& v, const P& load, const P& lasting) {
        const P before = P::load(impulse), most = P::load(coefficient) * load;
        const P after = max(min(before - P::load(stop) * v, most), -most);
        (after * lasting).store(impulse);
        (P::load(total) + after).store(total);
        return after - before;
    }
};

/// Along both tangents and about the normal, at the middle: speeds, or impulses.
template <class P>
struct slide_lanes {
    P x, y, twist;
};

/// Last step's friction of the points that are still there and still bear a load.
template <class S, int D>
tangential<S, D> friction_of(const contact<S, D>& c) {
    tangential<S, D> sum{};
    for (int k = 0; k < c.count; ++k)
        if (c.points[k].persisted && c.points[k].load > S(0)) sum += c.points[k].friction_impulse;
    return sum;
}
/// The loads of a contact's points together.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P sum_of(const P* loads, int count) {
    P sum = loads[0];
    for (int k = 1; k < count; ++k) sum = sum + loads[k];
    return sum;
}

/// Friction of patches in space.
template <class S, int W>
struct soft_patch_friction3 {
    using P = pack<S, W>;
    using body = solver_body<S, 3>;

    /// The largest friction for an impulse of 1, at the middle and, an angular impulse, about the normal (m).
    S coefficient[W], twist_arm[W];
    /// The impulses that stop a slip.
    cone_lanes<S, W> stop;
    S stop_twist[W];
    /// Impulses of this substep, and of the whole step.
    S x[W], y[W], twist[W];
    S total_x[W], total_y[W], total_twist[W];

    /// Writes a contact, whose points have been written, into a lane.
    template <class Point>
    void put(int lane, const contact<S, 3>& c, const contact_point<S, 3>& middle, const body& a, const body& b,
             const tangents<S, 3>& frame, const Point* points, S share) {
        using I = inverse_of<S>;
        S reach = S(0);
        for (int k = 0; k < c.count; ++k) reach += length(vec<S, 2>{points[k].x[lane], points[k].y[lane]});
        coefficient[lane] = c.friction;
        twist_arm[lane] = c.friction * reach / S(c.count);
        stop.put(lane, friction3<S>(a, b, middle, frame));
        const I twisted = torque_answer<S>(a.inverse_inertia, c.normal, c.normal) +
                          torque_answer<S>(b.inverse_inertia, c.normal, c.normal);
        stop_twist[lane] = twisted > I(0) ? reciprocal<S>(twisted) : S(0);
        const vec<S, 2> before = friction_of(c);
        x[lane] = before.x * share;
        y[lane] = before.y * share;
        twist[lane] = c.twist_impulse * share;
    }
    /// The impulse of point k, which bears that part of the load; and the one about the normal.
    vec<S, 2> of_point(int lane, int, S part) const { return {total_x[lane] * part, total_y[lane] * part}; }
    S about_normal(int lane) const { return total_twist[lane]; }
    /// The impulses so far.
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE slide_lanes<P> last(const Point*, int) const {
        return {P::load(x), P::load(y), P::load(twist)};
    }
    /// Their change where the surfaces slip under loads of which that share lasts: first it stops the slip at the
    /// middle, then the twist.
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE slide_lanes<P> next(const slide_lanes<P>& slip, const Point*, const P* loads, int count,
                                                  const P& lasting) {
        const P load = sum_of(loads, count);
        const lanes2<P> before = {P::load(x), P::load(y)};
        const lanes2<P> after = stop.next(before, {slip.x, slip.y}, P::load(coefficient) * load);
        (after.x * lasting).store(x);
        (after.y * lasting).store(y);
        const P twisted = P::load(twist), most = P::load(twist_arm) * load;
        const P turned = max(min(twisted - P::load(stop_twist) * slip.twist, most), -most);
        (turned * lasting).store(twist);
        (P::load(total_x) + after.x).store(total_x);
        (P::load(total_y) + after.y).store(total_y);
        (P::load(total_twist) + turned).store(total_twist);
        return {after.x - before.x, after.y - before.y, turned - twisted};
    }
};

/// Friction of points in space: each on its own cone, one after the other.
template <class S, int W>
struct soft_point_friction3 {
    using P = pack<S, W>;
    using Q = pack<inverse_of<S>, W>;
    using body = solver_body<S, 3>;

    struct point {
        cone_lanes<S, W> stop;
        /// Impulses of this substep, and of the whole step.
        S x[W], y[W], total_x[W], total_y[W];
    };

    S coefficient[W];
    /// How the slip at the middle and the twist answer to impulses along both tangents and to one about the normal.
    inverse_of<S> answer[6][W];
    point each[manifold<S, 3>::capacity];

    template <class Point>
    void put(int lane, const contact<S, 3>& c, const contact_point<S, 3>& middle, const body& a, const body& b,
             const tangents<S, 3>& frame, const Point*, S share) {
        coefficient[lane] = c.friction;
        const auto turned = [&](vec<S, 3> of_a, vec<S, 3> of_b, vec<S, 3> about_a, vec<S, 3> about_b) {
            return torque_answer<S>(a.inverse_inertia, of_a, about_a) +
                   torque_answer<S>(b.inverse_inertia, of_b, about_b);
        };
        const vec<S, 3> t_a = cross(middle.lever_a, frame.t), t_b = cross(middle.lever_b, frame.t);
        const vec<S, 3> u_a = cross(middle.lever_a, frame.u), u_b = cross(middle.lever_b, frame.u);
        const inverse_of<S> m = a.inverse_mass + b.inverse_mass;
        answer[0][lane] = m + turned(t_a, t_b, t_a, t_b);
        answer[1][lane] = turned(t_a, t_b, u_a, u_b);
        answer[2][lane] = turned(t_a, t_b, c.normal, c.normal);
        answer[3][lane] = m + turned(u_a, u_b, u_a, u_b);
        answer[4][lane] = turned(u_a, u_b, c.normal, c.normal);
        answer[5][lane] = turned(c.normal, c.normal, c.normal, c.normal);
        for (int k = 0; k < c.count; ++k) {
            const contact_point<S, 3>& from = c.points[k];
            const bool bears = from.persisted && from.load > S(0);
            each[k].stop.put(lane, friction3<S>(a, b, from, frame));
            each[k].x[lane] = bears ? from.friction_impulse.x * share : S(0);
            each[k].y[lane] = bears ? from.friction_impulse.y * share : S(0);
        }
    }
    vec<S, 2> of_point(int lane, int k, S) const { return {each[k].total_x[lane], each[k].total_y[lane]}; }
    S about_normal(int) const { return S(0); }
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE slide_lanes<P> last(const Point* points, int count) const {
        const P zero = P::broadcast(S(0));
        slide_lanes<P> sum{zero, zero, zero};
        for (int k = 0; k < count; ++k) add(sum, points[k], P::load(each[k].x), P::load(each[k].y));
        return sum;
    }
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE slide_lanes<P> next(slide_lanes<P> slip, const Point* points, const P* loads, int count,
                                                  const P& lasting) {
        const P zero = P::broadcast(S(0)), mu = P::load(coefficient);
        slide_lanes<P> sum{zero, zero, zero};
        for (int k = 0; k < count; ++k) {
            const P px = P::load(points[k].x), py = P::load(points[k].y);
            const lanes2<P> before = {P::load(each[k].x), P::load(each[k].y)};
            const lanes2<P> v = {slip.x - py * slip.twist, slip.y + px * slip.twist};
            const lanes2<P> after = each[k].stop.next(before, v, mu * loads[k]);
            (after.x * lasting).store(each[k].x);
            (after.y * lasting).store(each[k].y);
            (P::load(each[k].total_x) + after.x).store(each[k].total_x);
            (P::load(each[k].total_y) + after.y).store(each[k].total_y);
            slide_lanes<P> by{zero, zero, zero};
            add(by, points[k], after.x - before.x, after.y - before.y);
            sum = {sum.x + by.x, sum.y + by.y, sum.twist + by.twist};
            slip = {slip.x + answered(0, 1, 2, by), slip.y + answered(1, 3, 4, by),
                    slip.twist + answered(2, 4, 5, by)};
        }
        return sum;
    }

private:
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE static void add(slide_lanes<P>& sum, const Point& p, const P& x, const P& y) {
        sum = {sum.x + x, sum.y + y, sum.twist + lane_difference(P::load(p.x), y, P::load(p.y), x)};
    }
    PHYSICS_HPP_ALWAYS_INLINE P answered(int i, int j, int k, const slide_lanes<P>& by) const {
        return narrow<S>(product(Q::load(answer[i]), by.x) + product(Q::load(answer[j]), by.y) +
                         product(Q::load(answer[k]), by.twist));
    }
};

template <class S, int W, class Features>
using soft_friction2_of = std::conditional_t<Features::friction, soft_friction2<S, W>, no_soft_friction>;
template <class S, int W, class Features, class Friction>
using soft_friction3_of =
    std::conditional_t<!Features::friction, no_soft_friction,
                       std::conditional_t<std::is_same_v<Friction, point_friction>, soft_point_friction3<S, W>,
                                          soft_patch_friction3<S, W>>>;

}  // namespace detail

PHYSICS_HPP_END
