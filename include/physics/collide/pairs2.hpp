// Contact of the pairs that are particular to the plane.
#pragma once

#include "physics/collide/polygon2.hpp"
#include "physics/collide/round.hpp"

PHYSICS_HPP_BEGIN

template <class S>
constexpr void collide(const box<S, 2>& a, const halfspace<S, 2>& b, const transform<S, 2>& b_in_a, S margin, manifold<S, 2>& out) {
    const auto plane = detail::plane_of(b, b_in_a);
    // The two lowest corners share the edge that rises least.
    const vec<S, 2> h = a.half_extents, n = plane.normal;
    const bool along_x = abs(n.x) * h.x <= abs(n.y) * h.y;
    const vec<S, 2> side = along_x ? vec<S, 2>{S(0), n.y > S(0) ? -h.y : h.y} : vec<S, 2>{n.x > S(0) ? -h.x : h.x, S(0)};
    const vec<S, 2> half = along_x ? vec<S, 2>{h.x, S(0)} : vec<S, 2>{S(0), h.y};
    const std::uint32_t edge = (along_x ? 2u : 0u) | (side.x + side.y > S(0) ? 4u : 0u);
    detail::touch_plane(side - half, S(0), n, plane.offset, margin, edge, out);
    detail::touch_plane(side + half, S(0), n, plane.offset, margin, edge | 1u, out);
}

template <class S>
constexpr void collide(const capsule<S, 2>& a, const capsule<S, 2>& b, const transform<S, 2>& b_in_a, S margin, manifold<S, 2>& out) {
    collide_polygons(detail::polygon_of(a, {}), detail::polygon_of(b, b_in_a), margin, out);
}
template <class S>
constexpr void collide(const capsule<S, 2>& a, const box<S, 2>& b, const transform<S, 2>& b_in_a, S margin, manifold<S, 2>& out) {
    collide_polygons(detail::polygon_of(a, {}), detail::polygon_of(b, b_in_a), margin, out);
}
template <class S>
constexpr void collide(const box<S, 2>& a, const box<S, 2>& b, const transform<S, 2>& b_in_a, S margin, manifold<S, 2>& out) {
    collide_polygons(detail::polygon_of(a, {}), detail::polygon_of(b, b_in_a), margin, out);
}

PHYSICS_HPP_END
