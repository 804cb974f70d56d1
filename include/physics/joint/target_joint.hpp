// The target joint: dragging a body by a point.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// Draws a point of B to a target in A's frame, in the world's if A is a static body at its origin, by a spring of
/// limited force: as a mouse drags. Rows: D.
template <class S, int D>
struct target_joint {
    /// In the frame of A, and in that of B (m).
    vec<S, D> target{}, anchor_b{};
    /// Of the spring, whatever the masses are (N/m, N s/m; 0: by a frequency).
    S stiffness = S(0), damping = S(0);
    /// Of the spring (Hz, greater than 0 unless it has a stiffness), and its damping as a part of the critical one.
    S frequency = stiffness > S(0) || damping > S(0) ? S(0) : S(5);
    S damping_ratio = stiffness > S(0) || damping > S(0) ? S(0) : S(1);
    /// At most, whatever the direction (N).
    S max_force = scalar_traits<S>::max();

    static constexpr int row_count = D;
    static constexpr std::uint32_t shared_bounds = D == 2 ? 0b1 : 0b11;
    PHYSICS_HPP_MEMBERS(target, anchor_b, stiffness, damping, frequency, damping_ratio, max_force)

    [[nodiscard]] joint_spring<S> spring() const { return {frequency, damping_ratio, stiffness, damping}; }

    void rows(const joint_frames<S, D>& at, joint_row<S, D>* row) const {
        at.hold(target, anchor_b, row);
        for (int i = 0; i < D; ++i) row[i] = row[i].spring(row[i].error, spring()).at_most(max_force);
    }
};

template <class S, int D>
bool check(const target_joint<S, D>& joint, const char* function) {
    return detail::check_bounded(function, "target", joint.target) &&
           detail::check_bounded(function, "anchor_b", joint.anchor_b) &&
           detail::check_spring(function, joint.spring()) &&
           (joint.spring().is_physical() || detail::check_positive(function, "frequency", joint.frequency)) &&
           detail::check_not_negative(function, "max_force", joint.max_force);
}

PHYSICS_HPP_END
