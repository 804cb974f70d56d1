// The convex hull: a polygon in 2D, a polyhedron in 3D, of any number of vertices up to 65,535.
#pragma once

#include <initializer_list>

#include "physics/base/pack.hpp"
#include "physics/base/probe.hpp"
#include "physics/shape/concept.hpp"
#include "physics/shape/farthest.hpp"
#include "physics/shape/hull_builder3.hpp"

PHYSICS_HPP_BEGIN

/// The shape, see below.
template <class S, int D>
struct hull;

namespace detail {

template <class S, int D>
using hull_block = hull_data<hull_real<S>, D>;

/// A hull for calculations with the scalar T, whose geometry is stored for S: what as<T>() gives where the two store
/// differently. It has a mass, and goes back.
template <class T, class S, int D>
struct foreign_hull {
    using scalar = T;
    const hull_block<S, D>* geometry;
    T radius;

    template <class U>
    [[nodiscard]] constexpr auto as() const {
        if constexpr (std::is_same_v<hull_real<U>, hull_real<S>>) return hull<U, D>{geometry, static_cast<U>(radius)};
        else return foreign_hull<U, S, D>{geometry, static_cast<U>(radius)};
    }
};

}  // namespace detail

/// All points within radius (m, 0 or more) of a convex polygon or polyhedron in the shape's frame, whose vertices are
/// in a block of memory that a hull_geometry or a world keeps: as long as one of them does, the shape is good.
template <class S, int D>
struct hull {
    using scalar = S;
    const detail::hull_block<S, D>* geometry = nullptr;
    S radius{};

    template <class T>
    [[nodiscard]] constexpr auto as() const {
        return detail::foreign_hull<S, S, D>{geometry, radius}.template as<T>();
    }
};

/// How to build a hull.
struct hull_settings {
    /// At most so many vertices, of those that reach farthest; at least 3, in 3D 4. The others then lie outside, see
    /// hull_geometry::shortfall(). 0: all.
    std::uint32_t max_vertices = 0;
};

namespace detail {

/// How far rounding to S may bend what was flat, for coordinates up to `reach`: 8 spacings.
template <class S>
double hull_tolerance(double reach) {
    const double spacing = static_cast<double>(scalar_traits<S>::epsilon());
    return 8 * max(self_wide<S> ? spacing * reach : spacing, 0x1p-52 * reach);
}

/// A block around points, owned once; null after a refusal.
template <class S, int D>
const hull_block<S, D>* build_hull(const vec<S, D>* points, std::uint32_t count, const hull_settings& settings) {
    constexpr const char* function = "hull_geometry::build";
    if (!check_array(function, "points", points, count)) return nullptr;
    buffer<vec<double, D>> exact;
    exact.reserve(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        vec<double, D> p;
        for (int k = 0; k < D; ++k) p[k] = static_cast<double>(points[i][k]);
        // Without the sign of zeros, which would count as a difference in the digest.
        exact.push_back(p + vec<double, D>{});
        if (is_finite(p)) continue;
        char field[24];
        std::snprintf(field, sizeof field, "points[%u]", static_cast<unsigned>(i));
        check_finite(function, field, p);
        return nullptr;
    }
    if (count < D + 1) {
        refuse(function, "number of points", static_cast<double>(count),
               D == 2 ? "a polygon needs at least 3" : "a polyhedron needs at least 4");
        return nullptr;
    }
    const std::uint32_t maximum = settings.max_vertices;
    if (maximum > 0 && maximum < D + 1) {
        refuse(function, "max_vertices", static_cast<double>(maximum),
               D == 2 ? "it must be at least 3, or 0 for all" : "it must be at least 4, or 0 for all");
        return nullptr;
    }
    const double reach = reach_of(exact);
    if (!(reach > 0)) {
        refuse_thickness<D>(function, 0);
        return nullptr;
    }
    if (reach > 1e30 || reach < 1e-30) {
        refuse(function, "largest coordinate", reach, "it must be from 1e-30 to 1e30");
        return nullptr;
    }
    const hull_outline<D> outline = build_outline(exact, hull_tolerance<S>(reach), maximum, function);
    if (outline.empty()) return nullptr;
    const hull_block<S, D>* built = hull_block<S, D>::make(outline);
    if (built->volume() > 0) return built;
    release(built);
    refuse_thickness<D>(function, outline.tolerance);
    return nullptr;
}

/// The least and the largest dot products of vertices with D rows.
template <class R, int D>
void vertex_ranges(const hull_data<R, D>& h, const vec<R, D> (&rows)[D], vec<R, D>& lower, vec<R, D>& upper) {
    constexpr int width = sizeof(R) == 4 ? 8 : 4;
    using lanes = pack<R, width>;
    for (int axis = 0; axis < D; ++axis) {
        const auto height = [&](std::uint32_t i) {
            lanes sum = lanes::broadcast(rows[axis].x) * lanes::load(h.coordinate(0) + i) +
                        lanes::broadcast(rows[axis].y) * lanes::load(h.coordinate(1) + i);
            if constexpr (D == 3) sum = sum + lanes::broadcast(rows[axis].z) * lanes::load(h.coordinate(2) + i);
            return sum;
        };
        lanes low = height(0), high = low;
        for (std::uint32_t i = width; i < h.padded_vertices(); i += width) {
            const lanes here = height(i);
            low = min(low, here);
            high = max(high, here);
        }
        lower[axis] = -largest_lane(-low);
        upper[axis] = largest_lane(high);
    }
}

template <class T>
mass_properties<T, 2> narrowed_mass(const mass_properties<double, 3>& m, mass_properties<T, 2>*) {
    return {T(m.mass), {T(m.center.x), T(m.center.y)}, T(m.inertia.zz)};
}
template <class T>
mass_properties<T, 3> narrowed_mass(const mass_properties<double, 3>& m, mass_properties<T, 3>*) {
    const symmetric<double>& i = m.inertia;
    return {T(m.mass),
            {T(m.center.x), T(m.center.y), T(m.center.z)},
            {T(i.xx), T(i.yy), T(i.zz), T(i.xy), T(i.xz), T(i.yz)}};
}
template <class T, class Data>
mass_properties<T, Data::dimension> mass_of_hull(const Data& h, T radius, T density) {
    const double r = static_cast<double>(radius), d = static_cast<double>(density);
    return narrowed_mass(h.moments.mass(in_space(h.centroid), r, d),
                         static_cast<mass_properties<T, Data::dimension>*>(nullptr));
}

template <class T, class S, int D>
mass_properties<T, D> mass_of(const foreign_hull<T, S, D>& h, std::type_identity_t<T> density) {
    return mass_of_hull(*h.geometry, h.radius, density);
}

}  // namespace detail

template <class S, int D>
bool check(const hull<S, D>& h, const char* function) {
    if (h.geometry == nullptr)
        return detail::refuse(function, "geometry", "null", "it must be the shape of a hull_geometry that was built");
    return detail::check_not_negative(function, "radius", h.radius);
}
/// Tight, and around all vertices whatever rounding does. Cost: 1 to 3 ns a vertex.
template <class S, int D>
aabb<S, D> bounds(const hull<S, D>& h, const transform<S, D>& at) {
    using R = detail::hull_real<S>;
    const mat<S, D> m = matrix(at.rotation);
    vec<R, D> rows[D], low, high;
    for (int i = 0; i < D; ++i)
        for (int k = 0; k < D; ++k) rows[i][k] = static_cast<R>(static_cast<double>(m.column[k][i]));
    detail::vertex_ranges(*h.geometry, rows, low, high);
    S slack = S(4 * static_cast<double>(scalar_traits<S>::epsilon()) * h.geometry->reach);
    if (!(slack > S(0))) slack = scalar_traits<S>::epsilon();
    aabb<S, D> box;
    for (int i = 0; i < D; ++i) {
        box.lower[i] = S(static_cast<double>(low[i])) - (h.radius + slack);
        box.upper[i] = S(static_cast<double>(high[i])) + (h.radius + slack);
    }
    return {at.position + box.lower, at.position + box.upper};
}
/// Of vertices at the same distance the first.
template <class S, int D>
vec<S, D> support(const hull<S, D>& h, vec<S, D> direction) {
    const detail::hull_real<S>* rows[D];
    vec<double, D> d;
    for (int i = 0; i < D; ++i) {
        rows[i] = h.geometry->coordinate(i);
        d[i] = static_cast<double>(direction[i]);
    }
    const std::uint32_t farthest = detail::farthest_vertex(rows, h.geometry->padded_vertices(), d);
    const vec<double, D> v = h.geometry->exact_vertex(farthest);
    vec<S, D> p;
    for (int i = 0; i < D; ++i) p[i] = S(v[i]);
    return h.radius > S(0) ? p + normalized(direction) * h.radius : p;
}
/// Exact, rounding included; calculated in double.
template <class S, int D>
mass_properties<S, D> mass_of(const hull<S, D>& h, std::type_identity_t<S> density) {
    return detail::mass_of_hull(*h.geometry, h.radius, density);
}

/// The convex hull of points, built once and then shared by all hull shapes that are made of it, and by worlds that
/// hold such; copies share it too.
///
///     const auto rock = physics::hull_geometry<float, 3>::build(points, count);
///     world.create_shape(body, {.shape = rock.shape()});
template <class S, int D>
class hull_geometry {
public:
    /// No hull: what build() gives in builds without exceptions when it has refused.
    hull_geometry() = default;

    /// The hull of points in any order, at least 3 (4 in 3D), not all on one line (in one plane). Duplicates, points
    /// inside, on edges and in faces do no harm. Exact, but that what rounding of coordinates to S bent by at most 8
    /// spacings is flat, so that points may lie as far outside: the corners of a rotated box give six quads. Points
    /// within 32 spacings of each other may count as one; among many of these, as in float those of a plate of 1:10^5,
    /// points may lie 64 spacings of the largest coordinate outside. Vertices are some of the points, unchanged, in an
    /// order that depends on the set of points only. Refuses NaN and infinity, points without area or volume, and
    /// more than 65,535 vertices. Cost: O(n log n), in 3D 1 us a vertex and 0.1 to 0.5 us a point.
    [[nodiscard]] static hull_geometry build(const vec<S, D>* points, std::uint32_t count,
                                             const hull_settings& settings = {}) {
        return hull_geometry(detail::scoped([&] { return detail::build_hull(points, count, settings); }));
    }
    template <array_of<vec<S, D>> Points>
    [[nodiscard]] static hull_geometry build(const Points& points, const hull_settings& settings = {}) {
        if (!detail::check_count("hull_geometry::build", "points", points)) return {};
        return build(points.data(), detail::count_of(points), settings);
    }
    template <std::size_t N>
    [[nodiscard]] static hull_geometry build(const vec<S, D> (&points)[N], const hull_settings& settings = {}) {
        return build(points, static_cast<std::uint32_t>(N), settings);
    }
    [[nodiscard]] static hull_geometry build(std::initializer_list<vec<S, D>> points,
                                             const hull_settings& settings = {}) {
        return build(points.begin(), static_cast<std::uint32_t>(points.size()), settings);
    }

    explicit operator bool() const { return data() != nullptr; }
    /// The shape, grown by a radius (m). It is good as long as this geometry, a copy of it or a world keeps it.
    [[nodiscard]] hull<S, D> shape(S radius = S(0)) const { return {data(), radius}; }

    /// In 2D counter-clockwise, in 3D by x, y and z.
    [[nodiscard]] std::uint32_t vertex_count() const { return data()->vertex_count; }
    [[nodiscard]] vec<S, D> vertex(std::uint32_t i) const { return narrowed(data()->exact_vertex(i)); }
    /// Edges in 2D, edge i from vertex i to the next; polygons in 3D.
    [[nodiscard]] std::uint32_t face_count() const { return data()->face_count; }
    [[nodiscard]] std::uint32_t face_size(std::uint32_t face) const {
        return data()->face_end(face) - data()->face_begin(face);
    }
    /// The number of the k-th vertex of a face, counter-clockwise as seen from outside.
    [[nodiscard]] std::uint32_t face_vertex(std::uint32_t face, std::uint32_t k) const {
        return data()->face_vertices()[data()->face_begin(face) + k];
    }
    /// The unit outward normal of a face.
    [[nodiscard]] vec<S, D> face_normal(std::uint32_t face) const { return narrowed(data()->normal(face)); }
    /// The volume (m^3; in 2D the area, m^2) and the centroid, without any radius.
    [[nodiscard]] double volume() const { return data()->volume(); }
    [[nodiscard]] vec<double, D> centroid() const { return data()->centroid; }

    /// How far (m) points lie outside of a face since settings allowed only so many vertices.
    [[nodiscard]] double shortfall() const { return data()->shortfall; }
    /// The block itself; null if there is none.
    [[nodiscard]] const detail::hull_block<S, D>* data() const { return owner_.get(); }

private:
    explicit hull_geometry(const detail::hull_block<S, D>* built) : owner_(built) {}
    static vec<S, D> narrowed(const vec<double, D>& v) {
        vec<S, D> result;
        for (int i = 0; i < D; ++i) result[i] = S(v[i]);
        return result;
    }

    detail::geometry_owner<detail::hull_block<S, D>> owner_;
};

PHYSICS_HPP_END
