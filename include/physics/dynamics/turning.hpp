// How a body turns in 3D by its own inertia.
#pragma once

#include "physics/dynamics/body.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A turn about an axis of a frame, as seen from it.
template <class S>
class axis_turn {
public:
    constexpr explicit axis_turn(S angle) : half_(turned(rotation<S, 2>{}, angle * S(0.5))) {}
    /// Turns the frame about its axis number `axis`, and what is seen from it the other way. Does not repair lengths.
    constexpr void apply(int axis, rotation<S, 3>& frame, vec<S, 3>& seen) const {
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        const vec<S, 3> q = frame.imaginary();
        const S s = half_.sine, c = half_.cosine;
        vec<S, 3> r;
        r[axis] = sum_of_products(frame.w, s, q[axis], c);
        r[i] = sum_of_products(q[i], c, q[j], s);
        r[j] = difference_of_products(q[j], c, q[i], s);
        frame = {r.x, r.y, r.z, difference_of_products(frame.w, c, q[axis], s)};
        const S sine = (s + s) * c, cosine = S(1) - (s + s) * s, along = seen[i];
        seen[i] = sum_of_products(along, cosine, seen[j], sine);
        seen[j] = difference_of_products(seen[j], cosine, along, sine);
    }

private:
    rotation<S, 2> half_;
};

/// Turns a body by its own inertia for a time h: its principal axes, with a momentum that stays; gives the angular
/// velocity at the end. A time in which it would turn beyond its reach is split, for else its energy could grow to that
/// of its shortest axis: into up to 1,024 parts of an eighth of a radian, which takes about 0.1 us each.
template <class S>
constexpr vec<S, 3> turn_gyroscopic(const free_spin<S, 3>& spin, rotation<S, 3>& axes, const vec<S, 3>& momentum, S h) {
    vec<S, 3> seen = rotated_as_unit(inverse(axes), momentum);
    const auto turn_about = [&](int axis, inverse_of<S> by, S time) {
        if (by != inverse_of<S>(0)) axis_turn<S>(mul<S>(by, seen[axis]) * time).apply(axis, axes, seen);
    };
    S largest{}, part = h;
    for (int i = 0; i < 3; ++i) largest = max(largest, abs(momentum[i]));
    int parts = 1;
    if (largest * h > spin.reach)
        for (; parts < 1024 && largest * part > spin.reach * S(0.25); parts *= 2) part = part * S(0.5);
    for (int n = 0; n < parts; ++n) {
        turn_about(1, spin.second, part * S(0.5));
        turn_about(2, spin.third, part);
        turn_about(1, spin.second, part * S(0.5));
    }
    vec<S, 3> angle;
    for (int i = 0; i < 3; ++i) angle[i] = mul<S>(spin.first, momentum[i]) * h;
    axes = turned(axes, angle);
    vec<S, 3> w = rotated_as_unit(inverse(axes), momentum);
    for (int i = 0; i < 3; ++i) w[i] = w[i] / spin.moments[i];
    return rotated_as_unit(axes, w);
}

/// Turns a body on which no torque acts for a time h. Its energy of motion is split into parts whose motions are known:
/// a turn about the angular momentum, as if all moments were the first, and turns about two principal axes for what is
/// left of these. Momentum is kept to rounding, whatever the spin and however thin the body; the energy errs with the
/// square of h and does not drift; exact for symmetric tops. Source: McLachlan, Explicit Lie-Poisson integration and
/// the Euler equations (1993); Hairer, Lubich, Wanner, Geometric Numerical Integration, VII.5.
template <class S>
constexpr void turn_freely(moving_body<S, 3>& b, vec<S, 3>& angular_velocity, S h) {
    const free_spin<S, 3>& spin = b.gyroscopic->spin;
    rotation<S, 3> axes = b.rotation * spin.axes;
    vec<S, 3> momentum = rotated_as_unit(inverse(axes), angular_velocity);
    for (int i = 0; i < 3; ++i) momentum[i] = spin.moments[i] * momentum[i];
    angular_velocity = turn_gyroscopic(spin, axes, rotated_as_unit(axes, momentum), h);
    b.rotation = axes * inverse(spin.axes);
}

}  // namespace detail

PHYSICS_HPP_END
