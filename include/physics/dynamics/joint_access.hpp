// What solvers ask of joints whatever their kinds are, and how they judge them.
#pragma once

#include "physics/dynamics/joint_pattern.hpp"
#include "physics/dynamics/point_lanes.hpp"
#include "physics/dynamics/shared_bounds.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// What is asked of a joint, whatever its kind. `Two`: among others of kinds with two directions.
template <class S, int D, bool Rotates, bool Two>
struct joint_access {
    using pose = joint_pose<S, D, Rotates>;
    using target = row_target<S, D, Two>;

    vec<S, D> (*write)(void* joint, bool is_ahead, const pose& a, const pose& b, target to);
    S (*first_impulse)(const void* joint, int row, S h);
    /// From the bodies' centres to the points that a joint holds; of kinds with point_rows.
    point_pair<S, D> (*find_points)(const void* joint, const pose& a, const pose& b);
    std::uint32_t point_rows;
    void (*store_impulses)(void* joint, S h, const S* given, const S* sum);
    std::uint32_t shared_bounds;

    template <class Joint>
    static joint_access of() {
        using step_joint = solver_api::step_joint<Joint, S, D>;
        return {[](void* j, bool is_ahead, const pose& a, const pose& b, target to) {
                    for (int k = 0; k < Joint::row_count; ++k) new (to.row + k) joint_row<S, D>();
                    if constexpr (Two)
                        for (int k = 0; k < Joint::row_count; ++k) new (to.of_a + k) vec<S, D>();
                    return write_rows(*static_cast<step_joint*>(j), is_ahead, a, b, to);
                },
                [](const void* j, int row, S h) {
                    return detail::first_impulse(*static_cast<const step_joint*>(j), row, h);
                },
                []([[maybe_unused]] const void* j, [[maybe_unused]] const pose& a, [[maybe_unused]] const pose& b) {
                    point_pair<S, D> r;
                    if constexpr (point_rows_of<Joint>() != 0) {
                        const auto& joint = *static_cast<const step_joint*>(j);
                        const auto& start = joint.start;
                        const auto points = joint.joint->points();
                        r = {a.rotation_from(start.rotation_a) * (points.a - start.center_a),
                             b.rotation_from(start.rotation_b) * (points.b - start.center_b)};
                    }
                    return r;
                },
                point_rows_of<Joint>(),
                [](void* j, S h, const S* given, const S* sum) {
                    detail::store_impulses(
                        *static_cast<step_joint*>(j), h, [given](int k) { return given[k]; },
                        [sum](int k) { return sum[k]; });
                },
                shared_bounds_of<Joint>()};
    }
    static constexpr int max_rows = 24;
    /// Memory for the rows of a joint, which are made as they are written.
    union row_memory {
        joint_row<S, D> at[max_rows];
        row_memory() {}
    };
    union direction_memory {
        vec<S, D> at[Two ? max_rows : 1];
        direction_memory() {}
    };
    static target target_of(row_memory& rows, [[maybe_unused]] direction_memory& directions) {
        if constexpr (Two) return {rows.at, directions.at};
        else return {rows.at};
    }
};

template <class S, int D>
double length_squared_of(const vec<S, D>& v) {
    double sum = 0;
    for (int i = 0; i < D; ++i) sum += to_double(v[i]) * to_double(v[i]);
    return sum;
}
/// Lanes in the type that a matrix is solved in, and back.
template <class K, class P>
PHYSICS_HPP_ALWAYS_INLINE K widened(const P& x) {
    if constexpr (std::is_same_v<K, P>) {
        return x;
    } else {
        typename P::scalar lanes[P::width];
        x.store(lanes);
        return lanes_from<K>(lanes);
    }
}
template <class P, class K>
PHYSICS_HPP_ALWAYS_INLINE P narrowed(const K& x) {
    if constexpr (std::is_same_v<K, P>) {
        return x;
    } else {
        const K limit = K::broadcast(to_double(joint_row<typename P::scalar, 2>::unlimited()));
        return lanes_to<P>(max(min(x, limit), -limit));
    }
}
/// M^-1 J^T of a row, of one of its bodies.
template <class K, class S, int D, bool Rotates, bool Two>
struct row_response {
    static constexpr int W = K::width, A = pushed_lanes<S, D, Rotates, W>::A;
    using row = row_lanes<S, D, Rotates, W, Two>;

    K linear[D], angular[row::array];

    row_response(const row& r, bool is_b, const pushed_lanes<S, D, Rotates, W>& to) {
        const K mass = lanes_from<K>(to.mass);
        for (int c = 0; c < D; ++c) linear[c] = mass * lanes_from<K>(r.direction_of(is_b)[c]);
        [[maybe_unused]] const auto& axis = is_b ? r.angular_b : r.angular_a;
        if constexpr (A == 1) angular[0] = lanes_from<K>(to.inertia[0]) * lanes_from<K>(axis[0]);
        if constexpr (A == 3) {
            constexpr int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
            for (int c = 0; c < 3; ++c)
                angular[c] = lanes_from<K>(to.inertia[place[c][0]]) * lanes_from<K>(axis[0]) +
                             lanes_from<K>(to.inertia[place[c][1]]) * lanes_from<K>(axis[1]) +
                             lanes_from<K>(to.inertia[place[c][2]]) * lanes_from<K>(axis[2]);
        }
    }
    /// The speed of a row of the same body by that; `opposed`: the body is A of one of both, and B of the other.
    [[nodiscard]] K answer(const row& r, bool is_b, bool opposed) const {
        const auto& direction = r.direction_of(is_b);
        K sum = lanes_from<K>(direction[0]) * linear[0];
        for (int c = 1; c < D; ++c) sum = sum + lanes_from<K>(direction[c]) * linear[c];
        if (opposed) sum = -sum;
        [[maybe_unused]] const auto& axis = is_b ? r.angular_b : r.angular_a;
        for (int c = 0; c < A; ++c) sum = sum + lanes_from<K>(axis[c]) * angular[c];
        return sum;
    }
};
/// What a direct solve keeps of a row between solves.
template <class P, class S, int W>
struct direct_row {
    /// What it has given to take back its error; and what it had given before a solve.
    P correction, start;
    /// In the last substep, all of it; and what lasts of that.
    S given[W], load[W];
    /// See rows_together.
    std::uint32_t together;
};
/// J M^-1 J^T of rows.
template <class S, int D, bool Rotates, bool Two, class K, int W = K::width>
void assemble(const joint_pattern& of, const row_lanes<S, D, Rotates, W, Two>* rows,
              const pushed_lanes<S, D, Rotates, W>* sides, K* matrix) {
    const K zero = K::broadcast(typename K::scalar(0));
    for (std::uint32_t i = 0; i < of.entries; ++i) matrix[i] = zero;
    for (std::uint32_t i = 0; i < of.joint_count; ++i) {
        const joint_pattern::joint& j = of.joints[i];
        for (std::uint32_t k = 0; k < j.row_count; ++k) {
            const auto& r = rows[j.first_row + k];
            for (const bool is_b : {false, true}) {
                const auto& to = sides[is_b ? j.b : j.a];
                if (!to.is_pushed) continue;
                const row_response<K, S, D, Rotates, Two> moved(r, is_b, to);
                for (std::uint32_t l = k; l < j.row_count; ++l) {
                    K& at = matrix[j.panel + l * j.row_count + k];
                    at = at + moved.answer(rows[j.first_row + l], is_b, false);
                }
                for (std::uint32_t n = j.couplings; n < of.joints[i + 1].couplings; ++n) {
                    const joint_pattern::coupling& c = of.couplings[n];
                    if (c.first_is_b != is_b) continue;
                    const joint_pattern::joint& later = of.joints[c.later];
                    for (std::uint32_t l = 0; l < later.row_count; ++l) {
                        K& at = matrix[c.to + l * j.row_count + k];
                        at = at + moved.answer(rows[later.first_row + l], c.later_is_b, c.later_is_b != is_b);
                    }
                }
            }
        }
    }
}
/// The square of an error as a part of what a joint measures (of a radian, where a row only turns), up to 1.
template <class S, int D>
double part_of(double error, const joint_row<S, D>& of, const vec<S, D>& direction, double apart) {
    const bool turns = direction == vec<S, D>{};
    const double reach = apart + length_squared_of(of.r_a) + length_squared_of(of.r_b),
                 size = turns ? 1 : length_squared_of(direction) * reach;
    return error * error < size ? error * error / size : 1;
}
/// The square of the lever on which a force of a joint turns the lighter of its bodies as fast as it moves it.
template <class S, int D, bool Rotates>
double own_lever_of(const solver_body<S, D, Rotates>& a, const solver_body<S, D, Rotates>& b) {
    double result = 1e30;
    if constexpr (Rotates)
        for (const auto* body : {&a, &b}) {
            double turns;
            if constexpr (D == 2) turns = to_double(body->inverse_inertia);
            else
                turns = max(to_double(body->inverse_inertia.xx),
                            max(to_double(body->inverse_inertia.yy), to_double(body->inverse_inertia.zz)));
            const double moves = to_double(body->inverse_mass);
            if (moves > 0 && turns > 0) result = min(result, moves / turns);
        }
    return result;
}
/// The square of omega of a body that sways under a joint's force of 1 N on its lever. What hangs by no other joint
/// turns about this one, as far as that stands: `other` is the inverse mass behind it.
template <class S, int D, bool Rotates>
double sway_of([[maybe_unused]] const solver_body<S, D, Rotates>& b, [[maybe_unused]] const vec<S, D>& r,
               [[maybe_unused]] bool is_last, [[maybe_unused]] double other) {
    const double square = length_squared_of(r);
    if constexpr (!Rotates) {
        return 0;
    } else {
        if (!(square > 0)) return 0;
        double across;
        if constexpr (D == 2) {
            across = to_double(b.inverse_inertia);
        } else {
            const auto& m = b.inverse_inertia;
            const double x = to_double(r.x), y = to_double(r.y), z = to_double(r.z);
            const double xx = to_double(m.xx), yy = to_double(m.yy), zz = to_double(m.zz);
            const double along = xx * x * x + yy * y * y + zz * z * z +
                                 2 * (to_double(m.xy) * x * y + to_double(m.xz) * x * z + to_double(m.yz) * y * z);
            across = xx + yy + zz - along / square;
        }
        const double moves = to_double(b.inverse_mass) + other;
        return sqrt(square) * across * (is_last ? moves / (moves + square * across) : 1);
    }
}

}  // namespace detail

PHYSICS_HPP_END
