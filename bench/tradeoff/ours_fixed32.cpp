// The library in Q32.32.
#include "../scenes/ours.hpp"

namespace bench {

namespace {

using kinds_of_joints = physics::joints<physics::ball_joint, physics::revolute_joint, physics::weld_joint>;

const enlisted soft({.name = "soft_step-fixed32",
                     .settings = "substeps",
                     .make = make_ours<physics::fixed32, physics::soft_step, by_oneself, kinds_of_joints>,
                     .has_joints = true});

}  // namespace

}  // namespace bench
