// The prismatic joint: sliders.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// Keeps B's frame on the x axis of A's, turned as that: B slides along it, with limits, a motor and a spring. Rows: 6
/// in 2D, 9 in 3D.
template <class S, int D>
struct prismatic_joint {
    /// In the bodies' frames (m).
    transform<S, D> frame_a{}, frame_b{};
    /// B's frame stays between these on the axis (m).
    S min_translation = -scalar_traits<S>::max(), max_translation = scalar_traits<S>::max();
    /// A motor drives to that speed (m/s) by up to that force (N); with a speed of 0 it is friction.
    S motor_speed = S(0), max_motor_force = S(0);
    /// Of a spring (Hz; 0: there is none), with a damping as a part of the critical one, and where it rests (m).
    S frequency = S(0), damping_ratio = S(0), rest_translation = S(0);
    /// The same whatever the masses are (N/m, N s/m), instead of those.
    S stiffness = S(0), damping = S(0);

    static constexpr int row_count = joint_drive<S>::row_count + (D == 2 ? 2 : 5);
    PHYSICS_HPP_MEMBERS(frame_a, frame_b, min_translation, max_translation, motor_speed, max_motor_force, frequency,
                        damping_ratio, rest_translation, stiffness, damping)

    [[nodiscard]] joint_spring<S> spring() const { return {frequency, damping_ratio, stiffness, damping}; }

    void rows(const joint_frames<S, D>& at, joint_row<S, D>* row) const {
        const vec<S, D> r_b = at.r_b(frame_b.position), apart = at.between + (r_b - at.r_a(frame_a.position)),
                        r_a = at.between + r_b;
        const auto along = [&](int i) { return at.along(at.axis_a(frame_a.rotation, i), r_a, r_b); };
        const auto translation = [&](int i) { return dot(at.axis_a(frame_a.rotation, i), apart); };
        const joint_drive<S> drive{min_translation, max_translation,  motor_speed,
                                   max_motor_force, rest_translation, spring()};
        drive.rows(along(0), translation(0), row);
        for (int i = 1; i < D; ++i) row[drive.row_count + i - 1] = along(i).equality(translation(i));
        at.hold(frame_a.rotation, frame_b.rotation, row + drive.row_count + D - 1);
    }
};

template <class S, int D>
bool check(const prismatic_joint<S, D>& joint, const char* function) {
    return detail::check_frames(function, joint.frame_a, joint.frame_b) &&
           detail::check_finite(function, "min_translation", joint.min_translation) &&
           detail::check_finite(function, "max_translation", joint.max_translation) &&
           detail::check_limits(function, "min_translation", joint.min_translation, joint.max_translation,
                                "it must be at most max_translation") &&
           detail::check_finite(function, "motor_speed", joint.motor_speed) &&
           detail::check_not_negative(function, "max_motor_force", joint.max_motor_force) &&
           detail::check_spring(function, joint.spring()) &&
           detail::check_finite(function, "rest_translation", joint.rest_translation);
}

PHYSICS_HPP_END
