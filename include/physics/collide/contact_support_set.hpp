// As many of many contact points as hold a body where the ground under it is not flat.
#pragma once

#include "physics/base/raw_array.hpp"
#include "physics/collide/gjk.hpp"
#include "physics/collide/reduce2.hpp"
#include "physics/collide/reduce3.hpp"
#include "physics/shape/core.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A set of contact points that supports a body: points that lie above the lines and triangles between kept points are
/// implied by them and dropped, since no rotation makes them overlap while the kept ones do not.
template <int D>
struct contact_support_set {
    static constexpr int capacity = 8;

    /// A point across the normal, and its separation.
    struct spot {
        point<D> at;
        double height;
    };

    point<D> normal;
    /// What deviation is small, of heights and of places (m): two parts that meet both have points where they do.
    double slack, reach;
    raw_array<spot, capacity> kept;
    int count = 0;

    contact_support_set(const point<D>& n, double small) : normal(n), slack(small), reach(4 * small) {}

    template <class S>
    [[nodiscard]] spot seen(const manifold_point<S, D>& p) const {
        const point<D> at = to_point(p.position);
        return {at - normal * dot(normal, at), static_cast<double>(p.separation)};
    }
    /// Calls f(place) for the lines and triangles that end in the last of the kept points until it returns true; that
    /// is called with a point, and tells whether it is between the ends, and how high above.
    template <class F>
    bool any_with_last(F&& f) const {
        const spot& last = kept[count - 1];
        for (int i = 0; i + 1 < count; ++i) {
            if (f([&](const spot& p) { return over(kept[i], last, p); })) return true;
            if constexpr (D == 3)
                for (int k = 0; k < i; ++k)
                    if (f([&](const spot& p) { return over(kept[k], kept[i], last, p); })) return true;
        }
        return false;
    }

private:
    struct place {
        bool between;
        double above;
    };

    [[nodiscard]] place over(const spot& a, const spot& b, const spot& p) const {
        const point<D> segment = b.at - a.at, from = p.at - a.at;
        const double square = dot(segment, segment);
        if (!(square > 0)) return {false, no_limit};
        const double share = dot(from, segment) / square, beyond = max(-share, share - 1);
        const point<D> aside = from - segment * share;
        if (dot(aside, aside) > reach * reach) return {false, no_limit};
        return {beyond <= 0 || beyond * beyond * square <= reach * reach,
                p.height - a.height - (b.height - a.height) * share};
    }
    [[nodiscard]] place over(const spot& a, const spot& b, const spot& c, const spot& p) const requires(D == 3) {
        const point<3> e = b.at - a.at, f = c.at - a.at, from = p.at - a.at;
        const double area = dot(normal, cross(e, f));
        // The plane of a needle is anywhere.
        if (!(area * area > 1e-4 * dot(e, e) * dot(f, f))) return {false, no_limit};
        const double of_b = dot(normal, cross(from, f)) / area, of_c = dot(normal, cross(e, from)) / area;
        return {min(min(of_b, of_c), 1 - of_b - of_c) > -1e-6,
                p.height - a.height - of_b * (b.height - a.height) - of_c * (c.height - a.height)};
    }
};

/// Leaves as many of the points as hold what all do, and tells how many. On flat ground those that reduce() chooses do;
/// elsewhere, while the kept ones do not imply all others, the deepest that is left joins them. On ridges and bumps a
/// body that lost a point would drop there until that is the deepest one and another one is lost: it would tremble
/// without end. Cost: O(count) for each of up to 84 lines and triangles, 10 on flat ground.
template <class S, int D>
int keep_supports(manifold_point<S, D>* points, int count, vec<S, D> normal, S slack) {
    using spot = typename contact_support_set<D>::spot;
    contact_support_set<D> set(to_point(normal), static_cast<double>(slack));
    manifold_point<S, D> kept[contact_support_set<D>::capacity];
    raw_array<spot, max_candidates> spots;
    for (int i = 0; i < count; ++i) spots[i] = set.seen(points[i]);
    manifold<S, D> chosen;
    reduce(points, count, normal, slack, chosen);
    bool flat = chosen.count == 1;
    for (int k = 0; k < chosen.count; ++k) {
        kept[k] = chosen.points[k];
        set.kept[set.count++] = set.seen(kept[k]);
        flat = flat || set.any_with_last([&](const auto& over) {
            for (int i = 0; i < count; ++i)
                if (abs(over(spots[i]).above) > set.slack) return false;
            return true;
        });
    }
    int left = flat ? 0 : count;
    const auto drop_implied = [&] {
        const int before = left;
        left = 0;
        for (int i = 0; i < before; ++i) {
            const bool implied = set.any_with_last([&](const auto& over) {
                const auto at = over(spots[i]);
                return at.between && at.above >= -set.slack;
            });
            if (implied) continue;
            spots[left] = spots[i];
            points[left++] = points[i];
        }
    };
    for (set.count = 1; set.count < chosen.count;) {
        ++set.count;
        drop_implied();
    }
    while (left > 0 && set.count < contact_support_set<D>::capacity) {
        double low = spots[0].height;
        for (int i = 1; i < left; ++i) low = min(low, spots[i].height);
        // Of those that are alike the one farthest from the one before: ends imply what is between them.
        int deepest = -1;
        double maximum = 0;
        for (int i = 0; i < left; ++i) {
            const double far = length(spots[i].at - set.kept[set.count - 1].at);
            if (spots[i].height > low + set.slack || (deepest >= 0 && !(far > maximum + set.reach))) continue;
            deepest = i;
            maximum = far;
        }
        kept[set.count] = points[deepest];
        set.kept[set.count++] = spots[deepest];
        drop_implied();
    }
    for (int k = 0; k < set.count; ++k) points[k] = kept[k];
    return set.count;
}

}  // namespace detail

PHYSICS_HPP_END
