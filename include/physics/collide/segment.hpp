// Closest points on segments, and segments cut by planes.
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

/// Where on two segments the points lie that are closest to each other, as distances from their middles.
template <class S>
struct segment_parameters {
    S on_a{};
    S on_b{};
};

/// The closest points of the segment |x| <= half_a of the coordinate axis a, and of the segment
/// center + t * b, |t| <= half_b, of unit direction b. For parallel segments one of the pairs that are closest.
/// Seen along the axis this is a point and a line, which keeps its precision where the two are nearly parallel.
template <class S>
constexpr segment_parameters<S> closest_to_axis(int a, S half_a, vec<S, 3> center, vec<S, 3> b, S half_b) {
    vec<S, 3> beside = center, across = b;
    beside[a] = across[a] = S(0);
    const auto [direction, sine] = direction_and_length_of(across);
    const S along = -dot(beside, direction), maximum = half_b * sine;
    S t = !(along < maximum) ? half_b : !(along > -maximum) ? -half_b : along / sine;
    S s = clamp(center[a] + b[a] * t, -half_a, half_a);
    t = clamp(b[a] * s - dot(b, center), -half_b, half_b);
    s = clamp(center[a] + b[a] * t, -half_a, half_a);
    return {s, t};
}

/// Cuts a segment middle + t * direction, start <= t <= stop, seen along one coordinate, down to what lies
/// within |p| <= limit; false if nothing does.
template <class S>
constexpr bool clip_segment(S middle, S direction, S limit, S& start, S& stop) {
    const S sides[2] = {S(-1), S(1)};
    for (const S side : sides) {
        const S at_start = side * (middle + direction * start) - limit,
                at_stop = side * (middle + direction * stop) - limit;
        if (at_start > S(0) && at_stop > S(0)) return false;
        if (at_start > S(0)) start += (stop - start) * (at_start / (at_start - at_stop));
        else if (at_stop > S(0)) stop -= (stop - start) * (at_stop / (at_stop - at_start));
    }
    return true;
}

PHYSICS_HPP_END
