// Axis-aligned bounding boxes.
#pragma once

#include "physics/space/vec.hpp"

PHYSICS_HPP_BEGIN

/// An axis-aligned box from its lower to its upper corner; both belong to it.
template <class S, int D>
struct aabb {
    vec<S, D> lower;
    vec<S, D> upper;

    friend bool operator==(const aabb&, const aabb&) = default;
};

/// True if both corners are finite and none is on the wrong side of the other.
template <class S, int D>
constexpr bool is_box(const aabb<S, D>& a) {
    for (int i = 0; i < D; ++i)
        if (!(a.lower[i] <= a.upper[i])) return false;
    return is_finite(a.lower) && is_finite(a.upper);
}
/// True if the boxes share a point.
template <class S, int D>
constexpr bool overlap(const aabb<S, D>& a, const aabb<S, D>& b) {
    for (int i = 0; i < D; ++i)
        if (a.lower[i] > b.upper[i] || b.lower[i] > a.upper[i]) return false;
    return true;
}
/// True if a contains all of b.
template <class S, int D>
constexpr bool contains(const aabb<S, D>& a, const aabb<S, D>& b) {
    for (int i = 0; i < D; ++i)
        if (b.lower[i] < a.lower[i] || b.upper[i] > a.upper[i]) return false;
    return true;
}
/// The smallest box around both.
template <class S, int D>
constexpr aabb<S, D> merged(const aabb<S, D>& a, const aabb<S, D>& b) {
    return {min(a.lower, b.lower), max(a.upper, b.upper)};
}
/// The box, grown by a margin on every side.
template <class S, int D>
constexpr aabb<S, D> grown(const aabb<S, D>& a, S margin) {
    const vec<S, D> m = vec<S, D>::filled(margin);
    return {a.lower - m, a.upper + m};
}

PHYSICS_HPP_END
