// Fixed-point arithmetic against exact integers: values, wrap and saturation, and what the audit counts.
#ifndef PHYSICS_HPP_AUDIT
#define PHYSICS_HPP_AUDIT
#endif
#include "physics/base/scalar.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "integer.hpp"

namespace {

using exact::integer;
using physics::fixed;
using physics::wide_fixed;

using q24_40 = fixed<std::int64_t, 40>;
using q2_62 = fixed<std::int64_t, 62>;
using q63_1 = fixed<std::int64_t, 1>;
using q2_30 = fixed<std::int32_t, 30>;
using q31_1 = fixed<std::int32_t, 1>;
#define FORMATS physics::fixed32, physics::fixed48, physics::fixed16, q24_40, q2_62, q63_1, q2_30, q31_1

template <class S>
constexpr int bits = sizeof(typename S::rep) * 8;

/// A number of any size, and half of the time one whose square is in range.
template <class S>
S random_number(exact::words& source) {
    const auto raw = source.signed_word<typename S::rep>();
    return S::from_raw(static_cast<typename S::rep>(source.next() & 1 ? raw : raw >> (bits<S> - S::fraction_bits) / 2));
}

/// Counts results that are not the exact one wrapped or saturated, and audits that miscount.
template <class S>
class judge {
public:
    void wraps(S result, const integer& expected, std::uint64_t counted) {
        wrong_ += !(integer(result.raw()) == expected.wrapped(bits<S>));
        audit(expected, counted);
    }
    void saturates(S result, const integer& expected, std::uint64_t counted) {
        wrong_ += !(integer(result.raw()) == exact::saturated<typename S::rep>(expected));
        audit(expected, counted);
    }
    void expect(bool condition) { wrong_ += !condition; }
    long wrong() const { return wrong_; }
    long overflows() const { return overflows_; }

private:
    void audit(const integer& expected, std::uint64_t counted) {
        const bool out = !exact::fits<typename S::rep>(expected);
        overflows_ += out;
        wrong_ += counted != std::uint64_t{out};
    }
    long wrong_ = 0, overflows_ = 0;
};

template <class F>
auto audited(F f, std::uint64_t& counted) {
    physics::reset_overflow_count();
    const auto result = f();
    counted = physics::overflow_count();
    return result;
}

}  // namespace

TEST_CASE_TEMPLATE("sums and products wrap, quotients saturate, all are exact but for one rounding", S, FORMATS) {
    exact::words source(11);
    judge<S> verdict;
    std::uint64_t counted = 0;
    for (int i = 0; i < 60000; ++i) {
        const S a = random_number<S>(source), b = random_number<S>(source);
        const integer x(a.raw()), y(b.raw());
        const S sum = audited([&] { return a + b; }, counted);
        verdict.wraps(sum, x + y, counted);
        const S difference = audited([&] { return a - b; }, counted);
        verdict.wraps(difference, x - y, counted);
        const S negated = audited([&] { return -a; }, counted);
        verdict.wraps(negated, -x, counted);
        const S product = audited([&] { return a * b; }, counted);
        verdict.wraps(product, integer::nearest(x * y, integer(1) << S::fraction_bits), counted);
        if (b != S()) {
            const S quotient = audited([&] { return a / b; }, counted);
            verdict.saturates(quotient, integer::nearest(x << S::fraction_bits, y), counted);
        }
        const auto least = std::numeric_limits<typename S::rep>::min();
        if (a.raw() != least && b.raw() != least) {
            verdict.expect((-a) * b == -(a * b) && a * (-b) == -(a * b) && (-a) * (-b) == a * b);
            if (b != S() && (a / b).raw() > least && a / b < physics::scalar_traits<S>::max())
                verdict.expect((-a) / b == -(a / b) && a / (-b) == -(a / b) && (-a) / (-b) == a / b);
        }
        S changed = a;
        changed += b;
        verdict.expect(changed == sum);
        changed = a;
        changed -= b;
        verdict.expect(changed == difference);
        changed = a;
        changed *= b;
        verdict.expect(changed == product);
        verdict.expect((a < b) == (x < y) && (a > b) == (x > y) && (a <= b) == !(y < x) && (a >= b) == !(x < y));
        verdict.expect((a == b) == (x == y) && (a != b) == !(x == y) && +a == a);
    }
    CHECK(verdict.wrong() == 0);
    CHECK(verdict.overflows() > 1000);
}

TEST_CASE_TEMPLATE("division by zero saturates by the sign and is counted", S, FORMATS) {
    using limits = std::numeric_limits<typename S::rep>;
    physics::reset_overflow_count();
    CHECK((S(1) / S(0)).raw() == limits::max());
    CHECK((S(-1) / S(0)).raw() == limits::min());
    CHECK((S(0) / S(0)).raw() == 0);
    CHECK(physics::quotient<S>(product(S(1), S(1)), S(0)).raw() == limits::max());
    CHECK(physics::quotient<S>(product(S(0), S(1)), product(S(0), S(1))).raw() == 0);
    CHECK(physics::overflow_count() == 5);
    physics::reset_overflow_count();
    CHECK(physics::overflow_count() == 0);
}

TEST_CASE_TEMPLATE("conversions round to nearest and saturate", S, FORMATS) {
    exact::words source(12);
    judge<S> verdict;
    std::uint64_t counted = 0;
    const auto from_double = [&](double value) {
        // Exact: the double is m * 2^e.
        int e = 0;
        const auto m = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &e), 53));
        const int shift = e - 53 + S::fraction_bits;
        const S result = audited([&] { return S(value); }, counted);
        const integer expected = shift >= 0     ? integer(m) << shift
                                 : shift < -200 ? integer(0)
                                                : integer::nearest(integer(m), integer(1) << -shift);
        verdict.saturates(result, expected, counted);
        if (result.raw() != std::numeric_limits<typename S::rep>::min() && exact::fits<typename S::rep>(expected))
            verdict.expect(S(-value).raw() == -result.raw());
    };
    const double end = std::ldexp(1.0, bits<S> - 1 - S::fraction_bits), step = std::ldexp(1.0, -S::fraction_bits);
    for (double value :
         {0.0, 0.5 * step, 0.49999 * step, 1.5 * step, end, -end, end - 0.5 * step, end - step, -end - 0.4 * step,
          -end - 0.6 * step, std::nextafter(end, 0), std::nextafter(-end, -2 * end), 2 * end, 1e300, -1e300, 1e-300})
        from_double(value);
    for (int i = 0; i < 20000; ++i) {
        const std::uint64_t word = source.next(), scale = source.next();
        from_double(
            std::ldexp(static_cast<double>(static_cast<std::int64_t>(word)), static_cast<int>(scale % 130) - 128));
        const auto whole = source.signed_word<std::int64_t>() >> (scale % 64);
        const S from_whole = audited([&] { return S(whole); }, counted);
        verdict.saturates(from_whole, integer(whole) << S::fraction_bits, counted);

        // Out again: to the nearest double and float, and to the integer towards zero.
        const S a = random_number<S>(source);
        const double exact_value = std::ldexp(static_cast<double>(a.raw()), -S::fraction_bits);
        verdict.expect(static_cast<double>(a) == exact_value);
        verdict.expect(static_cast<float>(a) == std::ldexp(static_cast<float>(a.raw()), -S::fraction_bits));
        const std::int64_t cut = a.raw() / (std::int64_t{1} << S::fraction_bits);
        const int as_int = audited([&] { return static_cast<int>(a); }, counted);
        const bool fits = exact::fits<int>(integer(cut));
        verdict.expect(integer(as_int) == exact::saturated<int>(integer(cut)) && counted == std::uint64_t{!fits});
    }
    CHECK(verdict.wrong() == 0);
    CHECK(verdict.overflows() > 100);
    physics::reset_overflow_count();
    CHECK(S(std::numeric_limits<double>::quiet_NaN()) == S());
    CHECK(S(std::numeric_limits<double>::infinity()) == physics::scalar_traits<S>::max());
    CHECK(S(-std::numeric_limits<float>::infinity()).raw() == std::numeric_limits<typename S::rep>::min());
    CHECK(physics::overflow_count() == 3);
}

namespace {

template <class R, class A, class B>
void mixed(exact::words& source, long& wrong, long& overflows) {
    judge<R> verdict;
    std::uint64_t counted = 0;
    constexpr int up = R::fraction_bits + B::fraction_bits - A::fraction_bits;
    constexpr int down = A::fraction_bits + B::fraction_bits - R::fraction_bits;
    for (int i = 0; i < 4000; ++i) {
        const A a = random_number<A>(source);
        const B b = random_number<B>(source);
        const integer x(a.raw()), y(b.raw());
        const R converted = audited([&] { return R(a); }, counted);
        constexpr int shift = R::fraction_bits - A::fraction_bits;
        verdict.saturates(
            converted,
            shift >= 0 ? x << (shift < 0 ? 0 : shift) : integer::nearest(x, integer(1) << (shift < 0 ? -shift : 0)),
            counted);

        const auto wide = product(a, b);
        verdict.expect(integer::of(wide.raw) == x * y);
        if constexpr (down > 0) {
            const R narrowed = audited([&] { return physics::narrow<R>(wide); }, counted);
            const integer expected = integer::nearest(x * y, integer(1) << down);
            verdict.wraps(narrowed, expected, counted);
            verdict.expect(physics::mul<R>(a, b) == narrowed);
        }
        if (b == B()) continue;
        const R plain = audited([&] { return physics::quotient<R>(a, b); }, counted);
        verdict.saturates(plain,
                          integer::nearest(up >= 0 ? x << (up < 0 ? 0 : up) : x, up >= 0 ? y : y << (up < 0 ? -up : 0)),
                          counted);
        if (a.raw() != 0) verdict.expect(physics::reciprocal<R>(a) == physics::quotient<R>(A(1), a));

        // Wide over narrow, narrow over wide, wide over wide: fraction bits differ by those of the product.
        const auto over = [&](auto n, auto d, const integer& top, const integer& bottom, int lift) {
            const R result = audited([&] { return physics::quotient<R>(n, d); }, counted);
            verdict.saturates(
                result, integer::nearest(lift >= 0 ? top << lift : top, lift >= 0 ? bottom : bottom << -lift), counted);
        };
        over(wide, b, x * y, y, R::fraction_bits - A::fraction_bits);
        over(wide, a == A() ? A(1) : a, x * y, a == A() ? integer(A(1).raw()) : x, R::fraction_bits - B::fraction_bits);
        const auto square = product(b, b);
        over(a, square, x, y * y, R::fraction_bits + 2 * B::fraction_bits - A::fraction_bits);
        over(wide, square, x * y, y * y, up);
    }
    wrong += verdict.wrong();
    overflows += verdict.overflows();
}

}  // namespace

TEST_CASE("formats mix: products are exact, narrowing, quotients and conversions round once") {
    using physics::fixed16;
    using physics::fixed32;
    using physics::fixed48;
    exact::words source(13);
    long wrong = 0, overflows = 0;
    mixed<fixed32, fixed32, fixed32>(source, wrong, overflows);
    mixed<fixed32, fixed32, q24_40>(source, wrong, overflows);
    mixed<q24_40, fixed32, fixed32>(source, wrong, overflows);
    mixed<fixed16, fixed16, fixed16>(source, wrong, overflows);
    mixed<fixed16, fixed16, q24_40>(source, wrong, overflows);
    mixed<q24_40, fixed16, fixed16>(source, wrong, overflows);
    mixed<fixed48, q24_40, fixed48>(source, wrong, overflows);
    mixed<q24_40, fixed48, fixed16>(source, wrong, overflows);
    mixed<q2_30, fixed16, fixed32>(source, wrong, overflows);
    mixed<q2_62, q2_62, q63_1>(source, wrong, overflows);
    mixed<q63_1, q2_62, q2_62>(source, wrong, overflows);
    mixed<q31_1, q63_1, q2_62>(source, wrong, overflows);
    CHECK(wrong == 0);
    CHECK(overflows > 1000);
}

TEST_CASE_TEMPLATE("wide numbers: sums, order and roots", S, FORMATS) {
    using wide = physics::wide_of<S>;
    exact::words source(14);
    judge<S> verdict;
    std::uint64_t counted = 0;
    constexpr int wide_bits = sizeof(typename S::rep) * 16;
    for (int i = 0; i < 20000; ++i) {
        const S a = random_number<S>(source), b = random_number<S>(source), c = random_number<S>(source);
        const wide ab = product(a, b), cc = product(c, c);
        const integer x = integer(a.raw()) * integer(b.raw()), y = integer(c.raw()) * integer(c.raw());
        verdict.expect(integer::of((ab + cc).raw) == (x + y).wrapped(wide_bits));
        verdict.expect(integer::of((ab - cc).raw) == (x - y).wrapped(wide_bits));
        verdict.expect(integer::of((-ab).raw) == (-x).wrapped(wide_bits));
        verdict.expect((ab < cc) == (x < y) && (ab > cc) == (y < x) && (ab <= cc) == !(y < x) &&
                       (ab >= cc) == !(x < y));
        verdict.expect((ab == cc) == (x == y));
        verdict.expect(integer::of(physics::widen(a).raw) == integer(a.raw()) << S::fraction_bits);

        // The root in the own format, and in a coarser one where there is one of the same parity.
        const S root = audited([&] { return physics::root<S>(cc); }, counted);
        verdict.saturates(root, integer::nearest_root(y, integer(1)), counted);
        constexpr S most = S::from_raw(std::numeric_limits<typename S::rep>::max());
        for (const S limit : {b, root, root - S::from_raw(1), most}) {
            verdict.expect(physics::detail::is_root_greater(cc, limit) == (root > limit));
            verdict.expect(physics::detail::is_root_greater(-widen(S(1)), limit) == (S() > limit));
        }
        const wide sum = product(a, a) + cc;
        const integer z = integer(a.raw()) * integer(a.raw()) + y;
        if (!(sum < wide{})) {
            const S length = audited([&] { return physics::root<S>(sum); }, counted);
            verdict.saturates(length, integer::nearest_root(z, integer(1)), counted);
        }
        if constexpr (S::fraction_bits > 16) {
            using coarse = fixed<typename S::rep, 16>;
            judge<coarse> other;
            const coarse rough = audited([&] { return physics::root<coarse>(cc); }, counted);
            other.saturates(rough, integer::nearest_root(y, integer(1) << 2 * (S::fraction_bits - 16)), counted);
            verdict.expect(other.wrong() == 0);
        }
    }
    CHECK(verdict.wrong() == 0);
    physics::reset_overflow_count();
    CHECK(physics::root<S>(-product(S(1), S(1))) == S());
    CHECK(physics::overflow_count() == 1);
}

// Constant expressions compute the same.
static_assert(physics::fixed32(2) / physics::fixed32(3) == physics::fixed32::from_raw(2863311531));
static_assert(physics::fixed32(1.5) * physics::fixed32(-1.5) == physics::fixed32(-2.25));
static_assert(physics::root<physics::fixed32>(product(physics::fixed32(3), physics::fixed32(3))) ==
              physics::fixed32(3));
