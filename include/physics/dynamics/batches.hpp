// Batches: the islands of a step in parts that are solved one by one while they are in the caches, or side by side.
#pragma once

#include "physics/base/crew.hpp"
#include "physics/dynamics/islands.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

inline std::uint32_t* numbers_below(std::uint32_t count, arena& scratch) {
    auto* const numbers = scratch.take<std::uint32_t>(count);
    for (std::uint32_t i = 0; i < count; ++i) numbers[i] = i;
    return numbers;
}

}  // namespace detail

/// Contacts that a solver is to solve, of a longer list, and what their surfaces make of each other.
template <class S, int D, class Features = without<>>
class contact_list {
    using contact = physics::contact<S, D, Features>;
    using mixture = detail::mixture<S, Features>;

public:
    contact_list(contact* all, const std::uint32_t* numbers, std::uint32_t count, const mixture& surfaces = {})
        : all_(all), numbers_(numbers), count_(count), surfaces_(surfaces) {}
    /// All contacts of a buffer.
    contact_list(buffer<contact>& all, arena& scratch, const mixture& surfaces = {})
        : contact_list(all.begin(), detail::numbers_below(all.size(), scratch), all.size(), surfaces) {}

    [[nodiscard]] std::uint32_t size() const { return count_; }
    contact& operator[](std::uint32_t i) const { return all_[numbers_[i]]; }

    /// Coefficients of a contact (see material), whether it holds them or, in a recipe without materials a shape, all
    /// contacts have them in common; 0 of what the recipe leaves out.
    [[nodiscard]] S friction(const contact& c) const { return surfaces_.friction_of(c); }
    [[nodiscard]] S restitution(const contact& c) const { return surfaces_.restitution_of(c); }
    [[nodiscard]] S rolling_resistance(const contact& c) const { return surfaces_.rolling_resistance_of(c); }
    /// The same, for what sees only some contacts of the list.
    [[nodiscard]] const mixture& surfaces() const { return surfaces_; }

private:
    contact* all_;
    const std::uint32_t* numbers_;
    std::uint32_t count_;
    [[no_unique_address]] mixture surfaces_;
};

namespace detail {

/// Islands of a step that are solved together: which slots its bodies have, with nobody's and a spare one after them,
/// and which part of the order of contacts it is.
struct batch {
    std::uint32_t bodies, nobody, contacts, end;

    [[nodiscard]] std::uint32_t slots() const { return nobody + 2 - bodies; }
    /// How much work there is in it.
    [[nodiscard]] std::uint32_t weight() const { return nobody - bodies + end - contacts; }
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

/// Makes batches: an island is in one, and small islands share one until they have so many bodies and contacts as go
/// well into caches. What a batch does touches no other, and within an island the order is that of the whole list, so
/// that neither their size nor their order changes any bit. Contacts name bodies by number, those of the many that
/// never move by the count; from here on they name them by their slots in the batch. O(bodies + contacts).
class batch_maker {
public:
    static constexpr std::uint32_t enough = 512;

    /// is_pushed: of each body, and false for one more. Up to `in_one` bodies and contacts make one batch.
    template <class S, int D, class Features>
    batch_maker(buffer<contact<S, D, Features>>& contacts, const bool* is_pushed, std::uint32_t bodies, arena& scratch,
                std::uint32_t in_one = enough, crew* hands = nullptr)
        : scratch_(scratch), is_pushed_(is_pushed), bodies_(bodies), contacts_(contacts.size()) {
        if (bodies_ + contacts_ <= in_one) {
            put_all_into_one();
            return;
        }
        const arena::mark start = scratch.here();
        ends_ = scratch.take<ends>(contacts_);
        crew alone;
        (hands != nullptr ? *hands : alone)
            .each_range(contacts_, enough, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
                for (std::uint32_t n = first; n < end; ++n) ends_[n] = {contacts[n].body_a, contacts[n].body_b};
            });
        fill();
        if (result_.count == 1) {
            scratch.rewind(start);
            put_all_into_one();
            return;
        }
        place_bodies();
        for (std::uint32_t k = 0; k < result_.count; ++k) {
            batch& of = result_.first[k];
            if (some_only_push_)
                for (std::uint32_t i = of.contacts; i < of.end; ++i) invite(of, ends_[result_.order[i]]);
            for (std::uint32_t i = of.contacts; i < of.end; ++i) {
                const std::uint32_t n = result_.order[i];
                contacts[n].body_a = number_in(of, ends_[n].a);
                contacts[n].body_b = number_in(of, ends_[n].b);
            }
            result_.body_at[of.nobody] = bodies_;
        }
    }
    [[nodiscard]] const batches& result() const { return result_; }

private:
    struct ends {
        std::uint32_t a, b;
    };

    void put_all_into_one() {
        result_.first = new (scratch_.take<batch>(1)) batch{0, bodies_, 0, contacts_};
        result_.count = 1;
        result_.slots = result_.first->slots();
        result_.order = numbers_below(contacts_, scratch_);
        result_.slot_of = result_.body_at = numbers_below(bodies_ + 1, scratch_);
    }

    /// Says which batch each body is in.
    void fill() {
        disjoint_sets islands(bodies_, scratch_);
        for (std::uint32_t n = 0; n < contacts_; ++n)
            if (is_pushed_[ends_[n].a] && is_pushed_[ends_[n].b]) islands.unite(ends_[n].a, ends_[n].b);
        auto* weight = scratch_.take<std::uint32_t>(bodies_);
        for (std::uint32_t i = 0; i < bodies_; ++i) weight[i] = 0;
        for (std::uint32_t i = 0; i < bodies_; ++i) ++weight[islands.find(i)];
        for (std::uint32_t n = 0; n < contacts_; ++n) ++weight[islands.find(owner(n))];

        batch_of_ = scratch_.take<std::uint32_t>(bodies_);
        std::uint32_t filled = 0;
        for (std::uint32_t i = 0; i < bodies_; ++i) {
            const std::uint32_t island = islands.find(i);
            // An island's name is its least member, so that it has been seen.
            if (island != i) {
                batch_of_[i] = batch_of_[island];
                continue;
            }
            if (filled > 0 && filled + weight[i] > enough) ++result_.count, filled = 0;
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

    /// Gives bodies their slots, with room for those that only push and for nobody, and puts contacts into order.
    void place_bodies() {
        batch* const first = result_.first = scratch_.take<batch>(result_.count);
        auto* room = scratch_.take<std::uint32_t>(result_.count);
        for (std::uint32_t k = 0; k < result_.count; ++k) new (first + k) batch{0, 0, 0, 0}, room[k] = 2;
        for (std::uint32_t i = 0; i < bodies_; ++i) ++room[batch_of_[i]];
        for (std::uint32_t n = 0; n < contacts_; ++n) {
            const auto [a, b] = ends_[n];
            const std::uint32_t k = batch_of_[owner(n)];
            ++first[k].end;
            for (const std::uint32_t body : {a, b}) {
                if (!(body < bodies_) || batch_of_[body] == k) continue;
                some_only_push_ = true;
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
        result_.order = scratch_.take<std::uint32_t>(contacts_);
        result_.slot_of = scratch_.take<std::uint32_t>(bodies_);
        result_.body_at = scratch_.take<std::uint32_t>(slot);
        copy_of_ = scratch_.take<std::uint32_t>(bodies_);
        for (std::uint32_t i = 0; i < bodies_; ++i) result_.slot_of[i] = copy_of_[i] = add(first[batch_of_[i]], i);
        for (std::uint32_t n = 0; n < contacts_; ++n) result_.order[first[batch_of_[owner(n)]].end++] = n;
    }
    std::uint32_t add(batch& to, std::uint32_t body) {
        result_.body_at[to.nobody] = body;
        return to.nobody++;
    }
    /// Gives bodies that push something in a batch, and are not of it, a slot there.
    void invite(batch& to, const ends& of) {
        for (const std::uint32_t body : {of.a, of.b})
            if (body < bodies_ && !has(to, slot_in(to, body))) copy_of_[body] = add(to, body);
    }
    static bool has(const batch& of, std::uint32_t slot) { return slot >= of.bodies && slot < of.nobody; }
    [[nodiscard]] std::uint32_t slot_in(const batch& of, std::uint32_t body) const {
        return has(of, result_.slot_of[body]) ? result_.slot_of[body] : copy_of_[body];
    }
    [[nodiscard]] std::uint32_t number_in(const batch& of, std::uint32_t body) const {
        return (body < bodies_ ? slot_in(of, body) : of.nobody) - of.bodies;
    }

    arena& scratch_;
    const bool* is_pushed_;
    std::uint32_t bodies_, contacts_;
    bool some_only_push_ = false;
    ends* ends_ = nullptr;
    std::uint32_t *batch_of_ = nullptr, *copy_of_ = nullptr;
    batches result_;
};

}  // namespace detail

PHYSICS_HPP_END
