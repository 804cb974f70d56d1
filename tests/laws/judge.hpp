// The judge of certificates: what a convex shape is, in long double, by formulas that are short enough to be seen
// right.
//
// Shapes are judged as the library stores them, a hull by its vertices. The judge has no search that could end too
// early: it knows how far a shape reaches along a direction, where it is nearest to a point, and, of polytopes, all
// directions in which a face of the difference of two of them may point.
#pragma once

#include "convex_bodies.hpp"

namespace {

namespace judge {

using oracle::point;
using oracle::real;

inline point unit_of(point v) { return v * (1 / oracle::size(v)); }
inline point unrotate(const oracle::frame& f, point v) {
    return {dot(f.axis[0], v), dot(f.axis[1], v), dot(f.axis[2], v)};
}

/// The point of a segment that is nearest to p.
inline point nearest_on_segment(point p, point a, point b) {
    const point along = b - a;
    const real whole = dot(along, along), t = dot(p - a, along);
    if (!(t > 0)) return a;
    return t < whole ? a + along * (t / whole) : b;
}
/// The point of a triangle with a unit normal that is nearest to p.
inline point nearest_on_triangle(point p, point a, point b, point c, point n) {
    const bool in =
        dot(cross(n, b - a), p - a) >= 0 && dot(cross(n, c - b), p - b) >= 0 && dot(cross(n, a - c), p - c) >= 0;
    if (in) return p - n * dot(n, p - a);
    point best = nearest_on_segment(p, a, b);
    for (const point& q : {nearest_on_segment(p, b, c), nearest_on_segment(p, c, a)})
        if (dot(q - p, q - p) < dot(best - p, best - p)) best = q;
    return best;
}

/// A convex set, the core of a shape, and the radius around it.
class body {
public:
    enum class kind { box, polytope, discs };

    kind of = kind::polytope;
    std::vector<point> corners;
    real radius = 0;
    /// Of a box its half extents; of discs half their distance and the radii at its ends.
    point half;
    /// How far it reaches from its origin, and half of its least width, the radius included (m).
    real extent = 0, thin = 0;

    /// Unit vectors out of the core, and how far it reaches along each: all of its faces are among them.
    std::vector<point> normals;
    std::vector<real> offsets;
    /// An edge, by its unit direction, and unit vectors across it to other corners of its faces. All edges are among
    /// them, and some lines within faces.
    struct edge {
        point along;
        std::size_t first, last;
    };
    std::vector<edge> edges;
    std::vector<point> beside;

    body() = default;
    explicit body(const convex_body& b) {
        if (b.round) {
            of = kind::discs;
            half = {b.discs.half, b.discs.low, b.discs.high};
            radius = b.discs.rounding;
            extent = std::hypot(half.x, std::max(half.y, half.z)) + radius;
            const real slope = half.y - half.z;
            thin = std::min(half.x, std::max(half.y, half.z) * 2 * half.x / std::hypot(2 * half.x, slope)) + radius;
            return;
        }
        corners = b.hull.points;
        if (b.geometry) {
            corners.clear();
            for (std::uint32_t i = 0; i < b.geometry.vertex_count(); ++i) corners.push_back(wide(b.geometry.vertex(i)));
        }
        radius = b.hull.radius;
        if (b.kind == of::box || b.kind == of::rounded_box) {
            of = kind::box;
            half = {std::abs(corners[0].x), std::abs(corners[0].y), std::abs(corners[0].z)};
        }
        for (const point& p : corners) extent = std::max(extent, oracle::size(p) + radius);
        const oracle::polytope core(D, corners, 0);
        D == 2 ? add_sides(core) : add_faces(core);
        thin = normals.empty() ? 0 : extent;
        for (std::size_t i = 0; i < normals.size(); ++i) thin = std::min(thin, (offsets[i] + reach(-normals[i])) / 2);
        thin += radius;
    }

    /// How far the core reaches along a vector: a scan of all corners, or the formula.
    [[nodiscard]] real reach(point n) const {
        if (of == kind::box) return std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z;
        if (of == kind::discs) {
            const real across = std::sqrt(n.y * n.y + n.z * n.z), x = n.x * half.x;
            return std::max(across * half.y - x, across * half.z + x);
        }
        real most = dot(corners[0], n);
        for (const point& p : corners) most = std::max(most, dot(p, n));
        return most;
    }
    /// How far a point lies outside of the core, negative inside, and the core's point that is nearest to it.
    real distance(point p, point& nearest) const {
        nearest = p;
        if (of == kind::discs) return distance_of_discs(p, nearest);
        real most = -HUGE_VALL;
        for (std::size_t i = 0; i < normals.size(); ++i) most = std::max(most, dot(normals[i], p) - offsets[i]);
        // Of what is flat nothing is inside.
        const bool flat = corners.size() <= std::size_t{D};
        if (most <= 0 && !flat) return most;
        if (of == kind::box) {
            for (int i = 0; i < D; ++i) nearest[i] = std::min(std::max(p[i], -half[i]), half[i]);
            return oracle::size(p - nearest);
        }
        // Outside, it is nearest on a side that it lies above, but for roundings.
        real least = HUGE_VALL;
        const auto consider = [&](point q) {
            const real square = dot(q - p, q - p);
            if (square < least) least = square, nearest = q;
        };
        for (const part& t : parts_)
            if (flat || dot(normals[t.plane], p) >= offsets[t.plane] - 1e-12L * extent)
                consider(t.a == t.b || t.b == t.c || t.a == t.c
                             ? nearest_on_segment(p, corners[t.a], corners[t.a == t.b ? t.c : t.b])
                             : nearest_on_triangle(p, corners[t.a], corners[t.b], corners[t.c], normals[t.plane]));
        return std::sqrt(least);
    }
    [[nodiscard]] real distance(point p) const {
        point nearest;
        return distance(p, nearest);
    }

private:
    /// A triangle of a face, or where two corners are one a segment; plane: the normal across it, if it has one.
    struct part {
        std::size_t a, b, c, plane;
    };
    std::vector<part> parts_;
    static constexpr std::size_t none = ~std::size_t{0};

    std::size_t plane_of(point n) {
        for (std::size_t i = 0; i < normals.size(); ++i)
            if (oracle::size(normals[i] - n) < 1e-17L) return i;
        normals.push_back(n);
        offsets.push_back(scan(n));
        return normals.size() - 1;
    }
    [[nodiscard]] real scan(point n) const {
        real most = dot(corners[0], n);
        for (const point& p : corners) most = std::max(most, dot(p, n));
        return most;
    }
    /// The plane through a, on the side that has less of the body above it; of a flat body on both sides.
    void add_part(point n, std::size_t a, std::size_t b, std::size_t c) {
        const real above = scan(n) - dot(n, corners[a]), below = scan(-n) + dot(n, corners[a]);
        if (above <= below) parts_.push_back({a, b, c, plane_of(n)});
        if (below <= above) parts_.push_back({a, D == 2 ? b : c, D == 2 ? c : b, plane_of(-n)});
    }
    void add_sides(const oracle::polytope& core) {
        for (const auto& e : core.edges()) {
            const point along = corners[e.to] - corners[e.from];
            if (e.length > 0) add_part(unit_of({along.y, -along.x, 0}), e.from, e.to, e.from);
            else parts_.push_back({e.from, e.from, e.from, none});
        }
    }
    void add_faces(const oracle::polytope& core) {
        for (const auto& f : core.faces())
            add_part(unit_of(cross(corners[f.b] - corners[f.a], corners[f.c] - corners[f.a])), f.a, f.b, f.c);
        for (const auto& e : core.edges()) {
            if (core.faces().empty()) parts_.push_back({e.from, e.to, e.from, none});
            if (!(e.length > 0)) continue;
            const point along = unit_of(corners[e.to] - corners[e.from]);
            const std::size_t first = beside.size();
            bool flat = false;
            for (const std::size_t i : e.beside) {
                point across = corners[i] - corners[e.from];
                across = across - along * dot(across, along);
                if (!(oracle::size(across) > 1e-17L * extent)) continue;
                across = unit_of(across);
                bool known = false;
                for (std::size_t k = first; k < beside.size(); ++k) {
                    known = known || oracle::size(beside[k] - across) < 1e-17L;
                    // Between two faces that are one but for 1e-15: what it may add is no more than that, times sizes.
                    flat = flat || oracle::size(beside[k] + across) < 1e-15L;
                }
                if (!known) beside.push_back(across);
            }
            if (flat) beside.resize(first);
            else edges.push_back({along, first, beside.size()});
        }
    }
    /// In the half plane of x and the distance from the axis the set is a polygon.
    real distance_of_discs(point p, point& nearest) const {
        const real q = std::sqrt(p.y * p.y + p.z * p.z);
        const point at{p.x, q, 0},
            corner[4] = {{-half.x, 0, 0}, {-half.x, half.y, 0}, {half.x, half.z, 0}, {half.x, 0, 0}};
        real least = HUGE_VALL;
        point best;
        for (int i = 0; i < 3; ++i) {
            const point on = nearest_on_segment(at, corner[i], corner[i + 1]);
            const real away = oracle::size(on - at);
            if (away < least) least = away, best = on;
        }
        if (std::abs(p.x) <= half.x && q * 2 * half.x <= half.y * (half.x - p.x) + half.z * (half.x + p.x))
            return -least;
        nearest = {best.x, q > 0 ? p.y * (best.y / q) : best.y, q > 0 ? p.z * (best.y / q) : 0};
        return least;
    }
};

/// Two bodies and B's place in A's frame.
struct couple {
    const body *a, *b;
    oracle::frame at;

    [[nodiscard]] real radii() const { return a->radius + b->radius; }
    /// How far apart the cores are along a unit vector from A to B: never more than they are apart.
    [[nodiscard]] real along(point n) const { return dot(at.origin, n) - a->reach(n) - b->reach(-unrotate(at, n)); }
    /// No less than the cores are apart: from that point of A's core on, or of B's, which is nearest to p.
    [[nodiscard]] real from_a(point p) const {
        point on, other;
        a->distance(p, on);
        return std::max(b->distance(at.undo(on), other), real(0));
    }
    [[nodiscard]] real from_b(point p) const {
        point on, other;
        b->distance(at.undo(p), on);
        return std::max(a->distance(at.apply(on), other), real(0));
    }
    [[nodiscard]] bool is_polytopes() const { return a->of != body::kind::discs && b->of != body::kind::discs; }
    [[nodiscard]] std::size_t work() const { return a->edges.size() * b->edges.size(); }

    /// The best that any face of the difference of two polytopes says: that is the signed distance where they overlap.
    /// The normals of these faces are the faces' of A and of B, and in 3D those across an edge of A and one of B
    /// that both may touch the same plane from its two sides. Candidates that are none do no harm: what a direction
    /// parts is parted. Source: Gauss maps, Gregorius, The separating axis test (2013).
    [[nodiscard]] real best_of_all() const {
        real best = -HUGE_VALL;
        const auto consider = [&](point n) { best = std::max(best, along(n)); };
        for (const point& n : a->normals) consider(n);
        for (const point& n : b->normals) consider(-at.rotate(n));
        if (D == 2) return best;
        static std::vector<point> beside;
        beside.clear();
        for (const point& p : b->beside) beside.push_back(at.rotate(p));
        for (const body::edge& f : b->edges) {
            const point along_f = at.rotate(f.along);
            for (const body::edge& e : a->edges) {
                const point n = cross(e.along, along_f);
                bool up = true, down = true;
                const auto look = [&](real height) {
                    up = up && height <= 1e-12L;
                    down = down && height >= -1e-12L;
                };
                for (std::size_t i = e.first; i < e.last && (up || down); ++i) look(dot(n, a->beside[i]));
                for (std::size_t i = f.first; i < f.last && (up || down); ++i) look(-dot(n, beside[i]));
                if (!up && !down) continue;
                const real length = oracle::size(n);
                if (!(length > 0)) continue;
                if (up) consider(n * (1 / length));
                if (down) consider(n * (-1 / length));
            }
        }
        return best;
    }
    /// The best of directions about n, of the axes of both and of what their faces say: an attempt to refute.
    [[nodiscard]] real best_about(point n) const {
        real best = along(n);
        const auto consider = [&](point m) {
            const real length = oracle::size(m);
            if (length > 0) best = std::max(best, along(m * (1 / length)));
        };
        const point u = unit_of(std::abs(n.x) < 0.6L ? cross(n, {1, 0, 0}) : cross(n, {0, 1, 0})), v = cross(n, u);
        const point w = D == 2 ? point{-n.y, n.x, 0} : u;
        for (const real step : {0.3L, 0.05L, 0.01L, 1e-3L, 1e-4L, 1e-6L})
            for (int k = 0; k < 8; ++k) {
                if (D == 2 && k > 1) break;
                const real sign = k & 1 ? -step : step;
                consider(n + (k < 2 ? w : k < 4 ? v : k < 6 ? u + v : u - v) * sign);
            }
        for (int i = 0; i < D; ++i)
            for (const real sign : {1.0L, -1.0L}) {
                point axis;
                axis[i] = sign;
                consider(axis);
                consider(at.rotate(axis));
            }
        for (const point& m : a->normals) consider(m);
        for (const point& m : b->normals) consider(-at.rotate(m));
        return best;
    }
};

}  // namespace judge

}  // namespace
