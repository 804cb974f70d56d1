// The scenes: those of the usual benchmarks of engines, rebuilt from their descriptions.
#pragma once

#include <vector>

#include "scene.hpp"

namespace bench {

struct maker {
    const char* name;
    int dimension;
    const char* about;
    scene (*make)(bool quick);
};

const std::vector<maker>& makers();
/// Those with joints.
const std::vector<maker>& joint_makers();
/// Those that are played to rest.
const std::vector<maker>& piles();

/// `rows` floors with `columns` pyramids of 55 boxes each.
scene many_pyramids(int rows, int columns, int steps);
/// A pyramid of squares of 1 m.
scene pyramid(int base, int steps);
/// A pyramid of cubes on a square base.
scene square_pyramid(int base, int steps);
/// Stacks of cubes.
scene stacks(int columns, int rows, int height, int steps);

}  // namespace bench
