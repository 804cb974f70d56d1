// Contacts of the soft solver between bodies that do not turn, in lanes.
#pragma once

#include "physics/dynamics/soft_contact.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Velocities and displacements of W bodies.
template <class P, int D>
struct linear_lanes {
    using S = typename P::scalar;
    using body = solver_body<S, D, false>;
    static constexpr int stride = sizeof(body) / sizeof(S);
    static_assert(sizeof(linear_twist<S, D>) == D * sizeof(S));

    lane_vec<P, D> velocity, displacement;

    PHYSICS_HPP_ALWAYS_INLINE void load(const body* bodies, const std::uint32_t* index) {
        const auto* first = reinterpret_cast<const S*>(bodies);
        const quad<P> p = load4<P>(indexed_rows<const S, stride>{first, index});
        if constexpr (D == 2) {
            velocity = {p.x, p.y};
            displacement = {p.z, p.w};
        } else {
            const quad<P> q = load4<P>(indexed_rows<const S, stride>{first + 4, index});
            velocity = {p.x, p.y, p.z};
            displacement = {p.w, q.x, q.y};
        }
    }
    PHYSICS_HPP_ALWAYS_INLINE void store(body* bodies, const std::uint32_t* index) const {
        const indexed_rows<S, stride> to{reinterpret_cast<S*>(bodies), index};
        const auto& [v, moved] = *this;
        if constexpr (D == 2) store4(to, quad<P>{v.x, v.y, moved.x, moved.y});
        else store4(to, quad<P>{v.x, v.y, v.z, moved.x});
    }
};

/// Friction where nothing turns: the same mass answers in every direction.
template <class S, int D, int W, class Features>
struct soft_linear_friction {
    using P = kernel_pack<S, W>;

    coefficient_lanes<S, W, Features> coefficient;
    /// Along the tangents; of this substep, and of the whole step.
    S impulse[D - 1][W], total[D - 1][W];

    void put(int lane, const contact<S, D, Features>& c, const prepare_input<S, D, Features>& with) {
        coefficient.put(lane, with.surfaces.friction_of(c));
        if constexpr (D == 2) {
            impulse[0][lane] = c.substep_friction;
        } else {
            const vec<S, 2> before = friction_of(c) * with.share;
            for (int i = 0; i < 2; ++i) impulse[i][lane] = before[i];
        }
    }
    /// Hands a share of the step's impulses back.
    [[nodiscard]] tangential<S, D> scaled_total(int lane, S share) const {
        if constexpr (D == 2) return total[0][lane] * share;
        else return {total[0][lane] * share, total[1][lane] * share};
    }
    /// More than 0 where it holds anything.
    PHYSICS_HPP_ALWAYS_INLINE P max_impulse(int) const {
        P maximum = lane_abs(P::load(impulse[0]));
        for (int i = 1; i < D - 1; ++i) maximum = max(maximum, lane_abs(P::load(impulse[i])));
        return maximum;
    }
    /// Turns slips into the changes of the impulses that stop them, under a load, or let them slide.
    PHYSICS_HPP_ALWAYS_INLINE void solve(P (&slip)[D - 1], const P& mass, const P& load, bool use_bias) {
        const P maximum = coefficient.all() * load;
        P before[D - 1], after[D - 1];
        for (int i = 0; i < D - 1; ++i) {
            before[i] = P::load(impulse[i]);
            P stopping = mass * slip[i];
            if constexpr (D == 2) stopping = stopping * friction_part(lane_abs(before[i]), maximum, use_bias);
            after[i] = before[i] - stopping;
        }
        if constexpr (D == 2) {
            after[0] = max(min(after[0], maximum), -maximum);
        } else if (lane_is_longer(after[0], after[1], maximum).bits() != 0) {
            const P one = P::broadcast(S(1)), length = lane_length(after[0], after[1]);
            const P share =
                select_greater(length, maximum, maximum / select_greater(length, maximum, length, one), one);
            for (P& along : after) along = along * share;
        }
        for (int i = 0; i < D - 1; ++i) {
            after[i].store(impulse[i]);
            if (!use_bias) (P::load(total[i]) + after[i]).store(total[i]);
            slip[i] = after[i] - before[i];
        }
    }
};

/// The first tangent in 3D, where it takes a root to find; in 2D it follows from the normal.
template <class S, int W>
struct kept_tangent {
    S kept[3][W];
};

/// W contacts that push different bodies, none of which turns. All points of a contact move alike: the nearest one
/// stands for all of them, and they share out evenly what it bears.
template <class S, int D, int W, class Features>
struct soft_linear_contact {
    using I = inverse_of<S>;
    using P = kernel_pack<S, W>;
    using Q = kernel_pack<I, W>;
    using body = solver_body<S, D, false>;
    using pass_type = contact_pass<S, D, false>;
    struct gathering {};

    struct point {
        S mass[W], separation[W];
        /// Of this substep, after its last round what the next one begins with; and of the whole step.
        S impulse[W], total[W];
    };
    static constexpr int point_count = 1;

    std::uint32_t a[W], b[W];
    S normal[D][W];
    [[no_unique_address]] std::conditional_t<Features::friction && D == 3, kept_tangent<S, W>, absent_base<2>> tangent;
    I mass_a[W], mass_b[W];
    point points[point_count];
    [[no_unique_address]] std::conditional_t<Features::friction, soft_linear_friction<S, D, W, Features>,
                                             no_soft_friction>
        friction;
    /// What the points bore together as the substep began.
    S start_load[W];
    /// Whether any contact is going to bounce in this substep.
    bool bounces_now = false;
    /// Whether the contacts push their bodies, which is the same for all lanes.
    bool moves_a = false, moves_b = false;
    [[no_unique_address]] extras_of_block<S, W, D, Features> extras;
    [[no_unique_address]] soft_bounces_of<S, 1, W, Features> bounce_to;

    /// Writes a contact into a lane: as it is, to be prepared with its neighbours.
    void put(int lane, const contact<S, D, Features>& c, const body_pair& ends, const body* bodies,
             const prepare_input<S, D, Features>& with, gathering&, arena& scratch) {
        const body& first = bodies[ends.a];
        const body& second = bodies[ends.b];
        a[lane] = ends.a;
        b[lane] = ends.b;
        mass_a[lane] = first.inverse_mass;
        mass_b[lane] = second.inverse_mass;
        for (int i = 0; i < D; ++i) normal[i][lane] = c.normal[i];
        int nearest = 0;
        S load = S(0);
        for (int k = 0; k < c.count; ++k) {
            if (c.points[k].separation < c.points[nearest].separation) nearest = k;
            if (c.persisted(k)) load += c.points[k].substep_impulse;
        }
        points[0].separation[lane] = c.points[nearest].separation;
        points[0].impulse[lane] = load;
        if constexpr (Features::restitution) bounce_to.put(lane, c, ends, with, scratch);
        if constexpr (Features::friction) friction.put(lane, c, with);
        extras.put(lane, c, first, second, with, scratch);
    }
    /// Works out, once all lanes have been written, what the rounds need.
    PHYSICS_HPP_ALWAYS_INLINE void prepare(const body*, gathering&) {
        using K = preparing<S, W>;
        put_lanes(lane_reciprocal(lanes_from<K>(mass_a) + lanes_from<K>(mass_b)), points[0].mass);
        if constexpr (Features::friction && D == 3) {
            lane_tangent(lane_vec3<K>::load(normal)).store(tangent.kept);
        }
    }
    /// Hands the impulses back.
    void store_impulses(int lane, contact<S, D, Features>& c) const {
        const S share = S(1) / S(int{c.count});
        for (int k = 0; k < c.count; ++k) {
            auto& to = c.points[k];
            to.normal_impulse = points[0].total[lane] * share;
            to.substep_impulse = points[0].impulse[lane] * share;
            if constexpr (Features::friction) to.friction_impulse = friction.scaled_total(lane, share);
        }
        if constexpr (Features::friction && D == 2) c.substep_friction = friction.impulse[0][lane];
    }

    /// Gives the bodies the impulses of the last substep at once.
    PHYSICS_HPP_ALWAYS_INLINE void warm_start(body* bodies) {
        P::load(points[0].impulse).store(start_load);
        if (carries_no_impulse<P>(*this)) return;
        linear_lanes<P, D> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        const P load = P::load(points[0].impulse);
        if constexpr (Features::friction) {
            P friction_impulses[D - 1];
            for (int i = 0; i < D - 1; ++i) friction_impulses[i] = P::load(friction.impulse[i]);
            apply(load, friction_impulses, at_a, at_b);
        } else {
            apply(load, at_a, at_b);
        }
        store(bodies, at_a, at_b);
    }
    /// One round over the contacts, then friction by their load; in 3D it rests while overlaps are pushed apart (see
    /// soft_contact3).
    PHYSICS_HPP_ALWAYS_INLINE void solve(body* bodies, const pass_type& pass) {
        linear_lanes<P, D> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        const vector n = normals();
        const P speed = dot(n, slip_of(at_a, at_b)), displacement = dot(n, at_b.displacement - at_a.displacement);
        const P one = P::broadcast(S(1));
        const auto displacement_at = [&](int) PHYSICS_HPP_INLINE_LAMBDA { return displacement; };
        const auto speed_at = [&](int) PHYSICS_HPP_INLINE_LAMBDA { return speed; };
        if (carries_no_impulse<P>(*this) && are_inactive(points, 1, pass, one, displacement_at, speed_at)) {
            if (!pass.use_bias) P::broadcast(S(0)).store(start_load);
            else if constexpr (Features::restitution) bounces_now = false;
            return;
        }
        apply(next_impulse(points[0], speed, displacement, pass, one), at_a, at_b);
        if constexpr (Features::restitution)
            if (pass.use_bias && bounces_now) bounce_to.at->template keep_pushed<P>(points, 1);
        if constexpr (Features::friction)
            if (D == 2 || !pass.use_bias) solve_friction(P::load(points[0].impulse), pass.use_bias, at_a, at_b);
        if (!pass.use_bias) {
            add_totals<P>(points, 1);
            if (greater(-speed, P::broadcast(pass.impact_speed)).bits() != 0) discard_impacts(bodies, pass, speed);
            P::load(points[0].impulse).store(start_load);
        }
        store(bodies, at_a, at_b);
    }
    /// Notes which contacts are going to bounce, before anything stops them.
    PHYSICS_HPP_ALWAYS_INLINE void note_approaches(const body* bodies,
                                                   const pass_type& pass) requires Features::restitution {
        bounces_now = false;
        if (!bounce_to.at->template any_free<P>(points, 1)) return;
        linear_lanes<P, D> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        const vector n = normals();
        const P speed = dot(n, slip_of(at_a, at_b)), displacement = dot(n, at_b.displacement - at_a.displacement);
        bounces_now = bounce_to.at->template note<P>(
            points, 1, pass, [&](int) PHYSICS_HPP_INLINE_LAMBDA { return displacement; },
            [&](int) PHYSICS_HPP_INLINE_LAMBDA { return speed; });
    }
    /// Lets bounce what has met in this substep. The next one does not begin with any of that.
    PHYSICS_HPP_NOINLINE void bounce(body* bodies, const pass_type& pass) requires Features::restitution {
        for (int lane = 0; lane < W; ++lane) {
            if (!bounce_to.at->has(lane, 1)) continue;
            body& of_a = bodies[a[lane]];
            body& of_b = bodies[b[lane]];
            vec<S, D> n;
            for (int i = 0; i < D; ++i) n[i] = normal[i][lane];
            const S v = dot(n, of_b.velocity.linear - of_a.velocity.linear);
            const S impulse = max(points[0].mass[lane] * (bounce_to.at->speed[0][lane] - v), -points[0].impulse[lane]);
            if (moves_a) remove_from_start(of_a.velocity, of_a, n * -impulse);
            if (moves_b) remove_from_start(of_b.velocity, of_b, n * impulse);
            points[0].total[lane] += impulse;
            remove_from_next_start(lane, bodies, pass, impulse + reduce_to(points[0].impulse[lane], S(0)), S(0));
        }
        P::load(points[0].impulse).store(start_load);
        bounces_now = false;
    }

private:
    using vector = lane_vec<P, D>;

    PHYSICS_HPP_ALWAYS_INLINE vector normals() const { return vector::load(normal); }
    /// Tangent number i.
    PHYSICS_HPP_ALWAYS_INLINE vector along(int i) const requires Features::friction {
        if constexpr (D == 2) {
            return {P::load(normal[1]), -P::load(normal[0])};
        } else {
            const lane_vec3<P> t = lane_vec3<P>::load(tangent.kept);
            return i == 0 ? t : cross(lane_vec3<P>::load(normal), t);
        }
    }
    /// How B moves against A.
    PHYSICS_HPP_ALWAYS_INLINE static vector slip_of(const linear_lanes<P, D>& at_a, const linear_lanes<P, D>& at_b) {
        return at_b.velocity - at_a.velocity;
    }
    /// Stops the slip, or lets it slide.
    PHYSICS_HPP_ALWAYS_INLINE void solve_friction(const P& load, bool use_bias, linear_lanes<P, D>& at_a,
                                                  linear_lanes<P, D>& at_b) {
        const vector slip = slip_of(at_a, at_b);
        P by[D - 1];
        for (int i = 0; i < D - 1; ++i) by[i] = dot(along(i), slip);
        if constexpr (Features::surface_velocity) {
            if (extras.at != nullptr) {
                if constexpr (D == 2) {
                    by[0] = by[0] - P::load(extras.at->along);
                } else {
                    by[0] = by[0] - P::load(extras.belt().x);
                    by[1] = by[1] - P::load(extras.belt().y);
                }
            }
        }
        friction.solve(by, P::load(points[0].mass), load, use_bias);
        apply(P::broadcast(S(0)), by, at_a, at_b);
    }
    /// After an impact, removes from the start velocities of the next substep all impulse but what was held before it.
    PHYSICS_HPP_NOINLINE void discard_impacts(const body* bodies, const pass_type& pass, const P& speed) {
        for (int lane = 0; lane < W; ++lane) {
            const S load = points[0].impulse[lane];
            if (!(-speed.lane(lane) > pass.impact_speed) || !(load > start_load[lane])) continue;
            const S share = start_load[lane] / load;
            remove_from_next_start(lane, bodies, pass, reduce_to(points[0].impulse[lane], share), share);
        }
    }
    /// Takes an impulse along the normal of a lane, and all but a share of friction, from what the next substep begins
    /// with.
    void remove_from_next_start(int lane, const body* bodies, const pass_type& pass, S load, [[maybe_unused]] S share) {
        vec<S, D> n;
        for (int i = 0; i < D; ++i) n[i] = normal[i][lane];
        vec<S, D> lost = n * load;
        if constexpr (Features::friction) {
            vec<S, D> t = n;
            if constexpr (D == 2) t = perpendicular(n);
            else t = {tangent.kept[0][lane], tangent.kept[1][lane], tangent.kept[2][lane]};
            lost += t * reduce_to(friction.impulse[0][lane], share);
            if constexpr (D == 3) lost += cross(n, t) * reduce_to(friction.impulse[1][lane], share);
        }
        if (moves_a) remove_from_start(pass.start_velocity[a[lane]], bodies[a[lane]], -lost);
        if (moves_b) remove_from_start(pass.start_velocity[b[lane]], bodies[b[lane]], lost);
    }
    /// Impulses along the normal and along the tangents, from A on B.
    PHYSICS_HPP_ALWAYS_INLINE void apply(const P& load, linear_lanes<P, D>& at_a, linear_lanes<P, D>& at_b) const {
        apply_impulse(normals() * load, at_a, at_b);
    }
    PHYSICS_HPP_ALWAYS_INLINE void apply(const P& load, const P (&friction_impulses)[D - 1], linear_lanes<P, D>& at_a,
                                         linear_lanes<P, D>& at_b) const requires Features::friction {
        const vector n = normals(), t = along(0);
        const P& by_t = friction_impulses[0];
        if constexpr (D == 2) {
            apply_impulse({lane_sum(n.x, load, t.x, by_t), lane_sum(n.y, load, t.y, by_t)}, at_a, at_b);
        } else {
            const vector u = along(1), by = {load, by_t, friction_impulses[1]};
            apply_impulse({dot({n.x, t.x, u.x}, by), dot({n.y, t.y, u.y}, by), dot({n.z, t.z, u.z}, by)}, at_a, at_b);
        }
    }
    PHYSICS_HPP_ALWAYS_INLINE void apply_impulse(const vector& impulse, linear_lanes<P, D>& at_a,
                                                 linear_lanes<P, D>& at_b) const {
        at_a.velocity = at_a.velocity - impulse * Q::load(mass_a);
        at_b.velocity = at_b.velocity + impulse * Q::load(mass_b);
    }
    PHYSICS_HPP_ALWAYS_INLINE void store(body* bodies, const linear_lanes<P, D>& at_a,
                                         const linear_lanes<P, D>& at_b) const {
        if (moves_a) at_a.store(bodies, a);
        if (moves_b) at_b.store(bodies, b);
    }
};

}  // namespace detail

PHYSICS_HPP_END
