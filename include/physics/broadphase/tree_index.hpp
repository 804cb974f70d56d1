// The index behind dynamic_tree: where boxes are, in trees that are packed anew as the boxes move.
#pragma once

#include "physics/base/sort.hpp"
#include "physics/broadphase/arrange.hpp"
#include "physics/broadphase/box_tail.hpp"
#include "physics/broadphase/box_tests.hpp"
#include "physics/broadphase/proxies.hpp"
#include "physics/broadphase/tree_pairs.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Movable proxies and those that are not live in trees of their own, and each kind in two: a main tree, in which
/// boxes that move keep their places, and a young one for what came or strayed from its neighbours, packed anew with
/// every change. Once the main tree has grown by a fifth, or an eighth of all is young, everything goes into a new
/// main tree. What has just come or strayed waits in a tail, searched eight by eight.
template <class Space>
class tree_index {
public:
    using S = typename Space::scalar;
    static constexpr int D = Space::dimension;
    using table = proxies<Space>;
    using tree = packed_tree<D>;
    static constexpr bool exact = true;

    /// Takes the memory for so many changes, of numbers below `slots`, and for the update after them.
    void reserve(const table& all, std::uint32_t slots, std::uint32_t changes) {
        places_.reserve(slots);
        reserve_update(all.dirty_for_index().size() + changes);
    }
    void insert(const table& all, std::uint32_t id) {
        kind& k = kinds_[all.is_movable(id)];
        k.unsorted.reserve(k.unsorted.size() + 1);
        if (id >= places_.size()) places_.resize(id + 1);
        add_unsorted(all, k, id);
        pop_unsorted(all, k);
    }
    void erase(const table& all, std::uint32_t id) { take_out(kinds_[all.is_movable(id)], id); }

    /// Brings the trees up to date with the boxes of these proxies.
    void update(const table& all, const std::uint32_t* ids, std::uint32_t count) {
        reserve_update(count);
        for (int m = 0; m < 2; ++m) {
            kind& k = kinds_[m];
            keys_.clear();
            for (std::uint32_t i = 0; i < count; ++i) {
                const std::uint32_t id = ids[i];
                if (!all.has(id) || all.is_movable(id) != (m == 1)) continue;
                if (places_[id] & staging_place) move_to_unsorted(all, k, id);
                else if (places_[id] & unsorted_place) k.unsorted.set(places_[id] & slot_mask, box_of(all, id));
                else keys_.push_back(std::uint64_t{places_[id]} << 32 | id);
            }
            const std::uint32_t staging = k.staging.live() + k.unsorted.size(), live = k.main.live() + staging;
            if ((staging > live / 8 || (k.size > max_growth * k.packed_size && !keys_.empty())) &&
                has_room(k.main, live, false)) {
                pack_all(all, k);
                if (m == 1) follow(all);
                continue;
            }
            touched_.clear();
            if (keys_.size() > live / 8) {
                for (std::uint32_t slot = 0; slot < k.main.leaves() * 8; ++slot) {
                    fetch_ahead(all, k.main, slot);
                    const std::uint32_t id = k.main.id(slot);
                    if (id != no_proxy && all.stale(id) && all.dirty_for_index(id)) place(all, k, id);
                }
            } else {
                scratch_.resize(keys_.size());
                const std::uint64_t* sorted = radix_sort(keys_.begin(), scratch_.begin(), keys_.size(), 32, 64);
                for (std::uint32_t i = 0; i < keys_.size(); ++i) place(all, k, static_cast<std::uint32_t>(sorted[i]));
            }
            k.size += k.main.refit(touched_);
            pop_unsorted(all, k);
        }
    }

    /// Calls emit(a, b) for each two proxies of which one at least is stale, that may meet and whose boxes overlap;
    /// once for each two. Returns true if these were all pairs that there are. To be called after an update with
    /// everything that has changed.
    template <class Emit>
    bool find(const table& all, Emit&& emit_pair) {
        const auto emit = [&](const tree& x, std::uint32_t i, const tree& y, std::uint32_t k) {
            if (!may_meet(x.filter(i), y.filter(k))) return;
            const std::uint32_t a = x.id(i), b = y.id(k);
            if constexpr (!std::is_same_v<S, float>)
                if (!overlap(all.box(a), all.box(b))) return;
            emit_pair(a, b);
        };
        for (kind& k : kinds_)
            if (!k.unsorted.empty() && has_room(k.staging, k.staging.live() + k.unsorted.size(), true))
                pack_staging(all, k);
        kind &fixed = kinds_[0], &movable = kinds_[1];
        bool everything = true;
        for (tree* x : {&movable.main, &movable.staging}) everything = everything && x->all_marked();
        for (tree* x : {&movable.main, &movable.staging}) {
            const bool first = x == &movable.main;
            find_pairs(*x, movable.main, first ? tree_order::same : tree_order::before, everything, emit);
            find_pairs(*x, movable.staging, first ? tree_order::after : tree_order::same, everything, emit);
            find_pairs(*x, fixed.main, tree_order::after, false, emit);
            find_pairs(*x, fixed.staging, tree_order::after, false, emit);
        }
        for (tree* x : {&fixed.main, &fixed.staging})
            for (tree* y : {&movable.main, &movable.staging}) find_pairs(*x, *y, tree_order::before, false, emit);
        return everything;
    }
    /// What was found has been taken in: nothing is stale any more.
    void end_search() {
        for (kind& k : kinds_) {
            k.main.clear_marks();
            k.staging.clear_marks();
        }
    }

    /// How many blocks of eight boxes a search for this box looks at: what a query costs.
    [[nodiscard]] std::uint32_t blocks_tested(const typename Space::aabb& box) const {
        const float_box<D> reach = enclosing(box, origin_);
        std::uint32_t count = 0;
        for (const kind& k : kinds_)
            for (const tree* t : {&k.main, &k.staging})
                t->search(
                    0, [&](const auto& block) { return ++count, block.overlapping(reach); },
                    [](std::uint32_t, std::uint32_t) {});
        return count;
    }
    /// Calls f(box) for the boxes of the trees' nodes, in double: to draw them.
    template <class F>
    void each_node(F&& f) const {
        const auto give = [&](const float_box<D>& box) {
            aabb<double, D> in_world;
            for (int i = 0; i < D; ++i) {
                const double from = static_cast<double>(origin_[i]);
                in_world.lower[i] = static_cast<double>(box.lower[i]) + from;
                in_world.upper[i] = static_cast<double>(box.upper[i]) + from;
            }
            // One that has lost all that was in it is inside out.
            if (!(box.lower[0] > box.upper[0])) f(in_world);
        };
        for (const kind& k : kinds_)
            for (const tree* t : {&k.main, &k.staging}) t->each_node(give);
    }
    /// Calls visit(id) for every proxy whose box may overlap this one, until it returns false; `movable` says whether
    /// those that move are wanted as well.
    template <class Visit>
    void each_near(const table& all, const typename Space::aabb& box, Visit&& visit, bool movable = true) const {
        const float_box<D> reach = enclosing(box, origin_);
        each_where(
            all, movable ? 2 : 1, [&](const auto& block) { return block.overlapping(reach); }, visit);
    }
    /// The same for every proxy that may not lie wholly beyond a plane.
    template <class Visit>
    void each_inside(const table& all, const bounding_plane<S, D>* planes, std::uint32_t count, Visit&& visit) const {
        const float_region<D> region(planes, count, origin_);
        each_where(
            all, 2, [&](const auto& block) { return region.reaches(block); }, visit);
    }
    /// Calls visit(id) for proxies that the ray may meet, the first ones early. It returns how far along the
    /// translation the search is to go on.
    template <class Visit>
    void each_along(const table& all, const ray<S, D>& r, S limit, Visit&& visit) const {
        const float_ray<D> fast_ray(r, origin_);
        float reach = above(limit) + fast_ray.step;
        each_in_order(
            all, [&](const auto& block, auto& keys) { return fast_ray.meets(block, reach, keys); },
            [&](float key) { return key > reach; }, [&](const auto& c) { reach = above(visit(c)) + fast_ray.step; });
    }
    /// Calls visit(id) for proxies near a point, the nearest ones early. It returns the square of the distance up to
    /// which the search is to go on.
    template <class Visit>
    void each_around(const table& all, const typename Space::vec& point, wide_of<S> limit, Visit&& visit) const {
        const float_point<D> at(point, origin_);
        float reach = above_square<S>(limit);
        each_in_order(
            all, [&](const auto& block, auto& keys) { return at.within(block, reach, keys); },
            [&](float key) { return key > reach; }, [&](const auto& c) { reach = above_square<S>(visit(c)); });
    }

    PHYSICS_HPP_MEMBERS(kinds_, places_, origin_, keys_, scratch_, items_, spare_items_, touched_)

private:
    /// What is in a slot; of float the box in the lane is the exact one, and near in memory.
    static candidate<Space> candidate_in(const table& all, const tree& t, std::uint32_t slot) {
        const std::uint32_t id = t.id(slot);
        if constexpr (!std::is_same_v<S, float>) {
            return {id, t.filter(slot), all.box(id)};
        } else {
            const float_box<D> box = t.leaf(slot / 8).get(slot % 8);
            candidate<Space> c{id, t.filter(slot), {}};
            for (int i = 0; i < D; ++i) {
                c.box.lower[i] = box.lower[i];
                c.box.upper[i] = box.upper[i];
            }
            return c;
        }
    }
    /// Searches so many kinds, of which what is fixed is the first.
    template <class Test, class Visit>
    void each_where(const table& all, int kinds, Test&& test, Visit&& visit) const {
        bool on = true;
        for (int m = 0; m < kinds; ++m) {
            const kind& k = kinds_[m];
            for (const tree* t : {&k.main, &k.staging})
                t->search(
                    0, [&](const auto& block) { return on ? test(block) : 0u; },
                    [&](std::uint32_t leaf, std::uint32_t lanes) {
                        each_bit(lanes,
                                 [&](std::uint32_t i) { on = on && visit(candidate_in(all, *t, leaf * 8 + i)); });
                    });
            k.unsorted.search([&](const auto& block) { return on ? test(block) : 0u; },
                              [&](std::uint32_t leaf, std::uint32_t lanes) {
                                  each_bit(lanes, [&](std::uint32_t i) {
                                      on = on && visit(all.candidate_at(k.unsorted.id(leaf * 8 + i)));
                                  });
                              });
        }
    }
    template <class Test, class Outside, class Visit>
    void each_in_order(const table& all, Test&& test, Outside&& outside, Visit&& visit) const {
        for (const kind& k : kinds_) {
            for (const tree* t : {&k.main, &k.staging})
                t->search_in_order(test, outside, [&](std::uint32_t slot) { visit(candidate_in(all, *t, slot)); });
            k.unsorted.search_all(test, outside, [&](std::uint32_t i) { visit(all.candidate_at(k.unsorted.id(i))); });
        }
    }

    enum : std::uint32_t { staging_place = 1u << 30, unsorted_place = 2u << 30, slot_mask = (1u << 30) - 1 };
    /// How much larger leaves may get by moving before the tree is packed anew.
    static constexpr double max_growth = 1.2;

    struct kind {
        tree main, staging;
        box_tail<D> unsorted;
        /// The sides of the boxes around leaves of the main tree, and above: as they are, and as they were packed.
        double size = 0, packed_size = 0;

        PHYSICS_HPP_MEMBERS(main, staging, unsorted, size, packed_size)
    };

    auto box_of(const table& all, std::uint32_t id) const { return enclosing(all.box(id), origin_); }

    /// Takes a proxy out of where it is.
    void take_out(kind& k, std::uint32_t id) {
        const std::uint32_t place = places_[id], slot = place & slot_mask;
        if (place & unsorted_place) {
            places_[*(k.unsorted.end() - 1)] = place;
            k.unsorted.remove(slot);
        } else {
            (place & staging_place ? k.staging : k.main).remove(slot);
        }
    }

    /// Writes a box where its proxy is in the main tree, or sends the proxy to the tail if that is far from there.
    void place(const table& all, kind& k, std::uint32_t id) {
        const std::uint32_t p = places_[id];
        const float_box<D> box = box_of(all, id);
        const float_box<D> around = k.main.around(p / 8);
        float growth = 0, size = 0;
        for (int i = 0; i < D; ++i) {
            const float below = around.lower[i] - box.lower[i], above_it = box.upper[i] - around.upper[i];
            growth += (below > 0 ? below : 0) + (above_it > 0 ? above_it : 0);
            size += box.upper[i] - box.lower[i];
        }
        if (growth > 0.5f * size) {
            move_to_unsorted(all, k, id);
            return;
        }
        k.main.set(p, box);
        k.main.mark(p);
        if (touched_.empty() || touched_.back() != p / 8) touched_.push_back(p / 8);
    }
    void move_to_unsorted(const table& all, kind& k, std::uint32_t id) {
        take_out(k, id);
        add_unsorted(all, k, id);
    }
    void add_unsorted(const table& all, kind& k, std::uint32_t id) {
        places_[id] = unsorted_place | k.unsorted.size();
        k.unsorted.push_back(id, box_of(all, id));
    }

    PHYSICS_HPP_NOINLINE void gather(const table& all, const tree& from) {
        for (std::uint32_t slot = 0; slot < from.leaves() * 8; ++slot) {
            fetch_ahead(all, from, slot);
            if (from.id(slot) != no_proxy) add_item(all, from.id(slot));
        }
    }
    /// Numbers are in no order in memory, so what a loop over slots will look up is asked for in time.
    static void fetch_ahead(const table& all, const tree& t, std::uint32_t slot) {
        constexpr std::uint32_t ahead = 16;
        if (slot + ahead < t.leaves() * 8 && t.id(slot + ahead) != no_proxy) all.fetch(t.id(slot + ahead));
    }
    void add_item(const table& all, std::uint32_t id) {
        const float_box<D> box = box_of(all, id);
        packed_item item{{}, id};
        // A quarter of the sum of both ends: differences stay within the range.
        for (int i = 0; i < D; ++i) item.middle[i] = box.lower[i] * 0.25f + box.upper[i] * 0.25f;
        items_.push_back(item);
    }
    PHYSICS_HPP_NOINLINE void pack(const table& all, kind& k, tree& to, std::uint32_t tag) {
        for (const std::uint32_t id : k.unsorted) add_item(all, id);
        k.unsorted.clear();
        spare_items_.resize(items_.size());
        arrange<D>(items_.begin(), spare_items_.begin(), items_.size());
        to.build(
            items_.begin(), items_.size(),
            [&](std::uint32_t i) {
                constexpr std::uint32_t ahead = 16;
                if (i + ahead < items_.size()) all.fetch(items_[i + ahead].id);
                return box_of(all, items_[i].id);
            },
            [&](std::uint32_t id) -> const proxy_filter& { return all.filter(id); });
        for (std::uint32_t i = 0; i < items_.size(); ++i) {
            const std::uint32_t id = items_[i].id;
            places_[id] = tag | i;
            if (all.stale(id)) to.mark(i);
        }
        items_.clear();
    }
    /// Takes the memory to pack so many into a tree, so that nothing fails while it is packed: false where there is
    /// none, and it is not needed.
    PHYSICS_HPP_NOINLINE bool has_room(tree& to, std::uint32_t count, bool must) {
        return items_.try_reserve(count, must) && spare_items_.try_reserve(count, must) && to.try_reserve(count, must);
    }
    PHYSICS_HPP_NOINLINE void reserve_update(std::uint32_t count) {
        for (kind& k : kinds_) k.unsorted.reserve(k.unsorted.size() + count);
        keys_.reserve(count);
        scratch_.reserve(count);
        touched_.reserve(count);
    }
    /// Packs what waits in the tail once it is long for a search in no order; a search for pairs does so in any case.
    void pop_unsorted(const table& all, kind& k) {
        const std::uint32_t live = k.staging.live();
        if (k.unsorted.size() > 64 + live && has_room(k.staging, live + k.unsorted.size(), false)) pack_staging(all, k);
    }
    void pack_staging(const table& all, kind& k) {
        gather(all, k.staging);
        pack(all, k, k.staging, staging_place);
    }
    void pack_all(const table& all, kind& k) {
        gather(all, k.main);
        gather(all, k.staging);
        k.staging.clear();
        pack(all, k, k.main, 0);
        k.size = k.packed_size = k.main.size();
    }
    /// Moves the origin to where the movable proxies are, once that is far away for a float.
    void follow(const table& all) {
        if constexpr (!std::is_same_v<S, float>) {
            if (kinds_[1].main.live() == 0) return;
            const float_box<D> box = kinds_[1].main.around();
            float far = 0, wide = 0;
            for (int i = 0; i < D; ++i) {
                const float middle = box.lower[i] * 0.5f + box.upper[i] * 0.5f, size = box.upper[i] - box.lower[i];
                far = middle > far ? middle : -middle > far ? -middle : far;
                wide = size > wide ? size : wide;
            }
            if (!(far > 8 * wide)) return;
            for (kind& k : kinds_)
                if (!has_room(k.main, k.main.live() + k.staging.live() + k.unsorted.size(), false)) return;
            for (int i = 0; i < D; ++i) origin_[i] += S(static_cast<double>(box.lower[i] * 0.5f + box.upper[i] * 0.5f));
            for (kind& k : kinds_) pack_all(all, k);
        }
    }

    kind kinds_[2];
    /// By proxy: a place in the main tree, in the young one or in the tail of its kind.
    buffer<std::uint32_t> places_;
    typename Space::vec origin_{};
    // Scratch.
    step_scratch<buffer<std::uint64_t>> keys_, scratch_;
    step_scratch<buffer<packed_item>> items_, spare_items_;
    step_scratch<buffer<std::uint32_t>> touched_;
};

}  // namespace detail

PHYSICS_HPP_END
