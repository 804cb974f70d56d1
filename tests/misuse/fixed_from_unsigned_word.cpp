// expect: physics::fixed: converts from integers that fit in std::int64_t
#include <physics.hpp>

const physics::fixed32 number(std::uint64_t{1} << 63);
