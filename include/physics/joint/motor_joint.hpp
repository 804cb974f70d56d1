// The motor joint.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// Drives B's frame, as seen from A's, to a velocity by limited forces, whatever the direction: with speeds of 0 that
/// is friction. Springs may draw B's frame to A's as well. Forces act where B's frame is. Rows: 6 in 2D, 12 in 3D.
template <class S, int D>
struct motor_joint {
    /// In the bodies' frames (m).
    transform<S, D> frame_a{}, frame_b{};
    /// Along and about the axes of A's frame (m/s, rad/s).
    vec<S, D> linear_velocity{};
    angular<S, D> angular_velocity{};
    /// What drives it gives no more than these (N, N m).
    S max_force = S(0), max_torque = S(0);
    /// Of springs that draw B's frame to A's (Hz; 0: there are none), with a damping as a part of the critical one. In
    /// 3D they turn it by the shorter way.
    S linear_frequency = S(0), linear_damping_ratio = S(0);
    S angular_frequency = S(0), angular_damping_ratio = S(0);
    /// The same whatever the masses are, instead of those (N/m, N s/m; N m/rad, N m s/rad).
    S linear_stiffness = S(0), linear_damping = S(0);
    S angular_stiffness = S(0), angular_damping = S(0);
    /// Springs give no more than these (N, N m).
    S max_spring_force = scalar_traits<S>::max(), max_spring_torque = scalar_traits<S>::max();

    static constexpr int turns = D == 2 ? 1 : 3, row_count = 2 * (D + turns);
    static constexpr std::uint32_t shared_bounds = D == 2 ? 0b001001 : 0b011011011011;
    PHYSICS_HPP_MEMBERS(frame_a, frame_b, linear_velocity, angular_velocity, max_force, max_torque, linear_frequency,
                        linear_damping_ratio, angular_frequency, angular_damping_ratio, linear_stiffness,
                        linear_damping, angular_stiffness, angular_damping, max_spring_force, max_spring_torque)

    [[nodiscard]] joint_spring<S> linear_spring() const {
        return {linear_frequency, linear_damping_ratio, linear_stiffness, linear_damping};
    }
    [[nodiscard]] joint_spring<S> angular_spring() const {
        return {angular_frequency, angular_damping_ratio, angular_stiffness, angular_damping};
    }

    void rows(const joint_frames<S, D>& at, joint_row<S, D>* row) const {
        const vec<S, D> r_b = at.r_b(frame_b.position), apart = at.between + (r_b - at.r_a(frame_a.position)),
                        r_a = at.between + r_b;
        for (int i = 0; i < D; ++i) {
            const vec<S, D> x = at.axis_a(frame_a.rotation, i);
            const joint_row<S, D> along = at.along(x, r_a, r_b);
            if (max_force > S(0)) row[i] = along.motor(linear_velocity[i], max_force);
            if (linear_spring().is_on())
                row[D + turns + i] = along.spring(dot(x, apart), linear_spring()).at_most(max_spring_force);
        }
        const angular<S, D> error = rotation_vector(at.relative(frame_a.rotation, frame_b.rotation));
        for (int i = 0; i < turns; ++i) {
            const joint_row<S, D> about = at.about_a(frame_a.rotation, i);
            if (max_torque > S(0)) row[D + i] = about.motor(component(angular_velocity, i), max_torque);
            if (angular_spring().is_on())
                row[2 * D + turns + i] = about.spring(component(error, i), angular_spring()).at_most(max_spring_torque);
        }
    }

private:
    static S component(S x, int) { return x; }
    static S component(const vec<S, 3>& v, int i) { return v[i]; }
};

template <class S, int D>
bool check(const motor_joint<S, D>& joint, const char* function) {
    return detail::check_frames(function, joint.frame_a, joint.frame_b) &&
           detail::check_finite(function, "linear_velocity", joint.linear_velocity) &&
           detail::check_finite(function, "angular_velocity", joint.angular_velocity) &&
           detail::check_not_negative(function, "max_force", joint.max_force) &&
           detail::check_not_negative(function, "max_torque", joint.max_torque) &&
           detail::check_spring(function, joint.linear_spring(), detail::linear_spring) &&
           detail::check_spring(function, joint.angular_spring(), detail::angular_spring) &&
           detail::check_not_negative(function, "max_spring_force", joint.max_spring_force) &&
           detail::check_not_negative(function, "max_spring_torque", joint.max_spring_torque);
}

PHYSICS_HPP_END
