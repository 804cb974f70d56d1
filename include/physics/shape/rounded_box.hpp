// The rounded box: a box whose edges and corners are round.
#pragma once

#include "physics/shape/box.hpp"
#include "physics/shape/solid_moments.hpp"

PHYSICS_HPP_BEGIN

/// All points within radius (m) of the box |p_i| <= half_extents_i (m) in the shape's frame: it reaches
/// half_extents_i + radius along each axis.
template <class S, int D>
struct rounded_box {
    using scalar = S;
    vec<S, D> half_extents = vec<S, D>::filled(S(0.375));
    S radius = S(0.125);

    template <class T>
    [[nodiscard]] constexpr rounded_box<T, D> as() const {
        rounded_box<T, D> result;
        for (int i = 0; i < D; ++i) result.half_extents[i] = static_cast<T>(half_extents[i]);
        result.radius = static_cast<T>(radius);
        return result;
    }
};

template <class S, int D>
bool check(const rounded_box<S, D>& b, const char* function) {
    return check(box<S, D>{b.half_extents}, function) && detail::check_positive(function, "radius", b.radius);
}
template <class S, int D>
constexpr aabb<S, D> bounds(const rounded_box<S, D>& b, const transform<S, D>& at) {
    return grown(bounds(box<S, D>{b.half_extents}, at), b.radius);
}
template <class S, int D>
constexpr vec<S, D> support(const rounded_box<S, D>& b, vec<S, D> direction) {
    return support(box<S, D>{b.half_extents}, direction) + normalized(direction) * b.radius;
}
/// Exact; calculated in double. The box, slabs on its sides, quarters of discs or cylinders at its edges, and in 3D
/// eighths of a ball at its corners.
template <class S, int D>
mass_properties<S, D> mass_of(const rounded_box<S, D>& b, std::type_identity_t<S> density) {
    const vec<double, 3> h = detail::exact_in_space(b.half_extents);
    const double r = static_cast<double>(b.radius), rr = r * r;
    double volume = 0, squares[3] = {};
    for (int i = 0; i < D; ++i) {
        const int j = i + 1 < D ? i + 1 : 0, k = D == 2 ? j : i > 0 ? i - 1 : 2;
        const double a = h[i], aa = a * a;
        // What lies between this axis' sides, and beyond them. Together the same volume for each axis.
        const double within =
            D == 2 ? 4 * a * (h[j] + r) : 8 * a * (h[j] * h[k] + r * (h[j] + h[k])) + 2 * pi<double> * rr * a;
        const double slabs = r * (D == 2 ? 4 * h[j] : 8 * h[j] * h[k]);
        const double quarters = pi<double> * rr * (D == 2 ? 1 : 2 * (h[j] + h[k]));
        const double balls = D == 2 ? 0 : pi<double> * (4.0 / 3) * rr * r;
        volume = within + slabs + quarters + balls;
        squares[i] = within * (aa / 3) + slabs * (aa + a * r + rr / 3) +
                     quarters * (aa + a * r * (8.0 / 3) / pi<double> + rr / 4) + balls * (aa + a * r * 0.75 + rr / 5);
    }
    detail::solid_moments m;
    m.add(volume, {}, {}, symmetric<double>::diagonal(squares[0], squares[1], squares[2]));
    return m.template mass<S, D>({}, density);
}

PHYSICS_HPP_END
