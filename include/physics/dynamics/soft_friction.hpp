// Friction of the soft solver's contacts, in lanes: of a whole patch at its middle, or of each point.
#pragma once

#include "physics/dynamics/contact_frame2.hpp"
#include "physics/dynamics/contact_frame3.hpp"
#include "physics/dynamics/soft_extras.hpp"

PHYSICS_HPP_BEGIN

/// Friction acts once a contact: at the middle of its points by their whole load, and against twisting by the mean
/// distance of the points from there. Exact where the load is even; costs less than friction at each point.
struct patch_friction {};
/// Friction acts at each point by the point's own load: a spin or an uneven load slows each corner by what it carries.
/// In 2D all points of a contact slip alike, and patch_friction is taken.
struct point_friction {};

namespace detail {

/// What a contact's points bear together.
template <class P, class Point>
PHYSICS_HPP_ALWAYS_INLINE P load_of(const Point* points, int count) {
    P load = P::load(points[0].impulse);
    for (int k = 1; k < count; ++k) load = load + P::load(points[k].impulse);
    return load;
}
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

    void put(int lane, const contact<S, 2, Features>& c, const prepare_input<S, 2, Features>& with) {
        coefficient.put(lane, with.surfaces.friction_of(c));
        impulse[lane] = c.substep_friction;
    }
    /// Works out the rest in lanes.
    template <class K, class Point>
    PHYSICS_HPP_ALWAYS_INLINE void prepare(const contact_lanes2<K>& c, const Point*, int, const K&) {
        const K slide_a = dot(c.r_a, c.n), slide_b = dot(c.r_b, c.n);
        put_lanes(lane_reciprocal(c.mass + c.inertia_a * slide_a * slide_a + c.inertia_b * slide_b * slide_b), stop);
    }
    /// The impulse of a point, as the points share the load.
    S of_point(int lane, int, S borne, S load) const { return load > S(0) ? total[lane] * (borne / load) : S(0); }
    void store_impulses(int lane, contact<S, 2, Features>& c) const { c.substep_friction = impulse[lane]; }
    /// More than 0 where it holds anything.
    PHYSICS_HPP_ALWAYS_INLINE P max_impulse(int) const { return lane_abs(P::load(impulse)); }
    /// The impulse so far.
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE P last(const Point*, int) const {
        return P::load(impulse);
    }
    /// Keeps a share of the impulse of a lane, and tells what it loses.
    template <class Point>
    S reduce_impulses(int lane, const Point*, int, S share) {
        return reduce_to(impulse[lane], share);
    }
    /// The change of the impulse where the surfaces slip by v at the middle, under the points' loads.
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE P next(const P& v, const Point* points, int count, bool use_bias) {
        const P before = P::load(impulse), maximum = coefficient.all() * load_of<P>(points, count);
        const P stopping = P::load(stop) * v * friction_part(lane_abs(before), maximum, use_bias);
        const P after = max(min(before - stopping, maximum), -maximum);
        after.store(impulse);
        if (!use_bias) (P::load(total) + after).store(total);
        return after - before;
    }
};

/// The impulses that stop a slip at these levers.
template <class K, class S, int W>
PHYSICS_HPP_ALWAYS_INLINE void prepare_cone(const contact_lanes3<K>& c, const lane_vec3<K>& r_a,
                                            const lane_vec3<K>& r_b, friction_cone_lanes<S, W>& stop) {
    const lane_vec3<K> t_a = cross(r_a, c.t), t_b = cross(r_b, c.t);
    const lane_vec3<K> u_a = cross(r_a, c.u), u_b = cross(r_b, c.u);
    stop.prepare(c.mass + c.turned(t_a, t_b, t_a, t_b), c.turned(t_a, t_b, u_a, u_b),
                 c.mass + c.turned(u_a, u_b, u_a, u_b));
}

/// Friction of patches in 3D.
template <class S, int W, class Features>
struct soft_patch_friction3 {
    using P = kernel_pack<S, W>;
    using vector = lane_vec3<P>;

    /// The largest friction for an impulse of 1, at the middle and, an angular impulse, about the normal (m).
    coefficient_lanes<S, W, Features> coefficient;
    S twist_arm[W];
    /// The impulses that stop a slip.
    friction_cone_lanes<S, W> stop;
    S stop_twist[W];
    /// Impulses along both tangents and about the normal, of this substep and of the whole step.
    S impulse[3][W], total[3][W];

    void put(int lane, const contact<S, 3, Features>& c, const prepare_input<S, 3, Features>& with) {
        coefficient.put(lane, with.surfaces.friction_of(c));
        const vec<S, 2> before = friction_of(c);
        impulse[0][lane] = before.x * with.share;
        impulse[1][lane] = before.y * with.share;
        impulse[2][lane] = c.twist_impulse * with.share;
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
    vec<S, 2> of_point(int lane, int, S borne, S load) const {
        const S fraction = load > S(0) ? borne / load : S(0);
        return {total[0][lane] * fraction, total[1][lane] * fraction};
    }
    void store_impulses(int lane, contact<S, 3, Features>& c) const { c.twist_impulse = total[2][lane]; }
    /// More than 0 where it holds anything.
    PHYSICS_HPP_ALWAYS_INLINE P max_impulse(int) const {
        return max(lane_abs(P::load(impulse[0])), max(lane_abs(P::load(impulse[1])), lane_abs(P::load(impulse[2]))));
    }
    /// The impulses so far.
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE vector last(const Point*, int) const {
        return vector::load(impulse);
    }
    /// Keeps a share of the impulses of a lane, and tells what they lose.
    template <class Point>
    vec<S, 3> reduce_impulses(int lane, const Point*, int, S share) {
        return {reduce_to(impulse[0][lane], share), reduce_to(impulse[1][lane], share),
                reduce_to(impulse[2][lane], share)};
    }
    /// Their change where the surfaces slip under the points' loads: first it stops the slip at the middle, then the
    /// twist.
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE vector next(const vector& slip, const Point* points, int count, bool) {
        const P load = load_of<P>(points, count), maximum = P::load(twist_arm) * load;
        const vector before = vector::load(impulse);
        const lane_vec2<P> slid = stop.next({before.x, before.y}, {slip.x, slip.y}, coefficient.all() * load);
        const vector after = {slid.x, slid.y, max(min(before.z - P::load(stop_twist) * slip.z, maximum), -maximum)};
        after.store(impulse);
        (vector::load(total) + after).store(total);
        return after - before;
    }
};

/// Friction of points in 3D: each on its own cone, one after the other.
template <class S, int W, class Features>
struct soft_point_friction3 {
    using P = kernel_pack<S, W>;
    using Q = kernel_pack<inverse_of<S>, W>;
    using vector = lane_vec3<P>;

    struct point {
        friction_cone_lanes<S, W> stop;
        /// Impulses of this substep, and of the whole step.
        S impulse[2][W], total[2][W];
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
            for (int i = 0; i < 2; ++i) each[k].impulse[i][lane] = bears ? from.friction_impulse[i] * with.share : S(0);
        }
    }
    template <class K, class Point>
    PHYSICS_HPP_ALWAYS_INLINE void prepare(const contact_lanes3<K>& c, const Point* points, int maximum, const K&) {
        const lane_vec3<K> t_a = cross(c.r_a, c.t), t_b = cross(c.r_b, c.t);
        const lane_vec3<K> u_a = cross(c.r_a, c.u), u_b = cross(c.r_b, c.u);
        lane_symmetric<K, 3>{c.mass + c.turned(t_a, t_b, t_a, t_b), c.mass + c.turned(u_a, u_b, u_a, u_b),
                             c.turned(c.n, c.n, c.n, c.n),          c.turned(t_a, t_b, u_a, u_b),
                             c.turned(t_a, t_b, c.n, c.n),          c.turned(u_a, u_b, c.n, c.n)}
            .store(k_matrix);
        for (int k = 0; k < maximum; ++k) {
            const lane_vec3<K> offset = combine(c.t, lanes_from<K>(points[k].x), c.u, lanes_from<K>(points[k].y));
            prepare_cone(c, c.r_a + offset, c.r_b + offset, each[k].stop);
        }
    }
    vec<S, 2> of_point(int lane, int k, S, S) const { return {each[k].total[0][lane], each[k].total[1][lane]}; }
    void store_impulses(int, contact<S, 3, Features>& c) const { c.twist_impulse = S(0); }
    PHYSICS_HPP_ALWAYS_INLINE P max_impulse(int count) const {
        P maximum = P::broadcast(S(0));
        for (int k = 0; k < count; ++k)
            maximum = max(maximum, max(lane_abs(P::load(each[k].impulse[0])), lane_abs(P::load(each[k].impulse[1]))));
        return maximum;
    }
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE vector last(const Point* points, int count) const {
        vector sum = none();
        for (int k = 0; k < count; ++k) sum = sum + at_middle(points[k], lane_vec2<P>::load(each[k].impulse));
        return sum;
    }
    template <class Point>
    vec<S, 3> reduce_impulses(int lane, const Point* points, int count, S share) {
        vec<S, 3> sum;
        for (int k = 0; k < count; ++k) {
            const S along = reduce_to(each[k].impulse[0][lane], share);
            const S across = reduce_to(each[k].impulse[1][lane], share);
            sum +=
                vec<S, 3>{along, across, difference_of_products(points[k].x[lane], across, points[k].y[lane], along)};
        }
        return sum;
    }
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE vector next(const vector& start, const Point* points, int count, bool) {
        const P mu = coefficient.all();
        vector slip = start, sum = none();
        for (int k = 0; k < count; ++k) {
            const lane_vec2<P> before = lane_vec2<P>::load(each[k].impulse);
            const lane_vec2<P> v = {slip.x - P::load(points[k].y) * slip.z, slip.y + P::load(points[k].x) * slip.z};
            const lane_vec2<P> after = each[k].stop.next(before, v, mu * P::load(points[k].impulse));
            after.store(each[k].impulse);
            (lane_vec2<P>::load(each[k].total) + after).store(each[k].total);
            const vector by = none() + at_middle(points[k], after - before);
            sum = sum + by;
            slip = slip + lane_symmetric<Q, 3>::load(k_matrix) * by;
        }
        return sum;
    }

private:
    PHYSICS_HPP_ALWAYS_INLINE static vector none() {
        const P zero = P::broadcast(S(0));
        return {zero, zero, zero};
    }
    /// What an impulse at a point comes to at the middle.
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE static vector at_middle(const Point& p, const lane_vec2<P>& impulse) {
        return {impulse.x, impulse.y, cross(lane_vec2<P>{P::load(p.x), P::load(p.y)}, impulse)};
    }
};

}  // namespace detail

PHYSICS_HPP_END
