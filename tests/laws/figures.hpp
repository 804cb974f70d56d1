// Shapes as oracles see them, in double: a box that may be flat, grown by a radius; or a halfspace.
#pragma once

#include <string>

#include "reals.hpp"

namespace {

using ball = physics::ball<S, D>;
using capsule = physics::capsule<S, D>;
using box = physics::box<S, D>;
using halfspace = physics::halfspace<S, D>;
using any_shape = physics::any_shape<S, D, physics::ball, physics::capsule, physics::box, physics::halfspace>;

/// Balls, capsules and boxes are all points within `radius` of the box |p_i| <= half_i; a halfspace is all
/// points with dot(normal, p) <= offset.
struct figure {
    reals half;
    double radius = 0;
    bool endless = false;
    reals normal;
    double offset = 0;

    /// The distance of a point from the surface; negative inside.
    double distance(reals p) const {
        if (endless) return dot(normal, p) - offset;
        reals beyond;
        double most = -HUGE_VAL;
        for (int i = 0; i < D; ++i) {
            const double q = std::abs(p[i]) - half[i];
            beyond[i] = std::fmax(q, 0);
            most = std::fmax(most, q);
        }
        return (most > 0 ? size(beyond) : most) - radius;
    }
    /// How far the shape reaches along a unit vector.
    double reach(reals n) const {
        double sum = radius;
        for (int i = 0; i < D; ++i) sum += half[i] * std::abs(n[i]);
        return sum;
    }
    /// The largest and the smallest of its sizes; the radius counts where there is one.
    double largest() const { return size(half) + radius; }
    double smallest() const {
        if (radius > 0 || endless) return radius;
        double least = half.x;
        for (int i = 1; i < D; ++i) least = std::fmin(least, half[i]);
        return least;
    }
};

inline figure grown_box(reals half, double radius) {
    figure f;
    f.half = half;
    f.radius = radius;
    return f;
}
inline figure to_figure(const ball& b) { return grown_box({}, cell::number(b.radius)); }
inline figure to_figure(const capsule& c) {
    return grown_box({cell::number(c.half_length), 0, 0}, cell::number(c.radius));
}
inline figure to_figure(const box& b) { return grown_box(to_reals(b.half_extents), 0); }
inline figure to_figure(const halfspace& h) { return {{}, 0, true, unit(to_reals(h.normal)), cell::number(h.offset)}; }
inline figure to_figure(const any_shape& s) {
    return s.visit([](const auto& shape) { return to_figure(shape); });
}

constexpr int kinds = 4;
/// A shape of one kind, with sizes between the two.
inline any_shape random_shape(int kind, cell::dice& dice, double least, double most) {
    switch (kind) {
        case 0: return ball{dice.real(least, most)};
        case 1: return capsule{dice.real(least, most), dice.real(least, most)};
        case 2: return box{dice.vec<vec>(least, most)};
        default: return halfspace{from_reals(random_direction(dice)), dice.real(-most, most)};
    }
}
/// The same shape, larger by a factor.
inline any_shape scaled(const any_shape& shape, double factor) {
    const S f = cell::real(factor);
    switch (shape.kind()) {
        case 0: return ball{shape.get<ball>().radius * f};
        case 1: return capsule{shape.get<capsule>().half_length * f, shape.get<capsule>().radius * f};
        case 2: return box{shape.get<box>().half_extents * f};
        default: return halfspace{shape.get<halfspace>().normal, shape.get<halfspace>().offset * f};
    }
}

}  // namespace
