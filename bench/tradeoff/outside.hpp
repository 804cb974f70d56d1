// Engines that another program plays: a scene as they are told it, and what comes back.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "../scenes/engine.hpp"
#include "../timing.hpp"
#include "question.hpp"

namespace bench {

/// What an engine whose list of settings this is always plays with.
inline constexpr const char* no_settings = "none";

/// A scene as JSON: all that there is in it.
void write_json(std::FILE* out, const scene& s);

/// Engines as a file lists them, a line each: FILE NAME DIMENSION JOINTS SETTINGS. None where there is no such file.
std::vector<contestant> listed(const std::string& file);

/// A film as it is written: a line `gravity X Y Z`, a line `seconds S ...` (CPU seconds a simulated second, of each
/// run), a line `frames N bodies M`; then of each body in each frame 14 doubles, little-endian: place, turn, velocity,
/// spin, mass.
struct outside_run {
    film seen;
    triple gravity = {};
    samples seconds;
};
/// False if it is no film, or one that does not fit the scene.
bool read(std::FILE* in, const scene& s, outside_run& into);

}  // namespace bench
