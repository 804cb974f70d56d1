// What the tests of packs share: scalars of all kinds and values, all widths, and how to compare.
#pragma once

#include "physics/base/pack.hpp"

#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

// Named, since compilers would point out which of an unnamed type's operators stay unused.
namespace pack_tests {

/// A user's number type: explicit construction, no infinity, not known to any vector unit.
struct plain {
    double value = 0;
    plain() = default;
    explicit plain(double x) : value(x) {}
    explicit plain(int x) : value(x) {}
    explicit operator double() const { return value; }
    friend plain operator+(plain a, plain b) { return plain(a.value + b.value); }
    friend plain operator-(plain a, plain b) { return plain(a.value - b.value); }
    friend plain operator*(plain a, plain b) { return plain(a.value * b.value); }
    friend plain operator/(plain a, plain b) { return plain(a.value / b.value); }
    friend plain operator-(plain a) { return plain(-a.value); }
    plain& operator+=(plain b) { return *this = *this + b; }
    plain& operator-=(plain b) { return *this = *this - b; }
    plain& operator*=(plain b) { return *this = *this * b; }
    plain& operator/=(plain b) { return *this = *this / b; }
    friend bool operator==(plain a, plain b) { return a.value == b.value; }
    friend bool operator<(plain a, plain b) { return a.value < b.value; }
    friend bool operator>(plain a, plain b) { return a.value > b.value; }
    friend bool operator<=(plain a, plain b) { return a.value <= b.value; }
    friend bool operator>=(plain a, plain b) { return a.value >= b.value; }
};

}  // namespace pack_tests

using pack_tests::plain;

template <>
struct physics::scalar_traits<plain> {
    using wide = plain;
    using inverse = plain;
    static plain epsilon() { return plain(0x1p-52); }
    static plain max() { return plain(0x1p1000); }
    static bool is_finite(plain x) { return x.value - x.value == 0; }
    static std::uint64_t bits(plain x) { return scalar_traits<double>::bits(x.value); }
    static plain sqrt(plain x) { return plain(physics::sqrt(x.value)); }
};

namespace {

using physics::detail::native_width;
using physics::detail::pack;
using physics::detail::vector_bytes;

/// The same number with the same sign; NaNs are alike.
template <class S>
bool same(S a, S b) {
    if constexpr (std::is_floating_point_v<S>) {
        if (a != a || b != b) return a != a && b != b;
    }
    if constexpr (std::is_same_v<S, plain>) return same(a.value, b.value);
    else return std::memcmp(&a, &b, sizeof a) == 0;
}

template <class S>
class numbers {
public:
    /// Bits as they come for floating point, so all magnitudes, infinities, NaNs; and near 1 half of the time.
    S next() {
        const std::uint64_t word = engine_();
        const double small = static_cast<double>(static_cast<std::int64_t>(engine_())) * 0x1p-61;
        if constexpr (std::is_same_v<S, plain>) {
            return S(small);
        } else if constexpr (std::is_floating_point_v<S>) {
            if (word & 1) return static_cast<S>(small);
            S result;
            std::memcpy(&result, &word, sizeof result);
            return result;
        } else {
            return word & 1 ? S(small) : S::from_raw(static_cast<typename S::rep>(engine_()));
        }
    }
    /// The numbers that break things.
    static std::vector<S> adversaries() {
        if constexpr (std::is_same_v<S, plain>) {
            return {S(0), -S(0), S(1), S(-1), S(0.1), S(1e300), S(-1e300)};
        } else if constexpr (std::is_floating_point_v<S>) {
            using limits = std::numeric_limits<S>;
            const S least = limits::denorm_min(), tiny = limits::min(), most = limits::max(), step = limits::epsilon();
            const S infinite = limits::infinity(), nan = limits::quiet_NaN();
            return {0,     -S(0),    1,         -1,  least, -least, tiny, -tiny,  tiny - least, most,
                    -most, infinite, -infinite, nan, -nan,  2,      3,    S(0.1), 1 + step,     1 - step};
        } else {
            using limits = std::numeric_limits<typename S::rep>;
            return {S(0),
                    S(1),
                    S(-1),
                    S(0.1),
                    S::from_raw(1),
                    S::from_raw(-1),
                    S::from_raw(limits::max()),
                    S::from_raw(limits::min()),
                    S::from_raw(limits::max() / 2),
                    S(3)};
        }
    }

private:
    std::mt19937_64 engine_{20250101};
};

/// Counts the scalars that differ from what they should be, and remembers the first of them.
struct tally {
    int scalars = 0, wrong = 0;
    std::string first;

    template <class S>
    void same_all(const char* what, const S* got, const S* want, int n) {
        for (int i = 0; i < n; ++i) {
            ++scalars;
            if (!same(got[i], want[i]) && wrong++ == 0) first = std::string(what) + ", lane " + std::to_string(i);
        }
    }
};

// Sanitizers instrument every lane; the widest packs are two of the next width and no more.
#ifdef __SANITIZE_ADDRESS__
constexpr int most_lanes = 8;
#else
constexpr int most_lanes = 16;
#endif

/// Calls f.template operator()<P>() for each width up to the widest, with registers as the unit has them and with none.
template <class S, int Widest = most_lanes, class F>
void for_all_widths(F f) {
    f.template operator()<pack<S, 1>>();
    f.template operator()<pack<S, 2>>();
    f.template operator()<pack<S, 4>>();
    if constexpr (Widest >= 8) f.template operator()<pack<S, 8>>();
    if constexpr (Widest >= 16) f.template operator()<pack<S, 16>>();
    if constexpr (native_width < S >> 1) {
        f.template operator()<pack<S, 4, 0>>();
        if constexpr (vector_bytes > 16) f.template operator()<pack<S, 8, 16>>();
    }
}

}  // namespace
