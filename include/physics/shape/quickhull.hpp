// The convex hull of points in 3D, as triangles: exact, whatever lies in one plane or on one line.
#pragma once

#include "physics/base/handle.hpp"
#include "physics/shape/hull_builder2.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Triangles that enclose all points: corners counter-clockwise as seen from outside; next[i] is the triangle across
/// the edge from corner[i] to corner[i + 1].
struct hull_triangle {
    std::uint32_t corner[3];
    std::uint32_t next[3];

    /// Which of its corners a vertex is.
    [[nodiscard]] std::uint32_t find(std::uint32_t vertex) const {
        return corner[0] == vertex ? 0 : corner[1] == vertex ? 1 : 2;
    }
};
inline std::uint32_t next_corner(std::uint32_t i) { return i < 2 ? i + 1 : 0; }
inline std::uint32_t previous_corner(std::uint32_t i) { return i > 0 ? i - 1 : 2; }

/// Quickhull with exact predicates: no triangle ever has a point outside that was taken for inside. A face of more
/// corners comes as triangles in one plane; points within it or on its edges may or may not be corners of these. What
/// it gives depends on the order of the points. Cost: O(n log n) on most input, 0.5 us a point where all are vertices.
/// Source: Barber, Dobkin, Huhdanpaa, The quickhull algorithm for convex hulls (1996).
class quickhull {
public:
    /// points: each once. False, and the thickness by which the points miss a volume, if it is at most `tolerance`.
    /// most: if not 0, takes the point that lies farthest outside of all until there are so many vertices, O(n) each.
    bool build(const vec<double, 3>* points, std::uint32_t count, double tolerance, double& thickness,
               std::uint32_t maximum = 0) {
        points_ = points;
        double reach = 0;
        for (std::uint32_t i = 0; i < count; ++i) reach = max(reach, largest(points[i]));
        grid_ = orientation(power_above(reach));
        std::uint32_t simplex[4];
        if (!choose_simplex(count, tolerance, simplex, thickness)) return false;
        next_point_.resize(count, none);
        facet_from_.resize(count, none);
        start(count, simplex);
        for (std::uint32_t vertices = 4; maximum > 0; ++vertices) {
            const std::uint32_t f = farthest_facet();
            if (f == none || vertices >= maximum) return true;
            add_farthest(f);
        }
        while (!pending_.empty()) {
            const std::uint32_t f = pending_.back();
            pending_.pop_back();
            if (facets_[f].alive && facets_[f].outside != none) add_farthest(f);
        }
        return true;
    }
    /// The triangles, packed.
    void collect(buffer<hull_triangle>& triangles) {
        buffer<std::uint32_t> number;
        number.resize(facets_.size(), none);
        std::uint32_t count = 0;
        for (std::uint32_t f = 0; f < facets_.size(); ++f)
            if (facets_[f].alive) number[f] = count++;
        triangles.clear();
        for (const facet& f : facets_) {
            if (!f.alive) continue;
            hull_triangle t = f.triangle;
            for (std::uint32_t& n : t.next) n = number[n];
            triangles.push_back(t);
        }
    }

private:
    static constexpr std::uint32_t none = null_index;
    struct facet {
        hull_triangle triangle;
        /// The points that it sees, a list, and the farthest of them with its height times twice the facet's area.
        std::uint32_t outside, farthest;
        double height;
        std::uint32_t seen_at;
        bool visible, alive;
        orientation::plane plane;
    };
    struct horizon_edge {
        std::uint32_t from, to, beyond;
    };

    /// Four points far apart. thickness: the largest distance from the first, the line or the plane of those before.
    bool choose_simplex(std::uint32_t count, double tolerance, std::uint32_t* simplex, double& thickness) const {
        const vec<double, 3> a = points_[0];
        const auto farthest = [&](auto&& distance) {
            std::uint32_t best = 0;
            thickness = 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                const double d = abs(distance(points_[i] - a));
                if (!(d > thickness)) continue;
                thickness = d;
                best = i;
            }
            return best;
        };
        simplex[0] = 0;
        simplex[1] = farthest([](const vec<double, 3>& q) { return length(q); });
        if (!(thickness > tolerance)) return false;
        const vec<double, 3> along = normalized(points_[simplex[1]] - a);
        simplex[2] = farthest([&](const vec<double, 3>& q) { return length(cross(along, q)); });
        if (!(thickness > tolerance)) return false;
        const vec<double, 3> n = normalized(cross(along, points_[simplex[2]] - a));
        simplex[3] = farthest([&](const vec<double, 3>& q) { return dot(n, q); });
        // Of three points near a line the normal is rounding, which makes them seem to lie beside their own plane.
        if (!(thickness > tolerance) || grid_.of(a, points_[simplex[1]], points_[simplex[2]], points_[simplex[3]]) == 0)
            return false;
        if (dot(n, points_[simplex[3]] - a) > 0) std::swap(simplex[1], simplex[2]);
        return true;
    }

    std::uint32_t new_facet(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        std::uint32_t f = facets_.size();
        if (free_.empty()) {
            facets_.resize(f + 1);
        } else {
            f = free_.back();
            free_.pop_back();
        }
        facet& made = facets_[f];
        made = {};
        made.triangle = {{a, b, c}, {none, none, none}};
        made.outside = made.farthest = none;
        made.alive = true;
        made.plane = {grid_, points_[a], points_[b], points_[c]};
        return f;
    }
    [[nodiscard]] bool sees(const facet& f, std::uint32_t point) const {
        const std::uint32_t* c = f.triangle.corner;
        return grid_.side(f.plane, points_[c[0]], points_[c[1]], points_[c[2]], points_[point]) > 0;
    }
    /// Whether a facet sees the point, which is then in its list.
    bool add_outside_point(facet& f, std::uint32_t point) {
        if (!sees(f, point)) return false;
        const double height = dot(f.plane.normal(), points_[point] - points_[f.triangle.corner[0]]);
        if (f.outside == none || height > f.height) {
            f.farthest = point;
            f.height = height;
        }
        next_point_[point] = f.outside;
        f.outside = point;
        return true;
    }

    /// s[3] lies below the plane of the three others, which are counter-clockwise from above.
    void start(std::uint32_t count, const std::uint32_t* s) {
        new_facet(s[0], s[1], s[2]);
        new_facet(s[0], s[3], s[1]);
        new_facet(s[1], s[3], s[2]);
        new_facet(s[2], s[3], s[0]);
        constexpr std::uint32_t next[4][3] = {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}};
        for (std::uint32_t f = 0; f < 4; ++f) {
            for (int k = 0; k < 3; ++k) facets_[f].triangle.next[k] = next[f][k];
            pending_.push_back(f);
        }
        for (std::uint32_t i = 0; i < count; ++i)
            for (std::uint32_t f = 0; f < 4; ++f)
                if (add_outside_point(facets_[f], i)) break;
    }

    /// The facet that sees a point from farthest.
    [[nodiscard]] std::uint32_t farthest_facet() const {
        std::uint32_t best = none;
        double distance = 0;
        for (std::uint32_t f = 0; f < facets_.size(); ++f) {
            if (!facets_[f].alive || facets_[f].outside == none) continue;
            const double d = facets_[f].height / length(facets_[f].plane.normal());
            if (!(d > distance)) continue;
            distance = d;
            best = f;
        }
        return best;
    }
    /// Replaces all facets that see the farthest point of facet f by those from it to their rim. The rim is one ring,
    /// and the point is on none of its edges' lines, since what sees it is exact.
    void add_farthest(std::uint32_t f) {
        const std::uint32_t p = facets_[f].farthest;
        ++stamp_;
        visible_.clear();
        horizon_.clear();
        facets_[f].seen_at = stamp_;
        facets_[f].visible = true;
        visible_.push_back(f);
        for (std::uint32_t i = 0; i < visible_.size(); ++i) {
            const hull_triangle t = facets_[visible_[i]].triangle;
            for (std::uint32_t k = 0; k < 3; ++k) {
                facet& g = facets_[t.next[k]];
                if (g.seen_at != stamp_) {
                    g.seen_at = stamp_;
                    g.visible = sees(g, p);
                    if (g.visible) visible_.push_back(t.next[k]);
                }
                if (!g.visible) horizon_.push_back({t.corner[k], t.corner[next_corner(k)], t.next[k]});
            }
        }
        made_.clear();
        for (const horizon_edge& e : horizon_) {
            const std::uint32_t made = new_facet(e.from, e.to, p);
            hull_triangle& beyond = facets_[e.beyond].triangle;
            beyond.next[beyond.find(e.to)] = made;
            facets_[made].triangle.next[0] = e.beyond;
            facet_from_[e.from] = made;
            made_.push_back(made);
        }
        for (const std::uint32_t made : made_) {
            hull_triangle& t = facets_[made].triangle;
            t.next[1] = facet_from_[t.corner[1]];
            facets_[t.next[1]].triangle.next[2] = made;
        }
        for (const std::uint32_t gone : visible_) {
            facets_[gone].alive = false;
            free_.push_back(gone);
            std::uint32_t next = none;
            for (std::uint32_t i = facets_[gone].outside; i != none; i = next) {
                next = next_point_[i];
                if (i == p) continue;
                for (const std::uint32_t made : made_)
                    if (add_outside_point(facets_[made], i)) break;
            }
        }
        for (const std::uint32_t made : made_)
            if (facets_[made].outside != none) pending_.push_back(made);
    }

    const vec<double, 3>* points_ = nullptr;
    orientation grid_{1};
    buffer<facet> facets_;
    buffer<std::uint32_t> free_, pending_, next_point_, facet_from_, visible_, made_;
    buffer<horizon_edge> horizon_;
    std::uint32_t stamp_ = 0;
};

}  // namespace detail

PHYSICS_HPP_END
