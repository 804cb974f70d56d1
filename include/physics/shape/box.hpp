// The box: a rectangle in 2D, a cuboid in 3D.
#pragma once

#include "physics/shape/concept.hpp"

PHYSICS_HPP_BEGIN

/// All points p with |p_i| <= half_extents_i (m) in the shape's frame.
template <class S, int D>
struct box {
    using scalar = S;
    vec<S, D> half_extents = vec<S, D>::filled(S(0.5));

    template <class T>
    [[nodiscard]] constexpr box<T, D> as() const {
        box<T, D> result;
        for (int i = 0; i < D; ++i) result.half_extents[i] = static_cast<T>(half_extents[i]);
        return result;
    }
};

template <class S, int D>
bool check(const box<S, D>& b, const char* function) {
    constexpr const char* names[] = {"half_extents.x", "half_extents.y", "half_extents.z"};
    for (int i = 0; i < D; ++i)
        if (!detail::check_positive(function, names[i], b.half_extents[i])) return false;
    return true;
}
template <class S, int D>
constexpr aabb<S, D> bounds(const box<S, D>& b, const transform<S, D>& at) {
    const mat<S, D> m = matrix(at.rotation);
    vec<S, D> reach;
    for (int i = 0; i < D; ++i) reach += abs(m.column[i] * b.half_extents[i]);
    return {at.position - reach, at.position + reach};
}
template <class S, int D>
constexpr vec<S, D> support(const box<S, D>& b, vec<S, D> direction) {
    vec<S, D> corner = b.half_extents;
    for (int i = 0; i < D; ++i)
        if (direction[i] < S(0)) corner[i] = -corner[i];
    return corner;
}
template <class S>
constexpr mass_properties<S, 2> mass_of(const box<S, 2>& b, S density) {
    const vec<S, 2> h = b.half_extents;
    const S mass = density * S(4) * h.x * h.y;
    return {mass, {}, mass * (dot(h, h) / S(3))};
}
template <class S>
constexpr mass_properties<S, 3> mass_of(const box<S, 3>& b, S density) {
    const vec<S, 3> h = b.half_extents;
    const S mass = density * S(8) * h.x * h.y * h.z;
    const S xx = h.x * h.x, yy = h.y * h.y, zz = h.z * h.z;
    return {mass,
            {},
            symmetric<S>::diagonal(mass * ((yy + zz) / S(3)), mass * ((xx + zz) / S(3)), mass * ((xx + yy) / S(3)))};
}

PHYSICS_HPP_END
