// The library in float, by both of its solvers.
#include "../scenes/ours.hpp"

namespace bench {

namespace {

using kinds_of_joints = physics::joints<physics::ball_joint, physics::revolute_joint, physics::weld_joint>;

const enlisted soft({.name = "soft_step-float",
                     .settings = "substeps",
                     .make = make_ours<float, physics::soft_step, by_oneself, kinds_of_joints>,
                     .has_joints = true});
const enlisted impulses({.name = "sequential_impulse-float",
                         .settings = "substeps iterations",
                         .make = make_ours<float, physics::sequential_impulse, by_oneself, kinds_of_joints>,
                         .has_joints = true});

}  // namespace

}  // namespace bench
