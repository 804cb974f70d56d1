// One name for all types of a world's space.
#pragma once

#include "physics/space/aabb.hpp"
#include "physics/space/inertia.hpp"

PHYSICS_HPP_BEGIN

/// The types of a world with scalar S in D dimensions; policies rebind themselves to one of these.
template <class S, int D>
struct space {
    using scalar = S;
    static constexpr int dimension = D;
    using vec = physics::vec<S, D>;
    using angular = physics::angular<S, D>;
    using rotation = physics::rotation<S, D>;
    using transform = physics::transform<S, D>;
    using twist = physics::twist<S, D>;
    using aabb = physics::aabb<S, D>;
    using inertia = physics::inertia<S, D>;
    using inverse = inverse_of<S>;
    using inverse_inertia = physics::inverse_inertia<S, D>;
    using mass_properties = physics::mass_properties<S, D>;
};

PHYSICS_HPP_END
