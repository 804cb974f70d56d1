// A crate falls on the ground. Build by hand: c++ -std=c++20 -O2 -I. samples/01_hello.cpp -o hello && ./hello
#include <physics.hpp>

#include <cstdio>

struct crates : physics::recipe<float, 2> {};  // the scalar, the dimension; every policy by default
using world = physics::world<crates>;

int main() {
    world arena{{.gravity = {0, -10}}};

    const physics::body_id ground = arena.create_body({.type = physics::body_type::static_body});
    arena.create_shape(ground, world::box{{50, 1}});  // half extents in metres

    const physics::body_id crate = arena.create_body({.position = {0, 4}, .angular_velocity = 1});
    arena.create_shape(crate, world::box{{0.5, 0.5}}, {.density = 2, .material = {.restitution = 0.3f}});

    for (int frame = 0; frame <= 120; ++frame) {
        if (frame % 15 == 0) {
            const auto [position, rotation] = arena.pose(crate);
            std::printf("%.2f s: x %+.3f m, y %.3f m, turned %+.3f rad, %u contacts\n", frame / 60.0, position.x,
                        position.y, rotation.angle(), arena.contacts().size());
        }
        arena.step(1.0f / 60);
    }
}
