// Contacts in 2D as their bodies see them, in lanes: their frame, how fast they move, and what impulses come to.
#pragma once

#include "physics/dynamics/block_solve.hpp"
#include "physics/dynamics/body_lanes.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// W contacts that are prepared together, and how their bodies answer to impulses at the middles.
template <class K>
struct contact_lanes2 {
    lane_vec2<K> n, r_a, r_b;
    K mass, inertia_a, inertia_b;

    PHYSICS_HPP_ALWAYS_INLINE lane_symmetric<K, 2> k_matrix() const {
        const K turn_a = cross(r_a, n), turn_b = cross(r_b, n);
        return {mass + inertia_a * turn_a * turn_a + inertia_b * turn_b * turn_b, inertia_a + inertia_b,
                inertia_a * turn_a + inertia_b * turn_b};
    }
    /// Of a point that is so far from the middle.
    PHYSICS_HPP_ALWAYS_INLINE lane_vec2<K> jacobian(const lane_vec2<K>& offset) const {
        return {K::broadcast(typename K::scalar(1)), cross(offset, n)};
    }
};

/// Where W contacts are. B moves against A with two speeds: along the normal at the contact's middle, and turning;
/// impulses are one along the normal and an angular one.
template <class S, int W>
struct contact_frame2 {
    using scalar = S;
    using I = inverse_of<S>;
    using P = kernel_pack<S, W>;
    using Q = kernel_pack<I, W>;
    static constexpr int dimension = 2, width = W, capacity = manifold<S, 2>::capacity;
    static constexpr bool rotates = true;
    using vector = lane_vec2<P>;
    using bodies = body_pair_lanes<P, 2>;
    using motion_rows = S[2][W];
    using speeds = vec<S, 2>;
    using direct_solve = block_solve<S, 2, W>;
    using k_matrix_type = k_matrix_lanes<S, 2, W>;
    /// Along the tangent, at the middle: a speed or an impulse.
    using slide = S;
    /// Whether friction acts while overlaps are pushed apart.
    static constexpr bool slides_with_bias = true;

    struct point : soft_point<S, 2, W> {
        /// The lever that an impulse along the normal has about the middle (m).
        S moment_arm[W];

        template <class K>
        PHYSICS_HPP_ALWAYS_INLINE void put_jacobian(const lane_vec2<K>& j) {
            put_lanes(j.y, moment_arm);
        }
        PHYSICS_HPP_ALWAYS_INLINE P speed(const vector& v) const { return v.x + P::load(moment_arm) * v.y; }
        PHYSICS_HPP_ALWAYS_INLINE vector at_middle(const P& by) const { return {by, P::load(moment_arm) * by}; }
        S speed(int lane, vec<S, 2> v) const { return v.x + moment_arm[lane] * v.y; }
        vec<S, 2> at_middle(int lane, S by) const { return {by, moment_arm[lane] * by}; }
    };

    S normal[2][W];
    /// From the bodies' centres to the middle (m).
    S r_a[2][W], r_b[2][W];
    I mass_a[W], mass_b[W], inertia_a[W], inertia_b[W];

    PHYSICS_HPP_ALWAYS_INLINE static vector none() {
        const P zero = P::broadcast(S(0));
        return {zero, zero};
    }
    PHYSICS_HPP_ALWAYS_INLINE static P along(const vector& speeds) { return speeds.x; }
    template <class K>
    PHYSICS_HPP_ALWAYS_INLINE contact_lanes2<K> prepare() {
        const K mass = lanes_from<K>(mass_a) + lanes_from<K>(mass_b);
        return {lane_vec2<K>::load(normal), lane_vec2<K>::load(r_a), lane_vec2<K>::load(r_b), mass,
                lanes_from<K>(inertia_a),   lanes_from<K>(inertia_b)};
    }
    /// From the middle to its points.
    PHYSICS_HPP_ALWAYS_INLINE static P half_width(const point* points, int) {
        return lane_abs(P::load(points[0].moment_arm));
    }

    /// The normal, and the levers of impulses along it and along the tangent (y, -x).
    struct lanes {
        const contact_frame2& of;
        vector n;
        P turn_a, turn_b, slide_a, slide_b;

        PHYSICS_HPP_ALWAYS_INLINE explicit lanes(const contact_frame2& c) : of(c), n(vector::load(c.normal)) {
            const vector to_a = vector::load(c.r_a), to_b = vector::load(c.r_b);
            turn_a = cross(to_a, n);
            turn_b = cross(to_b, n);
            slide_a = -dot(to_a, n);
            slide_b = -dot(to_b, n);
        }
        PHYSICS_HPP_ALWAYS_INLINE vector motion(const lane_twist<P, 2>& a, const lane_twist<P, 2>& b) const {
            return {dot(n, b.linear - a.linear) + lane_difference(turn_b, b.angular, turn_a, a.angular),
                    b.angular - a.angular};
        }
        PHYSICS_HPP_ALWAYS_INLINE P slip(const lane_twist<P, 2>& a, const lane_twist<P, 2>& b) const {
            return cross(b.linear - a.linear, n) + lane_difference(slide_b, b.angular, slide_a, a.angular);
        }
        /// How surfaces roll that turn against each other, and what moment an impulse against it makes.
        PHYSICS_HPP_ALWAYS_INLINE P rolling(const P& turn) const { return turn; }
        PHYSICS_HPP_ALWAYS_INLINE P rolling_moment(const P& impulse) const { return impulse; }
        /// The angular velocities that a moment gives.
        PHYSICS_HPP_ALWAYS_INLINE P spin_a(const P& moment) const { return mul<S>(Q::load(of.inertia_a), moment); }
        PHYSICS_HPP_ALWAYS_INLINE P spin_b(const P& moment) const { return mul<S>(Q::load(of.inertia_b), moment); }

        /// Impulses from A on B, along the normal, along the tangent, or both.
        PHYSICS_HPP_ALWAYS_INLINE void apply(const vector& sum, const P& across, bodies& at) const {
            const vector impulse = {lane_sum(n.x, sum.x, n.y, across), lane_difference(n.y, sum.x, n.x, across)};
            auto& [v_a, w_a] = at.a.velocity;
            auto& [v_b, w_b] = at.b.velocity;
            v_a = v_a - impulse * Q::load(of.mass_a);
            v_b = v_b + impulse * Q::load(of.mass_b);
            w_a = w_a - spin_a(lane_sum(turn_a, sum.x, slide_a, across) + sum.y);
            w_b = w_b + spin_b(lane_sum(turn_b, sum.x, slide_b, across) + sum.y);
        }
        PHYSICS_HPP_ALWAYS_INLINE void apply(const vector& sum, bodies& at) const {
            apply(sum, P::broadcast(S(0)), at);
        }
        PHYSICS_HPP_ALWAYS_INLINE void apply_friction(const P& across, bodies& at) const {
            const P zero = P::broadcast(S(0));
            apply({zero, zero}, across, at);
        }
    };

    /// The frame of one contact.
    struct single {
        vec<S, 2> n, r_a, r_b;

        single(const contact_frame2& c, int i)
            : n(c.normal[0][i], c.normal[1][i]), r_a(c.r_a[0][i], c.r_a[1][i]), r_b(c.r_b[0][i], c.r_b[1][i]) {}
        vec<S, 2> motion(const twist<S, 2>& a, const twist<S, 2>& b) const {
            return {dot(n, velocity_at(b, r_b) - velocity_at(a, r_a)), b.angular - a.angular};
        }
        /// Impulse and moment at the middle.
        twist<S, 2> impulse(vec<S, 2> sum) const { return {n * sum.x, sum.y}; }
        twist<S, 2> impulse(vec<S, 2> sum, S across) const { return {n * sum.x + perpendicular(n) * across, sum.y}; }
        /// About the bodies' centres.
        twist<S, 2> on_a(const twist<S, 2>& by) const { return {-by.linear, -(cross(r_a, by.linear) + by.angular)}; }
        twist<S, 2> on_b(const twist<S, 2>& by) const { return {by.linear, cross(r_b, by.linear) + by.angular}; }
    };
};

}  // namespace detail

PHYSICS_HPP_END
