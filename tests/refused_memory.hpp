// The library, with its calls for memory counted, and refused where told so. For one unit of a program.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {
unsigned long calls = 0;
/// After so many calls one of the C library's is refused, or all from then on; none if it is less than 0.
long calls_until_refused = -1;
bool all_are_refused_then = false;
bool is_refused() {
    ++calls;
    if (calls_until_refused < 0) return false;
    if (calls_until_refused > 0) {
        --calls_until_refused;
        return false;
    }
    if (!all_are_refused_then) calls_until_refused = -1;
    return true;
}
}  // namespace

// What the header calls in place of the C library. Its names must be those of std, since it asks for them there.
namespace std {
inline void* counted_malloc(std::size_t bytes) { return is_refused() ? nullptr : malloc(bytes); }
inline void* counted_calloc(std::size_t count, std::size_t bytes) {
    return is_refused() ? nullptr : calloc(count, bytes);
}
inline void* counted_realloc(void* memory, std::size_t bytes) {
    return is_refused() ? nullptr : realloc(memory, bytes);
}
}  // namespace std
#define malloc counted_malloc
#define calloc counted_calloc
#define realloc counted_realloc
#include <physics.hpp>
#undef malloc
#undef calloc
#undef realloc
