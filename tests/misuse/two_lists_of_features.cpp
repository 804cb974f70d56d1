// expect: physics::recipe: two policies serve the same stage; keep one of them
#include <physics.hpp>

struct mine : physics::recipe<float, 2, physics::without<physics::feature::friction>,
                              physics::without<physics::feature::restitution>> {};

physics::world<mine> world;
