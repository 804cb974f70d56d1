// Joints solved directly: all rows of bodies that joints hold together at once.
#pragma once

#include "physics/dynamics/joint_bounds.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// W times the same joints between other bodies, one in each lane. The rows J of all of them are solved at once:
/// J M^-1 J^T is factorised by L D L^T along the joints' graph, in time linear in their number where that is a tree.
/// Rows that say what others say already give way. Source: Baraff, Linear-time dynamics using Lagrange multipliers
/// (1996).
template <class S, int D, bool Rotates, int W, bool Two>
class direct_joints : joint_bounds<S, D, Rotates, W, Two> {
    using base = joint_bounds<S, D, Rotates, W, Two>;
    using typename base::P, typename base::K, typename base::C, typename base::body, typename base::lanes;
    using typename base::poses_of;
    using typename base::row, typename base::access, typename base::pose;

public:
    /// See joint_system.
    template <class JointAt, class BodiesOf>
    direct_joints(const joint_pattern& pattern, int used, const access* kinds, JointAt&& joint, BodiesOf&& bodies,
                  const body* all, std::uint32_t dummy_body, S h, arena& scratch)
        : base(pattern, used, kinds, joint, bodies, all, dummy_body, h, scratch) {
        starts_ = made<lanes>(of_.body_count, scratch);
        asked_ = made<K>(of_.row_count, scratch);
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
        if (are_corrected_) {
            load(bodies);
            take_corrections_back(P::load(is_taken_back_));
            store(bodies);
        }
        are_forces_noted_ = false;
        if (starts == nullptr) return write_rows(bodies, poses, with);
        for (std::uint32_t k = 0; k < of_.body_count; ++k) velocities_[k] = {};
        give(S(1));
        write_rows(bodies, poses, with);
        give(S(-1));
        for (std::uint32_t k = 0; k < of_.body_count; ++k)
            if (sides_[k].is_pushed) velocities_[k].add_to(starts, sides_[k].index);
    }
    /// Says that bodies of a lane have contacts.
    void touch(int lane) { is_touched_[lane] = S(1); }
    void solve(body* bodies, const poses_of& poses, const joint_pass<S>& with, joint_round round) {
        if (round == joint_round::before_contacts) return solve_before_contacts(bodies, with);
        const bool springs = has_springs(round), errors = has_errors(round);
        // All at once: further rounds would find the same.
        if (errors && !springs && are_corrected_) return;
        if (springs) note_forces();
        load(bodies);
        // A solver may visit joints several times before it moves.
        if (are_corrected_) take_corrections_back(P::broadcast(S(1)));
        if (springs || !errors) settle(with, springs, K::broadcast(C(1)));
        if (springs && greater(P::load(resolved_), P::broadcast(S(0))).bits() != 0) look_ahead(poses, with);
        if (errors) find_corrections(poses, with);
        if (round == joint_round::relaxing)
            for (std::uint32_t r = 0; r < of_.row_count; ++r) rows_[r].add_up();
        store(bodies);
    }
    void store_impulses(const pose*, S h) const {
        for (std::uint32_t i = 0; i < of_.joint_count; ++i)
            for (int lane = 0; lane < W; ++lane) {
                if (joint_at(i, lane) == nullptr) continue;
                S given[access::max_rows] = {}, sum[access::max_rows] = {};
                of_.joints[i].each_row([&](std::uint32_t r, int k) {
                    given[k] = rows_[r].impulse[lane];
                    sum[k] = rows_[r].total[lane];
                });
                kinds_[of_.joints[i].kind].store_impulses(joint_at(i, lane), h, given, sum);
            }
    }

private:
    using base::each_row;
    using base::find_corrections, base::take_corrections_back, base::settle;
    using base::joint_at, base::load, base::store, base::give, base::give_more, base::note_forces, base::write_rows,
        base::part_of_step, base::each_row_ahead;
    using base::of_, base::kinds_, base::rows_, base::state_, base::sides_, base::velocities_, base::matrix_;
    using base::own_lever_, base::are_forces_noted_, base::has_bounds_;
    using base::resolved_, base::far_;
    using base::solve_and_measure, base::moved_, base::is_curved_, base::ahead_, base::are_corrected_,
        base::is_taken_back_;

    /// Solves for the speeds of lanes with contacts.
    void solve_before_contacts(body* bodies, const joint_pass<S>& with) {
        const P touched = P::load(is_touched_);
        if (greater(touched, P::broadcast(S(0))).bits() == 0) return;
        note_forces();
        load(bodies);
        keep();
        settle(with, true, widened<K>(touched));
        undo_elsewhere(touched);
        store(bodies);
    }
    /// Keeps what there is before a solve.
    void keep() {
        for (std::uint32_t r = 0; r < of_.row_count; ++r) state_[r].start = P::load(rows_[r].impulse);
        for (std::uint32_t k = 0; k < of_.body_count; ++k) starts_[k] = velocities_[k];
    }
    /// In lanes that are not open all is again as it was kept.
    void undo_elsewhere(const P& open) {
        const P zero = P::broadcast(S(0));
        for (std::uint32_t k = 0; k < of_.body_count; ++k)
            for (int c = 0; c < lanes::size; ++c)
                velocities_[k].at[c] = select_greater(open, zero, velocities_[k].at[c], starts_[k].at[c]);
        for (std::uint32_t r = 0; r < of_.row_count; ++r)
            select_greater(open, zero, P::load(rows_[r].impulse), state_[r].start).store(rows_[r].impulse);
    }
    /// Rows are tangents to the ways of bodies, which the move leaves by what the square of the substep makes: solves
    /// once more for what holds where bodies will be. So half of what turns a motion is given before it and half after,
    /// and heavy bodies' errors do not act on the levers of light ones. Source: RATTLE (Andersen 1983); Hairer, Lubich,
    /// Wanner, Geometric Numerical Integration, VII.1.
    void look_ahead(const poses_of& poses, const joint_pass<S>& with) {
        each_row([&](std::uint32_t r, const joint_pattern::joint& j) {
            matrix_.row[r].right_hand = widened<K>(rows_[r].speed_of(velocities_[j.a], velocities_[j.b]));
        });
        S is_near[W] = {};
        for (int lane = 0; lane < W; ++lane)
            is_near[lane] = joint_at(0, lane) == nullptr || far_[lane] > S(0) ? S(0) : resolved_[lane];
        double largest[W] = {};
        look(poses, with, is_near, largest, true);
        // What that leaves is about the square of what was missed. Left there, it would add to the energy of what turns
        // for long, in float too.
        bool again = false;
        for (int lane = 0; lane < W; ++lane) {
            if (!(largest[lane] > rounding() * rounding())) is_near[lane] = S(0);
            largest[lane] = 0;
            again = again || is_near[lane] > S(0);
        }
        if (again) look(poses, with, is_near, largest, false);
    }
    /// Has rows of lanes that are near take back by how much they miss where bodies will be, if it is `first` besides
    /// what the speeds that are their right-hand sides ask for. Lanes that turn too far are near no longer: there the
    /// square is not all of it, and what is far off is drawn together first; nor are those whose ways are so curved
    /// that a quarter of it would still be missed. Gives the largest of the squares of misses.
    void look(const poses_of& poses, const joint_pass<S>& with, S (&is_near)[W], double (&largest)[W], bool first) {
        const P none = P::broadcast(S(0));
        for (std::uint32_t r = 0; r < of_.row_count; ++r)
            asked_[r] = first ? matrix_.row[r].right_hand : K::broadcast(C(0));
        double before[W] = {}, after[W] = {}, ignored[W] = {};
        find_misses(poses, with, none, is_near, largest, before);
        for (S& is : is_curved_) is = S(0);
        const P part = part_of_step(with, largest, 1);
        for (std::uint32_t r = 0; r < of_.row_count; ++r)
            state_[r].correction = narrowed<P>(matrix_.row[r].right_hand) * part;
        const P curved = P::load(is_curved_) * P::load(is_near);
        if (greater(curved, none).bits() != 0) {
            S tried[W];
            curved.store(tried);
            find_misses(poses, with, part, tried, ignored, after);
            for (int lane = 0; lane < W; ++lane)
                if (curved.lane(lane) > S(0) && !(tried[lane] > S(0) && after[lane] <= before[lane] / 16))
                    is_near[lane] = S(0);
        }
        if (has_bounds_) leave_cut_lanes(is_near);
        const P near = P::load(is_near);
        give_more([&](std::uint32_t r) { return state_[r].correction * near; });
    }
    /// Lanes where a row would be cut off are near no longer: what the others give answers to all of it.
    void leave_cut_lanes(S (&is_near)[W]) const {
        for (std::uint32_t r = 0, n; r < of_.row_count; r += n) {
            n = state_[r].together > 1 ? state_[r].together : 1;
            if (!rows_[r].is_bounded) continue;
            for (int lane = 0; lane < W; ++lane) {
                const auto next = [&](std::uint32_t k) {
                    return rows_[k].impulse[lane] + state_[k].correction.lane(lane);
                };
                double square = 0;
                for (std::uint32_t k = r; k < r + n; ++k) square += to_double(next(k)) * to_double(next(k));
                const double high = to_double(rows_[r].high[lane]);
                const bool is_cut =
                    n > 1 ? square > high * high : next(r) > rows_[r].high[lane] || next(r) < rows_[r].low[lane];
                if (is_cut) is_near[lane] = S(0);
            }
        }
    }
    /// What lanes that are near miss where bodies will be with that part of what they are moved by more; and solves for
    /// it.
    void find_misses(const poses_of& poses, const joint_pass<S>& with, const P& part, S (&is_near)[W],
                     double (&largest)[W], double (&size)[W]) {
        for (int lane = 0; lane < W; ++lane) {
            if (joint_at(0, lane) == nullptr) continue;
            for (std::uint32_t k = 0; k < of_.body_count; ++k) {
                lanes at = velocities_[k];
                if (part.lane(lane) > S(0) && sides_[k].is_pushed)
                    for (int c = 0; c < lanes::size; ++c) at.at[c] = at.at[c] + moved_[k].at[c] * part;
                const auto v = at.of(lane);
                ahead_[k] = poses.of(sides_[k].index[lane], &v, with.h);
            }
            each_row_ahead(lane, [&](std::uint32_t r, std::uint32_t i, const auto& at, const auto& direction,
                                     const vec<S, D>& between) {
                const double apart = own_lever_[i * W + static_cast<std::uint32_t>(lane)] + length_squared_of(between);
                const bool holds = !rows_[r].is_bounded && !rows_[r].has_spring;
                const double moved = to_double(at.error) - to_double(rows_[r].error[lane]),
                             asked = static_cast<double>(asked_[r].lane(lane)) * to_double(with.h),
                             misses = holds ? moved - asked : 0;
                const double miss = part_of(misses, at, direction, apart);
                largest[lane] = max(largest[lane], miss);
                if (miss > 0.0025) is_near[lane] = S(0);
                // Rows that all but say the same would make much of what is rounding.
                const double speed = miss > rounding() * rounding() ? -misses * to_double(with.inverse_h) : 0;
                matrix_.row[r].right_hand.set_lane(lane, static_cast<C>(speed));
            });
        }
        const K near = lanes_from<K>(is_near);
        for (std::uint32_t r = 0; r < of_.row_count; ++r) matrix_.row[r].right_hand *= near;
        solve_and_measure(size);
    }

    /// A part of what joints measure that is rounding.
    static double rounding() { return 16 * to_double(scalar_traits<S>::epsilon()); }

    /// 1 in lanes with contacts.
    S is_touched_[W] = {};
    /// Velocities before a solve.
    lanes* starts_;
    /// What speeds asked for before a look ahead.
    K* asked_;
};

}  // namespace detail

PHYSICS_HPP_END
