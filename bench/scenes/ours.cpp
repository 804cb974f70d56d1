// The library in float, with either of its solvers.
#include "ours.hpp"

namespace bench {

namespace {

const enlisted soft({.name = "ours",
                     .settings = "soft_step, 4 substeps; no slop: what is left is what the springs give",
                     .order = 0,
                     .make = make_ours<float, physics::soft_step>});
const enlisted impulses({.name = "ours-si",
                         .settings = "sequential_impulse, 4 substeps of 8 rounds, slop 5 mm",
                         .order = 1,
                         .make = make_ours<float, physics::sequential_impulse>});

}  // namespace

}  // namespace bench
