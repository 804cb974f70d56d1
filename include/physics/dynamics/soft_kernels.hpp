// The kernels of the soft solver: what it does with a block of contacts.
#pragma once

#include "physics/dynamics/soft_linear_contact.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Kernels as the unit is compiled.
template <class Block>
struct soft_kernels {
    using body = typename Block::body;

    template <class Gathered>
    static void prepare(Block& block, const body* bodies, Gathered& gathered) {
        block.prepare(bodies, gathered);
    }
    static void warm_start(Block& block, body* bodies) { block.warm_start(bodies); }
    template <class Pass>
    static void solve(Block& block, body* bodies, const Pass& pass) {
        if constexpr (requires { block.rolls(pass); })
            if (block.rolls(pass)) roll(block, bodies);
        block.solve(bodies, pass);
    }
    // Apart from the rest, so that contacts that don't roll have their registers to themselves.
    PHYSICS_HPP_NOINLINE static void roll(Block& block, body* bodies) { block.roll(bodies); }
    template <class Pass>
    static void note_approaches(Block& block, const body* bodies, const Pass& pass) {
        block.note_approaches(bodies, pass);
    }
};

#if PHYSICS_HPP_AVX2_KERNELS
// Without fma, which would change bits.
#define PHYSICS_HPP_AVX2_KERNEL __attribute__((noinline, target("avx2"))) static

/// The same for AVX2, where the unit is compiled for less. What is called from here and not inlined is compiled for
/// less, too: lanes have no place in it.
template <class Block>
struct avx2_kernels {
    using body = typename Block::body;

    template <class Gathered>
    PHYSICS_HPP_AVX2_KERNEL void prepare(Block& block, const body* bodies, Gathered& gathered) {
        block.prepare(bodies, gathered);
    }
    PHYSICS_HPP_AVX2_KERNEL void warm_start(Block& block, body* bodies) { block.warm_start(bodies); }
    template <class Pass>
    PHYSICS_HPP_AVX2_KERNEL void solve(Block& block, body* bodies, const Pass& pass) {
        if constexpr (requires { block.rolls(pass); })
            if (block.rolls(pass)) roll(block, bodies);
        block.solve(bodies, pass);
    }
    PHYSICS_HPP_AVX2_KERNEL void roll(Block& block, body* bodies) { block.roll(bodies); }
    template <class Pass>
    PHYSICS_HPP_AVX2_KERNEL void note_approaches(Block& block, const body* bodies, const Pass& pass) {
        block.note_approaches(bodies, pass);
    }
};

inline bool has_avx2() { return __builtin_cpu_supports("avx2") != 0; }

#undef PHYSICS_HPP_AVX2_KERNEL
#endif

}  // namespace detail

PHYSICS_HPP_END
