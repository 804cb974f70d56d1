// Elementary functions of float and double: the same bits everywhere, from + - * / and sqrt alone.
#pragma once

#include <limits>
#include <type_traits>

#include "physics/base/math_reduce.hpp"
#include "physics/base/root.hpp"

PHYSICS_HPP_BEGIN

// All kernels take and return double. Precise ones keep the parts of a result that do not fit in a double
// until the last addition, for errors below 1 ulp of double; the others stop their series at 2^-31 and serve
// float, whose only visible rounding is then the last one. The polynomials are relative minimax fits (Remez'
// exchange in 200-bit arithmetic) to what follows the leading terms of each Taylor series; their first terms
// are so close to Taylor's that float takes a beginning of the same table.

namespace detail {

inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinite = std::numeric_limits<double>::infinity();
inline constexpr double_pair pi_pair{0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
inline constexpr double_pair half_pi_pair{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};

/// (sin x - x) / x^3 in x^2, |x| <= pi/4; error of the sine 2^-58.
inline constexpr double sine_series[] = {-0x1.5555555555549p-3, 0x1.111111110f8a6p-7,   -0x1.a01a019c1619ep-13,
                                         0x1.71de357b1c021p-19, -0x1.ae5e689f1914fp-26, 0x1.5d93a47bc7c21p-33};
/// (cos x - 1 + x^2/2) / x^4 in x^2, |x| <= pi/4; error of the cosine 2^-64.
inline constexpr double cosine_series[] = {0x1.555555555554cp-5,   -0x1.6c16c16c1521fp-10, 0x1.a01a019cbf634p-16,
                                           -0x1.27e4f812b76b4p-22, 0x1.1ee9f153733fap-29,  -0x1.8fb13176f7930p-37};
/// (exp x - 1 - x) / x^2 in x, |x| <= log(2)/2; error of the exponential 2^-56.
inline constexpr double exp_series[] = {
    0x1.000000000000bp-1,  0x1.5555555555561p-3,  0x1.555555555001cp-5,  0x1.111111110d612p-7,  0x1.6c16c185ac392p-10,
    0x1.a01a01baf110cp-13, 0x1.a01996850cf70p-16, 0x1.71dddfa9da093p-19, 0x1.28b057f105d9bp-22, 0x1.af85bd3f177a1p-26};
/// (2 atanh s - 2 s) / s^3 in s^2, |s| <= (sqrt(2) - 1) / (sqrt(2) + 1); error of the logarithm 2^-59.
inline constexpr double log_series[] = {0x1.5555555555592p-1, 0x1.999999997ff18p-2, 0x1.24924941e16d9p-2,
                                        0x1.c71c52143773cp-3, 0x1.74663cf3c5182p-3, 0x1.39a1e80a6e733p-3,
                                        0x1.2f03c2b77e2b3p-3};
/// (atan u - u) / u^3 in u^2, |u| <= 0.1638; error of the arctangent 2^-60.
inline constexpr double arctangent_series[] = {-0x1.555555555553cp-2, 0x1.999999998dbdbp-3,  -0x1.2492491594086p-3,
                                               0x1.c71c5fce129e2p-4,  -0x1.7457528af2ff3p-4, 0x1.3a0e5503996aap-4,
                                               -0x1.f1be9b5d729d9p-5};
/// (asin x - x) / x^3 in x^2, |x| <= 1/2; error of the arcsine 2^-59.
inline constexpr double arcsine_series[] = {
    0x1.5555555555578p-3, 0x1.333333332df1fp-4,  0x1.6db6db722abbdp-5, 0x1.f1c71a8bebd1ap-6, 0x1.6e8bdfdc83fc0p-6,
    0x1.1c49decb2c3f1p-6, 0x1.ca212fb7b03dap-7,  0x1.7578420cf7d3cp-7, 0x1.6186833457bc3p-7, 0x1.e19e9ca2d18a3p-9,
    0x1.64ec74b91c73ap-6, -0x1.59d68e3a47e11p-6, 0x1.0bd9f58ddc882p-5};

template <int I, int Terms, int N>
constexpr double every_second_term(double xx, const double (&c)[N]) {
    if constexpr (I + 2 >= Terms) return c[I];
    else return c[I] + xx * every_second_term<I + 2, Terms>(xx, c);
}
/// The first Terms terms of a polynomial; even and odd terms side by side, which halves the latency.
template <int Terms, int N>
constexpr double polynomial(double x, const double (&c)[N]) {
    static_assert(Terms >= 2 && Terms <= N);
    const double xx = x * x;
    return every_second_term<0, Terms>(xx, c) + x * every_second_term<1, Terms>(xx, c);
}

/// The sine of a reduced angle, as a head and a tail of at most a ninth of it.
template <bool Precise>
constexpr double_pair sine_of(const reduced_angle& a) {
    const double z = a.high * a.high;
    const double cubic = a.high * z * polynomial < Precise ? 6 : 5 > (z, sine_series);
    return {a.high, Precise ? cubic + a.low * (1 - 0.5 * z) : cubic};
}
template <bool Precise>
constexpr double_pair cosine_of(const reduced_angle& a) {
    const double z = a.high * a.high;
    const double half = 0.5 * z;
    const double quartic = z * z * polynomial < Precise ? 6 : 5 > (z, cosine_series);
    const double head = 1 - half;
    return {head, Precise ? ((1 - head) - half) + (quartic - a.high * a.low) : quartic};
}
constexpr double sum(double_pair a) { return a.high + a.low; }

/// Below 2^-27 sine, tangent and arcsine are their argument, sign of zero included.
constexpr bool tiny(double x) { return x > -0x1p-27 && x < 0x1p-27; }

template <bool Precise>
constexpr double sine(double x) {
    if (x - x != 0) return not_a_number;
    if (tiny(x)) return x;
    const reduced_angle a = reduce<Precise>(x);
    const double value = a.quadrant & 1 ? sum(cosine_of<Precise>(a)) : sum(sine_of<Precise>(a));
    return a.quadrant & 2 ? -value : value;
}
template <bool Precise>
constexpr double cosine(double x) {
    if (x - x != 0) return not_a_number;
    const reduced_angle a = reduce<Precise>(x);
    const double value = a.quadrant & 1 ? sum(sine_of<Precise>(a)) : sum(cosine_of<Precise>(a));
    return (a.quadrant + 1) & 2 ? -value : value;
}
/// Sine (high) and cosine (low) from one reduction.
template <bool Precise>
constexpr double_pair sine_and_cosine(double x) {
    if (x - x != 0) return {not_a_number, not_a_number};
    if (tiny(x)) return {x, 1};
    const reduced_angle a = reduce<Precise>(x);
    const double s = sum(sine_of<Precise>(a)), c = sum(cosine_of<Precise>(a));
    const double first = a.quadrant & 1 ? c : s, second = a.quadrant & 1 ? s : c;
    return {a.quadrant & 2 ? -first : first, (a.quadrant + 1) & 2 ? -second : second};
}
template <bool Precise>
constexpr double tangent(double x) {
    if (x - x != 0) return not_a_number;
    if (tiny(x)) return x;
    const reduced_angle a = reduce<Precise>(x);
    const double_pair s = sine_of<Precise>(a);
    double_pair c = cosine_of<Precise>(a);
    if constexpr (Precise) c.low -= 0.5 * two_product(a.high, a.high).low;  // the rounding of x^2 in cosine_of
    const bool odd = a.quadrant & 1;
    const double_pair n = odd ? fast_two_sum(-c.high, -c.low) : fast_two_sum(s.high, s.low);
    const double_pair d = odd ? fast_two_sum(s.high, s.low) : fast_two_sum(c.high, c.low);
    const double quotient = n.high / d.high;
    if constexpr (!Precise) return quotient;
    const double_pair back = two_product(quotient, d.high);
    return quotient + (((n.high - back.high) - back.low) + (n.low - quotient * d.low)) / d.high;
}

/// atan(n / d) for 0 <= n <= d, n not below d / 2^60. Subtracts the nearest of atan(0, 1/4, 1/2, 1), since
/// atan(n/d) - atan(c) = atan((n - c d) / (d + c n)): those products are exact, and |u| <= 0.1638 remains.
template <bool Precise>
constexpr double_pair arctangent(double n, double d) {
    constexpr double_pair known[] = {{0, 0},
                                     {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                     {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                     {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};
    constexpr double tangents[] = {0, 0.25, 0.5, 1};
    const int i = (8 * n > d) + (8 * n > 3 * d) + (32 * n > 23 * d);
    const double c = tangents[i];
    if constexpr (!Precise) {
        const double u = (n - c * d) / (d + c * n);
        const double z = u * u;
        return {known[i].high, u + u * z * polynomial<6>(z, arctangent_series)};
    } else {
        const double_pair top = two_sum(n, -c * d), bottom = two_sum(d, c * n);
        const double inverse = 1 / bottom.high;
        const double u = top.high * inverse;
        const double_pair back = two_product(u, bottom.high);
        const double rest = (((top.high - back.high) - back.low) + (top.low - u * bottom.low)) * inverse;
        const double z = u * u;
        const double_pair whole = two_sum(known[i].high, u);
        return {whole.high, whole.low + (known[i].low + (rest + u * z * polynomial<7>(z, arctangent_series)))};
    }
}

template <bool Precise>
constexpr double arctangent2(double y, double x) {
    if (x != x || y != y) return not_a_number;
    const bool y_negative = detail::bit_cast<std::uint64_t>(y) >> 63 != 0;
    const bool x_negative = detail::bit_cast<std::uint64_t>(x) >> 63 != 0;
    double height = y_negative ? -y : y, width = x_negative ? -x : x;
    if (height == infinite || width == infinite) {
        const bool both = height == width;
        height = both || height == infinite ? 1 : 0;
        width = both || height == 0 ? 1 : 0;
    }
    const bool steep = height > width;
    double shorter = steep ? width : height, longer = steep ? height : width;
    const double_pair base = steep ? half_pi_pair : pi_pair;
    const double sign = y_negative ? -1 : 1;
    if (shorter <= longer * 0x1p-60) {
        if (steep || x_negative) return sign * base.high;
        return height == 0 ? sign * 0.0 : sign * (height / width);
    }
    if constexpr (Precise) {
        const double scale = longer > 0x1p400 ? 0x1p-600 : longer < 0x1p-400 ? 0x1p600 : 1;
        shorter *= scale;
        longer *= scale;
    }
    const double_pair angle = arctangent<Precise>(shorter, longer);
    if (!steep && !x_negative) return sign * sum(angle);
    const double turn = steep && x_negative ? 1 : -1;
    const double_pair total = two_sum(base.high, turn * angle.high);
    return sign * (total.high + (total.low + (base.low + turn * angle.low)));
}

/// asin(root) - root for root = sqrt(z) <= 1/2.
constexpr double arcsine_tail(double root, double z) { return root * z * polynomial<13>(z, arcsine_series); }
/// asin(sqrt(z)) for 0 < z <= 1/4, with the part of the root that a double can't hold.
template <bool Precise>
inline double_pair arcsine_of_root(double z) {
    const double root = hardware_root(z);
    double tail = arcsine_tail(root, z);
    if constexpr (Precise) {
        const double_pair square = two_product(root, root);
        tail += ((z - square.high) - square.low) / (2 * root);
    }
    return {root, tail};
}
/// Near the ends acos x = 2 asin(sqrt((1 - x) / 2)), whose argument is exact under the root.
template <bool Precise>
inline double arccosine(double x) {
    const double size = x < 0 ? -x : x;
    if (!(size <= 1)) return not_a_number;
    if (size <= 0.5) return half_pi_pair.high - (x - (half_pi_pair.low - arcsine_tail(x, x * x)));
    if (size == 1) return x < 0 ? pi_pair.high : 0;
    const double_pair half = arcsine_of_root<Precise>(0.5 * (1 - size));
    if (x > 0) return 2 * sum(half);
    return pi_pair.high - 2 * (half.high + (half.low - 0.5 * pi_pair.low));
}
template <bool Precise>
inline double arcsine(double x) {
    const double size = x < 0 ? -x : x;
    if (!(size <= 1)) return not_a_number;
    if (tiny(x)) return x;
    if (size <= 0.5) return x + arcsine_tail(x, x * x);
    if (size == 1) return x < 0 ? -half_pi_pair.high : half_pi_pair.high;
    const double_pair half = arcsine_of_root<Precise>(0.5 * (1 - size));
    const double_pair rest = two_sum(half_pi_pair.high, -2 * half.high);
    const double value = rest.high + (rest.low + (half_pi_pair.low - 2 * half.low));
    return x < 0 ? -value : value;
}

/// exp(n log 2 + r) = 2^n exp(r), |r| <= log(2)/2 (Cody & Waite 1980).
template <bool Precise>
constexpr double exponential(double x) {
    if (x != x) return not_a_number;
    if (x > 709.8) return infinite;
    if (x < -745.2) return 0;
    const int n = nearest_int(x * 0x1.71547652b82fep+0);
    const double turns = static_cast<double>(n);
    double_pair r{x - turns * 0x1.62e42fefa39efp-1, 0};
    if constexpr (Precise) r = two_sum(x - turns * 0x1.62e42fefa38p-1, -(turns * 0x1.ef35793c7673p-45));
    const double square = r.high * r.high * polynomial < Precise ? 10 : 8 > (r.high, exp_series);
    const double_pair head = fast_two_sum(1, r.high);
    const double value = head.high + (head.low + (r.low + square));
    // In two steps, since 2^n alone may leave the range of double; the second step rounds subnormal results.
    return value * power_of_two(n / 2) * power_of_two(n - n / 2);
}

/// log(2^n m) = n log 2 + log(1 + f), sqrt(1/2) <= m < sqrt(2). With s = f / (2 + f), log(1 + f) = 2 atanh(s)
/// = 2 s + s R(s^2) and 2 s = f - s f, hence = f - s (f - R) = f - f^2/2 + s (f^2/2 + R): the large terms
/// are exact or nearly so.
template <bool Precise>
constexpr double logarithm(double x) {
    if (!(x > 0)) return x == 0 ? -infinite : not_a_number;
    if (x == infinite) return infinite;
    int n = -1023;
    if (x < 0x1p-1022) {
        x *= 0x1p54;
        n -= 54;
    }
    constexpr std::uint64_t root_half = 0x3fe6a09e667f3bcd, one = 0x3ff0000000000000;
    const std::uint64_t word = detail::bit_cast<std::uint64_t>(x) - root_half + one;
    n += static_cast<int>(word >> 52);
    const double m = detail::bit_cast<double>((word & 0xfffffffffffff) + root_half);
    const double turns = static_cast<double>(n);
    const double f = m - 1;
    const double s = f / (2 + f);
    const double z = s * s;
    const double tail = z * polynomial < Precise ? 7 : 6 > (z, log_series);
    if constexpr (!Precise) return turns * 0x1.62e42fefa39efp-1 + (f - s * (f - tail));
    const double half = 0.5 * f * f;
    const double_pair head = two_sum(turns * 0x1.62e42fefa38p-1, f);
    return head.high + (head.low - (half - (s * (half + tail) + turns * 0x1.ef35793c7673p-45)));
}

/// The largest integer not above x.
template <class Real>
constexpr Real floor_of(Real x) {
    using Integer = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
    constexpr Real whole = Real(1) / std::numeric_limits<Real>::epsilon();
    if (!(x < whole && x > -whole) || x == 0) return x;
    const Real cut = static_cast<Real>(static_cast<Integer>(x));
    return cut > x ? cut - 1 : cut;
}

}  // namespace detail

PHYSICS_HPP_END
