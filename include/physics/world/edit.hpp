// How bodies and shapes come, go and change between steps; every check of the user's numbers.
#pragma once

#include "physics/base/probe.hpp"
#include "physics/world/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Looks a handle up: its index, or none after refusing a null, foreign or stale one.
struct found {
    std::uint32_t index;
    bool ok;
    explicit operator bool() const { return ok; }
};
template <class Plan, class Pool, class Tag>
found find(const state<Plan>& s, const Pool& pool, handle<Tag> id, const char* function, const char* what) {
    if (!id) return {0, refuse(function, what, "null", "it must name something that this world has created")};
    char name[32];
    std::snprintf(name, sizeof name, "#%u", static_cast<unsigned>(id.index));
    if (id.world != s.tag) return {0, refuse(function, what, name, "it belongs to another world")};
    if (!pool.contains(id.index, id.generation)) return {0, refuse(function, what, name, "it has been destroyed")};
    return {id.index, true};
}
template <class Plan>
found find_body(const state<Plan>& s, body_id id, const char* function) {
    return find(s, s.bodies, id, function, "body");
}
template <class Plan>
found find_shape(const state<Plan>& s, shape_id id, const char* function) {
    return find(s, s.shapes, id, function, "shape");
}
/// The same for calls that only dynamic bodies take.
template <class Plan>
found find_dynamic(const state<Plan>& s, body_id id, const char* function) {
    const found f = find_body(s, id, function);
    if (f && !s.bodies[f.index].is_dynamic())
        return {0, refuse(function, "body", s.bodies[f.index].type == body_type::static_body ? "static" : "kinematic", "it must be dynamic")};
    return f;
}

template <class S, int D>
bool check_rotation(const char* function, const char* field, const rotation<S, D>& r) {
    const double error = is_finite(r) ? static_cast<double>(norm_error(r)) : 1.0;
    return error < 1e-3 || refuse(function, field, error, "is how far its squared length is from 1; it must be below 0.001");
}
template <class S, int D>
bool check_pose(const char* function, vec<S, D> position, const rotation<S, D>& r) {
    return check_finite(function, "position", position) && check_rotation(function, "rotation", r);
}
template <class S, int D>
bool check_body(const body_def<S, D>& def) {
    const char* f = "create_body";
    return check_pose(f, def.position, def.rotation) && check_finite(f, "linear_velocity", def.linear_velocity) &&
           check_finite(f, "angular_velocity", def.angular_velocity) && check_not_negative(f, "linear_damping", def.linear_damping) &&
           check_not_negative(f, "angular_damping", def.angular_damping) && check_finite(f, "gravity_scale", def.gravity_scale);
}
template <class S>
bool check_material(const char* function, const material<S>& m) {
    if (!check_not_negative(function, "friction", m.friction) || !check_not_negative(function, "restitution", m.restitution)) return false;
    return !(m.restitution > S(1)) || refuse(function, "restitution", static_cast<double>(m.restitution), "it must be at most 1");
}
template <class Plan, class Settings>
bool check_settings(const Settings& with, const char* function) {
    return check_finite(function, "gravity", with.gravity) && check_not_negative(function, "contact_margin", with.contact_margin) &&
           check_not_negative(function, "box_margin", with.box_margin) && check(with.solver, function);
}

/// Refuses to make a world of floating-point numbers where arithmetic would not give the same bits as
/// everywhere. What the step itself repairs, rounding modes and flushing to zero, is no reason to refuse.
template <class S>
bool check_environment([[maybe_unused]] const char* function) {
#ifndef PHYSICS_HPP_NONDETERMINISTIC
    if constexpr (std::floating_point<S>) {
        const float_control_scope control;
        const auto faults = float_environment();
        if (faults != 0)
            return refuse(function, "arithmetic", float_fault_names(faults).c_str(),
                          "compile without the flags that allow it, or define PHYSICS_HPP_NONDETERMINISTIC");
    }
#endif
    return true;
}

/// True if the type can hold the value to one percent: neither rounded away nor out of range.
template <class S>
bool representable(double value) {
    const double back = static_cast<double>(static_cast<S>(value));
    const double error = back < value ? value - back : back - value;
    return error <= 0.01 * (value < 0 ? -value : value);
}
template <class S>
bool check_mass_value(const char* function, const char* field, double value) {
    if (!(value > 0)) return refuse(function, field, value, "it must be greater than 0");
    if (!representable<S>(value) || !representable<inverse_of<S>>(1 / value))
        return refuse(function, field, value, "it or its inverse is beyond the scalar's range; use other units of length or mass");
    return true;
}
/// Says whether a dynamic body can have these mass properties, given in double.
template <class S>
bool check_mass(const char* function, const mass_properties<double, 2>& m) {
    return check_mass_value<S>(function, "mass", m.mass) && check_mass_value<S>(function, "inertia", m.inertia);
}
template <class S>
bool check_mass(const char* function, const mass_properties<double, 3>& m) {
    const symmetric<double> inv = inverse<double>(m.inertia);
    if (!(inv.xx > 0)) return refuse(function, "inertia", m.inertia.xx, "is its first entry; the tensor must be positive definite");
    return check_mass_value<S>(function, "mass", m.mass) && check_mass_value<S>(function, "inertia.xx", m.inertia.xx) &&
           check_mass_value<S>(function, "inertia.yy", m.inertia.yy) && check_mass_value<S>(function, "inertia.zz", m.inertia.zz);
}

template <class T, class S>
transform<T, 2> converted(const transform<S, 2>& t) {
    return {{static_cast<T>(t.position.x), static_cast<T>(t.position.y)}, {static_cast<T>(t.rotation.cosine), static_cast<T>(t.rotation.sine)}};
}
template <class T, class S>
transform<T, 3> converted(const transform<S, 3>& t) {
    const auto& r = t.rotation;
    return {{static_cast<T>(t.position.x), static_cast<T>(t.position.y), static_cast<T>(t.position.z)},
            {static_cast<T>(r.x), static_cast<T>(r.y), static_cast<T>(r.z), static_cast<T>(r.w)}};
}
template <class T, class S>
mass_properties<T, 2> converted(const mass_properties<S, 2>& m) {
    return {static_cast<T>(m.mass), {static_cast<T>(m.center.x), static_cast<T>(m.center.y)}, static_cast<T>(m.inertia)};
}
template <class T, class S>
mass_properties<T, 3> converted(const mass_properties<S, 3>& m) {
    const auto& i = m.inertia;
    return {static_cast<T>(m.mass),
            {static_cast<T>(m.center.x), static_cast<T>(m.center.y), static_cast<T>(m.center.z)},
            {static_cast<T>(i.xx), static_cast<T>(i.yy), static_cast<T>(i.zz), static_cast<T>(i.xy), static_cast<T>(i.xz), static_cast<T>(i.yz)}};
}

/// The mass of one shape in its body's frame, computed with the scalar T; none for shapes without mass.
template <class T, class Plan>
auto mass_of_shape(const typename Plan::shape& shape, const transform<typename Plan::scalar, Plan::dimension>& local,
                   typename Plan::scalar density) {
    return shape.visit([&](const auto& s) -> mass_properties<T, Plan::dimension> {
        using shape_type = std::remove_cvref_t<decltype(s)>;
        if constexpr (solid_shape_for<shape_type, typename Plan::scalar, Plan::dimension>)
            return transformed(mass_of(s.template as<T>(), static_cast<T>(density)), converted<T>(local));
        else return {};
    });
}
/// The mass of all shapes of a body, computed with the scalar T.
template <class T, class Plan>
auto mass_of_shapes(const state<Plan>& s, std::uint32_t body) {
    mass_properties<T, Plan::dimension> sum;
    each_shape(s, body, [&](std::uint32_t, const shape_record<Plan>& shape) {
        sum = combined(sum, mass_of_shape<T, Plan>(shape.shape, shape.local, shape.density));
    });
    return sum;
}

/// Gives a body its mass, its centre and what follows from them; the frame and the velocity of its
/// material points stay.
template <class S, int D>
void set_mass_properties(body<S, D>& b, const mass_properties<S, D>& mass) {
    const transform<S, D> pose = b.pose();
    const vec<S, D> old_center = b.center;
    b.mass = mass;
    b.set_pose(pose);
    b.velocity.linear += cross(b.velocity.angular, b.center - old_center);
    b.inverse_mass = {};
    b.inverse_inertia = {};
    b.is_gyroscopic = b.is_dynamic() && !b.rotation_locked && !is_isotropic(mass.inertia);
    if (!b.is_dynamic()) return;
    b.inverse_mass = reciprocal<inverse_of<S>>(mass.mass);
    if (!b.rotation_locked) b.inverse_inertia = inverted_inertia(mass.inertia);
}
/// Mass from shapes, unless the user has set it. A body without any mass is a point of 1 kg at its origin.
template <class Plan>
void refresh_mass(state<Plan>& s, std::uint32_t index) {
    using S = typename Plan::scalar;
    auto& b = s.bodies[index];
    if (b.mass_is_set) return set_mass_properties(b, mass_properties<S, Plan::dimension>(b.mass));
    auto mass = mass_of_shapes<S>(s, index);
    if (!(mass.mass > S(0))) mass = {S(1), {}, {}};
    set_mass_properties(b, mass);
}

/// Tells the broadphase where the shapes of a body are now.
template <class Plan>
void refresh_boxes(state<Plan>& s, std::uint32_t body) {
    each_shape(s, body, [&](std::uint32_t i, shape_record<Plan>& shape) {
        shape.fat_box = fat_box(s, shape);
        s.broadphase.move(i, shape.fat_box);
    });
}

template <class Plan>
body_id create_body(state<Plan>& s, const body_def<typename Plan::scalar, Plan::dimension>& def) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    if (!check_body(def)) return {};
    body<S, D> b;
    b.type = def.type;
    b.rotation = normalized(def.rotation);
    b.center = def.position;
    if (def.type != body_type::static_body) b.velocity = {def.linear_velocity, def.angular_velocity};
    b.linear_damping = def.linear_damping;
    b.angular_damping = def.angular_damping;
    b.gravity_scale = def.gravity_scale;
    b.rotation_locked = def.rotation_locked;
    b.user_data = def.user_data;
    const auto place = s.bodies.insert(b);
    refresh_mass(s, place.index);
    return {place.index, place.generation, s.tag};
}

/// Forgets the contacts for which gone(contact) is true; the others keep their order.
template <class Plan, class Gone>
void drop_contacts(state<Plan>& s, Gone&& gone) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < s.contacts.size(); ++i)
        if (!gone(s.contacts[i])) s.contacts[kept++] = s.contacts[i];
    while (s.contacts.size() > kept) s.contacts.pop();
}

template <class Plan, class Shape>
shape_id create_shape(state<Plan>& s, body_id body, const Shape& shape, const shape_def<typename Plan::scalar, Plan::dimension>& def) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const char* f = "create_shape";
    static_assert(Plan::shape::template kind_of<Shape>() >= 0,
                  "physics::world::create_shape: the recipe's set of shapes lacks this one; name it in physics::shapes<...>");
    const found at = find_body(s, body, f);
    if (!at || !check(shape, f) || !check_pose(f, def.position, def.rotation) || !check_not_negative(f, "density", def.density) ||
        !check_material(f, def.material))
        return {};
    if constexpr (!solid_shape_for<Shape, S, D>) {
        if (s.bodies[at.index].is_dynamic()) {
            refuse(f, "shape", "without mass", "a dynamic body needs shapes that have a mass");
            return {};
        }
    }
    shape_record<Plan> record;
    record.shape = shape;
    record.local = {def.position, normalized(def.rotation)};
    record.material = def.material;
    record.density = def.density;
    record.body = at.index;
    record.next = s.bodies[at.index].first_shape;
    record.user_data = def.user_data;
    if (def.density > S(0) && s.bodies[at.index].is_dynamic() && !s.bodies[at.index].mass_is_set) {
        const auto own = mass_of_shape<double, Plan>(record.shape, record.local, record.density);
        if (!check_mass<S>(f, combined(mass_of_shapes<double>(s, at.index), own))) return {};
    }
    record.fat_box = fat_box(s, record);
    const auto place = s.shapes.insert(record);
    s.bodies[at.index].first_shape = place.index;
    s.broadphase.insert(place.index, record.fat_box);
    refresh_mass(s, at.index);
    return {place.index, place.generation, s.tag};
}

template <class Plan>
void destroy_shape(state<Plan>& s, std::uint32_t index) {
    drop_contacts(s, [&](const auto& c) { return c.shape_a == index || c.shape_b == index; });
    const std::uint32_t body = s.shapes[index].body;
    std::uint32_t* link = &s.bodies[body].first_shape;
    while (*link != index) link = &s.shapes[*link].next;
    *link = s.shapes[index].next;
    s.broadphase.erase(index);
    s.shapes.erase(index);
    refresh_mass(s, body);
}

template <class Plan>
void destroy_body(state<Plan>& s, std::uint32_t index) {
    drop_contacts(s, [&](const auto& c) { return c.body_a == index || c.body_b == index; });
    each_shape(s, index, [&](std::uint32_t i, const shape_record<Plan>&) {
        s.broadphase.erase(i);
        s.shapes.erase(i);
    });
    s.bodies.erase(index);
}

/// A body that has a velocity: dynamic or kinematic.
template <class Plan>
found find_moving(const state<Plan>& s, body_id id, const char* function) {
    const found f = find_body(s, id, function);
    if (f && s.bodies[f.index].type == body_type::static_body)
        return {0, refuse(function, "body", "static", "it must be dynamic or kinematic")};
    return f;
}

/// Refuses to take a body's mass from shapes whose mass the scalar cannot hold.
template <class Plan>
bool check_shapes_mass(const state<Plan>& s, std::uint32_t body, const char* function) {
    const auto mass = mass_of_shapes<double>(s, body);
    return mass.mass == 0 || check_mass<typename Plan::scalar>(function, mass);
}

template <class Plan>
void set_type(state<Plan>& s, std::uint32_t index, body_type type) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    auto& b = s.bodies[index];
    if (type == body_type::dynamic_body) {
        bool solid = true;
        each_shape(s, index, [&](std::uint32_t, const auto& record) {
            record.shape.visit([&](const auto& shape) { solid = solid && solid_shape_for<std::remove_cvref_t<decltype(shape)>, S, D>; });
        });
        if (!solid) {
            refuse("set_type", "shape", "without mass", "a dynamic body needs shapes that have a mass");
            return;
        }
        if (!b.mass_is_set && !check_shapes_mass(s, index, "set_type")) return;
    }
    if (type == body_type::static_body) b.velocity = {};
    if (type != body_type::dynamic_body) {
        b.force = {};
        b.torque = {};
    }
    b.has_target = false;
    b.type = type;
    refresh_mass(s, index);
    refresh_boxes(s, index);
    drop_contacts(s, [&](const auto& c) {
        return (c.body_a == index || c.body_b == index) && !s.bodies[c.body_a].is_dynamic() && !s.bodies[c.body_b].is_dynamic();
    });
}

template <class Plan>
void set_rotation_locked(state<Plan>& s, std::uint32_t index, bool locked) {
    auto& b = s.bodies[index];
    b.rotation_locked = locked;
    if (locked) b.velocity.angular = {};
    refresh_mass(s, index);
}

template <class Plan>
void change_settings(state<Plan>& s, const typename Plan::settings& settings) {
    s.settings = settings;
    s.bodies.each([&](std::uint32_t i, const auto&) { refresh_boxes(s, i); });
}

/// Calls f(body, force, lever) with a force or impulse and its lever from the centre of mass, in world axes.
template <class Plan, class F>
void act(state<Plan>& s, body_id id, const char* function, const char* field, vec<typename Plan::scalar, Plan::dimension> force,
         bool local, const vec<typename Plan::scalar, Plan::dimension>* point, F&& f) {
    const found at = find_dynamic(s, id, function);
    if (!at || !check_finite(function, field, force) || (point && !check_finite(function, "point", *point))) return;
    auto& b = s.bodies[at.index];
    vec<typename Plan::scalar, Plan::dimension> lever;
    if (point) lever = local ? b.rotation * (*point - b.mass.center) : *point - b.center;
    f(b, local ? b.rotation * force : force, lever);
}

}  // namespace detail

PHYSICS_HPP_END
