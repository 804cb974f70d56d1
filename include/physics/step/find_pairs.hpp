// Which shapes may touch.
#pragma once

#include "physics/base/arena.hpp"
#include "physics/broadphase/concept.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Boxes -> pairs of shapes whose boxes overlap, in order, of two bodies of which one at least can be pushed: the
/// filters that shapes were inserted with say so.
template <class Broadphase, class Accept>
const buffer<proxy_pair>& find_pairs(Broadphase& broadphase, const Accept& accept, [[maybe_unused]] arena& scratch) {
    if constexpr (requires { broadphase.pairs(accept, scratch); }) return broadphase.pairs(accept, scratch);
    else return broadphase.pairs(accept);
}
template <class Broadphase>
const buffer<proxy_pair>& find_pairs(Broadphase& broadphase, arena& scratch) {
    return find_pairs(
        broadphase, [](std::uint32_t, std::uint32_t) { return true; }, scratch);
}

}  // namespace detail

PHYSICS_HPP_END
