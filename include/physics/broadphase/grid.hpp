// A dense grid of cells.
#pragma once

#include "physics/broadphase/cell_index.hpp"
#include "physics/broadphase/indexed.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Cells in an array: as many as fill the region.
template <int D>
class dense_cells {
public:
    void arrange(cell_level<D>* levels, std::uint32_t count, std::uint32_t, const float_box<D>& region,
                 const std::uint32_t* population) {
        std::uint32_t total = 0;
        for (std::uint32_t l = 0; l < count; ++l) {
            cell_level<D>& level = levels[l];
            const auto dimension = [&](int i, float cell) {
                const double wide = static_cast<double>(region.upper[i]) - static_cast<double>(region.lower[i]);
                const double cells = wide / static_cast<double>(cell);
                return cells < 1e6 ? static_cast<double>(static_cast<std::uint32_t>(cells)) + 1 : 1e6;
            };
            const auto number = [&](float cell) {
                double product = 1;
                for (int i = 0; i < D; ++i) product *= dimension(i, cell);
                return product;
            };
            float cell = l + 1 < count ? level.side : std::numeric_limits<float>::max();
            const double maximum = population[l] / 4 + 1;
            while (number(cell) > maximum) cell *= 1.1f;
            level.set_cell(cell);
            level.base = total;
            std::uint32_t stride = 1;
            for (int i = 0; i < D; ++i) {
                level.low[i] = region.lower[i];
                level.maximum[i] = static_cast<float>(dimension(i, cell) - 1);
                level.stride[i] = stride;
                stride *= static_cast<std::uint32_t>(dimension(i, cell));
            }
            total += stride;
        }
        heads_.clear();
        heads_.resize(total, no_block);
    }
    bool adapt(const cell_level<D>*, std::uint32_t) { return false; }
    [[nodiscard]] std::uint32_t head(std::uint64_t key) const { return heads_[static_cast<std::uint32_t>(key)]; }
    std::uint32_t& at(std::uint64_t key) { return heads_[static_cast<std::uint32_t>(key)]; }

    PHYSICS_HPP_MEMBERS(heads_)

private:
    buffer<std::uint32_t> heads_;
};

}  // namespace detail

/// A dense grid: an array of cells over the region where things are. For worlds that are filled about evenly: there it
/// is as fast as dynamic_tree, within a tenth or so either way, and takes less memory. A move within a cell is one
/// write, and one into another cell costs the same wherever that is.
/// It measures by itself how large boxes are, how many and where, and arranges its cells anew when that has changed
/// much; each box is in cells of about its size, so that sizes may differ. The region is no wall: what lies outside
/// (the ends of the world, a few strays) is in the cells at the border and found like the rest; many there make each
/// other slow until the region follows them.
/// Choose another where things are in clusters far apart, or sizes differ a hundredfold (dynamic_tree takes half the
/// time): all cells of a level are of one size, so that clusters fill but few.
/// Cost of a step, for each proxy that left its box: 70 to 110 ns in 2D, 150 to 350 ns in 3D; resting ones cost
/// nothing. Arranging cells anew: 100 to 200 ns a proxy, in one step. Queries: O(cells in reach +
/// found); each_inside looks at all.
/// Source: Ericson, Real-time collision detection (2005), 7.1 and 7.2.
struct grid {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = indexed_broadphase<Space, detail::cell_index<Space, detail::dense_cells<Space::dimension>>>;
};

PHYSICS_HPP_END
