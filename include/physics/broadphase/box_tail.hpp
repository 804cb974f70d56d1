// Boxes in no order, searched eight at a time: where those wait that have just come.
#pragma once

#include "physics/base/buffer.hpp"
#include "physics/broadphase/box_block.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Boxes of proxies in the order in which they came, in eights, and the boxes around eights of these: what came one
/// after the other is often near each other. To add, to change and to remove one takes O(1).
template <int D>
class box_tail {
public:
    using block = box_block<D>;
    using box = float_box<D>;

    [[nodiscard]] std::uint32_t size() const { return ids_.size(); }
    [[nodiscard]] bool empty() const { return ids_.empty(); }
    [[nodiscard]] std::uint32_t id(std::uint32_t i) const { return ids_[i]; }
    [[nodiscard]] const std::uint32_t* begin() const { return ids_.begin(); }
    [[nodiscard]] const std::uint32_t* end() const { return ids_.end(); }
    void clear() {
        ids_.clear();
        leaves_.clear();
        above_.clear();
    }
    void reserve(std::uint32_t count) {
        ids_.reserve(count);
        leaves_.reserve((count + 7) / 8);
        above_.reserve((count + 63) / 64);
    }
    PHYSICS_HPP_NOINLINE void push_back(std::uint32_t id, const box& b) {
        const std::uint32_t i = ids_.size();
        reserve(i + 1);
        if (i % 64 == 0) add_empty(above_);
        if (i % 8 == 0) add_empty(leaves_);
        ids_.push_back(id);
        set(i, b);
    }
    void set(std::uint32_t i, const box& b) {
        leaves_[i / 8].set(i % 8, b);
        box around = above_[i / 64].get(i / 8 % 8);
        for (int k = 0; k < D; ++k) {
            around.lower[k] = b.lower[k] < around.lower[k] ? b.lower[k] : around.lower[k];
            around.upper[k] = b.upper[k] > around.upper[k] ? b.upper[k] : around.upper[k];
        }
        above_[i / 64].set(i / 8 % 8, around);
    }
    /// The last one takes its place; the boxes around it stay as large as they were, until they are empty.
    void remove(std::uint32_t i) {
        const std::uint32_t last = ids_.size() - 1;
        if (i != last) {
            ids_[i] = ids_[last];
            set(i, leaves_[last / 8].get(last % 8));
        }
        ids_.pop_back();
        leaves_[last / 8].clear(last % 8);
        if (last % 8 != 0) return;
        leaves_.pop_back();
        above_[last / 64].clear(last / 8 % 8);
        if (last % 64 == 0) above_.pop_back();
    }

    /// Calls visit(leaf, lanes) for each eight that has boxes within reach of the test, as packed_tree::search does.
    template <class Test, class Visit>
    void search(Test&& test, Visit&& visit) const {
        for (std::uint32_t g = 0; g < above_.size(); ++g)
            each_bit(test(above_[g]), [&](std::uint32_t lane) {
                const std::uint32_t leaf = 8 * g + lane, lanes = test(leaves_[leaf]);
                if (lanes != 0) visit(leaf, lanes);
            });
    }
    /// Calls visit(i) for boxes within reach, as packed_tree::search_in_order does, in no order.
    template <class Test, class Outside, class Visit>
    void search_all(Test&& test, Outside&& outside, Visit&& visit) const {
        for (std::uint32_t g = 0; g < above_.size(); ++g) {
            float keys[8];
            each_bit(test(above_[g], keys), [&](std::uint32_t lane) {
                if (outside(keys[lane])) return;
                const std::uint32_t leaf = 8 * g + lane;
                float inner[8];
                each_bit(test(leaves_[leaf], inner), [&](std::uint32_t k) {
                    if (!outside(inner[k])) visit(leaf * 8 + k);
                });
            });
        }
    }

    PHYSICS_HPP_MEMBERS(ids_, leaves_, above_)

private:
    static void add_empty(buffer<block>& blocks) {
        block empty;
        for (std::uint32_t lane = 0; lane < 8; ++lane) empty.clear(lane);
        blocks.push_back(empty);
    }

    buffer<std::uint32_t> ids_;
    buffer<block> leaves_, above_;
};

}  // namespace detail

PHYSICS_HPP_END
