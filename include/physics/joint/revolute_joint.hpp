// The revolute joint: hinges.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// Holds a point of B to one of A, and in 3D the z axes of both frames to each other: B turns about them, with limits,
/// a motor and a spring. The angle is that of B's frame as seen from A's, counter-clockwise, counted over any number of
/// turns. Rows: 6 in 2D, 9 in 3D.
template <class S, int D>
struct revolute_joint {
    /// In the bodies' frames (m).
    transform<S, D> frame_a{}, frame_b{};
    /// The angle stays between these (rad).
    S min_angle = -scalar_traits<S>::max(), max_angle = scalar_traits<S>::max();
    /// A motor drives to that speed (rad/s) by up to that torque (N m); with a speed of 0 it is friction.
    S motor_speed = S(0), max_motor_torque = S(0);
    /// Of a spring (Hz; 0: there is none), with a damping as a part of the critical one, and where it rests (rad).
    S frequency = S(0), damping_ratio = S(0), rest_angle = S(0);
    /// The same whatever the masses are (N m/rad, N m s/rad), instead of those.
    S stiffness = S(0), damping = S(0);

    static constexpr int row_count = joint_drive<S>::row_count + (D == 2 ? 2 : 5);
    PHYSICS_HPP_MEMBERS(frame_a, frame_b, min_angle, max_angle, motor_speed, max_motor_torque, frequency, damping_ratio,
                        rest_angle, stiffness, damping)

    [[nodiscard]] joint_spring<S> spring() const { return {frequency, damping_ratio, stiffness, damping}; }

    static constexpr std::uint32_t point_rows = D == 2 ? 3u << joint_drive<S>::row_count : 0;
    [[nodiscard]] bool holds_points_only() const { return !drive_of().is_on(); }
    [[nodiscard]] point_pair<S, D> points() const { return {frame_a.position, frame_b.position}; }
    static constexpr int angle_count = 1;
    [[nodiscard]] S angle(const joint_frames<S, D>& at, int) const {
        return at.angle_about_z(at.relative(frame_a.rotation, frame_b.rotation));
    }
    [[nodiscard]] bool uses_angles() const { return drive_of().uses_value(); }
    void rows(const joint_frames<S, D>& at, joint_row<S, D>* row) const {
        const joint_drive<S> drive = drive_of();
        if constexpr (D == 2) {
            drive.rows(at.about(S(1)), at.turned->total(), row);
        } else {
            const vec<S, 3> x = at.axis_a(frame_a.rotation, 0), y = at.axis_a(frame_a.rotation, 1),
                            z = at.axis_a(frame_a.rotation, 2), error = cross(z, at.axis_b(frame_b.rotation, 2));
            drive.rows(at.about(z), at.turned->total(), row);
            row[drive.row_count + 3] = at.about(x).equality(dot(error, x));
            row[drive.row_count + 4] = at.about(y).equality(dot(error, y));
        }
        at.hold(frame_a.position, frame_b.position, row + drive.row_count);
    }

private:
    [[nodiscard]] joint_drive<S> drive_of() const {
        return {min_angle, max_angle, motor_speed, max_motor_torque, rest_angle, spring()};
    }
};

template <class S, int D>
bool check(const revolute_joint<S, D>& joint, const char* function) {
    return detail::check_frames(function, joint.frame_a, joint.frame_b) &&
           detail::check_finite(function, "min_angle", joint.min_angle) &&
           detail::check_finite(function, "max_angle", joint.max_angle) &&
           detail::check_limits(function, "min_angle", joint.min_angle, joint.max_angle,
                                "it must be at most max_angle") &&
           detail::check_finite(function, "motor_speed", joint.motor_speed) &&
           detail::check_not_negative(function, "max_motor_torque", joint.max_motor_torque) &&
           detail::check_spring(function, joint.spring()) &&
           detail::check_finite(function, "rest_angle", joint.rest_angle);
}

PHYSICS_HPP_END
