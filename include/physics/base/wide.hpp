// 128-bit integers for exact products, quotients and roots: the compiler's, and a portable twin.
#pragma once

#include <bit>

#include "physics/base/config.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The bits of a value as another type of the same size. Not std::bit_cast, which libc++ lacks before version 14.
template <class To, class From>
constexpr To bit_cast(const From& value) {
    static_assert(sizeof(To) == sizeof(From));
    return __builtin_bit_cast(To, value);
}

/// Unsigned 128-bit integer from two 64-bit halves; the twin of the compiler's, for targets without one
/// and for wasm, where it is the faster of the two.
struct portable_uint128 {
    std::uint64_t low = 0;
    std::uint64_t high = 0;

    constexpr portable_uint128() = default;
    constexpr portable_uint128(std::uint64_t value) : low(value) {}
    constexpr portable_uint128(std::uint64_t high_half, std::uint64_t low_half) : low(low_half), high(high_half) {}
    constexpr explicit operator std::uint64_t() const { return low; }

    friend bool operator==(portable_uint128 a, portable_uint128 b) = default;
};

constexpr portable_uint128 operator+(portable_uint128 a, portable_uint128 b) {
    const std::uint64_t sum = a.low + b.low;
    return {a.high + b.high + (sum < a.low), sum};
}
constexpr portable_uint128 operator~(portable_uint128 a) { return {~a.high, ~a.low}; }
constexpr portable_uint128 operator-(portable_uint128 a) { return ~a + portable_uint128(1); }
constexpr portable_uint128 operator-(portable_uint128 a, portable_uint128 b) { return a + -b; }
constexpr portable_uint128 operator<<(portable_uint128 a, int n) {
    if (n == 0) return a;
    if (n >= 64) return {a.low << (n - 64), 0};
    return {(a.high << n) | (a.low >> (64 - n)), a.low << n};
}
constexpr portable_uint128 operator>>(portable_uint128 a, int n) {
    if (n == 0) return a;
    if (n >= 64) return {0, a.high >> (n - 64)};
    return {a.high >> n, (a.low >> n) | (a.high << (64 - n))};
}
constexpr portable_uint128 operator|(portable_uint128 a, portable_uint128 b) {
    return {a.high | b.high, a.low | b.low};
}
constexpr bool operator<(portable_uint128 a, portable_uint128 b) {
    return a.high != b.high ? a.high < b.high : a.low < b.low;
}
constexpr bool operator>=(portable_uint128 a, portable_uint128 b) { return !(a < b); }
constexpr bool operator>(portable_uint128 a, portable_uint128 b) { return b < a; }
constexpr bool operator<=(portable_uint128 a, portable_uint128 b) { return !(b < a); }

/// The exact product of two 64-bit integers, by four 32-bit products.
constexpr portable_uint128 portable_product(std::uint64_t a, std::uint64_t b) {
    const std::uint64_t mask = 0xffffffffu;
    const std::uint64_t low = (a & mask) * (b & mask);
    const std::uint64_t mid = (a >> 32) * (b & mask) + (low >> 32);
    const std::uint64_t mid2 = (a & mask) * (b >> 32) + (mid & mask);
    return {(a >> 32) * (b >> 32) + (mid >> 32) + (mid2 >> 32), (mid2 << 32) | (low & mask)};
}

/// Bits needed to hold the value; 0 for zero.
constexpr int bit_width(portable_uint128 a) {
    return a.high != 0 ? 64 + static_cast<int>(std::bit_width(a.high)) : static_cast<int>(std::bit_width(a.low));
}

/// The next 32 bits of a long division by a normalised divisor: high becomes the rest. The guess from the
/// divisor's upper half is at most two too large (Knuth, The Art of Computer Programming 2, 4.3.1, D).
constexpr std::uint64_t quotient_digit(std::uint64_t& high, std::uint64_t next, std::uint64_t d) {
    const std::uint64_t mask = 0xffffffffu, d_high = d >> 32, d_low = d & mask;
    std::uint64_t guess = high / d_high, rest = high % d_high;
    while (rest <= mask && (guess > mask || guess * d_low > ((rest << 32) | next))) {
        --guess;
        rest += d_high;
    }
    high = ((high << 32) | next) - guess * d;
    return guess;
}

/// (high * 2^64 + low) / d and its remainder, for high < d.
constexpr std::uint64_t portable_divide(std::uint64_t high, std::uint64_t low, std::uint64_t d,
                                        std::uint64_t& remainder) {
    if (high == 0) {
        remainder = low % d;
        return low / d;
    }
    const int shift = std::countl_zero(d);
    const portable_uint128 a = portable_uint128(high, low) << shift;
    d <<= shift;
    remainder = a.high;
    const std::uint64_t first = quotient_digit(remainder, a.low >> 32, d);
    const std::uint64_t second = quotient_digit(remainder, a.low & 0xffffffffu, d);
    remainder >>= shift;
    return (first << 32) | second;
}

/// Quotient and remainder of a 128-bit by a 128-bit integer; b must not be zero. ~10 ns.
constexpr portable_uint128 portable_divide(portable_uint128 a, portable_uint128 b, portable_uint128& remainder) {
    if (b.high == 0) {
        portable_uint128 quotient(a.high / b.low, 0);
        std::uint64_t rest = 0;
        quotient.low = portable_divide(a.high % b.low, a.low, b.low, rest);
        remainder = rest;
        return quotient;
    }
    // The quotient by the divisor's upper 64 bits is right or one too large; half of a keeps its upper word
    // below the divisor's.
    const int shift = std::countl_zero(b.high);
    const portable_uint128 half = a >> 1;
    std::uint64_t unused = 0;
    std::uint64_t quotient = portable_divide(half.high, half.low, (b << shift).high, unused) >> (63 - shift);
    if (quotient != 0) --quotient;
    portable_uint128 back = portable_product(quotient, b.low);
    back.high += quotient * b.high;
    remainder = a - back;
    if (remainder >= b) {
        remainder = remainder - b;
        ++quotient;
    }
    return quotient;
}

#if PHYSICS_HPP_INT128
__extension__ typedef unsigned __int128 uint128;
constexpr uint128 product128(std::uint64_t a, std::uint64_t b) { return static_cast<uint128>(a) * b; }
constexpr uint128 divide128(uint128 a, uint128 b, uint128& remainder) {
    const uint128 quotient = a / b;
    remainder = a - quotient * b;
    return quotient;
}
constexpr std::uint64_t divide128(std::uint64_t high, std::uint64_t low, std::uint64_t d, std::uint64_t& remainder) {
    const std::uint64_t quotient =
        high == 0 ? low / d : static_cast<std::uint64_t>(((static_cast<uint128>(high) << 64) | low) / d);
    remainder = low - quotient * d;
    return quotient;
}
constexpr int bit_width(uint128 a) {
    return bit_width(portable_uint128(static_cast<std::uint64_t>(a >> 64), static_cast<std::uint64_t>(a)));
}
__extension__ typedef __int128 native_int128;
constexpr uint128 shift_signed(uint128 a, int n) { return static_cast<uint128>(static_cast<native_int128>(a) >> n); }
constexpr std::uint64_t high_half(uint128 a) { return static_cast<std::uint64_t>(a >> 64); }
#else
using uint128 = portable_uint128;
constexpr uint128 product128(std::uint64_t a, std::uint64_t b) { return portable_product(a, b); }
constexpr uint128 divide128(uint128 a, uint128 b, uint128& remainder) { return portable_divide(a, b, remainder); }
constexpr std::uint64_t divide128(std::uint64_t high, std::uint64_t low, std::uint64_t d, std::uint64_t& remainder) {
    return portable_divide(high, low, d, remainder);
}
#endif
/// Arithmetic shift: rounds towards minus infinity.
constexpr portable_uint128 shift_signed(portable_uint128 a, int n) { return a.high >> 63 != 0 ? ~(~a >> n) : a >> n; }
constexpr std::uint64_t high_half(portable_uint128 a) { return a.high; }
constexpr std::uint64_t low_half(uint128 a) { return static_cast<std::uint64_t>(a); }
/// The upper half of the product of two 64-bit integers.
constexpr std::uint64_t mul_high(std::uint64_t a, std::uint64_t b) { return high_half(product128(a, b)); }

/// Two's-complement 128-bit integer over either representation; wraps, never undefined.
template <class Unsigned>
struct basic_int128 {
    Unsigned bits{};

    constexpr basic_int128() = default;
    constexpr explicit basic_int128(Unsigned value) : bits(value) {}
    constexpr basic_int128(std::int64_t value)
        : bits(value < 0 ? -Unsigned(std::uint64_t{0} - static_cast<std::uint64_t>(value))
                         : Unsigned(static_cast<std::uint64_t>(value))) {}

    constexpr bool negative() const { return static_cast<std::uint64_t>(bits >> 127) != 0; }
    constexpr Unsigned magnitude() const { return negative() ? -bits : bits; }
    constexpr std::int64_t low() const { return static_cast<std::int64_t>(static_cast<std::uint64_t>(bits)); }
};

template <class Unsigned>
constexpr basic_int128<Unsigned> operator+(basic_int128<Unsigned> a, basic_int128<Unsigned> b) {
    return basic_int128<Unsigned>(a.bits + b.bits);
}
template <class Unsigned>
constexpr basic_int128<Unsigned> operator-(basic_int128<Unsigned> a, basic_int128<Unsigned> b) {
    return basic_int128<Unsigned>(a.bits - b.bits);
}
template <class Unsigned>
constexpr basic_int128<Unsigned> operator-(basic_int128<Unsigned> a) {
    return basic_int128<Unsigned>(-a.bits);
}
template <class Unsigned>
constexpr basic_int128<Unsigned> operator<<(basic_int128<Unsigned> a, int n) {
    return basic_int128<Unsigned>(a.bits << n);
}
/// Arithmetic shift: rounds towards minus infinity.
template <class Unsigned>
constexpr basic_int128<Unsigned> operator>>(basic_int128<Unsigned> a, int n) {
    return basic_int128<Unsigned>(shift_signed(a.bits, n));
}
template <class Unsigned>
constexpr bool operator==(basic_int128<Unsigned> a, basic_int128<Unsigned> b) {
    return a.bits == b.bits;
}
template <class Unsigned>
constexpr bool operator<(basic_int128<Unsigned> a, basic_int128<Unsigned> b) {
    return a.negative() != b.negative() ? a.negative() : a.bits < b.bits;
}
template <class Unsigned>
constexpr bool operator>(basic_int128<Unsigned> a, basic_int128<Unsigned> b) {
    return b < a;
}
template <class Unsigned>
constexpr bool operator<=(basic_int128<Unsigned> a, basic_int128<Unsigned> b) {
    return !(b < a);
}
template <class Unsigned>
constexpr bool operator>=(basic_int128<Unsigned> a, basic_int128<Unsigned> b) {
    return !(a < b);
}

using int128 = basic_int128<uint128>;

constexpr int128 product128(std::int64_t a, std::int64_t b) {
#if PHYSICS_HPP_INT128
    return int128(static_cast<uint128>(static_cast<native_int128>(a) * b));
#else
    // The product of the bit patterns is too large by 2^64 times the other factor for each negative one.
    const std::uint64_t ua = static_cast<std::uint64_t>(a), ub = static_cast<std::uint64_t>(b);
    uint128 result = product128(ua, ub);
    result.high -= (a < 0 ? ub : 0) + (b < 0 ? ua : 0);
    return int128(result);
#endif
}

/// a / 2^n to nearest, ties away from zero; n from 1 to 126. Symmetric: f(-a) == -f(a).
template <class Unsigned>
constexpr basic_int128<Unsigned> shift_nearest(basic_int128<Unsigned> a, int n) {
    const basic_int128<Unsigned> half = basic_int128<Unsigned>(Unsigned(1) << (n - 1));
    return (a + half - basic_int128<Unsigned>(std::int64_t{a.negative()})) >> n;
}

constexpr std::int64_t shift_nearest(std::int64_t a, int n) {
    const std::int64_t half = std::int64_t{1} << (n - 1);
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(half) -
                                     static_cast<std::uint64_t>(a < 0)) >>
           n;
}

/// The low word of shift_nearest(a, n), n from 1 to 63, in fewer steps: by words, since shifts across two are slow, and
/// by comparing the rest, since rounding then needs no carries.
template <class Unsigned>
PHYSICS_HPP_ALWAYS_INLINE constexpr std::int64_t low_of_shift_nearest(basic_int128<Unsigned> a, int n) {
    const std::uint64_t high = high_half(a.bits), low = static_cast<std::uint64_t>(a.bits);
    const std::uint64_t half = std::uint64_t{1} << (n - 1), rest = low & (2 * half - 1),
                        maximum = half - 1 + (high >> 63);
    std::uint64_t result = (high << (64 - n)) | (low >> n);
    result += maximum < rest;
    return static_cast<std::int64_t>(result);
}
constexpr std::int64_t low_of_shift_nearest(std::int64_t a, int n) { return shift_nearest(a, n); }

}  // namespace detail

PHYSICS_HPP_END
