// 128-bit integers for exact products, quotients and roots: the compiler's, and a portable twin.
#pragma once

#include <bit>

#include "physics/base/config.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Unsigned 128-bit integer from two 64-bit halves; the twin of the compiler's, for targets without one
/// and for wasm, where it is the faster of the two.
struct portable_uint128 {
    std::uint64_t low = 0;
    std::uint64_t high = 0;

    constexpr portable_uint128() = default;
    constexpr portable_uint128(std::uint64_t value) : low(value) {}
    constexpr portable_uint128(std::uint64_t high_half, std::uint64_t low_half) : low(low_half), high(high_half) {}
    constexpr explicit operator std::uint64_t() const { return low; }

    friend constexpr portable_uint128 operator+(portable_uint128 a, portable_uint128 b) {
        const std::uint64_t sum = a.low + b.low;
        return {a.high + b.high + (sum < a.low), sum};
    }
    friend constexpr portable_uint128 operator~(portable_uint128 a) { return {~a.high, ~a.low}; }
    friend constexpr portable_uint128 operator-(portable_uint128 a) { return ~a + portable_uint128(1); }
    friend constexpr portable_uint128 operator-(portable_uint128 a, portable_uint128 b) { return a + -b; }
    friend constexpr portable_uint128 operator<<(portable_uint128 a, int n) {
        if (n == 0) return a;
        if (n >= 64) return {a.low << (n - 64), 0};
        return {(a.high << n) | (a.low >> (64 - n)), a.low << n};
    }
    friend constexpr portable_uint128 operator>>(portable_uint128 a, int n) {
        if (n == 0) return a;
        if (n >= 64) return {0, a.high >> (n - 64)};
        return {a.high >> n, (a.low >> n) | (a.high << (64 - n))};
    }
    friend constexpr portable_uint128 operator|(portable_uint128 a, portable_uint128 b) {
        return {a.high | b.high, a.low | b.low};
    }
    friend constexpr bool operator==(portable_uint128 a, portable_uint128 b) = default;
    friend constexpr bool operator<(portable_uint128 a, portable_uint128 b) {
        return a.high != b.high ? a.high < b.high : a.low < b.low;
    }
    friend constexpr bool operator>=(portable_uint128 a, portable_uint128 b) { return !(a < b); }
    friend constexpr bool operator>(portable_uint128 a, portable_uint128 b) { return b < a; }
    friend constexpr bool operator<=(portable_uint128 a, portable_uint128 b) { return !(b < a); }
};

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

/// Quotient and remainder of a 128-bit by a 128-bit integer, schoolbook: one bit a round.
constexpr portable_uint128 portable_divide(portable_uint128 a, portable_uint128 b, portable_uint128& remainder) {
    portable_uint128 quotient;
    remainder = {};
    for (int i = bit_width(a) - 1; i >= 0; --i) {
        remainder = (remainder << 1) | ((a >> i).low & 1u);
        quotient = quotient << 1;
        if (remainder >= b) {
            remainder = remainder - b;
            quotient.low |= 1u;
        }
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
constexpr int bit_width(uint128 a) {
    return bit_width(portable_uint128(static_cast<std::uint64_t>(a >> 64), static_cast<std::uint64_t>(a)));
}
#else
using uint128 = portable_uint128;
constexpr uint128 product128(std::uint64_t a, std::uint64_t b) { return portable_product(a, b); }
constexpr uint128 divide128(uint128 a, uint128 b, uint128& remainder) { return portable_divide(a, b, remainder); }
#endif

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

    friend constexpr basic_int128 operator+(basic_int128 a, basic_int128 b) { return basic_int128(a.bits + b.bits); }
    friend constexpr basic_int128 operator-(basic_int128 a, basic_int128 b) { return basic_int128(a.bits - b.bits); }
    friend constexpr basic_int128 operator-(basic_int128 a) { return basic_int128(-a.bits); }
    friend constexpr basic_int128 operator<<(basic_int128 a, int n) { return basic_int128(a.bits << n); }
    /// Arithmetic shift: rounds towards minus infinity.
    friend constexpr basic_int128 operator>>(basic_int128 a, int n) {
        return a.negative() ? basic_int128(~(~a.bits >> n)) : basic_int128(a.bits >> n);
    }
    friend constexpr bool operator==(basic_int128 a, basic_int128 b) { return a.bits == b.bits; }
    friend constexpr bool operator<(basic_int128 a, basic_int128 b) {
        return a.negative() != b.negative() ? a.negative() : a.bits < b.bits;
    }
    friend constexpr bool operator>(basic_int128 a, basic_int128 b) { return b < a; }
    friend constexpr bool operator<=(basic_int128 a, basic_int128 b) { return !(b < a); }
    friend constexpr bool operator>=(basic_int128 a, basic_int128 b) { return !(a < b); }
};

using int128 = basic_int128<uint128>;

constexpr int128 product128(std::int64_t a, std::int64_t b) {
#if PHYSICS_HPP_INT128
    __extension__ typedef __int128 native;
    return int128(static_cast<uint128>(static_cast<native>(a) * b));
#else
    const std::uint64_t ua = a < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(a) : static_cast<std::uint64_t>(a);
    const std::uint64_t ub = b < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(b) : static_cast<std::uint64_t>(b);
    const uint128 magnitude = product128(ua, ub);
    return int128((a < 0) != (b < 0) ? -magnitude : magnitude);
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

/// a / b to nearest, ties away from zero; b must not be zero.
constexpr uint128 divide_nearest(uint128 a, uint128 b) {
    uint128 remainder{};
    const uint128 quotient = divide128(a, b, remainder);
    return remainder >= b - remainder ? quotient + uint128(1) : quotient;
}

/// The integer nearest to sqrt(a): the digit-by-digit method, two bits of a round. The root is never a tie.
template <class Unsigned>
constexpr Unsigned root_nearest_by_digits(Unsigned a) {
    Unsigned root{}, rest = a;
    Unsigned bit = Unsigned(1) << 126;
    while (bit > a) bit = bit >> 2;
    for (; bit > Unsigned(0); bit = bit >> 2) {
        if (rest >= root + bit) {
            rest = rest - (root + bit);
            root = (root >> 1) + bit;
        } else {
            root = root >> 1;
        }
    }
    return rest > root ? root + Unsigned(1) : root;
}

/// The integer nearest to sqrt(a). A hardware double seeds Newton's iteration and integers repair it, so
/// the result does not depend on the floating-point environment; ~20 ns.
constexpr std::uint64_t root_nearest(uint128 a) {
    const int width = bit_width(a);
    if (width == 0) return 0;
    if (std::is_constant_evaluated() || width > 126) {
        const uint128 root = root_nearest_by_digits(a);
        return static_cast<std::uint64_t>(root);
    }
    const int shift = width > 62 ? (width - 61) & ~1 : 0;
    const double leading = static_cast<double>(static_cast<std::int64_t>(static_cast<std::uint64_t>(a >> shift)));
    std::uint64_t root = static_cast<std::uint64_t>(static_cast<std::int64_t>(__builtin_sqrt(leading))) << (shift / 2);
    if (root == 0) root = 1;
    if (shift > 0) {
        uint128 rest{};
        root = (root + static_cast<std::uint64_t>(divide128(a, uint128(root), rest))) / 2;
    }
    while (product128(root, root) > a) --root;
    while (product128(root + 1, root + 1) <= a) ++root;
    return a - product128(root, root) > uint128(root) ? root + 1 : root;
}

}  // namespace detail

PHYSICS_HPP_END
