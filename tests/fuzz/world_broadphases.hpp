// All broadphases of the library as one, chosen as a world is made: one recipe serves to compare them.
#pragma once

#include "input.hpp"

namespace fuzz {

enum class broadphase_kind : std::uint32_t { dynamic_tree, sweep_and_prune, hash_grid, grid, all_pairs };
inline constexpr int broadphase_kinds = 5;
/// Of the worlds that are made from now on.
inline broadphase_kind next_broadphase = broadphase_kind::dynamic_tree;

template <class Space>
class any_broadphase_in {
    using aabb = typename Space::aabb;
    using vec = typename Space::vec;
    using S = typename Space::scalar;

public:
    void configure(const physics::broadphase_settings<S>& settings) {
        with(*this, [&](auto& b) { b.configure(settings); });
    }
    void reserve(std::uint32_t slots, std::uint32_t changes) {
        with(*this, [&](auto& b) { b.reserve(slots, changes); });
    }
    bool insert(std::uint32_t id, const aabb& box, const physics::proxy_filter& filter = {}) {
        return with(*this, [&](auto& b) { return b.insert(id, box, filter); });
    }
    bool erase(std::uint32_t id) {
        return with(*this, [&](auto& b) { return b.erase(id); });
    }
    bool move(std::uint32_t id, const aabb& box, const vec& displacement = {}) {
        return with(*this, [&](auto& b) { return b.move(id, box, displacement); });
    }
    void update() {
        with(*this, [](auto& b) { b.update(); });
    }
    template <class Accept>
    const physics::buffer<physics::proxy_pair>& pairs(Accept&& accept) {
        return with(
            *this, [&](auto& b) -> const auto& { return b.pairs(accept); });
    }
    template <class Accept>
    const physics::buffer<physics::proxy_pair>& pairs(Accept&& accept, physics::arena& scratch) {
        return with(
            *this, [&](auto& b) -> const auto& { return b.pairs(accept, scratch); });
    }
    [[nodiscard]] const aabb& box(std::uint32_t id) const {
        return with(*this, [&](auto& b) -> const aabb& { return b.box(id); });
    }
    template <class Visit>
    void each_overlapping(const aabb& box, const physics::query_filter& filter, Visit&& visit,
                          bool movable = true) const {
        with(*this, [&](auto& b) { b.each_overlapping(box, filter, visit, movable); });
    }
    template <class Visit>
    void each_along(const physics::ray<S, Space::dimension>& r, const physics::query_filter& filter,
                    Visit&& visit) const {
        with(*this, [&](auto& b) { b.each_along(r, filter, visit); });
    }

    PHYSICS_HPP_MEMBERS(kind_, tree_, sweep_, hashed_, dense_, none_)

private:
    template <class Self, class F>
    static decltype(auto) with(Self& self, F&& f) {
        switch (self.kind_) {
            case broadphase_kind::dynamic_tree: return f(self.tree_);
            case broadphase_kind::sweep_and_prune: return f(self.sweep_);
            case broadphase_kind::hash_grid: return f(self.hashed_);
            case broadphase_kind::grid: return f(self.dense_);
            default: return f(self.none_);
        }
    }

    broadphase_kind kind_ = next_broadphase;
    physics::dynamic_tree::in<Space> tree_;
    physics::sweep_and_prune::in<Space> sweep_;
    physics::hash_grid::in<Space> hashed_;
    physics::grid::in<Space> dense_;
    physics::all_pairs::in<Space> none_;
};

struct any_broadphase {
    using stage = physics::stage::broadphase;

    template <class Space>
    using in = any_broadphase_in<Space>;
};

}  // namespace fuzz
