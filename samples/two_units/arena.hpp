// What the units of a program share: the recipe, and that its world is compiled in one of them.
#pragma once

#include <physics.hpp>

struct arena_recipe : physics::recipe<float, 2> {};
PHYSICS_HPP_EXTERN(arena_recipe)
using arena = physics::world<arena_recipe>;
