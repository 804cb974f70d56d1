// What the units of the linking test tell each other: a recipe that two of them use, and one function each.
#pragma once

#include <physics.hpp>

#include <cstdint>

struct shared_recipe : physics::recipe<float, 2> {};

/// A ball and a box land on the ground; the state after a second.
template <class Recipe>
std::uint64_t hash_of_landing() {
    using world = physics::world<Recipe>;
    world w;
    const auto ground = w.create_body({.type = physics::body_type::static_body});
    w.create_shape(ground, typename world::halfspace{});
    for (int i = 0; i < 2; ++i) {
        typename world::body_def def;
        def.position.x = typename world::scalar(i);
        def.position.y = typename world::scalar(2);
        const auto body = w.create_body(def);
        if (i == 0) w.create_shape(body, typename world::ball{});
        else w.create_shape(body, typename world::box{});
    }
    for (int i = 0; i < 64; ++i) w.step(typename world::scalar(1.0 / 64));
    return w.state_hash();
}

/// A ball falls for a second.
template <class World>
std::uint64_t hash_of_fall() {
    World w;
    w.create_shape(w.create_body(), typename World::ball{});
    for (int i = 0; i < 64; ++i) w.step(typename World::scalar(1.0 / 64));
    return World(w).state_hash();
}

/// Defined in one.cpp: the shared recipe, and a recipe of that unit alone.
std::uint64_t shared_hash_in_one();
std::uint64_t own_hash_in_one();
/// Of a recipe that has another one's name in two.cpp.
std::uint64_t namesake_hash_in_one();
/// Defined in audited.cpp, which is built with other options: there, all types are others.
int overflows_in_audited();
std::uint64_t shared_hash_in_audited();
