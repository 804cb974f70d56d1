// expect: physics::recipe: a policy names a stage that only physics::shapes<...>, physics::joints<...>, physics::without<...>, physics::events<...> or physics::user_types<...> may serve
#include <physics.hpp>

struct everything {
    using stage = physics::stage::events;
};
struct mine : physics::recipe<float, 2, everything> {};

physics::world<mine> world;
