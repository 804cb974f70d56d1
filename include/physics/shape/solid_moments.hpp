// Volume, centroid and second moments of solids that are put together of pieces.
#pragma once

#include "physics/shape/hull_moments.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The integrals of 1, p and p p^T over a solid, with p from a place near it, summed in double over its pieces. In the
/// plane z is 0, and integrals are over the plane.
struct solid_moments {
    double volume = 0;
    vec<double, 3> first;
    symmetric<double> second;

    /// Adds a piece of so much volume at a place, whose p and p p^T from that place sum up to `sum` and `squares`.
    void add(double size, const vec<double, 3>& at, const vec<double, 3>& sum, const symmetric<double>& squares) {
        volume += size;
        first += at * size + sum;
        second = second + square_of(at) * size + both_products(at, sum) + squares;
    }
    /// By density; `origin` is where p begins. None if there is no volume.
    template <class T, int D>
    [[nodiscard]] mass_properties<T, D> mass(const vec<double, 3>& origin, T density) const {
        if (!(volume > 0)) return {};
        const double d = static_cast<double>(density);
        const vec<double, 3> shift = first / volume, c = origin + shift;
        const symmetric<double> m = (second + square_of(shift) * -volume) * d;
        if constexpr (D == 2) return {T(d * volume), {T(c.x), T(c.y)}, T(m.xx + m.yy)};
        else
            return {T(d * volume),
                    {T(c.x), T(c.y), T(c.z)},
                    {T(m.yy + m.zz), T(m.xx + m.zz), T(m.xx + m.yy), T(-m.xy), T(-m.xz), T(-m.yz)}};
    }
};

/// A point of a shape in double, in 3D.
template <class S, int D>
vec<double, 3> exact_in_space(const vec<S, D>& v) {
    vec<double, 3> p;
    for (int i = 0; i < D; ++i) p[i] = static_cast<double>(v[i]);
    return p;
}

}  // namespace detail

PHYSICS_HPP_END
