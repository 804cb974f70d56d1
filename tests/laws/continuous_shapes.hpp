// Laws of continuous collision with hulls, compounds and surfaces made of parts.
#pragma once

#include <vector>

#include "world_cell.hpp"

namespace {
namespace continuous_shapes_laws {

#if CELL_DIMENSION == 2
using all_shapes = physics::shapes<physics::ball, physics::capsule, physics::box, physics::hull, physics::compound,
                                   physics::chain, physics::heightfield, physics::tile_grid>;
#else
using all_shapes = physics::shapes<physics::ball, physics::capsule, physics::box, physics::hull, physics::compound,
                                   physics::mesh, physics::heightfield, physics::cylinder, physics::cone>;
#endif
struct everything : physics::recipe<S, cell::dimension, all_shapes> {};
using wide_world = physics::world<everything>;
constexpr int D = cell::dimension;

enum class surface { bumps, field, grid };

/// Level ground at the height 0 from -8 to 8, in parts of 1 m; of triangles or segments, as a heightfield or as tiles.
inline body_id add_ground(wide_world& w, surface kind, bool two_sided = false) {
    const body_id ground = w.create_body({.type = body_type::static_body});
#if CELL_DIMENSION == 2
    if (kind == surface::bumps) {
        std::vector<vec> points;
        for (int x = 8; x >= -8; --x) points.push_back(at(x, 0));
        w.create_shape(ground, wide_world::chain_geometry::build(points.data(), 17, {.two_sided = two_sided}).shape());
    } else if (kind == surface::field) {
        const std::vector<S> heights(17);
        w.create_shape(
            ground, wide_world::heightfield_geometry::build(heights.data(), 17, S(1), {.two_sided = two_sided}).shape(),
            {.position = at(-8, 0)});
    } else {
        const std::vector<std::uint8_t> cells(16, 1);
        w.create_shape(ground, wide_world::tile_grid_geometry::build(cells.data(), 16, 1, S(1)).shape(),
                       {.position = at(-8, -1)});
    }
#else
    vec corner = at(-8, 0);
    corner.z = S(-8);
    if (kind == surface::bumps) {
        std::vector<vec> points;
        std::vector<std::uint32_t> t;
        for (std::uint32_t z = 0; z <= 16; ++z)
            for (std::uint32_t x = 0; x <= 16; ++x) points.push_back(corner + vec{S(int(x)), S(0), S(int(z))});
        for (std::uint32_t z = 0; z < 16; ++z)
            for (std::uint32_t x = 0; x < 16; ++x) {
                const std::uint32_t a = z * 17 + x, b = a + 1, c = a + 17, d = c + 1;
                t.insert(t.end(), {a, c, d, a, d, b});
            }
        w.create_shape(
            ground,
            wide_world::mesh_geometry::build(points.data(), 289, t.data(), 512, {.two_sided = two_sided}).shape());
    } else {
        const std::vector<S> heights(289);
        w.create_shape(ground,
                       wide_world::heightfield_geometry::build(heights.data(), 17, 17, S(1), S(1),
                                                               {.alternating = true, .two_sided = two_sided})
                           .shape(),
                       {.position = corner});
    }
#endif
    return ground;
}
inline std::vector<surface> surfaces() {
    if (cell::is_2d) return {surface::bumps, surface::field, surface::grid};
    return {surface::bumps, surface::field};
}

/// A hull and a compound of two balls and a rod, about 0.2 across.
inline const wide_world::hull_geometry& wedge() {
    static const wide_world::hull_geometry hull = [] {
        std::vector<vec> points;
        for (int i = 0; i < 1 << D; ++i) {
            vec p;
            for (int k = 0; k < D; ++k) p[k] = S((i >> k & 1) ? 0.1 + 0.02 * k : -0.1);
            if (i & 1) p.y *= S(0.5);
            points.push_back(p);
        }
        return wide_world::hull_geometry::build(points.data(), static_cast<std::uint32_t>(points.size()));
    }();
    return hull;
}
inline const wide_world::compound_geometry& dumbbell() {
    static const auto bell = wide_world::compound_geometry::build({{wide_world::ball{S(0.1)}, at(-0.2, 0)},
                                                                   {wide_world::ball{S(0.1)}, at(0.2, 0)},
                                                                   {wide_world::capsule{S(0.2), S(0.05)}}});
    return bell;
}
inline wide_world open_range(double gravity = 0) {
    wide_world::settings_type settings;
    settings.gravity = along(1, -gravity);
    return wide_world(settings);
}

/// Shoots a body at the ground; true if it is beyond in the end.
template <class Shape>
bool passes(const Shape& shape, cell::dice& dice, surface kind, double from, double speed, double spin,
            bool two_sided = false) {
    wide_world w = open_range();
    add_ground(w, kind, two_sided);
    const double up = from > 0 ? 1 : -1;
    vec place = dice.vec<vec>(-2, 2), displacement = dice.vec<vec>(-0.2, 0.2);
    // Often at an edge or at a corner of parts.
    for (int i = 0; i < D; ++i)
        if (dice.below(3) == 0) place[i] = S(dice.below(5) - 2), displacement[i] = S(0);
    place.y = S(from + up * dice.number(0, speed / 64));
    displacement.y = S(-up);
    const body_id body = w.create_body({.position = place,
                                        .rotation = random_rotation(dice),
                                        .linear_velocity = displacement * S(speed),
                                        .angular_velocity = skew(spin)});
    w.create_shape(body, shape);
    for (int i = 0; i < 6 + 80 / speed; ++i) {
        // Those that bounce off or slide may leave the ground over its rim.
        const vec next = w.position(body) + w.linear_velocity(body) * S(1.0 / 64);
        if (i > 0 && (std::abs(number(next.x)) > 6.5 || (cell::is_3d && std::abs(number(next[D - 1])) > 6.5)))
            return false;
        w.step(S(1.0 / 64));
        if (number(w.center_of_mass(body).y) * up < 0) return true;
    }
    return false;
}
CELL_CASE("no shape passes a surface from its front, at edges and corners of its parts neither") {
    cell::dice dice(600);
    for (const surface kind : surfaces())
        for (const double speed : {20.0, 100.0, 1000.0})
            for (const double spin : {0.0, 30.0})
                for (int run = 0; run < 6; ++run) {
                    CAPTURE(int(kind));
                    CAPTURE(speed);
                    CAPTURE(spin);
                    CAPTURE(run);
                    REQUIRE_FALSE(passes(wide_world::ball{S(0.1)}, dice, kind, 0.6, speed, spin));
                    REQUIRE_FALSE(passes(wide_world::box{vec::filled(S(0.1))}, dice, kind, 0.6, speed, spin));
                    REQUIRE_FALSE(passes(wide_world::capsule{S(0.2), S(0.05)}, dice, kind, 0.6, speed, spin));
                    REQUIRE_FALSE(passes(wedge().shape(), dice, kind, 0.6, speed, spin));
                    REQUIRE_FALSE(passes(dumbbell().shape(), dice, kind, 0.6, speed, spin));
                }
}
CELL_CASE("from behind bodies fly through one-sided surfaces as if there were none, and not through two-sided ones") {
    cell::dice dice(601);
    for (const surface kind : {surface::bumps, surface::field})
        for (int run = 0; run < 12; ++run) {
            CHECK(passes(wide_world::ball{S(0.1)}, dice, kind, -0.4, 200, 0));
            CHECK(passes(wedge().shape(), dice, kind, -0.4, 200, 0));
            CHECK_FALSE(passes(wide_world::ball{S(0.1)}, dice, kind, -0.4, 200, 0, true));
            CHECK_FALSE(passes(wedge().shape(), dice, kind, -0.4, 200, 10, true));
        }
}

CELL_CASE("what rolls or slides fast over the inner edges of a surface is swept, and never stopped") {
    for (const surface kind : surfaces())
        for (const double speed : {20.0, 60.0, 200.0})
            for (const bool slides : {false, true}) {
                CAPTURE(static_cast<int>(kind));
                CAPTURE(speed);
                CAPTURE(slides);
                wide_world w = open_range(10);
                add_ground(w, kind);
                vec start = at(-7.5, 0.1);
                if (cell::is_3d) start[D - 1] = S(0.3);
                const body_id body = w.create_body({.position = start, .linear_velocity = along(0, speed)});
                if (slides)
                    w.create_shape(body, wide_world::box{vec::filled(S(0.1))}, {.material = {.friction = S(0)}});
                else w.create_shape(body, wide_world::ball{S(0.1)}, {.material = {.friction = S(0)}});
                const int steps = static_cast<int>(15 / speed * 64);
                for (int i = 0; i < steps; ++i) {
                    w.step(S(1.0 / 64));
                    REQUIRE(w.continuous_report().swept == 1);
                    // Fixed point rounds the seams of a surface by as much as stops it for a moment.
                    if (!cell::is_fixed) REQUIRE(w.continuous_report().stopped == 0);
                }
                CHECK(std::abs(number(w.position(body).x) + 7.5 - steps * speed / 64) <=
                      0.01 * speed / 64 + rounding(64, 8));
                CHECK(std::abs(number(w.position(body).y) - 0.1) <= 0.01);
            }
}

/// Gives a flat body the same inertia about all axes: what spins fast and does not tumble gains no energy.
template <class World>
void calm(World& w, body_id b) {
    if constexpr (cell::is_3d) {
        auto mass = w.mass(b);
        mass.inertia = {mass.inertia.yy, mass.inertia.yy, mass.inertia.yy, S(0), S(0), S(0)};
        w.set_mass(b, mass);
    }
}
CELL_CASE("a sheet of paper made of a hull, thrown edge on and turning, does not pass a wall as thin") {
    vec half = vec::filled(S(0.2));
    half.y = S(0.005);
    std::vector<vec> points;
    for (int i = 0; i < 1 << D; ++i) {
        vec p = half;
        for (int k = 0; k < D; ++k)
            if (i >> k & 1) p[k] = -p[k];
        points.push_back(p);
    }
    const auto sheet = wide_world::hull_geometry::build(points.data(), static_cast<std::uint32_t>(points.size()));
    cell::dice dice(602);
    for (int run = 0; run < 24; ++run) {
        wide_world w = open_range();
        vec wall = vec::filled(S(20));
        wall.x = S(0.0005);
        w.create_shape(w.create_body({.type = body_type::static_body}), wide_world::box{wall});
        const body_id body = w.create_body({.position = at(-1 - dice.number(0, 3), 0),
                                            .rotation = random_rotation(dice),
                                            .linear_velocity = along(0, run % 2 ? 200 : 20),
                                            .angular_velocity = skew(dice.number(-60, 60))});
        w.create_shape(body, sheet.shape());
        calm(w, body);
        for (int i = 0; i < 30; ++i) {
            w.step(S(1.0 / 64));
            CAPTURE(run);
            CAPTURE(i);
            CAPTURE(w.position(body));
            CAPTURE(w.linear_velocity(body));
            CAPTURE(w.continuous_report().unconverged);
            REQUIRE(number(w.position(body).x) < 0);
        }
    }
}

#if CELL_DIMENSION == 3
/// Sets a body of the radius 0.5 on its edge, spinning, and runs it for 3 s: the most energy of any time, as a part of
/// what it began with, and the most that a step made.
struct energies {
    double maximum, made;
};
template <class Shape>
energies energies_of_spun(const Shape& shape, surface ground, double lean, double spin, double step, int substeps) {
    auto settings = open_range(10).settings();
    settings.solver.substeps = substeps;
    wide_world w(settings);
    add_ground(w, ground);
    const body_id body = w.create_body(
        {.position = at(0.1, 0.6), .rotation = turned_about_z(1.57 - lean), .angular_velocity = along(1, spin)});
    w.create_shape(body, shape);
    const auto first = w.energy();
    const double whole = first.kinetic + first.potential;
    energies result{};
    for (int i = 0; i * step < 3; ++i) {
        const auto now = w.step_with_energy_report(S(step));
        result.maximum = std::max(result.maximum, (now.kinetic + now.potential) / whole);
        result.made = std::max(result.made, now.made / whole);
    }
    CHECK(w.position(body).y > S(0));
    return result;
}
CELL_CASE("what is spun on its edge gains no energy, however thin, at any substeps and rates") {
    const auto coin = wide_world::cylinder{S(0.02), S(0.5)};
    for (const double step : {1.0 / 32, 1.0 / 64})
        for (const int substeps : {1, 4, 16})
            for (const double spin : {3.0, 8.0, 20.0})
                for (const double lean : {0.8, 1.2, 1.4}) {
                    CAPTURE(step);
                    CAPTURE(substeps);
                    CAPTURE(spin);
                    CAPTURE(lean);
                    for (const auto& e : {energies_of_spun(coin, surface::bumps, lean, spin, step, substeps),
                                          energies_of_spun(coin, surface::field, lean, spin, step, substeps),
                                          energies_of_spun(wide_world::cone{S(0.05), S(0.5), S(0.3)}, surface::bumps,
                                                           lean, spin, step, substeps),
                                          energies_of_spun(wide_world::box{vec{S(0.02), S(0.35), S(0.35)}},
                                                           surface::bumps, lean, spin, step, substeps)}) {
                        CHECK(e.maximum <= 1.0001 + rounding(256));
                        // They sink into the ground, the less the more substeps, and are lifted out of there: with one
                        // by half of a coin's thickness at most, of the 0.6 m from which they fall.
                        CHECK(e.made <= 0.02 / 0.6 / substeps);
                    }
                }
}
#endif

CELL_CASE("sweeps: a body reaches as far, whether its shapes come one by one or are measured together") {
    cell::dice dice(71);
    for (const body_type type : {body_type::static_body, body_type::kinematic_body, body_type::dynamic_body}) {
        world w;
        const body_id b = w.create_body({.type = type, .position = at(1, 2)});
        const auto& data = physics::detail::world_access::data_of(w);
        using plan = physics::detail::plan_of<scene>::type;
        const auto is_measured = [&] {
            const auto all = physics::detail::measure_body<plan>(data.bodies, data.shapes, b.index);
            const auto& known = data.continuous.extents[b.index];
            CHECK(known.thickness == all.thickness);
            CHECK(known.reach == all.reach);
            CHECK(known.outer == all.outer);
        };
        std::vector<shape_id> shapes;
        for (int i = 0; i < 24; ++i) {
            const world::shape_def def{.position = dice.vec<vec>(-3, 3), .rotation = random_rotation(dice)};
            const S size = dice.real(0.1, 1);
            if (i % 3 == 0) shapes.push_back(w.create_shape(b, world::ball{size}, def));
            else if (i % 3 == 1) shapes.push_back(w.create_shape(b, world::box{vec::filled(size)}, def));
            else shapes.push_back(w.create_shape(b, world::capsule{size, dice.real(0.1, 1)}, def));
            is_measured();
            if (i % 5 != 4) continue;
            w.destroy_shape(shapes[static_cast<std::size_t>(i / 2)]);
            is_measured();
        }
        w.set_type(b, body_type::static_body);
        is_measured();
    }
}

}  // namespace continuous_shapes_laws
}  // namespace
