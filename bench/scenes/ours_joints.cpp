// The library in float, with joints in its recipe: for the scenes that have some.
#include "ours.hpp"

namespace bench {

namespace {

using kinds_of_joints = physics::joints<physics::ball_joint, physics::revolute_joint, physics::weld_joint>;

const enlisted joined({.name = "ours",
                       .settings = "with joints: as above, trees and small nets of joints solved directly",
                       .order = 0,
                       .make = make_ours<float, physics::soft_step, by_oneself, kinds_of_joints>,
                       .plays = [](const scene& s) { return !s.joints.empty(); },
                       .has_joints = true});

}  // namespace

}  // namespace bench
