// A grid without bounds, of which only cells with something in them exist.
#pragma once

#include "physics/broadphase/cell_index.hpp"
#include "physics/broadphase/indexed.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Cells in a hash table with open addressing. Nothing walks through the table in its order.
template <int D>
class hashed_cells {
public:
    void arrange(cell_level<D>* levels, std::uint32_t count, std::uint32_t usual, const float_box<D>& region,
                 const std::uint32_t*) {
        // Cells of small ones not much smaller than of most: large ones look through them.
        for (std::uint32_t l = stretch_.size(); l < count; ++l)
            stretch_.push_back(l + 1 < usual ? static_cast<float>(1 << 2 * (usual - l - 1)) : 1.0f);
        for (std::uint32_t l = 0; l < count; ++l) {
            cell_level<D>& level = levels[l];
            const bool endless = l + 1 == count;
            level.set_cell(endless ? std::numeric_limits<float>::max() : level.side * stretch_[l]);
            level.base = std::uint64_t{l} << 60;
            for (int i = 0; i < D; ++i) {
                // A million cells along each axis, what there is in their middle.
                const float middle = region.lower[i] * 0.5f + region.upper[i] * 0.5f;
                level.low[i] = endless ? 0 : middle - level.cell * (1 << (bits - 1));
                level.maximum[i] = endless ? 0.0f : static_cast<float>((1 << bits) - 1);
                level.stride[i] = std::uint64_t{1} << i * bits;
            }
        }
        entries_.clear();
        used_ = 0;
    }
    /// Wider cells, where most would have but one or two boxes.
    bool adapt(const cell_level<D>* levels, std::uint32_t count) {
        bool better = false;
        for (std::uint32_t l = 0; l + 1 < count; ++l) {
            if (levels[l].count < 64) continue;
            const bool sparse = levels[l].count < 3 * levels[l].cells && stretch_[l] < 256;
            const bool dense = levels[l].count > 32 * levels[l].cells && stretch_[l] > 1.01f;
            if (sparse || dense) stretch_[l] *= sparse ? 1.5f : 1 / 1.5f;
            better = better || sparse || dense;
        }
        return better;
    }
    [[nodiscard]] std::uint32_t head(std::uint64_t key) const {
        if (entries_.empty()) return no_block;
        for (std::uint32_t i = first(key);; i = i + 1 == entries_.size() ? 0 : i + 1)
            if (entries_[i].key == key || entries_[i].key == no_key) return entries_[i].head;
    }
    std::uint32_t& at(std::uint64_t key) {
        if (2 * (used_ + 1) > entries_.size()) grow();
        std::uint32_t i = first(key);
        while (entries_[i].key != key && entries_[i].key != no_key) i = i + 1 == entries_.size() ? 0 : i + 1;
        if (entries_[i].key == no_key) ++used_;
        entries_[i].key = key;
        return entries_[i].head;
    }

    PHYSICS_HPP_MEMBERS(entries_, stretch_, used_, scratch_)

private:
    static constexpr int bits = 20;
    static constexpr std::uint64_t no_key = ~std::uint64_t{0};
    struct entry {
        std::uint64_t key;
        std::uint32_t head;
    };

    [[nodiscard]] std::uint32_t first(std::uint64_t key) const {
        const std::uint64_t mixed = (key ^ key >> 29) * 0x9e3779b97f4a7c15u;
        return static_cast<std::uint32_t>(mixed >> 32) & (entries_.size() - 1);
    }
    /// Makes room; entries of cells that are empty by now go.
    void grow() {
        std::uint32_t live = 0;
        for (const entry& e : entries_) live += e.head != no_block;
        std::uint32_t size = 64;
        while (size < 4 * (live + 1)) size *= 2;
        scratch_.clear();
        scratch_.resize(size, entry{no_key, no_block});
        entries_.swap(scratch_);
        used_ = 0;
        for (const entry& e : scratch_)
            if (e.head != no_block) at(e.key) = e.head;
    }

    buffer<entry> entries_;
    /// By level, how much wider a cell is than its boxes may be.
    buffer<float> stretch_;
    reset_on_move<std::uint32_t> used_;
    /// Scratch.
    step_scratch<buffer<entry>> scratch_;
};

}  // namespace detail

/// A hashed grid: the cells of grid, without its region. Only cells with something in them exist, found by a hash of
/// their coordinates, a million along each axis about where most things are; beyond, those at the border serve. For
/// open worlds in which things are scattered unevenly over a large area, and come and go everywhere: its memory and
/// time depend on them alone.
/// Choose grid where the world is filled evenly, which spares a tenth to a quarter, and dynamic_tree where sizes
/// differ tenfold and more or queries matter: each size of cells in use adds to every search.
/// Cost of a step, for each proxy that left its box: 80 to 120 ns in 2D, 200 to 400 ns in 3D; resting ones cost
/// nothing. Arranging cells anew: 100 to 300 ns a proxy, in one step. Queries:
/// O(cells in reach + found), but never much worse than a look at all boxes; each_inside looks at all.
/// Source: Teschner, Heidelberger, Mueller, Pomeranets, Gross, Optimized spatial hashing for collision detection of
/// deformable objects (2003); levels: Ericson, Real-time collision detection (2005), 7.2.1.
struct hash_grid {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = indexed_broadphase<Space, detail::cell_index<Space, detail::hashed_cells<Space::dimension>>>;
};

PHYSICS_HPP_END
