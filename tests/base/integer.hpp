// Integers without a limit, by GMP: the oracle of fixed point, and a source of awkward words.
#pragma once

#include <gmp.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <random>

#include "physics/base/fixed.hpp"

namespace exact {

class integer {
public:
    integer() { mpz_init(value_); }
    integer(std::int64_t value) : integer() {
        const std::uint64_t size =
            value < 0 ? 0 - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
        mpz_import(value_, 1, 1, sizeof size, 0, 0, &size);
        if (value < 0) mpz_neg(value_, value_);
    }
    /// Not a constructor from uint64_t: literals would be ambiguous.
    static integer unsigned_word(std::uint64_t word) {
        integer result;
        mpz_import(result.value_, 1, 1, sizeof word, 0, 0, &word);
        return result;
    }
    static integer of(physics::detail::uint128 a) {
        return (unsigned_word(physics::detail::high_half(a)) << 64) + unsigned_word(physics::detail::low_half(a));
    }
    static integer of(physics::detail::int128 a) { return a.negative() ? -of(a.magnitude()) : of(a.bits); }
    static integer of(std::int64_t a) { return integer(a); }
    integer(const integer& other) : integer() { mpz_set(value_, other.value_); }
    integer& operator=(const integer& other) {
        mpz_set(value_, other.value_);
        return *this;
    }
    ~integer() { mpz_clear(value_); }

    friend integer operator+(const integer& a, const integer& b) { return call(mpz_add, a, b); }
    friend integer operator-(const integer& a, const integer& b) { return call(mpz_sub, a, b); }
    friend integer operator*(const integer& a, const integer& b) { return call(mpz_mul, a, b); }
    friend integer operator-(const integer& a) { return integer(0) - a; }
    friend integer operator<<(const integer& a, int n) {
        integer result;
        mpz_mul_2exp(result.value_, a.value_, static_cast<mp_bitcnt_t>(n));
        return result;
    }
    friend bool operator==(const integer& a, const integer& b) { return mpz_cmp(a.value_, b.value_) == 0; }
    friend bool operator<(const integer& a, const integer& b) { return mpz_cmp(a.value_, b.value_) < 0; }
    friend bool operator>(const integer& a, const integer& b) { return b < a; }

    /// n / d to nearest, ties away from zero: floor(2 |n| + |d|, 2 |d|) with the sign.
    static integer nearest(const integer& n, const integer& d) {
        integer top, bottom, result;
        mpz_abs(top.value_, n.value_);
        mpz_abs(bottom.value_, d.value_);
        const integer dividend = (top << 1) + bottom, divisor = bottom << 1;
        mpz_fdiv_q(result.value_, dividend.value_, divisor.value_);
        return (mpz_sgn(n.value_) < 0) != (mpz_sgn(d.value_) < 0) ? -result : result;
    }
    /// sqrt(n / d) to nearest: the largest r with (2 r - 1)^2 d <= 4 n.
    static integer nearest_root(const integer& n, const integer& d) {
        integer quotient, root;
        const integer four = n << 2;
        mpz_fdiv_q(quotient.value_, four.value_, d.value_);
        mpz_sqrt(root.value_, quotient.value_);
        const integer next = root + integer(1);
        mpz_fdiv_q_2exp(root.value_, next.value_, 1);
        return root;
    }
    /// Modulo 2^bits, in two's complement.
    integer wrapped(int bits) const {
        integer result;
        const integer half = integer(1) << (bits - 1), shifted = *this + half;
        mpz_fdiv_r_2exp(result.value_, shifted.value_, static_cast<mp_bitcnt_t>(bits));
        return result - half;
    }

private:
    static integer call(void (*f)(mpz_ptr, mpz_srcptr, mpz_srcptr), const integer& a, const integer& b) {
        integer result;
        f(result.value_, a.value_, b.value_);
        return result;
    }
    mpz_t value_;
};

template <class Rep>
bool fits(const integer& a) {
    using limits = std::numeric_limits<Rep>;
    return !(a < integer(limits::min())) && !(a > integer(limits::max()));
}
template <class Rep>
integer saturated(const integer& a) {
    using limits = std::numeric_limits<Rep>;
    return a < integer(limits::min())   ? integer(limits::min())
           : a > integer(limits::max()) ? integer(limits::max())
                                        : a;
}

/// Words of all lengths, and half of the time runs of equal bits, powers of two and their neighbours: where
/// carries, guesses of a quotient's digits, and roundings go wrong.
class words {
public:
    explicit words(std::uint64_t seed) : engine_(seed) {}
    std::uint64_t next() {
        const std::uint64_t word = engine_(), choice = engine_();
        const int shift = static_cast<int>(choice >> 8 & 63);
        switch (choice & 7) {
            case 0: return std::uint64_t{1} << shift;
            case 1: return (std::uint64_t{1} << shift) - 1;
            case 2: return ~std::uint64_t{0} << shift;
            case 3: return (~std::uint64_t{0} >> shift) ^ (std::uint64_t{1} << (word & 63));
            default: return word >> shift;
        }
    }
    template <class Rep>
    Rep signed_word() {
        const std::uint64_t word = next();
        const std::uint64_t kept = sizeof(Rep) == 4 ? (word >> 32) ^ (word & 0xffffffffu) : word;
        return static_cast<Rep>(engine_() & 1 ? 0 - kept : kept);
    }

private:
    std::mt19937_64 engine_;
};

}  // namespace exact
