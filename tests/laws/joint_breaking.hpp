// Laws of nets of joints under load: what breaks leaves them bent, and they bear no more than what hits them can give;
// taut ones of light bodies bear heavy ones.
#pragma once

#include "joint_cell.hpp"

namespace {
namespace joint_breaking_laws {

using namespace joint_laws;
using weld_joint = physics::weld_joint<S, D>;
using plain = physics::world<joined<>>;
using split = physics::world<joined<physics::sequential_impulse>>;

/// A wall of bricks of 0.5 m, each welded to those beside it and below it: rows of `columns` of them, along the last
/// axis in 3D.
template <class World>
std::vector<body_id> add_wall(World& w, int rows, int columns, double strength) {
    std::vector<body_id> all;
    const vec across = D == 2 ? at(0.5) : at(0, 0, 0.5);
    for (int row = 0; row < rows; ++row)
        for (int i = 0; i < columns; ++i) {
            const vec where = at(3, 0.25 + 0.5 * row) + across * S(i - (columns - 1) / 2.0);
            all.push_back(w.create_body({.position = where}));
            vec half = vec::filled(S(0.25));
            if constexpr (D == 3) half[0] = S(0.2);
            w.create_shape(all.back(), typename World::box{half}, {.density = S(D == 2 ? 16 : 40)});
            const std::size_t last = all.size() - 1;
            const auto weld = [&](std::size_t to) {
                w.create_joint_at(all[to], all[last], w.pose(all[to]), weld_joint{},
                                  {.collide_connected = true, .break_force = strength, .break_torque = strength / 4});
            };
            if (i > 0) weld(last - 1);
            if (row > 0) weld(last - static_cast<std::size_t>(columns));
        }
    return all;
}

/// A wall of 50 welds and more, that a ball of 83 kg at 11 m/s breaks to pieces.
template <class World>
void no_weld_gives_more_than_the_ball(int rate, int substeps) {
    CAPTURE(rate);
    CAPTURE(substeps);
    World w = falling<World>(substeps);
    w.create_shape(add_anchor(w, at(0)), typename World::halfspace{});
    const auto bricks = add_wall(w, 8, 4, 2000);
    const body_id ball = add_ball(w, at(D == 2 ? 0.8 : 1.5, 1.5), 0.6);
    w.create_shape(ball, typename World::ball{S(0.6)}, {.density = S(82 / (D == 2 ? 1.131 : 0.9048))});
    w.set_linear_velocity(ball, at(11));
    const double momentum = number(w.mass(ball).mass) * 11;
    double largest = 0, fastest = 0;
    int broken = 0;
    for (int i = 0; i < rate; ++i) {
        w.step(S(1.0 / rate));
        for (const auto& one : w.broken_joints()) {
            largest = std::max(largest, length_of(one.reaction.force));
            ++broken;
        }
        for (const physics::joint_id j : w.joints())
            if (w.joint_enabled(j)) largest = std::max(largest, length_of(w.reaction(j).force));
        for (const body_id b : bricks) fastest = std::max(fastest, length_of(w.linear_velocity(b)));
    }
    CHECK(broken >= 4);
    CHECK(largest < momentum * rate);
    CHECK(fastest < 22);
}
CELL_CASE("joint breaking: no weld of a wall gives more than what hits it") {
    for (const int rate : {30, 60, 120, 240})
        for (const int substeps : {1, 2, 4, 8, 16}) no_weld_gives_more_than_the_ball<plain>(rate, substeps);
    no_weld_gives_more_than_the_ball<split>(60, 4);
}

/// A taut net of 5 x 5 balls of 10 g, held at its corners, that bears another of so many kg in its middle: how far its
/// joints are apart at most in three seconds, in one at many substeps a second (m). In 2D a rope of nine.
template <class World>
double opening_of_net(double heavy, int rate, int substeps) {
    using ball_joint = physics::ball_joint<S, D>;
    World w = falling<World>(substeps);
    const int rows = D == 2 ? 1 : 5, columns = D == 2 ? 9 : 5;
    std::vector<body_id> all;
    struct link {
        std::size_t a, b;
        vec half;
    };
    std::vector<link> links;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const vec where = at(0.25 * x, 0, 0.25 * y);
            const bool is_corner = (x == 0 || x == columns - 1) && (y == 0 || y == rows - 1),
                       is_middle = x == columns / 2 && y == rows / 2;
            all.push_back(is_corner ? add_anchor(w, where) : add_ball(w, where, 0.05));
            if (!is_corner) {
                auto mass = w.mass(all.back());
                const S factor = S(is_middle ? heavy : 0.01);
                mass.mass = mass.mass * factor;
                mass.inertia = mass.inertia * factor;
                w.set_mass(all.back(), mass);
                w.set_can_sleep(all.back(), false);
            }
            const std::size_t last = all.size() - 1;
            const auto join = [&](std::size_t to) {
                const vec half = (w.position(all[last]) - w.position(all[to])) * S(0.5);
                links.push_back({to, last, half});
                w.create_joint(all[to], all[last], ball_joint{half, -half});
            };
            if (x > 0) join(last - 1);
            if (y > 0) join(last - static_cast<std::size_t>(columns));
        }
    double worst = 0;
    for (int i = 0; i < (rate * substeps > 1000 ? rate : 3 * rate); ++i) {
        w.step(S(1.0 / rate));
        for (const link& l : links) {
            const auto a = w.pose(all[l.a]), b = w.pose(all[l.b]);
            worst = std::max(worst, length_of((a.position + a.rotation * l.half) - (b.position - b.rotation * l.half)));
        }
    }
    return worst;
}
CELL_CASE("joint breaking: a taut net of light bodies bears heavy ones") {
    for (const double heavy : {0.01, 1.0, 100.0})
        for (const int rate : {30, 60, 240})
            for (const int substeps : {4, 16}) {
                // A rope under 10,000 times its links opens at substeps of 1/240 s.
                if (D == 2 && heavy > 50 && rate * substeps <= 240) continue;
                CAPTURE(heavy);
                CAPTURE(rate);
                CAPTURE(substeps);
                CHECK(opening_of_net<plain>(heavy, rate, substeps) < 0.003);
            }
}

}  // namespace joint_breaking_laws
}  // namespace
