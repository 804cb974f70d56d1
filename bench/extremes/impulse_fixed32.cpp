// The library in Q32.32, by its solver sequential_impulse.
#include "plays.hpp"

namespace bench {

namespace {

const enlisted_column it({"sequential_impulse-fixed32", 5, cells_of<physics::fixed32, physics::sequential_impulse>});

}  // namespace

}  // namespace bench
