// Bounces: how fast surfaces part that meet, alone and in lanes.
#pragma once

#include "physics/base/arena.hpp"
#include "physics/base/lane_math.hpp"
#include "physics/base/pack_mask.hpp"
#include "physics/dynamics/contact.hpp"
#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The speed with which surfaces part that meet at speed v within a substep of h: e times that with which they would
/// meet at the end of the gap, if they are drawn together with acceleration a and each substep moves them with the
/// velocity at its end. So heights fall as e^2, whatever phase of the substep they meet in. Source: the invariant of
/// semi-implicit Euler in a uniform field, v^2 / 2 + a y - v a h / 2.
template <class S>
S rebound_speed(S restitution, S v, S gap, S a, S h) {
    if (a == S(0)) return restitution * v;
    const S half = mul<S>(a, h) * S(0.5), fall = gap > S(0) ? root<S>(product(abs(a + a), gap)) : S(0), mean = v - half;
    if (!(mean > S(0))) return restitution * v;
    if (a > S(0)) return half + restitution * root<S>(product(mean, mean) + product(fall, fall));
    return mean > fall ? max(half + restitution * (sqrt(mean - fall) * sqrt(mean + fall)), S(0)) : S(0);
}

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

/// Symmetric Gauss-Seidel over the points: last to first and back, so that no corner is always solved first. The order
/// turns at the first point, which all lanes have, so it does not depend on which contacts share lanes.
template <class F>
PHYSICS_HPP_ALWAYS_INLINE void symmetric_gauss_seidel(int points, F&& f) {
    for (int i = 1 - points; i < points; ++i) f(i < 0 ? -i : i);
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
        points[k].total[lane] = solver_api::added_load(points[k].total[lane], impulses[k]);
        if (bounces.speed[k][lane] > S(0)) stopped += points[k].impulse[lane];
    }
    return load > S(0) ? stopped / load : S(1);
}

}  // namespace detail

PHYSICS_HPP_END
