// Two of many contact points that span what all of them hold.
#pragma once

#include "physics/collide/manifold.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Adds up to two of the candidates to the manifold: the deepest, and the farthest beside it. Among candidates that
/// are alike, within `slack`, the first wins: rounding would choose others in each step.
template <class S>
constexpr void reduce(const manifold_point<S, 2>* candidates, int count, vec<S, 2> normal, S slack,
                      manifold<S, 2>& out) {
    if (count == 0) return;
    int deepest = 0, farthest = 0;
    for (int i = 1; i < count; ++i)
        if (candidates[i].separation < candidates[deepest].separation - slack) deepest = i;
    const vec<S, 2> along = perpendicular(normal);
    const auto apart = [&](int i) { return abs(dot(along, candidates[i].position - candidates[deepest].position)); };
    for (int i = 0; i < count; ++i)
        if (apart(i) > apart(farthest) + slack) farthest = i;
    out.points[out.count++] = candidates[deepest];
    if (farthest != deepest && apart(farthest) > slack) out.points[out.count++] = candidates[farthest];
}

}  // namespace detail

PHYSICS_HPP_END
