// 30 cars with sprung wheels on a hilly road in 2D.
#include <cmath>
#include <vector>

#include "game.hpp"

using namespace physics::feature;
struct tailored : physics::recipe<float, 2, physics::shapes<physics::box, physics::ball, physics::chain>,
                                  physics::joints<physics::wheel_joint>,
                                  physics::without<restitution, rolling_resistance, surface_velocity>> {};
using world = physics::world<games::chosen<float, 2, tailored>>;

int main(int, char** words) {
    std::vector<world::vec> road;
    for (int i = 0; i <= 600; ++i) {
        const float x = static_cast<float>(i) - 20;
        // From right to left: the front of a chain is to the right of its way.
        road.insert(road.begin(), {x, 1.5f * std::sin(0.15f * x) + 0.3f * std::sin(0.9f * x)});
    }
    const auto hills = world::chain_geometry::build(road.data(), static_cast<std::uint32_t>(road.size()));
    const auto make = [&] {
        world w{{.gravity = {0, -10}}};
        static_cast<void>(w.create_shape(w.create_body({.type = physics::body_type::static_body}), hills.shape()));
        for (int i = 0; i < 30; ++i) {
            const world::vec at = {6 * static_cast<float>(i), 4};
            const auto chassis = w.create_body({.position = at});
            static_cast<void>(w.create_shape(chassis, world::box{{1.5f, 0.4f}}));
            for (const float x : {-1.0f, 1.0f}) {
                const world::vec place = {x, -0.6f};
                const auto wheel = w.create_body({.position = at + place});
                static_cast<void>(w.create_shape(wheel, world::ball{0.4f}, {.material = {.friction = 1}}));
                const auto up = physics::rotation<float, 2>::from_angle(1.5707964f);
                w.create_joint(chassis, wheel,
                               world::wheel_joint{.frame_a = {place, up},
                                                  .frame_b = {{}, up},
                                                  .min_translation = -0.25f,
                                                  .max_translation = 0.25f,
                                                  .frequency = 4,
                                                  .damping_ratio = 0.7f,
                                                  .motor_speed = -20,
                                                  .max_motor_torque = 20});
            }
        }
        return w;
    };
    return games::play<world>(600, std::atoi(words[1]), make, [](world&, int) {});
}
