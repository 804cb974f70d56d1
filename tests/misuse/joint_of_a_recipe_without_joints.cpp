// expect: physics::world: the recipe knows no joints; name their kinds in physics::joints<...>
#include <physics.hpp>

struct mine : physics::recipe<float, 2> {};

void join(physics::world<mine>& world, physics::body_id a, physics::body_id b) {
    world.create_joint(a, b, physics::world<mine>::distance_joint{});
}
