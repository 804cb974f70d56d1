// What chains and tile grids are in memory: points, what follows what, and a tree over the segments.
#pragma once

#include "physics/shape/surface_shape.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The segments before and after one; itself where nothing follows.
struct chain_links {
    std::uint32_t before, after;
};

/// Segments with coordinates in R. Segment i leads from point i to the point at which the segment after it begins; the
/// last of an open chain to the point after it. Without links segments follow one another as they are numbered.
template <class R>
struct chain_data : geometry_block {
    bool loop, two_sided;
    std::uint64_t digest;
    aabb<double, 2> box;
    block_array<vec<R, 2>> points;
    block_array<chain_links> links;
    part_tree<2> tree;

    [[nodiscard]] std::uint32_t segment_count() const { return tree.size(); }
    [[nodiscard]] vec<double, 2> point(std::uint32_t i) const { return to_point(points[i]); }
    [[nodiscard]] chain_links links_of(std::uint32_t i) const {
        if (links.size() > 0) return links[i];
        const std::uint32_t last = segment_count() - 1;
        return {i > 0 ? i - 1 : loop ? last : i, i < last ? i + 1 : loop ? 0 : i};
    }
    [[nodiscard]] vec<double, 2> end_of(std::uint32_t i) const {
        const std::uint32_t after = links_of(i).after;
        return point(after == i ? i + 1 : after);
    }
    [[nodiscard]] vec<double, 2> normal_of(std::uint32_t i) const {
        return normalized(perpendicular(end_of(i) - point(i)));
    }
    [[nodiscard]] surface_part<2> part(std::uint32_t i) const {
        const chain_links l = links_of(i);
        surface_part<2> p;
        p.corner[0] = point(i);
        p.corner[1] = point(l.after == i ? i + 1 : l.after);
        p.normal = normalized(perpendicular(p.corner[1] - p.corner[0]));
        p.continues[0] = l.before != i;
        p.continues[1] = l.after != i;
        if (p.continues[0]) p.beyond[0] = normal_of(l.before);
        if (p.continues[1]) p.beyond[1] = normal_of(l.after);
        p.two_sided = two_sided;
        p.number = i;
        return p;
    }

    /// A block with one owner: the caller. Links are null or one for each segment.
    static const chain_data* make(const buffer<vec<double, 2>>& points, const buffer<chain_links>& links, bool loop,
                                  bool two_sided);
};

/// The parts of a surface whose boxes reach into a box.
template <class R, class F>
void each_segment(const chain_data<R>& c, const aabb<double, 2>& box, F&& f) {
    c.tree.visit(box, [&](std::uint32_t i) {
        const vec<double, 2> a = c.point(i), b = c.end_of(i);
        if (overlap(aabb<double, 2>{min(a, b), max(a, b)}, box)) f(c.part(i));
    });
}
/// The parts that a segment may meet, as for rays on meshes.
template <class R, class F>
void each_segment_along(const chain_data<R>& c, const box_ray<2>& ray, F&& f) {
    c.tree.visit(ray, [&](std::uint32_t i) { return f(surface_face<2>{{c.point(i), c.end_of(i)}, c.two_sided}); });
}

template <class R>
const chain_data<R>* chain_data<R>::make(const buffer<vec<double, 2>>& points, const buffer<chain_links>& links,
                                         bool loop, bool two_sided) {
    const bool linked = links.size() > 0;
    const std::uint32_t segments = points.size() - (loop || linked ? 0 : 1);
    block_layout layout(sizeof(chain_data));
    const std::size_t at_points = layout.place<vec<R, 2>>(points.size());
    const std::size_t at_links = layout.place<chain_links>(links.size());
    const auto at_tree = part_tree<2>::place(layout, segments);
    auto* c = new_geometry<chain_data>(layout.bytes());
    c->loop = loop;
    c->two_sided = two_sided;
    c->box = box_around(points);
    c->digest = points.size() * 4ull + std::uint64_t{loop} * 2 + std::uint64_t{two_sided};
    c->points.attach(c, at_points, points.size());
    c->links.attach(c, at_links, links.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        c->points[i] = from_point<R>(points[i]);
        mix_digest(c->digest, points[i]);
    }
    for (std::uint32_t i = 0; i < links.size(); ++i) {
        c->links[i] = links[i];
        mix_digest(c->digest, std::uint64_t{links[i].before} << 32 | links[i].after);
    }
    buffer<aabb<float, 2>> boxes;
    boxes.reserve(segments);
    for (std::uint32_t i = 0; i < segments; ++i) {
        const vec<double, 2> a = points[i], b = points[linked ? links[i].after : i + 1 < points.size() ? i + 1 : 0];
        boxes.push_back(outward_floats(aabb<double, 2>{min(a, b), max(a, b)}));
    }
    c->tree.build(c, at_tree, boxes.begin(), segments);
    return c;
}

template <class R, class S>
aabb<S, 2> bounds_of_chain(const chain_data<R>& c, S radius, const transform<S, 2>& at) {
    turned_bounds<S, 2> around(at);
    if (c.points.size() <= points_to_bound)
        for (std::uint32_t i = 0; i < c.points.size(); ++i) around.add(c.point(i));
    else c.tree.cover([&](const aabb<float, 2>& box) { around.add(box); });
    return around.box(radius, c.box);
}

}  // namespace detail

PHYSICS_HPP_END
