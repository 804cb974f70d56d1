// Bounces.
#pragma once

#include "physics/dynamics/body.hpp"
#include "physics/dynamics/contact.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The speed with which the surfaces part at point k after they have met; 0 where nothing bounces.
template <class S, int D, class Features>
S bounce_of(const contact<S, D, Features>& c, int k, S restitution, const solver_body<S, D, Features::rotation>& a,
            const solver_body<S, D, Features::rotation>& b, S slop, S h) {
    if (!(restitution > S(0))) return S(0);
    // A bounce starts where the gap is: the speed that closes it first would be lost.
    const auto [to_a, to_b] = c.levers(k);
    const S speed = dot(c.normal, velocity_at(b.velocity, to_b) - velocity_at(a.velocity, to_a));
    const bool meets = c.points[k].separation + speed * h < S(0);
    return meets && -speed > slop ? -(restitution * speed) : S(0);
}

}  // namespace detail

PHYSICS_HPP_END
