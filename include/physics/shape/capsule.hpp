// The capsule: all points near a segment.
#pragma once

#include "physics/shape/concept.hpp"
#include "physics/shape/placed.hpp"

PHYSICS_HPP_BEGIN

/// All points within radius (m) of the segment from (-half_length, 0) to (half_length, 0) on the x axis of
/// the shape's frame.
template <class S, int D>
struct capsule {
    using scalar = S;
    S half_length = S(0.5);
    S radius = S(0.25);

    /// Along y, as tall as that from end to end (m; more than two radii), with its middle at the origin of the body.
    [[nodiscard]] static placed_shape<capsule, D> upright(S height, S radius) {
        return {{height * S(0.5) - radius, radius}, {}, detail::upwards<S, D>()};
    }
    /// All points near the segment from a point of the body to another one.
    [[nodiscard]] static placed_shape<capsule, D> between(const vec<S, D>& from, const vec<S, D>& to, S radius) {
        return detail::placed_between(capsule{length(to - from) * S(0.5), radius}, from, to);
    }

    template <class T>
    [[nodiscard]] constexpr capsule<T, D> as() const {
        return {static_cast<T>(half_length), static_cast<T>(radius)};
    }
};

template <class S, int D>
bool check(const capsule<S, D>& c, const char* function) {
    return detail::check_positive(function, "half_length", c.half_length) &&
           detail::check_positive(function, "radius", c.radius);
}
namespace detail {
template <class S, int D>
constexpr vec<S, D> along_x(S x) {
    vec<S, D> v;
    v.x = x;
    return v;
}
}  // namespace detail
template <class S, int D>
constexpr aabb<S, D> bounds(const capsule<S, D>& c, const transform<S, D>& at) {
    const vec<S, D> reach = abs(at.rotation * detail::along_x<S, D>(c.half_length)) + vec<S, D>::filled(c.radius);
    return {at.position - reach, at.position + reach};
}
template <class S, int D>
constexpr vec<S, D> support(const capsule<S, D>& c, vec<S, D> direction) {
    return detail::along_x<S, D>(direction.x < S(0) ? -c.half_length : c.half_length) +
           normalized(direction) * c.radius;
}
/// Rectangle and two half discs, whose centroids lie 4 r / (3 pi) outwards of their flat sides.
template <class S>
constexpr mass_properties<S, 2> mass_of(const capsule<S, 2>& c, S density) {
    const S l = c.half_length, r = c.radius, rr = r * r, ll = l * l;
    const S middle = density * S(4) * l * r;
    const S ends = density * pi<S> * rr;
    const S offset = r * (S(4.0 / 3) / pi<S>);
    return {middle + ends, {}, middle * ((ll + rr) / S(3)) + ends * (rr * S(0.5) + ll + S(2) * l * offset)};
}
/// Cylinder and two half balls, whose centroids lie 3 r / 8 outwards of their flat sides.
template <class S>
constexpr mass_properties<S, 3> mass_of(const capsule<S, 3>& c, S density) {
    const S l = c.half_length, r = c.radius, rr = r * r, ll = l * l;
    const S middle = density * pi<S> * rr * (l + l);
    const S ends = density * (S(4) * pi<S> / S(3)) * rr * r;
    const S along = middle * (rr * S(0.5)) + ends * (rr * S(0.4));
    const S across = middle * (rr * S(0.25) + ll / S(3)) + ends * (rr * S(0.4) + ll + l * r * S(0.75));
    return {middle + ends, {}, symmetric<S>::diagonal(along, across, across)};
}

PHYSICS_HPP_END
