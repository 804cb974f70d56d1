// Plain structs that users fill in: of a world, a body, a shape.
#pragma once

#include "physics/base/handle.hpp"
#include "physics/broadphase/proxies.hpp"
#include "physics/dynamics/body.hpp"
#include "physics/dynamics/contact.hpp"
#include "physics/dynamics/islands.hpp"
#include "physics/joint/joint.hpp"
#include "physics/step/events.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Stands in settings for the material that all surfaces have in common.
struct every_shape_has_a_material_of_its_own {};

}  // namespace detail

/// Numbers of a world. Lengths in metres, times in seconds, masses in kilograms; a world in other units
/// scales the lengths and speeds here with them.
template <class S, int D, class SolverSettings, class SleepSettings = sleep_settings<S>,
          class Material = detail::every_shape_has_a_material_of_its_own,
          class EventSettings = detail::no_event_settings>
struct world_settings {
    /// Acceleration of every body, times its gravity scale (m/s^2).
    vec<S, D> gravity = downward();
    /// Surfaces closer than this are contacts already, so that the solver can stop them at the surface (m).
    S contact_margin = S(0.02);
    /// Margins of the boxes in the broadphase.
    broadphase_settings<S> broadphase = {};
    /// Numbers of the solver that the recipe names.
    SolverSettings solver = {};
    /// When bodies fall asleep, unless the recipe leaves sleeping out.
    [[no_unique_address]] SleepSettings sleeping = {};
    /// What all surfaces are made of, if the recipe leaves out materials a shape. None of them runs.
    [[no_unique_address]] Material material = {};
    /// What counts as a hit, where the recipe asks for hits.
    [[no_unique_address]] EventSettings events = {};

private:
    static constexpr vec<S, D> downward() {
        vec<S, D> g;
        g.y = S(-9.81);
        return g;
    }
};

/// A body to be.
template <class S, int D>
struct body_def {
    body_type type = body_type::dynamic_body;
    /// Where the origin of the body's frame is (m), and how the frame is turned.
    vec<S, D> position = {};
    physics::rotation<S, D> rotation = {};
    /// Velocity of the centre of mass (m/s) and angular velocity (rad/s).
    vec<S, D> linear_velocity = {};
    physics::angular<S, D> angular_velocity = {};
    /// Rates at which velocities decay without force (1/s), at least 0.
    S linear_damping = S(0);
    S angular_damping = S(0);
    /// Factor of the world's gravity for this body.
    S gravity_scale = S(1);
    /// True if nothing turns the body.
    bool rotation_locked = false;
    /// False keeps the body awake, and those that touch it.
    bool can_sleep = true;
    /// False: it comes disabled (see set_enabled).
    bool enabled = true;
    /// True if moving bodies stop this one too where it goes far in a step (see swept). Static ones stop every body.
    /// One that is slow itself is not looked after, however fast the others are.
    bool continuous = false;
    /// Anything of the user's; the library never looks at it.
    std::uint64_t user_data = 0;
};

/// How a shape sits on its body, and what it is made of; in recipes without materials a shape, not the latter.
template <class S, int D, bool HasMaterial = true>
struct shape_def {
    /// Pose of the shape's frame in the body's frame.
    vec<S, D> position = {};
    physics::rotation<S, D> rotation = {};
    /// kg/m^3 in 3D, kg/m^2 in 2D; at least 0. Only ratios matter until forces act.
    S density = S(1);
    physics::material<S, D> material = {};
    /// Which other shapes it meets.
    collision_filter filter = {};
    /// True if it stops nothing and has no mass, but tells what is in it, in recipes that name event::sensor.
    bool sensor = false;
    /// True of a sensor that sees the shapes of static bodies too: it searches for them in each step.
    bool senses_static = false;
    /// True if it holds only what comes from its upper side, the y axis of its frame, in recipes that name
    /// one_way_platforms or another contact rule that asks for it.
    bool one_way = false;
    std::uint64_t user_data = 0;
};
template <class S, int D>
struct shape_def<S, D, false> {
    vec<S, D> position = {};
    physics::rotation<S, D> rotation = {};
    S density = S(1);
    collision_filter filter = {};
    bool sensor = false, senses_static = false, one_way = false;
    std::uint64_t user_data = 0;
};

/// What a joint is told besides what it holds.
struct joint_def {
    /// False: it holds nothing until it is enabled.
    bool enabled = true;
    /// True if its bodies collide with each other nevertheless.
    bool collide_connected = false;
    /// It breaks by a force or a torque that is greater in a whole step (N, N m; 0: by none). It is no longer enabled
    /// then, and among the broken_joints() of that step.
    double break_force = 0, break_torque = 0;
    std::uint64_t user_data = 0;
};

/// A joint that broke in the last step, and what it gave in that.
template <class S, int D>
struct broken_joint {
    joint_id joint;
    joint_reaction<S, D> reaction;
};

/// One contact as it is reported: both sides, and up to 2 (plane) or 4 (space) points.
template <class S, int D>
struct contact_view {
    struct point {
        /// Halfway between the surfaces at the step's start, carried along with body A since (m).
        vec<S, D> position;
        /// The same point in the frames of both bodies, in which it stays.
        vec<S, D> local_a, local_b;
        /// Distance of the surfaces at the step's start (m); negative is the depth of their overlap.
        S separation;
        /// Sums of the last step's impulses (N s): along the normal, and along the tangents.
        S normal_impulse;
        physics::tangential<S, D> friction_impulse;
        /// True if the point had been in contact in the step before.
        bool persisted;
    };

    shape_id shape_a, shape_b;
    body_id body_a, body_b;
    /// Which part of a concave shape touches: the number of a triangle, segment or child; 0 of convex shapes.
    std::uint32_t part;
    /// True if a point pressed in the last step, or the surfaces were no farther apart as it ended than 1/20 of the
    /// contact margin; where the recipe asks for event::contact, until they are 1/4 of it apart. Others are only near.
    bool touching;
    /// Unit normal from A to B, and unit tangents (one in 2D, two in 3D), in world axes.
    vec<S, D> normal;
    physics::tangents<S, D> tangents;
    point points[manifold<S, D>::capacity];
    int count;
    /// Coefficients of the two surfaces together (see material).
    S friction, restitution, rolling_resistance;
    /// How fast the surfaces drive B over A along the tangents (m/s).
    physics::tangential<S, D> surface_velocity;
    /// Angular impulses of the last step (N m s): about the normal, where the solver lets patches resist twisting, and
    /// against rolling, about z in 2D and about both tangents in 3D.
    S twist_impulse;
    physics::tangential<S, D> rolling_impulse;

    /// The other one of the two bodies, and the normal that points out of that to this one.
    [[nodiscard]] body_id other(body_id body) const { return body == body_a ? body_b : body_a; }
    [[nodiscard]] vec<S, D> normal_on(body_id body) const { return body == body_a ? -normal : normal; }
    /// What pressed on either in the last step along the normal, of all points (N s).
    [[nodiscard]] S normal_impulse() const {
        S sum{};
        for (int k = 0; k < count; ++k) sum += points[k].normal_impulse;
        return sum;
    }
};

PHYSICS_HPP_END
