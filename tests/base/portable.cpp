// The tests of fixed-point arithmetic once more, on the path for targets without a 128-bit integer. Both paths are
// held against exact integers, so they agree bit by bit; tests/determinism compares the functions of math.hpp.
#ifndef PHYSICS_HPP_NO_INT128
#define PHYSICS_HPP_NO_INT128
#endif
#include "fixed.cpp"
