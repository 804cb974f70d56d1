// expect: physics::fixed: the representation must be std::int32_t or std::int64_t
#include <physics.hpp>

physics::fixed<short, 8> number;
