// Conveyors: belts of two speeds carry crates to a sorter whose sensor tells the large ones. In 3D a kicker pushes them
// aside, and the others go round a corner; in 2D they fall through a hatch, and the others go up a slope.
#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "filming.hpp"

namespace {

template <int D>
struct plant : physics::recipe<float, D, physics::joints<physics::prismatic_joint>,
                               physics::events<physics::event::sensor, physics::event::sleep>> {};

enum : std::uint64_t { small = 1, large = 2 };

constexpr float slow = 0.5f, fast = 1.5f;

/// Five small ones and three large ones in a row that ends at x = 0, on the height 0.
template <class World>
std::vector<physics::body_id> add_crates(World& arena) {
    std::vector<physics::body_id> crates;
    for (int i = 0; i < 8; ++i) {
        const bool is_large = i % 3 == 1;
        const float half = is_large ? 0.3f : 0.2f;
        typename World::body_def def{.user_data = is_large ? large : small};
        def.position.x = -0.9f * static_cast<float>(i) - 0.9f;
        def.position.y = half;
        crates.push_back(arena.create_body(def));
        arena.create_shape(crates.back(), typename World::box{World::vec::filled(half)}, {.density = 100});
    }
    return crates;
}
template <class World>
void start(World& arena, physics::shape_id belt, const physics::surface_motion<float, World::dimension>& velocity) {
    auto rubber = arena.material(belt);
    rubber.surface_velocity = velocity;
    arena.set_material(belt, rubber);
}
template <class World>
void drive(World& arena, physics::joint_id motor, float speed) {
    auto joint = arena.template joint<typename World::prismatic_joint>(motor);
    joint.motor_speed = speed;
    arena.set_joint(motor, joint);
}

void sort_by_hatch(samples::film& film) {
    using world = physics::world<plant<2>>;
    world arena{{.gravity = {0, -10}}};
    const physics::body_id floor = arena.create_body({.type = physics::body_type::static_body});
    arena.create_shape(floor, world::halfspace{{0, 1}, -3});
    const float slope = 0.25f, rise = std::sin(slope), run = std::cos(slope);
    const physics::shape_id belts[] = {
        arena.create_shape(floor, world::box{{4, 0.1f}}, {.position = {-4, -0.1f}}),
        arena.create_shape(floor, world::box{{2, 0.1f}}, {.position = {2, -0.1f}}),
        arena.create_shape(floor, world::box{{2, 0.1f}},
                           {.position = {5 + 2 * run + 0.1f * rise, 2 * rise - 0.1f * run},
                            .rotation = physics::rotation<float, 2>::from_angle(slope)})};
    // Between the belts: as one of them, and slides under the slope. It passes through belts, since a joint ties both.
    const physics::body_id hatch = arena.create_body({.position = {4.5f, -0.1f}});
    const physics::shape_id lid = arena.create_shape(hatch, world::box{{0.5f, 0.1f}}, {.density = 2000});
    const physics::joint_id motor = arena.create_joint(
        floor, hatch,
        world::prismatic_joint{
            .frame_a = {{4.5f, -0.1f}, {}}, .min_translation = 0, .max_translation = 1.1f, .max_motor_force = 20000});
    const physics::shape_id eye =
        arena.create_shape(floor, world::box{{0.05f, 0.05f}}, {.position = {3, 0.5f}, .sensor = true});
    const std::vector<physics::body_id> crates = add_crates(arena);

    int dropped = 0;
    double told_at = -10, now = 0;
    float slip = 0;
    film.play(
        "hatch", arena, {}, 26,
        [&](double t) {
            now = t;
            if (t == 2) {
                start(arena, belts[0], slow);
                for (const physics::shape_id id : {belts[1], belts[2], lid}) start(arena, id, fast);
            }
            drive(arena, motor, t - told_at < 1.6 ? 4.0f : -4.0f);
        },
        [&] {
            for (const auto& e : arena.sensor_begin_events())
                if (e.sensor == eye && e.visitor_body_data == large) ++dropped, told_at = now;
            for (const physics::body_id id : crates)
                if (const float x = arena.position(id).x; x > 6 && x < 8)
                    slip = std::max(slip, length(arena.linear_velocity(id) - world::vec{fast * run, fast * rise}));
        });
    int sorted[2] = {};
    for (const physics::body_id id : crates) {
        const world::vec at = arena.position(id);
        sorted[0] += arena.user_data(id) == small && at.x > 8.5f;
        sorted[1] += arena.user_data(id) == large && at.x < 6.5f && at.y < -2;
    }
    film.expect("slip on the slope, m/s", slip, 0, 0.001);
    film.expect("times that the hatch opens", dropped, 3);
    film.expect("small crates over the slope", sorted[0], 5);
    film.expect("large crates through the hatch", sorted[1], 3);
}

void sort_by_kicker(samples::film& film) {
    using world = physics::world<plant<3>>;
    using vec = world::vec;
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

    const std::vector<physics::body_id> crates = add_crates(arena);
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

    int asleep = 0, woken = 0, kicks = 0;
    double kicked_at = -10, now = 0;
    float slip[3] = {};
    film.play(
        "sorter", arena, {}, 32,
        [&](double t) {
            now = t;
            if (t == 3) {
                asleep = static_cast<int>(std::ranges::count_if(crates, [&](auto id) { return arena.is_asleep(id); }));
                start(arena, belts[0], {slow, 0, 0});
                start(arena, belts[1], {fast, 0, 0});
                start(arena, corner, {0, 0, fast});
            }
            drive(arena, kicker, t - kicked_at < 0.4 ? 3.0f : -3.0f);
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
}

}  // namespace

int main() {
    samples::film film("Conveyor", "two speeds and a sensor; a hatch and a slope, a kicker and a corner",
                       "samples/out/conveyor.html");
    sort_by_hatch(film);
    sort_by_kicker(film);
    return film.finish();
}
