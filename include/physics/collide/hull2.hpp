// Contact of convex polygons of a few vertices in 2D.
#pragma once

#include "physics/collide/patch.hpp"
#include "physics/collide/polygon2.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Polygons of more vertices are quicker by GJK; thin ones need its precision.
inline constexpr int max_separating_edges = 8;

template <class S>
bool is_small(const hull<S, 2>& h) {
    return h.geometry->vertex_count <= std::uint32_t{max_separating_edges} &&
           h.geometry->inradius > 0x1p-7 * h.geometry->reach;
}
/// In its own frame, and in another one.
template <int N, class S>
rounded_polygon<S, N> polygon_of(const hull<S, 2>& h) {
    const auto& data = *h.geometry;
    rounded_polygon<S, N> p;
    p.count = static_cast<int>(data.vertex_count);
    p.radius = h.radius;
    p.size = static_cast<S>(data.inradius) + h.radius;
    if constexpr (N == 8 && std::same_as<S, hull_real<S>>) {
        // Its rows are as long, and filled up in the same way.
        for (int axis = 0; axis < 2; ++axis) {
            std::memcpy(p.vertices[axis], data.coordinate(axis), sizeof p.vertices[axis]);
            std::memcpy(p.normals[axis], data.face_normal(axis), sizeof p.normals[axis]);
        }
    } else {
        for (int i = 0; i < p.count; ++i) {
            const auto k = static_cast<std::uint32_t>(i);
            p.set(i, from_point<S>(data.exact_vertex(k)), from_point<S>(data.normal(k)));
        }
        p.fill_up();
    }
    return p;
}
template <int N, class S>
rounded_polygon<S, N> polygon_of(const hull<S, 2>& h, const transform<S, 2>& at) {
    using P = typename rounded_polygon<S, N>::lanes;
    rounded_polygon<S, N> p = polygon_of<N>(h);
    const mat<S, 2> m = matrix(at.rotation);
    const P xx = P::broadcast(m.column[0].x), xy = P::broadcast(m.column[1].x);
    const P yx = P::broadcast(m.column[0].y), yy = P::broadcast(m.column[1].y);
    const P at_x = P::broadcast(at.position.x), at_y = P::broadcast(at.position.y);
    for (int i = 0; i < N; i += P::width) {
        const P x = P::load(p.vertices[0] + i), y = P::load(p.vertices[1] + i);
        const P n_x = P::load(p.normals[0] + i), n_y = P::load(p.normals[1] + i);
        (lane_sum(xx, x, xy, y) + at_x).store(p.vertices[0] + i);
        (lane_sum(yx, x, yy, y) + at_y).store(p.vertices[1] + i);
        lane_sum(xx, n_x, xy, n_y).store(p.normals[0] + i);
        lane_sum(yx, n_x, yy, n_y).store(p.normals[1] + i);
    }
    return p;
}
/// Whether circles around the origins of their frames part two hulls.
template <class S>
bool are_far_apart(const hull<S, 2>& a, const hull<S, 2>& b, const vec<S, 2>& offset, S margin) {
    const double x = to_double(offset.x), y = to_double(offset.y);
    const double reach = (a.geometry->span + b.geometry->span) * (1 + 0x1p-20) + to_double(a.radius) +
                         to_double(b.radius) + to_double(margin);
    return x * x + y * y > reach * reach;
}
/// By separating edges where both are small.
template <class A, class S>
void collide_with_hull(const A& a, const hull<S, 2>& b, bool small, const transform<S, 2>& b_in_a, S margin,
                       manifold<S, 2>& out) {
    constexpr int maximum = max_separating_edges;
    if (small) collide_polygons(polygon_of<maximum>(a), polygon_of<maximum>(b, b_in_a), margin, out);
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
