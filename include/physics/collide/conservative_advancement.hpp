// Two convex shapes that move and turn, and when they come close: conservative advancement.
#pragma once

#include "physics/collide/gjk.hpp"
#include "physics/collide/ray_solids.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

template <class S>
physics::rotation<S, 2> rotation_by(S turn) {
    return physics::rotation<S, 2>::from_angle(turn);
}
template <class S>
physics::rotation<S, 3> rotation_by(const vec<S, 3>& turn) {
    const auto [axis, angle] = direction_and_length_of(turn);
    return physics::rotation<S, 3>::from_axis_angle(axis, angle);
}

}  // namespace detail

/// How a shape moves within a step: its body's centre of mass in a straight line, about which it turns at a constant
/// rate.
template <class S, int D>
struct sweep {
    /// The centre of mass at the beginning and at the end (m).
    vec<S, D> start, end;
    /// The body's rotation at the beginning.
    physics::rotation<S, D> rotation;
    /// How far it turns until the end: the angle, in 3D axis times angle (rad), in the outer frame; any number of
    /// times around.
    angular<S, D> turn{};
    /// The shape's frame, as seen from the centre of mass in a frame that turns with the body.
    transform<S, D> shape;

    /// Where the shape's frame is after a part of the motion. The angle is exact to rounding.
    [[nodiscard]] transform<S, D> at(S fraction) const {
        const physics::rotation<S, D> r = detail::rotation_by(turn * fraction) * rotation;
        const vec<S, D> center = start + (end - start) * fraction;
        return {center + r * shape.position, normalized(r * shape.rotation)};
    }
};

/// The motion between two poses of the centre of mass, the shorter way around: at most half a turn.
template <class S, int D>
sweep<S, D> sweep_between(const transform<S, D>& start, const transform<S, D>& end, const transform<S, D>& shape = {}) {
    return {start.position, end.position, start.rotation, rotation_vector(end.rotation * inverse(start.rotation)),
            shape};
}

/// How a search for the time at which two shapes come close ended.
enum class impact_state : std::uint8_t {
    /// The shapes do not come as close as the target; the fraction is 1.
    separated,
    /// At the fraction they are as far apart as the target, at most by the tolerance farther.
    hit,
    /// They overlap at the beginning, or touch within rounding; the fraction is 0.
    overlapping,
    /// The search was given up. Up to the fraction the shapes are apart, at least by the target.
    iteration_limit,
};

namespace detail {

// Turns, their lengths and the lengths of their cross products, in 2D and in 3D.
inline double magnitude(double w) { return abs(w); }
inline double magnitude(const point<3>& w) { return length(w); }
inline double magnitude_of_cross(double, double) { return 0; }
inline double magnitude_of_cross(const point<3>& a, const point<3>& b) { return length(cross(a, b)); }
inline mat<double, 2> turning(double angle) {
    const auto [s, c] = sine_cosine(angle);
    return {{{c, s}, {-s, c}}};
}
/// Source: Rodrigues.
inline mat<double, 3> turning(const point<3>& turn) {
    const auto [k, angle] = direction_and_length_of(turn);
    const auto [s, c] = sine_cosine(angle);
    const double half = sine_cosine(angle * 0.5).sine, v = 2 * half * half;
    return {{{c + k.x * k.x * v, k.x * k.y * v + k.z * s, k.x * k.z * v - k.y * s},
             {k.x * k.y * v - k.z * s, c + k.y * k.y * v, k.y * k.z * v + k.x * s},
             {k.x * k.z * v + k.y * s, k.y * k.z * v - k.x * s, c + k.z * k.z * v}}};
}
template <class S>
double to_turn(S w) {
    return detail::to_double(w);
}
template <class S>
point<3> to_turn(const vec<S, 3>& w) {
    return to_point(w);
}

/// A core that moves; time runs from 0 to 1.
template <int D>
struct moving_core {
    core<D> shape;
    /// Of the centre of mass, at time 0.
    point<D> start;
    /// The turn until time 1.
    angular<double, D> turn;
    mat<double, D> axes;
    /// From the centre of mass to the shape's frame, at time 0.
    point<D> center_offset;
    /// No point of the core is farther from the centre of mass.
    double reach;

    template <class S>
    moving_core(const core<D>& c, const sweep<S, D>& s, const point<D>& origin)
        : moving_core(c, s, to_matrix(s.shape.rotation), to_point(s.shape.position), origin) {}
    /// The same where the shape stands elsewhere on the body.
    template <class S>
    moving_core(const core<D>& c, const sweep<S, D>& s, const mat<double, D>& local, const point<D>& arm,
                const point<D>& origin)
        : shape(c), turn(to_turn(s.turn)) {
        const mat<double, D> body = to_matrix(s.rotation);
        start = to_point(s.start) - origin;
        axes = body * local;
        center_offset = body * arm;
        // The box around the core in its own frame, seen from the centre of mass.
        const point<D> center = -transposed_times(local, arm);
        double square = 0;
        for (int i = 0; i < D; ++i) {
            point<D> n;
            n[i] = 1;
            const double far = max(abs(shape.support(n).at[i] - center[i]), abs(shape.support(-n).at[i] - center[i]));
            square += far * far;
        }
        reach = physics::sqrt(square);
    }
    /// Where it is at a time, its centre of mass having moved to `center`.
    [[nodiscard]] placed_core<D> at(double time, const point<D>& center) const {
        if (!(magnitude(turn) > 0)) return {&shape, axes, center + center_offset};
        const mat<double, D> m = turning(turn * time);
        return {&shape, m * axes, center + m * center_offset};
    }
};

/// The rate of an axis that stays across an edge of A and an edge of B; left as it is where they are parallel.
inline void across_edges(const point<3>& n, const point<3>& edge_a, const point<3>& edge_b, const point<3>& turn_a,
                         const point<3>& turn_b, point<3>& turn) {
    const point<3> u = normalized(cross(n, edge_a)), w = normalized(cross(n, edge_b));
    const double uw = dot(u, w), det = 1 - uw * uw;
    const double of_a = dot(turn_a, u), of_b = dot(turn_b, w);
    if (det > 1.0 / 64) turn = u * ((of_a - uw * of_b) / det) + w * ((of_b - uw * of_a) / det);
}
inline void across_edges(const point<2>&, const point<2>&, const point<2>&, double, double, double&) {}

/// Two cores in motion; A's centre of mass is the origin at all times. A halfspace as A is the point of its surface
/// that is closest to the origin of its frame, with a normal.
template <int D>
struct moving_pair {
    const moving_core<D>&a, &b;
    point<D> displacement;
    /// Of the halfspace, in A's own frame; else null.
    const point<D>* face;
    /// The radii of both.
    double radii;
    double error;
    double tolerance;

    [[nodiscard]] point<D> center(double t) const { return b.start + displacement * t; }
    /// What rounding may do to a distance.
    [[nodiscard]] double noise() const {
        const double far = max(largest(b.start), largest(b.start + displacement));
        return 0x1p-48 * (a.reach + b.reach + radii + far) + error;
    }
    /// The halfspace's point.
    [[nodiscard]] point<D> on_face(const placed_core<D>& on_a) const { return on_a.axes * a.shape.corner[0] + on_a.at; }
    /// How far apart they are along n.
    [[nodiscard]] double gap(double t, const point<D>& n) const {
        const placed_core<D> on_a = a.at(t, {}), on_b = b.at(t, center(t));
        const point<D> top = face != nullptr ? on_face(on_a) : on_a.support(n).at;
        return (dot(n, on_b.support(-n).at) - dot(n, top)) - radii;
    }
};

/// The axis along which a moving pair is farthest apart at a time, null if it overlaps; at what rate that should turn
/// so that the features it stands on stay the closest ones; and the point of A's core.
template <int D>
struct separating_axis {
    point<D> normal, on_a;
    angular<double, D> turn{};
};

/// B in A's frame.
template <int D>
placed_core<D> seen_from(const placed_core<D>& a, const placed_core<D>& b) {
    mat<double, D> axes;
    for (int i = 0; i < D; ++i) axes.column[i] = transposed_times(a.axes, b.axes.column[i]);
    return {b.shape, axes, transposed_times(a.axes, b.at - a.at)};
}

template <int D>
separating_axis<D> closest_features(const moving_pair<D>& p, double t, gjk_cache& cache) {
    separating_axis<D> axis;
    const placed_core<D> on_a = p.a.at(t, {}), on_b = p.b.at(t, p.center(t));
    if (p.face != nullptr) {
        axis.normal = on_a.axes * *p.face;
        axis.turn = p.a.turn;
        const point<D> lowest = on_b.support(-axis.normal).at;
        axis.on_a = lowest + axis.normal * dot(axis.normal, p.on_face(on_a) - lowest);
        return axis;
    }
    const gjk_result<D> r = gjk(p.a.shape, seen_from(on_a, on_b), no_limit, p.tolerance, &cache);
    if (r.overlapping) return axis;
    axis.normal = on_a.axes * r.normal;
    axis.on_a = on_a.axes * r.at.on_a() + on_a.at;
    // What the shapes turn towards each other: how many corners, and an edge between two of them. Corners that are
    // close count as one: round shapes have many that differ a little.
    const auto& v = r.at.vertex;
    int corners_a = 1, corners_b = 1;
    point<D> edge_a, edge_b;
    for (int i = 1; i < r.at.count; ++i) {
        bool new_a = true, new_b = true;
        for (int k = 0; k < i; ++k) {
            const point<D> from_a = v[i].on_a - v[k].on_a, from_b = (v[i].w - v[k].w) + from_a;
            if (largest(from_a) > 0x1p-5 * p.a.reach) edge_a = from_a;
            else new_a = false;
            if (largest(from_b) > 0x1p-5 * p.b.reach) edge_b = from_b;
            else new_b = false;
        }
        corners_a += new_a;
        corners_b += new_b;
    }
    if (corners_a == 1 && corners_b == 1) return axis;
    const bool of_a = corners_a > corners_b || (corners_a == corners_b && largest(edge_a) >= largest(edge_b));
    axis.turn = of_a ? p.a.turn : p.b.turn;
    if (D == 3 && corners_a == 2 && corners_b == 2)
        across_edges(axis.normal, on_a.axes * edge_a, on_a.axes * edge_b, p.a.turn, p.b.turn, axis.turn);
    return axis;
}

/// How long a pair certainly stays apart by `goal`, from a time on, along an axis that turns: at most until `end`. The
/// gap along such an axis is the least of functions of time whose second derivative is at most `bend`; so it lies above
/// the chord between two times, less bend / 2 times the product of the times since and until. At both ends it is known
/// from supports. Some second times are tried, and the best bound taken.
template <int D>
double proven_advance(const moving_pair<D>& p, const separating_axis<D>& axis, double t, double gap, double end,
                      double goal) {
    const auto &a = p.a, &b = p.b;
    const auto curving = [&](const moving_core<D>& c) {
        const auto spin = c.turn - axis.turn;
        return (magnitude(spin) * magnitude(spin) + magnitude_of_cross(spin, axis.turn)) * c.reach;
    };
    const double whirl = length(cross(axis.turn, axis.normal));
    const double far = max(length(cross(axis.turn, p.center(t))), length(cross(axis.turn, p.center(end))));
    const double bend = curving(a) + curving(b) + whirl * (far + 2 * length(p.displacement)), spare = gap - goal;
    double best = 0, span = end - t;
    if (bend * span * span > 8 * spare) span = physics::sqrt(8 * spare / bend);
    for (int i = 0; i < 4 && span > best; ++i) {
        const point<D> n = turning(axis.turn * span) * axis.normal;
        const double there = p.gap(t + span, n) - goal, slope = (there - spare) / span, sag = 0.5 * bend;
        // The first root of spare + slope x - sag x (span - x).
        const double b1 = slope - sag * span, square = b1 * b1 - 4 * sag * spare;
        double safe = span;
        if (b1 < 0 && square >= 0) safe = min(span, 2 * spare / (physics::sqrt(square) - b1));
        best = max(best, safe);
        if (safe >= span) break;
        // Where the chord would meet the goal, unless even a straight path could not be proven that far.
        double next = there < 0 ? span * (spare / (spare - there)) : 0.5 * span;
        if (bend * next * next > 2 * spare) next = min(next, max(physics::sqrt(2 * spare / bend), 0.125 * span));
        span = next;
    }
    return best;
}

/// When a pair may be within a distance: where the balls around both, about the centres of mass, are.
template <int D>
struct near_times {
    bool any = true, at_start = true, at_end = true;
    double from = 0, end = 1;

    near_times(const moving_pair<D>& p, double distance, double noise, double latest) {
        if (p.face != nullptr) return;
        const double reach = (p.a.reach + p.b.reach + p.radii + distance) + noise;
        const local_ray<D> ray{p.b.start, p.displacement};
        at_start = dot(ray.origin, ray.origin) <= reach * reach;
        double first = 0, last = 1;
        const bool meets = ball_span(ray, reach, first, last);
        any = at_start || (meets && !(first < 0) && !(first > latest));
        if (!at_start) from = first;
        at_end = !(meets && last < 1);
        if (!at_end) end = max(last, from);
    }
};

/// Where a search for the time at which a pair comes close ended.
template <int D>
struct moving_impact {
    impact_state state = impact_state::separated;
    double time = 1;
    /// With A's centre of mass as the origin.
    point<D> normal, on_a;
    double gap = 0;
};

/// Follows a pair through time: conservative advancement. AxisAt gives the axis along which to measure the gap. Source:
/// Mirtich, Impulse-based dynamic simulation of rigid body systems (1996); the separating axis that turns along is
/// Catto's, Continuous collision, GDC (2013), here with a bound that proves it.
template <int D, separating_axis<D> (*AxisAt)(const moving_pair<D>&, double, gjk_cache&)>
class advancement {
public:
    struct moment {
        double time = -1;
        separating_axis<D> axis;
        double gap = 0;
    };

    explicit advancement(const moving_pair<D>& pair) : pair_(pair) {}
    /// The axis and the gap at a time. The start is looked at by all that follows.
    const moment& at(double t) {
        moment& m = seen_[t > 0];
        if (m.time == t) return m;
        m.axis = AxisAt(pair_, t, cache_);
        m.gap = m.axis.normal == point<D>{} ? -pair_.radii : pair_.gap(t, m.axis.normal);
        m.time = t;
        return m;
    }
    /// From a time on until the gap is `goal`, which may be negative, or larger by at most `slack`.
    [[nodiscard]] PHYSICS_HPP_COLD moving_impact<D> follow(double t, double end, double goal, double slack) {
        constexpr int max_iterations = 100;
        for (int iterations = 0;; ++iterations) {
            const auto& [time, axis, gap] = at(t);
            if (gap <= goal + slack) return {impact_state::hit, t, axis.normal, axis.on_a, gap};
            const double next = t + proven_advance(pair_, axis, t, gap, end, goal);
            if (next >= end) return {};
            if (!(next > t) || iterations == max_iterations)
                return {impact_state::iteration_limit, t, axis.normal, axis.on_a, gap};
            t = next;
        }
    }

private:
    const moving_pair<D>& pair_;
    gjk_cache cache_;
    moment seen_[2];
};

}  // namespace detail

PHYSICS_HPP_END
