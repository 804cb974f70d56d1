// Rigid transforms, twists and boxes.
#pragma once

#include "physics/space/rotation3.hpp"

PHYSICS_HPP_BEGIN

/// A rigid transform: first the rotation, then the translation to position (metres).
template <class S, int D>
struct transform {
    vec<S, D> position;
    physics::rotation<S, D> rotation;

    friend bool operator==(const transform&, const transform&) = default;
};

/// The point p, given in the inner frame, in the outer one.
template <class S, int D>
constexpr vec<S, D> operator*(const transform<S, D>& t, vec<S, D> p) {
    return t.rotation * p + t.position;
}
/// b first, then a.
template <class S, int D>
constexpr transform<S, D> operator*(const transform<S, D>& a, const transform<S, D>& b) {
    return {a * b.position, a.rotation * b.rotation};
}

/// The transform that undoes t.
template <class S, int D>
constexpr transform<S, D> inverse(const transform<S, D>& t) {
    return {-inverse_rotate(t.rotation, t.position), inverse(t.rotation)};
}
/// The point p, given in the outer frame, in the inner one.
template <class S, int D>
constexpr vec<S, D> inverse_transform(const transform<S, D>& t, vec<S, D> p) {
    return inverse_rotate(t.rotation, p - t.position);
}
/// The frame b as seen from a: a * relative(a, b) == b. Subtracts positions first, so that two bodies far
/// from the origin keep the precision of their distance.
template <class S, int D>
constexpr transform<S, D> relative(const transform<S, D>& a, const transform<S, D>& b) {
    return {inverse_rotate(a.rotation, b.position - a.position), inverse(a.rotation) * b.rotation};
}
template <class S, int D>
constexpr bool is_finite(const transform<S, D>& t) {
    return is_finite(t.position) && is_finite(t.rotation);
}

/// Linear velocity (m/s) and angular velocity (rad/s) of a body, or an impulse and its moment.
template <class S, int D>
struct twist {
    vec<S, D> linear;
    physics::angular<S, D> angular{};

    friend bool operator==(const twist&, const twist&) = default;
};

template <class S, int D>
constexpr twist<S, D> operator+(const twist<S, D>& a, const twist<S, D>& b) {
    return {a.linear + b.linear, a.angular + b.angular};
}
template <class S, int D>
constexpr twist<S, D> operator-(const twist<S, D>& a, const twist<S, D>& b) {
    return {a.linear - b.linear, a.angular - b.angular};
}

/// The velocity of the point at lever r from the centre of mass.
template <class S, int D>
constexpr vec<S, D> velocity_at(const twist<S, D>& v, vec<S, D> r) {
    return v.linear + cross(v.angular, r);
}

PHYSICS_HPP_END
