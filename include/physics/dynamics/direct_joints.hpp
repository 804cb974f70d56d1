// Joints solved directly: all rows of bodies that joints hold together at once.
#pragma once

#include "physics/dynamics/joint_access.hpp"
#include "physics/dynamics/joint_matrix.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// W times the same joints between other bodies, one in each lane. The rows J of all of them are solved at once:
/// J M^-1 J^T is factorised by L D L^T along the joints' graph, in time linear in their number where that is a tree.
/// Limits, motors and other rows with bounds are in or out; a row that would give more than it may is set to its bound,
/// and the others are solved again. Rows that say what others say already give way. For the solve only, bodies have so
/// much inertia that forces which turn with them cannot make a substep unstable: else light links under a heavy load
/// blow up. Source: Baraff, Linear-time dynamics using Lagrange multipliers (1996); Tournier et al., Stable constrained
/// dynamics (2015); Judice, Pires, A block pivoting algorithm (1994).
template <class S, int D, bool Rotates, int W>
class direct_joints {
    using P = kernel_pack<S, W>;
    using K = kernel_pack<double, W>;
    using C = typename K::scalar;
    using body = solver_body<S, D, Rotates>;
    using lanes = twist_lanes<P, D, Rotates>;
    using row = row_lanes<S, D, Rotates, W>;
    using side = pushed_lanes<S, D, Rotates, W>;
    using access = joint_access<S, D, Rotates>;
    using pose = joint_pose<S, D, Rotates>;
    using poses_of = joint_poses<S, D, Rotates>;
    using row_state = direct_row<P, K, S, W>;

public:
    /// `used` components of a pattern; joint(lane, i) is the i-th joint of one, and bodies(lane, i) are its bodies.
    template <class JointAt, class BodiesOf>
    direct_joints(const joint_pattern& pattern, int used, const access* kinds, JointAt&& joint, BodiesOf&& bodies,
                  const body* all, std::uint32_t dummy_body, S h, arena& scratch)
        : of_(pattern), kinds_(kinds), matrix_(pattern, C(least_pivot), scratch) {
        joints_ = scratch.template allocate<void*>(of_.joint_count * W);
        rows_ = made<row>(of_.row_count, scratch);
        state_ = made<row_state>(of_.row_count, scratch);
        sides_ = made<side>(of_.body_count, scratch);
        velocities_ = made<lanes>(of_.body_count, scratch);
        sway_ = scratch.template allocate<double>(of_.body_count);
        joints_of_ = made<std::uint32_t>(of_.body_count, scratch);
        unit_sway_ = made<K>(of_.joint_count, scratch);
        ahead_ = made<pose>(of_.body_count, scratch);
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
    }

    void warm_start(body* bodies, const pose* poses, const joint_pass<S>& with) {
        note_forces();
        write_rows(bodies, poses, with);
        load(bodies);
        give(S(1));
        store(bodies);
    }
    /// See joint_block.
    void update_rows(body* bodies, const pose* poses, const joint_pass<S>& with, twist_of<S, D, Rotates>* starts) {
        take_corrections_back(bodies);
        are_forces_noted_ = false;
        if (starts == nullptr) return write_rows(bodies, poses, with);
        for (std::uint32_t k = 0; k < of_.body_count; ++k) velocities_[k] = {};
        give(S(1));
        write_rows(bodies, poses, with);
        give(S(-1));
        for (std::uint32_t k = 0; k < of_.body_count; ++k)
            if (sides_[k].is_pushed) velocities_[k].add_to(starts, sides_[k].index);
    }
    void solve(body* bodies, const poses_of& poses, const joint_pass<S>& with, bool use_bias) {
        if (use_bias) note_forces();
        load(bodies);
        // The last solve of a pass cuts no row off: what others give would not fit. Each lane goes on by itself.
        const K zero = K::broadcast(C(0));
        K open = K::broadcast(C(1)), cut = zero;
        for (int round = 0; round < max_rounds; ++round) {
            const bool settles = round >= free_rounds;
            K changed = choose_rows(with, use_bias, settles, open), turned = zero;
            if (any_shared_ && !settles) {
                turned = turn_shared(use_bias, open);
                changed = max(changed, choose_rows(with, use_bias, settles, open));
            }
            if (round > 0) open = select_greater(changed + cut + turned, zero, open, zero);
            if (greater(open, zero).bits() == 0) break;
            if (!is_factorised_ || greater(changed, zero).bits() != 0) matrix_.factorise();
            is_factorised_ = true;
            cut = solve_once(open);
            if (!any_bounded_) break;
            if (settles) open = select_greater(cut, zero, open, zero);
        }
        if (use_bias && greater(P::load(resolved_), P::broadcast(S(0))).bits() != 0) look_ahead(poses, with);
        if (use_bias) find_corrections();
        store(bodies);
    }
    void store_impulses(S h) const {
        for (std::uint32_t i = 0; i < of_.joint_count; ++i)
            for (int lane = 0; lane < W; ++lane) {
                if (joint_at(i, lane) == nullptr) continue;
                S given[access::max_rows] = {};
                of_.joints[i].each_row([&](std::uint32_t r, int k) { given[k] = rows_[r].impulse[lane]; });
                kinds_[of_.joints[i].kind].store_impulses(joint_at(i, lane), h, given);
            }
    }

private:
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
        for (std::uint32_t r = 0; r < of_.row_count; ++r)
            for (int lane = 0; lane < W; ++lane) {
                row_state& w = state_[r];
                const S now = abs(rows_[r].impulse[lane]);
                w.load[lane] = has_loads_ ? min(now, w.given[lane]) : now;
                w.given[lane] = now;
            }
        has_loads_ = true;
    }
    void write_rows(const body* bodies, const pose* poses, const joint_pass<S>& with) {
        for (std::uint32_t r = 0; r < of_.row_count; ++r) rows_[r].clear();
        for (int lane = 0; lane < W; ++lane) {
            if (joint_at(0, lane) == nullptr) continue;
            far_[lane] = S(0);
            for (std::uint32_t k = 0; k < of_.body_count; ++k) sway_[k] = 0;
            for (std::uint32_t i = 0; i < of_.joint_count; ++i) write_joint(i, lane, bodies, poses, with);
            for (std::uint32_t k = 0; k < of_.body_count; ++k)
                sides_[k].put(lane, sides_[k].index[lane], bodies, sway_[k] > 1 ? S(1 / sway_[k]) : S(1));
            double largest = 0;
            for (std::uint32_t k = 0; k < of_.body_count; ++k) largest = max(largest, sway_[k]);
            resolved_[lane] = largest > max_resolved ? S(0) : S(1);
        }
        assemble<S, D, Rotates>(of_, rows_, sides_, matrix_.matrix);
        is_factorised_ = false;
    }
    PHYSICS_HPP_NOINLINE void write_joint(std::uint32_t i, int lane, const body* bodies, const pose* poses,
                                          const joint_pass<S>& with) {
        const joint_pattern::joint& j = of_.joints[i];
        const std::uint32_t at_a = sides_[j.a].index[lane], at_b = sides_[j.b].index[lane];
        const body &a = bodies[at_a], &b = bodies[at_b];
        typename access::row_memory rows;
        const double apart =
            length_squared_of(kinds_[j.kind].write(joint_at(i, lane), false, poses[at_a], poses[at_b], rows.at));
        double square = 0;
        vec<S, D> r_a, r_b;
        j.each_row([&](std::uint32_t r, int k) {
            rows_[r].write(lane, rows.at[k], a, b, with);
            // Of what has room, rests elsewhere or gives in, the error says nothing.
            const bool holds = !rows.at[k].is_bounded() && !rows.at[k].is_spring();
            const double part = holds ? part_of(to_double(rows.at[k].error), rows.at[k], apart) : 0;
            matrix_.row[r].slack.set_lane(lane, static_cast<C>(part > 1.0 / 1024 ? part * part : 0));
            if (part > 0.0001) far_[lane] = S(1);
            if (rows.at[k].direction == vec<S, D>{}) return;
            const double given = to_double(state_[r].load[lane]);
            square += length_squared_of(rows.at[k].direction) * given * given;
            r_a = rows.at[k].r_a;
            r_b = rows.at[k].r_b;
        });
        const double of_a = sway_of(a, r_a, joints_of_[j.a] == 1, to_double(b.inverse_mass)),
                     of_b = sway_of(b, r_b, joints_of_[j.b] == 1, to_double(a.inverse_mass));
        const double force_h2 = sqrt(square) * to_double(with.h);
        sway_[j.a] += of_a * force_h2;
        sway_[j.b] += of_b * force_h2;
        unit_sway_[i].set_lane(lane, static_cast<C>(max(of_a, of_b) * to_double(with.h)));
    }
    /// Right-hand sides, and of lanes that are open (1) which rows are in the solve; greater than 0 where these are
    /// others than before. To settle, rows only leave.
    K choose_rows(const joint_pass<S>& with, bool use_bias, bool settles, const K& open) {
        const K zero = K::broadcast(C(0)), one = K::broadcast(C(1));
        K changed = zero;
        any_bounded_ = false;
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_pattern::joint& j = of_.joints[i];
            // Of those that share a bound.
            const row_state* first = nullptr;
            for (std::uint32_t k = j.first_row; k < j.first_row + j.row_count; ++k) {
                row& r = rows_[k];
                auto& w = matrix_.row[k];
                const K before = lanes_from<K>(r.impulse), low = lanes_from<K>(r.low), high = lanes_from<K>(r.high);
                K bias = zero, soft = zero, in = select_greater(high, low, one, zero);
                if (use_bias) {
                    // Of springs with the share m of the speed: m J v + p C + (1 - m) / m_eff lambda = 0.
                    const K share = max(lanes_from<K>(r.share[1]), K::broadcast(C(1e-6)));
                    bias = lanes_from<K>(r.error) * lanes_from<K>(r.push[1]) / share;
                    if (r.has_spring) {
                        const K is_spring = lanes_from<K>(r.spring);
                        soft = select_greater(is_spring, zero,
                                              lane_quotient(lanes_from<K>(r.loss[1]), share * lanes_from<K>(r.mass)),
                                              zero);
                    }
                } else if (r.has_spring) {
                    in = select_greater(lanes_from<K>(r.spring), zero, zero, in);
                }
                if (r.is_one_sided) {
                    const K free = widened<K>(r.room());
                    bias = select_greater(free, zero, free * K::broadcast(static_cast<C>(to_double(with.inverse_h))),
                                          bias);
                }
                const K limit = lanes_from<K>(r.max_bias);
                bias = max(min(bias, limit), -limit);
                state_[k].bias = r.is_bounded || r.has_spring ? zero : bias;
                const K v = widened<K>(r.speed_of(velocities_[j.a], velocities_[j.b])) - lanes_from<K>(r.speed);
                w.right_hand = -(v + bias + (soft + w.leak) * before);
                any_bounded_ = any_bounded_ || r.is_bounded;
                if (state_[k].together != 0) first = &state_[k];
                if (state_[k].together != 1) {
                    in = in * (one - lanes_from<K>(first->is_cut)) * (settles ? w.in : one);
                } else if (r.is_bounded) {
                    // At a bound a row is in if it would leave it.
                    const K up = select_greater(w.right_hand, zero, one, zero);
                    const K down = select_greater(zero, w.right_hand, one, zero);
                    const K inside = select_greater(before, low, select_greater(high, before, one, down), up);
                    const K strictly = select_greater(before, low, select_greater(high, before, one, zero), zero);
                    in = in * (settles ? strictly * w.in : inside);
                }
                in = select_greater(open, zero, in, w.in);
                soft = select_greater(open, zero, soft, w.softness);
                changed = max(changed, lane_abs(in - w.in) + lane_abs(soft - w.softness));
                w.in = in;
                w.softness = soft;
            }
        }
        return changed;
    }
    /// What rows that share a bound give turns to what they act on; greater than 0 where that changes anything.
    K turn_shared(bool use_bias, const K& open) {
        K turned = K::broadcast(C(0));
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_pattern::joint& j = of_.joints[i];
            for (std::uint32_t r = j.first_row, n; r < j.first_row + j.row_count; r += n) {
                n = state_[r].together;
                if (n == 1 || (rows_[r].has_spring && !use_bias)) continue;
                P by[3];
                turned = max(
                    turned, turn_together(rows_ + r, matrix_.row + r, static_cast<int>(n), open, state_[r].is_cut, by));
                for (std::uint32_t k = 0; k < n; ++k) give(r + k, j, P::load(rows_[r + k].impulse) + by[k]);
            }
        }
        return turned;
    }
    /// Has each row give by(row) more, up to its bounds; greater than 0 where any was cut off by these.
    template <class F>
    K give_more(F&& by) {
        P cut = P::broadcast(S(0));
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_pattern::joint& j = of_.joints[i];
            for (std::uint32_t r = j.first_row, n; r < j.first_row + j.row_count; r += n) {
                n = state_[r].together;
                P wanted[3], next[3];
                for (std::uint32_t k = 0; k < n; ++k) next[k] = wanted[k] = P::load(rows_[r + k].impulse) + by(r + k);
                if (n > 1) cut_together(rows_ + r, static_cast<int>(n), next, state_[r].is_cut);
                else next[0] = max(min(wanted[0], P::load(rows_[r].high)), P::load(rows_[r].low));
                for (std::uint32_t k = 0; k < n; ++k) {
                    cut = max(cut, lane_abs(wanted[k] - next[k]));
                    give(r + k, j, next[k]);
                }
            }
        }
        return widened<K>(cut);
    }
    /// Solves for the right-hand sides of some lanes; greater than 0 where a row was cut off.
    K solve_once(const K& open) {
        for (std::uint32_t r = 0; r < of_.row_count; ++r) matrix_.row[r].right_hand *= open;
        matrix_.substitute();
        return give_more([this](std::uint32_t r) { return narrowed<P>(matrix_.row[r].right_hand); });
    }
    /// Rows are tangents to the ways of bodies, which the move leaves by what the square of the substep makes: solves
    /// once more for what holds where bodies will be. So half of what turns a motion is given before it and half after,
    /// and heavy bodies' errors do not act on the levers of light ones. Source: RATTLE (Andersen 1983); Hairer, Lubich,
    /// Wanner, Geometric Numerical Integration, VII.1.
    void look_ahead(const poses_of& poses, const joint_pass<S>& with) {
        // Where bodies turn far the square is not all of it; and what is far off is drawn together first.
        S is_near[W] = {};
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_pattern::joint& j = of_.joints[i];
            for (std::uint32_t r = j.first_row; r < j.first_row + j.row_count; ++r)
                matrix_.row[r].right_hand = widened<K>(rows_[r].speed_of(velocities_[j.a], velocities_[j.b]));
        }
        for (int lane = 0; lane < W; ++lane) {
            if (joint_at(0, lane) == nullptr) continue;
            for (std::uint32_t k = 0; k < of_.body_count; ++k) {
                const auto v = velocities_[k].of(lane);
                ahead_[k] = poses.of(sides_[k].index[lane], &v, with.h);
            }
            is_near[lane] = far_[lane] > S(0) ? S(0) : resolved_[lane];
            for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
                const joint_pattern::joint& j = of_.joints[i];
                typename access::row_memory rows;
                const double apart =
                    length_squared_of(kinds_[j.kind].write(joint_at(i, lane), true, ahead_[j.a], ahead_[j.b], rows.at));
                j.each_row([&](std::uint32_t r, int k) {
                    K& right_hand = matrix_.row[r].right_hand;
                    const bool holds = !rows_[r].is_bounded && !rows_[r].has_spring;
                    const double moved = to_double(rows.at[k].error) - to_double(rows_[r].error[lane]),
                                 misses = holds ? moved - right_hand.lane(lane) * to_double(with.h) : 0;
                    if (part_of(misses, rows.at[k], apart) > 0.0025) is_near[lane] = S(0);
                    right_hand.set_lane(lane, -misses * to_double(with.inverse_h));
                });
            }
        }
        solve_once(lanes_from<K>(is_near));
    }
    /// What rows give for their errors is taken back where it was given, along the same rows: a pass after the move
    /// would leave what heavy bodies are drawn by on the levers of light ones, and whirl them. That keeps angular
    /// momentum but for how far errors move the bodies; where they are small, the pass does it, which keeps all of it.
    void find_corrections() {
        for (std::uint32_t r = 0; r < of_.row_count; ++r) matrix_.row[r].right_hand = -state_[r].bias;
        matrix_.substitute();
        K sway = lanes_from<K>(far_);
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_pattern::joint& j = of_.joints[i];
            for (std::uint32_t r = j.first_row; r < j.first_row + j.row_count; ++r)
                sway = max(sway, lane_abs(matrix_.row[r].right_hand) * unit_sway_[i]);
        }
        const K zero = K::broadcast(C(0)), limit = K::broadcast(C(max_resolved / 16));
        are_corrected_ = greater(sway, limit).bits() != 0;
        for (std::uint32_t r = 0; r < of_.row_count; ++r)
            state_[r].correction = narrowed<P>(select_greater(sway, limit, matrix_.row[r].right_hand, zero));
    }
    void take_corrections_back(body* bodies) {
        if (!are_corrected_) return;
        are_corrected_ = false;
        load(bodies);
        give_more([this](std::uint32_t r) { return -state_[r].correction; });
        store(bodies);
    }

    static constexpr int free_rounds = 4, max_rounds = 64;
    /// Of the square of omega h of what sways under the forces of joints: up to it substeps are short enough.
    static constexpr double max_resolved = 0.5;
    /// See joint_matrix. Of rows that say the same, what is left is the square of how far bodies are off by.
    static constexpr double least_pivot = 0x1p-20;

    const joint_pattern& of_;
    const access* kinds_;
    void** joints_;
    row* rows_;
    row_state* state_;
    side* sides_;
    lanes* velocities_;
    joint_matrix<K> matrix_;
    double* sway_;
    /// Of each joint the larger of its bodies' sways by an impulse of 1 N s a substep.
    K* unit_sway_;
    /// Of each body how many joints it has.
    std::uint32_t* joints_of_;
    pose* ahead_;
    bool is_factorised_ = false, are_forces_noted_ = false, are_corrected_ = false, has_loads_ = false,
         any_bounded_ = false, any_shared_ = false;
    /// 1 where substeps are short enough; and where something is farther from what holds it than a hundredth.
    S resolved_[W] = {}, far_[W] = {};
};

}  // namespace detail

PHYSICS_HPP_END
