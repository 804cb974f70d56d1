// The joint of six degrees of freedom: each free, limited, driven, sprung or locked.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// How a joint leaves a coordinate, an angle or a length: as it stands free. Equal limits lock it.
template <class S>
struct joint_axis {
    /// It stays between these (m, rad).
    S min = -scalar_traits<S>::max(), max = scalar_traits<S>::max();
    /// A motor drives to that speed (m/s, rad/s) by up to that much (N, N m); with a speed of 0 it is friction.
    S motor_speed = S(0), max_motor = S(0);
    /// Of a spring (Hz; 0: there is none), with a damping as a part of the critical one, and where it rests (m, rad).
    S frequency = S(0), damping_ratio = S(0), rest = S(0);
    /// The same whatever the masses are, instead of those (N/m, N s/m; N m/rad, N m s/rad).
    S stiffness = S(0), damping = S(0);

    PHYSICS_HPP_MEMBERS(min, max, motor_speed, max_motor, frequency, damping_ratio, rest, stiffness, damping)

    [[nodiscard]] joint_spring<S> spring() const { return {frequency, damping_ratio, stiffness, damping}; }
    /// One that stays where it is.
    static constexpr joint_axis locked(S where = S(0)) { return {where, where}; }
    [[nodiscard]] constexpr bool is_free() const {
        return !(max_motor > S(0)) && !spring().is_on() && !joint_drive<S>::is_limit(min) &&
               !joint_drive<S>::is_limit(max);
    }
    [[nodiscard]] constexpr joint_drive<S> drive() const { return {min, max, motor_speed, max_motor, rest, spring()}; }
};

namespace detail {

/// Rows of lengths along the axes of A's frame.
template <class S, int D>
void drive_lengths(const joint_frames<S, D>& at, const transform<S, D>& frame_a, const transform<S, D>& frame_b,
                   const joint_axis<S> (&axes)[D], joint_row<S, D>* row) {
    const vec<S, D> r_b = at.r_b(frame_b.position), apart = at.between + (r_b - at.r_a(frame_a.position));
    for (int i = 0; i < D; ++i) {
        const vec<S, D> n = at.axis_a(frame_a.rotation, i);
        axes[i].drive().rows(at.along(n, at.between + r_b, r_b), dot(n, apart), row + i * joint_drive<S>::row_count);
    }
}
template <class S>
bool check_axis(const char* function, const char* name, const joint_axis<S>& axis) {
    const auto bad = [&](const char* member, S value, const char* rule) {
        return refuse(function, name, member, static_cast<double>(value), rule);
    };
    constexpr const char *finite = "it must be finite", *positive = "it must not be negative";
    if (!is_finite(axis.min)) return bad(".min", axis.min, finite);
    if (!is_finite(axis.max)) return bad(".max", axis.max, finite);
    if (axis.min > axis.max) return bad(".min", axis.min, "it must be at most max");
    if (!is_finite(axis.motor_speed)) return bad(".motor_speed", axis.motor_speed, finite);
    if (!is_finite(axis.max_motor)) return bad(".max_motor", axis.max_motor, finite);
    if (axis.max_motor < S(0)) return bad(".max_motor", axis.max_motor, positive);
    if (!check_spring(function, axis.spring(), axis_spring, name)) return false;
    return is_finite(axis.rest) || bad(".rest", axis.rest, finite);
}

}  // namespace detail

/// Leaves B's frame as many ways to move as its axes say, as seen from A's. It moves along the axes of A's frame. In 3D
/// it turns by Cardan angles: by angle_x about the x axis of A's frame, then by angle_y about the y axis that this has
/// made, then by angle_z about the z axis, which is that of B's frame. Those of x and z are counted over any number of
/// turns. At a quarter turn of angle_y x and z turn alike: it must be limited to 1.5 rad to either side, unless all
/// three are free. Rows: 12 in 2D, 24 in 3D.
template <class S, int D>
struct six_degrees_joint;

/// In 2D it turns by one angle, counted over any number of turns.
template <class S>
struct six_degrees_joint<S, 2> {
    /// In the bodies' frames (m).
    transform<S, 2> frame_a{}, frame_b{};
    /// Along the axes of A's frame (m), and the angle (rad).
    joint_axis<S> x{}, y{}, angle_z{};

    static constexpr int row_count = 3 * joint_drive<S>::row_count, angle_count = 1;
    PHYSICS_HPP_MEMBERS(frame_a, frame_b, x, y, angle_z)

    [[nodiscard]] S angle(const joint_frames<S, 2>& at, int) const {
        return at.relative(frame_a.rotation, frame_b.rotation).angle();
    }
    void rows(const joint_frames<S, 2>& at, joint_row<S, 2>* row) const {
        detail::drive_lengths<S, 2>(at, frame_a, frame_b, {x, y}, row);
        angle_z.drive().rows(at.about(S(1)), at.turned->total(), row + 2 * joint_drive<S>::row_count);
    }
};
template <class S>
struct six_degrees_joint<S, 3> {
    /// In the bodies' frames (m).
    transform<S, 3> frame_a{}, frame_b{};
    /// Along the axes of A's frame (m), and the angles (rad).
    joint_axis<S> x{}, y{}, z{}, angle_x{}, angle_y{}, angle_z{};

    static constexpr int row_count = 6 * joint_drive<S>::row_count, angle_count = 2;
    PHYSICS_HPP_MEMBERS(frame_a, frame_b, x, y, z, angle_x, angle_y, angle_z)

    /// Those that are counted: x and z.
    [[nodiscard]] S angle(const joint_frames<S, 3>& at, int i) const {
        const rotation<S, 3> r = at.relative(frame_a.rotation, frame_b.rotation);
        // Of B's z axis in A's frame, and of A's x axis in B's.
        const vec<S, 3> axis = i == 0 ? r * at.axis(2) : inverse_rotate(r, at.axis(0));
        return i == 0 ? atan2(-axis.y, axis.z) : atan2(-axis.y, axis.x);
    }
    void rows(const joint_frames<S, 3>& at, joint_row<S, 3>* row) const {
        constexpr int n = joint_drive<S>::row_count;
        detail::drive_lengths<S, 3>(at, frame_a, frame_b, {x, y, z}, row);
        // What turns B by one angle and not by the others is across the axes of those.
        const vec<S, 3> a = at.axis_a(frame_a.rotation, 0), b = at.axis_b(frame_b.rotation, 2);
        const auto [across, cosine] = direction_and_length_of(cross(b, a));
        const vec<S, 3> middle = cosine > S(0) ? across : at.axis_a(frame_a.rotation, 1);
        const S scale = S(1) / max(cosine, S(1.0 / 64));
        angle_x.drive().rows(at.about(cross(middle, b) * scale), at.turned[0].total(), row + 3 * n);
        angle_y.drive().rows(at.about(middle), atan2(dot(a, b), cosine), row + 4 * n);
        angle_z.drive().rows(at.about(cross(a, middle) * scale), at.turned[1].total(), row + 5 * n);
    }
};

template <class S>
bool check(const six_degrees_joint<S, 2>& joint, const char* function) {
    return detail::check_frames(function, joint.frame_a, joint.frame_b) && detail::check_axis(function, "x", joint.x) &&
           detail::check_axis(function, "y", joint.y) && detail::check_axis(function, "angle_z", joint.angle_z);
}
template <class S>
bool check(const six_degrees_joint<S, 3>& joint, const char* function) {
    if (!detail::check_frames(function, joint.frame_a, joint.frame_b) || !detail::check_axis(function, "x", joint.x) ||
        !detail::check_axis(function, "y", joint.y) || !detail::check_axis(function, "z", joint.z) ||
        !detail::check_axis(function, "angle_x", joint.angle_x) ||
        !detail::check_axis(function, "angle_y", joint.angle_y) ||
        !detail::check_axis(function, "angle_z", joint.angle_z))
        return false;
    if (joint.angle_x.is_free() && joint.angle_y.is_free() && joint.angle_z.is_free()) return true;
    constexpr const char* rule = "unless all angles are free it must be 1.5 rad at most, to either side";
    if (!(joint.angle_y.min >= S(-1.5)))
        return detail::refuse(function, "angle_y", ".min", static_cast<double>(joint.angle_y.min), rule);
    return joint.angle_y.max <= S(1.5) ||
           detail::refuse(function, "angle_y", ".max", static_cast<double>(joint.angle_y.max), rule);
}

PHYSICS_HPP_END
