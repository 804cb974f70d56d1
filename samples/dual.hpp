// Dual numbers: a value, and how fast it changes with whatever is asked about. As the scalar of a world they carry
// derivatives through all of a simulation. Source: Griewank, Walther, Evaluating Derivatives (2008), chapter 3.
#pragma once

#include <physics.hpp>

struct dual {
    double value = 0, slope = 0;

    dual() = default;
    explicit dual(int x) : value(x) {}
    explicit dual(double x) : value(x) {}
    dual(double x, double by) : value(x), slope(by) {}
    explicit operator double() const { return value; }

    friend dual operator+(dual a, dual b) { return {a.value + b.value, a.slope + b.slope}; }
    friend dual operator-(dual a, dual b) { return {a.value - b.value, a.slope - b.slope}; }
    friend dual operator-(dual a) { return {-a.value, -a.slope}; }
    friend dual operator*(dual a, dual b) { return {a.value * b.value, a.slope * b.value + a.value * b.slope}; }
    friend dual operator/(dual a, dual b) {
        const double q = a.value / b.value;
        return {q, (a.slope - q * b.slope) / b.value};
    }
    dual& operator+=(dual b) { return *this = *this + b; }
    dual& operator-=(dual b) { return *this = *this - b; }
    dual& operator*=(dual b) { return *this = *this * b; }
    dual& operator/=(dual b) { return *this = *this / b; }
    // Equal are those that change equally too; their order is that of their values.
    friend bool operator==(dual, dual) = default;
    friend bool operator<(dual a, dual b) { return a.value < b.value; }
    friend bool operator>(dual a, dual b) { return a.value > b.value; }
    friend bool operator<=(dual a, dual b) { return a.value <= b.value; }
    friend bool operator>=(dual a, dual b) { return a.value >= b.value; }
};

template <>
struct physics::scalar_traits<dual> {
    using wide = dual;
    using inverse = dual;
    using real = scalar_traits<double>;
    static const char* name() { return "dual"; }
    static dual epsilon() { return dual(real::epsilon()); }
    static dual max() { return dual(real::max()); }
    static bool is_finite(dual x) { return real::is_finite(x.value) && real::is_finite(x.slope); }
    static std::uint64_t bits(dual x) { return real::bits(x.value) ^ real::bits(x.slope) * 0x9e3779b97f4a7c15u; }

    // A function of x with that value and that derivative.
    static dual of(dual x, double value, double derivative) { return {value, derivative * x.slope}; }
    static dual sqrt(dual x) {
        const double root = physics::sqrt(x.value);
        return {root, x.slope == 0 ? 0 : x.slope / (2 * root)};
    }
    static dual floor(dual x) { return dual(physics::floor(x.value)); }
    static dual sin(dual x) { return of(x, physics::sin(x.value), physics::cos(x.value)); }
    static dual cos(dual x) { return of(x, physics::cos(x.value), -physics::sin(x.value)); }
    static dual tan(dual x) {
        const double t = physics::tan(x.value);
        return of(x, t, 1 + t * t);
    }
    static dual exp(dual x) { return of(x, physics::exp(x.value), physics::exp(x.value)); }
    static dual log(dual x) { return of(x, physics::log(x.value), 1 / x.value); }
    static dual acos(dual x) { return of(x, physics::acos(x.value), -1 / physics::sqrt(1 - x.value * x.value)); }
    static dual atan2(dual y, dual x) {
        const double square = x.value * x.value + y.value * y.value;
        const double turned = x.value * y.slope - y.value * x.slope;
        return {physics::atan2(y.value, x.value), turned == 0 ? 0 : turned / square};
    }
};
