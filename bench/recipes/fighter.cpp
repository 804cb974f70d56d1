// A lockstep fighter in fixed point, 2D: two fighters of three boxes each and ten loose things, nothing turns.
#include <vector>

#include "game.hpp"

using S = physics::fixed32;
using namespace physics::feature;
struct tailored : physics::recipe<S, 2, physics::shapes<physics::box>, physics::all_pairs,
                                  physics::without<rotation, restitution, rolling_resistance, surface_velocity,
                                                   materials, sleeping, continuous>> {};
using world = physics::world<games::chosen<S, 2, tailored>>;

int main(int, char** words) {
    std::vector<physics::body_id> fighters;
    const auto make = [&] {
        world w{{.gravity = {S(0), S(-20)}}};
        const auto ground = w.create_body({.type = physics::body_type::static_body, .position = {S(0), S(-1)}});
        static_cast<void>(w.create_shape(ground, world::box{{S(20), S(1)}}));
        fighters.clear();
        for (int i = 0; i < 2; ++i) {
            fighters.push_back(w.create_body(games::upright<world>({S(6 * i - 3), S(1)})));
            for (int k = 0; k < 3; ++k)
                static_cast<void>(w.create_shape(fighters.back(), world::box{{S(0.3), S(0.3)}},
                                                 {.position = {S(0), S(0.6 * (k - 1))}}));
        }
        for (int i = 0; i < 10; ++i) {
            const auto b = w.create_body(games::upright<world>({S(i - 5), S(4)}));
            static_cast<void>(w.create_shape(b, world::box{{S(0.25), S(0.25)}}));
        }
        return w;
    };
    return games::play<world>(1200, std::atoi(words[1]), make, [&](world& w, int frame) {
        for (int i = 0; i < 2; ++i) {
            const physics::body_id b = fighters[static_cast<std::size_t>(i)];
            const bool leaps = frame % 90 == 30 * i, goes_right = (frame / 60 + i) % 2 == 0;
            w.set_linear_velocity(b, {S(goes_right ? 4 : -4), leaps ? S(9) : w.linear_velocity(b).y});
        }
    });
}
