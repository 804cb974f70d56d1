// Checks of the user's numbers: each refuses a bad one by name and value, and says whether it was good.
#pragma once

#include "physics/base/error.hpp"
#include "physics/space/vec.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

template <class S>
bool check_finite(const char* function, const char* field, S value) {
    return is_finite(value) || refuse(function, field, static_cast<double>(value), "it must be finite");
}
template <class S, int D>
bool check_finite(const char* function, const char* field, vec<S, D> value) {
    for (int i = 0; i < D; ++i) {
        if (is_finite(value[i])) continue;
        const char component[] = {'.', "xyz"[i], '\0'};
        return refuse(function, field, component, static_cast<double>(value[i]), "it must be finite");
    }
    return true;
}
/// What a recipe leaves out must be 0.
template <class S>
bool check_left_out(const char* function, const char* field, S value) {
    return value == S(0) || refuse(function, field, static_cast<double>(value), "the recipe leaves it out");
}
template <class S, int D>
bool check_left_out(const char* function, const char* field, vec<S, D> value) {
    for (int i = 0; i < D; ++i) {
        if (value[i] == S(0)) continue;
        const char component[] = {'.', "xyz"[i], '\0'};
        return refuse(function, field, component, static_cast<double>(value[i]), "the recipe leaves it out");
    }
    return true;
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
