// expect: physics::recipe: the broadphase does not model physics::broadphase_for; its in<Space> needs insert, move, erase and pairs
#include <physics.hpp>

struct grid {
    using stage = physics::stage::broadphase;
};
struct mine : physics::recipe<float, 2, grid> {};

physics::world<mine> world;
