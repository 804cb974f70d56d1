// Square roots by the processor, and of 128-bit integers.
#pragma once

#include <bit>
#include <type_traits>

#include "physics/base/wide.hpp"

#if !defined(__GNUC__)
#include <cmath>
#endif

PHYSICS_HPP_BEGIN

namespace detail {

// __builtin_sqrt tests for negative arguments and calls the C library for errno's sake; the instruction does not.
#if defined(__SSE2__) && defined(__has_builtin)
#if __has_builtin(__builtin_ia32_sqrtsd) && __has_builtin(__builtin_ia32_sqrtss)
#define PHYSICS_HPP_SQRT_INSTRUCTION
#endif
#endif

/// The correctly rounded square root; NaN of negative numbers.
inline double hardware_root(double x) {
#if defined(PHYSICS_HPP_SQRT_INSTRUCTION)
    typedef double lanes __attribute__((vector_size(16)));
    return __builtin_ia32_sqrtsd(lanes{x, 0})[0];
#elif defined(__GNUC__)
    return __builtin_sqrt(x);
#else
    return std::sqrt(x);
#endif
}
inline float hardware_root(float x) {
#if defined(PHYSICS_HPP_SQRT_INSTRUCTION)
    typedef float lanes __attribute__((vector_size(16)));
    return __builtin_ia32_sqrtss(lanes{x, 0, 0, 0})[0];
#elif defined(__GNUC__)
    return __builtin_sqrtf(x);
#else
    return std::sqrt(x);
#endif
}
#undef PHYSICS_HPP_SQRT_INSTRUCTION

/// A square root rounded down, and what it leaves: a == root^2 + rest, 0 <= rest <= 2 root.
struct integer_root {
    std::uint64_t root = 0;
    uint128 rest{};
    /// The root to nearest; it is never a tie.
    constexpr std::uint64_t nearest() const { return root + std::uint64_t{rest > uint128(root)}; }
};

/// Two bits of a a round: for constant expressions, and for numbers above 125 bits.
constexpr integer_root root_by_digits(uint128 a) {
    uint128 root{}, rest = a;
    for (uint128 bit = uint128(std::uint64_t{1}) << 126; bit > uint128(std::uint64_t{0}); bit = bit >> 2) {
        const uint128 minimum = root + bit;
        root = root >> 1;
        if (rest >= minimum) {
            rest = rest - minimum;
            root = root + bit;
        }
    }
    return {low_half(root), rest};
}

/// The root of up to 125 bits: a hardware double gives its first 53 bits, a Newton step in doubles the others,
/// and integers repair the last unit, so that nothing depends on the floating-point environment. ~5 ns.
inline integer_root root_by_double(uint128 a) {
    const std::uint64_t high = high_half(a), low = low_half(a);
    if (high == 0 && low >> 62 == 0) {
        const std::int64_t whole = static_cast<std::int64_t>(low);
        std::int64_t root = static_cast<std::int64_t>(hardware_root(static_cast<double>(whole)));
        std::int64_t rest = whole - root * root;
        while (rest < 0) rest += 2 * --root + 1;
        while (rest > 2 * root) rest -= 2 * root++ + 1;
        return {static_cast<std::uint64_t>(root), uint128(static_cast<std::uint64_t>(rest))};
    }
    const double leading = static_cast<double>(static_cast<std::int64_t>(high)) * 0x1p64 +
                           static_cast<double>(static_cast<std::int64_t>(low >> 1)) * 2;
    // A guess that is a little too low makes the step positive, so that truncation is almost always right.
    const double guess = hardware_root(leading) * (1 - 0x1p-50);
    const double slope = 32768 / guess;
    std::uint64_t root = static_cast<std::uint64_t>(static_cast<std::int64_t>(guess));
    const int128 first_rest(a - product128(root, root));
    // |first_rest| < 2^77, since the guess is off by 2^13 at most.
    root +=
        static_cast<std::uint64_t>(static_cast<std::int64_t>(static_cast<double>((first_rest >> 16).low()) * slope));
    int128 rest(a - product128(root, root));
    while (rest.negative()) {
        --root;
        rest = rest + int128((uint128(root) << 1) + uint128(std::uint64_t{1}));
    }
    while (rest.bits > uint128(root) << 1) {
        rest = rest - int128((uint128(root) << 1) + uint128(std::uint64_t{1}));
        ++root;
    }
    return {root, rest.bits};
}

constexpr integer_root root_of(uint128 a) {
    return std::is_constant_evaluated() || bit_width(a) > 125 ? root_by_digits(a) : root_by_double(a);
}

}  // namespace detail

PHYSICS_HPP_END
