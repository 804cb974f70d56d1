// Cells of one size.
#pragma once

#include "physics/broadphase/box_block.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Cells for boxes up to some side, each in the cell of its lower corner. A box that meets another begins no farther
/// below it than its own side: all that may meet it are in a few cells in a row. What lies outside of the region is in
/// the cells at its border. Coordinates rise with the position, whatever is rounded, so that nothing is missed.
template <int D>
struct cell_level {
    /// The longest side of a box, and the same with room for rounding.
    float side, reach;
    float cell, inverse;
    float low[D];
    /// The last coordinate.
    float maximum[D];
    /// The key of a cell is base + the sum of coordinate * stride.
    std::uint64_t base, stride[D];
    /// How many boxes there are, and how many cells have any.
    std::uint32_t count, cells;

    [[nodiscard]] std::uint32_t at(int axis, float x) const {
        const float t = (x - low[axis]) * inverse;
        return t > 0 ? static_cast<std::uint32_t>(t < maximum[axis] ? t : maximum[axis]) : 0;
    }
    [[nodiscard]] bool outside(int axis, float x) const {
        const float t = (x - low[axis]) * inverse;
        return t < 0 || t > maximum[axis] + 1;
    }
    void set_cell(float size) {
        cell = size;
        inverse = 1 / size;
    }
};

/// A block of cells, as coordinates; both corners belong to it.
template <int D>
struct cell_range {
    std::uint32_t first[D], last[D];

    /// All cells with boxes that may meet this one.
    cell_range(const cell_level<D>& level, const float_box<D>& box) {
        for (int i = 0; i < D; ++i) {
            first[i] = level.at(i, box.lower[i] - level.reach);
            last[i] = level.at(i, box.upper[i]);
        }
    }
    [[nodiscard]] double size() const {
        double product = 1;
        for (int i = 0; i < D; ++i) product *= static_cast<double>(last[i] - first[i]) + 1;
        return product;
    }
    /// Calls visit(key) for each until it returns false.
    template <class Visit>
    bool each(const cell_level<D>& level, Visit&& visit) const {
        const std::uint32_t from = D == 3 ? first[D - 1] : 0, to = D == 3 ? last[D - 1] : 0;
        for (std::uint32_t z = from; z <= to; ++z)
            for (std::uint32_t y = first[1]; y <= last[1]; ++y) {
                std::uint64_t key = level.base + first[0] + y * level.stride[1];
                if constexpr (D == 3) key += z * level.stride[2];
                for (std::uint32_t x = first[0]; x <= last[0]; ++x, ++key)
                    if (!visit(key)) return false;
            }
        return true;
    }
};

}  // namespace detail

PHYSICS_HPP_END
