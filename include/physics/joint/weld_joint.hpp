// The weld joint.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// Holds B's frame to A's, rigidly or by springs, apart for places and turns. Rows: 3 in 2D, 6 in 3D.
template <class S, int D>
struct weld_joint {
    /// In the bodies' frames (m).
    transform<S, D> frame_a{}, frame_b{};
    /// Of springs (Hz; 0: rigid), with a damping as a part of the critical one.
    S linear_frequency = S(0), linear_damping_ratio = S(0);
    S angular_frequency = S(0), angular_damping_ratio = S(0);
    /// The same whatever the masses are, instead of those (N/m, N s/m; N m/rad, N m s/rad).
    S linear_stiffness = S(0), linear_damping = S(0);
    S angular_stiffness = S(0), angular_damping = S(0);

    static constexpr int row_count = D == 2 ? 3 : 6;
    PHYSICS_HPP_MEMBERS(frame_a, frame_b, linear_frequency, linear_damping_ratio, angular_frequency,
                        angular_damping_ratio, linear_stiffness, linear_damping, angular_stiffness, angular_damping)

    [[nodiscard]] joint_spring<S> linear_spring() const {
        return {linear_frequency, linear_damping_ratio, linear_stiffness, linear_damping};
    }
    [[nodiscard]] joint_spring<S> angular_spring() const {
        return {angular_frequency, angular_damping_ratio, angular_stiffness, angular_damping};
    }

    void rows(const joint_frames<S, D>& at, joint_row<S, D>* row) const {
        at.hold(frame_a.rotation, frame_b.rotation, row);
        at.hold(frame_a.position, frame_b.position, row + row_count - D);
        for (int i = 0; i < row_count; ++i) {
            const joint_spring<S> by = i >= row_count - D ? linear_spring() : angular_spring();
            if (by.is_on()) row[i] = row[i].spring(row[i].error, by);
        }
    }
};

template <class S, int D>
bool check(const weld_joint<S, D>& joint, const char* function) {
    return detail::check_frames(function, joint.frame_a, joint.frame_b) &&
           detail::check_spring(function, joint.linear_spring(), detail::linear_spring) &&
           detail::check_spring(function, joint.angular_spring(), detail::angular_spring);
}

PHYSICS_HPP_END
