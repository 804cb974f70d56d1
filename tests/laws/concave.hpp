// Laws of worlds with concave shapes: bodies roll, slide and rest on surfaces as if these were whole.
#pragma once

#include <memory>
#include <string>

#include "concave_shapes.hpp"

namespace {
namespace concave_laws {

/// A set of shapes, with what worlds make of it.
template <template <class, int> class... Shapes>
struct set_of {
    struct level : physics::recipe<S, D, physics::shapes<Shapes...>> {};
    using any = physics::any_shape<S, D, Shapes...>;
    using found = physics::manifold_list<S, D>;
    using query = physics::narrowphase_query<S, D, Shapes...>;
    using narrow = physics::best_per_pair::in<S, D, Shapes...>;
    static found meet(const any& a, const any& b, const transform& b_in_a, double margin) {
        const query q{&a, &b, b_in_a};
        found list;
        narrow::collide(&q, 1, S(margin), list);
        return list;
    }
};
#if CELL_DIMENSION == 2
using set = set_of<physics::ball, physics::capsule, physics::box, physics::halfspace, physics::hull, physics::chain,
                   physics::tile_grid, physics::heightfield, physics::compound>;
const std::vector<std::string> surfaces = {"chain", "heightfield", "tiles"};
#else
using set = set_of<physics::ball, physics::capsule, physics::box, physics::halfspace, physics::hull, physics::cylinder,
                   physics::mesh, physics::heightfield, physics::compound>;
const std::vector<std::string> surfaces = {"mesh", "heightfield", "chessboard"};
#endif
using world = physics::world<set::level>;
using physics::body_id;
using physics::body_type;

inline world::angular about_z(double size) { return to_angular({0, 0, size}); }
inline double speed(const world& w, body_id b) {
    return size(to_reals(w.linear_velocity(b))) + size(to_reals(w.angular_velocity(b)));
}
inline void run(world& w, int n) {
    for (int i = 0; i < n; ++i) w.step(S(1.0 / 64));
}

/// A surface, where its frame stands, and what keeps it.
struct ground {
    set::any shape;
    vec at;
    std::vector<std::shared_ptr<void>> kept;

    template <class Geometry>
    void take(const Geometry& g) {
        shape = g.shape();
        kept.push_back(std::make_shared<Geometry>(g));
    }
};
/// A surface of cells with sides of `step`, in the middle of the world, whose height depends on x and z. Tiles are
/// flat.
template <class Height>
ground make_ground(const std::string& kind, int cells, double step, Height height, bool two_sided = false) {
    ground result;
    result.shape = world::halfspace{};
    if (kind == "halfspace") return result;
    const double half = cells * step / 2;
    const auto y = [&](int i, int k) { return height(i * step - half, cell::is_3d ? k * step - half : 0); };
    const auto n = static_cast<std::uint32_t>(cells + 1);
    std::vector<S> heights;
    for (int k = 0; k <= (cell::is_3d ? cells : 0); ++k)
        for (int i = 0; i <= cells; ++i) heights.push_back(S(y(i, k)));
#if CELL_DIMENSION == 2
    if (kind == "chain") {
        points p;
        for (int i = cells; i >= 0; --i) p.push_back(point(i * step - half, y(i, 0)));
        result.take(world::chain_geometry::build(p.data(), n, {.two_sided = two_sided}));
    } else if (kind == "heightfield") {
        result.at = point(-half, 0);
        result.take(world::heightfield_geometry::build(heights.data(), n, S(step), {.two_sided = two_sided}));
    } else {
        const std::vector<std::uint8_t> solid(std::size_t(cells) * 3, 1);
        result.at = point(-half, -3 * step);
        result.take(world::tile_grid_geometry::build(solid.data(), n - 1, 3, S(step)));
    }
#else
    result.at = point(-half, 0, -half);
    if (kind == "mesh") result.take(mesh_of(heights, n, n, step, step, true, two_sided));
    else
        result.take(world::heightfield_geometry::build(heights.data(), n, n, S(step), S(step),
                                                       {.alternating = kind == "chessboard", .two_sided = two_sided}));
#endif
    return result;
}
template <class Height>
body_id add_surface(world& w, const std::string& kind, int cells, double step, Height height,
                    physics::material<S, cell::dimension> material = {}, bool two_sided = false) {
    const body_id body = w.create_body({.type = body_type::static_body});
    const ground g = make_ground(kind, cells, step, height, two_sided);
    g.shape.visit([&](const auto& shape) { w.create_shape(body, shape, {.position = g.at, .material = material}); });
    return body;
}
inline double flat(double, double) { return 0; }

/// What somebody sees who follows a body over the ground.
struct journey {
    double height = 0, climb = 0, spin = 0;
    reals end, velocity;
};
/// Follows a body whose origin belongs at that height.
inline journey follow(world& w, body_id b, double height, int steps, double wanted_spin = 0) {
    journey j;
    for (int i = 0; i < steps; ++i) {
        w.step(S(1.0 / 64));
        if (i < 6) continue;
        j.height = std::fmax(j.height, std::abs(number(w.position(b).y) - height));
        j.climb = std::fmax(j.climb, std::abs(number(w.linear_velocity(b).y)));
        j.spin = std::fmax(j.spin, std::abs(size(to_reals(w.angular_velocity(b))) - wanted_spin));
    }
    j.end = to_reals(w.position(b));
    j.velocity = to_reals(w.linear_velocity(b));
    return j;
}

/// A body of some kind, at most 1 from its origin.
inline set::any some_body(int kind, cell::dice& dice) {
    static std::vector<hull_geometry> hulls;
    if (kind == 0) return world::ball{S(0.5)};
    if (kind == 1) return world::capsule{S(0.5), S(0.25)};
    if (kind == 2) return world::box{point(0.5, 0.3, 0.4)};
    if (kind == 3) return two_boxes().shape();
#if CELL_DIMENSION == 3
    if (kind == 4) return physics::cylinder<S, 3>{.half_length = S(0.4), .radius = S(0.5)};
#endif
    points p;
    for (int i = 0; i < 12; ++i) {
        const double far = dice.number(0.3, 1);
        p.push_back(from_reals(random_direction(dice) * far));
    }
    hulls.push_back(hull_geometry::build(p.data(), 12));
    return hulls.back().shape(S(kind == 6 ? 0.1 : 0));
}
/// The least separation, and how far normals lean away from a direction.
struct contact_summary {
    double deepest = 1, lean = 0;

    contact_summary(const set::found& found, reals up) {
        for (const auto& f : found) {
            lean = std::fmax(lean, size(to_reals(f.contact.normal) - up));
            for (int i = 0; i < f.contact.count; ++i)
                deepest = std::fmin(deepest, number(f.contact.points[i].separation));
        }
    }
};

CELL_CASE("concave: the contact with flat surfaces is that with a halfspace") {
    const ground plane = make_ground("halfspace", 1, 1, flat);
    for (const std::string& kind : surfaces) {
        const ground g = make_ground(kind, 20, 0.4, flat);
        cell::dice dice(5);
        for (int round = 0; round < 1400; ++round) {
            const int k = round % 7;
            CAPTURE(kind);
            CAPTURE(round);
            const set::any body = some_body(k, dice);
            transform at = random_transform(dice, 1);
            at.position.y = S(0);
            const physics::aabb<S, D> box = bounds(body, at);
            // Tightly around the body: its lowest point.
            const double margin = 0.02, depth = dice.number(-0.05, 0.05);
            at.position.y = S(-number(box.lower.y) - depth);
            const contact_summary wanted(set::meet(plane.shape, body, at, margin), {0, 1, 0});
            transform from = at;
            from.position = from.position - g.at;
            const auto found = set::meet(g.shape, body, from, margin);
            const contact_summary seen(found, {0, 1, 0});
            REQUIRE(seen.lean < 1e-5);
            REQUIRE((seen.deepest < 1) == (wanted.deepest < 1));
            if (wanted.deepest < 1) REQUIRE(std::abs(seen.deepest - wanted.deepest) < 4e-3);
            REQUIRE(found.size() <= (k == 3 ? 2u : 1u));
        }
    }
}

CELL_CASE("concave: the contact with a closed surface is that with the solid inside") {
    ground g;
#if CELL_DIMENSION == 2
    g.take(world::chain_geometry::build({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, {.loop = true}));
#else
    points p;
    for (const vec c : corners_of_cube) p.push_back(c * S(2) - vec::filled(S(1)));
    g.take(build(p, sides_of_cube));
#endif
    const world::box solid{vec::filled(S(1))};
    cell::dice dice(3);
    int overlaps = 0, different = 0;
    for (int round = 0; round < 7000; ++round) {
        // Two boxes at once may touch twice.
        if (round % 7 == 3) continue;
        const set::any body = some_body(round % 7, dice);
        transform at = random_transform(dice, 1.9);
        const contact_summary wanted(set::meet(solid, body, at, 0.02), {});
        const contact_summary seen(set::meet(g.shape, body, at, 0.02), {});
        CAPTURE(round);
        CAPTURE(wanted.deepest);
        CAPTURE(seen.deepest);
        if (wanted.deepest < -0.05) continue;
        if (wanted.deepest < 0.019) REQUIRE(seen.deepest < 1);
        if (wanted.deepest >= 1) REQUIRE(seen.deepest > 0.01);
        if (wanted.deepest >= 1 || seen.deepest >= 1) continue;
        const bool same = std::abs(seen.deepest - wanted.deepest) < 6e-3;
        if (wanted.deepest > 0) REQUIRE(same);
        ++overlaps;
        different += !same;
    }
    CHECK(overlaps > 100);
    CHECK(different * 100 <= overlaps);
}

CELL_CASE("concave: a ball rolls over inner edges without a bump") {
    for (const std::string& kind : surfaces)
        for (int k = 0; k < (cell::is_3d ? 8 : 2); ++k) {
            CAPTURE(kind);
            CAPTURE(k);
            const double angle = cell::is_3d ? 0.02 + k * M_PI / 4 * (k < 4 ? 1 : 0.93) : k * M_PI;
            const reals displacement{std::cos(angle), 0, cell::is_3d ? std::sin(angle) : 0};
            const reals from = displacement * -5 + reals{0.03, 0.5, cell::is_3d ? 0.017 : 0};
            journey seen[2];
            for (int i = 0; i < 2; ++i) {
                world w;
                add_surface(w, i == 0 ? "halfspace" : kind, 40, 0.5, flat);
                const body_id b = w.create_body({.position = from_reals(from),
                                                 .linear_velocity = from_reals(displacement * 6),
                                                 .angular_velocity = to_angular(cross({0, 1, 0}, displacement) * 12)});
                w.create_shape(b, world::ball{S(0.5)});
                seen[i] = follow(w, b, 0.5, 110, 12);
            }
            // It sinks into the springs by a thousandth of its radius at most, on whatever surface.
            CHECK(seen[1].height < 5e-4);
            CHECK(std::abs(seen[1].height - seen[0].height) < 1e-5);
            CHECK(seen[1].climb < 1e-3);
            CHECK(seen[1].spin < seen[0].spin + 1e-3);
            CHECK(size(seen[1].end - (from + displacement * (6 * 110 / 64.0))) < 2e-3);
        }
}

CELL_CASE("concave: what slides over inner edges slides as on a halfspace") {
    for (const std::string& kind : surfaces)
        for (int k = 0; k < (cell::is_3d ? 6 : 2); ++k)
            for (int body = 0; body < 4; ++body) {
                CAPTURE(kind);
                CAPTURE(k);
                CAPTURE(body);
                const double angle = cell::is_3d ? k * M_PI / 4 : k * M_PI;
                const reals displacement{std::cos(angle), 0, cell::is_3d ? std::sin(angle) : 0};
                const double height = body == 1 ? 0.25 : 0.5;
                journey seen[2];
                for (int i = 0; i < 2; ++i) {
                    world w;
                    add_surface(w, i == 0 ? "halfspace" : kind, 40, 0.5, flat, {.friction = S(0.01)});
                    world::body_def def{.position = from_reals(displacement * -5 + reals{0.03, height, 0}),
                                        .linear_velocity = from_reals(displacement * 6)};
                    if (cell::is_3d) def.rotation = rotation_about({0, 1, 0}, 0.1 * k);
                    const body_id b = w.create_body(def);
                    const auto add = [&](const auto& shape) {
                        w.create_shape(b, shape, {.material = {.friction = S(0.01)}});
                    };
                    if (body == 0) add(world::box{});
                    if (body == 1) add(world::capsule{S(0.5), S(0.25)});
                    if (body == 2) add(cube_hull().shape());
                    if (body == 3) add(two_boxes().shape());
                    seen[i] = follow(w, b, height, 110);
                }
                CHECK(seen[1].height < 5e-4);
                CHECK(seen[1].climb < 1e-3);
                CHECK(seen[1].spin < seen[0].spin + 2e-3);
                CHECK(size(seen[1].end - seen[0].end) < 1e-2);
                CHECK(size(seen[1].velocity - seen[0].velocity) < 6e-3);
            }
}

CELL_CASE("concave: a ball rolls through a valley and over a ridge and stays on the surface") {
    for (const std::string& kind : surfaces) {
        if (kind == "tiles") continue;
        for (const double slope : {-0.25, 0.25, 0.5, 1.0}) {
            CAPTURE(kind);
            CAPTURE(slope);
            world w;
            const auto height = [&](double x, double) { return slope * std::abs(x); };
            add_surface(w, kind, 40, 0.5, height, {.friction = S(0)});
            const reals up = unit({slope, 1, 0}), along = unit({1, -slope, 0});
            const body_id b = w.create_body({.position = from_reals(reals{-1, height(-1, 0), 0.1} + up * 0.5),
                                             .linear_velocity = from_reals(along * (slope < 0 ? 2.5 : 0))});
            w.create_shape(b, world::ball{S(0.5)});
            double lowest = 1, highest = -1;
            for (int i = 0; i < 100; ++i) {
                w.step(S(1.0 / 64));
                const reals p = to_reals(w.position(b));
                // Its distance from the nearest point of the profile.
                double away = 100;
                for (int k = -2000; k <= 2000; ++k) {
                    const double u = p.x + k * 0.0005;
                    away = std::fmin(away, std::hypot(p.x - u, p.y - height(u, 0)));
                }
                lowest = std::fmin(lowest, away - 0.5);
                highest = std::fmax(highest, away - 0.5);
            }
            // What it moves in a step, less the margin.
            CHECK(lowest > -0.04);
            CHECK(highest < 1e-3);
        }
    }
}

/// The points in which a body touches, in all contacts of the world.
inline int points_touching(const world& w) {
    int n = 0;
    for (const auto& c : w.contacts()) n += c.count;
    return n;
}

CELL_CASE("concave: a box rests on few and on many parts on the same stable points") {
    for (const std::string& kind : surfaces)
        for (const int cells : {1, 10, 40}) {
            CAPTURE(kind);
            CAPTURE(cells);
            world w;
            // With a corner of parts under its middle, and one cell that is larger than the box.
            add_surface(w, kind, cells, cells == 40 ? 0.1 : 4.0 / cells, flat);
            const body_id b = w.create_body({.position = point(0.03, 0.5, 0.02)});
            w.create_shape(b, world::box{});
            run(w, 60);
            const reals start = to_reals(w.position(b));
            double drift = 0;
            for (int i = 0; i < 600; ++i) {
                w.step(S(1.0 / 64));
                REQUIRE(points_touching(w) == (cell::is_2d ? 2 : 4));
                int contacts = 0;
                for (const auto& c : w.contacts()) {
                    ++contacts;
                    for (int k = 0; k < c.count; ++k) REQUIRE(c.points[k].persisted);
                }
                REQUIRE(contacts == 1);
                drift = std::fmax(drift, size(to_reals(w.position(b)) - start));
            }
            CHECK(drift < 1e-5);
            CHECK(speed(w, b) < 1e-5);
        }
}

/// The heights of a landscape with walls.
inline double hills(double x, double z) {
    const double far = std::fmax(std::abs(x), std::abs(z)) - 6;
    return 0.3 * std::sin(1.3 * x) * (cell::is_3d ? std::cos(1.1 * z) : 1) + (far > 0 ? 3 * far : 0);
}

CELL_CASE("concave: bodies of all kinds fall on all surfaces, come to rest, and none sinks or gets through") {
    for (const std::string& kind : surfaces)
        for (int round = 0; round < (cell::is_2d ? 3 : 1); ++round) {
            CAPTURE(kind);
            CAPTURE(round);
            cell::dice dice(kind.size() + static_cast<std::uint64_t>(round));
            world w;
            const bool tiles = kind == "tiles";
            const auto height = [&](double x, double z) { return tiles ? 0 : hills(x, z); };
            const body_id ground = add_surface(w, kind, 64, 0.25, height);
            for (const double side : {-7.0, 7.0})
                if (tiles) w.create_shape(ground, world::box{vec::filled(S(1))}, {.position = point(side, 1)});
            std::vector<body_id> bodies;
            for (int i = 0; i < 10; ++i) {
                const double x = dice.number(-5, 5), z = cell::is_3d ? dice.number(-5, 5) : 0;
                const body_id b = w.create_body({.position = point(x, 1.5 + 1.2 * i, z),
                                                 .rotation = random_rotation(dice),
                                                 .linear_damping = S(0.1),
                                                 .angular_damping = S(2)});
                bodies.push_back(b);
                CAPTURE(i);
                if (i % 5 == 0) w.create_shape(b, world::ball{S(0.4)});
                if (i % 5 == 1) w.create_shape(b, world::capsule{S(0.4), S(0.2)});
                if (i % 5 == 2) w.create_shape(b, world::box{point(0.5, 0.3, 0.4)});
                if (i % 5 == 3) w.create_shape(b, cube_hull().shape());
                if (i % 5 == 4) w.create_shape(b, two_boxes().shape());
            }
            double lowest = 1;
            for (int i = 0; i < 700; ++i) {
                w.step(S(1.0 / 64));
                for (const body_id b : bodies) {
                    const reals p = to_reals(w.position(b));
                    lowest = std::fmin(lowest, p.y - height(p.x, p.z));
                }
            }
            double fastest = 0, rolling = 0;
            for (std::size_t i = 0; i < bodies.size(); ++i) {
                double& most = i % 5 == 0 || (cell::is_3d && i % 5 == 1) ? rolling : fastest;
                most = std::fmax(most, speed(w, bodies[i]));
            }
            CHECK(lowest > 0.1);
            // What rolls, in space capsules as well, does so for some time yet.
            CHECK(rolling < 1);
            CHECK(fastest < 1e-2);
        }
}

CELL_CASE("concave: all ridges hold a body that lies on them, also those between others") {
    for (const std::string& kind : surfaces) {
        if (kind == "tiles") continue;
        // Two ridges bear, the third is at one end and a little lower.
        for (const double low : {0.0, 0.004, 0.008, 0.015})
            for (const int displacement : {-1, 1})
                for (int body = 0; body < 3; ++body) {
                    CAPTURE(kind);
                    CAPTURE(low);
                    CAPTURE(displacement);
                    CAPTURE(body);
                    const auto height = [&](double x, double) {
                        const int k = static_cast<int>(std::lround(displacement * x / 0.2));
                        return k == -2 || k == 0 ? 0 : k == 2 ? -low : -0.2;
                    };
                    const ground g = make_ground(kind, 20, 0.2, height);
                    set::any lying;
                    if (body == 0) lying = world::capsule{S(0.5), S(0.25)};
                    if (body == 1) lying = world::box{point(0.5, 0.25, 0.3)};
                    if (body == 2) lying = cube_hull().shape();
                    transform at;
                    at.position = point(0, (body == 2 ? 0.5 : 0.25) - 0.001, 0.05) - g.at;
                    int ridges = 0;
                    for (const double x : {-0.4, 0.0, 0.4}) {
                        double nearest = 1;
                        for (const auto& f : set::meet(g.shape, lying, at, 0.02))
                            for (int i = 0; i < f.contact.count; ++i) {
                                const double here = number(f.contact.points[i].position.x + g.at.x);
                                if (std::abs(here - x) < 0.01 && number(f.contact.normal.y) > 0.99)
                                    nearest = std::fmin(nearest, number(f.contact.points[i].separation));
                            }
                        ridges += std::abs(nearest - (x * displacement > 0.2 ? low : 0) + 0.001) < 1e-3;
                    }
                    // What is all but flat may rest on its ends.
                    CHECK(ridges >= (low < 0.001 ? 2 : 3));
                }
    }
}

CELL_CASE("concave: what falls on hills alone comes to rest, wherever that is") {
    for (const std::string& kind : surfaces) {
        if (kind == "tiles") continue;
        double fastest = 0;
        int awake = 0;
        for (int round = 0; round < (cell::is_2d ? 40 : 12); ++round) {
            cell::dice dice(static_cast<std::uint64_t>(round));
            world w;
            add_surface(w, kind, 64, 0.25, hills);
            const double x = dice.number(-5, 5), z = cell::is_3d ? dice.number(-5, 5) : 0;
            const body_id b = w.create_body({.position = point(x, 1.2, z),
                                             .rotation = random_rotation(dice),
                                             .linear_damping = S(0.1),
                                             .angular_damping = S(2)});
            // In space they roll about for long.
            if (round % 4 == 0 && cell::is_2d) w.create_shape(b, world::capsule{S(0.4), S(0.2)});
            else if (round % 4 <= 1) w.create_shape(b, world::box{point(0.5, 0.3, 0.4)});
            if (round % 4 == 2) w.create_shape(b, cube_hull().shape());
            if (round % 4 == 3) w.create_shape(b, two_boxes().shape());
            run(w, 600);
            awake += !w.is_asleep(b);
            fastest = std::fmax(fastest, speed(w, b));
        }
        CAPTURE(kind);
        CHECK(awake == 0);
        CHECK(fastest == 0);
    }
}

CELL_CASE("concave: one-sided surfaces let bodies through from the back, two-sided ones do not") {
    for (const std::string& kind : surfaces)
        for (const bool two_sided : {false, true}) {
            if (kind == "tiles") continue;
            CAPTURE(kind);
            CAPTURE(two_sided);
            world w;
            add_surface(w, kind, 20, 0.5, flat, {}, two_sided);
            const body_id up = w.create_body({.position = point(0.1, -1, 0.1), .linear_velocity = point(0, 8)});
            w.create_shape(up, world::box{vec::filled(S(0.25))});
            const body_id ball = w.create_body({.position = point(2.1, -1, 0.1), .linear_velocity = point(0, 8)});
            w.create_shape(ball, world::ball{S(0.25)});
            run(w, 20);
            CHECK((number(w.position(up).y) > 0.25) == !two_sided);
            CHECK((number(w.position(ball).y) > 0.25) == !two_sided);
            run(w, 300);
            // Through it they have come down on the front.
            CHECK((std::abs(number(w.position(up).y) - 0.25) < 0.01) == !two_sided);
            CHECK((std::abs(number(w.position(ball).y) - 0.25) < 0.01) == !two_sided);
            if (two_sided) CHECK(number(w.position(up).y) < -5);
        }
}

#if CELL_DIMENSION == 2
CELL_CASE("concave: among tiles a box stops at walls, slides under ceilings, and none falls between corners") {
    // Upside down: a floor, a wall, a ceiling, and on the right a stair of cells that touch in corners only.
    const char* const map[] = {"#########.......", "#.........#.....", "#..........#....", "#...........#...",
                               "#............#..", "############..#.", "................"};
    std::vector<std::uint8_t> cells;
    for (int y = 6; y >= 0; --y)
        for (int x = 0; x < 16; ++x) cells.push_back(map[y][x] == '#');
    const auto g = world::tile_grid_geometry::build(cells.data(), 16, 7, S(1));
    const auto level = [&](world& w) {
        w.create_shape(w.create_body({.type = body_type::static_body}), g.shape(), {.material = {.friction = S(0)}});
    };
    const auto add = [&](world& w, vec at, vec velocity) {
        const body_id b = w.create_body({.position = at, .linear_velocity = velocity});
        w.create_shape(b, world::box{point(0.4, 0.4)}, {.material = {.friction = S(0)}});
        return b;
    };
    {
        world w;
        level(w);
        const body_id b = add(w, point(5, 2.4), point(-5, 0));
        journey j = follow(w, b, 2.4, 40);
        CHECK(j.height < 5e-4);
        CHECK(j.spin < 1e-3);
        run(w, 60);
        // What the springs give back of a blow: a hundredth of its speed.
        CHECK(number(w.position(b).x) > 1.4 - 1e-3);
        CHECK(speed(w, b) < 0.06);
    }
    {
        world::settings_type upwards;
        upwards.gravity.y = S(9.81);
        world w(upwards);
        level(w);
        const body_id b = add(w, point(3, 5.6), point(5, 0));
        const journey j = follow(w, b, 5.6, 50);
        CHECK(j.height < 5e-4);
        CHECK(j.spin < 1e-3);
        CHECK(std::abs(j.end.x - (3 + 5 * 50 / 64.0)) < 1e-3);
    }
    {
        world w;
        level(w);
        std::vector<body_id> falling;
        for (int i = 0; i < 4; ++i) {
            falling.push_back(w.create_body({.position = point(10.9 + i, 8.5 - i)}));
            w.create_shape(falling.back(), world::ball{S(i < 2 ? 0.1 : 0.2)}, {.material = {.friction = S(0)}});
        }
        // They come down on the stair's upper side, and down it to the right.
        run(w, 40);
        for (const body_id b : falling) {
            const reals p = to_reals(w.position(b));
            CHECK(p.x + p.y > 16);
        }
    }
}
#endif

CELL_CASE("concave: a kinematic surface lifts what lies on it") {
    for (const std::string& kind : surfaces) {
        CAPTURE(kind);
        world w;
        const body_id lift = add_surface(w, kind, 8, 0.5, flat);
        w.set_type(lift, body_type::kinematic_body);
        const body_id box = w.create_body({.position = point(0.1, 0.5)});
        w.create_shape(box, world::box{});
        const body_id pair = w.create_body({.position = point(0.1, 1.25)});
        w.create_shape(pair, two_boxes().shape(), {.position = point(0, 0.25)});
        const vec at = w.position(lift);
        for (int i = 1; i <= 64; ++i) {
            w.move_to(lift, at + point(0, i / 64.0), {});
            w.step(S(1.0 / 64));
        }
        run(w, 60);
        CHECK(std::abs(number(w.position(box).y) - 1.5) < 0.01);
        CHECK(std::abs(number(w.position(pair).y) - 2.25) < 0.01);
    }
}

CELL_CASE("concave: a table of five boxes stands, on a halfspace, a surface and a compound") {
    std::vector<physics::compound_child<S, D>> parts;
    parts.push_back({world::box{point(1, 0.1, 1)}, point(0, 1)});
    for (int i = 0; i < 4; ++i)
        parts.push_back({world::box{point(0.1, 0.45, 0.1)}, point(i & 1 ? 0.8 : -0.8, 0.45, i & 2 ? 0.8 : -0.8)});
    const auto table = compound_geometry::build(parts.data(), 5);
    for (int under = 0; under < 3; ++under) {
        CAPTURE(under);
        world w;
        if (under == 0) add_surface(w, "halfspace", 1, 1, flat);
        if (under == 1) add_surface(w, surfaces[0], 20, 0.5, flat);
        if (under == 2) {
            const body_id floor = w.create_body({.type = body_type::static_body});
            w.create_shape(floor, two_boxes().shape(), {.position = point(0.4, -0.5)});
            w.create_shape(floor, two_boxes().shape(), {.position = point(-1.6, -0.5)});
            if (cell::is_3d)
                for (const double z : {-1.0, 1.0}) {
                    w.create_shape(floor, two_boxes().shape(), {.position = point(0.4, -0.5, z)});
                    w.create_shape(floor, two_boxes().shape(), {.position = point(-1.6, -0.5, z)});
                }
        }
        const body_id b = w.create_body({.position = point(0, 0.01)});
        w.create_shape(b, table.shape());
        // A box on its edge, above one pair of legs.
        const body_id load = w.create_body({.position = point(0.7, 1.45)});
        w.create_shape(load, world::box{point(0.3, 0.3, 0.3)});
        run(w, 300);
        CHECK(std::abs(number(w.position(b).x)) < 0.01);
        CHECK(std::abs(number(w.position(b).y)) < 0.01);
        CHECK(std::abs(number(w.position(load).y) - 1.4) < 0.02);
        CHECK(speed(w, b) < 1e-2);
        CHECK(speed(w, load) < 1e-2);
    }
}

CELL_CASE("concave: an L falls on its side where its centre of mass is beyond its foot, else stands") {
    for (const double arm : {0.3, 1.5}) {
        CAPTURE(arm);
        // A post of 0.4 by 2 and an arm at its top to the right: the centre is at arm * (0.2 + arm / 2) / (arm + 2).
        const auto l = compound_geometry::build({{world::box{point(0.2, 1, 0.2)}, point(0, 1)},
                                                 {world::box{point(arm / 2, 0.2, 0.2)}, point(0.2 + arm / 2, 1.8)}});
        const double area = 0.8 + 0.4 * arm, depth = cell::is_3d ? 0.4 : 1;
        const double center = 0.4 * arm * (0.2 + arm / 2) / area;
        world w;
        add_surface(w, surfaces[0], 20, 0.5, flat);
        const body_id b = w.create_body({.position = point(0, 0)});
        w.create_shape(b, l.shape());
        CHECK(std::abs(number(w.mass(b).mass) - area * depth) < 1e-5);
        CHECK(std::abs(number(w.mass(b).center.x) - center) < 1e-5);
        run(w, 200);
        const bool stands = number((w.rotation(b) * point(0, 1)).y) > 0.99;
        CHECK(stands == (center < 0.2));
        CHECK(number(w.position(b).y) > -0.05);
    }
}

CELL_CASE("concave: compounds pile up on compounds") {
    for (const std::string& kind : surfaces) {
        CAPTURE(kind);
        world w;
        add_surface(w, kind, 20, 0.5, flat);
        std::vector<body_id> bodies;
        for (int i = 0; i < 6; ++i) {
            bodies.push_back(w.create_body({.position = point(0.05 * (i & 1), 0.505 + 1.01 * i)}));
            w.create_shape(bodies.back(), two_boxes().shape());
        }
        run(w, 400);
        int i = 0;
        for (const body_id b : bodies) {
            CAPTURE(i);
            CHECK(std::abs(number(w.position(b).y) - (0.5 + i)) < 0.03);
            CHECK(std::abs(number(w.position(b).x) - 0.05 * (i & 1)) < 0.03);
            // On a heightfield in fixed point they tremble without end; elsewhere they are asleep.
            CHECK(speed(w, b) < 2e-2);
            ++i;
        }
    }
}

}  // namespace concave_laws
}  // namespace
