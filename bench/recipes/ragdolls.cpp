// 24 ragdolls of eleven bodies, dropped onto each other and the ground in 3D.
#include "../../samples/scenes.hpp"
#include "game.hpp"

using namespace physics::feature;
struct tailored
    : physics::recipe<float, 3, physics::shapes<physics::box, physics::capsule, physics::ball>, scenes::joints,
                      physics::without<restitution, rolling_resistance, surface_velocity, materials>> {};
using world = physics::world<games::chosen<float, 3, tailored>>;

int main(int, char** words) {
    const auto make = [] {
        world w{{.gravity = {0, -10, 0}}};
        const auto ground = w.create_body({.type = physics::body_type::static_body, .position = {0, -1, 0}});
        static_cast<void>(w.create_shape(ground, world::box{{30, 1, 30}}));
        for (int i = 0; i < 24; ++i) {
            const world::vec feet = {1.2f * static_cast<float>(i % 4), 1 + 2.2f * static_cast<float>(i / 8),
                                     0.8f * static_cast<float>(i / 4 % 2)};
            static_cast<void>(scenes::ragdoll(w, {feet, {}}, 1000));
        }
        return w;
    };
    return games::play<world>(300, std::atoi(words[1]), make, [](world&, int) {});
}
