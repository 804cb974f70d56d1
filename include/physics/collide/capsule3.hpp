// Contact of capsules with capsules and boxes in space.
#pragma once

#include "physics/collide/box3.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The part of the segment from-to, as parameters in [0, 1], that lies between the planes dot(n, p) = low
/// and dot(n, p) = high; false if there is none.
template <class S>
constexpr bool clip_segment(vec<S, 3> from, vec<S, 3> to, vec<S, 3> n, S low, S high, S& start, S& stop) {
    const S a = dot(n, from), d = dot(n, to) - a;
    if (d == S(0)) return !(a < low) && !(a > high);
    S first = (low - a) / d, second = (high - a) / d;
    if (first > second) std::swap(first, second);
    start = max(start, first);
    stop = min(stop, second);
    return !(start > stop);
}

/// The parameter of the point of the segment from-to that is closest to the box |p_i| <= half_i. The
/// squared distance is convex and its slope piecewise linear, with a knee where a coordinate meets a face:
/// the root lies between two neighbouring knees and is found there exactly.
template <class S>
constexpr S closest_parameter_to_box(vec<S, 3> from, vec<S, 3> to, vec<S, 3> half) {
    const vec<S, 3> d = to - from;
    S knees[8] = {S(0), S(1)};
    int count = 2;
    for (int i = 0; i < 3; ++i) {
        if (d[i] == S(0)) continue;
        const S ends[2] = {-half[i] - from[i], half[i] - from[i]};
        for (const S end : ends) {
            // Compared before the division, which could leave a fixed-point range.
            const bool within = d[i] > S(0) ? end > S(0) && end < d[i] : end < S(0) && end > d[i];
            if (within) knees[count++] = end / d[i];
        }
    }
    for (int i = 1; i < count; ++i)
        for (int j = i; j > 0 && knees[j] < knees[j - 1]; --j) std::swap(knees[j], knees[j - 1]);
    const auto slope = [&](S t) {
        const vec<S, 3> p = from + d * t;
        const vec<S, 3> beyond = p - max(-half, min(half, p));
        return dot(beyond, d);
    };
    S at = S(0), slope_at = slope(S(0));
    if (!(slope_at < S(0))) {
        // Within the box the slope is zero: take the middle of the flat part.
        S end = S(0);
        for (int i = 1; i < count && slope_at == S(0) && slope(knees[i]) == S(0); ++i) end = knees[i];
        return end * S(0.5);
    }
    for (int i = 1; i < count; ++i) {
        const S next = slope(knees[i]);
        if (next > S(0)) return at + (knees[i] - at) * (slope_at / (slope_at - next));
        if (next == S(0)) {
            S end = knees[i];
            for (int j = i + 1; j < count && slope(knees[j]) == S(0); ++j) end = knees[j];
            return (knees[i] + end) * S(0.5);
        }
        at = knees[i];
        slope_at = next;
    }
    return S(1);
}

}  // namespace detail

/// Two capsules: one point between the axes, or two where the axes are parallel within three degrees.
template <class S>
constexpr void collide(const capsule<S, 3>& a, const capsule<S, 3>& b, const transform<S, 3>& b_in_a, S margin,
                       manifold<S, 3>& out) {
    const vec<S, 3> xa{a.half_length, S(0), S(0)};
    const vec<S, 3> xb = b_in_a.rotation * vec<S, 3>{b.half_length, S(0), S(0)};
    const vec<S, 3> b0 = b_in_a.position - xb, b1 = b_in_a.position + xb;
    const auto closest = closest_points(-xa, xa, b0, b1);
    const auto [direction, gap] = split(closest.on_b - closest.on_a);
    if (gap > a.radius + b.radius + margin) return;
    const vec<S, 3> across = cross(vec<S, 3>{S(1), S(0), S(0)}, xb / b.half_length);
    const bool parallel = largest(across) < S(0.05);
    out.normal = gap > S(0) ? direction : parallel ? vec<S, 3>{S(0), S(1), S(0)} : normalized(across);
    if (parallel && abs(out.normal.x) < S(0.1)) {
        S start = S(0), stop = S(1);
        if (detail::clip_segment(b0, b1, vec<S, 3>{S(1), S(0), S(0)}, -a.half_length, a.half_length, start, stop) &&
            stop > start) {
            const S ends[2] = {start, stop};
            for (int k = 0; k < 2; ++k) {
                const vec<S, 3> on_b = b0 + (b1 - b0) * ends[k];
                const vec<S, 3> on_a{on_b.x, S(0), S(0)};
                const S local = dot(out.normal, on_b - on_a);
                if (local - a.radius - b.radius > margin) continue;
                add_rounded(out, on_a, a.radius, on_b, b.radius, local, static_cast<std::uint32_t>(1 + k));
            }
            if (out.count > 0) return;
        }
    }
    add_rounded(out, closest.on_a, a.radius, closest.on_b, b.radius, gap, 0u);
}

/// A capsule and a box: the closest points where the axis is outside of the box, the axis of least overlap
/// where it is not; two points where the capsule lies on a face.
template <class S>
constexpr void collide(const capsule<S, 3>& a, const box<S, 3>& b, const transform<S, 3>& b_in_a, S margin,
                       manifold<S, 3>& out) {
    // In the box's frame, with the normal from the box to the capsule until the end.
    const transform<S, 3> a_in_b = inverse(b_in_a);
    const vec<S, 3> h = b.half_extents, x = a_in_b.rotation * vec<S, 3>{a.half_length, S(0), S(0)};
    const vec<S, 3> from = a_in_b.position - x, to = a_in_b.position + x, middle = a_in_b.position;
    const S t = detail::closest_parameter_to_box(from, to, h);
    const vec<S, 3> on_axis = from + (to - from) * t;
    const vec<S, 3> on_box = max(-h, min(h, on_axis));
    const auto [direction, distance] = split(on_axis - on_box);
    if (distance > a.radius + margin) return;

    vec<S, 3> n = direction;
    S gap = distance;
    vec<S, 3> lowest = on_axis;
    if (!(distance > S(0))) {
        for (int i = 0; i < 3; ++i) {
            const S overlap_i = abs(middle[i]) - h[i] - abs(x[i]);
            if (i > 0 && !(overlap_i > gap)) continue;
            gap = overlap_i;
            n = {};
            n[i] = middle[i] < S(0) ? S(-1) : S(1);
        }
        const vec<S, 3> axis = x / a.half_length;
        for (int i = 0; i < 3; ++i) {
            vec<S, 3> e;
            e[i] = S(1);
            const vec<S, 3> across = cross(e, axis);
            const S size = length(across);
            if (size < S(1.0 / 1024)) continue;
            const vec<S, 3> candidate = across / size;
            const S along = dot(candidate, middle);
            const S overlap_i = abs(along) - dot(abs(candidate), h);
            if (!(overlap_i > gap + min(h.x, min(h.y, h.z)) * S(1.0 / 256))) continue;
            gap = overlap_i;
            n = along < S(0) ? -candidate : candidate;
        }
        lowest = dot(n, x) > S(0) ? from : to;
    }

    const auto add = [&](vec<S, 3> core, S local, std::uint32_t feature) {
        if (local - a.radius > margin) return;
        const vec<S, 3> on_surface = core - n * local;
        out.add(b_in_a * ((on_surface + core - n * a.radius) * S(0.5)), local - a.radius, feature);
    };
    out.normal = -(b_in_a.rotation * n);
    int face = 0;
    for (int i = 1; i < 3; ++i)
        if (abs(n[i]) > abs(n[face])) face = i;
    // On a face, within three degrees: both ends of the part above the face.
    if (abs(n[face]) > S(0.9986) && abs(dot(n, x)) < a.half_length * S(0.05)) {
        S start = S(0), stop = S(1);
        bool above = true;
        for (int i = 0; i < 3 && above; ++i) {
            vec<S, 3> e;
            e[i] = S(1);
            if (i != face) above = detail::clip_segment(from, to, e, -h[i], h[i], start, stop);
        }
        if (above && stop > start) {
            const S ends[2] = {start, stop};
            for (int k = 0; k < 2; ++k) {
                const vec<S, 3> core = from + (to - from) * ends[k];
                add(core, dot(n, core) - abs(n[face]) * h[face], static_cast<std::uint32_t>(face << 2 | 2 | k));
            }
            if (out.count > 0) return;
        }
    }
    add(lowest, gap, static_cast<std::uint32_t>(face << 2));
}

PHYSICS_HPP_END
