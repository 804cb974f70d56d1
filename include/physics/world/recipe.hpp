// Recipes: which types make up a world.
#pragma once

#include "physics/broadphase/dynamic_tree.hpp"
#include "physics/collide/first_penetration.hpp"
#include "physics/collide/narrowphase.hpp"
#include "physics/dynamics/continuous.hpp"
#include "physics/dynamics/sequential_impulse.hpp"
#include "physics/dynamics/soft_step.hpp"
#include "physics/joint/ball_joint.hpp"
#include "physics/joint/cone_joint.hpp"
#include "physics/joint/distance_joint.hpp"
#include "physics/joint/filter_joint.hpp"
#include "physics/joint/gear_joint.hpp"
#include "physics/joint/motor_joint.hpp"
#include "physics/joint/prismatic_joint.hpp"
#include "physics/joint/pulley_joint.hpp"
#include "physics/joint/rack_joint.hpp"
#include "physics/joint/revolute_joint.hpp"
#include "physics/joint/six_degrees_joint.hpp"
#include "physics/joint/swing_twist_joint.hpp"
#include "physics/joint/target_joint.hpp"
#include "physics/joint/weld_joint.hpp"
#include "physics/joint/wheel_joint.hpp"
#include "physics/shape/chain.hpp"
#include "physics/shape/compound.hpp"
#include "physics/shape/heightfield.hpp"
#include "physics/shape/mesh.hpp"
#include "physics/shape/tile_grid.hpp"
#include "physics/step/contact_rule.hpp"
#include "physics/step/events.hpp"
#include "physics/step/user_types.hpp"
#include "physics/world/settings.hpp"

PHYSICS_HPP_BEGIN

namespace detail {
template <class... Policies>
struct policy_list {};
}  // namespace detail

/// What a world is made of: a scalar, a dimension (2 or 3) and policies in any order. Derive a struct from
/// it, so that the world has a short name:
///
///     struct crates : physics::recipe<float, 2> {};
///     struct lockstep : physics::recipe<physics::fixed32, 3, physics::shapes<physics::sphere, physics::box>> {};
///     physics::world<lockstep> arena;
///
/// A policy is a type that names its stage (`using stage = physics::stage::solver`) and rebinds itself to
/// the recipe's space, so changing the scalar changes everything. Stages without a policy get the default.
template <class Scalar, int Dimension, class... Policies>
struct recipe {
    using scalar = Scalar;
    static constexpr int dimension = Dimension;
    using policies = detail::policy_list<Policies...>;
};

/// The shapes that a world knows, of those in shape/ or your own. Default: ball (or circle, sphere), capsule, box,
/// halfspace. A world's shapes are as large as the largest of the set, and each kind adds code for its pairs.
template <template <class, int> class... Shapes>
struct shapes {
    using stage = physics::stage::shapes;
};

namespace detail {

/// The stage of a policy; void for a type that names none.
template <class Policy>
struct stage_of {
    using type = void;
};
template <class Policy>
    requires requires { typename Policy::stage; }
struct stage_of<Policy> {
    using type = typename Policy::stage;
};

/// The first policy of a list that serves a stage, or the default.
template <class Stage, class Default, class... Policies>
struct policy_for {
    using type = Default;
};
template <class Stage, class Default, class First, class... Rest>
struct policy_for<Stage, Default, First, Rest...> {
    using type = typename std::conditional_t<std::same_as<typename stage_of<First>::type, Stage>,
                                             policy_for<Stage, First>, policy_for<Stage, Default, Rest...>>::type;
};

/// The names of shapes and joints inside a world: physics::world<recipe>::box.
template <class S, int D>
struct shape_names {
    using ball = physics::ball<S, D>;
    using capsule = physics::capsule<S, D>;
    using box = physics::box<S, D>;
    using halfspace = physics::halfspace<S, D>;
    using segment = physics::segment<S, D>;
    using triangle = physics::triangle<S, D>;
    using rounded_box = physics::rounded_box<S, D>;
    using hull = physics::hull<S, D>;
    using hull_geometry = physics::hull_geometry<S, D>;
    using heightfield = physics::heightfield<S, D>;
    using heightfield_geometry = physics::heightfield_geometry<S, D>;
    using compound = physics::compound<S, D>;
    using compound_child = physics::compound_child<S, D>;
    using compound_geometry = physics::compound_geometry<S, D>;
    using ball_joint = physics::ball_joint<S, D>;
    using distance_joint = physics::distance_joint<S, D>;
    using filter_joint = physics::filter_joint<S, D>;
    using motor_joint = physics::motor_joint<S, D>;
    using prismatic_joint = physics::prismatic_joint<S, D>;
    using revolute_joint = physics::revolute_joint<S, D>;
    using gear_joint = physics::gear_joint<S, D>;
    using pulley_joint = physics::pulley_joint<S, D>;
    using rack_joint = physics::rack_joint<S, D>;
    using joint_axis = physics::joint_axis<S>;
    using six_degrees_joint = physics::six_degrees_joint<S, D>;
    using target_joint = physics::target_joint<S, D>;
    using weld_joint = physics::weld_joint<S, D>;
    using wheel_joint = physics::wheel_joint<S, D>;
};
template <class S, int D>
struct shape_aliases;
template <class S>
struct shape_aliases<S, 2> : shape_names<S, 2> {
    using circle = physics::ball<S, 2>;
    using chain = physics::chain<S, 2>;
    using chain_geometry = physics::chain_geometry<S, 2>;
    using tile_grid = physics::tile_grid<S, 2>;
    using tile_grid_geometry = physics::tile_grid_geometry<S, 2>;
};
template <class S>
struct shape_aliases<S, 3> : shape_names<S, 3> {
    using sphere = physics::ball<S, 3>;
    using cylinder = physics::cylinder<S, 3>;
    using cone = physics::cone<S, 3>;
    using mesh = physics::mesh<S, 3>;
    using cone_joint = physics::cone_joint<S, 3>;
    using swing_twist_joint = physics::swing_twist_joint<S, 3>;
    using mesh_geometry = physics::mesh_geometry<S, 3>;
};

/// What a narrowphase remembers of a pair, if anything.
template <class Narrowphase>
struct memory_of {
    struct type {};
};
template <class Narrowphase>
    requires requires { typename Narrowphase::memory; }
struct memory_of<Narrowphase> {
    using type = typename Narrowphase::memory;
};

/// Settings of what a recipe leaves out.
struct no_settings {};
inline bool check(const no_settings&, const char*) { return true; }

/// A recipe's choices, resolved: every stage with its type in the recipe's space.
template <class S, int D, class ShapeSet, class... Policies>
struct plan;
template <class S, int D, template <class, int> class... Shapes, class... Policies>
struct plan<S, D, shapes<Shapes...>, Policies...> {
    using scalar = S;
    static constexpr int dimension = D;
    using space = physics::space<S, D>;
    using features = typename policy_for<stage::features, without<>, Policies...>::type;
    static constexpr bool rotates = features::rotation;
    using body = solver_api::body<S, D, rotates>;
    using contact = solver_api::contact<S, D, features>;
    using shape = any_shape<S, D, Shapes...>;
    using query = narrowphase_query<S, D, Shapes...>;
    using broadphase = typename policy_for<stage::broadphase, dynamic_tree, Policies...>::type::template in<space>;
    using narrowphase =
        typename policy_for<stage::narrowphase, best_per_pair, Policies...>::type::template in<S, D, Shapes...>;
    static constexpr bool remembers = requires { typename narrowphase::memory; };
    using pair_memory = typename memory_of<narrowphase>::type;
    using mixing = typename policy_for<stage::mixing, geometric_mixing, Policies...>::type::template in<space>;
    using integrator =
        typename policy_for<stage::integrator, semi_implicit_euler, Policies...>::type::template in<space>;
    using solver = typename policy_for<stage::solver, soft_step, Policies...>::type::template in<space, features>;
    static constexpr bool sleeps = features::sleeping;
    using events = typename policy_for<stage::events, physics::events<>, Policies...>::type;
    using user_types = typename policy_for<stage::user_types, physics::user_types<>, Policies...>::type;
    using contact_rule = typename policy_for<stage::contact_rule, no_contact_rule, Policies...>::type;
    static constexpr bool has_contact_rule = !std::same_as<contact_rule, no_contact_rule>;
    using joints = typename policy_for<stage::joints, physics::joints<>, Policies...>::type;
    static constexpr bool has_joints = !std::same_as<joints, physics::joints<>>;
    using settings =
        world_settings<S, D, typename solver::settings, std::conditional_t<sleeps, sleep_settings<S>, no_settings>,
                       std::conditional_t<features::materials, every_shape_has_a_material_of_its_own, material<S, D>>,
                       std::conditional_t<events::hits, event_settings<S>, no_event_settings>>;
    using shape_def = physics::shape_def<S, D, features::materials>;
    using continuous = typename std::conditional_t<features::continuous,
                                                   typename policy_for<stage::continuous, swept, Policies...>::type,
                                                   no_continuous>::template in<space>;
    /// Whether all shapes are so simple that sweeps can do without the general kernels.
    static constexpr bool few_corners = D == 2 && (has_few_corners<Shapes<S, D>, S> && ...);
    static constexpr bool sweeps = detail::sweeps<continuous, S, D>;
    static constexpr bool looks_ahead = detail::looks_ahead<continuous, S, D>;
    static constexpr bool is_continuous = sweeps || looks_ahead;
};

template <class... Policies>
using shape_set_for = typename policy_for<stage::shapes, shapes<ball, capsule, box, halfspace>, Policies...>::type;

}  // namespace detail

PHYSICS_HPP_END
