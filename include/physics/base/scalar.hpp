// What a number type must offer to run the engine, and the few operations in which number types differ.
#pragma once

#include <concepts>
#include <cstring>
#include <limits>

#include "physics/base/fixed.hpp"

PHYSICS_HPP_BEGIN

/// Facts about a scalar type. Specialise it for your own:
///   wide       holds products and sums of products without rounding, where the type can; else the scalar itself
///   inverse    holds inverse masses and inertias: finer than the scalar where that is fixed point
///   name()     for tables and cell names
///   epsilon()  the spacing of numbers next to 1
///   max()      the largest number
///   is_finite(x)
///   bits(x)    equal numbers give equal bits, for hashing; both zeros give 0
///   sqrt, floor, sin, cos, tan, exp, log, acos (x) and atan2(y, x), needed only of types the library does not
///   know (see math.hpp)
template <class S>
struct scalar_traits;

template <std::floating_point S>
    requires(!std::same_as<S, long double>)
struct scalar_traits<S> {
    using wide = S;
    using inverse = S;
    static constexpr const char* name() { return sizeof(S) == 4 ? "float" : "double"; }
    static constexpr S epsilon() { return std::numeric_limits<S>::epsilon(); }
    static constexpr S max() { return std::numeric_limits<S>::max(); }
    static constexpr bool is_finite(S x) { return x - x == S(0); }
    static std::uint64_t bits(S x) {
        if (x == S(0)) return 0;
        std::uint64_t result = 0;
        if constexpr (sizeof(S) == 4) {
            std::uint32_t word = 0;
            std::memcpy(&word, &x, sizeof x);
            result = word;
        } else {
            std::memcpy(&result, &x, sizeof x);
        }
        return result;
    }
};

template <class Rep, int FractionBits>
struct scalar_traits<fixed<Rep, FractionBits>> {
    using scalar = fixed<Rep, FractionBits>;
    using wide = wide_fixed<detail::product_integer<Rep, Rep>, 2 * FractionBits>;
    /// Q24.40 for every format: inverse masses from 1e-12 to 8e6.
    using inverse = fixed<std::int64_t, 40>;
    static constexpr const char* name() {
        if constexpr (std::is_same_v<scalar, fixed32>) return "fixed32";
        else if constexpr (std::is_same_v<scalar, fixed16>) return "fixed16";
        else if constexpr (std::is_same_v<scalar, fixed48>) return "fixed48";
        else return "fixed";
    }
    static constexpr scalar epsilon() { return scalar::from_raw(1); }
    static constexpr scalar max() { return scalar::from_raw(std::numeric_limits<Rep>::max()); }
    static constexpr bool is_finite(scalar) { return true; }
    static constexpr std::uint64_t bits(scalar x) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(x.raw()));
    }
};

/// A number type that the engine can run on. It asks only what fixed point can give: explicit construction
/// from int and double, conversion to double for messages, order, + - * /, and scalar_traits. No implicit
/// conversion, no infinity, no NaN.
template <class S>
concept scalar_type = std::regular<S> && std::totally_ordered<S> && requires(S a, const S b) {
    S(1);
    S(0.5);
    { static_cast<double>(b) } -> std::same_as<double>;
    { a + b } -> std::same_as<S>;
    { a - b } -> std::same_as<S>;
    { a* b } -> std::same_as<S>;
    { a / b } -> std::same_as<S>;
    { -b } -> std::same_as<S>;
    a += b;
    a -= b;
    a *= b;
    a /= b;
    typename scalar_traits<S>::wide;
    typename scalar_traits<S>::inverse;
    { scalar_traits<S>::epsilon() } -> std::same_as<S>;
    { scalar_traits<S>::max() } -> std::same_as<S>;
    { scalar_traits<S>::is_finite(b) } -> std::same_as<bool>;
    { scalar_traits<S>::bits(b) } -> std::same_as<std::uint64_t>;
} && !std::integral<S>;

/// The type of exact products of S.
template <class S>
using wide_of = typename scalar_traits<S>::wide;
/// The type of inverse masses and inertias of S.
template <class S>
using inverse_of = typename scalar_traits<S>::inverse;

namespace detail {
/// Scalars whose products have the scalar's own type.
template <class S>
concept self_wide = std::same_as<wide_of<S>, S>;
}  // namespace detail

/// a * b without rounding where S can.
template <detail::self_wide S>
constexpr S product(S a, S b) {
    return a * b;
}
/// A wide number as R, rounded once.
template <class R>
    requires detail::self_wide<R>
constexpr R narrow(R a) { return a; }
/// numerator / denominator as R, rounded once; each may be wide.
template <class R>
    requires detail::self_wide<R>
constexpr R quotient(R numerator, R denominator) { return numerator / denominator; }
/// a * b rounded once to R; the operands may be a scalar and its inverse type.
template <class R, class A, class B>
constexpr R mul(A a, B b) {
    return narrow<R>(product(a, b));
}
/// 1 / a rounded once to R.
template <class R, class A>
constexpr R reciprocal(A a) {
    return quotient<R>(A(1), a);
}
/// a as a wide number, to compare with products.
template <scalar_type S>
constexpr wide_of<S> widen(S a) {
    return product(a, S(1));
}

namespace detail {
/// x as a double. Through an opaque step for floats: the vectoriser of gcc 12 forgets the rounding of floats that are
/// made of doubles and become doubles again in the same function.
template <scalar_type S>
constexpr double to_double(S x) {
#if defined(__GNUC__) && !defined(__clang__)
    if constexpr (std::is_same_v<S, float>)
        if (!std::is_constant_evaluated()) {
#if defined(__SSE2__)
            __asm__("" : "+x"(x));
#elif defined(__aarch64__)
            __asm__("" : "+w"(x));
#else
            __asm__("" : "+m"(x));
#endif
        }
#endif
    return static_cast<double>(x);
}
}  // namespace detail

template <scalar_type S>
constexpr S min(S a, S b) {
    return b < a ? b : a;
}
template <scalar_type S>
constexpr S max(S a, S b) {
    return a < b ? b : a;
}
template <scalar_type S>
constexpr S clamp(S x, S low, S high) {
    return x < low ? low : (high < x ? high : x);
}
template <scalar_type S>
constexpr S abs(S x) {
    return x < S(0) ? -x : x;
}
template <scalar_type S>
constexpr bool is_finite(S x) {
    return scalar_traits<S>::is_finite(x);
}

PHYSICS_HPP_END
