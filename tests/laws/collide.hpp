// Laws of contact: against signed distances, for every pair of shapes in both orders.
#pragma once

#include "distances.hpp"

template struct physics::manifold<cell::scalar, cell::dimension>;

namespace {

/// Draws pairs near touching: every kind, size, proportion and alignment that has been trouble somewhere.
struct encounters {
    cell::dice dice;
    double size = 1;

    /// Many orders of magnitude, evenly.
    double small() { return std::pow(10, dice.number(-8, -2)); }

    any_shape shape(int kind) {
        if (kind == 2 && dice.below(4) == 0) {
            // A plate or a needle.
            vec half = dice.vec<vec>(0.3 * size, size);
            half[dice.below(D)] = dice.real(size / 1000, size / 100);
            return box{half};
        }
        if (kind == 1 && dice.below(4) == 0)
            return capsule{dice.real(0.5 * size, size), dice.real(size / 1000, size / 20)};
        return random_shape(kind, dice, 0.1 * size, size);
    }
    /// In line with the axes, nearly so, by simple angles, or any.
    rotation turn() {
        const double angles[] = {0, M_PI / 4, M_PI / 2, M_PI, 2 * M_PI / 3};
        const int way = dice.below(4);
        if (way == 0) return random_rotation(dice);
        reals axis;
        axis[cell::is_2d ? 2 : dice.below(3)] = 1;
        if (cell::is_3d && dice.below(3) == 0) axis = unit(reals{1, 1, 1});
        double angle = angles[dice.below(5)];
        if (way == 1) angle = 0;
        if (way == 3) angle += (dice.below(2) ? 1 : -1) * small();
        const rotation first = turned(rotation{}, to_angular(axis * angle));
        if (way < 3) return first;
        return turned(first, to_angular(random_axis(dice) * small()));
    }
    reals direction(const pose& at) {
        const pose frame;
        const int way = dice.below(5);
        reals n = random_direction(dice);
        if (way == 0) n = frame.axis[dice.below(D)];
        if (way == 1) n = at.axis[dice.below(D)];
        if (way == 2 && cell::is_3d) n = cross(frame.axis[dice.below(3)], at.axis[dice.below(3)]);
        if (way == 3) n = frame.axis[dice.below(D)] + at.axis[dice.below(D)] * (dice.below(2) ? 1 : -1);
        if (::size(n) < 1e-3) n = frame.axis[0];
        return unit(n) * (dice.below(2) ? 1 : -1);
    }
    double gap() {
        switch (dice.below(6)) {
            case 0:
                return 0;
            case 1:
                return (dice.below(2) ? 1 : -1) * small() * size;
            case 2:
                return dice.number(-0.1, 0.1) * size;
            case 3:
                return dice.number(-1, 0) * size;
            default:
                return dice.number(-0.02, 0.06) * size;
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
            if (dice.below(8) == 0) p = n * (dice.below(2) ? 0 : touching * dice.number(0, 1));
        }
        // Aside: not at all, a hair, or anywhere.
        const double aside[] = {0, small() * size, 0.5 * size, size};
        reals q = random_direction(dice) * aside[dice.below(4)];
        if (a.endless) q = q - a.normal * dot(q, a.normal);
        if (b.endless) q = q - at.rotate(b.normal) * dot(q, at.rotate(b.normal));
        e.b_in_a.position = from_reals(p + q);
        return e;
    }
};

CELL_CASE("oracle: no direction parts the shapes better than the signed distance says, and some do as well") {
    encounters draw{cell::dice(100)};
    for (int i = 0; i < 300; ++i) {
        const encounter e = draw.draw(draw.dice.below(3), draw.dice.below(3));
        const figure a = to_figure(e.a), b = to_figure(e.b);
        const pose at = to_pose(e.b_in_a);
        const double exact = signed_distance(a, b, at);
        double best = -HUGE_VAL;
        reals direction;
        const auto consider = [&](reals n) {
            const double s = separation_along(a, b, at, n);
            if (s > best) best = s, direction = n;
        };
        for (int k = 0; k < 400; ++k) consider(random_direction(draw.dice));
        // Closer and closer around the best one.
        for (double step = 0.3; step > 1e-9; step *= 0.93)
            for (int k = 0; k < 8; ++k) consider(unit(direction + random_direction(draw.dice) * step));
        REQUIRE(best <= exact + 1e-9);
        // From the deepest point of a shallow basin the search may not find out; a few steps are enough evidence.
        CHECK(best >= exact - 0.05);
    }
}

/// Draws pairs of every two kinds in both orders, and hands them to a check that returns a complaint.
template <class Check>
void every_pair(encounters draw, int times, double larger, Check&& check) {
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
        every_pair({cell::dice(102), std::pow(10, power)}, 600, 1, complaint);
    }
}

CELL_CASE("collide: so do big and small") {
    every_pair({cell::dice(103)}, 1000, 200, complaint);
    every_pair({cell::dice(104)}, 1000, 0.005, complaint);
}

}  // namespace
