// Conveyors: belts of two speeds carry crates to a sorter, whose sensor tells a kicker which ones to push aside, and
// the others round a corner.
#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "filming.hpp"

namespace {

struct plant : physics::recipe<float, 3, physics::joints<physics::prismatic_joint>,
                               physics::events<physics::event::sensor, physics::event::sleep>> {};
using world = physics::world<plant>;
using vec = world::vec;

enum : std::uint64_t { small = 1, large = 2 };

constexpr float slow = 0.5f, fast = 1.5f;

}  // namespace

int main() {
    samples::film film("Conveyor", "two speeds, a sensor and a kicker", "samples/out/conveyor.html");
    world arena{{.gravity = {0, -10, 0}}};
    const physics::body_id floor = arena.create_body({.type = physics::body_type::static_body});
    arena.create_shape(floor, world::halfspace{{0, 1, 0}, -1});
    // Their tops are the height 0.
    const auto belt = [&](float x, float half) {
        return arena.create_shape(floor, world::box{{half, 0.1f, 0.6f}}, {.position = {x, -0.1f, 0}});
    };
    const physics::shape_id belts[] = {belt(-4, 4), belt(4, 4)};
    // Round the corner, across the end of the others.
    const physics::shape_id corner =
        arena.create_shape(floor, world::box{{0.7f, 0.1f, 2.6f}}, {.position = {8.7f, -0.1f, 2}});

    std::vector<physics::body_id> crates;
    for (int i = 0; i < 8; ++i) {
        const bool is_large = i % 3 == 1;
        const float half = is_large ? 0.3f : 0.2f;
        const physics::body_id crate = arena.create_body({
            .position = {-0.9f * static_cast<float>(i) - 0.9f, half, 0},
            .user_data = is_large ? large : small,
        });
        arena.create_shape(crate, world::box{{half, half, half}}, {.density = 100});
        crates.push_back(crate);
    }
    // What is as high as this is large.
    const physics::shape_id eye =
        arena.create_shape(floor, world::box{{0.05f, 0.05f, 0.6f}}, {.position = {4, 0.5f, 0}, .sensor = true});
    // A plate beside the belt that slides across it.
    const physics::body_id plate = arena.create_body({.position = {4.5f, 0.25f, -1.1f}});
    arena.create_shape(plate, world::box{{0.5f, 0.2f, 0.1f}}, {.density = 200});
    const auto across = physics::rotation<float, 3>::from_x_axis({0, 0, 1});
    const physics::joint_id kicker =
        arena.create_joint(floor, plate,
                           world::prismatic_joint{.frame_a = {{4.5f, 0.25f, -1.1f}, across},
                                                  .frame_b = {{}, across},
                                                  .min_translation = 0,
                                                  .max_translation = 1.2f,
                                                  .max_motor_force = 5000});
    const auto drive_kicker = [&](float speed) {
        auto joint = arena.joint<world::prismatic_joint>(kicker);
        joint.motor_speed = speed;
        arena.set_joint(kicker, joint);
    };
    const auto start = [&](physics::shape_id id, const vec& velocity) {
        auto rubber = arena.material(id);
        rubber.surface_velocity = velocity;
        arena.set_material(id, rubber);
    };

    int asleep = 0, woken = 0, kicks = 0;
    double kicked_at = -10, now = 0;
    float slip[3] = {};
    film.play(
        "sorter", arena, {}, 32,
        [&](double t) {
            now = t;
            if (t == 3) {
                asleep = static_cast<int>(std::ranges::count_if(crates, [&](auto id) { return arena.is_asleep(id); }));
                start(belts[0], {slow, 0, 0});
                start(belts[1], {fast, 0, 0});
                start(corner, {0, 0, fast});
            }
            drive_kicker(t - kicked_at < 0.4 ? 3.0f : -3.0f);
        },
        [&] {
            if (now >= 3 && now < 3.1) woken += static_cast<int>(arena.wake_events().size());
            for (const auto& e : arena.sensor_begin_events())
                if (e.sensor == eye && e.visitor_body_data == large) ++kicks, kicked_at = now;
            // How far off the belt's speed crates are that have been on it for long.
            for (const physics::body_id id : crates) {
                const vec at = arena.position(id), v = arena.linear_velocity(id);
                if (now > 5 && at.x < -0.6f) slip[0] = std::max(slip[0], std::fabs(v.x - slow));
                if (at.x > 2 && at.x < 3.5f) slip[1] = std::max(slip[1], std::fabs(v.x - fast));
                if (at.x > 8 && at.z > 1.5f && at.z < 4) slip[2] = std::max(slip[2], length(v - vec{0, 0, fast}));
            }
        });
    int sorted[2] = {};
    for (const physics::body_id id : crates) {
        const vec at = arena.position(id);
        sorted[0] += arena.user_data(id) == small && at.x > 8 && at.z > 4;
        sorted[1] += arena.user_data(id) == large && at.x < 8 && at.z > 0.6f;
    }
    film.expect("crates asleep before the belts start", asleep, 8);
    film.expect("of them woken by the start", woken, 8, 9);
    film.expect("slip on the slow belt, m/s", slip[0], 0, 0.001);
    film.expect("slip on the fast belt, m/s", slip[1], 0, 0.001);
    film.expect("slip after the corner, m/s", slip[2], 0, 0.001);
    film.expect("kicks", kicks, 3);
    film.expect("small crates round the corner", sorted[0], 5);
    film.expect("large crates kicked aside", sorted[1], 3);
    return film.finish();
}
