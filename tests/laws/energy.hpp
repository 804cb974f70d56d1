// Laws of energy reports: what bodies have is the textbook's sum, what acts on them from outside is work, and what
// comes from nowhere is found.
#pragma once

#include "world_cell.hpp"

namespace {
namespace energy_laws {

inline double whole(const physics::energy_report& r) { return r.kinetic + r.potential; }

CELL_CASE("the energy of bodies is that of their motion and their height") {
    world w;
    CHECK(whole(w.energy()) == 0);
    add_ground(w);
    const body_id body = w.create_body(
        {.position = at(3, 2), .linear_velocity = at(3, -1), .angular_velocity = skew(2), .gravity_scale = S(0.5)});
    w.create_shape(body, world::box{vec::filled(S(0.5))}, {.density = S(8)});
    const double gravity = -number(w.settings().gravity.y), inertia = 8.0 / 6;
    const double spin = cell::is_2d ? 4 : 4 * (0.25 + 0.5625 + 1);
    const auto now = w.energy();
    CHECK(std::abs(now.kinetic - (0.5 * 8 * 10 + 0.5 * inertia * spin)) <= rounding(16, 64));
    CHECK(std::abs(now.potential - 8 * 0.5 * gravity * 2) <= rounding(16, 64));
    CHECK(now.work == 0);
    CHECK(now.made == 0);
}

CELL_CASE("what forces, torques and kinematic bodies give is work, and no step makes more") {
    for (const int substeps : {1, 4, 16}) {
        world::settings_type settings;
        settings.solver.substeps = substeps;
        world w(settings);
        add_ground(w);
        const body_id slid = add_box(w, at(0, 0.5)), flown = add_box(w, at(0, 8)), pushed = add_box(w, at(6, 0.5));
        const body_id pusher =
            w.create_body({.type = body_type::kinematic_body, .position = at(4.9, 0.5), .linear_velocity = at(1, 0)});
        w.create_shape(pusher, world::box{vec::filled(S(0.5))});
        double work = 0, gain = whole(w.energy());
        for (int i = 0; i < 64; ++i) {
            w.apply_force(slid, at(9, 0));
            w.apply_torque(flown, skew(3));
            w.apply_force(flown, at(-2, 14));
            const auto r = w.step_with_energy_report(S(1.0 / 64));
            CHECK(r.made <= 0.004 + rounding(256, 256));
            work += r.work;
        }
        gain = whole(w.energy()) - gain;
        CHECK(work > 10);
        CHECK(gain > 10);
        CHECK(gain <= work * 1.01);
        CHECK(w.position(pushed).x > S(6.5));
    }
}
CELL_CASE("what a belt gives is work") {
    world w;
    const body_id belt = w.create_body({.type = body_type::static_body});
    world::shape_def def;
    def.material.surface_velocity = about_z<physics::surface_motion<S, cell::dimension>>(1);
    w.create_shape(belt, world::halfspace{}, def);
    const body_id box = add_box(w, at(0, 0.5));
    double work = 0;
    for (int i = 0; i < 64; ++i) {
        const auto r = w.step_with_energy_report(S(1.0 / 64));
        CHECK(r.made <= 0.004);
        work += r.work;
    }
    const vec v = w.linear_velocity(box);
    const double kinetic = 0.5 * number(w.mass(box).mass) * number(dot(v, v));
    CHECK(kinetic > 0.4);
    // The belt runs at its speed from the first moment on: half of its work becomes heat.
    CHECK(work >= 1.8 * kinetic);
    CHECK(work <= 2.2 * kinetic);
}
CELL_CASE("energy that comes from nowhere is found") {
    world w;
    add_ground(w);
    add_box(w, at(0, 0.25));
    double made = 0;
    for (int i = 0; i < 32; ++i) made += std::max(w.step_with_energy_report(S(1.0 / 64)).made, 0.0);
    // A box that is set into the ground is lifted out.
    CHECK(made > 1);
}

}  // namespace energy_laws
}  // namespace
