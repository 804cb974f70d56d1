// Two coaxial discs and all between them, rounded or not: what cylinders and cones are.
#pragma once

#include "physics/shape/concept.hpp"
#include "physics/shape/solid_moments.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Discs of the radii low and high at -half and half on the x axis, and all within `rounding` of what is between.
template <class S>
struct discs {
    S half, low, high, rounding;
};

template <class S>
constexpr aabb<S, 3> bounds_of(const discs<S>& d, const transform<S, 3>& at) {
    const mat<S, 3> m = matrix(at.rotation);
    aabb<S, 3> box;
    for (int i = 0; i < 3; ++i) {
        // How far a disc of radius 1 reaches. Of the axis alone, 1 - x * x would lose half of the digits.
        const S across = length(vec<S, 2>{m.column[1][i], m.column[2][i]}), along = m.column[0][i] * d.half;
        const S at_low = across * d.low, at_high = across * d.high;
        box.lower[i] = min(-along - at_low, along - at_high) - d.rounding;
        box.upper[i] = max(-along + at_low, along + at_high) + d.rounding;
    }
    return {at.position + box.lower, at.position + box.upper};
}
template <class S>
constexpr vec<S, 3> support_of(const discs<S>& d, vec<S, 3> direction) {
    const vec<S, 3> n = normalized(direction);
    const auto [aside, across] = direction_and_length_of(vec<S, 2>{n.y, n.z});
    const bool upper = !(n.x * (d.half + d.half) < across * (d.low - d.high));
    const S r = upper ? d.high : d.low;
    return vec<S, 3>{upper ? d.half : -d.half, aside.x * r, aside.y * r} + n * d.rounding;
}
/// Exact; calculated in double. Slices across the axis, whose radius is a line between two arcs.
template <class S>
mass_properties<S, 3> mass_of_discs(const discs<S>& d, S density) {
    const double half = static_cast<double>(d.half), low = static_cast<double>(d.low),
                 high = static_cast<double>(d.high), r = static_cast<double>(d.rounding);
    // Integrals over x of R^2, x R^2, x^2 R^2 and R^4 for the radius R of the slice at x.
    double area = 0, first = 0, along = 0, fourth = 0;
    const double slope = low - high, side = sqrt(4 * half * half + slope * slope);
    const double sine = slope / side, cosine = 2 * half / side;
    {
        // The side: polynomials up to the fourth degree, exact by three points of Gauss.
        const double begin = low + r * cosine, end = high + r * cosine;
        constexpr double gauss[3][2] = {{-0.77459666924148338, 5.0 / 9}, {0, 8.0 / 9}, {0.77459666924148338, 5.0 / 9}};
        for (const auto& g : gauss) {
            const double x = r * sine + half * g[0], radius = 0.5 * (begin + end) + 0.5 * (end - begin) * g[0];
            const double rr = radius * radius, weight = half * g[1];
            area += weight * rr;
            first += weight * x * rr;
            along += weight * x * x * rr;
            fourth += weight * rr * rr;
        }
    }
    // An arc about (x, q): slices at x + r * sin, of the radius q + r * cos, between two angles that differ by `angle`.
    const auto arc = [&](double x, double q, double angle, double s0, double c0, double s1, double c1) {
        // The integrals of cos^k, and of sin cos^k and sin^2 cos^k.
        double powers[8] = {angle, s1 - s0}, odd[5] = {0, 0.5 * (c0 * c0 - c1 * c1)}, p0 = c0, p1 = c1;
        for (int k = 2; k < 8; ++k) {
            powers[k] = (p1 * s1 - p0 * s0) / k + powers[k - 2] * (k - 1) / k;
            p0 *= c0;
            p1 *= c1;
            if (k < 5) odd[k] = (p0 * c0 - p1 * c1) / (k + 1);
        }
        const double square[3] = {q * q * r, 2 * q * r * r, r * r * r};
        for (int k = 0; k < 3; ++k) {
            const double even = powers[k + 1] - powers[k + 3];
            area += square[k] * powers[k + 1];
            first += square[k] * (x * powers[k + 1] + r * odd[k + 1]);
            along += square[k] * (x * x * powers[k + 1] + 2 * x * r * odd[k + 1] + r * r * even);
        }
        const double qq = q * q, rr = r * r;
        const double quartic[5] = {qq * qq, 4 * qq * q * r, 6 * qq * rr, 4 * q * r * rr, rr * rr};
        for (int k = 0; k < 5; ++k) fourth += r * quartic[k] * powers[k + 1];
    };
    if (r > 0) {
        const double angle = atan2(slope, 2 * half), quarter = 0.5 * pi<double>;
        arc(-half, low, angle + quarter, -1, 0, sine, cosine);
        arc(half, high, quarter - angle, sine, cosine, 1, 0);
    }
    const double across = 0.25 * pi<double> * fourth;
    solid_moments m;
    m.add(pi<double> * area, {}, vec<double, 3>{pi<double> * first, 0.0, 0.0},
          symmetric<double>::diagonal(pi<double> * along, across, across));
    return m.template mass<S, 3>({}, density);
}

}  // namespace detail

PHYSICS_HPP_END
