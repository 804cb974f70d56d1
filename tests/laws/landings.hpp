// Laws of landings: nothing sinks into what stands, however fast it comes and in whichever phase of the step, nor loses
// its bounce or its way along the surface.
#pragma once

#include <vector>

#include "world_cell.hpp"

namespace {
namespace landing_laws {

#if CELL_DIMENSION == 2
using all_shapes =
    physics::shapes<physics::ball, physics::capsule, physics::box, physics::hull, physics::halfspace, physics::chain>;
#else
using all_shapes =
    physics::shapes<physics::ball, physics::capsule, physics::box, physics::hull, physics::halfspace, physics::mesh>;
#endif
struct everything : physics::recipe<S, cell::dimension, all_shapes> {};
using wide_world = physics::world<everything>;
constexpr int D = cell::dimension;

enum class ground { slab, half, parts };

/// Level at the height 0, from -8 to 8 at least.
inline void add_ground(wide_world& w, ground kind, const physics::material<S, D>& material) {
    const body_id body = w.create_body({.type = body_type::static_body});
    if (kind == ground::half) {
        w.create_shape(body, wide_world::halfspace{}, {.material = material});
    } else if (kind == ground::slab) {
        vec half = vec::filled(S(8));
        half.y = S(1);
        w.create_shape(body, wide_world::box{half}, {.position = at(0, -1), .material = material});
    } else {
        std::vector<vec> points;
#if CELL_DIMENSION == 2
        for (int x = 8; x >= -8; --x) points.push_back(at(x, 0));
        w.create_shape(body, wide_world::chain_geometry::build(points.data(), 17).shape(), {.material = material});
#else
        std::vector<std::uint32_t> t;
        for (std::uint32_t z = 0; z <= 8; ++z)
            for (std::uint32_t x = 0; x <= 8; ++x) points.push_back(at(2 * int(x) - 8, 0) + along(2, 2 * int(z) - 8));
        for (std::uint32_t z = 0; z < 8; ++z)
            for (std::uint32_t x = 0; x < 8; ++x) {
                const std::uint32_t a = z * 9 + x, b = a + 1, c = a + 9, d = c + 1;
                t.insert(t.end(), {a, c, d, a, d, b});
            }
        w.create_shape(body, wide_world::mesh_geometry::build(points.data(), 81, t.data(), 128).shape(),
                       {.material = material});
#endif
    }
}
inline const wide_world::hull_geometry& wedge() {
    static const wide_world::hull_geometry hull = [] {
        std::vector<vec> points;
        for (int i = 0; i < 1 << D; ++i) {
            vec p;
            for (int k = 0; k < D; ++k) p[k] = S((i >> k & 1) ? 0.3 + 0.06 * k : -0.3);
            if (i & 1) p.y *= S(0.5);
            points.push_back(p);
        }
        return wide_world::hull_geometry::build(points.data(), static_cast<std::uint32_t>(points.size()));
    }();
    return hull;
}

/// How deep a body comes that falls at a speed, in 1 s, at most; `phases` of the step.
template <class Shape>
double deepest(const Shape& shape, ground kind, double speed, double angle, double spin, int phases) {
    double depth = 0;
    for (int phase = 0; phase < phases; ++phase) {
        wide_world w;
        add_ground(w, kind, {});
        const body_id body = w.create_body({.position = at(0, 0.9 + speed / 64 * ((phase + 0.375) / phases + 0.5)),
                                            .rotation = turned_about_z(angle),
                                            .linear_velocity = along(1, -speed),
                                            .angular_velocity = about_z(spin)});
        w.create_shape(body, shape);
        for (int i = 0; i < 12 + 32 / speed; ++i) {
            w.step(S(1.0 / 64));
            depth = std::max(depth, -number(bounds(shape, w.pose(body)).lower.y));
        }
    }
    return depth;
}
template <class Shape>
void land(const Shape& shape, double angle, double spin = 0) {
    for (const ground kind : {ground::slab, ground::half, ground::parts})
        for (const double speed : {1.5, 2.5, 5.0, 10.0, 20.0, 40.0}) {
            CAPTURE(int(kind));
            CAPTURE(speed);
            CAPTURE(angle);
            CHECK(deepest(shape, kind, speed, angle, spin, 4) <= 0.005);
        }
}
CELL_CASE("landings: nothing sinks in by more than 5 mm, at any speed, turned in any way") {
    vec half = vec::filled(S(0.35));
    half.y = S(0.45);
    land(wide_world::ball{S(0.35)}, 0, 5);
    land(wide_world::box{half}, 0);
    land(wide_world::box{half}, 0.1);
    land(wide_world::box{half}, 0.7);
    land(wide_world::box{half}, 0.3, 8);
    land(wide_world::capsule{S(0.4), S(0.2)}, 1.4);
    land(wedge().shape(), 0.2);
}

CELL_CASE("landings: what bounces keeps its speed, and all keep their way along the surface") {
    for (const ground kind : {ground::slab, ground::half, ground::parts})
        for (const double speed : {4.0, 12.0, 40.0})
            for (const double e : {0.0, 1.0})
                for (int phase = 0; phase < 4; ++phase) {
                    wide_world::settings_type settings;
                    settings.gravity = {};
                    wide_world w(settings);
                    add_ground(w, kind, {.friction = S(0), .restitution = S(e)});
                    const body_id body =
                        w.create_body({.position = at(-2, 0.5 + speed / 64 * ((phase + 0.375) / 4 + 1)),
                                       .linear_velocity = at(8, -speed)});
                    w.create_shape(body, wide_world::ball{S(0.3)},
                                   {.material = {.friction = S(0), .restitution = S(e)}});
                    int stopped = 0;
                    for (int i = 0; i < 16; ++i) {
                        w.step(S(1.0 / 64));
                        stopped += static_cast<int>(w.continuous_report().stopped);
                    }
                    CAPTURE(int(kind));
                    CAPTURE(speed);
                    CAPTURE(phase);
                    if (stopped > 0) CHECK(std::abs(number(w.linear_velocity(body).y) - e * speed) <= 0.01 * speed);
                    CHECK(std::abs(number(w.position(body).x)) <= 0.01 + rounding(64, 8));
                    CHECK(number(w.position(body).y) >= 0.299);
                }
}

CELL_CASE("landings: what lands flat neither slides nor turns, nor hops") {
    vec cube = vec::filled(S(0.5)), brick = cube;
    brick.y = S(0.15);
    for (const ground kind : {ground::slab, ground::half, ground::parts})
        for (const double speed : {4.0, 16.0})
            for (const double e : {0.0, 0.5, 1.0})
                for (const int substeps : {1, 4, 16})
                    for (int run = 0; run < 16; ++run) {
                        const vec half = run % 2 == 0 ? cube : brick;
                        const physics::material<S, D> rough{.friction = S(0.6), .restitution = S(e)};
                        wide_world::settings_type settings;
                        settings.solver.substeps = substeps;
                        wide_world w(settings);
                        add_ground(w, kind, rough);
                        const double height = number(half.y) + 0.02 + speed / 64 * (1 + run / 16.0);
                        const body_id body =
                            w.create_body({.position = at(0.2, height), .linear_velocity = along(1, -speed)});
                        w.create_shape(body, wide_world::box{half}, {.material = rough});
                        for (int i = 0; i < 16; ++i) w.step(S(1.0 / 64));
                        vec v = w.linear_velocity(body);
                        v.y = S(0);
                        CAPTURE(int(kind));
                        CAPTURE(speed);
                        CAPTURE(e);
                        CAPTURE(substeps);
                        CAPTURE(run);
                        CHECK(gap(v, vec{}) <= 0.001 * speed);
                        if (e == 0) CHECK(number(w.position(body).y) <= number(half.y) + 0.002);
                        CHECK(gap(w.angular_velocity(body), about_z(0)) <= 0.002 * speed);
                    }
}

CELL_CASE("flagged balls that go by each other closer than they are wide meet, however little") {
    struct flags : physics::recipe<S, D, physics::soft_step> {};
    for (const double speed : {18.0, 200.0})
        for (int run = 0; run < 24; ++run) {
            physics::world<flags>::settings_type settings;
            settings.gravity = {};
            physics::world<flags> w(settings);
            const double far = 1 + speed / 64 * ((7 * run) % 24 + 0.5) / 24, off = 0.396 * (run + 0.5) / 24;
            const body_id left =
                w.create_body({.position = at(-far, off), .linear_velocity = along(0, speed / 4), .continuous = true});
            const body_id right = w.create_body(
                {.position = at(far, 0), .linear_velocity = along(0, -speed * 3 / 4), .continuous = true});
            for (const body_id b : {left, right}) w.create_shape(b, world::ball{S(0.2)});
            for (int i = 0; i < 4 + 3 * 64 * far / speed; ++i) w.step(S(1.0 / 64));
            CAPTURE(speed);
            CAPTURE(off);
            CHECK(gap(w.linear_velocity(left), along(0, speed / 4)) > 0.01 * speed);
        }
}

}  // namespace landing_laws
}  // namespace
