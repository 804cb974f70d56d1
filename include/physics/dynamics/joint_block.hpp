// Joints of a kind in lanes, solved one row after the other.
#pragma once

#include "physics/dynamics/point_lanes.hpp"
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
    using row_type = row;

    /// `on`: the rows that are on in any lane, by their bits; `rows` has the place for so many.
    joint_block(std::uint32_t on, row* rows) : rows_(rows) {
        for (int k = 0; k < Joint::row_count; ++k) {
            if ((on >> k & 1) == 0) continue;
            new (rows + count_) row();
            kind_row_[count_++] = static_cast<std::uint8_t>(k);
        }
        if constexpr (can_hold_points) holds_points_ = on == point_rows_of<Joint>();
    }
    /// Writes a joint into a lane, and what it gives in the first substep.
    void put(int lane, step_joint<Joint, S, D>& joint, const body_pair& ends, const body* bodies, S h) {
        joints_[lane] = &joint;
        a_.put(lane, ends.a, bodies);
        b_.put(lane, ends.b, bodies);
        if constexpr (can_hold_points) points_.put(lane, joint.start, joint.joint->points());
        each_row([&](row& r, int k) { r.impulse[lane] = first_impulse(joint, k, h); });
    }
    void put_nothing(int lane, std::uint32_t dummy_body) { a_.index[lane] = b_.index[lane] = dummy_body; }
    /// Which sides are pushed, which is the same for all lanes.
    void note_sides(const body* bodies) {
        a_.is_pushed = bodies[a_.index[0]].inverse_mass > inverse_of<S>(0);
        b_.is_pushed = bodies[b_.index[0]].inverse_mass > inverse_of<S>(0);
    }

    /// Writes the rows where bodies are now, and gives these what the last substep gave.
    void warm_start(body* bodies, const pose* poses, const joint_pass<S>& with) {
        if constexpr (can_hold_points)
            if (holds_points_) points_.begin(rows_, with);
        write_rows(poses, with);
        lanes of_a, of_b;
        load(bodies, of_a, of_b);
        each_row([&](const row& r, int) { r.apply(P::load(r.impulse), a_, b_, of_a, of_b); });
        store(bodies, of_a, of_b);
    }
    /// Writes the rows anew after bodies have moved. Of what the substep gave, the next one is to begin with the same
    /// impulses along the new rows: starts (v - what it begins with) change by the difference.
    void update_rows(body* bodies, const pose* poses, const joint_pass<S>& with, twist_of<S, D, Rotates>* starts) {
        if (is_corrected_) {
            lanes of_a, of_b;
            load(bodies, of_a, of_b);
            each_row([&](row& r, int) { r.take_correction_back(a_, b_, of_a, of_b); });
            store(bodies, of_a, of_b);
            is_corrected_ = false;
        }
        if (starts == nullptr) return write_rows(poses, with);
        lanes of_a{}, of_b{};
        each_row([&](const row& r, int) { r.apply(P::load(r.impulse), a_, b_, of_a, of_b); });
        write_rows(poses, with);
        each_row([&](const row& r, int) { r.apply(-P::load(r.impulse), a_, b_, of_a, of_b); });
        if (a_.is_pushed) of_a.add_to(starts, a_.index);
        if (b_.is_pushed) of_b.add_to(starts, b_.index);
    }
    /// Row by row, from the first to the last, or back.
    void solve(body* bodies, const joint_pass<S>& with, joint_round round, bool back) {
        lanes of_a, of_b;
        load(bodies, of_a, of_b);
        if constexpr (shared == 0) {
            for (int i = 0; i < count_; ++i) rows_[back ? count_ - 1 - i : i].solve(with, round, a_, b_, of_a, of_b);
        } else {
            for (int i = 0, n; i < count_; i += n) {
                int first = back ? count_ - 1 - i : i;
                while ((n = rows_together(shared, kind_row_[first])) == 0) --first;
                if (n > 1) solve_together(first, n, with, round, of_a, of_b);
                else rows_[first].solve(with, round, a_, b_, of_a, of_b);
            }
        }
        is_corrected_ = is_corrected_ || round == joint_round::corrections;
        if (round == joint_round::relaxing) each_row([](row& r, int) { r.add_up(); });
        store(bodies, of_a, of_b);
    }
    void store_impulses(const pose* poses, S h) const {
        for (int lane = 0; lane < W; ++lane) {
            if (joints_[lane] == nullptr) continue;
            if constexpr (can_hold_points && angles_of<Joint>() > 0)
                if (holds_points_) count_turns_since(*joints_[lane], poses[a_.index[lane]], poses[b_.index[lane]]);
            fixed_list<S, Joint::row_count> given, sum;
            each_row([&](const row& r, int k) {
                given[k] = r.impulse[lane];
                sum[k] = r.total[lane];
            });
            detail::store_impulses(
                *joints_[lane], h, [&](int k) { return given[k]; }, [&](int k) { return sum[k]; });
        }
    }

private:
    static constexpr std::uint32_t shared = shared_bounds_of<Joint>();
    static constexpr bool can_hold_points = point_rows_of<Joint>() != 0;

    /// f(row, its number among those of the kind).
    template <class F>
    void each_row(F&& f) const {
        for (int i = 0; i < count_; ++i) f(rows_[i], kind_row_[i]);
    }

    void solve_together(int k, int n, const joint_pass<S>& with, joint_round round, lanes& of_a, lanes& of_b) {
        P wanted[3];
        for (int i = 0; i < n; ++i) {
            rows_[k + i].template solve<false>(with, round, a_, b_, of_a, of_b);
            wanted[i] = P::load(rows_[k + i].impulse);
        }
        cut_together<W>(&rows_[k], n, wanted);
        for (int i = 0; i < n; ++i) {
            const P by = wanted[i] - P::load(rows_[k + i].impulse);
            rows_[k + i].apply(by, a_, b_, of_a, of_b);
            wanted[i].store(rows_[k + i].impulse);
            if (has_errors(round)) rows_[k + i].note_correction(by);
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
    void write_rows(const pose* poses, const joint_pass<S>& with) {
        if (!write_points(poses)) {
            each_row([](row& r, int) { r.clear(); });
            for (int lane = 0; lane < W; ++lane)
                if (joints_[lane] != nullptr) write_lane(lane, poses, with);
        }
        each_row([&](row& r, int) { r.finish(a_, b_, with); });
    }
    bool write_points([[maybe_unused]] const pose* poses) {
        if constexpr (can_hold_points) return holds_points_ && points_.write(rows_, a_, b_, poses);
        else return false;
    }
    PHYSICS_HPP_NOINLINE void write_lane(int lane, const pose* poses, const joint_pass<S>& with) {
        row_list<S, D, Joint::row_count, has_two_directions<Joint>()> rows;
        const auto to = rows.target();
        detail::write_rows(*joints_[lane], false, poses[a_.index[lane]], poses[b_.index[lane]], to);
        each_row([&](row& r, int k) { r.put(lane, to.row[k], to.direction_a(k), with); });
    }

    step_joint<Joint, S, D>* joints_[W] = {};
    bool is_corrected_ = false;
    pushed_lanes<S, D, Rotates, W> a_, b_;
    [[no_unique_address]] std::conditional_t<can_hold_points, point_lanes<S, D, Rotates, W>, no_points> points_;
    bool holds_points_ = false;
    row* rows_;
    int count_ = 0;
    fixed_list<std::uint8_t, Joint::row_count> kind_row_{};
};

}  // namespace detail

PHYSICS_HPP_END
