// A scalar that offers only what the concept scalar_type asks for: what compiles with it needs nothing more.
#pragma once

#include <concepts>
#include <cstdint>
#include <physics.hpp>

/// A double behind explicit constructors: no constexpr, no conversion from or to anything but int and double, no
/// mixed operands, no infinity by name. A stray 0.5 or size_t in an algorithm does not compile.
class archetype {
public:
    archetype() = default;
    explicit archetype(int value) : value_(value) {}
    explicit archetype(double value) : value_(value) {}
    template <class T>
        requires(!std::same_as<T, archetype>)
    archetype(T)
    = delete;

    explicit operator double() const { return value_; }

    friend archetype operator+(archetype a, archetype b) { return archetype(a.value_ + b.value_); }
    friend archetype operator-(archetype a, archetype b) { return archetype(a.value_ - b.value_); }
    friend archetype operator*(archetype a, archetype b) { return archetype(a.value_ * b.value_); }
    friend archetype operator/(archetype a, archetype b) { return archetype(a.value_ / b.value_); }
    friend archetype operator-(archetype a) { return archetype(-a.value_); }
    archetype& operator+=(archetype b) { return *this = *this + b; }
    archetype& operator-=(archetype b) { return *this = *this - b; }
    archetype& operator*=(archetype b) { return *this = *this * b; }
    archetype& operator/=(archetype b) { return *this = *this / b; }
    friend bool operator==(archetype a, archetype b) { return a.value_ == b.value_; }
    friend bool operator!=(archetype a, archetype b) { return a.value_ != b.value_; }
    friend bool operator<(archetype a, archetype b) { return a.value_ < b.value_; }
    friend bool operator>(archetype a, archetype b) { return a.value_ > b.value_; }
    friend bool operator<=(archetype a, archetype b) { return a.value_ <= b.value_; }
    friend bool operator>=(archetype a, archetype b) { return a.value_ >= b.value_; }

private:
    double value_ = 0;
};

/// What a user writes to run the engine on a number type of their own.
template <>
struct physics::scalar_traits<archetype> {
    using wide = archetype;
    using inverse = archetype;
    using real = scalar_traits<double>;
    static const char* name() { return "archetype"; }
    static archetype epsilon() { return archetype(real::epsilon()); }
    static archetype max() { return archetype(real::max()); }
    static bool is_finite(archetype x) { return real::is_finite(double(x)); }
    static std::uint64_t bits(archetype x) { return real::bits(double(x)); }
    static archetype sqrt(archetype x) { return archetype(physics::sqrt(double(x))); }
    static archetype sin(archetype x) { return archetype(physics::sin(double(x))); }
    static archetype cos(archetype x) { return archetype(physics::cos(double(x))); }
    static archetype tan(archetype x) { return archetype(physics::tan(double(x))); }
    static archetype exp(archetype x) { return archetype(physics::exp(double(x))); }
    static archetype log(archetype x) { return archetype(physics::log(double(x))); }
    static archetype acos(archetype x) { return archetype(physics::acos(double(x))); }
    static archetype atan2(archetype y, archetype x) { return archetype(physics::atan2(double(y), double(x))); }
};

static_assert(physics::scalar_type<archetype>);
static_assert(!std::convertible_to<int, archetype> && !std::convertible_to<double, archetype>);
static_assert(!std::constructible_from<archetype, float> && !std::constructible_from<archetype, long>);
static_assert(!std::convertible_to<archetype, double>);
