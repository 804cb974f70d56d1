// The pairs of a broadphase from search to search: which go on, which begin, which end.
#pragma once

#include "physics/base/arena.hpp"
#include "physics/base/sort.hpp"
#include "physics/broadphase/concept.hpp"
#include "physics/broadphase/proxies.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Pairs that a search finds, as numbers that sort as they do, in memory of the step.
class pair_search {
public:
    /// Among proxies of numbers below `size`.
    pair_search(std::uint32_t size, arena& scratch)
        : bits_(static_cast<int>(std::bit_width(size))), scratch_(scratch), start_(scratch.here()) {}
    pair_search(const pair_search&) = delete;
    pair_search& operator=(const pair_search&) = delete;
    ~pair_search() { scratch_.rewind(start_); }

    void add(std::uint32_t a, std::uint32_t b) {
        if (count_ == capacity_) grow();
        found_[count_++] = a < b ? key({a, b}) : key({b, a});
    }
    [[nodiscard]] std::uint32_t size() const { return count_; }
    [[nodiscard]] std::uint64_t key(proxy_pair p) const { return std::uint64_t{p.a} << bits_ | p.b; }
    [[nodiscard]] proxy_pair pair(std::uint64_t key) const {
        return {static_cast<std::uint32_t>(key >> bits_),
                static_cast<std::uint32_t>(key & ((std::uint64_t{1} << bits_) - 1))};
    }
    /// Their keys in order.
    const std::uint64_t* sorted() {
        return radix_sort(found_, scratch_.allocate<std::uint64_t>(count_), count_, 0, 2 * bits_);
    }

private:
    PHYSICS_HPP_COLD void grow() {
        capacity_ = capacity_ < 128 ? 256 : capacity_ * 2;
        auto* const larger = scratch_.allocate<std::uint64_t>(capacity_);
        if (count_ > 0) std::memcpy(larger, found_, count_ * sizeof *found_);
        found_ = larger;
    }

    int bits_;
    arena& scratch_;
    arena::mark start_;
    std::uint64_t* found_ = nullptr;
    std::uint32_t count_ = 0, capacity_ = 0;
};

/// Pairs in ascending order. What a search finds is sorted and merged with what was there before: no hashing, and the
/// order depends on the numbers alone.
class pair_set {
public:
    [[nodiscard]] const buffer<proxy_pair>& pairs() const { return pairs_; }
    [[nodiscard]] const buffer<proxy_pair>& begun() const { return begun_; }
    [[nodiscard]] const buffer<proxy_pair>& ended() const { return ended_; }

    /// After a search that found the pairs of all proxies, or of those that are stale.
    template <class Table>
    void finish(pair_search& found, const Table& all, bool everything) {
        begun_.clear();
        ended_.clear();
        if (found.size() == 0 && all.changed().empty()) return;
        // All memory first, so that pairs are not left half changed.
        begun_.reserve(found.size());
        ended_.reserve(pairs_.size());
        pairs_.reserve(pairs_.size() + found.size());
        const std::uint64_t* now = found.sorted();
        const std::uint64_t* const end = now + found.size();
        std::uint32_t left = 0, added = 0;
        const auto begin_pair = [&](std::uint64_t key) {
            begun_.push_back(found.pair(key));
            ++added;
        };
        for (const proxy_pair p : pairs_) {
            const std::uint64_t key = found.key(p);
            while (now < end && *now < key) begin_pair(*now++);
            if (now < end && *now == key) {
                ++now;
                pairs_[left++] = p;
                if (!all.slot_reused(p.a) && !all.slot_reused(p.b)) continue;
                // Other proxies that bear the same numbers.
                ended_.push_back(p);
                begun_.push_back(p);
            } else if (everything || all.stale(p.a) || all.stale(p.b)) {
                ended_.push_back(p);
            } else {
                pairs_[left++] = p;
            }
        }
        while (now < end) begin_pair(*now++);
        pairs_.resize(left);
        insert_begun(added);
    }

    PHYSICS_HPP_MEMBERS(pairs_, begun_, ended_)

private:
    /// Puts so many of the pairs that begin among the others, from behind; the rest of them is there.
    void insert_begun(std::uint32_t added) {
        std::uint32_t from = pairs_.size(), to = from + added;
        pairs_.extend(added);
        for (std::uint32_t n = begun_.size(); to > from; --n) {
            const proxy_pair p = begun_[n - 1];
            while (from > 0 && p < pairs_[from - 1]) pairs_[--to] = pairs_[--from];
            if (!(from > 0 && pairs_[from - 1] == p)) pairs_[--to] = p;
        }
    }

    buffer<proxy_pair> pairs_, begun_, ended_;
};

}  // namespace detail

PHYSICS_HPP_END
