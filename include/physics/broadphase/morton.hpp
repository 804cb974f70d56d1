// The order of boxes along a curve that keeps neighbours together.
#pragma once

#include "physics/base/sort.hpp"
#include "physics/broadphase/box_block.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The bits of x, D - 1 zeros between each two.
template <int D>
constexpr std::uint32_t spread(std::uint32_t x) {
    if constexpr (D == 2) {
        x = (x | x << 8) & 0x00ff00ffu;
        x = (x | x << 4) & 0x0f0f0f0fu;
        x = (x | x << 2) & 0x33333333u;
        return (x | x << 1) & 0x55555555u;
    } else {
        x = (x | x << 16) & 0x030000ffu;
        x = (x | x << 8) & 0x0300f00fu;
        x = (x | x << 4) & 0x030c30c3u;
        return (x | x << 2) & 0x09249249u;
    }
}

/// Sorts keys, whose low 32 bits are numbers of boxes, along a Morton curve through the boxes' centres; get(number)
/// gives a box. Boxes that share a cell are sorted by cells of their own, however small, so that neither distant
/// strays nor clusters spoil the order. Cost: about 15 ns a box.
/// Source: Morton, A computer oriented geodetic data base (1966).
template <int D, class Get>
void morton_sort(std::uint64_t* keys, std::uint64_t* spare, std::uint32_t count, Get&& get) {
    constexpr int bits = D == 2 ? 16 : 10;
    constexpr float cells = static_cast<float>(1 << bits);
    constexpr float most = std::numeric_limits<float>::max();
    // A quarter of the sum of both ends: differences stay within the range.
    const auto middle = [](const float_box<D>& box, int i) { return box.lower[i] * 0.25f + box.upper[i] * 0.25f; };
    float low[D], high[D];
    for (int i = 0; i < D; ++i) {
        low[i] = most;
        high[i] = -most;
    }
    for (std::uint32_t k = 0; k < count; ++k) {
        const float_box<D> box = get(static_cast<std::uint32_t>(keys[k]));
        for (int i = 0; i < D; ++i) {
            const float m = middle(box, i);
            low[i] = m < low[i] ? m : low[i];
            high[i] = m > high[i] ? m : high[i];
        }
    }
    float widest = 0;
    for (int i = 0; i < D; ++i) widest = high[i] - low[i] > widest ? high[i] - low[i] : widest;
    // Also false where a cell would be too small for a number.
    if (!(widest > 1e-30f)) return;
    const float scale = cells / widest;
    for (std::uint32_t k = 0; k < count; ++k) {
        const auto number = static_cast<std::uint32_t>(keys[k]);
        const float_box<D> box = get(number);
        std::uint32_t code = 0;
        for (int i = 0; i < D; ++i) {
            const float cell = (middle(box, i) - low[i]) * scale;
            code |= spread<D>(static_cast<std::uint32_t>(cell < cells - 1 ? cell : cells - 1)) << i;
        }
        keys[k] = std::uint64_t{code} << 32 | number;
    }
    std::uint64_t* sorted = radix_sort(keys, spare, count, 32, 32 + D * bits);
    if (sorted != keys) std::memcpy(keys, sorted, count * sizeof *keys);
    for (std::uint32_t from = 0; from < count;) {
        std::uint32_t to = from + 1;
        while (to < count && keys[to] >> 32 == keys[from] >> 32) ++to;
        if (to - from > 8) morton_sort<D>(keys + from, spare, to - from, get);
        from = to;
    }
}

}  // namespace detail

PHYSICS_HPP_END
