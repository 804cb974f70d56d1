// Joints of a kind in lanes: their rows, whatever the kind is.
#pragma once

#include "physics/base/pack_rows.hpp"
#include "physics/dynamics/constraints.hpp"
#include "physics/dynamics/contact_pass.hpp"
#include "physics/dynamics/friction.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// What joints are solved with.
template <class S>
struct joint_pass {
    /// Length of a substep (s), and its inverse.
    S h, inverse_h;
    /// Of rows that are as stiff as can be.
    softness<S> rigid;
};

/// Velocities of W bodies, component by component.
template <class P, int D, bool Rotates>
struct twist_lanes {
    using S = typename P::scalar;
    using body = solver_body<S, D, Rotates>;
    static constexpr int angular_size = !Rotates ? 0 : D == 2 ? 1 : 3, size = D + angular_size;
    static constexpr int stride = sizeof(body) / sizeof(S);

    /// Behind the velocity is what follows in a row: so much of the displacement as fills it.
    P at[(size + 3) / 4 * 4];

    void load(const body* bodies, const std::uint32_t* index) {
        const auto* first = reinterpret_cast<const S*>(bodies);
        for (int i = 0; i < size; i += 4) {
            const quad<P> four = load4<P>(indexed_rows<const S, stride>{first + i, index});
            at[i] = four.x, at[i + 1] = four.y, at[i + 2] = four.z, at[i + 3] = four.w;
        }
    }
    void store(body* bodies, const std::uint32_t* index) const {
        auto* first = reinterpret_cast<S*>(bodies);
        for (int i = 0; i < size; i += 4)
            store4(indexed_rows<S, stride>{first + i, index}, quad<P>{at[i], at[i + 1], at[i + 2], at[i + 3]});
    }
};

/// The change of angular velocity by an angular impulse of 1 about an axis, about the same axis.
template <class S>
constexpr inverse_of<S> torque_k(inverse_of<S> inverse_inertia, S axis, S) {
    using I = inverse_of<S>;
    return mul<I>(mul<I>(inverse_inertia, axis), axis);
}

/// W joints of a kind that push different bodies. Rows are solved one after the other (projected Gauss-Seidel), each as
/// a damped spring in passes with bias. Source: Catto, Soft constraints (GDC 2011).
template <class Joint, class S, int D, bool Rotates, int W>
class joint_block {
    using I = inverse_of<S>;
    using P = kernel_pack<S, W>;
    using Q = kernel_pack<I, W>;
    using body = solver_body<S, D, Rotates>;
    using lanes = twist_lanes<P, D, Rotates>;
    static constexpr int row_count = Joint::row_count, A = lanes::angular_size, array = A > 0 ? A : 1;

public:
    /// Writes a joint into a lane, and what it gives in the first substep.
    void put(int lane, step_joint<Joint, S, D>& joint, const body_pair& ends, const body* bodies, S h) {
        joints_[lane] = &joint;
        put_body(a_, lane, ends.a, bodies);
        put_body(b_, lane, ends.b, bodies);
        const S ratio = joint.substep > S(0) ? impulse_ratio(joint.substep, h, S(8)) : S(0);
        for (int k = 0; k < row_count; ++k) rows_[k].impulse[lane] = joint.impulse[k] * ratio;
    }
    void put_nothing(int lane, std::uint32_t dummy_body) { a_.index[lane] = b_.index[lane] = dummy_body; }
    /// Which sides are pushed, which is the same for all lanes.
    void note_sides(const body* bodies) {
        a_.is_pushed = bodies[a_.index[0]].inverse_mass > I(0);
        b_.is_pushed = bodies[b_.index[0]].inverse_mass > I(0);
    }

    /// Writes the rows where bodies are now, and gives these what the last substep gave.
    void warm_start(body* bodies, const joint_pass<S>& with) {
        write_rows(bodies, with);
        lanes of_a, of_b;
        load(bodies, of_a, of_b);
        for (const row& r : rows_)
            if (r.is_on) apply(r, P::load(r.impulse), of_a, of_b);
        store(bodies, of_a, of_b);
    }
    /// Writes the rows anew after bodies have moved. Of what the substep gave, the next one is to begin with the same
    /// along the new rows: that is what starts tell, the velocities with which the substep began, where there are any.
    void update_rows(body* bodies, const joint_pass<S>& with, twist_of<S, D, Rotates>* starts) {
        if (starts == nullptr) return write_rows(bodies, with);
        lanes of_a{}, of_b{};
        for (const row& r : rows_)
            if (r.is_on) apply(r, P::load(r.impulse), of_a, of_b);
        write_rows(bodies, with);
        for (const row& r : rows_)
            if (r.is_on) apply(r, -P::load(r.impulse), of_a, of_b);
        if (a_.is_pushed) add(of_a, a_.index, starts);
        if (b_.is_pushed) add(of_b, b_.index, starts);
    }
    void solve(body* bodies, const joint_pass<S>& with, bool use_bias) {
        lanes of_a, of_b;
        load(bodies, of_a, of_b);
        for (row& r : rows_)
            if (r.is_on) solve(r, with, use_bias, of_a, of_b);
        store(bodies, of_a, of_b);
    }
    /// Hands the impulses back: those of a substep as long as usual ones, to which a shorter one adds its part.
    void store_impulses(S h) const {
        for (int lane = 0; lane < W; ++lane) {
            if (joints_[lane] == nullptr) continue;
            step_joint<Joint, S, D>& to = *joints_[lane];
            const S before = to.substep, usual = max(h, before - h * S(0.125));
            const S kept = h < before ? S(1) - impulse_ratio(before, h) : S(0);
            for (int k = 0; k < row_count; ++k) {
                const S given = rows_[k].impulse[lane];
                to.impulse[k] = h < before ? (to.impulse[k] * kept + given) * (usual / before) : given;
            }
            to.substep = usual;
        }
    }

private:
    /// The bodies of one side, and how they answer to impulses.
    struct side {
        std::uint32_t index[W] = {};
        I mass[W] = {}, inertia[A == 3 ? 6 : 1][W] = {};
        bool is_pushed = false;
    };
    struct row {
        S direction[D][W], angular_a[array][W], angular_b[array][W];
        /// See joint_row; impulses in a substep.
        S error[W], low[W], high[W], speed[W], one_sided[W];
        /// Of passes without and with bias.
        S rate[2][W], mass_scale[2][W], impulse_scale[2][W];
        S mass[W], impulse[W];
        /// Biases are no larger (m/s).
        S max_bias[W];
        /// Whether any lane is.
        bool is_on, is_one_sided;
    };

    static void put_body(side& to, int lane, std::uint32_t index, const body* bodies) {
        const body& b = bodies[index];
        to.index[lane] = index;
        to.mass[lane] = b.inverse_mass;
        if constexpr (A == 1) to.inertia[0][lane] = b.inverse_inertia;
        if constexpr (A == 3) {
            const auto& m = b.inverse_inertia;
            const I six[] = {m.xx, m.xy, m.xz, m.yy, m.yz, m.zz};
            for (int i = 0; i < 6; ++i) to.inertia[i][lane] = six[i];
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

    static void add(const lanes& change, const std::uint32_t (&index)[W], twist_of<S, D, Rotates>* to) {
        for (int lane = 0; lane < W; ++lane) {
            auto& v = to[index[lane]];
            for (int i = 0; i < D; ++i) v.linear[i] += change.at[i].lane(lane);
            if constexpr (A == 1) v.angular += change.at[D].lane(lane);
            if constexpr (A == 3)
                for (int i = 0; i < 3; ++i) v.angular[i] += change.at[D + i].lane(lane);
        }
    }
    void write_rows(const body* bodies, const joint_pass<S>& with) {
        for (row& r : rows_) r.is_on = r.is_one_sided = false;
        for (int lane = 0; lane < W; ++lane)
            if (joints_[lane] != nullptr) write_rows(lane, bodies, with);
    }
    PHYSICS_HPP_NOINLINE void write_rows(int lane, const body* bodies, const joint_pass<S>& with) {
        const body &a = bodies[a_.index[lane]], &b = bodies[b_.index[lane]];
        joint_frames<S, D> at = joints_[lane]->start;
        at.between = at.between + (b.displacement.linear - a.displacement.linear);
        if constexpr (Rotates) {
            at.rotation_a = turned(at.rotation_a, a.displacement.angular);
            at.rotation_b = turned(at.rotation_b, b.displacement.angular);
        }
        joint_row<S, D> rows[row_count];
        joints_[lane]->joint->rows(at, rows);
        for (int k = 0; k < row_count; ++k) write_row(rows_[k], lane, rows[k], a, b, with);
    }
    static void write_row(row& to, int lane, const joint_row<S, D>& from, const body& a, const body& b,
                          const joint_pass<S>& with) {
        const bool is_on = from.min_force < S(0) || from.max_force > S(0);
        const bool is_one_sided = is_on && !(from.min_force < S(0)), is_spring = from.frequency > S(0);
        to.is_on = to.is_on || is_on;
        to.is_one_sided = to.is_one_sided || is_one_sided;
        for (int i = 0; i < D; ++i) to.direction[i][lane] = from.direction[i];
        I k = from.direction == vec<S, D>{} ? I(0) : a.inverse_mass + b.inverse_mass;
        if constexpr (A == 1) {
            to.angular_a[0][lane] = from.angular_a;
            to.angular_b[0][lane] = from.angular_b;
        } else if constexpr (A == 3) {
            for (int i = 0; i < A; ++i) {
                to.angular_a[i][lane] = from.angular_a[i];
                to.angular_b[i][lane] = from.angular_b[i];
            }
        }
        if constexpr (Rotates)
            k = k + torque_k<S>(a.inverse_inertia, from.angular_a, from.angular_a) +
                torque_k<S>(b.inverse_inertia, from.angular_b, from.angular_b);
        const S unlimited = joint_row<S, D>::unlimited(), mass = k > I(0) && is_on ? reciprocal<S>(k) : S(0);
        const S max_bias = unlimited / max(mass, S(1)), max_error = max_bias * min(with.h, S(1));
        to.mass[lane] = mass;
        to.max_bias[lane] = max_bias;
        to.error[lane] = clamp(from.error, -max_error, max_error);
        to.one_sided[lane] = is_one_sided ? S(1) : S(0);
        to.speed[lane] = from.speed;
        const S max_force = unlimited / max(with.h, S(1));
        to.low[lane] = max(from.min_force, -max_force) * with.h;
        to.high[lane] = min(from.max_force, max_force) * with.h;
        // What is off forgets what it gave.
        to.impulse[lane] = clamp(to.impulse[lane], to.low[lane], to.high[lane]);
        // Springs act once in a substep, as forces do: passes without bias leave them alone.
        const softness<S> biased = is_spring ? softness<S>::of(from.frequency, from.damping_ratio, with.h) : with.rigid;
        const softness<S> relaxed{S(0), is_spring ? S(0) : S(1), S(0)};
        for (const bool use_bias : {false, true}) {
            const softness<S>& of = use_bias ? biased : relaxed;
            to.rate[use_bias][lane] = of.rate;
            to.mass_scale[use_bias][lane] = of.mass_scale;
            to.impulse_scale[use_bias][lane] = of.impulse_scale;
        }
    }

    /// J times the velocities.
    static P speed_of(const row& r, const lanes& a, const lanes& b) {
        auto sum = product(P::load(r.direction[0]), b.at[0] - a.at[0]);
        for (int i = 1; i < D; ++i) sum = sum + product(P::load(r.direction[i]), b.at[i] - a.at[i]);
        for (int i = 0; i < A; ++i)
            sum = sum + (product(P::load(r.angular_a[i]), a.at[D + i]) + product(P::load(r.angular_b[i]), b.at[D + i]));
        return narrow<S>(sum);
    }
    void apply(const row& r, const P& impulse, lanes& of_a, lanes& of_b) const {
        const Q mass_a = Q::load(a_.mass), mass_b = Q::load(b_.mass);
        for (int i = 0; i < D; ++i) {
            const P p = P::load(r.direction[i]) * impulse;
            of_a.at[i] = of_a.at[i] - mul<S>(mass_a, p);
            of_b.at[i] = of_b.at[i] + mul<S>(mass_b, p);
        }
        turn(a_, r.angular_a, impulse, of_a);
        turn(b_, r.angular_b, impulse, of_b);
    }
    static void turn([[maybe_unused]] const side& of, [[maybe_unused]] const S (&axis)[array][W],
                     [[maybe_unused]] const P& impulse, [[maybe_unused]] lanes& to) {
        if constexpr (A == 1) to.at[D] = to.at[D] + mul<S>(Q::load(of.inertia[0]), P::load(axis[0]) * impulse);
        if constexpr (A == 3) {
            constexpr int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
            const P moment[] = {P::load(axis[0]) * impulse, P::load(axis[1]) * impulse, P::load(axis[2]) * impulse};
            for (int i = 0; i < 3; ++i)
                to.at[D + i] = to.at[D + i] + narrow<S>(product(Q::load(of.inertia[place[i][0]]), moment[0]) +
                                                        product(Q::load(of.inertia[place[i][1]]), moment[1]) +
                                                        product(Q::load(of.inertia[place[i][2]]), moment[2]));
        }
    }
    void solve(row& r, const joint_pass<S>& with, bool use_bias, lanes& of_a, lanes& of_b) const {
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1));
        const P error = P::load(r.error);
        const P room = r.is_one_sided ? select_greater(P::load(r.one_sided), zero, max(error, zero), zero) : zero;
        const P limit = P::load(r.max_bias);
        // What has room may come so near within the substep.
        const P opens = room * P::broadcast(with.inverse_h);
        const P bias = max(min(select_greater(room, zero, opens, error * P::load(r.rate[use_bias])), limit), -limit);
        const P mass_scale = select_greater(room, zero, one, P::load(r.mass_scale[use_bias]));
        const P impulse_scale = select_greater(room, zero, zero, P::load(r.impulse_scale[use_bias]));
        const P speed = speed_of(r, of_a, of_b) - P::load(r.speed), impulse = P::load(r.impulse);
        const P wanted = impulse - P::load(r.mass) * (mass_scale * (speed + bias)) - impulse_scale * impulse;
        const P next = max(min(wanted, P::load(r.high)), P::load(r.low));
        apply(r, next - impulse, of_a, of_b);
        next.store(r.impulse);
    }

    step_joint<Joint, S, D>* joints_[W] = {};
    side a_, b_;
    row rows_[row_count] = {};
};

}  // namespace detail

PHYSICS_HPP_END
