// Joints: what a kind of joint tells of itself, whoever solves it.
#pragma once

#include "physics/base/stage.hpp"
#include "physics/joint/joint_row.hpp"
#include "physics/space/check.hpp"

PHYSICS_HPP_BEGIN

/// What drives one coordinate of a joint, an angle or a length, by up to four rows. Equal limits lock it.
template <class S>
struct joint_drive {
    S min, max;
    S motor_speed, max_motor;
    S rest;
    joint_spring<S> spring;

    static constexpr int row_count = 4;
    /// Whether it matters where the coordinate is.
    [[nodiscard]] constexpr bool uses_value() const { return spring.is_on() || is_limit(min) || is_limit(max); }
    /// Whether any row is on.
    [[nodiscard]] constexpr bool is_on() const { return min == max || uses_value() || max_motor > S(0); }
    static constexpr bool is_limit(S x) { return x < scalar_traits<S>::max() && -x < scalar_traits<S>::max(); }

    /// `along` has the Jacobian of the coordinate, which is at `value`.
    template <int D>
    void rows(const joint_row<S, D>& along, S value, joint_row<S, D>* row) const {
        if (min == max) {
            row[2] = along.equality(value - min);
            return;
        }
        if (spring.is_on()) row[0] = along.spring(value - rest, spring);
        if (max_motor > S(0)) row[1] = along.motor(motor_speed, max_motor);
        if (is_limit(min)) row[2] = along.limit(value - min);
        if (is_limit(max)) row[3] = (-along).limit(max - value);
    }
};

/// What a joint gives B, and takes from A.
template <class S, int D>
struct joint_reaction {
    /// Force (N), and torque about where it acts (N m): of joints with frames the place of B's.
    vec<S, D> force;
    angular<S, D> torque{};
};

namespace detail {

/// N values, of which there may be none.
template <class T, int N>
struct fixed_list {
    T at[N] = {};

    T& operator[](int i) { return at[i]; }
    const T& operator[](int i) const { return at[i]; }
    T* begin() { return at; }
    T* end() { return at + N; }
    const T* begin() const { return at; }
    const T* end() const { return at + N; }
};
template <class T>
struct fixed_list<T, 0> {
    T& operator[](int) { return *begin(); }
    const T& operator[](int) const { return *begin(); }
    T* begin() { return nullptr; }
    T* end() { return nullptr; }
    const T* begin() const { return nullptr; }
    const T* end() const { return nullptr; }
};

/// Whether rows of a kind pull A and B in directions of their own.
template <class Joint>
constexpr bool has_two_directions() {
    if constexpr (requires { Joint::two_directions; }) return Joint::two_directions;
    else return false;
}
template <class Joint, class S, int D>
using frames_for = std::conditional_t<has_two_directions<Joint>(), grounded_frames<S, D>, joint_frames<S, D>>;

/// Where rows are written to. `Two`: and of each also in which direction it pulls A.
template <class S, int D, bool Two>
struct row_target {
    joint_row<S, D>* row;

    [[nodiscard]] const vec<S, D>& direction_a(int k) const { return row[k].direction; }
    /// That of the body which it moves more; null of rows that only turn.
    [[nodiscard]] const vec<S, D>& direction(int k) const { return row[k].direction; }
};
template <class S, int D>
struct row_target<S, D, true> {
    joint_row<S, D>* row;
    vec<S, D>* of_a;

    [[nodiscard]] const vec<S, D>& direction_a(int k) const { return of_a[k]; }
    [[nodiscard]] const vec<S, D>& direction(int k) const {
        return largest(row[k].direction) < largest(of_a[k]) ? of_a[k] : row[k].direction;
    }
};
/// N rows.
template <class S, int D, int N, bool Two>
struct row_list {
    fixed_list<joint_row<S, D>, N> row;

    row_target<S, D, false> target() { return {row.begin()}; }
};
template <class S, int D, int N>
struct row_list<S, D, N, true> {
    fixed_list<joint_row<S, D>, N> row;
    fixed_list<vec<S, D>, N> of_a;

    row_target<S, D, true> target() { return {row.begin(), of_a.begin()}; }
};
/// The rows of a joint of any kind.
template <class Joint, class S, int D, bool Two>
void rows_of(const Joint& joint, const frames_for<Joint, S, D>& at, const row_target<S, D, Two>& to) {
    if constexpr (has_two_directions<Joint>()) {
        joint.rows(at, to.row, to.of_a);
    } else {
        joint.rows(at, to.row);
        if constexpr (Two)
            for (int k = 0; k < Joint::row_count; ++k) to.of_a[k] = to.row[k].direction;
    }
}
template <class Joint, class S, int D>
concept writes_rows = requires(const Joint& joint, const frames_for<Joint, S, D>& at,
                               const row_target<S, D, has_two_directions<Joint>()>& to) {
    rows_of<Joint>(joint, at, to);
};

}  // namespace detail

/// What a kind of joint must offer: values whose members are listed, a function check(joint, function) like that of
/// shapes, and how many rows it has, 0 to 24: rows(frames, row) writes them. It is pure geometry, and is asked in each
/// substep; all else is the library's. Of a kind that says so by the bits of `static constexpr std::uint32_t
/// shared_bounds`, row k shares its max_force with row k + 1, and so on, up to three: not each of them, but the length
/// of what they give together is bounded. Such rows are on together, with the same bounds and stiffness. Of a kind with
/// a `static constexpr int angle_count`, so many angles are counted: it tells angle(frames, i), |angle| <= pi, and
/// finds them in frames.turned[i]; where it offers uses_angles(), these are exact only if it says so. fill_in(frames)
/// is called as a joint is made or set, for what it leaves open till then; check_at(frames, function) before that, for
/// what depends on where bodies are. Of a kind with a `static constexpr bool two_directions = true` a row pulls A
/// otherwise than B, and the world bears the difference: rows(grounded_frames, row, direction_a) writes the negative of
/// the Jacobian of A's centre of mass too. A kind that holds a point of B to one of A by joint_frames::hold may say so
/// by the bits of `static constexpr std::uint32_t point_rows`, with points(), and holds_points_only(), whether no other
/// row is on: such joints are written in lanes. A kind that names places of the world moves them in shift_origin(to).
template <class Joint, class S, int D>
concept joint_for = std::is_trivially_copyable_v<Joint> && detail::names_members<Joint> &&
    requires(const Joint& joint) {
    { check(joint, "create_joint") } -> std::same_as<bool>;
    requires Joint::row_count >= 0 && Joint::row_count <= 24;
    requires detail::writes_rows<Joint, S, D>;
};

namespace detail {

/// Kinds that hold a frame of each body; and those too that hold the same point of both.
template <class Joint>
concept holds_frames = requires(Joint& j) {
    j.frame_a, j.frame_b;
};
template <class Joint>
concept placed_by_frame = holds_frames<Joint> ||(
    requires(Joint& j) { j.anchor_a, j.anchor_b; } && !requires(Joint & j) { j.length; } &&
    !requires(Joint & j) { j.ground_a; });

/// How many angles of a kind are counted.
template <class Joint>
constexpr int angles_of() {
    if constexpr (requires { Joint::angle_count; }) return Joint::angle_count;
    else return 0;
}
template <class Joint, class S>
using angle_list = fixed_list<counted_angle<S>, angles_of<Joint>()>;
/// Whether rows depend on them.
template <class Joint>
bool uses_angles([[maybe_unused]] const Joint& joint) {
    if constexpr (requires { joint.uses_angles(); }) return joint.uses_angles();
    else return true;
}
/// Angles that were last seen so, where bodies are now.
template <class Joint, class S, int D>
angle_list<Joint, S> count_turns([[maybe_unused]] const Joint& joint, [[maybe_unused]] const joint_frames<S, D>& at,
                                 angle_list<Joint, S> turned) {
    if constexpr (angles_of<Joint>() > 0)
        for (int i = 0; i < angles_of<Joint>(); ++i) turned[i] = turned[i].at(joint.angle(at, i));
    return turned;
}

/// Checks of what joints are made of.
template <class S, int D>
bool check_frame(const char* function, const char* position, const char* rotation, const transform<S, D>& frame) {
    if (!check_bounded(function, position, frame.position)) return false;
    const S error = norm_error(frame.rotation);
    return error < S(0.001) || refuse(function, rotation, static_cast<double>(error),
                                      "its squared length must be 1, to less than 0.001; it is off by that");
}
template <class S, int D>
bool check_frames(const char* function, const transform<S, D>& a, const transform<S, D>& b) {
    return check_frame(function, "frame_a.position", "frame_a.rotation", a) &&
           check_frame(function, "frame_b.position", "frame_b.rotation", b);
}
template <class S>
bool check_limits(const char* function, const char* min_name, S min, S max, const char* rule) {
    return min <= max || refuse(function, min_name, static_cast<double>(min), rule);
}

}  // namespace detail

/// The joints that a world knows, of those in joint/ or your own. Default: none, which costs nothing.
template <template <class, int> class... Joints>
struct joints {
    using stage = physics::stage::joints;
};

PHYSICS_HPP_END
