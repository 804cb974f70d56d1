// Sweep and prune: boxes in order along one axis.
#pragma once

#include "physics/broadphase/axis_order.hpp"
#include "physics/broadphase/block_scan.hpp"
#include "physics/broadphase/indexed.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Movable proxies and the others in an order each. What has just come waits in a tail, searched one by one, until
/// the next update.
template <class Space>
class sweep_index : public block_scan<sweep_index<Space>, Space> {
public:
    using S = typename Space::scalar;
    static constexpr int D = Space::dimension;
    using table = proxies<Space>;
    using box = float_box<D>;
    using order = axis_order<D>;

    void insert(const table& all, std::uint32_t id) {
        if (id >= places_.size()) places_.resize(id + 1);
        kind& k = kinds_[all.is_movable(id)];
        places_[id] = unsorted_place | k.unsorted.size();
        k.unsorted.push_back(id);
        if (k.unsorted.size() > 64 + k.order.live() / 4) sort(all, k);
    }
    void erase(const table& all, std::uint32_t id) {
        kind& k = kinds_[all.is_movable(id)];
        const std::uint32_t slot = places_[id] & ~unsorted_place;
        if (places_[id] == slot) {
            k.order.remove(slot);
        } else {
            k.unsorted[slot] = k.unsorted.back();
            places_[k.unsorted[slot]] = unsorted_place | slot;
            k.unsorted.pop_back();
        }
    }
    void update(const table& all, const std::uint32_t* ids, std::uint32_t count) {
        for (int m = 0; m < 2; ++m) {
            kind& k = kinds_[m];
            const auto ours = [&](std::uint32_t id) { return all.has(id) && all.is_movable(id) == (m == 1); };
            std::uint32_t moves = k.unsorted.size();
            for (std::uint32_t i = 0; i < count; ++i) moves += ours(ids[i]);
            bool sorted = moves < k.too_many && k.order.live() + k.order.live() / 4 + 64 > k.order.size() &&
                          k.since_sorted < 32 * (std::uint64_t{k.order.live()} + 64);
            k.since_sorted += moves;
            // So much work in small steps costs as much as to sort everything.
            std::uint32_t left = 4 * k.order.size() + 64;
            const auto spend = [&](std::uint32_t steps) {
                left = left > steps + 1 ? left - steps - 1 : 0;
                if (left == 0) k.too_many = moves;
                return left > 0;
            };
            while (!k.unsorted.empty() && (sorted = sorted && k.order.has_room())) {
                const std::uint32_t id = k.unsorted.back();
                k.unsorted.pop_back();
                sorted = spend(k.order.insert(id, box_of(all, id), left, at()));
            }
            for (std::uint32_t i = 0; i < count && sorted; ++i)
                if (ours(ids[i])) sorted = spend(k.order.move(places_[ids[i]], box_of(all, ids[i]), left, at()));
            // Now and then it is worth another try.
            if (!sorted && k.too_many < 1u << 30) k.too_many += k.too_many / 16 + 1;
            if (sorted) k.order.finish_order();
            else if (moves > 0 || k.order.size() > 0) sort(all, k);
        }
    }

    /// See tree_index: the pairs of which one at least has moved.
    template <class Emit>
    bool find(const table& all, Emit&& emit) {
        std::uint32_t moved[2] = {0, 0};
        for (kind& k : kinds_) {
            // Some are left where the caller threw out of the last search.
            if (searching_) k.moved.clear();
            k.moved.resize(k.order.blocks());
        }
        searching_ = true;
        for (const std::uint32_t id : all.changed()) {
            if (!all.has(id)) continue;
            mark(all, id, true);
            ++moved[all.is_movable(id)];
        }
        kind &fixed = kinds_[0], &movable = kinds_[1];
        const bool everything = moved[1] == movable.order.live();
        std::uint32_t guess = 0;
        if (moved[1] > 0)
            each_moved(movable, [&](std::uint32_t slot) {
                const box own = movable.order[slot / 8].get(slot % 8);
                const auto meet = [&](const order& other, std::uint32_t b, std::uint32_t lanes) {
                    each_bit(lanes, [&](std::uint32_t lane) { emit(movable.order.id(slot), other.id(b * 8 + lane)); });
                };
                movable.order.sweep(slot, own,
                                    [&](std::uint32_t b, std::uint32_t lanes) { meet(movable.order, b, lanes); });
                // Those before it that have moved have swept over it.
                if (!everything)
                    movable.order.search(own, slot / 8 + 1, [&](std::uint32_t b) {
                        std::uint32_t wanted = ~std::uint32_t{movable.moved[b]} & 0xffu;
                        if (b == slot / 8) wanted &= (1u << slot % 8) - 1;
                        if (wanted != 0) meet(movable.order, b, wanted & movable.order[b].overlapping(own));
                        return true;
                    });
                guess = fixed.order.begun(own.upper[fixed.order.axis()], guess);
                fixed.order.search(own, guess, [&](std::uint32_t b) {
                    meet(fixed.order, b, fixed.order[b].overlapping(own));
                    return true;
                });
            });
        if (moved[0] > 0)
            each_moved(fixed, [&](std::uint32_t slot) {
                const box own = fixed.order[slot / 8].get(slot % 8);
                guess = movable.order.begun(own.upper[movable.order.axis()], guess);
                movable.order.search(own, guess, [&](std::uint32_t b) {
                    each_bit(movable.order[b].overlapping(own) & ~std::uint32_t{movable.moved[b]},
                             [&](std::uint32_t lane) { emit(fixed.order.id(slot), movable.order.id(b * 8 + lane)); });
                    return true;
                });
            });
        for (const std::uint32_t id : all.changed())
            if (all.has(id)) mark(all, id, false);
        searching_ = false;
        return everything;
    }

    template <class Visit>
    void each_near(const table&, const typename Space::aabb& near, Visit&& visit) const {
        const box reach = enclosing(near, origin_);
        bool on = true;
        each_loose([&](std::uint32_t id) { on = on && visit(id); });
        each_eight(reach, [&](const auto& block, auto&& id_of) {
            each_bit(on ? block.overlapping(reach) : 0, [&](std::uint32_t lane) { on = on && visit(id_of(lane)); });
            return on;
        });
    }
    template <class Visit>
    void each_along(const table&, const ray<S, D>& r, S limit, Visit&& visit) const {
        const float_ray<D> fast_ray(r, origin_);
        float reach = above(limit) + fast_ray.step, near[8];
        const auto see = [&](std::uint32_t id) { reach = above(visit(id)) + fast_ray.step; };
        each_loose(see);
        box near_translation;
        for (int i = 0; i < D; ++i) {
            const double from = static_cast<double>(r.origin[i]) - static_cast<double>(origin_[i]);
            const double to = from + static_cast<double>(r.translation[i]);
            const double low = from < to ? from : to, high = from < to ? to : from;
            // The exact test may round a fraction, and take what is a little beside the way.
            const double room = (high - low) * static_cast<double>(fast_ray.step) + static_cast<double>(r.extent[i]) +
                                ((low < 0 ? -low : low) + (high < 0 ? -high : high)) * 1e-6;
            near_translation.lower[i] = to_float(low - room);
            near_translation.upper[i] = to_float(high + room);
        }
        each_eight(near_translation, [&](const auto& block, auto&& id_of) {
            each_bit(fast_ray.meets(block, reach, near), [&](std::uint32_t lane) { see(id_of(lane)); });
            return !(reach < 0);
        });
    }

    // For block_scan.
    template <class F>
    void each_eight(F&& f) const {
        for (const kind& k : kinds_)
            for (std::uint32_t b = 0; b < k.order.blocks(); ++b)
                if (!f(k.order[b], [&](std::uint32_t lane) { return k.order.id(b * 8 + lane); })) return;
    }
    template <class F>
    void each_eight(const box& near, F&& f) const {
        for (const kind& k : kinds_)
            k.order.search(near, k.order.begun(near.upper[k.order.axis()], 0), [&](std::uint32_t b) {
                return f(k.order[b], [&](std::uint32_t lane) { return k.order.id(b * 8 + lane); });
            });
    }
    [[nodiscard]] float usual_size() const { return kinds_[1].order.usual_size(); }
    template <class F>
    void each_loose(F&& f) const {
        for (const kind& k : kinds_)
            for (const std::uint32_t id : k.unsorted) f(id);
    }
    [[nodiscard]] const typename Space::vec& origin() const { return origin_; }

    PHYSICS_HPP_MEMBERS(kinds_, places_, origin_, searching_)

private:
    static constexpr std::uint32_t unsorted_place = 1u << 31;

    struct kind {
        detail::axis_order<D> order;
        buffer<std::uint32_t> unsorted;
        /// So many moves at once have been too many for small steps.
        std::uint32_t too_many = 1u << 31;
        /// Moves in small steps: after many, another axis may be better.
        std::uint64_t since_sorted = 0;
        /// Scratch: by block, a bit for each box that has moved; all 0 but while pairs are searched.
        step_scratch<buffer<std::uint8_t>> moved;

        PHYSICS_HPP_MEMBERS(order, unsorted, too_many, since_sorted, moved)
    };

    box box_of(const table& all, std::uint32_t id) const { return enclosing(all.box(id), origin_); }
    auto at() {
        return [&](std::uint32_t id, std::uint32_t slot) { places_[id] = slot; };
    }
    void sort(const table& all, kind& k) {
        for (const std::uint32_t id : k.unsorted) k.order.add(id);
        k.unsorted.clear();
        k.since_sorted = 0;
        k.order.sort([&](std::uint32_t id) { return box_of(all, id); }, at());
        if (&k == &kinds_[1]) follow(all);
    }
    /// Moves the origin to where the movable proxies are, once that is far away for a float.
    void follow(const table& all) {
        if constexpr (!std::is_same_v<S, float>) {
            const order& movable = kinds_[1].order;
            if (movable.live() == 0) return;
            bool far = false;
            for (int i = 0; i < D; ++i) {
                const float middle = movable.middle(i);
                far = far || max(middle, -middle) > 64 * max(movable.usual_size(), movable.width());
            }
            if (!far) return;
            for (int i = 0; i < D; ++i) origin_[i] += S(static_cast<double>(movable.middle(i)));
            for (kind& k : kinds_) k.order.sort([&](std::uint32_t id) { return box_of(all, id); }, at());
        }
    }
    void mark(const table& all, std::uint32_t id, bool value) {
        std::uint8_t& bits = kinds_[all.is_movable(id)].moved[places_[id] / 8];
        bits = static_cast<std::uint8_t>(value ? bits | 1u << places_[id] % 8 : 0u);
    }
    template <class F>
    static void each_moved(const kind& k, F&& f) {
        for (std::uint32_t b = 0; b < k.moved.size(); ++b)
            each_bit(k.moved[b], [&](std::uint32_t lane) { f(b * 8 + lane); });
    }

    kind kinds_[2];
    /// By proxy: its slot in the order of its kind, or in the tail.
    buffer<std::uint32_t> places_;
    typename Space::vec origin_{};
    /// Whether the scratch of kinds is in use, or was left so.
    bool searching_ = false;
};

}  // namespace detail

/// Boxes in order along the axis on which they are spread widest, swept eight at a time in float lanes: for worlds
/// that are long and narrow, such as side-scrollers, roads and corridors: there it takes up to a sixth less time than
/// dynamic_tree, above all where few move. What moves a little stays near its place in the
/// order (insertion sort), what jumps costs no more than sorting everything (radix sort). Movable proxies and the
/// others have orders of their own; resting ones cost nothing.
/// Choose another where a world of thousands is as wide as it is long: what is passed over in a sweep grows with the
/// root of their number, in a cube with its power of 2/3.
/// Cost of a step, for each proxy that left its box: in a corridor 80 to 150 ns, however long; in a square of 10,000
/// or 100,000 100 or 200 ns, in a cube 0.4 or 1.7 us (dynamic_tree: 80 or 100 ns, 0.2 or 0.3 us). What comes costs up
/// to 3 ns a proxy in the world. Rays and boxes: all boxes beside them along the axis, 3 to 10 times a tree's;
/// each_inside looks at all.
/// Source: Baraff, Dynamic simulation of non-penetrating rigid bodies (1992); Cohen, Lin, Manocha, Ponamgi, I-COLLIDE
/// (1995); Ericson, Real-time collision detection (2005), 7.5.
struct sweep_and_prune {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = indexed_broadphase<Space, detail::sweep_index<Space>>;
};

PHYSICS_HPP_END
