// How joints that are solved at once take their errors back.
#pragma once

#include "physics/dynamics/joint_system.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A damped Newton step towards poses without errors, for a move of bodies only. Rows that are far from what they are
/// to hold give way (damped least squares): not all of them can be met, perhaps, and what seems to do it would be a
/// leap. Where bodies turn so far for it that their curved ways matter, a shorter step is looked for, until errors
/// lessen by the measure of the matrix: a taut chain would shake itself apart else. Source: Nakamura, Hanafusa, Inverse
/// kinematic solutions with singularity robustness (1986); Deuflhard, Newton Methods for Nonlinear Problems (2004),
/// 3.3, the natural monotonicity test.
template <class S, int D, bool Rotates, int W, bool Two>
class joint_corrections : protected joint_system<S, D, Rotates, W, Two> {
    using base = joint_system<S, D, Rotates, W, Two>;

protected:
    using typename base::P, typename base::K, typename base::C, typename base::body, typename base::lanes;
    using typename base::row, typename base::access, typename base::pose;
    using poses_of = joint_poses<S, D, Rotates>;
    using joint_of_pattern = joint_pattern::joint;
    using base::far_, base::largest_, base::is_curved_, base::max_resolved, base::unit_sway_, base::is_factorised_,
        base::is_any_far_;
    using base::joint_at, base::each_row, base::apply, base::give, base::part_of_step;
    using base::of_, base::kinds_, base::rows_, base::state_, base::sides_, base::velocities_, base::moved_,
        base::matrix_;

    /// See joint_system.
    template <class JointAt, class BodiesOf>
    joint_corrections(const joint_pattern& pattern, int used, const access* kinds, JointAt&& joint, BodiesOf&& bodies,
                      const body* all, std::uint32_t dummy_body, S h, arena& scratch)
        : base(pattern, used, kinds, joint, bodies, all, dummy_body, h, scratch) {
        ahead_ = made<pose>(of_.body_count, scratch);
        errors_ = made<K>(of_.row_count, scratch);
    }

    /// Of springs without damping it is 0, which would divide: so little does not show.
    static K share_of(const row& r) { return max(lanes_from<K>(r.share), K::broadcast(C(1e-12))); }
    static K limited(const K& bias, const row& r) {
        const K limit = lanes_from<K>(r.max_bias);
        return max(min(bias, limit), -limit);
    }
    /// Has each row give by(row) more, up to its bounds.
    template <class F>
    void give_more(F&& by) {
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_of_pattern& j = of_.joints[i];
            for (std::uint32_t r = j.first_row, n; r < j.first_row + j.row_count; r += n) {
                n = state_[r].together;
                P next[3];
                for (std::uint32_t k = 0; k < n; ++k) next[k] = P::load(rows_[r + k].impulse) + by(r + k);
                if (n > 1) cut_together<W>(rows_ + r, static_cast<int>(n), next);
                else next[0] = max(min(next[0], P::load(rows_[r].high)), P::load(rows_[r].low));
                for (std::uint32_t k = 0; k < n; ++k) give(r + k, j, next[k]);
            }
        }
    }
    /// Calls f(row, number of its joint, what that says of the row, its direction, way between the bodies) for the rows
    /// of a lane, where ahead_ has its bodies.
    template <class F>
    void each_row_ahead(int lane, F&& f) {
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_of_pattern& j = of_.joints[i];
            typename access::row_memory rows;
            typename access::direction_memory directions;
            const auto to = access::target_of(rows, directions);
            const vec<S, D> between = kinds_[j.kind].write(joint_at(i, lane), true, ahead_[j.a], ahead_[j.b], to);
            j.each_row([&](std::uint32_t r, int k) { f(r, i, rows.at[k], to.direction(k), between); });
        }
    }

    /// Has rows take their errors back. What they give for that is taken back where it was given, along the same rows:
    /// a pass after the move would leave what heavy bodies are drawn by on the levers of light ones, and whirl them.
    /// That keeps angular momentum but for how far errors move the bodies; where they are small, the pass does it,
    /// which keeps all of it.
    void find_corrections(const poses_of& poses, const joint_pass<S>& with) {
        const K zero = K::broadcast(C(0)), one = K::broadcast(C(1));
        bool has_changed = is_any_far_;
        P part;
        for (S& is : is_curved_) is = S(0);
        for (int round = 0; round < max_corrections; ++round) {
            each_row([&](std::uint32_t k, const joint_of_pattern& j) {
                const row& r = rows_[k];
                auto& w = matrix_.row[k];
                w.right_hand = zero;
                if (r.has_spring) return;
                if (r.is_bounded && !r.is_one_sided) {
                    // Motors and friction do not hold up what draws errors together: it would be more than they can.
                    has_changed = has_changed || greater(w.in, zero).bits() != 0;
                    w.in = zero;
                    return;
                }
                const K bias = lanes_from<K>(r.error) * lanes_from<K>(r.push) / share_of(r);
                w.right_hand = -limited(bias, r);
                if (!r.is_one_sided) return;
                // Of what has gone too far, unless it goes back by itself.
                const K is_one = lanes_from<K>(r.one_sided),
                        v = widened<K>(r.speed_of(velocities_[j.a], velocities_[j.b]));
                const K more = select_greater(zero, bias, max(w.right_hand - v, zero), zero);
                w.right_hand = select_greater(is_one, zero, more, w.right_hand);
                if (round > 0) return;
                const K in = select_greater(is_one, zero, select_greater(more, zero, one, w.in), w.in);
                has_changed = has_changed || greater(in, w.in).bits() != 0;
                w.in = in;
            });
            if (has_changed) {
                matrix_.factorise(true);
                is_factorised_ = false;
            }
            matrix_.substitute();
            part = part_of_step(with, largest_, to_double(with.rigid.rate) * to_double(with.h));
            // Limits do not pull: those that would are left out.
            has_changed = false;
            each_row([&](std::uint32_t r, const joint_of_pattern&) {
                if (!rows_[r].is_one_sided) return;
                auto& w = matrix_.row[r];
                const P next = P::load(rows_[r].impulse) + narrowed<P>(w.right_hand) * part;
                const K pulls = widened<K>(P::load(rows_[r].low) - next) * w.in;
                w.in = select_greater(pulls, zero, zero, w.in);
                has_changed = has_changed || greater(pulls, zero).bits() != 0;
            });
            if (!has_changed) break;
        }
        K sway = lanes_from<K>(far_);
        each_row([&](std::uint32_t r, const joint_of_pattern&) {
            state_[r].start = P::load(rows_[r].impulse);
            state_[r].correction = narrowed<P>(matrix_.row[r].right_hand);
        });
        if (greater(P::load(is_curved_), P::broadcast(S(0))).bits() != 0) shorten(poses, with, part);
        give_more([&](std::uint32_t r) { return state_[r].correction * part; });
        each_row([&](std::uint32_t r, const joint_of_pattern& j) {
            state_[r].correction = P::load(rows_[r].impulse) - state_[r].start;
            sway = max(sway, lane_abs(widened<K>(state_[r].correction)) * unit_sway_[&j - of_.joints]);
        });
        narrowed<P>(select_greater(sway, K::broadcast(C(max_resolved / 16)), one, zero)).store(is_taken_back_);
        are_corrected_ = true;
    }
    void take_corrections_back(const P& lanes_of) {
        are_corrected_ = false;
        give_more([&](std::uint32_t r) { return -(state_[r].correction * lanes_of); });
    }

    /// Solves for the right-hand sides e, and gives e^T (J M^-1 J^T)^-1 e of each lane.
    void solve_and_measure(double (&size)[W]) {
        for (std::uint32_t r = 0; r < of_.row_count; ++r) errors_[r] = matrix_.row[r].right_hand;
        matrix_.substitute();
        for (int lane = 0; lane < W; ++lane) {
            size[lane] = 0;
            for (std::uint32_t r = 0; r < of_.row_count; ++r)
                size[lane] += static_cast<double>(errors_[r].lane(lane)) *
                              static_cast<double>(matrix_.row[r].right_hand.lane(lane));
        }
    }

    pose* ahead_;
    bool are_corrected_ = false;
    /// 1 in lanes where corrections are taken back along the rows that gave them.
    S is_taken_back_[W] = {};

private:
    /// e^T (J M^-1 J^T)^-1 e, of the errors where that part of the corrections would have bodies.
    void measure(const poses_of& poses, const joint_pass<S>& with, const P& part, double (&size)[W]) {
        for (int lane = 0; lane < W; ++lane) {
            if (!(is_curved_[lane] > S(0))) {
                each_row(
                    [&](std::uint32_t r, const joint_of_pattern&) { matrix_.row[r].right_hand.set_lane(lane, 0); });
                continue;
            }
            for (std::uint32_t k = 0; k < of_.body_count; ++k) {
                lanes v{};
                if (sides_[k].is_pushed)
                    for (int c = 0; c < lanes::size; ++c) v.at[c] = moved_[k].at[c] * part;
                const auto moves = v.of(lane);
                ahead_[k] = poses.of(sides_[k].index[lane], &moves, with.h);
            }
            each_row_ahead(lane, [&](std::uint32_t r, std::uint32_t, const auto& at, const auto&, const auto&) {
                const double error = to_double(at.error);
                const bool is_beyond = rows_[r].one_sided[lane] > S(0) && error < 0;
                const bool counts = !rows_[r].has_spring && (is_beyond || !rows_[r].is_bounded);
                matrix_.row[r].right_hand.set_lane(lane, counts ? static_cast<C>(error) : C(0));
            });
        }
        solve_and_measure(size);
    }
    /// Shortens the part of corrections that is given in lanes with curved ways, until it takes from the errors at
    /// least half of what it would if ways were straight; none if none does.
    void shorten(const poses_of& poses, const joint_pass<S>& with, P& part) {
        double before[W], after[W];
        measure(poses, with, P::broadcast(S(0)), before);
        const double share = to_double(with.rigid.mass_scale * with.rigid.rate * with.h);
        bool is_too_long = true;
        for (int tries = 0; tries < max_tries && is_too_long; ++tries) {
            measure(poses, with, part, after);
            is_too_long = false;
            for (int lane = 0; lane < W; ++lane) {
                const S of = part.lane(lane);
                if (!(is_curved_[lane] > S(0)) || after[lane] <= before[lane] * (1 - share * to_double(of))) continue;
                is_too_long = true;
                part.set_lane(lane, tries + 1 < max_tries ? of * S(0.25) : S(0));
            }
        }
    }

    static constexpr int max_corrections = 8, max_tries = 5;

    /// Of rows, where bodies would be.
    K* errors_;
};

}  // namespace detail

PHYSICS_HPP_END
