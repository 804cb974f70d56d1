// The numbers of a character, and what it stands on.
#pragma once

#include "physics/world/world.hpp"

PHYSICS_HPP_BEGIN

/// Numbers of a character.
template <class S, int D>
struct character_settings {
    /// Distance that it keeps from all surfaces (m).
    S skin = S(0.01);
    /// The steepest slope on which it stands (rad, below a right angle).
    S max_slope = pi<S> / S(4);
    /// The highest step that it climbs (m).
    S step_height = S(0.35);
    /// How far below its feet it keeps to the ground that it leaves downwards (m).
    S snap_distance = S(0.3);
    /// What it pushes bodies with (N), and how heavy it is on what it stands on (kg).
    S strength = S(100);
    S mass = S(80);
    /// What it meets.
    query_filter filter = {};
};
template <class S, int D>
bool check(const character_settings<S, D>& with, const char* function) {
    using namespace detail;
    if (!(with.max_slope < pi<S> / S(2)))
        return refuse(function, "max_slope", static_cast<double>(with.max_slope), "it must be below a right angle");
    return check_positive(function, "skin", with.skin) && check_positive(function, "max_slope", with.max_slope) &&
           check_not_negative(function, "step_height", with.step_height) &&
           check_not_negative(function, "snap_distance", with.snap_distance) &&
           check_not_negative(function, "strength", with.strength) && check_not_negative(function, "mass", with.mass);
}

/// What a character stands on.
template <class S, int D>
struct character_ground {
    shape_id shape;
    body_id body;
    /// Where its foot touches (m), the unit normal of the surface there, and how fast that moves (m/s).
    vec<S, D> point, normal, velocity;

    explicit operator bool() const { return static_cast<bool>(shape); }
};

PHYSICS_HPP_END
