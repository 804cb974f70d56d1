// The rack joint: a rack and its pinion.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// A pinion A rolls on a rack B: as the pinion turns counter-clockwise about the z axis of its frame, as seen from the
/// rack, this slides along the x axis of its own by the radius times the angle, counted over any number of turns. Other
/// joints hold both to what they move on, which may move itself. The rack is where x is right of the pinion seen along
/// z: at its bottom in 2D, for x to the right; with a negative radius opposite. Rows: 1.
template <class S, int D>
struct rack_joint {
    /// In the bodies' frames (m): A's where the pinion's centre is.
    transform<S, D> frame_a{}, frame_b{};
    /// Of the pinion (m, not 0).
    S radius = S(1);
    /// Where B's frame is along x from the pinion's centre while both frames are turned alike (m). Default: as they
    /// stand when the joint is made or set.
    S offset = scalar_traits<S>::max();

    static constexpr int row_count = 1, angle_count = 1;
    PHYSICS_HPP_MEMBERS(frame_a, frame_b, radius, offset)

    /// How far the pinion is turned as seen from the rack.
    [[nodiscard]] S angle(const joint_frames<S, D>& at, int) const {
        return -at.angle_about_z(at.relative(frame_a.rotation, frame_b.rotation));
    }
    void fill_in(const joint_frames<S, D>& at) {
        if (offset == scalar_traits<S>::max()) offset = S(slip(at));
    }
    void rows(const joint_frames<S, D>& at, joint_row<S, D>* row) const {
        // Both push each other where they roll.
        const vec<S, D> x = at.axis_b(frame_b.rotation, 0);
        vec<S, D> down;
        if constexpr (D == 2) down = perpendicular(x);
        else down = normalized(cross(x, at.axis_a(frame_a.rotation, 2)));
        const vec<S, D> r_a = at.r_a(frame_a.position) + down * radius;
        row[0] = at.along(x, r_a, r_a - at.between).equality(S(slip(at) - detail::to_double(offset)));
    }

private:
    [[nodiscard]] double slip(const joint_frames<S, D>& at) const {
        const vec<S, D> apart = at.between + (at.r_b(frame_b.position) - at.r_a(frame_a.position));
        return detail::to_double(dot(at.axis_b(frame_b.rotation, 0), apart)) -
               detail::to_double(radius) * at.turned->wide_total();
    }
};

template <class S, int D>
bool check(const rack_joint<S, D>& joint, const char* function) {
    return detail::check_frames(function, joint.frame_a, joint.frame_b) &&
           detail::check_finite(function, "radius", joint.radius) &&
           (!(joint.radius == S(0)) || detail::refuse(function, "radius", 0.0, "it must not be 0")) &&
           detail::check_finite(function, "offset", joint.offset);
}

PHYSICS_HPP_END
