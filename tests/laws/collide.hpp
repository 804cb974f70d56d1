// Laws of contact: against signed distances, for every pair of shapes in both orders.
#pragma once

#include "distances.hpp"
#include "hard_pairs.hpp"
#include "manifolds.hpp"
#include "segments.hpp"

template struct physics::manifold<cell::scalar, cell::dimension>;

namespace {
namespace collide_laws {

/// Draws pairs near touching: every kind, size, proportion and alignment that has been trouble somewhere. Each
/// draw is a statement of its own, since the order within one is the compiler's.
struct encounters {
    cell::dice dice;
    double size = 1;

    /// Many orders of magnitude, evenly.
    double small() { return std::pow(10, dice.number(-8, -2)); }
    double sign() { return dice.below(2) ? 1 : -1; }

    any_shape shape(int kind) {
        if (kind == 2 && dice.below(4) == 0) {
            // A plate or a needle.
            vec half = dice.vec<vec>(0.3 * size, size);
            const int thin = dice.below(D);
            half[thin] = dice.real(size / 1000, size / 100);
            return box{half};
        }
        if (kind == 1 && dice.below(4) == 0)
            return capsule{dice.real(0.5 * size, size), dice.real(size / 1000, size / 20)};
        return random_shape(kind, dice, 0.1 * size, size);
    }
    /// In line with the axes, nearly so, by simple angles, or any.
    rotation turn() {
        const double angles[] = {0, M_PI / 4, M_PI / 2, M_PI, 2 * M_PI / 3};
        const int displacement = dice.below(4);
        if (displacement == 0) return random_rotation(dice);
        reals axis;
        axis[cell::is_2d ? 2 : dice.below(3)] = 1;
        if (cell::is_3d && dice.below(3) == 0) axis = unit(reals{1, 1, 1});
        double angle = angles[dice.below(5)];
        if (displacement == 1) angle = 0;
        const rotation first = turned(rotation{}, to_angular(axis * angle));
        if (displacement < 3) return first;
        const double about = small() * sign(), aside = small();
        return turned(turned(first, to_angular(axis * about)), to_angular(random_axis(dice) * aside));
    }
    reals direction(const pose& at) {
        const pose frame;
        const int displacement = dice.below(5);
        const reals of_a = frame.axis[dice.below(D)], of_b = at.axis[dice.below(D)] * sign();
        reals n = random_direction(dice);
        if (displacement == 0) n = of_a;
        if (displacement == 1) n = of_b;
        if (displacement == 2 && cell::is_3d) n = cross(of_a, of_b);
        if (displacement == 3) n = of_a + of_b;
        if (::size(n) < 1e-3) n = frame.axis[0];
        return unit(n) * sign();
    }
    double gap() {
        switch (dice.below(6)) {
            case 0: return 0;
            case 1: {
                const double hair = small() * size;
                return hair * sign();
            }
            case 2: return dice.number(-0.1, 0.1) * size;
            case 3: return dice.number(-1, 0) * size;
            default: return dice.number(-0.02, 0.06) * size;
        }
    }
    encounter draw(int kind_a, int kind_b, double larger = 1) {
        encounter e{shape(kind_a), scaled(shape(kind_b), larger), {{}, turn()}, S(0.04 * size)};
        const figure a = to_figure(e.a), b = to_figure(e.b);
        const pose at = to_pose(e.b_in_a);
        reals p;
        if (a.endless || b.endless) {
            const reals n = a.endless ? a.normal : -at.rotate(b.normal);
            p = n * (gap() - separation_along(a, b, at, n));
        } else {
            const reals n = direction(at);
            const double touching = a.reach(n) + b.reach(at.unrotate(n));
            p = n * (touching + gap());
            const int within = dice.below(16);
            if (within == 0) p = {};
            if (within == 1) p = n * (touching * dice.number(0, 1));
        }
        // Aside: not at all, a hair, or anywhere.
        const double aside[] = {0, small() * size, 0.5 * size, size};
        const double away = aside[dice.below(4)];
        reals q = random_direction(dice) * away;
        if (a.endless) q = q - a.normal * dot(q, a.normal);
        if (b.endless) q = q - at.rotate(b.normal) * dot(q, at.rotate(b.normal));
        e.b_in_a.position = from_reals(p + q);
        return e;
    }
};

CELL_CASE("oracle: no direction parts the shapes better than the signed distance says, and some do as well") {
    encounters draw{cell::dice(100)};
    for (int i = 0; i < 200; ++i) {
        const int kind_a = draw.dice.below(3), kind_b = draw.dice.below(3);
        const encounter e = draw.draw(kind_a, kind_b);
        const figure a = to_figure(e.a), b = to_figure(e.b);
        const pose at = to_pose(e.b_in_a);
        const double exact = signed_distance(a, b, at);
        double best_of_all = -HUGE_VAL;
        for (int start = 0; start < 12; ++start) {
            double best = -HUGE_VAL;
            reals direction;
            const auto consider = [&](reals n) {
                const double s = separation_along(a, b, at, n);
                if (s > best) best = s, direction = n;
            };
            for (int k = 0; k < 12; ++k) consider(random_direction(draw.dice));
            // Closer and closer around the best one.
            for (double step = 0.5; step > 1e-7; step *= 0.9)
                for (int k = 0; k < 4; ++k) consider(unit(direction + random_direction(draw.dice) * step));
            best_of_all = std::fmax(best_of_all, best);
        }
        REQUIRE(best_of_all <= exact + 1e-9);
        REQUIRE(best_of_all >= exact - 1e-3);
    }
}

/// Draws pairs of every two kinds in both orders, and hands them to a check that returns a complaint.
template <class Check>
void every_pair(encounters draw, int times, double larger, Check&& check) {
#ifdef CELL_NARROWPHASE_IN_DOUBLE
    times = cell::draws(times);
#endif
    for (int a = 0; a < kinds; ++a)
        for (int b = 0; b < kinds; ++b) {
            if (a == 3 && b == 3) continue;
            CAPTURE(a);
            CAPTURE(b);
            bool good = true;
            for (int i = 0; i < times && good; ++i) {
                const std::string said = check(draw.draw(a, b, larger));
                good = said.empty();
                CHECK_MESSAGE(good, said);
            }
        }
}

CELL_CASE("collide: manifolds agree with signed distances") { every_pair({cell::dice(101)}, 6000, 1, complaint); }

CELL_CASE("collide: so they do at every scale") {
    const int powers = cell::is_fixed ? 2 : 3;
    for (int power = -powers; power <= powers; ++power) {
        CAPTURE(power);
        every_pair({cell::dice(102), std::pow(10, power)}, 400, 1, complaint);
    }
}

CELL_CASE("collide: so do big and small") {
    every_pair({cell::dice(103)}, 600, 200, complaint);
    every_pair({cell::dice(104)}, 600, 0.005, complaint);
}

CELL_CASE("collide: deviations on purpose are rare") {
    encounters draw{cell::dice(105)};
    int met = 0, exact = 0;
    for (int i = 0; i < 6000; ++i) {
        const int kind_a = 1 + draw.dice.below(2), kind_b = 1 + draw.dice.below(2);
        const encounter e = draw.draw(kind_a, kind_b);
        const manifold m = collide(e);
        if (m.count == 0) continue;
        const figure a = to_figure(e.a), b = to_figure(e.b);
        const pose at = to_pose(e.b_in_a);
        const double best = signed_distance(a, b, at), along = separation_along(a, b, at, unit(to_reals(m.normal)));
        ++met;
        exact += std::abs(along - best) <= rounding(e, a, b) && std::abs(deepest(m) - best) <= rounding(e, a, b);
    }
    CHECK(met > 2000);
    CHECK(exact > met * 9 / 10);
}

CELL_CASE("collide: swapping the shapes mirrors the contact") {
    every_pair({cell::dice(106)}, 1000, 1, [](const encounter& e) -> std::string {
        const encounter turned_round{e.b, e.a, inverse(e.b_in_a), e.margin};
        const std::string law = complaint(turned_round);
        if (!law.empty()) return law;
        const figure a = to_figure(e.a), b = to_figure(e.b);
        const manifold first = collide(e), n = collide(turned_round);
        const double tolerance = 2 * rounding(e, a, b), allowed = tolerance + 2 * deliberate(e, a, b);
        if (first.count == 0 || n.count == 0) return "";
        if (std::abs(deepest(first) - deepest(n)) > allowed)
            return text_of("depths differ", deepest(first), deepest(n)) + text_of(e);
        // Of one kind, either may lead where both are alike; of two kinds, one order is made of the other.
        if (e.a.kind() == e.b.kind()) return "";
        encounter again = e;
        again.b_in_a = inverse(turned_round.b_in_a);
        const bool turned_first = e.a.kind() > e.b.kind();
        const manifold m = turned_first ? first : collide(again);
        if (m.count != n.count) return text_of("counts differ", m.count, n.count) + text_of(e);
        const pose at = to_pose(e.b_in_a);
        if (!near(m.normal, -at.rotate(to_reals(n.normal)), 32)) return "the normals differ" + text_of(e);
        for (int i = 0; i < m.count; ++i) {
            if (m.points[i].feature != n.points[i].feature) return "the features differ" + text_of(e);
            const double apart = size(to_reals(m.points[i].position) - at.apply(to_reals(n.points[i].position)));
            if (apart > tolerance) return text_of("the points differ", apart, i) + text_of(e);
        }
        return "";
    });
}

CELL_CASE("collide: only sizes relative to each other count") {
    if (cell::is_fixed) return;
    every_pair({cell::dice(107)}, 500, 1, [](const encounter& e) -> std::string {
        const manifold m = collide(e);
        // By a power of two nothing is rounded differently, so every bit agrees.
        for (const int power : {-24, -7, 9, 24}) {
            const S factor = cell::real(std::ldexp(1.0, power));
            encounter larger{scaled(e.a, std::ldexp(1.0, power)), scaled(e.b, std::ldexp(1.0, power)), e.b_in_a,
                             e.margin * factor};
            larger.b_in_a.position *= factor;
            const manifold n = collide(larger);
            bool same = m.count == n.count && (m.count == 0 || m.normal == n.normal);
            // But for what is so small beside the shapes that it leaves the range at one of the scales.
            const auto alike = [&](vec a, vec b) { return a == b || size(to_reals(a - b)) < 1e-30; };
            for (int i = 0; i < m.count && same; ++i)
                same = alike(m.points[i].position * factor, n.points[i].position) &&
                       m.points[i].separation * factor == n.points[i].separation &&
                       m.points[i].feature == n.points[i].feature;
            if (!same) return text_of("another contact at another scale", power, 0) + text_of(e);
        }
        return "";
    });
}

CELL_CASE("collide: the pair may be anywhere in the world") {
    for (const double far : {1.0, 1024.0}) {
        encounters draw{cell::dice(108)};
        for (int i = 0; i < 3000; ++i) {
            const int kind_a = draw.dice.below(4), kind_b = draw.dice.below(3);
            const encounter e = draw.draw(kind_a, kind_b);
            const transform world_a{draw.dice.vec<vec>(-far, far), random_rotation(draw.dice)};
            encounter moved = e;
            moved.b_in_a = relative(world_a, world_a * e.b_in_a);
            const std::string law = complaint(moved);
            REQUIRE_MESSAGE(law.empty(), law);
            const manifold m = collide(e), n = collide(moved);
            if (m.count == 0 || n.count == 0) continue;
            const figure a = to_figure(e.a), b = to_figure(e.b);
            const double allowed = 4 * rounding(e, a, b) + 2 * deliberate(e, a, b) + 16 * epsilon * far;
            REQUIRE(std::abs(deepest(m) - deepest(n)) <= allowed);
        }
    }
}

}  // namespace collide_laws
}  // namespace
