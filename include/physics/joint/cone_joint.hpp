// The cone joint: a ball joint that swings only so far.
#pragma once

#include "physics/joint/swing_cone.hpp"

PHYSICS_HPP_BEGIN

/// Holds a point of B to one of A, and the x axis of B's frame within a cone about that of A's; it twists freely. With
/// limits of the twist, motors or springs it is a swing-twist joint. In 3D only: in 2D a revolute joint is that.
/// Rows: 5.
template <class S, int D>
struct cone_joint;

template <class S>
struct cone_joint<S, 3> {
    /// In the bodies' frames (m). x is the axis.
    transform<S, 3> frame_a{}, frame_b{};
    /// Between the axes, at most (rad, 0 to pi): with 0 the axis is fixed, with pi it goes anywhere.
    S half_angle = S(detail::half_turn);

    static constexpr int row_count = 5;
    PHYSICS_HPP_MEMBERS(frame_a, frame_b, half_angle)

    void rows(const joint_frames<S, 3>& at, joint_row<S, 3>* row) const {
        at.hold(frame_a.position, frame_b.position, row);
        detail::swing_cone<S>{half_angle, half_angle}.rows(at, frame_a.rotation, frame_b.rotation, row + 3);
    }
};

template <class S>
bool check(const cone_joint<S, 3>& joint, const char* function) {
    return detail::check_frames(function, joint.frame_a, joint.frame_b) &&
           detail::check_swing(function, "half_angle", joint.half_angle);
}

PHYSICS_HPP_END
