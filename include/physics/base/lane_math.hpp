// Short formulas in lanes.
#pragma once

#include "physics/base/pack_mask.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The magnitude of each lane; of both zeros the same zero.
template <class S, int W, int Bytes>
PHYSICS_HPP_ALWAYS_INLINE pack<S, W, Bytes> lane_abs(const pack<S, W, Bytes>& x) {
    if constexpr (!std::is_floating_point_v<S>) {
        return max(x, -x);
    } else if constexpr (W == 1) {
        using bits = std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>;
        return {detail::bit_cast<S>(detail::bit_cast<bits>(x.value) & ~detail::bit_cast<bits>(S(-0.0)))};
    } else if constexpr (requires { x.low; }) {
        return {lane_abs(x.low), lane_abs(x.high)};
    } else {
        using lanes = decltype(x.value < x.value);
        const auto sign = pack<S, W, Bytes>::broadcast(S(-0.0));
        return {reinterpret_cast<typename pack<S, W, Bytes>::storage>(reinterpret_cast<lanes>(x.value) &
                                                                      ~reinterpret_cast<lanes>(sign.value))};
    }
}
/// Four scalars as lanes.
template <class P, class S = typename P::scalar>
PHYSICS_HPP_ALWAYS_INLINE P lanes_of(S a, S b, S c, S d) {
    if constexpr (!requires(P x) { x.low; }) return {typename P::storage{a, b, c, d}};
    else if constexpr (requires(P x) { x.low.low; }) return {{{a}, {b}}, {{c}, {d}}};
    else return {{typename P::half::storage{a, b}}, {typename P::half::storage{c, d}}};
}
/// Lanes of scalars of one type from or to such of another.
template <class K, class T>
PHYSICS_HPP_ALWAYS_INLINE K lanes_from(const T* from) {
    using C = typename K::scalar;
    if constexpr (std::is_same_v<C, T>) {
        return K::load(from);
    } else if constexpr (K::width == 1) {
        return {static_cast<C>(to_double(*from))};
    } else if constexpr (requires(K x) { x.low; }) {
        return {lanes_from<typename K::half>(from), lanes_from<typename K::half>(from + K::width / 2)};
    } else if constexpr (K::width == 2) {
        return {typename K::storage{static_cast<C>(from[0]), static_cast<C>(from[1])}};
    } else {
        const typename lane_storage<T, K::width>::type lanes =
            *reinterpret_cast<const typename lane_storage<T, K::width>::unaligned*>(from);
        return {PHYSICS_HPP_CONVERT(lanes, typename K::storage)};
    }
}
/// Lanes in another type.
template <class P, class K>
PHYSICS_HPP_ALWAYS_INLINE P lanes_to(const K& x) {
    using S = typename P::scalar;
    if constexpr (std::is_same_v<P, K>) {
        return x;
    } else if constexpr (P::width == 1) {
        return {S(x.value)};
    } else if constexpr (requires(P p) { p.low; }) {
        return {lanes_to<typename P::half>(x.low), lanes_to<typename P::half>(x.high)};
    } else if constexpr (!requires { x.low; }) {
        return {PHYSICS_HPP_CONVERT(x.value, typename P::storage)};
    } else if constexpr (P::width == 4) {
        return lanes_of<P>(S(x.lane(0)), S(x.lane(1)), S(x.lane(2)), S(x.lane(3)));
    } else {
        using half = pack<S, P::width / 2, 16>;
        return join<P>(lanes_to<half>(x.low), lanes_to<half>(x.high));
    }
}
template <class K, class T>
PHYSICS_HPP_ALWAYS_INLINE void put_lanes(const K& lanes, T* to) {
    if constexpr (std::is_same_v<typename K::scalar, T>) lanes.store(to);
    else
        for (int i = 0; i < K::width; ++i) to[i] = static_cast<T>(lanes.lane(i));
}
/// a * b + c * d, rounded once where the scalar can.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P lane_sum(const P& a, const P& b, const P& c, const P& d) {
    return narrow<typename P::scalar>(product(a, b) + product(c, d));
}
/// a * b - c * d, rounded once where the scalar can.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P lane_difference(const P& a, const P& b, const P& c, const P& d) {
    return narrow<typename P::scalar>(product(a, b) - product(c, d));
}
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P lane_dot(const P* a, const P& x, const P& y, const P& z) {
    return narrow<typename P::scalar>(product(a[0], x) + product(a[1], y) + product(a[2], z));
}
/// a / b where b is greater than 0, else 0.
template <class K>
PHYSICS_HPP_ALWAYS_INLINE K lane_quotient(const K& a, const K& b) {
    using C = typename K::scalar;
    const K zero = K::broadcast(C(0)), one = K::broadcast(C(1));
    return select_greater(b, zero, a / select_greater(b, zero, b, one), zero);
}
template <class K>
PHYSICS_HPP_ALWAYS_INLINE K lane_reciprocal(const K& x) {
    return lane_quotient(K::broadcast(typename K::scalar(1)), x);
}
/// The length of (a, b).
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P lane_length(const P& a, const P& b) {
    // One lane takes the root of what has not been rounded yet.
    if constexpr (P::width == 1)
        return {root<typename P::scalar>(product(a.value, a.value) + product(b.value, b.value))};
    else return sqrt(a * a + b * b);
}
/// Where (a, b) is longer than that.
template <class S, int W, int Bytes>
PHYSICS_HPP_ALWAYS_INLINE pack_mask<S, W, Bytes> lane_is_longer(const pack<S, W, Bytes>& a, const pack<S, W, Bytes>& b,
                                                                const pack<S, W, Bytes>& length) {
    if constexpr (is_fixed<S>)
        return {is_root_greater(product(a.value, a.value) + product(b.value, b.value), length.value)};
    else return greater(lane_length(a, b), length);
}
/// x * share; one lane is left as it is where the share is all of it.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P lane_scaled(const P& x, const P& share) {
    if constexpr (P::width == 1)
        if (share.value == typename P::scalar(1)) return x;
    return x * share;
}
/// The largest lane.
template <class S, int W, int Bytes>
PHYSICS_HPP_ALWAYS_INLINE S largest_lane(const pack<S, W, Bytes>& x) {
    if constexpr (W == 1) return x.value;
    else if constexpr (requires { x.low; }) return largest_lane(max(x.low, x.high));
    else if constexpr (W == 2) return max(x.lane(0), x.lane(1));
    else if constexpr (sizeof x == 32) return largest_lane(max(half_of<false>(x), half_of<true>(x)));
    else return max(max(x.lane(0), x.lane(2)), max(x.lane(1), x.lane(3)));
}

}  // namespace detail

PHYSICS_HPP_END
