// Distance, overlap and penetration of any two convex shapes.
#pragma once

#include "physics/collide/core_shapes.hpp"
#include "physics/collide/mpr.hpp"

PHYSICS_HPP_BEGIN

/// Where two shapes are closest to each other, or how to part them; all in the frame of shape A.
template <class S, int D>
struct closest_points {
    /// Unit vector from A to B. Where points, lines or flat shapes lie in one another one of those that part them.
    vec<S, D> normal;
    /// Between the surfaces (m). Negative where they overlap: moving B along the normal by as much parts them.
    S distance{};
    vec<S, D> on_a;
    vec<S, D> on_b;
    query_status status = query_status::converged;
};

namespace detail {

/// How exactly the general kernels need to know a distance: what the scalar resolves. Polytopes they know to the last
/// digit of double.
template <class S>
constexpr double relative_tolerance() {
    return is_fixed<S> ? 0x1p-50 : static_cast<double>(scalar_traits<S>::epsilon()) * 0.25;
}
/// The same for a depth of overlap between shapes of that size (m).
template <class S>
constexpr double depth_tolerance(double size) {
    const double epsilon = static_cast<double>(scalar_traits<S>::epsilon());
    return is_fixed<S> ? max(epsilon * 0.25, size * 0x1p-51) : size * epsilon * 0.25;
}

/// Two shapes as the general kernels take them, in A's frame.
template <int D>
struct core_pair {
    core<D> a, b;
    placed_core<D> placed;

    template <class A, class B, class S>
    core_pair(const A& shape_a, const B& shape_b, const transform<S, D>& b_in_a)
        : a(core_of(shape_a)), b(core_of(shape_b)), placed{&b, to_matrix(b_in_a.rotation), to_point(b_in_a.position)} {}
    core_pair(const core<D>& core_a, const core<D>& core_b, const mat<double, D>& axes, const point<D>& at)
        : a(core_a), b(core_b), placed{&b, axes, at} {}
    core_pair(const core_pair&) = delete;
    core_pair& operator=(const core_pair&) = delete;
};

/// Where the cores of two shapes are closest: the point on A's and what lies between, negative where they overlap.
template <int D>
struct core_separation {
    point<D> normal;
    double gap = 0;
    /// As in penetration.
    point<D> on_a;
    bool located = true;
    std::uint32_t names[3] = {};
    int name_count = 0;
    bool beyond = false;
    query_status status = query_status::converged;
};

/// What finds the way out of an overlap.
enum class overlap_method { epa, mpr };

template <class S, int D>
core_separation<D> separate(const core_pair<D>& pair, double maximum, gjk_cache* cache,
                            overlap_method method = overlap_method::epa) {
    const gjk_result<D> r = gjk(pair.a, pair.placed, maximum, relative_tolerance<S>(), cache);
    core_separation<D> result;
    result.status = r.status;
    if (!r.overlapping) {
        result.normal = r.normal;
        result.gap = r.distance;
        result.beyond = r.beyond;
        if (!r.beyond) result.on_a = r.at.on_a();
        result.name_count = r.at.count;
        for (int i = 0; i < r.at.count; ++i) result.names[i] = r.at.vertex[i].name;
        return result;
    }
    const double tolerance = depth_tolerance<S>(extent_of(pair.a, pair.placed));
    const penetration<D> p = method == overlap_method::mpr ? mpr(pair.a, pair.placed, r.at, tolerance)
                                                           : epa(pair.a, pair.placed, r.at, tolerance);
    result.normal = p.normal;
    result.gap = -p.depth;
    result.on_a = p.on_a;
    result.located = p.located;
    result.name_count = D;
    for (int i = 0; i < D; ++i) result.names[i] = p.names[i];
    result.status = p.status;
    return result;
}

/// Finds the points that touch, where the way to part the cores was all that was found.
template <int D>
void locate(const core_pair<D>& pair, core_separation<D>& s) {
    if (s.located) return;
    penetration<D> p{s.normal, -s.gap, s.on_a, false, {}, s.status};
    for (int i = 0; i < 3; ++i) p.names[i] = s.names[i];
    locate(pair.a, pair.placed, extent_of(pair.a, pair.placed), p);
    s.on_a = p.on_a;
    for (int i = 0; i < 3; ++i) s.names[i] = p.names[i];
    s.located = true;
}

template <class S, int D>
closest_points<S, D> rounded(const core_pair<D>& pair, core_separation<D> s) {
    locate(pair, s);
    const point<D> on_b = s.on_a + s.normal * (s.gap - pair.b.radius);
    return {from_point<S>(s.normal), static_cast<S>(s.gap - pair.a.radius - pair.b.radius),
            from_point<S>(s.on_a + s.normal * pair.a.radius), from_point<S>(on_b), s.status};
}

}  // namespace detail

/// How far apart two convex shapes are, and where they are closest; or how deep they overlap, and how to part them.
/// Exact to a few roundings of the shapes' sizes: those of double for polytopes, with a radius or without; cylinders
/// and cones to 1e-8 of their sizes or to roundings of S, whichever is more. Of 45 million random pairs in 3D
/// (touching, thin, far, one a million times as large) five were worse in double, one in float, none in fixed point:
/// round ones up to 2.4 times that, and where sizes are a million to one normals part them by 1e-10 m less than they
/// say. Source: GJK and, where cores overlap, EPA (see gjk.hpp, epa3.hpp). Cost: 0.1-0.5 us apart, 0.5-4 us where they
/// overlap; hulls of more than 32 vertices more.
/// `cache` makes the next call for the same pair cheaper where the two have moved little.
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B> closest_points<S, D> separation(const A& a, const B& b,
                                                                                        const transform<S, D>& b_in_a,
                                                                                        gjk_cache& cache) {
        const detail::core_pair<D> pair(a, b, b_in_a);
        return detail::rounded<S>(pair, detail::separate<S>(pair, detail::no_limit, &cache));
    }
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B> closest_points<S, D> separation(const A& a, const B& b,
                                                                                        const transform<S, D>& b_in_a) {
        const detail::core_pair<D> pair(a, b, b_in_a);
        return detail::rounded<S>(pair, detail::separate<S>(pair, detail::no_limit, nullptr));
    }

namespace detail {

template <class S, int D>
closest_points<S, D> distance(const core_pair<D>& pair, gjk_cache* cache) {
    const gjk_result<D> r = gjk(pair.a, pair.placed, no_limit, relative_tolerance<S>(), cache);
    if (r.overlapping) return {{}, S(0), {}, {}, r.status};
    const point<D> core_on_a = r.at.on_a(), on_b = core_on_a + r.normal * (r.distance - pair.b.radius);
    return {from_point<S>(r.normal), static_cast<S>(max(r.distance - pair.a.radius - pair.b.radius, 0.0)),
            from_point<S>(core_on_a + r.normal * pair.a.radius), from_point<S>(on_b), r.status};
}
template <class S, int D>
bool overlap(const core_pair<D>& pair, gjk_cache* cache) {
    const double reach = pair.a.radius + pair.b.radius;
    const gjk_result<D> r = gjk(pair.a, pair.placed, reach, relative_tolerance<S>(), cache);
    return r.overlapping || (!r.beyond && r.distance <= reach);
}

}  // namespace detail

/// How far apart two convex shapes are, 0 where they touch or overlap; normal and points are then those of the cores
/// where only the rounded parts overlap, else null. Cost: GJK alone.
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B> closest_points<S, D> distance(const A& a, const B& b,
                                                                                      const transform<S, D>& b_in_a,
                                                                                      gjk_cache& cache) {
        return detail::distance<S>(detail::core_pair<D>(a, b, b_in_a), &cache);
    }
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B> closest_points<S, D> distance(const A& a, const B& b,
                                                                                      const transform<S, D>& b_in_a) {
        return detail::distance<S>(detail::core_pair<D>(a, b, b_in_a), nullptr);
    }

/// Whether two convex shapes share a point; true as well for some that are apart by less than 5e-13 of their sizes and
/// distances, round ones 5e-10. Cost: GJK until an axis parts them.
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B>
bool overlap(const A& a, const B& b, const transform<S, D>& b_in_a, gjk_cache& cache) {
    return detail::overlap<S>(detail::core_pair<D>(a, b, b_in_a), &cache);
}
template <class A, class B, class S, int D>
    requires detail::has_core<A> && detail::has_core<B>
bool overlap(const A& a, const B& b, const transform<S, D>& b_in_a) {
    return detail::overlap<S>(detail::core_pair<D>(a, b, b_in_a), nullptr);
}

PHYSICS_HPP_END
