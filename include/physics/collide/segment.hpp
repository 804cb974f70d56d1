// Closest points on segments.
#pragma once

#include "physics/space/vec.hpp"

PHYSICS_HPP_BEGIN

/// Where the point of the segment a-b closest to p lies: 0 at a, 1 at b. Source: Ericson, Real-Time
/// Collision Detection, 5.1.2.
template <class S, int D>
constexpr S closest_parameter(vec<S, D> a, vec<S, D> b, vec<S, D> p) {
    const vec<S, D> d = b - a;
    const wide_of<S> along = wide_dot(p - a, d);
    const wide_of<S> whole = length_squared(d);
    if (!(along > wide_of<S>{})) return S(0);
    if (!(along < whole)) return S(1);
    return quotient<S>(along, whole);
}

/// Closest points of two segments.
template <class S, int D>
struct segment_pair {
    vec<S, D> on_a;
    vec<S, D> on_b;
    S at_a{};
    S at_b{};
};

/// The closest points of the segments a0-a1 and b0-b1. For parallel segments one of the pairs that are
/// closest. Source: Ericson, 5.1.9; the clamped parameter is refined once against the other segment.
template <class S, int D>
constexpr segment_pair<S, D> closest_points(vec<S, D> a0, vec<S, D> a1, vec<S, D> b0, vec<S, D> b1) {
    const vec<S, D> da = a1 - a0, db = b1 - b0, r = a0 - b0;
    const S aa = dot(da, da), bb = dot(db, db), ab = dot(da, db);
    const S determinant = difference_of_products(aa, bb, ab, ab);
    S s(0);
    // Of near-parallel segments every s is nearly right; the projections below choose.
    if (determinant > S(32) * scalar_traits<S>::epsilon() * aa * bb)
        s = clamp(difference_of_products(ab, dot(db, r), bb, dot(da, r)) / determinant, S(0), S(1));
    S t = closest_parameter(b0, b1, a0 + da * s);
    s = closest_parameter(a0, a1, b0 + db * t);
    t = closest_parameter(b0, b1, a0 + da * s);
    return {a0 + da * s, b0 + db * t, s, t};
}

PHYSICS_HPP_END
