// The cone, pointed or cut off: two discs of different radii on an axis and all between them.
#pragma once

#include "physics/shape/frustum.hpp"
#include "physics/shape/placed.hpp"

PHYSICS_HPP_BEGIN

/// All points within rounding (m, 0 or more) of the cone about the x axis of the shape's frame, with the lower radius
/// (m) at -half_length (m) and the upper one at half_length: a frustum, or a pointed cone where one of the radii is 0.
/// The frame's origin is the middle of the axis, not the centre of mass: a pointed cone's lies a quarter of the height
/// from its base. In 3D only: in 2D it is a polygon.
template <class S, int D>
struct cone;

template <class S>
struct cone<S, 3> {
    using scalar = S;
    S half_length = S(0.5);
    S lower_radius = S(0.5);
    S upper_radius{};
    S rounding{};

    /// Along y, as tall as that (m), with the middle of its axis at the origin of the body, and its upper end above.
    [[nodiscard]] static placed_shape<cone, 3> upright(S height, S lower_radius, S upper_radius = S(0)) {
        return {{height * S(0.5), lower_radius, upper_radius}, {}, detail::upwards<S, 3>()};
    }
    /// With its lower end at a point of the body, and its upper one at another.
    [[nodiscard]] static placed_shape<cone, 3> between(const vec<S, 3>& lower, const vec<S, 3>& upper, S lower_radius,
                                                       S upper_radius = S(0)) {
        return detail::placed_between(cone{length(upper - lower) * S(0.5), lower_radius, upper_radius}, lower, upper);
    }

    template <class T>
    [[nodiscard]] constexpr cone<T, 3> as() const {
        return {static_cast<T>(half_length), static_cast<T>(lower_radius), static_cast<T>(upper_radius),
                static_cast<T>(rounding)};
    }
};

namespace detail {
template <class S>
constexpr discs<S> frustum_of(const cone<S, 3>& c) {
    return {c.half_length, c.lower_radius, c.upper_radius, c.rounding};
}
}  // namespace detail

template <class S>
bool check(const cone<S, 3>& c, const char* function) {
    if (!detail::check_positive(function, "half_length", c.half_length) ||
        !detail::check_not_negative(function, "lower_radius", c.lower_radius) ||
        !detail::check_not_negative(function, "upper_radius", c.upper_radius) ||
        !detail::check_not_negative(function, "rounding", c.rounding))
        return false;
    return c.lower_radius > S(0) || c.upper_radius > S(0) ||
           detail::refuse(function, "upper_radius", 0.0, "one of the radii must be greater than 0");
}
template <class S>
constexpr aabb<S, 3> bounds(const cone<S, 3>& c, const transform<S, 3>& at) {
    return detail::bounds_of(detail::frustum_of(c), at);
}
template <class S>
constexpr vec<S, 3> support(const cone<S, 3>& c, vec<S, 3> direction) {
    return detail::support_of(detail::frustum_of(c), direction);
}
/// Exact, rounding included; calculated in double.
template <class S>
mass_properties<S, 3> mass_of(const cone<S, 3>& c, std::type_identity_t<S> density) {
    return detail::mass_of_discs(detail::frustum_of(c), density);
}

PHYSICS_HPP_END
