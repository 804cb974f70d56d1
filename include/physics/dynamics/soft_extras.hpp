// What only some contacts of the soft solver have, in lanes: running surfaces, resistance to rolling.
#pragma once

#include "physics/base/arena.hpp"
#include "physics/base/probe.hpp"
#include "physics/dynamics/contact_pass.hpp"
#include "physics/dynamics/friction.hpp"
#include "physics/dynamics/running_surface.hpp"
#include "physics/dynamics/soft_prepare.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A circular cone in lanes.
template <class S, int W>
struct friction_cone_lanes {
    using P = kernel_pack<S, W>;

    S xx[W], xy[W], yy[W], gradient_step[W];

    void put(int lane, const friction_cone<S>& cone) {
        xx[lane] = cone.xx;
        xy[lane] = cone.xy;
        yy[lane] = cone.yy;
        gradient_step[lane] = cone.gradient_step;
    }
    /// Of the speeds' answers to unit impulses, as friction_cone.
    template <class K>
    PHYSICS_HPP_ALWAYS_INLINE void prepare(const K& kxx, const K& kxy, const K& kyy) {
        using C = typename K::scalar;
        const K determinant = kxx * kyy - kxy * kxy, half = K::broadcast(C(0.5));
        put_lanes(lane_quotient(kyy, determinant), xx);
        put_lanes(lane_quotient(-kxy, determinant), xy);
        put_lanes(lane_quotient(kxx, determinant), yy);
        const K zero = K::broadcast(C(0)), greatest = half * (kxx + kyy) + lane_length(half * (kxx - kyy), kxy);
        put_lanes(select_greater(determinant, zero, lane_reciprocal(greatest), zero), gradient_step);
    }
    /// The impulses that follow those before where the speeds are v: they stop them, or slide on the cone.
    PHYSICS_HPP_ALWAYS_INLINE lane_vec2<P> next(const lane_vec2<P>& before, const lane_vec2<P>& v,
                                                const P& limit) const {
        const lane_vec2<P> stick = before - lane_symmetric<P, 2>{P::load(xx), P::load(yy), P::load(xy)} * v;
        if (lane_is_longer(stick.x, stick.y, limit).bits() == 0) return stick;
        const lane_vec2<P> slide = before - v * P::load(gradient_step);
        const P sliding = length(slide), sticking = length(stick);
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1));
        const P share = select_greater(sliding, limit, limit / select_greater(sliding, zero, sliding, one), one);
        return select_greater(sticking, limit, slide * share, stick);
    }
};

/// A coefficient of each of W contacts, or the one that all contacts have in common.
template <class S, int W, class Features>
struct coefficient_lanes {
    using P = kernel_pack<S, W>;

    S of[W];

    void put(int lane, S value) { of[lane] = value; }
    PHYSICS_HPP_ALWAYS_INLINE P all() const { return P::load(of); }
    template <class K>
    PHYSICS_HPP_ALWAYS_INLINE K as() const {
        return lanes_from<K>(of);
    }
};
template <class S, int W, class Features>
    requires(!Features::materials)
struct coefficient_lanes<S, W, Features> {
    using P = kernel_pack<S, W>;

    S common;

    void put(int, S value) { common = value; }
    PHYSICS_HPP_ALWAYS_INLINE P all() const { return P::broadcast(common); }
    template <class K>
    PHYSICS_HPP_ALWAYS_INLINE K as() const {
        return K::broadcast(static_cast<typename K::scalar>(to_double(common)));
    }
};

/// How fast surfaces run along the tangents as a step begins (m/s), and how that changes (m/s^2).
template <class S, int W, int D>
struct belt_lanes {
    using P = kernel_pack<S, W>;

    S along[D - 1][W], change[D - 1][W];

    template <class Features>
    void put(int lane, const contact<S, D, Features>& c, const tangential<S, D>& changes) {
        for (int i = 0; i < D - 1; ++i) {
            along[i][lane] = component(value_of(c.surface_velocity), i);
            change[i][lane] = component(changes, i);
        }
    }
    /// The slip against them some time after the step began, in 2D and in 3D.
    PHYSICS_HPP_ALWAYS_INLINE void take_from(P& slip, S elapsed) const { slip = slip - at(0, elapsed); }
    template <class Slip>
    PHYSICS_HPP_ALWAYS_INLINE void take_from(Slip& slip, S elapsed) const {
        slip.x = slip.x - at(0, elapsed);
        slip.y = slip.y - at(1, elapsed);
    }

private:
    static S component(S of, int) { return of; }
    static S component(const vec<S, 2>& of, int i) { return of[i]; }
    PHYSICS_HPP_ALWAYS_INLINE P at(int i, S elapsed) const {
        return P::load(along[i]) + P::load(change[i]) * P::broadcast(elapsed);
    }
};

/// Resistance to rolling. Lanes without it stay as they are, to the bit, so that they do not depend on their
/// neighbours.
template <class S, int W, int D, class Features>
struct rolling_lanes {
    using P = kernel_pack<S, W>;

    coefficient_lanes<S, W, Features> arm;
    S inertia[W];
    /// Of this substep, and of the whole step.
    S impulse[W], total[W];

    void put(int lane, const contact<S, 2, Features>& c, S resistance, const rolling2<S>& with, S share) {
        arm.put(lane, resistance);
        inertia[lane] = with.inertia;
        impulse[lane] = c.rolling_impulse * share;
    }
    void store_impulses(int lane, contact<S, 2, Features>& c) const { c.rolling_impulse = total[lane]; }
    PHYSICS_HPP_ALWAYS_INLINE void add_to(lane_vec2<P>& sum) const { sum.y = sum.y + P::load(impulse); }
    /// The change of the angular impulse where B turns by w against A.
    PHYSICS_HPP_ALWAYS_INLINE P next(const P& w, const P& load) {
        const P before = P::load(impulse), reach = arm.all(), maximum = reach * load, zero = P::broadcast(S(0));
        const P after = max(min(before - P::load(inertia) * w, maximum), -maximum);
        const P now = select_greater(reach, zero, after, before);
        now.store(impulse);
        (P::load(total) + now).store(total);
        return after - before;
    }
};
template <class S, int W, class Features>
struct rolling_lanes<S, W, 3, Features> {
    using P = kernel_pack<S, W>;

    coefficient_lanes<S, W, Features> arm;
    friction_cone_lanes<S, W> stop;
    /// Of this substep, and of the whole step.
    S impulse[2][W], total[2][W];

    void put(int lane, const contact<S, 3, Features>& c, S resistance, const rolling3<S>& with, S share) {
        arm.put(lane, resistance);
        stop.put(lane, with);
        for (int i = 0; i < 2; ++i) impulse[i][lane] = c.rolling_impulse[i] * share;
    }
    void store_impulses(int lane, contact<S, 3, Features>& c) const {
        c.rolling_impulse = {total[0][lane], total[1][lane]};
    }
    PHYSICS_HPP_ALWAYS_INLINE void add_to(lane_vec3<P>& sum) const {
        sum.y = sum.y + P::load(impulse[0]);
        sum.z = sum.z + P::load(impulse[1]);
    }
    PHYSICS_HPP_ALWAYS_INLINE lane_vec2<P> next(const lane_vec2<P>& w, const P& load) {
        using vector = lane_vec2<P>;
        const vector before = vector::load(impulse);
        const P reach = arm.all();
        const vector after = select_greater(reach, P::broadcast(S(0)), stop.next(before, w, reach * load), before);
        after.store(impulse);
        (vector::load(total) + after).store(total);
        return after - before;
    }
};

/// In place of what a recipe leaves out.
template <int Which>
struct absent_base {};

/// Rows that few contacts need (rolling resistance, belts) are allocated apart; other blocks pay one null check.
template <class S, int W, int D, class Features>
struct soft_extras : std::conditional_t<Features::rolling_resistance, rolling_lanes<S, W, D, Features>, absent_base<0>>,
                     std::conditional_t<Features::surface_velocity, belt_lanes<S, W, D>, absent_base<1>> {
    using rolling = rolling_lanes<S, W, D, Features>;
    using belt = belt_lanes<S, W, D>;
    using body = solver_body<S, D, Features::rotation>;

    static bool needed_by(const contact<S, D, Features>& c, const body& a, const body& b,
                          const prepare_input<S, D, Features>& with) {
        if constexpr (Features::surface_velocity)
            if (value_of(c.surface_velocity) != tangential<S, D>{} || turns_by_itself(a) || turns_by_itself(b))
                return true;
        return with.surfaces.rolling_resistance_of(c) > S(0);
    }
    void put(int lane, const contact<S, D, Features>& c, [[maybe_unused]] const body& a, [[maybe_unused]] const body& b,
             [[maybe_unused]] const prepare_input<S, D, Features>& with) {
        if constexpr (Features::rolling_resistance)
            if (const S resistance = with.surfaces.rolling_resistance_of(c); resistance > S(0))
                rolling::put(lane, c, resistance, rolling_at<S, D>(a, b, tangents<S, D>(c.normal)), with.share);
        if constexpr (Features::surface_velocity) belt::put(lane, c, slip_change(c, a, b, with.step));
    }
};

/// Where the extras of a block are, if it has any.
template <class S, int W, int D, class Features>
struct extras_of_block {
    using extras = soft_extras<S, W, D, Features>;
    using body = typename extras::body;

    extras* at = nullptr;

    // Named apart for g++ 11, which cannot say at->rolling::x.
    [[nodiscard]] const typename extras::rolling& rolling() const { return *at; }
    [[nodiscard]] const typename extras::belt& belt() const { return *at; }

    void put(int lane, const contact<S, D, Features>& c, const body& a, const body& b,
             const prepare_input<S, D, Features>& with, arena& scratch) {
        if (extras::needed_by(c, a, b, with)) add(lane, c, a, b, with, scratch);
    }
    void store_impulses(int lane, contact<S, D, Features>& c) const {
        if constexpr (Features::rolling_resistance)
            if (at != nullptr) at->extras::rolling::store_impulses(lane, c);
    }

private:
    PHYSICS_HPP_NOINLINE void add(int lane, const contact<S, D, Features>& c, const body& a, const body& b,
                                  const prepare_input<S, D, Features>& with, arena& scratch) {
        if (at == nullptr) at = new (scratch.template allocate<extras>(1)) extras{};
        at->put(lane, c, a, b, with);
    }
};
template <class S, int W, int D, class Features>
    requires(!Features::rolling_resistance && !Features::surface_velocity)
struct extras_of_block<S, W, D, Features> {
    template <class Body>
    void put(int, const contact<S, D, Features>&, const Body&, const Body&, const prepare_input<S, D, Features>&,
             arena&) {}
    void store_impulses(int, contact<S, D, Features>&) const {}
};

}  // namespace detail

PHYSICS_HPP_END
