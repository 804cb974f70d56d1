// 3D crates: 400 of them in walls, into which a heavy ball rolls every two seconds.
#include "game.hpp"

using namespace physics::feature;
struct tailored : physics::recipe<float, 3, physics::shapes<physics::box, physics::ball>,
                                  physics::without<restitution, rolling_resistance, surface_velocity, materials>> {};
using world = physics::world<games::chosen<float, 3, tailored>>;

int main(int, char** words) {
    const auto make = [] {
        world w{{.gravity = {0, -10, 0}}};
        const auto ground = w.create_body({.type = physics::body_type::static_body, .position = {0, -1, 0}});
        static_cast<void>(w.create_shape(ground, world::box{{60, 1, 60}}));
        for (int i = 0; i < 400; ++i) {
            const auto b = w.create_body(
                {.position = {1.02f * static_cast<float>(i % 10) - 5, 0.5f + static_cast<float>(i / 10 % 8),
                              4 * static_cast<float>(i / 80) - 8}});
            static_cast<void>(w.create_shape(b, world::box{{0.5f, 0.5f, 0.5f}}));
        }
        return w;
    };
    return games::play<world>(600, std::atoi(words[1]), make, [](world& w, int frame) {
        if (frame % 120 != 60) return;
        const auto b = w.create_body(
            {.position = {static_cast<float>(frame / 120) - 2, 1.5f, -20}, .linear_velocity = {0, 0, 20}});
        static_cast<void>(w.create_shape(b, world::ball{1}, {.density = 10}));
    });
}
