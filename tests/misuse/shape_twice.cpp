// expect: physics::shapes: a shape stands in the set twice
#include <physics.hpp>

struct mine : physics::recipe<float, 2, physics::shapes<physics::ball, physics::box, physics::circle>> {};

physics::world<mine> world;
