// The pairs of boxes of two trees.
#pragma once

#include "physics/broadphase/packed_tree.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Where a tree is in the order of all trees, as seen from another one.
enum class tree_order { before, same, after };

/// The pairs of a marked box of x with a box of y; where y's is marked as well, from the side of the earlier leaf.
template <int D, class Emit>
void find_pairs(const packed_tree<D>& x, const packed_tree<D>& y, tree_order y_is, bool all_marked, Emit&& emit) {
    if (!x.any_marked()) return;
    for (std::uint32_t l = 0; l < x.leaves(); ++l) {
        const std::uint32_t moved = x.marked(l);
        if (moved == 0) continue;
        const float_box<D> reach = moved == 0xffu ? x.around(l) : x.around(l, moved);
        const auto& leaf = x.leaf(l);
        y.search(
            y_is == tree_order::same && all_marked ? l : 0, [&](const auto& block) { return block.overlapping(reach); },
            [&](std::uint32_t m, std::uint32_t near) {
                const auto& other = y.leaf(m);
                const bool itself = y_is == tree_order::same && m == l;
                const std::uint32_t twice =
                    y_is == tree_order::after || (y_is == tree_order::same && m > l) ? 0 : y.marked(m);
                if (itself) {
                    each_bit(moved, [&](std::uint32_t i) {
                        const std::uint32_t earlier = (moved & ((1u << i) - 1)) | 1u << i;
                        each_bit(leaf.overlapping(leaf.get(i)) & ~earlier,
                                 [&](std::uint32_t k) { emit(x, l * 8 + i, x, l * 8 + k); });
                    });
                    return;
                }
                near &= ~twice;
                if (near == 0) return;
                const std::uint32_t mine = moved & leaf.overlapping(y.around(m));
                each_bit(mine, [&](std::uint32_t i) {
                    each_bit(near & other.overlapping(leaf.get(i)),
                             [&](std::uint32_t k) { emit(x, l * 8 + i, y, m * 8 + k); });
                });
            });
    }
}

}  // namespace detail

PHYSICS_HPP_END
