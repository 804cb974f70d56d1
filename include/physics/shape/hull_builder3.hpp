// Convex polyhedra from points.
#pragma once

#include "physics/shape/hull_faces.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Shortens the list to those points that are corners of triangles and not to be dropped.
inline void keep_corners(buffer<vec<double, 3>>& points, const buffer<hull_triangle>& triangles,
                         const buffer<bool>& drop) {
    buffer<bool> used;
    used.resize(points.size(), false);
    for (const hull_triangle& t : triangles)
        for (const std::uint32_t v : t.corner) used[v] = true;
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < points.size(); ++i)
        if (used[i] && !drop[i]) points[count++] = points[i];
    points.resize(count);
}

/// The convex polyhedron around points that it sorts; empty after a refusal. Exact but for what a tolerance (m) allows:
/// faces join triangles that are flat within it, and vertices go that are within it of a face or of an edge's line, or
/// within four of it of another vertex. Without superfluous vertices, regions are joined to convex faces in any order;
/// hence hulls are built anew of the others, at most six times. Points end up at most one tolerance outside, among
/// noise of the tolerance's size eight. most: if not 0, no more vertices than that, those that reach farthest.
/// Cost: see quickhull.
inline hull_outline<3> build_outline(buffer<vec<double, 3>>& points, double tolerance, std::uint32_t maximum,
                                     const char* function) {
    hull_outline<3> result;
    sort_points(points, power_above(reach_of(points)));
    buffer<hull_triangle> triangles;
    buffer<bool> drop;
    buffer<vec<double, 3>> all;
    double thickness = 0;
    for (int round = 0;; ++round) {
        quickhull hull;
        if (!hull.build(points.begin(), points.size(), tolerance, thickness)) break;
        hull.collect(triangles);
        hull_faces faces(points.begin(), triangles, tolerance);
        if (round < 6 && faces.drop_superfluous(points.size(), drop)) {
            keep_corners(points, triangles, drop);
            if (points.size() < 4) break;
            continue;
        }
        faces.join(points.size(), result);
        if (maximum > 0 && result.vertices.size() > maximum) {
            quickhull simpler;
            all = points = result.vertices;
            result = {};
            if (!simpler.build(points.begin(), points.size(), tolerance, thickness, maximum)) break;
            simpler.collect(triangles);
            drop.clear();
            drop.resize(points.size(), false);
            keep_corners(points, triangles, drop);
            round = 0;
            continue;
        }
        if (!check_hull_size<3>(function, result.vertices.size())) return {};
        if (result.vertices.size() < 4 || result.face_count() < 4) break;
        result.tolerance = tolerance;
        for (std::uint32_t f = 0; f < result.face_count() && !all.empty(); ++f) {
            const std::uint16_t* corners = result.face_vertices.begin() + result.face_begin[f];
            const vec<double, 3>& on = result.vertices[corners[0]];
            const vec<double, 3> n =
                hull_normal(result.vertices.begin(), corners, result.face_begin[f + 1] - result.face_begin[f]);
            for (const vec<double, 3>& p : all) result.shortfall = max(result.shortfall, dot(n, p - on));
        }
        return result;
    }
    refuse_thickness<3>(function, thickness);
    return {};
}

}  // namespace detail

PHYSICS_HPP_END
