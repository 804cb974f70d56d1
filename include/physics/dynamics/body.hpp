// The state of a body.
#pragma once

#include "physics/base/handle.hpp"
#include "physics/base/members.hpp"
#include "physics/dynamics/features.hpp"
#include "physics/dynamics/free_spin.hpp"

PHYSICS_HPP_BEGIN

/// How a body moves.
enum class body_type : std::uint8_t {
    /// Never moves; infinite mass.
    static_body,
    /// Moves as told, by velocities or poses; pushes dynamic bodies and is not pushed.
    kinematic_body,
    /// Moved by forces, impulses and contacts.
    dynamic_body,
};

namespace solver_api {

/// A twist of what does not turn.
template <class S, int D>
struct linear_twist {
    vec<S, D> linear;
    /// Of no object, since lanes read twists as rows of scalars.
    static constexpr detail::absent<physics::angular<S, D>, feature::rotation, 0> angular{};

    friend bool operator==(const linear_twist&, const linear_twist&) = default;
};
template <class S, int D>
constexpr linear_twist<S, D> operator+(const linear_twist<S, D>& a, const linear_twist<S, D>& b) {
    return {a.linear + b.linear};
}
template <class S, int D>
constexpr linear_twist<S, D> operator-(const linear_twist<S, D>& a, const linear_twist<S, D>& b) {
    return {a.linear - b.linear};
}
template <class S, int D>
constexpr vec<S, D> velocity_at(const linear_twist<S, D>& v, vec<S, D>) {
    return v.linear;
}
/// The velocity of a body, or how far it has come: with its turn, unless the recipe leaves rotation out.
template <class S, int D, bool Rotates = true>
using twist_of = std::conditional_t<Rotates, twist<S, D>, linear_twist<S, D>>;

/// The mass properties of what does not turn.
template <class S, int D>
struct linear_mass {
    S mass{};
    vec<S, D> center;

    constexpr linear_mass() = default;
    constexpr linear_mass(const mass_properties<S, D>& m) : mass(m.mass), center(m.center) {}
    constexpr operator mass_properties<S, D>() const { return {mass, center, {}}; }
};

/// Everything that a world keeps of one body; Turns: unless the recipe leaves rotation out.
template <class S, int D, bool Rotates = true>
struct body {
    template <class T, int Nth>
    using if_rotation = detail::optional_member<Rotates, T, feature::rotation, Nth>;

    // Moves every step. The centre of mass is the integrated position; the body's origin follows from it.
    vec<S, D> center;
    physics::rotation<S, D> rotation;
    twist_of<S, D, Rotates> velocity;
    vec<S, D> force;
    [[no_unique_address]] if_rotation<angular<S, D>, 1> torque{};

    // Changes when shapes, masses or settings do.
    std::conditional_t<Rotates, mass_properties<S, D>, linear_mass<S, D>> mass;
    inverse_of<S> inverse_mass{};
    [[no_unique_address]] if_rotation<physics::inverse_inertia<S, D>, 2> inverse_inertia{};
    /// Of bodies that are gyroscopic.
    [[no_unique_address]] if_rotation<free_spin<S, D>, 3> spin;
    S linear_damping{};
    [[no_unique_address]] if_rotation<S, 4> angular_damping{};
    S gravity_scale = S(1);
    transform<S, D> target;
    std::uint64_t user_data = 0;
    /// The shape of the highest number.
    std::uint32_t first_shape = detail::null_index;
    /// How it moves: as its user says while it is enabled; else it stands.
    body_type type = body_type::dynamic_body, given_type = body_type::dynamic_body;
    bool enabled = true;
    bool rotation_locked = !Rotates;
    bool can_sleep = true;
    /// True if the inertia depends on the axis: then the spin changes even without torque.
    bool is_gyroscopic = false;
    bool mass_is_set = false;
    bool has_target = false;
    /// True while its velocity is that with which it has reached a target: it does not go on with it.
    bool at_target = false;
    bool continuous = false;
    PHYSICS_HPP_MEMBERS(center, rotation, velocity, force, torque, mass, inverse_mass, inverse_inertia, spin,
                        linear_damping, angular_damping, gravity_scale, target, user_data, first_shape, type,
                        given_type, enabled, rotation_locked, can_sleep, is_gyroscopic, mass_is_set, has_target,
                        at_target, continuous)

    /// The pose of the body's own frame, in which its shapes lie.
    [[nodiscard]] constexpr transform<S, D> pose() const { return {center - rotation * mass.center, rotation}; }
    constexpr void set_pose(const transform<S, D>& pose) {
        rotation = pose.rotation;
        center = pose * mass.center;
    }
    /// Its velocity as a step of h seconds begins: towards its target, if it has one; 0 if it has just reached one.
    [[nodiscard]] twist_of<S, D, Rotates> velocity_ahead(S h) const {
        if (!has_target) return at_target ? twist_of<S, D, Rotates>{} : velocity;
        twist_of<S, D, Rotates> v;
        v.linear = (target * mass.center - center) / h;
        if constexpr (Rotates) v.angular = rotation_vector(target.rotation * inverse(rotation)) / h;
        return v;
    }
    [[nodiscard]] constexpr bool is_dynamic() const { return type == body_type::dynamic_body; }
    /// True if a force or torque waits to act on it.
    [[nodiscard]] constexpr bool has_external_force() const {
        return !(force == vec<S, D>{} && torque == if_rotation<angular<S, D>, 1>{});
    }
};

/// What an integrator sees of a body: where it is, and what drives it.
template <class S, int D, bool Rotates = true>
struct moving_body {
    /// As the step begins; how far the body has come since is added up apart, where far from the origin less is lost.
    vec<S, D> center;
    /// In 2D, and where poses advance in lanes, as the step begins; else in 3D as it is.
    physics::rotation<S, D> rotation;
    /// By gravity, forces and torques (m/s^2, rad/s^2), in world axes.
    vec<S, D> acceleration;
    angular<S, D> angular_acceleration{};
    S linear_damping{};
    S angular_damping{};
    /// The body, if its spin changes even without torque; else null.
    const body<S, D>* gyroscopic = nullptr;
};
/// The same of what does not turn.
template <class S, int D>
struct moving_body<S, D, false> {
    vec<S, D> center;
    vec<S, D> acceleration;
    S linear_damping{};
};

/// How a body is turned that has moved.
template <class S, int D, bool Rotates>
constexpr const rotation<S, D>& rotation_after([[maybe_unused]] const moving_body<S, D, Rotates>& moved,
                                               [[maybe_unused]] const body<S, D, Rotates>& before) {
    if constexpr (Rotates) return moved.rotation;
    else return before.rotation;
}

/// Where its own frame is then: at its target, to the bit, if it has one.
template <class S, int D, bool Rotates>
constexpr transform<S, D> pose_after(const body<S, D, Rotates>& before, const moving_body<S, D, Rotates>& moved) {
    if (before.has_target) return before.target;
    const rotation<S, D>& turn = rotation_after(moved, before);
    return {moved.center - turn * before.mass.center, turn};
}

/// The velocity of a body as it turns: in 3D that changes how it spins, in 2D it does not.
template <class S, int D, bool Rotates = true>
using pose_velocity = std::conditional_t<D == 3 && Rotates, twist<S, D>, const twist_of<S, D, Rotates>>;

/// What a solver sees of a body: velocity, how far it has come in this step (m, rad), and how it answers to impulses.
/// Bodies that nothing pushes have the inverse mass 0. The twists come first, so that lanes read them in rows
/// of four scalars.
template <class S, int D, bool Rotates = true>
struct alignas(16) solver_body {
    twist_of<S, D, Rotates> velocity;
    twist_of<S, D, Rotates> displacement;
    inverse_of<S> inverse_mass{};
    [[no_unique_address]] detail::optional_member<Rotates, physics::inverse_inertia<S, D>, feature::rotation, 2>
        inverse_inertia{};

    /// The impulse p (kg m/s) acts at r from the centre of mass.
    constexpr void apply(vec<S, D> p, [[maybe_unused]] vec<S, D> r) {
        for (int i = 0; i < D; ++i) velocity.linear[i] += mul<S>(inverse_mass, p[i]);
        if constexpr (Rotates) velocity.angular += times(inverse_inertia, cross(r, p));
    }
};

/// Bodies by number. Two entries follow those that can move: the static body (inverse mass 0) and a dummy that unused
/// SIMD lanes write to.
template <class S, int D, bool Rotates = true>
struct solver_bodies {
    solver_body<S, D, Rotates>* first;
    /// With the last two.
    std::uint32_t count;

    [[nodiscard]] std::uint32_t static_body() const { return count - 2; }
    [[nodiscard]] std::uint32_t dummy_body() const { return count - 1; }

    solver_body<S, D, Rotates>& operator[](std::uint32_t i) const { return first[i]; }
};

/// The bodies of a step by their numbers as a solver has left them.
template <class S, int D, bool Rotates = true>
struct moved_bodies {
    solver_body<S, D, Rotates>* solved;
    moving_body<S, D, Rotates>* moved;
    /// Where each body is in these arrays.
    const std::uint32_t* slot_of;

    twist_of<S, D, Rotates>& velocity(std::uint32_t i) const { return solved[slot_of[i]].velocity; }
    moving_body<S, D, Rotates>& operator[](std::uint32_t i) const { return moved[slot_of[i]]; }
};

}  // namespace solver_api

PHYSICS_HPP_END
