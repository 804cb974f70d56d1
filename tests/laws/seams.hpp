// Laws of seams: static shapes that lie flush are one floor to what slides over them; what rises from it is not.
#pragma once

#include "world_cell.hpp"

namespace {
namespace seams_laws {

inline world::settings_type pulled(int substeps) {
    world::settings_type settings;
    settings.gravity = along(1, -10);
    settings.sleeping.enabled = false;
    settings.solver.substeps = substeps;
    return settings;
}
/// A static box, its half extents along x and y given, turned about z.
inline void add_slab(world& w, vec position, double half_x, double half_y, double friction = 0, double angle = 0) {
    const body_id slab = w.create_body({.type = body_type::static_body,
                                        .position = position,
                                        .rotation = turned_about_z<world::rotation_type>(angle)});
    vec half = vec::filled(S(3));
    half.x = S(half_x);
    half.y = S(half_y);
    world::shape_def def;
    def.material.friction = S(friction);
    w.create_shape(slab, world::box{half}, def);
}
inline body_id add_mover(world& w, bool is_box, vec position, double friction = 0) {
    const body_id body = w.create_body({.position = position});
    world::shape_def def;
    def.material.friction = S(friction);
    if (is_box) w.create_shape(body, world::box{vec::filled(S(0.5))}, def);
    else w.create_shape(body, world::ball{S(0.5)}, def);
    return body;
}

CELL_CASE("boxes and balls slide over tiles as over one floor") {
    for (const bool is_box : {true, false})
        for (const int substeps : {4, 8, 16})
            for (const double speed : {0.03125, 0.5, 2.0, 6.0, 15.0}) {
                CAPTURE(is_box);
                CAPTURE(substeps);
                CAPTURE(speed);
                world w(pulled(substeps));
                for (int i = -3; i < 40; ++i) add_slab(w, at(i + 1.0 / 64, -0.5), 0.5, 0.5);
                const body_id body = add_mover(w, is_box, at(0, 0.5));
                run(w, 64);
                const double rest = number(w.center_of_mass(body).y);
                w.set_linear_velocity(body, along(0, speed));
                double highest = rest;
                for (int i = 0; i < 128; ++i) {
                    run(w, 1);
                    highest = std::max(highest, number(w.center_of_mass(body).y));
                }
                CHECK(number(w.linear_velocity(body).x) == doctest::Approx(speed).epsilon(0.01));
                CHECK(highest - rest <= 1e-3);
            }
}

CELL_CASE("a step that rises from the floor stops what slides, at any height from a fiftieth of it") {
    for (const bool is_box : {true, false})
        for (const double height : {0.02, 0.1, 1.0})
            for (const int substeps : {4, 16}) {
                CAPTURE(is_box);
                CAPTURE(height);
                CAPTURE(substeps);
                world w(pulled(substeps));
                add_slab(w, at(0, -0.5), 5, 0.5);
                add_slab(w, at(10, height - 0.5), 5, 0.5);
                const body_id body = add_mover(w, is_box, at(3, 0.5));
                run(w, 32);
                w.set_linear_velocity(body, along(0, 0.25));
                run(w, 10 * 64);
                // A ball touches the edge before its middle is there.
                const double reach = is_box || height >= 0.5 ? 0.5 : std::sqrt(0.25 - (0.5 - height) * (0.5 - height));
                CHECK(number(w.center_of_mass(body).x) <= 5 - reach + 0.01);
            }
}

CELL_CASE("a groove of two slabs holds what lies in it, however flat") {
    for (const bool is_box : {true, false})
        for (const double angle : {1.0 / 64, 1.0 / 16, 0.25, 1.0})
            for (const int substeps : {4, 16}) {
                CAPTURE(is_box);
                CAPTURE(angle);
                CAPTURE(substeps);
                world w(pulled(substeps));
                for (const int side : {-1, 1})
                    add_slab(w,
                             at(side * (4 * std::cos(angle) + 0.5 * std::sin(angle)),
                                4 * std::sin(angle) - 0.5 * std::cos(angle)),
                             4, 0.5, 0.25, side * angle);
                const body_id body = add_mover(w, is_box, at(1.0 / 64, 1.25), 0.25);
                run(w, 2 * 64);
                double deepest = 0;
                for (int i = 0; i < 4 * 64; ++i) {
                    run(w, 1);
                    for (const auto c : w.contacts())
                        for (int k = 0; k < c.count; ++k) deepest = std::max(deepest, -number(c.points[k].separation));
                }
                CHECK(deepest <= 2e-3);
                CHECK(number(length(w.linear_velocity(body))) <= 0.25);
            }
}

}  // namespace seams_laws
}  // namespace
