// What moves freely, fast, far out, spinning, bouncing.
#pragma once

#include <cstdint>

#include "piles.hpp"

namespace extremes {

constexpr triple tumbling = {0.05, 0.2, 0.45};

/// F4: a free box that flips over (Dzhanibekov), for 10 s: the largest relative error of its energy, of its angular
/// momentum, and of the time when it has flipped for the third time.
template <class World, class F>
double watch_tumble(const work& with, F&& figure) {
    stage<World> s(with, {});
    solid b;
    b.half = tumbling, b.density = 10 / 0.036;
    b.spin = {0.1, 5, 0.1};
    const body_id id = s.box(b);
    return figure(s, id);
}
template <class World>
double energy_of_tumble(double, const work& with) {
    return watch_tumble<World>(with, [](auto& s, body_id id) {
        const double start = s.motion(id, tumbling);
        return s.largest(10, [&] { return std::abs(s.motion(id, tumbling) / start - 1); });
    });
}
template <class World>
double momentum_of_tumble(double, const work& with) {
    return watch_tumble<World>(with, [](auto& s, body_id id) {
        const triple start = s.angular_momentum(id, tumbling);
        return s.largest(10, [&] { return length(s.angular_momentum(id, tumbling) - start) / length(start); });
    });
}
template <class World>
double time_of_tumble(double, const work& with) {
    return watch_tumble<World>(with, [](auto& s, body_id id) {
        double before = 5;
        int flips = 0;
        for (int i = 1; i <= 600; ++i) {
            s.step();
            const double now = s.into(id, s.spin(id))[1];
            if (now * before < 0 && ++flips == 3)
                return std::abs(((i - 1) + before / (before - now)) * frame / 7.222804 - 1);
            before = now;
        }
        return infinity;
    });
}

/// X5: a free box that spins, for 10 s: how much energy it gains, and how much of its angular momentum it loses.
template <class World, class F>
double watch_spin(double speed, const work& with, F&& figure) {
    stage<World> s(with, {});
    solid b;
    b.half = tumbling, b.density = 10 / 0.036;
    b.spin = World::dimension == 2 ? triple{0, 0, speed} : triple{0.02 * speed, speed, 0.02 * speed};
    const body_id id = s.box(b);
    return figure(s, id);
}
template <class World>
double gain_of_spin(double speed, const work& with) {
    return watch_spin<World>(speed, with, [](auto& s, body_id id) {
        const double start = s.motion(id, tumbling);
        return s.largest(10, [&] { return s.motion(id, tumbling) / start - 1; });
    });
}
template <class World>
double loss_of_spin(double speed, const work& with) {
    return watch_spin<World>(speed, with, [](auto& s, body_id id) {
        const double start = length(s.angular_momentum(id, tumbling));
        return s.largest(10, [&] { return 1 - length(s.angular_momentum(id, tumbling)) / start; });
    });
}

/// X3: how far a pyramid's cubes, so far out, get from where they get at the origin (m).
template <class World>
double unlike_of_far(double distance, const work& with) {
    const auto play = [&](double x) {
        stage<World> s(with);
        lay_pyramid(s, 10, {x, 0, 0});
        std::vector<triple> places;
        for (int i = 0; i < 300; ++i) {
            s.step();
            if (i % 30 == 29)
                for (const body_id id : s.bodies) places.push_back(s.place(id) - triple{x, 0, 0});
        }
        return places;
    };
    const std::vector<triple> near_by = play(0), far = play(distance);
    double most = 0;
    for (std::size_t i = 0; i < near_by.size(); ++i) most = worse(length(near_by[i] - far[i]), most);
    return most;
}
/// The relative error of the way that a cube drifts in 10 s at 0.1 m/s.
template <class World>
double error_of_drift(double distance, const work& with) {
    stage<World> s(with, {});
    solid b;
    b.at = {distance, 0, 0}, b.velocity = {0.1, 0, 0};
    const body_id id = s.box(b);
    for (int i = 0; i < 600; ++i) s.step();
    return std::abs((s.place(id)[0] - distance) / 1 - 1);
}

/// X1: how many of 48 shots go wrong at walls of 0.1, 0.01 and 0.001 m, in 16 phases of a step: they pass, or never
/// come near.
template <class World>
double shots(const work& with, double speed, bool is_static, bool rod) {
    int wrong = 0;
    for (const double thickness : {0.1, 0.01, 0.001})
        for (int phase = 0; phase < 16; ++phase) {
            stage<World> s(with, {});
            solid wall;
            wall.half = {thickness / 2, 60, 60};
            wall.density = 0.125;
            if (is_static) wall.type = body_type::static_body;
            const body_id target = s.box(wall);
            solid shot;
            const double reach = rod ? 2 : 0.1;
            shot.at = {-reach - 0.9 - speed * frame * (phase + 0.25) / 16, 0.25, 0};
            shot.velocity = {speed, 0, 0};
            shot.continuous = !is_static;
            if (rod) shot.spin = {0, 0, 100}, shot.angle = 0.4 * phase, shot.half = {2, 0.02, 0.02};
            else shot.half[0] = reach;
            const body_id id = rod ? s.box(shot) : s.ball(shot);
            const auto side = [&] { return s.into(target, s.place(id) - s.place(target))[0]; };
            double nearest = infinity;
            for (int i = 0; i < 16 + 60 * 4 / speed; ++i) {
                s.step();
                nearest = std::fmin(nearest, std::abs(side()));
            }
            wrong += !(side() < 0) || !(nearest < reach + 0.2);
        }
    return wrong;
}
template <class World>
double balls_at_walls(double speed, const work& with) {
    return shots<World>(with, speed, true, false);
}
template <class World>
double bullets_at_movable(double speed, const work& with) {
    return shots<World>(with, speed, false, false);
}
template <class World>
double rods_at_walls(double speed, const work& with) {
    return shots<World>(with, speed, true, true);
}

/// C2: a ball that falls by 5 m and bounces for 20 s without loss: by how much it ever rises above 5 m, as a share.
template <class World, class F>
double watch_bounce(const work& with, F&& figure) {
    stage<World> s(with);
    s.floor(0, 1);
    solid b;
    b.at = {0, 5.1, 0}, b.half = {0.1, 0.1, 0.1};
    b.friction = 0, b.restitution = 1;
    const body_id id = s.ball(b);
    return figure(s, [&s, id] { return s.place(id)[1] - 0.1; });
}
template <class World>
double gain_of_bounce(double, const work& with) {
    return watch_bounce<World>(with,
                               [](auto& s, auto&& height) { return s.largest(20, [&] { return height() / 5 - 1; }); });
}
/// How much lower it rises between 15 and 20 s than it began, as a share.
template <class World>
double loss_of_bounce(double, const work& with) {
    return watch_bounce<World>(with, [](auto& s, auto&& height) {
        double top = 0;
        for (int i = 0; i < 1200; ++i) {
            s.step();
            if (i >= 900) top = worse(height(), top);
        }
        return std::fmax(0, 1 - top / 5);
    });
}
/// X8: ten cubes without friction that bounce between walls without loss, for so many seconds: by how much
/// their energy is ever above that of the start, and below it at the end, as a share.
template <class World, class F>
double watch_elastic(const work& with, F&& figure) {
    stage<World> s(with);
    s.floor(0, 1);
    for (int side = 0; side < (World::dimension == 2 ? 2 : 4); ++side) {
        solid wall;
        wall.type = body_type::static_body;
        wall.friction = 0, wall.restitution = 1;
        wall.at = {0, 10, 0}, wall.half = {10, 10, 10};
        wall.at[side < 2 ? 0 : 2] = side % 2 ? 15 : -15;
        s.box(wall);
    }
    const std::size_t first = s.bodies.size();
    for (int row = 0; row < 4; ++row)
        for (int i = 0; i < 4 - row; ++i) {
            solid b;
            b.at = {1.5 * (i - 0.5 * (3 - row)), 1 + 1.5 * row, 0};
            b.friction = 0, b.restitution = 1;
            s.box(b);
        }
    const auto energy = [&s, first] {
        double sum = 0;
        for (std::size_t i = first; i < s.bodies.size(); ++i) sum += s.energy(s.bodies[i], {0.5, 0.5, 0.5});
        return sum;
    };
    return figure(s, energy);
}
template <class World>
double gain_of_elastic(double seconds, const work& with) {
    return watch_elastic<World>(with, [seconds](auto& s, auto& energy) {
        const double start = energy();
        // What bounces between two frames is not where its speed says; a gain lasts.
        std::array<double, 12> last{};
        std::size_t next = 0;
        return s.largest(seconds, [&] {
            last[next++ % last.size()] = energy() / start - 1;
            double least = infinity;
            for (const double gain : last) least = gain < least ? gain : least;
            return least < infinity ? least : infinity;
        });
    });
}
template <class World>
double loss_of_elastic(double seconds, const work& with) {
    return watch_elastic<World>(with, [seconds](auto& s, auto& energy) {
        const double start = energy();
        for (int i = 0; i < seconds / frame; ++i) s.step();
        return worse(0, 1 - energy() / start);
    });
}
/// X8: a cube that is thrown along a floor of high friction: by how much its energy is ever above that of the start.
template <class World>
double gain_of_grip(double friction, const work& with) {
    stage<World> s(with);
    s.floor(friction);
    solid b;
    b.at = {0, 0.6, 0}, b.velocity = {5, 0, 0};
    b.friction = friction;
    const body_id id = s.box(b);
    const auto energy = [&] { return s.energy(id, b.half); };
    const double start = energy();
    return s.largest(10, [&] { return energy() / start - 1; });
}

/// Slabs of 1 m, so many times thinner, that fall by 1 m onto a floor, spinning, at 12 angles: by how much the energy
/// of any is ever above that of the start, as a share.
template <class World>
double gain_of_thin(double thin, const work& with) {
    double most = 0;
    for (int k = 0; k < 12; ++k) {
        stage<World> s(with);
        s.floor(0.5);
        solid b;
        b.at = {0, 1, 0}, b.half = {0.5, 0.5 / thin, 0.5};
        b.density = 1 / (8 * b.half[0] * b.half[1] * (World::dimension == 2 ? 0.5 : b.half[2]));
        b.friction = 0.5, b.angle = 0.05 + 0.13 * k;
        b.spin = {0.3 * (1 + k % 4), 0.2, World::dimension == 2 ? 0.5 * (1 + k % 4) : 0};
        const body_id id = s.box(b);
        const auto energy = [&] { return s.energy(id, b.half); };
        const double start = energy();
        most = worse(s.largest(4, [&] { return energy() / start - 1; }), most);
    }
    return most;
}
/// A slab that spins about the vertical on an edge, tilted by a bit: the same.
template <class World>
double gain_on_edge(double thin, const work& with) {
    double most = 0;
    for (int k = 0; k < 6; ++k) {
        stage<World> s(with);
        s.floor(0.5);
        solid b;
        b.at = {0, 0.55, 0}, b.half = {0.5, 0.5 / thin, 0.5};
        b.density = thin;
        b.friction = 0.5, b.angle = pi / 2 - 0.02 * k;
        b.spin = {0, 20, 0};
        const body_id id = s.box(b);
        const auto energy = [&] { return s.energy(id, b.half); };
        const double start = energy();
        most = worse(s.largest(6, [&] { return energy() / start - 1; }), most);
    }
    return most;
}

}  // namespace extremes
