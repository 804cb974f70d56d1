// Laws of arrays that calls take: as with pointer and count, and refused where their lengths do not fit.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "cell.hpp"

namespace {
namespace arrays_laws {

using S = cell::scalar;
constexpr int D = cell::dimension;
using vec = physics::vec<S, D>;

static_assert(physics::array_of<std::vector<S>, S> && physics::array_of<std::span<const S>, S> &&
              physics::array_of<std::array<S, 3>, S> && physics::array_of<physics::buffer<S>, S> &&
              !physics::array_of<std::vector<int>, S> && !physics::array_of<S, S>);

template <class F>
std::string said_of(F&& call) {
    try {
        call();
    } catch (const physics::error& e) {
        return e.what();
    }
    return "";
}
template <class Geometry>
auto digest_of(const Geometry& g) {
    return g.data()->digest;
}

template <int N>
void of_surfaces(const std::vector<physics::vec<S, N>>& points, cell::dice& dice) {
    std::vector<S> heights;
    for (int i = 0; i < 12; ++i) heights.push_back(dice.real(0, 1));
    using field = physics::heightfield_geometry<S, N>;
    if constexpr (N == 2) {
        CHECK(digest_of(field::build(heights, S(1))) == digest_of(field::build(heights.data(), 12, S(1))));
        using chain = physics::chain_geometry<S, N>;
        CHECK(digest_of(chain::build(points)) == digest_of(chain::build(points.data(), 12)));
        const std::vector<std::uint8_t> cells{1, 0, 1, 1, 0, 1};
        using grid = physics::tile_grid_geometry<S, N>;
        CHECK(digest_of(grid::build(cells, 3, 2, S(1))) == digest_of(grid::build(cells.data(), 3, 2, S(1))));
        CHECK(said_of([&] { (void)grid::build(cells, 3, 3, S(1)); }) ==
              "physics: tile_grid_geometry::build: cells is 6; there must be columns times rows");
    } else {
        CHECK(digest_of(field::build(heights, 4, 3, S(1), S(1))) ==
              digest_of(field::build(heights.data(), 4, 3, S(1), S(1))));
        CHECK(said_of([&] { (void)field::build(heights, 65536, 65536, S(1), S(1)); }) ==
              "physics: heightfield_geometry::build: heights is 12; there must be columns times rows");
        const std::vector<std::uint32_t> indices{0, 1, 2, 2, 1, 3};
        using mesh = physics::mesh_geometry<S, N>;
        CHECK(digest_of(mesh::build(points, indices)) == digest_of(mesh::build(points.data(), 12, indices.data(), 2)));
        CHECK(said_of([&] {
                  (void)mesh::build(points, std::array<std::uint32_t, 4>{0, 1, 2, 2});
              }) == "physics: mesh_geometry::build: indices is 4; there must be three for each triangle");
    }
}
CELL_CASE("arrays: what is built of vectors, spans and buffers is what is built of pointers and counts") {
    cell::dice dice(3);
    std::vector<vec> points;
    physics::buffer<vec> in_buffer;
    for (int i = 0; i < 12; ++i) points.push_back(in_buffer.push_back(dice.vec<vec>(-1, 1)));
    using hull = physics::hull_geometry<S, D>;
    const auto rock = hull::build(points.data(), 12);
    CHECK(digest_of(hull::build(points)) == digest_of(rock));
    CHECK(digest_of(hull::build(in_buffer)) == digest_of(rock));
    CHECK(digest_of(hull::build(std::span(points))) == digest_of(rock));
    using compound = physics::compound_geometry<S, D>;
    const std::array<physics::compound_child<S, D>, 1> children{{{physics::ball<S, D>{S(0.5)}}}};
    CHECK(digest_of(compound::build(children)) == digest_of(compound::build(children.data(), 1)));
    of_surfaces<D>(points, dice);
}

}  // namespace arrays_laws
}  // namespace
