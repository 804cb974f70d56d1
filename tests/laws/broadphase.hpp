// Laws of broadphases: every pair of boxes that overlap, once, in order, whatever came before.
#pragma once

#include <set>

#include "crowds.hpp"

namespace {
namespace broadphase_laws {

using pair_list = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

inline pair_list listed(const physics::buffer<physics::proxy_pair>& found) {
    pair_list result;
    for (const physics::proxy_pair& p : found) result.emplace_back(p.a, p.b);
    return result;
}
inline bool anything(std::uint32_t, std::uint32_t) { return true; }

/// Every pair by comparison of all boxes, margins included.
template <class Accept>
pair_list all_pairs_of(const crowd& c, Accept&& accept) {
    pair_list result;
    for (auto a = c.members.begin(); a != c.members.end(); ++a)
        for (auto b = std::next(a); b != c.members.end(); ++b)
            if (share_a_point(a->second.wide, b->second.wide) && allowed(a->second.filter, b->second.filter) &&
                accept(a->first, b->first))
                result.emplace_back(a->first, b->first);
    return result;
}

/// What every broadphase has to find of a crowd, step by step: all meet the same one, so that boxes are compared once.
struct expectations {
    struct step {
        pair_list now, begun, ended;
    };
    std::vector<step> steps;

    const step& at(std::size_t i, const crowd& c, const std::set<std::uint32_t>& slot_reused) {
        if (i < steps.size()) return steps[i];
        step s{all_pairs_of(c, anything), {}, {}};
        const pair_list before = steps.empty() ? pair_list{} : steps.back().now;
        // What is given up in between ends, even where the same number pairs anew.
        const auto is_given_up = [&](const auto& p) {
            return slot_reused.count(p.first) + slot_reused.count(p.second) > 0;
        };
        const auto has = [](const pair_list& list, const auto& p) {
            return std::binary_search(list.begin(), list.end(), p);
        };
        for (const auto& p : s.now)
            if (!has(before, p) || is_given_up(p)) s.begun.push_back(p);
        for (const auto& p : before)
            if (!has(s.now, p) || is_given_up(p)) s.ended.push_back(p);
        steps.push_back(std::move(s));
        return steps.back();
    }
};

/// What has to be true after a step of a crowd.
template <class Broadphase>
void check_step(Broadphase& tested, const crowd& c, const expectations::step& expected) {
    REQUIRE(listed(tested.pairs(anything)) == expected.now);
    REQUIRE(listed(tested.begun()) == expected.begun);
    REQUIRE(listed(tested.ended()) == expected.ended);
    REQUIRE(tested.count() == c.members.size());
}

CELL_CASE("broadphase: the pairs are those that a comparison of all boxes finds, on every kind of crowd") {
    for (const layout kind : layouts) {
        CAPTURE(static_cast<int>(kind));
        for (const double share : {1.0, 0.2, 0.02}) {
            CAPTURE(share);
            expectations expected;
            each_broadphase([&](auto policy, const char* name) {
                using broadphase = typename decltype(policy)::template in<cell::space>;
                CAPTURE(name);
                cell::dice dice(60);
                crowd c(kind, 120, dice);
                broadphase tested;
                for (const auto& [id, m] : c.members) tested.insert(id, m.box, m.filter);
                check_step(tested, c, expected.at(0, c, {}));
                for (std::size_t step = 1; step <= 80; ++step) {
                    c.move(share, dice, [&](std::uint32_t id, const aabb& box, const vec& displacement) {
                        tested.move(id, box, displacement);
                        // Queries may see it at once, which changes nothing.
                        if (step % 5 == 1) tested.update();
                    });
                    check_step(tested, c, expected.at(step, c, {}));
                }
            });
        }
    }
}

CELL_CASE("broadphase: through any history of coming, going and moving, with numbers that come again") {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        expectations expected;
        each_broadphase([&](auto policy, const char* name) {
            using broadphase = typename decltype(policy)::template in<cell::space>;
            CAPTURE(name);
            cell::dice dice(seed);
            crowd c(layout::uniform, 0, dice);
            broadphase tested;
            for (std::size_t round = 0; round < 60; ++round) {
                std::set<std::uint32_t> slot_reused;
                for (int i = 0, n = dice.below(round % 20 == 0 ? 200 : 12); i < n; ++i) {
                    const auto id = static_cast<std::uint32_t>(dice.below(160));
                    if (c.members.count(id) == 0) {
                        c.add(id, dice);
                        tested.insert(id, c.members[id].box, c.members[id].filter);
                    } else if (dice.below(3) > 0) {
                        c.move_one(id, dice, [&](std::uint32_t k, const aabb& box, const vec& displacement) {
                            tested.move(k, box, displacement);
                        });
                    } else {
                        tested.erase(id);
                        c.members.erase(id);
                        slot_reused.insert(id);
                    }
                    if (dice.below(20) == 0) tested.update();
                }
                check_step(tested, c, expected.at(round, c, slot_reused));
                // A copy stands alone, and so does what it was copied from.
                if (round % 8 == 0) {
                    broadphase copy = tested;
                    if (!c.members.empty()) copy.erase(c.members.begin()->first);
                    copy.pairs(anything);
                    REQUIRE(listed(tested.pairs(anything)) == expected.steps[round].now);
                }
            }
        });
    }
}

CELL_CASE("broadphase: the caller is asked for pairs that the filters let through, and takes some") {
    each_broadphase([](auto policy, const char* name) {
        using broadphase = typename decltype(policy)::template in<cell::space>;
        CAPTURE(name);
        broadphase tested;
        // Many boxes in one place, entered backwards; the even ones of one owner, the last three without mass.
        crowd c;
        for (std::uint32_t id = 60; id-- > 0;) {
            member& m = c.members[id];
            m.box = {vec::filled(S(id % 2 ? 0 : -1)), vec::filled(S(1))};
            m.filter.owner = id % 2 ? id : 1000;
            m.filter.movable = id < 57;
            c.widen(m, {});
            tested.insert(id, m.box, m.filter);
        }
        pair_list asked;
        const pair_list found = listed(tested.pairs([&](std::uint32_t a, std::uint32_t b) {
            asked.emplace_back(a, b);
            return (a + b) % 3 == 0;
        }));
        std::sort(asked.begin(), asked.end());
        CHECK(asked == all_pairs_of(c, anything));
        CHECK(found == all_pairs_of(c, [](std::uint32_t a, std::uint32_t b) { return (a + b) % 3 == 0; }));
        CHECK(found.size() > 300);
        // Nothing moves, nothing is asked.
        asked.clear();
        CHECK(listed(tested.pairs([&](std::uint32_t a, std::uint32_t b) {
                  asked.emplace_back(a, b);
                  return true;
              })) == found);
        CHECK(asked.empty());
        CHECK(tested.begun().empty());
        CHECK(tested.ended().empty());
    });
}

CELL_CASE("broadphase: empty, alone, and boxes that share only a face, an edge or a corner") {
    each_broadphase([](auto policy, const char* name) {
        using broadphase = typename decltype(policy)::template in<cell::space>;
        CAPTURE(name);
        broadphase tested;
        tested.configure({S(0), S(0)});
        CHECK(listed(tested.pairs(anything)).empty());
        tested.insert(3, aabb{vec{}, vec::filled(S(1))});
        CHECK(listed(tested.pairs(anything)).empty());
        for (int n = 1; n < (cell::is_2d ? 4 : 8); ++n) {
            vec at;
            for (int i = 0; i < D; ++i) at[i] = S(n >> i & 1);
            tested.insert(5, aabb{at, at + vec::filled(S(1))});
            CHECK(listed(tested.pairs(anything)) == pair_list{{3, 5}});
            for (int i = 0; i < D; ++i)
                if (n >> i & 1) at[i] += cell::traits::epsilon() * S(2);
            tested.move(5, aabb{at, at + vec::filled(S(1))});
            CHECK(listed(tested.pairs(anything)).empty());
            tested.erase(5);
            CHECK(listed(tested.pairs(anything)).empty());
        }
    });
}

CELL_CASE("broadphase: within its margins a proxy is left alone") {
    each_broadphase([](auto policy, const char* name) {
        using broadphase = typename decltype(policy)::template in<cell::space>;
        CAPTURE(name);
        broadphase tested;
        tested.configure({S(0.25), S(2)});
        const aabb unit{vec{}, vec::filled(S(1))};
        tested.insert(0, unit);
        CHECK(tested.box(0) == grown(unit, S(0.25)));
        const auto moved = [](aabb box, double by) {
            box.lower.x += S(by);
            box.upper.x += S(by);
            return box;
        };
        vec displacement;
        displacement.x = S(0.125);
        tested.move(0, moved(unit, 0.25), displacement);
        CHECK(tested.box(0) == grown(unit, S(0.25)));
        // Out of them, it gets new ones, and twice the last move ahead.
        tested.move(0, moved(unit, 0.375), displacement);
        aabb expected = grown(moved(unit, 0.375), S(0.25));
        expected.upper.x += S(0.25);
        CHECK(tested.box(0) == expected);
        // A teleport is no velocity: no farther ahead than the box is wide, and its margin.
        displacement.x = S(-100);
        tested.move(0, moved(unit, -100), displacement);
        expected = grown(moved(unit, -100), S(0.25));
        expected.lower.x -= S(1.25);
        CHECK(tested.box(0) == expected);
    });
}

CELL_CASE("broadphase: bad calls are refused by name, and change nothing") {
    each_broadphase([](auto policy, const char* name) {
        using broadphase = typename decltype(policy)::template in<cell::space>;
        CAPTURE(name);
        broadphase tested;
        const aabb unit{vec{}, vec::filled(S(1))};
        tested.insert(0, unit);
        tested.insert(1, unit);
        aabb inverted = unit;
        inverted.lower.y = S(2);
        const char* wrong_way = "lower.y is 2; it must not be greater than upper";
        CHECK_THROWS_WITH(tested.insert(2, inverted), (std::string("physics: insert: ") + wrong_way).c_str());
        CHECK_THROWS_WITH(tested.move(1, inverted), (std::string("physics: move: ") + wrong_way).c_str());
        CHECK_THROWS_WITH(tested.insert(1, unit), "physics: insert: id is 1; it must not be in use");
        CHECK_THROWS_WITH(tested.move(2, unit), "physics: move: id is 2; it must have been inserted");
        CHECK_THROWS_WITH(tested.erase(7), "physics: erase: id is 7; it must have been inserted");
        CHECK_THROWS_WITH(tested.configure({S(-1), S(0)}),
                          "physics: configure: broadphase.margin is -1; it must not be negative");
        if constexpr (!cell::is_fixed) {
            for (const double bad : {std::nan(""), HUGE_VAL}) {
                aabb box = unit;
                box.upper.x = cell::real(bad);
                CHECK_THROWS(tested.insert(2, box));
                CHECK_THROWS(tested.move(1, box));
            }
        }
        CHECK(tested.count() == 2);
        CHECK(listed(tested.pairs(anything)) == pair_list{{0, 1}});
        // While a query runs, nothing may change; afterwards it may.
        for (int call = 0; call < 4; ++call)
            tested.each_overlapping(unit, {}, [&](std::uint32_t) {
                const char* while_queried = "broadphase is being queried; it must not change until the query has ended";
                const auto is = [&](const char* f) { return std::string("physics: ") + f + ": " + while_queried; };
                if (call == 0) CHECK_THROWS_WITH(tested.erase(0), is("erase").c_str());
                if (call == 1) CHECK_THROWS_WITH(tested.insert(9, unit), is("insert").c_str());
                if (call == 2) CHECK_THROWS_WITH(tested.update(), is("update").c_str());
                if (call == 3) CHECK_THROWS_WITH(tested.pairs(anything), is("pairs").c_str());
                broadphase other;
                other.insert(0, unit);
            });
        tested.erase(0);
        CHECK(listed(tested.pairs(anything)).empty());
    });
}

CELL_CASE("broadphase: a thousand boxes in one place, in a line in order, and through each other") {
    each_broadphase([](auto policy, const char* name) {
        using broadphase = typename decltype(policy)::template in<cell::space>;
        CAPTURE(name);
        const auto few = [](std::uint32_t a, std::uint32_t b) { return a + 1 == b; };
        broadphase heap, line;
        for (std::uint32_t id = 0; id < 1000; ++id) {
            heap.insert(id, aabb{vec{}, vec::filled(S(1))});
            vec at;
            at.x = S(static_cast<int>(id));
            line.insert(id, aabb{at, at + vec::filled(S(1))});
        }
        CHECK(heap.pairs(few).size() == 999);
        CHECK(line.pairs(anything).size() == 999 + 0);
        for (std::uint32_t id = 0; id < 1000; id += 2) heap.erase(id);
        CHECK(heap.pairs(few).empty());
        // Every one moves to the other end of the line.
        for (std::uint32_t id = 0; id < 1000; ++id) {
            vec at;
            at.x = S(static_cast<int>(2000 - id));
            line.move(id, aabb{at, at + vec::filled(S(1))});
        }
        CHECK(line.pairs(anything).size() == 999);
    });
}

}  // namespace broadphase_laws
}  // namespace
