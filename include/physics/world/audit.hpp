// Every way to misuse a recipe, each with its one sentence.
#pragma once

#include "physics/world/recipe.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

enum class recipe_problem {
    none,
    not_a_recipe,
    bad_scalar,
    bad_dimension,
    policy_without_stage,
    unknown_stage,
    not_shapes_or_without,
    two_policies_for_a_stage,
    no_shapes,
    same_shape_twice,
    not_a_shape,
    pair_without_contact,
    unknown_feature,
    same_joint_twice,
    not_a_joint,
    bad_broadphase,
    bad_narrowphase,
    bad_mixing,
    bad_integrator,
    bad_solver,
    solver_without_joints,
    bad_continuous,
    unknown_event,
    bad_user_type,
};

template <class T>
constexpr bool is_policy_list = false;
template <class... Policies>
constexpr bool is_policy_list<policy_list<Policies...>> = true;

template <class Recipe>
concept recipe_like = requires {
    typename Recipe::scalar;
    typename std::integral_constant<int, Recipe::dimension>;
    typename Recipe::policies;
}
&&is_policy_list<typename Recipe::policies>;

template <class Stage>
constexpr bool known_stage = std::same_as<Stage, stage::shapes> || std::same_as<Stage, stage::joints> ||
                             std::same_as<Stage, stage::broadphase> || std::same_as<Stage, stage::narrowphase> ||
                             std::same_as<Stage, stage::mixing> || std::same_as<Stage, stage::solver> ||
                             std::same_as<Stage, stage::integrator> || std::same_as<Stage, stage::continuous> ||
                             std::same_as<Stage, stage::features> || std::same_as<Stage, stage::events> ||
                             std::same_as<Stage, stage::contact_rule> || std::same_as<Stage, stage::user_types>;

/// False for a policy that claims a stage of the library's own.
template <class Policy, class Stage = typename stage_of<Policy>::type>
constexpr bool may_serve = !std::same_as<Stage, stage::shapes> && !std::same_as<Stage, stage::joints> &&
                           !std::same_as<Stage, stage::features> && !std::same_as<Stage, stage::events> &&
                           !std::same_as<Stage, stage::user_types>;
template <template <class, int> class... Shapes>
constexpr bool may_serve<shapes<Shapes...>, stage::shapes> = true;
template <template <class, int> class... Joints>
constexpr bool may_serve<joints<Joints...>, stage::joints> = true;
template <class... Features>
constexpr bool may_serve<without<Features...>, stage::features> = true;
template <class... Kinds>
constexpr bool may_serve<events<Kinds...>, stage::events> = true;
template <class Body, class Shape, class Joint>
constexpr bool may_serve<user_types<Body, Shape, Joint>, stage::user_types> = true;

/// How many of the policies serve the stage.
template <class Stage, class... Policies>
constexpr int policies_for = (0 + ... + int{std::same_as<typename stage_of<Policies>::type, Stage>});

template <class A, class S, int D, template <class, int> class... Shapes>
constexpr bool meets_all = (collidable<A, Shapes<S, D>, S, D> && ...);
template <class A, class S, int D, template <class, int> class... Shapes>
constexpr int times_among = (0 + ... + int{std::same_as<A, Shapes<S, D>>});

template <class T>
concept complete = requires {
    sizeof(T);
};
template <class Shape, class S, int D>
concept usable_shape = complete<Shape> && shape_for<Shape, S, D>;
template <class S, int D, template <class, int> class... Shapes>
constexpr recipe_problem problem_of_shapes(const shapes<Shapes...>*) {
    if constexpr (sizeof...(Shapes) == 0) return recipe_problem::no_shapes;
    else if constexpr (((times_among<Shapes<S, D>, S, D, Shapes...> > 1) || ...))
        return recipe_problem::same_shape_twice;
    else if constexpr (!(usable_shape<Shapes<S, D>, S, D> && ...)) return recipe_problem::not_a_shape;
    else if constexpr (!(meets_all<Shapes<S, D>, S, D, Shapes...> && ...)) return recipe_problem::pair_without_contact;
    else return recipe_problem::none;
}

template <class S, int D, template <class, int> class... Joints>
constexpr recipe_problem problem_of_joints(const joints<Joints...>*) {
    if constexpr (((times_among < Joints<S, D>, S, D, Joints... >> 1) || ...)) return recipe_problem::same_joint_twice;
    else if constexpr (!((complete<Joints<S, D>> && joint_for<Joints<S, D>, S, D>)&&...))
        return recipe_problem::not_a_joint;
    else return recipe_problem::none;
}

template <class Policy, class Space>
concept broadphase_policy = requires {
    typename Policy::template in<Space>;
}
&&broadphase_for<typename Policy::template in<Space>, Space>;

template <class Policy, class S, int D, template <class, int> class... Shapes>
constexpr bool narrowphase_serves(const shapes<Shapes...>*) {
    return narrowphase_for<Policy, S, D, Shapes...>;
}

/// What an integrator must offer: integrate_velocity(velocity, moving body, h), integrate_pose(moving body, velocity,
/// way, h), in 2D with a velocity that is const.
template <class Policy, class S, int D, bool Rotates>
concept integrator_policy = requires(moving_body<S, D, Rotates> b, twist_of<S, D, Rotates> v,
                                     pose_velocity<S, D, Rotates> turning) {
    Policy::template in<space<S, D>>::integrate_velocity(v, b, S(1));
    Policy::template in<space<S, D>>::integrate_pose(b, turning, v, S(1));
};

/// What a solver asks of the world that it advances.
template <class S>
struct any_motion {
    void integrate_velocities(S) {}
    void integrate_positions(S) {}
};
/// What a solver must offer: settings with a function check(settings, function) like that of shapes, and
/// solve(bodies, contacts, settings, h, scratch, motion).
template <class Policy, class S, int D, class Features>
concept solver_policy = requires(solver_bodies<S, D, Features::rotation> bodies,
                                 contact_constraints<S, D, Features> contacts, arena scratch, any_motion<S> motion,
                                 const typename Policy::template in<space<S, D>, Features>::settings settings) {
    { check(settings, "function") } -> std::same_as<bool>;
    Policy::template in<space<S, D>, Features>::solve(bodies, contacts, settings, S(1), scratch, motion);
};

/// A solver says so if it takes constraints with joints: see constraints and joint_solver.
template <class Policy>
constexpr bool solves_joints = requires {
    requires Policy::solves_joints;
};

template <class Policy, class S, int D>
concept continuous_policy = requires {
    typename Policy::template in<space<S, D>>;
}
&&continuous_for<typename Policy::template in<space<S, D>>, S, D>;

template <class S, int D, class... Policies>
constexpr recipe_problem problem_of_policies(const policy_list<Policies...>*) {
    if constexpr ((std::is_void_v<typename stage_of<Policies>::type> || ...)) {
        return recipe_problem::policy_without_stage;
    } else if constexpr (!(known_stage<typename stage_of<Policies>::type> && ...)) {
        return recipe_problem::unknown_stage;
    } else if constexpr (!(may_serve<Policies> && ...)) {
        return recipe_problem::not_shapes_or_without;
    } else if constexpr (((policies_for<typename stage_of<Policies>::type, Policies...> > 1) || ...)) {
        return recipe_problem::two_policies_for_a_stage;
    } else {
        using set = shape_set_for<Policies...>;
        using features = typename policy_for<stage::features, without<>, Policies...>::type;
        using joint_set = typename policy_for<stage::joints, joints<>, Policies...>::type;
        constexpr recipe_problem of_shapes = problem_of_shapes<S, D>(static_cast<const set*>(nullptr)),
                                 of_joints = problem_of_joints<S, D>(static_cast<const joint_set*>(nullptr));
        if constexpr (of_shapes != recipe_problem::none) return of_shapes;
        else if constexpr (of_joints != recipe_problem::none) return of_joints;
        else if constexpr (!features::known) return recipe_problem::unknown_feature;
        else if constexpr (!policy_for<stage::events, events<>, Policies...>::type::known)
            return recipe_problem::unknown_event;
        else if constexpr (!policy_for<stage::user_types, user_types<>, Policies...>::type::are_plain)
            return recipe_problem::bad_user_type;
        else if constexpr (!broadphase_policy<typename policy_for<stage::broadphase, dynamic_tree, Policies...>::type,
                                              space<S, D>>)
            return recipe_problem::bad_broadphase;
        else if constexpr (!narrowphase_serves<
                               typename policy_for<stage::narrowphase, best_per_pair, Policies...>::type, S, D>(
                               static_cast<const set*>(nullptr)))
            return recipe_problem::bad_narrowphase;
        else if constexpr (!mixing_for<typename policy_for<stage::mixing, geometric_mixing, Policies...>::type,
                                       space<S, D>>)
            return recipe_problem::bad_mixing;
        else if constexpr (!integrator_policy<
                               typename policy_for<stage::integrator, semi_implicit_euler, Policies...>::type, S, D,
                               features::rotation>)
            return recipe_problem::bad_integrator;
        else if constexpr (!solver_policy<typename policy_for<stage::solver, soft_step, Policies...>::type, S, D,
                                          features>)
            return recipe_problem::bad_solver;
        else if constexpr (!std::same_as<joint_set, joints<>> &&
                           !solves_joints<typename policy_for<stage::solver, soft_step, Policies...>::type>)
            return recipe_problem::solver_without_joints;
        else if constexpr (!continuous_policy<typename policy_for<stage::continuous, swept, Policies...>::type, S, D>)
            return recipe_problem::bad_continuous;
        else return recipe_problem::none;
    }
}

template <class Recipe>
constexpr recipe_problem problem_of() {
    if constexpr (!recipe_like<Recipe>) return recipe_problem::not_a_recipe;
    else if constexpr (!scalar_type<typename Recipe::scalar>) return recipe_problem::bad_scalar;
    else if constexpr (Recipe::dimension != 2 && Recipe::dimension != 3) return recipe_problem::bad_dimension;
    else
        return problem_of_policies<typename Recipe::scalar, Recipe::dimension>(
            static_cast<const typename Recipe::policies*>(nullptr));
}

template <class S, int D, class... Policies>
plan<S, D, shape_set_for<Policies...>, Policies...> planned(const policy_list<Policies...>*);

/// The plan of a recipe. A recipe that fails its audit gets the default plan, so that its one sentence is
/// the only error.
template <class Recipe, bool Good = problem_of<Recipe>() == recipe_problem::none>
struct plan_of {
    using type = decltype(planned<typename Recipe::scalar, Recipe::dimension>(
        static_cast<const typename Recipe::policies*>(nullptr)));
};
template <class Recipe>
struct plan_of<Recipe, false> : plan_of<std::conditional_t<sizeof(Recipe*) != 0, recipe<float, 2>, Recipe>> {};

/// Says in one sentence what is wrong with a recipe.
template <class Recipe>
struct audit {
    static constexpr recipe_problem problem = problem_of<Recipe>();
    static_assert(problem != recipe_problem::not_a_recipe,
                  "physics::world: the argument is not a recipe; write struct mine : physics::recipe<float, 2> {} and "
                  "physics::world<mine>");
    static_assert(problem != recipe_problem::bad_scalar,
                  "physics::recipe: the scalar is not a physics::scalar_type; use float, double, physics::fixed32, or "
                  "specialise physics::scalar_traits");
    static_assert(problem != recipe_problem::bad_dimension, "physics::recipe: the dimension must be 2 or 3");
    static_assert(problem != recipe_problem::policy_without_stage,
                  "physics::recipe: a policy names no stage; give it `using stage = physics::stage::...`");
    static_assert(problem != recipe_problem::unknown_stage,
                  "physics::recipe: a policy names a stage that does not exist; the stages are those of namespace "
                  "physics::stage");
    static_assert(problem != recipe_problem::not_shapes_or_without,
                  "physics::recipe: a policy names a stage that only physics::shapes<...>, physics::joints<...>, "
                  "physics::without<...>, physics::events<...> or physics::user_types<...> may serve");
    static_assert(problem != recipe_problem::two_policies_for_a_stage,
                  "physics::recipe: two policies serve the same stage; keep one of them");
    static_assert(problem != recipe_problem::no_shapes, "physics::shapes: the set is empty; name at least one shape");
    static_assert(problem != recipe_problem::same_shape_twice, "physics::shapes: a shape stands in the set twice");
    static_assert(
        problem != recipe_problem::not_a_shape,
        "physics::shapes: a type of the set does not model physics::shape_for; it needs check, bounds and as<T>()");
    static_assert(problem != recipe_problem::pair_without_contact,
                  "physics::shapes: two shapes of the set have no function collide(a, b, b_in_a, margin, manifold)");
    static_assert(
        problem != recipe_problem::unknown_feature,
        "physics::without: an argument is not a feature; the features are those of namespace physics::feature");
    static_assert(problem != recipe_problem::unknown_event,
                  "physics::events: an argument is not an event; the events are those of namespace physics::event");
    static_assert(problem != recipe_problem::bad_user_type,
                  "physics::user_types: a type is not plain; it must be trivially copyable and have a default value");
    static_assert(problem != recipe_problem::same_joint_twice, "physics::joints: a joint stands in the set twice");
    static_assert(problem != recipe_problem::not_a_joint,
                  "physics::joints: a type of the set does not model physics::joint_for; it needs a list of its "
                  "members, check, row_count and rows(frames, row)");
    static_assert(problem != recipe_problem::bad_broadphase,
                  "physics::recipe: the broadphase does not model physics::broadphase_for; its in<Space> needs insert, "
                  "move, erase and pairs");
    static_assert(problem != recipe_problem::bad_narrowphase,
                  "physics::recipe: the narrowphase does not model physics::narrowphase_for; its in<S, D, Shapes...> "
                  "needs collide");
    static_assert(problem != recipe_problem::bad_mixing,
                  "physics::recipe: the mixing rule does not model physics::mixing_for; its in<Space> needs friction, "
                  "restitution and rolling_resistance of two materials");
    static_assert(problem != recipe_problem::bad_integrator,
                  "physics::recipe: the integrator's in<Space> needs integrate_velocity and integrate_pose; without "
                  "rotation for physics::solver_api::linear_twist and physics::solver_api::moving_body<S, D, false>");
    static_assert(problem != recipe_problem::bad_solver,
                  "physics::recipe: the solver's in<Space, Features> needs a struct settings with a function check, "
                  "and a function solve");
    static_assert(problem != recipe_problem::solver_without_joints,
                  "physics::recipe: the solver does not say that it solves joints; with "
                  "physics::solver_api::joint_solver it does, "
                  "and says so by static constexpr bool solves_joints = true");
    static_assert(problem != recipe_problem::bad_continuous,
                  "physics::recipe: the continuous policy does not model physics::continuous_for; its in<Space> needs "
                  "sweep_against(body_motion) or ahead(body_motion)");
};

}  // namespace detail

PHYSICS_HPP_END
