// Where the bodies of joints are within a step, and the rows that joints have there.
#pragma once

#include "physics/dynamics/constraints.hpp"
#include "physics/dynamics/row_lanes.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Where a body is within a step.
template <class S, int D, bool Rotates>
struct joint_pose {
    /// Since the step began.
    twist_of<S, D, Rotates> displacement;
    /// How it is turned, if that is known: else by its displacement.
    physics::rotation<S, D> rotation;
    /// Of bodies whose angular velocity is as seen from themselves, drawn where they were turned as the step began: the
    /// turn since then.
    physics::rotation<S, D> turn;
    bool is_known = false, is_drawn = false;

    [[nodiscard]] physics::rotation<S, D> rotation_from(const physics::rotation<S, D>& start) const {
        if constexpr (Rotates) return is_known ? rotation : turned(start, displacement.angular);
        else return start;
    }
    /// An axis of angular velocities as that of the body is drawn.
    [[nodiscard]] angular<S, D> drawn(const angular<S, D>& axis) const {
        if constexpr (D == 3) return is_drawn ? inverse_rotate(turn, axis) : axis;
        else return axis;
    }
};
/// Where bodies are and will be, as far as a motion can tell.
template <class S, int D, bool Rotates>
class joint_poses {
    using pose = joint_pose<S, D, Rotates>;
    using twist = twist_of<S, D, Rotates>;

public:
    template <class Motion>
    joint_poses(solver_bodies<S, D, Rotates> bodies, const Motion& motion) : bodies_(bodies) {
        if constexpr (Rotates &&
                      requires(pose & to) { motion.find_rotation(0u, to, static_cast<twist*>(nullptr), S{}); }) {
            motion_ = &motion;
            find_rotation_ = [](const void* of, std::uint32_t k, pose& to, const twist* v, S h) {
                static_cast<const Motion*>(of)->find_rotation(k, to, v, h);
            };
        }
    }
    /// Where a body is, or with a velocity where it will be after h.
    [[nodiscard]] pose of(std::uint32_t k, const twist* v = nullptr, S h = S(0)) const {
        pose result;
        result.displacement = bodies_[k].displacement;
        if (v != nullptr) {
            result.displacement.linear += v->linear * h;
            if constexpr (Rotates) result.displacement.angular += v->angular * h;
        }
        if (motion_ != nullptr && k < bodies_.static_body()) find_rotation_(motion_, k, result, v, h);
        return result;
    }

private:
    solver_bodies<S, D, Rotates> bodies_;
    const void* motion_ = nullptr;
    void (*find_rotation_)(const void*, std::uint32_t, pose&, const twist*, S) = nullptr;
};

/// Writes the rows of a joint whose bodies have these poses; gives the way from one centre of mass to the other. Turns
/// are counted where bodies are, and not where they are looked for ahead.
template <class Joint, class S, int D, bool Rotates, bool Two>
vec<S, D> write_rows(step_joint<Joint, S, D>& joint, [[maybe_unused]] bool is_ahead, const joint_pose<S, D, Rotates>& a,
                     const joint_pose<S, D, Rotates>& b, const row_target<S, D, Two>& to) {
    auto at = joint.start;
    at.between = at.between + (b.displacement.linear - a.displacement.linear);
    at.rotation_a = a.rotation_from(at.rotation_a);
    at.rotation_b = b.rotation_from(at.rotation_b);
    at.is_rough = !uses_angles(*joint.joint);
    const auto turned = count_turns(*joint.joint, at, joint.turned);
    at.turned = turned.begin();
    if (!is_ahead) joint.turned = turned;
    if constexpr (has_two_directions<Joint>()) at.place_a = at.place_a + a.displacement.linear;
    rows_of(*joint.joint, at, to);
    if (a.is_drawn || b.is_drawn)
        for (int k = 0; k < Joint::row_count; ++k) {
            to.row[k].angular_a = a.drawn(to.row[k].angular_a);
            to.row[k].angular_b = b.drawn(to.row[k].angular_b);
        }
    return at.between;
}
/// Counts turns since the step began, with rows of a joint that were written then only. For angles that nothing uses.
template <class Joint, class S, int D, bool Rotates>
void count_turns_since(step_joint<Joint, S, D>& joint, const joint_pose<S, D, Rotates>& a,
                       const joint_pose<S, D, Rotates>& b) {
    static_assert(D == 2);
    auto at = joint.start;
    at.rotation_a = a.rotation_from(at.rotation_a);
    at.rotation_b = b.rotation_from(at.rotation_b);
    at.is_rough = true;
    double by = 0;
    if constexpr (Rotates) by = to_double(b.displacement.angular) - to_double(a.displacement.angular);
    for (int i = 0; i < angles_of<Joint>(); ++i) joint.turned[i] = joint.turned[i].after(by, joint.joint->angle(at, i));
}
/// What a row gave in the last step, for substeps of h.
template <class Joint, class S, int D>
S first_impulse(const step_joint<Joint, S, D>& joint, int row, S h) {
    return joint.substep > S(0) ? joint.impulse[row] * impulse_ratio(joint.substep, h, S(8)) : S(0);
}
/// Keeps what rows gave in the step, and in a substep as long as usual ones, to which a shorter one adds its part:
/// given(row) and sum(row).
template <class Joint, class S, int D, class Given, class Sum>
void store_impulses(step_joint<Joint, S, D>& to, S h, Given&& given, Sum&& sum) {
    for (int k = 0; k < Joint::row_count; ++k) to.sum[k] = sum(k);
    const S before = to.substep, usual = max(h, before - h * S(0.125));
    const S kept = h < before ? S(1) - impulse_ratio(before, h) : S(0);
    for (int k = 0; k < Joint::row_count; ++k)
        to.impulse[k] = h < before ? (to.impulse[k] * kept + given(k)) * (usual / before) : given(k);
    to.substep = usual;
}

}  // namespace detail

PHYSICS_HPP_END
