// expect: physics::world: the argument is not a recipe; write struct mine : physics::recipe<float, 2> {} and physics::world<mine>
#include <physics.hpp>

physics::world<float> world;
