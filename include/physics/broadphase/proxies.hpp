// The proxies of a broadphase: boxes, filters, and which have moved.
#pragma once

#include "physics/base/bit_array.hpp"
#include "physics/base/handle.hpp"
#include "physics/space/check.hpp"
#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

/// A mask of every category.
inline constexpr std::uint32_t all_categories = 0xffffffffu;

/// Which shapes meet: two of one group, unless that is 0, do if it is positive and do not if it is negative, whatever
/// their categories; else each one's category must be in the other's mask. Of several bits of a category one suffices.
struct collision_filter {
    std::uint32_t category = 1;
    std::uint32_t mask = all_categories;
    std::int32_t group = 0;

    friend bool operator==(const collision_filter&, const collision_filter&) = default;
};

/// Kinds of bodies, as bits: static_bodies | dynamic_bodies.
using body_kinds = std::uint32_t;
inline constexpr body_kinds static_bodies = 1, kinematic_bodies = 2, dynamic_bodies = 4, all_bodies = 7;

/// Which proxies can form a pair: those of which a collision_filter says so, if the owners differ and at least one is
/// movable, and not both are sensors.
struct proxy_filter {
    std::uint32_t category = 1;
    std::uint32_t mask = all_categories;
    std::int32_t group = 0;
    /// Proxies of one owner, say shapes of one body, never meet; none by default.
    std::uint32_t owner = detail::null_index;
    /// False for what nothing pushes: static and kinematic geometry. Such proxies never meet each other, and cost
    /// nothing while they rest.
    bool movable = true;
    /// Whether it only senses what it meets; queries leave it out unless they are to see it.
    bool sensor = false;
    /// What queries are told that it is.
    std::uint8_t kinds = all_bodies;

    friend bool operator==(const proxy_filter&, const proxy_filter&) = default;
};

/// True if the two may meet.
constexpr bool may_meet(const collision_filter& a, const collision_filter& b) {
    if (a.group == b.group && a.group != 0) return a.group > 0;
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}
constexpr bool may_meet(const proxy_filter& a, const proxy_filter& b) {
    return may_meet(collision_filter{a.category, a.mask, a.group}, collision_filter{b.category, b.mask, b.group}) &&
           (a.owner != b.owner || a.owner == detail::null_index) && (a.movable || b.movable) && !(a.sensor && b.sensor);
}

/// How much larger than their proxies boxes are kept, so that small moves leave them alone.
template <class S>
struct broadphase_settings {
    /// By how much on every side (m), at most a 16th of the scalar's range.
    S margin = S(0.05);
    /// How many times the last move ahead.
    S prediction = S(2);
};

template <class S>
bool check(const broadphase_settings<S>& with, const char* function) {
    if (!detail::check_not_negative(function, "broadphase.margin", with.margin) ||
        !detail::check_not_negative(function, "broadphase.prediction", with.prediction))
        return false;
    // Wider boxes would leave the range, or their sizes.
    return with.margin <= scalar_traits<S>::max() / S(16) ||
           detail::refuse(function, "broadphase.margin", static_cast<double>(with.margin),
                          "it must be at most a 16th of the scalar's range");
}

namespace detail {

/// What a query may look at: a proxy, with what an index has at hand of it.
template <class Space>
struct candidate {
    std::uint32_t id;
    proxy_filter filter;
    typename Space::aabb box;
};

/// No proxy has this number.
inline constexpr std::uint32_t no_proxy = null_index;

/// The proxies of a broadphase by number.
template <class Space>
class proxies {
public:
    using S = typename Space::scalar;
    using vec = typename Space::vec;
    using aabb = typename Space::aabb;
    static constexpr int D = Space::dimension;

    broadphase_settings<S> settings;

    [[nodiscard]] std::uint32_t size() const { return entries_.size(); }
    [[nodiscard]] std::uint32_t count() const { return count_; }
    [[nodiscard]] bool has(std::uint32_t id) const { return id < entries_.size() && used_[id]; }
    /// The box, with its margins.
    [[nodiscard]] const aabb& box(std::uint32_t id) const { return boxes_[id]; }
    [[nodiscard]] const proxy_filter& filter(std::uint32_t id) const { return entries_[id].filter; }
    [[nodiscard]] bool is_movable(std::uint32_t id) const { return entries_[id].filter.movable; }
    /// Asks the memory for a proxy that is going to be looked at.
    void fetch(std::uint32_t id) const {
        PHYSICS_HPP_PREFETCH(&boxes_[id]);
        PHYSICS_HPP_PREFETCH(&entries_[id]);
    }
    /// Whether the proxy came, went or left its box since the last search for pairs.
    [[nodiscard]] bool stale(std::uint32_t id) const { return stale_[id]; }
    /// Whether the number was given up since then, and perhaps given to another proxy.
    [[nodiscard]] bool slot_reused(std::uint32_t id) const { return any_slot_reused_ && entries_[id].slot_reused; }
    [[nodiscard]] candidate<Space> candidate_at(std::uint32_t id) const { return {id, filter(id), box(id)}; }
    [[nodiscard]] const candidate<Space>& candidate_at(const candidate<Space>& c) const { return c; }
    [[nodiscard]] bool may_meet(std::uint32_t a, std::uint32_t b) const {
        return physics::may_meet(entries_[a].filter, entries_[b].filter);
    }
    /// Those that came, went or left their box since then, once each.
    [[nodiscard]] const buffer<std::uint32_t>& changed() const { return changed_; }
    /// Those that left their box since the index last heard of it, once each.
    [[nodiscard]] const buffer<std::uint32_t>& dirty_for_index() const { return unseen_; }
    [[nodiscard]] bool dirty_for_index(std::uint32_t id) const { return entries_[id].dirty_for_index; }
    void flush_to_index() {
        for (const std::uint32_t id : unseen_) entries_[id].dirty_for_index = false;
        unseen_.clear();
    }

    /// Takes the memory for whatever happens to proxies of numbers below `slots`: nothing else here takes any then.
    PHYSICS_HPP_NOINLINE void reserve(std::uint32_t slots) {
        entries_.reserve(slots);
        boxes_.reserve(slots);
        used_.grow(slots);
        stale_.grow(slots);
        changed_.reserve(slots);
        unseen_.reserve(slots);
    }
    void insert(std::uint32_t id, const aabb& box, const proxy_filter& filter) {
        reserve(id < entries_.size() ? entries_.size() : id + 1);
        if (id >= entries_.size()) {
            entries_.resize(id + 1);
            boxes_.resize(id + 1);
        }
        entries_[id].filter = filter;
        used_.set(id);
        boxes_[id] = with_margin(box);
        ++count_;
        note(id);
    }
    void erase(std::uint32_t id) {
        used_.clear(id);
        entries_[id].slot_reused = any_slot_reused_ = true;
        --count_;
        note(id);
    }
    /// Whether a proxy in this box keeps within its margins; false for no box at all.
    [[nodiscard]] bool holds(std::uint32_t id, const aabb& box) const {
        const aabb& own = boxes_[id];
        for (int i = 0; i < D; ++i)
            if (!(own.lower[i] <= box.lower[i] && box.lower[i] <= box.upper[i] && box.upper[i] <= own.upper[i]))
                return false;
        return true;
    }
    /// Gives a proxy a new box around this one, wider on the way ahead.
    void move(std::uint32_t id, const aabb& box, const vec& displacement) {
        reserve(entries_.size());
        boxes_[id] = with_margin(box);
        for (int i = 0; i < D; ++i) {
            // No farther than the box is wide: a teleport is no velocity.
            const S maximum = box.upper[i] - box.lower[i] + settings.margin;
            const S ahead = clamp(displacement[i] * settings.prediction, -maximum, maximum);
            if (ahead > S(0)) boxes_[id].upper[i] = bounded_sum(boxes_[id].upper[i], ahead);
            else boxes_[id].lower[i] = bounded_sum(boxes_[id].lower[i], ahead);
        }
        note(id);
        if (!entries_[id].dirty_for_index) unseen_.push_back(id);
        entries_[id].dirty_for_index = true;
    }
    /// Forgets which have changed.
    void clear_dirty() {
        for (const std::uint32_t id : changed_) {
            stale_.clear(id);
            if (any_slot_reused_) entries_[id].slot_reused = false;
        }
        changed_.clear();
        any_slot_reused_ = false;
    }

    PHYSICS_HPP_MEMBERS(settings, boxes_, entries_, changed_, unseen_, used_, stale_, count_, any_slot_reused_)

private:
    /// Where fixed point would wrap, the end of its range.
    static S bounded_sum(S a, S b) {
        const S sum = a + b;
        if constexpr (is_fixed<S>) {
            if (b > S(0) && sum < a) return scalar_traits<S>::max();
            if (b < S(0) && sum > a) return -scalar_traits<S>::max();
        }
        return sum;
    }
    [[nodiscard]] aabb with_margin(const aabb& box) const {
        aabb wide;
        for (int i = 0; i < D; ++i) {
            wide.lower[i] = bounded_sum(box.lower[i], -settings.margin);
            wide.upper[i] = bounded_sum(box.upper[i], settings.margin);
        }
        return wide;
    }

    struct entry {
        proxy_filter filter;
        bool slot_reused = false, dirty_for_index = false;
    };

    void note(std::uint32_t id) {
        if (stale_[id]) return;
        stale_.set(id);
        changed_.push_back(id);
    }

    buffer<aabb> boxes_;
    buffer<entry> entries_;
    buffer<std::uint32_t> changed_, unseen_;
    bit_array used_, stale_;
    reset_on_move<std::uint32_t> count_;
    bool any_slot_reused_ = false;
};

}  // namespace detail

PHYSICS_HPP_END
