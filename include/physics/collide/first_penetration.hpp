// When a convex shape that moves and turns has to be stopped, so that it does not pass into or through another one.
#pragma once

#include "physics/collide/conservative_advancement.hpp"
#include "physics/collide/convex.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Lower bound of the inradius of a core, rounding included (m): how deep it can enter another core before its own
/// interior does.
template <bool Few, int D>
PHYSICS_HPP_COLD double inradius_of(const core<D>& c) {
    double inside = c.thickness;
    // Half the smallest width, which exceeds that radius by less than a factor of two.
    if (c.kind == core_kind::triangle || (c.kind == core_kind::disc && c.corner[0].y != c.corner[0][D - 1]))
        inside *= 0.5;
    if constexpr (!Few)
        if (c.kind == core_kind::custom) {
            const core<D> center_point;
            const placed_core<D> middle{&center_point, mat<double, D>::identity(), c.center};
            const gjk_result<D> r = gjk(c, middle, no_limit, 0x1p-20, nullptr);
            inside = r.overlapping ? 0.75 * max(epa(c, middle, r.at, 0x1p-10 * c.extent).depth, 0.0) : 0;
        }
    return inside + c.radius;
}

/// Limits of a first-penetration search: which penetrations stop a sweep, and where; lengths in metres.
struct penetration_limits {
    /// Shapes that begin closer are in contact: the solver stops them, unless they sink in.
    double touch;
    /// How far apart the others are left, and how much farther at most.
    double target, tolerance;
    /// The mover may sink in by half of this on its way, if it is out again at the end.
    double depth;
    /// How deep it may be at the end of the sweep: `sink` if it begins in contact and gets deeper; `sideways` if it
    /// enters through a joint between parts of a surface, in which it has been all along.
    double sink, sideways;
    /// What rounding of poses may do to a gap.
    double blur;
    /// Whether what begins apart is stopped however little it sinks in on its way.
    bool grazes = false;
};

/// When a shape is stopped, and at what: the axis on which it meets the other shape, towards it, and its gap there.
template <int D>
struct first_penetration {
    bool stops = false;
    bool converged = true;
    double time = 1;
    point<D> normal;
    double gap = 0;
    /// Whether it began in touch.
    bool touching = false;
    /// How far along the axis it must be moved at the end of its way, to be no deeper than it began.
    double push_out = 0;
};

template <class Any, class... Known>
constexpr bool is_one_of = (std::same_as<Any, Known> || ...);
/// Whether the core of a shape in 2D has at most four corners.
template <class Shape, class S>
constexpr bool has_few_corners = is_one_of<Shape, ball<S, 2>, capsule<S, 2>, box<S, 2>, rounded_box<S, 2>,
                                           segment<S, 2>, triangle<S, 2>, halfspace<S, 2>>;

/// The corners of a core in 2D, in order around it.
struct few_corners {
    point<2> at[4];
    int count;

    static bool has(const core<2>& c) { return c.kind <= core_kind::box; }
    explicit few_corners(const placed_core<2>& c) : count(static_cast<int>(c.shape->kind) + 1) {
        // Those of boxes are numbered by signs.
        for (int i = 0; i < count; ++i) at[i] = c.vertex(static_cast<std::uint32_t>(count == 4 ? i ^ (i >> 1) : i)).at;
    }
    [[nodiscard]] double minimum(const point<2>& n) const {
        double result = dot(n, at[0]);
        for (int i = 1; i < count; ++i) result = min(result, dot(n, at[i]));
        return result;
    }
};

/// The axis along which two cores in 2D are farthest apart or, where they overlap, the shortest way out: that is
/// across an edge of either, or from corner to corner. Cost: all of them are tried.
PHYSICS_HPP_COLD inline separating_axis<2> parting_edge(const placed_core<2>& a, const placed_core<2>& b, double turn_a,
                                                        double turn_b) {
    const few_corners on_a(a), on_b(b);
    separating_axis<2> best;
    double maximum = -no_limit;
    const auto offer = [&](const point<2>& displacement, double turn) {
        const double length = physics::length(displacement);
        if (!(length > 0)) return;
        const point<2> n = displacement * (1 / length);
        const double gap = on_b.minimum(n) + on_a.minimum(-n);
        if (!(gap > maximum)) return;
        maximum = gap;
        best = {n, {}, turn};
    };
    for (const few_corners* c : {&on_a, &on_b})
        for (int i = 0; i < c->count; ++i) {
            const point<2> across = perpendicular(c->at[i + 1 < c->count ? i + 1 : 0] - c->at[i]);
            offer(across, c == &on_a ? turn_a : turn_b);
            offer(-across, c == &on_a ? turn_a : turn_b);
        }
    for (int i = 0; i < on_a.count && (maximum > 0 || maximum == -no_limit); ++i)
        for (int k = 0; k < on_b.count; ++k) offer(on_b.at[k] - on_a.at[i], 0);
    return best;
}

/// As closest_features; where the cores overlap, the axis of the shortest way out.
template <int D>
PHYSICS_HPP_COLD separating_axis<D> parting_features_of_any(const moving_pair<D>& p, double t, gjk_cache& cache) {
    separating_axis<D> axis = closest_features(p, t, cache);
    if (!(axis.normal == point<D>{})) return axis;
    const placed_core<D> on_a = p.a.at(t, {}), on_b = p.b.at(t, p.center(t));
    const placed_core<D> b_in_a = seen_from(on_a, on_b);
    const gjk_result<D> r = gjk(p.a.shape, b_in_a, no_limit, p.tolerance, &cache);
    point<D> normal = r.normal;
    int corners_a = 1, corners_b = 1;
    if (r.overlapping) {
        const penetration<D> out = epa(p.a.shape, b_in_a, r.at, 0x1p-30 * extent_of(p.a.shape, b_in_a));
        normal = out.normal;
        for (int i = 1; i < D; ++i) {
            bool new_a = true, new_b = true;
            for (int k = 0; k < i; ++k) {
                new_a = new_a && out.names[i] >> 16 != out.names[k] >> 16;
                new_b = new_b && (out.names[i] & 0xffffu) != (out.names[k] & 0xffffu);
            }
            corners_a += new_a;
            corners_b += new_b;
        }
    }
    axis.normal = on_a.axes * normal;
    axis.turn = corners_a > corners_b ? p.a.turn : p.b.turn;
    return axis;
}

/// The same, in 2D, where cores with few corners need no general kernels. Few: both are known to be such.
template <bool Few, int D>
separating_axis<D> parting_features(const moving_pair<D>& p, double t, [[maybe_unused]] gjk_cache& cache) {
    if constexpr (D == 2) {
        if (p.face != nullptr) return {p.a.at(t, {}).axes * *p.face, {}, p.a.turn};
        if (Few || (few_corners::has(p.a.shape) && few_corners::has(p.b.shape)))
            return parting_edge(p.a.at(t, {}), p.b.at(t, p.center(t)), p.a.turn, p.b.turn);
    }
    if constexpr (!Few || D != 2) return parting_features_of_any(p, t, cache);
}

template <bool Few, int D>
using penetration_search = advancement<D, parting_features<Few, D>>;

/// By how much turning can bring a pair closer, along an axis that stays, than it is at both ends of the way.
template <int D>
double bulge_of(const moving_pair<D>& p) {
    const auto bend = [](const moving_core<D>& c) { return magnitude(c.turn) * magnitude(c.turn) * c.reach; };
    return (bend(p.a) + bend(p.b)) * (1.0 / 8);
}

/// The axis from a segment or a triangle towards the middle of the other shape, at the beginning; null if A is neither,
/// or the middle is on it.
template <int D>
point<D> axis_from_flat(const moving_pair<D>& p) {
    const core_kind kind = p.a.shape.kind;
    if (kind != core_kind::segment && kind != core_kind::triangle) return {};
    const placed_core<D> on_a = p.a.at(0, {}), on_b = p.b.at(0, p.center(0));
    const point<D> middle = on_b.axes * p.b.shape.center + on_b.at;
    const point<D> first = on_a.vertex(0).at - middle, second = on_a.vertex(1).at - middle;
    point<D> nearest = closest_on_edge(first, second).at;
    if constexpr (D == 3)
        if (kind == core_kind::triangle) nearest = closest_on_triangle(first, second, on_a.vertex(2).at - middle).at;
    const double far = length(nearest);
    return far > 0 ? nearest * (-1 / far) : point<D>{};
}
/// Whether a pair overlaps by more than that at the beginning.
template <bool Few, int D>
PHYSICS_HPP_COLD bool is_deeper(const moving_pair<D>& p, double depth) {
    const point<D> n = p.face == nullptr ? axis_from_flat(p) : point<D>{};
    if (!(n == point<D>{}) && !(p.gap(0, n) < -depth)) return false;
    return penetration_search<Few, D>(p).at(0).gap < -depth;
}
/// Whether it is plain that B is not stopped by a flat A, as it mostly is among the parts of a mesh: along one axis it
/// stays apart, or is out of A at both ends and nearly so in between.
template <int D>
PHYSICS_HPP_COLD bool passes_by(const moving_pair<D>& p, const penetration_limits& rule, double touch) {
    const point<D> n = axis_from_flat(p);
    if (n == point<D>{}) return false;
    const double gap = p.gap(0, n), then = p.gap(1, n), minimum = min(gap, then);
    const double nearest = minimum - bulge_of(p);
    if (nearest > touch) return true;
    const bool may_sink = !rule.grazes && rule.depth > 16 * p.noise();
    return may_sink && minimum >= 0 && nearest > -0.375 * rule.depth;
}

/// Whether a pair that began apart, or sunk in by so much, is too deep at the end of the way.
template <class Search, int D>
PHYSICS_HPP_COLD bool ends_deep(const moving_pair<D>& p, Search& search, const penetration_limits& rule, bool touching,
                                double sunk) {
    const auto& last = search.at(1);
    if (touching) return -last.gap > sunk + rule.sink;
    // What came in along the shortest way out came in there by all that it is deep, and by what they were apart.
    const bool came_in = p.gap(0, last.axis.normal) - last.gap > 0.5 * rule.touch;
    return -last.gap > (came_in ? rule.blur + 8 * p.noise() : rule.sideways);
}

/// When B has to be stopped on its way past or into A, if that is before `latest`: where it would otherwise be in A at
/// the end of the way, or sink in on its way deeper than half of what it can without passing through. So nothing that
/// slides along a surface, rolls over its inner edges or grazes it is stopped. It is stopped at the surface, or, where
/// it begins in touch, where it sinks in: on a way through, each time halfway to the depth that it must not reach, and
/// beyond that at once. The answer for one pair depends on no other; `latest` only spares work. Few: both cores are
/// known to have few corners. Cost: 0.1 us where they stay far apart.
template <bool Few, int D>
PHYSICS_HPP_COLD first_penetration<D> find_first_penetration(const moving_pair<D>& p, const penetration_limits& rule,
                                                             double latest) {
    const double noise = p.noise(), slack = max(rule.tolerance, 4 * noise),
                 touch = max(rule.touch, rule.target + slack);
    const near_times<D> near(p, touch, noise, latest);
    if (!near.any || (near.at_start && passes_by(p, rule, touch))) return {};
    penetration_search<Few, D> search(p);
    const double gap = near.at_start ? search.at(0).gap : no_limit;
    const bool touching = gap <= touch;
    const auto stopped = [&](const moving_impact<D>& at) -> first_penetration<D> {
        return {true, at.state == impact_state::hit, at.time, at.normal, at.gap, touching};
    };
    if (touching) {
        // Nothing inside that must not pass.
        if (!(rule.depth > 0)) return {};
        const double sunk = gap < 0 ? -gap : 0, left = rule.depth * (31.0 / 32) - sunk;
        double more = max(0.5 * left, rule.blur + 8 * noise), within = more * (1.0 / 8);
        // Most that begins in touch is not nearly so deep along the first axis at any time.
        const double then = p.gap(1, search.at(0).axis.normal);
        const double nearest = min(gap, then) - bulge_of(p);
        if (nearest > within - (sunk + more) && (!near.at_end || !(-then > sunk + rule.sink))) return {};
        if (near.at_end && ends_deep(p, search, rule, touching, sunk)) {
            more = min(more, rule.target + slack);
            within = slack;
        }
        const auto deep = search.follow(0, near.end, -(sunk + more), within);
        if (deep.state == impact_state::separated || deep.time > latest) return {};
        first_penetration<D> result = stopped(deep);
        result.push_out = -(p.gap(1, deep.normal) + sunk);
        return result;
    }
    const auto first = search.follow(near.from, latest < near.end ? latest : near.end, rule.target, slack);
    if (first.state == impact_state::separated) return {};
    if (first.state == impact_state::iteration_limit) return stopped(first);
    const double minimum = rule.blur + 8 * noise, maximum = rule.grazes ? minimum : 0.5 * rule.depth;
    if (!(rule.depth > 16 * noise) || (near.at_end && ends_deep(p, search, rule, touching, 0))) return stopped(first);
    const auto deep = search.follow(first.time, near.end, -maximum, maximum * (1.0 / 8));
    if (deep.state == impact_state::separated) return {};
    first_penetration<D> result = stopped(first);
    result.converged = deep.state == impact_state::hit;
    return result;
}

}  // namespace detail

PHYSICS_HPP_END
