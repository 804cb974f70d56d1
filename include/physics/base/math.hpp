// Elementary functions and constants for every scalar: the same bits on every compiler and processor.
#pragma once

#include <concepts>

#include "physics/base/math_fixed.hpp"
#include "physics/base/math_real.hpp"
#include "physics/base/scalar.hpp"

PHYSICS_HPP_BEGIN

// Errors are in units in the last place of the result and hold over the whole range, huge arguments included.
//   float   computed in double, rounded once: <= 0.501 ulp
//   double  <= 1 ulp; sqrt <= 0.5
//   fixed   sqrt <= 0.5 ulp; the others <= 0.51 where the format has up to 48 fraction bits and the result at
//           most 56 bits, <= 2 at the limits of the representation. A result out of range saturates, and the
//           audit counts it.
// Cost, on one core of 2022: float 3-10 ns, double 4-19, Q32.32 7-33; two to four times that for fixed point where
// there is no __int128.
// Float and double take and return infinities, NaN, signed zeros and subnormal numbers as IEEE 754 has it.
// Fixed point has no NaN: an argument outside the domain gives what is said below, and the audit counts it.
// Scalars of your own go to scalar_traits<S>.

namespace detail {
template <class S>
inline constexpr bool is_fixed = false;
template <class Rep, int FractionBits>
inline constexpr bool is_fixed<fixed<Rep, FractionBits>> = true;
/// Double keeps the tails of its results, float needs none.
template <class S>
inline constexpr bool is_precise = sizeof(S) > sizeof(float);

/// pi * 2^shift in S, to nearest; saturates.
template <class S>
constexpr S pi_times(int shift) {
    const double factor = shift == 0 ? 1 : shift < 0 ? 0.5 : 2;
    if constexpr (is_fixed<S>) {
        const uint128 twice = words128(0x6487ed5110b4611a, 0x62633145c06e0e68);  // 2 pi as a count of 2^-124
        return S::from_raw(
            signed_saturating<typename S::rep>(false, rounded<S::fraction_bits, 124>(twice >> (1 - shift))));
    } else {
        return S(3.14159265358979323846 * factor);
    }
}
}  // namespace detail

/// The circle constant, correctly rounded. A format too small for it gets its largest number.
template <class S>
inline const S pi = detail::pi_times<S>(0);
template <std::floating_point S>
inline constexpr S pi<S> = detail::pi_times<S>(0);
template <class Rep, int FractionBits>
inline constexpr fixed<Rep, FractionBits> pi<fixed<Rep, FractionBits>> = detail::pi_times<fixed<Rep, FractionBits>>(0);

/// A quarter turn in radians, correctly rounded.
template <class S>
inline const S half_pi = detail::pi_times<S>(-1);
template <std::floating_point S>
inline constexpr S half_pi<S> = detail::pi_times<S>(-1);
template <class Rep, int FractionBits>
inline constexpr fixed<Rep, FractionBits> half_pi<fixed<Rep, FractionBits>> =
    detail::pi_times<fixed<Rep, FractionBits>>(-1);

/// A full turn in radians, correctly rounded. A format too small for it gets its largest number.
template <class S>
inline const S two_pi = detail::pi_times<S>(1);
template <std::floating_point S>
inline constexpr S two_pi<S> = detail::pi_times<S>(1);
template <class Rep, int FractionBits>
inline constexpr fixed<Rep, FractionBits> two_pi<fixed<Rep, FractionBits>> =
    detail::pi_times<fixed<Rep, FractionBits>>(1);

/// The square root, correctly rounded. Negative numbers: NaN, in fixed point 0.
template <scalar_type S>
constexpr S sqrt(S x) {
    if constexpr (std::floating_point<S>) return detail::hardware_root(x);
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_root<typename S::rep, S::fraction_bits>(x.raw()));
    else return scalar_traits<S>::sqrt(x);
}
/// The square root of a wide number, for scalars that are their own wide type.
template <class R>
    requires detail::self_wide<R>
constexpr R root(R a) { return sqrt(a); }

/// The largest whole number not above x.
template <scalar_type S>
constexpr S floor(S x) {
    if constexpr (std::floating_point<S>) return detail::floor_of(x);
    else if constexpr (detail::is_fixed<S>) return S::from_raw(x.raw() >> S::fraction_bits << S::fraction_bits);
    else return scalar_traits<S>::floor(x);
}

/// The sine of x radians. Cody & Waite (1980) reduction, Payne & Hanek (1983) for huge arguments.
template <scalar_type S>
constexpr S sin(S x) {
    if constexpr (std::floating_point<S>) return static_cast<S>(detail::sine<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_sine<typename S::rep, S::fraction_bits>(x.raw()));
    else return scalar_traits<S>::sin(x);
}
/// The cosine of x radians.
template <scalar_type S>
constexpr S cos(S x) {
    if constexpr (std::floating_point<S>) return static_cast<S>(detail::cosine<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_cosine<typename S::rep, S::fraction_bits>(x.raw()));
    else return scalar_traits<S>::cos(x);
}

/// A sine and the cosine of the same angle.
template <class S>
struct sine_cosine_of {
    S sine;
    S cosine;
};
/// Both at once, the same numbers as sin and cos, for less than the price of two calls.
template <scalar_type S>
constexpr sine_cosine_of<S> sine_cosine(S x) {
    if constexpr (std::floating_point<S>) {
        const detail::double_pair both = detail::sine_and_cosine<detail::is_precise<S>>(x);
        return {static_cast<S>(both.high), static_cast<S>(both.low)};
    } else if constexpr (detail::is_fixed<S>) {
        typename S::rep sine = 0, cosine = 0;
        detail::fixed_sine_and_cosine<typename S::rep, S::fraction_bits>(x.raw(), sine, cosine);
        return {S::from_raw(sine), S::from_raw(cosine)};
    } else {
        return {scalar_traits<S>::sin(x), scalar_traits<S>::cos(x)};
    }
}

/// The tangent of x radians.
template <scalar_type S>
constexpr S tan(S x) {
    if constexpr (std::floating_point<S>) return static_cast<S>(detail::tangent<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_tangent<typename S::rep, S::fraction_bits>(x.raw()));
    else return scalar_traits<S>::tan(x);
}

/// The angle of the vector (x, y) in radians, -pi to pi; 0 for the zero vector of fixed point, by the signs of
/// the zeros for float and double.
template <scalar_type S>
constexpr S atan2(S y, S x) {
    if constexpr (std::floating_point<S>)
        return static_cast<S>(detail::arctangent2<detail::is_precise<S>>(detail::to_double(y), detail::to_double(x)));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_arctangent2<typename S::rep, S::fraction_bits>(y.raw(), x.raw()));
    else return scalar_traits<S>::atan2(y, x);
}

/// The angle from 0 to pi with cosine x. |x| > 1: NaN, in fixed point as 1 or -1.
template <scalar_type S>
constexpr S acos(S x) {
    if constexpr (std::floating_point<S>) return static_cast<S>(detail::arccosine<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_arccosine<typename S::rep, S::fraction_bits>(x.raw()));
    else return scalar_traits<S>::acos(x);
}
/// The angle from -pi/2 to pi/2 with sine x. |x| > 1: NaN, in fixed point as 1 or -1.
template <scalar_type S>
constexpr S asin(S x) {
    if constexpr (std::floating_point<S>) return static_cast<S>(detail::arcsine<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_arcsine<typename S::rep, S::fraction_bits>(x.raw()));
    else return scalar_traits<S>::atan2(x, scalar_traits<S>::sqrt((S(1) - x) * (S(1) + x)));
}

/// e^x. Overflow: infinity, in fixed point the largest number.
template <scalar_type S>
constexpr S exp(S x) {
    if constexpr (std::floating_point<S>) return static_cast<S>(detail::exponential<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_exponential<typename S::rep, S::fraction_bits>(x.raw()));
    else return scalar_traits<S>::exp(x);
}
/// The natural logarithm. Of 0: -infinity, in fixed point the smallest number; of negative numbers: NaN, in
/// fixed point 0.
template <scalar_type S>
constexpr S log(S x) {
    if constexpr (std::floating_point<S>) return static_cast<S>(detail::logarithm<detail::is_precise<S>>(x));
    else if constexpr (detail::is_fixed<S>)
        return S::from_raw(detail::fixed_logarithm<typename S::rep, S::fraction_bits>(x.raw()));
    else return scalar_traits<S>::log(x);
}

PHYSICS_HPP_END
