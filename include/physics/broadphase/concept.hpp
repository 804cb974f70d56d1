// What a broadphase must offer.
#pragma once

#include "physics/base/buffer.hpp"
#include "physics/base/stage.hpp"
#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

/// Two proxies whose boxes overlap; a < b.
struct proxy_pair {
    std::uint32_t a;
    std::uint32_t b;

    friend bool operator==(proxy_pair, proxy_pair) = default;
    friend constexpr bool operator<(proxy_pair x, proxy_pair y) { return x.a != y.a ? x.a < y.a : x.b < y.b; }
};

/// A broadphase bound to a space: a copyable set of boxes by number, with
///   insert(id, box), move(id, box), erase(id)   numbers are small and may come again after erase
///   pairs(accept, out)   clears out and fills it with every pair of overlapping boxes for which
///                        accept(a, b) is true, each once, in ascending order
/// A policy is a type with `using stage = physics::stage::broadphase` and such a class as `in<Space>`.
template <class B, class Space>
concept broadphase_for = std::copyable<B> && std::default_initializable<B> &&
    requires(B b, std::uint32_t id, const typename Space::aabb box, bool (*accept)(std::uint32_t, std::uint32_t),
             buffer<proxy_pair> out) {
    b.insert(id, box);
    b.move(id, box);
    b.erase(id);
    b.pairs(accept, out);
};

PHYSICS_HPP_END
