// Scenes that samples, tests and benchmarks share: one template for every scalar and dimension. What is computed here
// outside of the library is exact, or rounded once, so that worlds begin with the same bits whatever compiles this.
#pragma once

#include <physics.hpp>

namespace scenes {

/// A world with gravity 10 m/s^2 down, on a halfspace whose surface is the height 0.
template <class World>
World grounded(typename World::settings_type settings = {}) {
    using S = typename World::scalar;
    settings.gravity = {};
    settings.gravity.y = S(-10);
    World world(settings);
    world.create_shape(world.create_body({.type = physics::body_type::static_body}), typename World::halfspace{});
    return world;
}

/// A cube (2D: square) with edges of 1 m and 1 kg, its centre at x, y (and z).
template <class World>
physics::body_id add_crate(World& world, double x, double y, double z = 0) {
    using S = typename World::scalar;
    typename World::body_def def;
    def.position.x = S(x);
    def.position.y = S(y);
    if constexpr (World::dimension == 3) def.position.z = S(z);
    const physics::body_id crate = world.create_body(def);
    world.create_shape(crate, typename World::box{World::vec::filled(S(0.5))});
    return crate;
}

/// Crates one upon the other, touching; returns the top one.
template <class World>
physics::body_id stack(World& world, int height) {
    physics::body_id top;
    for (int i = 0; i < height; ++i) top = add_crate(world, 0, 0.5 + i);
    return top;
}

/// A wall of crates that narrows by one each row, touching in height and 5 cm apart in width; returns the top.
template <class World>
physics::body_id pyramid(World& world, int rows) {
    physics::body_id top;
    for (int row = 0; row < rows; ++row)
        for (int i = 0; i < rows - row; ++i) top = add_crate(world, 1.05 * (i - 0.5 * (rows - row - 1)), 0.5 + row);
    return top;
}

/// A pyramid of crates on a square base, in space; returns the top.
template <class World>
physics::body_id square_pyramid(World& world, int rows) {
    physics::body_id top;
    for (int row = 0; row < rows; ++row)
        for (int i = 0; i < rows - row; ++i)
            for (int k = 0; k < rows - row; ++k) {
                const double shift = 0.5 * (rows - row - 1);
                top = add_crate(world, 1.05 * (i - shift), 0.5 + row, 1.05 * (k - shift));
            }
    return top;
}

/// A tower of planks in space under a roof of 2 m: floors of two planks, each across those below and 25 cm narrower;
/// returns the roof.
template <class World>
physics::body_id tower(World& world, int floors) {
    using S = typename World::scalar;
    typename World::body_def def;
    for (int floor = 0; floor < floors; ++floor) {
        const double half = 1 + 0.125 * (floors - floor);
        for (const double side : {0.5 - half, half - 0.5}) {
            const bool along_x = floor % 2 == 0;
            def.position = {S(along_x ? 0 : side), S(0.25 + 0.5 * floor), S(along_x ? side : 0)};
            const physics::body_id plank = world.create_body(def);
            world.create_shape(plank,
                               typename World::box{{S(along_x ? half : 0.25), S(0.25), S(along_x ? 0.25 : half)}});
        }
    }
    def.position = {S(0), S(0.5 * floors + 0.1), S(0)};
    const physics::body_id roof = world.create_body(def);
    world.create_shape(roof, typename World::box{{S(1), S(0.1), S(1)}});
    return roof;
}

/// The kinds of joints that these scenes are made with.
using joints = physics::joints<physics::ball_joint, physics::distance_joint, physics::revolute_joint>;

/// A ball of 1 m on a chain of seven links, that is let go `angle` rad off the vertical, towards -x, under a hook that
/// holds it at height y. It has some 4,000 times (in the plane 300 times) the mass of a link. Returns the ball.
template <class World>
physics::body_id wrecking_ball(World& world, double x, double y, double angle) {
    using S = typename World::scalar;
    using rotation = physics::rotation<S, World::dimension>;
    constexpr int links = 7;
    const auto point = [](double px, double py) {
        typename World::vec v;
        v.x = S(px);
        v.y = S(py);
        return v;
    };
    // Along the chain, as capsules lie along the x axes of their bodies.
    typename World::body_def def;
    if constexpr (World::dimension == 2) def.rotation = rotation::from_angle(S(-1.5707963 - angle));
    else def.rotation = rotation::from_axis_angle({S(0), S(0), S(1)}, S(-1.5707963 - angle));
    def.position = point(x, y);
    def.type = physics::body_type::static_body;
    physics::body_id last = world.create_body(def);
    world.create_shape(last, typename World::ball{S(0.15)});
    def.type = physics::body_type::dynamic_body;
    for (int i = 0; i <= links; ++i) {
        const bool is_ball = i == links;
        const double half = is_ball ? 1 : 0.5;
        def.position = point(x, y) + def.rotation * point(i + half, 0);
        const physics::body_id next = world.create_body(def);
        if (is_ball) world.create_shape(next, typename World::ball{S(half)}, {.density = S(20)});
        else world.create_shape(next, typename World::capsule{S(half), S(0.08)});
        world.create_joint(last, next, typename World::ball_joint{point(i > 0 ? 0.5 : 0, 0), point(-half, 0)});
        last = next;
    }
    return last;
}

/// A person of eleven bodies, 1.75 m tall: head, trunk and pelvis, arms and legs of two bodies each, all of this
/// density. Neck, spine, elbows and knees are hinges with limits and friction; shoulders and hips are ball joints, of
/// which ropes keep upper arms and thighs within cones. Knees and elbows have the user data 1. The feet are at the
/// place's origin, the face is towards z. Returns the trunk.
template <class World>
physics::body_id ragdoll(World& world, const physics::transform<typename World::scalar, 3>& place, double density) {
    using S = typename World::scalar;
    using rotation = physics::rotation<S, 3>;
    const auto at = [](double x, double y, double z = 0) { return typename World::vec{S(x), S(y), S(z)}; };
    const auto part = [&](const typename World::vec& center, const auto& shape) {
        typename World::body_def def;
        def.position = place.position + place.rotation * center;
        def.rotation = place.rotation;
        const physics::body_id id = world.create_body(def);
        typename World::shape_def flesh;
        flesh.density = S(density);
        // Upright, as limbs are.
        flesh.rotation = rotation::from_axis_angle(at(0, 0, 1), S(1.5707963));
        world.create_shape(id, shape, flesh);
        return id;
    };
    // Joints are told where they are in the person.
    const auto hinge = [&](physics::body_id a, const auto& center_a, physics::body_id b, const auto& center_b,
                           const auto& center, double min, double max, std::uint64_t user_data = 0) {
        typename World::revolute_joint joint;
        // Its z axis is the person's x axis.
        joint.frame_a = {center - center_a, rotation::from_z_axis(at(1, 0, 0))};
        joint.frame_b = {center - center_b, joint.frame_a.rotation};
        joint.min_angle = S(min);
        joint.max_angle = S(max);
        joint.max_motor_torque = S(0.005 * density);
        world.create_joint(a, b, joint, {.user_data = user_data});
    };
    const auto socket = [&](physics::body_id a, const auto& center_a, physics::body_id b, const auto& center_b,
                            const auto& center, double length, const auto& axis, double cone) {
        world.create_joint(a, b, typename World::ball_joint{center - center_a, center - center_b});
        // The end of the limb stays near the end of the cone's axis.
        typename World::distance_joint rope;
        rope.anchor_a = center - center_a + axis * S(length);
        rope.anchor_b = center - center_b + at(0, -length);
        rope.min_length = S(0);
        rope.max_length = S(2 * length * physics::sin(cone / 2));
        world.create_joint(a, b, rope);
    };
    const auto pelvis_at = at(0, 0.96), trunk_at = at(0, 1.27), head_at = at(0, 1.62);
    const physics::body_id pelvis = part(pelvis_at, typename World::box{at(0.08, 0.16, 0.09)});
    const physics::body_id trunk = part(trunk_at, typename World::box{at(0.2, 0.18, 0.1)});
    const physics::body_id head = part(head_at, typename World::ball{S(0.12)});
    hinge(pelvis, pelvis_at, trunk, trunk_at, at(0, 1.05), -0.3, 0.8);
    hinge(trunk, trunk_at, head, head_at, at(0, 1.5), -0.5, 0.7);
    for (const double side : {-1.0, 1.0}) {
        const auto thigh_at = at(0.1 * side, 0.69), shin_at = at(0.1 * side, 0.25);
        const auto arm_at = at(0.26 * side, 1.27), forearm_at = at(0.26 * side, 0.97);
        const physics::body_id thigh = part(thigh_at, typename World::capsule{S(0.16), S(0.08)});
        const physics::body_id shin = part(shin_at, typename World::capsule{S(0.18), S(0.07)});
        const physics::body_id arm = part(arm_at, typename World::capsule{S(0.11), S(0.05)});
        const physics::body_id forearm = part(forearm_at, typename World::capsule{S(0.12), S(0.045)});
        socket(pelvis, pelvis_at, thigh, thigh_at, at(0.1 * side, 0.9), 0.43, at(0.2 * side, -0.8, 0.5657), 0.8);
        hinge(thigh, thigh_at, shin, shin_at, at(0.1 * side, 0.47), 0, 2.3, 1);
        socket(trunk, trunk_at, arm, arm_at, at(0.26 * side, 1.42), 0.3, at(0.6 * side, -0.6, 0.5292), 1.3);
        hinge(arm, arm_at, forearm, forearm_at, at(0.26 * side, 1.12), -2.3, 0, 1);
    }
    return trunk;
}

/// The flagship in the plane: a wrecking ball swings into a pyramid of crates within two seconds.
template <class World>
void wrecked_pyramid(World& world) {
    pyramid(world, 10);
    wrecking_ball(world, -4.2, 12.5, 1.25);
}
/// And in space: eight ragdolls fall on the edges of a tower's roof, and tumble down.
template <class World>
void ragdoll_tower(World& world) {
    using S = typename World::scalar;
    using vec = physics::vec<S, 3>;
    using rotation = physics::rotation<S, 3>;
    const double top = 5.2;
    tower(world, 10);
    for (int i = 0; i < 8; ++i) {
        // Face down, head first over an edge.
        const rotation turned = rotation::from_axis_angle({S(0), S(1), S(0)}, S(0.3)) *
                                rotation::from_axis_angle({S(0), S(1), S(0)}, S(1.5707963 * i)) *
                                rotation::from_axis_angle({S(1), S(0), S(0)}, S(1.5707963));
        const vec feet = turned * vec{S(i % 2 == 0 ? 0.1 : -0.2), S(0.2), S(0)};
        ragdoll(world, {feet + vec{S(0), S(top + 0.5 * i + 0.75), S(0)}, turned}, 1);
    }
}

/// The flagship scenes. Calls visit(world, number of steps taken) before the first step and after each one.
template <class World, class Build, class Visit>
World flagship(Build&& build, int steps, Visit&& visit) {
    using S = typename World::scalar;
    World world = grounded<World>();
    build(world);
    visit(world, 0);
    for (int i = 1; i <= steps; ++i) {
        world.step(S(1.0 / 60));
        visit(world, i);
    }
    return world;
}

/// Energy of motion (J), in double.
template <class World>
double kinetic_energy(const World& world) {
    double sum = 0;
    for (const physics::body_id id : world.bodies()) {
        if (world.type(id) != physics::body_type::dynamic_body) continue;
        const auto v = world.linear_velocity(id);
        const auto m = world.mass(id);
        double speed2 = 0;
        for (int i = 0; i < World::dimension; ++i) speed2 += static_cast<double>(v[i]) * static_cast<double>(v[i]);
        sum += 0.5 * static_cast<double>(m.mass) * speed2;
        if constexpr (World::dimension == 2) {
            const double w = static_cast<double>(world.angular_velocity(id));
            sum += 0.5 * static_cast<double>(m.inertia) * w * w;
        } else {
            const auto w = inverse_rotate(world.rotation(id), world.angular_velocity(id));
            const double x = static_cast<double>(w.x), y = static_cast<double>(w.y), z = static_cast<double>(w.z);
            const auto n = [](auto s) { return static_cast<double>(s); };
            sum += 0.5 * (n(m.inertia.xx) * x * x + n(m.inertia.yy) * y * y + n(m.inertia.zz) * z * z) +
                   n(m.inertia.xy) * x * y + n(m.inertia.xz) * x * z + n(m.inertia.yz) * y * z;
        }
    }
    return sum;
}

/// The deepest overlap among the contacts (m), in double; 0 where surfaces only touch.
template <class World>
double deepest_overlap(const World& world) {
    double deepest = 0;
    for (const auto contact : world.contacts())
        for (int k = 0; k < contact.count; ++k) {
            const double depth = -static_cast<double>(contact.points[k].separation);
            if (depth > deepest) deepest = depth;
        }
    return deepest;
}

}  // namespace scenes
