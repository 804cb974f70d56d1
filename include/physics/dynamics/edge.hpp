// What holds two bodies together.
#pragma once

#include <cstdint>

#include "physics/base/stage.hpp"

PHYSICS_HPP_BEGIN

namespace solver_api {

/// Two bodies, by their numbers in the world, that something holds together: a contact, or whatever else constrains
/// them.
struct edge {
    std::uint32_t body_a, body_b;
};
/// Edges one after the other.
struct edge_range {
    const edge *first, *last;

    [[nodiscard]] const edge* begin() const { return first; }
    [[nodiscard]] const edge* end() const { return last; }
};
/// Two bodies, by their numbers among those that a solver sees.
struct body_pair {
    std::uint32_t a, b;
};

}  // namespace solver_api

PHYSICS_HPP_END
