// Laws of steps of changing length: what rests stays at rest, whatever sequence of steps it is given.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "world_cell.hpp"

namespace {
namespace step_lengths_laws {

constexpr double usual = 1.0 / 60;

struct one_by_one : physics::recipe<S, cell::dimension, physics::sequential_impulse> {};

/// A tower of crates, and beside it a crate that bears a wide one, at rest after two seconds.
template <class World>
struct resting {
    World world;
    std::vector<body_id> bodies;
    std::vector<vec> start;

    explicit resting(int height, int substeps = 4) : world(settings(substeps)) {
        world.create_shape(world.create_body({.type = body_type::static_body}), typename World::halfspace{});
        for (int i = 0; i < height; ++i) add(at(0, i + 0.5), vec::filled(S(0.5)));
        vec wide = vec::filled(S(0.5));
        wide.x = S(1.5);
        add(at(6, 0.5), vec::filled(S(0.5)));
        add(at(6, 1.5), wide);
        for (int i = 0; i < 120; ++i) world.step(S(usual));
        for (const body_id id : bodies) start.push_back(world.position(id));
    }
    static typename World::settings_type settings(int substeps) {
        typename World::settings_type s;
        s.sleeping.enabled = false;
        s.solver.substeps = substeps;
        return s;
    }
    void add(vec position, vec half) {
        bodies.push_back(world.create_body({.position = position}));
        world.create_shape(bodies.back(), typename World::box{half});
    }
    /// How far the farthest is from where it rested (m), and how fast the fastest (m/s).
    double moved() const {
        double most = 0;
        for (std::size_t i = 0; i < bodies.size(); ++i)
            most = std::fmax(most, gap(world.position(bodies[i]), start[i]));
        return most;
    }
    double speed() const {
        double most = 0;
        for (const body_id id : bodies) most = std::fmax(most, gap(world.linear_velocity(id), vec{}));
        return most;
    }
};

/// Steps by each length in turn, then a second of usual ones. On the way nothing may leave its place by more than
/// that (m), and at the end by a millimetre.
template <class World>
void stays(const std::vector<double>& lengths, double on_the_way, int substeps = 4) {
    resting<World> tower(8, substeps);
    double most = 0;
    for (const double length : lengths) {
        tower.world.step(S(length));
        most = std::fmax(most, tower.moved());
    }
    for (int i = 0; i < 60; ++i) {
        tower.world.step(S(usual));
        most = std::fmax(most, tower.moved());
    }
    CHECK(most <= on_the_way);
    CHECK(tower.moved() <= 1e-3);
    CHECK(tower.speed() <= 3e-3);
}
template <class World>
void stays_whatever() {
    for (const double odd : {4e-3, 1e-3, 1e-4, 1e-6}) {
        CAPTURE(odd);
        stays<World>({odd}, 1e-3);
    }
    // In turns, and in short steps that last: there contacts become stiffer, and lift what they bear.
    std::vector<double> alternating, many;
    for (int i = 0; i < 60; ++i) alternating.push_back(i % 2 ? 1e-6 : usual);
    for (int i = 0; i < 60; ++i) many.push_back(i < 30 ? 4e-3 : usual);
    stays<World>(alternating, 1e-3);
    stays<World>(many, 8e-3);
    // A step of 1/15 s lets soft contacts sink in, and takes them back.
    for (const int substeps : {4, 16}) stays<World>({1e-5, 1.0 / 15}, 0.02, substeps);
    cell::dice dice(30);
    std::vector<double> frames, any, jitter, hitch(100, 1e-3);
    for (int i = 0; i < 100; ++i) {
        frames.push_back(5e-5 * std::pow(600, dice.number(0, 1)));
        any.push_back(1e-6 * std::pow(1e6 / 15, dice.number(0, 1)));
        jitter.push_back(i % 20 == 0 ? 1e-6 : usual * dice.number(0.9, 1.1));
    }
    hitch.push_back(1.0 / 15);
    stays<World>(frames, 0.01);
    stays<World>(any, 0.04);
    stays<World>(jitter, 2e-3);
    stays<World>(hitch, 0.02);
}

CELL_CASE("step lengths: what rests stays within a millimetre of its place, whatever the sequence of steps") {
    stays_whatever<world>();
}
CELL_CASE("step lengths: so it does where contacts are solved one by one") {
    stays_whatever<physics::world<one_by_one>>();
}

/// Crates that begin in one another, or fall, in steps of which the first or every third is short.
template <class World>
void throws_nothing() {
    for (const double odd : {1e-3, 1e-4, 1e-6}) {
        CAPTURE(odd);
        World w(resting<World>::settings(4));
        w.create_shape(w.create_body({.type = body_type::static_body}), typename World::halfspace{});
        std::vector<body_id> crates;
        for (int i = 0; i < 5; ++i) {
            crates.push_back(w.create_body({.position = at(0, 0.99 * (i + 0.5) + (i == 4 ? 3 : 0))}));
            w.create_shape(crates.back(), typename World::box{vec::filled(S(0.5))});
        }
        double up = 0;
        for (int i = 0; i < 240; ++i) {
            w.step(S(i % 3 ? usual : odd));
            for (const body_id id : crates) up = std::fmax(up, number(w.linear_velocity(id).y));
        }
        CHECK(up <= 7);
        CHECK(std::abs(number(w.position(crates.back()).y) - 4.5) <= 0.06);
    }
}
CELL_CASE("step lengths: neither overlaps nor impacts of short steps throw anything in longer ones") {
    throws_nothing<world>();
    throws_nothing<physics::world<one_by_one>>();
}

}  // namespace step_lengths_laws
}  // namespace
