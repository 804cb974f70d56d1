// expect: physics::recipe: no snapshot of the world can be made, as the solver's settings are not trivially copyable
#include <physics.hpp>

struct listening {
    using stage = physics::stage::solver;
    template <class Space, class Features>
    struct in : physics::soft_step::in<Space, Features> {
        struct settings : physics::soft_step::in<Space, Features>::settings {
            physics::buffer<float> heard;
        };
    };
};
struct mine : physics::recipe<float, 2, listening> {};

using plan = physics::detail::plan_of<mine>::type;
bool there_and_back(physics::detail::raw_snapshot<plan>& snapshot, physics::detail::world_data<plan>& state) {
    snapshot.save(state);
    return snapshot.restore(state);
}
