// Eight boxes side by side: what trees are made of.
#pragma once

#include <bit>
#include <limits>

#include "physics/base/pack_mask.hpp"
#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A box in float, whatever the scalar: it holds the exact box, so that a search in float misses nothing.
template <int D>
struct float_box {
    float lower[D], upper[D];
};

/// The next float below or above x, or the end of the range.
inline float stepped(float x, bool up) {
    constexpr float maximum = std::numeric_limits<float>::max();
    if (x != x) return up ? maximum : -maximum;
    if (up ? x >= maximum : x <= -maximum) return up ? maximum : -maximum;
    std::int32_t bits = 0;
    if (x == 0.0f) {
        bits = up ? 1 : static_cast<std::int32_t>(0x80000001u);
    } else {
        std::memcpy(&bits, &x, sizeof bits);
        bits += (x > 0.0f) == up ? 1 : -1;
    }
    std::memcpy(&x, &bits, sizeof x);
    return x < -maximum ? -maximum : x > maximum ? maximum : x;
}
inline float to_float(double x) {
    constexpr double maximum = std::numeric_limits<float>::max();
    return static_cast<float>(x > maximum ? maximum : x < -maximum ? -maximum : x);
}

/// The smallest float box around a box, seen from an origin. Of float itself it is the box, and the origin is 0.
template <class S, int D>
float_box<D> enclosing(const aabb<S, D>& box, const vec<S, D>& origin) {
    float_box<D> result;
    for (int i = 0; i < D; ++i) {
        if constexpr (std::is_same_v<S, float>) {
            result.lower[i] = box.lower[i];
            result.upper[i] = box.upper[i];
        } else {
            // Two roundings to nearest are off by less than one step.
            const double from = static_cast<double>(origin[i]);
            result.lower[i] = stepped(to_float(static_cast<double>(box.lower[i]) - from), false);
            result.upper[i] = stepped(to_float(static_cast<double>(box.upper[i]) - from), true);
        }
    }
    return result;
}

/// Eight boxes in lanes; an empty lane overlaps nothing finite.
template <int D>
struct box_block {
    static constexpr int size = 8;
    using lanes = pack<float, size>;

    float lower[D][size], upper[D][size];

    /// The lower sides by axis, then the upper ones.
    const float* row(int i) const { return i < D ? lower[i] : upper[i - D]; }
    void set(std::uint32_t lane, const float_box<D>& box) {
        for (int i = 0; i < D; ++i) {
            lower[i][lane] = box.lower[i];
            upper[i][lane] = box.upper[i];
        }
    }
    void clear(std::uint32_t lane) {
        constexpr float infinity = std::numeric_limits<float>::infinity();
        for (int i = 0; i < D; ++i) {
            lower[i][lane] = infinity;
            upper[i][lane] = -infinity;
        }
    }
    float_box<D> get(std::uint32_t lane) const {
        float_box<D> box;
        for (int i = 0; i < D; ++i) {
            box.lower[i] = lower[i][lane];
            box.upper[i] = upper[i][lane];
        }
        return box;
    }
    /// The box around all eight.
    float_box<D> all() const {
        float_box<D> box;
        for (int i = 0; i < D; ++i) {
            const lanes l = lanes::load(lower[i]), u = lanes::load(upper[i]);
            box.lower[i] = minimum<false>(l);
            box.upper[i] = minimum<true>(u);
        }
        return box;
    }
    /// Which lanes are empty.
    PHYSICS_HPP_ALWAYS_INLINE pack_mask<float, size> empty() const {
        return greater(lanes::load(lower[0]), lanes::load(upper[0]));
    }
    /// Bit i is set where box i shares a point with the given one.
    std::uint32_t overlapping(const float_box<D>& box) const {
        auto apart = beside(box, 0);
        for (int i = 1; i < D; ++i) apart = apart | beside(box, i);
        return ~apart.bits() & 0xffu;
    }

private:
    PHYSICS_HPP_ALWAYS_INLINE pack_mask<float, size> beside(const float_box<D>& box, int axis) const {
        return greater(lanes::load(lower[axis]), lanes::broadcast(box.upper[axis])) |
               greater(lanes::broadcast(box.lower[axis]), lanes::load(upper[axis]));
    }
    /// The smallest lane, or the largest.
    template <bool Largest, class P>
    PHYSICS_HPP_ALWAYS_INLINE static float minimum(const P& a) {
        float lane[size];
        a.store(lane);
        float best = lane[0];
        for (int i = 1; i < size; ++i) best = (Largest ? lane[i] > best : lane[i] < best) ? lane[i] : best;
        return best;
    }
};

/// Calls f(i) for every bit i that is set.
template <class F>
void each_bit(std::uint32_t bits, F&& f) {
    for (; bits != 0; bits &= bits - 1) f(static_cast<std::uint32_t>(std::countr_zero(bits)));
}

}  // namespace detail

PHYSICS_HPP_END
