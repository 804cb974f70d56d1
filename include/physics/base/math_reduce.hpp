// Angles modulo a quarter turn, exactly enough for any finite number.
#pragma once

#include "physics/base/wide.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The unevaluated sum of two doubles, the second far below the first: ~106 bits.
struct double_pair {
    double high = 0;
    double low = 0;
};

/// a + b without error (Knuth, The Art of Computer Programming 2, 4.2.2).
constexpr double_pair two_sum(double a, double b) {
    const double sum = a + b;
    const double part = sum - a;
    return {sum, (a - (sum - part)) + (b - part)};
}
/// a + b without error where |a| >= |b| (Dekker 1971).
constexpr double_pair fast_two_sum(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
}
/// a * b without error, for magnitudes from 2^-450 to 2^450 (Veltkamp's split, Dekker 1971). A fused
/// multiply-add would be shorter, but where the processor has none it is a slow call.
constexpr double_pair two_product(double a, double b) {
    constexpr double splitter = 134217729;  // 2^27 + 1
    const double a_scaled = a * splitter, b_scaled = b * splitter;
    const double a_high = a_scaled - (a_scaled - a), b_high = b_scaled - (b_scaled - b);
    const double a_low = a - a_high, b_low = b - b_high;
    const double product = a * b;
    return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

/// 2^n as a double; n from -1022 to 1023.
constexpr double power_of_two(int n) { return detail::bit_cast<double>(static_cast<std::uint64_t>(n + 1023) << 52); }

/// The integer nearest to x; ties away from zero. |x| < 2^31.
constexpr int nearest_int(double x) { return static_cast<int>(x < 0 ? x - 0.5 : x + 0.5); }

/// 2 / pi, 1,216 bits after the binary point; the word of zeros before it serves small arguments.
inline constexpr std::uint64_t two_over_pi[] = {
    0x0000000000000000, 0xa2f9836e4e441529, 0xfc2757d1f534ddc0, 0xdb6295993c439041, 0xfe5163abdebbc561,
    0xb7246e3a424dd2e0, 0x06492eea09d1921c, 0xfe1deb1cb129a73e, 0xe88235f52ebb4484, 0xe99c7026b45f7e41,
    0x3991d639835339f4, 0x9c845f8bbdf9283b, 0x1ff897ffde05980f, 0xef2f118b5a0a6d1f, 0x6d367ecf27cb09b7,
    0x4f463f669e5fea2d, 0x7527bac7ebe5f17b, 0x3d0739f78a5292ea, 0x6bfb5fb11f8d5d08, 0x56033046fc7b6bab};
/// pi / 2 in units of 2^-63.
inline constexpr std::uint64_t half_pi_word = 0xc90fdaa22168c235;

/// An angle as a number of quarter turns (only the last two bits count) and a rest of at most pi / 4.
struct reduced_angle {
    unsigned quadrant = 0;
    double high = 0;
    double low = 0;
};

/// For |x| >= 1. The method of Payne & Hanek (1983), in integers: x = m * 2^e, and of 2/pi only the 192 bits
/// count that are neither multiples of 4 after the product nor below 2^-137. No double comes closer than
/// 2^-62 to a multiple of pi/2 (relative to pi/2), so 64 good bits remain. ~15 ns.
PHYSICS_HPP_COLD constexpr reduced_angle reduce_huge(double x) {
    const std::uint64_t word = detail::bit_cast<std::uint64_t>(x);
    const std::uint64_t m = (word & 0xfffffffffffffu) | 0x10000000000000u;
    const int e = static_cast<int>((word >> 52) & 0x7ff) - 1075;
    const int first = e - 2 + 64;
    const std::uint64_t* words = two_over_pi + first / 64;
    const int shift = first % 64;
    std::uint64_t window[3] = {};
    for (int i = 0; i < 3; ++i)
        window[i] = shift == 0 ? words[i] : (words[i] << shift) | (words[i + 1] >> (64 - shift));

    const uint128 low = product128(m, window[2]);
    const uint128 middle = product128(m, window[1]) + uint128(high_half(low));
    const std::uint64_t top = m * window[0] + high_half(middle);
    // The binary point is below the top two bits, which hold the quarter turns.
    unsigned quadrant = static_cast<unsigned>(top >> 62);
    uint128 turn = (uint128(top) << 66) | (uint128(low_half(middle)) << 2) | uint128(low_half(low) >> 62);
    bool negative = high_half(turn) >> 63 != 0;
    if (negative) {
        ++quadrant;
        turn = -turn;
    }
    const int zeros = 128 - bit_width(turn);
    const std::uint64_t angle = mul_high(high_half(turn << zeros), half_pi_word);
    const double scale = power_of_two(-63 - zeros);
    double_pair rest = fast_two_sum(static_cast<double>(static_cast<std::int64_t>(angle >> 11)) * 2048,
                                    static_cast<double>(static_cast<std::int64_t>(angle & 2047)));
    if (x < 0) {
        quadrant = 0u - quadrant;
        negative = !negative;
    }
    const double unit = negative ? -scale : scale;
    return {quadrant, rest.high * unit, rest.low * unit};
}

/// For every finite x. Cody & Waite (1980): pi/2 in parts of 33, 33 and 53 bits, so that the first two
/// products are exact up to 2^20 quarter turns; where the rest nearly vanishes, integers take over.
/// Relative error of high + low < 2^-62, or < 2^-30 where not precise.
template <bool Precise>
constexpr reduced_angle reduce(double x) {
    const double size = x < 0 ? -x : x;
    if (size <= 0x1.921fb54442d18p-1) return {0, x, 0};
    if (size < 0x1p20) {
        const int turns = nearest_int(x * 0x1.45f306dc9c883p-1);
        const double n = static_cast<double>(turns);
        const double first = x - n * 0x1.921fb544p+0;
        if constexpr (!Precise) {
            return {static_cast<unsigned>(turns), first - n * 0x1.0b4611a626331p-34, 0};
        } else {
            const double_pair second = two_sum(first, -(n * 0x1.0b4611a6p-34));
            const double_pair rest = fast_two_sum(second.high, second.low - n * 0x1.3198a2e037073p-69);
            if (rest.high > 0x1p-30 || rest.high < -0x1p-30) return {static_cast<unsigned>(turns), rest.high, rest.low};
        }
    }
    // Field by field, so that compilers keep the common case in registers.
    const reduced_angle huge = reduce_huge(x);
    return {huge.quadrant, huge.high, huge.low};
}

}  // namespace detail

PHYSICS_HPP_END
