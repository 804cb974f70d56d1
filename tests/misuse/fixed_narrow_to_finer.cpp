// expect: physics::narrow: the result must have fewer fraction bits than the product
#include <physics.hpp>

const auto number = physics::narrow<physics::fixed32>(product(physics::fixed16(2), physics::fixed16(3)));
