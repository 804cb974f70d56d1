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
            CHECK(refusal([&] { w.set_mass(s.box, turn_about_diagonal(5e-8)); }).find("principal moment of inertia") !=
                  std::string::npos);
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
    const double huge = is_double ? 1e74 : cell::is_fixed ? 1e5 : 1e15, dense = is_double ? 1e200 : 1;
    const body_id fresh = w.create_body();
    for (const double size : {tiny, huge}) {
        const world::shape_def solid{.density = S(size > 1 ? dense : 1)};
        const auto said = refusal([&] { w.create_shape(fresh, world::ball{S(size)}, solid); });
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

/// The largest number that may be part of a state: of fixed-point ones, which wrap, half of those there are.
inline double largest() { return number(cell::largest()) * (cell::is_fixed ? 0.4999 : 1); }

/// Where everything is and what touches, exactly.
std::vector<S> picture(const world& w) {
    std::vector<S> all;
    const auto add = [&](vec v) {
        for (int i = 0; i < cell::dimension; ++i) all.push_back(v[i]);
    };
    for (const body_id id : w.bodies()) {
        add(w.position(id));
        add(w.rotation(id) * at(1, 2));
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
    using change = void (*)(scenery&);
    const change changes[] = {
        [](scenery& s) {
            s.w.apply_force(s.box, along(0, largest() * 0.5));
            s.w.set_mass(s.box, {S(0.001), {}, s.w.mass(s.box).inertia});
        },
        [](scenery& s) {
            s.w.apply_torque(s.ball, about_z(largest() * 0.5));
            s.w.set_gravity_scale(s.ball, S(-largest()));
            s.w.set_linear_velocity(s.ball, along(1, 0.999 * largest()));
        },
        [](scenery& s) {
            s.w.set_pose(s.ball, along(1, largest()), {});
            s.w.set_linear_velocity(s.ball, along(1, largest()));
        },
        [](scenery& s) { s.w.move_to(s.platform, along(0, largest()), {}); },
    };
    for (const change& make : changes) {
        scenery s, twin;
        make(s);
        make(twin);
        const auto before = picture(s.w);
        for (int i = 0; i < 2; ++i)
            refuses(s.w, "step", "a velocity, a position or an impulse", "", [&] { s.w.step(S(1.0 / 64)); });
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

CELL_CASE("limits: a step in which a frame leaves the range is refused, though the centre of mass stays") {
    world w{{.gravity = {}}};
    const body_id id = w.create_body();
    w.set_mass(id, {S(1), along(0, largest() * 0.75), w.mass(id).inertia});
    // Half a turn takes the frame to the other side of it.
    w.set_angular_velocity(id, about_z(64 * 3.14159));
    const auto before = picture(w);
    refuses(w, "step", "a velocity, a position or an impulse", "", [&] { w.step(S(1.0 / 64)); });
    CHECK(picture(w) == before);
    w.set_angular_velocity(id, {});
    w.step(S(1.0 / 64));
    CHECK(picture(w) == before);
}

CELL_CASE("limits: forces, impulses and poses that would leave the range of numbers are refused") {
    scenery s;
    world& w = s.w;
    const double most = largest();
    const vec far = along(0, most), arm = along(1, 4);
    w.apply_force(s.box, far);
    refuses(w, "apply_force", "force", "", [&] { w.apply_force(s.box, far); });
    refuses(w, "apply_force_at", "force", "", [&] { w.apply_force_at(s.ball, far, arm); });
    refuses(w, "apply_local_force_at", "force", "", [&] { w.apply_local_force_at(s.ball, far, arm); });
    w.clear_forces(s.box);
    w.apply_torque(s.box, about_z(most));
    refuses(w, "apply_torque", "torque", "", [&] { w.apply_torque(s.box, about_z(most)); });
    w.clear_forces(s.box);
    w.set_mass(s.box, {S(0.125), {}, w.mass(s.ball).inertia});
    refuses(w, "apply_impulse", "impulse", "", [&] { w.apply_impulse(s.box, far); });
    refuses(w, "apply_impulse_at", "impulse", "", [&] { w.apply_impulse_at(s.ball, far, arm); });
    w.set_angular_velocity(s.box, about_z(most));
    refuses(w, "apply_angular_impulse", "impulse", "", [&] { w.apply_angular_impulse(s.box, about_z(most)); });
    w.set_mass(s.ball, {S(1), along(0, most * 0.75), {}});
    refuses(w, "set_pose", "centre of mass", "", [&] { w.set_pose(s.ball, far, {}); });
    refuses(w, "set_mass", "center", "", [&] { w.set_mass(s.box, {S(1), arm, {}}); });
    const world::ball globe{S(number(cell::largest()) * 0.75)};
    refuses(w, "create_shape", cell::is_fixed ? "size of the box" : "upper end of the box.x", "",
            [&] { w.create_shape(s.ground, globe, {.position = along(0, most * 0.75)}); });
    if (!cell::is_fixed) return;
    // Beyond half the range nothing is taken.
    const vec beyond = along(0, most * 1.01);
    refuses(w, "create_body", "position.x", "", [&] { w.create_body({.position = beyond}); });
    refuses(w, "create_body", "linear_velocity.x", "", [&] { w.create_body({.linear_velocity = beyond}); });
    refuses(w, "set_pose", "position.x", "", [&] { w.set_pose(s.ball, beyond, {}); });
    refuses(w, "move_to", "position.x", "", [&] { w.move_to(s.platform, beyond, {}); });
    refuses(w, "set_linear_velocity", "v.x", "", [&] { w.set_linear_velocity(s.ball, beyond); });
    refuses(w, "apply_force", "force.x", "", [&] { w.apply_force(s.ball, beyond); });
    refuses(w, "apply_impulse", "impulse.x", "", [&] { w.apply_impulse(s.ball, -beyond); });
    refuses(w, "set_gravity_scale", "factor", "", [&] { w.set_gravity_scale(s.ball, beyond[0]); });
    refuses(w, "set_settings", "gravity.x", "", [&] { w.set_settings({.gravity = beyond}); });
}

struct exact_scene : physics::recipe<double, cell::dimension> {};

CELL_CASE("limits: a body that is pushed as hard as numbers allow flies as it would in double, or is refused") {
    if (!cell::is_fixed) return;
    using exact_world = physics::world<exact_scene>;
    cell::dice dice(3);
    const auto any = [&] { return std::pow(10.0, dice.number(3, 9.3)) * (dice.below(2) ? 1 : -1); };
    int flown = 0, refused_at_once = 0, refused_in_step = 0;
    for (int i = 0; i < 2000; ++i) {
        const double gravity = dice.below(3) ? -10 : any() / 4, scale = dice.below(3) ? 1 : any();
        world w{{.gravity = along(1, gravity)}};
        exact_world::settings_type with;
        with.gravity.y = number(S(gravity));
        exact_world twin{with};
        const auto size = S(std::pow(10.0, dice.number(-2, 1)));
        const vec start = along(dice.below(2), dice.below(3) ? 0 : any());
        try {
            const body_id b = w.create_body({.position = start});
            w.create_shape(b, world::ball{size});
            const physics::body_id t = twin.create_body({.position = real(start)});
            twin.create_shape(t, exact_world::ball{number(size)});
            for (int k = 0; k < 3; ++k) {
                const vec p = along(dice.below(2), dice.below(3) ? 1 : any());
                const auto both = [&](auto&& change) {
                    change(w, b, [](auto x) { return x; });
                    change(twin, t, [](auto x) { return real(x); });
                };
                const int which = dice.below(5);
                both([&](auto& in, body_id id, auto&& as) {
                    if (which == 0) in.set_linear_velocity(id, as(p));
                    if (which == 1) in.apply_force(id, as(p));
                    if (which == 2) in.apply_impulse(id, as(p));
                    if (which == 3) in.set_gravity_scale(id, as(S(scale)));
                    if (which == 4) in.apply_torque(id, as(about_z(scale)));
                });
            }
            const double dt = number(S(std::pow(2.0, -dice.below(10))));
            try {
                w.step(S(dt));
            } catch (const physics::error& e) {
                CHECK(std::string(e.what()).find(
                          "physics: step: a velocity, a position or an impulse is beyond the scalar") == 0);
                CHECK(w.steps() == 0);
                CHECK(w.position(b) == start);
                ++refused_in_step;
                continue;
            }
            twin.step(dt);
            ++flown;
            double most = 1;
            const auto compare = [&](vec x, exact_world::vec y) {
                for (int k = 0; k < cell::dimension; ++k) most = std::max(most, std::abs(y[k]));
                for (int k = 0; k < cell::dimension; ++k) REQUIRE(std::abs(number(x[k]) - y[k]) <= 0.02 * most);
            };
            compare(w.linear_velocity(b), twin.linear_velocity(t));
            compare(w.position(b), twin.position(t));
        } catch (const physics::error&) {
            ++refused_at_once;
        }
    }
    CAPTURE(flown);
    CHECK(flown > 500);
    CHECK(refused_at_once > 100);
    CHECK(refused_in_step > 100);
}

CELL_CASE("limits: a shape of any size, density and place is refused with nothing changed, or has a sound mass") {
    cell::dice dice(2);
    const bool is_double = !cell::is_fixed && number(cell::traits::epsilon()) < 1e-10;
    const double decades = cell::is_fixed ? 9 : is_double ? 300 : 37;
    const auto any = [&](double most) { return S(std::pow(10.0, dice.number(-most, most))); };
    int accepted = 0, refused = 0;
    scenery s;
    world& w = s.w;
    for (int i = 0; i < 2000; ++i) {
        // Most of them on a body that has a mass already.
        const body_id id = i % 4 == 0 ? w.create_body({.position = at(0, 50)}) : s.ball;
        const bool is_far = dice.below(2) == 0;
        const vec place = along(dice.below(cell::dimension), number(any(is_far ? decades : 1)));
        const S density = any(is_far ? 1 : decades), size = any(dice.below(2) ? 1 : decades / 3);
        const facts before = facts_of(w);
        const world::mass_properties mass_before = w.mass(id);
        shape_id shape;
        try {
            shape = i % 2 ? w.create_shape(id, world::ball{size}, {.position = place, .density = density})
                          : w.create_shape(id, world::box{vec::filled(size)}, {.position = place, .density = density});
        } catch (const physics::error& e) {
            ++refused;
            REQUIRE(std::string(e.what()).find("physics: create_shape: ") == 0);
            REQUIRE((facts_of(w) == before));
            REQUIRE(w.mass(id).mass == mass_before.mass);
        }
        if (shape) {
            ++accepted;
            const auto mass = w.mass(id);
            REQUIRE(mass.mass > S(0));
            REQUIRE(physics::is_finite(mass.mass));
            REQUIRE(physics::is_finite(mass.center));
            REQUIRE(inertia_about_z(real(mass).inertia) > 0);
            REQUIRE(physics::is_finite(w.center_of_mass(id)));
            REQUIRE(physics::is_finite(w.position(id)));
            w.destroy_shape(shape);
        }
        if (i % 4 == 0) w.destroy_body(id);
    }
    CHECK(accepted > 100);
    CHECK(refused > 100);
    if (cell::is_fixed) return;
    // What was seen: masses that only their sums in the scalar bring beyond its range.
    const double most = number(cell::traits::max());
    const body_id fresh = w.create_body();
    refuses(w, "create_shape", "mass", "",
            [&] { w.create_shape(fresh, world::ball{S(0.75)}, {.position = at(1, 0), .density = S(most * 0.6)}); });
    const facts before = facts_of(w);
    const auto said =
        refusal([&] { w.create_shape(fresh, world::ball{}, {.position = along(0, std::sqrt(most) * 1.7)}); });
    CHECK(said.find("physics: create_shape: ") == 0);
    CHECK((facts_of(w) == before));
    CHECK(w.mass(fresh).mass == S(1));
}

CELL_CASE("limits: poses, margins and queries whose boxes would leave the range are refused, and nothing has changed") {
    if (cell::is_fixed) return;
    scenery s;
    world& w = s.w;
    const double most = number(cell::largest());
    const auto face = [&](auto&& change, const std::string& function, const std::string& field) {
        const auto before = picture(w);
        refuses(w, function, field, "", change);
        CHECK(picture(w) == before);
    };
    const body_id globe = w.create_body({.type = body_type::static_body});
    w.create_shape(globe, world::ball{S(most * 0.25)});
    face([&] { w.set_pose(globe, along(0, most), {}); }, "set_pose", "upper end of the box.x");
    face([&] { w.set_pose(globe, along(1, -most), {}); }, "set_pose", "lower end of the box.y");
    w.set_pose(globe, along(0, most * 0.7), {});
    world::settings_type settings;
    settings.contact_margin = S(most * 0.5);
    settings.gravity = along(1, -3);
    face([&] { w.set_settings(settings); }, "set_settings", "upper end of the box.x");
    CHECK(w.settings().gravity == world::settings_type{}.gravity);
    w.destroy_body(globe);
    // Where a slope's surface is beyond all numbers.
    const body_id slope = w.create_body({.type = body_type::static_body, .rotation = turned_about_z(0.75)});
    w.create_shape(slope, world::halfspace{});
    face([&] { w.set_pose(slope, along(0, -most) + along(1, most), turned_about_z(0.75)); }, "set_pose",
         "upper end of the box.x");
    w.destroy_body(slope);
    const world::box wide{vec::filled(S(most * 0.5))};
    const auto nothing = [](shape_id) {};
    face(
        [&] {
            w.each_overlapping(wide, {along(0, most * 0.75), {}}, {}, nothing);
        },
        "each_overlapping", "upper end of the box.x");
    face(
        [&] {
            (void)w.cast_shape(wide, {along(0, most * 0.75), {}}, along(1, 1));
        },
        "cast_shape", "upper end of the box.x");
    // As far as anything can be is far enough.
    CHECK(w.closest_shape(at(0, 9), S(most)).shape == w.closest_shape(at(0, 9), S(100)).shape);
    CHECK(w.closest_shape(at(0, 9), S(100)));
}

CELL_CASE("limits: margins of the broadphase that boxes would leave the range with are refused, others find all") {
    scenery s;
    auto settings = s.w.settings();
    settings.broadphase.margin = cell::traits::max() / S(8);
    refuses(s.w, "set_settings", "broadphase.margin", "", [&] { s.w.set_settings(settings); });
    settings.broadphase.margin = cell::traits::max() / S(16);
    settings.broadphase.prediction = cell::traits::max();
    s.w.set_settings(settings);
    const auto below = [&] { return s.w.cast_ray(at(0, 30), along(1, -60)).shape; };
    CHECK(below());
    s.w.step(S(1.0 / 64));
    CHECK(below());
    // A box that ends where numbers do, which wrap there in fixed point.
    if (!cell::is_fixed) return;
    const body_id far = s.w.create_body({.type = body_type::static_body});
    const S most = cell::traits::max() * S(0.5);
    s.w.create_shape(far, world::ball{most * S(0.875)}, {.position = along(0, number(most))});
    CHECK(s.w.closest_shape(along(0, number(most)), S(1)).body == far);
}

CELL_CASE("limits: counts without end, and inertias that no body has, are refused") {
    scenery s;
    world& w = s.w;
    world::settings_type settings;
    settings.solver.substeps = 2147483647;
    refuses(w, "set_settings", "solver.substeps", "2.14748365e+09", [&] { w.set_settings(settings); });
    CHECK(w.settings().solver.substeps < 100);
    if constexpr (cell::is_3d) {
        const auto set = [&](double xx, double yy, double zz, double xz) {
            world::mass_properties mass{S(1), {}, {}};
            entry_of(mass.inertia, "xx") = S(xx);
            entry_of(mass.inertia, "yy") = S(yy);
            entry_of(mass.inertia, "zz") = S(zz);
            entry_of(mass.inertia, "xz") = S(xz);
            w.set_mass(s.box, mass);
        };
        // A plate has one moment that is the sum of the others; more none has, about whatever axes.
        set(1, 1, 2, 0);
        refuses(w, "set_mass", "inertia.xx", "", [&] { set(1, 1, 2.125, 0); });
        refuses(w, "set_mass", "inertia.xx", "", [&] { set(2, 2, 2, 1.25); });
        set(2, 2, 2, 0.9375);
    }
    w.set_angular_velocity(s.box, about_z(largest() * 0.5));
    refuses(w, "velocity_at", "point", "", [&] { (void)w.velocity_at(s.box, at(0, 100)); });
}

}  // namespace
