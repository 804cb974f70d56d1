// 2D from above: 1,000 circles that run for a place in the middle and crowd each other out; nothing turns or sleeps.
#include "game.hpp"

using namespace physics::feature;
struct tailored : physics::recipe<float, 2, physics::shapes<physics::ball>,
                                  physics::without<rotation, restitution, rolling_resistance, surface_velocity,
                                                   materials, sleeping, continuous>> {};
using world = physics::world<games::chosen<float, 2, tailored>>;

int main(int, char** words) {
    const auto make = [] {
        world w;
        for (int i = 0; i < 1000; ++i) {
            auto def =
                games::upright<world>({1.5f * static_cast<float>(i % 40) - 30, 1.5f * static_cast<float>(i / 40) - 20});
            def.linear_damping = 2;
            const auto b = w.create_body(def);
            static_cast<void>(w.create_shape(b, world::ball{0.4f}));
        }
        return w;
    };
    return games::play<world>(300, std::atoi(words[1]), make, [](world& w, int) {
        for (const physics::body_id b : w.bodies()) w.apply_force(b, w.position(b) * -0.3f);
    });
}
