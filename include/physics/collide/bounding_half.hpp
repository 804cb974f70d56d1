// A halfspace as the general kernels see it.
#pragma once

#include "physics/shape/core.hpp"
#include "physics/shape/halfspace.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The points for which dot(normal, p) <= offset.
template <int D>
struct bounding_half {
    /// Of unit length, outwards.
    point<D> normal;
    double offset;

    template <class S>
    explicit bounding_half(const halfspace<S, D>& h)
        : normal(normalized(to_point(h.normal))), offset(detail::to_double(h.offset)) {}
    /// The same as seen from the frame in which it stands.
    template <class S>
    bounding_half(const halfspace<S, D>& h, const transform<S, D>& at)
        : normal(normalized(to_matrix(at.rotation) * to_point(h.normal))),
          offset(detail::to_double(h.offset) + dot(normal, to_point(at.position))) {}

    /// The core of its surface's point that is closest to the origin, for motions: with `normal` as their `face`.
    [[nodiscard]] core<D> surface_point() const {
        core<D> point;
        point.corner[0] = normal * offset;
        return point;
    }
    /// How far a point lies outside.
    [[nodiscard]] double height(const point<D>& p) const { return dot(normal, p) - offset; }
};

}  // namespace detail

PHYSICS_HPP_END
