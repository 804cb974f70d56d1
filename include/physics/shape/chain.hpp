// The chain: a line of segments in 2D, such as the ground of a level.
#pragma once

#include <initializer_list>

#include "physics/base/probe.hpp"
#include "physics/shape/chain_data.hpp"
#include "physics/shape/concept.hpp"

PHYSICS_HPP_BEGIN

/// All points within radius (m, 0 or more) of a line of segments in the shape's frame; it exists in 2D. It has
/// no mass, so it serves static and kinematic bodies. A chain_geometry or a world keeps the points: as long as one of
/// them does, the shape is good.
template <class S, int D>
struct chain;
template <class S>
struct chain<S, 2> {
    using scalar = S;
    const detail::chain_data<detail::hull_real<S>>* geometry = nullptr;
    S radius{};

    template <class T>
    [[nodiscard]] constexpr auto as() const {
        if constexpr (detail::same_storage<S, T>) return chain<T, 2>{geometry, static_cast<T>(radius)};
        else return detail::foreign_shape<T, chain>{*this};
    }
};

template <class S>
bool check(const chain<S, 2>& c, const char* function) {
    return detail::check_surface(c, "it must be the shape of a chain_geometry that was built", function);
}
/// Tight up to 64 points; around 32 to 64 boxes of the tree where there are more.
template <class S>
aabb<S, 2> bounds(const chain<S, 2>& c, const transform<S, 2>& at) {
    return detail::bounds_of_chain(*c.geometry, c.radius, at);
}
/// For the narrowphase: calls f with the segments that may reach into a box of the shape's frame.
template <class S, class F>
void each_part(const chain<S, 2>& c, const aabb<double, 2>& box, F&& f) {
    detail::each_segment(*c.geometry, box, f);
}
/// For rays: calls f with the segments that a segment may meet; f returns up to which part of it the search goes on.
template <class S, class F>
void each_part_along(const chain<S, 2>& c, const detail::box_ray<2>& ray, F&& f) {
    detail::each_segment_along(*c.geometry, ray, f);
}

/// How the points of a chain are joined.
struct chain_settings {
    /// The last point is joined to the first.
    bool loop = false;
    /// Bodies are stopped on the back too.
    bool two_sided = false;
};

/// The line of segments from each point to the next, built once and shared by all chains made of it, and by worlds that
/// hold such. Bodies glide from segment to segment without a bump. The solid is to the left on the way, the front to
/// the right: the ground leads from right to left, a ceiling from left to right, and the outline of an island, as of a
/// polygon, counter-clockwise.
/// Walk along a chain with your left hand on the solid: what comes from the right is stopped.
///
/// A body whose centre is behind a segment passes through it, unless the chain is two-sided. An open chain ends in
/// corners that bodies can hit from the side.
template <class S, int D>
class chain_geometry;
template <class S>
class chain_geometry<S, 2> {
public:
    /// No chain: what build() gives in builds without exceptions when it has refused.
    chain_geometry() = default;

    /// Refuses NaN and infinity, coordinates beyond 1e30 or a quarter of the range of S, fewer than 2 points (3 for a
    /// loop), and equal points next to each other. Cost: O(n log n), 0.5 us a point.
    [[nodiscard]] static chain_geometry build(const vec<S, 2>* points, std::uint32_t count,
                                              const chain_settings& settings = {}) {
        return chain_geometry(detail::scoped([&] { return built(points, count, settings); }));
    }
    template <array_of<vec<S, 2>> Points>
    [[nodiscard]] static chain_geometry build(const Points& points, const chain_settings& settings = {}) {
        if (!detail::check_count("chain_geometry::build", "points", points)) return {};
        return build(points.data(), detail::count_of(points), settings);
    }
    template <std::size_t N>
    [[nodiscard]] static chain_geometry build(const vec<S, 2> (&points)[N], const chain_settings& settings = {}) {
        return build(points, static_cast<std::uint32_t>(N), settings);
    }
    [[nodiscard]] static chain_geometry build(std::initializer_list<vec<S, 2>> points,
                                              const chain_settings& settings = {}) {
        return build(points.begin(), static_cast<std::uint32_t>(points.size()), settings);
    }

    explicit operator bool() const { return data() != nullptr; }
    /// The shape, grown by a radius (m). It is good as long as this geometry, a copy of it or a world keeps it.
    [[nodiscard]] chain<S, 2> shape(S radius = S(0)) const { return {data(), radius}; }
    /// Segment i leads from point i to the next; contacts name it as their part.
    [[nodiscard]] std::uint32_t segment_count() const { return data()->segment_count(); }

    /// The block itself; null if there is none.
    [[nodiscard]] const detail::chain_data<detail::hull_real<S>>* data() const { return owner_.get(); }

private:
    using block = detail::chain_data<detail::hull_real<S>>;

    explicit chain_geometry(const block* built) : owner_(built) {}
    static const block* built(const vec<S, 2>* points, std::uint32_t count, const chain_settings& settings) {
        constexpr const char* f = "chain_geometry::build";
        buffer<vec<double, 2>> exact;
        if (!detail::take_points(f, "points", points, count, exact)) return nullptr;
        if (count < (settings.loop ? 3u : 2u)) {
            detail::refuse(f, "number of points", static_cast<double>(count),
                           settings.loop ? "a loop needs at least 3" : "a chain needs at least 2");
            return nullptr;
        }
        for (std::uint32_t i = 0; i < (settings.loop ? count : count - 1); ++i) {
            const std::uint32_t next = i + 1 < count ? i + 1 : 0;
            const vec<double, 2> edge_vector = exact[next] - exact[i];
            // Points so close that this underflows have no direction either.
            if (dot(edge_vector, edge_vector) > 0) continue;
            char field[40];
            std::snprintf(field, sizeof field, "points[%u].x", static_cast<unsigned>(next));
            detail::refuse(f, field, exact[next].x, "it must not be the same point as the one before");
            return nullptr;
        }
        return block::make(exact, {}, settings.loop, settings.two_sided);
    }

    detail::geometry_owner<block> owner_;
};

PHYSICS_HPP_END
