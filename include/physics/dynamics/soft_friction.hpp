// Friction of the soft solver's contacts, in lanes: of a whole patch at its middle, or of each point.
#pragma once

#include "physics/dynamics/soft_extras.hpp"

PHYSICS_HPP_BEGIN

/// Friction acts once a contact: at the middle of its points by their whole load, and against twisting by the mean
/// distance of the points from there. Exact where the load is even; costs less than friction at each point.
struct patch_friction {};
/// Friction acts at each point by the point's own load: a spin or an uneven load slows each corner by what it carries.
/// In 2D all points of a contact slip alike, and patch_friction is taken.
struct point_friction {};

namespace detail {

/// Keeps a share of an impulse, and tells what it loses by that.
template <class S>
S reduce_to(S& impulse, S share) {
    const S before = impulse;
    impulse *= share;
    return before - impulse;
}

/// Without friction.
struct no_soft_friction {};

/// What friction in 2D answers of a slip where it holds an impulse under a limit: all of it before poses
/// advance, so that nothing creeps. After that only a part where it holds less than half of what it could: where it
/// answers fully in both rounds, wide piles sway sideways for long; what is near slipping, as leaning cards are, would
/// slip.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P friction_part(const P& start_load, const P& limit, bool use_bias) {
    using S = typename P::scalar;
    const P one = P::broadcast(S(1));
    return use_bias ? one : select_greater(limit, start_load * P::broadcast(S(2)), P::broadcast(S(0.7)), one);
}

/// In 3D, what a step begins with: the last one's friction of the points that are still there and bear a load.
template <class S, class Features>
vec<S, 2> friction_of(const contact<S, 3, Features>& c) {
    vec<S, 2> sum{};
    for (int k = 0; k < c.count; ++k)
        if (c.persisted(k) && c.points[k].substep_impulse > S(0)) sum += c.points[k].friction_impulse;
    return sum;
}

/// In 2D: an impulse along the tangent at the middle.
template <class S, int W, class Features>
struct soft_friction2 {
    using P = kernel_pack<S, W>;

    coefficient_lanes<S, W, Features> coefficient;
    S stop[W];
    /// Of this substep, and of the whole step.
    S impulse[W], total[W];

    /// More than 0 where it holds anything.
    PHYSICS_HPP_ALWAYS_INLINE P max_impulse(int) const { return lane_abs(P::load(impulse)); }
    /// The change of the impulse where the surfaces slip by v at the middle, under a load.
    PHYSICS_HPP_ALWAYS_INLINE P next(const P& v, const P& load, bool use_bias) {
        const P before = P::load(impulse), maximum = coefficient.all() * load;
        const P stopping = P::load(stop) * v * friction_part(lane_abs(before), maximum, use_bias);
        const P after = max(min(before - stopping, maximum), -maximum);
        after.store(impulse);
        if (!use_bias) (P::load(total) + after).store(total);
        return after - before;
    }
};

/// Along both tangents and about the normal, at the middle: speeds, or impulses; of one contact, or in lanes.
template <class P>
struct slide_lanes {
    P x, y, twist;
};

/// The loads of a contact's points together.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P sum_of(const P* loads, int count) {
    P sum = loads[0];
    for (int k = 1; k < count; ++k) sum = sum + loads[k];
    return sum;
}

/// The impulses that stop a slip at these levers.
template <class K, class S, int W>
PHYSICS_HPP_ALWAYS_INLINE void prepare_cone(const contact_lanes3<K>& c, const lanes3<K>& r_a, const lanes3<K>& r_b,
                                            friction_cone_lanes<S, W>& stop) {
    const lanes3<K> t_a = lane_cross(r_a, c.t), t_b = lane_cross(r_b, c.t);
    const lanes3<K> u_a = lane_cross(r_a, c.u), u_b = lane_cross(r_b, c.u);
    stop.prepare(c.mass + c.turned(t_a, t_b, t_a, t_b), c.turned(t_a, t_b, u_a, u_b),
                 c.mass + c.turned(u_a, u_b, u_a, u_b));
}

/// Friction of patches in 3D.
template <class S, int W, class Features>
struct soft_patch_friction3 {
    using P = kernel_pack<S, W>;

    /// The largest friction for an impulse of 1, at the middle and, an angular impulse, about the normal (m).
    coefficient_lanes<S, W, Features> coefficient;
    S twist_arm[W];
    /// The impulses that stop a slip.
    friction_cone_lanes<S, W> stop;
    S stop_twist[W];
    /// Impulses of this substep, and of the whole step.
    S x[W], y[W], twist[W];
    S total_x[W], total_y[W], total_twist[W];

    void put(int lane, const contact<S, 3, Features>& c, const prepare_input<S, 3, Features>& with) {
        coefficient.put(lane, with.surfaces.friction_of(c));
        const vec<S, 2> before = friction_of(c);
        x[lane] = before.x * with.share;
        y[lane] = before.y * with.share;
        twist[lane] = c.twist_impulse * with.share;
    }
    /// Works out the rest in lanes.
    template <class K, class Point>
    PHYSICS_HPP_ALWAYS_INLINE void prepare(const contact_lanes3<K>& c, const Point* points, int maximum,
                                           const K& count) {
        K reach = K::broadcast(typename K::scalar(0));
        for (int k = 0; k < maximum; ++k)
            reach = reach + lane_length(lanes_from<K>(points[k].x), lanes_from<K>(points[k].y));
        put_lanes(lane_quotient(coefficient.template as<K>() * reach, count), twist_arm);
        prepare_cone(c, c.r_a, c.r_b, stop);
        put_lanes(lane_reciprocal(c.turned(c.n, c.n, c.n, c.n)), stop_twist);
    }
    /// The impulse of point k, which bears that part of the load; and the one about the normal.
    vec<S, 2> of_point(int lane, int, S fraction) const { return {total_x[lane] * fraction, total_y[lane] * fraction}; }
    S about_normal(int lane) const { return total_twist[lane]; }
    /// More than 0 where it holds anything.
    PHYSICS_HPP_ALWAYS_INLINE P max_impulse(int) const {
        return max(lane_abs(P::load(x)), max(lane_abs(P::load(y)), lane_abs(P::load(twist))));
    }
    /// The impulses so far.
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE slide_lanes<P> last(const Point*, int) const {
        return {P::load(x), P::load(y), P::load(twist)};
    }
    /// Keeps a share of the impulses of a lane, and tells what they lose.
    template <class Point>
    slide_lanes<S> reduce_impulses(int lane, const Point*, int, S share) {
        return {reduce_to(x[lane], share), reduce_to(y[lane], share), reduce_to(twist[lane], share)};
    }
    /// Their change where the surfaces slip under loads: first it stops the slip at the middle, then the twist.
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE slide_lanes<P> next(const slide_lanes<P>& slip, const Point*, const P* loads, int count) {
        const P load = sum_of(loads, count);
        const lanes2<P> before = {P::load(x), P::load(y)};
        const lanes2<P> after = stop.next(before, {slip.x, slip.y}, coefficient.all() * load);
        after.x.store(x);
        after.y.store(y);
        const P twisted = P::load(twist), maximum = P::load(twist_arm) * load;
        const P turned = max(min(twisted - P::load(stop_twist) * slip.twist, maximum), -maximum);
        turned.store(twist);
        (P::load(total_x) + after.x).store(total_x);
        (P::load(total_y) + after.y).store(total_y);
        (P::load(total_twist) + turned).store(total_twist);
        return {after.x - before.x, after.y - before.y, turned - twisted};
    }
};

/// Friction of points in 3D: each on its own cone, one after the other.
template <class S, int W, class Features>
struct soft_point_friction3 {
    using P = kernel_pack<S, W>;
    using Q = kernel_pack<inverse_of<S>, W>;

    struct point {
        friction_cone_lanes<S, W> stop;
        /// Impulses of this substep, and of the whole step.
        S x[W], y[W], total_x[W], total_y[W];
    };

    coefficient_lanes<S, W, Features> coefficient;
    /// How the slip at the middle and the twist answer to impulses along both tangents and to one about the normal.
    inverse_of<S> k_matrix[6][W];
    point each[manifold<S, 3>::capacity];

    void put(int lane, const contact<S, 3, Features>& c, const prepare_input<S, 3, Features>& with) {
        coefficient.put(lane, with.surfaces.friction_of(c));
        for (int k = 0; k < c.count; ++k) {
            const auto& from = c.points[k];
            const bool bears = c.persisted(k) && from.substep_impulse > S(0);
            each[k].x[lane] = bears ? from.friction_impulse.x * with.share : S(0);
            each[k].y[lane] = bears ? from.friction_impulse.y * with.share : S(0);
        }
    }
    template <class K, class Point>
    PHYSICS_HPP_ALWAYS_INLINE void prepare(const contact_lanes3<K>& c, const Point* points, int maximum, const K&) {
        const lanes3<K> t_a = lane_cross(c.r_a, c.t), t_b = lane_cross(c.r_b, c.t);
        const lanes3<K> u_a = lane_cross(c.r_a, c.u), u_b = lane_cross(c.r_b, c.u);
        put_lanes(c.mass + c.turned(t_a, t_b, t_a, t_b), k_matrix[0]);
        put_lanes(c.turned(t_a, t_b, u_a, u_b), k_matrix[1]);
        put_lanes(c.turned(t_a, t_b, c.n, c.n), k_matrix[2]);
        put_lanes(c.mass + c.turned(u_a, u_b, u_a, u_b), k_matrix[3]);
        put_lanes(c.turned(u_a, u_b, c.n, c.n), k_matrix[4]);
        put_lanes(c.turned(c.n, c.n, c.n, c.n), k_matrix[5]);
        for (int k = 0; k < maximum; ++k) {
            const lanes3<K> offset = lane_combine(c.t, lanes_from<K>(points[k].x), c.u, lanes_from<K>(points[k].y));
            prepare_cone(c, lane_add(c.r_a, offset), lane_add(c.r_b, offset), each[k].stop);
        }
    }
    vec<S, 2> of_point(int lane, int k, S) const { return {each[k].total_x[lane], each[k].total_y[lane]}; }
    S about_normal(int) const { return S(0); }
    PHYSICS_HPP_ALWAYS_INLINE P max_impulse(int count) const {
        P maximum = P::broadcast(S(0));
        for (int k = 0; k < count; ++k)
            maximum = max(maximum, max(lane_abs(P::load(each[k].x)), lane_abs(P::load(each[k].y))));
        return maximum;
    }
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE slide_lanes<P> last(const Point* points, int count) const {
        const P zero = P::broadcast(S(0));
        slide_lanes<P> sum{zero, zero, zero};
        for (int k = 0; k < count; ++k) add(sum, points[k], P::load(each[k].x), P::load(each[k].y));
        return sum;
    }
    template <class Point>
    slide_lanes<S> reduce_impulses(int lane, const Point* points, int count, S share) {
        slide_lanes<S> sum{};
        for (int k = 0; k < count; ++k) {
            const S along = reduce_to(each[k].x[lane], share), across = reduce_to(each[k].y[lane], share);
            sum.x += along;
            sum.y += across;
            sum.twist += difference_of_products(points[k].x[lane], across, points[k].y[lane], along);
        }
        return sum;
    }
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE slide_lanes<P> next(const slide_lanes<P>& start, const Point* points, const P* loads,
                                                  int count) {
        const P zero = P::broadcast(S(0)), mu = coefficient.all();
        slide_lanes<P> slip = start;
        slide_lanes<P> sum{zero, zero, zero};
        for (int k = 0; k < count; ++k) {
            const P px = P::load(points[k].x), py = P::load(points[k].y);
            const lanes2<P> before = {P::load(each[k].x), P::load(each[k].y)};
            const lanes2<P> v = {slip.x - py * slip.twist, slip.y + px * slip.twist};
            const lanes2<P> after = each[k].stop.next(before, v, mu * loads[k]);
            after.x.store(each[k].x);
            after.y.store(each[k].y);
            (P::load(each[k].total_x) + after.x).store(each[k].total_x);
            (P::load(each[k].total_y) + after.y).store(each[k].total_y);
            slide_lanes<P> by{zero, zero, zero};
            add(by, points[k], after.x - before.x, after.y - before.y);
            sum = {sum.x + by.x, sum.y + by.y, sum.twist + by.twist};
            slip = {slip.x + times_k(0, 1, 2, by), slip.y + times_k(1, 3, 4, by), slip.twist + times_k(2, 4, 5, by)};
        }
        return sum;
    }

private:
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE static void add(slide_lanes<P>& sum, const Point& p, const P& x, const P& y) {
        sum = {sum.x + x, sum.y + y, sum.twist + lane_difference(P::load(p.x), y, P::load(p.y), x)};
    }
    PHYSICS_HPP_ALWAYS_INLINE P times_k(int i, int j, int k, const slide_lanes<P>& by) const {
        return narrow<S>(product(Q::load(k_matrix[i]), by.x) + product(Q::load(k_matrix[j]), by.y) +
                         product(Q::load(k_matrix[k]), by.twist));
    }
};

template <class S, int W, class Features>
using soft_friction2_of = std::conditional_t<Features::friction, soft_friction2<S, W, Features>, no_soft_friction>;
template <class S, int W, class Features, class Friction>
using soft_friction3_of =
    std::conditional_t<!Features::friction, no_soft_friction,
                       std::conditional_t<std::is_same_v<Friction, point_friction>,
                                          soft_point_friction3<S, W, Features>, soft_patch_friction3<S, W, Features>>>;

}  // namespace detail

PHYSICS_HPP_END
