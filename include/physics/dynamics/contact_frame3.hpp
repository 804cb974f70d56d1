// Contacts in 3D as their bodies see them, in lanes: their frame, how fast they move, and what impulses come to.
#pragma once

#include "physics/dynamics/body_lanes.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The normal, both tangents, and from the bodies' centres to the middle.
template <class P>
struct contact_frame3 {
    lane_vec3<P> n, t, u, r_a, r_b;

    template <class Block>
    PHYSICS_HPP_ALWAYS_INLINE explicit contact_frame3(const Block& c)
        : n(lane_vec3<P>::load(c.normal)),
          t(lane_vec3<P>::load(c.tangent)),
          u(c.across.of(n, t)),
          r_a(lane_vec3<P>::load(c.r_a)),
          r_b(lane_vec3<P>::load(c.r_b)) {}

    /// How B moves against A at the middle.
    PHYSICS_HPP_ALWAYS_INLINE lane_vec3<P> at_middle(const lane_twist<P, 3>& a, const lane_twist<P, 3>& b) const {
        return (b.linear + cross(b.angular, r_b)) - (a.linear + cross(a.angular, r_a));
    }
};

/// How B moves against A: along the normal at the middle, and about the tangents.
template <class P>
struct contact_motion3 {
    P along, about_t, about_u;

    PHYSICS_HPP_ALWAYS_INLINE contact_motion3(const contact_frame3<P>& f, const lane_twist<P, 3>& a,
                                              const lane_twist<P, 3>& b)
        : along(dot(f.n, f.at_middle(a, b))) {
        const lane_vec3<P> turn = b.angular - a.angular;
        about_t = dot(f.t, turn);
        about_u = dot(f.u, turn);
    }
    PHYSICS_HPP_ALWAYS_INLINE explicit contact_motion3(const lane_vec3<P>& of)
        : along(of.x), about_t(of.y), about_u(of.z) {}
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE P at(const Point& p) const {
        return along + lane_difference(P::load(p.y), about_t, P::load(p.x), about_u);
    }
};

/// What impulses along the normal at points come to at the middle.
template <class P>
struct contact_impulse3 {
    P load, about_t, about_u;

    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE void add(const Point& p, const P& impulse) {
        load = load + impulse;
        about_t = about_t + P::load(p.y) * impulse;
        about_u = about_u - P::load(p.x) * impulse;
    }
};

/// From the middle to points: where they are more than two, in the narrower direction.
template <class P, class Point>
PHYSICS_HPP_ALWAYS_INLINE P half_width_of(const Point* points, int count) {
    P x = lane_abs(P::load(points[0].x)), y = lane_abs(P::load(points[0].y));
    for (int k = 1; k < count; ++k) {
        x = max(x, lane_abs(P::load(points[k].x)));
        y = max(y, lane_abs(P::load(points[k].y)));
    }
    const P longer = max(x, y);
    if (count < 3) return longer;
    return select_greater(P::load(points[2].mass), P::broadcast(typename P::scalar(0)), min(x, y), longer);
}

}  // namespace detail

PHYSICS_HPP_END
