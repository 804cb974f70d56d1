// The library in double, by its solver soft_step.
#include "plays.hpp"

namespace bench {

namespace {

const enlisted_column it({"soft_step-double", 1, cells_of<double, physics::soft_step>});

}  // namespace

}  // namespace bench
