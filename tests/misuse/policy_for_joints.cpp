// expect: physics::recipe: a policy names a stage that only physics::shapes<...>, physics::joints<...>, physics::without<...>, physics::events<...> or physics::user_types<...> may serve
#include <physics.hpp>

struct hinges {
    using stage = physics::stage::joints;
};
struct mine : physics::recipe<float, 2, hinges> {};

physics::world<mine> world;
