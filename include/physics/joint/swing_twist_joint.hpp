// The swing-twist joint: shoulders and hips.
#pragma once

#include "physics/joint/swing_cone.hpp"

PHYSICS_HPP_BEGIN

/// Holds a point of B to one of A, and limits how B's frame turns as seen from A's: the x axis swings by the shortest
/// turn, about an axis across it, within a cone whose section is an ellipse; and before that B twists about x. The
/// twist is counted over any number of turns. In 3D only: in 2D a revolute joint is that. Rows: 13.
template <class S, int D>
struct swing_twist_joint;

template <class S>
struct swing_twist_joint<S, 3> {
    /// In the bodies' frames (m). x is the axis of the twist.
    transform<S, 3> frame_a{}, frame_b{};
    /// How far B swings about the y and the z axis of A's frame, to either side (rad, 0 to pi: any). If both are 0 the
    /// axis is fixed; between y and z they are the half axes of an ellipse.
    S max_swing_y = S(detail::half_turn), max_swing_z = S(detail::half_turn);
    /// The twist stays between these (rad). That needs swings of at most 3 rad: where x points backwards there is none.
    S min_twist = -scalar_traits<S>::max(), max_twist = scalar_traits<S>::max();
    /// A motor turns B as seen from A at this velocity (rad/s, in the axes of A's frame) by up to that torque (N m),
    /// the same in all directions; with a speed of 0 it is friction.
    vec<S, 3> motor_velocity{};
    S max_motor_torque = S(0);
    /// Of a spring (Hz; 0: there is none), with a damping as a part of the critical one, and how B's frame is turned as
    /// seen from A's where it rests. It turns by the shorter way.
    S frequency = S(0), damping_ratio = S(0);
    rotation<S, 3> rest_rotation{};
    /// The same whatever the masses are (N m/rad, N m s/rad), instead of those.
    S stiffness = S(0), damping = S(0);

    static constexpr int row_count = 13, angle_count = 1;
    static constexpr std::uint32_t shared_bounds = 0b11 << 7;
    PHYSICS_HPP_MEMBERS(frame_a, frame_b, max_swing_y, max_swing_z, min_twist, max_twist, motor_velocity,
                        max_motor_torque, frequency, damping_ratio, rest_rotation, stiffness, damping)

    [[nodiscard]] joint_spring<S> spring() const { return {frequency, damping_ratio, stiffness, damping}; }

    /// The twist.
    [[nodiscard]] S angle(const joint_frames<S, 3>& at, int) const {
        const rotation<S, 3> r = at.relative(frame_a.rotation, frame_b.rotation);
        return r.w < S(0) ? S(2) * atan2(-r.x, -r.w) : S(2) * atan2(r.x, r.w);
    }
    void rows(const joint_frames<S, 3>& at, joint_row<S, 3>* row) const {
        at.hold(frame_a.position, frame_b.position, row);
        detail::swing_cone<S>{max_swing_y, max_swing_z}.rows(at, frame_a.rotation, frame_b.rotation, row + 3);
        const joint_drive<S> twist{min_twist, max_twist, {}, {}, {}, {}};
        if (twist.is_limit(min_twist) || twist.is_limit(max_twist)) {
            // What turns B about its x axis, and swings it not.
            const vec<S, 3> a = at.axis_a(frame_a.rotation, 0), b = at.axis_b(frame_b.rotation, 0);
            joint_row<S, 3> limits[twist.row_count];
            twist.rows(at.about((a + b) / max(S(1) + dot(a, b), S(1.0 / 256))), at.turned->total(), limits);
            row[5] = limits[2];
            row[6] = limits[3];
        }
        if (max_motor_torque > S(0))
            for (int i = 0; i < 3; ++i)
                row[7 + i] = at.about_a(frame_a.rotation, i).motor(motor_velocity[i], max_motor_torque);
        if (spring().is_on()) {
            const rotation<S, 3> r = at.relative(frame_a.rotation, frame_b.rotation) * inverse(rest_rotation);
            const vec<S, 3> error = rotation_vector(r);
            for (int i = 0; i < 3; ++i) row[10 + i] = at.about_a(frame_a.rotation, i).spring(error[i], spring());
        }
    }
};

template <class S>
bool check(const swing_twist_joint<S, 3>& joint, const char* function) {
    if (!detail::check_frames(function, joint.frame_a, joint.frame_b) ||
        !detail::check_swing(function, "max_swing_y", joint.max_swing_y) ||
        !detail::check_swing(function, "max_swing_z", joint.max_swing_z) ||
        !detail::check_finite(function, "min_twist", joint.min_twist) ||
        !detail::check_finite(function, "max_twist", joint.max_twist) ||
        !detail::check_limits(function, "min_twist", joint.min_twist, joint.max_twist,
                              "it must be at most max_twist") ||
        !detail::check_finite(function, "motor_velocity", joint.motor_velocity) ||
        !detail::check_not_negative(function, "max_motor_torque", joint.max_motor_torque) ||
        !detail::check_spring(function, joint.spring()) ||
        !detail::check_frame(function, "rest_rotation", "rest_rotation", transform<S, 3>{{}, joint.rest_rotation}))
        return false;
    using drive = joint_drive<S>;
    if (!drive::is_limit(joint.min_twist) && !drive::is_limit(joint.max_twist)) return true;
    constexpr const char* rule = "with limits of the twist it must be at most 3";
    if (joint.max_swing_y > S(3))
        return detail::refuse(function, "max_swing_y", static_cast<double>(joint.max_swing_y), rule);
    return joint.max_swing_z <= S(3) ||
           detail::refuse(function, "max_swing_z", static_cast<double>(joint.max_swing_z), rule);
}

PHYSICS_HPP_END
