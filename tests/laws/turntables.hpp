// Laws of what rides on bodies that turn by themselves: it goes round with them, and does not drift outwards.
#pragma once

#include <cmath>

#include "world_cell.hpp"

namespace {
namespace turntable_laws {

template <class Solver>
struct table_recipe : physics::recipe<S, cell::dimension, Solver> {};

template <class Solver>
struct turntable {
    using world_type = physics::world<table_recipe<Solver>>;
    world_type w;
    body_id table;
    double h;

    turntable(double rate, int substeps) : h(1 / rate) {
        auto settings = w.settings();
        settings.gravity = {};
        settings.solver.substeps = substeps;
        w.set_settings(settings);
        table = w.create_body({.type = body_type::kinematic_body});
    }
    void add_table(const vec& half) {
        w.create_shape(table, typename world_type::box{half}, {.material = {.friction = S(0.8)}});
    }
    template <class Shape>
    body_id add(const vec& position, const Shape& shape, const vec& velocity = {}) {
        const body_id b = w.create_body({.position = position, .linear_velocity = velocity, .can_sleep = false});
        w.create_shape(b, shape, {.material = {.friction = S(0.8)}});
        return b;
    }
    /// As the table sees it.
    vec seen(body_id b) const { return inverse_rotate(w.rotation(table), w.position(b)); }
};
/// Calls f(rate, substeps, how much may go wrong).
template <class F>
void at_rates(F&& f) {
    for (const double rate : {30.0, 60.0, 240.0})
        for (const int substeps : {1, 4, 16}) {
            CAPTURE(rate);
            CAPTURE(substeps);
            f(rate, substeps, rate > 50 ? 0.02 : substeps > 1 ? 0.04 : 0.12);
        }
}

/// A crate on the upper side of a beam that turns about z, pressed against it.
template <class Solver>
void ride_on_a_beam() {
    at_rates([](double rate, int substeps, double slack) {
        turntable<Solver> t(rate, substeps);
        vec half = vec::filled(S(1));
        half[0] = S(4);
        half[1] = S(0.25);
        t.add_table(half);
        const body_id crate = t.add(at(1, 0.5), typename turntable<Solver>::world_type::box{vec::filled(S(0.25))});
        vec start{};
        for (int i = 0; i < 8 * rate; ++i) {
            // It is brought up to 2 rad/s in a second.
            t.w.set_angular_velocity(t.table, about_z(2 * std::min(1.0, i / rate)));
            t.w.apply_force(crate, t.w.rotation(t.table) * along(1, -50) * t.w.mass(crate).mass);
            t.w.step(S(t.h));
            if (i == static_cast<int>(2 * rate)) start = t.seen(crate);
        }
        CHECK(std::abs(number(t.seen(crate).x - start.x)) < slack);
        CHECK(std::abs(number(t.seen(crate).y) - 0.5) < 0.02);
    });
}
CELL_CASE("turntables: a crate that is pressed against a beam stays where it is on it, by soft_step") {
    ride_on_a_beam<physics::soft_step>();
}
CELL_CASE("turntables: a crate that is pressed against a beam stays where it is on it, by sequential_impulse") {
    ride_on_a_beam<physics::sequential_impulse>();
}

#if CELL_DIMENSION == 3
/// A crate on a disc that turns about y, by its velocity or by targets.
template <class Solver>
void ride_on_a_disc() {
    using rotation = world::rotation_type;
    for (const bool by_targets : {false, true})
        at_rates([by_targets](double rate, int substeps, double slack) {
            turntable<Solver> t(rate, substeps);
            auto settings = t.w.settings();
            settings.gravity = along(1, -10);
            t.w.set_settings(settings);
            t.add_table({S(4), S(0.5), S(4)});
            const body_id crate = t.add(at(1, 0.75), typename turntable<Solver>::world_type::box{vec::filled(S(0.25))});
            vec start{};
            double angle = 0;
            for (int i = 0; i < 8 * rate; ++i) {
                const double spin = 2 * std::min(1.0, i / rate);
                angle += spin * t.h;
                if (by_targets) t.w.move_to(t.table, {}, rotation::from_axis_angle(along(1, 1), S(angle)));
                else t.w.set_angular_velocity(t.table, along(1, spin));
                t.w.step(S(t.h));
                if (i == static_cast<int>(2 * rate)) start = t.seen(crate);
            }
            CHECK(std::abs(number(length(t.seen(crate)) - length(start))) < slack);
            CHECK(gap(t.seen(crate), start) < 4 * slack);
        });
}
CELL_CASE("turntables: a crate on a disc goes round with it, by soft_step") { ride_on_a_disc<physics::soft_step>(); }
CELL_CASE("turntables: a crate on a disc goes round with it, by sequential_impulse") {
    ride_on_a_disc<physics::sequential_impulse>();
}

/// A ball that rolls on a turning disc goes round in circles of its own, two sevenths as fast (Weltner, Stable circular
/// orbits of freely moving balls on rotating discs, 1979).
template <class Solver>
void roll_on_a_disc() {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        const double spin = 2, rate = 2 * spin / 7, radius = 1;
        turntable<Solver> t(240, substeps);
        auto settings = t.w.settings();
        settings.gravity = along(1, -10);
        t.w.set_settings(settings);
        t.add_table({S(8), S(0.5), S(8)});
        t.w.set_angular_velocity(t.table, along(1, spin));
        const double size = 0.25;
        // About the axis: its middle moves at rate x radius, and where it touches at spin x radius.
        const body_id ball = t.add(at(radius, 0.5 + size), typename turntable<Solver>::world_type::ball{S(size)},
                                   along(2, -rate * radius));
        t.w.set_angular_velocity(ball, along(0, (spin - rate) * radius / size));
        double nearest = 9, farthest = 0, turned = 0;
        vec before = t.w.position(ball);
        for (int i = 0; i < 240 * 11; ++i) {
            t.w.step(S(t.h));
            const vec p = t.w.position(ball);
            turned += std::atan2(number(before.z * p.x - before.x * p.z), number(before.x * p.x + before.z * p.z));
            const double r = std::hypot(number(p.x), number(p.z));
            nearest = std::min(nearest, r), farthest = std::max(farthest, r);
            before = p;
        }
        CHECK(nearest > 0.97 * radius);
        CHECK(farthest < 1.03 * radius);
        CHECK(std::abs(turned / (rate * 11) - 1) < 0.02);
    }
}
CELL_CASE("turntables: a ball rolls round two sevenths as fast, by soft_step") { roll_on_a_disc<physics::soft_step>(); }
CELL_CASE("turntables: a ball rolls round two sevenths as fast, by sequential_impulse") {
    roll_on_a_disc<physics::sequential_impulse>();
}
#endif

}  // namespace turntable_laws
}  // namespace
