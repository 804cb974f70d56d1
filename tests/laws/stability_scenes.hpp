// What stands or falls: piles of crates and cards, and what becomes of them.
#pragma once

#include <algorithm>
#include <vector>

#include "world_cell.hpp"

namespace {

inline world::settings_type pulled(int substeps = world::settings_type{}.solver.substeps) {
    world::settings_type settings;
    settings.gravity = along(1, -10);
    settings.solver.substeps = substeps;
    return settings;
}
/// A floor whose surface is at the height 0, 200 m wide.
inline body_id add_floor(world& w, vec from = {}, double friction = 0.6) {
    vec half = vec::filled(S(100));
    half.y = S(1);
    const body_id floor = w.create_body({.type = body_type::static_body, .position = from - along(1, 1)});
    w.create_shape(floor, world::box{half}, {.material = {.friction = S(friction)}});
    return floor;
}
/// A box of some half width and half height, in 3D as deep as wide or 15 cm.
inline body_id add_slab(world& w, vec position, vec half, double density, double friction, double angle = 0) {
    const body_id slab = w.create_body({.position = position, .rotation = turned_about_z(angle)});
    w.create_shape(slab, world::box{half}, {.density = S(density), .material = {.friction = S(friction)}});
    return slab;
}
inline body_id add_cube(world& w, vec position, double mass = 1, double friction = 0.6) {
    return add_slab(w, position, vec::filled(S(0.5)), mass, friction);
}

/// 15 crates, each a centimetre aside and a decimetre above of where it comes to rest.
inline void drop_stack(world& w) {
    add_floor(w);
    for (int i = 0; i < 15; ++i) add_cube(w, at(i % 2 ? 0.01 : -0.01, 0.55 + 1.1 * i), 1, 0.3);
}
/// Crates that touch, one upon the other.
inline void stand_stack(world& w, int height) {
    add_floor(w);
    for (int i = 0; i < height; ++i) add_cube(w, at(0, 0.5 + i));
}
/// A wall of crates that touch each other, one fewer in each row.
inline void lay_pyramid(world& w, int rows, vec from = {}) {
    add_floor(w, from);
    for (int row = 0; row < rows; ++row)
        for (int i = 0; i < rows - row; ++i) add_cube(w, from + at(i - 0.5 * (rows - row - 1), 0.5 + row));
}
/// Cards of 40 cm and 2 mm, in pairs that lean 25 degrees on each other, and cards across the tops of the pairs.
inline void house_of_cards(world& w, int floors) {
    const double lean = 25 * 3.14159265358979323846 / 180, half_height = 0.2, friction = 0.7, pitch = 0.35;
    add_floor(w, {}, friction);
    vec half = vec::filled(S(0.15));
    half.x = S(0.001);
    half.y = S(half_height);
    for (int floor = 0; floor < floors; ++floor) {
        const double left = 0.5 * pitch * floor, y = half_height - 0.02 + floor * (2 * half_height - 0.03);
        for (int i = 0; i < floors - floor; ++i) {
            const double x = left + i * pitch;
            if (i + 1 < floors - floor)
                add_slab(w, at(x + 0.25, y + half_height - 0.015), half, 1, friction, 1.5707963267948966);
            add_slab(w, at(x, y), half, 1, friction, -lean);
            add_slab(w, at(x + 0.5 * pitch, y), half, 1, friction, lean);
        }
    }
}

inline double length_of(vec v) { return gap(v, vec{}); }
inline double sideways(vec v) {
    v.y = S(0);
    return length_of(v);
}
/// The deepest overlap of all contacts (m).
inline double deepest_of(const world& w) {
    double deepest = 0;
    for (const auto& c : w.contacts())
        for (int k = 0; k < c.count; ++k) deepest = std::max(deepest, -number(c.points[k].separation));
    return deepest;
}

/// What becomes of a scene's bodies: how far any of them gets (m), and how fast (m/s).
struct fate {
    double sideways = 0, sunk = 0, risen = 0, fastest = 0, upward = 0, deepest = 0;
    /// The step in which the last one falls asleep; -1: never.
    int asleep_after = -1;
};
/// Lives until all sleep, or for some seconds; the step's length may change from step to step.
template <class Step>
fate live_by(world& w, double seconds, Step&& length_of_step) {
    fate f;
    std::vector<std::pair<body_id, vec>> start;
    for (const body_id id : w.bodies())
        if (w.type(id) == body_type::dynamic_body) start.emplace_back(id, w.position(id));
    double time = 0;
    for (int i = 0; time < seconds && w.awake_count() > 0; ++i) {
        const double h = length_of_step(i);
        w.step(S(h));
        time += h;
        f.deepest = std::max(f.deepest, deepest_of(w));
        for (const auto& [id, from] : start) {
            f.fastest = std::max(f.fastest, length_of(w.linear_velocity(id)));
            f.upward = std::max(f.upward, number(w.linear_velocity(id).y));
        }
        if (w.awake_count() == 0) f.asleep_after = i + 1;
    }
    for (const auto& [id, from] : start) {
        const vec displacement = w.position(id) - from;
        f.sideways = std::max(f.sideways, sideways(displacement));
        f.sunk = std::max(f.sunk, -number(displacement.y));
        f.risen = std::max(f.risen, number(displacement.y));
    }
    return f;
}
inline fate live(world& w, double seconds) {
    return live_by(w, seconds, [](int) { return 1.0 / 60; });
}

}  // namespace
