// What the cells of the matrix include, precompiled: nothing in it depends on the cell. Without #pragma once, of which
// g++ warns in a file that it precompiles.
#include <doctest/doctest.h>

#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>
