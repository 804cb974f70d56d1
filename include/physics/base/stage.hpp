// The stages of a step. Policies name theirs, so that a recipe can list them in any order.
#pragma once

#include "physics/base/config.hpp"

PHYSICS_HPP_BEGIN

namespace stage {
/// Which shapes a world knows: shapes<...>.
struct shapes {};
/// Which joints a world knows: joints<...>.
struct joints {};
/// From boxes to pairs: all_pairs.
struct broadphase {};
/// From pairs to manifolds: best_per_pair.
struct narrowphase {};
/// What two surfaces make of a contact: geometric_mixing.
struct mixing {};
/// From contacts to velocities: soft_step, sequential_impulse.
struct solver {};
/// How velocities and poses advance: semi_implicit_euler.
struct integrator {};
/// How fast bodies are kept from passing through others: swept.
struct continuous {};
/// What a step tells of: events<...>.
struct events {};
/// Which contacts hold, and how: one_way_platforms.
struct contact_rule {};
/// Types of a user's own on bodies, shapes and joints: user_types<...>.
struct user_types {};
/// Which features are left out: without<...>.
struct features {};
}  // namespace stage

/// What a solver or an integrator of your own sees of a step, and no other: bodies, contacts, joints.
namespace solver_api {}
namespace detail {
using namespace solver_api;
}

PHYSICS_HPP_END
