// expect: physics::recipe: two policies serve the same stage; keep one of them
#include <physics.hpp>

struct other {
    using stage = physics::stage::broadphase;
    template <class Space>
    using in = physics::all_pairs::in<Space>;
};
struct mine : physics::recipe<float, 2, physics::all_pairs, physics::sequential_impulse, other> {};

physics::world<mine> world;
