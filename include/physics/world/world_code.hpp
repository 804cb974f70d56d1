// The functions of a world that take long to compile, so that one unit of a program can compile them for all.
#pragma once

#include "physics/world/advance.hpp"
#include "physics/world/body_kinds.hpp"
#include "physics/world/forces.hpp"
#include "physics/world/hash.hpp"
#include "physics/world/queries.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// What the members of a world call. None is defined in the class: such functions would be inline, and then compiled
/// in spite of PHYSICS_HPP_EXTERN. None has a constraint: clang 14 instantiates such members though they do not hold.
/// All run in a float_control_scope.
template <class Plan>
struct world_code {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;
    using state = detail::state<Plan>;
    using data = detail::world_data<Plan>;
    using vec = physics::vec<S, D>;
    using angular = physics::angular<S, D>;
    using rotation = physics::rotation<S, D>;
    using transform = physics::transform<S, D>;
    using hit = world_hit<S, D>;
    using hits = small_buffer<hit, 16>;
    using closest = closest_hit<S, D>;

    static void step(data& s, S h, const task_runner& tasks);
    static std::uint64_t state_hash(const state& s);
    static void change_settings(data& s, const typename Plan::settings& settings);
    static void set_settings(data& s, const typename Plan::settings& settings);

    static body_id create_body(data& s, const body_def<S, D>& def);
    static void destroy_body(data& s, std::uint32_t body);
    static void destroy_bodies(data& s, const body_id* ids, std::uint32_t count);
    static void clear(data& s);
    static void shift_origin(data& s, const vec& to);
    static shape_id insert_shape(data& s, std::uint32_t body, const typename Plan::shape& shape, bool has_mass,
                                 const typename Plan::shape_def& def);
    static void destroy_shape(data& s, std::uint32_t shape);

    static void set_pose(data& s, std::uint32_t body, const transform& pose);
    static void move_to(data& s, std::uint32_t body, vec position, const rotation& rotation);
    static vec velocity_of_point(const state& s, body_id body, vec point);
    static void wake(data& s, std::uint32_t body, std::uint32_t other);
    static void wake_affected(data& s, std::uint32_t body);
    static void add_force(data& s, body_id body, const char* function, vec force, bool local, const vec* point);
    static void add_torque(data& s, body_id body, angular torque);
    static void add_impulse(data& s, body_id body, const char* function, vec impulse, bool local, const vec* point);
    static void add_angular_impulse(data& s, body_id body, angular impulse);

    static void set_type(data& s, std::uint32_t body, body_type type);
    static void set_enabled(data& s, std::uint32_t body, bool enabled);
    static void set_mass(data& s, std::uint32_t body, const mass_properties<S, D>& mass);
    static void reset_mass(data& s, std::uint32_t body);
    static void set_rotation_locked(data& s, std::uint32_t body, bool locked);
    static void set_filter(data& s, std::uint32_t shape, const collision_filter& filter);

    static hit cast_ray(const state& s, vec origin, vec translation, const query_filter& filter);
    static void find_hits(const state& s, vec origin, vec translation, const query_filter& filter, hits& to);
    static closest closest_shape(const state& s, vec point, S reach, const query_filter& filter);
    static void collide_shape(const state& s, const typename Plan::shape& shape, const transform& pose, S margin,
                              const query_filter& filter, buffer<shape_contact<S, D>>& to);
};

template <class Plan>
void world_code<Plan>::step(data& s, S h, const task_runner& tasks) {
    advance(s, h, tasks);
}
template <class Plan>
std::uint64_t world_code<Plan>::state_hash(const state& s) {
    return scoped([&] { return detail::state_hash(s); });
}
template <class Plan>
void world_code<Plan>::change_settings(data& s, const typename Plan::settings& settings) {
    scoped([&] { detail::change_settings(s, settings); });
}
template <class Plan>
void world_code<Plan>::set_settings(data& s, const typename Plan::settings& settings) {
    scoped([&] { detail::set_settings(s, settings); });
}

template <class Plan>
body_id world_code<Plan>::create_body(data& s, const body_def<S, D>& def) {
    return scoped([&] { return detail::create_body(s, def); });
}
template <class Plan>
void world_code<Plan>::destroy_body(data& s, std::uint32_t body) {
    scoped([&] { detail::destroy_body(s, body); });
}
template <class Plan>
void world_code<Plan>::destroy_bodies(data& s, const body_id* ids, std::uint32_t count) {
    scoped([&] { detail::destroy_bodies(s, ids, count); });
}
template <class Plan>
void world_code<Plan>::clear(data& s) {
    scoped([&] { detail::clear(s); });
}
template <class Plan>
void world_code<Plan>::shift_origin(data& s, const vec& to) {
    scoped([&] { detail::shift_origin(s, to); });
}
template <class Plan>
shape_id world_code<Plan>::insert_shape(data& s, std::uint32_t body, const typename Plan::shape& shape, bool has_mass,
                                        const typename Plan::shape_def& def) {
    return scoped([&] { return detail::insert_shape(s, body, shape, has_mass, def); });
}
template <class Plan>
void world_code<Plan>::destroy_shape(data& s, std::uint32_t shape) {
    scoped([&] { detail::destroy_shape(s, shape); });
}

template <class Plan>
void world_code<Plan>::set_pose(data& s, std::uint32_t body, const transform& pose) {
    scoped([&] { detail::set_pose(s, body, {pose.position, normalized(pose.rotation)}); });
}
template <class Plan>
void world_code<Plan>::move_to(data& s, std::uint32_t body, vec position, const rotation& rotation) {
    scoped([&] { detail::move_to(s, body, position, rotation); });
}
template <class Plan>
auto world_code<Plan>::velocity_of_point(const state& s, body_id body, vec point) -> vec {
    return scoped([&] { return detail::velocity_of_point(s, body, point); });
}
template <class Plan>
void world_code<Plan>::wake(data& s, std::uint32_t body, std::uint32_t other) {
    scoped([&] { detail::wake(s, body, other); });
}
template <class Plan>
void world_code<Plan>::wake_affected(data& s, std::uint32_t body) {
    scoped([&] { detail::wake_affected(s, body); });
}
template <class Plan>
void world_code<Plan>::add_force(data& s, body_id body, const char* function, vec force, bool local, const vec* point) {
    scoped([&] { detail::add_force(s, body, function, force, local, point); });
}
template <class Plan>
void world_code<Plan>::add_torque(data& s, body_id body, angular torque) {
    if constexpr (Plan::rotates) scoped([&] { detail::add_torque(s, body, torque); });
}
template <class Plan>
void world_code<Plan>::add_impulse(data& s, body_id body, const char* function, vec impulse, bool local,
                                   const vec* point) {
    scoped([&] { detail::add_impulse(s, body, function, impulse, local, point); });
}
template <class Plan>
void world_code<Plan>::add_angular_impulse(data& s, body_id body, angular impulse) {
    if constexpr (Plan::rotates) scoped([&] { detail::add_angular_impulse(s, body, impulse); });
}

template <class Plan>
void world_code<Plan>::set_type(data& s, std::uint32_t body, body_type type) {
    scoped([&] { detail::set_type(s, body, type); });
}
template <class Plan>
void world_code<Plan>::set_enabled(data& s, std::uint32_t body, bool enabled) {
    scoped([&] { detail::set_enabled(s, body, enabled); });
}
template <class Plan>
void world_code<Plan>::set_mass(data& s, std::uint32_t body, const mass_properties<S, D>& mass) {
    scoped([&] { detail::set_mass(s, body, mass); });
}
template <class Plan>
void world_code<Plan>::reset_mass(data& s, std::uint32_t body) {
    scoped([&] { detail::reset_mass(s, body); });
}
template <class Plan>
void world_code<Plan>::set_rotation_locked(data& s, std::uint32_t body, bool locked) {
    if constexpr (Plan::rotates) scoped([&] { detail::set_rotation_locked(s, body, locked); });
}
template <class Plan>
void world_code<Plan>::set_filter(data& s, std::uint32_t shape, const collision_filter& filter) {
    scoped([&] { detail::set_filter(s, shape, filter); });
}

template <class Plan>
auto world_code<Plan>::cast_ray(const state& s, vec origin, vec translation, const query_filter& filter) -> hit {
    hit first;
    scoped([&] {
        detail::cast_ray(s, "cast_ray", origin, translation, filter, [&](const hit& found) {
            if (comes_first(found, first)) first = found;
            return first.fraction;
        });
    });
    return first;
}
template <class Plan>
void world_code<Plan>::find_hits(const state& s, vec origin, vec translation, const query_filter& filter, hits& to) {
    scoped([&] {
        detail::cast_ray(s, "each_hit_along_ray", origin, translation, filter, [&](const hit& found) {
            to.push_back(found);
            return S(1);
        });
    });
    sort_in_place(to.begin(), to.size(), comes_first<hit>);
}
template <class Plan>
auto world_code<Plan>::closest_shape(const state& s, vec point, S reach, const query_filter& filter) -> closest {
    return scoped([&] { return detail::closest_shape(s, point, reach, filter); });
}
template <class Plan>
void world_code<Plan>::collide_shape(const state& s, const typename Plan::shape& shape, const transform& pose, S margin,
                                     const query_filter& filter, buffer<shape_contact<S, D>>& to) {
    scoped([&] { detail::collide_shape(s, shape, pose, margin, filter, to); });
}

/// Calls visit(hit) for shapes that a ray meets, the first ones first; visit may change the world. What it has
/// destroyed is left out.
template <class Plan, class Visit>
void each_hit_along_ray(const state<Plan>& s, vec<typename Plan::scalar, Plan::dimension> origin,
                        vec<typename Plan::scalar, Plan::dimension> translation, const query_filter& filter,
                        Visit&& visit) {
    typename world_code<Plan>::hits hits;
    world_code<Plan>::find_hits(s, origin, translation, filter, hits);
    for (const auto& hit : hits) {
        if (hit.shape.world != s.tag) return;
        if (s.shapes.contains(hit.shape.index, hit.shape.generation) && !go_on(visit, hit)) return;
    }
}

/// With a pose that places the shape as seen from the one that it has.
template <class Def, class Placed>
Def moved_def(Def def, const Placed& placed) {
    scoped([&] {
        def.position += def.rotation * placed.position;
        def.rotation = def.rotation * placed.rotation;
    });
    return def;
}
template <class Plan, class Shape>
shape_id create_shape(world_data<Plan>& s, body_id body, const Shape& shape, const typename Plan::shape_def& def) {
    const lookup at = find_body(s, body, "create_shape");
    if (!at || !scoped([&] { return check(shape, "create_shape"); })) return {};
    constexpr bool has_mass = solid_shape_for<Shape, typename Plan::scalar, Plan::dimension>;
    typename Plan::shape any;
    any = shape;
    return world_code<Plan>::insert_shape(s, at.index, any, has_mass, def);
}

}  // namespace detail

PHYSICS_HPP_END

/// Put PHYSICS_HPP_EXTERN(recipe) after a recipe in the header that shares it, in no namespace: units that use the
/// world then compile none of its long functions. One unit of the program must say PHYSICS_HPP_INSTANTIATE(recipe),
/// else the linker misses physics::detail::world_code<...>. Worlds of the same recipe in units without either are
/// compiled as always.
#define PHYSICS_HPP_EXTERN(...) \
    extern template struct physics::detail::world_code<physics::detail::plan_of<__VA_ARGS__>::type>;
#define PHYSICS_HPP_INSTANTIATE(...) \
    template struct physics::detail::world_code<physics::detail::plan_of<__VA_ARGS__>::type>;
