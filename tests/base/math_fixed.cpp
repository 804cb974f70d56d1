// Elementary functions of fixed point against MPFR, in usual and odd formats; saturation is counted.
#ifndef PHYSICS_HPP_AUDIT
#define PHYSICS_HPP_AUDIT
#endif
#include "physics/base/math.hpp"

#include <doctest/doctest.h>

#include <array>
#include <string>

#include "reference.hpp"

namespace {

using reference::number;

#define FORMATS physics::fixed32, physics::fixed48, physics::fixed16, q24_40, q2_62, q62_2, q2_30, q31_1
using q24_40 = physics::fixed<std::int64_t, 40>;
using q2_62 = physics::fixed<std::int64_t, 62>;
using q62_2 = physics::fixed<std::int64_t, 2>;
using q2_30 = physics::fixed<std::int32_t, 30>;
using q31_1 = physics::fixed<std::int32_t, 1>;

/// The rounding at the end is all that is seen, unless the format has nearly as many bits as the kernels.
template <class S>
constexpr double bound = S::fraction_bits <= 48 ? 0.51 : 2.0;
/// Results that grow large show the kernels' last bits also in formats with few fraction bits.
template <class S>
constexpr double steep_bound = sizeof(typename S::rep) == 4 ? 0.51 : 2.0;

template <class S>
double unary(const char* name, S (*ours)(S), reference::unary_function exact, int least, int most) {
    auto hard = reference::hard_arguments<S>();
    for (S x : reference::near_quarter_turns<S>()) hard.push_back(x);
    return reference::worst_of<S>(name, ours, exact, least, most, 16000, hard).error();
}

/// Fixed point takes a cosine or sine beyond 1 as 1.
template <reference::unary_function Exact>
int clamped(mpfr_ptr y, mpfr_srcptr x, mpfr_rnd_t rounding) {
    if (mpfr_cmpabs_ui(x, 1) <= 0) return Exact(y, x, rounding);
    mpfr_set_si(y, mpfr_sgn(x), rounding);
    return Exact(y, y, rounding);
}

/// What saturates, does so to the end that the exact result lies beyond, and is counted once.
template <class S>
void saturates(const char* name, S (*ours)(S), reference::unary_function exact) {
    number x, y;
    long wrong = 0, seen = 0;
    std::mt19937_64 engine(20240604);
    auto arguments = reference::hard_arguments<S>();
    for (int i = 0; i < 4000; ++i) arguments.push_back(reference::any<S>(engine));
    for (const S argument : arguments) {
        reference::set(x, argument);
        exact(y, x, MPFR_RNDN);
        if (mpfr_nan_p(static_cast<mpfr_ptr>(y))) continue;
        mpfr_mul_2ui(y, y, S::fraction_bits, MPFR_RNDN);
        using limits = std::numeric_limits<typename S::rep>;
        physics::reset_overflow_count();
        const S result = ours(argument);
        const bool counted = physics::overflow_count() == 1;
        // A result within an ulp or two of the end may round to either side of it.
        const double scaled = mpfr_get_d(y, MPFR_RNDN), end = std::ldexp(1.0, limits::digits),
                     slack = 4 + end * 0x1p-52;
        if (scaled > end + slack) ++seen, wrong += !counted || result.raw() != limits::max();
        else if (scaled < -end - slack) ++seen, wrong += !counted || result.raw() != limits::min();
        else if (scaled < end - slack && scaled > -end + slack) wrong += physics::overflow_count() != 0;
    }
    INFO(std::string(name) << " " << reference::name_of<S>() << ", saturated: " << seen);
    CHECK(wrong == 0);
}

}  // namespace

TEST_CASE_TEMPLATE("fixed point: sine and cosine", S, FORMATS) {
    CHECK(unary<S>(
              "sin", [](S x) { return physics::sin(x); }, mpfr_sin, -20, 10) <= bound<S>);
    CHECK(unary<S>(
              "cos", [](S x) { return physics::cos(x); }, mpfr_cos, -20, 10) <= bound<S>);
}

TEST_CASE_TEMPLATE("fixed point: tangent", S, FORMATS) {
    CHECK(unary<S>(
              "tan", [](S x) { return physics::tan(x); }, mpfr_tan, -20, 10) <= steep_bound<S>);
    saturates<S>(
        "tan", [](S x) { return physics::tan(x); }, mpfr_tan);
}

TEST_CASE_TEMPLATE("fixed point: exponential and logarithm", S, FORMATS) {
    CHECK(unary<S>(
              "exp", [](S x) { return physics::exp(x); }, mpfr_exp, -12, 5) <= steep_bound<S>);
    CHECK(unary<S>(
              "log", [](S x) { return physics::log(x); }, mpfr_log, -S::fraction_bits, 20) <= bound<S>);
    saturates<S>(
        "exp", [](S x) { return physics::exp(x); }, mpfr_exp);
    physics::reset_overflow_count();
    CHECK(physics::log(S()).raw() == std::numeric_limits<typename S::rep>::min());
    CHECK(physics::log(-physics::scalar_traits<S>::epsilon()) == S());
    CHECK(physics::overflow_count() == 2);
}

TEST_CASE_TEMPLATE("fixed point: arccosine and arcsine", S, FORMATS) {
    CHECK(unary<S>(
              "acos", [](S x) { return physics::acos(x); }, clamped<mpfr_acos>, -10, -1) <= bound<S>);
    CHECK(unary<S>(
              "asin", [](S x) { return physics::asin(x); }, clamped<mpfr_asin>, -10, -1) <= bound<S>);
    // Beyond the domain as at its end, and counted.
    const S above = S(1) + physics::scalar_traits<S>::epsilon();
    physics::reset_overflow_count();
    CHECK(physics::acos(above) == S(0));
    CHECK(physics::asin(above) == physics::half_pi<S>);
    CHECK(physics::asin(-above) == -physics::half_pi<S>);
    CHECK(physics::overflow_count() == 3);
    CHECK(physics::acos(-above) == physics::pi<S>);
}

TEST_CASE_TEMPLATE("fixed point: direction of a vector", S, FORMATS) {
    std::mt19937_64 engine(20240605);
    reference::worst<S> found("atan2");
    number y, x, angle;
    const auto try_one = [&](std::array<S, 2> yx) {
        const auto [a, b] = yx;
        reference::set(y, a);
        reference::set(x, b);
        mpfr_atan2(angle, y, x, MPFR_RNDN);
        found.look(physics::atan2(a, b), angle, a, b);
    };
    for (int i = 0; i < 20000; ++i) try_one({reference::any<S>(engine), reference::any<S>(engine)});
    using limits = std::numeric_limits<typename S::rep>;
    std::vector<typename S::rep> special{0,
                                         1,
                                         2,
                                         3,
                                         4,
                                         5,
                                         7,
                                         8,
                                         23,
                                         32,
                                         limits::max(),
                                         limits::max() / 8,
                                         limits::max() / 8 * 3,
                                         limits::max() / 32 * 23};
    for (std::size_t i = 1, n = special.size(); i < n; ++i)
        for (int step : {-1, 1})
            special.push_back(
                static_cast<typename S::rep>(special[i] - (step > 0 && special[i] == limits::max() ? 0 : -step)));
    for (std::size_t i = 1, n = special.size(); i < n; ++i)
        special.push_back(static_cast<typename S::rep>(-special[i]));
    special.push_back(limits::min());
    for (auto a : special)
        for (auto b : special) try_one({S::from_raw(a), S::from_raw(b)});
    CHECK(found.error() <= bound<S>);
    CHECK(physics::atan2(S(), S()) == S());
}

TEST_CASE_TEMPLATE("fixed point: square root and floor", S, FORMATS) {
    const auto root = [](S x) { return physics::sqrt(x); };
    CHECK(unary<S>("sqrt", root, mpfr_sqrt, -S::fraction_bits, 40) <= 0.5);
    physics::reset_overflow_count();
    CHECK(physics::sqrt(-physics::scalar_traits<S>::epsilon()) == S());
    CHECK(physics::overflow_count() == 1);
    std::mt19937_64 engine(20240606);
    for (int i = 0; i < 1000; ++i) {
        const S x = reference::any<S>(engine), whole = physics::floor(x);
        CHECK(whole <= x);
        CHECK(whole.raw() % (typename S::rep{1} << S::fraction_bits) == 0);
        CHECK((x - whole).raw() < (typename S::rep{1} << S::fraction_bits));
    }
}

TEST_CASE_TEMPLATE("fixed point: exact symmetries", S, FORMATS) {
    std::mt19937_64 engine(20240607);
    auto arguments = reference::hard_arguments<S>();
    for (int i = 0; i < 10000; ++i) arguments.push_back(reference::any<S>(engine));
    long wrong = 0;
    for (const S x : arguments) {
        if (x.raw() == std::numeric_limits<typename S::rep>::min()) continue;
        wrong += physics::sin(-x) != -physics::sin(x) || physics::cos(-x) != physics::cos(x);
        const S tangent = physics::tan(x), most = physics::scalar_traits<S>::max();
        if (tangent < most && tangent > -most) wrong += physics::tan(-x) != -tangent;
        wrong += physics::asin(-x) != -physics::asin(x);
        wrong += physics::atan2(-x, S(1)) != -physics::atan2(x, S(1));
        const auto [sine, cosine] = physics::sine_cosine(x);
        wrong += sine != physics::sin(x) || cosine != physics::cos(x);
    }
    CHECK(wrong == 0);
}

TEST_CASE_TEMPLATE("fixed point: constants", S, FORMATS) {
    number exact;
    const auto error = [&](S constant, int halvings) {
        mpfr_const_pi(exact, MPFR_RNDN);
        mpfr_mul_2si(exact, exact, 1 - halvings, MPFR_RNDN);
        return reference::error(constant, exact);
    };
    CHECK(error(physics::two_pi<S>, 0) <= 0.5);
    CHECK(error(physics::pi<S>, 1) <= 0.5);
    CHECK(error(physics::half_pi<S>, 2) <= 0.5);
}

// All of it works in constant expressions, with the same digits.
TEST_CASE("fixed point: constant expressions") {
    using S = physics::fixed32;
    constexpr S x = S(0.7), y = S(-2.3);
    constexpr S values[] = {physics::sin(x), physics::cos(y), physics::tan(x),  physics::atan2(x, y), physics::acos(x),
                            physics::exp(y), physics::log(x), physics::sqrt(x), physics::asin(x)};
    const S again[] = {physics::sin(x), physics::cos(y), physics::tan(x),  physics::atan2(x, y), physics::acos(x),
                       physics::exp(y), physics::log(x), physics::sqrt(x), physics::asin(x)};
    for (int i = 0; i < 9; ++i) CHECK(values[i] == again[i]);
}
