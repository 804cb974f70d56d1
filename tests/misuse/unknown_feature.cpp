// expect: physics::without: an argument is not a feature; the features are those of namespace physics::feature
#include <physics.hpp>

struct gravity {};
struct mine : physics::recipe<float, 2, physics::without<physics::feature::friction, gravity>> {};

physics::world<mine> world;
