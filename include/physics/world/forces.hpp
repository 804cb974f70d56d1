// Forces, torques and impulses that calls apply to bodies, and velocities of their points.
#pragma once

#include "physics/world/edit.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Stores a quantity that an action has changed, unless it is beyond the scalar's range: false then. Sums of two that
/// are in range show it.
template <class Quantity>
bool assign(Quantity& to, const Quantity& value) {
    if (!is_in_range(value)) return false;
    to = value;
    return true;
}
/// The same of what sums of products have come to: where they wrap, the exact value is asked for.
template <class Quantity, class Exact>
bool assign(Quantity& to, const Quantity& value, Exact&& exact) {
    if constexpr (is_fixed<scalar_of<Quantity>>)
        if (!is_representable(value, exact())) return false;
    return assign(to, value);
}
inline bool refuse_action(const char* function, const char* field, double size) {
    return refuse(function, field, size, "with it a force or velocity of the body would be beyond the scalar's range");
}

/// The velocity of a body at a point of the world; refused where it would leave the scalar's range.
template <class Plan>
vec<typename Plan::scalar, Plan::dimension> velocity_of_point(const state<Plan>& s, body_id id,
                                                              vec<typename Plan::scalar, Plan::dimension> point) {
    const char* f = "velocity_at";
    const lookup at = find_body(s, id, f);
    if (!at || !check_in_range(f, "point", point)) return {};
    const auto& b = s.bodies[at.index];
    const auto r = point - b.center;
    if (has_velocity_at(b.velocity, r)) return velocity_at(b.velocity, r);
    refuse_action(f, "point", largest_magnitude(point));
    return {};
}
/// Calls f(body, force, r) with a force or impulse, and where it acts from the centre of mass, in world axes;
/// f says whether the body can take it.
template <class Plan, class F>
void apply_at(world_data<Plan>& s, body_id id, const char* function, const char* field,
              vec<typename Plan::scalar, Plan::dimension> force, bool local,
              const vec<typename Plan::scalar, Plan::dimension>* point, F&& f) {
    const lookup at = if_enabled(s, find_dynamic(s, id, function), function);
    if (!at || !check_in_range(function, field, force) || (point && !check_in_range(function, "point", *point))) return;
    auto& b = s.bodies[at.index];
    vec<typename Plan::scalar, Plan::dimension> anchor;
    if (point) anchor = local ? b.rotation * (*point - b.mass.center) : *point - b.center;
    prepare_waking_of(s, at.index);
    if (!f(b, local ? b.rotation * force : force, anchor)) refuse_action(function, field, largest_magnitude(force));
    else if (!(force == decltype(force){})) finish_waking(s);
}
template <class Plan>
void add_force(world_data<Plan>& s, body_id id, const char* function, vec<typename Plan::scalar, Plan::dimension> force,
               bool local, const vec<typename Plan::scalar, Plan::dimension>* point) {
    apply_at(s, id, function, "force", force, local, point, [](auto& b, auto f, [[maybe_unused]] auto anchor) {
        if constexpr (Plan::rotates) {
            auto torque = b.torque;
            const auto exact = [&] {
                return converted<double>(b.torque) + cross(converted<double>(anchor), converted<double>(f));
            };
            if (!assign(torque, b.torque + cross(anchor, f), exact) || !assign(b.force, b.force + f)) return false;
            b.torque = torque;
            return true;
        } else {
            return assign(b.force, b.force + f);
        }
    });
}
/// The velocity of a body after an impulse at r, computed with the scalar T.
template <class T, class S, int D, bool Rotates>
auto after_impulse(const body<S, D, Rotates>& b, const vec<S, D>& impulse, [[maybe_unused]] const vec<S, D>& anchor) {
    solver_body<T, D, Rotates> v{converted<T>(b.velocity), {}, static_cast<inverse_of<T>>(b.inverse_mass), {}};
    if constexpr (Rotates) v.inverse_inertia = converted<inverse_of<T>>(in_world(b.inverse_inertia, b.rotation));
    v.apply(converted<T>(impulse), converted<T>(anchor));
    return v.velocity;
}
template <class Plan>
void add_impulse(world_data<Plan>& s, body_id id, const char* function,
                 vec<typename Plan::scalar, Plan::dimension> impulse, bool local,
                 const vec<typename Plan::scalar, Plan::dimension>* point) {
    apply_at(s, id, function, "impulse", impulse, local, point, [](auto& b, auto p, auto anchor) {
        auto v = after_impulse<typename Plan::scalar>(b, p, anchor);
        const auto after = v;
        if (!assign(v.linear, after.linear, [&] { return after_impulse<double>(b, p, anchor).linear; })) return false;
        if constexpr (Plan::rotates)
            if (!assign(v.angular, after.angular, [&] { return after_impulse<double>(b, p, anchor).angular; }))
                return false;
        b.velocity = v;
        return true;
    });
}
template <class Plan>
void add_torque(world_data<Plan>& s, body_id id, physics::angular<typename Plan::scalar, Plan::dimension> torque) {
    const char* f = "apply_torque";
    const lookup at = if_enabled(s, find_dynamic(s, id, f), f);
    if (!at || !check_in_range(f, "torque", torque)) return;
    auto& b = s.bodies[at.index];
    prepare_waking_of(s, at.index);
    if (!assign(b.torque, b.torque + torque)) refuse_action(f, "torque", largest_magnitude(torque));
    else if (!(torque == decltype(torque){})) finish_waking(s);
}
template <class Plan>
void add_angular_impulse(world_data<Plan>& s, body_id id,
                         physics::angular<typename Plan::scalar, Plan::dimension> impulse) {
    const char* f = "apply_angular_impulse";
    const lookup at = if_enabled(s, find_dynamic(s, id, f), f);
    if (!at || !check_in_range(f, "impulse", impulse)) return;
    auto& b = s.bodies[at.index];
    const auto inverse_inertia = in_world(b.inverse_inertia, b.rotation);
    const auto exact = [&] {
        return converted<double>(b.velocity.angular) +
               times(converted<double>(inverse_inertia), converted<double>(impulse));
    };
    prepare_waking_of(s, at.index);
    if (!assign(b.velocity.angular, b.velocity.angular + times(inverse_inertia, impulse), exact))
        refuse_action(f, "impulse", largest_magnitude(impulse));
    else if (!(impulse == decltype(impulse){})) finish_waking(s);
}

}  // namespace detail

PHYSICS_HPP_END
