// expect: physics::recipe: the solver does not say that it solves joints; with physics::solver_api::joint_solver it does, and says so by static constexpr bool solves_joints = true
#include <physics.hpp>

struct contacts_only {
    using stage = physics::stage::solver;
    template <class Space, class Features>
    struct in {
        using settings = physics::sequential_impulse_settings<typename Space::scalar>;
        template <class Bodies, class Contacts, class S, class Motion>
        static void solve(Bodies, const Contacts&, const settings&, S, physics::arena&, Motion&&) {}
    };
};
struct mine : physics::recipe<float, 2, contacts_only, physics::joints<physics::distance_joint>> {};

physics::world<mine> world;
