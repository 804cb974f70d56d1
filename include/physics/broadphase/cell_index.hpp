// The index behind grid and hash_grid: boxes in cells of their size.
#pragma once

#include "physics/broadphase/block_scan.hpp"
#include "physics/broadphase/cell_blocks.hpp"
#include "physics/broadphase/cell_walk.hpp"
#include "physics/broadphase/float_order.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Levels of cells, each four times as wide as the one before; a box is in the level of its longest side. Cells, a
/// dense array or a hash table, says where the chain of a cell begins:
///   arrange(levels, count, usual, region, population)   how large cells are, and where; forgets all chains
///   adapt(levels, count)   after everything was put in: whether other cells would be better
///   head(key), at(key)     the first block of a cell
/// A box that moves within its cell is only written; one that leaves it costs the same wherever it goes.
template <class Space, class Cells>
class cell_index : public block_scan<cell_index<Space, Cells>, Space> {
public:
    using S = typename Space::scalar;
    static constexpr int D = Space::dimension;
    using table = proxies<Space>;
    using box = float_box<D>;

    void insert(const table& all, std::uint32_t id) {
        if (id >= places_.size()) places_.resize(id + 1);
        // Early ones of many: an update will see to how cells suit them all.
        if (levels_.empty() || all.count() > 4 * packed_ + 64) pack(all);
        else put(all, id, box_of(all, id));
    }
    void erase(const table&, std::uint32_t id) {
        take_out(id);
        wear_ = wear_ + 8;
    }
    void update(const table& all, const std::uint32_t* ids, std::uint32_t count) {
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::uint32_t id = ids[i];
            if (!all.has(id)) continue;
            const box b = box_of(all, id);
            auto& block = blocks_[places_[id] / 8];
            if (block.key == key_of(level_of(b), b)) {
                block.boxes.set(places_[id] % 8, b);
            } else {
                take_out(id);
                put(all, id, b);
            }
        }
        if (needs_rebuild(all)) pack(all);
    }

    /// See tree_index: the pairs of which one at least has moved.
    template <class Emit>
    bool find(const table& all, Emit&& emit) {
        // Some are left where the caller threw out of the last search.
        for (const std::uint32_t b : touched_) blocks_[b].moved = 0;
        touched_.clear();
        std::uint32_t movable = 0, moved[level_count]{};
        for (const std::uint32_t id : all.changed()) {
            if (!all.has(id)) continue;
            auto& block = blocks_[places_[id] / 8];
            ++moved[block.level];
            if (block.moved == 0) touched_.push_back(places_[id] / 8);
            block.moved = static_cast<std::uint8_t>(block.moved | 1u << places_[id] % 8);
            movable += all.is_movable(id);
        }
        // Where all of a level have moved, they find what is on coarser ones.
        std::uint32_t partly = 0;
        for (std::uint32_t l = 0; l < levels_.size(); ++l) partly |= (moved[l] < levels_[l].count ? 1u : 0u) << l;
        // In the order in which blocks lie in memory, where that is worth a look at each.
        if (touched_.size() > blocks_.size() / 16) {
            for (std::uint32_t b = 0; b < blocks_.size(); ++b)
                if (blocks_[b].moved != 0) find_from(b, partly, emit);
        } else {
            for (const std::uint32_t b : touched_) find_from(b, partly, emit);
        }
        for (const std::uint32_t b : touched_) blocks_[b].moved = 0;
        touched_.clear();
        return movable == movable_;
    }

    template <class Visit>
    void each_near(const table&, const typename Space::aabb& near, Visit&& visit) const {
        const box reach = enclosing(near, origin_);
        each_block(all_levels, reach, [&](std::uint32_t b) {
            bool on = true;
            each_bit(blocks_[b].boxes.overlapping(reach),
                     [&](std::uint32_t lane) { on = on && visit(blocks_[b].ids[lane]); });
            return on;
        });
    }
    /// Along the cells that the ray goes through, layer by layer.
    template <class Visit>
    void each_along(const table&, const ray<S, D>& r, S limit, Visit&& visit) const {
        const float_ray<D> fast_ray(r, origin_);
        float reach = above(limit) + fast_ray.step, near[8];
        const auto meet = [&](std::uint32_t b) {
            each_bit(fast_ray.meets(blocks_[b].boxes, reach, near),
                     [&](std::uint32_t lane) { reach = above(visit(blocks_[b].ids[lane])) + fast_ray.step; });
            return !(reach < 0);
        };
        const cell_walk<S, D> cells(r, origin_, fast_ray.step);
        std::uint32_t wide = 0;
        // Large ones first: they are few, and likely to end it.
        for (std::uint32_t l = levels_.size(); l-- > 0 && !(reach < 0);) {
            const cell_level<D>& level = levels_[l];
            const auto visit_range = [&](const cell_range<D>& range) { return each_in(level, range, meet); };
            if (level.count > 0 && !cells.each_layer(level, reach, blocks_.size(), visit_range)) wide |= 1u << l;
        }
        if (!(reach < 0)) each_of(wide, meet);
    }

    // For block_scan.
    template <class F>
    void each_eight(F&& f) const {
        for (std::uint32_t b = 0; b < blocks_.size(); ++b)
            if (blocks_[b].count > 0 && !f(blocks_[b].boxes, [&](std::uint32_t lane) { return blocks_[b].ids[lane]; }))
                return;
    }
    template <class F>
    void each_eight(const box& near, F&& f) const {
        each_block(all_levels, near, [&](std::uint32_t b) {
            return f(blocks_[b].boxes, [&](std::uint32_t lane) { return blocks_[b].ids[lane]; });
        });
    }
    [[nodiscard]] float usual_size() const { return levels_.empty() ? 1 : levels_[usual].cell; }
    template <class F>
    void each_loose(F&&) const {}
    [[nodiscard]] const typename Space::vec& origin() const { return origin_; }

    PHYSICS_HPP_MEMBERS(cells_, blocks_, levels_, places_, touched_, keys_, scratch_, origin_, packed_, movable_, wear_)

private:
    /// Below and above the level that most boxes are in; the last one has no bounds, and one cell.
    static constexpr std::uint32_t finer = 4, coarser = 4, level_count = finer + coarser + 2, usual = finer;
    static constexpr std::uint32_t all_levels = ~0u;

    box box_of(const table& all, std::uint32_t id) const { return enclosing(all.box(id), origin_); }
    static float side_of(const box& b) {
        float side = 0;
        for (int i = 0; i < D; ++i) side = b.upper[i] - b.lower[i] > side ? b.upper[i] - b.lower[i] : side;
        return side;
    }
    std::uint32_t level_of(const box& b) const {
        const float side = side_of(b);
        std::uint32_t l = usual;
        while (l + 1 < level_count && side > levels_[l].side) ++l;
        while (l > 0 && !(side > levels_[l - 1].side)) --l;
        return l;
    }
    std::uint64_t key_of(std::uint32_t l, const box& b) const {
        const cell_level<D>& level = levels_[l];
        std::uint64_t key = level.base;
        for (int i = 0; i < D; ++i) key += level.at(i, b.lower[i]) * level.stride[i];
        return key;
    }
    void put(const table& all, std::uint32_t id, const box& b) {
        const std::uint32_t l = level_of(b);
        cell_level<D>& level = levels_[l];
        const std::uint64_t key = key_of(l, b);
        std::uint32_t& head = cells_.at(key);
        level.cells += head == no_block;
        ++level.count;
        movable_ = movable_ + all.is_movable(id);
        places_[id] = blocks_.add(head, key, l, b, id, all.is_movable(id));
        // Far from all cells, where each more makes the others slower.
        for (int i = 0; i < D; ++i) wear_ = wear_ + (l + 1 < level_count && level.outside(i, b.lower[i]) ? 16 : 0);
        ++wear_;
    }
    void take_out(std::uint32_t id) {
        const std::uint32_t slot = places_[id];
        auto& block = blocks_[slot / 8];
        cell_level<D>& level = levels_[block.level];
        std::uint32_t& head = cells_.at(block.key);
        movable_ = movable_ - (block.movable >> slot % 8 & 1);
        const std::uint32_t moved = blocks_.remove(head, slot);
        if (moved != no_proxy) places_[moved] = slot;
        level.cells -= head == no_block;
        --level.count;
    }

    /// So much has come, gone or wandered off that other cells, or another order in memory, are likely to be better.
    bool needs_rebuild(const table& all) const {
        return wear_ > 8 * std::uint64_t{all.count()} + 512 || all.count() > packed_ + packed_ / 2 + 64;
    }

    /// Looks at what there is, arranges cells for it and puts everything in anew.
    void pack(const table& all) {
        float_sample sides, lows[D];
        const std::uint32_t stride = all.count() / float_sample::capacity + 1;
        const auto sample = [&](auto&& use) {
            std::uint32_t seen = 0;
            for (std::uint32_t id = 0; id < all.size(); ++id)
                if (all.has(id) && seen++ % stride == 0) use(box_of(all, id));
        };
        const auto middle = [&] {
            for (float_sample& s : lows) s = {};
            sample([&](const box& b) {
                for (int i = 0; i < D; ++i) lows[i].add(b.lower[i]);
            });
            for (float_sample& s : lows) s.sort();
        };
        middle();
        if constexpr (!std::is_same_v<S, float>) {
            // Floats are finest near their origin.
            for (int i = 0; i < D; ++i) origin_[i] += S(static_cast<double>(lows[i].at(0.5f)));
            middle();
        }
        sample([&](const box& b) { sides.add(side_of(b)); });
        sides.sort();
        box region;
        for (int i = 0; i < D; ++i) {
            // What is beyond by more than that is a stray.
            const float low = lows[i].at(0.02f), high = lows[i].at(0.98f), more = (high - low) * 0.25f;
            region.lower[i] = lows[i].at(0) > low - more ? lows[i].at(0) : low - more;
            region.upper[i] = lows[i].at(1) < high + more ? lows[i].at(1) : high + more;
        }
        std::uint32_t population[level_count]{};
        levels_.resize(level_count);
        const float infinity = std::numeric_limits<float>::infinity();
        const float typical = sides.at(0.9f) * 1.25f;
        float side = (typical > 1e-20f ? typical < 1e20f ? typical : 1e20f : 1e-20f) / (1 << 2 * finer);
        for (std::uint32_t l = 0; l < level_count; ++l, side *= 4) {
            levels_[l] = {};
            levels_[l].side = l + 1 < level_count ? side : infinity;
            levels_[l].reach = levels_[l].side * 1.000001f;
        }
        sample([&](const box& b) { population[level_of(b)] += stride; });
        keys_.clear();
        for (std::uint32_t id = 0; id < all.size(); ++id)
            if (all.has(id)) keys_.push_back(std::uint64_t{place_of(box_of(all, id), region)} << 32 | id);
        const std::uint32_t count = keys_.size();
        scratch_.resize(count);
        const std::uint64_t* order = radix_sort(keys_.begin(), scratch_.begin(), count, 32, 62);
        for (int attempt = 0;; ++attempt) {
            cells_.arrange(levels_.begin(), level_count, usual, region, population);
            blocks_.clear();
            touched_.clear();
            movable_ = 0;
            for (cell_level<D>& level : levels_) level.count = level.cells = 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                const auto id = static_cast<std::uint32_t>(order[i]);
                put(all, id, box_of(all, id));
            }
            if (attempt == 6 || !cells_.adapt(levels_.begin(), level_count)) break;
        }
        wear_ = 0;
        packed_ = count;
    }

    /// Where a box is on a curve through a region that keeps neighbours together in memory.
    /// Source: Morton, A computer oriented geodetic data base (1966).
    static std::uint32_t place_of(const box& b, const box& region) {
        constexpr int bits = 30 / D;
        std::uint32_t place = 0;
        for (int i = 0; i < D; ++i) {
            const float fraction = (b.lower[i] - region.lower[i]) / (region.upper[i] - region.lower[i]);
            // Not a number where the region is flat.
            const auto cell =
                static_cast<std::uint32_t>(fraction > 0 ? (fraction < 1 ? fraction : 1) * ((1 << bits) - 1) : 0);
            for (int bit = 0; bit < bits; ++bit) place |= (cell >> bit & 1u) << (bit * D + i);
        }
        return place;
    }

    /// Calls visit(b) for the blocks of some levels with boxes that may meet this one, until it returns false.
    template <class Visit>
    void each_block(std::uint32_t levels, const box& reach, Visit&& visit) const {
        std::uint32_t wide = 0;
        for (std::uint32_t l = 0; l < levels_.size(); ++l) {
            if (levels_[l].count == 0 || !(levels >> l & 1)) continue;
            const cell_range<D> range(levels_[l], reach);
            if (range.size() > blocks_.size()) wide |= 1u << l;
            else if (!each_in(levels_[l], range, visit)) return;
        }
        each_of(wide, visit);
    }
    template <class Visit>
    bool each_in(const cell_level<D>& level, const cell_range<D>& range, Visit&& visit) const {
        return range.each(level, [&](std::uint64_t key) {
            for (std::uint32_t b = cells_.head(key); b != no_block; b = blocks_[b].next)
                if (!visit(b)) return false;
            return true;
        });
    }
    /// The same for all blocks of some levels: where there are more cells than blocks.
    template <class Visit>
    void each_of(std::uint32_t levels, Visit&& visit) const {
        if (levels == 0) return;
        for (std::uint32_t b = 0; b < blocks_.size(); ++b)
            if (blocks_[b].count > 0 && levels >> blocks_[b].level & 1 && !visit(b)) return;
    }

    /// The pairs of the boxes of a block that have moved.
    template <class Emit>
    void find_from(std::uint32_t b, std::uint32_t partly, Emit&& emit) {
        const auto& block = blocks_[b];
        const float room = levels_[block.level].cell * 2;
        const std::uint32_t levels = partly | all_levels << block.level;
        box around{};
        std::uint32_t lanes = 0;
        each_bit(block.moved, [&](std::uint32_t lane) {
            const box own = block.boxes.get(lane);
            if (lanes == 0) around = own;
            box both = around;
            for (int i = 0; i < D; ++i) {
                both.lower[i] = own.lower[i] < both.lower[i] ? own.lower[i] : both.lower[i];
                both.upper[i] = own.upper[i] > both.upper[i] ? own.upper[i] : both.upper[i];
            }
            // Strays may share a cell at the border and yet be far from each other.
            if (lanes != 0 && side_of(both) > room) {
                find_lanes(b, lanes, around, levels, emit);
                lanes = 0;
                both = own;
            }
            around = both;
            lanes |= 1u << lane;
        });
        find_lanes(b, lanes, around, levels, emit);
    }
    template <class Emit>
    void find_lanes(std::uint32_t b, std::uint32_t lanes, const box& around, std::uint32_t levels, Emit&& emit) {
        const auto& block = blocks_[b];
        const std::uint32_t movable = lanes & block.movable;
        const bool alone = (lanes & (lanes - 1)) == 0;
        each_block(levels, around, [&](std::uint32_t o) {
            const auto& other = blocks_[o];
            // Of two that have moved, the one on the finer level finds the other, or that in the earlier block.
            std::uint32_t wanted = movable != 0 ? 0xffu : other.movable;
            const bool finds = block.level != other.level ? block.level < other.level : b < o;
            if (!finds && b != o) wanted &= ~std::uint32_t{other.moved};
            if (wanted == 0) return true;
            each_bit(wanted & other.boxes.overlapping(around), [&](std::uint32_t k) {
                std::uint32_t met = other.movable >> k & 1 ? lanes : movable;
                if (!alone || b == o) met &= block.boxes.overlapping(other.boxes.get(k));
                if (b == o && other.moved >> k & 1) met &= ~((2u << k) - 1);
                each_bit(met, [&](std::uint32_t i) { emit(block.ids[i], other.ids[k]); });
            });
            return true;
        });
    }

    Cells cells_;
    cell_blocks<D> blocks_;
    buffer<cell_level<D>> levels_;
    /// By proxy: its slot, eight a block.
    buffer<std::uint32_t> places_;
    /// The blocks with a box that has moved, while pairs are searched, and where the caller threw out of it.
    buffer<std::uint32_t> touched_;
    // Scratch.
    step_scratch<buffer<std::uint64_t>> keys_, scratch_;
    typename Space::vec origin_{};
    /// How many there were when cells were arranged, and how many are movable.
    reset_on_move<std::uint32_t> packed_, movable_;
    reset_on_move<std::uint64_t> wear_;
};

}  // namespace detail

PHYSICS_HPP_END
