// The point of a simplex that is closest to the origin.
#pragma once

#include "physics/base/raw_array.hpp"
#include "physics/shape/core.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// v / |v| for vectors whose squared length double holds, in fewer operations than normalized(); null for the null
/// vector.
template <int D>
point<D> unit(const point<D>& v) {
    const double squared = dot(v, v);
    return squared > 0 ? v * (1 / physics::sqrt(squared)) : point<D>{};
}

/// A vertex of the configuration space obstacle B - A: a point of B as seen from a point of A.
template <int D>
struct cso_vertex {
    point<D> w;
    point<D> on_a;
    /// The vertices of A and B, 16 bits each.
    std::uint32_t name = 0;
};

/// What lies closest to the origin of a simplex: the point, and the vertices that it needs, with their weights.
template <int D>
struct closest_of {
    point<D> at;
    raw_array<double, 3> weight;
    raw_array<int, 3> vertex;
    int count = 1;

    /// D + 1 vertices around the origin.
    closest_of() : count(D + 1) {}
    closest_of(const point<D>& p, int i) : at(p) {
        vertex[0] = i;
        weight[0] = 1;
    }
    closest_of(const point<D>& p, int i, int j, double part_of_j) : at(p), count(2) {
        vertex[0] = i;
        vertex[1] = j;
        weight[0] = 1 - part_of_j;
        weight[1] = part_of_j;
    }
    closest_of(const point<D>& p, int i, int j, int k, double of_i, double of_j, double of_k) : at(p), count(3) {
        vertex[0] = i;
        vertex[1] = j;
        vertex[2] = k;
        weight[0] = of_i;
        weight[1] = of_j;
        weight[2] = of_k;
    }
};

/// Up to D + 1 vertices, and the weights that make of them the point closest to the origin.
template <int D>
struct simplex {
    raw_array<cso_vertex<D>, D + 1> vertex;
    double weight[3] = {};
    int count = 0;

    /// Drops the vertices that the closest point does not need.
    void keep(const closest_of<D>& c) {
        count = c.count;
        for (int i = 0; i < c.count; ++i) {
            if (c.vertex[i] != i) vertex[i] = vertex[c.vertex[i]];
            weight[i] = c.weight[i];
        }
    }
    [[nodiscard]] point<D> on_a() const {
        point<D> p = vertex[0].on_a * weight[0];
        for (int i = 1; i < count && i < 3; ++i) p += vertex[i].on_a * weight[i];
        return p;
    }
};

template <int D>
closest_of<D> closest_on_edge(const point<D>& a, const point<D>& b, int i = 0, int j = 1) {
    const point<D> e = b - a;
    const double along = -dot(a, e), whole = dot(e, e);
    if (!(along > 0)) return {a, i};
    if (!(along < whole)) return {b, j};
    const double scale = 1 / whole, t = along * scale;
    // Across the edge to the last digit: where the point is near, the direction of a sum would be rounding.
    point<D> at;
    if constexpr (D == 2) {
        const point<2> n = perpendicular(e);
        at = n * (dot(n, t < 0.5 ? a : b) * scale);
    } else {
        at = t < 0.5 ? a + e * t : b - e * (1 - t);
        at -= e * (dot(at, e) * scale);
    }
    return {at, i, j, t};
}

/// The cross product of two sides of a triangle; `longest` is the third. Where it is thin, rounding turns that towards
/// the longest side, along which it would show: there all of it is taken away.
inline point<3> across_sides(const point<3>& e, const point<3>& f, double ee, double ff, const point<3>& longest,
                             double squared_longest) {
    const point<3> n = cross(e, f);
    if (dot(n, n) > 0x1p-8 * ee * ff) return n;
    return squared_longest > 0 ? n - longest * (dot(n, longest) / squared_longest) : n;
}
/// (b - a) x (c - a) from the two shorter edges, which give the better normal where the triangle is thin.
inline point<3> normal_by_shorter_edges(const point<3>& a, const point<3>& b, const point<3>& c) {
    const point<3> ab = b - a, bc = c - b, ca = a - c;
    const double of_ab = dot(ab, ab), of_bc = dot(bc, bc), of_ca = dot(ca, ca);
    if (of_ab > of_bc && of_ab > of_ca) return across_sides(bc, ca, of_bc, of_ca, ab, of_ab);
    if (of_bc > of_ca) return across_sides(ca, ab, of_ca, of_ab, bc, of_bc);
    return across_sides(ab, bc, of_ab, of_bc, ca, of_ca);
}

/// Corrects the weights of a triangle's corners that make the point below the origin, n being across it: what they miss
/// it by is known better than they are where the triangle is thin, so that steps of Newton help; without area one edge
/// has it all. Others' are exact, and left.
inline void correct_weights(const point<3>& a, const point<3>& b, const point<3>& c, const point<3>& n,
                            double (&weight)[3]) {
    constexpr int max_steps = 4;
    const double squared = dot(n, n), longest = max(max(dot(b - a, b - a), dot(c - b, c - b)), dot(a - c, a - c));
    if (squared > 0x1p-6 * longest * longest) return;
    const double scale = squared > 0 ? 1 / squared : 0;
    const auto missed_by = [&](double of_a, double of_b, double of_c) {
        const point<3> at = a * of_a + b * of_b + c * of_c;
        return at - n * (dot(n, at) * scale);
    };
    point<3> missed = missed_by(weight[0], weight[1], weight[2]);
    for (int i = 0; i < max_steps; ++i) {
        const point<3> turned = cross(missed, n) * scale;
        const double of_a = weight[0] - dot(c - b, turned), of_b = weight[1] - dot(a - c, turned),
                     of_c = 1 - of_a - of_b;
        const point<3> left = missed_by(of_a, of_b, of_c);
        if (!(dot(left, left) < dot(missed, missed))) break;
        weight[0] = of_a;
        weight[1] = of_b;
        weight[2] = of_c;
        missed = left;
    }
    const double noise = 0x1p-49 * max(max(largest(a), largest(b)), largest(c));
    const bool within = min(min(weight[0], weight[1]), weight[2]) >= 0;
    if (within && dot(missed, missed) <= noise * noise) return;
    double minimum = within ? dot(missed, missed) : 1e300;
    const closest_of<3> edges[3] = {closest_on_edge(a, b, 0, 1), closest_on_edge(b, c, 1, 2),
                                    closest_on_edge(c, a, 2, 0)};
    for (const closest_of<3>& on : edges) {
        double by_edge[3] = {};
        for (int i = 0; i < on.count; ++i) by_edge[on.vertex[i]] = on.weight[i];
        const point<3> left = missed_by(by_edge[0], by_edge[1], by_edge[2]);
        if (!(dot(left, left) < minimum)) continue;
        minimum = dot(left, left);
        for (int i = 0; i < 3; ++i) weight[i] = by_edge[i];
    }
}

inline closest_of<3> nearer(const closest_of<3>& a, const closest_of<3>& b) {
    return dot(b.at, b.at) < dot(a.at, a.at) ? b : a;
}

/// Source: Ericson, Real-Time Collision Detection (2005), 5.1.5, with the areas taken from the normal, which keeps
/// their signs where the triangle is small and far away.
inline closest_of<3> closest_on_triangle(const point<3>& a, const point<3>& b, const point<3>& c, int i = 0, int j = 1,
                                         int k = 2) {
    const point<3> ab = b - a, ac = c - a;
    const double a1 = -dot(ab, a), a2 = -dot(ac, a);
    if (a1 <= 0 && a2 <= 0) return {a, i};
    const double b1 = -dot(ab, b), b2 = -dot(ac, b);
    if (b1 >= 0 && b2 <= b1) return {b, j};
    const double c1 = -dot(ab, c), c2 = -dot(ac, c);
    if (c2 >= 0 && c1 <= c2) return {c, k};
    const point<3> n = normal_by_shorter_edges(a, b, c);
    const double of_c = dot(n, cross(a, ab)), of_b = dot(n, cross(ac, a)), of_a = dot(n, cross(b, c - b));
    if (of_c <= 0 && a1 >= 0 && b1 <= 0) return closest_on_edge(a, b, i, j);
    if (of_b <= 0 && a2 >= 0 && c2 <= 0) return closest_on_edge(a, c, i, k);
    if (of_a <= 0 && b2 - b1 >= 0 && c1 - c2 >= 0) return closest_on_edge(b, c, j, k);
    const double sum = of_a + of_b + of_c;
    // Without area one of the edges has it all.
    if (!(sum > 0))
        return nearer(nearer(closest_on_edge(a, b, i, j), closest_on_edge(b, c, j, k)), closest_on_edge(a, c, i, k));
    const double scale = 1 / sum;
    return {n * (dot(n, a) / dot(n, n)), i, j, k, of_a * scale, of_b * scale, of_c * scale};
}

/// The same; quicker where the origin lies beyond the last corner or one of its edges, since GJK has just added it.
/// Takes the edges e = a - c and f = b - c, and n = e x f or its opposite.
inline closest_of<3> closest_on_grown_triangle(const point<3>& a, const point<3>& b, const point<3>& c,
                                               const point<3>& e, const point<3>& f, const point<3>& n, int i, int j,
                                               int k) {
    const double along_e = -dot(c, e), along_f = -dot(c, f);
    if (along_e <= 0 && along_f <= 0) return {c, k};
    const double ee = dot(e, e), ff = dot(f, f), ef = dot(e, f), whole = dot(n, n);
    // Of thin triangles these differences are rounding.
    if (!(whole > 0x1p-4 * ee * ff)) return closest_on_triangle(a, b, c, i, j, k);
    const double of_a = along_e * ff - along_f * ef, of_b = along_f * ee - along_e * ef;
    if (of_b <= 0 && along_e > 0 && along_e < ee) return closest_on_edge(a, c, i, k);
    if (of_a <= 0 && along_f > 0 && along_f < ff) return closest_on_edge(b, c, j, k);
    const double of_c = whole - of_a - of_b;
    if (!(of_a > 0 && of_b > 0 && of_c > 0)) return closest_on_triangle(a, b, c, i, j, k);
    const double scale = 1 / whole;
    return {n * (dot(n, c) * scale), i, j, k, of_a * scale, of_b * scale, of_c * scale};
}

/// The point of a simplex that is closest to the origin; of count D + 1, and the origin itself, if that lies within.
/// `grown` says that the last vertex has just been added beyond the closest point of the others, `doubtful` that all
/// sides are to be tried, since no sign of an area or volume counts.
inline closest_of<2> closest_of_simplex(const simplex<2>& s, bool, bool doubtful = false) {
    if (s.count == 1) return {s.vertex[0].w, 0};
    if (s.count == 2) return closest_on_edge(s.vertex[0].w, s.vertex[1].w);
    const point<2> p[3] = {s.vertex[0].w, s.vertex[1].w, s.vertex[2].w};
    const double area = cross(p[1] - p[0], p[2] - p[0]);
    const double noise = 0x1p-50 * max(max(largest(p[0]), largest(p[1])), largest(p[2]));
    closest_of<2> best;
    double minimum = 0;
    for (int i = 0; i < 3; ++i) {
        const int j = i < 2 ? i + 1 : 0, k = i > 0 ? i - 1 : 2;
        const point<2> e = p[j] - p[i];
        // Where the triangle has no area to speak of, every edge is outside.
        const bool flat = doubtful || !(abs(area) > noise * max(largest(e), largest(p[k] - p[i])));
        if (!flat && (cross(p[i], e) < 0) == (area < 0)) continue;
        const closest_of<2> c = closest_on_edge(p[i], p[j], i, j);
        const double distance = dot(c.at, c.at);
        if (best.count < 3 && !(distance < minimum)) continue;
        minimum = distance;
        best = c;
    }
    // In ascending order, so that none is overwritten before it has moved.
    if (best.count == 2 && best.vertex[1] < best.vertex[0]) {
        std::swap(best.vertex[0], best.vertex[1]);
        std::swap(best.weight[0], best.weight[1]);
    }
    return best;
}

inline closest_of<3> closest_of_simplex(const simplex<3>& s, bool grown, bool doubtful = false) {
    if (s.count == 1) return {s.vertex[0].w, 0};
    if (s.count == 2) return closest_on_edge(s.vertex[0].w, s.vertex[1].w);
    if (s.count == 3) {
        const point<3>&a = s.vertex[0].w, &b = s.vertex[1].w, &c = s.vertex[2].w, e = a - c, f = b - c;
        return closest_on_grown_triangle(a, b, c, e, f, cross(e, f), 0, 1, 2);
    }
    // The faces at the last vertex, and their normals; the one opposite lies behind if the simplex has grown.
    const point<3>& d = s.vertex[3].w;
    const point<3> e[3] = {s.vertex[0].w - d, s.vertex[1].w - d, s.vertex[2].w - d};
    const point<3> n[3] = {cross(e[0], e[1]), cross(e[1], e[2]), cross(e[2], e[0])};
    const double volume = dot(n[0], e[2]);
    // Where the tetrahedron has no volume to speak of, or is no thicker than its corners are rounded, every face is
    // outside.
    const double l[3] = {largest(e[0]), largest(e[1]), largest(e[2])};
    const double area = max(max(largest(n[0]), largest(n[1])), largest(n[2]));
    const double noise = 0x1p-50 * (largest(d) + max(max(l[0], l[1]), l[2]));
    const bool flat = doubtful || !(abs(volume) > max(noise * area, 0x1p-48 * l[0] * l[1] * l[2]));
    closest_of<3> best;
    double minimum = 0;
    const auto consider = [&](const closest_of<3>& c) {
        const double distance = dot(c.at, c.at);
        if (best.count < 4 && !(distance < minimum)) return;
        minimum = distance;
        best = c;
    };
    for (int k = 0; k < 3; ++k) {
        if (!flat && (dot(n[k], d) > 0) != (volume > 0)) continue;
        const int i = k < 2 ? k : 0, j = k < 2 ? k + 1 : 2;
        consider(closest_on_grown_triangle(s.vertex[i].w, s.vertex[j].w, d, e[i], e[j], n[k], i, j, 3));
    }
    // Of flat ones the faces at the last vertex cover it too.
    if (!grown || doubtful) {
        const point<3> behind = cross(e[1] - e[0], e[2] - e[0]);
        if (flat || (dot(behind, s.vertex[0].w) < 0) == (volume > 0))
            consider(closest_on_triangle(s.vertex[0].w, s.vertex[1].w, s.vertex[2].w));
    }
    return best;
}

}  // namespace detail

PHYSICS_HPP_END
