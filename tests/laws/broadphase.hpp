// Laws of broadphases: every pair of boxes that overlap, once, in order, whatever came before.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "reals.hpp"

template class physics::all_pairs::in<cell::space>;

namespace {

using aabb = cell::space::aabb;
using broadphase = physics::all_pairs::in<cell::space>;
using pair_list = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

static_assert(physics::broadphase_for<broadphase, cell::space>);

/// What a broadphase should know: the boxes by number, compared one by one.
struct plain_broadphase {
    std::map<std::uint32_t, aabb> boxes;

    template <class Accept>
    pair_list pairs(Accept&& accept) const {
        pair_list result;
        for (auto a = boxes.begin(); a != boxes.end(); ++a)
            for (auto b = std::next(a); b != boxes.end(); ++b) {
                bool apart = false;
                for (int i = 0; i < D; ++i)
                    apart = apart || a->second.upper[i] < b->second.lower[i] || b->second.upper[i] < a->second.lower[i];
                if (!apart && accept(a->first, b->first)) result.emplace_back(a->first, b->first);
            }
        return result;
    }
};

template <class Accept>
pair_list pairs_of(const broadphase& b, Accept&& accept) {
    physics::buffer<physics::proxy_pair> found;
    found.push({7, 7});  // what was there before goes
    b.pairs(accept, found);
    pair_list result;
    for (const physics::proxy_pair& p : found) result.emplace_back(p.a, p.b);
    return result;
}
inline bool anything(std::uint32_t, std::uint32_t) { return true; }

/// Corners on a coarse lattice, so that boxes often just touch; some are flat, some endless.
inline aabb random_box(cell::dice& dice) {
    aabb box;
    for (int i = 0; i < D; ++i) {
        box.lower[i] = S(dice.below(12) * 0.5);
        box.upper[i] = box.lower[i] + S(dice.below(4) * 0.5);
    }
    if (dice.below(16) == 0) box.lower[dice.below(D)] = -(cell::traits::max() * S(0.25));
    return box;
}

CELL_CASE("broadphase: agrees with a comparison of all boxes through any history") {
    std::size_t met = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        cell::dice dice(seed);
        broadphase tested;
        plain_broadphase plain;
        for (int round = 0; round < 60; ++round) {
            for (int i = 0; i < 12; ++i) {
                // Few numbers, so that they are used again.
                const auto id = static_cast<std::uint32_t>(dice.below(40));
                const aabb box = random_box(dice);
                if (plain.boxes.count(id) == 0) {
                    tested.insert(id, box);
                    plain.boxes[id] = box;
                } else if (dice.below(3) > 0) {
                    tested.move(id, box);
                    plain.boxes[id] = box;
                } else {
                    tested.erase(id);
                    plain.boxes.erase(id);
                }
            }
            REQUIRE(pairs_of(tested, anything) == plain.pairs(anything));
            const auto few = [](std::uint32_t a, std::uint32_t b) { return (a + b) % 3 == 0; };
            REQUIRE(pairs_of(tested, few) == plain.pairs(few));
            // A copy stands alone.
            broadphase copy = tested;
            REQUIRE(pairs_of(copy, anything) == plain.pairs(anything));
            if (!plain.boxes.empty()) copy.erase(plain.boxes.begin()->first);
            REQUIRE(pairs_of(tested, anything) == plain.pairs(anything));
        }
        met += plain.pairs(anything).size();
    }
    CHECK(met > 100);
}

CELL_CASE("broadphase: pairs ascend, each once, and the filter sees no others") {
    cell::dice dice(50);
    broadphase tested;
    // Many boxes in one place, entered backwards.
    for (std::uint32_t id = 60; id-- > 0;) tested.insert(id, aabb{vec::filled(S(id % 2 ? 0 : -1)), vec::filled(S(1))});
    pair_list asked;
    const pair_list found = pairs_of(tested, [&](std::uint32_t a, std::uint32_t b) {
        asked.emplace_back(a, b);
        return a % 2 == b % 2;
    });
    CHECK(asked.size() == 60 * 59 / 2);
    CHECK(found.size() == 2 * (30 * 29 / 2));
    for (const pair_list& list : {asked, found})
        for (std::size_t i = 0; i < list.size(); ++i) {
            REQUIRE(list[i].first < list[i].second);
            if (i > 0) REQUIRE(list[i - 1] < list[i]);
        }
}

CELL_CASE("broadphase: empty, alone, and boxes that share only a face, an edge or a corner") {
    broadphase tested;
    CHECK(pairs_of(tested, anything).empty());
    tested.insert(3, aabb{vec{}, vec::filled(S(1))});
    CHECK(pairs_of(tested, anything).empty());
    for (int n = 1; n < (cell::is_2d ? 4 : 8); ++n) {
        vec at;
        for (int i = 0; i < D; ++i) at[i] = S(n >> i & 1);
        tested.insert(5, aabb{at, at + vec::filled(S(1))});
        CHECK(pairs_of(tested, anything) == pair_list{{3, 5}});
        for (int i = 0; i < D; ++i)
            if (n >> i & 1) at[i] += cell::traits::epsilon() * S(2);
        tested.move(5, aabb{at, at + vec::filled(S(1))});
        CHECK(pairs_of(tested, anything).empty());
        tested.erase(5);
        CHECK(pairs_of(tested, anything).empty());
    }
}

}  // namespace
