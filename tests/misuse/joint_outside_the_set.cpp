// expect: physics::world: the recipe's set of joints lacks this one; name it in physics::joints<...>
#include <physics.hpp>

template <class S, int D>
struct leash : physics::distance_joint<S, D> {};
struct mine : physics::recipe<float, 2, physics::joints<physics::distance_joint>> {};

void join(physics::world<mine>& world, physics::body_id a, physics::body_id b) {
    world.create_joint(a, b, leash<float, 2>{});
}
