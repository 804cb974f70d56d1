// The index behind dynamic_tree: where boxes are, in trees that are packed anew as the boxes move.
#pragma once

#include "physics/broadphase/box_tests.hpp"
#include "physics/broadphase/morton.hpp"
#include "physics/broadphase/packed_tree.hpp"
#include "physics/broadphase/proxies.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Movable proxies and those that are not live in trees of their own, and each kind in two: a main tree, in which
/// boxes that move a little stay where they are, and a young one for what came or strayed, packed anew with every
/// change; where much has moved, all goes into a new main tree. What has just come waits in a tail, searched one by
/// one, until the next update.
template <class Space>
class tree_index {
public:
    using S = typename Space::scalar;
    static constexpr int D = Space::dimension;
    using table = proxies<Space>;
    using tree = packed_tree<D>;

    void insert(const table& all, std::uint32_t id) {
        if (id >= places_.size()) places_.resize(id + 1);
        kind& k = kinds_[all.is_movable(id)];
        places_[id] = tail_place | k.tail.size();
        k.tail.push(id);
        if (k.tail.size() > 64 + k.young.live() / 4) pack_young(all, k);
    }
    void erase(const table& all, std::uint32_t id) { take_out(kinds_[all.is_movable(id)], id); }

    /// Brings the trees up to date with the boxes of these proxies.
    void update(const table& all, const std::uint32_t* ids, std::uint32_t count) {
        for (int m = 0; m < 2; ++m) {
            kind& k = kinds_[m];
            keys_.clear();
            for (std::uint32_t i = 0; i < count; ++i)
                if (all.has(ids[i]) && all.is_movable(ids[i]) == (m == 1))
                    keys_.push(std::uint64_t{places_[ids[i]]} << 32 | ids[i]);
            const std::uint32_t live = k.main.live() + k.young.live() + k.tail.size();
            const std::uint32_t moved = keys_.size() + k.young.live() + k.tail.size();
            if (moved > live / 4 || k.size > 1.5 * k.packed_size) {
                if (moved > 0) {
                    pack_all(all, k);
                    if (m == 1) follow(all);
                }
                continue;
            }
            spare_.resize(keys_.size());
            std::uint64_t* sorted = radix_sort(keys_.begin(), spare_.begin(), keys_.size(), 32, 64);
            touched_.clear();
            for (std::uint32_t i = 0; i < keys_.size(); ++i) place(all, k, static_cast<std::uint32_t>(sorted[i]));
            k.size += k.main.refit(touched_);
            if (k.tail.size() > 0) pack_young(all, k);
        }
    }

    /// Calls emit(a, b) for each two proxies of which one at least has moved, whose boxes overlap in float; once for
    /// each two. Returns true if these were all pairs that there are. To be called after an update with everything
    /// that has changed.
    template <class Emit>
    bool find(const table&, Emit&& emit) {
        kind &fixed = kinds_[0], &movable = kinds_[1];
        bool everything = true;
        for (tree* x : {&movable.main, &movable.young}) everything = everything && x->all_marked();
        for (tree* x : {&movable.main, &movable.young}) {
            const bool first = x == &movable.main;
            find_pairs(*x, movable.main, first ? same : before, everything, emit);
            find_pairs(*x, movable.young, first ? after : same, everything, emit);
            find_pairs(*x, fixed.main, after, false, emit);
            find_pairs(*x, fixed.young, after, false, emit);
        }
        for (tree* x : {&fixed.main, &fixed.young})
            for (tree* y : {&movable.main, &movable.young}) find_pairs(*x, *y, before, false, emit);
        for (kind& k : kinds_) {
            k.main.clear_marks();
            k.young.clear_marks();
        }
        return everything;
    }

    /// Calls visit(id) for every proxy whose box may overlap this one, until it returns false.
    template <class Visit>
    void each_near(const table& all, const typename Space::aabb& box, Visit&& visit) const {
        const float_box<D> reach = enclosing(box, origin_);
        each_where(all, [&](const auto& block) { return block.overlapping(reach); }, visit);
    }
    /// The same for every proxy that may not lie wholly beyond a plane.
    template <class Visit>
    void each_inside(const table& all, const bounding_plane<S, D>* planes, std::uint32_t count, Visit&& visit) const {
        const auto test = [&](const auto& block) {
            std::uint32_t lanes = 0xffu;
            for (std::uint32_t i = 0; i < count && lanes != 0; ++i)
                lanes &= float_plane<D>(planes[i], origin_).reaches(block);
            return count > 0 ? lanes : ~block.empty().bits() & 0xffu;
        };
        each_where(all, test, visit);
    }
    /// Calls visit(id) for proxies that the ray may meet, the first ones early. It returns how far along the
    /// translation the search is to go on.
    template <class Visit>
    void each_along(const table& all, const ray<S, D>& r, S limit, Visit&& visit) const {
        const float_ray<D> way(r, origin_);
        float reach = above(limit);
        each_in_order(
            all, [&](const auto& block, auto& keys) { return way.meets(block, reach, keys); },
            [&](float key) { return key > reach; }, [&](std::uint32_t id) { reach = above(visit(id)); });
    }
    /// Calls visit(id) for proxies near a point, the nearest ones early. It returns the square of the distance up to
    /// which the search is to go on.
    template <class Visit>
    void each_around(const table& all, const typename Space::vec& point, wide_of<S> limit, Visit&& visit) const {
        const float_point<D> at(point, origin_);
        float reach = above_square<S>(limit);
        each_in_order(
            all, [&](const auto& block, auto& keys) { return at.within(block, reach, keys); },
            [&](float key) { return key > reach; }, [&](std::uint32_t id) { reach = above_square<S>(visit(id)); });
    }

private:

    template <class Test, class Visit>
    void each_where(const table&, Test&& test, Visit&& visit) const {
        bool on = true;
        for (const kind& k : kinds_) {
            for (const tree* t : {&k.main, &k.young})
                t->search(0, [&](const auto& block) { return on ? test(block) : 0u; },
                          [&](std::uint32_t leaf, std::uint32_t lanes) {
                              each_bit(lanes, [&](std::uint32_t i) { on = on && visit(t->id(leaf * 8 + i)); });
                          });
            for (std::uint32_t i = 0; i < k.tail.size() && on; ++i) on = visit(k.tail[i]);
        }
    }
    template <class Test, class Outside, class Visit>
    void each_in_order(const table&, Test&& test, Outside&& outside, Visit&& visit) const {
        for (const kind& k : kinds_) {
            for (const tree* t : {&k.main, &k.young})
                t->search_in_order(test, outside, [&](std::uint32_t slot) { visit(t->id(slot)); });
            for (const std::uint32_t id : k.tail) visit(id);
        }
    }

    enum : std::uint32_t { young_place = 1u << 30, tail_place = 2u << 30, slot_mask = (1u << 30) - 1 };
    enum order { before, same, after };

    struct kind {
        tree main, young;
        buffer<std::uint32_t> tail;
        /// The leaves of the main tree by the sum of their sides: as it is, and as it was packed.
        double size = 0, packed_size = 0;
    };

    auto box_of(const table& all, std::uint32_t id) const { return enclosing(all.box(id), origin_); }

    /// Takes a proxy out of where it is.
    void take_out(kind& k, std::uint32_t id) {
        const std::uint32_t place = places_[id], slot = place & slot_mask;
        if (place & tail_place) {
            k.tail[slot] = k.tail.back();
            places_[k.tail[slot]] = place;
            k.tail.pop();
        } else {
            (place & young_place ? k.young : k.main).remove(slot);
        }
    }

    /// Writes a box where its proxy is, or sends the proxy to the tail if that is far from its neighbours.
    void place(const table& all, kind& k, std::uint32_t id) {
        const std::uint32_t p = places_[id];
        if (p & (tail_place | young_place)) {
            // Packed anew in a moment.
            if (p & young_place) send_to_tail(k, id);
            return;
        }
        const float_box<D> box = box_of(all, id);
        const float_box<D> around = k.main.around(p / 8);
        float apart = 0, size = 0;
        for (int i = 0; i < D; ++i) {
            const float low = box.lower[i] < around.lower[i] ? box.lower[i] : around.lower[i];
            const float high = box.upper[i] > around.upper[i] ? box.upper[i] : around.upper[i];
            apart += high - low;
            size += around.upper[i] - around.lower[i] + (box.upper[i] - box.lower[i]);
        }
        if (apart > 2 * size) {
            send_to_tail(k, id);
            return;
        }
        k.main.set(p, box);
        k.main.mark(p);
        if (touched_.empty() || touched_.back() != p / 8) touched_.push(p / 8);
    }
    void send_to_tail(kind& k, std::uint32_t id) {
        take_out(k, id);
        places_[id] = tail_place | k.tail.size();
        k.tail.push(id);
    }

    void gather(const tree& from) {
        for (std::uint32_t slot = 0; slot < from.leaves() * 8; ++slot)
            if (from.id(slot) != no_proxy) keys_.push(from.id(slot));
    }
    void pack(const table& all, kind& k, tree& to, std::uint32_t tag) {
        for (const std::uint32_t id : k.tail) keys_.push(id);
        k.tail.clear();
        spare_.resize(keys_.size());
        const auto get = [&](std::uint32_t id) { return box_of(all, id); };
        morton_sort<D>(keys_.begin(), spare_.begin(), keys_.size(), get);
        to.build(keys_.size(), [&](std::uint32_t i) { return static_cast<std::uint32_t>(keys_[i]); }, get);
        for (std::uint32_t i = 0; i < keys_.size(); ++i) {
            const auto id = static_cast<std::uint32_t>(keys_[i]);
            places_[id] = tag | i;
            if (all.moved(id)) to.mark(i);
        }
    }
    void pack_young(const table& all, kind& k) {
        keys_.clear();
        gather(k.young);
        pack(all, k, k.young, young_place);
    }
    void pack_all(const table& all, kind& k) {
        keys_.clear();
        gather(k.main);
        gather(k.young);
        k.young.clear();
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
            for (int i = 0; i < D; ++i)
                origin_[i] += S(static_cast<double>(box.lower[i] * 0.5f + box.upper[i] * 0.5f));
            for (kind& k : kinds_) pack_all(all, k);
        }
    }

    /// The pairs of a marked box of x with a box of y; where y's is marked as well, from the side of the earlier leaf.
    template <class Emit>
    void find_pairs(const tree& x, const tree& y, order y_is, bool all_marked, Emit&& emit) {
        for (std::uint32_t l = 0; l < x.leaves(); ++l) {
            const std::uint32_t moved = x.marked(l);
            if (moved == 0) continue;
            const float_box<D> reach = moved == 0xffu ? x.around(l) : x.around(l, moved);
            const auto& leaf = x.leaf(l);
            y.search(
                y_is == same && all_marked ? l : 0, [&](const auto& block) { return block.overlapping(reach); },
                [&](std::uint32_t m, std::uint32_t near) {
                    const auto& other = y.leaf(m);
                    const bool itself = y_is == same && m == l;
                    const std::uint32_t twice =
                        y_is == after || (y_is == same && m > l) ? 0 : y.marked(m);
                    near &= ~(itself ? 0 : twice);
                    if (near == 0) return;
                    each_bit(moved & leaf.overlapping(y.around(m)), [&](std::uint32_t i) {
                        std::uint32_t met = near & other.overlapping(leaf.get(i));
                        if (itself) met &= ~(moved & ((2u << i) - 1)) & ~(1u << i);
                        each_bit(met, [&](std::uint32_t k) { emit(x.id(l * 8 + i), y.id(m * 8 + k)); });
                    });
                });
        }
    }

    kind kinds_[2];
    /// By proxy: a place in the main tree, in the young one or in the tail of its kind.
    buffer<std::uint32_t> places_;
    typename Space::vec origin_{};
    buffer<std::uint64_t> keys_, spare_;
    buffer<std::uint32_t> touched_;
};

}  // namespace detail

PHYSICS_HPP_END
