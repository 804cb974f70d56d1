// A world of some recipe as the benchmark of features sees it: plain numbers and functions, so that the unit that makes
// such a world holds little code but the library's.
#pragma once

#include <cstdint>

namespace bench {

struct plain_shape {
    bool is_ball;
    double half[3], radius, at[3], density, friction;
};
struct plain_body {
    /// 0 static, 1 kinematic, 2 dynamic.
    int kind;
    double at[3], rotation[4], velocity[3], spin[3];
    const plain_shape* shapes;
    int count;
};

/// One recipe. Objects of it list themselves before main() begins.
struct subject {
    const char* left_out;
    int dimension;
    /// The friction is that of all shapes.
    void* (*make)(const double* gravity, double friction);
    void (*add)(void* world, const plain_body& body);
    void (*step)(void* world, double dt);
    void* (*copy)(const void* world);
    void (*drop)(void* world);
    std::uint32_t (*contacts)(const void* world);
    /// A number that worlds share whose bodies are in the same places, to the bit.
    std::uint64_t (*places)(const void* world);
    subject* next;

    static inline subject* first = nullptr;
};

}  // namespace bench
