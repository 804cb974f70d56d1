// expect: physics::recipe: a policy names a stage that only physics::shapes<...>, physics::joints<...>, physics::without<...>, physics::events<...> or physics::user_types<...> may serve
#include <physics.hpp>

struct balls {
    using stage = physics::stage::shapes;
};
struct mine : physics::recipe<float, 2, balls> {};

physics::world<mine> world;
