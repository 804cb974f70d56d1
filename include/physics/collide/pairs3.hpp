// Contact of the pairs that are particular to space.
#pragma once

#include "physics/collide/capsule3.hpp"
#include "physics/collide/round.hpp"

PHYSICS_HPP_BEGIN

template <class S>
constexpr void collide(const box<S, 3>& a, const halfspace<S, 3>& b, const transform<S, 3>& b_in_a, S margin, manifold<S, 3>& out) {
    const auto plane = detail::plane_of(b, b_in_a);
    out.normal = -plane.normal;
    manifold_point<S, 3> candidates[8];
    int count = 0;
    for (std::uint32_t i = 0; i < 8; ++i) {
        const vec<S, 3> h = a.half_extents;
        const vec<S, 3> corner{i & 1u ? h.x : -h.x, i & 2u ? h.y : -h.y, i & 4u ? h.z : -h.z};
        const S gap = dot(plane.normal, corner) - plane.offset;
        if (gap > margin) continue;
        candidates[count++] = {corner - plane.normal * (gap * S(0.5)), gap, i};
    }
    detail::reduce(candidates, count, plane.normal, out);
}

PHYSICS_HPP_END
