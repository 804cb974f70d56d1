// Four of many contact points that span what all of them hold.
#pragma once

#include "physics/collide/manifold.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Adds up to four of the candidates to the manifold: the deepest, the farthest beside it, then the points
/// that open the widest triangles on either side. Depth counts before distance, so that no overlap is left
/// without a point near it. Among candidates that are alike, depths within `slack` and distances within a
/// few percent, the first wins: rounding would choose others in each step.
template <class S>
constexpr void reduce(const manifold_point<S, 3>* candidates, int count, vec<S, 3> normal, S slack,
                      manifold<S, 3>& out) {
    if (count <= manifold<S, 3>::capacity) {
        for (int i = 0; i < count; ++i) out.points[out.count++] = candidates[i];
        return;
    }
    bool taken[8] = {};
    const auto take_best = [&](auto&& score, auto&& clearly) {
        int best = -1;
        S highest{};
        for (int i = 0; i < count; ++i) {
            if (taken[i]) continue;
            const S s = score(candidates[i]);
            if (best < 0 || clearly(s, highest)) best = i, highest = s;
        }
        taken[best] = true;
        out.points[out.count++] = candidates[best];
        return candidates[best].position;
    };
    const auto deeper = [&](S s, S highest) { return s > highest + slack; };
    const auto wider = [](S s, S highest) { return s > highest + abs(highest) * S(1.0 / 32); };
    const vec<S, 3> a = take_best([](const auto& p) { return -p.separation; }, deeper);
    const vec<S, 3> b = take_best([&](const auto& p) { return length(cross(normal, p.position - a)); }, wider);
    const vec<S, 3> across = normalized(cross(normal, b - a));
    const vec<S, 3> c = take_best([&](const auto& p) { return abs(dot(p.position - a, across)); }, wider);
    const bool left = dot(c - a, across) > S(0);
    take_best(
        [&](const auto& p) {
            const S beyond = dot(p.position - a, across);
            return left ? -beyond : beyond;
        },
        wider);
}

}  // namespace detail

PHYSICS_HPP_END
