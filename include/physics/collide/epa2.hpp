// How deep two convex sets in 2D overlap: EPA.
#pragma once

#include "physics/collide/epa3.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A growing convex polygon of vertices of B - A, counter-clockwise; edge i leads from vertex i to the next.
class cso_polygon {
public:
    static constexpr int max_vertices = 128;

    cso_polygon(const cso_vertex<2>& a, const cso_vertex<2>& b, const cso_vertex<2>& c) {
        put(a, b);
        put(b, c);
        put(c, a);
    }
    [[nodiscard]] const cso_vertex<2>& vertex(int i) const { return at(i).vertex; }
    [[nodiscard]] const point<2>& normal(int i) const { return at(i).normal; }
    [[nodiscard]] double distance(int i) const { return at(i).distance; }
    [[nodiscard]] int after(int i) const { return i + 1 < count_ ? i + 1 : 0; }
    [[nodiscard]] bool full() const { return count_ == max_vertices; }
    /// The edge that is closest to the origin, seen from within; its distance is negative if the origin is outside.
    [[nodiscard]] int closest() const {
        int best = 0;
        for (int i = 1; i < count_; ++i)
            if (distance(i) < distance(best)) best = i;
        return best;
    }
    /// Takes another distance for an edge; false if that is what it was. Short edges have normals that are not quite
    /// what their ends say exactly.
    bool correct(int i, double distance) {
        double& now = rings_[now_][i].distance;
        // Nothing has changed for the better where it is no number.
        const bool changed = distance < now || distance > now;
        now = distance;
        return changed;
    }
    /// Adds a vertex that lies beyond the edge `seen`; what it sees besides goes too.
    void add(const cso_vertex<2>& v, int seen, const orientation& grid) {
        const auto before = [&](int i) { return i > 0 ? i - 1 : count_ - 1; };
        const auto sees = [&](int i) { return grid.of(vertex(i).w, vertex(after(i)).w, v.w) < 0; };
        int first = seen, last = after(seen);
        while (sees(before(first)) && before(first) != last) first = before(first);
        while (sees(last) && after(last) != first) last = after(last);
        const auto& old = rings_[now_];
        auto& grown = rings_[1 - now_];
        int kept = 0;
        for (int i = last; i != first; i = after(i)) grown[kept++] = old[i];
        now_ = 1 - now_;
        count_ = kept;
        put(old[first].vertex, v);
        put(v, old[last].vertex);
    }

private:
    struct corner {
        cso_vertex<2> vertex;
        point<2> normal;
        double distance;
    };
    [[nodiscard]] const corner& at(int i) const { return rings_[now_][i]; }
    void put(const cso_vertex<2>& from, const cso_vertex<2>& to) {
        const point<2> n = unit(perpendicular(to.w - from.w));
        rings_[now_][count_++] = {from, n, dot(n, from.w)};
    }

    raw_array<corner, max_vertices> rings_[2];
    int now_ = 0, count_ = 0;
};

/// Completes a simplex to a triangle; false if B - A is flat. Of that, `normal` is then a unit vector across it.
inline bool make_triangle(const core<2>& a, const placed_core<2>& b, const simplex<2>& s, double noise,
                          const orientation& grid, cso_vertex<2> (&v)[3], point<2>& normal) {
    int count = s.count;
    for (int i = 0; i < count; ++i) v[i] = s.vertex[i];
    if (count < 2 || !(largest(v[1].w - v[0].w) > noise)) {
        double farthest = 0;
        for (int i = 0; i < 4; ++i) {
            point<2> n;
            n[i & 1] = i < 2 ? 1 : -1;
            const cso_vertex<2> p = support_along(a, b, n);
            if (!(largest(p.w - v[0].w) > farthest)) continue;
            farthest = largest(p.w - v[0].w);
            v[1] = p;
        }
        normal = {1, 0};
        if (!(farthest > noise)) return false;
        count = 2;
    }
    normal = perpendicular(unit(v[1].w - v[0].w));
    if (count < 3 || !(abs(dot(normal, v[2].w - v[0].w)) > noise)) {
        const cso_vertex<2> p = support_along(a, b, normal), q = support_along(a, b, -normal);
        v[2] = abs(dot(normal, p.w - v[0].w)) > abs(dot(normal, q.w - v[0].w)) ? p : q;
    }
    const int side = grid.of(v[0].w, v[1].w, v[2].w);
    if (side < 0) std::swap(v[1], v[2]);
    return side != 0;
}

/// The penetration of two cores in 2D that GJK found to overlap; see the one in 3D.
inline penetration<2> epa(const core<2>& a, const placed_core<2>& b, const simplex<2>& from, double tolerance) {
    const double size = power_above(extent_of(a, b)), noise = 0x1p-48 * size;
    const orientation grid(size);
    penetration<2> best;
    cso_vertex<2> first[3];
    point<2> flat;
    if (!make_triangle(a, b, from, noise, grid, first, flat)) {
        best.normal = dot(flat, b.at) < 0 ? -flat : flat;
        simplex<2> touching = from;
        touching.keep(closest_of_simplex(from, false, true));
        best.on_a = touching.on_a();
        for (int i = 0; i < 3; ++i) best.names[i] = touching.vertex[i < touching.count ? i : 0].name;
        return best;
    }
    cso_polygon hull(first[0], first[1], first[2]);
    for (;;) {
        const int f = hull.closest();
        const point<2> n = hull.normal(f);
        const cso_vertex<2> next = support_along(a, b, -n);
        const double h = dot(n, next.w);
        const cso_vertex<2> p = hull.vertex(f);
        const cso_vertex<2> q = hull.vertex(hull.after(f));
        bool converged = h - hull.distance(f) <= tolerance;
        if (!converged && grid.of(p.w, q.w, next.w) >= 0) {
            if (hull.correct(f, h)) continue;
            converged = true;
        }
        if (converged || hull.full()) {
            if (!converged) best.status = query_status::iteration_limit;
            best.normal = -n;
            best.depth = h;
            const closest_of<2> at = closest_on_edge(p.w, q.w);
            for (int i = 0; i < at.count; ++i) best.on_a += (at.vertex[i] == 0 ? p : q).on_a * at.weight[i];
            best.names[0] = p.name;
            best.names[1] = best.names[2] = q.name;
            best.located = at.count == 2;
            if (!best.located && best.depth <= 0.25 * noise && from.count < 3)
                keep_faces_at_distance_zero(from, 0.25 * noise, best);
            return best;
        }
        hull.add(next, f, grid);
    }
}

}  // namespace detail

PHYSICS_HPP_END
