// Filters: which shapes meet and which queries see, against the rule written out.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "refusal.hpp"
#include "world_cell.hpp"

namespace {
namespace filters_laws {

using physics::collision_filter;
using physics::query_filter;

/// The rule once more, so as not to trust the library's.
bool should_meet(const collision_filter& a, const collision_filter& b) {
    if (a.group != 0 && a.group == b.group) return a.group > 0;
    return (a.category & b.mask) && (b.category & a.mask);
}
collision_filter random_filter(cell::dice& dice) {
    collision_filter f;
    f.category = dice.below(4) ? 1u << dice.below(4) : static_cast<std::uint32_t>(dice.below(16));
    f.mask = static_cast<std::uint32_t>(dice.below(16)) | (dice.below(2) ? 0u : 0xfffffff0u);
    f.group = dice.below(3) ? 0 : dice.below(7) - 3;
    return f;
}
world::settings_type awake(double gravity = 0) {
    world::settings_type settings;
    settings.gravity = along(1, gravity);
    settings.sleeping.enabled = false;
    return settings;
}

CELL_CASE("filters: groups decide first, else both masks do") {
    const collision_filter a{.category = 1, .mask = 3}, b{.category = 2, .mask = 3}, deaf{.category = 2, .mask = 2},
        friends{.mask = 0, .group = 5}, foes{.group = -5}, others{.mask = 1, .group = 7};
    CHECK(may_meet(a, b));
    CHECK(!may_meet(a, deaf));
    CHECK(may_meet(friends, friends));
    CHECK(!may_meet(foes, foes));
    CHECK(!may_meet(friends, others));
    CHECK(may_meet(foes, others));
}

/// Balls in each other's way, on static and dynamic bodies of one or two shapes.
struct throng {
    world w{awake()};
    std::vector<shape_id> shapes;
    std::vector<vec> places;

    explicit throng(cell::dice& dice) {
        for (int i = 0; i < 40; ++i) {
            const body_id b = w.create_body({.type = i % 4 ? body_type::dynamic_body : body_type::static_body,
                                             .position = dice.vec<vec>(-1.5, 1.5)});
            for (int k = 0; k <= i % 2; ++k)
                shapes.push_back(w.create_shape(b, world::ball{S(0.5)},
                                                {.position = dice.vec<vec>(-0.5, 0.5), .filter = random_filter(dice)}));
        }
    }
    vec place(shape_id s) const { return w.pose(w.body(s)) * w.local_pose(s).position; }
    bool can_push(shape_id s) const { return w.type(w.body(s)) == body_type::dynamic_body; }
    /// Steps; contacts have to be those of shapes that overlap and meet.
    void check_step() {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> expected, found;
        for (std::size_t i = 0; i < shapes.size(); ++i)
            for (std::size_t k = i + 1; k < shapes.size(); ++k) {
                const shape_id a = shapes[i], b = shapes[k];
                // Of still ones that overlap each other, contacts within the surface of all are left out.
                if (w.body(a) == w.body(b) || !can_push(a) || !can_push(b)) continue;
                if (!should_meet(w.filter(a), w.filter(b)) || gap(place(a), place(b)) > 0.9) continue;
                expected.emplace_back(std::min(a.index, b.index), std::max(a.index, b.index));
            }
        std::sort(expected.begin(), expected.end());
        w.step(S(1.0 / 64));
        for (const auto& c : w.contacts())
            found.emplace_back(std::min(c.shape_a.index, c.shape_b.index), std::max(c.shape_a.index, c.shape_b.index));
        std::sort(found.begin(), found.end());
        CHECK(std::includes(found.begin(), found.end(), expected.begin(), expected.end()));
        check_contacts();
    }
    void check_contacts() const {
        for (const auto& c : w.contacts()) CHECK(should_meet(w.filter(c.shape_a), w.filter(c.shape_b)));
    }
};
CELL_CASE("filters: contacts are those of shapes that meet, at once after a change") {
    for (int seed = 0; seed < 20; ++seed) {
        cell::dice dice(static_cast<std::uint64_t>(8800 + seed));
        throng t(dice);
        for (int i = 0; i < 6; ++i) {
            t.check_step();
            for (int k = 0; k < 12; ++k) {
                const auto at = static_cast<std::size_t>(dice.below(static_cast<int>(t.shapes.size())));
                t.w.set_filter(t.shapes[at], random_filter(dice));
            }
            t.check_contacts();
        }
    }
}

/// Three boxes on the ground.
struct tower {
    world w;
    body_id ground;
    std::vector<body_id> boxes;
    shape_id floor;

    explicit tower(const world::settings_type& settings) : w(settings), ground(add_ground(w)) {
        for (int i = 0; i < 3; ++i) boxes.push_back(add_box(w, at(0, 0.5 + i)));
        floor = shape_of(ground);
    }
    shape_id shape_of(body_id b) const { return *w.shapes(b).begin(); }
};
CELL_CASE("filters: contacts that stay keep their impulses to the bit, those that go bear nothing") {
    tower t(awake(-10));
    run(t.w, 64);
    world same = t.w;
    t.w.set_filter(t.shape_of(t.boxes[1]), {.category = 5, .group = 3});
    CHECK(t.w.state_hash() != same.state_hash());
    run(t.w, 64);
    run(same, 64);
    for (const body_id b : t.boxes) {
        CHECK(t.w.pose(b) == same.pose(b));
        CHECK(t.w.linear_velocity(b) == same.linear_velocity(b));
    }
    t.w.set_filter(t.shape_of(t.boxes[1]), {});
    CHECK(t.w.state_hash() == same.state_hash());
    t.w.set_filter(t.floor, {.mask = 2});
    CHECK(t.w.contacts().size() == 2);
    run(t.w, 32);
    // They fall together, by g t^2 / 2 and half of g t h.
    for (std::size_t i = 0; i < 3; ++i)
        CHECK(std::abs(number(t.w.position(t.boxes[i]).y) - (0.5 + static_cast<double>(i)) + 1.25) <= 0.03);
}
CELL_CASE("filters: sleepers wake if what they touch lets go of them, or what they lie in begins to meet them") {
    world::settings_type settings;
    settings.gravity = along(1, -10);
    for (const bool lets_go : {true, false}) {
        tower t(settings);
        const body_id ghost = t.w.create_body({.position = at(0.1, 0.375)});
        const shape_id skin = t.w.create_shape(ghost, world::box{vec::filled(S(0.375))}, {.filter = {.group = -1}});
        t.w.set_filter(t.shape_of(t.boxes[0]), {.group = -1});
        const body_id far_away = add_box(t.w, at(20, 0.5));
        for (int i = 0; i < 512 && t.w.awake_count() > 0; ++i) run(t.w, 1);
        REQUIRE(t.w.awake_count() == 0);
        // Nothing changes.
        t.w.set_filter(skin, {.group = -1});
        CHECK(t.w.awake_count() == 0);
        t.w.set_filter(skin, lets_go ? collision_filter{.mask = 0} : collision_filter{});
        CHECK(!t.w.is_asleep(ghost));
        CHECK(t.w.is_asleep(far_away));
        CHECK(t.w.is_asleep(t.boxes[0]) == lets_go);
        run(t.w, 128);
        if (lets_go) CHECK(number(t.w.position(ghost).y) < -0.5);
        else CHECK(gap(t.w.position(ghost), t.w.position(t.boxes[0])) > 0.75);
    }
}
CELL_CASE("filters: kinematic bodies wake what they meet, and pass through the sleep of others") {
    world::settings_type settings;
    settings.gravity = along(1, -10);
    for (const bool meets : {false, true}) {
        tower t(settings);
        // A group that meets though no mask says so.
        if (meets) t.w.set_filter(t.shape_of(t.boxes[0]), {.group = 4});
        const body_id pusher = t.w.create_body(
            {.type = body_type::kinematic_body, .position = at(-3, 0.5), .linear_velocity = along(0, 2)});
        t.w.create_shape(pusher, world::box{vec::filled(S(0.4))}, {.filter = {.mask = 0, .group = 4}});
        for (int i = 0; i < 3; ++i) t.w.set_can_sleep(t.boxes[static_cast<std::size_t>(i)], true);
        bool slept = false;
        for (int i = 0; i < 64 * 3; ++i) {
            run(t.w, 1);
            slept = slept || t.w.is_asleep(t.boxes[0]);
            if (slept && !meets) CHECK(t.w.is_asleep(t.boxes[0]));
        }
        CHECK(slept);
        CHECK((number(t.w.position(t.boxes[0]).x) > 0.5) == meets);
    }
}

/// Whether a ball of a radius and a filter, thrown at a plate of another, passes it; at 16 phases of the step.
int passed(const collision_filter& ball, const collision_filter& plate, double speed) {
    int count = 0;
    for (int phase = 0; phase < 16; ++phase) {
        world w(awake());
        auto half = vec::filled(S(20));
        half.x = S(0.01);
        w.create_shape(w.create_body({.type = body_type::static_body}), world::box{half}, {.filter = plate});
        const body_id thrown = w.create_body(
            {.position = at(-1 - speed / 64 * (phase + 0.25) / 16, 0.25), .linear_velocity = along(0, speed)});
        w.create_shape(thrown, world::ball{S(0.1)}, {.filter = ball});
        // What meets nothing is larger.
        w.create_shape(thrown, world::ball{S(0.3)}, {.filter = {.mask = 0}});
        for (int i = 0; i < 16 + 128 / speed; ++i) {
            run(w, 1);
            const double x = number(w.position(thrown).x);
            // Not even for a moment, but at the front by the slop.
            if (x < 0 && should_meet(ball, plate)) REQUIRE(x <= -0.1);
        }
        count += number(w.position(thrown).x) > 0;
    }
    return count;
}
CELL_CASE("filters: what is swept is stopped by what it meets, and by nothing else") {
    for (const double speed : {20.0, 300.0}) {
        CHECK(passed({}, {}, speed) == 0);
        CHECK(passed({.category = 2}, {.mask = 1}, speed) == 16);
        CHECK(passed({.mask = 0, .group = 2}, {.category = 0, .group = 2}, speed) == 0);
        CHECK(passed({.group = -2}, {.group = -2}, speed) == 16);
    }
}

CELL_CASE("filters: queries see what categories and kinds say, and not the body that is left out") {
    cell::dice dice(8900);
    throng t(dice);
    run(t.w, 2);
    for (int i = 0; i < 200; ++i) {
        query_filter f;
        f.mask = static_cast<std::uint32_t>(dice.below(16));
        f.category = 1u << dice.below(4);
        f.any_category = dice.below(4) == 0;
        const shape_id own = t.shapes[static_cast<std::size_t>(dice.below(static_cast<int>(t.shapes.size())))];
        if (dice.below(3)) f.except = t.w.body(own);
        if (dice.below(2)) f.kinds = static_cast<physics::body_kinds>(dice.below(8));
        // Kinds are what they are told to be, whoever sleeps.
        if (i % 20 == 0) t.w.set_type(t.w.body(own), static_cast<body_type>(dice.below(3)));
        const auto sees = [&](shape_id s) {
            const collision_filter& of = t.w.filter(s);
            const bool by_category = f.any_category || ((of.category & f.mask) && (of.mask & f.category));
            const auto type = t.w.type(t.w.body(s));
            const bool by_kind = (f.kinds & (type == body_type::static_body      ? physics::static_bodies
                                             : type == body_type::kinematic_body ? physics::kinematic_bodies
                                                                                 : physics::dynamic_bodies)) != 0;
            return by_category && by_kind && !(f.except && t.w.body(s) == f.except);
        };
        const vec origin = t.place(own), way = dice.vec<vec>(-3, 3);
        std::vector<shape_id> expected, found;
        physics::world_hit<S, cell::dimension> first;
        for (const shape_id s : t.shapes) {
            if (!sees(s)) continue;
            const auto hit = cast_ray(t.w.shape(s), t.w.pose(t.w.body(s)) * t.w.local_pose(s), origin, way);
            if (hit && (!first || hit.fraction < first.fraction)) first = {s, t.w.body(s), hit.fraction, {}, {}};
            if (hit) expected.push_back(s);
        }
        const auto ray = t.w.cast_ray(origin, way, f);
        CHECK(gap(ray.fraction, first.fraction) <= rounding(64));
        CHECK(static_cast<bool>(ray) == static_cast<bool>(first));
        t.w.each_hit_along_ray(origin, way, f, [&](const auto& hit) { found.push_back(hit.shape); });
        const auto by_index = [](shape_id a, shape_id b) { return a.index < b.index; };
        std::sort(found.begin(), found.end(), by_index);
        std::sort(expected.begin(), expected.end(), by_index);
        CHECK(found == expected);
        expected.clear();
        found.clear();
        for (const shape_id s : t.shapes)
            if (sees(s) && gap(t.place(s), origin) <= 0.75) expected.push_back(s);
        t.w.each_overlapping(world::ball{S(0.25)}, {origin, {}}, f, [&](shape_id s) { found.push_back(s); });
        std::sort(expected.begin(), expected.end(), by_index);
        CHECK(found == expected);
        CHECK(static_cast<bool>(t.w.closest_shape(origin, S(0.25), f)) == !expected.empty());
        const auto cast = t.w.cast_shape(world::ball{S(0.25)}, {origin, {}}, way, f);
        if (!expected.empty()) CHECK(cast.fraction == S(0));
        if (cast) CHECK(sees(cast.shape));
        t.w.each_at(origin, f, [&](shape_id s) { CHECK(sees(s)); });
    }
}
CELL_CASE("filters: rays tell of what they begin in unless they are not to, and go on from what they met") {
    world w(awake());
    const body_id big = add_ball(w, {}, 2), small = add_ball(w, at(0.5, 0), 0.25), far = add_ball(w, at(5, 0), 0.5);
    const auto first = w.cast_ray({}, along(0, 10));
    CHECK(first.body == big);
    CHECK(first.inside());
    const auto next = w.cast_ray({}, along(0, 10), {.inside = false});
    CHECK(next.body == small);
    CHECK(!next.inside());
    CHECK(gap(next.point, at(0.25, 0)) <= rounding(64));
    CHECK(w.cast_ray({}, along(0, 10), {.except = small, .inside = false}).body == far);
    std::vector<body_id> met;
    w.each_hit_along_ray({}, along(0, 10), {.inside = false}, [&](const auto& hit) { met.push_back(hit.body); });
    CHECK(met == std::vector{small, far});
    // From each point that a ray meets, past what it met there.
    vec from = at(-10, 0);
    met.clear();
    while (const auto hit = w.cast_ray(from, at(10, 0) - from, {.inside = false})) {
        if (!met.empty() && met.back() == hit.body) break;
        met.push_back(hit.body);
        from = hit.point + along(0, 0.001);
    }
    CHECK(met == std::vector{big, small, far});
    // One that goes back the way that it came.
    const auto wall = w.cast_ray(at(-10, 0), along(0, 20));
    CHECK(!w.cast_ray(wall.point, at(-1, 0), {.inside = false}));
}
CELL_CASE("filters: a query does not take the handle of a body that is gone") {
    world w;
    const body_id ground = add_ground(w), gone = add_ball(w, at(0, 3));
    w.destroy_body(gone);
    add_ball(w, at(0, 3));
    const query_filter f{.except = gone};
    const auto ask = [&](const char* function, auto&& call) { refuses(w, function, "except", "", call); };
    ask("cast_ray", [&] { (void)w.cast_ray(at(0, 5), along(1, -5), f); });
    ask("each_hit_along_ray", [&] { w.each_hit_along_ray(at(0, 5), along(1, -5), f, [](const auto&) {}); });
    ask("cast_shape", [&] { (void)w.cast_shape(world::ball{}, {at(0, 5), {}}, along(1, -5), f); });
    ask("each_overlapping", [&] { w.each_overlapping(world::ball{}, {at(0, 5), {}}, f, [](shape_id) {}); });
    ask("each_at", [&] { w.each_at(at(0, 5), f, [](shape_id) {}); });
    ask("closest_shape", [&] { (void)w.closest_shape(at(0, 5), S(9), f); });
    CHECK(w.cast_ray(at(0, 1), along(1, -5), {.except = ground}).shape == shape_id{});
}

}  // namespace filters_laws
}  // namespace
