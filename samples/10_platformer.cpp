// A platformer: a character runs, climbs, rides, jumps and pushes its way through tiles to the flag, by a script.
#include <physics.hpp>

#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "filming.hpp"

namespace {

struct level
    : physics::recipe<
          float, 2, physics::shapes<physics::ball, physics::capsule, physics::box, physics::tile_grid, physics::chain>,
          physics::events<physics::event::sensor>, physics::one_way_platforms> {};
using world = physics::world<level>;
using vec = world::vec;
using chain = physics::chain_geometry<float, 2>;

// # tile, o coin, ^ spikes, P checkpoint, F flag, - plank, / ramp of two tiles, L lift of two tiles, c crate.
constexpr std::string_view rows[] = {
    "                                            ",   //
    "                        oo                  ",   //
    "                        --                  ",   //
    "                        --                F ",   //
    "                             c     o        ",   //
    "                     #############  ########",   //
    "       o             ########################",  //
    "    / ###  P    o    #######################",   //
    "############^^#####L #######################",
};
constexpr int columns = 44, height = 9;

enum kind : std::uint64_t { coin = 1, spikes, checkpoint, flag };
enum category : std::uint32_t { scenery = 1, player = 2, sensed = 4 };

/// All that a checkpoint keeps: a copy of it is one.
struct game {
    world arena{{.gravity = {0, -20}}};
    physics::character<world> hero{world::capsule::upright(0.9f, 0.3f), {1, 1}, {0, 1}, {.strength = 200, .mass = 10}};
    physics::body_id body, lift, crate;
    int coins = 0;
    bool is_over = false;

    game() {
        std::vector<std::uint8_t> cells;
        const physics::body_id ground = arena.create_body({.type = physics::body_type::static_body});
        for (int row = 0; row < height; ++row)
            for (int column = 0; column < columns; ++column) {
                const char c = rows[height - 1 - row][static_cast<std::size_t>(column)];
                const float x = static_cast<float>(column), y = static_cast<float>(row);
                cells.push_back(c == '#');
                if (c == 'o') add_sensor(coin, {x + 0.5f, y + 0.5f}, world::ball{0.25f});
                if (c == '^') add_sensor(spikes, {x + 0.5f, y + 0.25f}, world::box{{0.5f, 0.25f}});
                if (c == 'P') add_sensor(checkpoint, {x + 0.5f, y + 1}, world::box{{0.1f, 1}});
                if (c == 'F') add_sensor(flag, {x + 0.5f, y}, world::box{{0.1f, 1}});
                if (c == '-')
                    arena.create_shape(ground, world::box{{0.5f, 0.1f}},
                                       {.position = {x + 0.5f, y + 0.4f}, .one_way = true});
                // One-sided chains stop what comes from the right of their way alone: what falls on them.
                if (c == '/') arena.create_shape(ground, chain::build({{x + 2, y + 1}, {x, y}}).shape());
                if (c == 'L') {
                    lift = arena.create_body({.type = physics::body_type::kinematic_body, .position = {x + 1, y}});
                    arena.create_shape(lift, world::box{{0.95f, 0.2f}}, {.position = {0, 0.8f}});
                }
                if (c == 'c') {
                    crate = arena.create_body({.position = {x + 0.5f, y + 0.5f}});
                    arena.create_shape(crate, world::box{{0.5f, 0.5f}}, {.density = 5});
                }
            }
        const auto tiles = physics::tile_grid_geometry<float, 2>::build(cells.data(), columns, height, 1);
        arena.create_shape(ground, tiles.shape());
        // A character is no body: this one goes along, for sensors to see.
        body = arena.create_body({.type = physics::body_type::kinematic_body, .position = hero.pose().position});
        arena.create_shape(body, world::capsule::upright(0.9f, 0.3f), {.filter = {.category = player, .mask = sensed}});
    }
    template <class Shape>
    void add_sensor(kind what, vec at, const Shape& shape) {
        const physics::body_id it = arena.create_body({.type = physics::body_type::static_body, .position = at});
        arena.create_shape(it, shape,
                           {.filter = {.category = sensed, .mask = player}, .sensor = true, .user_data = what});
    }
    [[nodiscard]] float lift_height() const { return 1.5f - 1.5f * std::cos(static_cast<float>(arena.steps()) / 60); }
};

/// What the player does, and for how long (s).
struct input {
    float seconds, walk;
    bool jumps = false;
};
constexpr input script[] = {
    {2.7f, 5},        // into the spikes, and back to the checkpoint
    {0.9f, 5, true},  // over them
    {0.3f, 5},        // to the lift
    {2.6f, 0},        // until it is down
    {0.36f, 5},       // onto it
    {2.9f, 0},        // up
    {0.9f, 5},        // under the planks
    {1.4f, 0, true},  // through both
    {0.3f, 0},        // stands on the upper one
    {2.2f, 5},        // down, and pushes the crate into the pit
    {0.5f, 5, true},  // over it
    {1.7f, 5},        // to the flag
};

}  // namespace

int main() {
    samples::film film("Platformer", "a character on tiles, with a lift, planks, coins, spikes and a checkpoint",
                       "samples/out/platformer.html");
    game now, saved = now;
    int deaths = 0, step = 0;
    const input* key = script;
    double seconds = 0;
    for (const input& i : script) seconds += i.seconds;
    film.play(
        "level", now.arena, {}, seconds,
        [&](double) {
            now.arena.move_to(now.lift, {20, now.lift_height()}, {});
            now.arena.move_to(now.body, now.hero.pose());
        },
        [&] {
            for (const auto& e : now.arena.sensor_begin_events()) {
                if (e.sensor_data == coin) {
                    ++now.coins;
                    now.arena.destroy_body(e.sensor_body);
                } else if (e.sensor_data == checkpoint) {
                    saved = now;
                } else if (e.sensor_data == spikes) {
                    now = saved;
                    ++deaths;
                    break;
                } else {
                    now.is_over = true;
                }
            }
            if (step++ == static_cast<int>(60 * key->seconds)) ++key, step = 0;
            if (key->jumps && now.hero.ground()) now.hero.jump(9);
            now.hero.move(now.arena, {key->walk, 0}, 1.0f / 60);
        });
    film.expect("deaths on spikes", deaths, 1);
    film.expect("coins", now.coins, 5);
    film.expect("flag reached", now.is_over, 1);
    film.expect("crate pushed by, m", now.arena.position(now.crate).x - 29.5, 5.5, 6.1);
    return film.finish();
}
