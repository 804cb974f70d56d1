// Compiler facts, options, the determinism region and what is refused at compile time.
#pragma once

#include <cstdint>

// One place holds the version; meson.build and the banner of the single header read it from here.
#define PHYSICS_HPP_VERSION_MAJOR 0
#define PHYSICS_HPP_VERSION_MINOR 1
#define PHYSICS_HPP_VERSION_PATCH 0

// Options, all off unless the user defines them before including:
//   PHYSICS_HPP_NONDETERMINISTIC  accept fast-math, x87 and contraction; the bits then depend on the build
//   PHYSICS_HPP_AUDIT             count every fixed-point overflow (see overflow_count)
//   PHYSICS_HPP_NO_INT128         take the portable 128-bit path even where the compiler has __int128
//   PHYSICS_HPP_RUNTIME_AVX2      compile the kernels of the contact solver for AVX2 as well, and take these where the
//                                 processor has it, with the same bits: for units that are not compiled for AVX2

#if defined(_MSVC_LANG)
#define PHYSICS_HPP_CPLUSPLUS _MSVC_LANG
#else
#define PHYSICS_HPP_CPLUSPLUS __cplusplus
#endif
#if PHYSICS_HPP_CPLUSPLUS < 202002L
#error "physics.hpp needs C++20: compile with -std=c++20 or later"
// Ends the compilation, for want of such a file: hundreds of errors would bury the one that counts.
#pragma GCC dependency "C++20"
#endif

#if defined(__cpp_exceptions) || defined(_CPPUNWIND)
#define PHYSICS_HPP_EXCEPTIONS 1
#else
#define PHYSICS_HPP_EXCEPTIONS 0
#endif

#if defined(__SIZEOF_INT128__) && !defined(PHYSICS_HPP_NO_INT128)
#define PHYSICS_HPP_INT128 1
#else
#define PHYSICS_HPP_INT128 0
#endif

#ifndef PHYSICS_HPP_NONDETERMINISTIC
#if defined(__FAST_MATH__) || defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0 || defined(_M_FP_FAST)
#error \
    "physics.hpp promises the same bits everywhere, which -ffast-math breaks: drop that flag for this file, or define PHYSICS_HPP_NONDETERMINISTIC"
#elif defined(__GCC_IEC_559) && __GCC_IEC_559 == 0
#error \
    "physics.hpp promises the same bits everywhere, which flags such as -fassociative-math break: drop them for this file, or define PHYSICS_HPP_NONDETERMINISTIC"
#elif defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0 && __FLT_EVAL_METHOD__ != 16
// 16 is what gcc says where _Float16 has arithmetic of its own; float and double then have too.
#error \
    "physics.hpp promises the same bits everywhere, which x87 arithmetic breaks: add -msse2 -mfpmath=sse, or define PHYSICS_HPP_NONDETERMINISTIC"
#elif defined(__wasm_simd128__) && defined(__clang__) && __clang_major__ < 16 && !defined(PHYSICS_HPP_NO_SLP_VECTORIZE)
// No macro shows that flag. clang 14 miscompiles what its SLP vectoriser makes of plain numbers.
#error \
    "physics.hpp promises the same bits everywhere, which -msimd128 breaks for wasm in clang before 16: add -fno-slp-vectorize -DPHYSICS_HPP_NO_SLP_VECTORIZE, or define PHYSICS_HPP_NONDETERMINISTIC"
#endif
#endif

// Options that change types or results enter the name of the inline namespace, so that units built
// differently never share an instantiation by accident.
#if PHYSICS_HPP_INT128
#define PHYSICS_HPP_ABI_WIDE
#else
#define PHYSICS_HPP_ABI_WIDE _portable
#endif
#ifdef PHYSICS_HPP_AUDIT
#define PHYSICS_HPP_ABI_AUDIT _audit
#else
#define PHYSICS_HPP_ABI_AUDIT
#endif
#ifdef PHYSICS_HPP_NONDETERMINISTIC
#define PHYSICS_HPP_ABI_FLOAT _loose
#else
#define PHYSICS_HPP_ABI_FLOAT
#endif
#if defined(PHYSICS_HPP_RUNTIME_AVX2) && defined(__GNUC__) && defined(__SSE2__) && !defined(__AVX2__)
#define PHYSICS_HPP_AVX2_KERNELS 1
#define PHYSICS_HPP_ABI_LANES _avx2
#else
#define PHYSICS_HPP_AVX2_KERNELS 0
#define PHYSICS_HPP_ABI_LANES
#endif
#define PHYSICS_HPP_JOIN_(a, b, c, d, e) a##b##c##d##e
#define PHYSICS_HPP_JOIN(a, b, c, d, e) PHYSICS_HPP_JOIN_(a, b, c, d, e)
#define PHYSICS_HPP_ABI \
    PHYSICS_HPP_JOIN(v0_1, PHYSICS_HPP_ABI_WIDE, PHYSICS_HPP_ABI_AUDIT, PHYSICS_HPP_ABI_FLOAT, PHYSICS_HPP_ABI_LANES)

// The determinism region. Compilers fuse a * b + c into one rounding where the target has such an
// instruction (gcc also under -std=c++20), so each part of the library opens a region that forbids it.
// gcc's pragma keeps region code from inlining into user code, so it is set only where fusing is possible.
// gcc contracts always_inline functions again in the caller, hence the library's are plain inline.
#ifdef PHYSICS_HPP_NONDETERMINISTIC
#define PHYSICS_HPP_REGION_PUSH
#define PHYSICS_HPP_REGION_POP
#elif defined(__clang__) && (defined(__wasm__) || defined(__arm__) || defined(__aarch64__) && __clang_major__ < 15)
// Here clang ignores float_control(push): the pragma reaches to the end of the user's file.
#define PHYSICS_HPP_REGION_PUSH _Pragma("clang fp contract(off)")
#define PHYSICS_HPP_REGION_POP
#elif defined(__clang__)
// Precise as well, since no macro shows flags such as -fassociative-math. Only -ffp-contract=fast gets through, and
// flags that imply it: clang fuses after it has forgotten the pragma. The probe reports it.
#define PHYSICS_HPP_REGION_PUSH _Pragma("float_control(precise, on, push)") _Pragma("clang fp contract(off)")
#define PHYSICS_HPP_REGION_POP _Pragma("float_control(pop)")
#elif defined(__GNUC__) && (defined(__FP_FAST_FMA) || defined(__FP_FAST_FMAF))
// gcc's vectoriser forms fused multiply-addsub from paired products even so, hence it stays out; packs are explicit.
#define PHYSICS_HPP_REGION_PUSH \
    _Pragma("GCC push_options") \
        _Pragma("GCC optimize(\"fp-contract=off\", \"no-tree-slp-vectorize\", \"no-tree-loop-vectorize\")")
#define PHYSICS_HPP_REGION_POP _Pragma("GCC pop_options")
#elif defined(_MSC_VER)
#define PHYSICS_HPP_REGION_PUSH __pragma(float_control(precise, on, push)) __pragma(fp_contract(off))
#define PHYSICS_HPP_REGION_POP __pragma(float_control(pop))
#else
#define PHYSICS_HPP_REGION_PUSH
#define PHYSICS_HPP_REGION_POP
#endif

#define PHYSICS_HPP_BEGIN   \
    PHYSICS_HPP_REGION_PUSH \
    namespace physics {     \
    inline namespace PHYSICS_HPP_ABI {
#define PHYSICS_HPP_END \
    }                   \
    }                   \
    PHYSICS_HPP_REGION_POP

#if defined(__GNUC__)
#define PHYSICS_HPP_NOINLINE __attribute__((noinline))
#define PHYSICS_HPP_COLD __attribute__((noinline, cold))
#else
#define PHYSICS_HPP_NOINLINE __declspec(noinline)
#define PHYSICS_HPP_COLD PHYSICS_HPP_NOINLINE
#endif

// For lanes and the kernels made of them, and for integers; never for floats in what users call: gcc contracts
// a * b + c again where an always_inline function lands in code outside the determinism region. Within it, forced
// inlining keeps packs in registers at every optimisation level, and makes calls between functions of different targets
// harmless.
#if defined(__GNUC__) || defined(__clang__)
#define PHYSICS_HPP_ALWAYS_INLINE inline __attribute__((always_inline))
#define PHYSICS_HPP_INLINE_LAMBDA __attribute__((always_inline))
#elif defined(_MSC_VER)
#define PHYSICS_HPP_ALWAYS_INLINE __forceinline
#define PHYSICS_HPP_INLINE_LAMBDA
#else
#define PHYSICS_HPP_ALWAYS_INLINE inline
#define PHYSICS_HPP_INLINE_LAMBDA
#endif

// A hint that the memory at an address is wanted soon.
#if defined(__GNUC__)
#define PHYSICS_HPP_PREFETCH(address) __builtin_prefetch(address)
#else
#define PHYSICS_HPP_PREFETCH(address) static_cast<void>(address)
#endif
