// Four of many contact points that span what all of them hold.
#pragma once

#include "physics/collide/manifold.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Adds up to four of the candidates to the manifold: the deepest, the farthest beside it, then the points
/// that open the widest triangles on either side. Depth counts before distance, so that no overlap is left
/// without a point near it.
template <class S>
constexpr void reduce(const manifold_point<S, 3>* candidates, int count, vec<S, 3> normal, manifold<S, 3>& out) {
    if (count <= manifold<S, 3>::capacity) {
        for (int i = 0; i < count; ++i) out.points[out.count++] = candidates[i];
        return;
    }
    bool taken[8] = {};
    const auto take_best = [&](auto&& score) {
        int best = -1;
        S highest{};
        for (int i = 0; i < count; ++i) {
            if (taken[i]) continue;
            const S s = score(candidates[i]);
            if (best < 0 || s > highest) best = i, highest = s;
        }
        taken[best] = true;
        out.points[out.count++] = candidates[best];
        return candidates[best].position;
    };
    const vec<S, 3> a = take_best([](const auto& p) { return -p.separation; });
    const vec<S, 3> b = take_best([&](const auto& p) {
        const vec<S, 3> lateral = cross(normal, p.position - a);
        return dot(lateral, lateral);
    });
    const vec<S, 3> across = cross(normal, b - a);
    const vec<S, 3> c = take_best([&](const auto& p) { return abs(dot(p.position - a, across)); });
    const bool left = dot(c - a, across) > S(0);
    take_best([&](const auto& p) {
        const S beyond = dot(p.position - a, across);
        return left ? -beyond : beyond;
    });
}

}  // namespace detail

PHYSICS_HPP_END
