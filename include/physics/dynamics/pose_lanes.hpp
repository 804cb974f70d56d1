// Poses of bodies in 3D, advanced in lanes.
#pragma once

#include "physics/base/task_runner.hpp"
#include "physics/dynamics/body_lanes.hpp"
#include "physics/dynamics/turning.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Unit quaternions in lanes; the formulas are those of rotation<S, 3>.
template <class P>
struct rotation_lanes {
    P x, y, z, w;

    [[nodiscard]] PHYSICS_HPP_ALWAYS_INLINE lane_vec3<P> imaginary() const { return {x, y, z}; }
    [[nodiscard]] PHYSICS_HPP_ALWAYS_INLINE rotation_lanes inverse() const { return {-x, -y, -z, w}; }
    /// As norm_lack.
    [[nodiscard]] PHYSICS_HPP_ALWAYS_INLINE P norm_lack() const {
        const P one = P::broadcast(typename P::scalar(1));
        return narrow<typename P::scalar>(product(one, one) - product(w, w) - product(x, x) - product(y, y) -
                                          product(z, z));
    }
};
/// As rotated_as_unit; lack: that of q.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE lane_vec3<P> lane_rotated(const rotation_lanes<P>& q, const P& lack, const lane_vec3<P>& v) {
    const lane_vec3<P> c = cross(q.imaginary(), v);
    const lane_vec3<P> half = c + c * lack, t = half + half;
    return v + (t * q.w + cross(q.imaginary(), t));
}
/// First b, then a.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE rotation_lanes<P> operator*(const rotation_lanes<P>& a, const rotation_lanes<P>& b) {
    const auto sum = [](auto p, auto q, auto r, auto s)
                         PHYSICS_HPP_INLINE_LAMBDA { return narrow<typename P::scalar>(p + q + r + s); };
    return {sum(product(a.w, b.x), product(a.x, b.w), product(a.y, b.z), -product(a.z, b.y)),
            sum(product(a.w, b.y), product(a.y, b.w), product(a.z, b.x), -product(a.x, b.z)),
            sum(product(a.w, b.z), product(a.z, b.w), product(a.x, b.y), -product(a.y, b.x)),
            sum(product(a.w, b.w), -product(a.x, b.x), -product(a.y, b.y), -product(a.z, b.z))};
}

/// How W bodies are turned, and what their spin follows from (see free_spin): moments of 0 are those of bodies whose
/// spin does not change by itself.
template <class S, int W>
struct spin_lanes {
    using I = inverse_of<S>;

    std::uint32_t body[W];
    /// The principal axes of tops, the frames of others; and the former as the step began.
    S axes[4][W], start[4][W];
    S moments[3][W], reach[W];
    I first[W], second[W], third[W];
    /// Of tops: the angular velocity that the last turn has left, and the angular momentum that belongs to it: so that
    /// a momentum that nothing changes is not rounded again in each part of a step.
    S known[3][W], momentum[3][W];
    bool any_gyroscopic;
};

/// What semi_implicit_euler does with the poses of the bodies of a batch, for several at once: nothing but in 3D.
template <class S, int D, bool Rotates>
struct pose_lanes {
    static constexpr bool serves = false;
};
template <class S>
class pose_lanes<S, 3, true> {
    static constexpr int width = native_width<S>;
    /// Smallest number of bodies that makes a task.
    static constexpr std::uint32_t share = 128;
    using P = kernel_pack<S, width>;
    using Q = kernel_pack<inverse_of<S>, width>;
    using block = spin_lanes<S, width>;
    using body = solver_body<S, 3>;

public:
    static constexpr bool serves = true;

    pose_lanes(solver_bodies<S, 3> bodies, moving_body<S, 3>* moving, arena& scratch)
        : bodies_(bodies), moving_(moving), count_((bodies.static_body() + width - 1) / width) {
        blocks_ = scratch.allocate<block>(count_);
        for (std::uint32_t n = 0; n < count_; ++n) {
            block& to = *new (blocks_ + n) block{};
            for (int lane = 0; lane < width; ++lane) put(to, lane, n * width + static_cast<std::uint32_t>(lane));
        }
    }
    /// Advances poses by h; what a spin changes by, it changes in `start_velocity` too.
    void advance(S h, twist<S, 3>* start_velocity, task_runner& tasks) {
        tasks.parallel_for(count_, share / width, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
            for (std::uint32_t n = first; n < end; ++n) advance(blocks_[n], h, start_velocity);
        });
    }
    /// Writes how a body is turned, or with a velocity how it will be after h.
    template <class Pose>
    void find_rotation(std::uint32_t k, Pose& to, const twist<S, 3>* v, S h) const {
        const block& of = blocks_[k / width];
        const int lane = static_cast<int>(k % width);
        const auto* gyroscopic = moving_[k].gyroscopic;
        rotation<S, 3> axes = rotation_of(of.axes, lane);
        if (v != nullptr && gyroscopic) {
            const vec<S, 3> known{of.known[0][lane], of.known[1][lane], of.known[2][lane]};
            vec<S, 3> momentum{of.momentum[0][lane], of.momentum[1][lane], of.momentum[2][lane]};
            vec<S, 3> gain = rotated_as_unit(inverse(rotation_of(of.start, lane)), v->angular - known);
            for (int i = 0; i < 3; ++i) gain[i] = gyroscopic->spin.moments[i] * gain[i];
            momentum += rotated_as_unit(axes, gain);
            turn_gyroscopic(gyroscopic->spin, axes, momentum, h);
        } else if (v != nullptr) {
            axes = physics::turned(axes, v->angular * h);
        }
        to.rotation = axes;
        if (!gyroscopic) return;
        to.is_drawn = true;
        to.turn = axes * inverse(rotation_of(of.start, lane));
        to.rotation = axes * inverse(gyroscopic->spin.axes);
    }
    /// Says how some of the bodies are turned, and how they spin in world axes.
    void finish(std::uint32_t first, std::uint32_t end) {
        for (std::uint32_t k = first; k < end; ++k) {
            const block& of = blocks_[k / width];
            moving_body<S, 3>& b = moving_[k];
            const int lane = static_cast<int>(k % width);
            const rotation<S, 3> axes = rotation_of(of.axes, lane);
            b.rotation = b.gyroscopic ? axes * inverse(b.gyroscopic->spin.axes) : axes;
            if (!b.gyroscopic) continue;
            vec<S, 3>& w = bodies_[k].velocity.angular;
            w = rotated_as_unit(axes, rotated_as_unit(inverse(rotation_of(of.start, lane)), w));
        }
    }

private:
    void put(block& to, int lane, std::uint32_t k) {
        to.body[lane] = k < bodies_.static_body() ? k : bodies_.dummy_body();
        to.axes[3][lane] = S(1);
        if (!(k < bodies_.static_body())) return;
        const moving_body<S, 3>& b = moving_[k];
        set_axes(to, lane, b.gyroscopic ? b.rotation * b.gyroscopic->spin.axes : b.rotation);
        if (!b.gyroscopic) return;
        const free_spin<S, 3>& spin = b.gyroscopic->spin;
        for (int i = 0; i < 3; ++i) to.moments[i][lane] = spin.moments[i];
        to.first[lane] = spin.first;
        to.second[lane] = spin.second;
        to.third[lane] = spin.third;
        to.reach[lane] = spin.reach;
        to.any_gyroscopic = true;
    }
    static rotation<S, 3> rotation_of(const S (&rows)[4][width], int lane) {
        return {rows[0][lane], rows[1][lane], rows[2][lane], rows[3][lane]};
    }
    static void set_axes(block& of, int lane, const rotation<S, 3>& axes) {
        const S four[] = {axes.x, axes.y, axes.z, axes.w};
        for (int i = 0; i < 4; ++i) of.axes[i][lane] = of.start[i][lane] = four[i];
    }
    PHYSICS_HPP_ALWAYS_INLINE static rotation_lanes<P> lanes_of(const S (&rows)[4][width]) {
        return {P::load(rows[0]), P::load(rows[1]), P::load(rows[2]), P::load(rows[3])};
    }

    void advance(block& of, S h, twist<S, 3>* start_velocity) {
        body_lanes<P, 3> at;
        at.load(bodies_.first, of.body);
        const P step = P::broadcast(h);
        lane_vec3<P>& w = at.velocity.angular;
        const lane_vec3<P> before = w, angle = w * step;
        at.displacement = at.displacement + at.velocity * step;
        const rotation_lanes<P> frame = lanes_of(of.axes);
        std::uint32_t far = 0;
        rotation_lanes<P> axes = frame;
        if (of.any_gyroscopic) spin(of, h, frame, axes, w, far);
        else axes = turned(frame, angle, far);
        if (far != 0) turn_far(of, h, far, before, axes, w);
        if (of.any_gyroscopic) w.store(of.known);
        axes.x.store(of.axes[0]);
        axes.y.store(of.axes[1]);
        axes.z.store(of.axes[2]);
        axes.w.store(of.axes[3]);
        at.store_all(bodies_.first, of.body);
        if (!of.any_gyroscopic || start_velocity == nullptr) return;
        const lane_vec3<P> change = w - before;
        for (int lane = 0; lane < width; ++lane)
            if (of.moments[0][lane] > S(0)) start_velocity[of.body[lane]].angular += lane_of(change, lane);
    }
    /// As turn_freely, for tops; others turn by their velocity. During a step the velocities of tops are as seen from
    /// themselves, drawn where they were turned as it began: there contacts' levers and inverse inertias stay true
    /// however far they turn. Else what is light to spin about one axis gains energy as that axis moves away.
    PHYSICS_HPP_ALWAYS_INLINE static void spin(block& of, S h, const rotation_lanes<P>& frame, rotation_lanes<P>& axes,
                                               lane_vec3<P>& w, std::uint32_t& far) {
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1)), half = P::broadcast(h * S(0.5)),
                whole = P::broadcast(h), lack = frame.norm_lack();
        const lane_vec3<P> moments = lane_vec3<P>::load(of.moments);
        const rotation_lanes<P> drawn = lanes_of(of.start);
        const P drawn_lack = drawn.norm_lack();
        const lane_vec3<P> gain = lane_rotated(drawn.inverse(), drawn_lack, w - lane_vec3<P>::load(of.known));
        const lane_vec3<P> momentum =
            lane_vec3<P>::load(of.momentum) +
            lane_rotated(frame, lack, {moments.x * gain.x, moments.y * gain.y, moments.z * gain.z});
        momentum.store(of.momentum);
        const Q first = Q::load(of.first), second = Q::load(of.second), third = Q::load(of.third);
        lane_vec3<P> seen = lane_rotated(frame.inverse(), lack, momentum);
        turn_about(axes.y, axes.z, axes.x, axes.w, seen.z, seen.x, mul<S>(second, seen.y) * half, far);
        turn_about(axes.z, axes.x, axes.y, axes.w, seen.x, seen.y, mul<S>(third, seen.z) * whole, far);
        turn_about(axes.y, axes.z, axes.x, axes.w, seen.z, seen.x, mul<S>(second, seen.y) * half, far);
        const P largest = max(max(lane_abs(momentum.x), lane_abs(momentum.y)), lane_abs(momentum.z));
        far |= greater(largest * whole, P::load(of.reach)).bits();
        const auto of_gyroscopic = [&](const P& then, const P& otherwise) PHYSICS_HPP_INLINE_LAMBDA {
            return select_greater(moments.x, zero, then, otherwise);
        };
        const rotation_lanes<P> start{of_gyroscopic(axes.x, frame.x), of_gyroscopic(axes.y, frame.y),
                                      of_gyroscopic(axes.z, frame.z), of_gyroscopic(axes.w, frame.w)};
        const lane_vec3<P> turning = select_greater(moments.x, zero, momentum * first, w);
        axes = turned(start, turning * whole, far);
        // Momentum as it was, not as the turns have rounded it; and quotients, which undo the products: a factor that
        // is an ulp off would act in every step.
        const P left = axes.norm_lack();
        const lane_vec3<P> kept = lane_rotated(axes.inverse(), left, momentum);
        const lane_vec3<P> spinning = {kept.x / of_gyroscopic(moments.x, one), kept.y / of_gyroscopic(moments.y, one),
                                       kept.z / of_gyroscopic(moments.z, one)};
        w = select_greater(moments.x, zero, lane_rotated(drawn, drawn_lack, spinning), w);
    }
    /// Lanes that turn so far that it takes trigonometry or several turns: anew, one by one.
    PHYSICS_HPP_COLD void turn_far(const block& of, S h, std::uint32_t far, const lane_vec3<P>& before,
                                   rotation_lanes<P>& axes, lane_vec3<P>& w) const {
        for (int lane = 0; lane < width; ++lane) {
            if ((far >> lane & 1) == 0 || of.body[lane] == bodies_.dummy_body()) continue;
            const auto* gyroscopic = moving_[of.body[lane]].gyroscopic;
            vec<S, 3> v = lane_of(before, lane);
            rotation<S, 3> now = rotation_of(of.axes, lane);
            if (gyroscopic) {
                v = turn_gyroscopic(gyroscopic->spin, now,
                                    {of.momentum[0][lane], of.momentum[1][lane], of.momentum[2][lane]}, h);
                v = rotated_as_unit(rotation_of(of.start, lane), rotated_as_unit(inverse(now), v));
            } else now = physics::turned(now, v * h);
            axes.x.set_lane(lane, now.x);
            axes.y.set_lane(lane, now.y);
            axes.z.set_lane(lane, now.z);
            axes.w.set_lane(lane, now.w);
            w.x.set_lane(lane, v.x);
            w.y.set_lane(lane, v.y);
            w.z.set_lane(lane, v.z);
        }
    }

    static vec<S, 3> lane_of(const lane_vec3<P>& v, int lane) {
        return {v.x.lane(lane), v.y.lane(lane), v.z.lane(lane)};
    }
    /// In fixed point, puts the angles of far lanes in range: their turns are made anew, and these must not overflow.
    PHYSICS_HPP_ALWAYS_INLINE static P near(const P& quarter) {
        if constexpr (std::floating_point<S>) return quarter;
        else {
            const P maximum = P::broadcast(S(0.5));
            return max(min(quarter, maximum), -maximum);
        }
    }
    PHYSICS_HPP_ALWAYS_INLINE static P tangent_ratio_of(const P& xx) {
        P sum = P::broadcast(S(62.0 / 2835));
        for (const double term : {17.0 / 315, 2.0 / 15, 1.0 / 3, 1.0}) sum = P::broadcast(S(term)) + xx * sum;
        return sum;
    }
    /// As axis_turn, about the axis q of a frame (q, i, j, w), of which the seen (u, v) turn back.
    PHYSICS_HPP_ALWAYS_INLINE static void turn_about(P& q, P& i, P& j, P& w, P& u, P& v, const P& angle,
                                                     std::uint32_t& far) {
        const P one = P::broadcast(S(1)), given = angle * P::broadcast(S(0.25));
        far |= greater(lane_abs(given), P::broadcast(S(0.25))).bits();
        const P quarter = near(given), t = quarter * tangent_ratio_of(quarter * quarter);
        const P tt = t * t, scale = one / (one + tt);
        // One minus the cosine: what is added to numbers is small then, and rounds them once.
        const P sine = (t + t) * scale, less = (tt + tt) * scale;
        const P new_q = q + lane_difference(w, sine, q, less), new_w = w - lane_sum(w, less, q, sine);
        const P new_i = i + lane_difference(j, sine, i, less), new_j = j - lane_sum(j, less, i, sine);
        const P twice = sine + sine, back = twice - twice * less, off = twice * sine;
        const P new_u = u + lane_difference(v, back, u, off), new_v = v - lane_sum(v, off, u, back);
        q = new_q;
        w = new_w;
        i = new_i;
        j = new_j;
        u = new_u;
        v = new_v;
    }
    /// As turned(a, angle).
    PHYSICS_HPP_ALWAYS_INLINE static rotation_lanes<P> turned(const rotation_lanes<P>& a, const lane_vec3<P>& angle,
                                                              std::uint32_t& far) {
        const P one = P::broadcast(S(1));
        const lane_vec3<P> given = angle * P::broadcast(S(0.25));
        const P largest = max(lane_abs(given.x), max(lane_abs(given.y), lane_abs(given.z)));
        const lane_vec3<P> quarter = {near(given.x), near(given.y), near(given.z)};
        const P xx = dot(quarter, quarter);
        far |= (greater(largest, P::broadcast(S(0.25))) | greater(xx, P::broadcast(S(0.0625)))).bits();
        const lane_vec3<P> t = quarter * tangent_ratio_of(xx);
        const P tt = dot(t, t), scale = one / (one + tt);
        const lane_vec3<P> v = t * (scale + scale);
        const rotation_lanes<P> change = rotation_lanes<P>{v.x, v.y, v.z, -((tt + tt) * scale)} * a;
        const rotation_lanes<P> r{a.x + change.x, a.y + change.y, a.z + change.z, a.w + change.w};
        const P lack = r.norm_lack() * P::broadcast(S(0.5));
        return {r.x + r.x * lack, r.y + r.y * lack, r.z + r.z * lack, r.w + r.w * lack};
    }

    solver_bodies<S, 3> bodies_;
    moving_body<S, 3>* moving_;
    std::uint32_t count_;
    block* blocks_;
};

}  // namespace detail

PHYSICS_HPP_END
