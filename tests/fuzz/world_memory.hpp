// The library, with memory that ends when a fuzzer says so. Comes before all else.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <thread>
#include <vector>

namespace fuzz {

/// How many more times there is memory; none less than 0 means without end.
inline long memory_left = -1;

inline bool has_memory() {
    if (memory_left < 0) return true;
    if (memory_left == 0) return false;
    --memory_left;
    return true;
}

}  // namespace fuzz

// What the header calls in place of the C library. Its names must be those of std, since it asks for them there.
namespace std {
inline void* limited_malloc(std::size_t bytes) { return fuzz::has_memory() ? malloc(bytes) : nullptr; }
inline void* limited_calloc(std::size_t count, std::size_t bytes) {
    return fuzz::has_memory() ? calloc(count, bytes) : nullptr;
}
inline void* limited_realloc(void* memory, std::size_t bytes) {
    return fuzz::has_memory() ? realloc(memory, bytes) : nullptr;
}
}  // namespace std
#define malloc limited_malloc
#define calloc limited_calloc
#define realloc limited_realloc
#include <physics.hpp>
#undef malloc
#undef calloc
#undef realloc
