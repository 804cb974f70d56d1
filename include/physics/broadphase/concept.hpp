// What a broadphase must offer.
#pragma once

#include "physics/base/buffer.hpp"
#include "physics/base/stage.hpp"
#include "physics/broadphase/proxies.hpp"

PHYSICS_HPP_BEGIN

/// Two proxies whose boxes overlap; a < b.
struct proxy_pair {
    std::uint32_t a;
    std::uint32_t b;

    friend bool operator==(proxy_pair, proxy_pair) = default;
};
constexpr bool operator<(proxy_pair x, proxy_pair y) { return x.a != y.a ? x.a < y.a : x.b < y.b; }

/// A broadphase bound to a space: a copyable set of boxes by number, with
///   insert(id, box, filter), erase(id)   numbers are small and may come again after erase
///   move(id, box, way)   the proxy is in this box now, and moves that way (m a step)
///   pairs(accept)        a buffer of all pairs of overlapping boxes for which may_meet(filter, filter) and
///                        accept(a, b) are true, each once, in ascending order; pairs of boxes that are close may be
///                        among them
/// and, if it likes, configure(broadphase_settings), update(), which is called when boxes have moved, so that queries
/// see them, and each_member(self, f), which names what lasts of it, for snapshots of worlds (see base/members.hpp).
/// A policy is a type with `using stage = physics::stage::broadphase` and such a class as `in<Space>`: of your own, or
/// an indexed_broadphase around an index of your own.
template <class B, class Space>
concept broadphase_for = std::copyable<B> && std::default_initializable<B> &&
    requires(B b, std::uint32_t id, const typename Space::aabb box, const typename Space::vec displacement,
             const proxy_filter filter, bool (*accept)(std::uint32_t, std::uint32_t)) {
    b.insert(id, box, filter);
    b.move(id, box, displacement);
    b.erase(id);
    { b.pairs(accept) } -> std::convertible_to<const buffer<proxy_pair>&>;
};

PHYSICS_HPP_END
