// Which shapes may touch.
#pragma once

#include "physics/base/arena.hpp"
#include "physics/broadphase/concept.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Boxes -> pairs of shapes whose boxes overlap, in order, of two bodies of which one at least can be pushed: the
/// filters that shapes were inserted with say so.
template <class Broadphase>
const buffer<proxy_pair>& find_pairs(Broadphase& broadphase, [[maybe_unused]] arena& scratch) {
    const auto all = [](std::uint32_t, std::uint32_t) { return true; };
    if constexpr (requires { broadphase.pairs(all, scratch); }) return broadphase.pairs(all, scratch);
    else return broadphase.pairs(all);
}

}  // namespace detail

PHYSICS_HPP_END
