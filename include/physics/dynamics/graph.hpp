// Batches: the islands of a step in parts that are solved one by one while they are in the caches, or side by side.
#pragma once

#include "physics/base/task_runner.hpp"
#include "physics/dynamics/islands.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

inline std::uint32_t* iota(std::uint32_t count, arena& scratch) {
    auto* const numbers = scratch.allocate<std::uint32_t>(count);
    for (std::uint32_t i = 0; i < count; ++i) numbers[i] = i;
    return numbers;
}

}  // namespace detail

/// Contacts that a solver is to solve, of a longer list, and what their surfaces make of each other.
template <class S, int D, class Features = without<>>
class contact_constraints {
    using contact = physics::contact<S, D, Features>;
    using combined_material = detail::combined_material<S, Features>;

public:
    contact_constraints(contact* all, const std::uint32_t* numbers, std::uint32_t count,
                        const combined_material& surfaces = {})
        : all_(all), numbers_(numbers), count_(count), surfaces_(surfaces) {}
    /// All contacts of a buffer.
    contact_constraints(buffer<contact>& all, arena& scratch, const combined_material& surfaces = {})
        : contact_constraints(all.begin(), detail::iota(all.size(), scratch), all.size(), surfaces) {}

    [[nodiscard]] std::uint32_t size() const { return count_; }
    contact& operator[](std::uint32_t i) const { return all_[numbers_[i]]; }

    /// Coefficients of a contact (see material), whether it holds them or, in a recipe without materials a shape, all
    /// contacts have them in common; 0 of what the recipe leaves out.
    [[nodiscard]] S friction(const contact& c) const { return surfaces_.friction_of(c); }
    [[nodiscard]] S restitution(const contact& c) const { return surfaces_.restitution_of(c); }
    [[nodiscard]] S rolling_resistance(const contact& c) const { return surfaces_.rolling_resistance_of(c); }
    /// The same, for what sees only some contacts of the list.
    [[nodiscard]] const combined_material& surfaces() const { return surfaces_; }

private:
    contact* all_;
    const std::uint32_t* numbers_;
    std::uint32_t count_;
    [[no_unique_address]] combined_material surfaces_;
};

namespace detail {

/// Islands that are solved together: a range of body slots, followed by the static body's and a dummy slot, and a range
/// of the contact order.
struct batch {
    std::uint32_t bodies, static_slot, contacts, end;

    [[nodiscard]] std::uint32_t slots() const { return static_slot + 2 - bodies; }
    /// How much work there is in it.
    [[nodiscard]] std::uint32_t weight() const { return static_slot - bodies + end - contacts; }
};

/// The batches of a step. Bodies that can be pushed have one slot; those that only push have another one in each batch
/// that they push.
struct batches {
    batch* first = nullptr;
    std::uint32_t count = 0;
    /// Numbers of contacts, batch by batch, in each in ascending order.
    std::uint32_t* order = nullptr;
    /// Of each body its slot, and of each slot its body.
    std::uint32_t *slot_of = nullptr, *body_at = nullptr;
    std::uint32_t slots = 0;
};

/// Groups islands into batches: each island is in one batch, and small islands share one up to a weight that fits into
/// the caches. Batches share no body that can move, and each keeps the order of the whole list, so neither their size
/// nor their order changes any bit. Rewrites contact body numbers from awake index (static: the count) to batch slot.
/// O(bodies + contacts).
class graph_builder {
public:
    static constexpr std::uint32_t target_weight = 512;

    /// is_pushed: of each body, and false for one more. Up to `batch_limit` bodies and contacts make one batch.
    template <class S, int D, class Features>
    graph_builder(buffer<contact<S, D, Features>>& contacts, const bool* is_pushed, std::uint32_t bodies,
                  arena& scratch, std::uint32_t batch_limit = target_weight, task_runner* tasks = nullptr)
        : scratch_(scratch), is_pushed_(is_pushed), bodies_(bodies), contacts_(contacts.size()) {
        if (bodies_ + contacts_ <= batch_limit) {
            make_single_batch();
            return;
        }
        const arena::mark start = scratch.here();
        ends_ = scratch.allocate<ends>(contacts_);
        task_runner alone;
        (tasks != nullptr ? *tasks : alone)
            .parallel_for(contacts_, target_weight, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
                for (std::uint32_t n = first; n < end; ++n) ends_[n] = {contacts[n].body_a, contacts[n].body_b};
            });
        fill();
        if (result_.count == 1) {
            scratch.rewind(start);
            make_single_batch();
            return;
        }
        place_bodies();
        for (std::uint32_t k = 0; k < result_.count; ++k) {
            batch& of = result_.first[k];
            if (any_shared_)
                for (std::uint32_t i = of.contacts; i < of.end; ++i) add_shared_body(of, ends_[result_.order[i]]);
            for (std::uint32_t i = of.contacts; i < of.end; ++i) {
                const std::uint32_t n = result_.order[i];
                contacts[n].body_a = number_in(of, ends_[n].a);
                contacts[n].body_b = number_in(of, ends_[n].b);
            }
            result_.body_at[of.static_slot] = bodies_;
        }
    }
    [[nodiscard]] const batches& result() const { return result_; }

private:
    struct ends {
        std::uint32_t a, b;
    };

    void make_single_batch() {
        result_.first = new (scratch_.allocate<batch>(1)) batch{0, bodies_, 0, contacts_};
        result_.count = 1;
        result_.slots = result_.first->slots();
        result_.order = iota(contacts_, scratch_);
        result_.slot_of = result_.body_at = iota(bodies_ + 1, scratch_);
    }

    /// Says which batch each body is in.
    void fill() {
        disjoint_sets islands(bodies_, scratch_);
        for (std::uint32_t n = 0; n < contacts_; ++n)
            if (is_pushed_[ends_[n].a] && is_pushed_[ends_[n].b]) islands.unite(ends_[n].a, ends_[n].b);
        auto* weight = scratch_.allocate<std::uint32_t>(bodies_);
        for (std::uint32_t i = 0; i < bodies_; ++i) weight[i] = 0;
        for (std::uint32_t i = 0; i < bodies_; ++i) ++weight[islands.find(i)];
        for (std::uint32_t n = 0; n < contacts_; ++n) ++weight[islands.find(owner(n))];

        batch_of_ = scratch_.allocate<std::uint32_t>(bodies_);
        std::uint32_t filled = 0;
        for (std::uint32_t i = 0; i < bodies_; ++i) {
            const std::uint32_t island = islands.find(i);
            // An island's name is its least member, so that it has been seen.
            if (island != i) {
                batch_of_[i] = batch_of_[island];
                continue;
            }
            if (filled > 0 && filled + weight[i] > target_weight) ++result_.count, filled = 0;
            batch_of_[i] = result_.count;
            filled += weight[i];
        }
        ++result_.count;
    }
    /// The body whose batch a contact belongs to.
    [[nodiscard]] std::uint32_t owner(std::uint32_t n) const {
        const auto [a, b] = ends_[n];
        if (is_pushed_[a] || !(b < bodies_)) return a;
        return is_pushed_[b] || !(a < bodies_) ? b : a;
    }

    /// Assigns body slots, with room for kinematic bodies shared by several batches and for the static slot, and orders
    /// contacts by batch.
    void place_bodies() {
        batch* const first = result_.first = scratch_.allocate<batch>(result_.count);
        auto* room = scratch_.allocate<std::uint32_t>(result_.count);
        for (std::uint32_t k = 0; k < result_.count; ++k) new (first + k) batch{0, 0, 0, 0}, room[k] = 2;
        for (std::uint32_t i = 0; i < bodies_; ++i) ++room[batch_of_[i]];
        for (std::uint32_t n = 0; n < contacts_; ++n) {
            const auto [a, b] = ends_[n];
            const std::uint32_t k = batch_of_[owner(n)];
            ++first[k].end;
            for (const std::uint32_t body : {a, b}) {
                if (!(body < bodies_) || batch_of_[body] == k) continue;
                any_shared_ = true;
                ++room[k];
            }
        }
        std::uint32_t slot = 0, at = 0;
        for (std::uint32_t k = 0; k < result_.count; ++k) {
            const std::uint32_t size = first[k].end;
            first[k] = {slot, slot, at, at};
            slot += room[k];
            at += size;
        }
        result_.slots = slot;
        result_.order = scratch_.allocate<std::uint32_t>(contacts_);
        result_.slot_of = scratch_.allocate<std::uint32_t>(bodies_);
        result_.body_at = scratch_.allocate<std::uint32_t>(slot);
        shared_slot_of_ = scratch_.allocate<std::uint32_t>(bodies_);
        for (std::uint32_t i = 0; i < bodies_; ++i)
            result_.slot_of[i] = shared_slot_of_[i] = add(first[batch_of_[i]], i);
        for (std::uint32_t n = 0; n < contacts_; ++n) result_.order[first[batch_of_[owner(n)]].end++] = n;
    }
    std::uint32_t add(batch& to, std::uint32_t body) {
        result_.body_at[to.static_slot] = body;
        return to.static_slot++;
    }
    /// Gives bodies that push something in a batch, and are not of it, a slot there.
    void add_shared_body(batch& to, const ends& of) {
        for (const std::uint32_t body : {of.a, of.b})
            if (body < bodies_ && !has(to, slot_in(to, body))) shared_slot_of_[body] = add(to, body);
    }
    static bool has(const batch& of, std::uint32_t slot) { return slot >= of.bodies && slot < of.static_slot; }
    [[nodiscard]] std::uint32_t slot_in(const batch& of, std::uint32_t body) const {
        return has(of, result_.slot_of[body]) ? result_.slot_of[body] : shared_slot_of_[body];
    }
    [[nodiscard]] std::uint32_t number_in(const batch& of, std::uint32_t body) const {
        return (body < bodies_ ? slot_in(of, body) : of.static_slot) - of.bodies;
    }

    arena& scratch_;
    const bool* is_pushed_;
    std::uint32_t bodies_, contacts_;
    bool any_shared_ = false;
    ends* ends_ = nullptr;
    std::uint32_t *batch_of_ = nullptr, *shared_slot_of_ = nullptr;
    batches result_;
};

}  // namespace detail

PHYSICS_HPP_END
