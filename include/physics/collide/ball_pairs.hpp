// Contact of the pairs that read alike in 2D and in 3D: balls, and round shapes on a halfspace.
#pragma once

#include "physics/collide/manifold.hpp"
#include "physics/shape/shapes.hpp"

PHYSICS_HPP_BEGIN

// collide(a, b, b_in_a, margin, out) fills `out`, which must be empty, with the contact of a and b, in a's
// frame, if the shapes are within `margin` (m) of each other. Pairs come in the order ball, capsule, box,
// halfspace. No shape is refused here: the world has checked them.

template <class S, int D>
constexpr void collide(const ball<S, D>& a, const ball<S, D>& b, const transform<S, D>& b_in_a, S margin,
                       manifold<S, D>& out) {
    vec<S, D> up;
    up.y = S(1);
    collide_round(vec<S, D>{}, a.radius, b_in_a.position, b.radius, up, margin, 0u, out);
}

namespace detail {
/// A ball against a box that may be flat and rounded: all points within radius_b of |p_i| <= half_i.
template <class S, int D>
constexpr void collide_ball(S radius_a, vec<S, D> half, S radius_b, const transform<S, D>& b_in_a, S margin,
                            manifold<S, D>& out) {
    // In the box's frame, where the components of the normal along a face are exactly zero.
    const vec<S, D> center = inverse_transform(b_in_a, vec<S, D>{});
    const vec<S, D> nearest = max(-half, min(half, center));
    auto [direction, gap] = direction_and_length_of(nearest - center);
    if (gap > radius_a + radius_b + margin) return;
    std::uint32_t feature = 0;
    if (!(gap > S(0))) {
        int axis = 0;
        for (int i = 1; i < D; ++i)
            if (half[i] - abs(center[i]) < half[axis] - abs(center[axis])) axis = i;
        const bool below = center[axis] < S(0);
        direction[axis] = S(below ? 1 : -1);
        gap = abs(center[axis]) - half[axis];
        feature = static_cast<std::uint32_t>(1 + 2 * axis + int{below});
    }
    out.normal = b_in_a.rotation * direction;
    add_rounded(out, vec<S, D>{}, radius_a, out.normal * gap, radius_b, gap, feature);
}
}  // namespace detail

template <class S, int D>
constexpr void collide(const ball<S, D>& a, const capsule<S, D>& b, const transform<S, D>& b_in_a, S margin,
                       manifold<S, D>& out) {
    detail::collide_ball(a.radius, detail::along_x<S, D>(b.half_length), b.radius, b_in_a, margin, out);
}

template <class S, int D>
constexpr void collide(const ball<S, D>& a, const box<S, D>& b, const transform<S, D>& b_in_a, S margin,
                       manifold<S, D>& out) {
    detail::collide_ball(a.radius, b.half_extents, S(0), b_in_a, margin, out);
}

namespace detail {
/// Adds the contact of a core point p of A (with radius) and the halfspace B, both in A's frame.
template <class S, int D>
constexpr void touch_plane(vec<S, D> p, S radius, vec<S, D> normal, S offset, S margin, std::uint32_t feature,
                           manifold<S, D>& out) {
    const S gap = dot(normal, p) - offset;
    if (gap - radius > margin) return;
    out.normal = -normal;
    add_rounded(out, p, radius, p - normal * gap, S(0), gap, feature);
}
/// The plane of a halfspace in A's frame: its normal and offset.
template <class S, int D>
struct plane {
    vec<S, D> normal;
    S offset;
};
template <class S, int D>
constexpr plane<S, D> plane_of(const halfspace<S, D>& h, const transform<S, D>& at) {
    const vec<S, D> n = at.rotation * unit_normal(h);
    return {n, h.offset + dot(n, at.position)};
}
}  // namespace detail

template <class S, int D>
constexpr void collide(const ball<S, D>& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a, S margin,
                       manifold<S, D>& out) {
    const auto plane = detail::plane_of(b, b_in_a);
    detail::touch_plane(vec<S, D>{}, a.radius, plane.normal, plane.offset, margin, 0u, out);
}

template <class S, int D>
constexpr void collide(const capsule<S, D>& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a, S margin,
                       manifold<S, D>& out) {
    const auto plane = detail::plane_of(b, b_in_a);
    const vec<S, D> x = detail::along_x<S, D>(a.half_length);
    detail::touch_plane(-x, a.radius, plane.normal, plane.offset, margin, 0u, out);
    detail::touch_plane(x, a.radius, plane.normal, plane.offset, margin, 1u, out);
}

/// Halfspaces carry no mass, so two of them never push each other.
template <class S, int D>
constexpr void collide(const halfspace<S, D>&, const halfspace<S, D>&, const transform<S, D>&, S, manifold<S, D>&) {}

PHYSICS_HPP_END
