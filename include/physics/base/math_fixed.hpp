// Elementary functions of fixed point: 64-bit integers, every format from one set of series.
#pragma once

#include <bit>

#include "physics/base/fixed.hpp"
#include "physics/base/math_reduce.hpp"

PHYSICS_HPP_BEGIN

// Inside, numbers from 0 to 1 are counts of 2^-64, so that a product is the upper half of an integer product.
// The series are Taylor's, on ranges so short that a minimax fit would save one term; each format takes the
// terms that it can see. What is odd or symmetric is computed from magnitudes, hence f(-x) == -f(x) exactly.

namespace detail {

/// (pi/4)^(2k+1) / (2k+1)!: the sine of z^(1/2) eighths of a turn, over z^(1/2), with alternating signs.
inline constexpr std::uint64_t fixed_sine_series[] = {
    0xc90fdaa22168c235, 0x14abbce625be52bf, 0x00a335e33bad570f, 0x000265a599cc57b1, 0x00000541e0d21fba,
    0x000000078c1d3f7a, 0x0000000007a3d0d3, 0x000000000005beb7, 0x0000000000000356, 0x0000000000000002};
/// (pi/4)^(2k) / (2k)!, k from 1: one minus that cosine, over z, with alternating signs.
inline constexpr std::uint64_t fixed_cosine_series[] = {0x4ef4f326f9177969, 0x040f07c206d6b0ed, 0x00155d3c7e3cbffa,
                                                        0x00003c3ea0d12375, 0x00000069b47ca881, 0x000000007e74e28e,
                                                        0x00000000006db894, 0x0000000000004832, 0x0000000000000025};
/// 16 (log(2)/16)^k / k!, k from 1: 16 (2^(g/16) - 1), over g; the factor keeps four more bits.
inline constexpr std::uint64_t fixed_exp_series[] = {
    0xb17217f7d1cf79ac, 0x03d7f7bff058b1d5, 0x000e35846b825060, 0x0000276556df749d, 0x0000005761ff9e2a,
    0x00000000a184897c, 0x0000000000ffe5fe, 0x00000000000162c0, 0x00000000000001b5, 0x0000000000000002};
/// 2^(i/16) - 1.
inline constexpr std::uint64_t fixed_powers[] = {
    0x0000000000000000, 0x0b5586cf9890f62a, 0x172b83c7d517adce, 0x2387a6e75623866c,
    0x306fe0a31b7152df, 0x3dea64c12342235b, 0x4bfdad5362a271d4, 0x5ab07dd48542958d,
    0x6a09e667f3bcc909, 0x7a11473eb0186d7d, 0x8ace5422aa0db5ba, 0x9c49182a3f0901c8,
    0xae89f995ad3ad5e8, 0xc199bdd85529c222, 0xd5818dcfba48725e, 0xea4afa2a490d9859};

/// How many coefficients of a series on [0, 1] reach 2^-(bits + 7).
template <int N>
constexpr int terms_above(int bits, const std::uint64_t (&c)[N]) {
    int n = 1;
    while (n < N && (bits >= 57 || c[n] >> (57 - bits) != 0)) ++n;
    return n;
}
/// c[0] - z (c[1] - z (c[2] - ...)), or with sums instead.
template <int Terms, bool Alternating, int I = 0, int N>
constexpr std::uint64_t series(std::uint64_t z, const std::uint64_t (&c)[N]) {
    if constexpr (I + 1 >= Terms) {
        return c[I];
    } else {
        const std::uint64_t rest = mul_high(z, series<Terms, Alternating, I + 1>(z, c));
        return Alternating ? c[I] - rest : c[I] + rest;
    }
}
/// z (1/3 - z (1/5 - z (1/7 - ...))), or with sums instead: what atan u = u (1 - ...) and atanh u = u (1 + ...)
/// have beyond u, z = u^2. Enough terms for |u| < 0.172.
template <int FractionBits, bool Alternating, int I = 1>
constexpr std::uint64_t reciprocal_series(std::uint64_t z) {
    constexpr std::uint64_t c = ~std::uint64_t{0} / (2 * I + 1);
    if constexpr (I > (FractionBits + 4) / 6) {
        return mul_high(z, c);
    } else {
        const std::uint64_t rest = reciprocal_series<FractionBits, Alternating, I + 1>(z);
        return mul_high(z, Alternating ? c - rest : c + rest);
    }
}

/// A count of 2^-64 as one of 2^-FractionBits, to nearest.
template <int FractionBits>
constexpr std::uint64_t rounded(std::uint64_t a) {
    return ((a >> (63 - FractionBits)) + 1) >> 1;
}
/// A count of 2^-Bits as one of 2^-FractionBits, to nearest.
template <int FractionBits, int Bits>
constexpr uint128 rounded(uint128 a) {
    return ((a >> (Bits - 1 - FractionBits)) + uint128(std::uint64_t{1})) >> 1;
}
constexpr uint128 words128(std::uint64_t high, std::uint64_t low) { return (uint128(high) << 64) | uint128(low); }

/// An angle in eighths of a turn from the nearest axis, as a count of 2^-128, below 1.
struct fixed_angle {
    bool swapped;        // the nearest axis is the vertical one: sine and cosine change places
    bool sine_negative;  // for positive angles
    bool cosine_negative;
    uint128 eighths;
};

/// Multiplies by 2/pi. One word of it for 32-bit numbers and two for 64-bit ones leave an error below 2^-32 of the
/// format's step; with one more, the angle is right to 64 bits wherever its tangent is in range.
template <class Rep, int FractionBits, bool Fine = false>
constexpr fixed_angle reduce(Rep raw) {
    const std::uint64_t m = magnitude64(raw);
    constexpr int words = (sizeof(Rep) == 4 ? 1 : 2) + Fine;
    uint128 turns = product128(m, two_over_pi[1]), low{};
    if constexpr (words > 1) {
        low = product128(m, two_over_pi[2]);
        if constexpr (words > 2) low = low + uint128(mul_high(m, two_over_pi[3]));
        turns = turns + uint128(high_half(low));
    }
    const uint128 fraction = (turns << (64 - FractionBits)) | uint128(low_half(low) >> FractionBits);
    const unsigned quadrant = static_cast<unsigned>(low_half(turns >> (64 + FractionBits)) & 3);
    const bool upper = high_half(fraction) >> 63 != 0;
    // ~ for -: an exact half stays below 1.
    return {upper != ((quadrant & 1) != 0), (quadrant & 2) != 0, ((quadrant + 1) & 2) != 0,
            (upper ? ~fraction : fraction) << 1};
}

/// The sine of p eighths of a turn over p, z = p^2.
template <int Bits>
constexpr std::uint64_t fixed_sine_ratio(std::uint64_t z) {
    return series<terms_above(Bits, fixed_sine_series), true>(z, fixed_sine_series);
}
/// One minus the cosine of p eighths of a turn.
template <int Bits>
constexpr std::uint64_t fixed_versine(std::uint64_t z) {
    return mul_high(z, series<terms_above(Bits, fixed_cosine_series), true>(z, fixed_cosine_series));
}

template <class Rep>
constexpr Rep with_sign(bool negative, std::uint64_t magnitude) {
    const Rep value = static_cast<Rep>(magnitude);
    return negative ? static_cast<Rep>(-value) : value;
}

/// Sine of a reduced angle, or its cosine where swapped.
template <int FractionBits>
constexpr std::uint64_t fixed_wave(uint128 eighths, bool swapped) {
    const std::uint64_t p = high_half(eighths), z = mul_high(p, p);
    if (swapped) return (std::uint64_t{1} << FractionBits) - rounded<FractionBits>(fixed_versine<FractionBits>(z));
    return rounded<FractionBits>(mul_high(p, fixed_sine_ratio<FractionBits>(z)));
}
template <class Rep, int FractionBits>
constexpr Rep fixed_sine(Rep raw) {
    const fixed_angle a = reduce<Rep, FractionBits>(raw);
    return with_sign<Rep>(a.sine_negative != (raw < 0), fixed_wave<FractionBits>(a.eighths, a.swapped));
}
template <class Rep, int FractionBits>
constexpr Rep fixed_cosine(Rep raw) {
    const fixed_angle a = reduce<Rep, FractionBits>(raw);
    return with_sign<Rep>(a.cosine_negative, fixed_wave<FractionBits>(a.eighths, !a.swapped));
}
template <class Rep, int FractionBits>
constexpr void fixed_sine_and_cosine(Rep raw, Rep& sine, Rep& cosine) {
    const fixed_angle a = reduce<Rep, FractionBits>(raw);
    sine = with_sign<Rep>(a.sine_negative != (raw < 0), fixed_wave<FractionBits>(a.eighths, a.swapped));
    cosine = with_sign<Rep>(a.cosine_negative, fixed_wave<FractionBits>(a.eighths, !a.swapped));
}

/// Near a pole the result has all the bits of Rep, so the sine is normalised before its last digits are dropped.
template <class Rep, int FractionBits>
constexpr Rep fixed_tangent(Rep raw) {
    constexpr int bits = std::numeric_limits<Rep>::digits;
    const fixed_angle a = reduce<Rep, FractionBits, true>(raw);
    const bool negative = (a.sine_negative != a.cosine_negative) != (raw < 0);
    const std::uint64_t p = high_half(a.eighths), z = mul_high(p, p);
    const std::uint64_t ratio = fixed_sine_ratio<bits>(z), versine = fixed_versine<bits>(z);
    const std::uint64_t cosine = versine == 0 ? ~versine : std::uint64_t{0} - versine;
    if (!a.swapped) return scaled_quotient<Rep>(negative, mul_high(p, ratio), FractionBits, cosine);
    const int zeros = 128 - bit_width(a.eighths);
    if (zeros + FractionBits > 63) return saturated<Rep>(negative);
    const std::uint64_t sine =
        high_half(product128(high_half(a.eighths << zeros), ratio) + (uint128(std::uint64_t{1}) << 63));
    return scaled_quotient<Rep>(negative, cosine, zeros + FractionBits, sine);
}

/// atan(n / d) as a count of 2^-126, for n <= d. Subtracts the nearest of atan(0, 1/4, 1/2, 1), since
/// atan(n/d) - atan(c) = atan((n - c d) / (d + c n)); |u| <= 0.164 remains.
template <int FractionBits>
constexpr uint128 fixed_arctangent(std::uint64_t n, std::uint64_t d) {
    if (n == 0) return uint128(std::uint64_t{0});
    const int zeros = std::countl_zero(d);
    n <<= zeros;
    d <<= zeros;
    uint128 known{}, top = uint128(n) << 2, bottom = uint128(d) << 2;
    bool below = false;
    if (n > d / 8) {
        const int shift = n > d / 32 * 23 ? 2 : n > d / 8 * 3 ? 1 : 0;
        known = shift == 2   ? words128(0x3243f6a8885a308d, 0x313198a2e0370734)
                : shift == 1 ? words128(0x1dac670561bb4f68, 0xadfc88bd978751a0)
                             : words128(0x0fadbafc96406eb1, 0x56dc79ef5f7a217e);
        const uint128 subtracted = uint128(d) << shift;
        below = top < subtracted;
        top = below ? subtracted - top : top - subtracted;
        bottom = bottom + (uint128(n) << shift);
    }
    const uint128 dividend = top << 63;
    std::uint64_t unused = 0;
    const std::uint64_t u4 = divide128(high_half(dividend), low_half(dividend), low_half(bottom >> 3), unused);
    const std::uint64_t z = mul_high(u4, u4) >> 4;
    const uint128 rest = uint128(u4 - mul_high(u4, reciprocal_series<FractionBits, true>(z))) << 60;
    return below ? known - rest : known + rest;
}
/// The angle of (x, y), 0 to pi, y upwards, as a count of 2^-126.
template <int FractionBits>
constexpr uint128 fixed_direction(std::uint64_t y, bool x_negative, std::uint64_t x) {
    const bool steep = y > x;
    const uint128 angle = fixed_arctangent<FractionBits>(steep ? x : y, steep ? y : x);
    if (!steep && !x_negative) return angle;
    const uint128 pi = words128(0xc90fdaa22168c234, 0xc4c6628b80dc1cd1);
    const uint128 base = steep ? pi >> 1 : pi;
    return steep && x_negative ? base + angle : base - angle;
}
template <class Rep, int FractionBits>
constexpr Rep fixed_arctangent2(Rep y, Rep x) {
    const uint128 angle = fixed_direction<FractionBits>(magnitude64(y), x < 0, magnitude64(x));
    return signed_saturating<Rep>(y < 0, rounded<FractionBits, 126>(angle));
}

/// sqrt(1 - x^2) as a count of 2^-62; clamps |x| > 1 to 1.
template <int FractionBits>
constexpr std::uint64_t fixed_complement(std::uint64_t& x) {
    constexpr std::uint64_t one = std::uint64_t{1} << FractionBits;
    note_overflow(x > one);
    if (x > one) x = one;
    const uint128 square = product128(one - x, one + x) << (124 - 2 * FractionBits);
    x <<= 62 - FractionBits;
    return root_of(square).nearest();
}
template <class Rep, int FractionBits>
constexpr Rep fixed_arccosine(Rep raw) {
    std::uint64_t x = magnitude64(raw);
    const std::uint64_t y = fixed_complement<FractionBits>(x);
    return signed_saturating<Rep>(false, rounded<FractionBits, 126>(fixed_direction<FractionBits>(y, raw < 0, x)));
}
template <class Rep, int FractionBits>
constexpr Rep fixed_arcsine(Rep raw) {
    std::uint64_t y = magnitude64(raw);
    const std::uint64_t x = fixed_complement<FractionBits>(y);
    return signed_saturating<Rep>(raw < 0, rounded<FractionBits, 126>(fixed_direction<FractionBits>(y, false, x)));
}

/// x log2(e) = k + i/16 + g/16, k and i integers, 0 <= g < 1; exp x = 2^k 2^(i/16) 2^(g/16).
template <class Rep, int FractionBits>
constexpr Rep fixed_exponential(Rep raw) {
    constexpr int digits = std::numeric_limits<Rep>::digits;
    const std::uint64_t m = magnitude64(raw);
    // log2(e) / 2 to 128 bits makes this a count of 2^-(63 + FractionBits).
    const uint128 scaled = product128(m, 0xb8aa3b295c17f0bb) + uint128(mul_high(m, 0xbe87fed0691d3e88));
    const int128 exponent = raw < 0 ? -int128(scaled) : int128(scaled);
    const std::int64_t k = (exponent >> (63 + FractionBits)).low();
    if (k >= digits - FractionBits) return saturated<Rep>(false);
    if (k < -FractionBits - 1) return 0;
    const std::uint64_t fraction = low_half((exponent >> (FractionBits - 1)).bits);
    const std::uint64_t g = fraction << 4, power = fixed_powers[fraction >> 60];
    const std::uint64_t rest = mul_high(g, series<terms_above(digits, fixed_exp_series), false>(g, fixed_exp_series));
    const uint128 value = words128(1, power) + ((uint128(rest) + uint128(mul_high(power, rest))) >> 4);
    const int shift = 64 - FractionBits - static_cast<int>(k);
    return signed_saturating<Rep>(false, ((value >> (shift - 1)) + uint128(std::uint64_t{1})) >> 1);
}

/// log(2^k m) = k log 2 + 2 atanh((m - 1) / (m + 1)), sqrt(1/2) <= m < sqrt(2).
template <class Rep, int FractionBits>
constexpr Rep fixed_logarithm(Rep raw) {
    if (raw == 0) return saturated<Rep>(true);
    if (raw < 0) {
        note_overflow(true);
        return 0;
    }
    const std::uint64_t one = std::uint64_t{1} << 63;
    const int zeros = std::countl_zero(magnitude64(raw));
    const std::uint64_t m = magnitude64(raw) << zeros;
    const bool below = m > 0xb504f333f9de6484;  // sqrt(2): compare with 2 instead of 1
    const int k = 63 - zeros - FractionBits + below;
    const std::uint64_t top = below ? std::uint64_t{0} - m : m - one;
    std::uint64_t unused = 0;
    const std::uint64_t s4 = divide128(top << 1, 0, (m >> 1) + (below ? one : one >> 1), unused);
    const std::uint64_t z = mul_high(s4, s4) >> 4;
    // From here counts of 2^-65.
    const int128 rest{uint128(s4) + uint128(mul_high(s4, reciprocal_series<FractionBits, false>(z)))};
    const std::uint64_t doublings = magnitude64(k);
    const int128 whole{(product128(doublings, 0xb17217f7d1cf79ab) << 1) +
                       uint128(mul_high(doublings << 1, 0xc9e3b39803f2f6af))};
    const int128 value = (k < 0 ? -whole : whole) + (below ? -rest : rest);
    const int128 nearest = shift_nearest(value, 65 - FractionBits);
    return signed_saturating<Rep>(nearest.negative(), nearest.magnitude());
}

template <class Rep, int FractionBits>
constexpr Rep fixed_root(Rep raw) {
    if (raw < 0) {
        note_overflow(true);
        return 0;
    }
    return static_cast<Rep>(root_of(uint128(magnitude64(raw)) << FractionBits).nearest());
}

}  // namespace detail

PHYSICS_HPP_END
