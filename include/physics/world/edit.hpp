// How bodies and shapes come and change between steps.
#pragma once

#include "physics/world/removal.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Makes room for one body more, so that nothing fails once it is there.
template <class Plan>
void reserve_body(world_data<Plan>& s) {
    const std::uint32_t slots = s.bodies.slots() + 1;
    s.bodies.reserve(slots);
    s.contact_starts.reserve(slots);
    s.body_values.reserve(slots);
    if constexpr (Plan::sleeps) s.sleep.reserve(slots);
    if constexpr (Plan::has_joints) s.joints.first.reserve(slots);
    if constexpr (Plan::is_continuous) s.continuous.extents.reserve(slots);
}
template <class Plan>
body_id create_body(world_data<Plan>& s, const body_def<typename Plan::scalar, Plan::dimension>& def) {
    if (!check_not_in_step(s, "create_body") || !check_body(def) ||
        !check_turn<Plan>("create_body", def.angular_velocity, def.angular_damping) ||
        !check_continuous<Plan>("create_body", def.continuous))
        return {};
    typename Plan::body b;
    b.type = def.enabled ? def.type : body_type::static_body;
    b.given_type = def.type;
    b.enabled = def.enabled;
    b.rotation = normalized(def.rotation);
    b.center = def.position;
    if (def.type != body_type::static_body) b.velocity.linear = def.linear_velocity;
    b.linear_damping = def.linear_damping;
    b.gravity_scale = def.gravity_scale;
    if constexpr (Plan::rotates) {
        if (def.type != body_type::static_body) b.velocity.angular = def.angular_velocity;
        b.angular_damping = def.angular_damping;
        b.rotation_locked = def.rotation_locked;
    }
    b.can_sleep = def.can_sleep;
    b.continuous = def.continuous;
    b.user_data = def.user_data;
    reserve_body(s);
    const auto place = s.bodies.insert(b);
    if constexpr (Plan::sleeps) s.sleep.start(place.index, b.center);
    s.contact_starts.resize(s.bodies.slots());
    s.body_values.start(place.index);
    if constexpr (Plan::has_joints) s.joints.first.resize(s.bodies.slots(), no_joint);
    s.awake.is_stale = true;
    refresh_mass(s, place.index);
    return {place.index, place.generation, s.tag};
}

/// Adds a shape that has been checked to a body; without a mass, only to one that is not dynamic.
template <class Plan>
shape_id insert_shape(world_data<Plan>& s, std::uint32_t body, const typename Plan::shape& shape, bool has_mass,
                      const typename Plan::shape_def& def) {
    using S = typename Plan::scalar;
    const char* f = "create_shape";
    if (!check_pose(f, def.position, def.rotation) || !check_not_negative(f, "density", def.density)) return {};
    if constexpr (Plan::features::materials)
        if (!check_material<Plan>(f, def.material)) return {};
    if (!Plan::events::sensors && def.sensor) {
        refuse(f, "sensor", "true", "the recipe does not name event::sensor");
        return {};
    }
    if (def.senses_static && !def.sensor) {
        refuse(f, "senses_static", "true", "only sensors may");
        return {};
    }
    if (!Plan::has_contact_rule && def.one_way) {
        refuse(f, "one_way", "true", "the recipe names no contact rule, such as one_way_platforms");
        return {};
    }
    const auto& owner = s.bodies[body];
    const bool is_dynamic = owner.given_type == body_type::dynamic_body;
    if (!has_mass && is_dynamic && !def.sensor) {
        refuse(f, "shape", "without mass", "a dynamic body needs shapes that have a mass");
        return {};
    }
    shape_record<Plan> record;
    record.shape = shape;
    record.local = {def.position, normalized(def.rotation)};
    if constexpr (Plan::features::materials) record.material = def.material;
    record.density = def.density;
    record.filter = def.filter;
    record.sensor = def.sensor;
    record.senses_static = def.senses_static;
    record.one_way = def.one_way;
    record.body = body;
    record.user_data = def.user_data;
    update_pose(record, owner.pose(), owner.center);
    const auto box = query_bounds(s, record);
    if (!check_extent(f, box)) return {};
    if (def.density > S(0) && !def.sensor && is_dynamic && !owner.mass_is_set &&
        !check_shapes_mass(s, body, f, no_shape, &record))
        return {};
    // What may fail comes first.
    const std::uint32_t slots = s.shapes.slots() + 1;
    s.shapes.reserve(slots);
    s.shape_values.reserve(slots);
    if constexpr (Plan::events::sensors) {
        s.sensors.is_sensor.grow(slots);
        s.sensors.of_static.reserve(s.sensors.of_static.size() + 1);
    }
    start_waking(s);
    list_affected(s, body);
    if (owner.enabled) list_near_shape(s, record, owner.type);
    prepare_waking(s, slots, 1);
    // What a sleeper touches is among the contacts that move with its centre of mass.
    finish_waking(s);
    const auto place = s.shapes.insert(record);
    s.shape_values.start(place.index);
    if constexpr (Plan::events::sensors) {
        if (def.sensor) {
            s.sensors.is_sensor.set(place.index);
            s.sensors.count = s.sensors.count + 1;
            if (def.senses_static) s.sensors.of_static.push_back(place.index);
        }
    }
    std::uint32_t* link = &s.bodies[body].first_shape;
    while (*link != no_shape && *link > place.index) link = &s.shapes[*link].next;
    s.shapes[place.index].next = std::exchange(*link, place.index);
    s.broadphase.insert(place.index, box, filter_of(s, record));
    // What is not dynamic takes no mass from it: n shapes on one body cost O(n).
    if (is_dynamic) refresh_mass(s, body);
    else if (!def.sensor) extend_extent(s, s.shapes[place.index]);
    return {place.index, place.generation, s.tag};
}

template <class Plan>
void set_pose(world_data<Plan>& s, std::uint32_t index, const transform<typename Plan::scalar, Plan::dimension>& pose) {
    const char* f = "set_pose";
    auto& b = s.bodies[index];
    if (!has_point(pose, b.mass.center)) {
        refuse(f, "centre of mass", largest_magnitude(pose * b.mass.center), "it must lie within the scalar's range");
        return;
    }
    auto there = b;
    there.set_pose(pose);
    bool fits = true;
    std::uint32_t count = 0;
    start_waking(s);
    each_shape(s, index, [&](std::uint32_t, shape_record<Plan> shape) {
        update_pose(shape, there.pose(), there.center);
        fits = fits && check_extent(f, query_bounds(s, shape));
        if (fits && b.enabled) list_near_shape(s, shape, b.type);
        ++count;
    });
    if (!fits) return;
    list_affected(s, index);
    if (b.enabled) list_connected(s, index);
    // What sleeps in its sensors is looked at again.
    if constexpr (Plan::events::sensors)
        if (s.sensors.count > 0 && b.type == body_type::static_body) list_near(s, index, b.pose());
    prepare_waking(s, count);
    finish_waking(s);
    b.set_pose(pose);
    if (b.type == body_type::static_body) s.awake.is_stale = true;
    refresh_boxes(s, index);
}

/// Wakes what lies on a kinematic body's way, unless it is told to stay where it is.
template <class Plan>
void move_to(world_data<Plan>& s, std::uint32_t index, vec<typename Plan::scalar, Plan::dimension> position,
             const rotation<typename Plan::scalar, Plan::dimension>& rotation) {
    auto& b = s.bodies[index];
    // As it is turned, to the bit: it stands then.
    const auto turn = rotation == b.rotation ? b.rotation : normalized(rotation);
    // Accept only the body's own rotation, as stored or as given before normalisation.
    if (!Plan::rotates && !(rotation == b.rotation) && !(turn == b.rotation)) {
        refuse("move_to", "rotation", "another one", "the recipe leaves rotation out");
        return;
    }
    const transform<typename Plan::scalar, Plan::dimension> pose{position, Plan::rotates ? turn : b.rotation};
    if (!(pose == b.pose())) {
        start_waking(s);
        list_near(s, index, pose);
        prepare_waking(s);
        finish_waking(s);
    }
    b.target = pose;
    b.has_target = true;
}

/// A velocity that the user gives a body takes the place of one that it has from a target.
template <class Plan>
auto& velocity_to_set(world_data<Plan>& s, std::uint32_t index) {
    auto& b = s.bodies[index];
    if (std::exchange(b.at_target, false)) b.velocity = {};
    return b.velocity;
}

template <class Plan>
void set_mass(world_data<Plan>& s, std::uint32_t index,
              const mass_properties<typename Plan::scalar, Plan::dimension>& mass) {
    const char* f = "set_mass";
    const bool nothing_turns_it = mass.inertia == decltype(mass.inertia){};
    if (!Plan::rotates && !nothing_turns_it) {
        refuse(f, "inertia", "not 0", "the recipe leaves rotation out");
        return;
    }
    if (!check_bounded(f, "center", mass.center) ||
        !check_mass(f, s.bodies[index], converted<double>(mass), nothing_turns_it) ||
        (!nothing_turns_it && !check_spread(f, converted<double>(mass).inertia)))
        return;
    wake_affected(s, index);
    s.bodies[index].mass_is_set = true;
    set_mass_properties(s, index, mass);
}
template <class Plan>
void reset_mass(world_data<Plan>& s, std::uint32_t index) {
    if (!check_shapes_mass(s, index, "reset_mass")) return;
    wake_affected(s, index);
    s.bodies[index].mass_is_set = false;
    refresh_mass(s, index);
}

template <class Plan>
void set_rotation_locked(world_data<Plan>& s, std::uint32_t index, bool locked) {
    wake_affected(s, index);
    auto& b = s.bodies[index];
    b.rotation_locked = locked;
    if (locked) b.velocity.angular = {};
    refresh_mass(s, index);
}

template <class Plan>
void set_material(world_data<Plan>& s, shape_id id, const material<typename Plan::scalar, Plan::dimension>& m) {
    const lookup at = find_shape(s, id, "set_material");
    if (!at || !check_material<Plan>("set_material", m)) return;
    wake_affected(s, s.shapes[at.index].body);
    s.shapes[at.index].material = m;
}

/// Contacts with what the shape meets no longer go at once; others keep their impulses.
template <class Plan>
void set_filter(world_data<Plan>& s, std::uint32_t index, const collision_filter& filter) {
    auto& shape = s.shapes[index];
    if (filter == shape.filter) return;
    auto filtered = shape;
    filtered.filter = filter;
    const auto& owner = s.bodies[shape.body];
    index_contacts(s);
    start_waking(s);
    list_affected(s, shape.body);
    if (owner.enabled) {
        if (shape.sensor) list_near_shape(s, shape, owner.type);
        list_near_shape(s, filtered, owner.type);
    }
    prepare_removal(
        s, [&](auto&& of) { of(shape.body); }, index);
    finish_waking(s);
    shape.filter = filter;
    drop_contacts(s, shape.body, [&](const auto& c) {
        return (c.shape_a == index || c.shape_b == index) &&
               !may_meet(s.shapes[c.shape_a].filter, s.shapes[c.shape_b].filter);
    });
    s.broadphase.erase(index);
    s.broadphase.insert(index, query_bounds(s, shape), filter_of(s, shape));
}

template <class Plan>
bool is_continuous(const state<Plan>& s, body_id id) {
    const lookup at = find_body(s, id, "continuous");
    return at && s.bodies[at.index].continuous;
}
template <class Plan>
void set_continuous(world_data<Plan>& s, body_id id, bool on) {
    const char* f = "set_continuous";
    const lookup at = find_body(s, id, f);
    if (at && check_continuous<Plan>(f, on)) s.bodies[at.index].continuous = on;
}

/// Tells the broadphase where all shapes are now. Nothing fails after reserve_changes for all of them.
template <class Plan>
void refresh_all_boxes(state<Plan>& s) {
    s.bodies.each([&](std::uint32_t i, const auto&) {
        refresh_boxes<Plan>(s.bodies, s.settings.contact_margin, s.shapes, s.broadphase, i);
    });
    update_broadphase(s);
}

/// Brings a world to settings that have been checked.
template <class Plan>
void change_settings(world_data<Plan>& s, const typename Plan::settings& settings) {
    bool wakes = !(settings.gravity == s.settings.gravity);
    if constexpr (!Plan::features::materials) wakes = wakes || !(settings.material == s.settings.material);
    if constexpr (Plan::sleeps) wakes = wakes || !settings.sleeping.enabled;
    start_waking(s);
    if (wakes) list_all(s);
    prepare_waking(s, s.shapes.count());
    finish_waking(s);
    // What was carried along was found within the old margin.
    if (settings.contact_margin != s.settings.contact_margin) s.memories.clear();
    if constexpr (Plan::sleeps)
        if (!settings.sleeping.enabled)
            for (auto& sleep_time : s.sleep.sleep_time) sleep_time = {};
    s.settings = settings;
    configure_broadphase(s);
    refresh_all_boxes(s);
}

template <class Plan>
void set_settings(world_data<Plan>& s, const typename Plan::settings& settings) {
    const char* f = "set_settings";
    if (!check_not_in_step(s, f) || !check_settings<Plan>(settings, f)) return;
    bool fits = true;
    if (settings.contact_margin > s.settings.contact_margin)
        s.shapes.each([&](std::uint32_t, const auto& shape) {
            fits = fits && check_extent(f, box_within(settings.contact_margin, shape));
        });
    if (fits) change_settings(s, settings);
}

template <class Plan>
void shift_origin(world_data<Plan>& s, const vec<typename Plan::scalar, Plan::dimension>& to) {
    const char* f = "shift_origin";
    if (!check_not_in_step(s, f) || !check_in_range(f, "to", to)) return;
    bool fits = true;
    s.bodies.each([&](std::uint32_t i, auto b) {
        fits = fits && check_in_range(f, "centre of mass", b.center) &&
               check_in_range(f, "shifted centre of mass", b.center - to) &&
               (!b.has_target || check_in_range(f, "shifted target", b.target.position - to));
        b.center -= to;
        each_shape(s, i, [&](std::uint32_t, shape_record<Plan> shape) {
            update_pose(shape, b.pose(), b.center);
            fits = fits && check_extent(f, query_bounds(s, shape));
        });
    });
    if (!fits) return;
    reserve_changes(s.broadphase, s.shapes.slots(), s.shapes.count());
    s.bodies.each([&]([[maybe_unused]] std::uint32_t i, auto& b) {
        b.center -= to;
        if (b.has_target) b.target.position -= to;
        if constexpr (Plan::sleeps) s.sleep.sleep_anchor[i] -= to;
    });
    for (auto& start : s.contact_starts) start.position -= to;
    if constexpr (Plan::has_joints)
        s.joints.each_kind(s.joints, [&](std::uint32_t, auto& of_kind) {
            of_kind.each([&](std::uint32_t, auto& stored) {
                if constexpr (requires { stored.joint.shift_origin(to); }) stored.joint.shift_origin(to);
            });
        });
    refresh_all_boxes(s);
}

}  // namespace detail

PHYSICS_HPP_END
