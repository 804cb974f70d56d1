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

/// `rows` floors with `columns` pyramids of 55 boxes each.
scene many_pyramids(int rows, int columns, int steps);

}  // namespace bench
