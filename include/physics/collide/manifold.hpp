// What the narrowphase says of a pair of shapes.
#pragma once

#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

/// One point of contact, in the frame of shape A.
template <class S, int D>
struct manifold_point {
    /// Halfway between the two surfaces (m).
    vec<S, D> position;
    /// Distance of the surfaces along the normal (m); negative where they overlap.
    S separation{};
    /// Names the features that touch: equal in the next step if the same ones still do.
    std::uint32_t feature = 0;
};

/// The points in which two shapes touch or nearly touch: at most 2 in 2D and 4 in 3D.
template <class S, int D>
struct manifold {
    static constexpr int capacity = D == 2 ? 2 : 4;

    /// Unit normal from A to B, in the frame of shape A.
    vec<S, D> normal;
    manifold_point<S, D> points[capacity];
    int count = 0;

    constexpr void add(vec<S, D> position, S separation, std::uint32_t feature) {
        points[count++] = {position, separation, feature};
    }
};

/// Adds the point between the surfaces of two rounded features: their cores lie at a and b, the distance of
/// the cores along the normal is gap.
template <class S, int D>
constexpr void add_rounded(manifold<S, D>& m, vec<S, D> a, S radius_a, vec<S, D> b, S radius_b, S gap,
                           std::uint32_t feature) {
    const vec<S, D> on_a = a + m.normal * radius_a;
    const vec<S, D> on_b = b - m.normal * radius_b;
    m.add((on_a + on_b) * S(0.5), gap - radius_a - radius_b, feature);
}

/// Two round cores (points with radius): one point, if they are within margin. Coincident centres get the
/// fallback normal.
template <class S, int D>
constexpr void collide_round(vec<S, D> a, S radius_a, vec<S, D> b, S radius_b, vec<S, D> fallback, S margin,
                             std::uint32_t feature, manifold<S, D>& out) {
    const vec<S, D> offset = b - a;
    const S reach = radius_a + radius_b + margin;
    if (largest(offset) > reach) return;
    const auto [direction, gap] = direction_and_length_of(offset);
    if (gap > reach) return;
    out.normal = gap > S(0) ? direction : fallback;
    add_rounded(out, a, radius_a, b, radius_b, gap, feature);
}

namespace detail {
/// What a few roundings of numbers as large as `size` may come to.
template <class S>
constexpr S rounding_of(S size) {
    return S(16) * scalar_traits<S>::epsilon() * (is_fixed<S> ? max(size, S(1)) : size);
}
}  // namespace detail

PHYSICS_HPP_END
