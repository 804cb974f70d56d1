// expect: physics::shapes: the set is empty; name at least one shape
#include <physics.hpp>

struct mine : physics::recipe<float, 2, physics::shapes<>> {};

physics::world<mine> world;
