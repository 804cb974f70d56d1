// Rotation in 2D: a unit complex number.
#pragma once

#include "physics/space/check.hpp"
#include "physics/space/mat.hpp"

PHYSICS_HPP_BEGIN

/// A rotation in D dimensions. Both kinds offer: identity (the default), a * b (b first), a * v, inverse(a),
/// matrix(a), normalized(a), turned(a, angle) and is_finite(a).
template <class S, int D>
struct rotation;

/// A rotation in 2D, counter-clockwise, by its cosine and sine.
template <class S>
struct rotation<S, 2> {
    S cosine = S(1);
    S sine = S(0);

    constexpr rotation() = default;
    constexpr rotation(S cosine_, S sine_) : cosine(cosine_), sine(sine_) {}
    /// From an angle in radians; any scalar angle or plain number.
    static rotation from_angle(S radians) {
        const auto [s, c] = sine_cosine(radians);
        return {c, s};
    }
    /// Takes the x axis to the direction of a vector of any length: of the frames of joints that slide. Error: a null
    /// vector is refused, and the result is the identity.
    static rotation from_x_axis(const vec<S, 2>& axis) {
        if (!detail::check_axis("from_x_axis", "axis", axis)) return {};
        const vec<S, 2> x = normalized(axis);
        return {x.x, x.y};
    }
    /// The angle in radians, in [-pi, pi].
    [[nodiscard]] S angle() const { return atan2(sine, cosine); }

    friend bool operator==(rotation, rotation) = default;
};

template <class S>
constexpr rotation<S, 2> operator*(rotation<S, 2> a, rotation<S, 2> b) {
    return {difference_of_products(a.cosine, b.cosine, a.sine, b.sine),
            sum_of_products(a.sine, b.cosine, a.cosine, b.sine)};
}
template <class S>
constexpr vec<S, 2> operator*(rotation<S, 2> a, vec<S, 2> v) {
    return {difference_of_products(a.cosine, v.x, a.sine, v.y), sum_of_products(a.sine, v.x, a.cosine, v.y)};
}

template <class S>
constexpr rotation<S, 2> inverse(rotation<S, 2> a) {
    return {a.cosine, -a.sine};
}
/// The rotation that undoes a, times v.
template <class S>
constexpr vec<S, 2> inverse_rotate(rotation<S, 2> a, vec<S, 2> v) {
    return {sum_of_products(a.cosine, v.x, a.sine, v.y), difference_of_products(a.cosine, v.y, a.sine, v.x)};
}
template <class S>
constexpr mat<S, 2> matrix(rotation<S, 2> a) {
    return {{{a.cosine, a.sine}, {-a.sine, a.cosine}}};
}
template <class S>
constexpr bool is_finite(rotation<S, 2> a) {
    return is_finite(a.cosine) && is_finite(a.sine);
}
/// | |a|^2 - 1 |: how far a is from a rotation.
template <class S>
constexpr S norm_error(rotation<S, 2> a) {
    return abs(sum_of_products(a.cosine, a.cosine, a.sine, a.sine) - S(1));
}
/// a with length 1; the identity if a is null.
template <class S>
constexpr rotation<S, 2> normalized(rotation<S, 2> a) {
    const auto [unit, length] = direction_and_length_of(vec<S, 2>{a.cosine, a.sine});
    if (!(length > S(0))) return {};
    return {unit.x, unit.y};
}

/// The angle of a in radians, in [-pi, pi]; in 3D the rotation vector, axis times angle.
template <class S>
S rotation_vector(rotation<S, 2> a) {
    return a.angle();
}

namespace detail {
/// tan(x) / x by its series for x^2 = xx <= 1/16, relative error < 9e-9 there and 9e-16 at x = 1/20. A
/// rotation built from the tangent has length 1 whatever its error, so a cut series costs angle, never scale.
template <class S>
constexpr S tangent_ratio(S xx) {
    return S(1) + xx * (S(1.0 / 3) + xx * (S(2.0 / 15) + xx * (S(17.0 / 315) + xx * S(62.0 / 2835))));
}
/// The factor of one Newton step towards length 1: enough for the rounding of one product.
template <class S>
constexpr S length_repair(S squared_length) {
    return S(1.5) - S(0.5) * squared_length;
}
}  // namespace detail

/// a, turned further by an angle in radians; keeps length 1. Half a radian at most goes without trigonometry
/// (relative error of the angle < 9e-9), more through sine and cosine. Source: the Cayley map.
template <class S>
constexpr rotation<S, 2> turned(rotation<S, 2> a, S angle) {
    const S half = angle * S(0.5);
    if (abs(half) > S(0.25)) return normalized(rotation<S, 2>::from_angle(angle) * a);
    const S t = half * detail::tangent_ratio(half * half);
    const S scale = S(1) / (S(1) + t * t);
    const rotation<S, 2> r = rotation<S, 2>{(S(1) - t * t) * scale, (t + t) * scale} * a;
    const S repair = detail::length_repair(sum_of_products(r.cosine, r.cosine, r.sine, r.sine));
    return {r.cosine * repair, r.sine * repair};
}

PHYSICS_HPP_END
