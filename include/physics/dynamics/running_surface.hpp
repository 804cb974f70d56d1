// How surfaces run under each other where belts drive them or a kinematic body turns.
#pragma once

#include "physics/dynamics/contact.hpp"
#include "physics/dynamics/convert.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Whether it turns whatever touches it.
template <class Body>
bool turns_by_itself(const Body& b) {
    if constexpr (requires { b.velocity.angular; })
        return !(b.inverse_mass > decltype(b.inverse_mass)(0)) &&
               !(b.velocity.angular == decltype(b.velocity.angular){});
    else return false;
}

/// How the slip along the tangents at which surfaces stay together changes (m/s^2) in a step of h seconds, of which a
/// solver knows levers at the start alone, where one of the bodies turns by itself: by it what rides on a turntable
/// goes round, and not along tangents. The place at which they touch moves with the other body, and turns with it about
/// the normal. No more than what a turn by a radian in the step comes to: beyond it there is no such line.
template <class S, int D, class Features, bool Rotates>
tangential<S, D> slip_change([[maybe_unused]] const contact<S, D, Features>& c,
                             [[maybe_unused]] const solver_body<S, D, Rotates>& a,
                             [[maybe_unused]] const solver_body<S, D, Rotates>& b, [[maybe_unused]] S h) {
    if constexpr (Rotates) {
        const bool by_a = turns_by_itself(a);
        if (!by_a && !turns_by_itself(b)) return {};
        const solver_body<S, D, Rotates>&turning = by_a ? a : b, &other = by_a ? b : a;
        const auto of_turning = converted<double>(turning.velocity), of_other = converted<double>(other.velocity);
        vec<double, D> on_turning{}, on_other{};
        for (int k = 0; k < c.count; ++k) {
            const anchors<S, D> to = c.anchors(k);
            on_turning += converted<double>(by_a ? to.a : to.b) * (1.0 / c.count);
            on_other += converted<double>(by_a ? to.b : to.a) * (1.0 / c.count);
        }
        const vec<double, D> n = converted<double>(c.normal);
        vec<double, D> around{};
        if constexpr (D == 3) around = cross(n * dot(of_other.angular, n), on_other);
        // What comes at it is stopped before it goes along.
        const double approach = dot(n, velocity_at(of_other, on_other) - velocity_at(of_turning, on_turning));
        const vec<double, D> along = of_other.linear - n * approach + around - of_turning.linear;
        vec<double, D> change = cross(of_turning.angular, along) - cross(of_other.angular, around);
        const double turn = largest_magnitude(turning.velocity.angular) * to_double(h);
        change *= (by_a ? 1 : -1) / max(turn * turn, 1.0);
        // Within the scalar's range at the end of the step too.
        if (largest(change) * max(to_double(h), 1.0) < to_double(scalar_traits<S>::max()) / 4)
            return tangents<S, D>(c.normal).components(converted<S>(change));
    }
    return {};
}

/// The slip along the tangents at which the surfaces of a contact stay together (m/s), substep by substep.
template <class S, int D, class Features, bool = Features::surface_velocity>
struct running_surface {
    tangential<S, D> velocity, change;

    /// In a step of h seconds, of which a substep is a share.
    template <class Body>
    running_surface(const contact<S, D, Features>& c, const Body& a, const Body& b, S h, S share)
        : change(slip_change(c, a, b, h) * (h * share)) {
        velocity = c.surface_velocity + change * S(0.5);
    }
    void take_from(tangential<S, D>& slip) const { slip -= velocity; }
    void advance() { velocity += change; }
};
template <class S, int D, class Features>
struct running_surface<S, D, Features, false> {
    template <class Body>
    running_surface(const contact<S, D, Features>&, const Body&, const Body&, S, S) {}
    void take_from(const tangential<S, D>&) const {}
    void advance() {}
};

}  // namespace detail

PHYSICS_HPP_END
