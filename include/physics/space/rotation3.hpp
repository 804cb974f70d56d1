// Rotation in 3D: a unit quaternion.
#pragma once

#include "physics/space/check.hpp"
#include "physics/space/rotation2.hpp"

PHYSICS_HPP_BEGIN

/// A rotation in 3D as a unit quaternion x i + y j + z k + w.
template <class S>
struct rotation<S, 3> {
    S x{}, y{}, z{};
    S w = S(1);

    constexpr rotation() = default;
    constexpr rotation(S x_, S y_, S z_, S w_) : x(x_), y(y_), z(z_), w(w_) {}
    /// By an angle in radians about a unit axis, counter-clockwise as seen from its tip.
    static rotation from_axis_angle(vec<S, 3> axis, S radians) {
        const auto [s, c] = sine_cosine(radians * S(0.5));
        return {axis.x * s, axis.y * s, axis.z * s, c};
    }
    /// Takes the x axis to the direction of a vector of any length, by the shortest turn: of the frames of joints that
    /// slide, roll or swing. Error: a null vector is refused, and the result is the identity.
    static rotation from_x_axis(const vec<S, 3>& axis);
    /// The same for the z axis: of the frames of joints that turn.
    static rotation from_z_axis(const vec<S, 3>& axis);
    /// Takes the x axis to the direction of one, and the z axis as near as it may to that of another: of the frames of
    /// wheels. Error: vectors to within a thousandth of a line are refused, and the result is the identity.
    static rotation from_axes(const vec<S, 3>& x_axis, const vec<S, 3>& z_axis);

    [[nodiscard]] constexpr vec<S, 3> imaginary() const { return {x, y, z}; }

    friend bool operator==(rotation, rotation) = default;
};

template <class S>
constexpr rotation<S, 3> operator*(rotation<S, 3> a, rotation<S, 3> b) {
    const auto sum = [](auto p, auto q, auto r, auto s) { return narrow<S>(p + q + r + s); };
    return {sum(product(a.w, b.x), product(a.x, b.w), product(a.y, b.z), -product(a.z, b.y)),
            sum(product(a.w, b.y), product(a.y, b.w), product(a.z, b.x), -product(a.x, b.z)),
            sum(product(a.w, b.z), product(a.z, b.w), product(a.x, b.y), -product(a.y, b.x)),
            sum(product(a.w, b.w), -product(a.x, b.x), -product(a.y, b.y), -product(a.z, b.z))};
}
template <class S>
constexpr vec<S, 3> operator*(rotation<S, 3> a, vec<S, 3> v) {
    const vec<S, 3> t = cross(a.imaginary(), v) * S(2);
    return v + t * a.w + cross(a.imaginary(), t);
}

template <class S>
constexpr rotation<S, 3> inverse(rotation<S, 3> a) {
    return {-a.x, -a.y, -a.z, a.w};
}
/// The rotation that undoes a, times v.
template <class S>
constexpr vec<S, 3> inverse_rotate(rotation<S, 3> a, vec<S, 3> v) {
    return inverse(a) * v;
}
template <class S>
constexpr mat<S, 3> matrix(rotation<S, 3> a) {
    const S x2 = a.x + a.x, y2 = a.y + a.y, z2 = a.z + a.z;
    return {{{S(1) - sum_of_products(a.y, y2, a.z, z2), sum_of_products(a.x, y2, a.w, z2),
              difference_of_products(a.x, z2, a.w, y2)},
             {difference_of_products(a.x, y2, a.w, z2), S(1) - sum_of_products(a.x, x2, a.z, z2),
              sum_of_products(a.y, z2, a.w, x2)},
             {sum_of_products(a.x, z2, a.w, y2), difference_of_products(a.y, z2, a.w, x2),
              S(1) - sum_of_products(a.x, x2, a.y, y2)}}};
}
template <class S>
constexpr bool is_finite(rotation<S, 3> a) {
    return is_finite(a.imaginary()) && is_finite(a.w);
}

namespace detail {
template <class S>
constexpr S squared_norm(rotation<S, 3> a) {
    return narrow<S>(wide_dot(a.imaginary(), a.imaginary()) + product(a.w, a.w));
}
/// 1 - |a|^2 of what is nearly a rotation. Nothing is rounded near 1, where numbers above are coarser than those below
/// and a mean of roundings is not 0.
template <class S>
constexpr S norm_lack(rotation<S, 3> a) {
    return narrow<S>(product(S(1), S(1)) - product(a.w, a.w) - product(a.x, a.x) - product(a.y, a.y) -
                     product(a.z, a.z));
}
/// a * v as if a had length 1, off which it may be by rounding: the length of v is kept to the rounding of v, with no
/// bias, which a * v would stretch or shrink each time in the same sense.
template <class S>
constexpr vec<S, 3> rotated_as_unit(rotation<S, 3> a, vec<S, 3> v) {
    const vec<S, 3> half = cross(a.imaginary(), v), t = (half + half * norm_lack(a)) * S(2);
    return v + (t * a.w + cross(a.imaginary(), t));
}
}  // namespace detail

/// | |a|^2 - 1 |: how far a is from a rotation.
template <class S>
constexpr S norm_error(rotation<S, 3> a) {
    return abs(detail::squared_norm(a) - S(1));
}
/// a with length 1; the identity if a is null.
template <class S>
constexpr rotation<S, 3> normalized(rotation<S, 3> a) {
    const S scale = max(largest(a.imaginary()), abs(a.w));
    if (!(scale > S(0))) return {};
    const rotation<S, 3> b{a.x / scale, a.y / scale, a.z / scale, a.w / scale};
    const S norm = sqrt(detail::squared_norm(b));
    return {b.x / norm, b.y / norm, b.z / norm, b.w / norm};
}

/// Axis times angle of a (radians, at most pi), so that turned({}, rotation_vector(a)) is a again.
template <class S>
vec<S, 3> rotation_vector(rotation<S, 3> a) {
    const auto [axis, sine] = direction_and_length_of(a.w < S(0) ? -a.imaginary() : a.imaginary());
    return axis * (atan2(sine, abs(a.w)) * S(2));
}

/// a, turned further by a rotation vector (axis times angle, radians, in the outer frame); keeps length 1.
/// One radian at most goes without trigonometry, as in 2D.
template <class S>
constexpr rotation<S, 3> turned(rotation<S, 3> a, vec<S, 3> angle) {
    const vec<S, 3> quarter = angle * S(0.25);
    const S xx = dot(quarter, quarter);
    if (largest(quarter) > S(0.25) || xx > S(0.0625)) {
        const auto [axis, radians] = direction_and_length_of(angle);
        return normalized(rotation<S, 3>::from_axis_angle(axis, radians) * a);
    }
    const vec<S, 3> t = quarter * detail::tangent_ratio(xx);
    const S tt = dot(t, t);
    const S scale = S(1) / (S(1) + tt);
    const vec<S, 3> v = t * (scale + scale);
    // What is added is small where the angle is, so that a is rounded once.
    const rotation<S, 3> change = rotation<S, 3>{v.x, v.y, v.z, -((tt + tt) * scale)} * a;
    const rotation<S, 3> r{a.x + change.x, a.y + change.y, a.z + change.z, a.w + change.w};
    const S lack = detail::norm_lack(r) * S(0.5);
    return {r.x + r.x * lack, r.y + r.y * lack, r.z + r.z * lack, r.w + r.w * lack};
}

namespace detail {

/// By the shortest turn from one unit vector to another; `across` is one across the first.
template <class S>
rotation<S, 3> shortest_turn(const vec<S, 3>& from, const vec<S, 3>& to, const vec<S, 3>& across) {
    const vec<S, 3> axis = cross(from, to);
    const S cosine = dot(from, to);
    if (!(cosine < S(0))) return normalized(rotation<S, 3>{axis.x, axis.y, axis.z, S(1) + cosine});
    // 1 + cosine would be what rounding leaves of it.
    const auto [along, sine] = direction_and_length_of(axis);
    const vec<S, 3> about = sine > S(0) ? along : across;
    return normalized(rotation<S, 3>{about.x, about.y, about.z, sine / (S(1) - cosine)});
}

}  // namespace detail

template <class S>
rotation<S, 3> rotation<S, 3>::from_x_axis(const vec<S, 3>& axis) {
    if (!detail::check_axis("from_x_axis", "axis", axis)) return {};
    return detail::shortest_turn<S>({S(1), S(0), S(0)}, physics::normalized(axis), {S(0), S(0), S(1)});
}
template <class S>
rotation<S, 3> rotation<S, 3>::from_z_axis(const vec<S, 3>& axis) {
    if (!detail::check_axis("from_z_axis", "axis", axis)) return {};
    return detail::shortest_turn<S>({S(0), S(0), S(1)}, physics::normalized(axis), {S(1), S(0), S(0)});
}
template <class S>
rotation<S, 3> rotation<S, 3>::from_axes(const vec<S, 3>& x_axis, const vec<S, 3>& z_axis) {
    if (!detail::check_axis("from_axes", "x_axis", x_axis) || !detail::check_axis("from_axes", "z_axis", z_axis))
        return {};
    const rotation first = from_x_axis(x_axis);
    const vec<S, 3> aim = inverse_rotate(first, physics::normalized(z_axis));
    if (max(abs(aim.y), abs(aim.z)) < S(0.001)) {
        detail::refuse("from_axes", "z_axis", "along x_axis", "it must not be");
        return {};
    }
    return physics::normalized(first * from_axis_angle({S(1), S(0), S(0)}, atan2(-aim.y, aim.z)));
}

PHYSICS_HPP_END
