// The tile grid: solid and empty cells in 2D, such as the level of a platformer.
#pragma once

#include "physics/base/probe.hpp"
#include "physics/shape/concept.hpp"
#include "physics/shape/tile_outline.hpp"

PHYSICS_HPP_BEGIN

/// All points within radius (m, 0 or more) of the outline of solid cells; it exists in 2D. It has no mass, so it
/// serves static and kinematic bodies. A tile_grid_geometry or a world keeps the outline: as long as one of them does,
/// the shape is good.
template <class S, int D>
struct tile_grid;
template <class S>
struct tile_grid<S, 2> {
    using scalar = S;
    const detail::chain_data<detail::hull_real<S>>* geometry = nullptr;
    S radius{};

    template <class T>
    [[nodiscard]] constexpr auto as() const {
        if constexpr (detail::same_storage<S, T>) return tile_grid<T, 2>{geometry, static_cast<T>(radius)};
        else return detail::foreign_shape<T, tile_grid>{*this};
    }
};

template <class S>
bool check(const tile_grid<S, 2>& g, const char* function) {
    return detail::check_surface(g, "it must be the shape of a tile_grid_geometry that was built", function);
}
/// Tight up to 64 corners; around 32 to 64 boxes of the tree where there are more.
template <class S>
aabb<S, 2> bounds(const tile_grid<S, 2>& g, const transform<S, 2>& at) {
    return detail::bounds_of_chain(*g.geometry, g.radius, at);
}
/// For the narrowphase: calls f with the straight runs that may reach into a box of the shape's frame.
template <class S, class F>
void each_part(const tile_grid<S, 2>& g, const aabb<double, 2>& box, F&& f) {
    detail::each_segment(*g.geometry, box, f);
}
/// For rays: calls f with the runs that a segment may meet; f returns up to which part of it the search goes on.
template <class S, class F>
void each_part_along(const tile_grid<S, 2>& g, const detail::box_ray<2>& ray, F&& f) {
    detail::each_segment_along(*g.geometry, ray, f);
}

/// The outline of solid cells, built once and shared by all tile grids made of it, and by worlds that hold such. Sides
/// in a row are one segment, however many cells it runs along, so that nothing can stumble over the joints between
/// cells. Cells that touch in one corner only count as joined there: nothing falls through, and what slides into such a
/// corner meets floor and wall.
///
/// A body whose centre is inside of a solid cell passes through the sides from within, as it does with chains.
template <class S, int D>
class tile_grid_geometry;
template <class S>
class tile_grid_geometry<S, 2> {
public:
    /// No grid: what build() gives in builds without exceptions when it has refused.
    tile_grid_geometry() = default;

    /// A grid of columns times rows square cells with sides of cell_size (m), whose lower left corner is the origin of
    /// the shape's frame: cells[row * columns + column] is 0 where the cell is empty, rows counted upwards. Refuses a
    /// size that is not greater than 0, grids too large for S or of 2^31 cells and more, and grids without any solid
    /// cell. Cost: 2 to 5 ns a cell, 0.3 us a corner; memory for corners only.
    [[nodiscard]] static tile_grid_geometry build(const std::uint8_t* cells, std::uint32_t columns, std::uint32_t rows,
                                                  S cell_size) {
        return tile_grid_geometry(detail::scoped([&] { return built(cells, columns, rows, cell_size); }));
    }

    template <array_of<std::uint8_t> Cells>
    [[nodiscard]] static tile_grid_geometry build(const Cells& cells, std::uint32_t columns, std::uint32_t rows,
                                                  S cell_size) {
        if (!detail::check_grid("tile_grid_geometry::build", "cells", cells, columns, rows)) return {};
        return build(cells.data(), columns, rows, cell_size);
    }

    explicit operator bool() const { return data() != nullptr; }
    /// The shape, grown by a radius (m). It is good as long as this geometry, a copy of it or a world keeps it.
    [[nodiscard]] tile_grid<S, 2> shape(S radius = S(0)) const { return {data(), radius}; }
    /// The straight runs of the outline; contacts name them as their part.
    [[nodiscard]] std::uint32_t segment_count() const { return data()->segment_count(); }

    /// The block itself; null if there is none.
    [[nodiscard]] const detail::chain_data<detail::hull_real<S>>* data() const { return owner_.get(); }

private:
    using block = detail::chain_data<detail::hull_real<S>>;

    explicit tile_grid_geometry(const block* built) : owner_(built) {}
    static const block* built(const std::uint8_t* cells, std::uint32_t columns, std::uint32_t rows, S cell_size) {
        constexpr const char* f = "tile_grid_geometry::build";
        if (!detail::check_spacing(f, "cell_size", cell_size)) return nullptr;
        const std::uint64_t corners = (std::uint64_t{columns} + 1) * (std::uint64_t{rows} + 1);
        if (corners > 0x7fffffffu) {
            detail::refuse(f, "number of corners", static_cast<double>(corners), "it must be less than 2^31");
            return nullptr;
        }
        const double size = static_cast<double>(cell_size);
        if (!detail::check_reach<S>(f, size * (columns > rows ? columns : rows))) return nullptr;
        if (!detail::check_array(f, "cells", cells, std::uint64_t{columns} * rows)) return nullptr;
        detail::tile_outline outline(cells, columns, rows);
        outline.trace();
        if (outline.points.empty()) {
            detail::refuse(f, "number of solid cells", 0.0, "a tile grid needs at least 1");
            return nullptr;
        }
        for (vec<double, 2>& p : outline.points) p = p * size;
        return block::make(outline.points, outline.links, true, false);
    }

    detail::geometry_owner<block> owner_;
};

PHYSICS_HPP_END
