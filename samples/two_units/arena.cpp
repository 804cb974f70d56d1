// The unit that compiles the world, once for all: it is built anew only where the recipe or the library changes.
#include "arena.hpp"

PHYSICS_HPP_INSTANTIATE(arena_recipe)
