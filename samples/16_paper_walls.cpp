// Bullets of up to 390 m/s through walls of paper that tear: none is missed, and each begin of a contact has its end.
#include <physics.hpp>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "filming.hpp"

namespace {

template <int D>
struct range_of
    : physics::recipe<float, D, physics::shapes<physics::ball, physics::box>, physics::joints<physics::motor_joint>,
                      physics::events<physics::event::contact, physics::event::hit>> {};

/// One lane each, the last ones too slow to tear paper.
constexpr float speeds[] = {390, 377, 341, 290, 211, 130, 80, 6, 3};
constexpr int lanes = 9, fast_lanes = 7, walls = 12;
/// What tears a sheet (N s), and what holds it (N, N m).
constexpr float strength = 0.3f, grip = 3;

template <int D>
void shoot(samples::film& film, const char* title) {
    using world = physics::world<range_of<D>>;
    using vec = typename world::vec;
    world arena{{.gravity = {}}};
    const auto at = [](float x, float y) {
        vec v;
        v.x = x;
        v.y = y;
        return v;
    };
    const physics::body_id frame = arena.create_body({.type = physics::body_type::static_body});
    // Sheets of 1 mm and some grams, which give way by no less than a force: what hits them loses little.
    for (int lane = 0; lane < lanes; ++lane)
        for (int i = 0; i < walls; ++i) {
            const vec place = at(5 + 3.1f * static_cast<float>(i), static_cast<float>(lane));
            const physics::body_id sheet =
                arena.create_body({.position = place, .user_data = static_cast<std::uint64_t>(100 * lane + i)});
            vec half = vec::filled(0.4f);
            half.x = 0.0005f;
            arena.create_shape(sheet, typename world::box{half}, {.density = 10});
            arena.create_joint_at(frame, sheet, arena.pose(sheet),
                                  typename world::motor_joint{.max_force = grip, .max_torque = grip});
        }
    std::vector<physics::body_id> bullets;
    for (int lane = 0; lane < lanes; ++lane) {
        // Flagged, since the sheets can move: else only what is static stops it on its way through a step.
        bullets.push_back(arena.create_body({.position = at(0, static_cast<float>(lane)),
                                             .linear_velocity = at(speeds[lane], 0),
                                             .continuous = true,
                                             .user_data = 10000}));
        arena.create_shape(bullets.back(), typename world::ball{0.02f}, {.density = D == 2 ? 250.0f : 8000.0f});
    }

    // Each sheet is taken along to the bullet's new speed.
    float unhindered = speeds[0];
    for (const physics::body_id sheet : arena.bodies())
        if (arena.user_data(sheet) < walls && arena.type(sheet) == physics::body_type::dynamic_body)
            unhindered /= 1 + arena.mass(sheet).mass / arena.mass(bullets[0]).mass;

    std::map<std::pair<physics::shape_id, physics::shape_id>, int> open;
    int begins = 0, ends = 0, unpaired = 0, out_of_order = 0;
    int torn[lanes] = {};
    float speed_left = 0;
    film.play(
        title, arena, {}, 2, [](double) {},
        [&] {
            for (const auto& e : arena.contact_end_events()) {
                ++ends;
                unpaired += open[{e.shape_a, e.shape_b}]-- != 1;
            }
            for (const auto& e : arena.contact_begin_events()) {
                ++begins;
                unpaired += open[{e.shape_a, e.shape_b}]++ != 0;
            }
            for (const auto& h : arena.hit_events())
                for (const physics::body_id body : {h.body_a, h.body_b}) {
                    if (h.impulse < strength || !arena.contains(body) || arena.user_data(body) >= 10000) continue;
                    const int number = static_cast<int>(arena.user_data(body));
                    out_of_order += torn[number / 100]++ != number % 100;
                    arena.destroy_body(body);
                }
            for (physics::body_id& bullet : bullets) {
                if (!arena.contains(bullet) || arena.position(bullet).x < 45) continue;
                if (bullet == bullets[0]) speed_left = arena.linear_velocity(bullet).x;
                arena.destroy_body(bullet);
            }
        });
    arena.clear();
    arena.step(1.0f / 60);
    ends += static_cast<int>(arena.contact_end_events().size());
    int by_fast = 0, by_slow = 0;
    for (int lane = 0; lane < lanes; ++lane) (lane < fast_lanes ? by_fast : by_slow) += torn[lane];
    film.expect("sheets torn by fast bullets", by_fast, fast_lanes * walls);
    film.expect("of them out of order, or missed by the one before", out_of_order, 0);
    film.expect("sheets torn by slow ones", by_slow, 0);
    film.expect("speed of the fastest behind all sheets, m/s", speed_left, 0.99 * unhindered, unhindered);
    film.expect("begins of contacts that found the last one ended", begins - unpaired, begins);
    film.expect("ends of contacts, all destroyed at the end", ends, begins);
}

}  // namespace

int main() {
    samples::film film("Paper walls", "bullets of up to 390 m/s, twelve sheets in each lane",
                       "samples/out/paper_walls.html");
    shoot<2>(film, "in the plane");
    shoot<3>(film, "in space");
    return film.finish();
}
