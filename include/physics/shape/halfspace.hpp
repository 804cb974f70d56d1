// The halfspace: endless ground or wall.
#pragma once

#include "physics/shape/concept.hpp"

PHYSICS_HPP_BEGIN

/// All points p with dot(normal, p) <= offset (m) in the shape's frame; normal is a unit vector, four digits
/// of it suffice. It has no mass, so it serves static and kinematic bodies.
template <class S, int D>
struct halfspace {
    using scalar = S;
    vec<S, D> normal = upward();
    S offset = S(0);

    template <class T>
    [[nodiscard]] constexpr halfspace<T, D> as() const {
        halfspace<T, D> result;
        for (int i = 0; i < D; ++i) result.normal[i] = static_cast<T>(normal[i]);
        result.offset = static_cast<T>(offset);
        return result;
    }

private:
    static constexpr vec<S, D> upward() {
        vec<S, D> up;
        up.y = S(1);
        return up;
    }
};

namespace detail {

template <class Shape>
constexpr bool is_halfspace = false;
template <class S, int D>
constexpr bool is_halfspace<halfspace<S, D>> = true;

}  // namespace detail

template <class S, int D>
bool check(const halfspace<S, D>& h, const char* function) {
    if (!detail::check_finite(function, "normal", h.normal) || !detail::check_finite(function, "offset", h.offset))
        return false;
    const S l = length(h.normal);
    if (abs(l - S(1)) > S(64) * scalar_traits<S>::epsilon() + S(1e-4))
        return detail::refuse(function, "length of normal", static_cast<double>(l), "it must be 1");
    return true;
}
namespace detail {
/// The normal with length 1: two Newton steps bring the error that check() admits below rounding.
template <class S, int D>
constexpr vec<S, D> unit_normal(const halfspace<S, D>& h) {
    const vec<S, D> n = h.normal * length_repair(dot(h.normal, h.normal));
    return n * length_repair(dot(n, n));
}
}  // namespace detail
/// Endless in most directions: a quarter of the scalar's range stands for infinity, in double of 1e75, so that margins
/// do not leave it.
template <class S, int D>
constexpr aabb<S, D> bounds(const halfspace<S, D>& h, const transform<S, D>& at) {
    S far = scalar_traits<S>::max() * S(0.25);
    if (!detail::is_bounded(far)) far = static_cast<S>(detail::largest_of_double * 0.25);
    aabb<S, D> box{vec<S, D>::filled(-far), vec<S, D>::filled(far)};
    const vec<S, D> n = at.rotation * detail::unit_normal(h);
    const S height = h.offset + dot(n, at.position);
    for (int i = 0; i < D; ++i) {
        bool aligned = true;
        for (int j = 0; j < D; ++j) aligned = aligned && (i == j || n[j] == S(0));
        // A surface beyond the range is no box: worlds refuse it.
        const bool is_lost = !detail::is_bounded(height);
        if (is_lost || (aligned && n[i] > S(0))) box.upper[i] = height;
        if (aligned && n[i] < S(0)) box.lower[i] = -height;
    }
    return box;
}

PHYSICS_HPP_END
