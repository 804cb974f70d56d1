// The farthest of many points along a direction, in lanes.
#pragma once

#include "physics/base/pack.hpp"
#include "physics/space/vec.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The number of the first of n vertices that lies farthest along d; n is a multiple of 8. The coordinates come one
/// array an axis.
template <class R, int D>
std::uint32_t farthest_vertex(const R* const (&coordinate)[D], std::uint32_t n, const vec<double, D>& d) {
    constexpr int width = 8 / static_cast<int>(sizeof(R) / 4);
    using lanes = pack<R, width>;
    static constexpr R first_numbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    lanes along[D];
    for (int k = 0; k < D; ++k) along[k] = lanes::broadcast(static_cast<R>(d[k]));
    const auto reach = [&](std::uint32_t i) {
        lanes sum = lanes::load(coordinate[0] + i) * along[0] + lanes::load(coordinate[1] + i) * along[1];
        if constexpr (D == 3) sum = sum + lanes::load(coordinate[2] + i) * along[2];
        return sum;
    };
    lanes best = reach(0), number = lanes::load(first_numbers), best_number = number;
    const lanes step = lanes::broadcast(R(width));
    for (std::uint32_t i = width; i < n; i += width) {
        const lanes here = reach(i);
        number = number + step;
        best_number = select_greater(here, best, number, best_number);
        best = max(best, here);
    }
    R values[width], numbers[width];
    best.store(values);
    best_number.store(numbers);
    int k = 0;
    for (int i = 1; i < width; ++i)
        if (values[i] > values[k] || (values[i] == values[k] && numbers[i] < numbers[k])) k = i;
    return static_cast<std::uint32_t>(numbers[k]);
}

}  // namespace detail

PHYSICS_HPP_END
