// What kinds of joints are made of: rows, and where bodies are.
#pragma once

#include "physics/base/members.hpp"
#include "physics/joint/joint_spring.hpp"
#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

/// One scalar constraint between bodies A and B: a solver gives impulses along its Jacobian J, so that the velocity J v
/// follows `speed` and the error C goes to 0.
template <class S, int D>
struct joint_row {
    /// Jacobian of B's centre of mass; that of A's is its negative. Of length 1 of rows that measure a length,
    /// and 0 of those that only turn.
    vec<S, D> direction{};
    /// Jacobians of the angular velocities (m, or 1 for rows that only turn).
    angular<S, D> angular_a{}, angular_b{};
    /// From the centres of mass to where it acts (m); 0 of rows that only turn.
    vec<S, D> r_a{}, r_b{};
    /// C where the bodies are (m, rad). Of one-sided rows, which have a min_force of 0, it is the room that is left: it
    /// may be greater than 0.
    S error{};
    /// What the row may give (N, N m), min_force <= 0 <= max_force; both 0: it is off. Whether it is must not depend on
    /// where the bodies are.
    S min_force{}, max_force{};
    /// The velocity J v that it drives to (m/s, rad/s).
    S speed{};
    /// Whether the speed is all that it drives to, whatever C is: as stiff as it can be, and does not creep.
    bool is_motor = false;
    /// Of a damped spring that takes C to 0 (Hz, 1); with a frequency of 0 it is as stiff as the solver can make it. Or
    /// these are a stiffness and a damping (N/m, N s/m; N m/rad, N m s/rad).
    S frequency{}, damping_ratio{};
    bool is_physical = false;

    /// A row that gives whatever it takes.
    static constexpr S unlimited() { return scalar_traits<S>::max() / S(8); }
    [[nodiscard]] constexpr bool is_on() const { return min_force < S(0) || max_force > S(0); }
    [[nodiscard]] constexpr bool is_spring() const { return is_physical || frequency > S(0); }
    /// Whether it is on and may not give all that it takes.
    [[nodiscard]] constexpr bool is_bounded() const {
        return is_on() && (max_force < unlimited() || -min_force < unlimited());
    }
    /// The same row, which takes an error of both signs to 0.
    [[nodiscard]] constexpr joint_row equality(S error_) const {
        joint_row r = *this;
        r.error = error_;
        r.max_force = unlimited();
        r.min_force = -r.max_force;
        return r;
    }
    /// The same row, which keeps `room` from falling below 0.
    [[nodiscard]] constexpr joint_row limit(S room) const {
        joint_row r = *this;
        r.error = room;
        r.max_force = unlimited();
        return r;
    }
    /// The same row, which drives J v to a speed by up to so much.
    [[nodiscard]] constexpr joint_row motor(S speed_, S max) const {
        joint_row r = *this;
        r.is_motor = true;
        r.speed = speed_;
        r.max_force = max;
        r.min_force = -max;
        return r;
    }
    /// The same row, which gives no more than that (N, N m).
    [[nodiscard]] constexpr joint_row at_most(S max) const {
        joint_row r = *this;
        r.max_force = min(max, max_force);
        r.min_force = -r.max_force;
        return r;
    }
    /// The same row as a damped spring.
    [[nodiscard]] constexpr joint_row spring(S error_, S frequency_, S damping_ratio_) const {
        joint_row r = equality(error_);
        r.frequency = frequency_;
        r.damping_ratio = damping_ratio_;
        return r;
    }
    [[nodiscard]] constexpr joint_row spring(S error_, const joint_spring<S>& by) const {
        if (!by.is_physical()) return spring(error_, by.frequency, by.damping_ratio);
        joint_row r = spring(error_, by.stiffness, by.damping);
        r.is_physical = true;
        return r;
    }
};

/// The same row the other way round.
template <class S, int D>
constexpr joint_row<S, D> operator-(const joint_row<S, D>& r) {
    joint_row<S, D> result = r;
    result.direction = -r.direction;
    result.angular_a = -r.angular_a;
    result.angular_b = -r.angular_b;
    return result;
}

/// A point of A and one of B, in the bodies' frames.
template <class S, int D>
struct point_pair {
    vec<S, D> a, b;
};

/// An angle that is counted over any number of turns: 2 pi turns + angle, |angle| <= pi.
template <class S>
struct counted_angle {
    S angle{};
    std::int32_t turns = 0;

    /// Where it is when it is seen at `next`, which tells no turns, less than half a turn farther on.
    [[nodiscard]] constexpr counted_angle at(S next) const {
        constexpr double pi = 3.141592653589793;
        return {next, turns + (next - angle > S(pi) ? -1 : next - angle < S(-pi) ? 1 : 0)};
    }
    /// The same when it has turned by about so much.
    [[nodiscard]] constexpr counted_angle after(double turned, S next) const {
        const double passed = (detail::to_double(angle) + turned - detail::to_double(next)) / 6.283185307179586;
        if (!(passed < 1e9) || !(passed > -1e9)) return {next, turns};
        const auto more = static_cast<std::int32_t>(passed < 0 ? passed - 0.5 : passed + 0.5);
        // As unsigned numbers: these wrap where there is no room.
        return {next, static_cast<std::int32_t>(static_cast<std::uint32_t>(turns) + static_cast<std::uint32_t>(more))};
    }
    [[nodiscard]] constexpr S total() const { return angle + S(6.283185307179586) * S(turns); }
    /// The same, for differences of what has turned far.
    [[nodiscard]] double wide_total() const { return detail::to_double(angle) + 6.283185307179586 * turns; }

    PHYSICS_HPP_MEMBERS(angle, turns)
};

/// Where the two bodies of a joint are. Points, axes and frames of joints are given in the frames of their bodies.
template <class S, int D>
struct joint_frames {
    rotation<S, D> rotation_a, rotation_b;
    /// Centres of mass in the bodies' frames, and from A's to B's in world axes.
    vec<S, D> center_a, center_b, between;
    /// Of joints that count their turns, see joint_for.
    const counted_angle<S>* turned = nullptr;
    /// Whether angles are only to be counted: they may be 0.15 rad off, but not where they pass pi.
    bool is_rough = false;

    /// From a body's centre of mass to a point of it, in world axes.
    [[nodiscard]] vec<S, D> r_a(const vec<S, D>& point) const { return rotation_a * (point - center_a); }
    [[nodiscard]] vec<S, D> r_b(const vec<S, D>& point) const { return rotation_b * (point - center_b); }
    /// The row of two points, at these places from the bodies' centres, that move against each other along n.
    [[nodiscard]] static joint_row<S, D> along(const vec<S, D>& n, const vec<S, D>& r_a, const vec<S, D>& r_b) {
        return {n, -cross(r_a, n), cross(r_b, n), r_a, r_b};
    }
    /// The row of B that turns against A about an axis.
    [[nodiscard]] static joint_row<S, D> about(const angular<S, D>& axis) { return {{}, -axis, axis}; }
    /// An axis of a frame of a body in the world: x, y, z by 0, 1, 2.
    [[nodiscard]] vec<S, D> axis_a(const rotation<S, D>& frame, int i) const { return rotation_a * (frame * axis(i)); }
    [[nodiscard]] vec<S, D> axis_b(const rotation<S, D>& frame, int i) const { return rotation_b * (frame * axis(i)); }
    [[nodiscard]] static vec<S, D> axis(int i) {
        vec<S, D> result;
        result[i] = S(1);
        return result;
    }
    /// The row of B that turns against A about an axis of a frame of A; in 2D there is but one.
    [[nodiscard]] joint_row<S, D> about_a(const rotation<S, D>& frame, int i) const {
        if constexpr (D == 2) return about(S(1));
        else return about(axis_a(frame, i));
    }
    /// How a frame of B is turned as seen from one of A.
    [[nodiscard]] rotation<S, D> relative(const rotation<S, D>& frame_a, const rotation<S, D>& frame_b) const {
        return inverse(rotation_a * frame_a) * (rotation_b * frame_b);
    }
    /// How far that turns about the z axis, in [-pi, pi].
    [[nodiscard]] S angle_about_z(const rotation<S, D>& r) const {
        if constexpr (D == 2) {
            return is_rough ? rough_angle(r.sine, r.cosine) : r.angle();
        } else {
            const S z = r.w < S(0) ? -r.z : r.z, w = r.w < S(0) ? -r.w : r.w;
            return S(2) * (is_rough ? rough_angle(z, w) : atan2(z, w));
        }
    }
    /// Rows that keep a frame of B turned as one of A: 1 in 2D, 3 in 3D.
    void hold(const rotation<S, D>& frame_a, const rotation<S, D>& frame_b, joint_row<S, D>* row) const {
        const rotation<S, D> r = relative(frame_a, frame_b);
        if constexpr (D == 2) {
            row[0] = about(S(1)).equality(r.angle());
        } else {
            const vec<S, 3> error = (r.w < S(0) ? -r.imaginary() : r.imaginary()) * S(2);
            for (int i = 0; i < 3; ++i) row[i] = about(axis_a(frame_a, i)).equality(error[i]);
        }
    }
    /// D rows that hold a point of B to one of A.
    void hold(const vec<S, D>& point_a, const vec<S, D>& point_b, joint_row<S, D>* row) const {
        const vec<S, D> to_a = r_a(point_a), to_b = r_b(point_b), apart = between + (to_b - to_a);
        for (int i = 0; i < D; ++i) {
            // Member by member: copies of rows would wait for what has just been written.
            row[i].direction = axis(i);
            row[i].angular_a = -cross_axis(to_a, i);
            row[i].angular_b = cross_axis(to_b, i);
            row[i].r_a = to_a;
            row[i].r_b = to_b;
            row[i].error = apart[i];
            row[i].max_force = joint_row<S, D>::unlimited();
            row[i].min_force = -row[i].max_force;
        }
    }

private:
    /// r x axis(i).
    static angular<S, D> cross_axis(const vec<S, D>& r, int i) {
        if constexpr (D == 2) {
            return i == 0 ? -r.y : r.x;
        } else {
            return i == 0   ? vec<S, 3>{S(0), r.z, -r.y}
                   : i == 1 ? vec<S, 3>{-r.z, S(0), r.x}
                            : vec<S, 3>{r.y, -r.x, S(0)};
        }
    }
    /// The angle of (x, y) to 0.1 rad, exact at multiples of pi / 2.
    static S rough_angle(S y, S x) {
        const S sum = abs(x) + abs(y);
        if (!(sum > S(0))) return S(0);
        constexpr double pi = 3.141592653589793;
        const S angle = y / sum * S(pi / 2);
        return x < S(0) ? S(y < S(0) ? -pi : pi) - angle : angle;
    }
};

/// The same for joints that hold bodies to points of the world.
template <class S, int D>
struct grounded_frames : joint_frames<S, D> {
    /// A's centre of mass in the world.
    vec<S, D> place_a;

    /// From points of the world to points of A and of B.
    [[nodiscard]] vec<S, D> line_a(const vec<S, D>& from, const vec<S, D>& point) const {
        return (place_a - from) + this->r_a(point);
    }
    [[nodiscard]] vec<S, D> line_b(const vec<S, D>& from, const vec<S, D>& point) const {
        return (place_a - from) + (this->between + this->r_b(point));
    }
};

PHYSICS_HPP_END
