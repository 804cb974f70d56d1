// Shapes that are given with their places: upright and between two points.
#pragma once

#include "refusal.hpp"
#include "world_cell.hpp"

namespace {
namespace placed_laws {

template <class Placed>
auto box_of(const Placed& p) {
    return bounds(p.shape, world::transform{p.position, p.rotation});
}
/// The box of all points within r of a segment.
void check_box(const physics::aabb<S, cell::dimension>& box, vec a, vec b, double r) {
    for (int i = 0; i < cell::dimension; ++i) {
        CHECK(std::abs(number(box.lower[i]) - (std::min(number(a[i]), number(b[i])) - r)) <= rounding(64, 8));
        CHECK(std::abs(number(box.upper[i]) - (std::max(number(a[i]), number(b[i])) + r)) <= rounding(64, 8));
    }
}
CELL_CASE("placed: an upright capsule is as tall as it says, one between two points ends near them") {
    check_box(box_of(world::capsule::upright(S(1.75), S(0.25))), at(0, -0.625), at(0, 0.625), 0.25);
    cell::dice dice(7500);
    for (int i = 0; i < 200; ++i) {
        const vec a = dice.vec<vec>(-4, 4), b = i % 8 ? dice.vec<vec>(-4, 4) : a + along(i / 8 % cell::dimension, 1);
        check_box(box_of(world::capsule::between(a, b, S(0.5))), a, b, 0.5);
    }
}
CELL_CASE("placed: a world puts them there, moved by the pose of their definition") {
    world w;
    const body_id b = w.create_body({.position = at(2, 0)});
    const shape_id tall = w.create_shape(b, world::capsule::upright(S(2), S(0.25)));
    CHECK(gap(w.cast_ray(at(2, 4), along(1, -8)).point, at(2, 1)) <= rounding(64, 8));
    CHECK(gap(w.mass(b).center, vec{}) <= rounding(8));
    w.destroy_shape(tall);
    // Turned by a quarter it lies along x again.
    w.create_shape(b, world::capsule::upright(S(2), S(0.25)),
                   {.position = at(0, 3), .rotation = turned_about_z(-1.5707963267948966)});
    CHECK(gap(w.cast_ray(at(-8, 3), along(0, 16)).point, at(1, 3)) <= rounding(256, 8));
    w.create_shape(b, world::capsule::between(at(0, 4), at(0, 8), S(0.5)), {.position = at(1, 0)});
    CHECK(gap(w.cast_ray(at(3, 16), along(1, -16)).point, at(3, 8.5)) <= rounding(256, 16));
}
CELL_CASE("placed: what has no length is refused by its own number") {
    world w;
    const body_id b = w.create_body();
    refuses(w, "create_shape", "half_length", "0", [&] { w.create_shape(b, world::capsule::between({}, {}, S(1))); });
    refuses(w, "create_shape", "half_length", "-0.5", [&] { w.create_shape(b, world::capsule::upright(S(1), S(1))); });
}
#if CELL_DIMENSION == 3
CELL_CASE("placed: cylinders and cones stand upright, or from a point to a point") {
    const auto drum = box_of(world::cylinder::upright(S(2), S(0.5)));
    CHECK(gap(drum.lower, vec{S(-0.5), S(-1), S(-0.5)}) <= rounding(64));
    CHECK(gap(drum.upper, vec{S(0.5), S(1), S(0.5)}) <= rounding(64));
    const auto hat = box_of(world::cone::upright(S(2), S(0.5)));
    CHECK(gap(hat.lower, vec{S(-0.5), S(-1), S(-0.5)}) <= rounding(64));
    CHECK(gap(hat.upper, vec{S(0.5), S(1), S(0.5)}) <= rounding(64));
    // Its tip is above.
    const auto cone = world::cone::between({S(1), S(0), S(0)}, {S(1), S(4), S(0)}, S(0.5));
    const world::transform pose{cone.position, cone.rotation};
    const auto tip = pose * support(cone.shape, inverse_rotate(cone.rotation, along(1, 1)));
    CHECK(gap(tip, vec{S(1), S(4), S(0)}) <= rounding(64, 4));
    const auto rod = world::cylinder::between({S(0), S(0), S(-2)}, {S(0), S(0), S(2)}, S(0.25));
    CHECK(gap(box_of(rod).upper, vec{S(0.25), S(0.25), S(2)}) <= rounding(64, 4));
}
#endif

}  // namespace placed_laws
}  // namespace
