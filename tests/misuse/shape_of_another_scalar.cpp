// expect: physics::world::create_shape: the recipe's set of shapes lacks this one; name it in physics::shapes<...>
#include <physics.hpp>

struct mine : physics::recipe<float, 2> {};

void add_ball(physics::world<mine>& world, physics::body_id body) {
    world.create_shape(body, physics::circle<double>{0.5});
}
