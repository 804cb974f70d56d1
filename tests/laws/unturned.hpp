// Laws of recipes that leave rotation out: bodies move as if their rotation were locked, at a lower price.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "world_cell.hpp"

namespace {
namespace unturned_laws {

constexpr int D = cell::dimension;
using rotation = physics::rotation<S, D>;

/// Half the shapes, for the compiler's sake.
using few = physics::shapes<physics::ball, physics::box, physics::halfspace>;
template <class Features, class... Policies>
struct of : physics::recipe<S, D, few, Features, Policies...> {};
template <class... Policies>
using straight = physics::world<of<physics::without<physics::feature::rotation>, Policies...>>;
template <class... Policies>
using turning = physics::world<of<physics::without<>, Policies...>>;
using plain = straight<>;

const S step = S(1.0 / 64);
const double g = 10;

template <class Angular = physics::angular<S, D>>
Angular spin(double size) {
    if constexpr (cell::is_2d) return S(size);
    else return {S(size), S(0), S(0)};
}
/// How ground runs that carries what lies on it to the right.
template <class Motion = physics::surface_motion<S, D>>
Motion running(double speed) {
    if constexpr (cell::is_2d) return S(speed);
    else return along(0, speed);
}

template <class World>
World under_gravity(double down = g) {
    typename World::settings_type settings;
    settings.gravity = along(1, -down);
    return World(settings);
}
template <class World>
body_id add(World& w, vec position, vec half, double angle = 0, const typename World::shape_def& def = {}) {
    const body_id b = w.create_body({.position = position, .rotation = turned_about_z(angle), .rotation_locked = true});
    w.create_shape(b, typename World::box{half}, def);
    return b;
}
template <class World>
void add_ground(World& w, const typename World::shape_def& def = {}) {
    w.create_shape(w.create_body({.type = body_type::static_body}), typename World::halfspace{}, def);
}
template <class World>
void run(World& w, int steps) {
    for (int i = 0; i < steps; ++i) w.step(step);
}

/// Where a rotation is locked, in 3D it is still rounded in every step, unless it is none.
const double turned = cell::is_2d ? 1 : 0;

/// What falls onto a tilted box, a ground and a pusher: boxes turned this way and that, or balls alone.
template <class World>
struct pile {
    World w = under_gravity<World>();
    std::vector<body_id> bodies;
    body_id pusher;

    explicit pile(bool with_boxes, std::uint64_t seed) {
        const typename World::shape_def def{.material = {.friction = S(0.5), .restitution = S(0.25)}};
        add_ground(w, def);
        if (with_boxes) {
            const body_id ramp =
                w.create_body({.type = body_type::static_body, .position = at(3, 1), .rotation = turned_about_z(0.5)});
            w.create_shape(ramp, typename World::box{vec::filled(S(1.5))}, def);
        }
        pusher = w.create_body({.type = body_type::kinematic_body, .position = at(-6, 0.5)});
        w.create_shape(pusher, typename World::box{vec::filled(S(0.5))}, def);
        cell::dice dice{seed};
        for (int i = 0; i < 24; ++i) {
            const vec where = at(0.8 * (i % 4) + dice.number(-0.2, 0.2), 1 + 1.2 * (i / 4));
            const body_id b = w.create_body({.position = where,
                                             .rotation = turned_about_z(turned * dice.number(-1, 1)),
                                             .linear_velocity = dice.vec<vec>(-1, 1),
                                             .linear_damping = S(i % 3 ? 0 : 0.125),
                                             .rotation_locked = true});
            if (with_boxes && i % 3)
                w.create_shape(b, typename World::box{vec::filled(S(0.25)) + at(dice.number(0, 0.25), 0)}, def);
            else w.create_shape(b, typename World::ball{S(dice.number(0.2, 0.4))}, def);
            bodies.push_back(b);
        }
        bodies.push_back(pusher);
    }
    void advance(int i) {
        // Off-centre forces and impulses turn nobody.
        if (i % 16 == 3) w.apply_impulse_at(bodies[5], at(0.5, 1), w.position(bodies[5]) + at(0.25, 0.125));
        if (i % 16 == 7) w.apply_force_at(bodies[7], at(-8, 24), w.position(bodies[7]) + at(0.125, 0.25));
        if (i < 128) w.move_to(pusher, w.position(pusher) + along(0, 0.03125), w.rotation(pusher));
        w.step(step);
    }
};
/// The two go the same way, to the bit or within a distance.
template <class Straight, class Turning>
void compare(bool with_boxes, std::uint64_t seed, int steps = 256, double within = 0) {
    pile<Straight> one(with_boxes, seed);
    pile<Turning> other(with_boxes, seed);
    for (int i = 0; i < steps; ++i) {
        one.advance(i);
        other.advance(i);
        for (std::size_t k = 0; k < one.bodies.size(); ++k) {
            const body_id a = one.bodies[k], b = other.bodies[k];
            const vec gap = one.w.position(a) - other.w.position(b);
            REQUIRE(number(length(gap)) <= within);
            if (within > 0) continue;
            REQUIRE(one.w.linear_velocity(a) == other.w.linear_velocity(b));
            REQUIRE(one.w.is_asleep(a) == other.w.is_asleep(b));
        }
    }
}
using seq = physics::sequential_impulse;
CELL_CASE("without rotation: one constraint at a time, bodies move as those whose rotation is locked, to the bit") {
    for (const bool with_boxes : {true, false}) compare<straight<seq>, turning<seq>>(with_boxes, 11);
}
CELL_CASE("without rotation: in lanes, balls, of which one point touches, move as those whose rotation is locked") {
    using no_friction = physics::without<physics::feature::friction>;
    using neither = physics::without<physics::feature::friction, physics::feature::rotation>;
    if constexpr (cell::is_2d) compare<straight<>, turning<>>(false, 13);
    // In 3D a locked rotation costs velocities a rounding, and friction goes by a general cone.
    const double within = cell::is_2d ? 0 : cell::is_fixed ? 1e-4 : 1e4 * number(cell::traits::epsilon());
    compare<physics::world<of<neither>>, physics::world<of<no_friction>>>(false, 13, cell::is_2d ? 256 : 40, within);
}
CELL_CASE("without rotation: a crate slides straight, as far as Coulomb says, whatever the direction") {
    for (int k = 0; k < 12; ++k) {
        plain w = under_gravity<plain>();
        const plain::shape_def def{.material = {.friction = S(0.5)}};
        add_ground(w, def);
        const body_id crate = add(w, at(0, 0.5), vec::filled(S(0.5)), 0, def);
        run(w, 16);
        const double angle = k * 0.5235987755982988;
        const vec displacement =
            cell::is_2d ? along(0, k % 2 ? -1 : 1) : along(0, std::cos(angle)) + along(D - 1, std::sin(angle));
        w.set_linear_velocity(crate, displacement * S(3));
        const vec start = w.position(crate);
        run(w, 64);
        const vec gone = w.position(crate) - start;
        const double far = number(dot(gone, displacement));
        // v^2 / (2 mu g), but for the first substep's part of it.
        CHECK(std::abs(far - 0.9) <= 0.02);
        CHECK(number(length(gone - displacement * S(far))) <= 0.003);
        CHECK(number(length(w.linear_velocity(crate))) <= 1e-4);
    }
}

template <int Width>
struct lanes {
    using stage = physics::stage::solver;
    template <class Space, class Features>
    class in : public physics::soft_step::in<Space, Features, Width> {};
};
template <int Width>
std::uint64_t hash_of_pile() {
    pile<straight<lanes<Width>>> p(true, 14);
    for (int i = 0; i < 200; ++i) p.advance(i);
    return p.w.state_hash();
}
CELL_CASE("without rotation: every width of the lanes gives the same bits") {
    // Others have lanes in 2D only, which the solver's own laws compare.
    if constexpr (std::is_floating_point_v<S>) {
        const std::uint64_t hash = hash_of_pile<1>();
        CHECK(hash_of_pile<2>() == hash);
        CHECK(hash_of_pile<4>() == hash);
        CHECK(hash_of_pile<8>() == hash);
    }
}

CELL_CASE("without rotation: nothing turns, whatever hits it") {
    pile<plain> p(true, 15);
    std::vector<rotation> before;
    for (const body_id b : p.bodies) before.push_back(p.w.rotation(b));
    for (int i = 0; i < 200; ++i) p.advance(i);
    for (std::size_t k = 0; k < p.bodies.size(); ++k) {
        CHECK(p.w.rotation(p.bodies[k]) == before[k]);
        CHECK(p.w.angular_velocity(p.bodies[k]) == plain::angular{});
        CHECK(p.w.rotation_locked(p.bodies[k]));
    }
    // But a pose can be set.
    p.w.set_pose(p.bodies[0], at(0, 20), turned_about_z(1));
    CHECK(!(p.w.rotation(p.bodies[0]) == before[0]));
    const rotation now = p.w.rotation(p.bodies[0]);
    run(p.w, 32);
    CHECK(p.w.rotation(p.bodies[0]) == now);
}

CELL_CASE("without rotation: a slope holds what friction can, and the rest slides as Coulomb says") {
    const double angle = 0.4, c = std::cos(angle), s = std::sin(angle);
    for (const double mu : {0.0, 0.2, 0.5}) {
        plain w = under_gravity<plain>();
        const plain::shape_def def{.material = {.friction = S(mu)}};
        const body_id slope = w.create_body({.type = body_type::static_body, .rotation = turned_about_z(angle)});
        w.create_shape(slope, plain::box{vec::filled(S(50))}, def);
        const vec up = at(-s, c), down = at(-c, -s);
        const body_id crate = add(w, up * S(50.5), vec::filled(S(0.5)), angle, def);
        run(w, 64);
        const vec before = w.linear_velocity(crate);
        run(w, 64);
        const double gained = number(dot(w.linear_velocity(crate) - before, down));
        const double expected = std::max(0.0, g * (s - mu * c));
        CHECK(std::abs(gained - expected) <= 0.002 * expected + 1e-5);
        CHECK(std::abs(number(dot(w.position(crate), up)) - 50.5) <= 0.003);

        // The points bear together what the slope does.
        const auto contact = *w.contacts().begin();
        CHECK(contact.count == (cell::is_2d ? 2 : 4));
        double load = 0, rubbed = 0;
        for (int k = 0; k < contact.count; ++k) {
            load += number(contact.points[k].normal_impulse);
            const vec along_slope = contact.tangents.combine(contact.points[k].friction_impulse);
            rubbed += number(dot(along_slope, down));
        }
        const double of_step = g * number(w.mass(crate).mass) * number(step);
        const double sign = contact.body_a == slope ? -1 : 1;
        CHECK(std::abs(load - of_step * c) <= 0.005 * of_step);
        CHECK(std::abs(rubbed * sign - of_step * std::min(s, mu * c)) <= 0.005 * of_step);
    }
}

CELL_CASE("without rotation: crates that meet off their centres part as points do, and keep their momentum") {
    for (const double e : {0.0, 0.5, 1.0}) {
        plain w = under_gravity<plain>(0);
        const plain::shape_def def{.density = S(2), .material = {.friction = S(0), .restitution = S(e)}};
        const plain::shape_def light{.density = S(1), .material = {.friction = S(0), .restitution = S(e)}};
        const body_id a = add(w, at(-2, 0), vec::filled(S(0.5)), 0, def);
        const body_id b = add(w, at(2, 0.75), vec::filled(S(0.5)), 0, light);
        w.set_linear_velocity(a, along(0, 3));
        w.set_linear_velocity(b, along(0, -1.5));
        run(w, 64);
        // 2 u + v = 4.5, v - u = 4.5 e.
        const double u = 1.5 - 1.5 * e, v = 1.5 + 3 * e;
        CHECK(std::abs(number(w.linear_velocity(a).x) - u) <= 1e-3);
        CHECK(std::abs(number(w.linear_velocity(b).x) - v) <= 1e-3);
        const double momentum = 2 * number(w.linear_velocity(a).x) + number(w.linear_velocity(b).x);
        CHECK(std::abs(momentum - 4.5) <= 64 * number(cell::traits::epsilon()));
        CHECK(w.linear_velocity(a).y == S(0));
    }
}

CELL_CASE("without rotation: a tower stands as it was built, falls asleep, and wakes when it is hit") {
    plain w = under_gravity<plain>();
    add_ground(w);
    std::vector<body_id> crates;
    // Each hangs over by more than could stand if crates turned.
    for (int i = 0; i < 8; ++i) crates.push_back(add(w, at(0.75 * i, 0.5 + i), vec::filled(S(0.5))));
    run(w, 192);
    for (int i = 0; i < 8; ++i) {
        const vec p = w.position(crates[static_cast<std::size_t>(i)]);
        CHECK(std::abs(number(p.x) - 0.75 * i) <= 1e-5);
        CHECK(std::abs(number(p.y) - (0.5 + i)) <= 0.01);
        CHECK(w.is_asleep(crates[static_cast<std::size_t>(i)]));
    }
    const body_id ball = add(w, at(-2, 0.5), vec::filled(S(0.25)));
    w.set_linear_velocity(ball, along(0, 10));
    run(w, 16);
    CHECK(!w.is_asleep(crates[0]));
    CHECK(w.linear_velocity(ball).x < S(1));
}

CELL_CASE("without rotation: nothing passes through a wall, and conveyors carry crates along") {
    plain w = under_gravity<plain>();
    const plain::shape_def belt{.material = {.friction = S(0.5), .surface_velocity = running(2)}};
    add_ground(w, belt);
    w.create_shape(w.create_body({.type = body_type::static_body, .position = at(20, 5)}),
                   plain::box{vec::filled(S(5)) - along(0, 4.96875)});
    const body_id crate = add(w, at(-30, 0.5), vec::filled(S(0.5)));
    const body_id bullet = add(w, at(0, 5), vec::filled(S(0.125)));
    w.set_linear_velocity(bullet, along(0, 900));
    run(w, 64);
    CHECK(w.position(bullet).x < S(20));
    CHECK(std::abs(number(w.linear_velocity(crate).x) - 2) <= 1e-4);
}

CELL_CASE("without rotation: what would turn a body is refused, and nothing is half done") {
    plain w = under_gravity<plain>();
    add_ground(w);
    const body_id crate = add(w, at(0, 0.5), vec::filled(S(0.5)));
    const body_id door = w.create_body({.type = body_type::kinematic_body, .position = at(9, 9)});
    std::uint64_t before = w.state_hash();
    const auto said = [&](auto&& f) {
        std::string what;
        try {
            f();
        } catch (const physics::error& e) {
            what = e.what();
        }
        CHECK(w.state_hash() == before);
        return what;
    };
    plain::body_def spins, decays;
    spins.angular_velocity = spin(2);
    decays.angular_damping = S(0.5);
    const std::string component = cell::is_2d ? "" : ".x";
    CHECK(said([&] { w.create_body(spins); }) ==
          "physics: create_body: angular_velocity" + component + " is 2; the recipe leaves it out");
    CHECK(said([&] { w.create_body(decays); }) ==
          "physics: create_body: angular_damping is 0.5; the recipe leaves it out");
    CHECK(said([&] { w.set_damping(crate, S(0), S(0.5)); }) ==
          "physics: set_damping: angular_rate is 0.5; the recipe leaves it out");
    for (const double angle : {0.3, 1.1}) {
        // The rotation that a body was made with is no other one, though it has been normalised.
        const body_id made = w.create_body({.type = body_type::kinematic_body, .rotation = turned_about_z(angle)});
        w.move_to(made, at(1, 1), turned_about_z(angle));
        w.step(step);
        CHECK(w.position(made) == at(1, 1));
        w.destroy_body(made);
    }
    before = w.state_hash();
    CHECK(said([&] { w.move_to(door, at(9, 8), turned_about_z(0.5)); }) ==
          "physics: move_to: rotation is another one; the recipe leaves rotation out");
    plain::mass_properties mass = w.mass(crate);
    CHECK(mass.inertia == decltype(mass.inertia){});
    mass.inertia = physics::mass_of(plain::box{vec::filled(S(0.5))}, S(1)).inertia;
    CHECK(said([&] { w.set_mass(crate, mass); }) ==
          "physics: set_mass: inertia is not 0; the recipe leaves rotation out");
    mass.inertia = {};
    w.set_mass(crate, mass);
    CHECK(w.mass(crate).mass == mass.mass);
}

/// Calls that only make sense for what turns do not compile.
template <class World>
concept takes_spins = requires(World w, body_id b, typename World::angular spin) {
    w.set_angular_velocity(b, spin);
};
template <class World>
concept takes_torques = requires(World w, body_id b, typename World::angular torque) {
    w.apply_torque(b, torque);
};
static_assert(takes_spins<turning<>> && takes_torques<turning<>>);
static_assert(!takes_spins<plain> && !takes_torques<plain>);

/// What is left out takes no byte.
using physics::solver_api::body;
using physics::solver_api::solver_body;
static_assert(sizeof(body<S, D, false>) + sizeof(S) * (D == 2 ? 5 : 26) <= sizeof(body<S, D>) + 8);
static_assert(sizeof(solver_body<S, D, false>) <= sizeof(solver_body<S, D>) / (D == 2 ? 1 : 2));
static_assert(sizeof(S) != 4 || sizeof(solver_body<S, D, false>) == 32);
static_assert(sizeof(physics::solver_api::moving_body<S, D, false>) == sizeof(S) * (2 * D + 1));
using features = physics::without<physics::feature::rotation>;
using turning_block = physics::detail::soft_contact<S, D, 4, physics::without<>>;
static_assert(sizeof(physics::detail::soft_linear_contact<S, D, 4, features>) * (D == 2 ? 2 : 4) <=
              sizeof(turning_block));
static_assert(sizeof(physics::solver_api::contact<S, D, features>) < sizeof(physics::solver_api::contact<S, D>));

}  // namespace unturned_laws
}  // namespace
