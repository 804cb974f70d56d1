// Joints whose motion is known: a pendulum wave, Newton's cradle, a bridge; each with what it should do.
#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "filming.hpp"
#include "scenes.hpp"

namespace {

constexpr double pi = 3.141592653589793, gravity = 10;

struct in_space : physics::recipe<double, 3, physics::joints<physics::distance_joint>> {};
struct with_bounces
    : physics::recipe<double, 2, physics::joints<physics::distance_joint>, physics::sequential_impulse> {};
struct in_plane : physics::recipe<double, 2, physics::joints<physics::revolute_joint>> {};

template <class World>
physics::body_id add_anchor(World& world) {
    return world.create_body({.type = physics::body_type::static_body});
}

/// Fifteen pendulums that make 20, 21, 22 ... swings in half a minute: then all are back where they began.
void pendulum_wave(samples::film& film) {
    using world = physics::world<in_space>;
    world arena{{.gravity = {0, -gravity, 0}}};
    const physics::body_id beam = add_anchor(arena);
    arena.create_shape(beam, world::box{{0.05, 0.05, 2.1}});
    const double angle = 0.25, minute = 30;
    std::vector<physics::body_id> bobs;
    for (int i = 0; i < 15; ++i) {
        // The exact period of a swing of that size is 2 pi sqrt(L/g) (1 + a^2/16 + 11 a^4/3072 + ...).
        const double longer = 1 + angle * angle / 16 + 11 * std::pow(angle, 4) / 3072;
        const double length = gravity * std::pow(minute / (20 + i) / (2 * pi * longer), 2), z = 0.28 * (i - 7);
        bobs.push_back(arena.create_body({
            .position = {length * std::sin(angle), -length * std::cos(angle), z},
            .rotation_locked = true,
        }));
        arena.create_shape(bobs.back(), world::ball{0.06}, {.density = 1000});
        arena.create_joint(beam, bobs.back(), world::distance_joint{.anchor_a = {0, 0, z}, .length = length});
    }
    std::vector<world::vec> began;
    for (const physics::body_id bob : bobs) began.push_back(arena.position(bob));
    film.play("pendulum wave", arena, samples::joints_of<physics::distance_joint>(arena), minute, [](double) {});

    double off = 0;
    for (std::size_t i = 0; i < bobs.size(); ++i) off = std::max(off, length(arena.position(bobs[i]) - began[i]));
    film.fact("20 to 34 swings later, farthest from its start, mm", 1000 * off);
}

/// Two balls go in, two come out.
void cradle(samples::film& film) {
    using world = physics::world<with_bounces>;
    world::settings_type settings{.gravity = {0, -gravity}};
    settings.solver.restitution_threshold = 0;
    world arena{settings};
    const physics::body_id beam = add_anchor(arena);
    arena.create_shape(beam, world::box{{3, 0.1}});
    const double length = 4;
    std::vector<physics::body_id> balls;
    for (int i = 0; i < 5; ++i) {
        const double x = i - 2, angle = i < 2 ? -0.6 : 0;
        balls.push_back(arena.create_body({
            .position = {x + length * std::sin(angle), -length * std::cos(angle)},
            .rotation_locked = true,
        }));
        arena.create_shape(balls.back(), world::ball{0.5}, {.material = {.friction = 0, .restitution = 1}});
        arena.create_joint(beam, balls.back(), world::distance_joint{.anchor_a = {x, 0}, .length = length});
    }
    const auto height = [&](int i) { return arena.position(balls[static_cast<std::size_t>(i)]).y + length; };
    const auto energy = [&] {
        double sum = scenes::kinetic_energy(arena);
        for (int i = 0; i < 5; ++i) sum += arena.mass(balls[static_cast<std::size_t>(i)]).mass * gravity * height(i);
        return sum;
    };
    const double dropped = height(0), at_first = energy();
    double left = 0, right = 0;
    film.play("Newton's cradle", arena, samples::joints_of<physics::distance_joint>(arena), 20, [&](double t) {
        if (t > 16) left = std::max(left, height(0)), right = std::max(right, height(4));
    });
    film.fact("dropped from, mm", 1000 * dropped);
    film.fact("first ball rises to after 16 s, mm", 1000 * left);
    film.fact("last ball rises to after 16 s, mm", 1000 * right);
    film.fact("energy kept after 20 s, %", 100 * energy() / at_first);
}

/// Forty planks hang between two cliffs, and carry what falls on them.
void bridge(samples::film& film) {
    using world = physics::world<in_plane>;
    world arena{{.gravity = {0, -gravity}}};
    // At first they lie on an arc of one rad.
    constexpr int planks = 40;
    const double half = 0.25, radius = half / std::sin(0.5 / planks);
    const auto end_of = [&](int plank) {
        const double angle = (plank - planks / 2) / double(planks);
        return world::vec{radius * std::sin(angle), radius * (std::cos(0.5) - std::cos(angle))};
    };
    physics::body_id cliffs[2];
    for (int i = 0; i < 2; ++i) {
        const double x = end_of(i * planks).x;
        cliffs[i] = arena.create_body({.type = physics::body_type::static_body, .position = {x, 0}});
        arena.create_shape(cliffs[i], world::box{{3, 3}}, {.position = {i == 0 ? -3.0 : 3.0, -3}});
    }
    std::vector<physics::joint_id> joints;
    physics::body_id last = cliffs[0];
    for (int i = 0; i < planks; ++i) {
        const world::vec along = end_of(i + 1) - end_of(i);
        const physics::body_id plank = arena.create_body({
            .position = end_of(i) + along / 2.0,
            .rotation = physics::rotation<double, 2>::from_angle(std::atan2(along.y, along.x)),
        });
        arena.create_shape(plank, world::box{{half, 0.1}}, {.density = 20});
        joints.push_back(
            arena.create_joint(last, plank, world::revolute_joint{{{i > 0 ? half : 0, 0}, {}}, {{-half, 0}, {}}}));
        last = plank;
    }
    joints.push_back(arena.create_joint(last, cliffs[1], world::revolute_joint{{{half, 0}, {}}}));
    for (int i = 0; i < 12; ++i) scenes::add_crate(arena, 1.2 * (i % 6) - 3, 3 + 2 * i);
    double weight = 0;
    for (const physics::body_id b : arena.bodies())
        if (arena.type(b) == physics::body_type::dynamic_body) weight += gravity * arena.mass(b).mass;
    const auto pins = samples::joints_of<physics::revolute_joint>(arena);
    double widest = 0, carried = 0;
    film.play("bridge", arena, pins, 20, [&](double t) {
        widest = std::max(widest, samples::largest_gap(arena, pins));
        // A reaction acts on the second body, which at the right end is the cliff.
        const double now = arena.reaction(joints.front()).force.y - arena.reaction(joints.back()).force.y;
        if (t >= 10) carried += now / 600;
    });
    film.fact("weight of planks and crates, N", weight);
    film.fact("what the cliffs carry, mean of 10 s, N", carried);
    film.fact("widest joint, mm", 1000 * widest);
}

}  // namespace

int main() {
    samples::film film("Mechanisms", "motions that are known, and how near the joints come",
                       "samples/out/mechanisms.html");
    pendulum_wave(film);
    cradle(film);
    bridge(film);
    return film.finish();
}
