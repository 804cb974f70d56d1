// Laws of debug drawing: what is drawn of a shape lies on it, and all that was asked for is drawn.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "refusal.hpp"
#include "world_cell.hpp"

namespace {
namespace drawing_laws {

constexpr int D = cell::dimension;
using physics::debug_color;
using options = physics::debug_draw_options<S, D>;

template <int Dimension>
struct all_shapes {
    using type = physics::shapes<physics::ball, physics::capsule, physics::box, physics::halfspace, physics::hull,
                                 physics::compound, physics::heightfield, physics::chain, physics::tile_grid,
                                 physics::rounded_box, physics::triangle>;
};
template <>
struct all_shapes<3> {
    using type = physics::shapes<physics::ball, physics::capsule, physics::box, physics::halfspace, physics::hull,
                                 physics::compound, physics::heightfield, physics::mesh, physics::cylinder,
                                 physics::cone, physics::rounded_box>;
};
struct gallery : physics::recipe<S, D, all_shapes<D>::type, physics::events<physics::event::sensor>,
                                 physics::joints<physics::ball_joint>> {};
using world = physics::world<gallery>;

/// Keeps what it is told to draw.
struct pen {
    struct stroke {
        vec from, to;
        debug_color color;
    };
    std::vector<stroke> lines;
    std::vector<std::pair<vec, debug_color>> points;
    std::vector<std::string> texts;

    void line(const vec& from, const vec& to, debug_color color) { lines.push_back({from, to, color}); }
    void point(const vec& at, debug_color color) { points.push_back({at, color}); }
    void text(const vec&, const char* said, debug_color) { texts.push_back(said); }
    [[nodiscard]] long strokes(debug_color color) const {
        return std::count_if(lines.begin(), lines.end(), [&](const stroke& l) { return l.color == color; });
    }
};

/// One shape of each kind, each on a body of its own, turned anyhow.
struct hall {
    world w{world::settings_type{.gravity = {}}};
    cell::dice dice{1};
    std::vector<body_id> bodies;

    template <class Shape>
    void add(const Shape& shape, body_type type = body_type::dynamic_body) {
        vec at;
        at[0] = S(6.0 * static_cast<double>(bodies.size()));
        bodies.push_back(w.create_body({.type = type, .position = at, .rotation = random_rotation(dice)}));
        w.create_shape(bodies.back(), shape);
    }
    hall() {
        vec half = vec::filled(S(0.5));
        half.x = S(1);
        add(world::ball{S(0.75)});
        add(world::capsule{S(0.5), S(0.25)});
        add(world::box{half});
        std::vector<vec> corners;
        for (int i = 0; i < 12; ++i) corners.push_back(dice.vec<vec>(-1, 1));
        add(world::hull_geometry::build(corners.data(), 12).shape());
        add(world::compound_geometry::build({{world::box{half}, along(0, -1)}, {world::ball{S(0.5)}, along(0, 1)}})
                .shape());
        add(physics::rounded_box<S, D>{half, S(0.125)});
        add_own<D>();
    }
    template <int Dimension>
    void add_own() {
        if constexpr (Dimension == 2) {
            const physics::vec<S, Dimension> bends[] = {{-1, 0}, {0, 0.5}, {1, 0}, {2, 1}};
            add(physics::chain_geometry<S, Dimension>::build(bends).shape(), body_type::static_body);
            add(physics::triangle<S, Dimension>{{0, 0}, {1, 0}, {0, 1}});
            add(physics::triangle<S, Dimension>{{0, 0}, {0, 1}, {1, 0}});
        } else {
            add(physics::cylinder<S, Dimension>{S(0.5), S(0.75)});
            add(physics::cone<S, Dimension>{S(0.5), S(0.75), S(0.25)});
        }
    }
};

CELL_CASE("drawing: lines of shapes lie on their surfaces, all of them") {
    hall h;
    pen drawn;
    debug_draw(h.w, drawn, {.sides = 16});
    std::map<std::uint32_t, int> by_body;
    for (const auto& l : drawn.lines)
        for (const vec end : {l.from, l.to}) {
            const auto hit = h.w.closest_shape(end, S(0.25));
            REQUIRE(hit);
            const auto position = h.w.position(hit.body);
            // A ball's line from its middle shows how it is turned.
            CAPTURE(hit.body.index);
            CHECK((std::abs(number(hit.distance)) < 1e-3 || gap(end, position) < 1e-6 ||
                   gap(end, h.w.pose(h.bodies[4]) * along(0, 1)) < 1e-6));
            ++by_body[hit.body.index];
        }
    CHECK(by_body.size() == h.bodies.size());
    // Those of a circle, and one to its middle; a box has 4 or 12 edges.
    CHECK(by_body[h.bodies[0].index] >= 2 * 16);
    CHECK(by_body[h.bodies[2].index] == (cell::is_2d ? 8 : 24));
}
/// Keeps polygons too.
struct brush : pen {
    struct face {
        std::vector<vec> corners;
        debug_color color;
    };
    std::vector<face> faces;

    void polygon(const vec* corners, std::uint32_t count, debug_color color) {
        faces.push_back({{corners, corners + count}, color});
    }
};
/// Signed area of a polygon in 2D; volume of the pyramid from a polygon to the origin in 3D.
double measure_under(const std::vector<vec>& corners, vec origin) {
    const auto n = [&](std::size_t i, int axis) {
        return number(corners[i % corners.size()][axis]) - number(origin[axis]);
    };
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if constexpr (D == 2) {
            sum += (n(i, 0) * n(i + 1, 1) - n(i, 1) * n(i + 1, 0)) / 2;
        } else {
            if (i == 0 || i + 1 == corners.size()) continue;
            for (int k = 0; k < 3; ++k) {
                const int u = (k + 1) % 3, v = (k + 2) % 3;
                sum += n(0, k) * (n(i, u) * n(i + 1, v) - n(i, v) * n(i + 1, u)) / 6;
            }
        }
    }
    return sum;
}
CELL_CASE("drawing: polygons are the faces of what is solid, counter-clockwise from outside") {
    hall h;
    brush drawn;
    debug_draw(h.w, drawn, {.sides = 96});
    std::map<std::uint32_t, double> measure;
    std::map<std::uint32_t, int> faces;
    for (const auto& f : drawn.faces) {
        REQUIRE(f.corners.size() >= 3);
        CHECK(f.color == options{}.of_awake);
        const auto at = h.w.closest_shape(f.corners[0], S(0.25));
        REQUIRE(at);
        for (const vec& corner : f.corners) {
            const auto near = h.w.closest_shape(corner, S(0.25));
            REQUIRE(near);
            CHECK(near.body == at.body);
            CHECK(std::abs(number(near.distance)) < 1e-3);
        }
        const double part = measure_under(f.corners, h.w.center_of_mass(at.body));
        CHECK(part > 0);
        measure[at.body.index] += part;
        ++faces[at.body.index];
    }
    // As the masses say, of density 1; circles of 96 sides lack 1/1400.
    for (const int i : {0, 1, 2, 3, 5, 7, 8}) {
        if (!cell::is_2d && (i < 2 || i > 3)) continue;
        const body_id b = h.bodies[static_cast<std::size_t>(i)];
        CAPTURE(i);
        CHECK(measure[b.index] == doctest::Approx(number(h.w.mass(b).mass)).epsilon(i == 2 || i == 3 ? 1e-4 : 2e-3));
    }
    CHECK(faces[h.bodies[2].index] == (cell::is_2d ? 1 : 6));
    // What has no use for polygons is drawn the same lines.
    pen plain;
    debug_draw(h.w, plain, {.sides = 96});
    CHECK(plain.lines.size() == drawn.lines.size());
}
CELL_CASE("drawing: bodies are coloured by what they do, and only what is in view is drawn") {
    hall h;
    const options with;
    h.w.set_type(h.bodies[0], body_type::kinematic_body);
    h.w.set_type(h.bodies[1], body_type::static_body);
    h.w.create_shape(h.bodies[1], world::ball{S(0.25)}, {.sensor = true});
    h.w.set_linear_velocity(h.bodies[2], along(1, 1));
    for (int i = 0; i < 60; ++i) h.w.step(S(1.0 / 60));
    REQUIRE(h.w.is_asleep(h.bodies[3]));
    const body_id taken_out = h.w.create_body({.position = along(0, -2), .enabled = false});
    h.w.create_shape(taken_out, world::ball{S(0.25)});
    pen drawn;
    debug_draw(h.w, drawn, with);
    for (const debug_color c :
         {with.of_kinematic, with.of_static, with.of_sensor, with.of_awake, with.of_asleep, with.of_disabled})
        CHECK(drawn.strokes(c) > 0);
    pen one;
    options narrow;
    narrow.view = {h.w.position(h.bodies[3]) - vec::filled(S(2)), h.w.position(h.bodies[3]) + vec::filled(S(2))};
    debug_draw(h.w, one, narrow);
    CHECK(one.lines.size() > 0);
    CHECK(one.strokes(with.of_asleep) == static_cast<long>(one.lines.size()));
}
CELL_CASE("drawing: contacts, joints, boxes, frames, velocities and numbers are drawn where they are") {
    world w{world::settings_type{.gravity = along(1, -10)}};
    w.create_shape(w.create_body({.type = body_type::static_body}), world::halfspace{});
    const body_id box = w.create_body({.position = at(0, 0.5)}),
                  ball = w.create_body({.position = at(3, 2), .linear_velocity = along(0, 1), .gravity_scale = S(0)});
    w.create_shape(box, world::box{vec::filled(S(0.5))});
    w.create_shape(ball, world::ball{S(0.5)});
    const auto joint =
        w.create_joint(box, ball, world::ball_joint{.anchor_a = along(0, 1.5), .anchor_b = at(-1.5, -1.5)});
    w.step(S(1.0 / 60));
    const options with{.shapes = false,
                       .contacts = true,
                       .joints = true,
                       .boxes = true,
                       .frames = true,
                       .velocities = true,
                       .velocity_scale = S(1),
                       .numbers = true};
    pen drawn;
    debug_draw(w, drawn, with);
    const auto count = [&](debug_color c) {
        return std::count_if(drawn.points.begin(), drawn.points.end(), [&](const auto& p) { return p.second == c; });
    };
    int touching = 0;
    for (const auto& c : w.contacts()) touching += c.touching ? c.count : 0;
    CHECK(touching > 0);
    CHECK(count(with.of_contact) == touching);
    CHECK(drawn.strokes(with.of_normal) == touching);
    // Both ends of the joint, in one place.
    CHECK(count(with.of_joint) == 2);
    CHECK(drawn.strokes(with.of_joint) == 3);
    CHECK(drawn.strokes(with.of_box) == 3 * (cell::is_2d ? 4 : 12));
    CHECK(drawn.strokes({255, 0, 0}) == 3);
    CHECK(drawn.texts == std::vector<std::string>{"0", "1", "2"});
    bool is_drawn = false;
    for (const auto& l : drawn.lines)
        is_drawn = is_drawn || (l.color == with.of_velocity && l.from == w.center_of_mass(ball) &&
                                l.to == l.from + w.linear_velocity(ball));
    CHECK(is_drawn);
    // Nothing of it changes the world, or is drawn unless it is asked for.
    const std::uint64_t before = w.state_hash();
    pen none;
    debug_draw(w, none, {.shapes = false, .joints = false});
    CHECK(none.lines.empty());
    CHECK(none.points.empty());
    CHECK(w.state_hash() == before);
    w.destroy_joint(joint);
    ::world plain;
    refuses(plain, "debug_draw", "sides", "2", [&] { debug_draw(plain, none, {.sides = 2}); });
}

CELL_CASE("drawing: islands have a colour each, asleep too, and the boxes of the tree hold all shapes") {
    world w{world::settings_type{.gravity = along(1, -10)}};
    w.create_shape(w.create_body({.type = body_type::static_body}), world::box{vec::filled(S(0.5))});
    std::vector<body_id> bodies;
    for (int i = 0; i < 40; ++i) {
        // Pairs that lie on each other.
        const bool upper = i % 2 == 1;
        bodies.push_back(w.create_body({.position = at(3.0 * (i / 2) + 2, upper ? 1.5 : 0.5)}));
        w.create_shape(bodies.back(), world::box{vec::filled(S(0.5))});
    }
    const body_id floor = w.create_body({.type = body_type::static_body});
    w.create_shape(floor, world::halfspace{});
    for (const int steps : {5, 200}) {
        for (int i = 0; i < steps; ++i) w.step(S(1.0 / 60));
        CHECK(w.is_asleep(bodies[0]) == (steps == 200));
        std::map<std::tuple<int, int, int>, int> colors;
        for (const body_id b : bodies) {
            pen one;
            options with{.islands = true};
            with.view = {w.position(b) - vec::filled(S(0.25)), w.position(b) + vec::filled(S(0.25))};
            debug_draw(w, one, with);
            REQUIRE(!one.lines.empty());
            const debug_color c = one.lines[0].color;
            ++colors[{c.red, c.green, c.blue}];
        }
        CHECK(colors.size() == 20);
        for (const auto& [color, count] : colors) CHECK(count == 2);
    }
    pen drawn;
    const options with{.shapes = false, .joints = false, .tree = true};
    debug_draw(w, drawn, with);
    CHECK(drawn.strokes(with.of_tree) == static_cast<long>(drawn.lines.size()));
    for (const body_id b : bodies) {
        bool left = false, right = false;
        for (const auto& l : drawn.lines) {
            left = left || l.from.x <= w.position(b).x - S(0.5);
            right = right || l.from.x >= w.position(b).x + S(0.5);
        }
        CHECK((left && right));
    }
    // More than one node, fewer than shapes.
    CHECK(drawn.lines.size() > 2 * (cell::is_2d ? 4 : 12));
    CHECK(drawn.lines.size() < 40 * (cell::is_2d ? 4 : 12));
}

}  // namespace drawing_laws
}  // namespace
