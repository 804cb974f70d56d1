// 128-bit integers: the portable twin, fast division and fast roots against slow ones that are obviously right.
#include "physics/base/root.hpp"

#include <doctest/doctest.h>

#include "integer.hpp"

namespace {

using namespace physics::detail;
using portable = portable_uint128;

portable portable_word(exact::words& source) {
    const std::uint64_t high = source.next(), low = source.next();
    return source.next() & 1 ? portable(high, low) : portable(low);
}

/// Schoolbook division, one bit a round.
portable slow_divide(portable a, portable b, portable& rest) {
    portable quotient;
    rest = {};
    for (int i = 127; i >= 0; --i) {
        rest = (rest << 1) | portable((a >> i).low & 1);
        quotient = quotient << 1;
        if (rest >= b) {
            rest = rest - b;
            quotient.low |= 1;
        }
    }
    return quotient;
}

#ifdef __SIZEOF_INT128__
__extension__ typedef unsigned __int128 native;
native to_native(portable a) { return (static_cast<native>(a.high) << 64) | a.low; }
portable to_portable(native a) { return {static_cast<std::uint64_t>(a >> 64), static_cast<std::uint64_t>(a)}; }
#endif

}  // namespace

TEST_CASE("portable division is schoolbook division") {
    exact::words source(1);
    long wrong = 0;
    for (int i = 0; i < 100000; ++i) {
        const portable b = portable_word(source);
        if (b == portable(0)) continue;
        // Dividends next to multiples of the divisor are where a guessed digit is one off.
        portable a = portable_word(source), rest, slow_rest;
        const std::uint64_t choice = source.next();
        if (choice & 1) {
            a = portable_product(b.low, source.next());
            a.high += b.high * (choice >> 1);
            if (choice & 2) a = a - portable(1);
        }
        wrong += portable_divide(a, b, rest) != slow_divide(a, b, slow_rest);
        wrong += rest != slow_rest;
    }
    CHECK(wrong == 0);
}

TEST_CASE("128 by 64 bits: quotient and remainder satisfy a == q d + r, r < d") {
    exact::words source(2);
    long wrong = 0, seen = 0;
    for (int i = 0; i < 2000000; ++i) {
        std::uint64_t d = source.next(), high = source.next(), rest = 0, other = 0;
        const std::uint64_t low = source.next();
        if (d == 0) continue;
        if (high >= d) high = source.next() & 1 ? d - 1 : high % d;
        ++seen;
        const std::uint64_t q = portable_divide(high, low, d, rest);
        wrong += portable_product(q, d) + portable(rest) != portable(high, low) || rest >= d;
        wrong += divide128(high, low, d, other) != q || other != rest;
    }
    CHECK(seen > 1000000);
    CHECK(wrong == 0);
}

TEST_CASE("128 by 128 bits: quotient and remainder satisfy a == q b + r, r < b") {
    exact::words source(3);
    long wrong = 0;
    for (int i = 0; i < 1000000; ++i) {
        const portable a = portable_word(source), b = portable_word(source);
        if (b == portable(0)) continue;
        portable rest;
        const portable q = portable_divide(a, b, rest);
        portable back = portable_product(q.low, b.low);
        back.high += q.low * b.high + q.high * b.low;
        wrong += back + rest != a || rest >= b || (q.high != 0 && b.high != 0);
    }
    CHECK(wrong == 0);
}

#ifdef __SIZEOF_INT128__
TEST_CASE("the portable twin computes what the compiler's 128-bit integers do") {
    exact::words source(4);
    long wrong = 0;
    for (int i = 0; i < 1000000; ++i) {
        const portable a = portable_word(source), b = portable_word(source);
        const native x = to_native(a), y = to_native(b);
        const int n = static_cast<int>(source.next() & 127);
        wrong += to_portable(x + y) != a + b || to_portable(x - y) != a - b || to_portable(-x) != -a;
        wrong += to_portable(x << n) != a << n || to_portable(x >> n) != a >> n || to_portable(x | y) != (a | b);
        wrong += (x < y) != (a < b) || (x == y) != (a == b) || (x >= y) != (a >= b);
        wrong += to_portable(static_cast<native>(a.low) * b.low) != portable_product(a.low, b.low);
        wrong += bit_width(a) < 128 && (a >> bit_width(a)) != portable(0);
        wrong += bit_width(a) > 0 && (a >> (bit_width(a) - 1)) != portable(1);
        if (b == portable(0)) continue;
        portable rest;
        wrong += portable_divide(a, b, rest) != to_portable(x / y) || rest != to_portable(x % y);
    }
    CHECK(wrong == 0);
}
#endif

// The same laws for the representation that the library uses and for the portable one.
TEST_CASE_TEMPLATE("signed 128-bit integers against exact ones", Int, int128, basic_int128<portable>) {
    using Unsigned = decltype(Int::bits);
    using exact::integer;
    const auto value = [](Int a) {
        const auto word = [&](int shift) {
            return integer::unsigned_word(static_cast<std::uint64_t>(a.bits >> shift));
        };
        return ((word(64) << 64) + word(0)).wrapped(128);
    };
    exact::words source(5);
    const auto next = [&] {
        const std::uint64_t high = source.next(), low = source.next();
        const Int all((Unsigned(high) << 64) | Unsigned(low));
        return source.next() & 1 ? all : Int(static_cast<std::int64_t>(low));
    };
    long wrong = 0;
    for (int i = 0; i < 100000; ++i) {
        const Int a = next(), b = next();
        const integer x = value(a), y = value(b);
        wrong += !(value(a + b) == (x + y).wrapped(128)) || !(value(a - b) == (x - y).wrapped(128));
        wrong += !(value(-a) == (-x).wrapped(128)) || (a < b) != (x < y) || (a > b) != (x > y) || (a == b) != (x == y);
        wrong += a.negative() != (x < integer(0));
        const int n = 1 + static_cast<int>(source.next() % 126);
        // Rounds towards minus infinity: twice the shifted number and one bit less is the number again.
        const Int down = a >> n;
        wrong += value(down << n) > x || !(x < value(down << n) + (integer(1) << n));
        // Half of the step has to fit on top of the number.
        const Int tame = a >> 1;
        const Int nearest = shift_nearest(tame, n);
        wrong += !(value(nearest) == integer::nearest(value(tame), integer(1) << n));
        wrong += !(shift_nearest(-tame, n) == -nearest);
        if (n < 64) wrong += low_of_shift_nearest(tame, n) != nearest.low();
    }
    CHECK(wrong == 0);
}

TEST_CASE("signed products are exact") {
    using exact::integer;
    exact::words source(6);
    long wrong = 0;
    for (int i = 0; i < 200000; ++i) {
        const auto a = source.signed_word<std::int64_t>(), b = source.signed_word<std::int64_t>();
        wrong += !(integer::of(product128(a, b)) == integer(a) * integer(b));
    }
    CHECK(wrong == 0);
}

TEST_CASE("rounding shifts of 64-bit integers are to nearest, ties away from zero") {
    using exact::integer;
    exact::words source(7);
    long wrong = 0;
    for (int i = 0; i < 200000; ++i) {
        const std::int64_t a = source.signed_word<std::int64_t>() / 2;
        const int n = 1 + static_cast<int>(source.next() % 62);
        wrong += !(integer(shift_nearest(a, n)) == integer::nearest(integer(a), integer(1) << n));
        wrong += shift_nearest(-a, n) != -shift_nearest(a, n);
    }
    CHECK(wrong == 0);
}

TEST_CASE("fast roots are the digit-by-digit roots") {
    exact::words source(8);
    long wrong = 0;
    const auto look = [&](uint128 a) {
        if (bit_width(a) > 125) return;
        const integer_root fast = root_by_double(a), slow = root_by_digits(a);
        wrong += fast.root != slow.root || fast.rest != slow.rest;
        wrong += product128(fast.root, fast.root) + fast.rest != a || fast.rest > uint128(fast.root) << 1;
    };
    const uint128 one(std::uint64_t{1});
    for (int i = 0; i < 60000; ++i) {
        const std::uint64_t high = source.next(), low = source.next();
        look((uint128(high) << 64) | uint128(low));
        look(uint128(low));
        // Squares, half-way points and their neighbours.
        const std::uint64_t root = source.next() >> 2;
        const uint128 square = product128(root, root);
        look(square);
        look(square + one);
        look(square + uint128(root));
        look(square + uint128(root) + one);
        if (root != 0) look(square - one);
    }
    CHECK(wrong == 0);
    CHECK(root_of(uint128(std::uint64_t{2})).nearest() == 1);
    CHECK(root_of(uint128(std::uint64_t{3})).nearest() == 2);
    CHECK(root_of(~uint128(std::uint64_t{0})).root == ~std::uint64_t{0});
}

// Constant expressions take the same paths, roots aside.
static_assert(portable_product(~std::uint64_t{0}, ~std::uint64_t{0}) == portable(~std::uint64_t{1}, 1));
static_assert(root_of(product128(std::uint64_t{12345678901234567u}, std::uint64_t{12345678901234567u})).root ==
              12345678901234567u);
static_assert([] {
    portable rest;
    return portable_divide(portable(7, 5), portable(3, 1), rest) == portable(2) && rest == portable(1, 3);
}());
