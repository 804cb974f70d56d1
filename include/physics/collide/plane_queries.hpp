// Distance, overlap and penetration of any shape that has a core and a halfspace.
#pragma once

#include "physics/collide/bounding_half.hpp"
#include "physics/collide/convex.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The point of a core that lies lowest above a halfspace, both in A's frame.
template <int D>
struct lowest_point {
    point<D> normal, at;
    double radius, gap;

    /// Where the halfspace is shape B.
    template <class A, class S>
    lowest_point(const A& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a)
        : lowest_point(core_of(a), mat<double, D>::identity(), {}, bounding_half<D>(b, b_in_a)) {}
    /// Where it is shape A.
    template <class B, class S>
    lowest_point(const halfspace<S, D>& a, const B& b, const transform<S, D>& b_in_a)
        : lowest_point(core_of(b), to_matrix(b_in_a.rotation), to_point(b_in_a.position), bounding_half<D>(a)) {}
    lowest_point(const core<D>& c, const mat<double, D>& axes, const point<D>& where, const bounding_half<D>& half)
        : normal(half.normal),
          at(placed_core<D>{&c, axes, where}.support(-normal).at),
          radius(c.radius),
          gap(half.height(at)) {}

    /// The plane is shape A if `up` is 1, B if it is -1.
    template <class S>
    [[nodiscard]] closest_points<S, D> found(int up) const {
        const vec<S, D> on_shape = from_point<S>(at - normal * radius), on_plane = from_point<S>(at - normal * gap);
        return {from_point<S>(normal * up), static_cast<S>(gap - radius), up > 0 ? on_plane : on_shape,
                up > 0 ? on_shape : on_plane, query_status::converged};
    }
    /// The same, without overlaps.
    template <class S>
    [[nodiscard]] closest_points<S, D> found_apart(int up) const {
        if (!(gap > 0)) return {};
        closest_points<S, D> result = found<S>(up);
        result.distance = max(result.distance, S(0));
        return result;
    }
};

}  // namespace detail

/// How far a convex shape and a halfspace are apart, or how deep they overlap, and where: as of two convex shapes (see
/// convex.hpp), in either order. Exact, with or without a cache, which stays as it is. Cost: one support, 20 ns.
template <class A, class S, int D>
    requires detail::has_core<A> closest_points<S, D> separation(const A& a, const halfspace<S, D>& b,
                                                                 const transform<S, D>& b_in_a) {
        return detail::lowest_point<D>(a, b, b_in_a).template found<S>(-1);
    }
template <class B, class S, int D>
    requires detail::has_core<B> closest_points<S, D> separation(const halfspace<S, D>& a, const B& b,
                                                                 const transform<S, D>& b_in_a) {
        return detail::lowest_point<D>(a, b, b_in_a).template found<S>(1);
    }

/// How far apart they are, 0 where they touch or overlap; normal and points are null where the core enters the
/// halfspace.
template <class A, class S, int D>
    requires detail::has_core<A> closest_points<S, D> distance(const A& a, const halfspace<S, D>& b,
                                                               const transform<S, D>& b_in_a) {
        return detail::lowest_point<D>(a, b, b_in_a).template found_apart<S>(-1);
    }
template <class B, class S, int D>
    requires detail::has_core<B> closest_points<S, D> distance(const halfspace<S, D>& a, const B& b,
                                                               const transform<S, D>& b_in_a) {
        return detail::lowest_point<D>(a, b, b_in_a).template found_apart<S>(1);
    }

/// Whether they share a point.
template <class A, class S, int D>
    requires detail::has_core<A>
bool overlap(const A& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a) {
    const detail::lowest_point<D> p(a, b, b_in_a);
    return p.gap <= p.radius;
}
template <class B, class S, int D>
    requires detail::has_core<B>
bool overlap(const halfspace<S, D>& a, const B& b, const transform<S, D>& b_in_a) {
    const detail::lowest_point<D> p(a, b, b_in_a);
    return p.gap <= p.radius;
}

namespace detail {

template <class A, class B>
concept plane_pair = (is_halfspace<A> && has_core<B>) || (has_core<A> && is_halfspace<B>);

}  // namespace detail

template <class A, class B, class S, int D>
    requires detail::plane_pair<A, B> closest_points<S, D> separation(const A& a, const B& b,
                                                                      const transform<S, D>& b_in_a, gjk_cache&) {
        return separation(a, b, b_in_a);
    }
template <class A, class B, class S, int D>
    requires detail::plane_pair<A, B> closest_points<S, D> distance(const A& a, const B& b,
                                                                    const transform<S, D>& b_in_a, gjk_cache&) {
        return distance(a, b, b_in_a);
    }
template <class A, class B, class S, int D>
    requires detail::plane_pair<A, B>
bool overlap(const A& a, const B& b, const transform<S, D>& b_in_a, gjk_cache&) { return overlap(a, b, b_in_a); }

PHYSICS_HPP_END
