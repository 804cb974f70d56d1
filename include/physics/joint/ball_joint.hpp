// The ball joint.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// Holds a point of B to a point of A; both turn freely. Rows: D.
template <class S, int D>
struct ball_joint {
    /// Points in the bodies' frames (m).
    vec<S, D> anchor_a{}, anchor_b{};

    static constexpr int row_count = D;
    PHYSICS_HPP_MEMBERS(anchor_a, anchor_b)

    static constexpr std::uint32_t point_rows = (1u << D) - 1;
    [[nodiscard]] bool holds_points_only() const { return true; }
    [[nodiscard]] point_pair<S, D> points() const { return {anchor_a, anchor_b}; }
    void rows(const joint_frames<S, D>& at, joint_row<S, D>* row) const { at.hold(anchor_a, anchor_b, row); }
};

template <class S, int D>
bool check(const ball_joint<S, D>& joint, const char* function) {
    return detail::check_bounded(function, "anchor_a", joint.anchor_a) &&
           detail::check_bounded(function, "anchor_b", joint.anchor_b);
}

PHYSICS_HPP_END
