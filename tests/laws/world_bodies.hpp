// What a body does: mass, types, forces and impulses, damping, locks, and what it feels in contact.
#pragma once

#include <algorithm>
#include <vector>

#include "world_real.hpp"

namespace {

struct part {
    shape_id id;
    real_mass mass;
};
/// Adds a random shape, and says what it weighs.
part add_part(world& w, body_id body, cell::dice& dice, double density) {
    const int D = cell::dimension;
    world::shape_def def;
    def.position = dice.vec<vec>(-2, 2);
    def.rotation = random_rotation(dice);
    def.density = S(density);
    const physics::transform<double, D> frame{real(def.position), real(def.rotation)};
    const auto add = [&](const auto& shape, const auto& in_double) {
        return part{w.create_shape(body, shape, def),
                    physics::transformed(mass_of(in_double, number(def.density)), frame)};
    };
    const S a = dice.real(0.5, 1.5), b = dice.real(0.5, 1.5);
    switch (dice.below(3)) {
        case 0: return add(world::ball{a}, physics::ball<double, D>{number(a)});
        case 1: return add(world::capsule{a, b}, physics::capsule<double, D>{number(a), number(b)});
        default: {
            vec half = vec::filled(a);
            half.y = b;
            return add(world::box{half}, physics::box<double, D>{real(half)});
        }
    }
}
bool weighs(const world& w, body_id id, const real_mass& expected) {
    const real_mass m = real(w.mass(id));
    return spread(m.mass, expected.mass) <= rounding(100, expected.mass) &&
           spread(m.center, expected.center) <= rounding(100, 2) &&
           spread(m.inertia, expected.inertia) <= rounding(1000, 10 * expected.mass);
}
real_mass together(const std::vector<part>& parts) {
    real_mass sum;
    for (const part& p : parts) sum = physics::combined(sum, p.mass);
    return sum;
}
/// A body of several shapes in general position, that moves and turns.
body_id add_compound(world& w, cell::dice& dice) {
    world::body_def def;
    def.position = dice.vec<vec>(-4, 4);
    def.rotation = random_rotation(dice);
    def.linear_velocity = dice.vec<vec>(-2, 2);
    def.angular_velocity = skew(dice.number(-1, 1));
    const body_id id = w.create_body(def);
    for (int i = 0; i < 3; ++i) add_part(w, id, dice, dice.number(0.25, 2));
    return id;
}

CELL_CASE("bodies: mass, centre and inertia follow the shapes as they come and go") {
    cell::dice dice(1);
    for (int round = 0; round < 10; ++round) {
        world w;
        const body_id id = w.create_body({.position = dice.vec<vec>(-4, 4), .rotation = random_rotation(dice)});
        const world::transform pose = w.pose(id);
        CHECK(weighs(w, id, {1, {}, {}}));
        std::vector<part> parts;
        for (int i = 0; i < 8; ++i) {
            parts.push_back(add_part(w, id, dice, i % 3 == 1 ? 0 : dice.number(0.25, 4)));
            CHECK(weighs(w, id, together(parts)));
        }
        while (!parts.empty()) {
            const auto victim = parts.begin() + dice.below(static_cast<int>(parts.size()));
            w.destroy_shape(victim->id);
            parts.erase(victim);
            const real_mass sum = together(parts);
            CHECK(weighs(w, id, sum.mass > 0 ? sum : real_mass{1, {}, {}}));
        }
        CHECK(gap(w.position(id), pose.position) <= rounding(100, 4));
        CHECK(gap(w.rotation(id), pose.rotation) == 0);
    }
}

CELL_CASE("bodies: a mass that is set stays, whatever the shapes do, until it is reset") {
    cell::dice dice(2);
    world w;
    const body_id id = w.create_body();
    std::vector<part> parts{add_part(w, id, dice, 1)};
    world::mass_properties mass = w.mass(id);
    mass.mass = S(3);
    mass.center = at(0.5, -0.25);
    w.set_mass(id, mass);
    parts.push_back(add_part(w, id, dice, 2));
    w.set_rotation_locked(id, true);
    w.set_rotation_locked(id, false);
    CHECK(w.mass(id).mass == S(3));
    CHECK(w.mass(id).center == at(0.5, -0.25));
    w.set_type(id, body_type::kinematic_body);
    w.set_type(id, body_type::dynamic_body);
    CHECK(w.mass(id).mass == S(3));
    w.reset_mass(id);
    CHECK(weighs(w, id, together(parts)));
    // An inertia of 0 means that nothing turns the body: so it is with a body that has no shapes.
    mass.inertia = {};
    w.set_mass(id, mass);
    w.apply_angular_impulse(id, skew(1));
    CHECK(w.angular_velocity(id) == angular{});
    const body_id point = w.create_body();
    w.set_mass(point, w.mass(point));
    w.apply_impulse_at(point, along(0, 1), along(1, 1));
    CHECK(w.linear_velocity(point) == along(0, 1));
    CHECK(w.angular_velocity(point) == angular{});
}

CELL_CASE("bodies: a new mass leaves the pose, the velocity of each point, and contact points where they are") {
    cell::dice dice(3);
    for (int round = 0; round < 10; ++round) {
        world w(weightless());
        const body_id id = add_compound(w, dice);
        const vec p = dice.vec<vec>(-4, 4);
        const vec v = w.velocity_at(id, p);
        const world::transform pose = w.pose(id);
        const shape_id added = w.create_shape(id, world::ball{}, {.position = at(3, 2), .density = S(4)});
        CHECK(gap(w.velocity_at(id, p), v) <= rounding(100, 16));
        CHECK(gap(w.position(id), pose.position) <= rounding(100, 8));
        w.destroy_shape(added);
        CHECK(gap(w.velocity_at(id, p), v) <= rounding(200, 16));
        w.set_type(id, body_type::kinematic_body);
        CHECK(gap(w.velocity_at(id, p), v) <= rounding(300, 16));
        CHECK(gap(w.position(id), pose.position) <= rounding(300, 8));
    }
    world w;
    const body_id pair[] = {add_box(w, at(0, 0.5)), add_box(w, at(0, 1.5))};
    w.set_angular_velocity(pair[0], about_z(1));
    run(w, 1);
    REQUIRE(w.contacts().size() == 1);
    const auto before = *w.contacts().begin();
    for (const body_id box : pair) {
        world::mass_properties mass = w.mass(box);
        mass.center = at(0.25, box == pair[0] ? 0.25 : -0.125);
        w.set_mass(box, mass);
    }
    const auto after = *w.contacts().begin();
    REQUIRE(after.count == before.count);
    for (int k = 0; k < after.count; ++k) {
        CHECK(gap(after.points[k].position, before.points[k].position) <= rounding(10));
        CHECK(gap(after.points[k].local_a, before.points[k].local_a) <= rounding(10));
        CHECK(gap(after.points[k].local_b, before.points[k].local_b) <= rounding(10));
    }
}

CELL_CASE("bodies: static and kinematic bodies take no mass from shapes, however large these are") {
    for (const body_type type : {body_type::static_body, body_type::kinematic_body}) {
        world w;
        const body_id id = w.create_body({.type = type, .position = at(2, 3)});
        w.create_shape(id, world::box{vec::filled(S(1000000))}, {.position = at(5, 0), .density = S(1000000)});
        w.create_shape(id, world::ball{}, {.position = at(5, 0)});
        CHECK(w.mass(id).mass == S(0));
        CHECK(w.center_of_mass(id) == at(2, 3));
        w.create_shape(id, world::halfspace{});
        CHECK(w.center_of_mass(id) == at(2, 3));
        const body_id other = w.create_body({.type = type});
        w.create_shape(other, world::ball{}, {.position = at(5, 0)});
        w.set_type(other, body_type::dynamic_body);
        CHECK(gap(w.center_of_mass(other), at(5, 0)) <= rounding(4, 5));
        w.set_type(other, type);
        CHECK(w.center_of_mass(other) == vec{});
    }
}

CELL_CASE("bodies: forces and impulses change momentum and angular momentum as they must, in all eight forms") {
    cell::dice dice(4);
    const double h = 1.0 / 64;
    for (int round = 0; round < 16; ++round) {
        CAPTURE(round);
        world w(weightless());
        const body_id id = add_compound(w, dice);
        const bool local = round % 2 != 0, with_point = round / 2 % 2 != 0, impulse = round / 4 % 2 != 0;
        const vec f = dice.vec<vec>(-8, 8), p = dice.vec<vec>(-4, 4);
        const vec in_world = local ? w.rotation(id) * f : f;
        const vec where = !with_point ? w.center_of_mass(id) : local ? w.pose(id) * p : p;
        const momentum before = momentum_of(w, id);
        if (impulse) {
            if (with_point) local ? w.apply_local_impulse_at(id, f, p) : w.apply_impulse_at(id, f, p);
            else local ? w.apply_local_impulse(id, f) : w.apply_impulse(id, f);
        } else {
            if (with_point) local ? w.apply_local_force_at(id, f, p) : w.apply_force_at(id, f, p);
            else local ? w.apply_local_force(id, f) : w.apply_force(id, f);
            CHECK(spread((momentum_of(w, id) - before).linear, {}) == 0);
            run(w, 1);
        }
        const double time = impulse ? 1 : h;
        const momentum change = momentum_of(w, id) - before;
        const real_mass m = real(w.mass(id));
        const double tolerance = rounding(1000, 10 * m.mass);
        CHECK(spread(change.linear, real(in_world) * time) <= tolerance);
        CHECK(spread(change.angular, physics::cross(real(where), real(in_world)) * time) <= 4 * tolerance);
        const momentum after = momentum_of(w, id);
        run(w, 1);
        CHECK(spread((momentum_of(w, id) - after).linear, {}) == 0);
        CHECK(spread((momentum_of(w, id) - after).angular, real_angular{}) <= 4 * tolerance);
    }
}

CELL_CASE("bodies: torques turn, forces add up, and both can be taken back before the step") {
    world w(weightless());
    const body_id id = add_ball(w, at(1, 1));
    const double inertia = inertia_about_z(real(w.mass(id).inertia));
    w.apply_torque(id, about_z(3));
    w.apply_torque(id, about_z(-1));
    run(w, 1);
    CHECK(gap(w.angular_velocity(id), about_z(2 / inertia / 64)) <= rounding(100, 10));
    w.apply_angular_impulse(id, about_z(-2.0 / 64));
    CHECK(gap(w.angular_velocity(id), angular{}) <= rounding(100, 10));
    w.set_angular_velocity(id, {});
    const S mass = w.mass(id).mass;
    w.apply_force(id, at(1, 2));
    w.apply_force(id, at(3, -2));
    run(w, 1);
    CHECK(gap(w.linear_velocity(id), along(0, 4 / number(mass) / 64)) <= rounding(10));
    const vec v = w.linear_velocity(id);
    w.apply_force(id, at(5, 5));
    w.apply_torque(id, skew(1));
    w.clear_forces(id);
    run(w, 1);
    CHECK(w.linear_velocity(id) == v);
    CHECK(w.angular_velocity(id) == angular{});
}

CELL_CASE("bodies: what a force holds up rests where it is at no speed, whatever steps are made of") {
    if constexpr (requires(world::settings_type settings) { settings.solver.substeps; }) {
        for (const int substeps : {1, 2, 4, 8, 64})
            for (const double step : {1.0 / 32, 1.0 / 64, 1.0 / 1024}) {
                world::settings_type settings{.gravity = along(1, -8)};
                settings.solver.substeps = substeps;
                world w(settings);
                const body_id id = add_ball(w, at(0, 2));
                for (int i = 0; i < 100; ++i) {
                    w.apply_force(id, along(1, 8 * number(w.mass(id).mass)));
                    w.step(S(step));
                    CHECK(gap(w.linear_velocity(id), vec{}) <= rounding(100));
                    CHECK(gap(w.position(id), at(0, 2)) <= rounding(1000));
                }
            }
    }
}

CELL_CASE("bodies: nothing but gravity, by its scale, moves what is left alone") {
    for (const double scale : {1.0, 0.0, -2.0, 0.5}) {
        world::settings_type settings;
        settings.gravity = at(2, -8);
        world w(settings);
        const body_id id = w.create_body({.gravity_scale = S(scale)});
        CHECK(w.gravity_scale(id) == S(scale));
        run(w, 32);
        CHECK(w.linear_velocity(id) == at(scale, -4 * scale));
        w.set_gravity_scale(id, S(2));
        run(w, 32);
        CHECK(w.linear_velocity(id) == at(scale + 2, -4 * scale - 8));
    }
}

CELL_CASE("bodies: damping divides velocities by 1 + c h each substep") {
    world w(weightless());
    const body_id id = add_ball(w, {});
    w.set_linear_velocity(id, at(4, 3));
    w.set_angular_velocity(id, about_z(2));
    w.set_damping(id, S(1), S(3));
    CHECK(w.linear_damping(id) == S(1));
    CHECK(w.angular_damping(id) == S(3));
    run(w, 64);
    const int parts = 64 * w.settings().solver.substeps;
    const double slower = std::pow(1 + 1.0 / parts, -parts), stiller = std::pow(1 + 3.0 / parts, -parts);
    CHECK(gap(w.linear_velocity(id), at(4 * slower, 3 * slower)) <= rounding(4 * parts, 4));
    CHECK(gap(w.angular_velocity(id), about_z(2 * stiller)) <= rounding(4 * parts, 2));
    w.set_damping(id, S(1000000), S(1000000));
    run(w, 1);
    CHECK(number(physics::length(w.linear_velocity(id))) < 1e-3);
    CHECK(gap(w.angular_velocity(id), angular{}) < 1e-3);
}

CELL_CASE("bodies: a locked rotation stays, in any collision, until it is freed") {
    world w(weightless());
    const body_id locked = w.create_body({.rotation = turned_about_z(0.5), .rotation_locked = true});
    w.create_shape(locked, world::box{vec::filled(S(0.5))});
    const world::rotation_type start = w.rotation(locked);
    const body_id ball = add_ball(w, at(-3, 0.4));
    w.set_linear_velocity(ball, along(0, 5));
    w.apply_torque(locked, skew(1));
    w.apply_angular_impulse(locked, skew(1));
    run(w, 64);
    CHECK(number(w.linear_velocity(locked).x) > 1);
    CHECK(w.angular_velocity(locked) == angular{});
    CHECK(gap(w.rotation(locked), start) <= rounding(500));
    w.set_rotation_locked(locked, false);
    CHECK_FALSE(w.rotation_locked(locked));
    w.apply_angular_impulse(locked, about_z(1));
    CHECK(gap(w.angular_velocity(locked), angular{}) > 0.5);
    w.set_rotation_locked(locked, true);
    CHECK(w.angular_velocity(locked) == angular{});
}

CELL_CASE("bodies: a kinematic body keeps its velocity and reaches its target exactly, whatever is in the way") {
    world::settings_type settings;
    settings.gravity = along(1, -8);
    world w(settings);
    const body_id pusher = w.create_body({.type = body_type::kinematic_body, .linear_velocity = along(0, 1)});
    w.create_shape(pusher, world::box{vec::filled(S(0.5))}, {.position = along(1, 0.5)});
    const body_id box = add_box(w, at(1.25, 0.5));
    w.set_gravity_scale(box, S(0));
    run(w, 64);
    CHECK(w.linear_velocity(pusher) == along(0, 1));
    CHECK(w.position(pusher) == along(0, 1));
    CHECK(number(w.position(box).x) > 1.98);
    CHECK(number(w.linear_velocity(box).x) > 0.95);

    // A turn about z and one in general position, far beyond what a velocity would do in one step.
    for (const world::rotation_type& turn : {turned_about_z(2.5), turned(turned_about_z(1), skew(0.5))}) {
        const vec target = w.position(pusher) + at(0.5, 0.25);
        w.move_to(pusher, target, turn);
        CHECK(w.position(pusher) != target);
        run(w, 1);
        CHECK(w.position(pusher) == target);
        CHECK(gap(w.rotation(pusher), turn) <= rounding(4));
        run(w, 5);
        CHECK(w.position(pusher) == target);
        CHECK(w.linear_velocity(pusher) == vec{});
        CHECK(w.angular_velocity(pusher) == angular{});
    }
    // The last target counts.
    w.move_to(pusher, at(50, 50), {});
    w.move_to(pusher, {at(20, 20), {}});
    run(w, 1);
    CHECK(w.pose(pusher) == world::transform{at(20, 20), {}});
}

CELL_CASE("bodies: a target that a step reaches pushes as the velocity would") {
    vec reached[2];
    for (const bool by_target : {false, true}) {
        world w(weightless());
        const body_id pusher = w.create_body({.type = body_type::kinematic_body});
        w.create_shape(pusher, world::box{vec::filled(S(0.5))});
        const body_id ball = add_ball(w, along(0, 1));
        for (int i = 1; i <= 32; ++i) {
            if (by_target) w.move_to(pusher, along(0, i / 32.0), {});
            else w.set_linear_velocity(pusher, along(0, 2));
            run(w, 1);
        }
        CHECK(w.position(pusher) == along(0, 1));
        reached[by_target] = w.position(ball);
        CHECK(number(w.position(ball).x) >= 1.99);
    }
    CHECK(gap(reached[0], reached[1]) <= rounding(1000));
}

CELL_CASE("bodies: types change between steps, with shapes, velocities, boxes and contacts in order") {
    world w;
    add_ground(w);
    const body_id stage = add_box(w, at(0, 4)), dropped = add_ball(w, at(0.1, 14), 0.25);
    w.set_linear_velocity(stage, at(0.5, 20));
    // It flies out of the box that the broadphase knows, turns static, and is where it is all the same.
    run(w, 20);
    w.apply_force(stage, along(0, 1000));
    w.set_type(stage, body_type::static_body);
    CHECK(w.type(stage) == body_type::static_body);
    CHECK(w.linear_velocity(stage) == vec{});
    const vec stood = w.position(stage);
    run(w, 100);
    CHECK(w.position(stage) == stood);
    CHECK(std::abs(number(w.position(dropped).y - stood.y) - 0.75) <= 0.02);
    // On the ground and static, a body has no contact with it; dynamic again, it falls without the old force.
    w.set_type(stage, body_type::dynamic_body);
    run(w, 1);
    CHECK(number(w.linear_velocity(stage).x) <= 0.01);
    run(w, 200);
    CHECK(std::abs(number(w.position(stage).y) - 0.5) <= 0.02);
    std::uint32_t with_stage = 0;
    for (const auto& c : w.contacts()) with_stage += c.body_a == stage || c.body_b == stage;
    CHECK(with_stage > 0);
    w.set_type(stage, body_type::kinematic_body);
    for (const auto& c : w.contacts()) CHECK((c.body_a == dropped || c.body_b == dropped));
    w.set_linear_velocity(stage, along(0, 3));
    run(w, 1);
    w.move_to(stage, at(50, 50), {});
    w.set_type(stage, body_type::dynamic_body);
    CHECK(w.linear_velocity(stage) == along(0, 3));
    // The target was the kinematic body's.
    run(w, 1);
    CHECK(number(w.position(stage).y) < 1);
}

CELL_CASE("bodies: a static body that is set elsewhere is met there") {
    world w(weightless());
    const body_id wall = w.create_body({.type = body_type::static_body, .position = at(20, 0)});
    w.create_shape(wall, world::box{});
    const body_id ball = add_ball(w, at(0, 0.9));
    run(w, 1);
    CHECK(w.contacts().size() == 0);
    w.set_pose(wall, {}, {});
    run(w, 1);
    CHECK(w.contacts().size() == 1);
    w.set_pose(wall, at(-20, 0), turned_about_z(1));
    run(w, 1);
    CHECK(w.contacts().size() == 0);
    CHECK(w.contains(ball));
}

}  // namespace
