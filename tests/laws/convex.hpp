// Laws of contact once more, for GJK and EPA in place of closed forms.
#pragma once

#define CELL_NARROWPHASE physics::gjk_epa
#define CELL_NARROWPHASE_IN_DOUBLE
#include "collide.hpp"
