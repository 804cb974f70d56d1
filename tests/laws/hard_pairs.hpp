// Contacts with exact answers: lattices of boxes, and pairs that other libraries were reported to get wrong.
#pragma once

#include "distances.hpp"

namespace {

template <int N>
physics::rotation<S, N> quarter_turns(int times) {
    const double c[] = {1, 0, -1, 0}, s[] = {0, 1, 0, -1};
    return physics::rotation<S, N>{S(c[times % 4]), S(s[times % 4])};
}
/// The rotations of the lattice whose numbers every scalar holds exactly: 4 in the plane, 12 in space.
template <int N = D>
std::vector<physics::rotation<S, N>> exact_rotations() {
    std::vector<physics::rotation<S, N>> result;
    if constexpr (N == 2) {
        for (int i = 0; i < 4; ++i) result.push_back(quarter_turns<2>(i));
    } else {
        for (int i = 0; i < 4; ++i)
            result.push_back({S(i == 0 ? 1 : 0), S(i == 1 ? 1 : 0), S(i == 2 ? 1 : 0), S(i == 3 ? 1 : 0)});
        for (int i = 0; i < 8; ++i)
            result.push_back({S(i & 1 ? 0.5 : -0.5), S(i & 2 ? 0.5 : -0.5), S(i & 4 ? 0.5 : -0.5), S(0.5)});
    }
    return result;
}

CELL_CASE("hard pairs: boxes on a lattice have the exact gap") {
    const double extents[][3] = {{1, 1, 1}, {0.5, 1, 1.5}, {2, 0.5, 1}};
    const S margin(0.75);
    for (const auto& turn : exact_rotations())
        for (const auto& ea : extents)
            for (const auto& eb : extents) {
                const vec half_a = from_reals({ea[0], ea[1], ea[2]}), half_b = from_reals({eb[0], eb[1], eb[2]});
                const vec reach = abs(turn * half_b);
                const int steps = cell::is_2d ? 19 : 7;
                for (int n = 0; n < (cell::is_2d ? steps * steps : steps * steps * steps); ++n) {
                    const double spacing = cell::is_2d ? 0.5 : 1;
                    const vec p =
                        from_reals({(n % steps - steps / 2) * spacing, (n / steps % steps - steps / 2) * spacing,
                                    (n / steps / steps - steps / 2) * spacing});
                    double gap = -HUGE_VAL;
                    int outside = 0;
                    for (int i = 0; i < D; ++i) {
                        const double along = cell::number(abs(p)[i] - half_a[i] - reach[i]);
                        gap = std::fmax(gap, along);
                        outside += along > 0;
                    }
                    const manifold m = collide({box{half_a}, box{half_b}, {p, turn}, margin});
                    if (outside > 1) {
                        // Corner to corner: the root of a sum, at least 0.7; the random pairs test it.
                        continue;
                    }
                    REQUIRE((m.count > 0) == (gap <= 0.75));
                    for (int i = 0; i < m.count; ++i) REQUIRE(cell::number(m.points[i].separation) == gap);
                    if (m.count > 0) REQUIRE(largest(m.normal) == S(1));
                    if (m.count > 0) REQUIRE(size(to_reals(m.normal)) == 1);
                }
            }
}

CELL_CASE("hard pairs: round shapes with exact answers") {
    const S margin(8);
    const auto check = [&](const any_shape& a, const any_shape& b, reals at, double gap, reals normal) {
        const encounter e{a, b, {from_reals(at), {}}, margin};
        const std::string law = complaint(e);
        CHECK_MESSAGE(law.empty(), law);
        const manifold m = collide(e);
        REQUIRE(m.count > 0);
        CHECK(near(deepest(m), gap, 4));
        if (size(normal) > 0) CHECK(near(m.normal, normal, 4));
    };
    check(ball{S(1)}, ball{S(2)}, {3, 4, 0}, 2, {0.6, 0.8, 0});
    check(ball{S(1)}, ball{S(2)}, {}, -3, {});
    check(ball{S(1)}, capsule{S(2), S(0.5)}, {}, -1.5, {});
    check(ball{S(1)}, capsule{S(2), S(0.5)}, {-1, 0, 0}, -1.5, {});
    check(ball{S(1)}, capsule{S(2), S(0.5)}, {3, 0, 0}, -0.5, {1, 0, 0});
    check(ball{S(1)}, box{vec::filled(S(1))}, {2, 0, 0}, 0, {1, 0, 0});
    check(ball{S(1)}, box{vec::filled(S(1))}, {1, 0, 0}, -1, {1, 0, 0});
    check(ball{S(1)}, box{vec::filled(S(1))}, {0.75, 0, 0}, -1.25, {1, 0, 0});
    check(ball{S(1)}, box{vec::filled(S(1))}, {}, -2, {});
    check(ball{S(1)}, box{vec::filled(S(1))}, {4, 5, 0}, 4, {0.6, 0.8, 0});
    check(ball{S(1)}, halfspace{}, {0, -1, 0}, 0, {0, -1, 0});
    check(ball{S(1)}, halfspace{}, {0, 2, 0}, -3, {0, -1, 0});
    check(capsule{S(1), S(0.5)}, capsule{S(1), S(0.5)}, {}, -1, {});
    check(capsule{S(1), S(0.5)}, capsule{S(1), S(0.5)}, {3, 0, 0}, 0, {1, 0, 0});
    check(capsule{S(1), S(0.5)}, capsule{S(1), S(0.5)}, {0, 1, 0}, 0, {0, 1, 0});
    check(capsule{S(1), S(0.5)}, box{vec::filled(S(1))}, {}, -1.5, {});
    check(capsule{S(1), S(0.5)}, box{vec::filled(S(1))}, {2.5, 0, 0}, 0, {1, 0, 0});
    check(capsule{S(1), S(0.5)}, halfspace{}, {0, -0.5, 0}, 0, {0, -1, 0});
    check(box{vec::filled(S(1))}, halfspace{}, {0, -1, 0}, 0, {0, -1, 0});
    // A small one deep within a large one goes out the nearest way.
    check(ball{S(0.125)}, box{vec::filled(S(64))}, {32, 0, 0}, -32.125, {1, 0, 0});
    check(box{vec::filled(S(0.125))}, box{vec::filled(S(64))}, {32, 0, 0}, -32.125, {1, 0, 0});
}

/// A box by its full sizes, as issues state them.
template <int N = D>
physics::box<S, N> box_of(double x, double y, double z) {
    if constexpr (N == 2) return {{S(x / 2), S(y / 2)}};
    else return {{S(x / 2), S(y / 2), S(z / 2)}};
}
/// Checks the gap of a pair in space, in both orders and at several scales.
void expect(const any_shape& a, const any_shape& b, const transform& b_in_a, double gap, double margin,
            double tolerance) {
    for (const double scale : {1.0, 0.125, 16.0})
        for (const bool swapped : {false, true}) {
            CAPTURE(scale);
            CAPTURE(swapped);
            const transform at{b_in_a.position * S(scale), b_in_a.rotation};
            encounter e{scaled(a, scale), scaled(b, scale), at, S(margin * scale)};
            if (swapped) e = {e.b, e.a, inverse(e.b_in_a), e.margin};
            const std::string law = complaint(e);
            CHECK_MESSAGE(law.empty(), law);
            const manifold m = collide(e);
            REQUIRE(m.count > 0);
            CHECK(std::abs(deepest(m) / scale - gap) <= tolerance + 64 * epsilon * (cell::is_fixed ? 1 / scale : 1));
        }
}

CELL_CASE("hard pairs: boxes that other libraries got wrong") {
    if (cell::is_2d) return;
    // Answers are those of exhaustive searches in long double; the last digits are what the inputs carry.
    SUBCASE("libccd issue 25: NaN") {
        expect(box_of(2, 2, 2), box_of(2, 2, 2), {from_reals({0, 0, 1.9}), {}}, -0.1, 0.1, 0);
    }
    SUBCASE("Bullet: concentric cubes have a face's normal") {
        expect(box_of(1, 1, 1), box_of(1, 1, 1), {}, -1, 0.1, 0);
    }
    SUBCASE("FCL issue 508: 3.162 instead of 3") {
        expect(box_of(1, 1, 1), box_of(1, 1, 1), {from_reals({0, 4, 0}), {}}, 3, 4, 0);
    }
    SUBCASE("FCL issue 293: NaN") {
        const transform plate{from_reals({1.625, 0, 0.5}), {}};
        const transform brick{from_reals({0.192074, -0.27787, 0.273546}),
                              rotation_of(std::vector<S>{S(0.340674), S(0.155066), S(0.638138), S(0.672811)})};
        const transform at = relative(plate, {brick.position, normalized(brick.rotation)});
        expect(box_of(2.75, 6, 0.05), box_of(0.424, 0.15, 0.1686), at, 0.0535161628, 0.1, 1e-6);
    }
    SUBCASE("Box3D at 1 cm: crossing edges, one rolled about x, one about y") {
        for (const double side : {1.0, 0.1, 0.01}) {
            const transform at{from_reals({0, 0, side * (std::sqrt(2.0) - 0.02)}), rotation_about({0, 1, 0}, M_PI / 4)};
            const transform rolled{{}, rotation_about({1, 0, 0}, M_PI / 4)};
            expect(box_of(side, side, side), box_of(side, side, side), relative(rolled, at), -0.02 * side, 0.1 * side,
                   0);
        }
    }
    SUBCASE("FCL issue 495: cubes that kiss, in a tilted frame") {
        cell::dice dice(60);
        for (int i = 0; i < 100; ++i)
            for (const double side : {0.01, 0.25, 10.0}) {
                const transform a = random_transform(dice, side);
                transform b = a;
                vec step;
                step[i % 3] = S(side) + S(dice.below(3) - 1) * cell::traits::epsilon() * S(side);
                b.position += a.rotation * step;
                const encounter e{box_of(side, side, side), box_of(side, side, side), relative(a, b), S(0.01 * side)};
                const std::string law = complaint(e);
                REQUIRE_MESSAGE(law.empty(), law);
                const manifold m = collide(e);
                REQUIRE(m.count == 4);
                REQUIRE(std::abs(deepest(m)) <= 64 * epsilon * (cell::is_fixed ? 1 : side));
            }
    }
    SUBCASE("thin plates and a small box on a large one") {
        expect(box_of(10, 4, 0.01), box_of(10, 4, 0.01), {from_reals({3, 1, 0.009}), rotation_about({0, 0, 1}, 0.3)},
               -0.001, 0.01, 0);
        expect(box_of(200, 200, 1), box_of(0.2, 0.2, 0.2), {from_reals({70, -30, 0.599}), rotation_about({0, 0, 1}, 1)},
               -0.001, 0.01, 1e-5);
    }
}

CELL_CASE("hard pairs: Bullet issue 2579, a sphere among small cubes") {
    if (cell::is_2d) return;
    const double depths[][2] = {{0.3925, -0.00362063}, {0.3975, -0.00445543}, {0.4025, -0.00415652}};
    for (const auto& [z, depth] : depths) {
        const reals offset = reals{0.0275, -1.0275, z} - reals{0.019576, -1.03115, 0.398155};
        expect(ball{S(0.01)}, box_of(0.005, 0.005, 0.005), {from_reals(offset), {}}, depth, 0.001, 1e-8);
    }
}

CELL_CASE("hard pairs: extremes give numbers, never NaN") {
    if (cell::is_fixed) return;
    cell::dice dice(61);
    for (int i = 0; i < 20000; ++i) {
        const int kind_a = dice.below(4), kind_b = dice.below(3);
        const double size_a = std::pow(10, dice.number(-9, 9)), size_b = std::pow(10, dice.number(-9, 9));
        const any_shape a = scaled(random_shape(kind_a, dice, 0.1, 1), size_a);
        const any_shape b = scaled(random_shape(kind_b, dice, 0.1, 1), size_b);
        const double away = std::pow(10, dice.number(-12, 9));
        const transform at{from_reals(random_direction(dice) * away), random_rotation(dice)};
        const manifold m = collide({a, b, at, S(std::fmin(size_a, size_b) * 0.1)});
        if (m.count == 0) continue;
        REQUIRE(std::abs(size(to_reals(m.normal)) - 1) <= 16 * epsilon);
        for (int k = 0; k < m.count; ++k) {
            REQUIRE(is_finite(m.points[k].position));
            REQUIRE(physics::is_finite(m.points[k].separation));
        }
    }
}

}  // namespace
