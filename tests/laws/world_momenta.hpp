// What bodies give each other in fixed point, where impulses may leave the range: as in double, or refused.
#pragma once

#include <cmath>
#include <string>

#include "world_limits.hpp"

namespace {

/// Two bodies that touch, of any masses, and one's velocity; without another one the ground.
struct meeting {
    double mass, other_mass;
    bool is_ball, turns;
    double size;
    double velocity[3];
    double restitution;
};
template <class World>
struct met {
    World w;
    body_id body, other;

    explicit met(const meeting& of) {
        using T = typename World::scalar;
        const auto at = [](double x, double y, double z) {
            typename World::vec v;
            v[0] = T(x), v[1] = T(y);
            if constexpr (cell::is_3d) v[2] = T(z);
            return v;
        };
        other = w.create_body(
            {.type = of.other_mass > 0 ? physics::body_type::dynamic_body : physics::body_type::static_body,
             .position = at(0.25, -of.size, 0)});
        body = w.create_body({.position = at(0, of.size * 1.001, 0),
                              .linear_velocity = at(of.velocity[0], of.velocity[1], of.velocity[2]),
                              .rotation_locked = !of.turns});
        const auto add = [&](body_id to, double mass, bool is_ball) {
            const auto box = World::vec::filled(T(of.size));
            const typename World::shape_def def{.material = {.restitution = T(of.restitution)}};
            if (is_ball) w.create_shape(to, typename World::ball{T(of.size)}, def);
            else w.create_shape(to, typename World::box{box}, def);
            if (!(mass > 0)) return;
            auto m = w.mass(to);
            const double ratio = mass / static_cast<double>(m.mass);
            m.mass = T(mass);
            if constexpr (cell::is_2d) m.inertia = T(static_cast<double>(m.inertia) * ratio);
            else
                for (T* x : {&m.inertia.xx, &m.inertia.yy, &m.inertia.zz, &m.inertia.xy, &m.inertia.xz, &m.inertia.yz})
                    *x = T(static_cast<double>(*x) * ratio);
            w.set_mass(to, m);
        };
        add(other, of.other_mass, false);
        add(body, of.mass, of.is_ball);
    }
};

CELL_CASE("limits: bodies of any mass and speed meet as they would in double, or the step is refused") {
    if (!cell::is_fixed) return;
    using exact_world = physics::world<exact_scene>;
    cell::dice dice(11);
    // Four corners share a blow by rounding, and friction follows their loads.
    const double tolerance = cell::is_2d ? 0.02 : 0.06;
    int met_as_told = 0, refused = 0, out_of_reach = 0;
    for (int i = 0; i < 1500; ++i) {
        CAPTURE(i);
        meeting of{};
        of.mass = std::pow(10.0, dice.number(0, 8.5));
        of.other_mass = dice.below(2) ? 0 : of.mass * std::pow(10.0, dice.number(-1, 1));
        of.is_ball = dice.below(2) != 0;
        of.turns = dice.below(2) != 0;
        of.size = std::pow(10.0, dice.number(-1, 0.5));
        of.restitution = dice.below(2) ? 0 : dice.number(0, 1);
        const double speed = std::pow(10.0, dice.number(0, 8));
        double direction[3] = {dice.number(-1, 1), -dice.number(0, 1), cell::is_3d ? dice.number(-1, 1) : 0};
        for (int k = 0; k < 3; ++k) of.velocity[k] = speed * direction[k];
        CAPTURE(of.mass);
        CAPTURE(of.other_mass);
        CAPTURE(of.size);
        CAPTURE(speed);
        CAPTURE(of.is_ball);
        CAPTURE(of.turns);
        try {
            met<world> found(of);
            met<exact_world> twin(of);
            for (int step = 0; step < 3; ++step) {
                CAPTURE(step);
                const auto before = picture(found.w);
                try {
                    found.w.step(S(1.0 / 64));
                } catch (const physics::error& e) {
                    CHECK(std::string(e.what()).find("physics: step: a velocity, a position or an impulse is beyond") ==
                          0);
                    CHECK(picture(found.w) == before);
                    // Not of what is far below the range.
                    CHECK(of.mass * speed * std::max(1.0, of.size) > number(cell::traits::max()) / 64);
                    ++refused;
                    break;
                }
                twin.w.step(1.0 / 64);
                const auto same = [&](vec x, exact_world::vec y) {
                    for (int k = 0; k < cell::dimension; ++k)
                        REQUIRE(std::abs(number(x[k]) - y[k]) <= tolerance * std::max(speed, 1.0));
                };
                same(found.w.linear_velocity(found.body), twin.w.linear_velocity(twin.body));
                same(found.w.linear_velocity(found.other), twin.w.linear_velocity(twin.other));
                double load = 0, expected = 0;
                for (const auto c : found.w.contacts()) {
                    for (int k = 0; k < c.count; ++k) REQUIRE(c.points[k].normal_impulse >= S(0));
                    load += number(c.normal_impulse());
                }
                for (const auto c : twin.w.contacts()) expected += static_cast<double>(c.normal_impulse());
                REQUIRE(std::abs(load - expected) <= tolerance * std::max(expected, of.mass * speed));
            }
            ++met_as_told;
        } catch (const physics::error&) {
            ++out_of_reach;
        }
    }
    CAPTURE(met_as_told);
    CHECK(refused > 200);
    CHECK(met_as_told - refused > 500);
    CHECK(out_of_reach < 300);
}

}  // namespace
