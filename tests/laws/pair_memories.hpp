// Laws of what a narrowphase remembers of pairs: it saves work, and contacts stay as right as without.
#pragma once

#include "convex_manifolds.hpp"

namespace {

/// A pair that is met again and again.
template <class Policy>
struct acquaintance {
    using narrowphase = convex_set::narrowphase<Policy>;

    typename narrowphase::memory memory{};

    convex_manifold meet(const convex_encounter& e, double margin) {
        convex_set::query q{&e.a.shape, &e.b.shape, e.b_in_a};
        if (narrowphase::remembers(e.a.shape.kind(), e.b.shape.kind())) q.memory = 0;
        physics::manifold_list<S, D> found;
        narrowphase::collide(&q, 1, S(margin), &memory, found);
        return found.empty() ? convex_manifold{} : found[0].contact;
    }
};
inline bool same(const convex_manifold& a, const convex_manifold& b) {
    bool equal = a.count == b.count && (a.count == 0 || a.normal == b.normal);
    for (int i = 0; equal && i < a.count; ++i)
        equal = a.points[i].position == b.points[i].position && a.points[i].separation == b.points[i].separation &&
                a.points[i].feature == b.points[i].feature;
    return equal;
}
inline double margin_of(const convex_encounter& e) { return 0.04 * std::fmin(e.a.extent(), e.b.extent()); }

/// Moves B by a part of the smaller one's thickness.
inline void nudge(convex_encounter& e, double part, cell::dice& dice) {
    const double by = part * std::fmin(e.a.thin(), e.b.thin());
    const reals displacement = random_direction(dice);
    e.b_in_a.position = from_reals(to_reals(e.b_in_a.position) + displacement * by);
    const double angle = dice.number(-1, 1) * by / e.b.extent();
    const auto turn = cell::is_2d ? rotation_about({0, 0, 1}, angle) : rotation_about(random_axis(dice), angle);
    e.b_in_a.rotation = normalized(turn * e.b_in_a.rotation);
}

CELL_CASE("pair memory: contacts that are carried along agree with distances, at any pace") {
    each_encounter(240, 2, [](convex_encounter e, meeting, cell::dice& dice) {
        acquaintance<physics::best_per_pair> pair;
        const double margin = margin_of(e), parts[] = {0, 1.0 / 4096, 1.0 / 1024, 1.0 / 600, 1.0 / 256, 1.0 / 16};
        const double pace = parts[dice.below(6)];
        for (int step = 0; step < 6; ++step) {
            const convex_manifold m = pair.meet(e, margin);
            const double exact = exact_gap(e), thin = std::fmin(e.a.thin(), e.b.thin());
            if (!std::isnan(exact)) {
                // What is carried may be as old as 1/512, and a normal turns about the far end of a shape.
                const std::string law = broken_law(e, m, margin, exact, thin / 64);
                CHECK_MESSAGE(law.empty(), step << ": " << law << text_of(e));
            }
            nudge(e, pace, dice);
        }
    });
}

CELL_CASE("pair memory: a pair that has not moved has the same contact, to the bit") {
    each_encounter(241, 2, [](convex_encounter e, meeting, cell::dice& dice) {
        acquaintance<physics::best_per_pair> pair;
        pair.meet(e, margin_of(e));
        nudge(e, 1.0 / 16, dice);
        const convex_manifold once = pair.meet(e, margin_of(e));
        CHECK_MESSAGE(same(pair.meet(e, margin_of(e)), once), text_of(e));
    });
}

CELL_CASE("pair memory: of pairs that do not touch it bears on no result") {
    each_encounter(242, 2, [](convex_encounter e, meeting, cell::dice& dice) {
        acquaintance<physics::best_per_pair> pair;
        const double margin = margin_of(e);
        // Approaching from where they are apart, with anything remembered of the way.
        const reals n = random_direction(dice);
        for (const double gap : {4.0, 2.0, 1.2}) {
            convex_encounter before = e;
            move_to(before, n, gap * margin);
            if (pair.meet(before, margin).count > 0) return;
        }
        const convex_manifold cold = acquaintance<physics::best_per_pair>{}.meet(e, margin);
        CHECK_MESSAGE(same(pair.meet(e, margin), cold), text_of(e));
    });
}

CELL_CASE("pair memory: what belongs to another pair parts no shapes that touch") {
    cell::dice dice(243);
    acquaintance<physics::gjk_epa> other;
    each_encounter(244, 1, [&](const convex_encounter& e, meeting, cell::dice&) {
        if (e.a.kind == of::ball && e.b.kind == of::ball) return;
        other.memory.contact.count = 0;
        const double margin = margin_of(e), exact = exact_gap(e);
        const convex_manifold m = other.meet(e, margin);
        if (std::isnan(exact)) return;
        const std::string law = broken_law(e, m, margin, exact);
        CHECK_MESSAGE(law.empty(), law << text_of(e));
    });
}

/// A box or a hull at rest on another: the manifold that grows by one point a step.
CELL_CASE("persistent manifolds: a face that rocks on another gathers points that span it, and keeps them") {
    const double half = 0.5, sunk = 1.0 / 256;
    convex_encounter e{body_of(box{vec::filled(S(half))}), body_of(box{vec::filled(S(half))}), {}};
    acquaintance<physics::incremental_manifolds> pair;
    cell::dice dice(245);
    convex_manifold m;
    for (int step = 0; step < 200; ++step) {
        const double angle = 1e-3 * dice.number(-1, 1);
        reals about = unit(reals{dice.number(-1, 1), 0, dice.number(-1, 1)});
        if (cell::is_2d) about = {0, 0, 1};
        e.b_in_a = {from_reals({0, 2 * half - sunk, 0}), rotation_about(about, angle)};
        m = pair.meet(e, 0.02);
        REQUIRE(m.count > 0);
        const double exact = exact_gap(e);
        CHECK(std::abs(deepest_of(m) - exact) < 64 * std::fmax(epsilon, 1e-11));
        CHECK(to_reals(m.normal).y > 0.99);
    }
    CHECK(m.count == convex_manifold::capacity);
    double lowest = HUGE_VAL, highest = -HUGE_VAL;
    for (int i = 0; i < m.count; ++i) {
        lowest = std::fmin(lowest, to_reals(m.points[i].position).x);
        highest = std::fmax(highest, to_reals(m.points[i].position).x);
    }
    CHECK(highest - lowest > 1.9 * half);

    const std::vector<std::uint32_t> names = feature_list(m);
    for (int step = 0; step < 20; ++step) CHECK(feature_list(pair.meet(e, 0.02)) == names);
    // Carried away sideways the points go, and none is left behind.
    e.b_in_a.position.x = S(0.75);
    m = pair.meet(e, 0.02);
    for (int i = 0; i < m.count; ++i) CHECK(to_reals(m.points[i].position).x > 0.2);
    e.b_in_a.position.y = S(2);
    CHECK(pair.meet(e, 0.02).count == 0);
}

CELL_CASE("persistent manifolds: at most one point comes a step, and each is on both shapes") {
    each_encounter(246, 1, [](convex_encounter e, meeting, cell::dice& dice) {
        acquaintance<physics::incremental_manifolds> pair;
        const double margin = margin_of(e);
        int before = 0;
        for (int step = 0; step < 4; ++step) {
            const convex_manifold m = pair.meet(e, margin);
            CHECK(m.count <= before + 1);
            before = m.count;
            const oracle::frame at = to_frame(e.b_in_a);
            const oracle::point n = wide(m.normal);
            const double allowed = 1e-6 * e.reach() + 0.25 * std::fmin(e.a.extent(), e.b.extent());
            for (int i = 0; i < m.count; ++i) {
                const double gap = cell::number(m.points[i].separation);
                const oracle::point p = wide(m.points[i].position);
                CHECK_MESSAGE(std::abs(e.a.distance(p - n * (gap / 2))) <= allowed, text_of(e));
                CHECK_MESSAGE(std::abs(e.b.distance(at.undo(p + n * (gap / 2)))) <= allowed, text_of(e));
            }
            nudge(e, 1.0 / 64, dice);
        }
    });
}

}  // namespace
