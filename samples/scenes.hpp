// Scenes that samples, tests and benchmarks share: one template for every scalar and dimension.
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

/// A tower of planks in space: floors of two planks, each across those below; returns the last plank.
template <class World>
physics::body_id tower(World& world, int floors) {
    using S = typename World::scalar;
    physics::body_id top;
    for (int floor = 0; floor < floors; ++floor)
        for (const double side : {-1.0, 1.0}) {
            const bool along_x = floor % 2 == 0;
            typename World::body_def def;
            def.position = {S(along_x ? 0 : side), S(0.25 + 0.5 * floor), S(along_x ? side : 0)};
            top = world.create_body(def);
            world.create_shape(top, typename World::box{{S(along_x ? 1.5 : 0.25), S(0.25), S(along_x ? 0.25 : 1.5)}});
        }
    return top;
}

/// A heavy ball of 0.5 m that waits on the ground, to the left.
template <class World>
physics::body_id waiting_ball(World& world) {
    using S = typename World::scalar;
    typename World::body_def def;
    def.position.x = S(-9);
    def.position.y = S(0.5);
    const physics::body_id ball = world.create_body(def);
    world.create_shape(ball, typename World::ball{S(0.5)}, {.density = S(4)});
    return ball;
}

/// The flagship scenes: a structure stands for four seconds, then a ball flies into it. Calls
/// visit(world, number of steps taken) before the first step and after each one.
template <class World, class Build, class Visit>
World flagship(Build&& build, int steps, Visit&& visit) {
    using S = typename World::scalar;
    World world = grounded<World>();
    build(world);
    const physics::body_id ball = waiting_ball(world);
    visit(world, 0);
    for (int i = 1; i <= steps; ++i) {
        if (i == 240) {
            typename World::vec v;
            v.x = S(12);
            v.y = S(4);
            world.set_linear_velocity(ball, v);
        }
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
