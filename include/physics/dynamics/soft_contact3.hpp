// Contacts of the soft solver in 3D, in lanes.
#pragma once

#include "physics/dynamics/contact_frame3.hpp"
#include "physics/dynamics/soft_contact.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// W contacts that push different bodies. All points of a contact share the normal, so their speeds follow from three
/// numbers: the speed along the normal at the contact's middle, and how fast the bodies turn against each other about
/// both tangents. Friction follows from three more: the slip at the middle, and the twist about the normal.
template <class S, int W, class Features, class Friction = patch_friction>
struct soft_contact3 {
    using I = inverse_of<S>;
    using P = kernel_pack<S, W>;
    using Q = kernel_pack<I, W>;
    using body = solver_body<S, 3>;
    using gathering = contact_gather<S, 3, W, Features>;

    struct point : soft_point<S, 3, W> {
        /// Along both tangents, from the middle (m).
        S x[W], y[W];
    };

    std::uint32_t a[W], b[W];
    S normal[3][W], tangent[3][W];
    [[no_unique_address]] second_tangent_of<S, W> across;
    /// From the bodies' centres to the middle, on either surface (m).
    S r_a[3][W], r_b[3][W];
    I mass_a[W], mass_b[W], inertia_a[6][W], inertia_b[6][W];
    static constexpr int capacity = manifold<S, 3>::capacity;
    point points[capacity];
    block_solve<S, 3, W> direct;
    [[no_unique_address]] soft_friction3_of<S, W, Features, Friction> friction;
    /// What the points bore together as the substep began; less than 0 where they land in it with an impact.
    S start_load[W];
    /// How B has moved against A as of the last round that did not push: the next one that does asks for the same.
    S last_displacements[3][W];
    int point_count = 0;
    /// Whether any point is going to bounce in this substep.
    bool bounces_now = false;
    /// Whether the contacts push their bodies, which is the same for all lanes.
    bool moves_a = false, moves_b = false;
    [[no_unique_address]] extras_of_block<S, W, 3, Features> extras;
    // What most rounds do not ask for comes last, and stays out of their caches.
    /// How the three speeds answer to an impulse at the middle and to angular ones: xx, yy, zz, xy, xz, yz.
    I k_matrix[6][W];
    [[no_unique_address]] soft_bounces_of<S, capacity, W, Features> bounce_to;

    /// Writes a contact into a lane: as it is, to be prepared with its neighbours.
    void put(int lane, const contact<S, 3, Features>& c, const body_pair& ends, const body* bodies,
             const prepare_input<S, 3, Features>& with, gathering& gathered, arena& scratch) {
        const body& first = bodies[ends.a];
        const body& second = bodies[ends.b];
        a[lane] = ends.a;
        b[lane] = ends.b;
        gathered.add(lane, c);
        point_count = point_count < c.count ? c.count : point_count;
        for (int k = 0; k < c.count; ++k) points[k].impulse[lane] = c.persisted(k) ? c.points[k].substep_impulse : S(0);
        if constexpr (Features::restitution) bounce_to.put(lane, c, ends, with, scratch);
        if constexpr (Features::friction) friction.put(lane, c, with);
        extras.put(lane, c, first, second, with, scratch);
    }
    /// Works out, once all lanes have been written, what the rounds need.
    PHYSICS_HPP_ALWAYS_INLINE void prepare(const body* bodies, gathering& gathered) {
        gathered.read(*this, point_count);
        load_inverse_masses(bodies, a, mass_a, inertia_a);
        load_inverse_masses(bodies, b, mass_b, inertia_b);
        using K = preparing<S, W>;
        const lane_vec3<K> n = lane_vec3<K>::load(normal), t = lane_tangent(n);
        const contact_lanes3<K> c = {n,
                                     t,
                                     cross(n, t),
                                     lane_vec3<K>::load(r_a),
                                     lane_vec3<K>::load(r_b),
                                     lanes_from<K>(mass_a) + lanes_from<K>(mass_b),
                                     lane_symmetric<K, 3>::load(inertia_a),
                                     lane_symmetric<K, 3>::load(inertia_b)};
        t.store(tangent);
        across.prepare(normal, tangent);
        // How the three speeds answer to an impulse at the middle and to angular ones about the tangents.
        const lane_vec3<K> turn_a = cross(c.r_a, n), turn_b = cross(c.r_b, n);
        const lane_vec3<K> by_a = c.inertia_a * turn_a, by_b = c.inertia_b * turn_b;
        const lane_symmetric<K, 3> inertia = c.inertia_a + c.inertia_b;
        const lane_vec3<K> by_n = by_a + by_b, by_t = inertia * t, by_u = inertia * c.u;
        const lane_symmetric<K, 3> speeds = {c.mass + dot(turn_a, by_a) + dot(turn_b, by_b),
                                             dot(t, by_t),
                                             dot(c.u, by_u),
                                             dot(t, by_n),
                                             dot(c.u, by_n),
                                             dot(c.u, by_t)};

        speeds.store(k_matrix);

        using C = typename K::scalar;
        const K zero = K::broadcast(C(0));
        K jacobians[capacity][3], of_points[capacity][3], own[capacity], there[capacity];
        for (int k = 0; k < point_count; ++k) {
            const lane_vec3<K> offset = lane_vec3<K>::load(gathered.offset[k]);
            const K x = dot(offset, t), y = dot(offset, c.u);
            const lane_vec3<K> of = speeds * lane_vec3<K>{K::broadcast(C(1)), y, -x};
            jacobians[k][0] = K::broadcast(C(1));
            jacobians[k][1] = y;
            jacobians[k][2] = -x;
            of_points[k][0] = of.x;
            of_points[k][1] = of.y;
            of_points[k][2] = of.z;
            // Turning only adds to it, whatever rounding says.
            own[k] = max(of.x + y * of.y - x * of.z, c.mass);
            there[k] = lanes_from<K>(gathered.there[k]);
            point& to = points[k];
            put_lanes(x, to.x);
            put_lanes(y, to.y);
            put_lanes(select_greater(there[k], zero, lane_reciprocal(own[k]), zero), to.mass);
        }
        direct.clear();
        const K count = lanes_from<K>(gathered.count);
        // Each writes the lanes that are its own; a single lane is either.
        if (W == 1 ? point_count == 2 : point_count > 1) direct.prepare_edge(points, jacobians, of_points, own, count);
        if (point_count > 2) direct.prepare_face(points, point_count, jacobians, there, speeds, count);
        if constexpr (Features::friction) friction.prepare(c, points, point_count, count);
    }
    /// Hands the impulses back.
    void store_impulses(int lane, contact<S, 3, Features>& c) const {
        S load = S(0);
        for (int k = 0; k < c.count; ++k) load += points[k].total[lane];
        for (int k = 0; k < c.count; ++k) {
            auto& to = c.points[k];
            to.normal_impulse = points[k].total[lane];
            to.substep_impulse = points[k].impulse[lane];
            if constexpr (Features::friction)
                to.friction_impulse = friction.of_point(lane, k, load > S(0) ? to.normal_impulse / load : S(0));
        }
        if constexpr (Features::friction) c.twist_impulse = friction.about_normal(lane);
        extras.store_impulses(lane, c);
    }

    /// Gives the bodies the impulses of the last substep at once.
    PHYSICS_HPP_ALWAYS_INLINE void warm_start(body* bodies) {
        load_of<P>(points, point_count).store(start_load);
        if (carries_no_impulse<P>(*this)) return;
        frame_lanes f(*this);
        body_lanes<P, 3> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        const P zero = P::broadcast(S(0));
        impulse_sum sum{zero, zero, zero};
        for (int k = 0; k < point_count; ++k) sum.add(points[k], P::load(points[k].impulse));
        if constexpr (Features::rolling_resistance) {
            if (extras.at != nullptr) {
                sum.about_t = sum.about_t + P::load(extras.rolling().impulse[0]);
                sum.about_u = sum.about_u + P::load(extras.rolling().impulse[1]);
            }
        }
        lane_vec3<P> impulse = f.n * sum.load, moment = combine(f.t, sum.about_t, f.u, sum.about_u);
        if constexpr (Features::friction) {
            const lane_vec3<P> last = friction.last(points, point_count);
            impulse = impulse + combine(f.t, last.x, f.u, last.y);
            moment = moment + f.n * last.z;
        }
        apply(f, impulse, moment, at_a, at_b);
        if (moves_a) at_a.store(bodies, a);
        if (moves_b) at_b.store(bodies, b);
    }

    /// One round over the contacts: the points at once, or across and back, then friction by their load. While overlaps
    /// are pushed apart friction rests: else boxes that stand on four others sway, and piles of them slide apart.
    PHYSICS_HPP_ALWAYS_INLINE void solve(body* bodies, const contact_pass<S, 3>& pass) {
        frame_lanes f(*this);
        body_lanes<P, 3> at_a, at_b;
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
        const P speeds[] = {speed.along, speed.about_t, speed.about_u};
        const P displacements[] = {displacement.along, displacement.about_t, displacement.about_u};
        P zero = P::broadcast(S(0)), left;
        impulse_sum sum{zero, zero, zero};
        if (direct.solve(points, point_count, pass, speeds, displacements, left, sum, displacement_at, speed_at)) {
            direct.solve_landing(points, point_count, pass, speeds, displacements, start_load,
                                 half_width_of<P>(points, point_count), left, sum, displacement_at, speed_at);
            solve_points(speed, sum, [&](int k, const P& v) PHYSICS_HPP_INLINE_LAMBDA {
                return next_impulse(points[k], v, displacement_at(k), pass, left);
            });
        }
        apply(f, sum, at_a, at_b);
        if constexpr (Features::restitution)
            if (pass.use_bias && bounces_now) bounce_to.at->template keep_pushed<P>(points, point_count);
        if (!pass.use_bias) {
            if constexpr (Features::friction) solve_friction(f, at_a, at_b);
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
                                                   const contact_pass<S, 3>& pass) requires Features::restitution {
        bounces_now = false;
        if (!bounce_to.at->template any_free<P>(points, point_count)) return;
        const frame_lanes f(*this);
        body_lanes<P, 3> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        const relative_motion speed(f, at_a.velocity, at_b.velocity),
            displacement(lane_vec3<P>::load(last_displacements));
        bounces_now = bounce_to.at->template note<P>(
            points, point_count, pass, [&](int k) PHYSICS_HPP_INLINE_LAMBDA { return displacement.at(points[k]); },
            [&](int k) PHYSICS_HPP_INLINE_LAMBDA { return speed.at(points[k]); });
    }
    /// Lets bounce what has met in this substep. The next one does not begin with any of that.
    PHYSICS_HPP_NOINLINE void bounce(body* bodies, const contact_pass<S, 3>& pass) requires Features::restitution {
        for (int lane = 0; lane < W; ++lane) {
            if (!bounce_to.at->has(lane, point_count)) continue;
            body& of_a = bodies[a[lane]];
            body& of_b = bodies[b[lane]];
            const auto at = [&](const auto& rows) { return vec<S, 3>{rows[0][lane], rows[1][lane], rows[2][lane]}; };
            const vec<S, 3> n = at(normal), t = at(tangent), u = cross(n, t), to_a = at(r_a), to_b = at(r_b);
            const vec<S, 3> spin = of_b.velocity.angular - of_a.velocity.angular;
            // Along the normal at the middle, and about the tangents.
            vec<S, 3> v{dot(n, velocity_at(of_b.velocity, to_b) - velocity_at(of_a.velocity, to_a)), dot(t, spin),
                        dot(u, spin)};
            vec<S, 3> sum;
            const auto impulses_of = [&](int k, S impulse) {
                return vec<S, 3>{impulse, points[k].y[lane] * impulse, -(points[k].x[lane] * impulse)};
            };
            const S share = bounce_points<S>(
                points, point_count, *bounce_to.at, lane,
                [&](int k) { return v.x + difference_of_products(points[k].y[lane], v.y, points[k].x[lane], v.z); },
                [&](int k, S impulse) {
                    const vec<S, 3> by = impulses_of(k, impulse);
                    sum += by;
                    constexpr int row[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
                    for (int i = 0; i < 3; ++i)
                        v[i] += mul<S>(k_matrix[row[i][0]][lane], by.x) + mul<S>(k_matrix[row[i][1]][lane], by.y) +
                                mul<S>(k_matrix[row[i][2]][lane], by.z);
                });
            const vec<S, 3> impulse = n * sum.x, moment = t * sum.y + u * sum.z;
            if (moves_a) remove_from_start(of_a.velocity, of_a, -impulse, -(cross(to_a, impulse) + moment));
            if (moves_b) remove_from_start(of_b.velocity, of_b, impulse, cross(to_b, impulse) + moment);
            for (int k = 0; k < point_count; ++k) {
                if (!(bounce_to.at->speed[k][lane] > S(0))) continue;
                sum += impulses_of(k, points[k].impulse[lane]);
                points[k].impulse[lane] = S(0);
            }
            vec<S, 3> lost_friction;
            if constexpr (Features::friction)
                lost_friction = friction.reduce_impulses(lane, points, point_count, S(1) - share);
            remove_from_next_start(lane, bodies, pass, sum, lost_friction);
        }
        load_of<P>(points, point_count).store(start_load);
        bounces_now = false;
    }
    /// Whether a round begins with roll().
    bool rolls(const contact_pass<S, 3>& pass) const requires Features::rolling_resistance {
        return !pass.use_bias && extras.at != nullptr;
    }
    /// Stops the bodies' rolling against each other, or slows it.
    PHYSICS_HPP_ALWAYS_INLINE void roll(body* bodies) requires Features::rolling_resistance {
        const frame_lanes f(*this);
        body_lanes<P, 3> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        const lane_vec3<P> turning = at_b.velocity.angular - at_a.velocity.angular;
        const lane_vec2<P> rolling = {dot(f.t, turning), dot(f.u, turning)};
        const lane_vec2<P> by = extras.at->next(rolling, load_of<P>(points, point_count));
        const lane_vec3<P> moment = combine(f.t, by.x, f.u, by.y);
        const P arm = extras.at->arm.all(), zero = P::broadcast(S(0));
        lane_vec3<P>& w_a = at_a.velocity.angular;
        lane_vec3<P>& w_b = at_b.velocity.angular;
        w_a = select_greater(arm, zero, w_a - matrix::load(inertia_a) * moment, w_a);
        w_b = select_greater(arm, zero, w_b + matrix::load(inertia_b) * moment, w_b);
        if (moves_a) at_a.store(bodies, a);
        if (moves_b) at_b.store(bodies, b);
    }

private:
    using frame_lanes = contact_frame3<P>;
    using relative_motion = contact_motion3<P>;
    using impulse_sum = contact_impulse3<P>;
    using matrix = lane_symmetric<Q, 3>;

    PHYSICS_HPP_ALWAYS_INLINE relative_motion displacement_of(const frame_lanes& f, const body_lanes<P, 3>& at_a,
                                                              const body_lanes<P, 3>& at_b,
                                                              const contact_pass<S, 3>& pass) {
        if (pass.use_bias) return relative_motion(lane_vec3<P>::load(last_displacements));
        const relative_motion displacement(f, at_a.displacement, at_b.displacement);
        displacement.along.store(last_displacements[0]);
        displacement.about_t.store(last_displacements[1]);
        displacement.about_u.store(last_displacements[2]);
        return displacement;
    }
    /// Changes impulses point by point, each by the speed that the ones before left.
    template <class Next>
    PHYSICS_HPP_ALWAYS_INLINE void solve_points(const relative_motion& start, impulse_sum& sum, Next&& next) {
        relative_motion speed = start;
        symmetric_gauss_seidel(point_count, [&](int k) PHYSICS_HPP_INLINE_LAMBDA {
            const point& p = points[k];
            const P change = next(k, speed.at(p));
            sum.add(p, change);
            const lane_vec3<P> by =
                matrix::load(k_matrix) * lane_vec3<P>{change, P::load(p.y) * change, -(P::load(p.x) * change)};
            speed.along = speed.along + by.x;
            speed.about_t = speed.about_t + by.y;
            speed.about_u = speed.about_u + by.z;
        });
    }
    /// After an impact, removes from the start velocities of the next substep all impulse but what was held before it.
    PHYSICS_HPP_NOINLINE void discard_impacts(const body* bodies, const contact_pass<S, 3>& pass, const P& impact) {
        for (int lane = 0; lane < W; ++lane) {
            S load = S(0), held = max(start_load[lane], S(0));
            for (int k = 0; k < point_count; ++k) load += points[k].impulse[lane];
            if (!(impact.lane(lane) > S(0)) || !(load > held)) continue;
            const S share = held / load;
            vec<S, 3> sum;
            for (int k = 0; k < point_count; ++k) {
                const S removed = reduce_to(points[k].impulse[lane], share);
                sum += vec<S, 3>{removed, points[k].y[lane] * removed, -(points[k].x[lane] * removed)};
            }
            vec<S, 3> lost_friction;
            if constexpr (Features::friction)
                lost_friction = friction.reduce_impulses(lane, points, point_count, share);
            remove_from_next_start(lane, bodies, pass, sum, lost_friction);
        }
    }
    /// Takes impulses of a lane, along the normal at the middle and about the tangents, and friction, from what the
    /// next substep begins with.
    void remove_from_next_start(int lane, const body* bodies, const contact_pass<S, 3>& pass, const vec<S, 3>& sum,
                                const vec<S, 3>& lost_friction) {
        const auto at = [&](const auto& rows) { return vec<S, 3>{rows[0][lane], rows[1][lane], rows[2][lane]}; };
        const vec<S, 3> n = at(normal), t = at(tangent), u = cross(n, t);
        const vec<S, 3> impulse = n * sum.x + t * lost_friction.x + u * lost_friction.y;
        const vec<S, 3> moment = t * sum.y + u * sum.z + n * lost_friction.z;
        if (moves_a)
            remove_from_start(pass.start_velocity[a[lane]], bodies[a[lane]], -impulse,
                              -(cross(at(r_a), impulse) + moment));
        if (moves_b)
            remove_from_start(pass.start_velocity[b[lane]], bodies[b[lane]], impulse, cross(at(r_b), impulse) + moment);
    }
    /// Stops the slip, or lets it slide on the cone.
    PHYSICS_HPP_ALWAYS_INLINE void solve_friction(const frame_lanes& f, body_lanes<P, 3>& at_a,
                                                  body_lanes<P, 3>& at_b) {
        const lane_vec3<P> slipping = f.at_middle(at_a.velocity, at_b.velocity);
        lane_vec3<P> slip = {dot(f.t, slipping), dot(f.u, slipping),
                             dot(f.n, at_b.velocity.angular - at_a.velocity.angular)};
        if constexpr (Features::surface_velocity) {
            if (extras.at != nullptr) {
                slip.x = slip.x - P::load(extras.belt().x);
                slip.y = slip.y - P::load(extras.belt().y);
            }
        }
        const lane_vec3<P> by = friction.next(slip, points, point_count);
        apply(f, combine(f.t, by.x, f.u, by.y), f.n * by.z, at_a, at_b);
    }
    PHYSICS_HPP_ALWAYS_INLINE void apply(const frame_lanes& f, const impulse_sum& sum, body_lanes<P, 3>& at_a,
                                         body_lanes<P, 3>& at_b) const {
        apply(f, f.n * sum.load, combine(f.t, sum.about_t, f.u, sum.about_u), at_a, at_b);
    }
    /// An impulse at the middle and an angular impulse, from A on B.
    PHYSICS_HPP_ALWAYS_INLINE void apply(const frame_lanes& f, const lane_vec3<P>& impulse, const lane_vec3<P>& moment,
                                         body_lanes<P, 3>& at_a, body_lanes<P, 3>& at_b) const {
        const Q m_a = Q::load(mass_a), m_b = Q::load(mass_b);
        auto& [v_a, w_a] = at_a.velocity;
        auto& [v_b, w_b] = at_b.velocity;
        v_a = v_a - impulse * m_a;
        v_b = v_b + impulse * m_b;
        w_a = w_a - matrix::load(inertia_a) * (cross(f.r_a, impulse) + moment);
        w_b = w_b + matrix::load(inertia_b) * (cross(f.r_b, impulse) + moment);
    }
};

}  // namespace detail

PHYSICS_HPP_END
