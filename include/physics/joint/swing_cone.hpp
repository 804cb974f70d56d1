// How far an axis of a body may swing from that of another.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

inline constexpr double half_turn = 3.141592653589793;

/// A cone about the x axis of A's frame, in which that of B's stays; its section is an ellipse.
template <class S>
struct swing_cone {
    /// About the y and the z axis (rad); half a turn: any.
    S max_swing_y, max_swing_z;

    static bool is_limit(S swing) { return swing < S(detail::half_turn); }
    /// The room in it in the direction in which B swings; where it may not swing about an axis, that is held. 2 rows.
    void rows(const joint_frames<S, 3>& at, const rotation<S, 3>& frame_a, const rotation<S, 3>& frame_b,
              joint_row<S, 3>* row) const {
        if (!is_limit(max_swing_y) && !is_limit(max_swing_z)) return;
        const vec<S, 3> a = at.axis_a(frame_a, 0), b = at.axis_b(frame_b, 0);
        const vec<S, 3> y = at.axis_a(frame_a, 1), z = at.axis_a(frame_a, 2);
        if (!(max_swing_z > S(0))) row[0] = at.about(cross(b, y)).equality(dot(b, y));
        if (!(max_swing_y > S(0))) row[1] = at.about(cross(b, z)).equality(dot(b, z));
        if (!(max_swing_z > S(0)) && !(max_swing_y > S(0))) return;
        if (!(max_swing_z > S(0))) {
            if (is_limit(max_swing_y)) row[1] = swing_row(at, y, atan2(-dot(b, z), dot(b, a)), max_swing_y);
        } else if (!(max_swing_y > S(0))) {
            if (is_limit(max_swing_z)) row[0] = swing_row(at, z, atan2(dot(b, y), dot(b, a)), max_swing_z);
        } else {
            // The swing about the unit vector `across` by the angle, in which 1 is the ellipse, times its smaller half
            // axis: that has a gradient of at most 1, and where the ellipse is a circle one of 1.
            const auto [across, sine] = direction_and_length_of(cross(a, b));
            const S angle = atan2(sine, dot(a, b)), smaller = min(max_swing_y, max_swing_z),
                    ratio_y = smaller / max_swing_y, ratio_z = smaller / max_swing_z;
            const vec<S, 3> u = sine > S(0) ? across : y;
            const S c = dot(u, y), s = dot(u, z), c_y = c * ratio_y, s_z = s * ratio_z,
                    size = sqrt(c_y * c_y + s_z * s_z);
            const S turns = sine > S(1.0 / 64) ? angle / sine : angle > S(1) ? S(64) * angle : S(1);
            const S aside = turns * c * s * (ratio_z * ratio_z - ratio_y * ratio_y) / size;
            row[0] = at.about(-(u * size + cross(b, u) * aside)).limit(smaller - angle * size);
        }
    }

private:
    /// Keeps a swing about an axis within a limit to both sides.
    static joint_row<S, 3> swing_row(const joint_frames<S, 3>& at, const vec<S, 3>& axis, S swing, S limit) {
        return swing > S(0) ? at.about(-axis).limit(limit - swing) : at.about(axis).limit(limit + swing);
    }
};
template <class S>
bool check_swing(const char* function, const char* field, S value) {
    if (!check_not_negative(function, field, value)) return false;
    return value <= S(3.1416) || refuse(function, field, static_cast<double>(value), "it must be at most pi");
}

}  // namespace detail

PHYSICS_HPP_END
