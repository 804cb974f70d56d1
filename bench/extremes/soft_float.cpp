// The library in float, by its solver soft_step.
#include "plays.hpp"

namespace bench {

namespace {

const enlisted_column it({"soft_step-float", 0, cells_of<float, physics::soft_step>});

}  // namespace

}  // namespace bench
