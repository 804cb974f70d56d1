// Joints: what a kind of joint tells of itself, whoever solves it.
#pragma once

#include "physics/base/members.hpp"
#include "physics/base/stage.hpp"
#include "physics/space/check.hpp"
#include "physics/space/space.hpp"

PHYSICS_HPP_BEGIN

/// One scalar constraint between bodies A and B: a solver gives impulses along its Jacobian J, so that the velocity J v
/// follows `speed` and the error C goes to 0.
template <class S, int D>
struct joint_row {
    /// Jacobian of B's centre of mass; that of A's is its negative. Of length 1, or 0 for rows that only turn.
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
    /// Of a damped spring that takes C to 0 (Hz, 1); with a frequency of 0 it is as stiff as the solver can make it.
    S frequency{}, damping_ratio{};

    /// A row that gives whatever it takes.
    static constexpr S unlimited() { return scalar_traits<S>::max() / S(8); }
    [[nodiscard]] constexpr bool is_on() const { return min_force < S(0) || max_force > S(0); }
    [[nodiscard]] constexpr bool is_spring() const { return frequency > S(0); }
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
        r.speed = speed_;
        r.max_force = max;
        r.min_force = -max;
        return r;
    }
    /// The same row as a damped spring.
    [[nodiscard]] constexpr joint_row spring(S error_, S frequency_, S damping_ratio_) const {
        joint_row r = equality(error_);
        r.frequency = frequency_;
        r.damping_ratio = damping_ratio_;
        return r;
    }
};

/// Where the two bodies of a joint are. Points, axes and frames of joints are given in the frames of their bodies.
template <class S, int D>
struct joint_frames {
    rotation<S, D> rotation_a, rotation_b;
    /// Centres of mass in the bodies' frames, and from A's to B's in world axes.
    vec<S, D> center_a, center_b, between;

    /// From a body's centre of mass to a point of it, in world axes.
    [[nodiscard]] vec<S, D> r_a(const vec<S, D>& point) const { return rotation_a * (point - center_a); }
    [[nodiscard]] vec<S, D> r_b(const vec<S, D>& point) const { return rotation_b * (point - center_b); }
    /// The row of two points, at these places from the bodies' centres, that move against each other along n.
    [[nodiscard]] static joint_row<S, D> along(const vec<S, D>& n, const vec<S, D>& r_a, const vec<S, D>& r_b) {
        return {n, -cross(r_a, n), cross(r_b, n), r_a, r_b};
    }
    /// The row of B that turns against A about an axis.
    [[nodiscard]] static joint_row<S, D> about(const angular<S, D>& axis) { return {{}, -axis, axis}; }
    /// D rows that hold a point of B to one of A.
    void hold(const vec<S, D>& point_a, const vec<S, D>& point_b, joint_row<S, D>* row) const {
        const vec<S, D> to_a = r_a(point_a), to_b = r_b(point_b), apart = between + (to_b - to_a);
        for (int i = 0; i < D; ++i) {
            vec<S, D> n;
            n[i] = S(1);
            row[i] = along(n, to_a, to_b).equality(apart[i]);
        }
    }
};

/// What a kind of joint must offer: values whose members are listed, a function check(joint, function) like that of
/// shapes, and how many rows it has, 1 to 16: rows(frames, row) writes them. It is pure geometry, and is asked in each
/// substep; all else is the library's.
template <class Joint, class S, int D>
concept joint_for = std::is_trivially_copyable_v<Joint> && detail::names_members<Joint> &&
    requires(const Joint& joint, const joint_frames<S, D>& at, joint_row<S, D>* row) {
    { check(joint, "create_joint") } -> std::same_as<bool>;
    requires Joint::row_count >= 1 && Joint::row_count <= 16;
    joint.rows(at, row);
};

/// The joints that a world knows, of those in joint/ or your own. Default: none, which costs nothing.
template <template <class, int> class... Joints>
struct joints {
    using stage = physics::stage::joints;
};

PHYSICS_HPP_END
