// expect: physics::recipe: a policy names no stage; give it `using stage = physics::stage::...`
#include <physics.hpp>

struct mine : physics::recipe<float, 2, int> {};

float height_of_a_fall() {
    physics::world<mine> world({.gravity = {0, -10}});
    const physics::body_id ball = world.create_body({.position = {0, 4}});
    world.create_shape(ball, physics::world<mine>::ball{0.5f}, {.density = 2});
    physics::accumulator<physics::world<mine>> clock;
    clock.advance(world, 1.0f / 60);
    return world.position(ball).y;
}
