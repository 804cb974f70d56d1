// Boxes among the pairs of a narrowphase: met in lanes, and handed back to their places.
#pragma once

#include "physics/base/raw_array.hpp"
#include "physics/collide/pair_table.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

template <class Shape, class... Shapes>
constexpr bool is_among = (std::same_as<Shape, Shapes> || ...);

/// The manifolds of the pairs of boxes among some queries of a narrowphase.
template <pair_methods Methods, class S, int D, template <class, int> class... Shapes>
class box_batch {
    using table = pair_table<Methods, S, D, Shapes...>;
    using query = typename table::query;
    using memory = typename table::memory;
    using box = physics::box<S, D>;

public:
    static constexpr std::uint32_t capacity = 64;
    static constexpr bool is_used = Methods.closed_forms && !Methods.persistent && is_among<box, Shapes<S, D>...>;

    /// Meets the boxes among up to `capacity` queries.
    box_batch(const query* queries, std::uint32_t count, S margin, memory* memories) {
        constexpr int kind = table::any::template kind_of<box>();
        for (std::uint32_t i = 0; i < count; ++i) {
            const query& q = queries[i];
            const bool boxes = q.a->kind() == kind && q.b->kind() == kind;
            place_[i] = boxes ? place_of({&q.a->template get<box>(), &q.b->template get<box>(), &q.b_in_a},
                                         table::recalled(q, memories), margin)
                              : elsewhere;
        }
        if constexpr (D == 2) {
            collide_boxes(pairs_.items, met_, margin, found_.items);
        } else {
            raw_array<int, capacity> parting;
            collide_boxes(pairs_.items, met_, margin, found_.items, parting.items);
            for (std::uint32_t k = 0; k < met_; ++k) {
                if (owner_[k] == nullptr) continue;
                remember(*pairs_[k].a, *pairs_[k].b, *pairs_[k].b_in_a, found_[k], *owner_[k]);
                owner_[k]->parting = parting[k];
            }
        }
    }
    /// Whether query i is a pair of boxes, and adds its manifold to the list if it has one, under that number.
    bool add(std::uint32_t i, std::uint32_t number, manifold_list<S, D>& out) const {
        if (place_[i] == elsewhere) return false;
        if (place_[i] != apart && found_[place_[i]].count > 0) out.emplace_back(number, 0u, found_[place_[i]]);
        return true;
    }

private:
    static constexpr std::uint8_t elsewhere = 0xff, apart = 0xfe;

    std::uint8_t place_of(const box_pair<S, D>& pair, memory* m, S margin) {
        if constexpr (D == 3)
            if (m != nullptr) {
                if (is_still(*m, *pair.b_in_a)) {
                    // From behind: those that are met lie side by side.
                    manifold<S, D>& carried = found_[capacity - ++carried_];
                    carried = {};
                    carry_along(*m, *pair.b_in_a, margin, carried);
                    return static_cast<std::uint8_t>(capacity - carried_);
                }
                if (m->contact.count == 0 && m->parting >= 0 &&
                    separation_along(*pair.a, *pair.b, *pair.b_in_a, m->parting, margin))
                    return apart;
            }
        owner_[met_] = m;
        pairs_[met_] = pair;
        return static_cast<std::uint8_t>(met_++);
    }

    std::uint32_t met_ = 0, carried_ = 0;
    raw_array<std::uint8_t, capacity> place_;
    raw_array<memory*, capacity> owner_;
    raw_array<box_pair<S, D>, capacity> pairs_;
    raw_array<manifold<S, D>, capacity> found_;
};

}  // namespace detail

PHYSICS_HPP_END
