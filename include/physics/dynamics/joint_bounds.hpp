// How joints that are solved at once meet the bounds of their rows.
#pragma once

#include "physics/dynamics/joint_corrections.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Solves for speeds with bounds: the least of the energy E = 1/2 x^T A x - b^T x where A = J M^-1 J^T, x is what rows
/// give and b what they ask for. Rows with bounds are in the solve, or out of it and at a bound. Those that end up
/// beyond their bounds go out until none does. Then those that would leave theirs come in: all; if that does not lessen
/// E, only those that would gain most of it; at last the one that gains most. So E falls, and it ends. Source: Judice,
/// Pires, A block pivoting algorithm (1994); Stark, Parker, Bounded-variable least-squares (1995).
template <class S, int D, bool Rotates, int W, bool Two>
class joint_bounds : protected joint_corrections<S, D, Rotates, W, Two> {
    using base = joint_corrections<S, D, Rotates, W, Two>;

protected:
    using base::give_more, base::limited, base::share_of;
    using base::of_, base::rows_, base::state_, base::velocities_, base::matrix_, base::is_factorised_,
        base::has_bounds_, base::any_shared_;
    using typename base::P, typename base::K, typename base::C, typename base::body;
    using typename base::row, typename base::access, typename base::pose;

    /// See joint_system.
    template <class JointAt, class BodiesOf>
    joint_bounds(const joint_pattern& pattern, int used, const access* kinds, JointAt&& joint, BodiesOf&& bodies,
                 const body* all, std::uint32_t dummy_body, S h, arena& scratch)
        : base(pattern, used, kinds, joint, bodies, all, dummy_body, h, scratch) {
        x_ = made<K>(of_.row_count, scratch);
        b_ = made<K>(of_.row_count, scratch);
        ax_ = made<K>(of_.row_count, scratch);
        left_ = made<K>(of_.row_count, scratch);
        moves_ = made<K>(of_.row_count, scratch);
        gain_ = made<K>(of_.row_count, scratch);
        scale_ = made<K>(1, scratch);
        best_ = made<kept>(of_.row_count, scratch);
        can_ = made<K>(of_.row_count, scratch);
    }

    /// Solves for speeds in lanes that are open (1, else 0); what is off is left to find_corrections.
    void settle(const joint_pass<S>& with, bool use_bias, const K& open) {
        const K zero = K::broadcast(C(0)), one = K::broadcast(C(1)), unknown = K::broadcast(C(1e300));
        start(with, use_bias);
        // Lanes that have not ended; of each the lowest E, and how much less the next one is to be. And how strict they
        // are about what comes in: 0 all, 1 what gains a quarter of the most, 2 what gains most.
        K goes_on = open, best = unknown, hoped = zero, strict = zero;
        for (int round = 0;; ++round) {
            if (!is_factorised_) matrix_.factorise(false);
            is_factorised_ = true;
            solve_rows_in();
            if (!has_bounds_) break;
            const found now = find_violations();
            const K is_feasible = (one - now.is_beyond) * goes_on;
            const K is_better = is_feasible * select_greater(best, now.energy, one, zero);
            const K is_fast = is_better * select_greater(best - now.energy, hoped, one, zero);
            best = select_greater(is_better, zero, now.energy, best);
            strict = strict + (is_feasible - is_fast);
            const K gain = keep_best(is_better, is_feasible, *scale_ * K::broadcast(C(negligible)));
            hoped = gain * K::broadcast(C(0.25));
            const K turns = is_better * now.turned;
            goes_on = goes_on * (one - is_feasible * select_greater(gain + turns, zero, zero, one));
            goes_on = select_greater(strict, K::broadcast(C(2.5)), zero, goes_on);
            if (round + 1 == max_rounds) {
                keep_best(zero, goes_on * select_greater(unknown, best, one, zero), zero);
                goes_on = zero;
            }
            if (greater(goes_on, zero).bits() == 0) break;
            const K part = select_greater(strict, K::broadcast(C(1.5)), one,
                                          select_greater(strict, K::broadcast(C(0.5)), K::broadcast(C(0.25)), zero));
            change_sides(goes_on, is_feasible * goes_on, turns * goes_on, gain * part);
        }
        if (!is_factorised_) matrix_.factorise(false);
        is_factorised_ = true;
        give_more([&](std::uint32_t r) { return narrowed<P>(x_[r] * open); });
    }

private:
    struct found {
        /// E; whether a row is beyond a bound (1); and whether what shares one would turn (1).
        K energy, is_beyond, turned;
    };

    /// What a row's speed is to become 0 with; see find_corrections.
    K wanted(const row& r, const joint_pass<S>& with, bool use_bias) const {
        const K zero = K::broadcast(C(0));
        if (!r.has_spring && !r.is_one_sided) return zero;
        K bias = zero;
        if (use_bias) {
            // Of springs with the share m of the speed: m J v + p C + (1 - m) / m_eff lambda = 0.
            bias = limited(lanes_from<K>(r.error) * lanes_from<K>(r.push), r) / share_of(r);
        }
        if (r.is_one_sided) {
            const K free = widened<K>(r.room()) * K::broadcast(static_cast<C>(to_double(with.inverse_h)));
            bias = select_greater(lanes_from<K>(r.one_sided), zero, limited(free, r), bias);
        }
        return bias;
    }
    /// What rows ask for, and which are in at first: those inside of their bounds, or that would leave them.
    void start(const joint_pass<S>& with, bool use_bias) {
        const K zero = K::broadcast(C(0)), one = K::broadcast(C(1));
        *scale_ = zero;
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_pattern::joint& j = of_.joints[i];
            for (std::uint32_t k = j.first_row; k < j.first_row + j.row_count; ++k) {
                row& r = rows_[k];
                auto& w = matrix_.row[k];
                const K before = lanes_from<K>(r.impulse), low = lanes_from<K>(r.low), high = lanes_from<K>(r.high);
                const K v = widened<K>(r.speed_of(velocities_[j.a], velocities_[j.b])) - lanes_from<K>(r.speed);
                K soft = zero, in = select_greater(high, low, one, zero);
                if (r.has_spring) {
                    const K is_spring = lanes_from<K>(r.spring);
                    soft = use_bias ? lane_quotient(lanes_from<K>(r.loss), share_of(r) * lanes_from<K>(r.mass)) : zero;
                    soft = select_greater(is_spring, zero, soft, zero);
                    if (!use_bias) in = select_greater(is_spring, zero, zero, in);
                }
                x_[k] = zero;
                b_[k] = -(v + wanted(r, with, use_bias));
                if (!r.has_spring) *scale_ = max(*scale_, v * v * lanes_from<K>(r.mass));
                can_[k] = in;
                if (r.is_bounded && state_[k].together == 1) {
                    const K out = b_[k] - soft * before, up = select_greater(out, zero, one, zero);
                    const K down = select_greater(zero, out, one, zero);
                    in = in * select_greater(before, low, select_greater(high, before, one, down), up);
                }
                put(w.softness, soft);
                if (state_[k].together == 1) put(w.in, in);
            }
            for (std::uint32_t r = j.first_row, n; any_shared_ && r < j.first_row + j.row_count; r += n) {
                n = state_[r].together;
                if (n > 1) start_together(r, n);
            }
        }
    }
    void start_together(std::uint32_t r, std::uint32_t n) {
        K in = can_[r];
        for (int lane = 0; lane < W; ++lane) {
            double square = 0, outwards = 0;
            for (std::uint32_t k = r; k < r + n; ++k) {
                const double before = to_double(rows_[k].impulse[lane]);
                square += before * before;
                outwards += before * (static_cast<double>(b_[k].lane(lane)) -
                                      static_cast<double>(matrix_.row[k].softness.lane(lane)) * before);
            }
            const double bound = to_double(rows_[r].high[lane]);
            if (sqrt(square) >= bound * (1 - 0x1p-12) && outwards >= 0) in.set_lane(lane, C(0));
        }
        for (std::uint32_t k = r; k < r + n; ++k) put(matrix_.row[k].in, in);
    }
    /// Those that are out stay where they are.
    void solve_rows_in() {
        const K zero = K::broadcast(C(0));
        if (has_bounds_) {
            for (std::uint32_t r = 0; r < of_.row_count; ++r)
                x_[r] = select_greater(matrix_.row[r].in, zero, zero, x_[r]);
            matrix_.multiply(x_, ax_);
        }
        for (std::uint32_t r = 0; r < of_.row_count; ++r) {
            auto& w = matrix_.row[r];
            w.right_hand = b_[r] - (w.softness + w.leak) * lanes_from<K>(rows_[r].impulse);
            if (has_bounds_) w.right_hand = w.right_hand - ax_[r];
        }
        matrix_.substitute();
        for (std::uint32_t r = 0; r < of_.row_count; ++r) {
            const auto& w = matrix_.row[r];
            x_[r] = select_greater(w.in, zero, w.right_hand, x_[r]);
        }
    }
    /// Which rows are beyond a bound (moves_), and what those at one that they would leave would gain (gain_).
    found find_violations() {
        const K zero = K::broadcast(C(0)), one = K::broadcast(C(1)), half = K::broadcast(C(0.5));
        found all{zero, zero, zero};
        matrix_.multiply(x_, ax_);
        const K rounding = *scale_ * K::broadcast(C(0x1p-40));
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_pattern::joint& j = of_.joints[i];
            for (std::uint32_t r = j.first_row; r < j.first_row + j.row_count; ++r) {
                const auto& w = matrix_.row[r];
                const K own = matrix_.diagonal(j, r), soft = (w.slack * own + w.softness) * x_[r];
                const K asks = b_[r] - w.softness * lanes_from<K>(rows_[r].impulse);
                all.energy = all.energy + x_[r] * (half * (ax_[r] + soft) - asks);
                left_[r] = asks - ax_[r] - soft;
                moves_[r] = gain_[r] = zero;
                if (!rows_[r].is_bounded || state_[r].together != 1) continue;
                const K low = lanes_from<K>(rows_[r].low), high = lanes_from<K>(rows_[r].high);
                const K total = lanes_from<K>(rows_[r].impulse) + x_[r];
                const K beyond = max(total - high, low - total) * w.in;
                moves_[r] = select_greater(beyond * lane_abs(beyond) * own, rounding, one, zero);
                all.is_beyond = max(all.is_beyond, moves_[r]);
                // At its upper bound a row may ask for more, at its lower one for less.
                const K inwards = select_greater(total + total, low + high, -left_[r], left_[r]);
                const K gain = lane_quotient(inwards * lane_abs(inwards), own) * can_[r] * (one - w.in);
                gain_[r] = select_greater(gain, rounding, gain, zero);
            }
            for (std::uint32_t r = j.first_row, n; any_shared_ && r < j.first_row + j.row_count; r += n) {
                n = state_[r].together > 1 ? state_[r].together : 1;
                if (n > 1) find_together(j, r, n, rounding, all);
            }
        }
        return all;
    }
    /// Of n rows that share a bound in a lane: what they give, and with rows that are out what they ask for.
    struct shared_rows {
        double total[3], length, bound, outwards, own;
    };
    shared_rows look_at(const joint_pattern::joint& j, std::uint32_t r, std::uint32_t n, int lane) const {
        shared_rows all{{}, 0, to_double(rows_[r].high[lane]), 0, 0};
        for (std::uint32_t k = 0; k < n; ++k) {
            all.total[k] = to_double(rows_[r + k].impulse[lane]) + static_cast<double>(x_[r + k].lane(lane));
            all.length += all.total[k] * all.total[k];
            all.outwards += all.total[k] * static_cast<double>(left_[r + k].lane(lane));
            all.own = max(all.own, static_cast<double>(matrix_.diagonal(j, r + k).lane(lane)));
        }
        all.length = sqrt(all.length);
        return all;
    }
    void find_together(const joint_pattern::joint& j, std::uint32_t r, std::uint32_t n, const K& rounding, found& all) {
        for (int lane = 0; lane < W; ++lane) {
            if (!(can_[r].lane(lane) > C(0))) continue;
            const shared_rows now = look_at(j, r, n, lane);
            const double small = static_cast<double>(rounding.lane(lane)), beyond = now.length - now.bound;
            if (matrix_.row[r].in.lane(lane) > C(0)) {
                if (!(beyond > 0) || !(beyond * beyond * now.own > small)) continue;
                moves_[r].set_lane(lane, C(1));
                all.is_beyond.set_lane(lane, C(1));
            } else if (now.outwards < 0) {
                const double gain = now.outwards / now.bound * (now.outwards / now.bound) / now.own;
                if (gain > small) gain_[r].set_lane(lane, static_cast<C>(gain));
            } else {
                double next[3];
                if (turn(r, n, lane, now, next)) all.turned.set_lane(lane, C(1));
            }
        }
    }
    /// Where rows that share a bound, and would not leave it, turn there towards what they ask for, since what they act
    /// on moves on; false if that is where they are.
    bool turn(std::uint32_t r, std::uint32_t n, int lane, const shared_rows& now, double (&next)[3]) const {
        // By the least of their masses, so that they turn too far in no direction.
        double mass = to_double(rows_[r].mass[lane]), sum = 0, farthest = 0;
        for (std::uint32_t k = 1; k < n; ++k) mass = min(mass, to_double(rows_[r + k].mass[lane]));
        mass /= 1 + mass * static_cast<double>(matrix_.row[r].softness.lane(lane));
        for (std::uint32_t k = 0; k < n; ++k) {
            next[k] = now.total[k] + mass * static_cast<double>(left_[r + k].lane(lane));
            sum += next[k] * next[k];
        }
        if (!(sum > 0)) return false;
        for (std::uint32_t k = 0; k < n; ++k) {
            next[k] *= now.bound / sqrt(sum);
            farthest = max(farthest, abs(next[k] - now.total[k]));
        }
        return farthest >= now.bound * 0x1p-12;
    }
    /// Keeps lanes that are better than any before as the best of them, and has others that are feasible go back to
    /// that. The largest gain there that is not small.
    K keep_best(const K& is_better, const K& is_feasible, const K& small) {
        const K zero = K::broadcast(C(0));
        K gain = zero;
        for (std::uint32_t r = 0; r < of_.row_count; ++r) {
            auto& w = matrix_.row[r];
            kept& of = best_[r];
            of.in = select_greater(is_better, zero, w.in, of.in);
            of.x = select_greater(is_better, zero, x_[r], of.x);
            of.gain = select_greater(is_better, zero, gain_[r], of.gain);
            const K goes_back = is_feasible - is_better;
            put(w.in, select_greater(goes_back, zero, of.in, w.in));
            x_[r] = select_greater(goes_back, zero, of.x, x_[r]);
            gain_[r] = select_greater(is_feasible, zero, of.gain, zero);
            gain = max(gain, select_greater(gain_[r], small, gain_[r], zero));
        }
        return gain;
    }
    /// In lanes that go on: rows that are beyond their bounds leave; in those where none is, rows come in that gain at
    /// least as much, and what shares a bound turns.
    void change_sides(const K& goes_on, const K& may_come_in, const K& may_turn, const K& min_gain) {
        const K zero = K::broadcast(C(0)), one = K::broadcast(C(1));
        for (std::uint32_t i = 0; i < of_.joint_count; ++i) {
            const joint_pattern::joint& j = of_.joints[i];
            for (std::uint32_t r = j.first_row, n; r < j.first_row + j.row_count; r += n) {
                n = state_[r].together > 1 ? state_[r].together : 1;
                if (!rows_[r].is_bounded) continue;
                auto& w = matrix_.row[r];
                const K leaves = moves_[r] * goes_on * (one - may_come_in);
                const K gains = select_greater(min_gain, gain_[r], zero, select_greater(gain_[r], zero, one, zero));
                const K in = select_greater(leaves, zero, zero, select_greater(gains * may_come_in, zero, one, w.in));
                if (n > 1) {
                    for (int lane = 0; lane < W; ++lane) {
                        const bool is_cut = leaves.lane(lane) > C(0), is_out = !(in.lane(lane) > C(0));
                        if (is_cut || (may_turn.lane(lane) > C(0) && is_out && can_[r].lane(lane) > C(0)))
                            move_to_bound(j, r, n, lane, is_cut);
                    }
                } else {
                    const K before = lanes_from<K>(rows_[r].impulse), high = lanes_from<K>(rows_[r].high);
                    const K bound = max(min(before + x_[r], high), lanes_from<K>(rows_[r].low));
                    x_[r] = select_greater(leaves, zero, bound - before, x_[r]);
                }
                for (std::uint32_t k = r; k < r + n; ++k) put(matrix_.row[k].in, in);
            }
        }
    }
    void move_to_bound(const joint_pattern::joint& j, std::uint32_t r, std::uint32_t n, int lane, bool is_cut) {
        const shared_rows now = look_at(j, r, n, lane);
        double next[3];
        if (!is_cut && (now.outwards < 0 || !turn(r, n, lane, now, next))) return;
        for (std::uint32_t k = 0; k < n; ++k) {
            if (is_cut) next[k] = now.total[k] * (now.bound / now.length);
            x_[r + k].set_lane(lane, static_cast<C>(next[k] - to_double(rows_[r + k].impulse[lane])));
        }
    }
    /// Notes whether the matrix is another than that of which there are factors.
    void put(K& to, const K& next) {
        if (greater(lane_abs(next - to), K::broadcast(C(0))).bits() != 0) is_factorised_ = false;
        to = next;
    }

    static constexpr int max_rounds = 64;
    /// The part of scale_ that is not worth a round: rows that would gain so little come in later, in the next solve.
    static constexpr double negligible = 0x1p-13;

    /// Of a row where E was lowest.
    struct kept {
        K in, x, gain;
    };
    kept* best_;
    /// Of each row: x, b, A x and b - A x; whether it leaves (1), what it gains by coming in, and whether it can (1).
    K *x_, *b_, *ax_, *left_, *moves_, *gain_, *can_;
    /// The largest energy of a row's speed before a solve: a small part of it is rounding.
    K* scale_;
};

}  // namespace detail

PHYSICS_HPP_END
