// expect: physics::joints: a joint stands in the set twice
#include <physics.hpp>

struct mine : physics::recipe<float, 2, physics::joints<physics::distance_joint, physics::distance_joint>> {};

physics::world<mine> world;
