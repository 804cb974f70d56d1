// Rows of joints that share a bound: forces and torques that are limited as vectors, the same in all directions.
#pragma once

#include "physics/dynamics/joint_rows.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Which rows of a kind share their bound with the next one, see joint_for.
template <class Joint>
constexpr std::uint32_t shared_bounds_of() {
    if constexpr (requires { Joint::shared_bounds; }) return Joint::shared_bounds;
    else return 0;
}
/// How many rows share a bound, of which this is the first: 1 alone, and 0 of those that follow.
constexpr int rows_together(std::uint32_t shared, int row) {
    if (row > 0 && (shared >> (row - 1) & 1) != 0) return 0;
    int count = 1;
    for (; (shared >> row & 1) != 0; ++row) ++count;
    return count;
}
/// Cuts off what n rows want to give together, and tells in which lanes.
template <class Row, class P, class S, int W>
void cut_together(const Row* rows, int n, P* wanted, S (&is_cut)[W]) {
    for (int lane = 0; lane < W; ++lane) {
        vec<S, 3> sum;
        for (int i = 0; i < n; ++i) sum[i] = wanted[i].lane(lane);
        const auto [direction, length] = direction_and_length_of(sum);
        const S bound = rows->high[lane];
        is_cut[lane] = length > bound ? S(1) : S(0);
        if (length > bound)
            for (int i = 0; i < n; ++i) wanted[i].set_lane(lane, direction[i] * bound);
    }
}
/// Of n rows that share a bound, in lanes that are open: whether they are cut off, at the bound and not to leave it. If
/// so, what they give turns towards what they want, since what they act on moves on. `by`: what they give more;
/// `solved` has the right-hand sides. Greater than 0 where they turn.
template <class Row, class Entry, class K, class P, class S, int W>
K turn_together(const Row* rows, const Entry* solved, int n, const K& open, S (&is_cut)[W], P* by) {
    using C = typename K::scalar;
    K turns = K::broadcast(C(0));
    for (int i = 0; i < n; ++i) by[i] = P::broadcast(S(0));
    for (int lane = 0; lane < W; ++lane) {
        if (!(open.lane(lane) > C(0))) continue;
        const double bound = to_double(rows->high[lane]);
        double given[3], wanted[3], squared = 0, outwards = 0, mass = to_double(rows->mass[lane]);
        for (int i = 0; i < n; ++i) {
            given[i] = to_double(rows[i].impulse[lane]);
            wanted[i] = static_cast<double>(solved[i].right_hand.lane(lane));
            squared += given[i] * given[i];
            outwards += given[i] * wanted[i];
            mass = min(mass, to_double(rows[i].mass[lane]));
        }
        is_cut[lane] = sqrt(squared) < bound * (1 - 0x1p-12) || outwards < 0 ? S(0) : S(1);
        if (!(is_cut[lane] > S(0)) || !(bound > 0)) continue;
        // By the least of their masses, so that they turn too far in no direction.
        mass /= 1 + mass * static_cast<double>(solved->softness.lane(lane));
        double sum = 0, farthest = 0;
        for (int i = 0; i < n; ++i) {
            wanted[i] = given[i] + mass * wanted[i];
            sum += wanted[i] * wanted[i];
        }
        for (int i = 0; i < n; ++i) {
            wanted[i] = wanted[i] * (bound / sqrt(sum)) - given[i];
            farthest = max(farthest, abs(wanted[i]));
        }
        if (farthest < bound * 0x1p-12) continue;
        for (int i = 0; i < n; ++i) by[i].set_lane(lane, S(wanted[i]));
        turns.set_lane(lane, C(1));
    }
    return turns;
}

}  // namespace detail

PHYSICS_HPP_END
