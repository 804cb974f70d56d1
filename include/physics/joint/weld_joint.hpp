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

    static constexpr int row_count = D == 2 ? 3 : 6;
    PHYSICS_HPP_MEMBERS(frame_a, frame_b, linear_frequency, linear_damping_ratio, angular_frequency,
                        angular_damping_ratio)

    void rows(const joint_frames<S, D>& at, joint_row<S, D>* row) const {
        at.hold(frame_a.rotation, frame_b.rotation, row);
        at.hold(frame_a.position, frame_b.position, row + row_count - D);
        for (int i = 0; i < row_count; ++i) {
            const bool is_linear = i >= row_count - D;
            row[i].frequency = is_linear ? linear_frequency : angular_frequency;
            row[i].damping_ratio = is_linear ? linear_damping_ratio : angular_damping_ratio;
        }
    }
};

template <class S, int D>
bool check(const weld_joint<S, D>& joint, const char* function) {
    return detail::check_frames(function, joint.frame_a, joint.frame_b) &&
           detail::check_not_negative(function, "linear_frequency", joint.linear_frequency) &&
           detail::check_not_negative(function, "linear_damping_ratio", joint.linear_damping_ratio) &&
           detail::check_not_negative(function, "angular_frequency", joint.angular_frequency) &&
           detail::check_not_negative(function, "angular_damping_ratio", joint.angular_damping_ratio);
}

PHYSICS_HPP_END
