// Rows of joints in lanes, and the bodies that they push, whatever the kinds are.
#pragma once

#include "physics/base/pack_rows.hpp"
#include "physics/dynamics/constraints.hpp"
#include "physics/dynamics/contact_pass.hpp"
#include "physics/dynamics/friction.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// What a round over joints is for: speeds, with springs or without; to take errors back; speeds and errors at once;
/// speeds without springs before the last round of a substep; or speeds of what has contacts, before these are visited.
enum class joint_round : std::uint8_t {
    relaxing = 0,
    speeds = 1,
    corrections = 2,
    all = 3,
    relaxing_first = 4,
    before_contacts = 5
};
constexpr bool has_springs(joint_round r) { return (static_cast<unsigned>(r) & 1) != 0; }
constexpr bool has_errors(joint_round r) { return (static_cast<unsigned>(r) & 2) != 0; }

/// What joints are solved with.
template <class S>
struct joint_pass {
    /// Length of a substep (s), and its inverse.
    S h, inverse_h;
    /// Of rows that are as stiff as can be.
    softness<S> rigid;
};

/// What a damped spring does in a substep: it takes `share` of the speed along it, and adds `push` times its error:
/// v' = (v - omega^2 h x) / (1 + D). It sags by its load exactly. Without damping D is 0, as in symplectic Euler: it
/// keeps its amplitude; with it decay is right to the square of omega h below critical damping, and the slow mode
/// beyond. Two such springs on one body may be unstable from omega h = 2 on: between 1/2 and 1 the implicit form takes
/// over. Source: Catto, Soft constraints (GDC 2011); Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1.
template <class S>
struct spring_step {
    S share, push;

    static spring_step of(S frequency, S damping_ratio, S h) {
        const S omega = S(6.283185307179586) * frequency, angle = omega * h, damping = damping_ratio * angle;
        return of(omega, angle, damping, max(S(1) - damping_ratio * damping_ratio, S(0)));
    }
    /// The same by a stiffness and a damping, of a mass.
    static spring_step physical(S stiffness, S damping, S mass, S h) {
        const S omega = sqrt(stiffness / mass), angle = omega * h, half = damping * h / (mass + mass);
        const S ratio = half < angle ? half / angle : S(1);
        return of(omega, angle, half, S(1) - ratio * ratio);
    }

private:
    static spring_step of(S omega, S angle, S damping, S below_critical) {
        const S implicit = clamp(angle + angle - S(1), S(0), S(1));
        const S d = (damping + damping) * (S(1) + damping * below_critical) + implicit * angle * angle;
        return {d / (S(1) + d), omega * angle / (S(1) + d)};
    }
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
    /// That of one body.
    [[nodiscard]] twist_of<S, D, Rotates> of(int lane) const {
        twist_of<S, D, Rotates> v;
        for (int i = 0; i < D; ++i) v.linear[i] = at[i].lane(lane);
        if constexpr (angular_size == 1) v.angular = at[D].lane(lane);
        if constexpr (angular_size == 3)
            for (int i = 0; i < 3; ++i) v.angular[i] = at[D + i].lane(lane);
        return v;
    }
    /// Adds it to twists of single bodies.
    void add_to(twist_of<S, D, Rotates>* to, const std::uint32_t* index) const {
        for (int lane = 0; lane < P::width; ++lane) to[index[lane]] = to[index[lane]] + of(lane);
    }
};

/// W bodies, and how they answer to impulses.
template <class S, int D, bool Rotates, int W>
struct pushed_lanes {
    using I = inverse_of<S>;
    using P = kernel_pack<S, W>;
    using Q = kernel_pack<I, W>;
    using lanes = twist_lanes<P, D, Rotates>;
    static constexpr int A = lanes::angular_size, array = A > 0 ? A : 1;

    std::uint32_t index[W] = {};
    I mass[W] = {}, inertia[A == 3 ? 6 : 1][W] = {};
    bool is_pushed = false;

    void put(int lane, std::uint32_t number, const solver_body<S, D, Rotates>* bodies) {
        const auto& b = bodies[number];
        index[lane] = number;
        mass[lane] = b.inverse_mass;
        if constexpr (A == 1) inertia[0][lane] = b.inverse_inertia;
        if constexpr (A == 3) {
            const auto& m = b.inverse_inertia;
            const I six[] = {m.xx, m.xy, m.xz, m.yy, m.yz, m.zz};
            for (int i = 0; i < 6; ++i) inertia[i][lane] = six[i];
        }
    }
    /// Has bodies turn by so large a part of what they would.
    void scale_inertia(const S* share) {
        for (auto& entry : inertia)
            for (int lane = 0; lane < W; ++lane)
                if (share[lane] < S(1)) entry[lane] = mul<I>(entry[lane], share[lane]);
    }
    /// By which angular velocities change for an angular impulse of 1 about an axis.
    void find_response(const S (&axis)[array][W], I (&response)[array][W]) const {
        if constexpr (A == 1) mul<I>(Q::load(inertia[0]), P::load(axis[0])).store(response[0]);
        if constexpr (A == 3) {
            const P x[] = {P::load(axis[0]), P::load(axis[1]), P::load(axis[2])};
            for (int i = 0; i < 3; ++i) narrow<I>(inertia_row(i, x)).store(response[i]);
        }
    }

private:
    /// A row of the inverse inertia times a vector, before it is rounded.
    auto inertia_row(int i, const P (&v)[array]) const {
        constexpr int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
        return product(Q::load(inertia[place[i][0]]), v[0]) + product(Q::load(inertia[place[i][1]]), v[1]) +
               product(Q::load(inertia[place[i][2]]), v[2]);
    }
};

/// Of rows that pull A in a direction of its own.
template <class S, int D, int W, bool Two>
struct own_directions {};
template <class S, int D, int W>
struct own_directions<S, D, W, true> {
    S direction_a[D][W];
};

/// A row of W joints. `Two`: A has a direction of its own.
template <class S, int D, bool Rotates, int W, bool Two>
struct row_lanes : own_directions<S, D, W, Two> {
    using I = inverse_of<S>;
    using P = kernel_pack<S, W>;
    using Q = kernel_pack<I, W>;
    using lanes = twist_lanes<P, D, Rotates>;
    using side = pushed_lanes<S, D, Rotates, W>;
    static constexpr int A = side::A, array = side::array;

    S direction[D][W], angular_a[array][W], angular_b[array][W];
    /// See joint_row; impulses in a substep.
    S error[W], low[W], high[W], speed[W], one_sided[W], spring[W];
    /// In passes with bias, see spring_step; and which part of an impulse goes.
    S push[W], share[W], loss[W];
    S mass[W], impulse[W];
    /// By which angular velocities change for an impulse of 1.
    I response_a[array][W], response_b[array][W];
    /// What of the impulse took the error back, which is to be taken back itself.
    S correction[W];
    /// Of all substeps together.
    S total[W];
    /// Biases are no larger (m/s).
    S max_bias[W];
    /// Whether any lane is.
    bool is_on, is_one_sided, is_bounded, has_spring, is_physical;

    void clear() { is_on = is_one_sided = is_bounded = has_spring = is_physical = false; }
    /// Writes what a joint says of it into a lane. Once all lanes are written, finish has to follow.
    void put(int lane, const joint_row<S, D>& from, [[maybe_unused]] const vec<S, D>& to_a, const joint_pass<S>& with) {
        for (int i = 0; i < D; ++i) direction[i][lane] = from.direction[i];
        if constexpr (Two)
            for (int i = 0; i < D; ++i) this->direction_a[i][lane] = to_a[i];
        if constexpr (A == 1) {
            angular_a[0][lane] = from.angular_a;
            angular_b[0][lane] = from.angular_b;
        } else if constexpr (A == 3) {
            for (int i = 0; i < A; ++i) {
                angular_a[i][lane] = from.angular_a[i];
                angular_b[i][lane] = from.angular_b[i];
            }
        }
        const bool on = from.is_on(), is_one = on && !(from.min_force < S(0)), is_spring = from.is_spring();
        is_on = is_on || on;
        is_one_sided = is_one_sided || is_one;
        is_bounded = is_bounded || from.is_bounded();
        has_spring = has_spring || is_spring;
        error[lane] = from.error;
        speed[lane] = from.speed;
        low[lane] = from.min_force;
        high[lane] = from.max_force;
        one_sided[lane] = is_one ? S(1) : S(0);
        spring[lane] = is_spring ? S(1) : S(0);
        if (from.is_physical) {
            // Its mass is not known yet.
            share[lane] = from.frequency;
            push[lane] = from.damping_ratio;
            spring[lane] = S(2);
            is_physical = true;
        } else if (is_spring) {
            set_spring(lane, spring_step<S>::of(from.frequency, from.damping_ratio, with.h));
        } else if (from.is_motor) {
            share[lane] = S(1);
            push[lane] = loss[lane] = S(0);
        } else {
            share[lane] = with.rigid.mass_scale;
            push[lane] = with.rigid.mass_scale * with.rigid.rate;
            loss[lane] = with.rigid.impulse_scale;
        }
    }
    /// A row along an axis of the world that is as stiff as can be, in lanes where it is (1, else 0): all but its
    /// levers, error and bounds.
    void begin_rigid(int axis, const P& is, const joint_pass<S>& with) {
        clear();
        is_on = true;
        is.store(direction[axis]);
        P::broadcast(with.rigid.mass_scale).store(share);
        P::broadcast(with.rigid.mass_scale * with.rigid.rate).store(push);
        P::broadcast(with.rigid.impulse_scale).store(loss);
    }
    /// Turns forces into impulses, and cuts off what no number could hold.
    void finish(const side& a, const side& b, const joint_pass<S>& with) {
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1)), h = P::broadcast(with.h);
        const S unlimited = joint_row<S, D>::unlimited(), max_force = unlimited / max(with.h, S(1));
        find_response(a, b);
        const P own = select_greater(P::load(high), P::load(low), inverse(k_of(a, b)), zero),
                limit = P::broadcast(unlimited) / max(own, one), max_error = limit * min(h, one);
        own.store(mass);
        limit.store(max_bias);
        max(min(P::load(error), max_error), -max_error).store(error);
        // What gives all that it takes has no bound: in fixed point even the largest force gives little in a substep.
        const P endless = P::broadcast(unlimited);
        const auto bound = [&](const P& force) {
            return select_greater(endless, force, min(force, P::broadcast(max_force)) * h, endless);
        };
        const P low_impulse = select_greater(own, zero, -bound(-P::load(low)), zero),
                high_impulse = select_greater(own, zero, bound(P::load(high)), zero);
        low_impulse.store(low);
        high_impulse.store(high);
        // What is off forgets what it gave.
        max(min(P::load(impulse), high_impulse), low_impulse).store(impulse);
        if (!is_physical) return;
        for (int lane = 0; lane < W; ++lane) {
            if (!(spring[lane] > S(1))) continue;
            spring[lane] = S(1);
            set_spring(lane, mass[lane] > S(0) ? spring_step<S>::physical(share[lane], push[lane], mass[lane], with.h)
                                               : spring_step<S>{});
        }
    }

    /// Has to follow where inertias have changed.
    void find_response(const side& a, const side& b) {
        a.find_response(angular_a, response_a);
        b.find_response(angular_b, response_b);
    }
    /// Adds what it gave in a substep.
    void add_up() { (P::load(total) + P::load(impulse)).store(total); }
    [[nodiscard]] const auto& direction_of([[maybe_unused]] bool is_b) const {
        if constexpr (Two) return is_b ? direction : this->direction_a;
        else return direction;
    }
    /// J times the velocities.
    P speed_of(const lanes& a, const lanes& b) const {
        auto sum = product(P::load(direction[0]), b.at[0] - a.at[0]);
        for (int i = 1; i < D; ++i) sum = sum + product(P::load(direction[i]), b.at[i] - a.at[i]);
        // Adds nothing to rows of kinds with one direction: their bits are the same among others.
        if constexpr (Two)
            for (int i = 0; i < D; ++i)
                sum = sum + product(P::load(direction[i]) - P::load(this->direction_a[i]), a.at[i]);
        for (int i = 0; i < A; ++i)
            sum = sum + (product(P::load(angular_a[i]), a.at[D + i]) + product(P::load(angular_b[i]), b.at[D + i]));
        return narrow<S>(sum);
    }
    void apply(const P& by, const side& a, const side& b, lanes& of_a, lanes& of_b) const {
        const Q mass_a = Q::load(a.mass), mass_b = Q::load(b.mass);
        for (int i = 0; i < D; ++i) {
            const P p = P::load(direction[i]) * by;
            of_b.at[i] = of_b.at[i] + mul<S>(mass_b, p);
            if constexpr (Two) of_a.at[i] = of_a.at[i] - mul<S>(mass_a, P::load(this->direction_a[i]) * by);
            else of_a.at[i] = of_a.at[i] - mul<S>(mass_a, p);
        }
        for (int i = 0; i < A; ++i) {
            of_a.at[D + i] = of_a.at[D + i] + mul<S>(Q::load(response_a[i]), by);
            of_b.at[D + i] = of_b.at[D + i] + mul<S>(Q::load(response_b[i]), by);
        }
    }
    /// What has room may come so near within the substep: that speed, else 0.
    P room() const {
        const P zero = P::broadcast(S(0));
        return is_one_sided ? select_greater(P::load(one_sided), zero, max(P::load(error), zero), zero) : zero;
    }
    /// Visits it alone. Of what others have a part in, the bound is left to them. Springs act once in a substep, as
    /// forces do: rounds without them leave them alone. It keeps by what rounds for errors take them back; loads do not
    /// sag in these.
    template <bool IsBounded = true>
    void solve(const joint_pass<S>& with, joint_round round, const side& a, const side& b, lanes& of_a, lanes& of_b) {
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1));
        const P before = P::load(impulse), v = speed_of(of_a, of_b) - P::load(speed);
        P left = one, bias = zero, lost = zero;
        if (has_errors(round)) {
            // Motors ask for speeds only.
            left = select_greater(P::load(push), zero, one, zero);
            bias = P::load(error) * P::load(push);
        }
        if (has_spring) {
            const P spring_lanes = P::load(spring), rigid_lanes = one - spring_lanes;
            if (has_springs(round)) {
                left = select_greater(spring_lanes, zero, P::load(share), one);
                bias = P::load(error) * P::load(push) * spring_lanes;
                lost = P::load(loss) * spring_lanes;
            } else {
                left = left * rigid_lanes;
                bias = bias * rigid_lanes;
            }
        }
        if (is_one_sided) {
            const P free = room();
            left = select_greater(free, zero, one, left);
            bias = select_greater(free, zero, free * P::broadcast(with.inverse_h), bias);
            lost = select_greater(free, zero, zero, lost);
        }
        const P limit = P::load(max_bias);
        const P wanted = before - P::load(mass) * (left * v + max(min(bias, limit), -limit)) - lost * before;
        const P next = IsBounded ? max(min(wanted, P::load(high)), P::load(low)) : wanted;
        apply(next - before, a, b, of_a, of_b);
        next.store(impulse);
        if (has_errors(round)) note_correction(next - before);
    }
    void note_correction(const P& by) { (P::load(correction) + by).store(correction); }
    /// Takes back by what solve has taken errors back.
    void take_correction_back(const side& a, const side& b, lanes& of_a, lanes& of_b) {
        const P before = P::load(impulse), next = max(min(before - P::load(correction), P::load(high)), P::load(low));
        apply(next - before, a, b, of_a, of_b);
        next.store(impulse);
        P::broadcast(S(0)).store(correction);
    }

private:
    using array_of_lanes = S[W];

    void set_spring(int lane, const spring_step<S>& does) {
        share[lane] = does.share;
        push[lane] = does.push;
        loss[lane] = S(1) - does.share;
    }
    /// J M^-1 J^T.
    Q k_of(const side& a, const side& b) const {
        const P along = square_of(direction);
        Q k = mul<I>(Q::load(a.mass) + Q::load(b.mass), along);
        if constexpr (Two) k = mul<I>(Q::load(a.mass), square_of(this->direction_a)) + mul<I>(Q::load(b.mass), along);
        if constexpr (Rotates) k = k + answer(angular_a, response_a) + answer(angular_b, response_b);
        return k;
    }
    static P square_of(const array_of_lanes* v) {
        auto sum = product(P::load(v[0]), P::load(v[0]));
        for (int i = 1; i < D; ++i) sum = sum + product(P::load(v[i]), P::load(v[i]));
        return narrow<S>(sum);
    }
    static P inverse(const Q& k) {
        if constexpr (std::is_same_v<P, Q>) return lane_reciprocal(k);
        else return P::broadcast(k.lane(0) > I(0) ? reciprocal<S>(k.lane(0)) : S(0));
    }
    static Q answer(const S (&axis)[array][W], const I (&response)[array][W]) {
        if constexpr (A == 1) return mul<I>(Q::load(response[0]), P::load(axis[0]));
        else
            return narrow<I>(product(Q::load(response[0]), P::load(axis[0])) +
                             product(Q::load(response[1]), P::load(axis[1])) +
                             product(Q::load(response[2]), P::load(axis[2])));
    }
};

}  // namespace detail

PHYSICS_HPP_END
