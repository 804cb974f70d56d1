// expect: physics::fixed: the fraction must have at least one bit and leave at least one for the integer part
#include <physics.hpp>

physics::fixed<std::int32_t, 31> number;
