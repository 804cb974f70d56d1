// What a world refuses: every entry, every field, with a sentence that names them, and nothing has changed after it.
#pragma once

#include <string>

#include "refusal.hpp"
#include "world_sizes.hpp"

namespace {
namespace world_errors_laws {

/// Every entry that takes a handle, by name.
template <class Id>
struct entry {
    std::string name;
    void (*call)(world&, Id);
};
const entry<body_id> body_entries[] = {
    {"destroy_body", [](world& w, body_id b) { w.destroy_body(b); }},
    {"create_shape", [](world& w, body_id b) { w.create_shape(b, world::ball{}); }},
    {"shapes", [](world& w, body_id b) { (void)w.shapes(b); }},
    {"contacts", [](world& w, body_id b) { (void)w.contacts(b).size(); }},
    {"touching", [](world& w, body_id b) { (void)w.touching(b, b); }},
    {"touching", [](world& w, body_id b) { (void)w.touching(*w.bodies().begin(), b); }},
    {"position", [](world& w, body_id b) { (void)w.position(b); }},
    {"rotation", [](world& w, body_id b) { (void)w.rotation(b); }},
    {"pose", [](world& w, body_id b) { (void)w.pose(b); }},
    {"center_of_mass", [](world& w, body_id b) { (void)w.center_of_mass(b); }},
    {"set_pose", [](world& w, body_id b) { w.set_pose(b, {}, {}); }},
    {"set_pose", [](world& w, body_id b) { w.set_pose(b, {}); }},
    {"move_to", [](world& w, body_id b) { w.move_to(b, {}, {}); }},
    {"move_to", [](world& w, body_id b) { w.move_to(b, {}); }},
    {"linear_velocity", [](world& w, body_id b) { (void)w.linear_velocity(b); }},
    {"angular_velocity", [](world& w, body_id b) { (void)w.angular_velocity(b); }},
    {"velocity_at", [](world& w, body_id b) { (void)w.velocity_at(b, {}); }},
    {"set_linear_velocity", [](world& w, body_id b) { w.set_linear_velocity(b, {}); }},
    {"set_angular_velocity", [](world& w, body_id b) { w.set_angular_velocity(b, {}); }},
    {"apply_force", [](world& w, body_id b) { w.apply_force(b, {}); }},
    {"apply_force_at", [](world& w, body_id b) { w.apply_force_at(b, {}, {}); }},
    {"apply_local_force", [](world& w, body_id b) { w.apply_local_force(b, {}); }},
    {"apply_local_force_at", [](world& w, body_id b) { w.apply_local_force_at(b, {}, {}); }},
    {"apply_torque", [](world& w, body_id b) { w.apply_torque(b, {}); }},
    {"clear_forces", [](world& w, body_id b) { w.clear_forces(b); }},
    {"apply_impulse", [](world& w, body_id b) { w.apply_impulse(b, {}); }},
    {"apply_impulse_at", [](world& w, body_id b) { w.apply_impulse_at(b, {}, {}); }},
    {"apply_local_impulse", [](world& w, body_id b) { w.apply_local_impulse(b, {}); }},
    {"apply_local_impulse_at", [](world& w, body_id b) { w.apply_local_impulse_at(b, {}, {}); }},
    {"apply_angular_impulse", [](world& w, body_id b) { w.apply_angular_impulse(b, {}); }},
    {"type", [](world& w, body_id b) { (void)w.type(b); }},
    {"set_type", [](world& w, body_id b) { w.set_type(b, body_type::static_body); }},
    {"enabled", [](world& w, body_id b) { (void)w.enabled(b); }},
    {"set_enabled", [](world& w, body_id b) { w.set_enabled(b, false); }},
    {"island", [](world& w, body_id b) { (void)w.island(b); }},
    {"mass", [](world& w, body_id b) { (void)w.mass(b); }},
    {"set_mass",
     [](world& w, body_id b) {
         w.set_mass(b, {S(1), {}, {}});
     }},
    {"reset_mass", [](world& w, body_id b) { w.reset_mass(b); }},
    {"linear_damping", [](world& w, body_id b) { (void)w.linear_damping(b); }},
    {"angular_damping", [](world& w, body_id b) { (void)w.angular_damping(b); }},
    {"set_damping", [](world& w, body_id b) { w.set_damping(b, S(0), S(0)); }},
    {"gravity_scale", [](world& w, body_id b) { (void)w.gravity_scale(b); }},
    {"set_gravity_scale", [](world& w, body_id b) { w.set_gravity_scale(b, S(1)); }},
    {"rotation_locked", [](world& w, body_id b) { (void)w.rotation_locked(b); }},
    {"set_rotation_locked", [](world& w, body_id b) { w.set_rotation_locked(b, false); }},
    {"user_data", [](world& w, body_id b) { (void)w.user_data(b); }},
    {"set_user_data", [](world& w, body_id b) { w.set_user_data(b, 1); }},
};
const entry<shape_id> shape_entries[] = {
    {"destroy_shape", [](world& w, shape_id s) { w.destroy_shape(s); }},
    {"body", [](world& w, shape_id s) { (void)w.body(s); }},
    {"shape", [](world& w, shape_id s) { (void)w.shape(s); }},
    {"local_pose", [](world& w, shape_id s) { (void)w.local_pose(s); }},
    {"material", [](world& w, shape_id s) { (void)w.material(s); }},
    {"set_material", [](world& w, shape_id s) { w.set_material(s, {}); }},
    {"filter", [](world& w, shape_id s) { (void)w.filter(s); }},
    {"set_filter", [](world& w, shape_id s) { w.set_filter(s, {}); }},
    {"contacts", [](world& w, shape_id s) { (void)w.contacts(s).size(); }},
    {"touching", [](world& w, shape_id s) { (void)w.touching(s, s); }},
    {"is_sensor", [](world& w, shape_id s) { (void)w.is_sensor(s); }},
    {"is_one_way", [](world& w, shape_id s) { (void)w.is_one_way(s); }},
    {"senses_static", [](world& w, shape_id s) { (void)w.senses_static(s); }},
    {"user_data", [](world& w, shape_id s) { (void)w.user_data(s); }},
    {"set_user_data", [](world& w, shape_id s) { w.set_user_data(s, 1); }},
};
CELL_CASE("errors: every entry refuses null, foreign and stale handles") {
    scenery s, other;
    world& w = s.w;
    const body_id dead = add_ball(w, at(9, 9));
    const shape_id dead_shape = *w.shapes(dead).begin();
    w.destroy_body(dead);
    const body_id reborn = add_ball(w, at(9, 9));
    REQUIRE(reborn.index == dead.index);
    const auto check = [&](const auto& entries, const std::string& what, auto foreign, auto stale) {
        const auto number = [](auto id) { return "#" + std::to_string(id.index); };
        for (const auto& entry : entries) {
            refuses(w, entry.name, what, "null", [&] { entry.call(w, {}); });
            refuses(w, entry.name, what, number(foreign), [&] { entry.call(w, foreign); });
            refuses(w, entry.name, what, number(stale), [&] { entry.call(w, stale); });
            CHECK(refusal([&] { entry.call(w, foreign); }).find("another world") != std::string::npos);
            CHECK(refusal([&] { entry.call(w, stale); }).find("destroyed") != std::string::npos);
        }
    };
    check(body_entries, "body", other.box, dead);
    check(shape_entries, "shape", other.face, dead_shape);
    // Of two mistakes the first is told, on every compiler.
    if constexpr (!cell::is_fixed)
        refuses(w, "set_gravity_scale", "body", "null",
                [&] { w.set_gravity_scale({}, bad_values(rule::finite)[0].value); });
}

CELL_CASE("errors: what only some types of bodies can do, the others refuse") {
    scenery s;
    world& w = s.w;
    for (const auto& [name, call] : body_entries) {
        const auto& function = name;
        const auto refuses_body = [&, run = call](body_id id, const char* type) {
            refuses(w, function, "body", type, [&] { run(w, id); });
        };
        const bool acts =
            name.rfind("apply_", 0) == 0 || name == "clear_forces" || name == "set_mass" || name == "reset_mass";
        if (acts || name == "move_to" || name == "set_linear_velocity" || name == "set_angular_velocity")
            refuses_body(s.ground, "static");
        if (acts) refuses_body(s.platform, "kinematic");
        if (name == "move_to") refuses_body(s.ball, "dynamic");
    }
    refuses(w, "set_type", "type", "7", [&] { w.set_type(s.ball, static_cast<body_type>(7)); });
    refuses(w, "create_body", "type", "3", [&] { w.create_body({.type = static_cast<body_type>(3)}); });
    refuses(w, "set_type", "shape", "without mass", [&] { w.set_type(s.ground, body_type::dynamic_body); });
    refuses(w, "create_shape", "shape", "without mass", [&] { w.create_shape(s.ball, world::halfspace{}); });
    const body_id locked = w.create_body({.rotation_locked = true});
    refuses(w, "set_angular_velocity", "w", "2", [&] { w.set_angular_velocity(locked, about_z(-2)); });
    refuses(w, "create_body", "angular_velocity", "2",
            [&] { w.create_body({.angular_velocity = about_z(2), .rotation_locked = true}); });
}

CELL_CASE("errors: worlds and their settings refuse numbers out of range") {
    scenery s;
    const auto both = [&](const std::string& field, rule rule, call<world::settings_type&, S> change) {
        refuses_number(s.w, "world", field, rule, [&](S bad) {
            world::settings_type settings;
            change(settings, bad);
            world refused(settings);
        });
        refuses_number(s.w, "set_settings", field, rule, [&](S bad) {
            world::settings_type settings;
            change(settings, bad);
            s.w.set_settings(settings);
        });
    };
    for (int i = 0; i < cell::dimension; ++i)
        both(std::string("gravity.") + "xyz"[i], rule::finite,
             [&](world::settings_type& x, S bad) { x.gravity[i] = bad; });
    both("contact_margin", rule::not_negative, [](world::settings_type& x, S bad) { x.contact_margin = bad; });
    both("broadphase.margin", rule::not_negative, [](world::settings_type& x, S bad) { x.broadphase.margin = bad; });
    both("broadphase.prediction", rule::not_negative,
         [](world::settings_type& x, S bad) { x.broadphase.prediction = bad; });
    both("sleeping.time", rule::not_negative, [](world::settings_type& x, S bad) { x.sleeping.time = bad; });
    both("sleeping.speed", rule::not_negative, [](world::settings_type& x, S bad) { x.sleeping.speed = bad; });
    both("sleeping.spin", rule::not_negative, [](world::settings_type& x, S bad) { x.sleeping.spin = bad; });
    both("sleeping.drift", rule::not_negative, [](world::settings_type& x, S bad) { x.sleeping.drift = bad; });
    both("solver.contact_frequency_ratio", rule::positive,
         [](world::settings_type& x, S bad) { x.solver.contact_frequency_ratio = bad; });
    both("solver.damping_ratio", rule::positive, [](world::settings_type& x, S bad) { x.solver.damping_ratio = bad; });
    both("solver.frequency_cap", rule::not_negative,
         [](world::settings_type& x, S bad) { x.solver.frequency_cap = bad; });
    both("solver.max_depenetration_speed", rule::not_negative,
         [](world::settings_type& x, S bad) { x.solver.max_depenetration_speed = bad; });
    both("solver.impact_speed", rule::not_negative,
         [](world::settings_type& x, S bad) { x.solver.impact_speed = bad; });
    both("solver.restitution_threshold", rule::not_negative,
         [](world::settings_type& x, S bad) { x.solver.restitution_threshold = bad; });
    world::settings_type settings;
    settings.solver.substeps = 0;
    refuses(s.w, "set_settings", "solver.substeps", "0", [&] { s.w.set_settings(settings); });
    CHECK(s.w.settings().solver.substeps > 0);
    refuses_number(s.w, "step", "dt", rule::positive, [&](S bad) { s.w.step(bad); });
}

CELL_CASE("errors: bodies and shapes refuse numbers out of range") {
    scenery s;
    world& w = s.w;
    refuses_vec(w, "create_body", "position", rule::finite, [&](vec bad) { w.create_body({.position = bad}); });
    refuses_rotation(w, "create_body", [&](const world::rotation_type& bad) { w.create_body({.rotation = bad}); });
    refuses_vec(w, "create_body", "linear_velocity", rule::finite,
                [&](vec bad) { w.create_body({.linear_velocity = bad}); });
    refuses_angular(w, "create_body", "angular_velocity",
                    [&](angular bad) { w.create_body({.angular_velocity = bad}); });
    refuses_number(w, "create_body", "linear_damping", rule::not_negative,
                   [&](S bad) { w.create_body({.linear_damping = bad}); });
    refuses_number(w, "create_body", "angular_damping", rule::not_negative,
                   [&](S bad) { w.create_body({.angular_damping = bad}); });
    refuses_number(w, "create_body", "gravity_scale", rule::finite,
                   [&](S bad) { w.create_body({.gravity_scale = bad}); });

    const auto add = [&](const world::shape_def& def) { w.create_shape(s.box, world::box{}, def); };
    refuses_vec(w, "create_shape", "position", rule::finite, [&](vec bad) { add({.position = bad}); });
    refuses_rotation(w, "create_shape", [&](const world::rotation_type& bad) { add({.rotation = bad}); });
    refuses_number(w, "create_shape", "density", rule::not_negative, [&](S bad) { add({.density = bad}); });
    refuses_number(w, "create_shape", "friction", rule::not_negative,
                   [&](S bad) { add({.material = {.friction = bad}}); });
    refuses_number(w, "create_shape", "restitution", rule::not_negative,
                   [&](S bad) { add({.material = {.restitution = bad}}); });
    refuses_number(w, "create_shape", "rolling_resistance", rule::not_negative,
                   [&](S bad) { add({.material = {.rolling_resistance = bad}}); });
    refuses_number(w, "set_material", "rolling_resistance", rule::not_negative,
                   [&](S bad) { w.set_material(s.face, {.rolling_resistance = bad}); });
    refuses_angular(w, "create_shape", "surface_velocity",
                    [&](angular bad) { add({.material = {.surface_velocity = bad}}); });
    refuses_angular(w, "set_material", "surface_velocity",
                    [&](angular bad) { w.set_material(s.face, {.surface_velocity = bad}); });
    refuses_number(w, "create_shape", "restitution", rule::not_negative,
                   [&](S bad) { add({.material = {.restitution = bad}}); });
    refuses_number(w, "set_material", "friction", rule::not_negative,
                   [&](S bad) { w.set_material(s.face, {.friction = bad}); });
    refuses_number(w, "set_material", "restitution", rule::not_negative,
                   [&](S bad) { w.set_material(s.face, {.restitution = bad}); });

    refuses_number(w, "create_shape", "radius", rule::positive,
                   [&](S bad) { w.create_shape(s.box, world::ball{bad}); });
    refuses_number(w, "create_shape", "half_length", rule::positive, [&](S bad) {
        w.create_shape(s.box, world::capsule{bad, S(1)});
    });
    refuses_number(w, "create_shape", "radius", rule::positive, [&](S bad) {
        w.create_shape(s.box, world::capsule{S(1), bad});
    });
    refuses_vec(w, "create_shape", "half_extents", rule::positive,
                [&](vec bad) { w.create_shape(s.box, world::box{bad}); });
    const auto plane = [&](vec normal, S offset) {
        world::halfspace h;
        h.normal = normal;
        h.offset = offset;
        w.create_shape(s.ground, h);
    };
    refuses_vec(w, "create_shape", "normal", rule::finite, [&](vec bad) { plane(bad, S(0)); });
    refuses_number(w, "create_shape", "offset", rule::finite, [&](S bad) { plane(along(1, 1), bad); });
    refuses(w, "create_shape", "length of normal", "2", [&] { plane(along(0, 2), S(0)); });
    refuses(w, "create_shape", "length of normal", "0", [&] { plane({}, S(0)); });
}

CELL_CASE("errors: setters, forces and queries refuse numbers out of range") {
    scenery s;
    world& w = s.w;
    refuses_vec(w, "set_pose", "position", rule::finite, [&](vec bad) { w.set_pose(s.box, bad, {}); });
    refuses_vec(w, "set_pose", "position", rule::finite, [&](vec bad) { w.set_pose(s.ground, {bad, {}}); });
    refuses_rotation(w, "set_pose", [&](const world::rotation_type& bad) { w.set_pose(s.box, {}, bad); });
    refuses_vec(w, "move_to", "position", rule::finite, [&](vec bad) { w.move_to(s.platform, bad, {}); });
    refuses_rotation(w, "move_to", [&](const world::rotation_type& bad) { w.move_to(s.platform, {{}, bad}); });
    refuses_vec(w, "velocity_at", "point", rule::finite, [&](vec bad) { (void)w.velocity_at(s.box, bad); });
    refuses_vec(w, "set_linear_velocity", "v", rule::finite, [&](vec bad) { w.set_linear_velocity(s.box, bad); });
    refuses_angular(w, "set_angular_velocity", "w", [&](angular bad) { w.set_angular_velocity(s.box, bad); });
    refuses_vec(w, "apply_force", "force", rule::finite, [&](vec bad) { w.apply_force(s.box, bad); });
    refuses_vec(w, "apply_local_force", "force", rule::finite, [&](vec bad) { w.apply_local_force(s.box, bad); });
    refuses_vec(w, "apply_force_at", "force", rule::finite, [&](vec bad) { w.apply_force_at(s.box, bad, {}); });
    refuses_vec(w, "apply_force_at", "point", rule::finite, [&](vec bad) { w.apply_force_at(s.box, {}, bad); });
    refuses_vec(w, "apply_local_force_at", "force", rule::finite,
                [&](vec bad) { w.apply_local_force_at(s.box, bad, {}); });
    refuses_vec(w, "apply_local_force_at", "point", rule::finite,
                [&](vec bad) { w.apply_local_force_at(s.box, {}, bad); });
    refuses_vec(w, "apply_impulse", "impulse", rule::finite, [&](vec bad) { w.apply_impulse(s.box, bad); });
    refuses_vec(w, "apply_local_impulse", "impulse", rule::finite, [&](vec bad) { w.apply_local_impulse(s.box, bad); });
    refuses_vec(w, "apply_impulse_at", "impulse", rule::finite, [&](vec bad) { w.apply_impulse_at(s.box, bad, {}); });
    refuses_vec(w, "apply_impulse_at", "point", rule::finite, [&](vec bad) { w.apply_impulse_at(s.box, {}, bad); });
    refuses_vec(w, "apply_local_impulse_at", "impulse", rule::finite,
                [&](vec bad) { w.apply_local_impulse_at(s.box, bad, {}); });
    refuses_vec(w, "apply_local_impulse_at", "point", rule::finite,
                [&](vec bad) { w.apply_local_impulse_at(s.box, {}, bad); });
    refuses_angular(w, "apply_torque", "torque", [&](angular bad) { w.apply_torque(s.box, bad); });
    refuses_angular(w, "apply_angular_impulse", "impulse", [&](angular bad) { w.apply_angular_impulse(s.box, bad); });
    refuses_number(w, "set_damping", "linear_rate", rule::not_negative,
                   [&](S bad) { w.set_damping(s.box, bad, S(0)); });
    refuses_number(w, "set_damping", "angular_rate", rule::not_negative,
                   [&](S bad) { w.set_damping(s.box, S(0), bad); });
    refuses_number(w, "set_gravity_scale", "factor", rule::finite, [&](S bad) { w.set_gravity_scale(s.box, bad); });
}

}  // namespace world_errors_laws
}  // namespace
