// What a shape must offer.
#pragma once

#include "physics/space/check.hpp"
#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

/// A shape for the scalar S in D dimensions: a trivially copyable value with free functions
///   check(shape, function)       refuses bad numbers (see error.hpp) and says whether all are good
///   bounds(shape, transform)     the axis-aligned box around the shape at that transform
///   as<T>()                      a member: the same shape with the scalar T
/// and, where dynamic bodies may carry it,
///   mass_of(shape, density)      mass properties; density in kg/m^3 (kg/m^2 in 2D)
///   support(shape, direction)    the farthest point of the shape along a direction, in its own frame
template <class Shape, class S, int D>
concept shape_for = std::is_trivially_copyable_v<Shape> && requires(const Shape shape, const transform<S, D> at) {
    { check(shape, "function") } -> std::same_as<bool>;
    { bounds(shape, at) } -> std::same_as<aabb<S, D>>;
    shape.template as<double>();
};

/// A shape that has a mass.
template <class Shape, class S, int D>
concept solid_shape_for = shape_for<Shape, S, D> && requires(const Shape shape, S density, vec<S, D> direction) {
    { mass_of(shape, density) } -> std::same_as<mass_properties<S, D>>;
    { support(shape, direction) } -> std::same_as<vec<S, D>>;
};

PHYSICS_HPP_END
