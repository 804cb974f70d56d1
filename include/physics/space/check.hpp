// Checks of the user's numbers: each refuses a bad one by name and value, and says whether it was good.
#pragma once

#include <cstdint>

#include "physics/base/error.hpp"
#include "physics/space/vec.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Refuses a number, or the first component of a vector, for which good(x) is false.
template <class S, class Good>
bool check_each(const char* function, const char* field, S value, Good good, const char* rule) {
    return good(value) || refuse(function, field, static_cast<double>(value), rule);
}
template <class S, int D, class Good>
bool check_each(const char* function, const char* field, vec<S, D> value, Good good, const char* rule) {
    for (int i = 0; i < D; ++i) {
        if (good(value[i])) continue;
        const char component[] = {'.', "xyz"[i], '\0'};
        return refuse(function, field, component, static_cast<double>(value[i]), rule);
    }
    return true;
}
template <class T>
bool check_finite(const char* function, const char* field, T value) {
    return check_each(
        function, field, value, [](auto x) { return is_finite(x); }, "it must be finite");
}
/// The largest number that worlds compute with in double: where shapes meet, up to four lengths are multiplied.
inline constexpr double largest_of_double = 1e75;
/// Whether a world computes with such a quantity: a finite number, in double one that is not too large.
template <scalar_type S>
constexpr bool is_bounded(S x) {
    if constexpr (is_fixed<S>) return true;
    else return static_cast<double>(x) <= largest_of_double && static_cast<double>(x) >= -largest_of_double;
}
/// Whether a quantity may be part of a world's state: the same; of fixed-point ones, which wrap, within half of their
/// range, so that the sum of two shows whether it is.
template <scalar_type S>
constexpr bool is_in_range(S x) {
    if constexpr (is_fixed<S>) {
        const S maximum = scalar_traits<S>::max() / S(2);
        return x <= maximum && x >= -maximum;
    } else {
        return is_bounded(x);
    }
}
template <class S, int D>
constexpr bool is_in_range(const vec<S, D>& v) {
    for (int i = 0; i < D; ++i)
        if (!is_in_range(v[i])) return false;
    return true;
}
template <class T>
bool check_bounded(const char* function, const char* field, T value) {
    return check_finite(function, field, value) &&
           check_each(
               function, field, value, [](auto x) { return is_bounded(x); }, "its size must not be above 1e75");
}
template <class T>
bool check_in_range(const char* function, const char* field, T value) {
    return check_bounded(function, field, value) && check_each(
                                                        function, field, value, [](auto x) { return is_in_range(x); },
                                                        "it must be within half of the scalar's range");
}
template <class T>
bool check_left_out(const char* function, const char* field, T value) {
    return check_each(
        function, field, value, [](auto x) { return x == decltype(x){}; }, "the recipe leaves it out");
}
template <class S>
bool check_positive(const char* function, const char* field, S value) {
    return check_finite(function, field, value) &&
           (value > S(0) || refuse(function, field, static_cast<double>(value), "it must be greater than 0"));
}
/// An array of the caller's.
inline bool check_array(const char* function, const char* field, const void* first, std::uint64_t count) {
    return first != nullptr || count == 0 ||
           refuse(function, field, "null", "it must point to as many values as are counted");
}
/// A number of rounds: more than the limit is a mistake, and would look like a step that hangs.
inline bool check_count(const char* function, const char* field, int count) {
    constexpr int maximum = 65536;
    return (count >= 1 && count <= maximum) ||
           refuse(function, field, count, count < 1 ? "it must be at least 1" : "it must be at most 65536");
}
/// A limit of work.
inline bool check_limit(const char* function, const char* field, int limit) {
    return limit >= 0 || refuse(function, field, limit, "it must not be negative");
}
template <class S>
bool check_not_negative(const char* function, const char* field, S value) {
    return check_finite(function, field, value) &&
           (!(value < S(0)) || refuse(function, field, static_cast<double>(value), "it must not be negative"));
}
template <class S, int D>
bool check_axis(const char* function, const char* field, const vec<S, D>& axis) {
    return check_finite(function, field, axis) &&
           (largest(axis) > S(0) || refuse(function, field, 0.0, "it must have a length"));
}

}  // namespace detail

PHYSICS_HPP_END
