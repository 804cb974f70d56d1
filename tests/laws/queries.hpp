// Laws of queries: every broadphase gives the answers that a look at all boxes gives, exactly.
#pragma once

#include <numeric>

#include "crowds.hpp"

namespace {
namespace queries_laws {

using ray = physics::ray<S, D>;
using hit = physics::proxy_hit<S>;
using plane = physics::bounding_plane<S, D>;
using ids = std::vector<std::uint32_t>;
/// The one to compare with: it looks at all boxes, by the same exact tests, which have laws of their own below.
using looks_at_all = physics::all_pairs::in<cell::space>;

/// A crowd that has lived a little in a broadphase; some have moved since it last looked for pairs.
template <class Broadphase>
Broadphase lived_in(crowd& c, cell::dice& dice) {
    Broadphase b;
    for (const auto& [id, m] : c.members) b.insert(id, m.box, m.filter);
    const auto tell = [&](std::uint32_t id, const aabb& box, const vec& displacement) {
        b.move(id, box, displacement);
    };
    for (int step = 0; step < 6; ++step) {
        c.move(step % 2 ? 1 : 0.05, dice, tell);
        if (step == 3) b.pairs([](std::uint32_t, std::uint32_t) { return true; });
        b.update();
    }
    const auto add = [&](std::uint32_t first, std::uint32_t end) {
        for (std::uint32_t id = first; id < end; ++id) {
            c.add(id, dice);
            b.insert(id, c.members[id].box, c.members[id].filter);
        }
    };
    // Strangers that have moved, few enough that a tree keeps them apart, and some that no update has seen.
    add(500, 512);
    for (std::uint32_t id = 500; id < 512; id += 2) c.move_one(id, dice, tell);
    b.update();
    add(512, 530);
    for (const std::uint32_t gone : {3u, 505u, 529u}) {
        b.erase(gone);
        c.members.erase(gone);
    }
    return b;
}
/// Two broadphases with the same crowd, the second of which looks at all.
template <class Policy, class Check>
void with_crowds(Policy, Check&& check) {
    for (const layout kind : layouts) {
        CAPTURE(static_cast<int>(kind));
        cell::dice dice(70), again(70);
        crowd c(kind, 150, dice), same(kind, 150, again);
        const auto tested = lived_in<typename Policy::template in<cell::space>>(c, dice);
        const auto plain = lived_in<looks_at_all>(same, again);
        REQUIRE(c.members.size() == same.members.size());
        check(tested, plain, c, dice);
    }
}
inline ids sorted(ids list) {
    std::sort(list.begin(), list.end());
    return list;
}
/// Somewhere among the boxes, often exactly at a corner of one.
inline vec place_in(const crowd& c, cell::dice& dice) {
    auto m = c.members.begin();
    std::advance(m, dice.below(static_cast<int>(c.members.size())));
    const int displacement = dice.below(3);
    if (displacement == 0) return m->second.wide.lower;
    if (displacement == 1) return m->second.wide.upper;
    const vec aside = dice.vec<vec>(-3, 3);
    vec at = m->second.box.upper;
    return at += aside;
}
inline physics::query_filter filter_in(cell::dice& dice) {
    physics::query_filter f;
    if (dice.below(3) == 0) f.mask = static_cast<std::uint32_t>(dice.below(16));
    if (dice.below(3) == 0) f.category = 1u << dice.below(4);
    if (dice.below(3) == 0) f.kinds = static_cast<physics::body_kinds>(dice.below(8));
    f.any_category = dice.below(6) == 0;
    f.sensors = dice.below(2) == 0;
    if (dice.below(3) == 0) f.except.index = static_cast<std::uint32_t>(dice.below(6));
    return f;
}
inline bool is_seen(const physics::proxy_filter& p, const physics::query_filter& by) {
    const bool by_category = by.any_category || ((p.category & by.mask) && (p.mask & by.category));
    const bool left_out = by.except.index != 0xffffffffu && by.except.index == p.owner;
    return by_category && (by.kinds & p.kinds) != 0 && !left_out && (by.sensors || !p.sensor);
}

CELL_CASE("queries: boxes and points find what a comparison of all boxes finds") {
    each_broadphase([](auto policy, const char* name) {
        CAPTURE(name);
        std::size_t found = 0;
        with_crowds(policy, [&](const auto& tested, const auto&, const crowd& c, cell::dice& dice) {
            for (int i = 0; i < 60; ++i) {
                const vec at = place_in(c, dice), size = dice.vec<vec>(0, 4);
                const physics::query_filter filter = filter_in(dice);
                const aabb box = i % 2 ? aabb{at, at + size} : aabb{at, at};
                ids here, expected;
                const auto add = [&](std::uint32_t id) { here.push_back(id); };
                if (i % 2) tested.each_overlapping(box, filter, add);
                else tested.each_at(at, filter, add);
                for (const auto& [id, m] : c.members)
                    if (share_a_point(m.wide, box) && is_seen(m.filter, filter)) expected.push_back(id);
                REQUIRE(sorted(here) == expected);
                found += here.size();
                ids page(1 + here.size() / 2), whole(here.size() + 1);
                REQUIRE(tested.overlapping(box, filter, page.data(), static_cast<std::uint32_t>(page.size())) ==
                        here.size());
                REQUIRE(tested.overlapping(box, filter, whole.data(), static_cast<std::uint32_t>(whole.size())) ==
                        here.size());
                whole.pop_back();
                REQUIRE(sorted(whole) == expected);
            }
        });
        CHECK(found > 500);
    });
}

CELL_CASE("queries: rays and swept boxes meet the same, at the same fractions, whatever the index") {
    each_broadphase([](auto policy, const char* name) {
        CAPTURE(name);
        std::size_t found = 0;
        with_crowds(policy, [&](const auto& tested, const auto& plain, const crowd& c, cell::dice& dice) {
            for (int i = 0; i < 80; ++i) {
                ray r{place_in(c, dice), {}};
                const vec to = place_in(c, dice);
                r.translation = to - r.origin;
                // Huge ways, along axes, and none at all.
                for (int k = 0; k < D; ++k)
                    if (r.translation[k] > S(1000) || r.translation[k] < S(-1000)) r.translation[k] = S(0);
                if (i % 4 == 1) r.translation[dice.below(D)] = S(0);
                if (i % 16 == 2) r.translation = {};
                // Ways so short along an axis that the origin's number does not change.
                if (i % 8 == 3) r.translation[dice.below(D)] = cell::real(i % 16 == 3 ? 1e-20 : -1e-40);
                if (i % 3 == 0) r.extent = dice.vec<vec>(0, 1);
                const physics::query_filter filter = filter_in(dice);
                const auto all_hits = [&](const auto& b) {
                    std::map<std::uint32_t, S> hits;
                    b.each_along(r, filter, [&](const hit& h) {
                        REQUIRE(hits.count(h.id) == 0);
                        hits[h.id] = h.fraction;
                        return S(1);
                    });
                    return hits;
                };
                const auto hits = all_hits(tested);
                REQUIRE(hits == all_hits(plain));
                found += hits.size();
                const hit first = tested.closest(r, filter);
                REQUIRE(bool(first) == !hits.empty());
                REQUIRE(tested.any(r, filter) == !hits.empty());
                for (const auto& [id, fraction] : hits) {
                    REQUIRE(fraction >= S(0));
                    REQUIRE(fraction <= S(1));
                    REQUIRE((first.fraction < fraction || (first.fraction == fraction && first.id <= id)));
                }
                if (first) REQUIRE(hits.at(first.id) == first.fraction);
                // The first few in order.
                std::vector<std::pair<S, std::uint32_t>> in_order;
                for (const auto& [id, fraction] : hits) in_order.emplace_back(fraction, id);
                std::sort(in_order.begin(), in_order.end());
                hit few[3];
                const std::uint32_t count = tested.along(r, filter, few, 3);
                REQUIRE(count == std::min<std::size_t>(3, hits.size()));
                for (std::uint32_t k = 0; k < count; ++k)
                    REQUIRE((few[k].id == in_order[k].second && few[k].fraction == in_order[k].first));
            }
        });
        CHECK(found > 300);
    });
}

CELL_CASE("queries: the nearest few, in order, and none beyond reach") {
    each_broadphase([](auto policy, const char* name) {
        CAPTURE(name);
        with_crowds(policy, [&](const auto& tested, const auto&, const crowd& c, cell::dice& dice) {
            for (int i = 0; i < 40; ++i) {
                const vec at = place_in(c, dice);
                const physics::query_filter filter = filter_in(dice);
                const S reach = i % 3 == 0 ? dice.real(0, 3) : S(100);
                const std::uint32_t most = 1 + static_cast<std::uint32_t>(dice.below(12));
                std::vector<std::pair<physics::wide_of<S>, std::uint32_t>> expected;
                for (const auto& [id, m] : c.members) {
                    vec apart;
                    for (int k = 0; k < D; ++k) {
                        if (at[k] < m.wide.lower[k]) apart[k] = m.wide.lower[k] - at[k];
                        if (at[k] > m.wide.upper[k]) apart[k] = at[k] - m.wide.upper[k];
                    }
                    const auto square = length_squared(apart);
                    if (is_seen(m.filter, filter) && !(square > physics::product(reach, reach)))
                        expected.emplace_back(square, id);
                }
                std::sort(expected.begin(), expected.end(), [](const auto& a, const auto& b) {
                    return a.first < b.first || (a.first == b.first && a.second < b.second);
                });
                if (expected.size() > most) expected.resize(most);
                ids nearest(most);
                nearest.resize(tested.nearest(at, reach, filter, nearest.data(), most));
                REQUIRE(nearest.size() == expected.size());
                for (std::size_t k = 0; k < nearest.size(); ++k) REQUIRE(nearest[k] == expected[k].second);
            }
        });
    });
}

CELL_CASE("queries: a convex region holds all boxes that reach into it, and none wholly beyond one of its planes") {
    each_broadphase([](auto policy, const char* name) {
        CAPTURE(name);
        std::size_t found = 0;
        with_crowds(policy, [&](const auto& tested, const auto& plain, const crowd& c, cell::dice& dice) {
            for (int i = 0; i < 30; ++i) {
                const vec at = place_in(c, dice);
                std::vector<plane> planes;
                for (int k = 0, n = dice.below(7); k < n; ++k) {
                    const vec normal = from_reals(random_direction(dice) * (dice.below(2) ? 1 : 0.01));
                    // Through a place nearby; numbers far away may be too large for a product.
                    planes.push_back({normal, dot(normal, at) + dice.real(0, 2) * length(normal)});
                }
                const auto count = static_cast<std::uint32_t>(planes.size());
                ids here, expected;
                tested.each_inside(planes.data(), count, {}, [&](std::uint32_t id) { here.push_back(id); });
                plain.each_inside(planes.data(), count, {}, [&](std::uint32_t id) { expected.push_back(id); });
                REQUIRE(sorted(here) == sorted(expected));
                found += here.size();
            }
        });
        CHECK(found > 500);
    });
}

/// A box and a ray of small whole numbers; the answer is exact.
CELL_CASE("queries: rays through faces, edges and corners, in planes of faces, from within: as whole numbers say") {
    cell::dice dice(71);
    const auto whole = [&](int low, int high) { return low + dice.below(high - low + 1); };
    int met = 0;
    for (int i = 0; i < 20000; ++i) {
        int lower[3]{}, upper[3]{}, from[3]{}, displacement[3]{}, extent[3]{};
        aabb box;
        ray r{};
        for (int k = 0; k < D; ++k) {
            lower[k] = whole(-3, 2);
            upper[k] = whole(lower[k], 3);
            from[k] = whole(-5, 5);
            displacement[k] = dice.below(3) ? whole(-8, 8) : 0;
            extent[k] = i % 3 ? 0 : whole(0, 2);
            box.lower[k] = S(lower[k]);
            box.upper[k] = S(upper[k]);
            r.origin[k] = S(from[k]);
            r.translation[k] = S(displacement[k]);
            r.extent[k] = S(extent[k]);
        }
        // The largest entry and the smallest exit, as fractions of whole numbers.
        int near = 0, near_of = 1, far = 1, far_of = 1;
        bool meets = true;
        for (int k = 0; k < D; ++k) {
            const int to_lower = lower[k] - extent[k] - from[k], to_upper = upper[k] + extent[k] - from[k];
            if (displacement[k] == 0) {
                meets = meets && to_lower <= 0 && to_upper >= 0;
                continue;
            }
            const int of = std::abs(displacement[k]), in = displacement[k] > 0 ? to_lower : -to_upper;
            const int out = displacement[k] > 0 ? to_upper : -to_lower;
            if (in * near_of > near * of) near = in, near_of = of;
            if (out * far_of < far * of) far = out, far_of = of;
        }
        meets = meets && near * far_of <= far * near_of;
        each_broadphase([&](auto policy, const char* name) {
            CAPTURE(name);
            typename decltype(policy)::template in<cell::space> b;
            b.configure({S(0), S(0)});
            b.insert(0, box);
            const hit h = b.closest(r);
            // Also where the ray touches one corner: equal fractions round to equal numbers.
            REQUIRE(bool(h) == meets);
            if (h) REQUIRE(std::abs(cell::number(h.fraction) - double(near) / near_of) <= epsilon);
        });
        met += meets;
    }
    CHECK(met > 1000);
    CHECK(met < 17000);
}

CELL_CASE("queries: cases that other libraries were reported to get wrong") {
    each_broadphase([](auto policy, const char* name) {
        CAPTURE(name);
        typename decltype(policy)::template in<cell::space> b;
        b.configure({S(0), S(0)});
        const auto corner = [](double x, double y) { return from_reals({x, y, 0}); };
        b.insert(0, {corner(32, 32), corner(96, 96)});
        // Along the face, corner first.
        const hit along = b.closest({corner(16, 32), corner(240, 0)});
        CHECK(along.id == 0);
        CHECK(along.fraction == S(16) / S(240));
        // Ends exactly at the surface; begins there and leaves; stays there.
        CHECK(b.closest({corner(16, 50), corner(16, 0)}).fraction == S(1));
        CHECK(b.closest({corner(32, 50), corner(-5, 0)}).fraction == S(0));
        CHECK(b.any({corner(32, 50), {}}));
        CHECK(!b.any({corner(31, 50), {}}));
        CHECK(!b.any({corner(16, 50), corner(15, 0)}));
        // From within.
        CHECK(b.closest({corner(40, 40), corner(100, 3)}).fraction == S(0));
        if constexpr (!cell::is_fixed) {
            // As flat as a subnormal number.
            aabb flat{corner(0, -5000), corner(0, -5000)};
            flat.lower.x = flat.upper.x = cell::traits::max() * cell::real(1e-38) * cell::real(1e-38);
            b.insert(1, flat);
            CHECK(b.closest({corner(-5000, -5000), corner(0.7071, 0.7071)}).id == 0xffffffffu);
        }
        std::uint32_t seen = 0;
        for (std::uint32_t id = 10; id < 60; ++id) b.insert(id, {corner(0, 0), corner(1, 1)});
        b.each_at(corner(1, 1), {}, [&](std::uint32_t) { return ++seen < 5; });
        CHECK(seen == 5);
        seen = 0;
        b.each_along({corner(-1, -1), corner(8, 8)}, {}, [&](const hit&) { return ++seen < 5 ? S(1) : S(-1); });
        CHECK(seen == 5);
    });
}

CELL_CASE("queries: bad ones are refused by name") {
    each_broadphase([](auto policy, const char* name) {
        CAPTURE(name);
        typename decltype(policy)::template in<cell::space> b;
        b.insert(0, {vec{}, vec::filled(S(1))});
        ray r{vec{}, vec::filled(S(1))};
        r.extent.x = S(-1);
        CHECK_THROWS_WITH((void)b.any(r), "physics: each_along: extent is -1; it must not be negative");
        r.extent.x = S(0);
        r.origin.x = cell::traits::max();
        r.translation.x = cell::traits::max() / S(2);
        CHECK_THROWS((void)b.any(r));
        std::uint32_t out[1];
        CHECK_THROWS_WITH(b.nearest(vec{}, S(-2), {}, out, 1),
                          "physics: nearest: reach is -2; it must not be negative");
        CHECK_THROWS(b.each_overlapping({vec::filled(S(1)), vec{}}, {}, [](std::uint32_t) {}));
        if constexpr (!cell::is_fixed) {
            vec bad;
            bad.y = cell::real(std::nan(""));
            const plane p{bad, S(0)};
            CHECK_THROWS_WITH(b.each_at(bad, {}, [](std::uint32_t) {}),
                              "physics: each_at: point.y is nan; it must be finite");
            CHECK_THROWS_WITH(b.each_inside(&p, 1, {}, [](std::uint32_t) {}),
                              "physics: each_inside: normal.y is nan; it must be finite");
        }
    });
}

}  // namespace queries_laws
}  // namespace
