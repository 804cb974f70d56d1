// How bodies and shapes go between steps.
#pragma once

#include "physics/world/check.hpp"
#include "physics/world/wake.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Forgets the contacts of a body for which gone(contact) is true, as the next step begins; to all they are gone at
/// once. Nothing fails after index_contacts.
template <class Plan, class Gone>
void drop_contacts(world_data<Plan>& s, std::uint32_t body, Gone&& gone) {
    each_contact(s, body, [&](auto& in, std::uint32_t at) {
        auto& c = in[at];
        if (!gone(c)) return;
        if constexpr (Plan::events::contacts) note_dropped<Plan>(c, s.bodies, s.shapes, s.dropped.list);
        s.removed.add(c);
    });
}

/// Forgets the contacts of a body's shapes, or of one of them only unless that is no_shape, as the next step begins; to
/// all they are gone at once.
template <class Plan>
void remove_contacts(world_data<Plan>& s, std::uint32_t body, std::uint32_t shape) {
    if constexpr (Plan::events::contacts)
        each_contact(s, body, [&](const auto& in, std::uint32_t at) {
            if (shape == no_shape || in[at].shape_a == shape || in[at].shape_b == shape)
                note_dropped<Plan>(in[at], s.bodies, s.shapes, s.dropped.list);
        });
    s.removed.make_room(s.shapes.slots());
    if (shape != no_shape) s.removed.add(shape);
    else each_shape(s, body, [&](std::uint32_t i, const auto&) { s.removed.add(i); });
}

/// Takes the memory to wake what is listed, and to remove bodies, for which each(f) calls f(body), or just a
/// shape of them unless that is no_shape, or to enter them into the broadphase anew. It changes nothing of the world.
template <class Plan, class Each>
void prepare_removal(world_data<Plan>& s, Each&& each, std::uint32_t shape) {
    std::uint32_t shapes = 0;
    [[maybe_unused]] std::uint32_t contacts = 0, joints = 0;
    each([&](std::uint32_t body) {
        each_shape(s, body, [&](std::uint32_t i, const auto&) { shapes += shape == no_shape || i == shape; });
        if constexpr (Plan::events::contacts) each_contact(s, body, [&](const auto&, std::uint32_t) { ++contacts; });
        if constexpr (Plan::has_joints && Plan::events::joint_limits)
            s.joints.each_of(body, [&](std::uint32_t, const auto&) { ++joints; });
    });
    s.removed.reserve(s.shapes.slots());
    if constexpr (Plan::events::contacts) s.dropped.list.reserve(s.dropped.list.size() + contacts);
    if constexpr (Plan::has_joints && Plan::events::joint_limits)
        s.joint_limits.dropped.reserve(s.joint_limits.dropped.size() + joints);
    if constexpr (Plan::events::sensors) s.sensors.prepare_removal();
    prepare_waking(s, shapes);
}

/// Takes a joint out of its bodies' lists and of its kind.
template <class Plan>
void erase_joint(world_data<Plan>& s, std::uint32_t index) {
    if constexpr (Plan::events::joint_limits) drop_limit(s.joints, s.bodies, index, s.joint_limits);
    const joint_record gone = s.joints.records[index];
    for (const std::uint32_t body : {gone.body_a, gone.body_b}) {
        std::uint32_t* link = &s.joints.first[body];
        while (*link != index) link = &s.joints.records[*link].next(body);
        *link = gone.next(body);
    }
    s.joints.each_kind(s.joints, [&](std::uint32_t kind, auto& of_kind) {
        if (kind == gone.kind) of_kind.erase(gone.slot);
    });
    s.joints.records.erase(index);
}

/// Forgets shapes as sensors, and in sensors, for which each(f) calls f(shape).
template <class Plan, class Each>
void drop_sensors([[maybe_unused]] world_data<Plan>& s, [[maybe_unused]] Each&& each) {
    if constexpr (Plan::events::sensors) {
        each([&](std::uint32_t shape) {
            drop_visitors<Plan>(s.bodies, s.shapes, s.sensors, shape);
            if (!s.sensors.is_sensor[shape]) return;
            s.sensors.is_sensor.clear(shape);
            s.sensors.count = s.sensors.count - 1;
            auto& list = s.sensors.of_static;
            for (std::uint32_t i = 0; i < list.size() && s.shapes[shape].senses_static; ++i) {
                if (list[i] != shape) continue;
                list[i] = list.back();
                list.pop_back();
            }
        });
    }
}

/// Removes bodies, for which each(f) calls f(body).
template <class Plan, class Each>
void destroy_bodies(world_data<Plan>& s, Each&& each) {
    start_waking(s);
    list_affected(s, each);
    prepare_removal(s, each, no_shape);
    finish_waking(s);
    each([&](std::uint32_t body) { remove_contacts(s, body, no_shape); });
    if constexpr (Plan::has_joints)
        each([&](std::uint32_t body) {
            s.joints.each_of(body, [&](std::uint32_t i, const auto&) { erase_joint(s, i); });
        });
    s.awake.is_stale = true;
    drop_sensors(s, [&](auto&& f) {
        each([&](std::uint32_t body) { each_shape(s, body, [&](std::uint32_t i, const auto&) { f(i); }); });
    });
    each([&](std::uint32_t body) {
        each_shape(s, body, [&](std::uint32_t i, const shape_record<Plan>&) {
            s.broadphase.erase(i);
            s.shapes.erase(i);
        });
        s.bodies.erase(body);
    });
}
template <class Plan>
void destroy_body(world_data<Plan>& s, std::uint32_t index) {
    destroy_bodies(s, [&](auto&& f) { f(index); });
}
template <class Plan>
void destroy_bodies(world_data<Plan>& s, const body_id* ids, std::uint32_t count) {
    const char* f = "destroy_bodies";
    if (count == 0 || !check_not_in_step(s, f)) return;
    if (ids == nullptr) {
        refuse(f, "ids", "null", "it must hold as many as are to be destroyed");
        return;
    }
    bit_array gone;
    gone.grow(s.bodies.slots());
    for (std::uint32_t i = 0; i < count; ++i) {
        const lookup at = find_body(s, ids[i], f);
        if (!at) return;
        if (gone[at.index]) {
            refuse(f, "body", static_cast<double>(at.index), "it must be listed once");
            return;
        }
        gone.set(at.index);
    }
    destroy_bodies(s, [&](auto&& destroy) {
        for (std::uint32_t i = 0; i < count; ++i) destroy(ids[i].index);
    });
}
template <class Plan>
void clear(world_data<Plan>& s) {
    if (!check_not_in_step(s, "clear")) return;
    buffer<std::uint32_t> all;
    s.bodies.each([&](std::uint32_t i, const auto&) { all.push_back(i); });
    destroy_bodies(s, [&](auto&& destroy) {
        for (const std::uint32_t i : all) destroy(i);
    });
}

template <class Plan>
void destroy_shape(world_data<Plan>& s, std::uint32_t index) {
    const std::uint32_t body = s.shapes[index].body;
    const auto& owner = s.bodies[body];
    if (owner.given_type == body_type::dynamic_body && !owner.mass_is_set &&
        !check_shapes_mass(s, body, "destroy_shape", index))
        return;
    start_waking(s);
    list_affected(s, body);
    prepare_removal(
        s, [&](auto&& f) { f(body); }, index);
    finish_waking(s);
    remove_contacts(s, body, index);
    drop_sensors(s, [&](auto&& f) { f(index); });
    std::uint32_t* link = &s.bodies[body].first_shape;
    while (*link != index) link = &s.shapes[*link].next;
    *link = s.shapes[index].next;
    s.broadphase.erase(index);
    s.shapes.erase(index);
    refresh_mass(s, body);
}

}  // namespace detail

PHYSICS_HPP_END
