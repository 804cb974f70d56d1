// Inertias of bodies whose joints are visited one after the other.
#pragma once

#include "physics/dynamics/joint_access.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The inverse inertia of what turns by that part of what it would.
template <class S, class I>
    requires std::same_as<I, inverse_of<S>>
constexpr I steadied(const I& inverse_inertia, const S& share) { return mul<I>(inverse_inertia, share); }
template <class S, class I>
constexpr symmetric<I> steadied(const symmetric<I>& m, const S& share) {
    return {mul<I>(m.xx, share), mul<I>(m.yy, share), mul<I>(m.zz, share),
            mul<I>(m.xy, share), mul<I>(m.xz, share), mul<I>(m.yz, share)};
}

template <class I>
constexpr I trace(const symmetric<I>& m) {
    return m.xx + m.yy + m.zz;
}

/// Forces are those of one round in the last step: in the next one they may well be so many times as large.
constexpr double rise_of_forces = 4;

/// For the step, has bodies of joints that are not solved directly so much inertia that the forces and torques which
/// they held in the last one cannot make a substep unstable by turning with them (geometric stiffness); see
/// joint_system. What is prepared afterwards sees it, contacts too. Errors: the way of what turns by more than about
/// half a radian a substep. Cost: one look at each of these joints. Source: Tournier et al., Stable constrained
/// dynamics (2015).
template <class S, int D, bool Two>
PHYSICS_HPP_NOINLINE void raise_inertias(const graph_joint* joints, void* const* steps, const bool* is_direct,
                                         std::uint32_t count, const joint_access<S, D, true, Two>* kinds,
                                         solver_bodies<S, D, true> bodies, const joint_pose<S, D, true>* poses, S h,
                                         arena& scratch) {
    using access = joint_access<S, D, true, Two>;
    std::uint32_t first = 0;
    while (first < count && is_direct[first]) ++first;
    if (first == count) return;
    auto* const sway = scratch.template allocate<double>(bodies.count);
    auto* const joints_of = scratch.template allocate<std::uint32_t>(bodies.count);
    for (std::uint32_t k = 0; k < bodies.count; ++k) sway[k] = 0, joints_of[k] = 0;
    for (std::uint32_t i = 0; i < count; ++i) ++joints_of[joints[i].ends.a], ++joints_of[joints[i].ends.b];
    for (std::uint32_t i = first; i < count; ++i) {
        if (is_direct[i]) continue;
        const access& kind = kinds[joints[i].kind];
        const body_pair& ends = joints[i].ends;
        const bool is_point = kind.point_rows != 0 && joints[i].rows == kind.point_rows;
        typename access::row_memory rows;
        typename access::direction_memory directions;
        const auto to = access::target_of(rows, directions);
        point_pair<S, D> r;
        if (is_point) r = kind.find_points(steps[i], poses[ends.a], poses[ends.b]);
        else kind.write(steps[i], true, poses[ends.a], poses[ends.b], to);
        double square_a = 0, square_b = 0, square_of_torque = 0;
        for (std::uint32_t on = joints[i].rows; on != 0; on &= on - 1) {
            const int k = std::countr_zero(on);
            const double given = to_double(kind.first_impulse(steps[i], k, h)), square = given * given;
            square_a += square * (is_point ? 1 : length_squared_of(to.direction_a(k)));
            square_b += square * (is_point ? 1 : length_squared_of(to.direction(k)));
            if (is_point) continue;
            if (to.direction(k) == vec<S, D>{}) square_of_torque += square;
            else r = {rows.at[k].r_a, rows.at[k].r_b};
        }
        const auto &a = bodies[ends.a], &b = bodies[ends.b];
        const bool is_last_a = joints_of[ends.a] == 1, is_last_b = joints_of[ends.b] == 1;
        const double rise = rise_of_forces * to_double(h);
        sway[ends.a] += rise * sqrt(square_a) * sway_of(a, r.a, is_last_a, to_double(b.inverse_mass));
        sway[ends.b] += rise * sqrt(square_b) * sway_of(b, r.b, is_last_b, to_double(a.inverse_mass));
        // In 3D torques turn with bodies too.
        if constexpr (D == 3)
            for (const std::uint32_t end : {ends.a, ends.b})
                sway[end] += rise * sqrt(square_of_torque) * to_double(trace(bodies[end].inverse_inertia));
    }
    for (std::uint32_t k = 0; k < bodies.count; ++k)
        if (sway[k] > 1) bodies[k].inverse_inertia = steadied(bodies[k].inverse_inertia, S(1 / sway[k]));
}

}  // namespace detail

PHYSICS_HPP_END
