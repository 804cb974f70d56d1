// Rows of joints that hold points to each other, written in lanes.
#pragma once

#include "physics/dynamics/joint_rows.hpp"
#include "physics/dynamics/lane_vec.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Rotations in lanes: cosine and sine, or x, y, z, w.
template <class P, int D>
struct turned_lanes {
    P at[D == 2 ? 2 : 4];

    /// As rotation * vec.
    PHYSICS_HPP_ALWAYS_INLINE lane_vec<P, D> operator*(const lane_vec<P, D>& v) const {
        if constexpr (D == 2) {
            return {lane_difference(at[0], v.x, at[1], v.y), lane_sum(at[1], v.x, at[0], v.y)};
        } else {
            const lane_vec3<P> q{at[0], at[1], at[2]}, half = cross(q, v), t = half + half;
            return v + t * at[3] + cross(q, t);
        }
    }
};

/// W joints of which only the rows are on that hold a point of B to one of A: what joint_frames::hold says of them, in
/// lanes. Those rows have the same directions, bounds and stiffness wherever bodies are: once written in a step, only
/// their levers and errors change.
template <class S, int D, bool Rotates, int W>
class point_lanes {
    using P = kernel_pack<S, W>;
    using V = lane_vec<P, D>;
    using side = pushed_lanes<S, D, Rotates, W>;
    using pose = joint_pose<S, D, Rotates>;
    static constexpr int R = D == 2 ? 2 : 4;

public:
    void put(int lane, const joint_frames<S, D>& start, const point_pair<S, D>& points) {
        const vec<S, D> from_a = points.a - start.center_a, from_b = points.b - start.center_b;
        start_a_[lane] = start.rotation_a;
        start_b_[lane] = start.rotation_b;
        for (int i = 0; i < D; ++i) {
            a_[i][lane] = from_a[i];
            b_[i][lane] = from_b[i];
            between_[i][lane] = start.between[i];
        }
        force_[lane] = joint_row<S, D>::unlimited();
    }
    /// What of D rows is the same wherever bodies are.
    void begin(row_lanes<S, D, Rotates, W, false>* rows, const joint_pass<S>& with) const {
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1)),
                is_one = select_greater(P::load(force_), zero, one, zero);
        for (int i = 0; i < D; ++i) rows[i].begin_rigid(i, is_one, with);
    }
    /// Writes D rows where bodies are now, which still need to be finished. False, and nothing is written, if the
    /// velocities of a body are drawn otherwise.
    bool write(row_lanes<S, D, Rotates, W, false>* rows, const side& a, const side& b, const pose* poses) const {
        S of_a[R][W], of_b[R][W], move[D][W];
        for (int lane = 0; lane < W; ++lane) {
            const pose &at_a = poses[a.index[lane]], &at_b = poses[b.index[lane]];
            if (at_a.is_drawn || at_b.is_drawn) return false;
            put_rotation(at_a.rotation_from(start_a_[lane]), lane, of_a);
            put_rotation(at_b.rotation_from(start_b_[lane]), lane, of_b);
            const vec<S, D> by = at_b.displacement.linear - at_a.displacement.linear;
            for (int i = 0; i < D; ++i) move[i][lane] = by[i];
        }
        const V to_a = turned(of_a) * V::load(a_), to_b = turned(of_b) * V::load(b_),
                apart = (V::load(between_) + V::load(move)) + (to_b - to_a);
        const P force = P::load(force_);
        put_row<0>(rows[0], to_a, to_b, apart.x, force);
        put_row<1>(rows[1], to_a, to_b, apart.y, force);
        if constexpr (D == 3) put_row<2>(rows[2], to_a, to_b, apart.z, force);
        return true;
    }

private:
    static void put_rotation(const physics::rotation<S, D>& r, int lane, S (&to)[R][W]) {
        if constexpr (D == 2) {
            to[0][lane] = r.cosine, to[1][lane] = r.sine;
        } else {
            to[0][lane] = r.x, to[1][lane] = r.y, to[2][lane] = r.z, to[3][lane] = r.w;
        }
    }
    PHYSICS_HPP_ALWAYS_INLINE static turned_lanes<P, D> turned(const S (&from)[R][W]) {
        turned_lanes<P, D> q;
        for (int i = 0; i < R; ++i) q.at[i] = P::load(from[i]);
        return q;
    }
    template <int I>
    static void put_row(row_lanes<S, D, Rotates, W, false>& r, [[maybe_unused]] const V& to_a,
                        [[maybe_unused]] const V& to_b, const P& error, const P& force) {
        error.store(r.error);
        force.store(r.high);
        (-force).store(r.low);
        if constexpr (Rotates && D == 2) {
            (I == 0 ? to_a.y : -to_a.x).store(r.angular_a[0]);
            (I == 0 ? -to_b.y : to_b.x).store(r.angular_b[0]);
        } else if constexpr (Rotates) {
            // The cross product with an axis; what is 0 there stays so.
            constexpr int next = (I + 1) % 3, last = (I + 2) % 3;
            const P along_a[] = {to_a.x, to_a.y, to_a.z}, along_b[] = {to_b.x, to_b.y, to_b.z};
            (-along_a[last]).store(r.angular_a[next]);
            along_a[next].store(r.angular_a[last]);
            along_b[last].store(r.angular_b[next]);
            (-along_b[next]).store(r.angular_b[last]);
        }
    }

    /// From the bodies' centres to the points in their frames, from A's centre to B's as the step began, and what rows
    /// may give; 0 in lanes without a joint.
    S a_[D][W] = {}, b_[D][W] = {}, between_[D][W] = {}, force_[W] = {};
    physics::rotation<S, D> start_a_[W] = {}, start_b_[W] = {};
};

struct no_points {};

/// Which rows hold a point of B to one of A, of kinds that say so; 0: none.
template <class Joint>
constexpr std::uint32_t point_rows_of() {
    if constexpr (requires { Joint::point_rows; }) return Joint::point_rows;
    else return 0;
}
/// Whether these are all of a joint's rows that are on.
template <class Joint>
bool holds_points_only([[maybe_unused]] const Joint& joint) {
    if constexpr (point_rows_of<Joint>() != 0) return joint.holds_points_only();
    else return false;
}

}  // namespace detail

PHYSICS_HPP_END
