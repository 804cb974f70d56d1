// The triangle: solid in 2D; in 3D a sheet, thick or not.
#pragma once

#include "physics/shape/concept.hpp"
#include "physics/shape/solid_moments.hpp"

PHYSICS_HPP_BEGIN

/// All points within radius (m, 0 or more) of the triangle with the corners a, b, c (m) in the shape's frame, which may
/// go round either way and must not lie on one line. In 3D it has two sides, and a mass only if radius is not 0.
template <class S, int D>
struct triangle {
    using scalar = S;
    vec<S, D> a = corner(-0.5, -0.5);
    vec<S, D> b = corner(0.5, -0.5);
    vec<S, D> c = corner(0, 0.5);
    S radius{};

    template <class T>
    [[nodiscard]] constexpr triangle<T, D> as() const {
        triangle<T, D> result;
        for (int i = 0; i < D; ++i) {
            result.a[i] = static_cast<T>(a[i]);
            result.b[i] = static_cast<T>(b[i]);
            result.c[i] = static_cast<T>(c[i]);
        }
        result.radius = static_cast<T>(radius);
        return result;
    }

private:
    static constexpr vec<S, D> corner(double x, double y) {
        vec<S, D> v;
        v.x = S(x);
        v.y = S(y);
        return v;
    }
};

namespace detail {

/// The longest edge of a triangle, the height over it, and the largest coordinate.
struct triangle_sizes {
    double longest, height, reach;
};
template <class S, int D>
triangle_sizes sizes_of(const triangle<S, D>& t) {
    const vec<double, 3> corner[3] = {exact_in_space(t.a), exact_in_space(t.b), exact_in_space(t.c)};
    triangle_sizes s{};
    int from = 0;
    for (int i = 0; i < 3; ++i) {
        s.reach = max(s.reach, largest(corner[i]));
        const double l = length(corner[i < 2 ? i + 1 : 0] - corner[i]);
        if (l > s.longest) s.longest = l, from = i;
    }
    // Both ends give the same height, but for rounding: it is less from the nearer one.
    const vec<double, 3>& p = corner[from];
    const vec<double, 3>& q = corner[from < 2 ? from + 1 : 0];
    const vec<double, 3>& top = corner[from > 0 ? from - 1 : 2];
    const vec<double, 3> e = normalized(q - p);
    s.height = min(length(cross(e, top - p)), length(cross(e, top - q)));
    return s;
}

}  // namespace detail

template <class S, int D>
bool check(const triangle<S, D>& t, const char* function) {
    if (!detail::check_finite(function, "a", t.a) || !detail::check_finite(function, "b", t.b) ||
        !detail::check_finite(function, "c", t.c) || !detail::check_not_negative(function, "radius", t.radius))
        return false;
    const detail::triangle_sizes s = detail::sizes_of(t);
    // What rounding of the corners to S may make of three points on a line: 4 spacings.
    const double spacing = static_cast<double>(scalar_traits<S>::epsilon());
    const double minimum = 4 * max(detail::is_fixed<S> ? spacing : spacing * s.reach, 0x1p-52 * s.reach);
    return s.height > minimum ||
           detail::refuse(function, "area", 0.5 * s.longest * s.height, "the corners must not lie on one line");
}
template <class S, int D>
constexpr aabb<S, D> bounds(const triangle<S, D>& t, const transform<S, D>& at) {
    const vec<S, D> a = at.rotation * t.a, b = at.rotation * t.b, c = at.rotation * t.c;
    const aabb<S, D> box = grown(aabb<S, D>{min(a, min(b, c)), max(a, max(b, c))}, t.radius);
    return {at.position + box.lower, at.position + box.upper};
}
/// Of corners at the same distance the first.
template <class S, int D>
constexpr vec<S, D> support(const triangle<S, D>& t, vec<S, D> direction) {
    const wide_of<S> a = wide_dot(direction, t.a), b = wide_dot(direction, t.b), c = wide_dot(direction, t.c);
    const vec<S, D> corner = c > a && c > b ? t.c : b > a ? t.b : t.a;
    return t.radius > S(0) ? corner + normalized(direction) * t.radius : corner;
}
/// Exact; calculated in double. In 2D the triangle, a strip along each edge and a sector at each corner; in 3D a slab,
/// half a cylinder along each edge and a wedge of a ball at each corner: none where radius is 0.
template <class S, int D>
mass_properties<S, D> mass_of(const triangle<S, D>& t, std::type_identity_t<S> density) {
    using detail::square_of;
    const vec<double, 3> first = detail::exact_in_space(t.a), origin = first + (detail::exact_in_space(t.b) - first +
                                                                                (detail::exact_in_space(t.c) - first)) *
                                                                                   (1.0 / 3);
    vec<double, 3> corner[3] = {first - origin, detail::exact_in_space(t.b) - origin,
                                detail::exact_in_space(t.c) - origin};
    vec<double, 3> n{0.0, 0.0, 1.0}, edge[3];
    if (D == 3) n = detail::triangle_normal(corner[0], corner[1], corner[2]);
    // Counter-clockwise as seen from where n points.
    if (dot(cross(corner[1] - corner[0], corner[2] - corner[0]), n) < 0) std::swap(corner[1], corner[2]);
    const double r = static_cast<double>(t.radius), rr = r * r, rrr = rr * r;
    const symmetric<double> nn = square_of(n) * (D == 2 ? 0 : 1);

    detail::solid_moments m;
    const double area = 0.5 * dot(n, cross(corner[1] - corner[0], corner[2] - corner[0]));
    const double slab = D == 2 ? area : 2 * r * area;
    const detail::simplex_sums mean = detail::over_triangle(corner[0], corner[1], corner[2]);
    m.add(slab, {}, mean.first * slab, mean.second * slab + nn * (slab * rr / 3));
    for (int i = 0; i < 3; ++i) {
        const auto [u, l] = direction_and_length_of(corner[i < 2 ? i + 1 : 0] - corner[i]);
        edge[i] = u;
        const vec<double, 3> out = cross(u, n);
        const double strip = l * (D == 2 ? r : 0.5 * pi<double> * rr);
        const double outwards = l * (D == 2 ? 0.5 * rr : rrr * (2.0 / 3));
        const double squares = l * (D == 2 ? rrr / 3 : pi<double> / 8 * rr * rr);
        m.add(strip, corner[i] + u * (0.5 * l), out * outwards,
              square_of(u) * (strip * l * l / 12) + (square_of(out) + nn) * squares);
    }
    for (int i = 0; i < 3; ++i) {
        const vec<double, 3>& before = edge[i > 0 ? i - 1 : 2];
        const vec<double, 3>& after = edge[i];
        // By which the direction turns here; twice the sine of half of it is the length of the difference.
        const double sine = dot(cross(before, after), n), angle = atan2(sine, dot(before, after));
        const vec<double, 3> difference = before - after, out = normalized(difference), aside = cross(n, out);
        const double wedge = angle * (D == 2 ? 0.5 * rr : rrr * (2.0 / 3));
        const double outwards = 0.5 * (D == 2 ? rrr * (2.0 / 3) : 0.25 * pi<double> * rr * rr);
        const double squares = D == 2 ? rr * rr / 8 : rrr * rr * (2.0 / 15);
        m.add(wedge, corner[i], difference * outwards,
              square_of(out) * (squares * (angle + sine)) + square_of(aside) * (squares * (angle - sine)) +
                  nn * (squares * angle));
    }
    return m.template mass<S, D>(origin, density);
}

PHYSICS_HPP_END
