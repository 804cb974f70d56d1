// expect: physics::recipe: the dimension must be 2 or 3
#include <physics.hpp>

struct mine : physics::recipe<float, 4> {};

physics::world<mine> world;
