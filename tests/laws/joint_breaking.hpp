// Laws of nets of joints that break: what is left of them is bent, and bears no more than what hits it can give.
#pragma once

#include "joint_cell.hpp"

namespace {
namespace joint_breaking_laws {

using namespace joint_laws;
using weld_joint = physics::weld_joint<S, D>;
template <class... Policies>
struct walls : physics::recipe<S, D, few, physics::joints<physics::weld_joint>, Policies...> {};
using plain = physics::world<walls<>>;
using split = physics::world<walls<physics::sequential_impulse>>;

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

}  // namespace joint_breaking_laws
}  // namespace
