// The slow, obviously right broadphase: every box against every other.
#pragma once

#include "physics/broadphase/concept.hpp"

PHYSICS_HPP_BEGIN

/// Tests every pair of boxes: the oracle of the other broadphases, and the fastest for a few dozen boxes.
/// Cost: insert, move and erase O(1), pairs O(n^2), about 1 ns a test.
struct all_pairs {
    using stage = physics::stage::broadphase;

    template <class Space>
    class in {
    public:
        using aabb = typename Space::aabb;

        void insert(std::uint32_t id, const aabb& box) {
            if (id >= entries_.size()) entries_.resize(id + 1);
            entries_[id] = {box, true};
        }
        void move(std::uint32_t id, const aabb& box) { entries_[id].box = box; }
        void erase(std::uint32_t id) { entries_[id].used = false; }

        template <class Accept>
        void pairs(Accept&& accept, buffer<proxy_pair>& out) const {
            out.clear();
            for (std::uint32_t a = 0; a < entries_.size(); ++a) {
                if (!entries_[a].used) continue;
                for (std::uint32_t b = a + 1; b < entries_.size(); ++b)
                    if (entries_[b].used && overlap(entries_[a].box, entries_[b].box) && accept(a, b)) out.push({a, b});
            }
        }

    private:
        struct entry {
            aabb box;
            bool used = false;
        };
        buffer<entry> entries_;
    };
};

PHYSICS_HPP_END
