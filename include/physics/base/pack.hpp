// Lanes: W scalars that go through the same arithmetic, in vector registers where the target has them.
#pragma once

#include <cstring>
#include <type_traits>

#include "physics/base/math.hpp"

// The widest vector register that this unit may use, in bytes; 0 where there is none that keeps IEEE 754 (32-bit
// ARM flushes subnormals) or where the compiler has no vector types: lanes are then plain scalars.
#if !defined(__GNUC__) && !defined(__clang__)
#define PHYSICS_HPP_VECTOR_BYTES 0
#elif defined(__AVX2__)
#define PHYSICS_HPP_VECTOR_BYTES 32
#elif defined(__SSE2__) || defined(__aarch64__) || defined(__wasm_simd128__) || defined(__VSX__)
#define PHYSICS_HPP_VECTOR_BYTES 16
#else
#define PHYSICS_HPP_VECTOR_BYTES 0
#endif

PHYSICS_HPP_BEGIN

namespace detail {

inline constexpr int vector_bytes = PHYSICS_HPP_VECTOR_BYTES;

/// The number of lanes that fill one vector register of that many bytes: 4 or 8 for float, 2 or 4 for double, 1 for
/// all other scalars.
template <class S, int Bytes = vector_bytes>
inline constexpr int native_width = (std::is_same_v<S, float> || std::is_same_v<S, double>)&&Bytes >= 16
                                        ? Bytes / static_cast<int>(sizeof(S))
                                        : 1;

/// Whether W lanes are one vector; one lane is a scalar, and all other packs are made of two halves.
template <class S, int W, int Bytes>
inline constexpr bool is_vector = W > 1 && W <= native_width<S, Bytes>&& W * sizeof(S) >= 16;

template <class S, int W>
struct lane_storage {
#if PHYSICS_HPP_VECTOR_BYTES > 0
    typedef S type __attribute__((vector_size(W * sizeof(S))));
    typedef S unaligned __attribute__((vector_size(W * sizeof(S)), aligned(alignof(S)), may_alias));
    typedef S aligned __attribute__((vector_size(W * sizeof(S)), may_alias));
#endif
};
template <class S>
struct lane_storage<S, 1> {
    using type = S;
    using unaligned = S;
    using aligned = S;
};

/// W scalars, a power of two, that go through the same arithmetic: lane i of a result is what the scalar operation
/// gives for lane i of the operands, bit for bit, at any width and any Bytes (only the sign and the payload of a NaN
/// are left open). In memory it is an array of W scalars; trivially copyable where S is, but for those wider than the
/// unit. Operands are references since by value unoptimised builds copy them (1.5 to 4 times slower) and gcc warns
/// of vectors wider than the unit's.
///
/// Internal machinery of kernels: use it only between PHYSICS_HPP_BEGIN and PHYSICS_HPP_END (see
/// PHYSICS_HPP_ALWAYS_INLINE). A kernel for wider registers than the unit's is a noinline function with, say,
/// target("avx2"), without fma, that takes pointers only and works on pack<S, W, 32>.
template <class S, int W, int Bytes = vector_bytes>
struct pack {
    static_assert(W > 1 && (W & (W - 1)) == 0, "physics::detail::pack: the width must be a power of two");
    using scalar = S;
    using half = pack<S, W / 2, Bytes>;
    static constexpr int width = W;

    half low, high;

    /// x in every lane.
    PHYSICS_HPP_ALWAYS_INLINE static pack broadcast(S x) { return {half::broadcast(x), half::broadcast(x)}; }
    /// W scalars in a row, at any address.
    PHYSICS_HPP_ALWAYS_INLINE static pack load(const S* from) { return {half::load(from), half::load(from + W / 2)}; }
    /// W scalars in a row, at a multiple of alignof(pack).
    PHYSICS_HPP_ALWAYS_INLINE static pack load_aligned(const S* from) {
        return {half::load_aligned(from), half::load_aligned(from + W / 2)};
    }
    PHYSICS_HPP_ALWAYS_INLINE void store(S* to) const {
        low.store(to);
        high.store(to + W / 2);
    }
    PHYSICS_HPP_ALWAYS_INLINE void store_aligned(S* to) const {
        low.store_aligned(to);
        high.store_aligned(to + W / 2);
    }
    /// For messages, tests and rare paths: a kernel that picks lanes is slower than one without packs.
    PHYSICS_HPP_ALWAYS_INLINE S lane(int i) const { return i < W / 2 ? low.lane(i) : high.lane(i - W / 2); }
    /// Writes one scalar, to fill the lanes of a block in memory one by one.
    PHYSICS_HPP_ALWAYS_INLINE void set_lane(int i, S x) { (i < W / 2 ? low : high).set_lane(i & (W / 2 - 1), x); }

    PHYSICS_HPP_ALWAYS_INLINE friend pack operator+(const pack& a, const pack& b) {
        return {a.low + b.low, a.high + b.high};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator-(const pack& a, const pack& b) {
        return {a.low - b.low, a.high - b.high};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator*(const pack& a, const pack& b) {
        return {a.low * b.low, a.high * b.high};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator/(const pack& a, const pack& b) {
        return {a.low / b.low, a.high / b.high};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator-(const pack& a) { return {-a.low, -a.high}; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator+=(const pack& b) { return *this = *this + b; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator-=(const pack& b) { return *this = *this - b; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator*=(const pack& b) { return *this = *this * b; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator/=(const pack& b) { return *this = *this / b; }

    PHYSICS_HPP_ALWAYS_INLINE friend pack min(const pack& a, const pack& b) {
        return {min(a.low, b.low), min(a.high, b.high)};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack max(const pack& a, const pack& b) {
        return {max(a.low, b.low), max(a.high, b.high)};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack sqrt(const pack& a) { return {sqrt(a.low), sqrt(a.high)}; }
    /// a > b ? x : y in each lane; y where a or b is NaN.
    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE friend pack<T, W, Bytes> select_greater(const pack& a, const pack& b,
                                                                      const pack<T, W, Bytes>& x,
                                                                      const pack<T, W, Bytes>& y) {
        return {select_greater(a.low, b.low, x.low, y.low), select_greater(a.high, b.high, x.high, y.high)};
    }
    /// The lanes' products without rounding where S can: the twin of product(S, S).
    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE friend auto product(const pack& a, const pack<T, W, Bytes>& b) {
        using result = typename decltype(product(a.low, b.low))::scalar;
        return pack<result, W, Bytes>{product(a.low, b.low), product(a.high, b.high)};
    }
    /// The lanes of products, and sums of such, rounded once to R: the twin of narrow<R>(wide).
    template <class R>
    PHYSICS_HPP_ALWAYS_INLINE friend pack<R, W, Bytes> narrow(const pack& a) {
        return {narrow<R>(a.low), narrow<R>(a.high)};
    }
    /// a * b rounded once to R; the operands may be a scalar and its inverse type.
    template <class R, class T>
    PHYSICS_HPP_ALWAYS_INLINE friend pack<R, W, Bytes> mul(const pack& a, const pack<T, W, Bytes>& b) {
        return narrow<R>(product(a, b));
    }
};

/// One scalar, or one vector: compilers give both the same operators, and turn the ternaries into min, max and blend.
template <class S, int W, int Bytes>
    requires(W == 1 || is_vector<S, W, Bytes>)
struct pack<S, W, Bytes> {
    using scalar = S;
    using storage = typename lane_storage<S, W>::type;
    static constexpr int width = W;

    storage value;

#if PHYSICS_HPP_AVX2_KERNELS && !defined(__clang__)
    // Structs of vectors wider than the unit's gcc copies in pieces of 16 bytes, and what then reads them whole waits
    // until the pieces are in the cache. Named as vectors they are copied at once.
    pack() = default;
    pack(const pack&) = default;
    pack& operator=(const pack&) = default;
    PHYSICS_HPP_ALWAYS_INLINE pack(const storage& from) : value(from) {}
    PHYSICS_HPP_ALWAYS_INLINE pack(const pack& from) requires(Bytes > vector_bytes) : value(from.value) {}
    PHYSICS_HPP_ALWAYS_INLINE pack& operator=(const pack& from) requires(Bytes > vector_bytes) {
        value = from.value;
        return *this;
    }
#endif

    PHYSICS_HPP_ALWAYS_INLINE static pack broadcast(S x) {
        if constexpr (W == 1) return {x};
        else if constexpr (W == 2) return {storage{x, x}};
        else if constexpr (W == 4) return {storage{x, x, x, x}};
        else return {storage{x, x, x, x, x, x, x, x}};
    }
    PHYSICS_HPP_ALWAYS_INLINE static pack load(const S* from) {
        // By way of a variable, since nothing may refer to what is not aligned.
        const storage lanes = *reinterpret_cast<const typename lane_storage<S, W>::unaligned*>(from);
        return {lanes};
    }
    PHYSICS_HPP_ALWAYS_INLINE static pack load_aligned(const S* from) {
        const storage lanes = *reinterpret_cast<const typename lane_storage<S, W>::aligned*>(from);
        return {lanes};
    }
    PHYSICS_HPP_ALWAYS_INLINE void store(S* to) const {
        if constexpr (W == 1) *to = value;
        else *reinterpret_cast<typename lane_storage<S, W>::unaligned*>(to) = value;
    }
    PHYSICS_HPP_ALWAYS_INLINE void store_aligned(S* to) const {
        if constexpr (W == 1) *to = value;
        else *reinterpret_cast<typename lane_storage<S, W>::aligned*>(to) = value;
    }
    PHYSICS_HPP_ALWAYS_INLINE S lane([[maybe_unused]] int i) const {
        if constexpr (W == 1) return value;
        else return value[i];
    }
    PHYSICS_HPP_ALWAYS_INLINE void set_lane([[maybe_unused]] int i, S x) {
        // Not value[i] = x, which clang makes a load, an insertion and a store of the whole vector.
        if constexpr (W == 1) value = x;
        else std::memcpy(reinterpret_cast<char*>(&value) + i * static_cast<int>(sizeof x), &x, sizeof x);
    }

    PHYSICS_HPP_ALWAYS_INLINE friend pack operator+(const pack& a, const pack& b) { return {a.value + b.value}; }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator-(const pack& a, const pack& b) { return {a.value - b.value}; }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator*(const pack& a, const pack& b) { return {a.value * b.value}; }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator/(const pack& a, const pack& b) { return {a.value / b.value}; }
    PHYSICS_HPP_ALWAYS_INLINE friend pack operator-(const pack& a) { return {-a.value}; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator+=(const pack& b) { return *this = *this + b; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator-=(const pack& b) { return *this = *this - b; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator*=(const pack& b) { return *this = *this * b; }
    PHYSICS_HPP_ALWAYS_INLINE pack& operator/=(const pack& b) { return *this = *this / b; }

    PHYSICS_HPP_ALWAYS_INLINE friend pack min(const pack& a, const pack& b) {
        return {b.value < a.value ? b.value : a.value};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack max(const pack& a, const pack& b) {
        return {a.value < b.value ? b.value : a.value};
    }
    PHYSICS_HPP_ALWAYS_INLINE friend pack sqrt(const pack& a) {
        if constexpr (W == 1) return {physics::sqrt(a.value)};
        else return {vector_sqrt(a)};
    }
    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE friend pack<T, W, Bytes> select_greater(const pack& a, const pack& b,
                                                                      const pack<T, W, Bytes>& x,
                                                                      const pack<T, W, Bytes>& y) {
        return {a.value > b.value ? x.value : y.value};
    }
    template <class T>
    PHYSICS_HPP_ALWAYS_INLINE friend auto product(const pack& a, const pack<T, W, Bytes>& b) {
        using physics::product;
        if constexpr (W > 1) return a * b;
        else return pack<decltype(product(a.value, b.value)), W, Bytes>{product(a.value, b.value)};
    }
    template <class R>
    PHYSICS_HPP_ALWAYS_INLINE friend pack<R, W, Bytes> narrow(const pack& a) {
        using physics::narrow;
        if constexpr (W > 1) return a;
        else return {narrow<R>(a.value)};
    }
    template <class R, class T>
    PHYSICS_HPP_ALWAYS_INLINE friend pack<R, W, Bytes> mul(const pack& a, const pack<T, W, Bytes>& b) {
        return narrow<R>(product(a, b));
    }
};

/// Lanes of kernels that may be compiled for wider registers than the unit is: as many as fill one are one vector.
template <class S, int W>
inline constexpr bool is_wide_kernel = PHYSICS_HPP_AVX2_KERNELS != 0 && is_vector<S, W, 32>;
template <class S, int W>
using kernel_pack = pack<S, W, (is_wide_kernel<S, W> ? 32 : vector_bytes)>;

#if PHYSICS_HPP_VECTOR_BYTES > 0
#define PHYSICS_HPP_CONVERT(lanes, type) __builtin_convertvector(lanes, type)
#else
#define PHYSICS_HPP_CONVERT(lanes, type) lanes
#endif
#if PHYSICS_HPP_VECTOR_BYTES > 0

#if defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define PHYSICS_HPP_SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#endif
#if __has_builtin(__builtin_elementwise_sqrt)
#define PHYSICS_HPP_ELEMENTWISE_SQRT
#endif
#endif
#ifndef PHYSICS_HPP_SHUFFLE  // gcc before 12
#define PHYSICS_HPP_SHUFFLE(a, b, ...) __builtin_shuffle(a, b, decltype((a) < (b)){__VA_ARGS__})
#define PHYSICS_HPP_NO_SHUFFLEVECTOR
#endif

/// One vector from two of half its size.
template <class P, class S = typename P::scalar>
PHYSICS_HPP_ALWAYS_INLINE P join(const pack<S, P::width / 2, 16>& low, const pack<S, P::width / 2, 16>& high) {
#ifdef PHYSICS_HPP_NO_SHUFFLEVECTOR
    const pack<S, P::width / 2, 16> halves[2] = {low, high};
    return P::load(reinterpret_cast<const S*>(halves));
#else
    if constexpr (P::width == 4) return {PHYSICS_HPP_SHUFFLE(low.value, high.value, 0, 1, 2, 3)};
    else return {PHYSICS_HPP_SHUFFLE(low.value, high.value, 0, 1, 2, 3, 4, 5, 6, 7)};
#endif
}

/// The lower or upper half of a vector.
template <bool Upper, class S, int W, int Bytes>
PHYSICS_HPP_ALWAYS_INLINE pack<S, W / 2, 16> half_of(const pack<S, W, Bytes>& a) {
#ifdef PHYSICS_HPP_NO_SHUFFLEVECTOR
    S lanes[W];
    a.store(lanes);
    return pack<S, W / 2, 16>::load(lanes + (Upper ? W / 2 : 0));
#else
    constexpr int first = Upper ? W / 2 : 0;
    if constexpr (W == 4) return {PHYSICS_HPP_SHUFFLE(a.value, a.value, first, first + 1)};
    else return {PHYSICS_HPP_SHUFFLE(a.value, a.value, first, first + 1, first + 2, first + 3)};
#endif
}

/// The root of each lane by the target's own instruction: a loop over scalar roots stays scalar, with calls of libm.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE P vector_sqrt(const P& a) {
    using S = typename P::scalar;
    if constexpr (P::width * sizeof(S) == 32) {
        // Two steps here as well: the 32-byte instruction can't be named in code for targets without it.
        return join<P>(vector_sqrt(half_of<false>(a)), vector_sqrt(half_of<true>(a)));
    } else {
#ifdef PHYSICS_HPP_ELEMENTWISE_SQRT
        return {__builtin_elementwise_sqrt(a.value)};
#elif defined(__SSE2__)
        if constexpr (sizeof(S) == 4) return {__builtin_ia32_sqrtps(a.value)};
        else return {__builtin_ia32_sqrtpd(a.value)};
#elif defined(__aarch64__)
        P root;
        if constexpr (sizeof(S) == 4) __asm__("fsqrt %0.4s, %1.4s" : "=w"(root.value) : "w"(a.value));
        else __asm__("fsqrt %0.2d, %1.2d" : "=w"(root.value) : "w"(a.value));
        return root;
#elif defined(__wasm_simd128__)
        if constexpr (sizeof(S) == 4) return {__builtin_wasm_sqrt_f32x4(a.value)};
        else return {__builtin_wasm_sqrt_f64x2(a.value)};
#else
        P root = a;
        for (int i = 0; i < P::width; ++i) root.value[i] = physics::sqrt(a.value[i]);
        return root;
#endif
    }
}

#endif

}  // namespace detail

PHYSICS_HPP_END
