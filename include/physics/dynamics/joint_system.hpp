// The rows of joints that are solved at once, with all that they act on.
#pragma once

#include "physics/dynamics/joint_access.hpp"
#include "physics/dynamics/joint_matrix.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// W times the same joints between other bodies, one in each lane: their rows, the bodies that these push, and the
/// matrix J M^-1 J^T. For the solve only, bodies have so much inertia that forces which turn with them cannot make a
/// substep unstable: else light links under a heavy load fly off. Source: Tournier et al., Stable constrained dynamics
/// (2015).
template <class S, int D, bool Rotates, int W, bool Two>
class joint_system {
protected:
    using P = kernel_pack<S, W>;
    using K = kernel_pack<double, W>;
    using C = typename K::scalar;
    using body = solver_body<S, D, Rotates>;
    using lanes = twist_lanes<P, D, Rotates>;
    using row = row_lanes<S, D, Rotates, W, Two>;
    using side = pushed_lanes<S, D, Rotates, W>;
    using access = joint_access<S, D, Rotates, Two>;
    using pose = joint_pose<S, D, Rotates>;
    using row_state = direct_row<P, S, W>;

    /// `used` components of a pattern; joint(lane, i) is the i-th joint of one, and bodies(lane, i) are its bodies.
    template <class JointAt, class BodiesOf>
    joint_system(const joint_pattern& pattern, int used, const access* kinds, JointAt&& joint, BodiesOf&& bodies,
                 const body* all, std::uint32_t dummy_body, S h, arena& scratch)
        : of_(pattern), kinds_(kinds), matrix_(pattern, C(least_pivot), scratch) {
        joints_ = scratch.template allocate<void*>(of_.joint_count * W);
        rows_ = made<row>(of_.row_count, scratch);
        state_ = made<row_state>(of_.row_count, scratch);
        sides_ = made<side>(of_.body_count, scratch);
        velocities_ = made<lanes>(of_.body_count, scratch);
        moved_ = made<lanes>(of_.body_count, scratch);
        sway_ = scratch.template allocate<double>(of_.body_count);
        inertia_share_ = made<S>(of_.body_count * W, scratch);
        joints_of_ = made<std::uint32_t>(of_.body_count, scratch);
        unit_sway_ = made<K>(of_.joint_count, scratch);
        own_lever_ = scratch.template allocate<double>(of_.joint_count * W);
        for (std::uint32_t k = 0; k < of_.body_count; ++k)
            for (int lane = 0; lane < W; ++lane) sides_[k].index[lane] = dummy_body;
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_pattern::joint& j = of_.joints[i];
            ++joints_of_[j.a], ++joints_of_[j.b];
            for (int lane = 0; lane < W; ++lane) {
                joints_[i * W + static_cast<std::uint32_t>(lane)] = lane < used ? joint(lane, i) : nullptr;
                if (lane >= used) continue;
                const body_pair ends = bodies(lane, i);
                sides_[j.a].index[lane] = ends.a;
                sides_[j.b].index[lane] = ends.b;
                sides_[j.a].is_pushed = all[ends.a].inverse_mass > inverse_of<S>(0);
                sides_[j.b].is_pushed = all[ends.b].inverse_mass > inverse_of<S>(0);
                j.each_row([&](std::uint32_t r, int k) {
                    rows_[r].impulse[lane] = kinds_[j.kind].first_impulse(joint_at(i, lane), k, h);
                    state_[r].together = static_cast<std::uint32_t>(rows_together(kinds_[j.kind].shared_bounds, k));
                    any_shared_ = any_shared_ || state_[r].together > 1;
                });
            }
        }
        std::uint32_t pushed = 0;
        for (std::uint32_t k = 0; k < of_.body_count; ++k) pushed += sides_[k].is_pushed ? 1u : 0u;
        has_loops_ = of_.joint_count + (pushed == of_.body_count ? 1u : 0u) > pushed;
    }
    [[nodiscard]] void* joint_at(std::uint32_t i, int lane) const {
        return joints_[i * W + static_cast<std::uint32_t>(lane)];
    }
    void load(const body* bodies) {
        for (std::uint32_t k = 0; k < of_.body_count; ++k) velocities_[k].load(bodies, sides_[k].index);
    }
    void store(body* bodies) const {
        for (std::uint32_t k = 0; k < of_.body_count; ++k)
            if (sides_[k].is_pushed) velocities_[k].store(bodies, sides_[k].index);
    }
    void apply(std::uint32_t r, const joint_pattern::joint& j, const P& by) {
        rows_[r].apply(by, sides_[j.a], sides_[j.b], velocities_[j.a], velocities_[j.b]);
    }
    /// Has a row give so much in all.
    void give(std::uint32_t r, const joint_pattern::joint& j, const P& next) {
        apply(r, j, next - P::load(rows_[r].impulse));
        next.store(rows_[r].impulse);
    }
    /// Gives the velocities what rows hold.
    void give(S sign) {
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_pattern::joint& j = of_.joints[i];
            for (std::uint32_t r = j.first_row; r < j.first_row + j.row_count; ++r)
                apply(r, j, P::load(rows_[r].impulse) * P::broadcast(sign));
        }
    }

    /// What lasts of forces, so that impacts are not taken for loads: the lesser of the last two substeps'.
    void note_forces() {
        if (are_forces_noted_) return;
        are_forces_noted_ = true;
        for (std::uint32_t r = 0; r < of_.row_count; ++r) {
            row_state& w = state_[r];
            const P now = lane_abs(P::load(rows_[r].impulse));
            (has_loads_ ? min(now, P::load(w.given)) : now).store(w.load);
            now.store(w.given);
        }
        has_loads_ = true;
    }
    void write_rows(const body* bodies, const pose* poses, const joint_pass<S>& with) {
        has_bounds_ = is_any_far_ = false;
        bool is_any_raised = false;
        for (std::uint32_t r = 0; r < of_.row_count; ++r) rows_[r].clear();
        for (int lane = 0; lane < W; ++lane) {
            if (joint_at(0, lane) == nullptr) continue;
            far_[lane] = S(0);
            largest_[lane] = 0;
            for (std::uint32_t k = 0; k < of_.body_count; ++k) sway_[k] = 0;
            for (std::uint32_t k = 0; k < of_.body_count; ++k) sides_[k].put(lane, sides_[k].index[lane], bodies);
            for (std::uint32_t i = 0; i < of_.joint_count; ++i) write_joint(i, lane, bodies, poses, with);
            double largest = 0;
            for (std::uint32_t k = 0; k < of_.body_count; ++k) {
                inertia_share_[k * W + static_cast<std::uint32_t>(lane)] = sway_[k] > 1 ? S(1 / sway_[k]) : S(1);
                largest = max(largest, sway_[k]);
            }
            is_any_raised = is_any_raised || largest > 1;
            resolved_[lane] = largest > max_resolved ? S(0) : S(1);
            if (has_loops_) note_noise(lane, bodies);
        }
        each_row(
            [&](std::uint32_t r, const joint_pattern::joint& j) { rows_[r].finish(sides_[j.a], sides_[j.b], with); });
        if (is_any_raised) {
            for (std::uint32_t k = 0; k < of_.body_count; ++k) sides_[k].scale_inertia(inertia_share_ + k * W);
            each_row([&](std::uint32_t r, const joint_pattern::joint& j) {
                rows_[r].find_response(sides_[j.a], sides_[j.b]);
            });
        }
        assemble<S, D, Rotates, Two>(of_, rows_, sides_, matrix_.matrix);
        is_factorised_ = false;
    }
    /// In a loop rows may say what others say, but for their errors: of two joints with two ends each that are
    /// off by e, (4 e)^2 is left of a diagonal, and the row would give 1 / e times what it should. But what is left of
    /// a row is little too where a light body bears a heavy one: noise is at most a quarter of the share of the lighter
    /// body in the mass of all. A tree has no such rows.
    void note_noise(int lane, const body* bodies) {
        double mass = 0;
        for (std::uint32_t k = 0; k < of_.body_count; ++k)
            if (sides_[k].is_pushed) mass += 1 / to_double(bodies[sides_[k].index[lane]].inverse_mass);
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_pattern::joint& j = of_.joints[i];
            const double inverse_mass = max(to_double(bodies[sides_[j.a].index[lane]].inverse_mass),
                                            to_double(bodies[sides_[j.b].index[lane]].inverse_mass));
            const double noise = min(16 * largest_[lane], 1 / (4 * inverse_mass * mass));
            j.each_row([&](std::uint32_t r, int) { matrix_.row[r].noise.set_lane(lane, static_cast<C>(noise)); });
        }
    }
    PHYSICS_HPP_NOINLINE void write_joint(std::uint32_t i, int lane, const body* bodies, const pose* poses,
                                          const joint_pass<S>& with) {
        const joint_pattern::joint& j = of_.joints[i];
        const std::uint32_t at_a = sides_[j.a].index[lane], at_b = sides_[j.b].index[lane];
        const body &a = bodies[at_a], &b = bodies[at_b];
        typename access::row_memory rows;
        typename access::direction_memory directions;
        const auto to = access::target_of(rows, directions);
        const vec<S, D> between = kinds_[j.kind].write(joint_at(i, lane), false, poses[at_a], poses[at_b], to);
        const double own = own_lever_of(a, b), apart = own + length_squared_of(between);
        own_lever_[i * W + static_cast<std::uint32_t>(lane)] = own;
        double square = 0, square_a = 0, largest = 1, largest_a = 1;
        vec<S, D> r_a, r_b;
        j.each_row([&](std::uint32_t r, int k) {
            rows_[r].put(lane, rows.at[k], to.direction_a(k), with);
            // Of what has room, rests elsewhere or gives in, the error says nothing.
            const bool holds = !rows.at[k].is_bounded() && !rows.at[k].is_spring();
            const bool is_beyond = rows.at[k].is_on() && !(rows.at[k].min_force < S(0)) && rows.at[k].error < S(0);
            const double part =
                holds || is_beyond ? part_of(to_double(rows.at[k].error), rows.at[k], to.direction(k), apart) : 0;
            const bool is_bounded = rows.at[k].is_bounded();
            const double far = is_bounded || part * share_of_far < least_pivot ? 0 : part * share_of_far;
            matrix_.row[r].slack.set_lane(lane, static_cast<C>(is_bounded ? slack_of_bounded : 0));
            matrix_.row[r].far.set_lane(lane, static_cast<C>(far));
            has_bounds_ = has_bounds_ || is_bounded;
            is_any_far_ = is_any_far_ || far > 0;
            largest_[lane] = max(largest_[lane], part);
            if (part > 0.0001) far_[lane] = S(1);
            if (to.direction(k) == vec<S, D>{}) return;
            const double given = to_double(state_[r].load[lane]);
            square += length_squared_of(rows.at[k].direction) * given * given;
            if constexpr (Two) {
                square_a += length_squared_of(to.direction_a(k)) * given * given;
                largest = max(largest, length_squared_of(rows.at[k].direction));
                largest_a = max(largest_a, length_squared_of(to.direction_a(k)));
            }
            r_a = rows.at[k].r_a;
            r_b = rows.at[k].r_b;
        });
        const double of_a = sway_of(a, r_a, joints_of_[j.a] == 1, to_double(b.inverse_mass)),
                     of_b = sway_of(b, r_b, joints_of_[j.b] == 1, to_double(a.inverse_mass));
        const double force_h2 = sqrt(square) * to_double(with.h);
        if constexpr (Two) sway_[j.a] += of_a * sqrt(square_a) * to_double(with.h);
        else sway_[j.a] += of_a * force_h2;
        sway_[j.b] += of_b * force_h2;
        const double unit = Two ? max(of_a * sqrt(largest_a), of_b * sqrt(largest)) : max(of_a, of_b);
        unit_sway_[i].set_lane(lane, static_cast<C>(unit * to_double(with.h)));
    }
    /// Which part may be given of what the right-hand sides say, for errors up to the largest. Where rows all but say
    /// the same, small errors ask for large turns, that lead elsewhere: turns may make no more errors by their
    /// curvature than this fraction of what they are to take away.
    P part_of_step(const joint_pass<S>& with, const double* largest, double fraction) {
        P part = P::broadcast(S(1));
        if constexpr (lanes::angular_size > 0) {
            for (std::uint32_t k = 0; k < of_.body_count; ++k) moved_[k] = {};
            each_row([&](std::uint32_t r, const joint_pattern::joint& j) {
                rows_[r].apply(narrowed<P>(matrix_.row[r].right_hand), sides_[j.a], sides_[j.b], moved_[j.a],
                               moved_[j.b]);
            });
            for (int lane = 0; lane < W; ++lane) {
                double square = 0, sum = 0;
                for (std::uint32_t k = 0; k < of_.body_count; ++k) {
                    double turn = 0;
                    for (int c = D; c < lanes::size; ++c) {
                        const double angle = to_double(moved_[k].at[c].lane(lane)) * to_double(with.h);
                        turn += angle * angle;
                    }
                    if (!sides_[k].is_pushed) continue;
                    square = max(square, turn);
                    sum += turn;
                }
                const double limit = fraction * sqrt(largest[lane]);
                if (sum > limit / 16) is_curved_[lane] = S(1);
                if (square > limit) part.set_lane(lane, S(sqrt(limit / square)));
            }
        }
        return part;
    }
    /// Calls f(row, its joint) for each row.
    template <class F>
    void each_row(F&& f) const {
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_pattern::joint& j = of_.joints[i];
            for (std::uint32_t r = j.first_row; r < j.first_row + j.row_count; ++r) f(r, j);
        }
    }

    /// Of the square of omega h of what sways under the forces of joints: up to it substeps are short enough.
    static constexpr double max_resolved = 0.5;
    /// See joint_matrix.
    static constexpr double least_pivot = 0x1p-20;
    /// How far rows give way that are as far off as what they measure is large. More of it holds up what many bodies
    /// have to move for, less of it lets nets that cannot be met leap.
    static constexpr double share_of_far = 1.0 / 4;
    /// What rows with bounds leave of their speed in a solve, where others all but say the same: so that it is they
    /// that give way.
    static constexpr double slack_of_bounded = 0x1p-14;

    const joint_pattern& of_;
    const access* kinds_;
    void** joints_;
    row* rows_;
    row_state* state_;
    side* sides_;
    /// And what a step would add to them.
    lanes *velocities_, *moved_;
    joint_matrix<K> matrix_;
    double* sway_;
    /// Of each body in each lane which part of its inverse inertia it has for the solve.
    S* inertia_share_;
    /// Of each joint the larger of its bodies' sways by an impulse of 1 N s a substep.
    K* unit_sway_;
    /// See own_lever_of; of each joint in each lane.
    double* own_lever_;
    /// Of each body how many joints it has.
    std::uint32_t* joints_of_;
    bool is_factorised_ = false, are_forces_noted_ = false, has_loads_ = false, has_bounds_ = false,
         any_shared_ = false, is_any_far_ = false, has_loops_ = false;
    /// 1 where substeps are short enough; and where something is farther from what holds it than a hundredth.
    S resolved_[W] = {}, far_[W] = {};
    /// 1 where bodies turn so far in a correction that their ways are curved.
    S is_curved_[W] = {};
    /// The largest error, see part_of.
    double largest_[W] = {};
};

}  // namespace detail

PHYSICS_HPP_END
