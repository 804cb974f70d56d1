// The library in Q32.32, by its solver soft_step.
#include "plays.hpp"

namespace bench {

namespace {

const enlisted_column it({"soft_step-fixed32", 2, cells_of<physics::fixed32, physics::soft_step>});

}  // namespace

}  // namespace bench
