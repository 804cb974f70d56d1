// The library in double, by its solver sequential_impulse.
#include "plays.hpp"

namespace bench {

namespace {

const enlisted_column it({"sequential_impulse-double", 4, cells_of<double, physics::sequential_impulse>});

}  // namespace

}  // namespace bench
