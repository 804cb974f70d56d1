// expect: physics::recipe: the integrator's in<Space> needs integrate_velocity and integrate_pose; without rotation for physics::solver_api::linear_twist and physics::solver_api::moving_body<S, D, false>
#include <physics.hpp>

struct half_euler {
    using stage = physics::stage::integrator;
    template <class Space>
    struct in {
        template <class... Arguments>
        static void integrate_velocity(Arguments&&...);
    };
};
struct mine : physics::recipe<float, 2, half_euler> {};

physics::world<mine> world;
