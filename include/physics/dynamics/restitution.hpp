// Bounces.
#pragma once

#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The speed with which surfaces part that meet at speed v within a substep of h: e times that with which they would
/// meet at the end of the gap, if they are drawn together with acceleration a and each substep moves them with the
/// velocity at its end. So heights fall as e^2, whatever phase of the substep they meet in. Source: the invariant of
/// semi-implicit Euler in a uniform field, v^2 / 2 + a y - v a h / 2.
template <class S>
S rebound_speed(S restitution, S v, S gap, S a, S h) {
    if (a == S(0)) return restitution * v;
    const S half = mul<S>(a, h) * S(0.5), fall = gap > S(0) ? root<S>(product(abs(a + a), gap)) : S(0), mean = v - half;
    if (!(mean > S(0))) return restitution * v;
    if (a > S(0)) return half + restitution * root<S>(product(mean, mean) + product(fall, fall));
    return mean > fall ? max(half + restitution * (sqrt(mean - fall) * sqrt(mean + fall)), S(0)) : S(0);
}

}  // namespace detail

PHYSICS_HPP_END
