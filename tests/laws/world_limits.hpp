// What a world refuses because the scalar cannot hold it: masses, forces, and whole steps.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "refusal.hpp"
#include "world_real.hpp"

namespace {

/// The entry of an inertia, which in the plane is the only one.
[[maybe_unused]] S& entry_of(S& inertia, const std::string&) { return inertia; }
[[maybe_unused]] S& entry_of(physics::symmetric<S>& i, const std::string& name) {
    return name == "xx"   ? i.xx
           : name == "yy" ? i.yy
           : name == "zz" ? i.zz
           : name == "xy" ? i.xy
           : name == "xz" ? i.xz
                          : i.yz;
}

CELL_CASE("limits: masses that the scalar cannot hold are refused, wherever they come from") {
    scenery s;
    world& w = s.w;
    const auto with = [&](auto&& change) {
        world::mass_properties mass = w.mass(s.box);
        change(mass);
        return mass;
    };
    refuses_vec(w, "set_mass", "center", rule::finite,
                [&](vec bad) { w.set_mass(s.box, with([&](auto& m) { m.center = bad; })); });
    refuses_number(w, "set_mass", "mass", rule::positive,
                   [&](S bad) { w.set_mass(s.box, with([&](auto& m) { m.mass = bad; })); });
    const auto refuses_inertia = [&](const std::string& entry, const std::string& field, const bad_value& bad) {
        refuses(w, "set_mass", field, bad.text,
                [&] { w.set_mass(s.box, with([&](auto& m) { entry_of(m.inertia, entry) = bad.value; })); });
    };
    for (const bad_value& bad : bad_values(rule::not_negative))
        for (const std::string entry : {"xx", "yy", "zz"})
            refuses_inertia(entry, cell::is_2d ? "inertia" : "inertia." + entry, bad);
    if constexpr (cell::is_3d) {
        for (const bad_value& bad : bad_values(rule::finite))
            for (const std::string entry : {"xy", "xz", "yz"}) refuses_inertia(entry, "inertia." + entry, bad);
        // More off the diagonal than a body of any shape has.
        for (const std::string entry : {"xy", "xz", "yz"}) refuses_inertia(entry, "inertia.xx", {S(1), ""});
        CHECK(refusal([&] {
                  w.set_mass(s.box, with([](auto& m) { entry_of(m.inertia, "yz") = S(1); }));
              }).find("positive definite") != std::string::npos);
        // A needle along a diagonal of its frame: no entry of its inverse is out of range, but how it turns about
        // itself is.
        const auto turn_about_diagonal = [&](double moment) {
            return with([&](auto& m) {
                const double off = (moment - 0.5) / 3;
                for (const std::string entry : {"xx", "yy", "zz"}) entry_of(m.inertia, entry) = S(0.5 + off);
                for (const std::string entry : {"xy", "xz", "yz"}) entry_of(m.inertia, entry) = S(off);
            });
        };
        if (cell::is_fixed) {
            CHECK(refusal([&] {
                      w.set_mass(s.box, turn_about_diagonal(5e-8));
                  }).find("principal moment of inertia") != std::string::npos);
            // Nor is any entry of this one out of range, but the greatest moment is.
            CHECK(refusal([&] {
                      w.set_mass(s.box, with([](auto& m) {
                                     m.inertia = {};
                                     for (const std::string entry : {"xx", "yy", "zz"})
                                         entry_of(m.inertia, entry) = S(1.8e9);
                                     entry_of(m.inertia, "xy") = S(0.9e9);
                                 }));
                  }).find("principal moment of inertia") != std::string::npos);
        }
        w.set_mass(s.box, turn_about_diagonal(1e-3));
    }

    // Too light and too heavy; where squares and cubes of lengths enter, long before the lengths are.
    const bool is_double = !cell::is_fixed && number(cell::traits::epsilon()) < 1e-10;
    const double tiny = is_double ? (cell::is_2d ? 1e-80 : 1e-63) : cell::is_fixed ? 1e-4 : 1e-15;
    const double huge = is_double ? 1e120 : cell::is_fixed ? 1e5 : 1e15;
    const body_id fresh = w.create_body();
    for (const double size : {tiny, huge}) {
        const auto said = refusal([&] { w.create_shape(fresh, world::ball{S(size)}); });
        CAPTURE(said);
        CHECK(said.find("physics: create_shape: ") == 0);
        CHECK(said.find("beyond the scalar's range; use other units") != std::string::npos);
        CHECK(w.shape_count() == 4);
        CHECK(w.mass(fresh).mass == S(1));
    }
    // A body that is not dynamic takes any shape, and then cannot become dynamic; nor can mass be taken from it.
    const body_id speck = w.create_body({.type = body_type::static_body});
    w.create_shape(speck, world::ball{S(tiny)});
    CHECK(refusal([&] { w.set_type(speck, body_type::dynamic_body); }).find("physics: set_type: ") == 0);
    CHECK(w.type(speck) == body_type::static_body);
    // The light rest of a heavy body.
    const body_id sum = w.create_body();
    const shape_id heavy = w.create_shape(sum, world::ball{}), light = w.create_shape(sum, world::ball{S(tiny)});
    const facts before = facts_of(w);
    CHECK(refusal([&] { w.destroy_shape(heavy); }).find("physics: destroy_shape: ") == 0);
    CHECK((facts_of(w) == before));
    CHECK(w.contains(heavy));
    w.set_mass(sum, {S(1), {}, {}});
    w.destroy_shape(heavy);
    CHECK(refusal([&] { w.reset_mass(sum); }).find("physics: reset_mass: ") == 0);
    w.destroy_shape(light);
    w.reset_mass(sum);
    w.destroy_body(sum);
}

CELL_CASE("limits: a shape of any size and density is refused, or weighs what it must to one percent") {
    cell::dice dice(1);
    const double decades = cell::is_fixed ? 4 : 14;
    const auto any = [&] { return S(std::pow(10.0, dice.number(-decades, decades))); };
    int accepted = 0, refused = 0;
    world w;
    for (int i = 0; i < 3000; ++i) {
        const body_id id = w.create_body();
        const S density = any(), a = any(), b = any();
        real_mass expected;
        const auto add = [&](const auto& shape) {
            expected = mass_of(shape.template as<double>(), number(density));
            w.create_shape(id, shape, {.density = density});
        };
        try {
            if (i % 3 == 0) add(world::ball{a});
            else if (i % 3 == 1) add(world::capsule{a, b});
            else
                add(world::box{at(number(a), number(b)) + along(cell::dimension - 1, cell::is_2d ? 0 : number(any()))});
            const real_mass mass = real(w.mass(id));
            ++accepted;
            REQUIRE(std::abs(mass.mass / expected.mass - 1) <= 0.01);
            REQUIRE(std::abs(inertia_about_z(mass.inertia) / inertia_about_z(expected.inertia) - 1) <= 0.01);
        } catch (const physics::error&) {
            ++refused;
            REQUIRE(w.shape_count() == 0);
        }
        w.destroy_body(id);
    }
    CHECK(accepted > 100);
    if (cell::is_fixed) CHECK(refused > 100);
}

/// Where everything is and what touches, exactly.
std::vector<S> picture(const world& w) {
    std::vector<S> all;
    const auto add = [&](vec v) {
        for (int i = 0; i < cell::dimension; ++i) all.push_back(v[i]);
    };
    for (const body_id id : w.bodies()) {
        add(w.position(id));
        add(w.orientation(id) * at(1, 2));
        add(w.linear_velocity(id));
    }
    for (const auto& c : w.contacts())
        for (int k = 0; k < c.count; ++k) {
            add(c.points[k].position);
            add(c.points[k].local_a);
            add(c.points[k].local_b);
            all.push_back(c.points[k].normal_impulse);
        }
    return all;
}

CELL_CASE("limits: a step that leaves the range of numbers is refused, changes nothing, and the next one works") {
    if (cell::is_fixed)
        return;  // Nothing is out of range there: it wraps, and the audit counts it (tests/base/overflow.cpp).
    using change = void (*)(scenery&);
    const change changes[] = {
        [](scenery& s) {
            s.w.apply_force(s.box, along(0, number(cell::traits::max()) * 0.5));
            s.w.set_mass(s.box, {S(0.001), {}, s.w.mass(s.box).inertia});
        },
        [](scenery& s) {
            s.w.apply_torque(s.ball, about_z(number(cell::traits::max()) * 0.5));
            s.w.set_gravity_scale(s.ball, cell::traits::max());
        },
        [](scenery& s) {
            s.w.set_pose(s.ball, along(1, number(cell::traits::max())), {});
            s.w.set_linear_velocity(s.ball, along(1, number(cell::traits::max())));
        },
        [](scenery& s) { s.w.move_to(s.platform, along(0, number(cell::traits::max())), {}); },
    };
    for (const change& make : changes) {
        scenery s, twin;
        make(s);
        make(twin);
        const auto before = picture(s.w);
        for (int i = 0; i < 2; ++i) refuses(s.w, "step", "a velocity", "not finite", [&] { s.w.step(S(1.0 / 64)); });
        CHECK(picture(s.w) == before);
        for (scenery* each : {&s, &twin}) {
            world& w = each->w;
            for (const body_id id : {each->box, each->ball}) {
                w.clear_forces(id);
                w.set_gravity_scale(id, S(1));
                w.set_linear_velocity(id, {});
            }
            w.set_pose(each->ball, at(0.25, 1.5), {});
            w.move_to(each->platform, at(3, 1), {});
            run(w, 20);
        }
        CHECK(s.w.state_hash() == twin.w.state_hash());
        CHECK(picture(s.w) == picture(twin.w));
    }
}

CELL_CASE("limits: forces, impulses and poses that would leave the range of numbers are refused") {
    if (cell::is_fixed) return;
    scenery s;
    world& w = s.w;
    const S most = cell::traits::max();
    const vec far = along(0, number(most)), arm = along(1, 4);
    w.apply_force(s.box, far);
    refuses(w, "apply_force", "force", "", [&] { w.apply_force(s.box, far); });
    refuses(w, "apply_force_at", "force", "", [&] { w.apply_force_at(s.ball, far, arm); });
    refuses(w, "apply_local_force_at", "force", "", [&] { w.apply_local_force_at(s.ball, far, arm); });
    w.clear_forces(s.box);
    w.apply_torque(s.box, about_z(number(most)));
    refuses(w, "apply_torque", "torque", "", [&] { w.apply_torque(s.box, about_z(number(most))); });
    w.clear_forces(s.box);
    w.set_mass(s.box, {S(0.125), {}, w.mass(s.ball).inertia});
    refuses(w, "apply_impulse", "impulse", "", [&] { w.apply_impulse(s.box, far); });
    refuses(w, "apply_impulse_at", "impulse", "", [&] { w.apply_impulse_at(s.ball, far, arm); });
    w.set_angular_velocity(s.box, about_z(number(most)));
    refuses(w, "apply_angular_impulse", "impulse", "", [&] { w.apply_angular_impulse(s.box, about_z(number(most))); });
    w.set_mass(s.ball, {S(1), along(0, number(most) * 0.75), {}});
    refuses(w, "set_pose", "centre of mass.x", "", [&] { w.set_pose(s.ball, far, {}); });
    refuses(w, "set_mass", "center", "", [&] { w.set_mass(s.box, {S(1), arm, {}}); });
    const world::ball globe{S(number(most) * 0.5)};
    refuses(w, "create_shape", "upper end of the box.x", "",
            [&] { w.create_shape(s.ground, globe, {.position = along(0, number(most) * 0.75)}); });
}

}  // namespace
