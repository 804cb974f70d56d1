// expect: physics::recipe: a policy names no stage; give it `using stage = physics::stage::...`
#include <physics.hpp>

struct fast {};
struct mine : physics::recipe<float, 2, fast> {};

physics::world<mine> world;
