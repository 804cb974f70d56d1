// Contact of the pairs that are particular to space.
#pragma once

#include "physics/collide/ball_pairs.hpp"
#include "physics/collide/capsule3.hpp"

PHYSICS_HPP_BEGIN

template <class S>
constexpr void collide(const box<S, 3>& a, const halfspace<S, 3>& b, const transform<S, 3>& b_in_a, S margin,
                       manifold<S, 3>& out) {
    const auto plane = detail::plane_of(b, b_in_a);
    // The corners of the face that faces the plane most; one of them is the lowest of all.
    const vec<S, 3> n = plane.normal;
    int across = 0;
    for (int i = 1; i < 3; ++i)
        if (abs(n[i]) > abs(n[across])) across = i;
    for (std::uint32_t name = 0; name < 8; ++name) {
        if ((name >> across & 1u) == std::uint32_t{n[across] > S(0)}) continue;
        vec<S, 3> corner = a.half_extents;
        for (int i = 0; i < 3; ++i)
            if ((name >> i & 1u) == 0) corner[i] = -corner[i];
        detail::touch_plane(corner, S(0), n, plane.offset, margin, name, out);
    }
}

PHYSICS_HPP_END
