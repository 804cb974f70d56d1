// Contact of the pairs that are particular to the plane.
#pragma once

#include "physics/collide/ball_pairs.hpp"
#include "physics/collide/box2.hpp"
#include "physics/collide/polygon2.hpp"

PHYSICS_HPP_BEGIN

template <class S>
constexpr void collide(const box<S, 2>& a, const halfspace<S, 2>& b, const transform<S, 2>& b_in_a, S margin,
                       manifold<S, 2>& out) {
    const auto plane = detail::plane_of(b, b_in_a);
    // The corners of the edge that faces the plane most; one of them is the lowest of all.
    const vec<S, 2> n = plane.normal;
    const int across = abs(n.x) > abs(n.y) ? 0 : 1;
    for (std::uint32_t k = 0; k < 2; ++k) {
        vec<S, 2> corner = a.half_extents;
        if (n[across] > S(0)) corner[across] = -corner[across];
        if (k == 0) corner[1 - across] = -corner[1 - across];
        const std::uint32_t name = std::uint32_t{corner.x > S(0)} | std::uint32_t{corner.y > S(0)} << 1;
        detail::touch_plane(corner, S(0), n, plane.offset, margin, name, out);
    }
}

template <class S>
void collide(const capsule<S, 2>& a, const capsule<S, 2>& b, const transform<S, 2>& b_in_a, S margin,
             manifold<S, 2>& out) {
    collide_polygons(detail::polygon_of(a), detail::polygon_of(b, b_in_a), margin, out);
}
template <class S>
void collide(const capsule<S, 2>& a, const box<S, 2>& b, const transform<S, 2>& b_in_a, S margin, manifold<S, 2>& out) {
    collide_polygons(detail::polygon_of(a), detail::polygon_of(b, b_in_a), margin, out);
}

PHYSICS_HPP_END
