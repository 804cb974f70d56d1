// The library, with every call for memory counted: its own, and those of the language. For one unit of a program.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {
unsigned long calls = 0;
/// After so many calls one of the C library's is refused; none if it is less than 0.
long calls_until_refused = -1;
bool is_refused() {
    ++calls;
    return calls_until_refused >= 0 && calls_until_refused-- == 0;
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

// Not inlined, as compilers warn of free() for what a new expression gave.
PHYSICS_HPP_COLD void* operator new(std::size_t bytes) {
    ++calls;
    if (void* memory = std::malloc(bytes > 0 ? bytes : 1)) return memory;
    throw std::bad_alloc();
}
PHYSICS_HPP_COLD void operator delete(void* memory) noexcept { std::free(memory); }
PHYSICS_HPP_COLD void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace {

template <class F>
unsigned long calls_of(F&& f) {
    const unsigned long before = calls;
    f();
    return calls - before;
}

}  // namespace
