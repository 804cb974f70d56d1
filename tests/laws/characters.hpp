// Laws of characters: what one does on grounds, steps, slopes, gaps, lifts and among bodies, at several rates.
#pragma once

#include <algorithm>
#include <vector>

#include "refusal.hpp"
#include "world_cell.hpp"

namespace {
namespace characters_laws {

using hero = physics::character<world>;
constexpr int D = cell::dimension;

/// Boxes on one static body; 10 m/s^2.
struct level {
    world w{world::settings_type{.gravity = along(1, -10)}};
    body_id fixed = w.create_body({.type = body_type::static_body});
    int rate;

    explicit level(int steps_a_second = 60) : rate(steps_a_second) {}
    S dt() const { return S(1.0 / rate); }
    static vec half(double x, double y) {
        vec v = vec::filled(S(5));
        v.x = S(x);
        v.y = S(y);
        return v;
    }
    void floor() { w.create_shape(fixed, world::halfspace{}); }
    void box(double x, double y, double half_x, double half_y, double angle = 0) {
        w.create_shape(fixed, world::box{half(half_x, half_y)},
                       {.position = at(x, y), .rotation = turned_about_z(angle)});
    }
    static hero make(double x, double y) {
        return hero(world::capsule::upright(S(1.8), S(0.3)), at(x, y), along(1, 1));
    }
    /// Moves for some seconds, and steps before each move.
    template <class Each>
    void run(hero& h, double seconds, vec walk, Each&& each) {
        for (int i = 0; i < seconds * rate; ++i) {
            w.step(dt());
            h.move(w, walk, dt());
            each();
        }
    }
    void run(hero& h, double seconds, vec walk) {
        run(h, seconds, walk, [] {});
    }
};
double x_of(const hero& h) { return number(h.feet().x); }
double y_of(const hero& h) { return number(h.feet().y); }
template <class F>
void at_rates(F&& f) {
    for (const int rate : {60, 240}) {
        CAPTURE(rate);
        f(rate);
    }
}

CELL_CASE("characters: one stands for ten seconds where it is, to a tenth of a millimetre") {
    at_rates([](int rate) {
        level l(rate);
        l.box(0, -0.5, 5, 0.5);
        hero h = level::make(0.25, 0);
        l.run(h, 0.1, {});
        const double x = x_of(h);
        l.run(h, 10, {}, [&] {
            CHECK(std::abs(y_of(h)) < 1e-4);
            CHECK(x_of(h) == x);
            CHECK(h.ground().body == l.fixed);
            CHECK(h.velocity() == vec{});
        });
    });
}
CELL_CASE("characters: stairs are climbed and descended at the speed of walking, grounded all the time") {
    at_rates([](int rate) {
        level l(rate);
        l.floor();
        for (int i = 0; i < 10; ++i) l.box(2 + 0.3 * i + 5, 0.15 + 0.3 * i - 2.35, 5, 2.5);
        hero h = level::make(1, 0);
        l.run(h, 0.2, {});
        const auto steps_to = [&](double walk, auto&& is_there) {
            int steps = 0;
            for (; !is_there() && steps < 5 * rate; ++steps) {
                h.move(l.w, at(walk, 0), l.dt());
                CHECK(h.ground());
            }
            return double(steps) / rate;
        };
        CHECK(steps_to(4, [&] { return x_of(h) > 4.7; }) < 3.7 / 4 * 1.15);
        CHECK(y_of(h) > 2.8);
        l.run(h, 0.25, at(4, 0));
        const double from = x_of(h), took = steps_to(-4, [&] { return x_of(h) < 1; });
        CHECK(std::abs(took - (from - 1) / 4) < 0.05);
        CHECK(std::abs(y_of(h)) < 1e-3);
    });
}
CELL_CASE("characters: steps up to the height are climbed, higher ones and those without a tread never") {
    at_rates([](int rate) {
        for (const double high : {0.05, 0.1, 0.2, 0.3, 0.34, 0.36})
            for (const double depth : {0.4, 0.05}) {
                // A round foot walks over low edges, whatever is behind them.
                if (high < 0.3 && depth < 0.1) continue;
                level l(rate);
                l.floor();
                for (int i = 0; i < 6; ++i) l.box(2 + depth * i + 5, high * (i + 1) - 2.5, 5, 2.5);
                hero h = level::make(0, 0);
                double top = 0;
                // From several phases, as it comes to the step.
                l.run(h, 0.125, at(0.5, 0));
                l.run(h, 3, at(2, 0), [&] { top = std::max(top, y_of(h)); });
                if (high < 0.35 && depth > 0.1) {
                    CHECK(std::abs(top - 6 * high) < 1e-3);
                } else {
                    CHECK(std::abs(x_of(h) - 1.69) < 0.01);
                    CHECK(top < 1e-3);
                }
            }
    });
}
CELL_CASE("characters: slopes that it may stand on hold it, and are walked at one speed; steeper ones slide it down") {
    for (const double degrees : {30.0, 44.0, 45.0, 46.0, 60.0}) {
        CAPTURE(degrees);
        const double angle = degrees * 3.14159265358979 / 180;
        level l;
        l.box(5 * std::sin(angle), -5 * std::cos(angle), 60, 5, angle);
        hero h = level::make(0, 0.3 / std::cos(angle) - 0.25);
        l.run(h, 1, {});
        const vec start = h.feet();
        if (degrees < 45.5) {
            l.run(h, 10, {}, [&] { CHECK(h.ground()); });
            CHECK(gap(h.feet(), start) < 1e-3);
            for (const double way : {1.0, -1.0}) {
                const double from = x_of(h);
                l.run(h, 1, at(4 * way, 0), [&] { CHECK(h.ground()); });
                CHECK(std::abs(x_of(h) - from - 4 * way * std::cos(angle)) < 5e-3);
            }
        } else {
            const vec before = h.velocity();
            l.run(h, 1, {});
            const double gained = gap(h.velocity(), vec{}) - gap(before, vec{});
            CHECK(std::abs(gained - 10 * std::sin(angle)) < 0.1);
            level below;
            below.floor();
            below.box(5 + 5 * std::sin(angle), -5 * std::cos(angle), 60, 5, angle);
            hero other = level::make(0, 0);
            double top = 0;
            below.run(other, 3, at(4, 0), [&] { top = std::max(top, y_of(other)); });
            CHECK(top < 0.01);
            CHECK(x_of(other) > 3);
        }
    }
}
CELL_CASE("characters: gaps narrower than its foot are crossed at any speed, wider ones as fast as it must be") {
    at_rates([](int rate) {
        const auto cross_gap = [&](double wide, double speed) {
            level l(rate);
            l.box(-5, -5, 5, 5);
            l.box(wide + 5, -5, 5, 5);
            hero h = level::make(-1, 0);
            double low = 0;
            l.run(h, (wide + 2.2) / speed, at(speed, 0), [&] { low = std::min(low, y_of(h)); });
            return -low;
        };
        for (const double speed : {1.0, 4.0}) {
            CHECK(cross_gap(0.3, speed) < 0.0412);
            CHECK(cross_gap(0.5, speed) < 0.1352);
            CHECK(cross_gap(1.2, speed) > 1);
        }
        CHECK(cross_gap(0.65, 4) < 0.132);
        CHECK(cross_gap(0.65, 1) > 1);
    });
}
CELL_CASE(
    "characters: ducts that are too low stop it without a tremor, one that is higher than both skins lets it in") {
    at_rates([](int rate) {
        for (const double high : {1.75, 1.81, 1.83}) {
            level l(rate);
            l.floor();
            l.box(7, high + 1, 5, 1);
            hero h = level::make(0, 0);
            l.run(h, 2, at(2, 0));
            const vec start = h.feet();
            if (high > 1.82) CHECK(x_of(h) > 3.9);
            l.run(h, 0.5, at(2, 0), [&] { CHECK(std::abs(y_of(h)) < 1e-3); });
            if (high < 1.82) CHECK(gap(h.feet(), start) < 1e-4);
            if (high < 1.82) CHECK(x_of(h) < 2);
        }
    });
}
CELL_CASE("characters: a jump under a roof loses its rise and keeps its way, and lands") {
    at_rates([](int rate) {
        level l(rate);
        l.floor();
        l.box(0, 3.02, 50, 1);
        hero h = level::make(0, 0);
        l.run(h, 0.1, at(4, 0));
        h.jump(S(5));
        double time = 0, highest = 0;
        for (bool landed = false; !landed && time < 1; landed = static_cast<bool>(h.ground())) {
            h.move(l.w, at(4, 0), l.dt());
            time += 1.0 / rate;
            highest = std::max(highest, y_of(h));
            CHECK(std::abs(number(h.velocity().x) - 4) < 1e-3);
        }
        // There and back by the 0.2 m that are left within both skins.
        CHECK(std::abs(highest - 0.2) < 1e-3);
        CHECK(std::abs(time - 0.242) < 1.5 / rate);
        CHECK(std::abs(y_of(h)) < 1e-4);
    });
}
CELL_CASE("characters: lifts and turntables carry it exactly, and throw it when it jumps") {
    at_rates([](int rate) {
        for (const int axis : {0, 1}) {
            level l(rate);
            const body_id lift = l.w.create_body({.type = body_type::kinematic_body});
            l.w.create_shape(lift, world::box{level::half(2, 0.5)});
            hero h = level::make(0, 0.5);
            h.move(l.w, {}, l.dt());
            for (int i = 0; i < 4 * rate; ++i) {
                l.w.set_linear_velocity(lift, along(axis, i / rate % 2 ? -2 : 2));
                l.w.step(l.dt());
                h.move(l.w, {}, l.dt());
                CHECK(h.ground().body == lift);
                CHECK(gap(h.feet(), l.w.position(lift) + along(1, 0.5)) < 2e-4);
            }
            l.w.set_linear_velocity(lift, along(1, 2));
            l.w.step(l.dt());
            h.jump(S(5));
            h.move(l.w, {}, l.dt());
            CHECK(std::abs(number(h.velocity().y) - 7) < 1e-3);
            l.w.destroy_body(lift);
            h.move(l.w, {}, l.dt());
            CHECK(!h.ground());
        }
#if CELL_DIMENSION == 3
        level l(rate);
        const body_id table = l.w.create_body({.type = body_type::kinematic_body});
        l.w.create_shape(table, world::box{{S(8), S(0.5), S(8)}});
        l.w.set_angular_velocity(table, {S(0), S(3.14159265358979), S(0)});
        hero h = level::make(3, 0.5);
        h.move(l.w, {}, l.dt());
        l.run(h, 1, {}, [&] { CHECK(std::abs(gap(h.feet(), at(0, 0.5)) - 3) < 2e-4); });
        CHECK(gap(h.feet(), at(-3, 0.5)) < 1e-3);
#endif
    });
}
CELL_CASE("characters: a lift that is disabled neither carries it nor lets it jump") {
    at_rates([](int rate) {
        level l(rate);
        const body_id lift = l.w.create_body({.type = body_type::kinematic_body, .linear_velocity = along(1, 2)});
        l.w.create_shape(lift, world::box{level::half(2, 0.5)});
        hero h = level::make(0, 0.5);
        h.move(l.w, {}, l.dt());
        l.run(h, 0.5, {});
        REQUIRE(h.ground().body == lift);
        l.w.set_enabled(lift, false);
        h.jump(S(5));
        const double before = y_of(h);
        l.run(h, 0.5, {});
        CHECK(!h.ground());
        CHECK(y_of(h) - before == doctest::Approx(-1.25).epsilon(0.05));
        l.w.set_enabled(lift, true);
        CHECK(number(l.w.linear_velocity(lift).y) == 2);
    });
}
CELL_CASE("characters: crates are pushed as hard as it can, and heavy ones not at all") {
    const auto push = [](double mass, double strength) {
        level l;
        l.w.create_shape(l.fixed, world::halfspace{}, {.material = {.friction = S(0.5)}});
        const body_id crate = l.w.create_body({.position = at(1.5, 0.5)});
        l.w.create_shape(crate, world::box{vec::filled(S(0.5))},
                         {.density = S(mass), .material = {.friction = S(0.5)}});
        auto settings = physics::character_settings<S, D>{};
        settings.strength = S(strength);
        hero h = level::make(0, 0);
        h.set_settings(settings);
        l.run(h, 0.25, {});
        const double from = number(l.w.position(crate).x);
        l.run(h, 2, at(2, 0));
        return number(l.w.position(crate).x) - from;
    };
    // Less what the answer of the crate lags, by a step or two.
    CHECK(std::abs(push(5, 100) - 3.177) < 0.1);
    CHECK(std::abs(push(20, 400) - 3.177) < 0.1);
    CHECK(std::abs(push(200, 400)) < 1e-3);
    CHECK(std::abs(push(20, 90)) < 1e-3);
}
CELL_CASE("characters: tiles side by side are one floor and one wall") {
    at_rates([](int rate) {
        level l(rate);
        for (int i = 0; i < 24; ++i) l.box(i, -0.5, 0.5, 0.5);
#if CELL_DIMENSION == 3
        for (int i = 0; i < 24; ++i)
            l.w.create_shape(l.fixed, world::box{vec::filled(S(0.5))}, {.position = {S(i), S(1), S(1)}});
        const vec walk{S(4), S(0), S(2)};
#else
        const vec walk = at(4, 0);
#endif
        hero h = level::make(0, 0);
        l.run(h, 0.25, {});
        l.run(h, 5, walk, [&] {
            CHECK(std::abs(y_of(h)) < 1e-4);
            CHECK(number(h.ground().normal.y) > 0.9999);
        });
        CHECK(std::abs(x_of(h) - 20) < 2e-3);
    });
}
CELL_CASE("characters: a floor of a centimetre stops it at any speed") {
    for (const double speed : {53.0, 200.0, 1000.0}) {
        level l;
        l.box(0, -0.005, 5, 0.005);
        hero h = level::make(0, 30);
        h.set_fall_velocity(along(1, -speed));
        l.run(h, 3, {}, [&] { CHECK(y_of(h) > -1e-3); });
        CHECK(std::abs(y_of(h)) < 1e-3);
        CHECK(h.ground());
    }
}
CELL_CASE("characters: one that begins in a wall gets out at a limited speed; one that is walled in says so") {
    at_rates([](int rate) {
        for (const double deep : {0.05, 0.1, 0.25, 0.5}) {
            level l(rate);
            l.floor();
            l.box(0.5, 2, 0.5, 2);
            hero h = level::make(-0.3 + deep, 0);
            for (int i = 0; i < rate / 6; ++i) {
                const vec before = h.feet();
                h.move(l.w, {}, l.dt());
                CHECK(gap(h.feet(), before) * rate < 12.1);
            }
            CHECK(std::abs(x_of(h) + 0.31) < 1e-3);
            CHECK(std::abs(y_of(h)) < 1e-3);
            CHECK(h.velocity() == vec{});
            CHECK(!h.is_stuck());
        }
        level l(rate);
        l.box(0, 2, 2, 0.5);
        l.box(0, 0, 2, 0.5);
        hero h = level::make(0, 0.5);
        for (int i = 0; i < rate; ++i) h.move(l.w, at(4, 0), l.dt());
        CHECK(h.is_stuck());
        CHECK(std::abs(x_of(h)) < 0.5);
    });
}
#if CELL_DIMENSION == 3
CELL_CASE("characters: a wedge holds it at rest, and lets it go at once") {
    for (const double degrees : {15.0, 30.0, 60.0, 90.0}) {
        level l;
        l.floor();
        const double half = degrees * 3.14159265358979 / 360;
        for (const int side : {-1, 1})
            l.w.create_shape(l.fixed, world::box{{S(20), S(5), S(1)}},
                             {.position = {S(std::sin(half) - 20 * std::cos(half)), S(0),
                                           S(side * (20 * std::sin(half) + std::cos(half)))},
                              .rotation = world::rotation_type::from_axis_angle({S(0), S(1), S(0)}, S(side * half))});
        hero h = level::make(-6, 0);
        l.run(h, 4, {S(4), S(0), S(0.25)});
        CHECK(std::abs(-x_of(h) - 0.31 / std::sin(half)) < 5e-3);
        const vec rest = h.feet();
        l.run(h, 1, {S(4), S(0), S(0.25)}, [&] { CHECK(gap(h.feet(), rest) < 1e-3); });
        h.move(l.w, at(-4, 0), l.dt());
        CHECK(std::abs(number(rest.x) - x_of(h) - 4.0 / 60) < 1e-3);
    }
}
#endif
CELL_CASE("characters: one that drops into a valley or is thrown up a slope stands, and one that jumps there leaves") {
    for (const double angle : {0.5236, 0.7505, 0.7679})
        for (int k = -10; k <= 10; ++k)
            for (const double height : {1.0, 3.0}) {
                CAPTURE(angle);
                CAPTURE(k);
                level l;
                for (const int side : {-1, 1}) l.box(side * std::sin(angle), -std::cos(angle), 20, 1, side * angle);
                hero h = level::make(0.01 * k, height);
                l.run(h, 1.5, {});
                CHECK(h.ground());
                h.jump(S(4));
                l.run(h, 0.1, {});
                CHECK_FALSE(h.ground());
            }
    for (const double speed : {3.0, 8.0, 15.0}) {
        level l;
        l.box(std::sin(0.5236), -std::cos(0.5236), 60, 1, 0.5236);
        hero h = level::make(0, 0.3);
        h.set_fall_velocity(at(speed, -1));
        l.run(h, 0.2, {});
        CHECK(h.ground());
    }
}
#if CELL_DIMENSION == 3
CELL_CASE("characters: one that walks into a slit as wide as it is stays on the ground") {
    at_rates([](int rate) {
        for (const double width : {0.6, 0.605, 0.609, 0.615})
            for (const double speed : {2.0, 4.0, 6.0}) {
                CAPTURE(width);
                CAPTURE(speed);
                level l(rate);
                l.floor();
                for (const int side : {-1, 1})
                    l.w.create_shape(l.fixed, world::box{{S(5), S(3), S(1)}},
                                     {.position = {S(5), S(3), S(side * (1 + width / 2))}});
                hero h(world::capsule::upright(S(1.8), S(0.3)), {S(-1), S(0), S(0.004)}, along(1, 1));
                l.run(h, 3, along(0, speed), [&] {
                    CHECK(std::abs(y_of(h)) < 0.02);
                    CHECK(h.ground());
                });
            }
    });
}
#endif
template <class Rotation>
Rotation tilted(double angle) {
    if constexpr (cell::is_2d) return turned_about_z(angle);
    else return Rotation::from_axis_angle(normalized(at(1, 0.3) + along(2, 0.5)), S(angle));
}
CELL_CASE("characters: in a world that is turned as a whole one does as in an upright one") {
    using rotation = world::rotation_type;
    const auto play = [](const rotation& q) {
        std::vector<vec> seen;
        world w{world::settings_type{.gravity = q * along(1, -10)}};
        const body_id fixed = w.create_body({.type = body_type::static_body, .rotation = q});
        const auto add = [&](double x, double y, double half_x, double half_y, double angle = 0) {
            w.create_shape(fixed, world::box{level::half(half_x, half_y)},
                           {.position = at(x, y), .rotation = turned_about_z(angle)});
        };
        add(0, -1, 50, 1);
        add(4, 0.15, 1, 0.15);
        add(9, 0.25, 2, 0.25, 0.4);
        auto shape = world::capsule::upright(S(1.8), S(0.3));
        shape.rotation = q * shape.rotation;
        hero h(shape, q * at(0, 0.5), q * along(1, 1));
        const auto run = [&](int steps, double speed) {
            for (int i = 0; i < steps; ++i) {
                w.step(S(1.0 / 60));
                h.move(w, q * along(0, speed), S(1.0 / 60));
            }
            CHECK(h.ground());
            seen.push_back(inverse_rotate(q, h.feet()));
        };
        run(60, 0);
        run(50, 5);
        run(50, 3);
        h.jump(S(4));
        run(60, 1);
        return seen;
    };
    const std::vector<vec> upright = play({});
    for (int i = 1; i < 120; ++i) {
        CAPTURE(i);
        const auto q = tilted<rotation>(i * 0.0523);
        const std::vector<vec> turned = play(q);
        for (std::size_t k = 0; k < upright.size(); ++k) CHECK(length(turned[k] - upright[k]) < S(5e-3));
    }
}
CELL_CASE("characters: what falls for ever is stopped by name before it leaves the range of numbers") {
    const S most = cell::largest();
    for (const S pull : {S(10), S(1000), most * S(0.0625)}) {
        world w{world::settings_type{.gravity = along(1, -1) * pull}};
        hero h = level::make(0, 2);
        const std::string well = "not refused";
        std::string said = well;
        for (int i = 0; i < 400 && said == well; ++i) {
            const vec before = h.pose().position, speed = h.velocity();
            said = refusal([&] { h.move(w, {}, S(i < 4 ? 1 : i)); });
            REQUIRE(physics::detail::is_in_range(h.pose().position));
            REQUIRE(physics::detail::is_in_range(h.velocity()));
            if (said == well) continue;
            CHECK(h.pose().position == before);
            CHECK(h.velocity() == speed);
        }
        CAPTURE(said);
        CHECK((said == well || said.find("move: reach is ") != std::string::npos));
        CHECK((said != well || pull < most * S(0.03125)));
        const vec far = along(1, 1) * (most * S(0.75));
        CHECK((refusal([&] { h.set_feet(far); }) != well) == physics::detail::is_fixed<S>);
    }
}
CELL_CASE("characters: bad numbers are refused by name, and it stays where it is") {
    level l;
    l.floor();
    hero h = level::make(0, 0);
    l.run(h, 0.25, {});
    const vec feet = h.feet();
    refuses_number(l.w, "move", "dt", rule::positive, [&](S bad) { h.move(l.w, {}, bad); });
    refuses_number(l.w, "jump", "speed", rule::not_negative, [&](S bad) { h.jump(bad); });
    physics::character_settings<S, D> settings;
    settings.strength = S(-1);
    refuses(l.w, "set_settings", "strength", "-1", [&] { h.set_settings(settings); });
    settings.strength = S(1);
    settings.max_slope = S(1.75);
    refuses(l.w, "set_settings", "max_slope", "1.75", [&] { h.set_settings(settings); });
    settings = {};
    settings.skin = S(0);
    refuses(l.w, "character", "skin", "0",
            [&] { hero(world::capsule::upright(S(1.8), S(0.3)), {}, along(1, 1), settings); });
    refuses(l.w, "character", "length of up", "2",
            [&] { hero(world::capsule::upright(S(1.8), S(0.3)), {}, along(1, 2)); });
    CHECK(h.feet() == feet);
}

}  // namespace characters_laws
}  // namespace
