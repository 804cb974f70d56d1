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

namespace solver_api {

/// Contacts that a solver is to solve, of a longer list, and what their surfaces make of each other.
template <class S, int D, class Features = without<>>
class contact_constraints {
    using contact = solver_api::contact<S, D, Features>;
    using combined_material = detail::combined_material<S, Features>;

public:
    contact_constraints(contact* all, const std::uint32_t* numbers, const body_pair* bodies, std::uint32_t count,
                        const combined_material& surfaces = {})
        : all_(all), numbers_(numbers), bodies_(bodies), count_(count), surfaces_(surfaces) {}
    /// All contacts of a buffer, in a world of which the solver sees all bodies.
    contact_constraints(buffer<contact>& all, arena& scratch, const combined_material& surfaces = {})
        : all_(all.begin()), numbers_(detail::iota(all.size(), scratch)), count_(all.size()), surfaces_(surfaces) {
        auto* const bodies = scratch.allocate<body_pair>(count_);
        for (std::uint32_t i = 0; i < count_; ++i)
            new (bodies + i) body_pair{all[i].bodies.body_a, all[i].bodies.body_b};
        bodies_ = bodies;
    }

    [[nodiscard]] std::uint32_t size() const { return count_; }
    contact& operator[](std::uint32_t i) const { return all_[numbers_[i]]; }
    /// The bodies of a contact, by their numbers among those that the solver sees.
    [[nodiscard]] const body_pair& bodies(std::uint32_t i) const { return bodies_[i]; }

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
    const body_pair* bodies_ = nullptr;
    std::uint32_t count_;
    [[no_unique_address]] combined_material surfaces_;
};

}  // namespace solver_api

namespace detail {

/// Islands that are solved together: a range of body slots, followed by the static body's and a dummy slot, and a range
/// of the order of edges.
struct batch {
    std::uint32_t bodies, static_slot, edges, end;

    [[nodiscard]] std::uint32_t slots() const { return static_slot + 2 - bodies; }
    /// How much work there is in it.
    [[nodiscard]] std::uint32_t weight() const { return static_slot - bodies + end - edges; }
};

/// The batches of a step. Bodies that can be pushed have one slot; those that only push have another one in each batch
/// that they push.
struct batches {
    batch* first = nullptr;
    std::uint32_t count = 0;
    /// Numbers of edges, batch by batch, in each in ascending order; beside it their bodies by numbers in the batch.
    std::uint32_t* order = nullptr;
    body_pair* ends = nullptr;
    /// Of each body its slot, and of each slot its body.
    std::uint32_t *slot_of = nullptr, *body_at = nullptr;
    std::uint32_t slots = 0;
};

/// Groups islands into batches: each island is in one batch, and small islands share one up to a weight that fits into
/// the caches. Batches share no body that can move, and each keeps the order of the whole list, so neither their size
/// nor their order changes any bit. O(bodies + edges).
class graph_builder {
public:
    static constexpr std::uint32_t target_weight = 512;

    /// Of each body of the world its number among the awake ones, which is their count for all others; is_pushed: of
    /// each awake body, and false for one more. Up to `batch_limit` bodies and edges make one batch.
    graph_builder(const buffer<edge>& edges, const std::uint32_t* awake_index, const bool* is_pushed,
                  std::uint32_t bodies, arena& scratch, std::uint32_t batch_limit = target_weight,
                  task_runner* tasks = nullptr)
        : scratch_(scratch), is_pushed_(is_pushed), bodies_(bodies), edges_(edges.size()) {
        ends_ = scratch.allocate<body_pair>(edges_);
        task_runner alone;
        (tasks != nullptr ? *tasks : alone)
            .parallel_for(edges_, target_weight, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
                for (std::uint32_t n = first; n < end; ++n)
                    ends_[n] = {awake_index[edges[n].body_a], awake_index[edges[n].body_b]};
            });
        if (bodies_ + edges_ <= batch_limit) {
            make_single_batch();
            return;
        }
        const arena::mark start = scratch.here();
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
                for (std::uint32_t i = of.edges; i < of.end; ++i) add_shared_body(of, ends_[result_.order[i]]);
            for (std::uint32_t i = of.edges; i < of.end; ++i) {
                const body_pair& ends = ends_[result_.order[i]];
                result_.ends[i] = {number_in(of, ends.a), number_in(of, ends.b)};
            }
            result_.body_at[of.static_slot] = bodies_;
        }
    }
    [[nodiscard]] const batches& result() const { return result_; }

private:
    void make_single_batch() {
        result_.first = new (scratch_.allocate<batch>(1)) batch{0, bodies_, 0, edges_};
        result_.count = 1;
        result_.slots = result_.first->slots();
        result_.order = iota(edges_, scratch_);
        result_.ends = ends_;
        result_.slot_of = result_.body_at = iota(bodies_ + 1, scratch_);
    }

    /// Says which batch each body is in.
    void fill() {
        disjoint_sets islands(bodies_, scratch_);
        for (std::uint32_t n = 0; n < edges_; ++n)
            if (is_pushed_[ends_[n].a] && is_pushed_[ends_[n].b]) islands.unite(ends_[n].a, ends_[n].b);
        auto* weight = scratch_.allocate<std::uint32_t>(bodies_);
        for (std::uint32_t i = 0; i < bodies_; ++i) weight[i] = 0;
        for (std::uint32_t i = 0; i < bodies_; ++i) ++weight[islands.find(i)];
        for (std::uint32_t n = 0; n < edges_; ++n) ++weight[islands.find(owner(n))];

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
    /// The body whose batch an edge belongs to.
    [[nodiscard]] std::uint32_t owner(std::uint32_t n) const {
        const auto [a, b] = ends_[n];
        if (is_pushed_[a] || !(b < bodies_)) return a;
        return is_pushed_[b] || !(a < bodies_) ? b : a;
    }

    /// Assigns body slots, with room for kinematic bodies shared by several batches and for the static slot, and orders
    /// edges by batch.
    void place_bodies() {
        batch* const first = result_.first = scratch_.allocate<batch>(result_.count);
        auto* room = scratch_.allocate<std::uint32_t>(result_.count);
        for (std::uint32_t k = 0; k < result_.count; ++k) new (first + k) batch{0, 0, 0, 0}, room[k] = 2;
        for (std::uint32_t i = 0; i < bodies_; ++i) ++room[batch_of_[i]];
        for (std::uint32_t n = 0; n < edges_; ++n) {
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
        result_.order = scratch_.allocate<std::uint32_t>(edges_);
        result_.ends = scratch_.allocate<body_pair>(edges_);
        result_.slot_of = scratch_.allocate<std::uint32_t>(bodies_);
        result_.body_at = scratch_.allocate<std::uint32_t>(slot);
        shared_slot_of_ = scratch_.allocate<std::uint32_t>(bodies_);
        for (std::uint32_t i = 0; i < bodies_; ++i)
            result_.slot_of[i] = shared_slot_of_[i] = add(first[batch_of_[i]], i);
        for (std::uint32_t n = 0; n < edges_; ++n) result_.order[first[batch_of_[owner(n)]].end++] = n;
    }
    std::uint32_t add(batch& to, std::uint32_t body) {
        result_.body_at[to.static_slot] = body;
        return to.static_slot++;
    }
    /// Gives bodies that push something in a batch, and are not of it, a slot there.
    void add_shared_body(batch& to, const body_pair& of) {
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
    std::uint32_t bodies_, edges_;
    bool any_shared_ = false;
    body_pair* ends_ = nullptr;
    std::uint32_t *batch_of_ = nullptr, *shared_slot_of_ = nullptr;
    batches result_;
};

}  // namespace detail

PHYSICS_HPP_END
