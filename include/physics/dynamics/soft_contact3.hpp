// Contacts of the soft solver in space, in lanes.
#pragma once

#include "physics/dynamics/soft_contact.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// W contacts that push different bodies. All points of a contact share the normal, so their speeds follow from three
/// numbers: the speed along the normal at the contact's middle, and how fast the bodies turn against each other about
/// both tangents. Friction acts at the middle, and against twisting about the normal.
template <class S, int W, class Features>
struct soft_contact3 {
    using I = inverse_of<S>;
    using P = pack<S, W>;
    using Q = pack<I, W>;
    using body = solver_body<S, 3>;

    struct point : soft_point<S, W, Features::restitution> {
        /// Along both tangents, from the middle (m).
        S x[W], y[W];
    };

    std::uint32_t a[W], b[W];
    S normal[3][W], tangent[3][W];
    /// From the bodies' centres to the middle (m).
    S arm_a[3][W], arm_b[3][W];
    I mass_a[W], mass_b[W], inertia_a[6][W], inertia_b[6][W];
    /// How the three speeds answer to an impulse along the normal and to angular impulses about the tangents.
    I answer[6][W];
    point points[manifold<S, 3>::capacity];
    int point_count = 0;
    /// The largest friction for an impulse of 1, at the middle and, an angular impulse, about the normal (m).
    S friction[W], twist_friction[W];
    /// The impulses that stop a slip: the inverse of the answers along both tangents, and about the normal.
    S stop_xx[W], stop_xy[W], stop_yy[W], slip[W], stop_twist[W];
    S friction_x[W], friction_y[W], twist[W];

    /// Writes a contact into a lane.
    void put(int lane, const contact<S, 3>& c, const body* bodies, S bounce_slop, S h) {
        const body& first = bodies[c.body_a];
        const body& second = bodies[c.body_b];
        const tangents<S, 3> frame(c.normal);
        const contact_point<S, 3> middle = middle_of(c);
        const vec<S, 3> turn_a = cross(middle.lever_a, c.normal), turn_b = cross(middle.lever_b, c.normal);
        a[lane] = c.body_a;
        b[lane] = c.body_b;
        mass_a[lane] = first.inverse_mass;
        mass_b[lane] = second.inverse_mass;
        for (int i = 0; i < 3; ++i) {
            normal[i][lane] = c.normal[i];
            tangent[i][lane] = frame.t[i];
            arm_a[i][lane] = middle.lever_a[i];
            arm_b[i][lane] = middle.lever_b[i];
        }
        put_inertia(lane, first.inverse_inertia, inertia_a);
        put_inertia(lane, second.inverse_inertia, inertia_b);
        const auto both = [&](vec<S, 3> of_a, vec<S, 3> of_b, vec<S, 3> m_a, vec<S, 3> m_b) {
            return torque_answer<S>(first.inverse_inertia, of_a, m_a) +
                   torque_answer<S>(second.inverse_inertia, of_b, m_b);
        };
        answer[0][lane] = first.inverse_mass + second.inverse_mass + both(turn_a, turn_b, turn_a, turn_b);
        answer[1][lane] = both(turn_a, turn_b, frame.t, frame.t);
        answer[2][lane] = both(turn_a, turn_b, frame.u, frame.u);
        answer[3][lane] = both(frame.t, frame.t, frame.t, frame.t);
        answer[4][lane] = both(frame.t, frame.t, frame.u, frame.u);
        answer[5][lane] = both(frame.u, frame.u, frame.u, frame.u);

        point_count = point_count < c.count ? c.count : point_count;
        S reach = S(0), pushed = S(0);
        for (int k = 0; k < c.count; ++k) {
            const contact_point<S, 3>& from = c.points[k];
            const vec<S, 3> offset = from.lever_a - middle.lever_a;
            point& to = points[k];
            to.x[lane] = dot(offset, frame.t);
            to.y[lane] = dot(offset, frame.u);
            to.mass[lane] = effective_mass(first, second, from, c.normal);
            to.separation[lane] = from.separation;
            to.impulse[lane] = from.persisted ? from.normal_impulse : S(0);
            pushed += to.impulse[lane];
            reach += length(vec<S, 2>{to.x[lane], to.y[lane]});
            if constexpr (Features::restitution) to.bounce[lane] = bounce_of(c, from, first, second, bounce_slop, h);
        }
        if constexpr (Features::friction) {
            const friction3<S> stop(first, second, middle, frame);
            friction[lane] = c.friction;
            twist_friction[lane] = c.friction * reach / S(c.count);
            stop_xx[lane] = stop.xx;
            stop_xy[lane] = stop.xy;
            stop_yy[lane] = stop.yy;
            slip[lane] = stop.slip;
            const I twisted = both(c.normal, c.normal, c.normal, c.normal);
            stop_twist[lane] = twisted > I(0) ? reciprocal<S>(twisted) : S(0);
            const vec<S, 2> before = friction_of(c);
            friction_x[lane] = before.x;
            friction_y[lane] = before.y;
            twist[lane] = c.twist_impulse;
        }
    }
    /// Hands the impulses back. Friction is shared as the points share the load.
    void take(int lane, contact<S, 3>& c) const {
        S load = S(0);
        for (int k = 0; k < c.count; ++k) load += points[k].impulse[lane];
        for (int k = 0; k < c.count; ++k) {
            contact_point<S, 3>& to = c.points[k];
            to.normal_impulse = points[k].impulse[lane];
            if constexpr (Features::friction) {
                const S part = load > S(0) ? to.normal_impulse / load : S(0);
                to.friction_impulse = {friction_x[lane] * part, friction_y[lane] * part};
            }
        }
        if constexpr (Features::friction) c.twist_impulse = twist[lane];
    }

    /// Gives the bodies the impulses of the last substep at once.
    void warm_start(body* bodies) const {
        frame_lanes f(*this);
        body_lanes3<P> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        P load = P::broadcast(S(0)), about_t = load, about_u = load;
        for (int k = 0; k < point_count; ++k) add_push(points[k], P::load(points[k].impulse), load, about_t, about_u);
        lanes3<P> impulse = {f.n.x * load, f.n.y * load, f.n.z * load};
        lanes3<P> moment = lane_combine(f.t, about_t, f.u, about_u);
        if constexpr (Features::friction) {
            impulse = lane_add(impulse, lane_combine(f.t, P::load(friction_x), f.u, P::load(friction_y)));
            const P about_n = P::load(twist);
            moment = lane_add(moment, {f.n.x * about_n, f.n.y * about_n, f.n.z * about_n});
        }
        push(f, impulse, moment, at_a, at_b);
        at_a.store(bodies, a);
        at_b.store(bodies, b);
    }

    /// One round over the contacts: friction by the load of the last round, then the points one after the other. While
    /// overlaps are pushed apart friction rests: it would act against what the springs do, and piles would sway.
    void solve(body* bodies, const soft_round<S>& how) {
        frame_lanes f(*this);
        body_lanes3<P> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        if constexpr (Features::friction)
            if (!how.pushes) rub(f, at_a, at_b);
        const relative_motion speed(f, at_a.velocity, at_b.velocity), way(f, at_a.way, at_b.way);
        push_points(f, speed, at_a, at_b, [&](point& p, const P& v) { return next_impulse(p, v, way.at(p), how); });
        at_a.store(bodies, a);
        at_b.store(bodies, b);
    }
    void bounce(body* bodies) requires Features::restitution {
        frame_lanes f(*this);
        body_lanes3<P> at_a, at_b;
        at_a.load(bodies, a);
        at_b.load(bodies, b);
        const relative_motion speed(f, at_a.velocity, at_b.velocity);
        push_points(f, speed, at_a, at_b, [](point& p, const P& v) { return bounce_impulse(p, v); });
        at_a.store(bodies, a);
        at_b.store(bodies, b);
    }

private:
    struct frame_lanes {
        lanes3<P> n, t, u, arm_a, arm_b;

        PHYSICS_HPP_ALWAYS_INLINE explicit frame_lanes(const soft_contact3& c)
            : n(lanes3<P>::load(c.normal)),
              t(lanes3<P>::load(c.tangent)),
              u(lane_cross(n, t)),
              arm_a(lanes3<P>::load(c.arm_a)),
              arm_b(lanes3<P>::load(c.arm_b)) {}
    };
    /// How B moves against A: along the normal at the middle, and about the tangents.
    struct relative_motion {
        P along, about_t, about_u;

        PHYSICS_HPP_ALWAYS_INLINE relative_motion(const frame_lanes& f, const twist_lanes3<P>& a,
                                                  const twist_lanes3<P>& b)
            : along(lane_dot(f.n, at_middle(f, a, b))) {
            const lanes3<P> turn = lane_subtract(b.angular, a.angular);
            about_t = lane_dot(f.t, turn);
            about_u = lane_dot(f.u, turn);
        }
        PHYSICS_HPP_ALWAYS_INLINE P at(const point& p) const {
            return along + lane_difference(P::load(p.y), about_t, P::load(p.x), about_u);
        }
    };
    PHYSICS_HPP_ALWAYS_INLINE static lanes3<P> at_middle(const frame_lanes& f, const twist_lanes3<P>& a,
                                                         const twist_lanes3<P>& b) {
        return lane_subtract(lane_add(b.linear, lane_cross(b.angular, f.arm_b)),
                             lane_add(a.linear, lane_cross(a.angular, f.arm_a)));
    }
    PHYSICS_HPP_ALWAYS_INLINE static void add_push(const point& p, const P& impulse, P& load, P& about_t, P& about_u) {
        load = load + impulse;
        about_t = about_t + P::load(p.y) * impulse;
        about_u = about_u - P::load(p.x) * impulse;
    }
    template <class Next>
    PHYSICS_HPP_ALWAYS_INLINE void push_points(const frame_lanes& f, relative_motion speed, body_lanes3<P>& at_a,
                                               body_lanes3<P>& at_b, Next&& next) {
        P load = P::broadcast(S(0)), about_t = load, about_u = load;
        for (int k = 0; k < point_count; ++k) {
            point& p = points[k];
            const P change = next(p, speed.at(p));
            const P of_t = P::load(p.y) * change, of_u = -(P::load(p.x) * change);
            load = load + change;
            about_t = about_t + of_t;
            about_u = about_u + of_u;
            speed.along = speed.along + answered(0, 1, 2, change, of_t, of_u);
            speed.about_t = speed.about_t + answered(1, 3, 4, change, of_t, of_u);
            speed.about_u = speed.about_u + answered(2, 4, 5, change, of_t, of_u);
        }
        push(f, {f.n.x * load, f.n.y * load, f.n.z * load}, lane_combine(f.t, about_t, f.u, about_u), at_a, at_b);
    }
    PHYSICS_HPP_ALWAYS_INLINE P answered(int i, int j, int k, const P& x, const P& y, const P& z) const {
        return narrow<S>(product(Q::load(answer[i]), x) + product(Q::load(answer[j]), y) +
                         product(Q::load(answer[k]), z));
    }
    /// Stops the slip at the middle, or lets it slide on the cone; then the twist about the normal.
    PHYSICS_HPP_ALWAYS_INLINE void rub(const frame_lanes& f, body_lanes3<P>& at_a, body_lanes3<P>& at_b) {
        P load = P::load(points[0].impulse);
        for (int k = 1; k < point_count; ++k) load = load + P::load(points[k].impulse);
        const lanes3<P> slipping = at_middle(f, at_a.velocity, at_b.velocity);
        const P vx = lane_dot(f.t, slipping), vy = lane_dot(f.u, slipping), xy = P::load(stop_xy);
        const P before_x = P::load(friction_x), before_y = P::load(friction_y), limit = P::load(friction) * load;
        const P stick_x = before_x - lane_sum(P::load(stop_xx), vx, xy, vy);
        const P stick_y = before_y - lane_sum(xy, vx, P::load(stop_yy), vy);
        const P scale = P::load(slip), slide_x = before_x - scale * vx, slide_y = before_y - scale * vy;
        const P sliding = lane_length(slide_x, slide_y), sticking = lane_length(stick_x, stick_y);
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1));
        const P share = select_greater(sliding, limit, limit / select_greater(sliding, zero, sliding, one), one);
        const P x = select_greater(sticking, limit, slide_x * share, stick_x);
        const P y = select_greater(sticking, limit, slide_y * share, stick_y);
        x.store(friction_x);
        y.store(friction_y);
        const P about_n = lane_dot(f.n, lane_subtract(at_b.velocity.angular, at_a.velocity.angular));
        const P before = P::load(twist), most = P::load(twist_friction) * load;
        const P turned = max(min(before - P::load(stop_twist) * about_n, most), -most);
        turned.store(twist);
        const P by = turned - before;
        push(f, lane_combine(f.t, x - before_x, f.u, y - before_y), {f.n.x * by, f.n.y * by, f.n.z * by}, at_a, at_b);
    }
    /// An impulse at the middle and an angular impulse, from A on B.
    PHYSICS_HPP_ALWAYS_INLINE void push(const frame_lanes& f, const lanes3<P>& impulse, const lanes3<P>& moment,
                                        body_lanes3<P>& at_a, body_lanes3<P>& at_b) const {
        const Q m_a = Q::load(mass_a), m_b = Q::load(mass_b);
        auto& [v_a, w_a] = at_a.velocity;
        auto& [v_b, w_b] = at_b.velocity;
        v_a = {v_a.x - mul<S>(m_a, impulse.x), v_a.y - mul<S>(m_a, impulse.y), v_a.z - mul<S>(m_a, impulse.z)};
        v_b = {v_b.x + mul<S>(m_b, impulse.x), v_b.y + mul<S>(m_b, impulse.y), v_b.z + mul<S>(m_b, impulse.z)};
        w_a = lane_subtract(w_a, turned_by(inertia_a, lane_add(lane_cross(f.arm_a, impulse), moment)));
        w_b = lane_add(w_b, turned_by(inertia_b, lane_add(lane_cross(f.arm_b, impulse), moment)));
    }
    PHYSICS_HPP_ALWAYS_INLINE static lanes3<P> turned_by(const I (&inertia)[6][W], const lanes3<P>& moment) {
        const Q xx = Q::load(inertia[0]), yy = Q::load(inertia[1]), zz = Q::load(inertia[2]);
        const Q xy = Q::load(inertia[3]), xz = Q::load(inertia[4]), yz = Q::load(inertia[5]);
        const auto row = [&](const Q& x, const Q& y, const Q& z) {
            return narrow<S>(product(x, moment.x) + product(y, moment.y) + product(z, moment.z));
        };
        return {row(xx, xy, xz), row(xy, yy, yz), row(xz, yz, zz)};
    }
    static void put_inertia(int lane, const symmetric<I>& m, I (&to)[6][W]) {
        const I six[] = {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz};
        for (int i = 0; i < 6; ++i) to[i][lane] = six[i];
    }
};

}  // namespace detail

PHYSICS_HPP_END
