// What a narrowphase remembers of pairs from step to step, packed: of most pairs it is little.
#pragma once

#include <cstring>

#include "physics/base/arena.hpp"
#include "physics/base/task_runner.hpp"
#include "physics/broadphase/concept.hpp"
#include "physics/collide/pair_memory.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Memories of pairs, in ascending order of the pairs. Those of which there is nothing to keep are left out.
template <class Plan>
class pair_cache {
    using memory = typename Plan::pair_memory;
    using kept = kept_memory<memory>;
    using unit = std::uint32_t;

public:
    [[nodiscard]] std::uint32_t size() const { return pairs_.size(); }
    [[nodiscard]] proxy_pair pair(std::uint32_t i) const { return pairs_[i]; }
    /// The first one that is not of an earlier pair.
    [[nodiscard]] std::uint32_t find(proxy_pair pair) const {
        return count_before(pairs_, [&](proxy_pair p) { return p < pair; });
    }
    /// Writes an empty one.
    static void clear(memory& m) { kept::clear(m); }
    void read(std::uint32_t i, memory& m) const {
        clear(m);
        const std::uint32_t contents = contents_at(places_[i]);
        if (!is_brief(places_[i])) {
            const unit* from = units_.begin() + places_[i] + 1;
            kept::each_piece(m, contents, [&](void* to, std::size_t bytes) {
                std::memcpy(to, from, bytes);
                from += units_for(bytes);
            });
        }
        kept::complete(m, contents);
    }
    [[nodiscard]] memory operator[](std::uint32_t i) const {
        memory m{};
        read(i, m);
        return m;
    }
    /// Whether what was read from here has not changed: it says so, or all that there is to keep is a number.
    [[nodiscard]] bool is_unchanged(std::uint32_t i, const memory& m) const {
        return !kept::has_changed(m) || (is_brief(places_[i]) && contents_at(places_[i]) == kept::contents(m));
    }

    void clear() {
        pairs_.clear();
        places_.clear();
        units_.clear();
        free_ = {};
    }
    /// Adds a memory after the others, unless there is nothing to keep of it.
    void add(proxy_pair pair, memory& m) {
        const std::uint32_t contents = kept::contents(m);
        if (contents == 0) return;
        const std::uint32_t place = make_room(contents);
        pairs_.push_back(pair);
        places_.push_back(place);
        if (is_brief(place)) return;
        kept::tidy(m);
        unit* to = units_.begin() + place;
        *to++ = contents;
        kept::each_piece(m, contents, [&](const void* from, std::size_t bytes) {
            const std::size_t count = units_for(bytes);
            // What is behind the last byte.
            to[count - 1] = 0;
            std::memcpy(to, from, bytes);
            to += count;
        });
    }
    /// Forgets the pairs that have a shape for which gone(shape) is true.
    template <class Gone>
    void drop(Gone&& gone) {
        std::uint32_t left = 0;
        for (std::uint32_t i = 0; i < size(); ++i) {
            if (gone(pairs_[i].a) || gone(pairs_[i].b)) free_place(places_[i]);
            else move(i, left++);
        }
        truncate(left);
        clear_if_empty();
    }

    /// Lists of what is new, which follow on each other: the parts of some longer ones from `first` to `end`.
    struct segment {
        pair_cache* of;
        std::uint32_t first, end;
    };
    /// Forgets those that are not kept and takes in what is new. No pair is in both, and in its own place.
    void change(const bool* is_kept, const segment* segments, std::uint32_t count) {
        std::uint32_t i = 0, left = 0, added = 0;
        const auto pass = [&] {
            if (is_kept[i]) move(i, left++);
            else free_place(places_[i]);
            ++i;
        };
        for (std::uint32_t k = 0; k < count; ++k)
            for (std::uint32_t n = segments[k].first; n < segments[k].end; ++n) {
                pair_cache& of = *segments[k].of;
                const proxy_pair pair = of.pairs_[n];
                while (i < size() && pairs_[i] < pair) pass();
                const bool known = i < size() && pairs_[i] == pair;
                const std::uint32_t contents = of.contents_at(of.places_[n]);
                const bool fits = known && units_of(contents) == units_of(contents_at(places_[i]));
                if (known && !fits) free_place(places_[i]);
                const std::uint32_t place = fits && !is_brief(places_[i]) ? places_[i] : make_room(contents);
                if (!is_brief(place))
                    std::memcpy(units_.begin() + place, of.units_.begin() + of.places_[n],
                                units_of(contents) * sizeof(unit));
                if (known) {
                    places_[i] = place;
                    move(i++, left++);
                    // No shape meets itself: this one is in its place.
                    of.pairs_[n].b = pair.a;
                } else {
                    of.places_[n] = place;
                    ++added;
                }
            }
        while (i < size()) pass();
        truncate(left);
        if (added > 0) insert(segments, count, added);
        clear_if_empty();
    }
    /// The size of what is kept of all, in units.
    [[nodiscard]] std::uint32_t units() const { return units_.size(); }
    /// Takes the memory for so many more, of so many units.
    void reserve_more(std::uint32_t pairs, std::uint32_t units) {
        pairs_.reserve(pairs_.size() + pairs);
        places_.reserve(places_.size() + pairs);
        units_.reserve(units_.size() + units);
    }
    /// Exchanges the memory of each of the buffers with that of another which is empty too, if it has more.
    void swap_larger(pair_cache& other) {
        const auto swap_larger_one = [](auto& mine, auto& theirs) {
            if (mine.capacity() < theirs.capacity()) mine.swap(theirs);
        };
        swap_larger_one(pairs_, other.pairs_);
        swap_larger_one(places_, other.places_);
        swap_larger_one(units_, other.units_);
    }
    void swap(pair_cache& other) noexcept {
        pairs_.swap(other.pairs_);
        places_.swap(other.places_);
        units_.swap(other.units_);
        std::swap(free_, other.free_);
    }

    PHYSICS_HPP_MEMBERS(pairs_, places_, units_, free_)

private:
    static constexpr std::size_t units_for(std::size_t bytes) { return (bytes + sizeof(unit) - 1) / sizeof(unit); }
    /// So much does a memory of these contents need.
    static std::uint32_t units_of(std::uint32_t contents) {
        std::size_t count = 1;
        const memory m{};
        kept::each_piece(m, contents, [&](const void*, std::size_t bytes) { count += units_for(bytes); });
        return static_cast<std::uint32_t>(count);
    }
    /// No piece is smaller than a unit, and none is twice as large as what it holds.
    static constexpr std::size_t max_units = 1 + 2 * units_for(sizeof(memory));
    /// Free lists by size: the first free place of each size plus 1; a free place holds the next one.
    struct free_places {
        std::uint32_t first[max_units + 1];
    };
    /// Marks the place of contents which are all that there is to keep.
    static constexpr std::uint32_t brief = 0x80000000u;
    static bool is_brief(std::uint32_t place) { return (place & brief) != 0; }
    [[nodiscard]] std::uint32_t contents_at(std::uint32_t place) const {
        return is_brief(place) ? place & ~brief : units_[place];
    }

    std::uint32_t make_room(std::uint32_t contents) {
        const std::uint32_t count = units_of(contents);
        if (count == 1 && !is_brief(contents)) return brief | contents;
        std::uint32_t& head = free_.first[count];
        if (head != 0) {
            const std::uint32_t place = head - 1;
            head = units_[place];
            return place;
        }
        const std::uint32_t place = units_.size();
        if (is_brief(place + count)) {
            refuse("step", "pairs", static_cast<double>(size()), "there are more than can be remembered");
            std::abort();
        }
        units_.extend(count);
        return place;
    }
    void free_place(std::uint32_t place) {
        if (is_brief(place)) return;
        std::uint32_t& head = free_.first[units_of(units_[place])];
        units_[place] = head;
        head = place + 1;
    }
    void move(std::uint32_t from, std::uint32_t to) {
        if (from == to) return;
        pairs_[to] = pairs_[from];
        places_[to] = places_[from];
    }
    void truncate(std::uint32_t count) {
        pairs_.resize(count);
        places_.resize(count);
    }
    void clear_if_empty() {
        if (size() == 0) clear();
    }
    /// Puts new ones into the order, from behind.
    void insert(const segment* segments, std::uint32_t count, std::uint32_t added) {
        std::uint32_t left = size(), to = left + added;
        pairs_.extend(added);
        places_.extend(added);
        for (std::uint32_t k = count; k-- > 0;)
            for (std::uint32_t n = segments[k].end; n-- > segments[k].first;) {
                const pair_cache& of = *segments[k].of;
                const proxy_pair pair = of.pairs_[n];
                if (pair.a == pair.b) continue;
                while (left > 0 && pair < pairs_[left - 1]) move(--left, --to);
                pairs_[--to] = pair;
                places_[to] = of.places_[n];
            }
    }

    buffer<proxy_pair> pairs_;
    /// Where the contents of each begin, or these themselves.
    buffer<std::uint32_t> places_;
    /// Empty where there are no pairs.
    buffer<unit> units_;
    free_places free_ = {};
};

/// What a step makes of the memories, until it has succeeded.
template <class Plan>
struct pair_cache_changes {
    using memories = pair_cache<Plan>;

    /// What each worker has to add.
    per_worker<memories> by;
    /// For the step: which memories stay as they are, and the lists of those that are new, in the order of their pairs.
    bool* is_kept = nullptr;
    typename memories::segment* segments = nullptr;
    std::uint32_t count = 0;
    /// Whether all of them are one list.
    bool is_one = false;

    void start(memories& before, std::uint32_t maximum, const task_runner& tasks, arena& scratch) {
        for (std::uint32_t k = 0; k < tasks.workers(); ++k) by[k].clear();
        is_one = tasks.is_serial();
        // It goes over as a whole, and comes back where the same begins anew.
        if (is_one && before.size() == 0) by[0].swap_larger(before);
        is_kept = scratch.allocate<bool>(before.size());
        for (std::uint32_t i = 0; i < before.size(); ++i) is_kept[i] = false;
        segments = scratch.allocate<typename memories::segment>(maximum);
        count = maximum;
    }
    template <class Recalled>
    void add(const Recalled& pairs, const memories& before, std::uint32_t segment, std::uint32_t worker) {
        memories& to = by[worker];
        const std::uint32_t first = to.size();
        pairs.save_to_cache(before, is_kept, to);
        segments[segment] = {&to, first, to.size()};
    }
    /// Takes the memory for that.
    void reserve(memories& of, std::uint32_t workers) {
        if (is_one && of.size() == 0) return;
        for (std::uint32_t k = 0, pairs = 0, units = 0; k < workers; ++k) {
            pairs += by[k].size();
            units += by[k].units();
            of.reserve_more(pairs, units);
        }
    }
    void finish(memories& of) {
        if (is_one && of.size() == 0) of.swap(by[0]);
        else of.change(is_kept, segments, count);
    }
};

}  // namespace detail

PHYSICS_HPP_END
