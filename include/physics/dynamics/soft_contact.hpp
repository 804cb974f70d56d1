// The blocks of the soft solver: contacts in lanes, over a frame that says how their bodies move and are pushed.
#pragma once

#include "physics/dynamics/restitution.hpp"
#include "physics/dynamics/soft_friction.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Whether nothing has to be given to any lane of a block when a substep begins, nor be taken back.
template <class P, class Block>
PHYSICS_HPP_ALWAYS_INLINE bool carries_no_impulse(const Block& block) {
    P maximum = load_of<P>(block.points, block.count());
    if constexpr (requires { block.friction.max_impulse(1); })
        maximum = max(maximum, block.friction.max_impulse(block.count()));
    if constexpr (requires { block.extras.at; })
        if (block.extras.at != nullptr) return false;
    return greater(maximum, P::broadcast(typename P::scalar(0))).bits() == 0;
}
/// Gives a body's velocity, or that with which its next substep begins, an impulse and its moment.
template <class S, int D, bool Rotates>
void apply_impulse(twist_of<S, D, Rotates>& velocity, const solver_body<S, D, Rotates>& b,
                   const twist_of<S, D, Rotates>& by) {
    for (int i = 0; i < D; ++i) velocity.linear[i] += mul<S>(b.inverse_mass, by.linear[i]);
    if constexpr (Rotates) velocity.angular += times(b.inverse_inertia, by.angular);
}
/// The change of a point's impulse that its speed along the normal asks for, in lanes that are left to visits (1, else
/// 0).
template <class P, class Point, class Pass, class S = typename P::scalar>
PHYSICS_HPP_ALWAYS_INLINE P next_impulse(Point& point, const P& speed, const P& displacement, const Pass& pass,
                                         const P& left) {
    const P zero = P::broadcast(S(0)), one = P::broadcast(S(1));
    const P gap = P::load(point.separation) + displacement, mass = P::load(point.mass), before = P::load(point.impulse);
    const P closing = gap * P::broadcast(pass.inverse_step);
    P bias = zero, strength = lane_scaled(mass, left), kept = before;
    if (pass.use_bias) {
        bias = max(gap * P::broadcast(pass.spring.rate), P::broadcast(-pass.max_depenetration_speed));
        strength = strength * select_greater(gap, zero, one, P::broadcast(pass.spring.mass_scale));
        kept = before -
               lane_scaled(before, left) * select_greater(gap, zero, zero, P::broadcast(pass.spring.impulse_scale));
    }
    // Once poses have advanced, gaps that nothing has held close are left to the next substep: an approach that is
    // slowed here would bounce with less.
    if (!pass.use_bias) strength = select_greater(zero, gap, strength, select_greater(before, zero, strength, zero));
    const P wanted = select_greater(gap, zero, closing, bias);
    const P impulse = max(kept - strength * (speed + wanted), zero);
    impulse.store(point.impulse);
    return impulse - before;
}
/// Ends a substep: adds the loads of the points to the step's impulses.
template <class P, class Point>
PHYSICS_HPP_ALWAYS_INLINE void add_totals(Point* points, int count) {
    using S = typename P::scalar;
    for (int k = 0; k < count; ++k)
        if constexpr (is_fixed<S>)
            for (int lane = 0; lane < P::width; ++lane)
                points[k].total[lane] = solver_api::added_load(points[k].total[lane], points[k].impulse[lane]);
        else (P::load(points[k].total) + P::load(points[k].impulse)).store(points[k].total);
}

template <class S, int D, int W>
using contact_frame_of = std::conditional_t<D == 2, contact_frame2<S, W>, contact_frame3<S, W>>;
template <class S, int D, int W, class Features, class Friction>
using soft_friction_of = std::conditional_t<
    !Features::friction, no_soft_friction,
    std::conditional_t<D == 2, soft_friction2<S, W, Features>,
                       std::conditional_t<std::is_same_v<Friction, point_friction>,
                                          soft_point_friction3<S, W, Features>, soft_patch_friction3<S, W, Features>>>>;

/// W contacts that push different bodies: what each round does with them. All points of a contact share the normal, so
/// that their speeds follow from those of its frame, in which impulses are solved; bodies are updated once.
template <class Frame, class Features, class Friction>
struct soft_block {
    using S = typename Frame::scalar;
    static constexpr int D = Frame::dimension, W = Frame::width;
    using P = typename Frame::P;
    using vector = typename Frame::vector;
    using point = typename Frame::point;
    using body = solver_body<S, D, Frame::rotates>;
    using pass_type = contact_pass<S, D, Frame::rotates>;
    using twist = twist_of<S, D, Frame::rotates>;
    static constexpr int capacity = Frame::capacity;

    std::uint32_t a[W], b[W];
    Frame frame;
    point points[capacity];
    [[no_unique_address]] typename Frame::direct_solve direct;
    [[no_unique_address]] Friction friction;
    /// What the points bore together as the substep began; less than 0 where they land in it with an impact.
    S start_load[W];
    /// How B has moved against A as of the last round that did not push: the next one that does asks for the same.
    typename Frame::motion_rows last_displacement;
    int point_count = 0;
    /// Whether any point is going to bounce in this substep.
    bool bounces_now = false;
    /// Whether the contacts push their bodies, which is the same for all lanes.
    bool moves_a = false, moves_b = false;
    [[no_unique_address]] extras_of_block<S, W, D, Features> extras;
    // What most rounds do not ask for comes last, and stays out of their caches.
    [[no_unique_address]] typename Frame::k_matrix_type k_matrix;
    [[no_unique_address]] soft_bounces_of<S, capacity, W, Features> bounce_to;

    /// Writes a contact into a lane, but for its points: as it is, to be prepared with its neighbours.
    void put(int lane, const contact<S, D, Features>& c, const body_pair& ends, const body* bodies,
             const prepare_input<S, D, Features>& with, arena& scratch) {
        a[lane] = ends.a;
        b[lane] = ends.b;
        if constexpr (Features::restitution) bounce_to.put(lane, c, ends, with, scratch);
        if constexpr (Features::friction) friction.put(lane, c, with);
        extras.put(lane, c, bodies[ends.a], bodies[ends.b], with, scratch);
    }

    /// Gives the bodies the impulses of the last substep at once.
    PHYSICS_HPP_ALWAYS_INLINE void warm_start(body* bodies) {
        load_of<P>(points, count()).store(start_load);
        if (carries_no_impulse<P>(*this)) return;
        const lanes f(frame);
        typename Frame::bodies at;
        at.load(*this, bodies);
        vector sum = Frame::none();
        for (int k = 0; k < count(); ++k) sum = sum + points[k].at_middle(P::load(points[k].impulse));
        if constexpr (Features::rolling_resistance)
            if (extras.at != nullptr) extras.rolling().add_to(sum);
        if constexpr (Features::friction) f.apply(sum, friction.last(points, count()), at);
        else f.apply(sum, at);
        at.store(*this, bodies);
    }
    /// One round over the contacts: the points at once, or across and back, then friction by their load.
    PHYSICS_HPP_ALWAYS_INLINE void solve(body* bodies, const pass_type& pass) {
        const lanes f(frame);
        typename Frame::bodies at;
        at.load(*this, bodies);
        const vector speed = f.motion(at.a.velocity, at.b.velocity), displacement = displacement_of(f, at, pass);
        const auto displacement_at = [&](int k) PHYSICS_HPP_INLINE_LAMBDA { return points[k].speed(displacement); };
        const auto speed_at = [&](int k) PHYSICS_HPP_INLINE_LAMBDA { return points[k].speed(speed); };
        if (carries_no_impulse<P>(*this) &&
            are_inactive(points, count(), pass, P::broadcast(S(1)), displacement_at, speed_at)) {
            if (!pass.use_bias) P::broadcast(S(0)).store(start_load);
            else if constexpr (Features::restitution) bounces_now = false;
            return;
        }
        vector sum = Frame::none();
        P left;
        if (direct.solve(points, count(), pass, speed, displacement, left, sum, displacement_at, speed_at)) {
            direct.solve_landing(points, count(), pass, speed, displacement, start_load,
                                 Frame::half_width(points, count()), left, sum, displacement_at, speed_at);
            // Each point by the speed that the ones before left.
            vector v = speed;
            symmetric_gauss_seidel(count(), [&](int k) PHYSICS_HPP_INLINE_LAMBDA {
                const vector by =
                    points[k].at_middle(next_impulse(points[k], points[k].speed(v), displacement_at(k), pass, left));
                sum = sum + by;
                v = v + k_matrix * by;
            });
        }
        f.apply(sum, at);
        if constexpr (Features::restitution)
            if (pass.use_bias && bounces_now) bounce_to.at->template keep_pushed<P>(points, count());
        if constexpr (Features::friction)
            if (Frame::slides_with_bias || !pass.use_bias) solve_friction(f, pass, at);
        if (!pass.use_bias) {
            add_totals<P>(points, count());
            const P impact = max(-Frame::along(speed) - P::broadcast(pass.impact_speed), -P::load(start_load));
            if (greater(impact, P::broadcast(S(0))).bits() != 0) discard_impacts(bodies, pass, impact);
            load_of<P>(points, count()).store(start_load);
        }
        at.store(*this, bodies);
    }
    /// Notes which points are going to bounce, before anything stops them.
    PHYSICS_HPP_ALWAYS_INLINE void note_approaches(const body* bodies,
                                                   const pass_type& pass) requires Features::restitution {
        bounces_now = false;
        if (!bounce_to.at->template any_free<P>(points, count())) return;
        const lanes f(frame);
        typename Frame::bodies at;
        at.load(*this, bodies);
        const vector speed = f.motion(at.a.velocity, at.b.velocity), displacement = vector::load(last_displacement);
        bounces_now = bounce_to.at->template note<P>(
            points, count(), pass, [&](int k) PHYSICS_HPP_INLINE_LAMBDA { return points[k].speed(displacement); },
            [&](int k) PHYSICS_HPP_INLINE_LAMBDA { return points[k].speed(speed); });
    }
    /// Lets bounce what has met in this substep. The next one does not begin with any of that.
    PHYSICS_HPP_NOINLINE void bounce(body* bodies, const pass_type& pass) requires Features::restitution {
        for (int lane = 0; lane < W; ++lane) {
            if (!bounce_to.at->has(lane, count())) continue;
            body& of_a = bodies[a[lane]];
            body& of_b = bodies[b[lane]];
            const single f(frame, lane);
            typename Frame::speeds v = f.motion(of_a.velocity, of_b.velocity), sum{};
            const S share = bounce_points<S>(
                points, count(), *bounce_to.at, lane, [&](int k) { return points[k].speed(lane, v); },
                [&](int k, S impulse) {
                    const typename Frame::speeds by = points[k].at_middle(lane, impulse);
                    sum += by;
                    v += k_matrix.times(lane, by);
                });
            push(f, lane, bodies, f.impulse(sum), of_a.velocity, of_b.velocity);
            for (int k = 0; k < count(); ++k) {
                if (!(bounce_to.at->speed[k][lane] > S(0))) continue;
                sum += points[k].at_middle(lane, points[k].impulse[lane]);
                points[k].impulse[lane] = S(0);
            }
            remove_from_next_start(lane, bodies, pass, sum, S(1) - share);
        }
        load_of<P>(points, count()).store(start_load);
        bounces_now = false;
    }
    /// Whether a round begins with roll().
    bool rolls(const pass_type& pass) const requires Features::rolling_resistance {
        return !pass.use_bias && extras.at != nullptr;
    }
    /// Stops the bodies' rolling against each other, or slows it.
    PHYSICS_HPP_ALWAYS_INLINE void roll(body* bodies) requires Features::rolling_resistance {
        const lanes f(frame);
        typename Frame::bodies at;
        at.load(*this, bodies);
        auto& w_a = at.a.velocity.angular;
        auto& w_b = at.b.velocity.angular;
        const auto moment = f.rolling_moment(extras.at->next(f.rolling(w_b - w_a), load_of<P>(points, count())));
        const P arm = extras.at->arm.all(), zero = P::broadcast(S(0));
        w_a = select_greater(arm, zero, w_a - f.spin_a(moment), w_a);
        w_b = select_greater(arm, zero, w_b + f.spin_b(moment), w_b);
        at.store(*this, bodies);
    }

    /// Points that any lane has.
    PHYSICS_HPP_ALWAYS_INLINE int count() const { return capacity == 1 ? 1 : point_count; }

private:
    using lanes = typename Frame::lanes;
    using single = typename Frame::single;

    PHYSICS_HPP_ALWAYS_INLINE vector displacement_of(const lanes& f, const typename Frame::bodies& at,
                                                     const pass_type& pass) {
        if (pass.use_bias) return vector::load(last_displacement);
        const vector displacement = f.motion(at.a.displacement, at.b.displacement);
        displacement.store(last_displacement);
        return displacement;
    }
    /// Stops the slip, or lets it slide.
    PHYSICS_HPP_ALWAYS_INLINE void solve_friction(const lanes& f, const pass_type& pass, typename Frame::bodies& at) {
        auto slip = f.slip(at.a.velocity, at.b.velocity);
        if constexpr (Features::surface_velocity)
            if (extras.at != nullptr) extras.belt().take_from(slip, pass.elapsed);
        f.apply_friction(friction.next(slip, points, count(), pass.use_bias), at);
    }
    /// After an impact, removes from the start velocities of the next substep all impulse but what was held before it.
    PHYSICS_HPP_NOINLINE void discard_impacts(const body* bodies, const pass_type& pass, const P& impact) {
        for (int lane = 0; lane < W; ++lane) {
            S load = S(0), held = max(start_load[lane], S(0));
            for (int k = 0; k < count(); ++k) load += points[k].impulse[lane];
            if (!(impact.lane(lane) > S(0)) || !(load > held)) continue;
            const S share = held / load;
            typename Frame::speeds sum{};
            for (int k = 0; k < count(); ++k)
                sum += points[k].at_middle(lane, reduce_to(points[k].impulse[lane], share));
            remove_from_next_start(lane, bodies, pass, sum, share);
        }
    }
    /// Takes impulses of a lane, and all but a share of its friction, from what the next substep begins with.
    PHYSICS_HPP_NOINLINE void remove_from_next_start(int lane, const body* bodies, const pass_type& pass,
                                                     const typename Frame::speeds& sum, [[maybe_unused]] S share) {
        const single f(frame, lane);
        typename Frame::slide lost{};
        if constexpr (Features::friction) lost = friction.reduce_impulses(lane, points, count(), share);
        push(f, lane, bodies, f.impulse(sum, lost), pass.start_velocity[a[lane]], pass.start_velocity[b[lane]]);
    }
    /// Gives velocities of a lane's bodies what an impulse at the middle comes to.
    void push(const single& f, int lane, const body* bodies, const twist& impulse, twist& of_a, twist& of_b) {
        if (moves_a) apply_impulse(of_a, bodies[a[lane]], f.on_a(impulse));
        if (moves_b) apply_impulse(of_b, bodies[b[lane]], f.on_b(impulse));
    }
};

/// W contacts between bodies that turn.
template <class S, int D, int W, class Features, class Friction = patch_friction>
struct soft_contact : soft_block<contact_frame_of<S, D, W>, Features, soft_friction_of<S, D, W, Features, Friction>> {
    using base = soft_block<contact_frame_of<S, D, W>, Features, soft_friction_of<S, D, W, Features, Friction>>;
    using base::capacity, base::frame, base::points, base::point_count, base::direct, base::friction, base::extras;
    using typename base::body;
    using gathering = contact_gather<S, D, W, Features>;

    /// Writes a contact into a lane: as it is, to be prepared with its neighbours.
    void put(int lane, const contact<S, D, Features>& c, const body_pair& ends, const body* bodies,
             const prepare_input<S, D, Features>& with, gathering& gathered, arena& scratch) {
        gathered.add(lane, c);
        point_count = point_count < c.count ? c.count : point_count;
        for (int k = 0; k < c.count; ++k) points[k].impulse[lane] = c.persisted(k) ? c.points[k].substep_impulse : S(0);
        base::put(lane, c, ends, bodies, with, scratch);
    }
    /// Works out, once all lanes have been written, what the rounds need.
    PHYSICS_HPP_ALWAYS_INLINE void prepare(const body* bodies, gathering& gathered) {
        gathered.read(frame, points, point_count);
        load_inverse_masses(bodies, this->a, frame.mass_a, frame.inertia_a);
        load_inverse_masses(bodies, this->b, frame.mass_b, frame.inertia_b);
        using K = preparing<S, W>;
        const auto c = frame.template prepare<K>();
        const lane_symmetric<K, D> speeds = c.k_matrix();
        speeds.store(this->k_matrix.rows);

        const K zero = K::broadcast(typename K::scalar(0)), count = lanes_from<K>(gathered.count);
        lane_vec<K, D> jacobians[capacity], of_points[capacity];
        K own[capacity], there[capacity];
        for (int k = 0; k < point_count; ++k) {
            const lane_vec<K, D> jacobian = c.jacobian(lane_vec<K, D>::load(gathered.offset[k])),
                                 of = speeds * jacobian;
            jacobians[k] = jacobian;
            of_points[k] = of;
            // Turning only adds to it, whatever rounding says.
            own[k] = max(dot(jacobian, of), c.mass);
            there[k] = lanes_from<K>(gathered.there[k]);
            points[k].put_jacobian(jacobian);
            put_lanes(select_greater(there[k], zero, lane_reciprocal(own[k]), zero), points[k].mass);
        }
        direct.clear();
        // Each writes the lanes that are its own; a single lane is either.
        if (W == 1 ? point_count == 2 : point_count > 1) direct.prepare_edge(points, jacobians, of_points, own, count);
        if constexpr (D == 3)
            if (point_count > 2) direct.prepare_face(points, point_count, jacobians, there, speeds, count);
        if constexpr (Features::friction) friction.prepare(c, points, point_count, count);
    }
    /// Hands the impulses back.
    void store_impulses(int lane, contact<S, D, Features>& c) const {
        S load = S(0);
        for (int k = 0; k < c.count; ++k) load += points[k].total[lane];
        for (int k = 0; k < c.count; ++k) {
            auto& to = c.points[k];
            to.normal_impulse = points[k].total[lane];
            to.substep_impulse = points[k].impulse[lane];
            if constexpr (Features::friction) to.friction_impulse = friction.of_point(lane, k, to.normal_impulse, load);
        }
        if constexpr (Features::friction) friction.store_impulses(lane, c);
        extras.store_impulses(lane, c);
    }
};

}  // namespace detail

PHYSICS_HPP_END
