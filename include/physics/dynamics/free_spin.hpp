// How bodies turn on which no torque acts.
#pragma once

#include <limits>

#include "physics/base/stage.hpp"
#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Axes, as a rotation from them to the body's frame, about which an inertia is diagonal; and its moments about them.
struct principal_axes {
    rotation<double, 3> axes;
    double moments[3];
};

/// The principal axes of an inertia. Error: a few roundings of its largest moment. Source: Jacobi's method; Golub, Van
/// Loan, Matrix Computations, 8.5.
inline principal_axes principal_axes_of(const symmetric<double>& inertia) {
    principal_axes p{};
    symmetric<double> m = inertia;
    // Each turn removes the largest product of inertia; they shrink by squares in the end.
    for (int round = 0; round < 24; ++round) {
        const double products[] = {m.yz, m.xz, m.xy}, moments[] = {m.xx, m.yy, m.zz};
        int axis = 0;
        for (int i = 1; i < 3; ++i)
            if (abs(products[i]) > abs(products[axis])) axis = i;
        const double product = products[axis];
        if (abs(product) <= 0x1p-60 * (m.xx + m.yy + m.zz)) break;
        const double ratio = (moments[(axis + 1) % 3] - moments[(axis + 2) % 3]) / (2 * product);
        const double tangent = (ratio < 0 ? -1 : 1) / (abs(ratio) + sqrt(ratio * ratio + 1));
        const double cosine = 1 / sqrt(tangent * tangent + 1), half = sqrt((1 + cosine) / 2);
        rotation<double, 3> turn{0, 0, 0, half};
        (axis == 0 ? turn.x : axis == 1 ? turn.y : turn.z) = tangent * cosine / (2 * half);
        p.axes = normalized(p.axes * turn);
        m = rotated(inertia, matrix(inverse(p.axes)));
    }
    p.moments[0] = m.xx;
    p.moments[1] = m.yy;
    p.moments[2] = m.zz;
    return p;
}

/// a rounded so that its length is as near to 1 as can be: of the numbers next to its coordinates those that fit best.
/// A rotation by which others are multiplied in every step would stretch or shrink them always in the same sense.
template <class S>
rotation<S, 3> rounded_rotation(const rotation<double, 3>& a) {
    const S plain[] = {S(a.x), S(a.y), S(a.z), S(a.w)};
    rotation<S, 3> best;
    std::int64_t minimum = std::numeric_limits<std::int64_t>::max();
    for (int n = 0; n < 81 && minimum > 4; ++n) {
        S r[4];
        // |r|^2 - 1 in parts of 2^-60.
        int128 sum{};
        for (int i = 0, digits = n; i < 4; ++i, digits /= 3) {
            const S step = is_fixed<S> ? scalar_traits<S>::epsilon() : plain[i] * scalar_traits<S>::epsilon();
            r[i] = plain[i] + step * S(digits % 3 == 2 ? -1 : digits % 3);
            // Fixed point does not take halves as they are: products with them would often lie midway between two
            // numbers, and be rounded away from 0.
            if (is_fixed<S> && a.x == a.y && a.x != 0 && i < 2) r[i] += i == 0 ? step : -step;
            const auto units = static_cast<std::int64_t>(static_cast<double>(r[i]) * 0x1p60);
            sum = sum + product128(units, units);
        }
        const std::int64_t error = (sum >> 60).low() - (std::int64_t{1} << 60), size = error < 0 ? -error : error;
        if (!(size < minimum)) continue;
        minimum = size;
        best = {r[0], r[1], r[2], r[3]};
    }
    return best;
}

}  // namespace detail

namespace solver_api {

/// What a body's free spin needs to know of its inertia: nothing in 2D.
template <class S, int D>
struct free_spin {
    constexpr free_spin() = default;
    constexpr explicit free_spin(S) {}
};
/// In 3D: its principal axes and the moments about them, the inverse of the first one, and by how much the inverses
/// of the others differ from that; the second is the one that differs least. `reach` is the largest angular momentum
/// times a time (kg m^2) over which its turns may be taken one after the other: half a radian about the third axis;
/// without limit for symmetric tops, whose turns are exact.
template <class S>
struct free_spin<S, 3> {
    rotation<S, 3> axes;
    vec<S, 3> moments;
    inverse_of<S> first{}, second{}, third{};
    S reach{};

    free_spin() = default;
    explicit free_spin(const symmetric<S>& inertia) {
        detail::principal_axes p = detail::principal_axes_of(
            {static_cast<double>(inertia.xx), static_cast<double>(inertia.yy), static_cast<double>(inertia.zz),
             static_cast<double>(inertia.xy), static_cast<double>(inertia.xz), static_cast<double>(inertia.yz)});
        double inverse[3];
        // Of the moments as they are kept: else a spin would grow or fade, bit by bit.
        for (int i = 0; i < 3; ++i) {
            moments[i] = S(p.moments[i]);
            inverse[i] = 1 / static_cast<double>(moments[i]);
        }
        int last = 0;
        for (int i = 1; i < 3; ++i)
            if (apart(inverse, i) > apart(inverse, last)) last = i;
        // Turns the names of the axes until the odd one is the third.
        for (; last != 2; last = (last + 1) % 3) {
            p.axes = p.axes * rotation<double, 3>{-0.5, -0.5, -0.5, 0.5};
            const double before[] = {inverse[0], inverse[1], inverse[2]};
            for (int i = 0; i < 3; ++i) inverse[(i + 1) % 3] = before[i];
            moments = {moments.z, moments.x, moments.y};
        }
        axes = detail::rounded_rotation<S>(p.axes);
        first = inverse_of<S>(inverse[0]);
        second = inverse_of<S>(inverse[1] - inverse[0]);
        third = inverse_of<S>(inverse[2] - inverse[0]);
        const double unequal = abs(inverse[1] - inverse[0]), maximum = static_cast<double>(scalar_traits<S>::max()) / 2;
        const double limit = unequal > 0x1p-13 * inverse[0] ? 0.5 / abs(inverse[2] - inverse[0]) : maximum;
        reach = S(limit < maximum ? limit : maximum);
    }

private:
    /// How far a number is from the nearer one of the two others.
    static double apart(const double (&x)[3], int i) {
        const double a = abs(x[i] - x[(i + 1) % 3]), b = abs(x[i] - x[(i + 2) % 3]);
        return a < b ? a : b;
    }
};

}  // namespace solver_api

PHYSICS_HPP_END
