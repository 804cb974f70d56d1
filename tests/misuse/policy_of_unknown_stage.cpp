// expect: physics::recipe: a policy names a stage that does not exist; the stages are those of namespace physics::stage
#include <physics.hpp>

struct sound {
    struct stage {};
};
struct mine : physics::recipe<float, 2, sound> {};

physics::world<mine> world;
