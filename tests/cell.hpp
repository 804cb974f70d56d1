// One cell of the matrix, a scalar in a dimension: its types, how near is near in it, and its test cases' names.
// Each unit of the matrix defines CELL_SCALAR, CELL_DIMENSION and CELL_NAME, and includes this and a group of laws.
#pragma once

#include <doctest/doctest.h>

#include <physics.hpp>

#include <cstdint>
#include <cstdio>
#include <random>
#include <type_traits>

#include "archetype.hpp"

/// A test case of this cell, named for example `float/2D: rotation: inverse undoes`.
#define CELL_CASE(name) TEST_CASE(CELL_NAME ": " name)

// Unnamed, like all that depends on it: the cells of a group link into one program.
namespace {

struct cell {
    using scalar = CELL_SCALAR;
    static constexpr int dimension = CELL_DIMENSION;
    static constexpr const char* name = CELL_NAME;
    using space = physics::space<scalar, dimension>;
    using traits = physics::scalar_traits<scalar>;

    static constexpr bool is_2d = dimension == 2;
    static constexpr bool is_3d = dimension == 3;
    template <class S>
    static constexpr bool has_fraction_bits = requires {
        S::fraction_bits;
    };
    static constexpr bool is_fixed = has_fraction_bits<scalar>;

    /// Whether this is built under the address sanitizer, where everything takes ten times as long.
#if defined(__SANITIZE_ADDRESS__)
    static constexpr bool is_sanitized = true;
#elif defined(__has_feature)
    static constexpr bool is_sanitized = __has_feature(address_sanitizer);
#else
    static constexpr bool is_sanitized = false;
#endif

    /// Of how many random cases a law makes n, where its kernel computes in double whatever the scalar is: all in the
    /// cells of double, a tenth in the others.
    static constexpr int draws(int n) { return std::is_same_v<scalar, double> ? n : n < 10 ? 1 : n / 10; }

    /// The largest number that worlds compute with; of fixed-point ones their state may have half of it.
    static scalar largest() { return std::is_same_v<scalar, double> ? scalar(1e75) : traits::max(); }

    static scalar real(double x) { return scalar(x); }
    static double number(scalar x) { return static_cast<double>(x); }

    /// n times the spacing of numbers next to 1.
    static scalar tolerance(double n) { return scalar(n * number(traits::epsilon())); }

    /// Whether a and b are at most n spacings apart, of numbers next to 1 or, where those are larger, next to
    /// themselves. Fixed point has one spacing everywhere, but errors of products grow with their factors too.
    static bool near(scalar a, scalar b, double n) {
        const double x = number(a), y = number(b);
        double size = 1;
        if (x > size) size = x;
        if (-x > size) size = -x;
        if (y > size) size = y;
        if (-y > size) size = -y;
        const double gap = x < y ? y - x : x - y;
        return gap <= n * number(traits::epsilon()) * size;
    }

    /// Random numbers, the same on every system: the standard's distributions are not.
    class dice {
    public:
        explicit dice(std::uint64_t seed) : engine_(seed) {}
        std::uint64_t bits() { return engine_(); }
        /// From 0 to below n.
        int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
        double number(double low, double high) {
            return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
        }
        scalar real(double low, double high) { return scalar(number(low, high)); }
        template <class Vec>
        Vec vec(double low, double high) {
            Vec result{};
            for (int i = 0; i < Vec::size; ++i) result[i] = real(low, high);
            return result;
        }

    private:
        std::mt19937_64 engine_;
    };
};

}  // namespace

namespace cell_text {

inline doctest::String number(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", x);
    return text;
}

}  // namespace cell_text

template <class Rep, int FractionBits>
struct doctest::StringMaker<physics::fixed<Rep, FractionBits>> {
    static String convert(physics::fixed<Rep, FractionBits> x) { return cell_text::number(static_cast<double>(x)); }
};

template <>
struct doctest::StringMaker<archetype> {
    static String convert(archetype x) { return cell_text::number(static_cast<double>(x)); }
};

template <class S, int D>
struct doctest::StringMaker<physics::vec<S, D>> {
    static String convert(const physics::vec<S, D>& v) {
        String result = "(";
        for (int i = 0; i < D; ++i) {
            if (i) result += ", ";
            result += cell_text::number(static_cast<double>(v[i]));
        }
        return result += ")";
    }
};
