// expect: physics::accumulator: the argument is not a world; write physics::accumulator<physics::world<mine>>
#include <physics.hpp>

struct mine : physics::recipe<float, 2> {};

physics::accumulator<mine> clock;
