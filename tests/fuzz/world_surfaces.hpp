// Shapes made of parts, out of a fuzzer's bytes.
#pragma once

#include "world_values.hpp"

namespace fuzz {

/// None where it is refused: a shape of that is refused too.
template <class Build>
auto built(Build&& build) -> decltype(build()) {
    try {
        return build();
    } catch (const physics::error&) {
        return {};
    }
}

/// Calls f with a surface or a compound. What it is made of goes as f returns: worlds must keep it.
template <class S, class F>
void with_parts(values<S, 2>& v, F&& f) {
    using vec = physics::vec<S, 2>;
    const unsigned flags = v.byte();
    const S radius = v.share(0.25);
    switch (flags % 4) {
        case 0: {
            // From right to left, as ground leads.
            std::vector<vec> points;
            for (int n = 2 + v.below(6), i = 0; i < n; ++i)
                points.push_back({S(2.0 - 4.0 * i / (n - 1)), v.rarely(2) ? S(0) : v.real(1)});
            const physics::chain_settings how{.loop = (flags & 4) != 0, .two_sided = (flags & 8) != 0};
            f(built([&] { return physics::chain_geometry<S, 2>::build(points, how); }).shape(radius));
            break;
        }
        case 1: {
            std::vector<S> heights;
            for (int n = 2 + v.below(7); n > 0; --n) heights.push_back(v.rarely(2) ? S(0) : v.real(0.75));
            const std::uint8_t holes[8] = {0, 0, 1};
            physics::heightfield_settings how;
            if (flags & 4) how.holes = holes;
            how.two_sided = (flags & 8) != 0;
            const S spacing = v.positive(1);
            f(built([&] { return physics::heightfield_geometry<S, 2>::build(heights, spacing, how); }).shape(radius));
            break;
        }
        case 2: {
            std::vector<std::uint8_t> cells;
            for (int row = 0; row < 3; ++row)
                for (unsigned bits = v.byte(), i = 0; i < 5; ++i) cells.push_back((bits >> i & 1) != 0);
            const S side = v.positive(1);
            f(built([&] { return physics::tile_grid_geometry<S, 2>::build(cells, 5, 3, side); }).shape(radius));
            break;
        }
        default: with_compound(v, f);
    }
}
template <class S, class F>
void with_parts(values<S, 3>& v, F&& f) {
    using vec = physics::vec<S, 3>;
    const unsigned flags = v.byte();
    const S radius = v.share(0.25);
    switch (flags % 3) {
        case 0: {
            // A sheet whose front is above, or a tetrahedron.
            std::vector<vec> points;
            std::vector<std::uint32_t> indices{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
            if (flags & 4) {
                for (int i = 0; i < 4; ++i) points.push_back(v.vector(1));
            } else {
                indices.clear();
                for (int i = 0; i < 9; ++i)
                    points.push_back({S(i % 3 * 1.5 - 1.5), v.rarely(2) ? S(0) : v.real(0.5), S(i / 3 * 1.5 - 1.5)});
                for (const std::uint32_t i : {0u, 1u, 3u, 4u}) {
                    const std::uint32_t cell[] = {i, i + 3, i + 1, i + 1, i + 3, i + 4};
                    indices.insert(indices.end(), std::begin(cell), std::end(cell));
                }
            }
            const physics::mesh_settings how{.two_sided = (flags & 8) != 0};
            f(built([&] { return physics::mesh_geometry<S, 3>::build(points, indices, how); }).shape(radius));
            break;
        }
        case 1: {
            const std::uint32_t columns = 2 + static_cast<std::uint32_t>(v.below(3));
            std::vector<S> heights;
            for (std::uint32_t n = 3 * columns; n > 0; --n) heights.push_back(v.rarely(2) ? S(0) : v.real(0.5));
            const std::uint8_t holes[8] = {0, 1};
            physics::heightfield_settings how;
            if (flags & 4) how.holes = holes;
            how.two_sided = (flags & 8) != 0;
            how.alternating = (flags & 16) != 0;
            const S x = v.positive(1.5), z = v.positive(1.5);
            f(built([&] {
                  return physics::heightfield_geometry<S, 3>::build(heights, columns, 3, x, z, how);
              }).shape(radius));
            break;
        }
        default: with_compound(v, f);
    }
}
template <class S, int D, class F>
void with_compound(values<S, D>& v, F&& f) {
    std::vector<physics::compound_child<S, D>> children;
    for (int n = 1 + v.below(3); n > 0; --n) {
        const auto at = v.pose(0.5);
        const S size = v.positive(0.5);
        if (v.rarely(2)) children.emplace_back(physics::ball<S, D>{size}, at.position, at.rotation);
        else children.emplace_back(physics::box<S, D>{physics::vec<S, D>::filled(size)}, at.position, at.rotation);
    }
    f(built([&] { return physics::compound_geometry<S, D>::build(children); }).shape());
}

}  // namespace fuzz
