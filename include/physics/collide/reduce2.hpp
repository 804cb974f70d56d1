// Two of many contact points that span what all of them hold.
#pragma once

#include "physics/collide/manifold.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Adds up to two of the candidates to the manifold: one of the deepest, of those that are alike the one farthest out,
/// and the farthest beside it. Among candidates that are alike, within `slack`, the first wins: rounding would choose
/// others in each step.
template <class S>
constexpr void reduce(const manifold_point<S, 2>* candidates, int count, vec<S, 2> normal, S slack,
                      manifold<S, 2>& out) {
    if (count == 0) return;
    const vec<S, 2> along = perpendicular(normal);
    const auto place = [&](int i) { return dot(along, candidates[i].position - candidates[0].position); };
    S low = S(0), high = S(0), maximum = candidates[0].separation;
    for (int i = 1; i < count; ++i) {
        low = min(low, place(i));
        high = max(high, place(i));
        maximum = min(maximum, candidates[i].separation);
    }
    maximum += slack;
    const S middle = low + (high - low) * S(0.5);
    const auto pick = [&](S from, S deep) {
        int best = -1;
        for (int i = 0; i < count; ++i)
            if (!(candidates[i].separation > deep) &&
                (best < 0 || abs(place(i) - from) > abs(place(best) - from) + slack))
                best = i;
        return best;
    };
    const int deepest = pick(middle, maximum), farthest = pick(place(deepest), scalar_traits<S>::max());
    out.points[out.count++] = candidates[deepest];
    if (abs(place(farthest) - place(deepest)) > slack) out.points[out.count++] = candidates[farthest];
}

}  // namespace detail

PHYSICS_HPP_END
