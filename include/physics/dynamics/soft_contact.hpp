// What the contacts of the soft solver have in common in the plane and in space.
#pragma once

#include "physics/dynamics/body_lanes.hpp"
#include "physics/dynamics/restitution.hpp"
#include "physics/dynamics/soft_friction.hpp"
#include "physics/dynamics/soft_whole.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

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
/// The speeds with which the surfaces part at points after a bounce (m/s), 0 for none.
template <class S, int Points, int W>
struct soft_bounces {
    S speed[Points][W];
};
struct no_soft_bounces {};
template <class S, int Points, int W, class Features>
using soft_bounces_of = std::conditional_t<Features::restitution, soft_bounces<S, Points, W>, no_soft_bounces>;

/// What a contact's points bear together.
template <class P, class Point>
PHYSICS_HPP_ALWAYS_INLINE P load_of(const Point* points, int count) {
    P load = P::load(points[0].impulse);
    for (int k = 1; k < count; ++k) load = load + P::load(points[k].impulse);
    return load;
}
/// Whether nothing has to be given to any lane of a block when a substep begins, nor be taken back.
template <class P, class Block>
PHYSICS_HPP_ALWAYS_INLINE bool bears_nothing(const Block& block) {
    P most = load_of<P>(block.points, block.point_count);
    if constexpr (requires { block.friction.held(1); }) most = max(most, block.friction.held(block.point_count));
    if constexpr (requires { block.extras.at; })
        if (block.extras.at != nullptr) return false;
    return greater(most, P::broadcast(typename P::scalar(0))).bits() == 0;
}
/// Points are visited across and back, so that no corner answers first in all rounds. The way turns at the first point,
/// which all lanes have: it is the same whatever contacts share the lanes.
template <class F>
PHYSICS_HPP_ALWAYS_INLINE void across_and_back(int points, F&& f) {
    for (int i = 1 - points; i < points; ++i) f(i < 0 ? -i : i);
}
/// Less than all of an impulse lasts where surfaces meet with a blow: of its load what was held before. A body then
/// begins the next substep without the rest.
template <class S, int D>
void begin_without(twist<S, D>& begun, const solver_body<S, D>& b, vec<S, D> impulse, angular<S, D> moment) {
    for (int i = 0; i < D; ++i) begun.linear[i] += mul<S>(b.inverse_mass, impulse[i]);
    begun.angular += times(b.inverse_inertia, moment);
}
template <class S, int D>
void begin_without(linear_twist<S, D>& begun, const solver_body<S, D, false>& b, vec<S, D> impulse) {
    for (int i = 0; i < D; ++i) begun.linear[i] += mul<S>(b.inverse_mass, impulse[i]);
}
/// The change of a point's impulse that its speed along the normal asks for, in lanes that are left to visits (1, else
/// 0).
template <class P, class Point, class Round, class S = typename P::scalar>
PHYSICS_HPP_ALWAYS_INLINE P next_impulse(Point& point, const P& speed, const P& way, const Round& how,
                                         const P& left) {
    const P zero = P::broadcast(S(0)), one = P::broadcast(S(1));
    const P gap = P::load(point.separation) + way, mass = P::load(point.mass), before = P::load(point.impulse);
    const P closing = gap * P::broadcast(how.inverse_step);
    P bias = zero, strength = lane_part(mass, left), kept = before;
    if (how.pushes) {
        bias = max(gap * P::broadcast(how.spring.rate), P::broadcast(-how.push_speed));
        strength = strength * select_greater(gap, zero, one, P::broadcast(how.spring.mass_scale));
        kept = before - lane_part(before, left) *
                            select_greater(gap, zero, zero, P::broadcast(how.spring.impulse_scale));
    }
    const P wanted = select_greater(gap, zero, closing, bias);
    const P impulse = max(kept - strength * (speed + wanted), zero);
    impulse.store(point.impulse);
    return impulse - before;
}
/// The same for a bounce: only of points that have pushed, and no more is taken back than they have.
template <class P, class Point>
PHYSICS_HPP_ALWAYS_INLINE P bounce_impulse(Point& point, const P& bounce, const P& speed) {
    using S = typename P::scalar;
    const P zero = P::broadcast(S(0)), before = P::load(point.total);
    const P after = max(before - P::load(point.mass) * (speed - bounce), zero);
    const P total = select_greater(min(bounce, before), zero, after, before);
    total.store(point.total);
    return total - before;
}
/// Ends a substep: adds the loads of the points to the step's impulses.
template <class P, class Point>
PHYSICS_HPP_ALWAYS_INLINE void add_totals(Point* points, int count) {
    for (int k = 0; k < count; ++k)
        (P::load(points[k].total) + P::load(points[k].impulse)).store(points[k].total);
}

}  // namespace detail

PHYSICS_HPP_END
