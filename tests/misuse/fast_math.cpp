// expect: physics.hpp promises the same bits everywhere, which -ffast-math breaks: drop that flag for this file, or define PHYSICS_HPP_NONDETERMINISTIC
// flags: -ffast-math
#include <physics.hpp>
