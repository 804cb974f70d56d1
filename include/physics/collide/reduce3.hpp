// Four of many contact points that span what all of them hold.
#pragma once

#include "physics/collide/manifold.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The most points that reduce() chooses from.
inline constexpr int most_candidates = 72;

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
    bool taken[most_candidates] = {};
    const auto take = [&](int i) {
        taken[i] = true;
        out.points[out.count++] = candidates[i];
        return candidates[i].position;
    };
    const auto widest = [&](auto&& score, auto&& allowed) {
        int best = -1;
        S highest{};
        for (int i = 0; i < count; ++i) {
            if (taken[i] || !allowed(candidates[i])) continue;
            const S s = score(candidates[i]);
            if (best < 0 || s > highest + abs(highest) * S(1.0 / 32)) best = i, highest = s;
        }
        return best;
    };
    const auto any = [](const auto&) { return true; };
    const auto distance_from = [&](vec<S, 3> from) {
        return [&normal, from](const auto& p) {
            const vec<S, 3> beside = cross(normal, p.position - from);
            return dot(beside, beside);
        };
    };
    // The first is one of the deepest; of those that are alike the one farthest out.
    int deepest = 0;
    vec<S, 3> sum = candidates[0].position;
    for (int i = 1; i < count; ++i) {
        sum += candidates[i].position;
        if (candidates[i].separation < candidates[deepest].separation - slack) deepest = i;
    }
    const S most = candidates[deepest].separation + slack;
    const auto deep = [&](const auto& p) { return !(p.separation > most); };
    const vec<S, 3> a = take(widest(distance_from(sum / S(count)), deep));
    const vec<S, 3> b = take(widest(distance_from(a), any));
    const vec<S, 3> across = cross(normal, b - a);
    const vec<S, 3> c = take(widest([&](const auto& p) { return abs(dot(p.position - a, across)); }, any));
    const bool left = dot(c - a, across) > S(0);
    take(widest(
        [&](const auto& p) {
            const S beyond = dot(p.position - a, across);
            return left ? -beyond : beyond;
        },
        any));
}

}  // namespace detail

PHYSICS_HPP_END
