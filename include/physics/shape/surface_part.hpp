// What surfaces such as meshes and chains are made of.
#pragma once

#include "physics/space/vec.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// One flat part of a surface, in the surface's frame: a segment in 2D, a triangle in 3D.
template <int D>
struct surface_part {
    /// In 2D the ends, the solid being to the left on the way from the first to the second; in 3D
    /// counter-clockwise as seen from outside.
    vec<double, D> corner[D];
    /// Unit normal outwards.
    vec<double, D> normal;
    /// Unit normals of the parts that follow beyond the ends or, in 3D, beyond edge i from corner i to the next.
    vec<double, D> beyond[D];
    /// Whether anything follows there.
    bool continues[D] = {};
    /// Whether it stops bodies on its back too.
    bool two_sided = false;
    std::uint32_t number = 0;
};

/// What a ray needs to know of a part; corners as there.
template <int D>
struct surface_face {
    vec<double, D> corner[D];
    bool two_sided;
};

}  // namespace detail

PHYSICS_HPP_END
