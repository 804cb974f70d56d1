// The wheel joint.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// A wheel B on a chassis A: it moves along the x axis of A's frame on a spring, between limits, and spins about its z
/// axis, with a motor. In 3D it is steered about that x axis. Rows: 6 in 2D, 9 in 3D. The spring's frequency is that of
/// the masses that the two bodies have along the axis: of a heavy chassis on light wheels, about that of the wheels.
template <class S, int D>
struct wheel_joint {
    /// In the bodies' frames (m). The x axis of A's is that of the suspension; z axes are those of the wheel.
    transform<S, D> frame_a{}, frame_b{};
    /// The wheel stays between these on the axis (m).
    S min_translation = -scalar_traits<S>::max(), max_translation = scalar_traits<S>::max();
    /// Of the suspension (Hz; 0: there is none), with a damping as a part of the critical one, and where it rests (m).
    S frequency = S(0), damping_ratio = S(0), rest_translation = S(0);
    /// The same whatever the masses are (N/m, N s/m), instead of those.
    S stiffness = S(0), damping = S(0);
    /// A motor drives the spin to that speed (rad/s) by up to that torque (N m); with a speed of 0 it brakes.
    S motor_speed = S(0), max_motor_torque = S(0);
    /// In 3D, how far the wheel is turned about the axis of the suspension (rad, less than pi / 2).
    S steering_angle = S(0);

    static constexpr int row_count = joint_drive<S>::row_count + (D == 2 ? 2 : 5);
    PHYSICS_HPP_MEMBERS(frame_a, frame_b, min_translation, max_translation, frequency, damping_ratio, rest_translation,
                        stiffness, damping, motor_speed, max_motor_torque, steering_angle)

    [[nodiscard]] joint_spring<S> spring() const { return {frequency, damping_ratio, stiffness, damping}; }

    void rows(const joint_frames<S, D>& at, joint_row<S, D>* row) const {
        const vec<S, D> r_b = at.r_b(frame_b.position), apart = at.between + (r_b - at.r_a(frame_a.position)),
                        r_a = at.between + r_b;
        const auto along = [&](int i) { return at.along(at.axis_a(frame_a.rotation, i), r_a, r_b); };
        const auto translation = [&](int i) { return dot(at.axis_a(frame_a.rotation, i), apart); };
        // The motor takes the place of that of the drive.
        const joint_drive<S> drive{min_translation, max_translation, {}, {}, rest_translation, spring()};
        drive.rows(along(0), translation(0), row);
        for (int i = 1; i < D; ++i) row[drive.row_count + i - 1] = along(i).equality(translation(i));
        if constexpr (D == 2) {
            if (max_motor_torque > S(0)) row[5] = at.about(S(1)).motor(motor_speed, max_motor_torque);
        } else {
            // The wheel's axis stays where it is steered to.
            const rotation<S, 3> steered = rotation<S, 3>::from_axis_angle({S(1), S(0), S(0)}, steering_angle);
            const vec<S, 3> x = at.axis_a(frame_a.rotation, 0), spin = at.axis_b(frame_b.rotation, 2),
                            y = at.axis_a(frame_a.rotation * steered, 1), z = at.axis_a(frame_a.rotation * steered, 2),
                            error = cross(z, spin);
            row[6] = at.about(x).equality(dot(error, x));
            row[7] = at.about(y).equality(dot(error, y));
            if (max_motor_torque > S(0)) row[8] = at.about(spin).motor(motor_speed, max_motor_torque);
        }
    }
};

template <class S, int D>
bool check(const wheel_joint<S, D>& joint, const char* function) {
    if (!detail::check_frames(function, joint.frame_a, joint.frame_b) ||
        !detail::check_finite(function, "min_translation", joint.min_translation) ||
        !detail::check_finite(function, "max_translation", joint.max_translation) ||
        !detail::check_limits(function, "min_translation", joint.min_translation, joint.max_translation,
                              "it must be at most max_translation") ||
        !detail::check_spring(function, joint.spring()) ||
        !detail::check_finite(function, "rest_translation", joint.rest_translation) ||
        !detail::check_finite(function, "motor_speed", joint.motor_speed) ||
        !detail::check_not_negative(function, "max_motor_torque", joint.max_motor_torque) ||
        !detail::check_finite(function, "steering_angle", joint.steering_angle))
        return false;
    if (D == 2 && !(joint.steering_angle == S(0)))
        return detail::refuse(function, "steering_angle", static_cast<double>(joint.steering_angle),
                              "it must be 0 in 2D");
    return abs(joint.steering_angle) < S(1.5707) ||
           detail::refuse(function, "steering_angle", static_cast<double>(joint.steering_angle),
                          "it must be less than pi / 2 to either side");
}

PHYSICS_HPP_END
