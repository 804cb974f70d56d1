// Thickness and extent of bodies, for continuous collision.
#pragma once

#include "physics/collide/first_penetration.hpp"
#include "physics/collide/part_queries.hpp"
#include "physics/step/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Calls f(core, axes, at) for the convex pieces of a shape that may be swept, in its frame; surfaces and halfspaces,
/// which no dynamic body carries, have none.
template <class Shape, int D, class F>
void each_swept_piece(const Shape& shape, const aabb<double, D>& everywhere, F&& f) {
    if constexpr (has_core<Shape>) f(core_of(shape), mat<double, D>::identity(), point<D>{});
    else if constexpr (is_compound<Shape, D>)
        each_child(shape, everywhere, [&](const auto& child) { f(child.shape, child.axes, child.at); });
}

/// How far a core reaches from a point of its own frame.
template <int D>
PHYSICS_HPP_COLD double reach_from(const core<D>& c, const point<D>& center) {
    double square = 0;
    for (int i = 0; i < D; ++i) {
        point<D> n;
        n[i] = 1;
        const double far = max(abs(c.support(n).at[i] - center[i]), abs(c.support(-n).at[i] - center[i]));
        square += far * far;
    }
    return physics::sqrt(square);
}

/// Of a shape on a body: how thick its thinnest piece is, how far its cores reach from the centre of mass, and how far
/// all of it.
template <class Plan>
PHYSICS_HPP_COLD body_extent<typename Plan::scalar> measure_shape(const shape_record<Plan>& record,
                                                                  const typename Plan::body& body) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const point<D> center = to_point(body.mass.center);
    double thickness = no_limit, reach = 0, outer = 0;
    const mat<double, D> axes = to_matrix(record.local.rotation);
    const point<D> at = transposed_times(axes, center - to_point(record.local.position));
    record.shape.visit([&](const auto& shape) {
        each_swept_piece(shape, everywhere(record.local.rotation),
                         [&](const core<D>& c, const mat<double, D>& turned, const point<D>& where) {
                             const double far = reach_from(c, transposed_times(turned, at - where));
                             thickness = min(thickness, inradius_of<Plan::few_corners>(c));
                             reach = max(reach, far);
                             outer = max(outer, far + c.radius);
                         });
    });
    // Of what has no pieces, a box.
    if (!body.is_dynamic()) {
        const auto box = bounds(record.shape, record.local);
        double square = 0;
        for (int i = 0; i < D; ++i) {
            const double far =
                max(abs(detail::to_double(box.lower[i]) - center[i]), abs(detail::to_double(box.upper[i]) - center[i]));
            square += far * far;
        }
        outer = max(outer, physics::sqrt(square));
    }
    const double maximum = static_cast<double>(scalar_traits<S>::max()) * 0.25;
    return {static_cast<S>(min(thickness, maximum)), static_cast<S>(min(reach, maximum)), min(outer, maximum)};
}
/// Of a body with one more shape.
template <class S>
body_extent<S> merged(const body_extent<S>& a, const body_extent<S>& b) {
    return {min(a.thickness, b.thickness), max(a.reach, b.reach), max(a.outer, b.outer)};
}
/// Of a body, as of all its shapes.
template <class Plan>
body_extent<typename Plan::scalar> measure_body(const pool<typename Plan::body>& bodies, const shape_pool<Plan>& shapes,
                                                std::uint32_t index) {
    using S = typename Plan::scalar;
    body_extent<S> all{static_cast<S>(static_cast<double>(scalar_traits<S>::max()) * 0.25), {}, 0};
    each_solid_shape<Plan>(bodies, shapes, index, [&](std::uint32_t, const shape_record<Plan>& record) {
        all = merged(all, measure_shape(record, bodies[index]));
    });
    return all;
}

}  // namespace detail

PHYSICS_HPP_END
