// The gear joint.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// Two wheels that mesh: A turns about the z axis of its frame `ratio` times as far as B about that of its own, the
/// other way round. Turns are those against the line from A's centre to B's, counted over any number of them: other
/// joints hold both to what they turn on, which may turn itself (planetary gears), at any angle (bevel and worm gears).
/// In 3D the line must not lie along a z axis. Error: where the centres coincide, turns are those as seen from the
/// world. Rows: 1.
template <class S, int D>
struct gear_joint {
    /// In the bodies' frames (m), where the wheels' centres are.
    transform<S, D> frame_a{}, frame_b{};
    /// Of B's teeth to A's (not 0); negative of a wheel in a ring, where both turn the same way.
    S ratio = S(1);
    /// A's turn and `ratio` times B's (rad). Default: as they stand when the joint is made or set.
    S phase = scalar_traits<S>::max();

    static constexpr int row_count = 1, angle_count = 2;
    PHYSICS_HPP_MEMBERS(frame_a, frame_b, ratio, phase)

    /// How far A (0) and B (1) are turned.
    [[nodiscard]] S angle(const joint_frames<S, D>& at, int i) const {
        const rotation<S, D> r = i == 0 ? at.rotation_a * frame_a.rotation : at.rotation_b * frame_b.rotation;
        const vec<S, D> seen = inverse_rotate(r, line_of(at).direction);
        return atan2(-seen.y, seen.x);
    }
    void fill_in(const joint_frames<S, D>& at) {
        if (phase == scalar_traits<S>::max()) phase = S(turn_of(at));
    }
    void rows(const joint_frames<S, D>& at, joint_row<S, D>* row) const {
        const auto [line, distance] = line_of(at);
        const angular<S, D> turn_a = turn_against(at.rotation_a * frame_a.rotation, line),
                            turn_b = turn_against(at.rotation_b * frame_b.rotation, line) * ratio;
        // The line turns by the force that bears both.
        joint_row<S, D> r;
        r.r_a = at.r_a(frame_a.position);
        r.r_b = at.r_b(frame_b.position);
        if (distance > S(0)) r.direction = cross(turn_a + turn_b, line) / -distance;
        r.angular_a = turn_a - cross(r.r_a, r.direction);
        r.angular_b = turn_b + cross(r.r_b, r.direction);
        row[0] = r.equality(S(turn_of(at) - detail::to_double(phase)));
    }

private:
    [[nodiscard]] direction_and_length<S, D> line_of(const joint_frames<S, D>& at) const {
        direction_and_length<S, D> line =
            direction_and_length_of(at.between + (at.r_b(frame_b.position) - at.r_a(frame_a.position)));
        if (!(line.length > S(0))) line.direction = at.axis(0);
        return line;
    }
    /// The Jacobian of the turn of a wheel about its z axis against a line, which is across that.
    static S turn_against(const rotation<S, 2>&, const vec<S, 2>&) { return S(1); }
    static vec<S, 3> turn_against(const rotation<S, 3>& wheel, const vec<S, 3>& line) {
        const vec<S, 3> axis = wheel * joint_frames<S, 3>::axis(2);
        const S along = dot(axis, line);
        return (axis - line * along) / max(S(1) - along * along, S(1.0 / 4096));
    }
    [[nodiscard]] double turn_of(const joint_frames<S, D>& at) const {
        return at.turned[0].wide_total() + detail::to_double(ratio) * at.turned[1].wide_total();
    }
};

template <class S, int D>
bool check(const gear_joint<S, D>& joint, const char* function) {
    return detail::check_frames(function, joint.frame_a, joint.frame_b) &&
           detail::check_finite(function, "ratio", joint.ratio) &&
           (!(joint.ratio == S(0)) || detail::refuse(function, "ratio", 0.0, "it must not be 0")) &&
           detail::check_finite(function, "phase", joint.phase);
}

PHYSICS_HPP_END
