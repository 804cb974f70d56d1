// Laws of where memories of pairs are kept: nothing is lost, and what is free is used again.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "cell.hpp"

namespace {
namespace pair_stores_laws {

using S = cell::scalar;
constexpr int D = cell::dimension;
template <class Narrowphase>
struct by : physics::recipe<S, D, Narrowphase> {};
template <class Narrowphase>
using store_of = physics::detail::pair_cache<typename physics::detail::plan_of<by<Narrowphase>>::type>;
using memory = physics::pair_memory<S, D>;
using gathered = physics::persistent_manifold<S, D>;
using physics::proxy_pair;

inline physics::vec<S, D> random_vec(cell::dice& dice) {
    physics::vec<S, D> v;
    for (int i = 0; i < D; ++i) v[i] = dice.real(-2, 2);
    return v;
}
inline physics::gjk_cache random_cache(cell::dice& dice) {
    physics::gjk_cache c;
    c.count = static_cast<std::uint8_t>(dice.below(D + 2));
    for (int i = 0; i < c.count; ++i) c.vertex[i] = static_cast<std::uint32_t>(dice.bits());
    for (float& x : c.axis) x = static_cast<float>(dice.number(-1, 1));
    return c;
}
inline memory random_memory(cell::dice& dice, const memory*) {
    memory m;
    m.contact.count = dice.below(physics::manifold<S, D>::capacity + 1);
    if (dice.below(2) == 0) m.cache = random_cache(dice);
    m.changed = true;
    if (m.contact.count == 0) {
        m.parting = dice.below(16) - 1;
        return m;
    }
    m.b_in_a.position = random_vec(dice);
    m.reach = dice.real(0, 1);
    m.reuse_distance = dice.real(0, 1);
    m.contact.normal = random_vec(dice);
    // What lies behind the last point means nothing.
    for (auto& p : m.contact.points) p = {random_vec(dice), dice.real(-1, 1), static_cast<std::uint32_t>(dice.bits())};
    return m;
}
inline gathered random_memory(cell::dice& dice, const gathered*) {
    gathered m;
    m.cache = random_cache(dice);
    m.named = static_cast<std::uint32_t>(dice.below(3));
    m.count = dice.below(physics::manifold<S, D>::capacity + 1);
    for (auto& p : m.points) p = {random_vec(dice), random_vec(dice), static_cast<std::uint32_t>(dice.bits())};
    if (m.named == 0) m.count = 0;
    return m;
}
inline bool same(const physics::gjk_cache& a, const physics::gjk_cache& b) {
    bool equal = a.count == b.count;
    for (int i = 0; i < 4; ++i) equal = equal && (i >= a.count || a.vertex[i] == b.vertex[i]);
    for (int i = 0; i < 3; ++i) equal = equal && !(a.axis[i] != b.axis[i]);
    return equal;
}
inline bool same(const memory& a, const memory& b) {
    bool equal = same(a.cache, b.cache) && a.contact.count == b.contact.count;
    if (a.contact.count == 0) return equal && a.parting == b.parting;
    equal = equal && a.b_in_a == b.b_in_a && a.reach == b.reach && a.reuse_distance == b.reuse_distance &&
            a.contact.normal == b.contact.normal;
    for (int i = 0; i < a.contact.count; ++i)
        equal = equal && a.contact.points[i].position == b.contact.points[i].position &&
                a.contact.points[i].separation == b.contact.points[i].separation &&
                a.contact.points[i].feature == b.contact.points[i].feature;
    return equal;
}
inline bool same(const gathered& a, const gathered& b) {
    bool equal = same(a.cache, b.cache) && a.named == b.named && a.count == b.count;
    for (int i = 0; i < a.count; ++i)
        equal = equal && a.points[i].on_a == b.points[i].on_a && a.points[i].on_b == b.points[i].on_b &&
                a.points[i].feature == b.points[i].feature;
    return equal;
}
template <class Store>
std::size_t bytes_of(const Store& of) {
    std::size_t sum = 0;
    physics::detail::each_value_of(of, [&](const auto& piece) {
        if constexpr (physics::detail::is_buffer<std::remove_cvref_t<decltype(piece)>>)
            sum += piece.size() * sizeof(*piece.begin());
    });
    return sum;
}

/// Changes a store and a map side by side. Now most pairs stay as they are, now most come and go.
template <class Narrowphase, class Memory>
void check_changes(std::uint64_t seed) {
    using store = store_of<Narrowphase>;
    using segment = typename store::segment;
    cell::dice dice(seed);
    store of, lists[2];
    std::map<std::pair<std::uint32_t, std::uint32_t>, Memory> known;
    std::size_t most = 0, most_pairs = 1;
    for (int round = 0; round < 60; ++round) {
        const int stay = round % 3 == 0 ? 2 : 16;
        const std::uint32_t shapes = round % 20 == 19 ? 2 : 24;
        for (store& list : lists) list.clear();
        std::vector<segment> parts;
        auto before = std::exchange(known, {});
        bool kept[600] = {};
        REQUIRE(of.size() <= 600);
        std::uint32_t at = 0;
        for (std::uint32_t a = 0; a < 24; ++a) {
            // Each worker's list has several parts.
            store& list = lists[a % 2];
            const std::uint32_t first = list.size();
            for (std::uint32_t b = a + 1; b < 24; ++b) {
                const auto was = before.find({a, b});
                const bool is_known = was != before.end();
                const std::uint32_t place = at;
                at += is_known;
                if (b >= shapes) continue;
                const int what = dice.below(stay);
                if (is_known && what > 0) {
                    kept[place] = true;
                    known.insert(*was);
                } else if (what < 2) {
                    Memory m = random_memory(dice, static_cast<const Memory*>(nullptr));
                    const std::uint32_t size = list.size();
                    list.add({a, b}, m);
                    if (list.size() > size) known.emplace(std::pair{a, b}, m);
                }
            }
            parts.push_back({&list, first, list.size()});
        }
        of.change(kept, parts.data(), static_cast<std::uint32_t>(parts.size()));
        if (round % 7 == 6) {
            const auto gone = [](std::uint32_t shape) { return shape % 5 == 3; };
            of.drop(gone);
            std::erase_if(known, [&](const auto& one) { return gone(one.first.first) || gone(one.first.second); });
        }
        REQUIRE(of.size() == known.size());
        std::uint32_t i = 0;
        for (const auto& [pair, m] : known) {
            REQUIRE(of.pair(i) == proxy_pair{pair.first, pair.second});
            REQUIRE(of.find(of.pair(i)) == i);
            REQUIRE(same(of[i++], m));
        }
        most_pairs = most_pairs < known.size() ? known.size() : most_pairs;
        most = most < bytes_of(of) ? bytes_of(of) : most;
        if (known.empty()) CHECK(bytes_of(of) == 0);
    }
    // Places are used again: rounds take no more than the largest of them, in several sizes.
    CHECK(most <= 3 * most_pairs * (sizeof(Memory) + 16));
}
CELL_CASE("pair stores: what is remembered comes back as it was, whatever comes and goes beside it") {
    for (std::uint64_t seed = 1; seed < 4; ++seed) {
        check_changes<physics::best_per_pair, memory>(seed);
        check_changes<physics::incremental_manifolds, gathered>(seed);
    }
}

CELL_CASE("pair stores: pairs that do not touch keep a number or an axis, others no more than there is") {
    store_of<physics::best_per_pair> of;
    memory nothing, parted, axis, one;
    of.add({0, 1}, nothing);
    CHECK(of.size() == 0);
    parted.parting = 7;
    of.add({0, 1}, parted);
    CHECK(bytes_of(of) == 12);
    axis.cache.axis[0] = 1;
    of.add({0, 2}, axis);
    CHECK(bytes_of(of) <= 24 + 4 + sizeof axis.cache);
    one.contact.count = 1;
    of.add({0, 3}, one);
    CHECK(bytes_of(of) <= 24 + 4 + sizeof axis.cache + sizeof one - sizeof axis.cache + 12);
}

/// A brick wall, long at rest.
CELL_CASE("pair stores: a step at rest hands nothing on but what lasts") {
    physics::world<by<physics::best_per_pair>> w({.sleeping = {.enabled = false}});
    const auto ground = w.create_body({.type = physics::body_type::static_body});
    static_cast<void>(w.create_shape(ground, physics::halfspace<S, D>{}));
    for (int i = 0; i < 20; ++i) {
        physics::vec<S, D> at{};
        at[0] = S(1.0625 * (i % 5));
        at[1] = S(0.5 + i / 5);
        const physics::box<S, D> brick{physics::vec<S, D>::filled(S(0.5))};
        static_cast<void>(w.create_shape(w.create_body({.position = at}), brick));
    }
    for (int i = 0; i < 120; ++i) w.step(S(1.0 / 60));
    auto& s = physics::detail::world_access::data_of(w);
    const std::uint32_t before = s.memories.size();
    std::uint32_t changed = 0;
    for (int i = 0; i < 10; ++i) {
        w.step(S(1.0 / 60));
        changed += s.step.pair_cache_changes.by[0].size();
    }
    if (D == 3) CHECK(before > 15);
    CHECK(changed <= before);
}

}  // namespace pair_stores_laws
}  // namespace
