// How deep two convex sets in 3D overlap: EPA.
#pragma once

#include "physics/base/raw_array.hpp"
#include "physics/collide/gjk.hpp"
#include "physics/space/orientation.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// How deep two cores overlap: the least translation of B along `normal` that parts them.
template <int D>
struct penetration {
    /// Of unit length, from A to B.
    point<D> normal;
    /// Negative where rounding has parted the cores.
    double depth = 0;
    /// The points that touch once B has been moved by depth along the normal; A's. Not so where it is not `located`:
    /// then only near, see locate().
    point<D> on_a;
    bool located = true;
    /// The vertices between which that point lies, as in cso_vertex.
    std::uint32_t names[3] = {};
    query_status status = query_status::converged;
};

/// A growing convex polyhedron of vertices of B - A. Its faces are found by exact orientation, so that it stays closed
/// and convex whatever rounding does: each new vertex lies beyond at least one face, and no face is ever without area.
class cso_hull {
public:
    static constexpr int max_vertices = 160, max_faces = 2 * max_vertices;
    using index = std::uint16_t;

    struct face {
        /// Outwards, of twice the triangle's area.
        point<3> normal;
        double squared_normal;
        /// dot(normal, p) of its points, and what rounding and the grid may change in such a product.
        double height, error;
        index vertex[3];
        /// Across the edges 0-1, 1-2, 2-0.
        index neighbour[3];
    };

    /// Begins with a tetrahedron: three points that are counter-clockwise as seen from outside, and one behind them.
    cso_hull(const orientation& grid, double size, const raw_array<cso_vertex<3>, 4>& v)
        : grid_(grid), size_(size), minimum_error_(size * size * size * 0x1p-53) {
        for (int i = 0; i < 4; ++i) vertices_[i] = v[i];
        vertex_count_ = 4;
        set(0, 0, 1, 2, 1, 2, 3);
        set(1, 0, 3, 1, 3, 2, 0);
        set(2, 1, 3, 2, 1, 3, 0);
        set(3, 2, 3, 0, 2, 1, 0);
        face_count_ = 4;
    }

    [[nodiscard]] const cso_vertex<3>& vertex(int i) const { return vertices_[i]; }
    [[nodiscard]] const face& at(int i) const { return faces_[i]; }
    [[nodiscard]] bool full() const { return vertex_count_ == max_vertices; }
    /// The face that is closest to the origin, seen from within; the origin may be outside.
    [[nodiscard]] int closest() const {
        int best = 0;
        double minimum = key_[0];
        for (int i = 1; i < face_count_; ++i) {
            best = key_[i] < minimum ? i : best;
            minimum = min(key_[i], minimum);
        }
        return best;
    }
    /// Takes for a face's distance what its normal, times `height`, says; false if that is what it was. Thin faces have
    /// normals that are not quite what their corners say exactly.
    bool correct(int f, double height) {
        const double key = key_of(height, faces_[f].squared_normal);
        // Nothing has changed for the better where it is no number.
        const bool changed = key < key_[f] || key > key_[f];
        key_[f] = key;
        return changed;
    }
    /// On which side of a face a point lies: 1 where it sees it.
    [[nodiscard]] int side(int f, const point<3>& p) const {
        const face& it = faces_[f];
        const double det = dot(it.normal, p) - it.height;
        if (det > it.error) return 1;
        if (det < -it.error) return -1;
        return grid_.exact_side(w(it.vertex[0]), w(it.vertex[1]), w(it.vertex[2]), p);
    }

    /// Adds a vertex that lies beyond the face `seen`. The hull must not be full.
    void add(const cso_vertex<3>& v, int seen) {
        const int apex = vertex_count_++;
        vertices_[apex] = v;
        find_horizon(v.w, seen);
        // A fan around the vertex.
        const int first = free_face();
        int before = first, now = first;
        point<3> e = w(horizon_[0].from) - v.w;
        double ee = dot(e, e);
        for (int i = 0; i < horizon_count_; ++i) {
            const edge& h = horizon_[i];
            const int after = i + 1 < horizon_count_ ? free_face() : first;
            const point<3> g = w(h.to) - v.w;
            const double gg = dot(g, g);
            faces_[h.beyond].neighbour[h.of_beyond] = static_cast<index>(now);
            link(now, h.from, h.to, apex, h.beyond, after, before);
            shape(now, e, g, ee, gg);
            before = now;
            now = after;
            e = g;
            ee = gg;
        }
        faces_[first].neighbour[2] = static_cast<index>(before);
    }

private:
    /// Between a face that a new vertex sees and one beyond, as the first one has it.
    struct edge {
        index from, to, beyond, of_beyond;
    };
    struct crossing {
        index into, from;
    };

    [[nodiscard]] const point<3>& w(int i) const { return vertices_[i].w; }
    [[nodiscard]] int free_face() { return spare_count_ > 0 ? spare_[--spare_count_] : face_count_++; }
    /// All faces that see a point become spare; the edges between them and the others are found in order, since each
    /// face is left where it was entered.
    void find_horizon(const point<3>& p, int seen) {
        int open = 0;
        horizon_count_ = 0;
        const auto leave = [&](int f) {
            key_[f] = gone;
            spare_[spare_count_++] = static_cast<index>(f);
        };
        const auto cross_edge = [&](int f, int e) { todo_[open++] = {faces_[f].neighbour[e], static_cast<index>(f)}; };
        leave(seen);
        for (int e = 2; e >= 0; --e) cross_edge(seen, e);
        while (open > 0) {
            const crossing c = todo_[--open];
            if (key_[c.into] == gone) continue;
            const face& it = faces_[c.into];
            const int e = it.neighbour[0] == c.from ? 0 : it.neighbour[1] == c.from ? 1 : 2;
            const int next = e < 2 ? e + 1 : 0;
            if (side(c.into, p) > 0) {
                leave(c.into);
                cross_edge(c.into, e > 0 ? e - 1 : 2);
                cross_edge(c.into, next);
            } else {
                horizon_[horizon_count_++] = {it.vertex[next], it.vertex[e], c.into, static_cast<index>(e)};
            }
        }
    }
    void link(int f, int a, int b, int c, int ab, int bc, int ca) {
        face& it = faces_[f];
        it.vertex[0] = static_cast<index>(a);
        it.vertex[1] = static_cast<index>(b);
        it.vertex[2] = static_cast<index>(c);
        it.neighbour[0] = static_cast<index>(ab);
        it.neighbour[1] = static_cast<index>(bc);
        it.neighbour[2] = static_cast<index>(ca);
    }
    void set(int f, int a, int b, int c, int ab, int bc, int ca) {
        link(f, a, b, c, ab, bc, ca);
        const point<3> e = w(a) - w(c), g = w(b) - w(c);
        shape(f, e, g, dot(e, e), dot(g, g));
    }
    /// Measures a face that is linked, from the edges from its last vertex to the other two, and their squares.
    PHYSICS_HPP_ALWAYS_INLINE void shape(int f, const point<3>& e, const point<3>& g, double ee, double gg) {
        face& it = faces_[f];
        point<3> n = cross(e, g);
        double nn = dot(n, n);
        // Of thin triangles the shorter edges give the better normal.
        if (!(nn > 0x1p-8 * ee * gg)) {
            n = normal_by_shorter_edges(w(it.vertex[0]), w(it.vertex[1]), w(it.vertex[2]));
            nn = dot(n, n);
        }
        const double height = dot(n, w(it.vertex[2]));
        it.normal = n;
        it.squared_normal = nn;
        it.height = height;
        // Products of coordinates below size, and differences that the grid moves by 2 steps of size * 2^-59.
        it.error = size_ * ((ee + gg) * 0x1p-44) + minimum_error_;
        // Faces so thin that rounding leaves no normal take no part: beside them are others in the same plane.
        key_[f] = nn > 0 ? key_of(height, nn) : never;
    }
    [[nodiscard]] static double key_of(double height, double squared_normal) {
        return height * abs(height) / squared_normal;
    }
    /// In place of a face's key: it is none to be chosen; no face is here, but for one that is about to go.
    static constexpr double never = 1e300, gone = 1.7976931348623157e308;

    orientation grid_;
    double size_, minimum_error_;
    int vertex_count_ = 0, face_count_ = 0, horizon_count_ = 0, spare_count_ = 0;
    raw_array<cso_vertex<3>, max_vertices> vertices_;
    raw_array<face, max_faces> faces_;
    /// The squares of the faces' distances from the origin, with the distances' signs.
    raw_array<double, max_faces> key_;
    raw_array<index, max_faces> spare_;
    raw_array<edge, max_faces> horizon_;
    raw_array<crossing, 2 * max_faces> todo_;
};

/// Completes a simplex to a tetrahedron, as cso_hull takes it, with the farthest points beside it; false if B - A is
/// flat. Of that, `normal` is then a unit vector across it.
inline bool make_tetrahedron(const core<3>& a, const placed_core<3>& b, const simplex<3>& s, double noise,
                             const orientation& grid, raw_array<cso_vertex<3>, 4>& v, point<3>& normal) {
    int count = s.count;
    for (int i = 0; i < count; ++i) v[i] = s.vertex[i];
    const auto has_volume = [&] {
        const int side = grid.of(v[0].w, v[1].w, v[2].w, v[3].w);
        if (side > 0) std::swap(v[1], v[2]);
        return side != 0;
    };
    if (count == 4 && has_volume()) return true;
    // The farthest of the supports along n and -n from what measure() takes for the simplex so far.
    double farthest = 0;
    const auto look = [&](const point<3>& n, int into, auto&& measure) {
        for (const double sign : {1.0, -1.0}) {
            const cso_vertex<3> p = support_along(a, b, n * sign);
            const double far = measure(p.w - v[0].w);
            if (!(far > farthest)) continue;
            farthest = far;
            v[into] = p;
        }
    };
    if (count < 2 || !(largest(v[1].w - v[0].w) > noise)) {
        for (int i = 0; i < 3; ++i) {
            point<3> n;
            n[i] = 1;
            look(n, 1, [](const point<3>& e) { return dot(e, e); });
        }
        normal = {1, 0, 0};
        if (!(farthest > noise * noise)) return false;
        count = 2;
    }
    const point<3> e = unit(v[1].w - v[0].w);
    const auto beside_line = [&](const point<3>& p) {
        const point<3> c = cross(e, p);
        return dot(c, c);
    };
    if (count < 3 || !(beside_line(v[2].w - v[0].w) > noise * noise)) {
        farthest = 0;
        normal = perpendicular(e);
        look(normal, 2, beside_line);
        look(cross(e, normal), 2, beside_line);
        if (!(farthest > noise * noise)) return false;
    }
    // Across e to the last digit, however narrow B - A is.
    const point<3> aside = v[2].w - v[0].w;
    normal = unit(cross(e, aside - e * dot(e, aside)));
    farthest = 0;
    look(normal, 3, [&](const point<3>& p) { return abs(dot(normal, p)); });
    return farthest > 0 && has_volume();
}

/// Finds where two cores touch once `p` has parted them, if that is not known: of faces of B - A of which only some
/// vertices were found.
template <int D>
void locate(const core<D>& a, const placed_core<D>& b, double size, penetration<D>& p) {
    if (p.located) return;
    p.located = true;
    // Apart by any gap the same points are closest. Round ones need one across which directions are more than rounding,
    // hulls of floats one above what their supports miss, which rounds sums of three products of floats.
    const bool smooth = !a.has_vertices() || !b.shape->has_vertices();
    const bool rough = a.kind == core_kind::hull_of_floats || b.shape->kind == core_kind::hull_of_floats;
    placed_core<D> apart = b;
    apart.at += p.normal * (p.depth + (smooth ? 0x1p-16 : rough ? 0x1p-20 : 0x1p-30) * size);
    gjk_cache near;
    near.count = D;
    for (int i = 0; i < D; ++i) near.vertex[i] = p.names[i];
    const gjk_result<D> r = gjk(a, apart, size, smooth ? 0x1p-50 : 0x1p-30, &near);
    if (r.overlapping || r.beyond) return;
    p.on_a = r.at.on_a();
    for (int i = 0; i < D; ++i) p.names[i] = r.at.vertex[i < r.at.count ? i : 0].name;
}

/// Takes the normal of a face of B - A from the edges of A and B that it is made of, where that is no worse: where one
/// shape is much larger than the other, the vertices of B - A have lost digits that these still have.
inline void refine_face_normal(const core<3>& a, const placed_core<3>& b, double noise, penetration<3>& p) {
    if (!a.has_vertices() || !b.shape->has_vertices()) return;
    point<3> of_a[3], of_b[3];
    for (int i = 0; i < 3; ++i) {
        of_a[i] = a.vertex(p.names[i] >> 16).at;
        of_b[i] = b.shape->vertex(p.names[i] & 0xffffu).at;
    }
    point<3> edge[3];
    double squared[3];
    int longest = 0;
    for (int i = 0; i < 3; ++i) {
        const int j = i < 2 ? i + 1 : 0;
        edge[i] = b.axes * (of_b[j] - of_b[i]) - (of_a[j] - of_a[i]);
        squared[i] = dot(edge[i], edge[i]);
        if (squared[i] > squared[longest]) longest = i;
    }
    const int next = longest < 2 ? longest + 1 : 0, last = longest > 0 ? longest - 1 : 2;
    const point<3> n =
        unit(across_sides(edge[next], edge[last], squared[next], squared[last], edge[longest], squared[longest]));
    const point<3> m = dot(n, p.normal) < 0 ? -n : n;
    if (!(dot(m, p.normal) > 0.999999)) return;
    const double depth = -dot(m, support_along(a, b, m).w);
    if (!(depth < p.depth + noise)) return;
    p.normal = m;
    p.depth = depth;
}

/// Improves a way out on round shapes: parted along it, where they are closest shows a shorter one. Ends at a way that
/// is shorter than all others near it.
inline void descend(const core<3>& a, const placed_core<3>& b, double size, double tolerance, penetration<3>& p) {
    constexpr int max_iterations = 32;
    for (int i = 0; i < max_iterations; ++i) {
        placed_core<3> apart = b;
        apart.at += p.normal * (p.depth + 0x1p-10 * size);
        const gjk_result<3> r = gjk(a, apart, size, 0x1p-50, nullptr);
        if (r.overlapping || r.beyond) return;
        const double depth = -dot(r.normal, support_along(a, b, r.normal).w);
        if (!(depth < p.depth)) return;
        const bool last = p.depth - depth <= tolerance;
        p.normal = r.normal;
        p.depth = depth;
        if (last) return;
    }
}

/// Of cores that touch and no more: where GJK saw them do so.
template <int D>
void keep_faces_at_distance_zero(const simplex<D>& from, double noise, penetration<D>& p) {
    point<D> left;
    for (int i = 0; i < from.count; ++i) left += from.vertex[i].w * from.weight[i];
    if (!(largest(left) <= noise)) return;
    p.on_a = from.on_a();
    for (int i = 0; i < 3; ++i) p.names[i] = from.vertex[i < from.count ? i : 0].name;
    p.located = true;
}

/// The penetration of two cores that GJK found to overlap; `from` is where it ended, `tolerance` (m) ends the search
/// of round ones. Source: van den Bergen, Proximity queries and penetration depth computation on 3D game objects
/// (2001), with the hull of Barber, Dobkin, Huhdanpaa, The quickhull algorithm (1996). Cost: 5 to 60 supports.
inline penetration<3> epa(const core<3>& a, const placed_core<3>& b, const simplex<3>& from, double tolerance) {
    const double size = power_above(extent_of(a, b)), noise = 0x1p-48 * size;
    penetration<3> best;
    const orientation grid(size);
    raw_array<cso_vertex<3>, 4> first;
    point<3> flat;
    if (!make_tetrahedron(a, b, from, noise, grid, first, flat)) {
        best.normal = dot(flat, b.at) < 0 ? -flat : flat;
        simplex<3> touching = from;
        touching.keep(closest_of_simplex(from, false, true));
        if (touching.count == 3) {
            const point<3>&u = touching.vertex[0].w, &v = touching.vertex[1].w, &w = touching.vertex[2].w;
            correct_weights(u, v, w, normal_by_shorter_edges(u, v, w), touching.weight);
        }
        best.on_a = touching.on_a();
        for (int i = 0; i < 3; ++i) best.names[i] = touching.vertex[i < touching.count ? i : 0].name;
        return best;
    }
    cso_hull hull(grid, size, first);
    // Normals have the size of areas; supports are looked for along vectors that float holds too.
    const double scale = 1 / (size * size);
    for (;;) {
        const int f = hull.closest();
        const auto& face = hull.at(f);
        const point<3>& n = face.normal;
        const cso_vertex<3> next = support_along(a, b, n * -scale);
        const double height = dot(n, next.w), gain = height - face.height;
        bool converged = gain <= 0 || gain * gain <= tolerance * tolerance * face.squared_normal;
        if (!converged && hull.side(f, next.w) <= 0) {
            if (hull.correct(f, height)) continue;
            converged = true;
        }
        if (converged || hull.full()) {
            if (!converged) best.status = query_status::iteration_limit;
            const double length = physics::sqrt(face.squared_normal);
            best.normal = -unit(n);
            best.depth = length > 0 ? height / length : 0;
            point<3> w[3];
            for (int i = 0; i < 3; ++i) w[i] = hull.vertex(face.vertex[i]).w;
            const closest_of<3> at = closest_on_triangle(w[0], w[1], w[2]);
            for (int i = 0; i < 3; ++i) best.names[i] = hull.vertex(face.vertex[i]).name;
            double weight[3] = {};
            for (int i = 0; i < at.count; ++i) weight[at.vertex[i]] = at.weight[i];
            if (at.count == 3) correct_weights(w[0], w[1], w[2], n, weight);
            for (int i = 0; i < 3; ++i) best.on_a += hull.vertex(face.vertex[i]).on_a * weight[i];
            // Not where the normal turns by less than matters.
            if (!(tolerance * length > 0x1p-48 * size * size * size)) refine_face_normal(a, b, noise, best);
            if (!converged) descend(a, b, size, tolerance, best);
            best.located = at.count == 3 && converged;
            if (!best.located && best.depth <= 0.25 * noise && from.count < 4)
                keep_faces_at_distance_zero(from, 0.25 * noise, best);
            return best;
        }
        hull.add(next, f);
    }
}

}  // namespace detail

PHYSICS_HPP_END
