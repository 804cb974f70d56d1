// Checks of the user's numbers: each refuses a bad one by name and value, and says whether it was good.
#pragma once

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
    return check_each(function, field, value, [](auto x) { return is_finite(x); }, "it must be finite");
}
template <class T>
bool check_left_out(const char* function, const char* field, T value) {
    return check_each(function, field, value, [](auto x) { return x == decltype(x){}; }, "the recipe leaves it out");
}
template <class S>
bool check_positive(const char* function, const char* field, S value) {
    return check_finite(function, field, value) &&
           (value > S(0) || refuse(function, field, static_cast<double>(value), "it must be greater than 0"));
}
template <class S>
bool check_not_negative(const char* function, const char* field, S value) {
    return check_finite(function, field, value) &&
           (!(value < S(0)) || refuse(function, field, static_cast<double>(value), "it must not be negative"));
}

}  // namespace detail

PHYSICS_HPP_END
