// The library, with every call for memory counted: its own, and those of the language. For one unit of a program.
#pragma once

#include "refused_memory.hpp"

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
