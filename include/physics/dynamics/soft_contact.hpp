// What the contacts of the soft solver have in common in 2D and in 3D.
#pragma once

#include "physics/dynamics/block_solve.hpp"
#include "physics/dynamics/body_lanes.hpp"
#include "physics/dynamics/restitution.hpp"
#include "physics/dynamics/soft_friction.hpp"

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
/// What bounces. Speeds with which the surfaces part at points that meet in this substep (m/s), 0 for none.
template <class S, int Points, int W>
struct soft_bounces {
    /// What surfaces give back, 0 where they cannot meet, and how fast they are drawn together (m/s^2).
    S restitution[W], closing[W];
    S speed[Points][W];

    /// Whether a point that may bounce bears nothing.
    template <class P, class Point>
    PHYSICS_HPP_ALWAYS_INLINE bool any_free(const Point* points, int count) const {
        const P zero = P::broadcast(S(0));
        P any = zero;
        for (int k = 0; k < count; ++k)
            any = max(any, select_greater(P::load(points[k].impulse), zero, zero, P::load(points[k].mass)));
        return greater(min(any, P::load(restitution)), zero).bits() != 0;
    }
    /// Notes the approaches of points that bear nothing yet and meet within the substep, in lanes; true if there are
    /// any. Before contacts change velocities: what stops an approach is not to be what bounces.
    template <class P, class Point, class Pass, class DisplacementAt, class SpeedAt>
    PHYSICS_HPP_ALWAYS_INLINE bool note(const Point* points, int count, const Pass& pass,
                                        DisplacementAt&& displacement_at, SpeedAt&& speed_at) {
        const P zero = P::broadcast(S(0)), slop = P::broadcast(pass.bounce_slop), e = P::load(restitution);
        P any = zero;
        for (int k = 0; k < count; ++k) {
            const P v = speed_at(k), gap = P::load(points[k].separation) + displacement_at(k);
            const P arrives = min(-v - slop, -(v + gap * P::broadcast(pass.inverse_step)));
            const P meets = select_greater(P::load(points[k].impulse), zero, zero, min(arrives, e));
            const P target = select_greater(min(meets, P::load(points[k].mass)), zero, e * -v, zero);
            target.store(speed[k]);
            any = max(any, target);
        }
        if (greater(any, zero).bits() == 0) return false;
        for (int k = 0; k < count; ++k) {
            const P v = speed_at(k), gap = P::load(points[k].separation) + displacement_at(k);
            for (int lane = 0; lane < W; ++lane)
                if (speed[k][lane] > S(0))
                    speed[k][lane] =
                        rebound_speed(restitution[lane], -v.lane(lane), gap.lane(lane), closing[lane], pass.substep);
        }
        return true;
    }
    /// Forgets those that were stopped by others before they met.
    template <class P, class Point>
    PHYSICS_HPP_ALWAYS_INLINE void keep_pushed(const Point* points, int count) {
        const P zero = P::broadcast(S(0));
        for (int k = 0; k < count; ++k)
            select_greater(P::load(points[k].impulse), zero, P::load(speed[k]), zero).store(speed[k]);
    }
    [[nodiscard]] bool has(int lane, int count) const {
        for (int k = 0; k < count; ++k)
            if (speed[k][lane] > S(0)) return true;
        return false;
    }
};
/// Where the bounces of a block are, if it may have any.
template <class S, int Points, int W>
struct bounces_of_block {
    using bounces = soft_bounces<S, Points, W>;

    bounces* at = nullptr;

    /// Writes a contact into a lane. Points that were there in the last step, and overlap, have met before: what
    /// approaches there springs back, as it does in a crowd that is squeezed.
    template <class Contact, class Start>
    void put(int lane, const Contact& c, const body_pair& ends, const Start& with, arena& scratch) {
        const S share = with.surfaces.restitution_of(c);
        bool meets = false;
        for (int k = 0; k < c.count && share > S(0); ++k)
            meets = meets || !c.persisted(k) || c.points[k].separation > -with.overlap;
        if (!meets) return;
        if (at == nullptr) at = new (scratch.template allocate<bounces>(1)) bounces{};
        at->restitution[lane] = share;
        at->closing[lane] = with.closing(c, ends);
    }
};
struct no_bounces_of_block {};
template <class S, int Points, int W, class Features>
using soft_bounces_of = std::conditional_t<Features::restitution, bounces_of_block<S, Points, W>, no_bounces_of_block>;

/// Whether nothing has to be given to any lane of a block when a substep begins, nor be taken back.
template <class P, class Block>
PHYSICS_HPP_ALWAYS_INLINE bool carries_no_impulse(const Block& block) {
    P maximum = load_of<P>(block.points, block.point_count);
    if constexpr (requires { block.friction.max_impulse(1); })
        maximum = max(maximum, block.friction.max_impulse(block.point_count));
    if constexpr (requires { block.extras.at; })
        if (block.extras.at != nullptr) return false;
    return greater(maximum, P::broadcast(typename P::scalar(0))).bits() == 0;
}
/// Symmetric Gauss-Seidel over the points: last to first and back, so that no corner is always solved first. The order
/// turns at the first point, which all lanes have, so it does not depend on which contacts share lanes.
template <class F>
PHYSICS_HPP_ALWAYS_INLINE void symmetric_gauss_seidel(int points, F&& f) {
    for (int i = 1 - points; i < points; ++i) f(i < 0 ? -i : i);
}
/// After an impact only the impulse held before it is warm started; the rest is removed from the next substep's start
/// velocity.
template <class S, int D>
void remove_from_start(twist<S, D>& start_velocity, const solver_body<S, D>& b, vec<S, D> impulse,
                       angular<S, D> moment) {
    for (int i = 0; i < D; ++i) start_velocity.linear[i] += mul<S>(b.inverse_mass, impulse[i]);
    start_velocity.angular += times(b.inverse_inertia, moment);
}
template <class S, int D>
void remove_from_start(linear_twist<S, D>& start_velocity, const solver_body<S, D, false>& b, vec<S, D> impulse) {
    for (int i = 0; i < D; ++i) start_velocity.linear[i] += mul<S>(b.inverse_mass, impulse[i]);
}
/// The change of a point's impulse that its speed along the normal asks for, in lanes that are left to visits (1, else
/// 0).
template <class P, class Point, class Pass, class S = typename P::scalar>
PHYSICS_HPP_ALWAYS_INLINE P next_impulse(Point& point, const P& speed, const P& displacement, const Pass& pass,
                                         const P& left) {
    const P zero = P::broadcast(S(0)), one = P::broadcast(S(1));
    const P gap = P::load(point.separation) + displacement, mass = P::load(point.mass), before = P::load(point.impulse);
    const P closing = gap * P::broadcast(pass.inverse_step);
    P bias = zero, strength = lane_scaled(mass, left), kept = before;
    if (pass.use_bias) {
        bias = max(gap * P::broadcast(pass.spring.rate), P::broadcast(-pass.max_depenetration_speed));
        strength = strength * select_greater(gap, zero, one, P::broadcast(pass.spring.mass_scale));
        kept = before -
               lane_scaled(before, left) * select_greater(gap, zero, zero, P::broadcast(pass.spring.impulse_scale));
    }
    // Once poses have advanced, gaps that nothing has held close are left to the next substep: an approach that is
    // slowed here would bounce with less.
    if (!pass.use_bias) strength = select_greater(zero, gap, strength, select_greater(before, zero, strength, zero));
    const P wanted = select_greater(gap, zero, closing, bias);
    const P impulse = max(kept - strength * (speed + wanted), zero);
    impulse.store(point.impulse);
    return impulse - before;
}
/// Lets the points of a lane that have met part with their speeds, and stops those that this pushes in. `speed_at(k)`
/// gives the speed at a point, `change(k, impulse)` is told of impulses, by which speeds change. Returns which part of
/// the contact's load had stopped what bounces now.
template <class S, class Point, class Bounces, class SpeedAt, class Change>
S bounce_points(Point* points, int count, const Bounces& bounces, int lane, SpeedAt&& speed_at, Change&& change) {
    S impulses[4] = {}, load = S(0), stopped = S(0);
    int own = 0;
    for (int k = 0; k < count; ++k) {
        load += points[k].impulse[lane];
        own += points[k].mass[lane] > S(0) ? 1 : 0;
    }
    // To rounding, which takes five rounds for a cube: what is left turns it, and friction makes a slide of that.
    S last = S(1), total = S(0);
    for (int round = 0; round < (own > 1 ? 32 : 1) && last > total * S(1.0 / (1 << 22)); ++round) {
        last = total = S(0);
        symmetric_gauss_seidel(count, [&](int k) {
            const S target = bounces.speed[k][lane], bears = points[k].impulse[lane];
            if (!(target > S(0) || bears > S(0))) return;
            const S next = max(impulses[k] + points[k].mass[lane] * (target - speed_at(k)), -bears);
            const S by = next - impulses[k];
            change(k, by);
            impulses[k] = next;
            last = max(last, abs(by));
            total = max(total, abs(next));
        });
    }
    for (int k = 0; k < count; ++k) {
        points[k].total[lane] += impulses[k];
        if (bounces.speed[k][lane] > S(0)) stopped += points[k].impulse[lane];
    }
    return load > S(0) ? stopped / load : S(1);
}
/// Ends a substep: adds the loads of the points to the step's impulses.
template <class P, class Point>
PHYSICS_HPP_ALWAYS_INLINE void add_totals(Point* points, int count) {
    for (int k = 0; k < count; ++k) (P::load(points[k].total) + P::load(points[k].impulse)).store(points[k].total);
}

}  // namespace detail

PHYSICS_HPP_END
