// expect: physics::recipe: the scalar is not a physics::scalar_type; use float, double, physics::fixed32, or specialise physics::scalar_traits
#include <physics.hpp>

struct mine : physics::recipe<int, 2> {};

physics::world<mine> world;
