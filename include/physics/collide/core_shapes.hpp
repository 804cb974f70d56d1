// The cores of segments, triangles, rounded boxes, cylinders and cones.
#pragma once

#include "physics/shape/cone.hpp"
#include "physics/shape/core.hpp"
#include "physics/shape/cylinder.hpp"
#include "physics/shape/rounded_box.hpp"
#include "physics/shape/segment.hpp"
#include "physics/shape/triangle.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// How far a core with these corners reaches along any direction, or more.
template <int D>
double extent_of_corners(const core<D>& c, int count) {
    double maximum = 0;
    for (int i = 0; i < count; ++i) {
        double sum = 0;
        for (int k = 0; k < D; ++k) sum += abs(c.corner[i][k]);
        maximum = max(maximum, sum);
    }
    return maximum;
}
inline core<3> core_of_frustum(const discs<double>& d) {
    core<3> c;
    c.kind = core_kind::disc;
    c.corner[0] = {d.half, d.low, d.high};
    c.radius = d.rounding;
    c.extent = d.half + max(d.low, d.high);
    // Across the side, or along the axis.
    const double slope = d.low - d.high, side = sqrt(4 * d.half * d.half + slope * slope);
    c.thickness = min(d.half, max(d.low, d.high) * (2 * d.half / side));
    return c;
}

}  // namespace detail

template <class S, int D>
detail::core<D> core_of(const segment<S, D>& s) {
    detail::core<D> c;
    c.kind = detail::core_kind::segment;
    c.corner[0] = detail::to_point(s.a);
    c.corner[1] = detail::to_point(s.b);
    c.center = (c.corner[0] + c.corner[1]) * 0.5;
    c.extent = detail::extent_of_corners(c, 2);
    c.radius = detail::to_double(s.radius);
    return c;
}
template <class S, int D>
detail::core<D> core_of(const triangle<S, D>& t) {
    detail::core<D> c;
    c.kind = detail::core_kind::triangle;
    c.corner[0] = detail::to_point(t.a);
    c.corner[1] = detail::to_point(t.b);
    c.corner[2] = detail::to_point(t.c);
    c.center = c.corner[0] + (c.corner[1] - c.corner[0] + (c.corner[2] - c.corner[0])) * (1.0 / 3);
    c.extent = detail::extent_of_corners(c, 3);
    if (D == 2) c.thickness = 0.5 * detail::sizes_of(t).height;
    c.radius = detail::to_double(t.radius);
    return c;
}
template <class S, int D>
detail::core<D> core_of(const rounded_box<S, D>& b) {
    detail::core<D> c = core_of(box<S, D>{b.half_extents});
    c.radius = detail::to_double(b.radius);
    return c;
}
template <class S>
detail::core<3> core_of(const cylinder<S, 3>& c) {
    return detail::core_of_frustum(detail::frustum_of(c.template as<double>()));
}
template <class S>
detail::core<3> core_of(const cone<S, 3>& c) {
    return detail::core_of_frustum(detail::frustum_of(c.template as<double>()));
}

PHYSICS_HPP_END
