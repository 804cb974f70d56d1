// Contacts of the soft solver in 2D, in lanes.
#pragma once

#include "physics/dynamics/soft_contact.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// W contacts that push different bodies. All points of a contact share the normal, so their speeds follow from two
/// numbers: the speed along the normal at the contact's middle, and how fast the bodies turn against each other.
/// Friction acts at the middle: along their line all points slip alike.
template <class S, int W, class Features>
struct soft_contact2 {
    using I = inverse_of<S>;
    using P = kernel_pack<S, W>;
    using Q = kernel_pack<I, W>;
    using body = solver_body<S, 2>;
    using gathering = contact_gather<S, 2, W, Features>;

    struct point : soft_point<S, 2, W> {
        /// The lever that an impulse along the normal has about the middle (m).
        S moment_arm[W];
    };

    std::uint32_t a[W], b[W];
    S normal[2][W];
    /// From the bodies' centres to the middle (m).
    S r_a[2][W], r_b[2][W];
    I mass_a[W], mass_b[W], inertia_a[W], inertia_b[W];
    static constexpr int capacity = manifold<S, 2>::capacity;
    point points[capacity];
    block_solve<S, 2, W> direct;
    [[no_unique_address]] soft_friction2_of<S, W, Features> friction;
    /// What the points bore together as the substep began; less than 0 where they land in it with an impact.
    S start_load[W];
    /// How B has moved against A as of the last round that did not push: the next one that does asks for the same.
    S last_displacements[2][W];
    int point_count = 0;
    /// Whether any point is going to bounce in this substep.
    bool bounces_now = false;
    /// Whether the contacts push their bodies, which is the same for all lanes.
    bool moves_a = false, moves_b = false;
    [[no_unique_address]] extras_of_block<S, W, 2, Features> extras;
    // What most rounds do not ask for comes last, and stays out of their caches.
    /// How the two speeds answer to an impulse along the normal at the middle and to an angular one: xx, xy, yy.
    I k_matrix[3][W];
    [[no_unique_address]] soft_bounces_of<S, capacity, W, Features> bounce_to;

    /// Writes a contact into a lane: as it is, to be prepared with its neighbours.
    void put(int lane, const contact<S, 2, Features>& c, const body_pair& ends, const body* bodies,
             const prepare_input<S, 2, Features>& with, gathering& gathered, arena& scratch) {
        const body& first = bodies[ends.a];
        const body& second = bodies[ends.b];
        a[lane] = ends.a;
        b[lane] = ends.b;
        gathered.add(lane, c);
        point_count = point_count < c.count ? c.count : point_count;
        for (int k = 0; k < c.count; ++k) points[k].impulse[lane] = c.persisted(k) ? c.points[k].substep_impulse : S(0);
        if constexpr (Features::restitution) bounce_to.put(lane, c, ends, with, scratch);
        if constexpr (Features::friction) {
            friction.coefficient.put(lane, with.surfaces.friction_of(c));
            friction.impulse[lane] = c.substep_friction;
        }
        extras.put(lane, c, first, second, with, scratch);
    }
    /// Works out, once all lanes have been written, what the rounds need.
    PHYSICS_HPP_ALWAYS_INLINE void prepare(const body* bodies, gathering& gathered) {
        gathered.read(*this, point_count);
        load_inverse_masses(bodies, a, mass_a, inertia_a);
        load_inverse_masses(bodies, b, mass_b, inertia_b);
        using K = preparing<S, W>;
        using C = typename K::scalar;
        const K n_x = lanes_from<K>(normal[0]), n_y = lanes_from<K>(normal[1]);
        const K a_x = lanes_from<K>(r_a[0]), a_y = lanes_from<K>(r_a[1]);
        const K b_x = lanes_from<K>(r_b[0]), b_y = lanes_from<K>(r_b[1]);
        const K turn_a = a_x * n_y - a_y * n_x, turn_b = b_x * n_y - b_y * n_x;
        const K mass = lanes_from<K>(mass_a) + lanes_from<K>(mass_b);
        const K of_a = lanes_from<K>(inertia_a), of_b = lanes_from<K>(inertia_b);
        const K along = mass + of_a * turn_a * turn_a + of_b * turn_b * turn_b;
        const K across = of_a * turn_a + of_b * turn_b, turn = of_a + of_b;
        put_lanes(along, k_matrix[0]);
        put_lanes(across, k_matrix[1]);
        put_lanes(turn, k_matrix[2]);

        const K zero = K::broadcast(C(0)), one = K::broadcast(C(1));
        K jacobians[capacity][2], of_points[capacity][2], own[capacity];
        for (int k = 0; k < point_count; ++k) {
            const auto& offset = gathered.offset[k];
            const K moment_arm = lanes_from<K>(offset[0]) * n_y - lanes_from<K>(offset[1]) * n_x;
            jacobians[k][0] = one;
            jacobians[k][1] = moment_arm;
            of_points[k][0] = along + across * moment_arm;
            of_points[k][1] = across + turn * moment_arm;
            // Turning only adds to it, whatever rounding says.
            own[k] = max(of_points[k][0] + of_points[k][1] * moment_arm, mass);
            point& to = points[k];
            put_lanes(moment_arm, to.moment_arm);
            put_lanes(select_greater(lanes_from<K>(gathered.there[k]), zero, lane_reciprocal(own[k]), zero), to.mass);
        }
        direct.clear();
        if (point_count == 2) direct.prepare_edge(points, jacobians, of_points, own, lanes_from<K>(gathered.count));
        if constexpr (Features::friction) {
            const K slide_a = a_x * n_x + a_y * n_y, slide_b = b_x * n_x + b_y * n_y;
            put_lanes(lane_reciprocal(mass + of_a * slide_a * slide_a + of_b * slide_b * slide_b), friction.stop);
        }
    }
    /// Hands the impulses back. Friction is shared as the points share the load.
    void store_impulses(int lane, contact<S, 2, Features>& c) const {
        S load = S(0);
        for (int k = 0; k < c.count; ++k) load += points[k].total[lane];
        for (int k = 0; k < c.count; ++k) {
            auto& to = c.points[k];
            to.normal_impulse = points[k].total[lane];
            to.substep_impulse = points[k].impulse[lane];
            if constexpr (Features::friction)
                to.friction_impulse = load > S(0) ? friction.total[lane] * (to.normal_impulse / load) : S(0);
        }
        if constexpr (Features::friction) c.substep_friction = friction.impulse[lane];
        extras.store_impulses(lane, c);
    }

    /// Gives the bodies the impulses of the last substep at once.
    PHYSICS_HPP_ALWAYS_INLINE void warm_start(body* bodies) {
        load_of<P>(points, point_count).store(start_load);
        if (carries_no_impulse<P>(*this)) return;
        const frame_lanes f(*this);
        body_lanes<P, 2> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        const P zero = P::broadcast(S(0));
        impulse_sum sum{zero, zero};
        P friction_impulse = zero;
        for (int k = 0; k < point_count; ++k) sum.add(points[k], P::load(points[k].impulse));
        if constexpr (Features::friction) friction_impulse = P::load(friction.impulse);
        if constexpr (Features::rolling_resistance)
            if (extras.at != nullptr) sum.moment = sum.moment + P::load(extras.at->impulse);
        apply(f, sum.load, friction_impulse, sum.moment, at_a, at_b);
        if (moves_a) at_a.store(bodies, a);
        if (moves_b) at_b.store(bodies, b);
    }
    /// One round over the contacts: the points at once, or across and back, then friction by their load.
    PHYSICS_HPP_ALWAYS_INLINE void solve(body* bodies, const contact_pass<S, 2>& pass) {
        const frame_lanes f(*this);
        body_lanes<P, 2> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        const relative_motion speed(f, at_a.velocity, at_b.velocity),
            displacement = displacement_of(f, at_a, at_b, pass);
        const auto displacement_at = [&](int k) PHYSICS_HPP_INLINE_LAMBDA { return displacement.at(points[k]); };
        const auto speed_at = [&](int k) PHYSICS_HPP_INLINE_LAMBDA { return speed.at(points[k]); };
        if (carries_no_impulse<P>(*this) &&
            are_inactive(points, point_count, pass, P::broadcast(S(1)), displacement_at, speed_at)) {
            if (!pass.use_bias) P::broadcast(S(0)).store(start_load);
            else if constexpr (Features::restitution) bounces_now = false;
            return;
        }
        const P speeds[] = {speed.along, speed.turn};
        const P displacements[] = {displacement.along, displacement.turn};
        const P zero = P::broadcast(S(0));
        impulse_sum sum{zero, zero};
        P left;
        if (direct.solve(points, point_count, pass, speeds, displacements, left, sum, displacement_at, speed_at)) {
            direct.solve_landing(points, point_count, pass, speeds, displacements, start_load,
                                 lane_abs(P::load(points[0].moment_arm)), left, sum, displacement_at, speed_at);
            solve_points(speed, sum, [&](int k, const P& v) PHYSICS_HPP_INLINE_LAMBDA {
                return next_impulse(points[k], v, displacement_at(k), pass, left);
            });
        }
        apply(f, sum.load, zero, sum.moment, at_a, at_b);
        if constexpr (Features::restitution)
            if (pass.use_bias && bounces_now) bounce_to.at->template keep_pushed<P>(points, point_count);
        if constexpr (Features::friction) solve_friction(f, pass, at_a, at_b);
        if (!pass.use_bias) {
            add_totals<P>(points, point_count);
            const P impact = max(-speed.along - P::broadcast(pass.impact_speed), -P::load(start_load));
            if (greater(impact, zero).bits() != 0) discard_impacts(bodies, pass, impact);
            load_of<P>(points, point_count).store(start_load);
        }
        if (moves_a) at_a.store(bodies, a);
        if (moves_b) at_b.store(bodies, b);
    }
    /// Notes which points are going to bounce, before anything stops them.
    PHYSICS_HPP_ALWAYS_INLINE void note_approaches(const body* bodies,
                                                   const contact_pass<S, 2>& pass) requires Features::restitution {
        bounces_now = false;
        if (!bounce_to.at->template any_free<P>(points, point_count)) return;
        const frame_lanes f(*this);
        body_lanes<P, 2> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        const relative_motion speed(f, at_a.velocity, at_b.velocity),
            displacement(P::load(last_displacements[0]), P::load(last_displacements[1]));
        bounces_now = bounce_to.at->template note<P>(
            points, point_count, pass, [&](int k) PHYSICS_HPP_INLINE_LAMBDA { return displacement.at(points[k]); },
            [&](int k) PHYSICS_HPP_INLINE_LAMBDA { return speed.at(points[k]); });
    }
    /// Lets bounce what has met in this substep. The next one does not begin with any of that.
    PHYSICS_HPP_NOINLINE void bounce(body* bodies, const contact_pass<S, 2>& pass) requires Features::restitution {
        for (int lane = 0; lane < W; ++lane) {
            if (!bounce_to.at->has(lane, point_count)) continue;
            body& of_a = bodies[a[lane]];
            body& of_b = bodies[b[lane]];
            const vec<S, 2> n{normal[0][lane], normal[1][lane]};
            const vec<S, 2> to_a{r_a[0][lane], r_a[1][lane]}, to_b{r_b[0][lane], r_b[1][lane]};
            S along = dot(n, velocity_at(of_b.velocity, to_b) - velocity_at(of_a.velocity, to_a));
            S turn = of_b.velocity.angular - of_a.velocity.angular, load = S(0), moment = S(0);
            const S share = bounce_points<S>(
                points, point_count, *bounce_to.at, lane,
                [&](int k) { return along + points[k].moment_arm[lane] * turn; },
                [&](int k, S impulse) {
                    const S about = points[k].moment_arm[lane] * impulse;
                    load += impulse;
                    moment += about;
                    along += mul<S>(k_matrix[0][lane], impulse) + mul<S>(k_matrix[1][lane], about);
                    turn += mul<S>(k_matrix[1][lane], impulse) + mul<S>(k_matrix[2][lane], about);
                });
            const vec<S, 2> impulse = n * load;
            if (moves_a) remove_from_start(of_a.velocity, of_a, -impulse, -(cross(to_a, impulse) + moment));
            if (moves_b) remove_from_start(of_b.velocity, of_b, impulse, cross(to_b, impulse) + moment);
            for (int k = 0; k < point_count; ++k) {
                if (!(bounce_to.at->speed[k][lane] > S(0))) continue;
                load += points[k].impulse[lane];
                moment += points[k].moment_arm[lane] * points[k].impulse[lane];
                points[k].impulse[lane] = S(0);
            }
            S lost_friction = S(0);
            if constexpr (Features::friction) lost_friction = reduce_to(friction.impulse[lane], S(1) - share);
            remove_from_next_start(lane, bodies, pass, load, moment, lost_friction);
        }
        load_of<P>(points, point_count).store(start_load);
        bounces_now = false;
    }
    /// Whether a round begins with roll().
    bool rolls(const contact_pass<S, 2>& pass) const requires Features::rolling_resistance {
        return !pass.use_bias && extras.at != nullptr;
    }
    /// Stops the bodies' rolling against each other, or slows it.
    PHYSICS_HPP_ALWAYS_INLINE void roll(body* bodies) requires Features::rolling_resistance {
        body_lanes<P, 2> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        P& w_a = at_a.velocity.angular;
        P& w_b = at_b.velocity.angular;
        const P by = extras.at->next(w_b - w_a, load_of<P>(points, point_count));
        const P arm = extras.at->arm.all(), zero = P::broadcast(S(0));
        w_a = select_greater(arm, zero, w_a - mul<S>(Q::load(inertia_a), by), w_a);
        w_b = select_greater(arm, zero, w_b + mul<S>(Q::load(inertia_b), by), w_b);
        if (moves_a) at_a.store(bodies, a);
        if (moves_b) at_b.store(bodies, b);
    }

private:
    /// The normal, and the levers of impulses along it and along the tangent (y, -x).
    struct frame_lanes {
        P x, y, turn_a, turn_b, slide_a, slide_b;

        PHYSICS_HPP_ALWAYS_INLINE explicit frame_lanes(const soft_contact2& c)
            : x(P::load(c.normal[0])), y(P::load(c.normal[1])) {
            const P ax = P::load(c.r_a[0]), ay = P::load(c.r_a[1]);
            const P bx = P::load(c.r_b[0]), by = P::load(c.r_b[1]);
            turn_a = lane_difference(ax, y, ay, x);
            turn_b = lane_difference(bx, y, by, x);
            slide_a = -lane_sum(ax, x, ay, y);
            slide_b = -lane_sum(bx, x, by, y);
        }
    };
    /// How B moves against A: along the normal at the middle, and turning.
    struct relative_motion {
        P along, turn;

        PHYSICS_HPP_ALWAYS_INLINE relative_motion(const frame_lanes& f, const lane_twist<P, 2>& a,
                                                  const lane_twist<P, 2>& b)
            : along(lane_sum(f.x, b.linear.x - a.linear.x, f.y, b.linear.y - a.linear.y) +
                    lane_difference(f.turn_b, b.angular, f.turn_a, a.angular)),
              turn(b.angular - a.angular) {}
        PHYSICS_HPP_ALWAYS_INLINE relative_motion(const P& along_, const P& turn_) : along(along_), turn(turn_) {}
        PHYSICS_HPP_ALWAYS_INLINE P at(const point& p) const { return along + P::load(p.moment_arm) * turn; }
    };
    PHYSICS_HPP_ALWAYS_INLINE relative_motion displacement_of(const frame_lanes& f, const body_lanes<P, 2>& at_a,
                                                              const body_lanes<P, 2>& at_b,
                                                              const contact_pass<S, 2>& pass) {
        if (pass.use_bias) return {P::load(last_displacements[0]), P::load(last_displacements[1])};
        const relative_motion displacement(f, at_a.displacement, at_b.displacement);
        displacement.along.store(last_displacements[0]);
        displacement.turn.store(last_displacements[1]);
        return displacement;
    }
    /// What impulses along the normal at points come to at the middle.
    struct impulse_sum {
        P load, moment;

        PHYSICS_HPP_ALWAYS_INLINE void add(const point& p, const P& impulse) {
            load = load + impulse;
            moment = moment + P::load(p.moment_arm) * impulse;
        }
    };
    /// Changes impulses point by point, each by the speed that the ones before left.
    template <class Next>
    PHYSICS_HPP_ALWAYS_INLINE void solve_points(const relative_motion& start, impulse_sum& sum, Next&& next) {
        relative_motion speed = start;
        symmetric_gauss_seidel(point_count, [&](int k) PHYSICS_HPP_INLINE_LAMBDA {
            const point& p = points[k];
            const P change = next(k, speed.at(p));
            sum.add(p, change);
            const P moment = P::load(p.moment_arm) * change;
            const Q xx = Q::load(k_matrix[0]), xy = Q::load(k_matrix[1]), yy = Q::load(k_matrix[2]);
            speed.along = speed.along + narrow<S>(product(xx, change) + product(xy, moment));
            speed.turn = speed.turn + narrow<S>(product(xy, change) + product(yy, moment));
        });
    }
    /// After an impact, removes from the start velocities of the next substep all impulse but what was held before it.
    PHYSICS_HPP_NOINLINE void discard_impacts(const body* bodies, const contact_pass<S, 2>& pass, const P& impact) {
        for (int lane = 0; lane < W; ++lane) {
            S load = S(0), lost = S(0), moment = S(0), lost_friction = S(0);
            for (int k = 0; k < point_count; ++k) load += points[k].impulse[lane];
            const S held = max(start_load[lane], S(0));
            if (!(impact.lane(lane) > S(0)) || !(load > held)) continue;
            const S share = held / load;
            for (int k = 0; k < point_count; ++k) {
                const S removed = reduce_to(points[k].impulse[lane], share);
                lost += removed;
                moment += points[k].moment_arm[lane] * removed;
            }
            if constexpr (Features::friction) lost_friction = reduce_to(friction.impulse[lane], share);
            remove_from_next_start(lane, bodies, pass, lost, moment, lost_friction);
        }
    }
    /// Takes impulses of a lane, at the middle and about it, from what the next substep begins with.
    void remove_from_next_start(int lane, const body* bodies, const contact_pass<S, 2>& pass, S load, S moment,
                                S lost_friction) {
        const vec<S, 2> n{normal[0][lane], normal[1][lane]}, impulse = n * load + perpendicular(n) * lost_friction;
        const vec<S, 2> to_a{r_a[0][lane], r_a[1][lane]}, to_b{r_b[0][lane], r_b[1][lane]};
        if (moves_a)
            remove_from_start(pass.start_velocity[a[lane]], bodies[a[lane]], -impulse,
                              -(cross(to_a, impulse) + moment));
        if (moves_b)
            remove_from_start(pass.start_velocity[b[lane]], bodies[b[lane]], impulse, cross(to_b, impulse) + moment);
    }
    /// Stops the slip at the middle, or lets it slide.
    PHYSICS_HPP_ALWAYS_INLINE void solve_friction(const frame_lanes& f, const contact_pass<S, 2>& pass,
                                                  body_lanes<P, 2>& at_a, body_lanes<P, 2>& at_b) {
        const auto& [v_a, w_a] = at_a.velocity;
        const auto& [v_b, w_b] = at_b.velocity;
        P slip =
            lane_difference(f.y, v_b.x - v_a.x, f.x, v_b.y - v_a.y) + lane_difference(f.slide_b, w_b, f.slide_a, w_a);
        if constexpr (Features::surface_velocity)
            if (extras.at != nullptr) slip = slip - P::load(extras.at->along);
        const P change = friction.next(slip, load_of<P>(points, point_count), pass.use_bias);
        apply(f, P::broadcast(S(0)), change, P::broadcast(S(0)), at_a, at_b);
    }
    /// Impulses along the normal and the tangent at the middle, and an angular one, from A on B.
    PHYSICS_HPP_ALWAYS_INLINE void apply(const frame_lanes& f, const P& along, const P& across, const P& moment,
                                         body_lanes<P, 2>& at_a, body_lanes<P, 2>& at_b) const {
        const P x = lane_sum(f.x, along, f.y, across), y = lane_difference(f.y, along, f.x, across);
        const Q m_a = Q::load(mass_a), m_b = Q::load(mass_b);
        auto& [v_a, w_a] = at_a.velocity;
        auto& [v_b, w_b] = at_b.velocity;
        v_a = v_a - lane_vec2<P>{x, y} * m_a;
        v_b = v_b + lane_vec2<P>{x, y} * m_b;
        w_a = w_a - mul<S>(Q::load(inertia_a), lane_sum(f.turn_a, along, f.slide_a, across) + moment);
        w_b = w_b + mul<S>(Q::load(inertia_b), lane_sum(f.turn_b, along, f.slide_b, across) + moment);
    }
};

}  // namespace detail

PHYSICS_HPP_END
