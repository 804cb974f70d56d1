// expect: physics::recipe: a policy names a stage that only physics::shapes<...>, physics::joints<...>, physics::without<...>, physics::events<...> or physics::user_types<...> may serve
#include <physics.hpp>

struct bare {
    using stage = physics::stage::features;
    static constexpr bool friction = false;
    static constexpr bool restitution = false;
};
struct mine : physics::recipe<float, 2, bare> {};

physics::world<mine> world;
