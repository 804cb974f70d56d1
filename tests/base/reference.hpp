// Errors of results against MPFR, in units in the last place, and the arguments that are hardest to get right.
#pragma once

#include <doctest/doctest.h>

#define MPFR_USE_INTMAX_T
#include <mpfr.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "physics/base/fixed.hpp"

namespace reference {

inline constexpr int precision = 160;

/// A number with 160 bits and a practically unlimited exponent.
class number {
public:
    number() { mpfr_init2(value_, precision); }
    ~number() { mpfr_clear(value_); }
    number(const number&) = delete;
    number& operator=(const number&) = delete;
    operator mpfr_ptr() { return value_; }

private:
    mpfr_t value_;
};

inline void set(mpfr_ptr to, double x) { mpfr_set_d(to, x, MPFR_RNDN); }
inline void set(mpfr_ptr to, float x) { mpfr_set_flt(to, x, MPFR_RNDN); }
template <class Rep, int FractionBits>
void set(mpfr_ptr to, physics::fixed<Rep, FractionBits> x) {
    mpfr_set_sj(to, x.raw(), MPFR_RNDN);
    mpfr_div_2ui(to, to, FractionBits, MPFR_RNDN);
}

/// float, double, or Q and the bits before and after the point, sign included.
template <class S>
std::string name_of() {
    if constexpr (std::is_same_v<S, float>) return "float";
    else if constexpr (std::is_same_v<S, double>) return "double";
    else
        return "Q" + std::to_string(std::numeric_limits<typename S::rep>::digits + 1 - S::fraction_bits) + "." +
               std::to_string(S::fraction_bits);
}

template <class S>
inline constexpr bool is_real = std::numeric_limits<S>::is_iec559;

/// |result - exact| in units in the last place of exact; 1e9 where an infinity or a NaN is wrong. Changes exact.
template <class S>
double error(S result, mpfr_ptr exact) {
    constexpr double wrong = 1e9;
    static number storage;
    const mpfr_ptr difference = storage;
    if constexpr (is_real<S>) {
        using limits = std::numeric_limits<S>;
        if (mpfr_nan_p(exact)) return result != result ? 0 : wrong;
        if (result != result) return wrong;
        if (mpfr_zero_p(exact)) return result == 0 ? 0 : wrong;
        const bool infinite = result - result != 0;
        if (mpfr_inf_p(exact) || mpfr_get_exp(exact) > limits::max_exponent)
            return infinite && (result < 0) == (mpfr_sgn(exact) < 0) ? 0 : wrong;
        // An overflow counts as the power of two that it stands for.
        const double value = static_cast<double>(infinite ? (result < 0 ? S(-1) : S(1)) : result);
        if (infinite) mpfr_set_si_2exp(difference, value < 0 ? -1 : 1, limits::max_exponent, MPFR_RNDN);
        else mpfr_set_d(difference, value, MPFR_RNDN);
        mpfr_sub(difference, difference, exact, MPFR_RNDN);
        const long place = std::max<long>(mpfr_get_exp(exact) - limits::digits, limits::min_exponent - limits::digits);
        mpfr_mul_2si(difference, difference, -place, MPFR_RNDN);
    } else {
        using limits = std::numeric_limits<typename S::rep>;
        if (mpfr_nan_p(exact)) return result == S() ? 0 : wrong;
        mpfr_mul_2ui(exact, exact, S::fraction_bits, MPFR_RNDN);
        mpfr_set_sj(difference, limits::max(), MPFR_RNDN);
        mpfr_min(exact, exact, difference, MPFR_RNDN);
        mpfr_set_sj(difference, limits::min(), MPFR_RNDN);
        mpfr_max(exact, exact, difference, MPFR_RNDN);
        mpfr_set_sj(difference, result.raw(), MPFR_RNDN);
        mpfr_sub(difference, difference, exact, MPFR_RNDN);
    }
    return std::fabs(mpfr_get_d(difference, MPFR_RNDN));
}

/// Numbers of all magnitudes: any bits, which for float and double means any exponent.
template <class S>
S any(std::mt19937_64& engine) {
    const std::uint64_t word = engine();
    if constexpr (std::is_same_v<S, float>) return std::bit_cast<float>(static_cast<std::uint32_t>(word >> 32));
    else if constexpr (std::is_same_v<S, double>) return std::bit_cast<double>(word);
    else return S::from_raw(static_cast<typename S::rep>(static_cast<std::int64_t>(word) >> (engine() % 64)));
}
/// sign * m * 2^e, m from 1 to 2 and e between the given exponents, as far as S has them.
template <class S>
S between(std::mt19937_64& engine, int least, int most) {
    const std::uint64_t word = engine();
    const int e = least + static_cast<int>(engine() % static_cast<unsigned>(most - least + 1));
    const double m = static_cast<double>((word >> 12) | (std::uint64_t{1} << 52)) * 0x1p-52;
    return S(std::ldexp(word & 1 ? -m : m, e));
}

/// Near every power of two, every simple fraction and multiple of pi/4, and at the ends of the range.
template <class S>
std::vector<S> hard_arguments() {
    std::vector<double> bases;
    for (int e = -1074; e < 1024; ++e) bases.push_back(std::ldexp(1.0, e));
    for (int i = 1; i < 400; ++i) bases.push_back(i / 32.0);
    for (int i = 1; i < 400; ++i) bases.push_back(i * 0.78539816339744830962);
    // Halves of log 2, as far as the exponential has not left the range.
    for (int i = 1; i < (is_real<S> ? 2200 : 130); ++i) bases.push_back(i * 0.34657359027997265471);
    std::vector<S> list;
    const auto both = [&](S x) {
        list.push_back(x);
        list.push_back(-x);
    };
    for (double base : bases) {
        if constexpr (is_real<S>) {
            S below = static_cast<S>(base), above = below;
            for (int i = 0; i < 4; ++i) {
                both(below);
                both(above);
                below = std::nextafter(below, S(0));
                above = std::nextafter(above, std::numeric_limits<S>::infinity());
            }
        } else {
            if (base * std::ldexp(1.0, S::fraction_bits) >
                0.6 * static_cast<double>(std::numeric_limits<typename S::rep>::max()))
                continue;
            for (int i = -3; i <= 3; ++i) both(S(base) + S::from_raw(static_cast<typename S::rep>(i)));
        }
    }
    if constexpr (is_real<S>) {
        both(S(0));
        both(std::numeric_limits<S>::infinity());
        both(std::numeric_limits<S>::max());
        list.push_back(std::numeric_limits<S>::quiet_NaN());
    } else {
        using limits = std::numeric_limits<typename S::rep>;
        for (int i = 0; i < 4; ++i) {
            list.push_back(S::from_raw(static_cast<typename S::rep>(limits::max() - i)));
            list.push_back(S::from_raw(static_cast<typename S::rep>(limits::min() + i)));
        }
    }
    return list;
}

/// The numbers m * 2^e, m below 2^digits, that come closest to multiples of pi/2, for each e: numerators of the
/// continued fraction of pi/2 / 2^e. A reduction that keeps too few bits of pi fails here first.
template <class S>
std::vector<S> near_quarter_turns() {
    constexpr int digits = std::numeric_limits<S>::digits;
    std::vector<S> list;
    mpfr_t x, whole;
    mpfr_init2(x, 2400);
    mpfr_init2(whole, 2400);
    const auto collect = [&](int e, int bits, auto&& add) {
        mpfr_const_pi(x, MPFR_RNDN);
        mpfr_div_2si(x, x, 1 + e, MPFR_RNDN);
        double before = 1, numerator = 0;
        const double most = std::ldexp(1.0, bits);
        // The numerators p follow p = a p' + p'' for each partial quotient a; the fraction starts below p = a0.
        for (int i = 0; i < 200 && !mpfr_zero_p(x); ++i) {
            mpfr_floor(whole, x);
            const double quotient = mpfr_get_d(whole, MPFR_RNDN);
            const double next = i == 0 ? quotient : quotient * numerator + before;
            if (next >= most) break;
            before = i == 0 ? 1 : numerator;
            numerator = next;
            if (numerator > 0) add(numerator);
            mpfr_sub(x, x, whole, MPFR_RNDN);
            if (!mpfr_zero_p(x)) mpfr_ui_div(x, 1, x, MPFR_RNDN);
        }
    };
    if constexpr (is_real<S>) {
        for (int e = -digits; e <= std::numeric_limits<S>::max_exponent - digits; ++e)
            collect(e, digits, [&](double m) { list.push_back(static_cast<S>(std::ldexp(m, e))); });
    } else {
        collect(-S::fraction_bits, std::min(53, std::numeric_limits<typename S::rep>::digits),
                [&](double m) { list.push_back(S::from_raw(static_cast<typename S::rep>(m))); });
    }
    mpfr_clear(x);
    mpfr_clear(whole);
    return list;
}

using unary_function = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);

/// The largest error seen, told when asked for.
template <class S>
class worst {
public:
    explicit worst(const char* function) : function_(function) {}
    void look(S result, mpfr_ptr exact, S x, S y = S()) {
        const double e = reference::error(result, exact);
        if (e > error_ || count_ == 0) error_ = e, x_ = x, y_ = y;
        ++count_;
    }
    double error() const {
        char text[160];
        std::snprintf(text, sizeof text, "%s %s: at most %.3f ulp in %ld arguments, at (%.17g, %.17g)", function_,
                      name_of<S>().c_str(), error_, count_, static_cast<double>(x_), static_cast<double>(y_));
        MESSAGE(std::string(text));
        return error_;
    }

private:
    const char* function_;
    double error_ = 0;
    S x_{}, y_{};
    long count_ = 0;
};

/// The given arguments, count random ones with exponents from least to most, and an eighth as many of any bits.
template <class S>
worst<S> worst_of(const char* name, S (*ours)(S), unary_function exact, int least, int most, int count,
                  const std::vector<S>& hard) {
    std::mt19937_64 engine(20240601);
    number x, y;
    worst<S> found(name);
    const auto try_one = [&](S argument) {
        set(x, argument);
        exact(y, x, MPFR_RNDN);
        found.look(ours(argument), y, argument);
    };
    for (const S argument : hard) try_one(argument);
    for (int i = 0; i < count; ++i) try_one(between<S>(engine, least, most));
    for (int i = 0; i < count / 8; ++i) try_one(any<S>(engine));
    return found;
}

}  // namespace reference
