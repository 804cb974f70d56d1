// Fixed-point numbers with exact wide products: integers only, hence the same bits by construction.
#pragma once

#include <concepts>
#include <limits>
#include <type_traits>

#include "physics/base/root.hpp"

PHYSICS_HPP_BEGIN

/// How many fixed-point results left their range on this thread since the last reset: sums and products
/// that wrapped, and quotients, roots and conversions that saturated. Counts only where the user defines
/// PHYSICS_HPP_AUDIT; always 0 otherwise.
std::uint64_t overflow_count() noexcept;
/// Sets this thread's overflow_count back to 0.
void reset_overflow_count() noexcept;

namespace detail {

#ifdef PHYSICS_HPP_AUDIT
inline thread_local std::uint64_t overflow_counter = 0;
#endif

constexpr void note_overflow([[maybe_unused]] bool happened) noexcept {
#ifdef PHYSICS_HPP_AUDIT
    if (!std::is_constant_evaluated() && happened) ++overflow_counter;
#endif
}

/// The integer that holds a product of two representations exactly.
template <class A, class B>
using product_integer = std::conditional_t<sizeof(A) == 4 && sizeof(B) == 4, std::int64_t, int128>;

template <class Rep, class Int>
constexpr bool fits(Int a) {
    return a >= Int(std::int64_t{std::numeric_limits<Rep>::min()}) &&
           a <= Int(std::int64_t{std::numeric_limits<Rep>::max()});
}

/// a / 2^Shift to nearest, ties away from zero. Takes the low bits, so that a result out of range wraps; the audit
/// counts it.
template <class Rep, int Shift, class Int>
PHYSICS_HPP_ALWAYS_INLINE constexpr Rep shift_wrapped(Int a) {
#ifdef PHYSICS_HPP_AUDIT
    note_overflow(!fits<Rep>(shift_nearest(a, Shift)));
#endif
    if constexpr (Shift < 64) return static_cast<Rep>(low_of_shift_nearest(a, Shift));
    else return static_cast<Rep>(shift_nearest(a, Shift).low());
}

template <class Rep>
constexpr Rep saturated(bool negative) {
    note_overflow(true);
    return negative ? std::numeric_limits<Rep>::min() : std::numeric_limits<Rep>::max();
}

/// sign * magnitude, saturating.
template <class Rep>
constexpr Rep signed_saturating(bool negative, std::uint64_t magnitude) {
    const std::uint64_t maximum = static_cast<std::uint64_t>(std::numeric_limits<Rep>::max()) + std::uint64_t{negative};
    if (magnitude > maximum) return saturated<Rep>(negative);
    return static_cast<Rep>(static_cast<std::int64_t>(negative ? std::uint64_t{0} - magnitude : magnitude));
}
template <class Rep>
constexpr Rep signed_saturating(bool negative, uint128 magnitude) {
    return high_half(magnitude) != 0 ? saturated<Rep>(negative) : signed_saturating<Rep>(negative, low_half(magnitude));
}

constexpr std::uint64_t magnitude64(std::int64_t a) {
    return a < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(a) : static_cast<std::uint64_t>(a);
}
constexpr uint128 magnitude128(std::int64_t a) { return uint128(magnitude64(a)); }
constexpr uint128 magnitude128(int128 a) { return a.magnitude(); }

/// 0 / 0 is 0; other numbers by zero saturate.
template <class Rep>
constexpr Rep quotient_by_zero(bool negative, bool of_zero) {
    if (!of_zero) return saturated<Rep>(negative);
    note_overflow(true);
    return 0;
}

/// n * 2^shift / d to nearest, ties away from zero, saturating; shift from 1 to 63. One hardware division.
template <class Rep>
constexpr Rep scaled_quotient(bool negative, std::uint64_t n, int shift, std::uint64_t d) {
    if (d == 0) return quotient_by_zero<Rep>(negative, n == 0);
    const std::uint64_t high = n >> (64 - shift);
    if (high >= d) return saturated<Rep>(negative);
    std::uint64_t rest = 0;
    const std::uint64_t quotient = divide128(high, n << shift, d, rest);
    // No carry out of 64 bits: where the quotient is that large d <= 2^shift, of which the dividend is a multiple.
    return signed_saturating<Rep>(negative, quotient + std::uint64_t{rest >= d - rest});
}

/// a * 2^shift / b to nearest, ties away from zero, saturating; shift from -126 up, a and b up to 2^127.
/// Exact: where a * 2^shift has more than 128 bits, the division goes on with the rest, as many bits a round
/// as there is room for.
template <class Rep>
constexpr Rep scaled_quotient(bool negative, uint128 a, int shift, uint128 b) {
    if (b == uint128(0)) return quotient_by_zero<Rep>(negative, a == uint128(0));
    uint128 quotient{}, rest = a;
    do {
        const int room = 128 - bit_width(rest | uint128(1));
        const int step = shift < 0 ? 0 : shift < room ? shift : room;
        if (bit_width(quotient) + step > 127) return saturated<Rep>(negative);
        const uint128 dividend = rest << step;
        quotient = (quotient << step) + divide128(dividend, b, rest);
        shift -= step;
    } while (shift > 0);
    if (shift < 0) return signed_saturating<Rep>(negative, ((quotient >> (-shift - 1)) + uint128(1)) >> 1);
    return signed_saturating<Rep>(negative, rest >= b - rest ? quotient + uint128(1) : quotient);
}

}  // namespace detail

/// An exact product of two fixed-point numbers, or a sum of such: compare it as it is, or narrow it once.
/// Range: 128 bits for 64-bit operands, 64 for 32-bit ones; wraps beyond.
template <class Int, int FractionBits>
struct wide_fixed {
    Int raw{};
};

namespace detail {
constexpr int128 wide_sum(int128 a, int128 b) { return a + b; }
constexpr std::int64_t wide_sum(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
constexpr int128 wide_negated(int128 a) { return -a; }
constexpr std::int64_t wide_negated(std::int64_t a) {
    return static_cast<std::int64_t>(std::uint64_t{0} - static_cast<std::uint64_t>(a));
}
}  // namespace detail

template <class Int, int F>
constexpr wide_fixed<Int, F> operator+(wide_fixed<Int, F> a, wide_fixed<Int, F> b) {
    return {detail::wide_sum(a.raw, b.raw)};
}
template <class Int, int F>
constexpr wide_fixed<Int, F> operator-(wide_fixed<Int, F> a, wide_fixed<Int, F> b) { return a + -b; }
template <class Int, int F>
constexpr wide_fixed<Int, F> operator-(wide_fixed<Int, F> a) { return {detail::wide_negated(a.raw)}; }
template <class Int, int F>
constexpr bool operator==(wide_fixed<Int, F> a, wide_fixed<Int, F> b) { return a.raw == b.raw; }
template <class Int, int F>
constexpr bool operator<(wide_fixed<Int, F> a, wide_fixed<Int, F> b) { return a.raw < b.raw; }
template <class Int, int F>
constexpr bool operator>(wide_fixed<Int, F> a, wide_fixed<Int, F> b) { return b.raw < a.raw; }
template <class Int, int F>
constexpr bool operator<=(wide_fixed<Int, F> a, wide_fixed<Int, F> b) { return !(b.raw < a.raw); }
template <class Int, int F>
constexpr bool operator>=(wide_fixed<Int, F> a, wide_fixed<Int, F> b) { return !(a.raw < b.raw); }

/// A fixed-point number: an integer of type Rep that counts units of 2^-FractionBits.
/// Sums and products wrap, quotients, roots and conversions saturate, all rounding is to nearest with ties
/// away from zero, so that f(-x) == -f(x). Every operation is exact integer arithmetic: no result depends
/// on compiler, processor or floating-point environment. Cost: sums as integers, product 1 ns,
/// quotient 2-4 ns, root 3-8 ns (two to three times that where there is no __int128).
template <class Rep, int FractionBits>
class fixed {
    static_assert(std::is_same_v<Rep, std::int32_t> || std::is_same_v<Rep, std::int64_t>,
                  "physics::fixed: the representation must be std::int32_t or std::int64_t");
    static_assert(
        FractionBits > 0 && FractionBits < std::numeric_limits<Rep>::digits,
        "physics::fixed: the fraction must have at least one bit and leave at least one for the integer part");

public:
    using rep = Rep;
    static constexpr int fraction_bits = FractionBits;

    constexpr fixed() = default;
    /// From an integer; saturates.
    template <std::integral Integer>
    constexpr explicit fixed(Integer value) : raw_(from_integer(static_cast<std::int64_t>(value))) {
        static_assert(sizeof(Integer) < 8 || std::is_signed_v<Integer>,
                      "physics::fixed: converts from integers that fit in std::int64_t");
    }
    /// From a floating-point number, to nearest; saturates, and takes NaN as 0 (both counted by the audit).
    template <std::floating_point Real>
    constexpr explicit fixed(Real value) : raw_(from_double(static_cast<double>(value))) {}
    /// From another format, to nearest; saturates.
    template <class OtherRep, int OtherBits>
    constexpr explicit fixed(fixed<OtherRep, OtherBits> other) : raw_(from_fixed(other.raw(), OtherBits)) {}

    static constexpr fixed from_raw(Rep raw) {
        fixed result;
        result.raw_ = raw;
        return result;
    }
    [[nodiscard]] constexpr Rep raw() const { return raw_; }

    constexpr explicit operator double() const { return static_cast<double>(raw_) * unit; }
    constexpr explicit operator float() const { return static_cast<float>(raw_) * static_cast<float>(unit); }
    /// The integer part, towards zero; saturates.
    constexpr explicit operator int() const {
        const Rep whole = raw_ / (Rep{1} << FractionBits);
        return detail::fits<int>(std::int64_t{whole}) ? static_cast<int>(whole) : detail::saturated<int>(raw_ < 0);
    }

    constexpr fixed& operator+=(fixed other) { return *this = add(raw_, other.raw_); }
    constexpr fixed& operator-=(fixed other) { return *this = subtract(raw_, other.raw_); }
    PHYSICS_HPP_ALWAYS_INLINE constexpr fixed& operator*=(fixed other) {
        return *this = from_raw(detail::shift_wrapped<Rep, FractionBits>(raw_product(raw_, other.raw_)));
    }
    constexpr fixed& operator/=(fixed other) {
        return *this = from_raw(detail::scaled_quotient<Rep>((raw_ < 0) != (other.raw_ < 0), detail::magnitude64(raw_),
                                                             FractionBits, detail::magnitude64(other.raw_)));
    }

private:
    using limits = std::numeric_limits<Rep>;
    using unsigned_rep = std::make_unsigned_t<Rep>;
    static constexpr double unit = 1.0 / static_cast<double>(std::int64_t{1} << FractionBits);

    static constexpr detail::int128 raw_product(std::int64_t a, std::int64_t b) { return detail::product128(a, b); }
    static constexpr std::int64_t raw_product(std::int32_t a, std::int32_t b) { return std::int64_t{a} * b; }

    static constexpr fixed add(Rep a, Rep b) {
        const Rep sum = static_cast<Rep>(static_cast<unsigned_rep>(a) + static_cast<unsigned_rep>(b));
        detail::note_overflow((a < 0) == (b < 0) && (sum < 0) != (a < 0));
        return from_raw(sum);
    }
    static constexpr fixed subtract(Rep a, Rep b) {
        const Rep difference = static_cast<Rep>(static_cast<unsigned_rep>(a) - static_cast<unsigned_rep>(b));
        detail::note_overflow((a < 0) != (b < 0) && (difference < 0) != (a < 0));
        return from_raw(difference);
    }
    static constexpr Rep from_integer(std::int64_t value) {
        const std::int64_t maximum = static_cast<std::int64_t>(limits::max() >> FractionBits);
        if (value > maximum || value < -maximum - 1) return detail::saturated<Rep>(value < 0);
        return static_cast<Rep>(value * (std::int64_t{1} << FractionBits));
    }
    static constexpr Rep from_double(double value) {
        constexpr double end = -static_cast<double>(limits::min());
        const double scaled = value * static_cast<double>(std::int64_t{1} << FractionBits);
        // Next to the ends of a 64-bit representation doubles are whole, so there is no half to round.
        const bool inside =
            sizeof(Rep) == 4 ? scaled > -end - 0.5 && scaled < end - 0.5 : scaled >= -end && scaled < end;
        if (!inside) return value != value ? (detail::note_overflow(true), Rep{0}) : detail::saturated<Rep>(value < 0);
        const std::int64_t whole = static_cast<std::int64_t>(scaled);
        const double rest = scaled - static_cast<double>(whole);
        return static_cast<Rep>(whole + (rest >= 0.5 ? 1 : 0) - (rest <= -0.5 ? 1 : 0));
    }
    static constexpr Rep from_fixed(std::int64_t raw, int bits) {
        if (bits >= FractionBits) {
            const std::int64_t rounded =
                bits == FractionBits ? raw : detail::shift_nearest(detail::int128(raw), bits - FractionBits).low();
            return detail::fits<Rep>(rounded) ? static_cast<Rep>(rounded) : detail::saturated<Rep>(raw < 0);
        }
        return detail::signed_saturating<Rep>(raw < 0, detail::magnitude128(raw) << (FractionBits - bits));
    }

    Rep raw_ = 0;
};

// Operators stand outside of their classes, here and wherever they compute: gcc takes friends that are defined within
// a class template out of the determinism region, and then neither keeps products apart in them nor inlines into them.
template <class Rep, int F>
constexpr fixed<Rep, F> operator+(fixed<Rep, F> a, fixed<Rep, F> b) { return a += b; }
template <class Rep, int F>
constexpr fixed<Rep, F> operator-(fixed<Rep, F> a, fixed<Rep, F> b) { return a -= b; }
template <class Rep, int F>
PHYSICS_HPP_ALWAYS_INLINE constexpr fixed<Rep, F> operator*(fixed<Rep, F> a, fixed<Rep, F> b) { return a *= b; }
template <class Rep, int F>
constexpr fixed<Rep, F> operator/(fixed<Rep, F> a, fixed<Rep, F> b) { return a /= b; }
template <class Rep, int F>
constexpr fixed<Rep, F> operator-(fixed<Rep, F> a) { return fixed<Rep, F>() -= a; }
template <class Rep, int F>
constexpr fixed<Rep, F> operator+(fixed<Rep, F> a) { return a; }
template <class Rep, int F>
constexpr bool operator==(fixed<Rep, F> a, fixed<Rep, F> b) { return a.raw() == b.raw(); }
template <class Rep, int F>
constexpr bool operator!=(fixed<Rep, F> a, fixed<Rep, F> b) { return a.raw() != b.raw(); }
template <class Rep, int F>
constexpr bool operator<(fixed<Rep, F> a, fixed<Rep, F> b) { return a.raw() < b.raw(); }
template <class Rep, int F>
constexpr bool operator>(fixed<Rep, F> a, fixed<Rep, F> b) { return a.raw() > b.raw(); }
template <class Rep, int F>
constexpr bool operator<=(fixed<Rep, F> a, fixed<Rep, F> b) { return a.raw() <= b.raw(); }
template <class Rep, int F>
constexpr bool operator>=(fixed<Rep, F> a, fixed<Rep, F> b) { return a.raw() >= b.raw(); }

/// Q32.32, the default fixed point: range +-2.1e9, step 2.3e-10.
using fixed32 = fixed<std::int64_t, 32>;
/// Q48.16, for huge worlds: range +-1.4e14, step 1.5e-5.
using fixed48 = fixed<std::int64_t, 16>;
/// Q16.16, for particles and toys: range +-32,768, step 1.5e-5. A contact solver's impulses leave its range
/// in all but small scenes.
using fixed16 = fixed<std::int32_t, 16>;

template <class A, int FA, class B, int FB>
constexpr auto product(fixed<A, FA> a, fixed<B, FB> b) {
    using integer = detail::product_integer<A, B>;
    if constexpr (std::is_same_v<integer, std::int64_t>) {
        return wide_fixed<integer, FA + FB>{std::int64_t{a.raw()} * b.raw()};
    } else {
        return wide_fixed<integer, FA + FB>{detail::product128(std::int64_t{a.raw()}, std::int64_t{b.raw()})};
    }
}

namespace detail {
template <class Rep, int FractionBits>
constexpr std::int64_t raw_of(fixed<Rep, FractionBits> a) {
    return a.raw();
}
template <class Int, int FractionBits>
constexpr Int raw_of(wide_fixed<Int, FractionBits> a) {
    return a.raw;
}
}  // namespace detail

/// The wide number in format R, to nearest; wraps.
template <class R, class Int, int FractionBits>
PHYSICS_HPP_ALWAYS_INLINE constexpr R narrow(wide_fixed<Int, FractionBits> a) {
    constexpr int shift = FractionBits - R::fraction_bits;
    static_assert(shift > 0, "physics::narrow: the result must have fewer fraction bits than the product");
    return R::from_raw(detail::shift_wrapped<typename R::rep, shift>(a.raw));
}

/// numerator / denominator in format R, to nearest; saturates. Operands are fixed or wide.
template <class R, template <class, int> class N, class RepN, int FN, template <class, int> class D, class RepD, int FD>
constexpr R quotient(N<RepN, FN> numerator, D<RepD, FD> denominator) {
    const auto n = detail::raw_of(numerator);
    const auto d = detail::raw_of(denominator);
    const bool negative = (n < decltype(n)(std::int64_t{0})) != (d < decltype(d)(std::int64_t{0}));
    return R::from_raw(detail::scaled_quotient<typename R::rep>(negative, detail::magnitude128(n),
                                                                R::fraction_bits + FD - FN, detail::magnitude128(d)));
}

/// The square root of a wide number in format R, to nearest; 0 for negative numbers (counted by the audit).
template <class R, class Int, int FractionBits>
constexpr R root(wide_fixed<Int, FractionBits> a) {
    constexpr int shift = 2 * R::fraction_bits - FractionBits;
    static_assert(shift <= 0 && shift % 2 == 0,
                  "physics::root: the operand must have at least twice the result's fraction bits");
    if (a < wide_fixed<Int, FractionBits>{}) return detail::note_overflow(true), R{};
    const detail::integer_root found = detail::root_of(detail::magnitude128(a.raw));
    if constexpr (shift == 0)
        return R::from_raw(detail::signed_saturating<typename R::rep>(false, found.nearest()));
    else
        return R::from_raw(
            detail::signed_saturating<typename R::rep>(false, ((found.root >> (-shift / 2 - 1)) + 1) >> 1));
}

namespace detail {
/// root<R>(a) > limit, without the root.
template <class R, class Int, int FractionBits>
constexpr bool is_root_greater(wide_fixed<Int, FractionBits> a, R limit) {
    static_assert(FractionBits == 2 * R::fraction_bits);
    // Roots saturate, and are never ties: one rounds to more than limit where its square is above limit^2 + limit.
    if (limit < R{} || limit.raw() == std::numeric_limits<typename R::rep>::max()) return limit < R{};
    return a > wide_fixed<Int, FractionBits>{product(limit, limit).raw + Int(std::int64_t{limit.raw()})};
}
}  // namespace detail

inline std::uint64_t overflow_count() noexcept {
#ifdef PHYSICS_HPP_AUDIT
    return detail::overflow_counter;
#else
    return 0;
#endif
}
inline void reset_overflow_count() noexcept {
#ifdef PHYSICS_HPP_AUDIT
    detail::overflow_counter = 0;
#endif
}

PHYSICS_HPP_END
