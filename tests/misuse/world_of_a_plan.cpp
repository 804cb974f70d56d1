// expect: physics::world: the second argument is not for you; write world<mine>
#include <physics.hpp>

struct mine : physics::recipe<float, 2> {};

physics::world<mine, float> world;
