// The slow, obviously right broadphase: every box against every other.
#pragma once

#include "physics/broadphase/indexed.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// No index: all boxes, one by one.
template <class Space>
class no_index {
public:
    using table = proxies<Space>;

    void insert(const table&, std::uint32_t) {}
    void erase(const table&, std::uint32_t) {}
    void update(const table&, const std::uint32_t*, std::uint32_t) {}
    template <class Emit>
    bool find(const table& all, Emit&& emit) const {
        for (const std::uint32_t a : all.changed())
            for (std::uint32_t b = 0; b < all.size() && all.has(a); ++b)
                if (all.has(b) && a != b && !(all.stale(b) && b < a)) emit(a, b);
        return false;
    }
    template <class Visit>
    void each_near(const table& all, const typename Space::aabb&, Visit&& visit) const {
        for (std::uint32_t id = 0; id < all.size(); ++id)
            if (all.has(id) && !visit(id)) return;
    }
};

}  // namespace detail

/// Tests what has left its box against all others: the oracle of the other broadphases. No memory but the boxes; from a
/// few dozen boxes on the others are faster. Cost: 2 to 4 ns a test; insert, move and erase O(1), queries O(n).
struct all_pairs {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = indexed_broadphase<Space, detail::no_index<Space>>;
};

PHYSICS_HPP_END
