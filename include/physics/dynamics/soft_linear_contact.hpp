// Contacts of the soft solver between bodies that do not turn, in lanes.
#pragma once

#include "physics/dynamics/soft_contact.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Where W contacts are whose bodies do not turn. All points of a contact move alike, with one speed along the normal:
/// the nearest one stands for all of them.
template <class S, int D, int W, bool HasFriction>
struct linear_frame {
    using scalar = S;
    using I = inverse_of<S>;
    using P = kernel_pack<S, W>;
    using Q = kernel_pack<I, W>;
    static constexpr int dimension = D, width = W, capacity = 1;
    static constexpr bool rotates = false;
    using vector = P;
    using space = lane_vec<P, D>;
    using bodies = body_pair_lanes<P, D, false>;
    using motion_rows = S[W];
    using speeds = S;
    struct none_of_it {};
    /// Along the tangents; in 2D in each round (see contact_frame3).
    using slide = std::conditional_t<HasFriction, tangential<S, D>, none_of_it>;
    static constexpr bool slides_with_bias = D == 2;

    struct point {
        S mass[W], separation[W];
        /// Of this substep, after its last round what the next one begins with; and of the whole step.
        S impulse[W], total[W];

        PHYSICS_HPP_ALWAYS_INLINE P speed(const P& v) const { return v; }
        PHYSICS_HPP_ALWAYS_INLINE P at_middle(const P& by) const { return by; }
        S speed(int, S v) const { return v; }
        S at_middle(int, S by) const { return by; }
    };
    /// A single point is visited, and no other asks how that changes its speed.
    struct direct_solve {
        template <class Pass, class At, class SpeedAt>
        PHYSICS_HPP_ALWAYS_INLINE bool solve(const point*, int, const Pass&, const P&, const P&, P& left, P&, const At&,
                                             const SpeedAt&) const {
            left = P::broadcast(S(1));
            return true;
        }
        template <class... Args>
        PHYSICS_HPP_ALWAYS_INLINE void solve_landing(const Args&...) const {}
    };
    struct k_matrix_type {
        PHYSICS_HPP_ALWAYS_INLINE P operator*(const P&) const { return none(); }
        S times(int, S) const { return S(0); }
    };

    S normal[D][W];
    /// The first tangent in 3D, where it takes a root to find; in 2D it follows from the normal.
    struct kept_tangent {
        S kept[3][W];
    };
    [[no_unique_address]] std::conditional_t<HasFriction && D == 3, kept_tangent, none_of_it> tangent;
    I mass_a[W], mass_b[W];

    PHYSICS_HPP_ALWAYS_INLINE static P none() { return P::broadcast(S(0)); }
    PHYSICS_HPP_ALWAYS_INLINE static P along(const P& speed) { return speed; }
    PHYSICS_HPP_ALWAYS_INLINE static P half_width(const point*, int) { return none(); }

    struct lanes {
        const linear_frame& of;
        space n;

        PHYSICS_HPP_ALWAYS_INLINE explicit lanes(const linear_frame& c) : of(c), n(space::load(c.normal)) {}
        PHYSICS_HPP_ALWAYS_INLINE P motion(const space& a, const space& b) const { return dot(n, b - a); }
        PHYSICS_HPP_ALWAYS_INLINE auto slip(const space& a, const space& b) const {
            const space v = b - a;
            if constexpr (D == 2) return dot(first_tangent(), v);
            else return lane_vec2<P>{dot(first_tangent(), v), dot(cross(n, first_tangent()), v)};
        }
        /// Impulses from A on B, along the normal, along the tangents, or both.
        PHYSICS_HPP_ALWAYS_INLINE void apply(const P& load, bodies& at) const { give(n * load, at); }
        template <class Slide>
        PHYSICS_HPP_ALWAYS_INLINE void apply_friction(const Slide& slide, bodies& at) const {
            apply(none(), slide, at);
        }
        PHYSICS_HPP_ALWAYS_INLINE void apply(const P& load, const P& slide, bodies& at) const {
            const space t = first_tangent();
            give({lane_sum(n.x, load, t.x, slide), lane_sum(n.y, load, t.y, slide)}, at);
        }
        PHYSICS_HPP_ALWAYS_INLINE void apply(const P& load, const lane_vec2<P>& slide, bodies& at) const {
            const space t = first_tangent(), u = cross(n, t), by = {load, slide.x, slide.y};
            give({dot({n.x, t.x, u.x}, by), dot({n.y, t.y, u.y}, by), dot({n.z, t.z, u.z}, by)}, at);
        }

    private:
        PHYSICS_HPP_ALWAYS_INLINE space first_tangent() const {
            if constexpr (D == 2) return {n.y, -n.x};
            else return space::load(of.tangent.kept);
        }
        PHYSICS_HPP_ALWAYS_INLINE void give(const space& impulse, bodies& at) const {
            at.a.velocity = at.a.velocity - impulse * Q::load(of.mass_a);
            at.b.velocity = at.b.velocity + impulse * Q::load(of.mass_b);
        }
    };

    /// The frame of one contact.
    struct single {
        vec<S, D> n, t;

        single(const linear_frame& c, int i) {
            for (int k = 0; k < D; ++k) n[k] = c.normal[k][i];
            if constexpr (D == 2) t = perpendicular(n);
            else if constexpr (HasFriction) t = {c.tangent.kept[0][i], c.tangent.kept[1][i], c.tangent.kept[2][i]};
        }
        S motion(const linear_twist<S, D>& a, const linear_twist<S, D>& b) const { return dot(n, b.linear - a.linear); }
        linear_twist<S, D> impulse(S load) const { return {n * load}; }
        linear_twist<S, D> impulse(S load, [[maybe_unused]] const slide& along) const {
            if constexpr (!HasFriction) return impulse(load);
            else if constexpr (D == 2) return {n * load + t * along};
            else return {n * load + t * along.x + cross(n, t) * along.y};
        }
        linear_twist<S, D> on_a(const linear_twist<S, D>& by) const { return {-by.linear}; }
        linear_twist<S, D> on_b(const linear_twist<S, D>& by) const { return by; }
    };
};

/// In 3D, friction where nothing turns: the same mass answers in every direction.
template <class S, int W, class Features>
struct linear_friction3 {
    using P = kernel_pack<S, W>;
    using vector = lane_vec2<P>;

    coefficient_lanes<S, W, Features> coefficient;
    /// Along the tangents; of this substep, and of the whole step.
    S impulse[2][W], total[2][W];

    void put(int lane, const contact<S, 3, Features>& c, const prepare_input<S, 3, Features>& with) {
        coefficient.put(lane, with.surfaces.friction_of(c));
        const vec<S, 2> before = friction_of(c) * with.share;
        for (int i = 0; i < 2; ++i) impulse[i][lane] = before[i];
    }
    /// More than 0 where it holds anything.
    PHYSICS_HPP_ALWAYS_INLINE P max_impulse(int) const {
        return max(lane_abs(P::load(impulse[0])), lane_abs(P::load(impulse[1])));
    }
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE vector last(const Point*, int) const {
        return vector::load(impulse);
    }
    template <class Point>
    vec<S, 2> reduce_impulses(int lane, const Point*, int, S share) {
        return {reduce_to(impulse[0][lane], share), reduce_to(impulse[1][lane], share)};
    }
    template <class Point>
    PHYSICS_HPP_ALWAYS_INLINE vector next(const vector& slip, const Point* points, int, bool) {
        const P maximum = coefficient.all() * P::load(points[0].impulse);
        const vector before = vector::load(impulse);
        vector after = before - slip * P::load(points[0].mass);
        if (lane_is_longer(after.x, after.y, maximum).bits() != 0) {
            const P one = P::broadcast(S(1)), size = length(after);
            after = after * select_greater(size, maximum, maximum / select_greater(size, maximum, size, one), one);
        }
        after.store(impulse);
        (vector::load(total) + after).store(total);
        return after - before;
    }
};

template <class S, int D, int W, class Features>
using linear_friction_of =
    std::conditional_t<!Features::friction, no_soft_friction,
                       std::conditional_t<D == 2, soft_friction2<S, W, Features>, linear_friction3<S, W, Features>>>;

/// W contacts between bodies that do not turn: their points share out evenly what the nearest one bears.
template <class S, int D, int W, class Features>
struct soft_linear_contact
    : soft_block<linear_frame<S, D, W, Features::friction>, Features, linear_friction_of<S, D, W, Features>> {
    using base = soft_block<linear_frame<S, D, W, Features::friction>, Features, linear_friction_of<S, D, W, Features>>;
    using base::frame, base::points, base::friction;
    using typename base::body;
    struct gathering {};

    /// Writes a contact into a lane: as it is, to be prepared with its neighbours.
    void put(int lane, const contact<S, D, Features>& c, const body_pair& ends, const body* bodies,
             const prepare_input<S, D, Features>& with, gathering&, arena& scratch) {
        frame.mass_a[lane] = bodies[ends.a].inverse_mass;
        frame.mass_b[lane] = bodies[ends.b].inverse_mass;
        for (int i = 0; i < D; ++i) frame.normal[i][lane] = c.normal[i];
        int nearest = 0;
        S load = S(0);
        for (int k = 0; k < c.count; ++k) {
            if (c.points[k].separation < c.points[nearest].separation) nearest = k;
            if (c.persisted(k)) load += c.points[k].substep_impulse;
        }
        points[0].separation[lane] = c.points[nearest].separation;
        points[0].impulse[lane] = load;
        base::put(lane, c, ends, bodies, with, scratch);
    }
    /// Works out, once all lanes have been written, what the rounds need.
    PHYSICS_HPP_ALWAYS_INLINE void prepare(const body*, gathering&) {
        using K = preparing<S, W>;
        const K mass = lane_reciprocal(lanes_from<K>(frame.mass_a) + lanes_from<K>(frame.mass_b));
        put_lanes(mass, points[0].mass);
        if constexpr (Features::friction && D == 2) put_lanes(mass, friction.stop);
        if constexpr (Features::friction && D == 3)
            lane_tangent(lane_vec3<K>::load(frame.normal)).store(frame.tangent.kept);
    }
    /// Hands the impulses back.
    void store_impulses(int lane, contact<S, D, Features>& c) const {
        const S share = S(1) / S(int{c.count});
        for (int k = 0; k < c.count; ++k) {
            auto& to = c.points[k];
            to.normal_impulse = points[0].total[lane] * share;
            to.substep_impulse = points[0].impulse[lane] * share;
            if constexpr (Features::friction && D == 2) to.friction_impulse = friction.total[lane] * share;
            if constexpr (Features::friction && D == 3)
                to.friction_impulse = {friction.total[0][lane] * share, friction.total[1][lane] * share};
        }
        if constexpr (Features::friction && D == 2) friction.store_impulses(lane, c);
    }
};

}  // namespace detail

PHYSICS_HPP_END
