// Boxes in the order in which they begin along an axis.
#pragma once

#include "physics/base/buffer.hpp"
#include "physics/broadphase/box_block.hpp"
#include "physics/broadphase/float_order.hpp"
#include "physics/broadphase/proxies.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Boxes sorted by their lower sides along one axis, eight to a block. Above the blocks lies how far any of 8, 64, ...
/// boxes reaches, so that a search finds what began long before without looking at all. What was erased leaves an
/// empty lane with its key until the order is sorted anew.
template <int D>
class axis_order {
public:
    using box = float_box<D>;
    using block = box_block<D>;

    [[nodiscard]] std::uint32_t size() const { return keys_.size(); }
    [[nodiscard]] std::uint32_t live() const { return live_; }
    [[nodiscard]] std::uint32_t blocks() const { return blocks_.size(); }
    [[nodiscard]] const block& operator[](std::uint32_t b) const { return blocks_[b]; }
    [[nodiscard]] std::uint32_t id(std::uint32_t slot) const { return static_cast<std::uint32_t>(keys_[slot]); }
    [[nodiscard]] int axis() const { return axis_; }
    /// About how large boxes are.
    [[nodiscard]] float usual_size() const { return usual_size_; }
    /// Where the middle half of them is when they are sorted: its middle along any axis, its width along the best one.
    [[nodiscard]] float middle(int axis) const { return middle_[axis]; }
    [[nodiscard]] float width() const { return width_; }

    /// Adds a proxy, in no order: to be followed by sort().
    void add(std::uint32_t id) { keys_.push_back(id); }
    void remove(std::uint32_t slot) {
        clear(slot);
        keys_[slot] |= no_proxy;
        --live_;
    }
    /// Sorts everything, along the axis that suits it best; get(id) gives a box, and at(id, slot) is told where it is.
    template <class Get, class At>
    void sort(Get&& get, At&& at) {
        ids_.clear();
        for (const std::uint64_t key : keys_)
            if (static_cast<std::uint32_t>(key) != no_proxy) ids_.push_back(static_cast<std::uint32_t>(key));
        const std::uint32_t count = ids_.size();
        boxes_.clear();
        boxes_.reserve(count);
        for (const std::uint32_t id : ids_) boxes_.push_back(get(id));
        live_ = used_ = count;
        choose_axis();
        keys_.resize(count);
        for (std::uint32_t k = 0; k < count; ++k) keys_[k] = key_of(boxes_[k], k);
        scratch_.resize(count);
        if (radix_sort(keys_.begin(), scratch_.begin(), count, 32, 64) != keys_.begin()) keys_.swap(scratch_);
        // Behind the last one, room for some that come.
        const std::uint32_t blocks = count == 0 ? 0 : (count + count / 16 + 32) / 8;
        keys_.resize(blocks * 8, ~std::uint64_t{0});
        block empty;
        for (std::uint32_t lane = 0; lane < 8; ++lane) empty.clear(lane);
        blocks_.clear();
        blocks_.resize(blocks, empty);
        for (std::uint32_t slot = 0; slot < count; ++slot) {
            const auto k = static_cast<std::uint32_t>(keys_[slot]);
            keys_[slot] = keys_[slot] >> 32 << 32 | ids_[k];
            blocks_[slot / 8].set(slot % 8, boxes_[k]);
            at(ids_[k], slot);
        }
        starts_.clear();
        reaches_.clear();
        for (std::uint32_t n = blocks_.size(); n > 0; n = n > 1 ? (n + 7) / 8 : 0) {
            starts_.push_back(reaches_.size());
            // Whole eights, the last ones reaching nowhere.
            reaches_.resize(reaches_.size() + (n + 7) / 8 * 8, -std::numeric_limits<float>::infinity());
        }
        for (std::uint32_t b = 0; b < blocks_.size(); ++b) lift(b);
        finish_order();
    }
    /// Whether there is room for one more without sorting everything.
    [[nodiscard]] bool has_room() const { return used_ < size(); }
    /// Puts a proxy that has come where it belongs; the rest is as with move().
    template <class At>
    std::uint32_t insert(std::uint32_t id, const box& to, std::uint32_t maximum, At&& at) {
        keys_[used_] = keys_[used_] >> 32 << 32 | id;
        ++live_;
        const std::uint32_t slot = used_;
        used_ = slot + 1;
        return move(slot, to, maximum, at);
    }
    /// Puts a proxy with another box where it belongs, and tells where the others are now. Returns past how many it
    /// went, or stops after `maximum`; then the order is to be sorted.
    template <class At>
    std::uint32_t move(std::uint32_t slot, const box& to, std::uint32_t maximum, At&& at) {
        const std::uint64_t key = key_of(to, id(slot));
        const std::uint32_t from = slot, front = static_cast<std::uint32_t>(key >> 32);
        const auto shift = [&](std::uint32_t other) {
            keys_[slot] = keys_[other];
            blocks_[slot / 8].set(slot % 8, blocks_[other / 8].get(other % 8));
            if (id(slot) != no_proxy) at(id(slot), slot);
            slot = other;
            return --maximum > 0;
        };
        bool on = maximum > 0;
        while (on && slot > 0 && keys_[slot - 1] >> 32 > front) on = shift(slot - 1);
        while (on && slot + 1 < size() && keys_[slot + 1] >> 32 < front) on = shift(slot + 1);
        keys_[slot] = key;
        blocks_[slot / 8].set(slot % 8, to);
        at(id(slot), slot);
        const std::uint32_t first = slot < from ? slot : from, last = slot < from ? from : slot;
        for (std::uint32_t b = first / 8; b <= last / 8; ++b) lift(b);
        return last - first;
    }

    /// To be called after moves, before searches.
    void finish_order() {
        float reach = -std::numeric_limits<float>::infinity();
        before_.resize(blocks_.size());
        for (std::uint32_t b = 0; b < blocks_.size(); ++b) before_[b] = reach = max(reach, reaches_[b]);
    }

    /// How many blocks begin no later than there; best found from a number nearby.
    [[nodiscard]] std::uint32_t begun(float end, std::uint32_t guess) const {
        std::uint32_t low = 0, high = blocks_.size();
        for (std::uint32_t step = 2; guess > low && guess < high; step *= 4) {
            if (begins(guess) > end) {
                high = guess;
                guess -= step < guess ? step : guess;
            } else {
                low = guess + 1;
                guess += step;
            }
        }
        while (low < high) {
            const std::uint32_t middle = low + (high - low) / 2;
            if (begins(middle) > end) high = middle;
            else low = middle + 1;
        }
        return low;
    }
    /// Calls visit(b) for blocks with boxes that reach as far as this one, from the one before `last` downwards, until
    /// it returns false.
    template <class Visit>
    void search(const box& near, std::uint32_t last, Visit&& visit) const {
        const float from = near.lower[axis_];
        for (std::uint32_t b = last; b > 0 && !(before_[b - 1] < from);) {
            // Past long ones far away by leaps.
            int level = std::countr_zero(b) / 3;
            level = level < levels() ? level : levels() - 1;
            while (level >= 0 && !(reaches_[starts_[static_cast<std::uint32_t>(level)] + (b >> 3 * level) - 1] < from))
                --level;
            if (level >= 0) b -= 1u << 3 * level;
            else if (!visit(--b)) return;
        }
    }
    /// Calls visit(b, lanes) for boxes behind a slot that meet its box.
    template <class Visit>
    void sweep(std::uint32_t slot, const box& own, Visit&& visit) const {
        using lanes = typename block::lanes;
        const std::uint32_t blocks = blocks_.size();
        const float end = own.upper[axis_];
        // Along the axis only those of the last block can be apart.
        const int u = (axis_ + 1) % D, v = (axis_ + 2) % D;
        const lanes u_lower = lanes::broadcast(own.lower[u]), u_upper = lanes::broadcast(own.upper[u]);
        const lanes v_lower = lanes::broadcast(own.lower[v]), v_upper = lanes::broadcast(own.upper[v]);
        std::uint32_t mask = 0xfeu << slot % 8 & 0xffu;
        for (std::uint32_t b = slot / 8; b < blocks; ++b, mask = 0xffu) {
            const block& other = blocks_[b];
            if (other.lower[axis_][0] > end) return;
            auto apart = greater(lanes::load(other.lower[u]), u_upper) | greater(u_lower, lanes::load(other.upper[u]));
            if constexpr (D == 3)
                apart = apart | greater(lanes::load(other.lower[v]), v_upper) |
                        greater(v_lower, lanes::load(other.upper[v]));
            const std::uint32_t near = ~apart.bits() & mask;
            if (near != 0) visit(b, near & other.overlapping(own));
        }
    }

    PHYSICS_HPP_MEMBERS(keys_, blocks_, reaches_, before_, starts_, live_, used_, axis_, usual_size_, width_, middle_,
                        scratch_, ids_, boxes_)

private:
    [[nodiscard]] int levels() const { return static_cast<int>(starts_.size()); }
    [[nodiscard]] float begins(std::uint32_t b) const { return blocks_[b].lower[axis_][0]; }
    std::uint64_t key_of(const box& b, std::uint64_t id) const {
        return std::uint64_t{to_ordered(b.lower[axis_])} << 32 | id;
    }
    /// An empty lane that still says where it is.
    void clear(std::uint32_t slot) {
        block& b = blocks_[slot / 8];
        const float at = b.lower[axis_][slot % 8];
        b.clear(slot % 8);
        b.lower[axis_][slot % 8] = at;
    }
    /// Brings up to date how far blocks reach above this one.
    void lift(std::uint32_t b) {
        float reach = blocks_[b].upper[axis_][0];
        for (int lane = 1; lane < 8; ++lane) reach = max(reach, blocks_[b].upper[axis_][lane]);
        for (std::uint32_t level = 0; level < starts_.size(); ++level, b /= 8) {
            float* all = &reaches_[starts_[level]];
            if (all[b] == reach) return;
            all[b] = reach;
            all += b / 8 * 8;
            for (int i = 0; i < 8; ++i) reach = max(reach, all[i]);
        }
    }
    /// The axis along which the middle half of the boxes is spread widest, unless the present one is about as good.
    void choose_axis() {
        const std::uint32_t stride = boxes_.size() / float_sample::capacity + 1;
        float best = 0;
        int best_axis = axis_;
        float_sample sizes;
        for (std::uint32_t k = 0; k < boxes_.size(); k += stride)
            sizes.add(boxes_[k].upper[axis_] - boxes_[k].lower[axis_]);
        if (sizes.size() == 0) return;
        sizes.sort();
        usual_size_ = max(sizes.at(0.5f), 1e-10f);
        for (int i = 0; i < D; ++i) {
            const int axis = (axis_ + i) % D;
            float_sample sample;
            for (std::uint32_t k = 0; k < boxes_.size(); k += stride) sample.add(boxes_[k].lower[axis]);
            sample.sort();
            const float wide = sample.at(0.75f) - sample.at(0.25f);
            middle_[axis] = sample.at(0.5f);
            width_ = i == 0 || wide > width_ ? wide : width_;
            if (i == 0 || wide > best) {
                best = i == 0 ? wide * 1.25f : wide;
                best_axis = axis;
            }
        }
        axis_ = best_axis;
    }

    /// Where boxes begin, as integers that sort alike, above their proxies.
    buffer<std::uint64_t> keys_;
    buffer<block> blocks_;
    /// How far blocks reach, level by level.
    buffer<float> reaches_;
    /// How far any block up to this one reaches.
    buffer<float> before_;
    buffer<std::uint32_t> starts_;
    /// How many there are, and how many lanes before those that were never used.
    reset_on_move<std::uint32_t> live_, used_;
    int axis_ = 0;
    float usual_size_ = 1, width_ = 0, middle_[D]{};
    // Scratch, while everything is sorted.
    step_scratch<buffer<std::uint64_t>> scratch_;
    step_scratch<buffer<std::uint32_t>> ids_;
    step_scratch<buffer<box>> boxes_;
};

}  // namespace detail

PHYSICS_HPP_END
