// The ball: a circle in 2D, a sphere in 3D.
#pragma once

#include "physics/shape/concept.hpp"

PHYSICS_HPP_BEGIN

/// All points within radius (m) of the centre, which is the origin of the shape's frame.
template <class S, int D>
struct ball {
    using scalar = S;
    S radius = S(0.5);

    /// The same shape with another scalar.
    template <class T>
    [[nodiscard]] constexpr ball<T, D> as() const {
        return {static_cast<T>(radius)};
    }
};
/// A ball, by its name in 2D.
template <class S, int D = 2>
using circle = ball<S, D>;
/// A ball, by its name in 3D.
template <class S, int D = 3>
using sphere = ball<S, D>;

template <class S, int D>
bool check(const ball<S, D>& b, const char* function) {
    return detail::check_positive(function, "radius", b.radius);
}
template <class S, int D>
constexpr aabb<S, D> bounds(const ball<S, D>& b, const transform<S, D>& at) {
    return grown(aabb<S, D>{at.position, at.position}, b.radius);
}
template <class S, int D>
constexpr vec<S, D> support(const ball<S, D>& b, vec<S, D> direction) {
    return normalized(direction) * b.radius;
}
template <class S>
constexpr mass_properties<S, 2> mass_of(const ball<S, 2>& b, S density) {
    const S rr = b.radius * b.radius;
    const S mass = density * pi<S> * rr;
    return {mass, {}, mass * (rr * S(0.5))};
}
template <class S>
constexpr mass_properties<S, 3> mass_of(const ball<S, 3>& b, S density) {
    const S rr = b.radius * b.radius;
    const S mass = density * (S(4) * pi<S> / S(3)) * rr * b.radius;
    const S i = mass * (rr * S(0.4));
    return {mass, {}, symmetric<S>::diagonal(i, i, i)};
}

PHYSICS_HPP_END
