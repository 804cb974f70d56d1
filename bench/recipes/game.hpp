// What a unit of bench/recipes is: a typical game's scene, played by a recipe made for it, or by one that knows
// everything (if EVERYTHING is 1). It prints a line of CSV; see bench/recipes.py.
#pragma once

#include <malloc.h>

#include <cstdio>
#include <cstdlib>
#include <physics.hpp>
#include <string>

#include "../timing.hpp"

namespace games {

/// All that a recipe of a scalar and a dimension can name.
template <class S, int D>
struct everything;
template <class S>
struct everything<S, 2>
    : physics::recipe<
          S, 2,
          physics::shapes<physics::ball, physics::capsule, physics::box, physics::halfspace, physics::hull,
                          physics::segment, physics::triangle, physics::rounded_box, physics::compound,
                          physics::heightfield, physics::chain, physics::tile_grid>,
          physics::joints<physics::distance_joint, physics::ball_joint, physics::revolute_joint,
                          physics::prismatic_joint, physics::weld_joint, physics::wheel_joint, physics::target_joint,
                          physics::motor_joint, physics::six_degrees_joint, physics::gear_joint, physics::rack_joint,
                          physics::pulley_joint, physics::filter_joint>> {};
template <class S>
struct everything<S, 3>
    : physics::recipe<S, 3,
                      physics::shapes<physics::ball, physics::capsule, physics::box, physics::halfspace, physics::hull,
                                      physics::segment, physics::triangle, physics::rounded_box, physics::compound,
                                      physics::heightfield, physics::cylinder, physics::cone, physics::mesh>,
                      physics::joints<physics::distance_joint, physics::ball_joint, physics::revolute_joint,
                                      physics::prismatic_joint, physics::weld_joint, physics::wheel_joint,
                                      physics::target_joint, physics::motor_joint, physics::six_degrees_joint,
                                      physics::cone_joint, physics::swing_twist_joint, physics::gear_joint,
                                      physics::rack_joint, physics::pulley_joint, physics::filter_joint>> {};

#if EVERYTHING
template <class S, int D, class Tailored>
using chosen = everything<S, D>;
#else
template <class S, int D, class Tailored>
using chosen = Tailored;
#endif

/// A body that keeps upright, by a recipe without rotation or by being locked.
template <class World>
typename World::body_def upright(const typename World::vec& position) {
    typename World::body_def def;
    def.position = position;
    if constexpr (requires { def.rotation_locked; }) def.rotation_locked = true;
    return def;
}

inline double held_bytes() {
    const struct mallinfo2 m = mallinfo2();
    return static_cast<double>(m.uordblks + m.hblkhd);
}

/// Steps a world that has been filled, at 60 Hz, `drive(world, frame)` before each step: CPU ms a step, minimum and
/// median of the means of runs; bytes that a copy of it holds; where its bodies are in the end.
template <class World, class Make, class Drive>
int play(int frames, int runs, Make&& make, Drive&& drive) {
    using S = typename World::scalar;
    bench::samples means;
    double bytes = 0, place = 0, bodies = 0;
    for (int run = 0; run < runs; ++run) {
        World w = make();
        const bench::stopwatch clock;
        for (int i = 0; i < frames; ++i) {
            drive(w, i);
            w.step(S(1.0 / 60));
        }
        means.push_back(clock.ns() / frames / 1e6);
        if (run > 0) continue;
        const double before = held_bytes();
        const World copy = w;
        bytes = held_bytes() - before;
        for (const physics::body_id b : copy.bodies()) {
            if (copy.type(b) != physics::body_type::dynamic_body) continue;
            ++bodies;
            for (int k = 0; k < World::dimension; ++k) place += static_cast<double>(copy.position(b)[k]);
        }
    }
    std::printf("%.6g,%.6g,%.0f,%.0f,%.9g\n", bench::minimum(means), bench::median(means), bodies, bytes,
                place / bodies);
    return 0;
}

}  // namespace games
