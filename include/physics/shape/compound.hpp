// The compound: several convex shapes as one, such as a table.
#pragma once

#include <initializer_list>

#include "physics/base/probe.hpp"
#include "physics/shape/compound_data.hpp"
#include "physics/shape/concept.hpp"

PHYSICS_HPP_BEGIN

/// Convex shapes, the children, each at a place of its own in the shape's frame. A compound_geometry or a world keeps
/// them: as long as one of them does, the shape is good.
template <class S, int D>
struct compound {
    using scalar = S;
    const detail::compound_data<D>* geometry = nullptr;

    template <class T>
    [[nodiscard]] constexpr compound<T, D> as() const {
        return {geometry};
    }
};

/// It meets other shapes child by child: there is no convex core for all.
template <class S, int D>
detail::core<D> core_of(const compound<S, D>&) = delete;

template <class S, int D>
bool check(const compound<S, D>& c, const char* function) {
    return c.geometry != nullptr ||
           detail::refuse(function, "geometry", "null", "it must be the shape of a compound_geometry that was built");
}
/// Tight up to 64 children; around 32 to 64 boxes of the tree where there are more.
template <class S, int D>
aabb<S, D> bounds(const compound<S, D>& c, const transform<S, D>& at) {
    const auto& g = *c.geometry;
    detail::turned_bounds<S, D> around(at);
    if (g.children.size() > detail::points_to_bound) {
        g.tree.cover([&](const aabb<float, D>& box) { around.add(box); });
        return around.box(S(0), g.box);
    }
    const mat<double, D> rows = transposed(detail::to_matrix(at.rotation));
    for (std::uint32_t i = 0; i < g.children.size(); ++i)
        for (int k = 0; k < D; ++k) {
            around.add(g.farthest(i, rows.column[k]));
            around.add(g.farthest(i, -rows.column[k]));
        }
    return around.box(S(0), g.box);
}
/// The farthest point of all children; of those at the same distance the first one's. Cost: O(children).
template <class S, int D>
vec<S, D> support(const compound<S, D>& c, vec<S, D> direction) {
    const vec<double, D> d = detail::to_point(direction);
    vec<double, D> best = c.geometry->farthest(0, d);
    for (std::uint32_t i = 1; i < c.geometry->children.size(); ++i) {
        const vec<double, D> p = c.geometry->farthest(i, d);
        if (dot(d, p) > dot(d, best)) best = p;
    }
    return detail::from_point<S>(best);
}
/// The sum over all children, each of that density: what they share counts as often as they share it. Calculated in
/// double when the geometry is built.
template <class S, int D>
mass_properties<S, D> mass_of(const compound<S, D>& c, std::type_identity_t<S> density) {
    const double d = static_cast<double>(density);
    const mass_properties<double, D>& m = c.geometry->mass;
    mass_properties<S, D> result{S(m.mass * d), detail::from_point<S>(m.center), {}};
    if constexpr (D == 2) {
        result.inertia = S(m.inertia * d);
    } else {
        const symmetric<double> i = m.inertia * d;
        result.inertia = {S(i.xx), S(i.yy), S(i.zz), S(i.xy), S(i.xz), S(i.yz)};
    }
    return result;
}
/// For the narrowphase: calls f with the children that may reach into a box of the shape's frame.
template <class S, int D, class F>
void each_child(const compound<S, D>& c, const aabb<double, D>& box, F&& f) {
    const auto& g = *c.geometry;
    const aabb<float, D> wanted = detail::outward_floats(box);
    g.tree.visit(box, [&](std::uint32_t i) {
        if (overlap(g.boxes[i], wanted)) f(g.children[i]);
    });
}
/// For rays: calls f with the children that a segment may meet; f returns up to which part of it the search goes on.
template <class S, int D, class F>
void each_child_along(const compound<S, D>& c, const detail::box_ray<D>& ray, F&& f) {
    const auto& g = *c.geometry;
    double maximum = 1;
    g.tree.visit(ray, [&](std::uint32_t i) {
        if (ray.meets(g.boxes[i], maximum)) maximum = f(g.children[i]);
        return maximum;
    });
}

/// A child of a compound to be: any convex shape of up to 64 bytes, where its frame stands in the compound's (m), and
/// how it is turned. The rotation must be one, as for bodies.
template <class S, int D>
class compound_child {
public:
    template <class Shape>
        requires detail::has_core<Shape> compound_child(const Shape& shape, vec<S, D> position = {},
                                                        const rotation<S, D>& turned = {})
            : position_(position), rotation_(turned) {
            static_assert(
                sizeof(Shape) <= detail::solid_bytes::capacity && alignof(Shape) <= alignof(detail::solid_bytes),
                "physics::compound_child: the shape is larger than 64 bytes");
            solid_.functions = &detail::solid_functions_of<Shape, D>;
            new (static_cast<void*>(solid_.shape.bytes)) Shape(shape);
        }

    private:
        template <class, int>
        friend class compound_geometry;

        detail::loose_solid<D> solid_{};
        vec<S, D> position_;
        rotation<S, D> rotation_;
};

/// Convex shapes as one, built once and shared by all compounds made of it, and by worlds that hold such.
///
///     const auto hammer = physics::compound_geometry<float, 2>::build({
///         {physics::box<float, 2>{{0.05f, 0.5f}}}, {physics::box<float, 2>{{0.3f, 0.1f}}, {0, 0.6f}}});
///     world.create_shape(body, hammer.shape());
///
/// Bodies with few shapes need no compound: each may have its own material there. A compound is one shape for the
/// broadphase, and finds its children by a tree. It keeps the hulls of its children.
template <class S, int D>
class compound_geometry {
public:
    /// No compound: what build() gives in builds without exceptions when it has refused.
    compound_geometry() = default;

    /// Refuses what the shapes themselves do, naming the child, places that are not finite or too far out for S, and no
    /// children at all. Contacts name children by their order. Cost: O(n log n), 1 us a child, 0.3 KB each.
    [[nodiscard]] static compound_geometry build(const compound_child<S, D>* children, std::uint32_t count) {
        return compound_geometry(detail::scoped([&] { return built(children, count); }));
    }
    template <array_of<compound_child<S, D>> Children>
    [[nodiscard]] static compound_geometry build(const Children& children) {
        if (!detail::check_count("compound_geometry::build", "children", children)) return {};
        return build(children.data(), detail::count_of(children));
    }
    [[nodiscard]] static compound_geometry build(std::initializer_list<compound_child<S, D>> children) {
        return build(children.begin(), static_cast<std::uint32_t>(children.size()));
    }

    explicit operator bool() const { return data() != nullptr; }
    /// The shape. It is good as long as this geometry, a copy of it or a world keeps it.
    [[nodiscard]] compound<S, D> shape() const { return {data()}; }

    /// The block itself; null if there is none.
    [[nodiscard]] const detail::compound_data<D>* data() const { return owner_.get(); }

private:
    explicit compound_geometry(const detail::compound_data<D>* built) : owner_(built) {}
    static const detail::compound_data<D>* built(const compound_child<S, D>* children, std::uint32_t count) {
        constexpr const char* f = "compound_geometry::build";
        if (count == 0) {
            detail::refuse(f, "number of children", 0.0, "a compound needs at least 1");
            return nullptr;
        }
        if (!detail::check_array(f, "children", children, count)) return nullptr;
        buffer<detail::loose_solid<D>> solids;
        solids.reserve(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            const compound_child<S, D>& child = children[i];
            char name[64];
            std::snprintf(name, sizeof name, "%s: child %u", f, static_cast<unsigned>(i));
            if (!child.solid_.functions->check(child.solid_.shape.bytes, name) ||
                !detail::check_finite(name, "position", child.position_) || !check_rotation(name, child.rotation_))
                return nullptr;
            detail::loose_solid<D>& s = solids.push_back(child.solid_);
            s.axes = detail::to_matrix(child.rotation_);
            s.at = detail::to_point(child.position_);
            if (!detail::check_reach<S>(name, largest(s.at))) return nullptr;
        }
        return detail::compound_data<D>::make(solids);
    }
    static bool check_rotation(const char* function, const rotation<S, 2>& r) {
        const double c = static_cast<double>(r.cosine), s = static_cast<double>(r.sine);
        return check_length(function, c * c + s * s);
    }
    static bool check_rotation(const char* function, const rotation<S, 3>& r) {
        const double x = static_cast<double>(r.x), y = static_cast<double>(r.y), z = static_cast<double>(r.z),
                     w = static_cast<double>(r.w);
        return check_length(function, (x * x + y * y) + (z * z + w * w));
    }
    static bool check_length(const char* function, double squared) {
        return abs(squared - 1) < 1e-3 ||
               detail::refuse(function, "squared length of rotation", squared, "it must be 1, to less than 0.001");
    }

    detail::geometry_owner<detail::compound_data<D>> owner_;
};

PHYSICS_HPP_END
