// Contact of convex polygons of a few vertices in the plane.
#pragma once

#include "physics/collide/patch.hpp"
#include "physics/collide/polygon2.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Polygons of more vertices are quicker by GJK; thin ones need its precision.
inline constexpr int most_separating_edges = 8;

template <class S>
bool is_small(const hull<S, 2>& h) {
    return h.geometry->vertex_count <= std::uint32_t{most_separating_edges} &&
           h.geometry->inradius > 0x1p-7 * h.geometry->reach;
}
template <int N, class S>
rounded_polygon<S, N> polygon_of(const hull<S, 2>& h, const transform<S, 2>& at) {
    const auto& data = *h.geometry;
    const mat<S, 2> m = matrix(at.rotation);
    rounded_polygon<S, N> p;
    p.count = static_cast<int>(data.vertex_count);
    p.radius = h.radius;
    p.size = static_cast<S>(data.inradius) + h.radius;
    for (int i = 0; i < p.count; ++i) {
        const auto k = static_cast<std::uint32_t>(i);
        if constexpr (std::same_as<S, hull_real<S>>) {
            p.vertex[i] = m * data.vertex(k) + at.position;
            p.normal[i] = m * vec<S, 2>{data.face_normal(0)[k], data.face_normal(1)[k]};
        } else {
            p.vertex[i] = m * from_point<S>(data.exact_vertex(k)) + at.position;
            p.normal[i] = m * from_point<S>(data.normal(k));
        }
    }
    return p;
}
/// Whether circles around the origins of their frames part two hulls.
template <class S>
bool are_far_apart(const hull<S, 2>& a, const hull<S, 2>& b, const vec<S, 2>& way, S margin) {
    const double x = to_double(way.x), y = to_double(way.y);
    const double reach = (a.geometry->span + b.geometry->span) * (1 + 0x1p-20) + to_double(a.radius) +
                         to_double(b.radius) + to_double(margin);
    return x * x + y * y > reach * reach;
}
/// By separating edges where both are small.
template <class A, class S>
void collide_with_hull(const A& a, const hull<S, 2>& b, bool small, const transform<S, 2>& b_in_a, S margin,
                       manifold<S, 2>& out) {
    constexpr int most = most_separating_edges;
    if (small) collide_polygons(polygon_of<most>(a, {}), polygon_of<most>(b, b_in_a), margin, out);
    else collide_cores(a, b, b_in_a, margin, nullptr, overlap_method::epa, out);
}

}  // namespace detail

template <class S>
void collide(const capsule<S, 2>& a, const hull<S, 2>& b, const transform<S, 2>& b_in_a, S margin,
             manifold<S, 2>& out) {
    detail::collide_with_hull(a, b, detail::is_small(b), b_in_a, margin, out);
}
template <class S>
void collide(const box<S, 2>& a, const hull<S, 2>& b, const transform<S, 2>& b_in_a, S margin, manifold<S, 2>& out) {
    detail::collide_with_hull(a, b, detail::is_small(b), b_in_a, margin, out);
}
template <class S>
void collide(const hull<S, 2>& a, const hull<S, 2>& b, const transform<S, 2>& b_in_a, S margin, manifold<S, 2>& out) {
    if (detail::are_far_apart(a, b, b_in_a.position, margin)) return;
    detail::collide_with_hull(a, b, detail::is_small(a) && detail::is_small(b), b_in_a, margin, out);
}

PHYSICS_HPP_END
