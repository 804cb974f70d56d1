// expect: physics::joints: a type of the set does not model physics::joint_for; it needs a list of its members, check, row_count and rows(frames, row)
#include <physics.hpp>

template <class S, int D>
struct glue {
    S strength{};
    static constexpr int row_count = 1;
};
struct mine : physics::recipe<float, 2, physics::joints<glue>> {};

physics::world<mine> world;
