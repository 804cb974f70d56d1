// The library in fixed point: the same bits on every machine without help from floating point, at a price.
#include "ours.hpp"

namespace bench {

namespace {

const enlisted fixed({.name = "ours-fixed32",
                      .settings = "Q32.32, soft_step, 4 substeps",
                      .order = 2,
                      .make = make_ours<physics::fixed32, physics::soft_step>,
                      .plays = [](const scene& s) { return s.name == "pyramid" || s.name == "pyramid3"; }});

}  // namespace

}  // namespace bench
