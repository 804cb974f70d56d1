// Values of bodies in another scalar, and how large they are.
#pragma once

#include "physics/dynamics/body.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

template <class T, class S>
rotation<T, 2> converted(const rotation<S, 2>& r) {
    return {static_cast<T>(r.cosine), static_cast<T>(r.sine)};
}
template <class T, class S>
rotation<T, 3> converted(const rotation<S, 3>& r) {
    return {static_cast<T>(r.x), static_cast<T>(r.y), static_cast<T>(r.z), static_cast<T>(r.w)};
}
template <class T, class S, int D>
vec<T, D> converted(vec<S, D> v) {
    vec<T, D> result;
    for (int i = 0; i < D; ++i) result[i] = static_cast<T>(v[i]);
    return result;
}
template <class T, class S, int D>
transform<T, D> converted(const transform<S, D>& t) {
    return {converted<T>(t.position), converted<T>(t.rotation)};
}
template <class T, scalar_type S>
T converted(S x) {
    return static_cast<T>(x);
}
template <class T, class S>
symmetric<T> converted(const symmetric<S>& m) {
    return {static_cast<T>(m.xx), static_cast<T>(m.yy), static_cast<T>(m.zz),
            static_cast<T>(m.xy), static_cast<T>(m.xz), static_cast<T>(m.yz)};
}
template <class T, class S, int D>
twist<T, D> converted(const twist<S, D>& v) {
    return {converted<T>(v.linear), converted<T>(v.angular)};
}
template <class T, class S, int D>
linear_twist<T, D> converted(const linear_twist<S, D>& v) {
    return {converted<T>(v.linear)};
}
template <class T, class S, int D>
mass_properties<T, D> converted(const mass_properties<S, D>& m) {
    return {static_cast<T>(m.mass), converted<T>(m.center), converted<T>(m.inertia)};
}

/// The largest part of a number or vector, for messages.
template <scalar_type S>
double largest_magnitude(S x) {
    return static_cast<double>(abs(x));
}
template <class S, int D>
double largest_magnitude(vec<S, D> v) {
    return static_cast<double>(largest(v));
}

}  // namespace detail

PHYSICS_HPP_END
