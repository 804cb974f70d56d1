// The distance joint: rods, ropes and springs.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// Holds two points of two bodies at a distance. As it stands it is a rod; with a min_length of 0 a rope; with a
/// frequency or a stiffness a damped spring, which limits may bound. Rows: 3. Error: while the points coincide, it
/// pulls along x.
template <class S, int D>
struct distance_joint {
    /// Points in the bodies' frames (m).
    vec<S, D> anchor_a{}, anchor_b{};
    /// Of the rod, or of the spring at rest (m), greater than 0.
    S length = S(1);
    /// Of the spring (Hz; 0: there is none), as it swings with the mass that the bodies have along the line; and its
    /// damping as a part of the critical one.
    S frequency = S(0), damping_ratio = S(0);
    /// The same whatever the masses are (N/m, N s/m), instead of those.
    S stiffness = S(0), damping = S(0);
    /// The distance stays between these (m).
    S min_length = spring().is_on() ? S(0) : length;
    S max_length = spring().is_on() ? scalar_traits<S>::max() : length;

    static constexpr int row_count = 3;
    PHYSICS_HPP_MEMBERS(anchor_a, anchor_b, length, frequency, damping_ratio, stiffness, damping, min_length,
                        max_length)

    [[nodiscard]] joint_spring<S> spring() const { return {frequency, damping_ratio, stiffness, damping}; }

    void rows(const joint_frames<S, D>& at, joint_row<S, D>* row) const {
        const vec<S, D> r_a = at.r_a(anchor_a), r_b = at.r_b(anchor_b), line = at.between + (r_b - r_a);
        const S distance = physics::length(line);
        vec<S, D> n;
        n[0] = S(1);
        if (distance > S(0)) n = line / distance;
        const joint_row<S, D> apart = at.along(n, r_a, r_b), together = at.along(-n, r_a, r_b);
        if (min_length == max_length) {
            row[0] = apart.equality(distance - max_length);
            return;
        }
        if (spring().is_on()) row[0] = apart.spring(distance - length, spring());
        if (min_length > S(0)) row[1] = apart.limit(distance - min_length);
        if (max_length < joint_row<S, D>::unlimited()) row[2] = together.limit(max_length - distance);
    }
};

template <class S, int D>
bool check(const distance_joint<S, D>& joint, const char* function) {
    if (!detail::check_bounded(function, "anchor_a", joint.anchor_a) ||
        !detail::check_bounded(function, "anchor_b", joint.anchor_b) ||
        !detail::check_positive(function, "length", joint.length) || !detail::check_spring(function, joint.spring()) ||
        !detail::check_not_negative(function, "min_length", joint.min_length) ||
        !detail::check_positive(function, "max_length", joint.max_length))
        return false;
    return !(joint.min_length > joint.max_length) ||
           detail::refuse(function, "min_length", static_cast<double>(joint.min_length),
                          "it must be at most max_length");
}

PHYSICS_HPP_END
