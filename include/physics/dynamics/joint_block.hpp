// Joints of a kind in lanes, solved one row after the other.
#pragma once

#include "physics/dynamics/shared_bounds.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// W joints of a kind that push different bodies. Rows are solved one after the other (projected Gauss-Seidel), each as
/// a damped spring in passes with bias. Source: Catto, Soft constraints (GDC 2011).
template <class Joint, class S, int D, bool Rotates, int W>
class joint_block {
    using P = kernel_pack<S, W>;
    using body = solver_body<S, D, Rotates>;
    using lanes = twist_lanes<P, D, Rotates>;
    using row = row_lanes<S, D, Rotates, W, has_two_directions<Joint>()>;
    using pose = joint_pose<S, D, Rotates>;

public:
    /// Writes a joint into a lane, and what it gives in the first substep.
    void put(int lane, step_joint<Joint, S, D>& joint, const body_pair& ends, const body* bodies, S h) {
        joints_[lane] = &joint;
        a_.put(lane, ends.a, bodies);
        b_.put(lane, ends.b, bodies);
        for (int k = 0; k < Joint::row_count; ++k) rows_[k].impulse[lane] = first_impulse(joint, k, h);
    }
    void put_nothing(int lane, std::uint32_t dummy_body) { a_.index[lane] = b_.index[lane] = dummy_body; }
    /// Which sides are pushed, which is the same for all lanes.
    void note_sides(const body* bodies) {
        a_.is_pushed = bodies[a_.index[0]].inverse_mass > inverse_of<S>(0);
        b_.is_pushed = bodies[b_.index[0]].inverse_mass > inverse_of<S>(0);
    }

    /// Writes the rows where bodies are now, and gives these what the last substep gave.
    void warm_start(body* bodies, const pose* poses, const joint_pass<S>& with) {
        write_rows(bodies, poses, with);
        lanes of_a, of_b;
        load(bodies, of_a, of_b);
        for (const row& r : rows_)
            if (r.is_on) r.apply(P::load(r.impulse), a_, b_, of_a, of_b);
        store(bodies, of_a, of_b);
    }
    /// Writes the rows anew after bodies have moved. Of what the substep gave, the next one is to begin with the same
    /// impulses along the new rows: starts (v - what it begins with) change by the difference.
    void update_rows(body* bodies, const pose* poses, const joint_pass<S>& with, twist_of<S, D, Rotates>* starts) {
        if (starts == nullptr) return write_rows(bodies, poses, with);
        lanes of_a{}, of_b{};
        for (const row& r : rows_)
            if (r.is_on) r.apply(P::load(r.impulse), a_, b_, of_a, of_b);
        write_rows(bodies, poses, with);
        for (const row& r : rows_)
            if (r.is_on) r.apply(-P::load(r.impulse), a_, b_, of_a, of_b);
        if (a_.is_pushed) of_a.add_to(starts, a_.index);
        if (b_.is_pushed) of_b.add_to(starts, b_.index);
    }
    void solve(body* bodies, const joint_pass<S>& with, bool use_bias) {
        lanes of_a, of_b;
        load(bodies, of_a, of_b);
        if constexpr (shared == 0) {
            for (row& r : rows_)
                if (r.is_on) r.solve(with, use_bias, a_, b_, of_a, of_b);
        } else {
            for (int k = 0, n; k < Joint::row_count; k += n) {
                n = rows_together(shared, k);
                if (!rows_[k].is_on) continue;
                if (n > 1) solve_together(k, n, with, use_bias, of_a, of_b);
                else rows_[k].solve(with, use_bias, a_, b_, of_a, of_b);
            }
        }
        if (!use_bias)
            for (row& r : rows_)
                if (r.is_on) r.add_up();
        store(bodies, of_a, of_b);
    }
    void store_impulses(S h) const {
        for (int lane = 0; lane < W; ++lane)
            if (joints_[lane] != nullptr)
                detail::store_impulses(
                    *joints_[lane], h, [&](int k) { return rows_[k].impulse[lane]; },
                    [&](int k) { return rows_[k].total[lane]; });
    }

private:
    static constexpr std::uint32_t shared = shared_bounds_of<Joint>();

    void solve_together(int k, int n, const joint_pass<S>& with, bool use_bias, lanes& of_a, lanes& of_b) {
        P wanted[3];
        S is_cut[W];
        for (int i = 0; i < n; ++i) {
            rows_[k + i].template solve<false>(with, use_bias, a_, b_, of_a, of_b);
            wanted[i] = P::load(rows_[k + i].impulse);
        }
        cut_together(&rows_[k], n, wanted, is_cut);
        for (int i = 0; i < n; ++i) {
            rows_[k + i].apply(wanted[i] - P::load(rows_[k + i].impulse), a_, b_, of_a, of_b);
            wanted[i].store(rows_[k + i].impulse);
        }
    }
    void load(const body* bodies, lanes& of_a, lanes& of_b) const {
        of_a.load(bodies, a_.index);
        of_b.load(bodies, b_.index);
    }
    void store(body* bodies, const lanes& of_a, const lanes& of_b) const {
        if (a_.is_pushed) of_a.store(bodies, a_.index);
        if (b_.is_pushed) of_b.store(bodies, b_.index);
    }
    void write_rows(const body* bodies, const pose* poses, const joint_pass<S>& with) {
        for (row& r : rows_) r.clear();
        for (int lane = 0; lane < W; ++lane)
            if (joints_[lane] != nullptr) write_rows(lane, bodies, poses, with);
    }
    PHYSICS_HPP_NOINLINE void write_rows(int lane, const body* bodies, const pose* poses, const joint_pass<S>& with) {
        const std::uint32_t a = a_.index[lane], b = b_.index[lane];
        row_list<S, D, Joint::row_count, has_two_directions<Joint>()> rows;
        const auto to = rows.target();
        detail::write_rows(*joints_[lane], false, poses[a], poses[b], to);
        for (int k = 0; k < Joint::row_count; ++k)
            rows_[k].write(lane, to.row[k], to.direction_a(k), bodies[a], bodies[b], with);
    }

    step_joint<Joint, S, D>* joints_[W] = {};
    pushed_lanes<S, D, Rotates, W> a_, b_;
    fixed_list<row, Joint::row_count> rows_{};
};

}  // namespace detail

PHYSICS_HPP_END
