// A platformer in 3D: a character climbs, slides along a wall, jumps a gap that it first falls into, rides an arm that
// turns and a lift, and pushes a crate out of the gate to the flag, by a script.
#include <physics.hpp>

#include <cmath>
#include <cstdint>
#include <string_view>

#include "filming.hpp"

namespace {

struct level : physics::recipe<float, 3, physics::shapes<physics::ball, physics::capsule, physics::box>,
                               physics::events<physics::event::sensor>> {};
using world = physics::world<level>;
using vec = world::vec;

// From above, x to the right and z down: how high the ground is, in steps of 0.3 m from a on; a space is air.
constexpr std::string_view ground[] = {
    "bbbbbbcdeeeeej",                                        //
    "bbbbbbcdeeeeej                         kkkktt",         //
    "bbbbbbcdeeeeejeeee   eee         eeee  kkkkttkhhkkkk",  //
    "bbbbbbcdeeeeeeeeee   eee         eeee  kkkkkkkhhkkkk",  //
    "bbbbbbcdeeeeeeeeee   eee         eeee  kkkkttkhhkkkk",  //
};
constexpr float height_of(char c) { return 0.3f * static_cast<float>(c - 'a'); }

enum kind : std::uint64_t { coin = 1, checkpoint, flag };
enum category : std::uint32_t { scenery = 1, player = 2, sensed = 4 };
constexpr vec coins[] = {{7.5f, 1.6f, 1}, {13.5f, 2, 3.5f}, {19.5f, 3.2f, 3.5f}, {28.6f, 2, 6.5f}, {38, 3.5f, 3.5f}};

/// All that a checkpoint keeps: a copy of it is one.
struct game {
    world arena{{.gravity = {0, -20, 0}}};
    physics::character<world> hero{
        world::capsule::upright(0.9f, 0.3f), {1, 0.4f, 1}, {0, 1, 0}, {.strength = 200, .mass = 10}};
    physics::body_id body, arm, lift, crate;
    int coins_taken = 0;
    bool is_over = false;

    game() {
        const physics::body_id land = arena.create_body({.type = physics::body_type::static_body});
        for (std::size_t row = 0; row < std::size(ground); ++row)
            for (std::size_t from = 0, to = 0; from < ground[row].size(); from = to) {
                const char c = ground[row][from];
                while (to < ground[row].size() && ground[row][to] == c) ++to;
                if (c == ' ') continue;
                const float half = static_cast<float>(to - from) / 2, deep = (height_of(c) + 1) / 2;
                const vec middle = {static_cast<float>(from) + half, height_of(c) - deep,
                                    static_cast<float>(row) + 0.5f};
                arena.create_shape(land, world::box{{half, deep, 0.5f}}, {.position = middle});
            }
        for (const vec& at : coins) add_sensor(coin, at, world::ball{0.3f});
        add_sensor(checkpoint, {16.5f, 2.2f, 3.5f}, world::box{{0.1f, 1, 1.5f}});
        add_sensor(flag, {50.5f, 4, 3.5f}, world::box{{0.1f, 1, 1.5f}});
        arm = add_platform({28.5f, 1, 3.5f}, {4, 0.2f, 0.8f});
        arena.set_angular_velocity(arm, {0, 0.8f, 0});
        lift = add_platform({38, 1, 3.5f}, {0.95f, 0.2f, 1.5f});
        crate = arena.create_body({.position = {44.5f, 3.45f, 3.5f}});
        arena.create_shape(crate, world::box{{0.45f, 0.45f, 0.45f}}, {.density = 5});
        // A character is no body: this one goes along, for sensors to see.
        body = arena.create_body({.type = physics::body_type::kinematic_body, .position = hero.pose().position});
        arena.create_shape(body, world::capsule::upright(0.9f, 0.3f), {.filter = {.category = player, .mask = sensed}});
    }
    physics::body_id add_platform(vec at, vec half) {
        const physics::body_id it = arena.create_body({.type = physics::body_type::kinematic_body, .position = at});
        arena.create_shape(it, world::box{half});
        return it;
    }
    template <class Shape>
    void add_sensor(kind what, vec at, const Shape& shape) {
        const physics::body_id it = arena.create_body({.type = physics::body_type::static_body, .position = at});
        arena.create_shape(it, shape,
                           {.filter = {.category = sensed, .mask = player}, .sensor = true, .user_data = what});
    }
    [[nodiscard]] float lift_height() const { return 1.9f - 0.9f * std::cos(static_cast<float>(arena.steps()) / 60); }
};

/// Where the player goes, by a jump or on foot, and how long it waits there (s).
struct input {
    float x, z;
    double wait = 0;
    bool jumps = false;
};
constexpr input script[] = {
    {8.5f, 1},               // up the stairs
    {14, 3.5f},              // along the wall, and past its end
    {22, 3.5f},              // into the gap, and back to the checkpoint
    {17.9f, 3.5f},           // to its edge
    {22, 3.5f, 0, true},     // over it
    {23.6f, 3.5f, 2.85},     // to where the arm comes by
    {25.4f, 3.5f, 3.6},      // half around on it
    {34.5f, 3.5f},           // off it
    {36.6f, 3.5f},           // to the lift
    {38, 3.5f, 2.5},         // up
    {43.5f, 3.5f},           // to the gate
    {45.5f, 3.5f},           // and the crate through it
    {50.5f, 3.5f, 0, true},  // to the flag
};

}  // namespace

int main() {
    samples::film film("Platformer in 3D", "a character on islands, with an arm that turns, a lift, coins and a crate",
                       "samples/out/platformer_3d.html");
    game now, saved = now;
    int falls = 0, waited = 0;
    const input* key = script;
    const auto next = [&] {
        if (key + 1 == std::end(script)) return;
        waited = 0;
        if ((++key)->jumps) now.hero.jump(9);
    };
    film.play(
        "islands", now.arena, {}, 20,
        [&](double) {
            now.arena.move_to(now.lift, {38, now.lift_height(), 3.5f}, {});
            now.arena.move_to(now.body, now.hero.pose());
        },
        [&] {
            for (const auto& e : now.arena.sensor_begin_events()) {
                if (e.sensor_data == coin) {
                    ++now.coins_taken;
                    now.arena.destroy_body(e.sensor_body);
                } else if (e.sensor_data == checkpoint) {
                    saved = now;
                } else {
                    now.is_over = true;
                }
            }
            if (now.hero.feet().y < -5) {
                now = saved;
                ++falls;
                next();
            }
            const vec way = {key->x - now.hero.feet().x, 0, key->z - now.hero.feet().z};
            const bool is_there = waited > 0 || length(way) < 0.1f;
            if (is_there && ++waited > 60 * key->wait) next();
            now.hero.move(now.arena, is_there ? vec{} : normalized(way) * 5, 1.0f / 60);
        });
    film.expect("falls into the gap", falls, 1);
    film.expect("coins", now.coins_taken, 5);
    film.expect("flag reached", now.is_over, 1);
    film.expect("crate pushed by, m", now.arena.position(now.crate).x - 44.5, 2, 3);
    return film.finish();
}
