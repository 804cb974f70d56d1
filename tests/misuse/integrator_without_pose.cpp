// expect: physics::recipe: the integrator's in<Space> needs advance_velocity and advance_pose; without rotation for physics::linear_twist and physics::moving_body<S, D, false>
#include <physics.hpp>

struct half_euler {
    using stage = physics::stage::integrator;
    template <class Space>
    struct in {
        template <class... Arguments>
        static void advance_velocity(Arguments&&...);
    };
};
struct mine : physics::recipe<float, 2, half_euler> {};

physics::world<mine> world;
