// Convex shapes as the general kernels see them: a core with support points, and a radius around it.
#pragma once

#include "physics/shape/hull.hpp"
#include "physics/shape/shapes.hpp"

PHYSICS_HPP_BEGIN

// The general kernels (GJK, EPA, MPR, patches) compute in double for every scalar: it holds floats and Q32.32 numbers
// exactly, its products of floats too, and one copy of the code serves all. Results are rounded once to the scalar.

namespace detail {

/// A point or vector of the general kernels.
template <int D>
using point = vec<double, D>;

template <int D, class S>
constexpr point<D> to_point(const vec<S, D>& v) {
    point<D> p;
    for (int i = 0; i < D; ++i) p[i] = detail::to_double(v[i]);
    return p;
}
template <class S, int D>
constexpr vec<S, D> from_point(const point<D>& p) {
    vec<S, D> v;
    for (int i = 0; i < D; ++i) v[i] = static_cast<S>(p[i]);
    return v;
}

/// The rotation matrix in double; of a rotation whose length rounding has changed, that of the unit one.
template <class S>
mat<double, 2> to_matrix(const rotation<S, 2>& r) {
    const double c = detail::to_double(r.cosine), s = detail::to_double(r.sine);
    // One step of Newton from 1: what is left of an error e of the length is e^2.
    const double scale = 1.5 - 0.5 * (c * c + s * s);
    return {{{c * scale, s * scale}, {-s * scale, c * scale}}};
}
template <class S>
mat<double, 3> to_matrix(const rotation<S, 3>& r) {
    const double x = detail::to_double(r.x), y = detail::to_double(r.y), z = detail::to_double(r.z),
                 w = detail::to_double(r.w), s = 2 / ((x * x + y * y) + (z * z + w * w));
    return {{{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
             {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
             {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}}};
}

/// A support point and the number of the vertex that it is; 0 where the core has no vertices.
template <int D>
struct support_point {
    point<D> at;
    std::uint32_t vertex = 0;
};

/// In 2D the first four have as many corners as their place among them.
enum class core_kind : std::uint8_t { point, segment, triangle, box, hull_of_floats, hull_of_doubles, disc, custom };

/// A convex set in its own frame, to which a radius may be added on all sides; at first a point.
template <int D>
struct core {
    core_kind kind = core_kind::point;
    /// Vertices of a hull, a multiple of 8.
    std::uint32_t count = 0;
    /// Beyond the core (m).
    double radius = 0;
    /// No point of the core is farther from the frame's origin along any direction.
    double extent = 0;
    /// Half of the smallest width, which says what deviation is small; 0 for points, segments and triangles.
    double thickness = 0;
    /// The vertices of point, segment or triangle; in corner[0] the half extents of a box, or the half length, radius
    /// at the lower and at the upper end of discs.
    point<D> corner[3];
    /// A point inside.
    point<D> center;
    /// What a hull or a custom core is made of.
    const void* data = nullptr;
    const void* coordinate[D] = {};
    /// The support of a hull or a custom core: none is compiled where there are none.
    support_point<D> (*farthest)(const core&, const point<D>&) = nullptr;

    /// The farthest point along d, which need not be a unit vector, nor be other than null.
    [[nodiscard]] support_point<D> support(const point<D>& d) const {
        switch (kind) {
            case core_kind::point: return {corner[0], 0};
            case core_kind::segment: return nearer(d, 0, 1);
            case core_kind::triangle: {
                const support_point<D> best = nearer(d, 0, 1);
                return dot(d, corner[2] - best.at) > 0 ? support_point<D>{corner[2], 2} : best;
            }
            case core_kind::box: return support_of_box(d);
            case core_kind::disc: return {from_disc(d), 0};
            case core_kind::hull_of_floats:
            case core_kind::hull_of_doubles:
            case core_kind::custom: return farthest(*this, d);
        }
        return {};
    }
    /// The same, in line where it is short.
    [[nodiscard]] PHYSICS_HPP_ALWAYS_INLINE support_point<D> quick_support(const point<D>& d) const {
        return kind == core_kind::box ? support_of_box(d) : support(d);
    }
    /// The same of a box. Without branches, which nothing could predict.
    [[nodiscard]] PHYSICS_HPP_ALWAYS_INLINE support_point<D> support_of_box(const point<D>& d) const {
        support_point<D> result;
        for (int i = 0; i < D; ++i) {
            // Zeros have one sign only, so that corners do not depend on how a zero came about.
            const std::uint64_t sign = detail::bit_cast<std::uint64_t>(d[i] + 0.0) & sign_bit;
            result.at[i] = detail::bit_cast<double>(detail::bit_cast<std::uint64_t>(corner[0][i]) ^ sign);
            result.vertex |= static_cast<std::uint32_t>(sign >> (63 - i));
        }
        return result;
    }
    /// The vertex of that number; the number may be a wrong one, from another shape.
    [[nodiscard]] support_point<D> vertex(std::uint32_t i) const {
        switch (kind) {
            case core_kind::point: return {corner[0], 0};
            case core_kind::segment: i &= 1u; return {corner[i], i};
            case core_kind::triangle: i = i < 3 ? i : 0; return {corner[i], i};
            case core_kind::box: return vertex_of_box(i);
            case core_kind::hull_of_floats: return vertex_of_hull<float>(i < count ? i : 0);
            case core_kind::hull_of_doubles: return vertex_of_hull<double>(i < count ? i : 0);
            default: return {};
        }
    }
    [[nodiscard]] PHYSICS_HPP_ALWAYS_INLINE support_point<D> quick_vertex(std::uint32_t i) const {
        return kind == core_kind::box ? vertex_of_box(i) : vertex(i);
    }
    [[nodiscard]] PHYSICS_HPP_ALWAYS_INLINE support_point<D> vertex_of_box(std::uint32_t i) const {
        support_point<D> result{{}, i & ((1u << D) - 1)};
        for (int k = 0; k < D; ++k) {
            const std::uint64_t sign = static_cast<std::uint64_t>(i) << (63 - k) & sign_bit;
            result.at[k] = detail::bit_cast<double>(detail::bit_cast<std::uint64_t>(corner[0][k]) ^ sign);
        }
        return result;
    }
    /// As support(), of a hull whose coordinates are of type R.
    template <class R>
    [[nodiscard]] static support_point<D> support_of_hull(const core& c, const point<D>& d) {
        const R* rows[D];
        for (int k = 0; k < D; ++k) rows[k] = static_cast<const R*>(c.coordinate[k]);
        return c.vertex_of_hull<R>(farthest_vertex<R, D>(rows, c.count, d));
    }
    /// Whether a vertex's number names it, so that a simplex can be found again.
    [[nodiscard]] bool has_vertices() const { return kind < core_kind::disc; }

private:
    static constexpr std::uint64_t sign_bit = std::uint64_t{1} << 63;

    [[nodiscard]] support_point<D> nearer(const point<D>& d, std::uint32_t i, std::uint32_t j) const {
        return dot(d, corner[j] - corner[i]) > 0 ? support_point<D>{corner[j], j} : support_point<D>{corner[i], i};
    }
    template <class R>
    [[nodiscard]] support_point<D> vertex_of_hull(std::uint32_t i) const {
        support_point<D> result{{}, i};
        for (int k = 0; k < D; ++k) result.at[k] = static_cast<double>(static_cast<const R*>(coordinate[k])[i]);
        return result;
    }
    /// Of two coaxial discs and all between them; the axis is x.
    [[nodiscard]] point<D> from_disc(const point<D>& d) const {
        if constexpr (D == 3) {
            const double across = physics::sqrt(d.y * d.y + d.z * d.z), half = corner[0].x, low = corner[0].y,
                         high = corner[0].z;
            const bool upper = d.x * half + across * high > across * low - d.x * half;
            const double r = upper ? high : low, scale = across > 0 ? r / across : 0;
            return {upper ? half : -half, across > 0 ? d.y * scale : r, d.z * scale};
        } else {
            return {};
        }
    }
};

/// A core where it stands.
template <int D>
struct placed_core {
    const core<D>* shape;
    mat<double, D> axes;
    point<D> at;

    [[nodiscard]] PHYSICS_HPP_ALWAYS_INLINE support_point<D> support(const point<D>& d) const {
        support_point<D> s = shape->support(transposed_times(axes, d));
        s.at = axes * s.at + at;
        return s;
    }
    [[nodiscard]] support_point<D> vertex(std::uint32_t i) const {
        support_point<D> s = shape->vertex(i);
        s.at = axes * s.at + at;
        return s;
    }
};

}  // namespace detail

// core_of(shape) gives the core of a shape, which must outlive it. Shapes of your own have one too if they have a
// function support(shape, direction).

template <class S, int D>
detail::core<D> core_of(const ball<S, D>& b) {
    detail::core<D> c;
    c.radius = detail::to_double(b.radius);
    return c;
}
template <class S, int D>
detail::core<D> core_of(const capsule<S, D>& b) {
    detail::core<D> c;
    c.kind = detail::core_kind::segment;
    c.extent = detail::to_double(b.half_length);
    c.corner[0].x = -c.extent;
    c.corner[1].x = c.extent;
    c.radius = detail::to_double(b.radius);
    return c;
}
template <class S, int D>
detail::core<D> core_of(const box<S, D>& b) {
    detail::core<D> c;
    c.kind = detail::core_kind::box;
    c.corner[0] = detail::to_point(b.half_extents);
    c.thickness = c.corner[0].x;
    for (int i = 0; i < D; ++i) {
        c.extent += c.corner[0][i];
        c.thickness = min(c.thickness, c.corner[0][i]);
    }
    return c;
}
template <class S, int D>
detail::core<D> core_of(const hull<S, D>& b) {
    using real = detail::hull_real<S>;
    const auto& h = *b.geometry;
    detail::core<D> c;
    c.kind = std::is_same_v<real, float> ? detail::core_kind::hull_of_floats : detail::core_kind::hull_of_doubles;
    c.farthest = &detail::core<D>::template support_of_hull<real>;
    c.count = h.padded_vertices();
    c.radius = detail::to_double(b.radius);
    c.data = &h;
    for (int i = 0; i < D; ++i) {
        c.coordinate[i] = h.coordinate(i);
        c.extent += max(-h.lower[i], h.upper[i]);
    }
    c.center = h.centroid;
    c.thickness = h.inradius;
    return c;
}
/// Of a shape that is known by its support function alone.
template <template <class, int> class Shape, class S, int D>
    requires requires(const Shape<S, D>& s, vec<S, D> direction) {
        { support(s, direction) } -> std::same_as<vec<S, D>>;
    }
detail::core<D> core_of(const Shape<S, D>& shape) {
    detail::core<D> c;
    c.kind = detail::core_kind::custom;
    c.data = &shape;
    c.farthest = [](const detail::core<D>& self, const detail::point<D>& d) -> detail::support_point<D> {
        const vec<S, D> along = detail::from_point<S>(normalized(d));
        return {detail::to_point(support(*static_cast<const Shape<S, D>*>(self.data), along)), 0};
    };
    const aabb<S, D> box = bounds(shape, transform<S, D>{});
    for (int i = 0; i < D; ++i) c.extent += detail::to_double(max(abs(box.lower[i]), abs(box.upper[i])));
    return c;
}

namespace detail {

/// A shape that the general kernels take.
template <class Shape>
concept has_core = requires(const Shape& s) {
    core_of(s);
};

}  // namespace detail

PHYSICS_HPP_END
