// Elementary functions of float and double against MPFR, over the whole range and where it is hardest.
#include "physics/base/math.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <compare>

#include "reference.hpp"

namespace {

/// The largest error allowed, in ulp. Users are promised 1 for double; the kernels do better, and a bound close to
/// what they do notices when one of their small terms goes missing.
template <class S>
constexpr double bound(double of_double) {
    return std::is_same_v<S, float> ? 0.501 : of_double;
}

template <class S>
double unary(const char* name, S (*ours)(S), reference::unary_function exact, int least, int most,
             const std::vector<S>& hard) {
    return reference::worst_of<S>(name, ours, exact, least, most, 100000, hard).error();
}

template <class S>
bool is_nan(S x) {
    return x != x;
}
template <class S>
bool negative(S x) {
    return std::signbit(x);
}

}  // namespace

// Named, since compilers would point out which of an unnamed type's operators stay unused.
namespace math_tests {

/// A user's number type.
struct user {
    double value = 0;
    user() = default;
    explicit user(double x) : value(x) {}
    explicit user(int x) : value(x) {}
    explicit operator double() const { return value; }
    friend user operator+(user a, user b) { return user(a.value + b.value); }
    friend user operator-(user a, user b) { return user(a.value - b.value); }
    friend user operator*(user a, user b) { return user(a.value * b.value); }
    friend user operator/(user a, user b) { return user(a.value / b.value); }
    friend user operator-(user a) { return user(-a.value); }
    user& operator+=(user b) { return *this = *this + b; }
    user& operator-=(user b) { return *this = *this - b; }
    user& operator*=(user b) { return *this = *this * b; }
    user& operator/=(user b) { return *this = *this / b; }
    friend auto operator<=>(user, user) = default;
};

}  // namespace math_tests

using math_tests::user;

/// Each function answers with its own number, to show who was asked.
template <>
struct physics::scalar_traits<user> {
    using wide = user;
    using inverse = user;
    static user epsilon() { return user(0x1p-52); }
    static user max() { return user(0x1p1000); }
    static bool is_finite(user x) { return x.value - x.value == 0; }
    static std::uint64_t bits(user x) { return scalar_traits<double>::bits(x.value); }
    static user sqrt(user x) { return x + user(1); }
    static user floor(user x) { return x + user(2); }
    static user sin(user x) { return x + user(3); }
    static user cos(user x) { return x + user(4); }
    static user tan(user x) { return x + user(5); }
    static user exp(user x) { return x + user(6); }
    static user log(user x) { return x + user(7); }
    static user acos(user x) { return x + user(8); }
    static user atan2(user y, user x) { return y - x; }
};

TEST_CASE("scalars of a user's own answer through their traits") {
    const user x(0.5);
    CHECK(physics::sqrt(x).value == 1.5);
    CHECK(physics::root<user>(x).value == 1.5);
    CHECK(physics::floor(x).value == 2.5);
    CHECK(physics::sin(x).value == 3.5);
    CHECK(physics::cos(x).value == 4.5);
    CHECK(physics::sine_cosine(x).sine.value == 3.5);
    CHECK(physics::sine_cosine(x).cosine.value == 4.5);
    CHECK(physics::tan(x).value == 5.5);
    CHECK(physics::exp(x).value == 6.5);
    CHECK(physics::log(x).value == 7.5);
    CHECK(physics::acos(x).value == 8.5);
    CHECK(physics::atan2(x, user(2)).value == -1.5);
    CHECK(physics::asin(x).value == 0.5 - (0.5 * 1.5 + 1));
    CHECK(physics::pi<user>.value == physics::pi<double>);
    CHECK(physics::half_pi<user>.value == physics::half_pi<double>);
    CHECK(physics::two_pi<user>.value == physics::two_pi<double>);
}

TEST_CASE_TEMPLATE("sine, cosine and tangent are right to the last place at every argument", S, float, double) {
    auto hard = reference::hard_arguments<S>();
    double least = 1;
    for (S x : reference::near_quarter_turns<S>()) {
        hard.push_back(x);
        least = std::min(least, std::min(std::fabs(double(physics::sin(x))), std::fabs(double(physics::cos(x)))));
    }
    // The adversary is what it claims to be: no float or double comes much closer to a multiple of pi/2.
    CHECK(least < (std::is_same_v<S, float> ? 2e-9 : 1e-18));
    CHECK(unary<S>(
              "sin", [](S x) { return physics::sin(x); }, mpfr_sin, -12, 22, hard) <= bound<S>(0.85));
    CHECK(unary<S>(
              "cos", [](S x) { return physics::cos(x); }, mpfr_cos, -12, 22, hard) <= bound<S>(0.85));
    CHECK(unary<S>(
              "tan", [](S x) { return physics::tan(x); }, mpfr_tan, -12, 22, hard) <= bound<S>(0.95));
}

TEST_CASE_TEMPLATE("exponential and logarithm are right to the last place", S, float, double) {
    const auto hard = reference::hard_arguments<S>();
    const int most = std::is_same_v<S, float> ? 6 : 9;
    CHECK(unary<S>(
              "exp", [](S x) { return physics::exp(x); }, mpfr_exp, -12, most, hard) <= bound<S>(0.8));
    CHECK(unary<S>(
              "log", [](S x) { return physics::log(x); }, mpfr_log, -4, 4, hard) <= bound<S>(0.9));
}

TEST_CASE_TEMPLATE("arccosine and arcsine are right to the last place", S, float, double) {
    const auto hard = reference::hard_arguments<S>();
    CHECK(unary<S>(
              "acos", [](S x) { return physics::acos(x); }, mpfr_acos, -10, -1, hard) <= bound<S>(0.85));
    CHECK(unary<S>(
              "asin", [](S x) { return physics::asin(x); }, mpfr_asin, -10, -1, hard) <= bound<S>(0.7));
}

TEST_CASE_TEMPLATE("the direction of a vector is right to the last place, whatever the ratio", S, float, double) {
    std::mt19937_64 engine(20240602);
    reference::worst<S> found("atan2");
    reference::number y, x, angle;
    // Braces around calls below make their order that of the text.
    const auto try_one = [&](std::array<S, 2> yx) {
        const auto [a, b] = yx;
        reference::set(y, a);
        reference::set(x, b);
        mpfr_atan2(angle, y, x, MPFR_RNDN);
        found.look(physics::atan2(a, b), angle, a, b);
    };
    for (int i = 0; i < 100000; ++i)
        try_one({reference::between<S>(engine, -5, 5), reference::between<S>(engine, -5, 5)});
    for (int i = 0; i < 20000; ++i)
        try_one({reference::between<S>(engine, -70, 70), reference::between<S>(engine, -2, 2)});
    for (int i = 0; i < 20000; ++i) try_one({reference::any<S>(engine), reference::any<S>(engine)});
    // Ratios at and next to those where the kernel changes its reference angle, and the corners of the range.
    using limits = std::numeric_limits<S>;
    std::vector<S> special{S(0),
                           limits::denorm_min(),
                           limits::min(),
                           limits::epsilon(),
                           S(0.125),
                           S(0.375),
                           S(0.71875),
                           S(1),
                           S(1 / 0.71875),
                           S(8.0 / 3),
                           S(8),
                           S(1e10),
                           limits::max() / 2,
                           limits::max(),
                           limits::infinity()};
    for (std::size_t i = 0, n = special.size(); i < n; ++i) {
        special.push_back(std::nextafter(special[i], S(0)));
        special.push_back(std::nextafter(special[i], limits::infinity()));
    }
    for (S a : special)
        for (S b : special)
            for (int signs = 0; signs < 4; ++signs) try_one({signs & 1 ? -a : a, signs & 2 ? -b : b});
    CHECK(found.error() <= bound<S>(0.55));
}

TEST_CASE_TEMPLATE("the square root is correctly rounded", S, float, double) {
    const auto hard = reference::hard_arguments<S>();
    CHECK(unary<S>(
              "sqrt", [](S x) { return physics::sqrt(x); }, mpfr_sqrt, -100, 100, hard) <= 0.5);
    CHECK(physics::root<S>(S(2.25)) == S(1.5));
}

TEST_CASE("float is double rounded once, at every 1009th of all floats") {
    long wrong = 0;
    const auto look = [&](float ours, double exact, float x) {
        const float nearest = static_cast<float>(exact);
        // Where double itself nearly ties, its own error may turn the rounding.
        if (ours == nearest || (is_nan(ours) && is_nan(nearest))) return;
        const double step = std::fabs(double(std::nextafter(nearest, ours)) - nearest);
        if (std::fabs(ours - exact) > 0.51 * step) {
            ++wrong;
            CAPTURE(x);
            CHECK(double(ours) == exact);
        }
    };
    for (std::uint64_t word = 0; word < (std::uint64_t{1} << 32) && wrong < 10; word += 1009) {
        const float x = std::bit_cast<float>(static_cast<std::uint32_t>(word));
        const double d = x;
        look(physics::sin(x), physics::sin(d), x);
        look(physics::cos(x), physics::cos(d), x);
        look(physics::tan(x), physics::tan(d), x);
        look(physics::exp(x), physics::exp(d), x);
        look(physics::log(x), physics::log(d), x);
        look(physics::acos(x), physics::acos(d), x);
        look(physics::asin(x), physics::asin(d), x);
        look(physics::atan2(x, 1.5f), physics::atan2(d, 1.5), x);
        look(physics::atan2(-2.5f, x), physics::atan2(-2.5, d), x);
    }
    CHECK(wrong == 0);
}

TEST_CASE_TEMPLATE("odd functions are odd, sine and cosine agree with their pair, floor is the integer below", S, float,
                   double) {
    std::mt19937_64 engine(20240603);
    auto arguments = reference::hard_arguments<S>();
    for (int i = 0; i < 20000; ++i) arguments.push_back(reference::any<S>(engine));
    for (int i = 0; i < 20000; ++i) arguments.push_back(reference::between<S>(engine, -5, 5));
    long odd = 0, pair = 0, whole = 0;
    for (const S x : arguments) {
        if (is_nan(x)) continue;
        if (x - x == 0) {
            odd += physics::sin(-x) != -physics::sin(x) || physics::tan(-x) != -physics::tan(x);
            odd += physics::cos(-x) != physics::cos(x);
            const auto [sine, cosine] = physics::sine_cosine(x);
            pair += sine != physics::sin(x) || negative(sine) != negative(physics::sin(x)) || cosine != physics::cos(x);
        }
        odd += std::fabs(x) <= 1 && physics::asin(-x) != -physics::asin(x);
        odd += physics::atan2(-x, S(3)) != -physics::atan2(x, S(3));
        const S f = physics::floor(x);
        whole += f != std::floor(x) || negative(f) != negative(std::floor(x));
    }
    CHECK(odd == 0);
    CHECK(pair == 0);
    CHECK(whole == 0);
}

TEST_CASE_TEMPLATE("zeros, infinities and NaN behave as IEEE 754 has it", S, float, double) {
    const S inf = std::numeric_limits<S>::infinity(), nan = std::numeric_limits<S>::quiet_NaN(), zero = 0;
    for (const S x : {inf, -inf, nan}) {
        CHECK(is_nan(physics::sin(x)));
        CHECK(is_nan(physics::cos(x)));
        CHECK(is_nan(physics::tan(x)));
        CHECK(is_nan(physics::sine_cosine(x).sine));
        CHECK(is_nan(physics::sine_cosine(x).cosine));
        CHECK(is_nan(physics::acos(x)));
        CHECK(is_nan(physics::asin(x)));
    }
    for (const S x : {S(1), inf, nan}) {
        CHECK(is_nan(physics::sqrt(-x)));
        CHECK(is_nan(physics::log(-x)));
    }
    CHECK(is_nan(physics::exp(nan)));
    CHECK(is_nan(physics::floor(nan)));
    CHECK(is_nan(physics::atan2(nan, S(1))));
    CHECK(is_nan(physics::atan2(inf, nan)));
    CHECK(is_nan(physics::acos(std::nextafter(S(1), inf))));
    CHECK(physics::exp(inf) == inf);
    CHECK(physics::exp(-inf) == zero);
    CHECK(physics::exp(zero) == S(1));
    CHECK(physics::log(zero) == -inf);
    CHECK(physics::log(-zero) == -inf);
    CHECK(physics::log(inf) == inf);
    CHECK(physics::log(S(1)) == zero);
    CHECK(physics::sqrt(inf) == inf);
    CHECK(physics::floor(-inf) == -inf);
    CHECK(physics::acos(S(1)) == zero);
    CHECK(negative(physics::sin(-zero)));
    CHECK(negative(physics::tan(-zero)));
    CHECK(negative(physics::asin(-zero)));
    CHECK(negative(physics::sqrt(-zero)));
    CHECK(negative(physics::floor(-zero)));
    CHECK(!negative(physics::sin(zero)));
    // The direction of the zero vector goes by the signs of its zeros, that of infinite ones by the octant.
    CHECK((physics::atan2(zero, zero) == zero && !negative(physics::atan2(zero, zero))));
    CHECK(negative(physics::atan2(-zero, zero)));
    CHECK(physics::atan2(zero, -zero) == physics::pi<S>);
    CHECK(physics::atan2(-zero, S(-1)) == -physics::pi<S>);
    CHECK(physics::atan2(inf, -inf) == static_cast<S>(2.356194490192344928847));
    CHECK(physics::atan2(-inf, inf) == static_cast<S>(-0.785398163397448309616));
    CHECK(physics::atan2(S(1), -inf) == physics::pi<S>);
    CHECK(negative(physics::atan2(S(-1), inf)));
}

TEST_CASE_TEMPLATE("the constants are correctly rounded", S, float, double) {
    reference::number exact;
    const auto error = [&](S constant, int halvings) {
        mpfr_const_pi(exact, MPFR_RNDN);
        mpfr_mul_2si(exact, exact, 1 - halvings, MPFR_RNDN);
        return reference::error(constant, exact);
    };
    CHECK(error(physics::two_pi<S>, 0) <= 0.5);
    CHECK(error(physics::pi<S>, 1) <= 0.5);
    CHECK(error(physics::half_pi<S>, 2) <= 0.5);
}
