// expect: physics::recipe: the solver's in<Space, Features> needs a struct settings with a function check, and a function solve
#include <physics.hpp>

struct mine : physics::recipe<float, 3, physics::soft_step_with<physics::feature::friction>> {};

physics::world<mine> world;
