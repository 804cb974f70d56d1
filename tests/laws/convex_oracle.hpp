// The slow, obviously right twin of the convex kernel: signed distances of polytopes from all features and all axes.
//
// Two bounds make it right without a termination criterion. Any two points of A and B are at least as far apart as A
// and B are; along any unit vector, A and B are at most as far apart as their signed distance says. So trying too many
// features or axes does no harm, and where the two bounds meet the answer is proven: see answer::doubt.
// Needs nothing but the standard library, so that benchmarks judge by it too.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <vector>

namespace {

namespace oracle {

using real = long double;

struct point {
    real x = 0, y = 0, z = 0;

    real& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
    real operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
    friend point operator+(point a, point b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend point operator-(point a, point b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend point operator-(point a) { return {-a.x, -a.y, -a.z}; }
    friend point operator*(point a, real s) { return {a.x * s, a.y * s, a.z * s}; }
};
inline real dot(point a, point b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline point cross(point a, point b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline real size(point a) { return std::sqrt(dot(a, a)); }

/// A rigid motion, from a quaternion as it is rounded: not quite of unit length.
struct frame {
    point axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    point origin;

    [[nodiscard]] point rotate(point v) const { return axis[0] * v.x + axis[1] * v.y + axis[2] * v.z; }
    [[nodiscard]] point apply(point p) const { return rotate(p) + origin; }
    [[nodiscard]] point undo(point p) const {
        p = p - origin;
        return {dot(axis[0], p), dot(axis[1], p), dot(axis[2], p)};
    }

    static frame of_quaternion(real x, real y, real z, real w, point at) {
        const real s = 2 / (x * x + y * y + z * z + w * w);
        return {{{1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)},
                 {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)},
                 {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)}},
                at};
    }
    static frame of_turn(real cosine, real sine, point at) {
        const real length = std::sqrt(cosine * cosine + sine * sine);
        const real c = cosine / length, s = sine / length;
        return {{{c, s, 0}, {-s, c, 0}, {0, 0, 1}}, at};
    }
};

/// The convex hull of some points, grown by a radius; any number of points, on a plane, a line or one place too. In the
/// plane, z is 0. Faces are found by trying all: up to about 130 points, and few of them on one face (all triples of
/// a face are kept: 20 points on one are 1,140 triples).
class polytope {
public:
    struct face {
        std::size_t a, b, c;
    };
    /// An edge, or a line between points of one face: that does no harm. Beside it lie the other points of its faces.
    struct edge {
        std::size_t from, to;
        real length;
        std::vector<std::size_t> beside;
    };

    std::vector<point> points;
    real radius = 0;
    int dimension = 3;

    polytope() = default;
    polytope(int D, std::vector<point> corners, real grown_by)
        : points(std::move(corners)), radius(grown_by), dimension(D) {
        auto found = std::make_shared<features>();
        D == 2 ? find_in_plane(*found) : find_in_space(*found);
        features_ = found;
    }
    /// The same one elsewhere; shares what was found.
    [[nodiscard]] polytope moved(const frame& to) const {
        polytope result = *this;
        for (point& p : result.points) p = to.apply(p);
        return result;
    }
    [[nodiscard]] const std::vector<face>& faces() const { return features_->faces; }
    [[nodiscard]] const std::vector<edge>& edges() const { return features_->edges; }
    /// The farthest from the first of its points: how large it is, within a factor of 2.
    [[nodiscard]] real extent() const {
        real most = 0;
        for (const point& p : points) most = std::max(most, size(p - points[0]));
        return most;
    }
    /// How far it reaches along a vector, without the radius.
    [[nodiscard]] real reach(point n) const {
        real most = dot(points[0], n);
        for (const point& p : points) most = std::max(most, dot(p, n));
        return most;
    }

private:
    struct features {
        std::vector<face> faces;
        std::vector<edge> edges;
    };

    /// Whether all points lie on one side of a plane, but for roundings; n need not be a unit vector. A generous
    /// tolerance finds features that are none, which do no harm.
    [[nodiscard]] bool supports(std::size_t i, point n, real extent) const {
        const real tolerance = 1e-12L * size(n) * extent + 1e-17L * extent * extent * extent;
        bool above = false, below = false;
        for (const point& p : points) {
            const real height = dot(n, p - points[i]);
            above = above || height > tolerance;
            below = below || height < -tolerance;
            if (above && below) return false;
        }
        return true;
    }
    void find_in_space(features& to) const {
        const std::size_t n = points.size();
        const real whole = extent();
        std::vector<std::size_t> edge_at(n * n, n * n);
        const auto add = [&](std::size_t i, std::size_t k, std::size_t beside) {
            std::size_t& at = edge_at[i * n + k];
            if (at == n * n) at = to.edges.size(), to.edges.push_back({i, k, size(points[k] - points[i]), {}});
            if (beside < n) to.edges[at].beside.push_back(beside);
        };
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t k = i + 1; k < n; ++k)
                for (std::size_t m = k + 1; m < n; ++m) {
                    const point normal = cross(points[k] - points[i], points[m] - points[i]);
                    if (size(normal) == 0 || !supports(i, normal, whole)) continue;
                    to.faces.push_back({i, k, m});
                    add(i, k, m), add(i, m, k), add(k, m, i);
                }
        // On a line, or in one place.
        if (to.faces.empty())
            for (std::size_t i = 0; i < n; ++i)
                for (std::size_t k = i; k < n; ++k) add(i, k, n);
    }
    void find_in_plane(features& to) const {
        const std::size_t n = points.size();
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t k = i + 1; k < n; ++k) {
                const point along = points[k] - points[i];
                if (size(along) > 0 && supports(i, {along.y, -along.x, 0}, extent()))
                    to.edges.push_back({i, k, size(along), {}});
            }
        if (to.edges.empty()) to.edges.push_back({0, 0, 0, {}});
    }

    std::shared_ptr<const features> features_;
};

/// How far apart A and B are along a unit vector from A to B, radii included; negative where they overlap.
inline real separation_along(const polytope& a, const polytope& b, point n) {
    return -b.reach(-n) - a.reach(n) - a.radius - b.radius;
}

struct answer {
    /// Negative where they overlap: minus the least way to part them.
    real distance = 0;
    /// Unit, from A to B. Often others would do: judge a normal by separation_along(), which must give the distance.
    point normal{1, 0, 0};
    /// Closest points, where the cores are apart; on the surfaces.
    point on_a, on_b;
    /// Of the answer; a few roundings where the cores are apart. Where they overlap it is not known, and 0.
    real doubt = 0;
    bool cores_apart = false;
};

class search {
public:
    search(const polytope& a, const polytope& b) : a_(a), b_(b), core_a_(a), core_b_(b) {
        core_a_.radius = core_b_.radius = 0;
        extent_ = std::max(a.extent(), b.extent());
    }
    [[nodiscard]] answer run() {
        closest_points();
        try_axes();
        answer r;
        r.normal = best_normal_;
        r.cores_apart = best_ > 0;
        const real cores = r.cores_apart ? nearest_ : best_;
        r.distance = cores - a_.radius - b_.radius;
        r.doubt = r.cores_apart ? nearest_ - best_ : 0;
        r.on_a = on_a_ + r.normal * a_.radius;
        r.on_b = on_b_ - r.normal * b_.radius;
        return r;
    }

private:
    void consider(point p, point q) {
        const real distance = size(q - p);
        if (nearest_ >= 0 && distance >= nearest_) return;
        nearest_ = distance;
        on_a_ = p;
        on_b_ = q;
    }
    /// A point above a triangle; elsewhere an edge is nearer.
    static bool project(point p, point a, point b, point c, point& onto) {
        const point n = cross(b - a, c - a);
        const real square = dot(n, n);
        if (square == 0) return false;
        if (dot(cross(b - a, p - a), n) < 0 || dot(cross(c - b, p - b), n) < 0 || dot(cross(a - c, p - c), n) < 0)
            return false;
        onto = p - n * (dot(n, p - a) / square);
        return true;
    }
    static real clamped(real x) { return std::min(std::max(x, real(0)), real(1)); }
    void point_segment(point p, point from, point along, bool of_a) {
        const real square = dot(along, along);
        const point q = square > 0 ? from + along * clamped(dot(p - from, along) / square) : from;
        of_a ? consider(p, q) : consider(q, p);
    }
    void segments(point p, point d, point q, point e) {
        // Along the way between the nearest points so far they may be seen to be no nearer.
        const point look = on_b_ - on_a_;
        const real a = std::max(dot(p, look), dot(p + d, look)), b = std::min(dot(q, look), dot(q + e, look));
        if (nearest_ >= 0 && b - a >= nearest_ * nearest_) return;
        point_segment(p, q, e, true);
        point_segment(p + d, q, e, true);
        point_segment(q, p, d, false);
        point_segment(q + e, p, d, false);
        const real dd = dot(d, d), de = dot(d, e), ee = dot(e, e);
        const point axis = cross(d, e);
        const real square = dot(axis, axis);
        if (!(square > 0)) return;
        // Where they cross, inside both; again from there, as the roundings of nearly parallel ones are large.
        real s = 0, t = 0;
        for (int round = 0; round < 3; ++round) {
            const point gap = (q + e * t) - (p + d * s);
            const real along_d = dot(gap, d), along_e = dot(gap, e);
            s += (along_d * ee - along_e * de) / square;
            t += (along_d * de - along_e * dd) / square;
            if (!(s > -1 && s < 2 && t > -1 && t < 2)) return;
        }
        if (!(s >= 0 && s <= 1 && t >= 0 && t <= 1)) return;
        consider(p + d * s, q + e * t);
    }
    /// Over all pairs of features; where the polytopes overlap, what comes out means nothing.
    void closest_points() {
        for (const auto& [i, k, m] : core_a_.faces())
            for (const point& p : core_b_.points) {
                point onto;
                if (project(p, core_a_.points[i], core_a_.points[k], core_a_.points[m], onto)) consider(onto, p);
            }
        for (const auto& [i, k, m] : core_b_.faces())
            for (const point& p : core_a_.points) {
                point onto;
                if (project(p, core_b_.points[i], core_b_.points[k], core_b_.points[m], onto)) consider(p, onto);
            }
        for (const auto& ea : core_a_.edges())
            for (const auto& eb : core_b_.edges())
                segments(from(core_a_, ea), displacement(core_a_, ea), from(core_b_, eb), displacement(core_b_, eb));
    }
    void try_axis(point n) {
        const real length = size(n);
        if (!(length > 0)) return;
        n = n * (1 / length);
        for (const point& axis : {n, -n}) {
            const real along = separation_along(core_a_, core_b_, axis);
            if (tried_ && along <= best_) continue;
            tried_ = true;
            best_ = along;
            best_normal_ = axis;
        }
    }
    /// The faces of the difference of A and B have the normals of a face of one of them, or are made of two edges.
    void try_axes() {
        try_axis(on_b_ - on_a_);
        try_axis({1, 0, 0});
        try_axis({0, 1, 0});
        if (a_.dimension == 2) {
            for (const polytope* one : {&core_a_, &core_b_})
                for (const auto& e : one->edges()) try_axis({displacement(*one, e).y, -displacement(*one, e).x, 0});
            return;
        }
        try_axis({0, 0, 1});
        for (const polytope* one : {&core_a_, &core_b_}) {
            for (const auto& [i, k, m] : one->faces())
                try_axis(cross(one->points[k] - one->points[i], one->points[m] - one->points[i]));
            // Lone segments: two in one line have no edges that cross.
            if (one->faces().empty())
                for (const auto& e : one->edges())
                    for (const point& other : {point{1, 0, 0}, point{0, 1, 0}, point{0, 0, 1}})
                        try_axis(cross(displacement(*one, e), other));
        }
        for (const auto& ea : core_a_.edges())
            for (const auto& eb : core_b_.edges()) {
                const point n = cross(displacement(core_a_, ea), displacement(core_b_, eb));
                const real room = 1e-12L * ea.length * eb.length * extent_;
                // An axis counts where both edges lie in the polytopes' supporting planes; most do not.
                bool up = true, down = true;
                beside(core_a_, ea, n, room, up, down);
                beside(core_b_, eb, -n, room, up, down);
                if (up || down) try_axis(n);
            }
    }
    static void beside(const polytope& one, const polytope::edge& e, point n, real room, bool& up, bool& down) {
        for (const std::size_t i : e.beside) {
            if (!up && !down) return;
            const real height = dot(n, one.points[i] - from(one, e));
            up = up && height <= room;
            down = down && height >= -room;
        }
    }
    static point from(const polytope& one, const polytope::edge& e) { return one.points[e.from]; }
    static point displacement(const polytope& one, const polytope::edge& e) {
        return one.points[e.to] - one.points[e.from];
    }

    const polytope &a_, &b_;
    polytope core_a_, core_b_;
    real extent_ = 0, nearest_ = -1, best_ = 0;
    bool tried_ = false;
    point on_a_, on_b_, best_normal_{1, 0, 0};
};

/// Both in one frame. Cost: 8 points a side 0.1 ms, 32 2 ms, 128 20 ms.
inline answer signed_distance(const polytope& a, const polytope& b) { return search(a, b).run(); }

/// The signed distance of a point from the surface.
inline real off_surface(const polytope& one, point p) {
    return signed_distance(polytope(one.dimension, {p}, 0), one).distance;
}

}  // namespace oracle

}  // namespace
