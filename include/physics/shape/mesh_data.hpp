// What a mesh is in memory: vertices, triangles with their neighbours, and a tree over them.
#pragma once

#include "physics/shape/mesh_links.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Triangles with coordinates in R.
template <class R>
struct mesh_data : geometry_block {
    struct triangle {
        std::uint32_t vertex[3];
        std::uint32_t beyond[3];
        /// The number that it was given with.
        std::uint32_t number;
        vec<R, 3> normal;
    };
    static constexpr std::uint32_t none = mesh_outline::none;

    bool two_sided;
    std::uint32_t dropped;
    std::uint64_t digest;
    aabb<double, 3> box;
    block_array<vec<R, 3>> vertices;
    block_array<triangle> triangles;
    part_tree<3> tree;

    [[nodiscard]] vec<double, 3> vertex(std::uint32_t i) const { return to_point(vertices[i]); }
    [[nodiscard]] aabb<double, 3> box_of(const triangle& t) const {
        const vec<double, 3> a = vertex(t.vertex[0]), b = vertex(t.vertex[1]), c = vertex(t.vertex[2]);
        return {min(a, min(b, c)), max(a, max(b, c))};
    }
    [[nodiscard]] surface_face<3> face(const triangle& t) const {
        return {{vertex(t.vertex[0]), vertex(t.vertex[1]), vertex(t.vertex[2])}, two_sided};
    }
    [[nodiscard]] surface_part<3> part(const triangle& t) const {
        surface_part<3> p;
        p.normal = to_point(t.normal);
        for (int i = 0; i < 3; ++i) {
            p.corner[i] = vertex(t.vertex[i]);
            p.continues[i] = t.beyond[i] != none;
            if (p.continues[i]) p.beyond[i] = to_point(triangles[t.beyond[i]].normal);
        }
        p.two_sided = two_sided;
        p.number = t.number;
        return p;
    }

    /// A block with one owner: the caller.
    static const mesh_data* make(const mesh_outline& outline, bool two_sided, std::uint32_t dropped);
};

template <class R>
const mesh_data<R>* mesh_data<R>::make(const mesh_outline& outline, bool two_sided, std::uint32_t dropped) {
    const std::uint32_t vertices = outline.vertices.size(), triangles = outline.triangles.size();
    block_layout layout(sizeof(mesh_data));
    const std::size_t at_vertices = layout.place<vec<R, 3>>(vertices);
    const std::size_t at_triangles = layout.place<triangle>(triangles);
    const auto at_tree = part_tree<3>::place(layout, triangles);
    auto* m = new_geometry<mesh_data>(layout.bytes());
    m->two_sided = two_sided;
    m->dropped = dropped;
    m->box = box_around(outline.vertices);
    m->digest = triangles * 2ull + std::uint64_t{two_sided};
    m->vertices.attach(m, at_vertices, vertices);
    m->triangles.attach(m, at_triangles, triangles);
    for (std::uint32_t i = 0; i < vertices; ++i) {
        m->vertices[i] = from_point<R>(outline.vertices[i]);
        mix_digest(m->digest, outline.vertices[i]);
    }
    buffer<aabb<float, 3>> boxes;
    boxes.reserve(triangles);
    for (std::uint32_t i = 0; i < triangles; ++i) {
        const auto& given = outline.triangles[i];
        triangle& t = m->triangles[i];
        for (int k = 0; k < 3; ++k) {
            t.vertex[k] = given.vertex[k];
            t.beyond[k] = given.beyond[k];
            mix_digest(m->digest, given.vertex[k]);
        }
        t.number = outline.numbers[i];
        mix_digest(m->digest, t.number);
        t.normal = from_point<R>(given.normal);
        boxes.push_back(outward_floats(m->box_of(t)));
    }
    m->tree.build(m, at_tree, boxes.begin(), triangles);
    return m;
}

}  // namespace detail

PHYSICS_HPP_END
