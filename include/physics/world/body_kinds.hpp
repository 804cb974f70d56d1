// How bodies become static, kinematic, dynamic, disabled or enabled.
#pragma once

#include "physics/world/removal.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

template <class Plan>
void set_type(world_data<Plan>& s, std::uint32_t index, body_type type) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const char* f = "set_type";
    auto& b = s.bodies[index];
    if (!check_type(f, type) || type == b.given_type) return;
    if (type == body_type::dynamic_body) {
        bool solid = true;
        each_shape(s, index, [&](std::uint32_t, const auto& record) {
            if (record.sensor) return;
            record.shape.visit([&](const auto& shape) {
                solid = solid && solid_shape_for<std::remove_cvref_t<decltype(shape)>, S, D>;
            });
        });
        if (!solid) {
            refuse(f, "shape", "without mass", "a dynamic body needs shapes that have a mass");
            return;
        }
        if (!b.mass_is_set && !check_shapes_mass(s, index, f)) return;
    }
    index_contacts(s);
    start_waking(s);
    list_affected(s, index);
    prepare_removal(
        s, [&](auto&& of) { of(index); }, no_shape);
    finish_waking(s);
    if (type == body_type::static_body) b.velocity = {};
    if (type != body_type::dynamic_body) {
        b.force = {};
        b.torque = {};
    }
    b.has_target = false;
    b.at_target = false;
    b.given_type = type;
    if (b.enabled) b.type = type;
    s.awake.is_stale = true;
    refresh_mass(s, index);
    reinsert_proxies(s, index);
    drop_contacts(s, index, [&](const auto& c) {
        return !s.bodies[c.bodies.body_a].is_dynamic() && !s.bodies[c.bodies.body_b].is_dynamic();
    });
}

/// Tells joints of a body whether both of theirs are enabled.
template <class Plan>
void note_enabled([[maybe_unused]] world_data<Plan>& s, [[maybe_unused]] std::uint32_t index) {
    if constexpr (Plan::has_joints)
        s.joints.each_of(index, [&](std::uint32_t i, const joint_record& record) {
            s.joints.records[i].bodies_enabled = s.bodies[record.body_a].enabled && s.bodies[record.body_b].enabled;
        });
}
template <class Plan>
void disable(world_data<Plan>& s, std::uint32_t index) {
    auto& b = s.bodies[index];
    start_waking(s);
    list_affected(s, index);
    // What sleeps in its sensors is looked at again; those of a static body wake it.
    each_shape(s, index, [&](std::uint32_t, const auto& record) {
        if (record.sensor) list_near_shape(s, record, body_type::static_body);
    });
    prepare_removal(
        s, [&](auto&& of) { of(index); }, no_shape);
    finish_waking(s);
    b.type = body_type::static_body;
    b.enabled = false;
    if (b.at_target) b.velocity = {};
    b.has_target = b.at_target = false;
    b.force = {};
    b.torque = {};
    set_mass_properties(s, index, b.mass);
    note_enabled(s, index);
    remove_contacts(s, index, no_shape);
    s.awake.is_stale = true;
    reinsert_proxies(s, index);
}
template <class Plan>
void enable(world_data<Plan>& s, std::uint32_t index) {
    auto& b = s.bodies[index];
    std::uint32_t count = 0;
    start_waking(s);
    each_shape(s, index, [&](std::uint32_t, const auto& shape) {
        list_near_shape(s, shape, b.given_type);
        ++count;
    });
    if constexpr (Plan::sleeps && Plan::has_joints)
        s.joints.each_of(index, [&](std::uint32_t, const joint_record& r) {
            if (r.enabled && s.bodies[r.other(index)].enabled && s.joints.holds(r.kind)) list_island(s, r.other(index));
        });
    prepare_waking(s, count);
    finish_waking(s);
    b.enabled = true;
    b.type = b.given_type;
    if constexpr (Plan::sleeps) s.sleep.start(index, b.center);
    refresh_mass(s, index);
    note_enabled(s, index);
    s.awake.is_stale = true;
    reinsert_proxies(s, index);
}
template <class Plan>
void set_enabled(world_data<Plan>& s, std::uint32_t index, bool enabled) {
    if (enabled == s.bodies[index].enabled) return;
    if (enabled) enable(s, index);
    else disable(s, index);
}

}  // namespace detail

PHYSICS_HPP_END
