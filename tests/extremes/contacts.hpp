// What hardly moves: friction at its edge, short steps, slow movers that must not fall asleep, and what must.
#pragma once

#include "flights.hpp"

namespace extremes {

/// A block on a slope of 20 degrees, seen along it.
template <class World>
body_id lay_on_slope(stage<World>& s, double friction) {
    s.floor(friction);
    solid b;
    b.at = {0, 0.25, 0}, b.half = {0.5, 0.25, 0.5};
    b.friction = friction;
    return s.box(b);
}
constexpr double slope = pi / 9;
inline triple along_slope() { return {10 * std::sin(slope), -10 * std::cos(slope), 0}; }

/// S2: how far it gets in 10 s where friction is so many times what it needs (m).
template <class World>
double creep(double share, const work& with) {
    stage<World> s(with, along_slope());
    const body_id id = lay_on_slope(s, share * std::tan(slope));
    return s.largest(10, [&] { return length(s.place(id) - triple{0, 0.25, 0}); });
}
/// The relative error of its way in 2 s where friction is a part of what it needs.
template <class World>
double error_of_slip(double share, const work& with) {
    stage<World> s(with, along_slope());
    const body_id id = lay_on_slope(s, share * std::tan(slope));
    for (int i = 0; i < 120; ++i) s.step();
    return std::abs(s.place(id)[0] / (5 * std::sin(slope) * (1 - share) * 4) - 1);
}
/// The relative error of the friction with which it begins to slip, which is by more than 0.1 m in 5 s.
template <class World>
double error_of_slope(double, const work& with) {
    double slips = 0.8, holds = 1.2;
    for (int i = 0; i < 9; ++i) {
        const double share = (slips + holds) / 2;
        stage<World> s(with, along_slope());
        const body_id id = lay_on_slope(s, share * std::tan(slope));
        for (int k = 0; k < 300; ++k) s.step();
        (s.place(id)[0] > 0.1 ? slips : holds) = share;
    }
    return std::abs((slips + holds) / 2 - 1);
}

/// X6: the relative error of the way that a ball falls in 20,000 steps of 1 us, so high up (m).
template <class World>
double error_of_short_fall(double height, const work& with) {
    stage<World> s(with);
    solid b;
    b.at = {0, height, 0};
    const body_id id = s.ball(b);
    const double from = s.place(id)[1];
    for (int i = 0; i < 20000; ++i) s.step(1e-6);
    return std::abs((from - s.place(id)[1]) / (5 * 0.02 * 0.02) - 1);
}

/// A world in which bodies may fall asleep.
template <class World>
stage<World> bedroom(const work& with, const triple& gravity = {0, -10, 0}) {
    auto settings = stage<World>::settings_for(with, gravity);
    settings.sleeping.enabled = true;
    settings.solver.restitution_threshold = typename World::scalar(0.5);
    return stage<World>(settings);
}
/// The relative error of the way in 20 s at so many m/s: of a box on a belt, of a ball that rolls, of a box that
/// drifts.
template <class World>
double error_on_belt(double speed, const work& with) {
    stage<World> s = bedroom<World>(with);
    solid belt;
    belt.at = {0, -1, 0}, belt.half = {100, 1, 100};
    belt.belt = speed, belt.type = body_type::static_body;
    s.box(belt);
    const body_id id = s.cube({0, 0.5, 0});
    for (int i = 0; i < 1200; ++i) s.step();
    return std::abs(s.place(id)[0] / (20 * speed) - 1);
}
template <class World>
double error_of_roll(double speed, const work& with) {
    stage<World> s = bedroom<World>(with);
    s.floor();
    solid b;
    b.at = {0, 0.5, 0}, b.velocity = {speed, 0, 0};
    b.spin = {0, 0, -speed / 0.5};
    const body_id id = s.ball(b);
    for (int i = 0; i < 1200; ++i) s.step();
    return std::abs(s.place(id)[0] / (20 * speed) - 1);
}
template <class World>
double error_of_slow_drift(double speed, const work& with) {
    stage<World> s = bedroom<World>(with, {});
    solid b;
    b.velocity = {speed, 0, 0};
    const body_id id = s.box(b);
    for (int i = 0; i < 1200; ++i) s.step();
    return std::abs(s.place(id)[0] / (20 * speed) - 1);
}

/// After how many seconds all sleep (at most 60).
template <class World>
double until_asleep(stage<World>& s) {
    for (int i = 1; i <= 3600; ++i) {
        s.step();
        if (s.world.awake_count() == 0) return i * frame;
    }
    return infinity;
}
template <class World>
double sleep_of_stack(double height, const work& with) {
    stage<World> s = bedroom<World>(with);
    drop_stack(s, static_cast<int>(height));
    return until_asleep(s);
}
template <class World>
double sleep_of_pyramid(double base, const work& with) {
    stage<World> s = bedroom<World>(with);
    lay_pyramid(s, static_cast<int>(base));
    return until_asleep(s);
}
template <class World>
double sleep_under_heavy(double ratio, const work& with) {
    stage<World> s = bedroom<World>(with);
    s.floor();
    s.cube({0, 0.5, 0});
    s.cube({0, 1.5, 0}, ratio);
    return until_asleep(s);
}
template <class World>
double sleep_on_slope(double share, const work& with) {
    stage<World> s = bedroom<World>(with, along_slope());
    lay_on_slope(s, share * std::tan(slope));
    return until_asleep(s);
}
/// X3: by how many steps a pyramid, so far out, falls asleep earlier or later than at the origin.
template <class World>
double unlike_sleep_of_far(double distance, const work& with) {
    const auto asleep = [&](double x) {
        stage<World> s = bedroom<World>(with);
        lay_pyramid(s, 5, {x, 0, 0});
        return until_asleep(s) / frame;
    };
    return std::abs(asleep(distance) - asleep(0));
}

}  // namespace extremes
