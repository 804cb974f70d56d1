// The face, edge or corner of a convex shape that touches what lies along a direction.
#pragma once

#include "physics/base/raw_array.hpp"
#include "physics/shape/core.hpp"
#include "physics/shape/hull_data.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The support feature of a core: the face, edge or vertex that is farthest along a direction (a supporting face in
/// Jolt). Faces of hulls with more vertices are reduced.
template <int D>
struct support_feature {
    static constexpr int capacity = D == 2 ? 2 : 32;
    /// Counter-clockwise as seen from outside; in 2D the right end first.
    raw_array<point<D>, capacity> corner;
    int count = 0;
    /// Unit vector outwards, of a face.
    point<D> normal;
    bool flat = false;
    /// Of a triangle's edge: the face beside it leads farther out still, and leans.
    bool leans_out = false;
    /// The number of the face, to name contacts.
    std::uint32_t number = 0;
};

inline void add_corner(support_feature<3>& f, double x, double y, double z) { f.corner[f.count++] = {x, y, z}; }

template <class R>
support_feature<3> hull_support_feature(const hull_data<R, 3>& h, const point<3>& n) {
    const R* const rows[3] = {h.face_normal(0), h.face_normal(1), h.face_normal(2)};
    support_feature<3> f;
    f.number = farthest_vertex<R, 3>(rows, h.padded_faces(), n);
    f.normal = h.normal(f.number);
    f.flat = true;
    const std::uint32_t begin = h.face_begin(f.number), count = h.face_end(f.number) - begin;
    const std::uint32_t kept =
        count < std::uint32_t{support_feature<3>::capacity} ? count : std::uint32_t{support_feature<3>::capacity};
    for (std::uint32_t i = 0; i < kept; ++i) {
        const std::uint32_t v = h.face_vertices()[begin + i * count / kept];
        add_corner(f, static_cast<double>(h.coordinate(0)[v]), static_cast<double>(h.coordinate(1)[v]),
                   static_cast<double>(h.coordinate(2)[v]));
    }
    return f;
}
template <class R>
support_feature<2> hull_support_feature(const hull_data<R, 2>& h, const point<2>& n) {
    const R* const rows[2] = {h.face_normal(0), h.face_normal(1)};
    support_feature<2> f;
    f.number = farthest_vertex<R, 2>(rows, h.padded_faces(), n);
    f.normal = h.normal(f.number);
    f.flat = true;
    f.count = 2;
    const std::uint32_t ends[2] = {f.number, f.number + 1 < h.vertex_count ? f.number + 1 : 0};
    for (int k = 0; k < 2; ++k)
        f.corner[k] = {static_cast<double>(h.coordinate(0)[ends[k]]), static_cast<double>(h.coordinate(1)[ends[k]])};
    return f;
}

/// The face of discs, or what there is in place of it that a unit vector points out of most: a point of the rim, or the
/// line on the side.
inline support_feature<3> disc_facet(const core<3>& c, const point<3>& n) {
    // The tilt (rad) above which nothing lies on a face any more, so that its rim touches in one point.
    constexpr double tilted = 0.1;
    support_feature<3> f;
    const double half = c.corner[0].x, low = c.corner[0].y, high = c.corner[0].z;
    const double across = physics::sqrt(n.y * n.y + n.z * n.z);
    // The outward normal of the side, in the plane of the axis and n.
    const double slope = low - high, side = physics::sqrt(4 * half * half + slope * slope);
    const double of_side = (n.x * slope + across * (2 * half)) / side;
    const bool upper = n.x > 0;
    const double r = upper ? high : low, x = upper ? half : -half;
    if (abs(n.x) > of_side && r > 0) {
        f.number = upper ? 2 : 1;
        if (across > tilted) {
            add_corner(f, x, r * (n.y / across), r * (n.z / across));
            return f;
        }
        // Corners that stay where they are on the disc as n changes.
        static constexpr double c1 = 0.92387953251128674, s1 = 0.38268343236508977, d = 0.70710678118654752;
        static constexpr double around[8][2] = {{1, 0}, {c1, s1},  {d, d},  {s1, c1},
                                                {0, 1}, {-s1, c1}, {-d, d}, {-c1, s1}};
        int lowest = 0;
        double maximum = 0;
        for (int i = 0; i < 16; ++i) {
            const int k = upper ? i : 15 - i;
            const double sign = k < 8 ? r : -r;
            add_corner(f, x, sign * around[k & 7][0], sign * around[k & 7][1]);
            const double out = n.y * f.corner[i].y + n.z * f.corner[i].z;
            if (out > maximum) maximum = out, lowest = i;
        }
        // But where the farthest point of the rim lies clearly beyond them, the nearest of them goes there.
        if (r * across - maximum > c.thickness * (1.0 / 1024))
            f.corner[lowest] = {x, r * (n.y / across), r * (n.z / across)};
        f.normal.x = upper ? 1 : -1;
        f.flat = true;
        return f;
    }
    const double y = across > 0 ? n.y / across : 1, z = across > 0 ? n.z / across : 0;
    add_corner(f, -half, low * y, low * z);
    add_corner(f, half, high * y, high * z);
    return f;
}

inline support_feature<3> triangle_facet(const core<3>& c, const point<3>& n) {
    support_feature<3> f;
    const point<3> e = c.corner[1] - c.corner[0], g = c.corner[2] - c.corner[0], h = g - e;
    const auto [up, doubled_area] = direction_and_length_of(cross(e, g));
    const double facing = dot(up, n);
    const bool back = facing < 0;
    f.number = std::uint32_t{back};
    // Of a needle there is no more than an edge.
    const bool needle = doubled_area * 256 < max(max(dot(e, e), dot(g, g)), dot(h, h));
    // Where it leans more, only an edge of it touches: by that it may lie on another one or on a side.
    if (abs(facing) > 0.9 && !needle) {
        f.count = 3;
        f.flat = true;
        f.normal = back ? -up : up;
        for (int i = 0; i < 3; ++i) f.corner[i] = c.corner[back ? 2 - i : i];
        return f;
    }
    // The edge that lies farthest out.
    int out = 0;
    const double reach[3] = {dot(n, c.corner[0]), dot(n, c.corner[1]), dot(n, c.corner[2])};
    for (int i = 1; i < 3; ++i)
        if (reach[i] + reach[i < 2 ? i + 1 : 0] > reach[out] + reach[out < 2 ? out + 1 : 0]) out = i;
    f.count = 2;
    f.number = 2 + static_cast<std::uint32_t>(out);
    f.corner[0] = c.corner[out];
    f.corner[1] = c.corner[out < 2 ? out + 1 : 0];
    // Only behind an obtuse corner can it: there n leads out of the triangle's round side beside that of the edge.
    const point<3> edge = f.corner[1] - f.corner[0], beside = c.corner[out > 0 ? out - 1 : 2] - f.corner[0];
    f.leans_out =
        facing * facing < 1 - 1.0 / 128 && dot(n, beside) * dot(edge, edge) > dot(n, edge) * dot(beside, edge);
    return f;
}

/// What a core turns towards the unit vector n, in the core's frame.
inline support_feature<3> support_feature_of(const core<3>& c, const point<3>& n) {
    support_feature<3> f;
    switch (c.kind) {
        case core_kind::segment:
            f.count = 2;
            f.corner[0] = c.corner[0];
            f.corner[1] = c.corner[1];
            break;
        case core_kind::triangle: return triangle_facet(c, n);
        case core_kind::box: {
            int axis = 0;
            // A lower number wins unless another face is clearly better, so that rounding does not choose.
            for (int i = 1; i < 3; ++i)
                if (abs(n[i]) > abs(n[axis]) + 1.0 / 1024) axis = i;
            const int u = axis < 2 ? axis + 1 : 0, v = axis > 0 ? axis - 1 : 2;
            const double sign = n[axis] < 0 ? -1 : 1;
            static constexpr double around[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
            f.count = 4;
            f.flat = true;
            f.normal[axis] = sign;
            f.number = static_cast<std::uint32_t>(axis) << 1 | std::uint32_t{sign > 0};
            for (int i = 0; i < 4; ++i) {
                f.corner[i][axis] = sign * c.corner[0][axis];
                f.corner[i][u] = sign * around[i][0] * c.corner[0][u];
                f.corner[i][v] = around[i][1] * c.corner[0][v];
            }
            break;
        }
        case core_kind::hull_of_floats:
            return hull_support_feature(*static_cast<const hull_data<float, 3>*>(c.data), n);
        case core_kind::hull_of_doubles:
            return hull_support_feature(*static_cast<const hull_data<double, 3>*>(c.data), n);
        case core_kind::disc: return disc_facet(c, n);
        case core_kind::point:
        case core_kind::custom: break;
    }
    return f;
}
inline support_feature<2> support_feature_of(const core<2>& c, const point<2>& n) {
    support_feature<2> f;
    switch (c.kind) {
        case core_kind::segment: {
            // Flat on both sides.
            const bool back = dot(perpendicular(c.corner[1] - c.corner[0]), n) < 0;
            f.corner[0] = c.corner[back ? 1 : 0];
            f.corner[1] = c.corner[back ? 0 : 1];
            f.number = std::uint32_t{back};
            break;
        }
        case core_kind::triangle: {
            int out = 0;
            double best = -2;
            const bool clockwise = cross(c.corner[1] - c.corner[0], c.corner[2] - c.corner[0]) < 0;
            for (int i = 0; i < 3; ++i) {
                const point<2> e = c.corner[i < 2 ? i + 1 : 0] - c.corner[i];
                const double facing = dot(normalized(perpendicular(clockwise ? -e : e)), n);
                if (facing > best) best = facing, out = i;
            }
            f.corner[clockwise ? 1 : 0] = c.corner[out];
            f.corner[clockwise ? 0 : 1] = c.corner[out < 2 ? out + 1 : 0];
            f.number = static_cast<std::uint32_t>(out);
            break;
        }
        case core_kind::box: {
            const int axis = abs(n.y) > abs(n.x) + 1.0 / 1024 ? 1 : 0;
            const double sign = n[axis] < 0 ? -1 : 1, across = axis == 0 ? sign : -sign;
            f.corner[0][axis] = f.corner[1][axis] = sign * c.corner[0][axis];
            f.corner[0][1 - axis] = -across * c.corner[0][1 - axis];
            f.corner[1][1 - axis] = across * c.corner[0][1 - axis];
            f.number = static_cast<std::uint32_t>(axis) << 1 | std::uint32_t{sign > 0};
            break;
        }
        case core_kind::hull_of_floats:
            return hull_support_feature(*static_cast<const hull_data<float, 2>*>(c.data), n);
        case core_kind::hull_of_doubles:
            return hull_support_feature(*static_cast<const hull_data<double, 2>*>(c.data), n);
        default: return f;
    }
    f.count = 2;
    f.flat = true;
    f.normal = normalized(perpendicular(f.corner[1] - f.corner[0]));
    return f;
}

template <int D>
support_feature<D> support_feature_of(const placed_core<D>& c, const point<D>& n) {
    support_feature<D> f = support_feature_of(*c.shape, transposed_times(c.axes, n));
    f.normal = c.axes * f.normal;
    for (int i = 0; i < f.count; ++i) f.corner[i] = c.axes * f.corner[i] + c.at;
    return f;
}

}  // namespace detail

PHYSICS_HPP_END
