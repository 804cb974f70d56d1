// Exact products of fixed-point numbers; how results are narrowed and saturated, and overflows counted.
#pragma once

#include <concepts>
#include <limits>
#include <type_traits>

#include "physics/base/wide.hpp"

PHYSICS_HPP_BEGIN

/// How many fixed-point results left their range on this thread since the last reset: sums and products
/// that wrapped, and quotients, roots and conversions that saturated. Counts only where the user defines
/// PHYSICS_HPP_AUDIT; always 0 otherwise.
std::uint64_t overflow_count() noexcept;
/// Sets this thread's overflow_count back to 0.
void reset_overflow_count() noexcept;

namespace detail {

#ifdef PHYSICS_HPP_AUDIT
inline thread_local std::uint64_t overflow_counter = 0;
#endif

constexpr void note_overflow([[maybe_unused]] bool happened) noexcept {
#ifdef PHYSICS_HPP_AUDIT
    if (!std::is_constant_evaluated() && happened) ++overflow_counter;
#endif
}

/// The integer that holds a product of two representations exactly.
template <class A, class B>
using product_integer = std::conditional_t<sizeof(A) == 4 && sizeof(B) == 4, std::int64_t, int128>;

template <class Rep, class Int>
constexpr bool fits(Int a) {
    return a >= Int(std::int64_t{std::numeric_limits<Rep>::min()}) &&
           a <= Int(std::int64_t{std::numeric_limits<Rep>::max()});
}

/// a / 2^Shift to nearest, ties away from zero. Takes the low bits, so that a result out of range wraps; the audit
/// counts it.
template <class Rep, int Shift, class Int>
PHYSICS_HPP_ALWAYS_INLINE constexpr Rep shift_wrapped(Int a) {
#ifdef PHYSICS_HPP_AUDIT
    note_overflow(!fits<Rep>(shift_nearest(a, Shift)));
#endif
    if constexpr (Shift < 64) return static_cast<Rep>(low_of_shift_nearest(a, Shift));
    else return static_cast<Rep>(shift_nearest(a, Shift).low());
}

template <class Rep>
constexpr Rep saturated(bool negative) {
    note_overflow(true);
    return negative ? std::numeric_limits<Rep>::min() : std::numeric_limits<Rep>::max();
}

/// sign * magnitude, saturating.
template <class Rep>
constexpr Rep signed_saturating(bool negative, std::uint64_t magnitude) {
    const std::uint64_t maximum = static_cast<std::uint64_t>(std::numeric_limits<Rep>::max()) + std::uint64_t{negative};
    if (magnitude > maximum) return saturated<Rep>(negative);
    return static_cast<Rep>(static_cast<std::int64_t>(negative ? std::uint64_t{0} - magnitude : magnitude));
}
template <class Rep>
constexpr Rep signed_saturating(bool negative, uint128 magnitude) {
    return high_half(magnitude) != 0 ? saturated<Rep>(negative) : signed_saturating<Rep>(negative, low_half(magnitude));
}

constexpr std::uint64_t magnitude64(std::int64_t a) {
    return a < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(a) : static_cast<std::uint64_t>(a);
}
constexpr uint128 magnitude128(std::int64_t a) { return uint128(magnitude64(a)); }
constexpr uint128 magnitude128(int128 a) { return a.magnitude(); }

/// 0 / 0 is 0; other numbers by zero saturate.
template <class Rep>
constexpr Rep quotient_by_zero(bool negative, bool of_zero) {
    if (!of_zero) return saturated<Rep>(negative);
    note_overflow(true);
    return 0;
}

/// n * 2^shift / d to nearest, ties away from zero, saturating; shift from 1 to 63. One hardware division.
template <class Rep>
constexpr Rep scaled_quotient(bool negative, std::uint64_t n, int shift, std::uint64_t d) {
    if (d == 0) return quotient_by_zero<Rep>(negative, n == 0);
    const std::uint64_t high = n >> (64 - shift);
    if (high >= d) return saturated<Rep>(negative);
    std::uint64_t rest = 0;
    const std::uint64_t quotient = divide128(high, n << shift, d, rest);
    // No carry out of 64 bits: where the quotient is that large d <= 2^shift, of which the dividend is a multiple.
    return signed_saturating<Rep>(negative, quotient + std::uint64_t{rest >= d - rest});
}

/// a * 2^shift / b to nearest, ties away from zero, saturating; shift from -126 up, a and b up to 2^127.
/// Exact: where a * 2^shift has more than 128 bits, the division goes on with the rest, as many bits a round
/// as there is room for.
template <class Rep>
constexpr Rep scaled_quotient(bool negative, uint128 a, int shift, uint128 b) {
    if (b == uint128(0)) return quotient_by_zero<Rep>(negative, a == uint128(0));
    uint128 quotient{}, rest = a;
    do {
        const int room = 128 - bit_width(rest | uint128(1));
        const int step = shift < 0 ? 0 : shift < room ? shift : room;
        if (bit_width(quotient) + step > 127) return saturated<Rep>(negative);
        const uint128 dividend = rest << step;
        quotient = (quotient << step) + divide128(dividend, b, rest);
        shift -= step;
    } while (shift > 0);
    if (shift < 0) return signed_saturating<Rep>(negative, ((quotient >> (-shift - 1)) + uint128(1)) >> 1);
    return signed_saturating<Rep>(negative, rest >= b - rest ? quotient + uint128(1) : quotient);
}

}  // namespace detail

/// An exact product of two fixed-point numbers, or a sum of such: compare it as it is, or narrow it once.
/// Range: 128 bits for 64-bit operands, 64 for 32-bit ones; wraps beyond.
template <class Int, int FractionBits>
struct wide_fixed {
    Int raw{};
};

namespace detail {
constexpr int128 wide_sum(int128 a, int128 b) { return a + b; }
constexpr std::int64_t wide_sum(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
constexpr int128 wide_negated(int128 a) { return -a; }
constexpr std::int64_t wide_negated(std::int64_t a) {
    return static_cast<std::int64_t>(std::uint64_t{0} - static_cast<std::uint64_t>(a));
}
}  // namespace detail

template <class Int, int F>
constexpr wide_fixed<Int, F> operator+(wide_fixed<Int, F> a, wide_fixed<Int, F> b) {
    return {detail::wide_sum(a.raw, b.raw)};
}
template <class Int, int F>
constexpr wide_fixed<Int, F> operator-(wide_fixed<Int, F> a, wide_fixed<Int, F> b) {
    return a + -b;
}
template <class Int, int F>
constexpr wide_fixed<Int, F> operator-(wide_fixed<Int, F> a) {
    return {detail::wide_negated(a.raw)};
}
template <class Int, int F>
constexpr bool operator==(wide_fixed<Int, F> a, wide_fixed<Int, F> b) {
    return a.raw == b.raw;
}
template <class Int, int F>
constexpr bool operator<(wide_fixed<Int, F> a, wide_fixed<Int, F> b) {
    return a.raw < b.raw;
}
template <class Int, int F>
constexpr bool operator>(wide_fixed<Int, F> a, wide_fixed<Int, F> b) {
    return b.raw < a.raw;
}
template <class Int, int F>
constexpr bool operator<=(wide_fixed<Int, F> a, wide_fixed<Int, F> b) {
    return !(b.raw < a.raw);
}
template <class Int, int F>
constexpr bool operator>=(wide_fixed<Int, F> a, wide_fixed<Int, F> b) {
    return !(a.raw < b.raw);
}

PHYSICS_HPP_END
