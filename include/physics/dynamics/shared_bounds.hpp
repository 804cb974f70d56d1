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
/// Cuts off what n rows want to give together.
template <int W, class Row, class P>
void cut_together(const Row* rows, int n, P* wanted) {
    for (int lane = 0; lane < W; ++lane) {
        vec<typename P::scalar, 3> sum;
        for (int i = 0; i < n; ++i) sum[i] = wanted[i].lane(lane);
        const auto [direction, length] = direction_and_length_of(sum);
        const auto bound = rows->high[lane];
        if (length > bound)
            for (int i = 0; i < n; ++i) wanted[i].set_lane(lane, direction[i] * bound);
    }
}

}  // namespace detail

PHYSICS_HPP_END
