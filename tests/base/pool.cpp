// Slots with generations: against a map of what has ever been inserted.
#include <doctest/doctest.h>

#include <physics/base/pool.hpp>

#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace {

using pool = physics::pool<std::uint64_t>;
using name = std::pair<std::uint32_t, std::uint16_t>;

name insert(pool& p, std::uint64_t value) {
    const pool::place place = p.insert(value);
    return {place.index, place.generation};
}

}  // namespace

TEST_CASE("pool: long random sequences agree with a map; no name is given twice") {
    std::mt19937_64 engine(3);
    for (int round = 0; round < 10; ++round) {
        pool p;
        std::map<name, std::uint64_t> alive;
        std::set<name> ever;
        for (int i = 0; i < 3000; ++i) {
            // Grows at first, then shrinks, then both.
            const std::uint64_t odds = i < 1000 ? 75 : i < 2000 ? 30 : 50;
            if (alive.empty() || engine() % 100 < odds) {
                const std::uint64_t value = engine();
                const name id = insert(p, value);
                REQUIRE(ever.insert(id).second);
                alive[id] = value;
            } else {
                auto victim = alive.begin();
                std::advance(victim, static_cast<std::ptrdiff_t>(engine() % alive.size()));
                p.erase(victim->first.first);
                alive.erase(victim);
            }
            REQUIRE(p.count() == alive.size());
        }
        for (const name& id : ever) {
            const auto found = alive.find(id);
            CHECK(p.contains(id.first, id.second) == (found != alive.end()));
            if (found == alive.end()) continue;
            CHECK(p.alive(id.first));
            CHECK(p.generation(id.first) == id.second);
            CHECK(p[id.first] == found->second);
        }
        std::vector<std::uint32_t> order;
        p.each([&](std::uint32_t i, std::uint64_t& value) {
            order.push_back(i);
            CHECK(alive.at({i, p.generation(i)}) == value);
        });
        std::vector<std::uint32_t> expected;
        for (const auto& [id, value] : alive) expected.push_back(id.first);
        CHECK(order == expected);
        CHECK_FALSE(p.contains(p.slots(), 1));
        CHECK_FALSE(p.contains(0xffffffffu, 0));
    }
}

TEST_CASE("pool: the last slot that was freed is used first; slots depend on the calls alone") {
    pool p;
    for (std::uint32_t i = 0; i < 8; ++i) CHECK(insert(p, i) == name(i, std::uint16_t{1}));
    p.erase(2);
    p.erase(5);
    pool q = p;
    for (pool* each : {&p, &q}) {
        CHECK(insert(*each, 0) == name(5, std::uint16_t{2}));
        CHECK(insert(*each, 0) == name(2, std::uint16_t{2}));
        CHECK(insert(*each, 0) == name(8, std::uint16_t{1}));
    }
}

TEST_CASE("pool: a slot whose generations are used up retires, so that no stale name comes alive") {
    pool p;
    insert(p, 0);
    for (int i = 1; i < 0xffff; ++i) {
        p.erase(0);
        REQUIRE(insert(p, 0) == name(0, static_cast<std::uint16_t>(i + 1)));
    }
    p.erase(0);
    CHECK(p.count() == 0);
    CHECK_FALSE(p.alive(0));
    CHECK(p.next(0) == p.slots());
    CHECK(insert(p, 0) == name(1, std::uint16_t{1}));
    for (int generation = 0; generation <= 0xffff; ++generation)
        REQUIRE_FALSE(p.contains(0, static_cast<std::uint16_t>(generation)));
}

TEST_CASE("pool: copies are separate, a moved-from pool is empty and serves again") {
    pool p;
    for (std::uint32_t i = 0; i < 8; ++i) insert(p, i);
    p.erase(3);
    pool q = p;
    q[0] = 7;
    CHECK(p[0] == 0);
    pool r = std::move(p);
    CHECK(r.count() == 7);
    CHECK(p.count() == 0);
    CHECK(p.slots() == 0);
    CHECK(insert(p, 5) == name(0, std::uint16_t{1}));
    p = std::move(q);
    CHECK(p[0] == 7);
    CHECK(q.count() == 0);
    CHECK(insert(q, 5) == name(0, std::uint16_t{1}));
    CHECK(insert(p, 5) == name(3, std::uint16_t{2}));
}
