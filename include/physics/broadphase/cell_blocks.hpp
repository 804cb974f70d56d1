// Boxes in cells, eight to a block.
#pragma once

#include "physics/base/buffer.hpp"
#include "physics/base/handle.hpp"
#include "physics/broadphase/box_block.hpp"
#include "physics/broadphase/proxies.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

inline constexpr std::uint32_t no_block = null_index;

/// Up to eight boxes of one cell. Lanes from 0 to count - 1 are in use, the others empty.
template <int D>
struct cell_block {
    box_block<D> boxes;
    std::uint64_t key;
    std::uint32_t ids[8];
    /// The next block of the same cell.
    std::uint32_t next;
    std::uint8_t count;
    std::uint8_t level;
    /// By lane: whether the proxy is movable, and whether it has moved (only while pairs are searched).
    std::uint8_t movable, moved;
};

/// Blocks in chains, one chain a cell. All blocks of a chain but its first are full, so that adding and removing cost
/// the same however many share a cell.
template <int D>
class cell_blocks {
public:
    using block = cell_block<D>;

    [[nodiscard]] std::uint32_t size() const { return blocks_.size(); }
    [[nodiscard]] const block& operator[](std::uint32_t b) const { return blocks_[b]; }
    block& operator[](std::uint32_t b) { return blocks_[b]; }

    void clear() {
        blocks_.clear();
        free_.clear();
    }
    /// Adds a box to the chain that begins at `head`; returns its slot, eight a block.
    std::uint32_t add(std::uint32_t& head, std::uint64_t key, std::uint32_t level, const float_box<D>& box,
                      std::uint32_t id, bool movable) {
        if (head == no_block || blocks_[head].count == 8) {
            const std::uint32_t fresh = allocate();
            blocks_[fresh].key = key;
            blocks_[fresh].level = static_cast<std::uint8_t>(level);
            blocks_[fresh].next = head;
            head = fresh;
        }
        block& b = blocks_[head];
        const std::uint32_t lane = b.count++;
        b.boxes.set(lane, box);
        b.ids[lane] = id;
        set_bit(b.movable, lane, movable);
        return head * 8 + lane;
    }
    /// Takes a box out of its chain. The last one of the first block goes to its place: no_proxy, or the proxy that
    /// is in `slot` now.
    std::uint32_t remove(std::uint32_t& head, std::uint32_t slot) {
        block &to = blocks_[slot / 8], &from = blocks_[head];
        const std::uint32_t hole = slot % 8, last = --from.count;
        std::uint32_t moved = no_proxy;
        if (head != slot / 8 || hole != last) {
            moved = to.ids[hole] = from.ids[last];
            to.boxes.set(hole, from.boxes.get(last));
            set_bit(to.movable, hole, from.movable >> last & 1);
        }
        from.boxes.clear(last);
        set_bit(from.movable, last, false);
        if (last == 0) {
            free_.push_back(head);
            head = from.next;
        }
        return moved;
    }

    PHYSICS_HPP_MEMBERS(blocks_, free_)

private:
    static void set_bit(std::uint8_t& bits, std::uint32_t bit, bool value) {
        bits = static_cast<std::uint8_t>((bits & ~(1u << bit)) | (value ? 1u << bit : 0u));
    }
    std::uint32_t allocate() {
        if (!free_.empty()) {
            const std::uint32_t b = free_.back();
            free_.pop_back();
            return b;
        }
        block empty{};
        for (std::uint32_t lane = 0; lane < 8; ++lane) empty.boxes.clear(lane);
        blocks_.push_back(empty);
        return blocks_.size() - 1;
    }

    buffer<block> blocks_;
    buffer<std::uint32_t> free_;
};

}  // namespace detail

PHYSICS_HPP_END
