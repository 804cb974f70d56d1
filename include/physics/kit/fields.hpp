// Fields and explosions: what acts on bodies by where they are and how they move.
#pragma once

#include "physics/world/world.hpp"

PHYSICS_HPP_BEGIN

/// Gravity towards a point, as that of a planet: greatest at its surface, by the square of the distance outside, in
/// proportion to it inside.
template <class S, int D>
struct gravity_well {
    vec<S, D> center = {};
    /// Of the planet (m), and the acceleration at its surface (m/s^2); negative pushes away.
    S radius = S(1);
    S acceleration = S(10);
};

/// Air that moves, and slows down by the square of the speed what moves in it.
template <class S, int D>
struct wind {
    /// How fast the air moves (m/s).
    vec<S, D> velocity = {};
    /// Half the density of the air, times a drag coefficient (kg/m^3; in 2D kg/m^2).
    S drag = S(0.6);
};

/// An explosion: an impulse on each side that faces it.
template <class S, int D>
struct explosion {
    vec<S, D> center = {};
    /// Within this distance it acts in full, and less and less to nothing over the falloff behind it (m).
    S radius = S(1);
    S falloff = S(1);
    /// What each square metre that faces the centre is given, in 2D each metre (N s); negative: an implosion.
    S impulse = S(1);
    /// Which shapes it meets; those of static and kinematic bodies it leaves alone.
    query_filter filter = {};
};

namespace detail {

/// The area of a box as seen along a unit vector (m^2, in 2D m).
template <class S>
S area_facing(const aabb<S, 2>& box, const vec<S, 2>& along) {
    const vec<S, 2> size = box.upper - box.lower, n = abs(along);
    return size.x * n.y + size.y * n.x;
}
template <class S>
S area_facing(const aabb<S, 3>& box, const vec<S, 3>& along) {
    const vec<S, 3> size = box.upper - box.lower, n = abs(along);
    return size.y * size.z * n.x + size.z * size.x * n.y + size.x * size.y * n.z;
}
/// Around all shapes of a body that are no sensors; false if there are none.
template <class World>
bool bounds_of_body(const World& w, body_id id, aabb<typename World::scalar, World::dimension>& box) {
    bool any = false;
    for (const shape_id shape : w.shapes(id)) {
        if (w.is_sensor(shape)) continue;
        const auto pose = w.pose(id) * w.local_pose(shape);
        const auto own = w.shape(shape).visit([&](const auto& s) { return bounds(s, pose); });
        box = any ? merged(box, own) : own;
        any = true;
    }
    return any;
}
/// How fast a body will be after a step of dt seconds if nothing but the world's gravity acts on it.
template <class World, class S>
auto velocity_after(const World& w, body_id b, S dt) {
    return w.linear_velocity(b) + w.settings().gravity * (w.gravity_scale(b) * dt);
}
/// Calls f(body) for the dynamic bodies that are awake and enabled.
template <class World, class F>
void each_awake(World& w, F&& f) {
    for (const body_id b : w.bodies())
        if (w.type(b) == body_type::dynamic_body && w.enabled(b) && !w.is_asleep(b)) f(b);
}

}  // namespace detail

/// Pulls all bodies that are awake, in the next step, towards the centre: call it before each. What sleeps it lets
/// sleep; wake it where the field changes. Refuses a radius that is not positive. O(bodies).
template <class World>
void apply_gravity_well(World& w, const gravity_well<typename World::scalar, World::dimension>& well) {
    using S = typename World::scalar;
    const char* f = "apply_gravity_well";
    if (!detail::check_in_range(f, "center", well.center) || !detail::check_positive(f, "radius", well.radius) ||
        !detail::check_in_range(f, "acceleration", well.acceleration))
        return;
    detail::scoped([&] {
        detail::each_awake(w, [&](body_id b) {
            const auto [direction, distance] = direction_and_length_of(well.center - w.center_of_mass(b));
            const S part = distance > well.radius ? well.radius / distance : distance / well.radius;
            const S factor = distance > well.radius ? part * part : part;
            w.apply_force(b, direction * (well.acceleration * factor * w.gravity_scale(b) * w.mass(b).mass));
        });
    });
}

/// Blows on all bodies that are awake, in a next step of dt seconds: call it before each. The force is drag times the
/// area of the body's box that faces the wind times the square of the speed against it; no step is so long that it
/// turns a body around. What sleeps it lets sleep. Refuses a negative drag. O(bodies + shapes).
template <class World>
void apply_wind(World& w, const wind<typename World::scalar, World::dimension>& of, typename World::scalar dt) {
    using S = typename World::scalar;
    const char* f = "apply_wind";
    if (!detail::check_in_range(f, "velocity", of.velocity) || !detail::check_not_negative(f, "drag", of.drag) ||
        !detail::check_positive(f, "dt", dt))
        return;
    detail::scoped([&] {
        detail::each_awake(w, [&](body_id b) {
            aabb<S, World::dimension> box;
            // By the speed at the end of the step, so that no step is too long: u + a u^2 = what it is without wind.
            const auto [direction, speed] = direction_and_length_of(of.velocity - detail::velocity_after(w, b, dt));
            if (!(speed > S(0)) || !detail::bounds_of_body(w, b, box)) return;
            const S drag = of.drag * detail::area_facing(box, direction), a = drag * dt / w.mass(b).mass;
            const S then = S(2) * speed / (S(1) + physics::sqrt(S(1) + S(4) * a * speed));
            w.apply_force(b, direction * (drag * then * then));
        });
    });
}

/// Throws what is near at once, from the centre outwards at the nearest point of each shape, so that it spins too, and
/// wakes it. A shape about the centre is thrown from its middle. The area that faces the centre is that of the shape's
/// box. Refuses negative lengths. Cost: that of each_overlapping, and of a distance for each shape.
template <class World>
void explode(World& w, const explosion<typename World::scalar, World::dimension>& of) {
    using S = typename World::scalar;
    constexpr int D = World::dimension;
    const char* f = "explode";
    if (!detail::check_in_range(f, "center", of.center) || !detail::check_not_negative(f, "radius", of.radius) ||
        !detail::check_not_negative(f, "falloff", of.falloff) || !detail::check_in_range(f, "impulse", of.impulse))
        return;
    const S reach = of.radius + of.falloff;
    if (!(reach > S(0))) return;
    w.each_overlapping(ball<S, D>{reach}, {of.center, {}}, of.filter, [&](shape_id shape) {
        const body_id b = w.body(shape);
        if (w.type(b) != body_type::dynamic_body || w.is_sensor(shape)) return;
        detail::scoped([&] {
            const auto pose = w.pose(b) * w.local_pose(shape);
            w.shape(shape).visit([&](const auto& s) {
                const auto c = detail::separation_within(s, detail::point_shape<S, D>{},
                                                         relative(pose, transform<S, D>{of.center, {}}), reach);
                const bool is_inside = !(c.distance > S(0));
                const auto away = is_inside ? w.center_of_mass(b) - of.center : -(pose.rotation * c.normal);
                const auto direction = normalized(away);
                const S beyond = c.distance - of.radius;
                const S part =
                    beyond > S(0) ? (of.falloff > S(0) ? max(S(1) - beyond / of.falloff, S(0)) : S(0)) : S(1);
                const S size = of.impulse * part * detail::area_facing(bounds(s, pose), direction);
                w.apply_impulse_at(b, direction * size, is_inside ? w.center_of_mass(b) : pose * c.on_a);
            });
        });
    });
}

PHYSICS_HPP_END
