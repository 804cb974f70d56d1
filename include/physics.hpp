// Rigid-body physics for games, in 2D and 3D, in float, double and fixed point: the same bits everywhere.
//
// This one header is all there is: copy it into your project, compile as C++20, no flags, nothing to link.
// From a checkout, -I. gives the single header and -Iinclude its parts; both are #include <physics.hpp>.
// Options, off unless defined before the include:
//   PHYSICS_HPP_NONDETERMINISTIC  accept fast-math, x87 and contraction; the bits then depend on the build
//   PHYSICS_HPP_AUDIT             count every fixed-point overflow (see overflow_count)
//   PHYSICS_HPP_NO_INT128         take the portable 128-bit path even where the compiler has __int128
#pragma once

// Numbers, memory, errors, facts about the compiler.
#include "physics/base/arena.hpp"
#include "physics/base/bit_array.hpp"
#include "physics/base/buffer.hpp"
#include "physics/base/config.hpp"
#include "physics/base/error.hpp"
#include "physics/base/fixed.hpp"
#include "physics/base/handle.hpp"
#include "physics/base/math.hpp"
#include "physics/base/math_fixed.hpp"
#include "physics/base/math_real.hpp"
#include "physics/base/math_reduce.hpp"
#include "physics/base/pack.hpp"
#include "physics/base/pack_mask.hpp"
#include "physics/base/pack_rows.hpp"
#include "physics/base/pool.hpp"
#include "physics/base/probe.hpp"
#include "physics/base/raw_array.hpp"
#include "physics/base/root.hpp"
#include "physics/base/scalar.hpp"
#include "physics/base/sort.hpp"
#include "physics/base/stage.hpp"
#include "physics/base/wide.hpp"

// Vectors, rotations, transforms, inertia, boxes.
#include "physics/space/aabb.hpp"
#include "physics/space/check.hpp"
#include "physics/space/inertia.hpp"
#include "physics/space/mat.hpp"
#include "physics/space/orientation.hpp"
#include "physics/space/rotation2.hpp"
#include "physics/space/rotation3.hpp"
#include "physics/space/space.hpp"
#include "physics/space/transform.hpp"
#include "physics/space/vec.hpp"

// What bodies are made of.
#include "physics/shape/ball.hpp"
#include "physics/shape/box.hpp"
#include "physics/shape/capsule.hpp"
#include "physics/shape/concept.hpp"
#include "physics/shape/geometry.hpp"
#include "physics/shape/halfspace.hpp"
#include "physics/shape/hull.hpp"
#include "physics/shape/hull_builder2.hpp"
#include "physics/shape/hull_builder3.hpp"
#include "physics/shape/hull_data.hpp"
#include "physics/shape/hull_faces.hpp"
#include "physics/shape/hull_moments.hpp"
#include "physics/shape/quickhull.hpp"
#include "physics/shape/shapes.hpp"

// From two shapes to a contact.
#include "physics/collide/box3.hpp"
#include "physics/collide/capsule3.hpp"
#include "physics/collide/clip3.hpp"
#include "physics/collide/manifold.hpp"
#include "physics/collide/narrowphase.hpp"
#include "physics/collide/pairs2.hpp"
#include "physics/collide/pairs3.hpp"
#include "physics/collide/polygon2.hpp"
#include "physics/collide/reduce3.hpp"
#include "physics/collide/round.hpp"
#include "physics/collide/segment.hpp"

// From all boxes to the pairs that may touch.
#include "physics/broadphase/all_pairs.hpp"
#include "physics/broadphase/arrange.hpp"
#include "physics/broadphase/axis_order.hpp"
#include "physics/broadphase/block_scan.hpp"
#include "physics/broadphase/box_block.hpp"
#include "physics/broadphase/box_tests.hpp"
#include "physics/broadphase/cell_blocks.hpp"
#include "physics/broadphase/cell_index.hpp"
#include "physics/broadphase/cell_level.hpp"
#include "physics/broadphase/cell_walk.hpp"
#include "physics/broadphase/concept.hpp"
#include "physics/broadphase/dynamic_tree.hpp"
#include "physics/broadphase/float_order.hpp"
#include "physics/broadphase/grid.hpp"
#include "physics/broadphase/guard.hpp"
#include "physics/broadphase/hash_grid.hpp"
#include "physics/broadphase/indexed.hpp"
#include "physics/broadphase/packed_tree.hpp"
#include "physics/broadphase/pair_set.hpp"
#include "physics/broadphase/proxies.hpp"
#include "physics/broadphase/queries.hpp"
#include "physics/broadphase/sweep_and_prune.hpp"
#include "physics/broadphase/tree_index.hpp"

// Bodies, contacts, and the solver that moves them.
#include "physics/dynamics/body.hpp"
#include "physics/dynamics/contact.hpp"
#include "physics/dynamics/friction.hpp"
#include "physics/dynamics/integrator.hpp"
#include "physics/dynamics/sequential_impulse.hpp"

// What users hold; world/step.hpp is the page to read first.
#include "physics/world/audit.hpp"
#include "physics/world/check.hpp"
#include "physics/world/edit.hpp"
#include "physics/world/hash.hpp"
#include "physics/world/mass.hpp"
#include "physics/world/ranges.hpp"
#include "physics/world/recipe.hpp"
#include "physics/world/settings.hpp"
#include "physics/world/state.hpp"
#include "physics/world/step.hpp"
#include "physics/world/world.hpp"

// From elapsed time to fixed steps.
#include "physics/loop/accumulator.hpp"
