// The library in float, by its solver sequential_impulse.
#include "plays.hpp"

namespace bench {

namespace {

const enlisted_column it({"sequential_impulse-float", 3, cells_of<float, physics::sequential_impulse>});

}  // namespace

}  // namespace bench
