// Searches in float for queries of any scalar: they miss nothing that the exact answer holds.
#pragma once

#include "physics/broadphase/box_block.hpp"
#include "physics/broadphase/queries.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A float at least as large as x; infinity where no number is.
template <class T>
float above(T x) {
    if constexpr (std::is_same_v<T, float>) return x;
    constexpr float maximum = std::numeric_limits<float>::max();
    const float f = stepped(to_float(static_cast<double>(x)), true);
    return f < maximum ? f : std::numeric_limits<float>::infinity();
}

/// How far apart neighbouring numbers of a scalar are, wherever they are; 0 for floats, whose steps shrink with them.
template <class S>
constexpr double step_of() {
    return std::is_floating_point_v<S> ? 0 : static_cast<double>(scalar_traits<S>::epsilon());
}
/// The same as above() of a square that may be beyond the scalar.
template <class S>
float above_square(wide_of<S> square) {
    // The root may be off by a rounding.
    const double root_of = static_cast<double>(root<S>(square)) * (1 + 0x1p-20) + step_of<S>();
    return above(root_of * root_of);
}

/// How far a coordinate may be off after its way to float, a few roundings included.
inline float rounding_pad(float x) { return (x < 0 ? -x : x) * 0x1p-21f; }

/// A ray among boxes in float.
template <int D>
struct float_ray {
    static constexpr float tiny = 1e-30f, slack = 0x1p-20f;

    /// Along one axis: which sides the ray enters and leaves by, as rows of a block, and from where the distances to
    /// them are measured; the extent is in these. The inverse translation, for entries a little less than it is, for
    /// exits a little more.
    struct along {
        int in, out;
        float from_in, from_out, to_in, to_out;
    };
    along axes[D];
    bool moves[D];
    bool moves_along_all = true;
    /// How far the scalar may have rounded a fraction.
    float step = 0;

    template <class S>
    float_ray(const ray<S, D>& r, const vec<S, D>& origin) {
        step = to_float(2 * step_of<S>());
        for (int i = 0; i < D; ++i) {
            float f, from_lower, from_upper, pad = 0;
            if constexpr (std::is_same_v<S, float>) {
                f = r.translation[i];
                from_lower = r.origin[i] + r.extent[i];
                from_upper = r.origin[i] - r.extent[i];
                // A ray in float is what it is, a box may be rounded.
                if (r.extent[i] != 0) pad = rounding_pad(r.origin[i]) + rounding_pad(r.extent[i]);
            } else {
                const double o = static_cast<double>(r.origin[i]) - static_cast<double>(origin[i]);
                const double e = static_cast<double>(r.extent[i]);
                f = to_float(static_cast<double>(r.translation[i]));
                from_lower = to_float(o + e);
                from_upper = to_float(o - e);
                pad = rounding_pad(to_float(o)) + rounding_pad(to_float(e));
            }
            moves[i] = f > tiny || f < -tiny;
            moves_along_all = moves_along_all && moves[i];
            if (!moves[i] && !(r.translation[i] == S(0))) pad += 2 * tiny;
            from_lower += pad;
            from_upper -= pad;
            const float inverse = moves[i] ? 1 / f : 0;
            const bool forward = !moves[i] || f > 0;
            axes[i] = {forward ? i : D + i,
                       forward ? D + i : i,
                       forward ? from_lower : from_upper,
                       forward ? from_upper : from_lower,
                       inverse * (1 - slack),
                       inverse * (1 + slack)};
        }
    }
    /// Which of eight boxes the ray meets within the limit, and about where.
    PHYSICS_HPP_ALWAYS_INLINE std::uint32_t meets(const box_block<D>& boxes, float limit, float (&near)[8]) const {
        return moves_along_all ? find<true>(boxes, limit, near) : find<false>(boxes, limit, near);
    }

private:
    template <bool MovesAlongAll>
    PHYSICS_HPP_ALWAYS_INLINE std::uint32_t find(const box_block<D>& boxes, float limit, float (&near)[8]) const {
        using lanes = typename box_block<D>::lanes;
        lanes first = lanes::broadcast(0), last = lanes::broadcast(limit);
        auto apart = greater(first, last);
        for (int i = 0; i < D; ++i) {
            const along& a = axes[i];
            const lanes in = lanes::load(boxes.row(a.in)) - lanes::broadcast(a.from_in);
            const lanes out = lanes::load(boxes.row(a.out)) - lanes::broadcast(a.from_out);
            if (!MovesAlongAll && !moves[i]) {
                apart = apart | greater(in, lanes::broadcast(0)) | greater(lanes::broadcast(0), out);
                continue;
            }
            first = max(first, in * lanes::broadcast(a.to_in));
            last = min(last, out * lanes::broadcast(a.to_out));
        }
        first.store(near);
        apart = apart | greater(first, last + lanes::broadcast(step));
        return ~apart.bits() & 0xffu;
    }
};

/// A point among boxes in float.
template <int D>
struct float_point {
    float lower[D], upper[D];

    template <class S>
    float_point(const vec<S, D>& p, const vec<S, D>& origin) {
        for (int i = 0; i < D; ++i) {
            const float f = to_float(static_cast<double>(p[i]) - static_cast<double>(origin[i]));
            const float pad = std::is_same_v<S, float> ? 0 : rounding_pad(f);
            lower[i] = f - pad;
            upper[i] = f + pad;
        }
    }
    /// Which of eight boxes are within the square of a distance, and about at which.
    std::uint32_t within(const box_block<D>& boxes, float limit, float (&squares)[8]) const {
        using lanes = typename box_block<D>::lanes;
        const lanes zero = lanes::broadcast(0);
        lanes sum = zero;
        for (int i = 0; i < D; ++i) {
            const lanes below = lanes::load(boxes.lower[i]) - lanes::broadcast(upper[i]);
            const lanes above = lanes::broadcast(lower[i]) - lanes::load(boxes.upper[i]);
            const lanes apart = max(max(below, above), zero);
            sum += apart * apart;
        }
        sum = sum * lanes::broadcast(1 - 0x1p-20f);
        sum.store(squares);
        const auto outside = greater(sum, lanes::broadcast(limit)) | boxes.empty();
        return ~outside.bits() & 0xffu;
    }
};

/// A bounding plane among boxes in float.
template <int D>
struct float_plane {
    float normal[D];
    float offset;

    float_plane() = default;
    template <class S>
    float_plane(const bounding_plane<S, D>& plane, const vec<S, D>& origin) {
        // Scaled to a normal of about 1; how far the offset may be off depends on what it is a sum of.
        double largest = 0;
        for (int i = 0; i < D; ++i) {
            const double n = static_cast<double>(plane.normal[i]);
            largest = n > largest ? n : -n > largest ? -n : largest;
        }
        const double scale = largest > 0 ? 1 / largest : 1;
        double sum = static_cast<double>(plane.offset) * scale, parts = sum < 0 ? -sum : sum;
        for (int i = 0; i < D; ++i) {
            const double n = static_cast<double>(plane.normal[i]) * scale, o = n * static_cast<double>(origin[i]);
            normal[i] = to_float(n);
            sum -= o;
            parts += o < 0 ? -o : o;
        }
        offset = above(sum + parts * 0x1p-40);
        offset += rounding_pad(offset);
    }
    /// Which of eight boxes are not wholly beyond.
    std::uint32_t reaches(const box_block<D>& boxes) const {
        using lanes = typename box_block<D>::lanes;
        lanes sum = lanes::broadcast(-offset), error = lanes::broadcast(0);
        for (int i = 0; i < D; ++i) {
            const lanes corner = lanes::load(normal[i] > 0 ? boxes.lower[i] : boxes.upper[i]);
            // The ends of float stand for whatever is beyond them.
            const lanes product_of = corner * lanes::broadcast(normal[i]), away = max(corner, -corner);
            const lanes along = select_greater(away, lanes::broadcast(3.4e38f), -away, product_of);
            sum += along;
            error += max(along, -along);
        }
        return ~greater(sum, error * lanes::broadcast(0x1p-20f)).bits() & 0xffu;
    }
};

/// A convex region among boxes in float: its first planes, which exclude most; the exact test knows the others.
template <int D>
class float_region {
public:
    template <class S>
    float_region(const bounding_plane<S, D>* planes, std::uint32_t count, const vec<S, D>& origin)
        : count_(count < capacity ? count : capacity) {
        for (std::uint32_t i = 0; i < count_; ++i) planes_[i] = {planes[i], origin};
    }
    /// Which of eight boxes are not wholly beyond any of them.
    std::uint32_t reaches(const box_block<D>& boxes) const {
        std::uint32_t lanes = ~boxes.empty().bits() & 0xffu;
        for (std::uint32_t i = 0; i < count_ && lanes != 0; ++i) lanes &= planes_[i].reaches(boxes);
        return lanes;
    }

private:
    static constexpr std::uint32_t capacity = 16;

    std::uint32_t count_;
    float_plane<D> planes_[capacity];
};

}  // namespace detail

PHYSICS_HPP_END
