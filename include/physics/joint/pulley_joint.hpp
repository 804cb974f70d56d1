// The pulley joint: a rope over wheels that stand still.
#pragma once

#include "physics/joint/joint.hpp"

PHYSICS_HPP_BEGIN

/// A rope from a point of A over two points of the world to one of B: the length on A's side and `ratio` times that on
/// B's stay within limits. As it stands it is a rope, which pulls and does not push; with equal limits it does both.
/// With the tension T it pulls A by T and B by `ratio` T, as a block and tackle does. Rows: 4. Error: while a point is
/// on its wheel it is pulled along x; what is drawn beyond the wheel is pulled back to it.
template <class S, int D>
struct pulley_joint {
    /// Stands for the length when the joint is made or set.
    static constexpr S as_it_stands = scalar_traits<S>::max();

    /// Where the rope ends, in the bodies' frames (m).
    vec<S, D> anchor_a{}, anchor_b{};
    /// Where its wheels are, in the world (m); not where the anchors are when it is made or set.
    vec<S, D> ground_a{}, ground_b{};
    /// How much of the rope on A's side a length on B's takes up, greater than 0: 2 where B hangs in a loop.
    S ratio = S(1);
    /// The length on A's side and `ratio` times that on B's stay between these (m).
    S min_length = S(0), max_length = as_it_stands;

    static constexpr int row_count = 4;
    static constexpr bool two_directions = true;
    PHYSICS_HPP_MEMBERS(anchor_a, anchor_b, ground_a, ground_b, ratio, min_length, max_length)

    /// The world's origin moves to a point.
    void shift_origin(const vec<S, D>& to) {
        ground_a -= to;
        ground_b -= to;
    }

    /// The length on A's side and `ratio` times that on B's, where bodies are (m).
    [[nodiscard]] S length(const grounded_frames<S, D>& at) const {
        return physics::length(at.line_a(ground_a, anchor_a)) + ratio * physics::length(at.line_b(ground_b, anchor_b));
    }
    [[nodiscard]] bool check_at(const grounded_frames<S, D>& at, const char* function) const {
        constexpr const char* rule = "there must be some rope on both sides";
        if (at.line_a(ground_a, anchor_a) == vec<S, D>{})
            return detail::refuse(function, "ground_a", "where anchor_a is", rule);
        if (at.line_b(ground_b, anchor_b) == vec<S, D>{})
            return detail::refuse(function, "ground_b", "where anchor_b is", rule);
        pulley_joint filled = *this;
        filled.fill_in(at);
        return detail::check_limits(function, "min_length", filled.min_length, filled.max_length,
                                    "it must be at most max_length");
    }
    void fill_in(const grounded_frames<S, D>& at) {
        if (min_length == as_it_stands) min_length = length(at);
        if (max_length == as_it_stands) max_length = length(at);
    }
    void rows(const grounded_frames<S, D>& at, joint_row<S, D>* row, vec<S, D>* direction_a) const {
        auto a = direction_and_length_of(at.line_a(ground_a, anchor_a)),
             b = direction_and_length_of(at.line_b(ground_b, anchor_b));
        if (!(a.length > S(0))) a.direction = at.axis(0);
        if (!(b.length > S(0))) b.direction = at.axis(0);
        const vec<S, D> r_a = at.r_a(anchor_a), r_b = at.r_b(anchor_b), pull_b = b.direction * ratio;
        const joint_row<S, D> longer{pull_b, cross(r_a, a.direction), cross(r_b, pull_b), r_a, r_b};
        const S on_b = ratio * b.length, now = a.length + on_b;
        direction_a[0] = -a.direction;
        direction_a[1] = a.direction;
        // No side takes up more than all of it: at a wheel the direction on the other side turns back, and says
        // nothing.
        direction_a[2] = a.direction;
        row[2] = joint_row<S, D>{{}, -longer.angular_a, {}, r_a, r_b}.limit(max_length - a.length);
        row[3] = joint_row<S, D>{-pull_b, {}, -longer.angular_b, r_a, r_b}.limit(max_length - on_b);
        if (min_length == max_length) {
            row[0] = longer.equality(now - max_length);
            return;
        }
        if (min_length > S(0)) row[0] = longer.limit(now - min_length);
        row[1] = (-longer).limit(max_length - now);
    }
};

template <class S, int D>
bool check(const pulley_joint<S, D>& joint, const char* function) {
    return detail::check_bounded(function, "anchor_a", joint.anchor_a) &&
           detail::check_bounded(function, "anchor_b", joint.anchor_b) &&
           detail::check_bounded(function, "ground_a", joint.ground_a) &&
           detail::check_bounded(function, "ground_b", joint.ground_b) &&
           detail::check_positive(function, "ratio", joint.ratio) &&
           detail::check_not_negative(function, "min_length", joint.min_length) &&
           detail::check_positive(function, "max_length", joint.max_length);
}

PHYSICS_HPP_END
