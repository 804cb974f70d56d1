// The mesh: a surface of triangles in 3D, such as the ground of a level.
#pragma once

#include "physics/base/handle.hpp"
#include "physics/base/probe.hpp"
#include "physics/shape/concept.hpp"
#include "physics/shape/mesh_data.hpp"

PHYSICS_HPP_BEGIN

/// All points within radius (m, 0 or more) of triangles in the shape's frame; it exists in 3D. It has no mass, so it
/// serves static and kinematic bodies. A mesh_geometry or a world keeps the triangles: as long as one of them does, the
/// shape is good.
template <class S, int D>
struct mesh;
template <class S>
struct mesh<S, 3> {
    using scalar = S;
    const detail::mesh_data<detail::hull_real<S>>* geometry = nullptr;
    S radius{};

    template <class T>
    [[nodiscard]] constexpr auto as() const {
        if constexpr (detail::same_storage<S, T>) return mesh<T, 3>{geometry, static_cast<T>(radius)};
        else return detail::foreign_shape<T, mesh>{*this};
    }
};

template <class S>
bool check(const mesh<S, 3>& m, const char* function) {
    return detail::check_surface(m, "it must be the shape of a mesh_geometry that was built", function);
}
/// Tight up to 64 vertices; around 32 to 64 boxes of the tree where there are more.
template <class S>
aabb<S, 3> bounds(const mesh<S, 3>& m, const transform<S, 3>& at) {
    const auto& g = *m.geometry;
    detail::turned_bounds<S, 3> around(at);
    if (g.vertices.size() <= detail::points_to_bound)
        for (std::uint32_t i = 0; i < g.vertices.size(); ++i) around.add(g.vertex(i));
    else g.tree.cover([&](const aabb<float, 3>& box) { around.add(box); });
    return around.box(m.radius, g.box);
}
/// For the narrowphase: calls f with the triangles that may reach into a box of the shape's frame.
template <class S, class F>
void each_part(const mesh<S, 3>& m, const aabb<double, 3>& box, F&& f) {
    const auto& g = *m.geometry;
    g.tree.visit(box, [&](std::uint32_t i) {
        const auto& t = g.triangles[i];
        if (overlap(g.box_of(t), box)) f(g.part(t));
    });
}
/// For rays: calls f with the triangles that a segment may meet; f returns up to which part of it the search goes on.
template <class S, class F>
void each_part_along(const mesh<S, 3>& m, const detail::box_ray<3>& ray, F&& f) {
    const auto& g = *m.geometry;
    g.tree.visit(ray, [&](std::uint32_t i) { return f(g.face(g.triangles[i])); });
}

/// How triangles stop bodies.
struct mesh_settings {
    /// On the back too.
    bool two_sided = false;
};

/// A surface of triangles, built once and shared by all meshes made of it, and by worlds that hold such. Bodies glide
/// over the edges between triangles without a bump: vertices at the same place are one, and of the triangles that share
/// an edge each knows the other.
///
/// A body whose centre is behind a triangle passes through it, unless the mesh is two-sided. Where no triangle follows
/// beyond an edge, or more than one, or one of the other orientation, or one whose edge begins or ends elsewhere, the
/// edge is a free one: it can be hit from the side.
template <class S, int D>
class mesh_geometry;
template <class S>
class mesh_geometry<S, 3> {
public:
    /// No mesh: what build() gives in builds without exceptions when it has refused.
    mesh_geometry() = default;

    /// Triangles by three numbers of vertices each, counter-clockwise as seen from outside: triangle_count times 3
    /// indices. Triangles without area, as far as S can tell, are dropped and counted; what they lay between become
    /// neighbours. Refuses NaN and infinity, coordinates beyond 1e30 or a quarter of the range of S, numbers of
    /// vertices that do not exist, and meshes without any triangle. Cost: O(n log n), 1 us a triangle.
    [[nodiscard]] static mesh_geometry build(const vec<S, 3>* vertices, std::uint32_t vertex_count,
                                             const std::uint32_t* triangles, std::uint32_t triangle_count,
                                             const mesh_settings& settings = {}) {
        return mesh_geometry(
            detail::scoped([&] { return built(vertices, vertex_count, triangles, triangle_count, settings); }));
    }

    /// The same of arrays: of vertices, and of three indices for each triangle.
    template <array_of<vec<S, 3>> Vertices, array_of<std::uint32_t> Indices>
    [[nodiscard]] static mesh_geometry build(const Vertices& vertices, const Indices& indices,
                                             const mesh_settings& settings = {}) {
        const char* f = "mesh_geometry::build";
        if (!detail::check_count(f, "vertices", vertices) || !detail::check_count(f, "indices", indices)) return {};
        const std::uint32_t count = detail::count_of(indices);
        if (count % 3 != 0) {
            refuse(f, "indices", static_cast<double>(count), "there must be three for each triangle");
            return {};
        }
        return build(vertices.data(), detail::count_of(vertices), indices.data(), count / 3, settings);
    }

    explicit operator bool() const { return data() != nullptr; }
    /// The shape, grown by a radius (m). It is good as long as this geometry, a copy of it or a world keeps it.
    [[nodiscard]] mesh<S, 3> shape(S radius = S(0)) const { return {data(), radius}; }
    /// Contacts name triangles by the numbers that they were given with; the dropped ones count.
    [[nodiscard]] std::uint32_t triangle_count() const { return data()->triangles.size(); }
    [[nodiscard]] std::uint32_t dropped_triangles() const { return data()->dropped; }

    /// The block itself; null if there is none.
    [[nodiscard]] const detail::mesh_data<detail::hull_real<S>>* data() const { return owner_.get(); }

private:
    using block = detail::mesh_data<detail::hull_real<S>>;

    explicit mesh_geometry(const block* built) : owner_(built) {}
    static const block* built(const vec<S, 3>* vertices, std::uint32_t vertex_count, const std::uint32_t* triangles,
                              std::uint32_t triangle_count, const mesh_settings& settings);

    detail::geometry_owner<block> owner_;
};

template <class S>
const detail::mesh_data<detail::hull_real<S>>* mesh_geometry<S, 3>::built(const vec<S, 3>* vertices,
                                                                          std::uint32_t vertex_count,
                                                                          const std::uint32_t* triangles,
                                                                          std::uint32_t triangle_count,
                                                                          const mesh_settings& settings) {
    constexpr const char* f = "mesh_geometry::build";
    if (triangle_count > detail::null_index / 3) {
        detail::refuse(f, "triangle_count", triangle_count, "it must be at most 1431655765");
        return nullptr;
    }
    detail::mesh_outline outline;
    if (!detail::take_points(f, "vertices", vertices, vertex_count, outline.vertices)) return nullptr;
    if (!detail::check_array(f, "triangles", triangles, triangle_count)) return nullptr;
    for (std::uint32_t i = 0; i < triangle_count * 3; ++i) {
        if (triangles[i] < vertex_count) continue;
        char field[40];
        std::snprintf(field, sizeof field, "triangles[%u]", static_cast<unsigned>(i));
        detail::refuse(f, field, triangles[i], "it must be less than the number of vertices");
        return nullptr;
    }
    buffer<std::uint32_t> welded;
    outline.weld(welded);
    const double spacing = 2 * static_cast<double>(scalar_traits<S>::epsilon());
    outline.triangles.reserve(triangle_count);
    for (std::uint32_t i = 0; i < triangle_count; ++i) {
        const std::uint32_t* v = triangles + std::size_t{i} * 3;
        detail::mesh_outline::triangle t{{welded[v[0]], welded[v[1]], welded[v[2]]}, {}, {}};
        if (t.vertex[0] == t.vertex[1] || t.vertex[1] == t.vertex[2] || t.vertex[2] == t.vertex[0]) continue;
        t.normal = normalized(outline.area(t, spacing, detail::self_wide<S>));
        outline.triangles.push_back(t);
        outline.numbers.push_back(i);
    }
    outline.link();
    outline.drop_slivers();
    const std::uint32_t kept = outline.triangles.size();
    if (kept == 0) {
        detail::refuse(f, "number of triangles with an area", 0.0, "a mesh needs at least 1");
        return nullptr;
    }
    return block::make(outline, settings.two_sided, triangle_count - kept);
}

PHYSICS_HPP_END
