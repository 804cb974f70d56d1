// Volume, centroid and second moments of convex hulls, rounded by any radius.
#pragma once

#include "physics/base/math.hpp"
#include "physics/space/inertia.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// a b^T + b a^T.
inline symmetric<double> both_products(const vec<double, 3>& a, const vec<double, 3>& b) {
    return {2 * a.x * b.x,         2 * a.y * b.y,         2 * a.z * b.z,
            a.x * b.y + a.y * b.x, a.x * b.z + a.z * b.x, a.y * b.z + a.z * b.y};
}
/// a a^T.
inline symmetric<double> square_of(const vec<double, 3>& a) { return both_products(a, a) * 0.5; }

inline vec<double, 3> in_space(const vec<double, 2>& v) { return {v.x, v.y, 0.0}; }
inline vec<double, 3> in_space(const vec<double, 3>& v) { return v; }

/// The integrals of 1, p and p p^T over all points within r of a hull, with p from the hull's centroid, as polynomials
/// in r: volume[k] is the factor of r^k, and so on. Exact: a hull is its core, a prism on each face, a wedge of a
/// cylinder along each edge and of a ball at each vertex. In 2D the hull lies at z = 0, integrals are over its plane.
/// Source: Steiner's formula; of p and p p^T see Schneider, Convex Bodies, 5.4 (tensor valuations).
struct hull_moments {
    double volume[4] = {};
    vec<double, 3> first[5] = {};
    symmetric<double> second[6] = {};

    /// A piece of so much volume, whose p sum up to `sum` and p p^T to `squares`, extended by r along the unit normal.
    void add_prism(double size, const vec<double, 3>& sum, const symmetric<double>& squares, const vec<double, 3>& n) {
        volume[1] += size;
        first[1] += sum;
        first[2] += n * (0.5 * size);
        second[1] = second[1] + squares;
        second[2] = second[2] + both_products(sum, n) * 0.5;
        second[3] = second[3] + square_of(n) * (size / 3);
    }
    /// The same by all directions from n towards the unit vector t across it, up to an angle (rad).
    void add_wedge(double size, const vec<double, 3>& sum, const symmetric<double>& squares, const vec<double, 3>& n,
                   const vec<double, 3>& t, double angle, double cosine, double sine) {
        const vec<double, 3> arc = n * sine + t * (1 - cosine);
        const symmetric<double> arc_squares = square_of(n) * (0.5 * (angle + sine * cosine)) +
                                              square_of(t) * (0.5 * (angle - sine * cosine)) +
                                              both_products(n, t) * (0.5 * sine * sine);
        volume[2] += 0.5 * angle * size;
        first[2] += sum * (0.5 * angle);
        first[3] += arc * (size / 3);
        second[2] = second[2] + squares * (0.5 * angle);
        second[3] = second[3] + both_products(sum, arc) * (1.0 / 3);
        second[4] = second[4] + arc_squares * (0.25 * size);
    }

    template <class T>
    static T at(const T* factors, int degree, double r) {
        T sum = factors[degree];
        for (int k = degree - 1; k >= 0; --k) sum = sum * r + factors[k];
        return sum;
    }
    /// Mass properties of the hull with the centroid c, rounded by r (m), by density.
    [[nodiscard]] PHYSICS_HPP_COLD mass_properties<double, 3> mass(const vec<double, 3>& c, double r,
                                                                   double density) const {
        const double size = at(volume, 3, r);
        const vec<double, 3> shift = at(first, 4, r) / size;
        const symmetric<double> m = (at(second, 5, r) + square_of(shift) * -size) * density;
        return {density * size, c + shift, {m.yy + m.zz, m.xx + m.zz, m.xx + m.yy, -m.xy, -m.xz, -m.yz}};
    }
};

/// The unit outward normal of an edge.
inline vec<double, 2> hull_normal(const vec<double, 2>* points, const std::uint16_t* corners, std::uint32_t) {
    return normalized(perpendicular(points[corners[1]] - points[corners[0]]));
}
/// The unit normal of a triangle, across its edges to rounding even where it is a needle: there a cross product of
/// two edges is not, by rounding over the angle between them.
inline vec<double, 3> triangle_normal(const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c) {
    vec<double, 3> e = b - a, f = c - b, g = a - c;
    // The longest edge first, in the same order.
    for (int i = 0; i < 2 && (dot(e, e) < dot(f, f) || dot(e, e) < dot(g, g)); ++i) {
        const vec<double, 3> first = e;
        e = f;
        f = g;
        g = first;
    }
    e = normalized(e);
    return normalized(cross(e, normalized(f - e * dot(e, f))));
}
/// The unit outward normal of a polygon: of its area (Newell's formula), or of its widest triangle if that is flatter,
/// as on long thin polygons.
template <class Index>
vec<double, 3> hull_normal(const vec<double, 3>* points, const Index* corners, std::uint32_t count) {
    const auto point = [&](std::uint32_t i) -> const vec<double, 3>& { return points[corners[i]]; };
    if (count == 3) return triangle_normal(point(0), point(1), point(2));
    const auto farthest = [&](auto&& distance) {
        std::uint32_t best = 0;
        for (std::uint32_t i = 1; i < count; ++i)
            if (distance(point(i)) > distance(point(best))) best = i;
        return best;
    };
    const std::uint32_t a = farthest([&](const vec<double, 3>& p) { return length(p - point(0)); });
    const std::uint32_t b = farthest([&](const vec<double, 3>& p) { return length(p - point(a)); });
    const vec<double, 3> along = normalized(point(b) - point(a));
    const std::uint32_t c = farthest([&](const vec<double, 3>& p) {
        const vec<double, 3> q = p - point(a);
        return length(q - along * dot(along, q));
    });
    vec<double, 3> sum, edge = point(1) - point(0);
    for (std::uint32_t i = 2; i < count; ++i) {
        const vec<double, 3> next = point(i) - point(0);
        sum += cross(edge, next);
        edge = next;
    }
    const vec<double, 3> by_area = normalized(sum), by_triangle = triangle_normal(point(a), point(b), point(c));
    const auto thickness = [&](const vec<double, 3>& n) {
        double low = 0, high = 0;
        for (std::uint32_t i = 1; i < count; ++i) {
            const double height = dot(n, point(i) - point(0));
            low = min(low, height);
            high = max(high, height);
        }
        return high - low;
    };
    if (!(thickness(by_triangle) < thickness(by_area))) return by_area;
    return dot(by_triangle, by_area) < 0 ? -by_triangle : by_triangle;
}

/// The integrals over a polygon with doubled area `doubled`, less by its factor: over the triangle a, b, c.
struct simplex_sums {
    vec<double, 3> first;
    symmetric<double> second;
};
inline simplex_sums over_triangle(const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c) {
    const vec<double, 3> sum = a + b + c;
    return {sum * (1.0 / 3), (square_of(sum) + square_of(a) + square_of(b) + square_of(c)) * (1.0 / 12)};
}

/// A polygon's area, first and second moments.
template <class Hull>
vec<double, 2> compute_hull_moments(const Hull& h, hull_moments& m) requires(Hull::dimension == 2) {
    const std::uint32_t n = h.vertex_count;
    const vec<double, 2> base = h.exact_vertex(0);
    double area = 0;
    vec<double, 2> centroid;
    for (std::uint32_t i = 1; i + 1 < n; ++i) {
        const vec<double, 2> a = h.exact_vertex(i) - base, b = h.exact_vertex(i + 1) - base;
        const double contribution = 0.5 * cross(a, b);
        area += contribution;
        centroid += (a + b) * (contribution / 3);
    }
    centroid = centroid / area + base;
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t next = i + 1 < n ? i + 1 : 0;
        const vec<double, 3> a = in_space(h.exact_vertex(i) - centroid), b = in_space(h.exact_vertex(next) - centroid);
        const double contribution = 0.5 * cross(a, b).z;
        m.volume[0] += contribution;
        m.second[0] = m.second[0] + over_triangle({}, a, b).second * contribution;
        const double size = length(b - a);
        const vec<double, 3> n1 = in_space(h.normal(i)), n2 = in_space(h.normal(next));
        m.add_prism(size, (a + b) * (0.5 * size), (square_of(a) + square_of(b) + square_of(a + b)) * (size / 6), n1);
        const vec<double, 3> t{-n1.y, n1.x, 0.0};
        const double cosine = dot(n1, n2), sine = dot(t, n2);
        m.add_wedge(1, b, square_of(b), n1, t, atan2(sine, cosine), cosine, sine);
    }
    return centroid;
}

/// A polyhedron's volume, first and second moments. The wedges of balls at vertices come from the arcs on the unit
/// sphere that bound them, since n and n n^T - 1/3 are eigenfunctions of the sphere's Laplacian (-2 and -6).
template <class Hull>
vec<double, 3> compute_hull_moments(const Hull& h, hull_moments& m) requires(Hull::dimension == 3) {
    const auto each_triangle = [&](const vec<double, 3>& origin, auto&& use) {
        for (std::uint32_t f = 0; f < h.face_count; ++f) {
            const std::uint16_t* corners = h.face_vertices();
            const std::uint32_t begin = h.face_begin(f), end = h.face_end(f);
            const vec<double, 3> a = h.exact_vertex(corners[begin]) - origin;
            for (std::uint32_t i = begin + 1; i + 1 < end; ++i)
                use(f, a, h.exact_vertex(corners[i]) - origin, h.exact_vertex(corners[i + 1]) - origin);
        }
    };
    const vec<double, 3> base = h.exact_vertex(0);
    double volume = 0;
    vec<double, 3> centroid;
    each_triangle(base, [&](std::uint32_t, const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c) {
        const double contribution = dot(a, cross(b, c)) / 6;
        volume += contribution;
        centroid += (a + b + c) * (0.25 * contribution);
    });
    centroid = centroid / volume + base;
    each_triangle(centroid,
                  [&](std::uint32_t f, const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c) {
                      const double contribution = dot(a, cross(b, c)) / 6;
                      m.volume[0] += contribution;
                      // A tetrahedron's second moment is 3/5 of its base's, at a third of the base's height.
                      const simplex_sums sums = over_triangle(a, b, c);
                      m.second[0] = m.second[0] + sums.second * (0.6 * contribution);
                      const vec<double, 3> n = h.normal(f);
                      const double area = 0.5 * dot(n, cross(b - a, c - a));
                      m.add_prism(area, sums.first * area, sums.second * area, n);
                  });
    const auto ball_wedge = [&](const vec<double, 3>& p, const vec<double, 3>& out, double angle,
                                const vec<double, 3>& arc) {
        // Of the ball's part between the planes across edges; their solid angles are added by corners below.
        const vec<double, 3> n1 = out * (-0.5 * angle);
        const symmetric<double> n2 = both_products(out, arc) * (-1.0 / 6);
        m.first[4] += n1 * 0.25;
        m.second[4] = m.second[4] + both_products(p, n1) * 0.25;
        m.second[5] = m.second[5] + n2 * 0.2;
    };
    for (std::uint32_t i = 0; i < h.edge_count; ++i) {
        const auto& e = h.edge(i);
        const vec<double, 3> a = h.exact_vertex(e.vertex[0]) - centroid, b = h.exact_vertex(e.vertex[1]) - centroid;
        const auto [d, size] = direction_and_length_of(b - a);
        const vec<double, 3> n = h.normal(e.face[0]), other = h.normal(e.face[1]), t = normalized(cross(d, n));
        const double cosine = dot(n, other), sine = dot(t, other), angle = atan2(sine, cosine);
        m.add_wedge(size, (a + b) * (0.5 * size), (square_of(a) + square_of(b) + square_of(a + b)) * (size / 6), n, t,
                    angle, cosine, sine);
        const vec<double, 3> arc = n * sine + t * (1 - cosine);
        ball_wedge(a, d, angle, arc);
        ball_wedge(b, -d, angle, arc);
    }
    const auto solid_angle = [&](const vec<double, 3>& p, double angle) {
        m.volume[3] += angle / 3;
        m.first[3] += p * (angle / 3);
        m.second[3] = m.second[3] + square_of(p) * (angle / 3);
        // 2 * angle / 6 in all directions, times r^5 / 5.
        m.second[5] = m.second[5] + symmetric<double>::diagonal(1, 1, 1) * (angle / 15);
    };
    // A vertex is rounded by the solid angle that its faces' corners lack of a full turn.
    constexpr double turn = 6.283185307179586;
    for (std::uint32_t v = 0; v < h.vertex_count; ++v) solid_angle(h.exact_vertex(v) - centroid, turn);
    for (std::uint32_t f = 0; f < h.face_count; ++f) {
        const std::uint32_t begin = h.face_begin(f), end = h.face_end(f);
        const auto corner = [&](std::uint32_t i) { return h.exact_vertex(h.face_vertices()[i]) - centroid; };
        for (std::uint32_t i = begin; i < end; ++i) {
            const vec<double, 3> p = corner(i), to = corner(i + 1 < end ? i + 1 : begin) - p,
                                 from = corner(i > begin ? i - 1 : end - 1) - p;
            solid_angle(p, -atan2(length(cross(to, from)), dot(to, from)));
        }
    }
    return centroid;
}

}  // namespace detail

PHYSICS_HPP_END
