// What a compound is in memory: children with their cores and places, and a tree over them.
#pragma once

#include "physics/shape/surface_shape.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// What a compound needs to know of a shape whose type is forgotten.
template <int D>
struct solid_functions {
    bool (*check)(const void*, const char* function);
    detail::core<D> (*core)(const void*);
    /// With density 1.
    mass_properties<double, D> (*mass)(const void*);
    const geometry_block* (*geometry)(const void*);
    std::uint64_t (*digest)(const void*);
};
template <class Shape, int D>
inline constexpr solid_functions<D> solid_functions_of = {
    [](const void* s, const char* function) { return check(*static_cast<const Shape*>(s), function); },
    [](const void* s) { return core_of(*static_cast<const Shape*>(s)); },
    [](const void* s) -> mass_properties<double, D> {
        const auto exact = static_cast<const Shape*>(s)->template as<double>();
        if constexpr (requires { mass_of(exact, 1.0); }) return mass_of(exact, 1.0);
        else return {};
    },
    [](const void* s) -> const geometry_block* {
        if constexpr (refers_to_geometry<Shape>) return static_cast<const Shape*>(s)->geometry;
        else return static_cast<void>(s), nullptr;
    },
    [](const void* s) -> std::uint64_t {
        if constexpr (refers_to_geometry<Shape>) return static_cast<const Shape*>(s)->geometry->digest;
        else return static_cast<void>(s), 0;
    }};

/// The bytes of any shape.
struct solid_bytes {
    static constexpr std::size_t capacity = 64;
    alignas(8) unsigned char bytes[capacity] = {};
};
/// A shape and its place, before they become a child.
template <int D>
struct loose_solid {
    const solid_functions<D>* functions;
    solid_bytes shape;
    mat<double, D> axes;
    vec<double, D> at;
};

/// A child of a compound, as each_child() gives it.
template <int D>
struct placed_child {
    detail::core<D> shape;
    mat<double, D> axes;
    vec<double, D> at;
    std::uint32_t number;
};

/// Children in double for every scalar. It owns the geometry that they refer to.
template <int D>
struct compound_data : geometry_block {
    std::uint64_t digest;
    aabb<double, D> box;
    /// With density 1.
    mass_properties<double, D> mass;
    block_array<placed_child<D>> children;
    block_array<aabb<float, D>> boxes;
    block_array<solid_bytes> shapes;
    block_array<const geometry_block*> owned;
    part_tree<D> tree;

    /// The farthest point of child i along a direction of any length, radius included.
    [[nodiscard]] vec<double, D> farthest(std::uint32_t i, const vec<double, D>& d) const {
        const placed_child<D>& c = children[i];
        return c.axes * c.shape.support(transposed_times(c.axes, d)).at + c.at + normalized(d) * c.shape.radius;
    }
    /// A block with one owner: the caller.
    static const compound_data* make(const buffer<loose_solid<D>>& solids);
};

/// A mass as seen from where the frame of its shape stands.
inline mass_properties<double, 2> placed_mass(const mass_properties<double, 2>& m, const mat<double, 2>& axes,
                                              const vec<double, 2>& at) {
    return {m.mass, axes * m.center + at, m.inertia};
}
inline mass_properties<double, 3> placed_mass(const mass_properties<double, 3>& m, const mat<double, 3>& axes,
                                              const vec<double, 3>& at) {
    return {m.mass, axes * m.center + at, rotated(m.inertia, axes)};
}

template <int D>
const compound_data<D>* compound_data<D>::make(const buffer<loose_solid<D>>& solids) {
    const std::uint32_t count = solids.size();
    block_layout layout(sizeof(compound_data));
    const std::size_t at_children = layout.place<placed_child<D>>(count);
    const std::size_t at_boxes = layout.place<aabb<float, D>>(count);
    const std::size_t at_shapes = layout.place<solid_bytes>(count);
    const std::size_t at_owned = layout.place<const geometry_block*>(count);
    const auto at_tree = part_tree<D>::place(layout, count);
    auto* c = new_geometry<compound_data>(layout.bytes());
    c->gone = [](const geometry_block* block) {
        for (const geometry_block* held : static_cast<const compound_data*>(block)->owned) release(held);
    };
    c->digest = count;
    c->mass = {};
    c->children.attach(c, at_children, count);
    c->boxes.attach(c, at_boxes, count);
    c->shapes.attach(c, at_shapes, count);
    c->owned.attach(c, at_owned, count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const loose_solid<D>& s = solids[i];
        // Cores may refer to their shape.
        const void* const shape = new (&c->shapes[i]) solid_bytes(s.shape);
        const placed_child<D>& child =
            *new (&c->children[i]) placed_child<D>{s.functions->core(shape), s.axes, s.at, i};
        c->owned[i] = s.functions->geometry(shape);
        retain(c->owned[i]);
        c->mass = combined(c->mass, placed_mass(s.functions->mass(shape), s.axes, s.at));
        aabb<double, D> around;
        for (int k = 0; k < D; ++k) {
            vec<double, D> along;
            along[k] = 1;
            around.upper[k] = c->farthest(i, along)[k];
            around.lower[k] = c->farthest(i, -along)[k];
        }
        c->box = i == 0 ? around : merged(c->box, around);
        c->boxes[i] = outward_floats(around);
        mix_digest(c->digest, static_cast<std::uint64_t>(child.shape.kind));
        mix_digest(c->digest, s.functions->digest(shape));
        mix_digest(c->digest, scalar_traits<double>::bits(child.shape.radius));
        for (const vec<double, D>& p : child.shape.corner) mix_digest(c->digest, p);
        for (const vec<double, D>& p : s.axes.column) mix_digest(c->digest, p);
        for (const vec<double, D>& p : {s.at, around.lower, around.upper}) mix_digest(c->digest, p);
    }
    c->tree.build(c, at_tree, c->boxes.begin(), count);
    return c;
}

}  // namespace detail

PHYSICS_HPP_END
