// Contact of shapes that are made of parts: surfaces and compounds.
#pragma once

#include "physics/base/buffer.hpp"
#include "physics/base/handle.hpp"
#include "physics/collide/surface.hpp"

PHYSICS_HPP_BEGIN

/// What a narrowphase found: a manifold, the number of the query that it answers, and of which part of concave shapes.
template <class S, int D>
struct found_manifold {
    std::uint32_t query;
    std::uint32_t part;
    manifold<S, D> contact = {};
};
/// Manifolds in ascending order of queries; none for shapes that are too far apart, several for concave shapes.
template <class S, int D>
using manifold_list = buffer<found_manifold<S, D>>;

namespace detail {

struct no_op {
    template <class T>
    void operator()(const T&) const {}
};
/// A shape made of flat parts: each_part(shape, box, f) calls f(surface_part) for those that may reach into the box, in
/// the shape's frame; it has a `radius`.
template <class Shape, int D>
concept is_surface = requires(const Shape s, const aabb<double, D> box) {
    each_part(s, box, no_op{});
};
/// A shape made of convex shapes: each_child(shape, box, f) calls f(compound_child) likewise.
template <class Shape, int D>
concept is_compound = requires(const Shape s, const aabb<double, D> box) {
    each_child(s, box, no_op{});
};

/// Calls f(core where it stands, number) for the convex shapes that a solid consists of and that may reach into the
/// box, which is given in the frame that `axes` and `at` lead to.
template <class Shape, int D, class F>
void each_solid(const Shape& shape, const mat<double, D>& axes, const point<D>& at, const aabb<double, D>& box, F&& f) {
    if constexpr (has_core<Shape>) {
        const core<D> c = core_of(shape);
        f(placed_core<D>{&c, axes, at}, 0u);
    } else {
        // The box as seen from the compound, by its middle and half extents.
        const point<D> middle = transposed_times(axes, (box.lower + box.upper) * 0.5 - at);
        const point<D> half = (box.upper - box.lower) * 0.5;
        point<D> reach;
        for (int i = 0; i < D; ++i)
            for (int k = 0; k < D; ++k) reach[i] += abs(axes.column[i][k]) * half[k];
        each_child(shape, aabb<double, D>{middle - reach, middle + reach}, [&](const auto& child) {
            f(placed_core<D>{&child.shape, axes * child.axes, axes * child.at + at}, child.number);
        });
    }
}
template <class S>
aabb<double, 2> everywhere(const rotation<S, 2>&) {
    return {{-no_limit, -no_limit}, {no_limit, no_limit}};
}
template <class S>
aabb<double, 3> everywhere(const rotation<S, 3>&) {
    return {{-no_limit, -no_limit, -no_limit}, {no_limit, no_limit, no_limit}};
}
/// Where a shape made of parts can be touched; everywhere unless its geometry says what box it fills.
template <class A, class S, int D>
aabb<double, D> box_of_parts(const A& a, const transform<S, D>& b_in_a, double reach) {
    if constexpr (requires {
                      { a.geometry->box } -> std::convertible_to<aabb<double, D>>;
                  })
        return grown(a.geometry->box, reach);
    else return everywhere(b_in_a.rotation);
}

/// Adds the contacts of A, a compound, with a halfspace.
template <class A, class S, int D>
void collide_children_with_plane(const A& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a, S margin,
                                 std::uint32_t query, manifold_list<S, D>& out) {
    const bounding_half<D> half(b, b_in_a);
    each_child(a, everywhere(b_in_a.rotation), [&](const auto& child) {
        manifold<double, D> m;
        find_halfspace_contacts<S>(placed_core<D>{&child.shape, child.axes, child.at}, half, detail::to_double(margin),
                                   m);
        if (m.count == 0) return;
        add_rounded_once(m, out.emplace_back(query, child.number).contact);
        for (int i = 0; i < m.count; ++i) out.back().contact.points[i].feature += hash_mixed(child.number, 0);
    });
}

/// Adds the contacts of A, a surface or a compound, with B, a compound or any shape that has a core.
template <class A, class B, class S, int D>
void collide_parts(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, overlap_method method,
                   std::uint32_t query, manifold_list<S, D>& out) {
    const mat<double, D> axes = to_matrix(b_in_a.rotation);
    const point<D> at = to_point(b_in_a.position);
    const double reach = detail::to_double(margin);
    const std::uint32_t first = out.size();
    double slack = 0;
    const auto add = [&](const manifold<double, D>& m, std::uint32_t of_a, std::uint32_t of_b) {
        if (m.count == 0) return;
        auto& found = out.emplace_back(query, of_a);
        add_rounded_once(m, found.contact);
        for (int i = 0; i < m.count; ++i) found.contact.points[i].feature += hash_mixed(of_a, of_b);
    };
    if constexpr (is_surface<A, D>) {
        const double radius = detail::to_double(a.radius);
        each_solid(b, axes, at, box_of_parts(a, b_in_a, radius + reach), [&](const auto& body, std::uint32_t of_b) {
            const double slack_of_body = (body.shape->thickness + body.shape->radius) * (1.0 / 512);
            const std::uint32_t first_of_body = out.size();
            doubtful_parts<D> doubtful;
            manifold<double, D> last_resort;
            rotated_support_feature<D> facets;
            std::uint32_t last_part = null_index;
            slack = max(slack, slack_of_body);
            each_part(a, bounds_of(body, radius + reach), [&](const surface_part<D>& part) {
                manifold<double, D> m;
                const bool certain = touch_part<S>(part, radius, body, reach, method, facets, m, last_resort);
                add(m, part.number, of_b);
                if (!certain && m.count > 0) doubtful.add(part, out.size() - 1);
                last_part = part.number < last_part ? part.number : last_part;
            });
            if (out.size() == first_of_body) add(last_resort, last_part, of_b);
            drop_doubtful<S, D>(out, first_of_body, doubtful, radius, body, slack_of_body);
        });
        join_alike<S, D>(out, first, static_cast<S>(slack));
    } else {
        each_solid(b, axes, at, box_of_parts(a, b_in_a, reach), [&](const placed_core<D>& body, std::uint32_t of_b) {
            each_child(a, bounds_of(body, reach), [&](const auto& child) {
                const mat<double, D> back = transposed(child.axes);
                const core_pair<D> pair(child.shape, *body.shape, back * body.axes, back * (body.at - child.at));
                manifold<double, D> m;
                find_core_contacts<S>(pair, reach, nullptr, method, m);
                m.normal = child.axes * m.normal;
                for (int i = 0; i < m.count; ++i) m.points[i].position = child.axes * m.points[i].position + child.at;
                add(m, child.number, of_b);
            });
        });
    }
}

}  // namespace detail

PHYSICS_HPP_END
