// Contact of capsules with capsules and boxes in 3D.
#pragma once

#include "physics/collide/box3.hpp"
#include "physics/collide/segment.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A capsule's axis: middle, unit direction and half length.
template <class S>
struct axis_segment {
    vec<S, 3> middle;
    vec<S, 3> direction;
    S half;

    constexpr vec<S, 3> at(S t) const { return middle + direction * t; }
    /// Half of its extent along a direction.
    constexpr S reach(vec<S, 3> n) const { return abs(dot(n, direction)) * half; }
};

/// Where on a segment the point lies that is closest to the box |p_i| <= half_i. The squared distance is convex
/// and its slope piecewise linear, with a knee where a coordinate meets a face: the root lies between two
/// neighbouring knees and is found there exactly. Within a flat stretch, its middle.
template <class S>
constexpr S closest_to_box(const axis_segment<S>& s, vec<S, 3> half) {
    S knees[8] = {-s.half, s.half};
    int count = 2;
    for (int i = 0; i < 3; ++i) {
        const S reach = abs(s.direction[i]) * s.half;
        const S ends[2] = {-half[i] - s.middle[i], half[i] - s.middle[i]};
        for (const S end : ends)
            if (abs(end) < reach) knees[count++] = end / s.direction[i];
    }
    for (int i = 1; i < count; ++i)
        for (int j = i; j > 0 && knees[j] < knees[j - 1]; --j) std::swap(knees[j], knees[j - 1]);
    const auto slope = [&](S t) {
        const vec<S, 3> p = s.at(t);
        return wide_dot(p - max(-half, min(half, p)), s.direction);
    };
    const wide_of<S> zero{};
    S before = knees[0];
    wide_of<S> slope_before = slope(before);
    for (int i = 0; i < count; ++i) {
        const wide_of<S> here = i == 0 ? slope_before : slope(knees[i]);
        if (here > zero) {
            if (i == 0) return knees[0];
            // From the knee where the slope is less, since the other may be far away.
            const wide_of<S> rise = here - slope_before;
            return here + slope_before > zero ? before - (knees[i] - before) * quotient<S>(slope_before, rise)
                                              : knees[i] - (knees[i] - before) * quotient<S>(here, rise);
        }
        if (here == zero) {
            S end = knees[i];
            for (int j = i + 1; j < count && slope(knees[j]) == zero; ++j) end = knees[j];
            return (knees[i] + end) * S(0.5);
        }
        before = knees[i];
        slope_before = here;
    }
    return s.half;
}

/// The direction in which a segment is to be moved out of a box, and what it then leads past.
template <class S>
struct parting {
    vec<S, 3> normal;
    S gap{};
    /// Where on the segment the box is nearest.
    S at{};
};
/// The best separating axis of a segment and the box |p_i| <= half_i, from the box to the segment: the faces,
/// then the edges across the segment, which have to be better by `slack`.
template <class S>
constexpr parting<S> part_from_box(const axis_segment<S>& s, vec<S, 3> half, S slack) {
    parting<S> best;
    for (int i = 0; i < 3; ++i) {
        const S gap = abs(s.middle[i]) - half[i] - abs(s.direction[i]) * s.half;
        if (i > 0 && !(gap > best.gap)) continue;
        best.gap = gap;
        best.normal = {};
        best.normal[i] = s.middle[i] < S(0) ? S(-1) : S(1);
        best.at = dot(best.normal, s.direction) > S(0) ? -s.half : s.half;
    }
    const S best_face = best.gap;
    for (int i = 0; i < 3; ++i) {
        vec<S, 3> e;
        e[i] = S(1);
        const auto [n, sine] = direction_and_length_of(cross(e, s.direction));
        // An edge so nearly parallel to the segment that a face says the same.
        if (sine * (half[i] + s.half) < slack) continue;
        const S along = dot(n, s.middle);
        const S gap = abs(along) - dot(abs(n), half);
        if (!(gap > best.gap) || !(gap > best_face + slack)) continue;
        best.gap = gap;
        best.normal = along < S(0) ? -n : n;
        vec<S, 3> edge;
        for (int k = 0; k < 3; ++k)
            if (k != i) edge[k] = best.normal[k] > S(0) ? half[k] : -half[k];
        best.at = closest_to_axis(i, half[i], s.middle - edge, s.direction, s.half).on_b;
    }
    return best;
}

}  // namespace detail

/// Two capsules: one point between the axes, or two where the axes lie side by side.
template <class S>
constexpr void collide(const capsule<S, 3>& a, const capsule<S, 3>& b, const transform<S, 3>& b_in_a, S margin,
                       manifold<S, 3>& out) {
    const detail::axis_segment<S> s{b_in_a.position, b_in_a.rotation * vec<S, 3>{S(1), S(0), S(0)}, b.half_length};
    const auto closest = closest_to_axis(0, a.half_length, s.middle, s.direction, s.half);
    const vec<S, 3> on_a{closest.on_a, S(0), S(0)}, on_b = s.at(closest.on_b);
    auto [n, gap] = direction_and_length_of(on_b - on_a);
    const S reach = a.radius + b.radius, thinner = min(a.radius, b.radius);
    if (gap > reach + margin) return;

    // Of points that all but coincide the direction is chance: try what is across one axis or both.
    const auto axis_gap = [&](vec<S, 3> m) { return dot(m, s.middle) - abs(m.x) * a.half_length - s.reach(m); };
    const S rounding = detail::rounding_of(a.half_length + b.half_length);
    if (!(gap > S(0)) || axis_gap(n) < gap - rounding) {
        const vec<S, 3> d = s.direction;
        vec<S, 3> across{S(0), -d.z, d.y};
        if (across == vec<S, 3>{}) across.y = S(1);
        if (dot(across, s.middle) < S(0)) across = -across;
        const vec<S, 3> along = n - d * dot(d, n),
                        candidates[3] = {across, {S(0), n.y, n.z}, along - d * dot(d, along)};
        bool found = gap > S(0);
        gap = axis_gap(n);
        for (const vec<S, 3>& candidate : candidates) {
            const vec<S, 3> m = normalized(candidate);
            const S by = axis_gap(m);
            if (m == vec<S, 3>{} || (found && !(by > gap))) continue;
            found = true;
            n = m;
            gap = by;
        }
    }
    out.normal = n;

    // Side by side: both ends of what they share, if the axes stay within three degrees of each other there and
    // the surfaces meet along the normal.
    const vec<S, 3> d = s.direction;
    if (abs(n.x) < S(0.05) && max(abs(d.y), abs(d.z)) < S(0.05)) {
        S ends[2] = {-s.half, s.half};
        if (clip_segment(s.middle.x, d.x, a.half_length, ends[0], ends[1]) && ends[1] > ends[0]) {
            vec<S, 3> from_a[2];
            S gaps[2];
            bool beside = true;
            for (int k = 0; k < 2; ++k) {
                from_a[k] = s.at(ends[k]);
                from_a[k].x = S(0);
                gaps[k] = dot(n, from_a[k]);
                beside = beside && largest(from_a[k] - n * gaps[k]) < thinner * S(0.1);
            }
            if (beside && !(min(gaps[0], gaps[1]) > gap + max(thinner * S(1.0 / 512), rounding))) {
                for (int k = 0; k < 2; ++k) {
                    if (gaps[k] - reach > margin) continue;
                    const vec<S, 3> p = s.at(ends[k]);
                    add_rounded(out, p - from_a[k], a.radius, p, b.radius, gaps[k], static_cast<std::uint32_t>(1 + k));
                }
                return;
            }
        }
    }
    if (!(gap - reach > margin)) add_rounded(out, on_a, a.radius, on_b, b.radius, gap, 0u);
}

/// A capsule and a box: the closest points where the axis is outside of the box, the axis of least overlap where
/// it is not; two points where the capsule lies on a face. To keep the features of bodies at rest, contacts may
/// deviate by 1/256 of the smallest size, never more.
template <class S>
constexpr void collide(const capsule<S, 3>& a, const box<S, 3>& b, const transform<S, 3>& b_in_a, S margin,
                       manifold<S, 3>& out) {
    // In the box's frame, with the normal from the box to the capsule until the end.
    const vec<S, 3> h = b.half_extents;
    const detail::axis_segment<S> s{inverse_transform(b_in_a, vec<S, 3>{}),
                                    inverse_rotate(b_in_a.rotation, vec<S, 3>{S(1), S(0), S(0)}), a.half_length};
    const S rounding = detail::rounding_of(s.half + largest(h) + largest(s.middle));
    const S slack = max(min(a.radius, min(h.x, min(h.y, h.z))) * S(1.0 / 512), rounding);
    S at = closest_to_box(s, h);
    const vec<S, 3> nearest = s.at(at);
    const vec<S, 3> offset = nearest - max(-h, min(h, nearest));
    const auto parting = direction_and_length_of(offset);
    vec<S, 3> n = parting.direction;
    S gap = parting.length;
    if (gap > a.radius + margin) return;
    // A corner of the box beside the axis: rounding must not tilt the normal along the axis.
    if (abs(at) < s.half && offset.x != S(0) && offset.y != S(0) && offset.z != S(0))
        n = normalized(n - s.direction * dot(s.direction, n));
    // Of points that all but coincide the direction is chance; of near ones it is rounded: try what is across the axis
    // or an edge.
    const auto separation_along = [&](vec<S, 3> m) { return dot(m, s.middle) - dot(abs(m), h) - s.reach(m); };
    S axis_gap = separation_along(n);
    if (!(gap > S(0)) || axis_gap < gap - rounding) {
        const vec<S, 3> across_axis = n - s.direction * dot(s.direction, n);
        for (int i = 0; i < 4 && gap > S(0); ++i) {
            vec<S, 3> m = i < 3 ? n : across_axis;
            if (i < 3) m[i] = S(0);
            m = normalized(m);
            const S by = separation_along(m);
            if (!(by > axis_gap)) continue;
            n = m;
            axis_gap = gap = by;
        }
        const auto best = detail::part_from_box(s, h, slack);
        if (!(gap > S(0)) || best.gap > axis_gap) {
            n = best.normal;
            gap = best.gap;
            at = best.at;
        }
    }

    int face = 0;
    for (int i = 1; i < 3; ++i)
        if (abs(n[i]) > abs(n[face])) face = i;
    const bool upper = n[face] > S(0);
    const std::uint32_t name = static_cast<std::uint32_t>(face << 3 | int{upper} << 2);
    out.normal = -(b_in_a.rotation * n);
    const auto add = [&](S t, S local, std::uint32_t feature) {
        if (local - a.radius > margin) return;
        out.add(b_in_a * (s.at(t) - n * ((local + a.radius) * S(0.5))), local - a.radius, feature);
    };
    // On a face: the part of the axis that the normal leads to the face, both ends of it within three degrees.
    if (abs(n[face]) > S(0.9986)) {
        const S height = s.middle[face] - (upper ? h[face] : -h[face]), rise = s.direction[face];
        S ends[2] = {-s.half, s.half};
        bool above = true;
        for (int i = 0; i < 3 && above; ++i) {
            if (i == face) continue;
            const S lean = n[i] / n[face];
            above =
                clip_segment(s.middle[i] - lean * height, s.direction[i] - lean * rise, h[i] + slack, ends[0], ends[1]);
        }
        const S gaps[2] = {(height + rise * ends[0]) / n[face], (height + rise * ends[1]) / n[face]};
        const std::uint32_t deeper = gaps[1] < gaps[0] ? 1 : 0;
        if (above && !(gaps[deeper] > gap + slack + slack)) {
            const bool lies = abs(dot(n, s.direction)) < S(0.05) && ends[1] > ends[0];
            for (std::uint32_t k = 0; k < 2; ++k)
                if (lies || k == deeper) add(ends[k], gaps[k], name | 2u | k);
            return;
        }
    }
    add(at, gap, name);
}

PHYSICS_HPP_END
