// Fixed-point numbers with exact wide products: integers only, hence the same bits by construction.
#pragma once

#include <concepts>
#include <limits>
#include <type_traits>

#include "physics/base/root.hpp"
#include "physics/base/wide_fixed.hpp"

PHYSICS_HPP_BEGIN

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
constexpr fixed<Rep, F> operator+(fixed<Rep, F> a, fixed<Rep, F> b) {
    return a += b;
}
template <class Rep, int F>
constexpr fixed<Rep, F> operator-(fixed<Rep, F> a, fixed<Rep, F> b) {
    return a -= b;
}
template <class Rep, int F>
PHYSICS_HPP_ALWAYS_INLINE constexpr fixed<Rep, F> operator*(fixed<Rep, F> a, fixed<Rep, F> b) {
    return a *= b;
}
template <class Rep, int F>
constexpr fixed<Rep, F> operator/(fixed<Rep, F> a, fixed<Rep, F> b) {
    return a /= b;
}
template <class Rep, int F>
constexpr fixed<Rep, F> operator-(fixed<Rep, F> a) {
    return fixed<Rep, F>() -= a;
}
template <class Rep, int F>
constexpr fixed<Rep, F> operator+(fixed<Rep, F> a) {
    return a;
}
template <class Rep, int F>
constexpr bool operator==(fixed<Rep, F> a, fixed<Rep, F> b) {
    return a.raw() == b.raw();
}
template <class Rep, int F>
constexpr bool operator!=(fixed<Rep, F> a, fixed<Rep, F> b) {
    return a.raw() != b.raw();
}
template <class Rep, int F>
constexpr bool operator<(fixed<Rep, F> a, fixed<Rep, F> b) {
    return a.raw() < b.raw();
}
template <class Rep, int F>
constexpr bool operator>(fixed<Rep, F> a, fixed<Rep, F> b) {
    return a.raw() > b.raw();
}
template <class Rep, int F>
constexpr bool operator<=(fixed<Rep, F> a, fixed<Rep, F> b) {
    return a.raw() <= b.raw();
}
template <class Rep, int F>
constexpr bool operator>=(fixed<Rep, F> a, fixed<Rep, F> b) {
    return a.raw() >= b.raw();
}

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
    if constexpr (shift == 0) return R::from_raw(detail::signed_saturating<typename R::rep>(false, found.nearest()));
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
