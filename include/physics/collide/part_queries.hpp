// Casts and distances of shapes that are made of parts: surfaces and compounds.
#pragma once

#include "physics/collide/plane_queries.hpp"
#include "physics/collide/ray_parts.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Calls f(core, axes, at, number) for the convex pieces of a shape with parts that may reach into a box: triangles or
/// segments with the surface's rounding, or children. `sees(part)` says which parts of surfaces are meant.
template <class Shape, int D, class Sees, class F>
void each_piece(const Shape& shape, const aabb<double, D>& box, Sees&& sees, F&& f) {
    if constexpr (is_surface<Shape, D>) {
        const double radius = detail::to_double(shape.radius);
        each_part(shape, grown(box, radius), [&](const surface_part<D>& part) {
            if (sees(part)) f(core_of_part(part, radius), mat<double, D>::identity(), point<D>{}, part.number);
        });
    } else {
        each_child(shape, box, [&](const auto& child) { f(child.shape, child.axes, child.at, child.number); });
    }
}
/// Of a one-sided part only the front is seen.
template <int D>
bool faces(const surface_part<D>& part, const point<D>& from) {
    return part.two_sided || dot(part.normal, from - part.corner[0]) >= 0;
}

}  // namespace detail

/// When shape B, moving by `translation`, first touches a surface or a compound; see shape_cast of convex shapes.
/// One-sided parts stop what begins before them. Cost: a cast for each part near the way.
template <class A, class B, class S, int D>
    requires detail::has_parts<A, D> && detail::has_core<B> cast_hit<S, D> cast_shape(
        const A& a, const B& b, const transform<S, D>& b_in_a, std::type_identity_t<vec<S, D>> translation,
        std::type_identity_t<S> maximum = S(1)) {
        using detail::point;
        const detail::core<D> shape = core_of(b);
        const mat<double, D> axes = detail::to_matrix(b_in_a.rotation);
        const point<D> from = detail::to_point(b_in_a.position), displacement = detail::to_point(translation);
        const aabb<double, D> start = detail::bounds_of(detail::placed_core<D>{&shape, axes, from}, 0.0);
        const aabb<double, D> box{min(start.lower, start.lower + displacement),
                                  max(start.upper, start.upper + displacement)};
        cast_hit<S, D> first;
        detail::each_piece(
            a, box, [&](const auto& part) { return detail::faces(part, axes * shape.center + from); },
            [&](const detail::core<D>& piece, const mat<double, D>& piece_axes, const point<D>& at, std::uint32_t) {
                const mat<double, D> back = transposed(piece_axes);
                const detail::core_pair<D> pair(piece, shape, back * axes, back * (from - at));
                const double left = detail::to_double(first ? first.fraction : maximum);
                cast_hit<S, D> hit = detail::cast_shapes<S>(pair, back * displacement, left);
                if (!hit || (first && !(hit.fraction < first.fraction))) return;
                hit.normal = detail::from_point<S>(piece_axes * detail::to_point(hit.normal));
                hit.point = detail::from_point<S>(piece_axes * detail::to_point(hit.point) + at);
                first = hit;
            });
        return first;
    }

/// Where a surface or a compound and a convex shape are closest, if they are not farther apart than `reach` (m); see
/// separation of convex shapes. Cost: one for each part within reach.
template <class A, class B, class S, int D>
    requires detail::has_parts<A, D> && detail::has_core<B> closest_points<S, D> separation(
        const A& a, const B& b, const transform<S, D>& b_in_a, std::type_identity_t<S> reach) {
        using detail::point;
        const detail::core<D> shape = core_of(b);
        const mat<double, D> axes = detail::to_matrix(b_in_a.rotation);
        const point<D> from = detail::to_point(b_in_a.position);
        closest_points<S, D> best;
        best.distance = scalar_traits<S>::max();
        detail::each_piece(
            a, detail::bounds_of(detail::placed_core<D>{&shape, axes, from}, detail::to_double(reach)),
            [](const auto&) { return true; },
            [&](const detail::core<D>& piece, const mat<double, D>& piece_axes, const point<D>& at, std::uint32_t) {
                const mat<double, D> back = transposed(piece_axes);
                const detail::core_pair<D> pair(piece, shape, back * axes, back * (from - at));
                const auto s = detail::separate<S>(pair, detail::no_limit, nullptr);
                closest_points<S, D> c = detail::rounded<S>(pair, s);
                if (c.distance > reach || !(c.distance < best.distance)) return;
                c.normal = detail::from_point<S>(piece_axes * s.normal);
                c.on_a = detail::from_point<S>(piece_axes * detail::to_point(c.on_a) + at);
                c.on_b = detail::from_point<S>(piece_axes * detail::to_point(c.on_b) + at);
                best = c;
            });
        return best;
    }

PHYSICS_HPP_END
