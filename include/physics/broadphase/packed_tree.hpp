// A tree of boxes without pointers: eight children a node, every level full but its last node.
#pragma once

#include "physics/base/buffer.hpp"
#include "physics/broadphase/arrange.hpp"
#include "physics/broadphase/proxies.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Boxes in eights, eights of these in eights, and so on, in the order in which they were built: neighbours in the
/// order should be neighbours in space. Node n of a level holds the boxes of the nodes 8 n to 8 n + 7 below; the
/// lowest level, 0, holds the boxes of proxies, slot by slot. Boxes may change where they are: `mark` them, and
/// `refit` brings the levels above up to date.
template <int D>
class packed_tree {
public:
    using block = box_block<D>;
    using box = float_box<D>;
    static constexpr int max_levels = 11;

    /// Takes the memory to be built of so many: false where there is none, and it is not needed.
    [[nodiscard]] bool try_reserve(std::uint32_t count, bool must) {
        const std::uint32_t leaves = (count + 7) / 8;
        std::uint32_t total = leaves;
        for (std::uint32_t n = leaves; n > 1; total += n) n = (n + 7) / 8;
        return ids_.try_reserve(leaves * 8, must) && filters_.try_reserve(leaves * 8, must) &&
               marks_.try_reserve(leaves, must) && nodes_.try_reserve(total, must);
    }
    /// Holds the proxies of these items, in their order; box_at(i) gives the box of item i, filter_of(id) a filter.
    template <class Box, class Filter>
    void build(const packed_item* items, std::uint32_t count, Box&& box_at, Filter&& filter_of) {
        clear();
        const std::uint32_t leaves = (count + 7) / 8;
        ids_.resize(leaves * 8, no_proxy);
        marks_.resize(leaves, 0);
        live_ = count;
        if (leaves == 0) return;
        std::uint32_t total = 0;
        for (std::uint32_t n = leaves;; n = (n + 7) / 8) {
            starts_[levels_] = total;
            ++levels_;
            total += n;
            if (n == 1) break;
        }
        filters_.resize(leaves * 8);
        block empty;
        for (std::uint32_t i = 0; i < 8; ++i) empty.clear(i);
        nodes_.resize(total, empty);
        for (std::uint32_t i = 0; i < count; ++i) {
            nodes_[i / 8].set(i % 8, box_at(i));
            ids_[i] = items[i].id;
            filters_[i] = filter_of(items[i].id);
        }
        for (int level = 1; level < levels_; ++level)
            for (std::uint32_t n = 0; n < nodes_at(level - 1); ++n) lift(level - 1, n);
    }
    void clear() {
        nodes_.clear();
        ids_.clear();
        filters_.clear();
        marks_.clear();
        levels_ = 0;
        live_ = 0;
        marked_ = 0;
    }

    /// The box around everything; of an empty tree none.
    [[nodiscard]] box around() const { return nodes_.back().all(); }
    [[nodiscard]] std::uint32_t live() const { return live_; }
    [[nodiscard]] std::uint32_t leaves() const { return marks_.size(); }
    [[nodiscard]] std::uint32_t nodes_at(int level) const {
        return (level + 1 < levels_ ? starts_[level + 1] : nodes_.size()) - starts_[level];
    }
    [[nodiscard]] const block& node(int level, std::uint32_t n) const { return nodes_[starts_[level] + n]; }
    [[nodiscard]] const block& leaf(std::uint32_t n) const { return nodes_[n]; }
    /// The box around a leaf.
    [[nodiscard]] box around(std::uint32_t leaf) const {
        return levels_ > 1 ? node(1, leaf / 8).get(leaf % 8) : nodes_[leaf].all();
    }
    /// The box around some of a leaf's boxes.
    [[nodiscard]] box around(std::uint32_t leaf, std::uint32_t lanes) const {
        box all;
        for (int i = 0; i < D; ++i) {
            all.lower[i] = std::numeric_limits<float>::infinity();
            all.upper[i] = -all.lower[i];
        }
        each_bit(lanes, [&](std::uint32_t lane) {
            for (int i = 0; i < D; ++i) {
                const float l = nodes_[leaf].lower[i][lane], u = nodes_[leaf].upper[i][lane];
                all.lower[i] = l < all.lower[i] ? l : all.lower[i];
                all.upper[i] = u > all.upper[i] ? u : all.upper[i];
            }
        });
        return all;
    }
    [[nodiscard]] std::uint32_t id(std::uint32_t slot) const { return ids_[slot]; }
    [[nodiscard]] const proxy_filter& filter(std::uint32_t slot) const { return filters_[slot]; }
    [[nodiscard]] bool all_marked() const { return marked_ == live_; }
    /// The slots of a leaf that have been marked.
    [[nodiscard]] std::uint32_t marked(std::uint32_t leaf) const { return marks_[leaf]; }

    void set(std::uint32_t slot, const box& b) { nodes_[slot / 8].set(slot % 8, b); }
    [[nodiscard]] bool any_marked() const { return marked_ > 0; }
    void mark(std::uint32_t slot) {
        const std::uint32_t bit = 1u << slot % 8;
        if (marks_[slot / 8] & bit) return;
        marks_[slot / 8] = static_cast<std::uint8_t>(marks_[slot / 8] | bit);
        ++marked_;
    }
    void clear_marks() {
        if (marked_ == 0) return;
        for (std::uint8_t& m : marks_) m = 0;
        marked_ = 0;
    }
    void remove(std::uint32_t slot) {
        const std::uint32_t bit = 1u << slot % 8;
        nodes_[slot / 8].clear(slot % 8);
        if (marks_[slot / 8] & bit) --marked_;
        marks_[slot / 8] = static_cast<std::uint8_t>(marks_[slot / 8] & ~bit);
        ids_[slot] = no_proxy;
        --live_;
    }
    /// Makes the boxes above these leaves, in ascending order, fit; uses the list up. Returns by how much they have
    /// grown.
    double refit(buffer<std::uint32_t>& touched) {
        double grown = 0;
        for (int level = 0; level + 1 < levels_; ++level) {
            std::uint32_t kept = 0;
            for (std::uint32_t i = 0; i < touched.size(); ++i) {
                const std::uint32_t n = touched[i];
                const box before = node(level + 1, n / 8).get(n % 8), after = node(level, n).all();
                grown += size_of(after) - size_of(before);
                nodes_[starts_[level + 1] + n / 8].set(n % 8, after);
                if (kept == 0 || touched[kept - 1] != n / 8) touched[kept++] = n / 8;
            }
            while (touched.size() > kept) touched.pop_back();
        }
        return grown;
    }
    /// The sides of the boxes around leaves and whatever is above, but for the top.
    [[nodiscard]] double size() const {
        double sum = 0;
        for (int level = 0; level + 1 < levels_; ++level)
            for (std::uint32_t n = 0; n < nodes_at(level); ++n) sum += size_of(node(level + 1, n / 8).get(n % 8));
        return sum;
    }

    /// Calls f(box) for the boxes around eights, and eights of these, and so on.
    template <class F>
    void each_node(F&& f) const {
        for (int level = 1; level < levels_; ++level)
            for (std::uint32_t n = 0; n < nodes_at(level - 1); ++n) f(node(level, n / 8).get(n % 8));
        if (levels_ > 0) f(around());
    }
    /// Calls visit(leaf, lanes) for each leaf from `first` on that has boxes within reach of the test: test(block)
    /// says which of eight boxes are, and must say so of a box around any that is.
    template <class Test, class Visit>
    void search(std::uint32_t first, Test&& test, Visit&& visit) const {
        if (levels_ == 0) return;
        struct {
            std::uint32_t node, lanes;
        } path[max_levels];
        int level = levels_ - 1;
        path[level] = {0, test(node(level, 0))};
        for (;;) {
            if (level == 0) {
                if (path[0].lanes != 0) visit(path[0].node, path[0].lanes);
                path[0].lanes = 0;
            }
            while (path[level].lanes == 0)
                if (++level == levels_) return;
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(path[level].lanes));
            path[level].lanes &= path[level].lanes - 1;
            const std::uint32_t child = path[level].node * 8 + lane;
            --level;
            // Ends before the first leaf: all of it was visited from there.
            if ((std::uint64_t{child} + 1) << 3 * level <= first) {
                ++level;
                continue;
            }
            path[level] = {child, test(node(level, child))};
        }
    }

    /// Calls visit(slot) for boxes, the ones with small keys early: test(block, keys) says which of eight boxes are
    /// within reach, and writes a key for each, no less than that of a box around it; what has come out of reach by
    /// then, by outside(key), is left out.
    template <class Test, class Outside, class Visit>
    void search_in_order(Test&& test, Outside&& outside, Visit&& visit) const {
        struct entry {
            float key;
            std::uint32_t node;
            int level;
        };
        if (levels_ == 0) return;
        entry stack[7 * max_levels];
        entry next{0, 0, levels_ - 1};
        int top = 0;
        for (;;) {
            float keys[8];
            std::uint32_t lanes = test(node(next.level, next.node), keys);
            if (next.level == 0) {
                each_bit(lanes, [&](std::uint32_t lane) {
                    if (!outside(keys[lane])) visit(next.node * 8 + lane);
                });
            } else if (lanes != 0) {
                // On into the first one, the others later.
                const auto child = [&](std::uint32_t lane) {
                    return entry{keys[lane], next.node * 8 + lane, next.level - 1};
                };
                auto nearest = static_cast<std::uint32_t>(std::countr_zero(lanes));
                each_bit(lanes & (lanes - 1), [&](std::uint32_t lane) {
                    const bool nearer = keys[lane] < keys[nearest];
                    stack[top] = child(nearer ? nearest : lane);
                    fetch(stack[top].level, stack[top].node);
                    ++top;
                    nearest = nearer ? lane : nearest;
                });
                next = child(nearest);
                continue;
            }
            do {
                if (top == 0) return;
                next = stack[--top];
            } while (outside(next.key));
        }
    }

    PHYSICS_HPP_MEMBERS(nodes_, ids_, filters_, marks_, starts_, levels_, live_, marked_)

private:
    void fetch(int level, std::uint32_t n) const {
        const char* from = reinterpret_cast<const char*>(&node(level, n));
        for (std::size_t line = 0; line < sizeof(block); line += 64) PHYSICS_HPP_PREFETCH(from + line);
    }
    static double size_of(const box& b) {
        double sum = 0;
        if (b.lower[0] > b.upper[0]) return sum;
        for (int i = 0; i < D; ++i) sum += static_cast<double>(b.upper[i]) - static_cast<double>(b.lower[i]);
        return sum;
    }
    /// Writes the box around a node into the level above.
    void lift(int level, std::uint32_t n) { nodes_[starts_[level + 1] + n / 8].set(n % 8, node(level, n).all()); }

    buffer<block> nodes_;
    buffer<std::uint32_t> ids_;
    /// Copies, so that pairs are filtered without a look at proxies far away in memory.
    buffer<proxy_filter> filters_;
    buffer<std::uint8_t> marks_;
    std::uint32_t starts_[max_levels]{};
    reset_on_move<int> levels_;
    reset_on_move<std::uint32_t> live_, marked_;
};

}  // namespace detail

PHYSICS_HPP_END
