// Comparisons of lanes, as bits.
#pragma once

#include "physics/base/pack.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The answers of a comparison of packs: all bits of a lane, or none.
template <class S, int W, int Bytes = vector_bytes>
struct pack_mask {
    using half = pack_mask<S, W / 2, Bytes>;

    half low, high;

    PHYSICS_HPP_ALWAYS_INLINE friend pack_mask operator|(const pack_mask& a, const pack_mask& b) {
        return {a.low | b.low, a.high | b.high};
    }
    /// Bit i is set where lane i is.
    PHYSICS_HPP_ALWAYS_INLINE std::uint32_t bits() const { return low.bits() | high.bits() << (W / 2); }
};

template <class S, int W, int Bytes>
    requires(W == 1)
struct pack_mask<S, W, Bytes> {
    bool value;

    PHYSICS_HPP_ALWAYS_INLINE friend pack_mask operator|(const pack_mask& a, const pack_mask& b) {
        return {static_cast<bool>(a.value | b.value)};
    }
    PHYSICS_HPP_ALWAYS_INLINE std::uint32_t bits() const { return value; }
};

#if PHYSICS_HPP_VECTOR_BYTES > 0

template <class S, int W, int Bytes>
    requires is_vector<S, W, Bytes>
struct pack_mask<S, W, Bytes> {
    using lanes = typename lane_storage<S, W>::type;
    using storage = decltype(lanes{} < lanes{});

    storage value;

    PHYSICS_HPP_ALWAYS_INLINE friend pack_mask operator|(const pack_mask& a, const pack_mask& b) {
        return {a.value | b.value};
    }
    PHYSICS_HPP_ALWAYS_INLINE std::uint32_t bits() const {
#if defined(__SSE2__)
        if constexpr (W * sizeof(S) == 16 && sizeof(S) == 4)
            return static_cast<std::uint32_t>(__builtin_ia32_movmskps(reinterpret_cast<lanes>(value)));
        else if constexpr (W * sizeof(S) == 16)
            return static_cast<std::uint32_t>(__builtin_ia32_movmskpd(reinterpret_cast<lanes>(value)));
#if defined(__AVX2__)
        else if constexpr (sizeof(S) == 4)
            return static_cast<std::uint32_t>(__builtin_ia32_movmskps256(reinterpret_cast<lanes>(value)));
        else return static_cast<std::uint32_t>(__builtin_ia32_movmskpd256(reinterpret_cast<lanes>(value)));
#else
        else {
            // Kernels for wider registers than the unit's, in whose code those instructions can't be named.
            const pack<S, W, Bytes> all{reinterpret_cast<lanes>(value)};
            return signs(half_of<false>(all)) | signs(half_of<true>(all)) << (W / 2);
        }
#endif
#else
        std::uint32_t result = 0;
        for (int i = 0; i < W; ++i) result |= static_cast<std::uint32_t>(value[i] & 1) << i;
        return result;
#endif
    }

private:
#if defined(__SSE2__) && !defined(__AVX2__)
    template <class Half>
    PHYSICS_HPP_ALWAYS_INLINE static std::uint32_t signs(const Half& of) {
        if constexpr (sizeof(S) == 4) return static_cast<std::uint32_t>(__builtin_ia32_movmskps(of.value));
        else return static_cast<std::uint32_t>(__builtin_ia32_movmskpd(of.value));
    }
#endif
};

#endif

/// a > b in each lane; false where either is NaN.
template <class S, int W, int Bytes>
PHYSICS_HPP_ALWAYS_INLINE pack_mask<S, W, Bytes> greater(const pack<S, W, Bytes>& a, const pack<S, W, Bytes>& b) {
    if constexpr (W == 1 || is_vector<S, W, Bytes>) return {a.value > b.value};
    else return {greater(a.low, b.low), greater(a.high, b.high)};
}

}  // namespace detail

PHYSICS_HPP_END
