// expect: physics::recipe: the continuous policy does not model physics::continuous_for; its in<Space> needs sweep_against(body_motion) or ahead(body_motion)
#include <physics.hpp>

struct careless {
    using stage = physics::stage::continuous;
    template <class Space>
    struct in {};
};
struct mine : physics::recipe<float, 2, careless> {};

physics::world<mine> world;
