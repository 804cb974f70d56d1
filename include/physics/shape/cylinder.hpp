// The cylinder: two discs on an axis and all between them.
#pragma once

#include "physics/shape/frustum.hpp"
#include "physics/shape/placed.hpp"

PHYSICS_HPP_BEGIN

/// All points within rounding (m, 0 or more) of the cylinder about the x axis of the shape's frame, from -half_length
/// to half_length (m), with that radius (m). With rounding it reaches beyond both by as much. In 3D only: in 2D it is
/// a box.
template <class S, int D>
struct cylinder;

template <class S>
struct cylinder<S, 3> {
    using scalar = S;
    S half_length = S(0.5);
    S radius = S(0.5);
    S rounding{};

    /// Along y, as tall as that (m), with its middle at the origin of the body.
    [[nodiscard]] static placed_shape<cylinder, 3> upright(S height, S radius) {
        return {{height * S(0.5), radius}, {}, detail::upwards<S, 3>()};
    }
    /// From a point of the body to another one.
    [[nodiscard]] static placed_shape<cylinder, 3> between(const vec<S, 3>& from, const vec<S, 3>& to, S radius) {
        return detail::placed_between(cylinder{length(to - from) * S(0.5), radius}, from, to);
    }

    template <class T>
    [[nodiscard]] constexpr cylinder<T, 3> as() const {
        return {static_cast<T>(half_length), static_cast<T>(radius), static_cast<T>(rounding)};
    }
};

namespace detail {
template <class S>
constexpr discs<S> frustum_of(const cylinder<S, 3>& c) {
    return {c.half_length, c.radius, c.radius, c.rounding};
}
}  // namespace detail

template <class S>
bool check(const cylinder<S, 3>& c, const char* function) {
    return detail::check_positive(function, "half_length", c.half_length) &&
           detail::check_positive(function, "radius", c.radius) &&
           detail::check_not_negative(function, "rounding", c.rounding);
}
template <class S>
constexpr aabb<S, 3> bounds(const cylinder<S, 3>& c, const transform<S, 3>& at) {
    return detail::bounds_of(detail::frustum_of(c), at);
}
template <class S>
constexpr vec<S, 3> support(const cylinder<S, 3>& c, vec<S, 3> direction) {
    return detail::support_of(detail::frustum_of(c), direction);
}
/// Exact, rounding included; calculated in double.
template <class S>
mass_properties<S, 3> mass_of(const cylinder<S, 3>& c, std::type_identity_t<S> density) {
    return detail::mass_of_discs(detail::frustum_of(c), density);
}

PHYSICS_HPP_END
