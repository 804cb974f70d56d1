// Contacts in 3D as their bodies see them, in lanes: their frame, how fast they move, and what impulses come to.
#pragma once

#include "physics/dynamics/block_solve.hpp"
#include "physics/dynamics/body_lanes.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// W contacts that are prepared together, and how their bodies answer to impulses at the middles.
template <class K>
struct contact_lanes3 {
    lane_vec3<K> n, t, u, r_a, r_b;
    K mass;
    lane_symmetric<K, 3> inertia_a, inertia_b;

    /// How fast B turns about some axes against A by angular impulses about others.
    PHYSICS_HPP_ALWAYS_INLINE K turned(const lane_vec3<K>& of_a, const lane_vec3<K>& of_b, const lane_vec3<K>& about_a,
                                       const lane_vec3<K>& about_b) const {
        return dot(inertia_a * of_a, about_a) + dot(inertia_b * of_b, about_b);
    }
    PHYSICS_HPP_ALWAYS_INLINE lane_symmetric<K, 3> k_matrix() const {
        const lane_vec3<K> turn_a = cross(r_a, n), turn_b = cross(r_b, n);
        const lane_vec3<K> by_a = inertia_a * turn_a, by_b = inertia_b * turn_b;
        const lane_symmetric<K, 3> inertia = inertia_a + inertia_b;
        const lane_vec3<K> by_n = by_a + by_b, by_t = inertia * t, by_u = inertia * u;
        return {mass + dot(turn_a, by_a) + dot(turn_b, by_b),
                dot(t, by_t),
                dot(u, by_u),
                dot(t, by_n),
                dot(u, by_n),
                dot(u, by_t)};
    }
    /// Of a point that is so far from the middle.
    PHYSICS_HPP_ALWAYS_INLINE lane_vec3<K> jacobian(const lane_vec3<K>& offset) const {
        return {K::broadcast(typename K::scalar(1)), dot(offset, u), -dot(offset, t)};
    }
};

/// The first tangent of normals in 3D, as tangents3 has it.
template <class K>
PHYSICS_HPP_ALWAYS_INLINE lane_vec3<K> lane_tangent(const lane_vec3<K>& n) {
    const K zero = K::broadcast(typename K::scalar(0)), x = lane_abs(n.x), z = lane_abs(n.z);
    const K from = select_greater(x, z, n.y, n.z), to = select_greater(x, z, n.x, n.y);
    const K length = lane_length(from, to), back = lane_quotient(-from, length), on = lane_quotient(to, length);
    return {select_greater(x, z, back, zero), select_greater(x, z, on, back), select_greater(x, z, zero, on)};
}

/// The second tangent, which is the product of the normal and the first one: worked out where that costs less than to
/// read it.
template <class S, int W>
struct second_tangent {
    void prepare(const S (&)[3][W], const S (&)[3][W]) {}
    template <class P>
    PHYSICS_HPP_ALWAYS_INLINE lane_vec3<P> of(const lane_vec3<P>& n, const lane_vec3<P>& t) const {
        return cross(n, t);
    }
};
template <class S, int W>
struct kept_second_tangent {
    S kept[3][W];

    PHYSICS_HPP_ALWAYS_INLINE void prepare(const S (&normal)[3][W], const S (&tangent)[3][W]) {
        using P = kernel_pack<S, W>;
        const lane_vec3<P> u = cross(lane_vec3<P>::load(normal), lane_vec3<P>::load(tangent));
        u.store(kept);
    }
    template <class P>
    PHYSICS_HPP_ALWAYS_INLINE lane_vec3<P> of(const lane_vec3<P>&, const lane_vec3<P>&) const {
        return lane_vec3<P>::load(kept);
    }
};
template <class S, int W>
using second_tangent_of =
    std::conditional_t<std::is_floating_point_v<S>, second_tangent<S, W>, kept_second_tangent<S, W>>;

/// Where W contacts are. B moves against A with three speeds: along the normal at the contact's middle, and turning
/// about both tangents; impulses are one along the normal and angular ones about the tangents.
template <class S, int W>
struct contact_frame3 {
    using scalar = S;
    using I = inverse_of<S>;
    using P = kernel_pack<S, W>;
    using Q = kernel_pack<I, W>;
    static constexpr int dimension = 3, width = W, capacity = manifold<S, 3>::capacity;
    static constexpr bool rotates = true;
    using vector = lane_vec3<P>;
    using bodies = body_pair_lanes<P, 3>;
    using motion_rows = S[3][W];
    using speeds = vec<S, 3>;
    using direct_solve = block_solve<S, 3, W>;
    using k_matrix_type = k_matrix_lanes<S, 3, W>;
    /// Along both tangents at the middle, and about the normal: speeds or impulses.
    using slide = vec<S, 3>;
    /// While overlaps are pushed apart friction rests: else boxes that stand on four others sway, and piles of them
    /// slide apart.
    static constexpr bool slides_with_bias = false;

    struct point : soft_point<S, 3, W> {
        /// Along both tangents, from the middle (m).
        S x[W], y[W];

        template <class K>
        PHYSICS_HPP_ALWAYS_INLINE void put_jacobian(const lane_vec3<K>& j) {
            put_lanes(-j.z, x);
            put_lanes(j.y, y);
        }
        PHYSICS_HPP_ALWAYS_INLINE P speed(const vector& v) const {
            return v.x + lane_difference(P::load(y), v.y, P::load(x), v.z);
        }
        PHYSICS_HPP_ALWAYS_INLINE vector at_middle(const P& by) const {
            return {by, P::load(y) * by, -(P::load(x) * by)};
        }
        S speed(int lane, vec<S, 3> v) const { return v.x + difference_of_products(y[lane], v.y, x[lane], v.z); }
        vec<S, 3> at_middle(int lane, S by) const { return {by, y[lane] * by, -(x[lane] * by)}; }
    };

    S normal[3][W], tangent[3][W];
    [[no_unique_address]] second_tangent_of<S, W> across;
    /// From the bodies' centres to the middle, on either surface (m).
    S r_a[3][W], r_b[3][W];
    I mass_a[W], mass_b[W], inertia_a[6][W], inertia_b[6][W];

    PHYSICS_HPP_ALWAYS_INLINE static vector none() {
        const P zero = P::broadcast(S(0));
        return {zero, zero, zero};
    }
    PHYSICS_HPP_ALWAYS_INLINE static P along(const vector& speeds) { return speeds.x; }
    template <class K>
    PHYSICS_HPP_ALWAYS_INLINE contact_lanes3<K> prepare() {
        const lane_vec3<K> n = lane_vec3<K>::load(normal), t = lane_tangent(n);
        t.store(tangent);
        across.prepare(normal, tangent);
        const K mass = lanes_from<K>(mass_a) + lanes_from<K>(mass_b);
        return {n,
                t,
                cross(n, t),
                lane_vec3<K>::load(r_a),
                lane_vec3<K>::load(r_b),
                mass,
                lane_symmetric<K, 3>::load(inertia_a),
                lane_symmetric<K, 3>::load(inertia_b)};
    }
    /// From the middle to points: where they are more than two, in the narrower direction.
    PHYSICS_HPP_ALWAYS_INLINE static P half_width(const point* points, int count) {
        P x = lane_abs(P::load(points[0].x)), y = lane_abs(P::load(points[0].y));
        for (int k = 1; k < count; ++k) {
            x = max(x, lane_abs(P::load(points[k].x)));
            y = max(y, lane_abs(P::load(points[k].y)));
        }
        const P longer = max(x, y);
        if (count < 3) return longer;
        return select_greater(P::load(points[2].mass), P::broadcast(S(0)), min(x, y), longer);
    }

    /// The normal, both tangents, and from the bodies' centres to the middle.
    struct lanes {
        const contact_frame3& of;
        vector n, t, u, r_a, r_b;

        PHYSICS_HPP_ALWAYS_INLINE explicit lanes(const contact_frame3& c)
            : of(c),
              n(vector::load(c.normal)),
              t(vector::load(c.tangent)),
              u(c.across.of(n, t)),
              r_a(vector::load(c.r_a)),
              r_b(vector::load(c.r_b)) {}

        PHYSICS_HPP_ALWAYS_INLINE vector at_middle(const lane_twist<P, 3>& a, const lane_twist<P, 3>& b) const {
            return (b.linear + cross(b.angular, r_b)) - (a.linear + cross(a.angular, r_a));
        }
        PHYSICS_HPP_ALWAYS_INLINE vector motion(const lane_twist<P, 3>& a, const lane_twist<P, 3>& b) const {
            const vector turn = b.angular - a.angular;
            return {dot(n, at_middle(a, b)), dot(t, turn), dot(u, turn)};
        }
        PHYSICS_HPP_ALWAYS_INLINE vector slip(const lane_twist<P, 3>& a, const lane_twist<P, 3>& b) const {
            const vector v = at_middle(a, b);
            return {dot(t, v), dot(u, v), dot(n, b.angular - a.angular)};
        }
        /// How surfaces roll that turn against each other, and what moment an impulse against it makes.
        PHYSICS_HPP_ALWAYS_INLINE lane_vec2<P> rolling(const vector& turn) const {
            return {dot(t, turn), dot(u, turn)};
        }
        PHYSICS_HPP_ALWAYS_INLINE vector rolling_moment(const lane_vec2<P>& impulse) const {
            return combine(t, impulse.x, u, impulse.y);
        }
        /// The angular velocities that a moment gives.
        PHYSICS_HPP_ALWAYS_INLINE vector spin_a(const vector& moment) const {
            return lane_symmetric<Q, 3>::load(of.inertia_a) * moment;
        }
        PHYSICS_HPP_ALWAYS_INLINE vector spin_b(const vector& moment) const {
            return lane_symmetric<Q, 3>::load(of.inertia_b) * moment;
        }

        /// Impulses from A on B, along and about the normal and the tangents, at the middle.
        PHYSICS_HPP_ALWAYS_INLINE void apply(const vector& sum, const vector& slide, bodies& at) const {
            give(n * sum.x + combine(t, slide.x, u, slide.y), combine(t, sum.y, u, sum.z) + n * slide.z, at);
        }
        PHYSICS_HPP_ALWAYS_INLINE void apply(const vector& sum, bodies& at) const {
            give(n * sum.x, combine(t, sum.y, u, sum.z), at);
        }
        PHYSICS_HPP_ALWAYS_INLINE void apply_friction(const vector& slide, bodies& at) const {
            give(combine(t, slide.x, u, slide.y), n * slide.z, at);
        }

    private:
        PHYSICS_HPP_ALWAYS_INLINE void give(const vector& impulse, const vector& moment, bodies& at) const {
            auto& [v_a, w_a] = at.a.velocity;
            auto& [v_b, w_b] = at.b.velocity;
            v_a = v_a - impulse * Q::load(of.mass_a);
            v_b = v_b + impulse * Q::load(of.mass_b);
            w_a = w_a - spin_a(cross(r_a, impulse) + moment);
            w_b = w_b + spin_b(cross(r_b, impulse) + moment);
        }
    };

    /// The frame of one contact.
    struct single {
        vec<S, 3> n, t, u, r_a, r_b;

        single(const contact_frame3& c, int i)
            : n(at(c.normal, i)), t(at(c.tangent, i)), u(cross(n, t)), r_a(at(c.r_a, i)), r_b(at(c.r_b, i)) {}
        vec<S, 3> motion(const twist<S, 3>& a, const twist<S, 3>& b) const {
            const vec<S, 3> turn = b.angular - a.angular;
            return {dot(n, velocity_at(b, r_b) - velocity_at(a, r_a)), dot(t, turn), dot(u, turn)};
        }
        /// Impulse and moment at the middle.
        twist<S, 3> impulse(vec<S, 3> sum) const { return {n * sum.x, t * sum.y + u * sum.z}; }
        twist<S, 3> impulse(vec<S, 3> sum, vec<S, 3> slide) const {
            return {n * sum.x + t * slide.x + u * slide.y, t * sum.y + u * sum.z + n * slide.z};
        }
        /// About the bodies' centres.
        twist<S, 3> on_a(const twist<S, 3>& by) const { return {-by.linear, -(cross(r_a, by.linear) + by.angular)}; }
        twist<S, 3> on_b(const twist<S, 3>& by) const { return {by.linear, cross(r_b, by.linear) + by.angular}; }

    private:
        static vec<S, 3> at(const S (&rows)[3][W], int i) { return {rows[0][i], rows[1][i], rows[2][i]}; }
    };
};

}  // namespace detail

PHYSICS_HPP_END
