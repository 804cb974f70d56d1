// The farthest of many points along a direction, in lanes.
#pragma once

#include <bit>

#include "physics/base/lane_math.hpp"
#include "physics/base/pack_mask.hpp"
#include "physics/space/vec.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The number of the first of n vertices that lies farthest along d; n is a multiple of 8. The coordinates come one
/// array an axis, each at a multiple of 32 bytes. Cost: 0.3 ns a float.
template <class R, int D>
std::uint32_t farthest_vertex(const R* const (&coordinate)[D], std::uint32_t n, const vec<double, D>& d) {
    constexpr int width = 8 / static_cast<int>(sizeof(R) / 4);
    // The largest reach is found first, and then whose it is: so much has to be looked at again for that.
    constexpr std::size_t chunk = 64;
    using lanes = pack<R, width>;
    lanes along[D];
    for (int k = 0; k < D; ++k) along[k] = lanes::broadcast(static_cast<R>(d[k]));
    const R *x = coordinate[0], *y = coordinate[1], *z = coordinate[D - 1];
    const auto reach = [&](std::size_t i) {
        lanes sum = lanes::load_aligned(x + i) * along[0] + lanes::load_aligned(y + i) * along[1];
        if constexpr (D == 3) sum = sum + lanes::load_aligned(z + i) * along[2];
        return sum;
    };
    R maximum{};
    std::size_t found = 0;
    for (std::size_t begin = 0; begin < n; begin += chunk) {
        const std::size_t end = n - begin < chunk ? n : begin + chunk;
        lanes best = reach(begin);
        for (std::size_t i = begin + width; i < end; i += width) best = max(best, reach(i));
        const R here = largest_lane(best);
        if (begin > 0 && !(here > maximum)) continue;
        maximum = here;
        found = begin;
    }
    constexpr std::uint32_t all = (1u << width) - 1;
    for (const lanes wanted = lanes::broadcast(maximum); found < n; found += width) {
        const std::uint32_t others = greater(wanted, reach(found)).bits();
        if (others == all) continue;
        return static_cast<std::uint32_t>(found) + static_cast<std::uint32_t>(std::countr_one(others));
    }
    return 0;
}

}  // namespace detail

PHYSICS_HPP_END
