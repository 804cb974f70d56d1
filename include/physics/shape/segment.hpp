// The segment: a line between two points, thick or not.
#pragma once

#include "physics/shape/concept.hpp"
#include "physics/shape/solid_moments.hpp"

PHYSICS_HPP_BEGIN

/// All points within radius (m, 0 or more) of the line from a to b (m) in the shape's frame: a capsule anywhere, or
/// with radius 0 an edge of a level, which has no mass. a and b must differ.
template <class S, int D>
struct segment {
    using scalar = S;
    vec<S, D> a = at_x(S(-0.5));
    vec<S, D> b = at_x(S(0.5));
    S radius{};

    template <class T>
    [[nodiscard]] constexpr segment<T, D> as() const {
        segment<T, D> result;
        for (int i = 0; i < D; ++i) {
            result.a[i] = static_cast<T>(a[i]);
            result.b[i] = static_cast<T>(b[i]);
        }
        result.radius = static_cast<T>(radius);
        return result;
    }

private:
    static constexpr vec<S, D> at_x(S x) {
        vec<S, D> v;
        v.x = x;
        return v;
    }
};

template <class S, int D>
bool check(const segment<S, D>& s, const char* function) {
    if (!detail::check_finite(function, "a", s.a) || !detail::check_finite(function, "b", s.b) ||
        !detail::check_not_negative(function, "radius", s.radius))
        return false;
    return !(s.a == s.b) || detail::refuse(function, "length", 0.0, "the ends must differ; a point is a ball");
}
template <class S, int D>
constexpr aabb<S, D> bounds(const segment<S, D>& s, const transform<S, D>& at) {
    const vec<S, D> a = at.rotation * s.a, b = at.rotation * s.b;
    const aabb<S, D> box = grown(aabb<S, D>{min(a, b), max(a, b)}, s.radius);
    return {at.position + box.lower, at.position + box.upper};
}
template <class S, int D>
constexpr vec<S, D> support(const segment<S, D>& s, vec<S, D> direction) {
    const vec<S, D> end = wide_dot(direction, s.b) > wide_dot(direction, s.a) ? s.b : s.a;
    return s.radius > S(0) ? end + normalized(direction) * s.radius : end;
}
/// Exact; calculated in double. A rectangle or cylinder and two half balls; none where radius is 0.
template <class S, int D>
mass_properties<S, D> mass_of(const segment<S, D>& s, std::type_identity_t<S> density) {
    const vec<double, 3> a = detail::exact_in_space(s.a), b = detail::exact_in_space(s.b);
    const auto [u, whole] = direction_and_length_of(b - a);
    const double l = 0.5 * whole, r = static_cast<double>(s.radius), rr = r * r;
    // Sizes of middle and ends, and the means of squares along and across.
    const double middle = D == 2 ? 4 * l * r : 2 * pi<double> * rr * l;
    const double ends = D == 2 ? pi<double> * rr : pi<double> * (4.0 / 3) * rr * r;
    const double outwards = D == 2 ? r * (4.0 / 3) / pi<double> : r * (3.0 / 8);
    const double along = middle * (l * l / 3) + ends * (l * l + 2 * l * outwards + rr / (D + 2));
    const double across = middle * (rr / (D == 2 ? 3 : 4)) + ends * (rr / (D + 2));
    const symmetric<double> space = symmetric<double>::diagonal(1, 1, D == 2 ? 0 : 1);
    detail::solid_moments m;
    m.add(middle + ends, {}, {}, space * across + detail::square_of(u) * (along - across));
    return m.template mass<S, D>(a + (b - a) * 0.5, density);
}

PHYSICS_HPP_END
