// The laws of worlds: what comes and goes, what bodies do, what happens between them.
#pragma once

#include "world_bodies.hpp"
#include "world_contacts.hpp"
#include "world_life.hpp"

// Compiles every member, in every cell.
template class physics::world<scene>;
