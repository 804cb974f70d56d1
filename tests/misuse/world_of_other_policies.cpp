// expect: physics::world: the argument is not a recipe; write struct mine : physics::recipe<float, 2> {} and physics::world<mine>
#include <physics.hpp>

struct mine {
    using scalar = float;
    static constexpr int dimension = 2;
    using policies = int;
};

physics::world<mine> world;
