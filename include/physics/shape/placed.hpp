// Shapes that are given with their places: upright, or from a point to a point.
#pragma once

#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

/// A shape and where its frame is in that of its body: what upright() and between() of long shapes give, which lie
/// along x in their own frames, for create_shape.
template <class Shape, int D>
struct placed_shape {
    using S = typename Shape::scalar;

    Shape shape;
    vec<S, D> position = {};
    physics::rotation<S, D> rotation = {};
};

namespace detail {

/// Takes the x axis to the direction of a vector, if it has one.
template <class S>
rotation<S, 2> along_axis(const vec<S, 2>& axis) {
    const vec<S, 2> x = normalized(axis);
    return x == vec<S, 2>{} ? rotation<S, 2>{} : rotation<S, 2>{x.x, x.y};
}
template <class S>
rotation<S, 3> along_axis(const vec<S, 3>& axis) {
    const vec<S, 3> x = normalized(axis);
    return x == vec<S, 3>{} ? rotation<S, 3>{} : shortest_turn<S>({S(1), S(0), S(0)}, x, {S(0), S(0), S(1)});
}
/// Takes it to the y axis.
template <class S, int D>
rotation<S, D> upwards() {
    vec<S, D> y;
    y.y = S(1);
    return along_axis(y);
}
/// Of a shape that is as long as two points are apart.
template <class Shape, class S, int D>
placed_shape<Shape, D> placed_between(const Shape& shape, const vec<S, D>& from, const vec<S, D>& to) {
    return {shape, from + (to - from) * S(0.5), along_axis(to - from)};
}

}  // namespace detail

PHYSICS_HPP_END
