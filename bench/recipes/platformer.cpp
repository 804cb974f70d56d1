// A 2D platformer: a level of tiles, 60 crates and 20 runners that jump; runners and crates keep upright.
#include <vector>

#include "game.hpp"

using namespace physics::feature;
struct tailored : physics::recipe<float, 2, physics::shapes<physics::box, physics::capsule, physics::tile_grid>,
                                  physics::without<rotation, restitution, rolling_resistance, surface_velocity>> {};
using world = physics::world<games::chosen<float, 2, tailored>>;

int main(int, char** words) {
    std::vector<std::uint8_t> cells(128 * 16);
    for (std::size_t x = 0; x < 128; ++x)
        for (std::size_t y = 0; y < 16; ++y)
            cells[y * 128 + x] = y == 0 || x == 0 || x == 127 || (y == 4 && x % 16 > 8) || (y == 1 && x % 32 == 5);
    const auto level = world::tile_grid_geometry::build(cells.data(), 128, 16, 1);
    std::vector<physics::body_id> runners;
    const auto make = [&] {
        world w{{.gravity = {0, -20}}};
        const auto ground = w.create_body({.type = physics::body_type::static_body});
        static_cast<void>(w.create_shape(ground, level.shape()));
        for (int i = 0; i < 60; ++i) {
            const auto b = w.create_body(games::upright<world>({3 + 2 * static_cast<float>(i), 7}));
            static_cast<void>(w.create_shape(b, world::box{{0.4f, 0.4f}}));
        }
        runners.clear();
        for (int i = 0; i < 20; ++i) {
            runners.push_back(w.create_body(games::upright<world>({4 + 6 * static_cast<float>(i), 10})));
            static_cast<void>(w.create_shape(runners.back(), world::box{{0.3f, 0.6f}}, {.material = {.friction = 0}}));
        }
        return w;
    };
    return games::play<world>(600, std::atoi(words[1]), make, [&](world& w, int frame) {
        for (std::size_t i = 0; i < runners.size(); ++i) {
            const bool jumps = (static_cast<std::size_t>(frame) + 7 * i) % 60 == 0;
            const float speed = (static_cast<std::size_t>(frame) / 240 + i) % 2 == 0 ? 5.0f : -5.0f;
            w.set_linear_velocity(runners[i], {speed, jumps ? 11 : w.linear_velocity(runners[i]).y});
        }
    });
}
