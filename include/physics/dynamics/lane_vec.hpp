// Vectors, twists and symmetric matrices in lanes, with the operators that their scalar twins have.
#pragma once

#include "physics/base/lane_math.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

template <class P, int D>
struct lane_vec;
template <class P>
struct lane_vec<P, 2> {
    P x, y;

    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE static lane_vec load(const T (&from)[2][P::width]) {
        return {lanes_from<P>(from[0]), lanes_from<P>(from[1])};
    }
    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE void store(T (&to)[2][P::width]) const {
        put_lanes(x, to[0]);
        put_lanes(y, to[1]);
    }
};
template <class P>
struct lane_vec<P, 3> {
    P x, y, z;

    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE static lane_vec load(const T (&from)[3][P::width]) {
        return {lanes_from<P>(from[0]), lanes_from<P>(from[1]), lanes_from<P>(from[2])};
    }
    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE void store(T (&to)[3][P::width]) const {
        put_lanes(x, to[0]);
        put_lanes(y, to[1]);
        put_lanes(z, to[2]);
    }
};
template <class P>
using lane_vec2 = lane_vec<P, 2>;
template <class P>
using lane_vec3 = lane_vec<P, 3>;

template <class P, int D>
PHYSICS_HPP_ALWAYS_INLINE lane_vec<P, D> operator+(const lane_vec<P, D>& a, const lane_vec<P, D>& b) {
    if constexpr (D == 2) return {a.x + b.x, a.y + b.y};
    else return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class P, int D>
PHYSICS_HPP_ALWAYS_INLINE lane_vec<P, D> operator-(const lane_vec<P, D>& a, const lane_vec<P, D>& b) {
    if constexpr (D == 2) return {a.x - b.x, a.y - b.y};
    else return {a.x - b.x, a.y - b.y, a.z - b.z};
}
/// Each component rounded once; the factor may be of the inverse type.
template <class P, int D, class T, int W, int Bytes>
PHYSICS_HPP_ALWAYS_INLINE lane_vec<P, D> operator*(const lane_vec<P, D>& v, const pack<T, W, Bytes>& s) {
    using S = typename P::scalar;
    if constexpr (D == 2) return {mul<S>(s, v.x), mul<S>(s, v.y)};
    else return {mul<S>(s, v.x), mul<S>(s, v.y), mul<S>(s, v.z)};
}
/// Rounded once where the scalar can, as the cross product's components are.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P dot(const lane_vec2<P>& a, const lane_vec2<P>& b) {
    return lane_sum(a.x, b.x, a.y, b.y);
}
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P dot(const lane_vec3<P>& a, const lane_vec3<P>& b) {
    return narrow<typename P::scalar>(product(a.x, b.x) + product(a.y, b.y) + product(a.z, b.z));
}
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P cross(const lane_vec2<P>& a, const lane_vec2<P>& b) {
    return lane_difference(a.x, b.y, a.y, b.x);
}
template <class P>
PHYSICS_HPP_ALWAYS_INLINE lane_vec3<P> cross(const lane_vec3<P>& a, const lane_vec3<P>& b) {
    return {lane_difference(a.y, b.z, a.z, b.y), lane_difference(a.z, b.x, a.x, b.z),
            lane_difference(a.x, b.y, a.y, b.x)};
}
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P length(const lane_vec2<P>& v) {
    return lane_length(v.x, v.y);
}
/// a times s, plus b times t, rounded once where the scalar can.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE lane_vec3<P> combine(const lane_vec3<P>& a, const P& s, const lane_vec3<P>& b, const P& t) {
    return {lane_sum(a.x, s, b.x, t), lane_sum(a.y, s, b.y, t), lane_sum(a.z, s, b.z, t)};
}
/// a / b where b is greater than 0, else 0.
template <class P, int D>
PHYSICS_HPP_ALWAYS_INLINE lane_vec<P, D> lane_quotient(const lane_vec<P, D>& a, const P& b) {
    if constexpr (D == 2) return {lane_quotient(a.x, b), lane_quotient(a.y, b)};
    else return {lane_quotient(a.x, b), lane_quotient(a.y, b), lane_quotient(a.z, b)};
}
/// a > b ? v : w in each lane.
template <class P, int D>
PHYSICS_HPP_ALWAYS_INLINE lane_vec<P, D> select_greater(const P& a, const P& b, const lane_vec<P, D>& v,
                                                        const lane_vec<P, D>& w) {
    if constexpr (D == 2) return {select_greater(a, b, v.x, w.x), select_greater(a, b, v.y, w.y)};
    else return {select_greater(a, b, v.x, w.x), select_greater(a, b, v.y, w.y), select_greater(a, b, v.z, w.z)};
}

/// Velocities, or displacements, of W bodies.
template <class P, int D>
struct lane_twist {
    lane_vec<P, D> linear;
    std::conditional_t<D == 2, P, lane_vec<P, D>> angular;
};
template <class P, int D>
PHYSICS_HPP_ALWAYS_INLINE lane_twist<P, D> operator+(const lane_twist<P, D>& a, const lane_twist<P, D>& b) {
    return {a.linear + b.linear, a.angular + b.angular};
}
template <class P, int D>
PHYSICS_HPP_ALWAYS_INLINE lane_twist<P, D> operator*(const lane_twist<P, D>& v, const P& s) {
    return {v.linear * s, v.angular * s};
}

/// Symmetric D x D matrices.
template <class P, int D>
struct lane_symmetric;
template <class P>
struct lane_symmetric<P, 2> {
    P xx, yy, xy;

    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE static lane_symmetric load(const T (&from)[3][P::width]) {
        return {lanes_from<P>(from[0]), lanes_from<P>(from[1]), lanes_from<P>(from[2])};
    }
    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE void store(T (&to)[3][P::width]) const {
        put_lanes(xx, to[0]);
        put_lanes(yy, to[1]);
        put_lanes(xy, to[2]);
    }
};
template <class P>
struct lane_symmetric<P, 3> {
    P xx, yy, zz, xy, xz, yz;

    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE static lane_symmetric load(const T (&from)[6][P::width]) {
        return {lanes_from<P>(from[0]), lanes_from<P>(from[1]), lanes_from<P>(from[2]),
                lanes_from<P>(from[3]), lanes_from<P>(from[4]), lanes_from<P>(from[5])};
    }
    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE void store(T (&to)[6][P::width]) const {
        put_lanes(xx, to[0]);
        put_lanes(yy, to[1]);
        put_lanes(zz, to[2]);
        put_lanes(xy, to[3]);
        put_lanes(xz, to[4]);
        put_lanes(yz, to[5]);
    }
};
template <class P>
PHYSICS_HPP_ALWAYS_INLINE lane_symmetric<P, 3> operator+(const lane_symmetric<P, 3>& a, const lane_symmetric<P, 3>& b) {
    return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
}
/// Each component rounded once where the scalar can; the matrix may be of the inverse type.
template <class Q, class P>
PHYSICS_HPP_ALWAYS_INLINE lane_vec2<P> operator*(const lane_symmetric<Q, 2>& m, const lane_vec2<P>& v) {
    using S = typename P::scalar;
    return {narrow<S>(product(m.xx, v.x) + product(m.xy, v.y)), narrow<S>(product(m.xy, v.x) + product(m.yy, v.y))};
}
template <class Q, class P>
PHYSICS_HPP_ALWAYS_INLINE lane_vec3<P> operator*(const lane_symmetric<Q, 3>& m, const lane_vec3<P>& v) {
    const auto row = [&](const Q& x, const Q& y, const Q& z) PHYSICS_HPP_INLINE_LAMBDA {
        return narrow<typename P::scalar>(product(x, v.x) + product(y, v.y) + product(z, v.z));
    };
    return {row(m.xx, m.xy, m.xz), row(m.xy, m.yy, m.yz), row(m.xz, m.yz, m.zz)};
}
/// The inverse of positive definite matrices; of others anything. By L D L^T, as in mat.hpp.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE lane_symmetric<P, 3> lane_inverse(const lane_symmetric<P, 3>& m) {
    const P e1 = lane_reciprocal(m.xx), l21 = m.xy * e1, l31 = m.xz * e1;
    const P e2 = lane_reciprocal(m.yy - l21 * m.xy), left = m.yz - l21 * m.xz, l32 = left * e2;
    const P e3 = lane_reciprocal(m.zz - l31 * m.xz - l32 * left);
    const P m31 = l21 * l32 - l31, xz = e3 * m31, yz = -(e3 * l32), xy = -(e2 * l21) - xz * l32;
    return {e1 + e2 * l21 * l21 + xz * m31, e2 - yz * l32, e3, xy, xz, yz};
}

}  // namespace detail

PHYSICS_HPP_END
