// The pairs of a broadphase from search to search: which go on, which begin, which end.
#pragma once

#include "physics/base/sort.hpp"
#include "physics/broadphase/concept.hpp"
#include "physics/broadphase/proxies.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Pairs in ascending order. What a search finds is sorted and merged with what was there before: no hashing, and the
/// order depends on the numbers alone.
class pair_set {
public:
    [[nodiscard]] const buffer<proxy_pair>& pairs() const { return pairs_; }
    [[nodiscard]] const buffer<proxy_pair>& begun() const { return begun_; }
    [[nodiscard]] const buffer<proxy_pair>& ended() const { return ended_; }

    /// Before a search among numbers below `size`.
    void start(std::uint32_t size) {
        bits_ = static_cast<int>(std::bit_width(size));
        found_.clear();
    }
    void add(std::uint32_t a, std::uint32_t b) {
        found_.push(a < b ? std::uint64_t{a} << bits_ | b : std::uint64_t{b} << bits_ | a);
    }
    /// After a search that found the pairs of all proxies, or of those that are stale.
    template <class Table>
    void finish(const Table& all, bool everything) {
        begun_.clear();
        ended_.clear();
        if (found_.empty() && all.changed().empty()) return;
        spare_.resize(found_.size());
        const std::uint64_t* now = radix_sort(found_.begin(), spare_.begin(), found_.size(), 0, 2 * bits_);
        const std::uint64_t* const end = now + found_.size();
        next_.clear();
        next_.reserve(pairs_.size() + found_.size());
        const auto begin_pair = [&](std::uint64_t key) {
            const proxy_pair p{static_cast<std::uint32_t>(key >> bits_),
                               static_cast<std::uint32_t>(key & ((std::uint64_t{1} << bits_) - 1))};
            begun_.push(p);
            next_.push(p);
        };
        for (const proxy_pair& p : pairs_) {
            const std::uint64_t key = std::uint64_t{p.a} << bits_ | p.b;
            while (now < end && *now < key) begin_pair(*now++);
            if (now < end && *now == key) {
                ++now;
                next_.push(p);
                if (!all.given_up(p.a) && !all.given_up(p.b)) continue;
                // Other proxies that bear the same numbers.
                ended_.push(p);
                begun_.push(p);
            } else if (everything || all.stale(p.a) || all.stale(p.b)) {
                ended_.push(p);
            } else {
                next_.push(p);
            }
        }
        while (now < end) begin_pair(*now++);
        pairs_.swap(next_);
    }

    template <class Self, class F>
    static void each_part(Self& self, F&& f) {
        f(self.pairs_);
        f(self.begun_);
        f(self.ended_);
    }

private:
    buffer<proxy_pair> pairs_, begun_, ended_;
    // Scratch of a search.
    buffer<proxy_pair> next_;
    buffer<std::uint64_t> found_, spare_;
    int bits_ = 0;
};

}  // namespace detail

PHYSICS_HPP_END
