// expect: physics::root: the operand must have at least twice the result's fraction bits
#include <physics.hpp>

const auto number = physics::root<physics::fixed32>(product(physics::fixed16(2), physics::fixed16(3)));
