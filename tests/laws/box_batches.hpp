// Laws of box against box in batches: lanes, their number and what fills the last group change no bit.
#pragma once

#include <cstring>
#include <vector>

#include "reals.hpp"

namespace {
namespace box_batches_laws {

using box = physics::box<S, D>;
using manifold = physics::manifold<S, D>;
using box_pair = physics::detail::box_pair<S, D>;

/// Pairs of boxes, kept where the pairs point.
struct box_pairs {
    std::vector<box> a, b;
    std::vector<transform> b_in_a;
    std::vector<box_pair> pairs;

    void add(const box& first, const box& second, const transform& at) {
        a.push_back(first);
        b.push_back(second);
        b_in_a.push_back(at);
    }
    const box_pair* data() {
        pairs.clear();
        for (std::size_t i = 0; i < a.size(); ++i) pairs.push_back({&a[i], &b[i], &b_in_a[i]});
        return pairs.data();
    }
};

/// A rotation by nothing, by quarters, by halves of them, by nearly those, or any.
inline rotation drawn_rotation(cell::dice& dice) {
    const int displacement = dice.below(4);
    if (displacement == 0) return random_rotation(dice);
    reals axis;
    axis[cell::is_2d ? 2 : dice.below(3)] = 1;
    const rotation simple = rotation_about(axis, dice.below(9) * M_PI / 4);
    if (displacement == 1) return {};
    if (displacement == 2) return simple;
    const double hair = std::pow(10, dice.number(-8, -2));
    return turned(simple, to_angular(random_axis(dice) * hair));
}
inline box drawn_box(cell::dice& dice) {
    vec half = dice.vec<vec>(0.125, 0.5);
    const int displacement = dice.below(4);
    if (displacement == 0) half = vec::filled(S(0.25));
    if (displacement == 1) half[dice.below(D)] = dice.real(0.0005, 0.005);
    return {half};
}
/// Far, near, touching, deep, one in the other, side by side, corner at corner.
inline box_pairs drawn_pairs(cell::dice& dice, int count) {
    box_pairs all;
    for (int i = 0; i < count; ++i) {
        const box a = drawn_box(dice), b = dice.below(4) == 0 ? a : drawn_box(dice);
        transform at{{}, drawn_rotation(dice)};
        const reals ha = to_reals(a.half_extents), hb = to_reals(b.half_extents);
        const pose turned_b = to_pose(at);
        reals n = random_direction(dice);
        if (dice.below(2)) n = reals{}, n[dice.below(D)] = dice.below(2) ? 1 : -1;
        const reals in_b = turned_b.unrotate(n);
        double touching = 0;
        for (int k = 0; k < D; ++k) touching += ha[k] * std::abs(n[k]) + hb[k] * std::abs(in_b[k]);
        const double gaps[] = {0, 1e-6, -1e-6, 0.01, -0.01, 0.1, 10, -touching / 2, -touching};
        reals p = n * (touching + gaps[dice.below(9)]);
        const double aside[] = {0, 1e-5, 0.1, 0.6};
        const double away = aside[dice.below(4)];
        p = p + random_direction(dice) * away;
        if (dice.below(6) == 0) {
            // Corner at corner, a hair apart or within each other.
            const reals reach = to_reals(abs(at.rotation * b.half_extents));
            for (int k = 0; k < D; ++k)
                p[k] = (ha[k] + std::abs(reach[k]) + dice.number(-0.001, 0.01)) * (k % 2 ? 1 : -1);
        }
        at.position = from_reals(p);
        all.add(a, b, at);
    }
    return all;
}

inline bool same_bits(S a, S b) { return std::memcmp(&a, &b, sizeof a) == 0; }
inline bool same_bits(const manifold& m, const manifold& n) {
    bool same = m.count == n.count;
    for (int i = 0; i < D; ++i) same = same && same_bits(m.normal[i], n.normal[i]);
    for (int k = 0; k < manifold::capacity && same; ++k) {
        const auto &p = m.points[k], &q = n.points[k];
        for (int i = 0; i < D; ++i) same = same && same_bits(p.position[i], q.position[i]);
        same = same && same_bits(p.separation, q.separation) && p.feature == q.feature;
    }
    return same;
}
/// What nothing should be left of.
inline manifold stale() {
    manifold m;
    m.normal = vec::filled(S(7));
    for (int k = 0; k < manifold::capacity; ++k) m.add(vec::filled(S(8)), S(9), 10);
    return m;
}
inline manifold alone(const box_pair& pair, S margin) {
    manifold m;
    collide(*pair.a, *pair.b, *pair.b_in_a, margin, m);
    return m;
}

CELL_CASE("box batches: each pair gets what it gets alone, bit for bit, in batches of any size") {
    cell::dice dice(300);
    int empty = 0, one = 0, more = 0;
    for (int run = 0; run < 4; ++run)
        for (int count = 1; count <= 70; ++count)
            for (const double distance : {0.0, 0.02, 0.3}) {
                const S margin = cell::real(distance);
                box_pairs drawn = drawn_pairs(dice, count);
                const box_pair* pairs = drawn.data();
                std::vector<manifold> found(static_cast<std::size_t>(count) + 1, stale());
                physics::detail::collide_boxes(pairs, static_cast<std::uint32_t>(count), margin, found.data());
                for (int i = 0; i < count; ++i) {
                    const manifold expected = alone(pairs[i], margin);
                    REQUIRE(same_bits(found[static_cast<std::size_t>(i)], expected));
                    ++(expected.count == 0 ? empty : expected.count == 1 ? one : more);
                }
                // Not a slot further.
                REQUIRE(same_bits(found.back(), stale()));
            }
    CHECK(empty > 1000);
    CHECK(one > 1000);
    CHECK(more > 1000);
}

CELL_CASE("box batches: nothing is written for no pairs") {
    manifold m = stale();
    physics::detail::collide_boxes(static_cast<const box_pair*>(nullptr), 0, S(1), &m);
    CHECK(same_bits(m, stale()));
}

CELL_CASE("box batches: the neighbours in a group leave no trace") {
    cell::dice dice(301);
    const S margin = cell::real(0.02);
    box_pairs drawn = drawn_pairs(dice, 64);
    const box_pair* pairs = drawn.data();
    for (int first = 0; first < 64; ++first) {
        // The same pair in each place, among others.
        std::vector<box_pair> shuffled;
        for (int i = 0; i < 16; ++i) shuffled.push_back(pairs[i % 3 ? dice.below(64) : first]);
        std::vector<manifold> found(16, stale());
        physics::detail::collide_boxes(shuffled.data(), 16, margin, found.data());
        const manifold expected = alone(pairs[first], margin);
        for (std::size_t i = 0; i < 16; i += 3) REQUIRE(same_bits(found[i], expected));
    }
}

template <int W>
std::vector<manifold> in_lanes(const box_pair* pairs, int count, S margin) {
    std::vector<manifold> found(static_cast<std::size_t>(count), stale());
    for (int i = 0; i < count; i += W) physics::detail::collide_box_lanes<S, W>(pairs + i, margin, found.data() + i);
    return found;
}
/// Compares the widths; a template, so that only the plane, which has a choice, compiles it.
template <int N>
void compare_widths() {
    if constexpr (N == 2) {
        cell::dice dice(302);
        const int count = 4000;
        const S margin = cell::real(0.02);
        box_pairs drawn = drawn_pairs(dice, count);
        const box_pair* pairs = drawn.data();
        const auto one = in_lanes<N / 2>(pairs, count, margin), two = in_lanes<N>(pairs, count, margin),
                   four = in_lanes<2 * N>(pairs, count, margin), eight = in_lanes<4 * N>(pairs, count, margin);
        for (std::size_t i = 0; i < count; ++i) {
            REQUIRE(same_bits(one[i], alone(pairs[i], margin)));
            REQUIRE(same_bits(one[i], two[i]));
            REQUIRE(same_bits(one[i], four[i]));
            REQUIRE(same_bits(one[i], eight[i]));
        }
    }
}
CELL_CASE("box batches: every width gives the same bits") { compare_widths<D>(); }

}  // namespace box_batches_laws
}  // namespace
