// Rigid-body physics for games, in 2D and 3D, in float, double and fixed point: the same bits everywhere.
//
// This one header is all there is: copy it into your project, compile as C++20, no flags, nothing to link.
// From a checkout, -I. gives the single header and -Iinclude its parts; both are #include <physics.hpp>.
// Options, off unless defined before the include:
//   PHYSICS_HPP_NONDETERMINISTIC  accept fast-math, x87 and contraction; the bits then depend on the build
//   PHYSICS_HPP_AUDIT             count every fixed-point overflow (see overflow_count)
//   PHYSICS_HPP_NO_INT128         take the portable 128-bit path even where the compiler has __int128
#pragma once

#include "physics/base/config.hpp"
#include "physics/base/error.hpp"
#include "physics/base/fixed.hpp"
#include "physics/base/scalar.hpp"
#include "physics/base/wide.hpp"

#include "physics/space/aabb.hpp"
#include "physics/space/inertia.hpp"
#include "physics/space/mat.hpp"
#include "physics/space/rotation2.hpp"
#include "physics/space/rotation3.hpp"
#include "physics/space/space.hpp"
#include "physics/space/transform.hpp"
#include "physics/space/vec.hpp"
