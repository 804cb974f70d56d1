// Laws of surfaces: resistance to rolling, belts, rules of mixing, friction of patches and of points.
#pragma once

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "cell.hpp"

namespace {
namespace surfaces_laws {

using S = cell::scalar;
constexpr int D = cell::dimension;
using physics::body_id;
using physics::shape_id;
using vec = physics::vec<S, D>;
using material = physics::material<S, D>;

/// Half the shapes, for the compiler's sake.
using few = physics::shapes<physics::ball, physics::box, physics::halfspace>;
template <class... Policies>
struct of : physics::recipe<S, D, few, Policies...> {};
template <class... Policies>
using made_of = physics::world<of<Policies...>>;
using sequential = made_of<physics::sequential_impulse>;
using patches = made_of<physics::soft_step>;
using points = made_of<physics::soft_step_with<physics::point_friction>>;

const double pi = 3.14159265358979323846, g = 10;

inline double number(S x) { return cell::number(x); }
inline vec along(int axis, double size) {
    vec v;
    v[axis] = S(size);
    return v;
}
inline double size(vec v) {
    double sum = 0;
    for (int i = 0; i < D; ++i) sum += number(v[i]) * number(v[i]);
    return std::sqrt(sum);
}
/// The direction k of n in the ground: round about in space, there and back in the plane.
inline vec direction(int k, int n) {
    if constexpr (cell::is_2d) return along(0, k % 2 ? -1 : 1);
    else return along(0, std::cos(2 * pi * k / n)) + along(D - 1, std::sin(2 * pi * k / n));
}
const int directions = cell::is_2d ? 2 : 12;

/// How the ground runs with a velocity that lies in it.
template <class Motion = physics::surface_motion<S, D>>
Motion running(vec v) {
    if constexpr (cell::is_2d) return v.x;
    else return v;
}
template <class Rotation = physics::rotation<S, D>>
Rotation about_z(double angle) {
    if constexpr (cell::is_2d) return Rotation::from_angle(S(angle));
    else return Rotation::from_axis_angle({S(0), S(0), S(1)}, S(angle));
}
template <class Angular = physics::angular<S, D>>
Angular spin(vec axis, double speed) {
    if constexpr (cell::is_2d) return S(speed);
    else return axis * S(speed);
}

/// Gravity 10 on a slope, which falls to the left where the angle is positive. Nobody sleeps: what holds has to hold.
template <class World>
World ground(const material& m, double angle = 0) {
    typename World::settings_type settings;
    settings.sleeping.enabled = false;
    settings.gravity = along(1, -g);
    World w(settings);
    typename World::halfspace plane;
    plane.normal = along(0, -std::sin(angle)) + along(1, std::cos(angle));
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), plane, {.material = m});
    return w;
}
template <class World>
body_id ball(World& w, double radius, double angle = 0) {
    const body_id b =
        w.create_body({.position = along(0, -radius * std::sin(angle)) + along(1, radius * std::cos(angle))});
    w.create_shape(b, typename World::ball{S(radius)});
    return b;
}
template <class World>
body_id box(World& w, vec half) {
    const body_id b = w.create_body({.position = along(1, number(half.y))});
    w.create_shape(b, typename World::box{half});
    return b;
}
template <class World>
void run(World& w, int steps) {
    for (int i = 0; i < steps; ++i) w.step(S(1.0 / 64));
}
/// Sets a ball rolling without slip.
template <class World>
void roll(World& w, body_id b, vec towards, double speed, double radius) {
    w.set_linear_velocity(b, towards * S(speed));
    const vec axis = along(0, number(towards[D - 1])) - along(D - 1, number(towards.x));
    w.set_angular_velocity(b, spin(axis, cell::is_2d ? -number(towards.x) * speed / radius : speed / radius));
}
inline double yaw(S) { return 0; }
inline double yaw(physics::vec<S, 3> w) { return number(w.y); }
/// What fixed point rounds: impulses of a substep, some hundredths.
const double fine = cell::is_fixed ? 1e-6 : 1e3 * number(cell::traits::epsilon());

/// Rolling, about the point of contact: (I + m r^2) dw/dt = -b m g, with I = 2/5 m r^2 of a ball, 1/2 of a disc.
const double share = cell::is_2d ? 2.0 / 3 : 5.0 / 7;

template <class World>
void slows_down() {
    const double b = 0.03125, r = 0.5, v = 4, slowing = share * g * b / r;
    for (int k = 0; k < directions; ++k) {
        World w = ground<World>({.friction = S(0.6), .rolling_resistance = S(b)});
        const body_id id = ball(w, r);
        const vec towards = direction(k, directions);
        run(w, 16);
        roll(w, id, towards, v, r);
        run(w, 16);
        const double before = size(w.linear_velocity(id));
        run(w, 64);
        const double after = size(w.linear_velocity(id));
        // In the steady state friction and resistance are the same in each step: only rounding is left.
        CHECK(std::abs(before - after - slowing) <= 0.002 * slowing + fine);
        // And not aside.
        CHECK(std::abs(number(dot(w.linear_velocity(id), towards)) - after) <= 1e-4 + fine);
        const auto c = *w.contacts().begin();
        CHECK(c.rolling_resistance == S(b));
        if constexpr (cell::is_2d) CHECK(std::abs(number(c.rolling_impulse)) > 0);
        else CHECK(size(along(0, number(c.rolling_impulse.x)) + along(1, number(c.rolling_impulse.y))) > 0);
        run(w, 640);
        CHECK(size(w.linear_velocity(id)) <= 1e-4 + fine);
    }
}
CELL_CASE("rolling: resistance slows a ball by 5/7 g b / r, a disc by 2/3 g b / r, in any direction, and stops it") {
    slows_down<sequential>();
    slows_down<patches>();
    slows_down<points>();
}

template <class World>
void rolls_down_from() {
    const double b = 0.05, r = 0.5;
    const auto displacement = [&](double tangent) {
        const double angle = std::atan(tangent);
        World w = ground<World>({.friction = S(1), .rolling_resistance = S(b)}, angle);
        const body_id id = ball(w, r, angle);
        const vec start = w.position(id);
        run(w, 256);
        return size(w.position(id) - start);
    };
    // Above the critical slope after 4 s: 1/2 * share * g * 0.02 tan * 16 > 0.1 m.
    CHECK(displacement(0.98 * b / r) <= 0.005);
    CHECK(displacement(1.02 * b / r) >= 0.05);
    CHECK(displacement(0.5 * b / r) <= 0.005);
}
CELL_CASE("rolling: a ball stays on slopes below b / r and rolls down above, to 2 %") {
    rolls_down_from<sequential>();
    rolls_down_from<patches>();
}

CELL_CASE("rolling: resistance comes and goes with the material, and leaves no impulse behind") {
    patches w = ground<patches>({.rolling_resistance = S(0.05)});
    const shape_id floor = *w.shapes(*w.bodies().begin()).begin();
    const body_id id = ball(w, 0.5);
    run(w, 16);
    roll(w, id, along(0, 1), 4, 0.5);
    run(w, 32);
    w.set_material(floor, {});
    CHECK(w.material(floor).rolling_resistance == S(0));
    run(w, 1);
    const double v = size(w.linear_velocity(id));
    CHECK((*w.contacts().begin()).rolling_impulse == physics::tangential<S, D>{});
    run(w, 64);
    CHECK(std::abs(size(w.linear_velocity(id)) - v) <= 1e-3);
}

/// A box on a belt: mu g until it goes along.
template <class World>
void carried_along() {
    const double mu = 0.5, speed = 3;
    for (int k = 0; k < directions; ++k) {
        const vec towards = direction(k, directions);
        World w = ground<World>({.friction = S(mu)});
        const shape_id belt = *w.shapes(*w.bodies().begin()).begin();
        const body_id id = w.create_body({.position = along(1, 0.25)});
        w.create_shape(id, typename World::box{vec::filled(S(0.25))}, {.material = {.friction = S(mu)}});
        run(w, 32);
        CHECK(size(w.linear_velocity(id)) <= 1e-4 + fine);
        w.set_material(belt, {.friction = S(mu), .surface_velocity = running(towards * S(speed))});
        run(w, 1);
        const double first = number(dot(w.linear_velocity(id), towards));
        run(w, 16);
        // mu g for 16/64 s.
        const vec v = w.linear_velocity(id);
        CHECK(std::abs(number(dot(v, towards)) - first - mu * g * 0.25) <= 0.02);
        CHECK(size(v - towards * dot(v, towards)) <= 0.01);
        run(w, 64);
        CHECK(size(w.linear_velocity(id) - towards * S(speed)) <= 0.005);
        const vec there = w.position(id);
        run(w, 64);
        // No slip: a second takes it as far as the belt runs.
        CHECK(size(w.position(id) - there - towards * S(speed)) <= 0.005);
    }
}
CELL_CASE("belt: it drives a box by mu g up to its own speed, then without slip, in any direction") {
    carried_along<sequential>();
    carried_along<patches>();
    carried_along<points>();
}

/// Of a ball on a belt: friction turns it while it slips; then it rolls, and nothing drives it any more.
template <class World>
void ball_on_a_belt() {
    const double speed = 4;
    World w = ground<World>({.friction = S(0.6), .surface_velocity = running(along(0, speed))});
    const body_id id = ball(w, 0.5);
    run(w, 128);
    // m v = J and I w = J r with v + w r = speed: v = speed I / (I + m r^2).
    CHECK(std::abs(number(w.linear_velocity(id).x) - speed * (1 - share)) <= 0.01);
    const vec bottom = w.velocity_at(id, w.position(id) - along(1, 0.5));
    CHECK(std::abs(number(bottom.x) - speed) <= 0.01);
}
CELL_CASE("belt: a ball on it ends at 2/7 of its speed, a disc at 1/3") {
    ball_on_a_belt<sequential>();
    ball_on_a_belt<patches>();
    ball_on_a_belt<points>();
}

CELL_CASE("belt: it runs in its shape's frame, also where the shape comes second, and two of them add up") {
    const auto speed_of = [](auto&& build) {
        patches w = ground<patches>({});
        const body_id id = build(w);
        run(w, 96);
        return number(w.linear_velocity(id).x);
    };
    // The tread of a box upon ground that rests: it drives itself the other way.
    const auto self_driven = [](double turned, double speed) {
        return [=](patches& w) {
            const body_id id = w.create_body({.position = along(1, 0.25), .rotation = about_z(turned)});
            // In the plane the bottom runs against the top: the sense of rotation is the same all round.
            const vec tread = cell::is_2d ? along(0, -speed)
                                          : along(0, speed * std::cos(turned)) + along(1, -speed * std::sin(turned));
            w.create_shape(id, patches::box{vec::filled(S(0.25))}, {.material = {.surface_velocity = running(tread)}});
            return id;
        };
    };
    CHECK(std::abs(speed_of(self_driven(0, 2)) + 2) <= 0.005);
    CHECK(std::abs(speed_of(self_driven(pi / 2, 2)) + 2) <= 0.005);
    const auto both = [&](patches& w) {
        w.set_material(*w.shapes(*w.bodies().begin()).begin(), {.surface_velocity = running(along(0, 3))});
        return self_driven(0, 2)(w);
    };
    CHECK(std::abs(speed_of(both) - 1) <= 0.005);
    // A box as belt, whose kind comes after the ball's.
    const auto on_a_box = [](patches& w) {
        const body_id belt = w.create_body({.type = physics::body_type::static_body, .position = along(1, 1)});
        w.create_shape(belt, patches::box{vec::filled(S(1)) + along(0, 30)},
                       {.material = {.surface_velocity = running(along(0, 4))}});
        const body_id id = w.create_body({.position = along(1, 2.5)});
        w.create_shape(id, patches::ball{S(0.5)});
        return id;
    };
    CHECK(std::abs(speed_of(on_a_box) - 4 * (1 - share)) <= 0.01);
}

template <class World>
void slide_of() {
    for (int k = 0; k < directions; ++k) {
        World w = ground<World>({.friction = S(0.5)});
        const vec towards = direction(k, directions);
        const body_id id = w.create_body({.position = along(1, 0.5)});
        w.create_shape(id, typename World::box{vec::filled(S(0.5))}, {.material = {.friction = S(0.5)}});
        run(w, 16);
        const vec start = w.position(id);
        w.set_linear_velocity(id, towards * S(10));
        run(w, 192);
        const vec displacement = w.position(id) - start;
        // v^2 / (2 mu g), less half the way of a substep, to as much.
        CHECK(std::abs(size(displacement) - (10 - 0.5 * 10 / 256)) <= 0.5 * 10 / 256);
        CHECK(size(displacement - towards * dot(displacement, towards)) <= 0.01);
    }
}
template <class World>
void slips_from() {
    const double angle = 20 * pi / 180;
    const auto displacement = [&](double mu) {
        World w = ground<World>({.friction = S(mu)}, angle);
        const body_id id =
            w.create_body({.position = along(0, -0.25 * std::sin(angle)) + along(1, 0.25 * std::cos(angle)),
                           .rotation = about_z(angle)});
        w.create_shape(id, typename World::box{vec::filled(S(0.25)) + along(0, 0.25)},
                       {.material = {.friction = S(mu)}});
        const vec start = w.position(id);
        run(w, 320);
        return size(w.position(id) - start);
    };
    CHECK(displacement(0.995 * std::tan(angle)) > 0.1);
    CHECK(displacement(1.005 * std::tan(angle)) <= 0.1);
    CHECK(displacement(1.1 * std::tan(angle)) <= 0.005);
}
CELL_CASE("S1 slide, S2 incline: of patches and of points alike, in 12 directions and to 0.5 %") {
    slide_of<patches>();
    slide_of<points>();
    slips_from<patches>();
    slips_from<points>();
}

template <int N>
void spin_down() {
    if constexpr (N == 3) {
        // Four corners with a quarter of the load each, at the distance d: torque mu m g d against m (a^2 + c^2) / 3.
        const double mu = 0.5, a = 0.5, c = 0.25, d = std::sqrt(a * a + c * c), speed = 8;
        const double slowing = mu * g * d / ((a * a + c * c) / 3);
        const auto check = [&](auto&& w) {
            using world = std::remove_cvref_t<decltype(w)>;
            const body_id id = w.create_body({.position = along(1, 0.25)});
            w.create_shape(id, typename world::box{along(0, a) + along(1, 0.25) + along(D - 1, c)},
                           {.material = {.friction = S(mu)}});
            run(w, 32);
            w.set_angular_velocity(id, spin(along(1, 1), speed));
            const int steps = 12;
            run(w, steps);
            const auto left = w.angular_velocity(id);
            if constexpr (cell::is_3d) CHECK(std::abs(number(left.y) - (speed - slowing * steps / 64)) <= 0.02 * speed);
            run(w, 32);
            if constexpr (cell::is_3d) CHECK(std::abs(number(w.angular_velocity(id).y)) <= 1e-3);
            CHECK(size(w.linear_velocity(id)) <= 1e-2);
        };
        check(ground<patches>({.friction = S(mu)}));
        check(ground<points>({.friction = S(mu)}));
    }
}
CELL_CASE("friction: a spinning box stops in the time of its four corners, of patches and of points") {
    spin_down<D>();
}

template <int N>
void uneven_load() {
    if constexpr (N == 3) {
        // A plank whose centre of mass is near one end: load and friction share their centre right below it, and so
        // nothing turns it.
        points w = ground<points>({.friction = S(0.4)});
        const body_id id = w.create_body({.position = along(1, 0.125)});
        w.create_shape(id, points::box{along(0, 1) + along(1, 0.125) + along(D - 1, 0.25)},
                       {.material = {.friction = S(0.4)}});
        auto mass = w.mass(id);
        mass.center = along(0, 0.5);
        w.set_mass(id, mass);
        run(w, 32);
        w.set_linear_velocity(id, along(D - 1, 3));
        run(w, 24);
        CHECK(std::abs(yaw(w.angular_velocity(id))) <= 0.03);
    }
}
CELL_CASE("friction of points acts where the load is: a body that slides under a load off its middle does not turn") {
    uneven_load<D>();
}

/// A body on four corners of even load that slides at v (along x) and spins at w: what Coulomb's law at each corner
/// leaves of both after a time, in small steps. Corners at a, c; per mass.
struct sliding_top {
    double vx, vz = 0, w, turned = 0;

    void advance(double time, double mu, double a, double c) {
        const int steps = 100000;
        const double h = time / steps, inertia = (a * a + c * c) / 3;
        for (int i = 0; i < steps; ++i) {
            double fx = 0, fz = 0, torque = 0;
            for (const double s : {-1.0, 1.0})
                for (const double q : {-1.0, 1.0}) {
                    // About y, x turns towards -z.
                    const double x = s * a * std::cos(turned) + q * c * std::sin(turned);
                    const double z = -s * a * std::sin(turned) + q * c * std::cos(turned);
                    const double ux = vx + w * z, uz = vz - w * x, u = std::hypot(ux, uz);
                    const double px = -mu * g / 4 * ux / u, pz = -mu * g / 4 * uz / u;
                    fx += px;
                    fz += pz;
                    torque += z * px - x * pz;
                }
            vx += fx * h;
            vz += fz * h;
            w += torque / inertia * h;
            turned += w * h;
        }
    }
};
template <int N>
void slide_and_spin() {
    if constexpr (N == 3) {
        const double mu = 0.5, a = 0.5, c = 0.25;
        const auto left_of = [&](auto&& w) {
            using world = std::remove_cvref_t<decltype(w)>;
            const body_id id = w.create_body({.position = along(1, 0.02)});
            w.create_shape(id, typename world::box{along(0, a) + along(1, 0.02) + along(D - 1, c)},
                           {.material = {.friction = S(mu)}});
            run(w, 32);
            w.set_linear_velocity(id, along(0, 4));
            w.set_angular_velocity(id, spin(along(1, 1), 4));
            run(w, 32);
            return std::pair{size(w.linear_velocity(id)), yaw(w.angular_velocity(id))};
        };
        sliding_top exact{.vx = 4, .w = 4};
        exact.advance(0.5, mu, a, c);
        const auto [speed, spinning] = left_of(ground<points>({.friction = S(mu)}));
        CHECK(std::abs(speed - std::hypot(exact.vx, exact.vz)) <= 0.02 * 4);
        CHECK(std::abs(spinning - exact.w) <= 0.02 * 4);
        // A patch slows both at once, as if each had all friction for itself.
        const auto [patch_speed, patch_spin] = left_of(ground<patches>({.friction = S(mu)}));
        CHECK(std::abs(patch_speed - (4 - mu * g / 2)) <= 0.02 * 4);
        CHECK(std::abs(patch_spin) <= 0.01);
        CHECK(exact.w > 0.5);
    }
}
CELL_CASE("friction of points slows a sliding spin as Coulomb's law at four corners does, to 2 %") {
    slide_and_spin<D>();
}

// What a user writes.
struct rubber_wins {
    using stage = physics::stage::mixing;
    template <class Space>
    struct in {
        using T = typename Space::scalar;
        using surface = physics::material<T, Space::dimension>;
        static T friction(const surface& a, const surface& b) {
            return a.friction > T(0.75) || b.friction > T(0.75) ? T(1) : a.friction * b.friction;
        }
        static T restitution(const surface&, const surface&) { return T(0.125); }
        static T rolling_resistance(const surface& a, const surface& b) {
            return a.rolling_resistance + b.rolling_resistance;
        }
    };
};
struct gone_wrong : rubber_wins {
    template <class Space>
    struct in : rubber_wins::in<Space> {
        using T = typename Space::scalar;
        using surface = physics::material<T, Space::dimension>;
        static T friction(const surface& a, const surface&) { return T(1) - a.friction; }
    };
};

/// What a ball and the ground make of their contact.
template <class... Policies>
auto mixed(const material& a, const material& b) {
    made_of<Policies...> w = ground<made_of<Policies...>>(a);
    const body_id id = w.create_body({.position = along(1, 0.5)});
    w.create_shape(id, physics::ball<S, D>{S(0.5)}, {.material = b});
    w.step(S(1.0 / 64));
    REQUIRE(w.contacts().size() == 1);
    return *w.contacts().begin();
}
template <class... Policies>
void check_mixture(double friction, double restitution, double rolling) {
    const material a{.friction = S(0.25), .restitution = S(0.5), .rolling_resistance = S(0.0625)};
    const material b{.friction = S(1), .restitution = S(0.25), .rolling_resistance = S(0.125)};
    for (const auto& c : {mixed<Policies...>(a, b), mixed<Policies...>(b, a)}) {
        CHECK(c.friction == S(friction));
        CHECK(c.restitution == S(restitution));
        CHECK(c.rolling_resistance == S(rolling));
    }
}
CELL_CASE("mixing: each rule gives what it says, whoever comes first; a user's rule too") {
    check_mixture<>(0.5, 0.5, 0.125);
    check_mixture<physics::geometric_mixing>(0.5, 0.5, 0.125);
    check_mixture<physics::product_mixing>(0.25, 0.125, 0.125);
    check_mixture<physics::minimum_mixing>(0.25, 0.25, 0.0625);
    check_mixture<physics::maximum_mixing>(1, 0.5, 0.125);
    check_mixture<physics::average_mixing>(0.625, 0.375, 0.09375);
    check_mixture<rubber_wins>(1, 0.125, 0.1875);
}
template <class... Policies>
void check_bumper(double restitution) {
    for (const double speed : {2.0, 10.0}) {
        made_of<Policies...> w = ground<made_of<Policies...>>({.friction = S(0), .restitution = S(restitution)});
        auto settings = w.settings();
        settings.gravity = {};
        w.set_settings(settings);
        const body_id id = w.create_body({.position = along(1, 1), .linear_velocity = along(1, -speed)});
        w.create_shape(id, physics::ball<S, D>{S(0.5)});
        double fastest = 0;
        for (int i = 0; i < 40; ++i) {
            w.step(S(1.0 / 64));
            fastest = std::max(fastest, cell::number(w.linear_velocity(id).y));
        }
        CHECK(std::abs(fastest - restitution * speed) <= 1e-3 * restitution * speed);
        CHECK(std::abs(cell::number(w.linear_velocity(id).y) - fastest) <= 1e-3 * fastest);
    }
}
CELL_CASE("bounces: a bumper gives back more than it gets") {
    for (const double restitution : {1.0, 1.5, 4.0}) {
        check_bumper<>(restitution);
        check_bumper<physics::sequential_impulse>(restitution);
    }
}
CELL_CASE("mixing: the step refuses what no solver takes, and changes nothing") {
    auto w = ground<made_of<gone_wrong>>({.friction = S(0.5)});
    const body_id id = w.create_body({.position = along(1, 0.5)});
    const shape_id shape = w.create_shape(id, physics::ball<S, D>{S(0.5)}, {.material = {.friction = S(2)}});
    const std::uint64_t before = w.state_hash();
    CHECK_THROWS_WITH(
        w.step(S(1.0 / 64)),
        "physics: step: a coefficient of two surfaces is out of range; the mixing rule must give friction, "
        "restitution and rolling_resistance that are finite and at least 0");
    CHECK(w.state_hash() == before);
    w.set_material(shape, {.friction = S(0.5)});
    w.step(S(1.0 / 64));
    CHECK(w.steps() == 1);
}
/// Two boxes of unlike surfaces that hit one another, and the same with the surfaces swapped, seen in a mirror.
CELL_CASE("mixing: swapped surfaces give the mirrored motion") {
    const material a{.friction = S(0.25), .restitution = S(0.5)}, b{.friction = S(1), .restitution = S(0.25)};
    const auto meet = [&](const material& left, const material& right) {
        made_of<> w;
        w.set_settings({.gravity = {}});
        body_id ids[2];
        for (int i = 0; i < 2; ++i) {
            const double side = i ? 1 : -1;
            ids[i] =
                w.create_body({.position = along(0, side), .linear_velocity = along(0, -2 * side) + along(1, side)});
            w.create_shape(ids[i], physics::ball<S, D>{S(0.5)}, {.material = i ? right : left});
        }
        run(w, 64);
        return std::pair{w.linear_velocity(ids[0]), w.linear_velocity(ids[1])};
    };
    const auto one = meet(a, b), other = meet(b, a);
    CHECK(size(one.first - other.first) <= fine);
    CHECK(size(one.second - other.second) <= fine);
    CHECK(size(one.first + one.second) <= fine);
}

using physics::without;
using physics::feature::rolling_resistance;
using physics::feature::surface_velocity;

/// The sentence with which a recipe refuses a material, if it does.
template <class Recipe>
std::string refusal_of(const material& m) {
    physics::world<Recipe> w;
    const body_id id = w.create_body({});
    const shape_id shape = w.create_shape(id, physics::ball<S, D>{S(0.5)});
    const std::uint64_t before = w.state_hash();
    std::string said;
    try {
        w.set_material(shape, m);
    } catch (const physics::error& e) {
        said = e.what();
        CHECK(w.state_hash() == before);
    }
    return said;
}
CELL_CASE("features: surfaces cannot ask for what the recipe leaves out") {
    const material resists{.rolling_resistance = S(0.25)}, runs{.surface_velocity = running(along(0, 5))};
    const material bounces{.restitution = S(0.5)}, rubs{.friction = S(0.5)};
    using no_friction = of<without<physics::feature::friction>>;
    CHECK(refusal_of<of<without<rolling_resistance>>>(resists) ==
          "physics: set_material: rolling_resistance is 0.25; the recipe leaves it out");
    CHECK(refusal_of<of<without<physics::feature::restitution>>>(bounces) ==
          "physics: set_material: restitution is 0.5; the recipe leaves it out");
    CHECK(refusal_of<of<without<surface_velocity>>>(runs).find("the recipe leaves it out") != std::string::npos);
    CHECK(refusal_of<no_friction>(runs).find("surface_velocity") != std::string::npos);
    CHECK(refusal_of<no_friction>(rubs).empty());
    for (const material& m : {resists, runs, bounces, rubs}) CHECK(refusal_of<of<>>(m).empty());
}
CELL_CASE("features: without them neither resistance nor belts nor friction act") {
    const auto speeds = [](auto&& w) {
        const body_id id = ball(w, 0.5);
        run(w, 64);
        roll(w, id, along(0, 1), 4, 0.5);
        run(w, 64);
        CHECK(((*w.contacts().begin()).rolling_impulse == physics::tangential<S, D>{}));
        return number(w.linear_velocity(id).x);
    };
    const material plain{.friction = S(0.6)};
    CHECK(std::abs(speeds(ground<made_of<without<rolling_resistance>>>(plain)) - 4) <= 0.01);
    CHECK(std::abs(speeds(ground<made_of<physics::soft_step, without<rolling_resistance>>>(plain)) - 4) <= 0.01);
    CHECK(std::abs(speeds(ground<made_of<without<surface_velocity>>>(plain)) - 4) <= 0.01);
    CHECK(std::abs(speeds(ground<made_of<physics::soft_step, without<surface_velocity>>>(plain)) - 4) <= 0.01);
    CHECK(std::abs(speeds(ground<made_of<physics::soft_step, without<physics::feature::friction>>>(plain)) - 4) <=
          0.01);
}

/// What a recipe leaves out takes no byte of its contacts and shapes.
template <class Features>
using contact_of = physics::solver_api::contact<S, D, Features>;
template <class Features>
using kept_by = physics::detail::stored_material<S, D, Features>;
using bare = without<physics::feature::friction, physics::feature::restitution, rolling_resistance>;
static_assert(sizeof(contact_of<bare>) + sizeof(S) * (D == 2 ? 8 : 16) == sizeof(contact_of<without<>>));
static_assert(sizeof(contact_of<without<physics::feature::restitution>>) < sizeof(contact_of<without<>>));
static_assert(sizeof(kept_by<without<>>) == sizeof(material));
static_assert(sizeof(kept_by<without<physics::feature::friction>>) == sizeof(S) * 2);
static_assert(sizeof(kept_by<without<physics::feature::restitution>>) == sizeof(material) - sizeof(S));
static_assert(std::is_empty_v<kept_by<bare>>);

/// Bytes of a block of the soft solver, and of what only some contacts have.
template <class Features, class Friction = physics::patch_friction>
using block_of = physics::detail::soft_contact<S, D, 4, Features, Friction>;
template <class Features>
using extras_of = physics::detail::soft_extras<S, 4, D, Features>;
using neither = without<rolling_resistance, surface_velocity>;
static_assert(sizeof(block_of<neither>) < sizeof(block_of<without<>>));
static_assert(sizeof(block_of<without<physics::feature::friction>>) < sizeof(block_of<without<>>));
static_assert(sizeof(block_of<without<physics::feature::restitution>>) < sizeof(block_of<without<>>));
static_assert(sizeof(extras_of<without<rolling_resistance>>) == sizeof(S) * 4 * 2 * (D - 1));
static_assert(sizeof(extras_of<without<surface_velocity>>) == sizeof(S) * 4 * (D == 2 ? 4 : 9));
static_assert(sizeof(extras_of<without<>>) ==
              sizeof(extras_of<without<rolling_resistance>>) + sizeof(extras_of<without<surface_velocity>>));
static_assert(D == 2 || sizeof(block_of<neither, physics::point_friction>) > sizeof(block_of<neither>));

}  // namespace surfaces_laws
}  // namespace
