// Joints whose motion is known: a pendulum wave, Newton's cradle, a bridge, a lift, a crane; with what each should do.
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
struct in_plane : physics::recipe<double, 2, physics::joints<physics::revolute_joint, physics::prismatic_joint>> {};
struct with_ropes : physics::recipe<double, 2, physics::joints<physics::distance_joint, physics::pulley_joint>> {};

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

/// Eight pairs of crossed bars of 4 m, opened by a slider with a motor, under a platform of 600 kg.
void scissor_lift(samples::film& film) {
    using world = physics::world<in_plane>;
    world arena{{.gravity = {0, -gravity}}};
    const physics::body_id ground = add_anchor(arena);
    arena.create_shape(ground, world::halfspace{{0, 1}, -0.5});
    constexpr int levels = 8;
    const double half = 2, folded = 0.2, wide = half * std::cos(folded), tall = half * std::sin(folded);
    const auto pin = [&](physics::body_id a, const world::vec& at_a, physics::body_id b, const world::vec& at_b) {
        arena.create_joint(a, b, world::revolute_joint{{at_a, {}}, {at_b, {}}});
    };
    physics::body_id up, down;  // the bars of the level below that rise to the right, and to the left
    physics::body_id foot = arena.create_body({.position = {wide, 0}});
    arena.create_shape(foot, world::ball{0.15}, {.density = 100});
    for (int i = 0; i < levels; ++i) {
        const double y = tall * (2 * i + 1);
        const auto bar = [&](double angle) {
            const physics::body_id id =
                arena.create_body({.position = {0, y}, .rotation = physics::rotation<double, 2>::from_angle(angle)});
            arena.create_shape(id, world::box{{half, 0.04}}, {.density = 50});
            return id;
        };
        const physics::body_id right = bar(folded), left = bar(-folded);
        pin(right, {}, left, {});
        if (i == 0) pin(ground, {-wide, 0}, right, {-half, 0}), pin(foot, {}, left, {half, 0});
        else pin(down, {-half, 0}, right, {-half, 0}), pin(up, {half, 0}, left, {half, 0});
        up = right, down = left;
    }
    const double top = 2 * tall * levels;
    const physics::body_id platform = arena.create_body({.position = {0, top + 0.2}});
    arena.create_shape(platform, world::box{{2.2, 0.1}}, {.density = 600 / 0.88});
    const physics::body_id shoe = arena.create_body({.position = {wide, top}});
    arena.create_shape(shoe, world::ball{0.1}, {.density = 100});
    pin(platform, {-wide, -0.2}, down, {-half, 0});
    pin(shoe, {}, up, {half, 0});
    arena.create_joint(platform, shoe, world::prismatic_joint{.frame_a = {{0, -0.2}, {}}});
    const physics::joint_id motor = arena.create_joint(ground, foot, world::prismatic_joint{.max_motor_force = 1e6});
    const auto pins = samples::joints_of<physics::revolute_joint>(arena);
    double tilt = 0, off = 0, widest = 0;
    film.play("scissor lift", arena, pins, 16, [&](double t) {
        const double spread = arena.position(foot).x + wide, step = std::sqrt(4 * half * half - spread * spread);
        tilt = std::max(tilt, std::fabs(arena.rotation(platform).angle()));
        off = std::max(off, std::fabs(arena.position(platform).y - 0.2 - levels * step));
        widest = std::max(widest, samples::largest_gap(arena, pins));
        // The foot goes in, and out again, so that the platform rises and sinks by up to 1.2 m/s.
        auto slider = arena.joint<world::prismatic_joint>(motor);
        slider.motor_speed = -1.2 * std::sin(2 * pi * t / 16) * step / (levels * spread);
        arena.set_joint(motor, slider);
    });
    film.fact("platform off the height that its foot implies, mm", 1000 * off);
    film.fact("platform off level, mrad", 1000 * tilt);
    film.fact("widest joint, mm", 1000 * widest);
}

/// A winch hauls a container of 2 t on slings, by a block and tackle over a crane's jib, and puts it down again.
void crane(samples::film& film) {
    using world = physics::world<with_ropes>;
    world arena{{.gravity = {0, -gravity}}};
    const physics::body_id frame = add_anchor(arena);
    arena.create_shape(frame, world::halfspace{{0, 1}, 0});
    arena.create_shape(frame, world::box{{0.4, 6}}, {.position = {0, 6}});
    arena.create_shape(frame, world::box{{4.4, 0.25}}, {.position = {3.2, 12}});
    const world::vec wheels[] = {{-1, 12}, {7, 11.5}};
    const physics::body_id winch =
        arena.create_body({.type = physics::body_type::kinematic_body, .position = {-4, 0.3}});
    arena.create_shape(winch, world::box{{0.6, 0.3}});
    const physics::body_id hook = arena.create_body({.position = {7, 3.7}}),
                           load = arena.create_body({.position = {7, 1}});
    arena.create_shape(hook, world::ball{0.2}, {.density = 100 / (0.04 * pi)});
    arena.create_shape(load, world::box{{1.5, 1}}, {.density = 2000 / 6.0});
    const world::pulley_joint over{.ground_a = wheels[0], .ground_b = wheels[1], .ratio = 2};
    const physics::joint_id rope = arena.create_joint(winch, hook, over);
    // Slings to its upper corners, which are slack at first.
    const double sling = std::hypot(1.4, 1.8);
    for (const double x : {-1.4, 1.4})
        arena.create_joint(hook, load, world::distance_joint{.anchor_b = {x, 1}, .length = sling, .min_length = 0});
    const auto rope_length = [&] {
        return length(arena.position(winch) - wheels[0]) + 2 * length(arena.position(hook) - wheels[1]);
    };
    const double whole = rope_length();
    double highest = 0, longest = 0, tension = 0;
    film.play("crane", arena, samples::joints_of<physics::distance_joint, physics::pulley_joint>(arena), 20,
              [&](double t) {
                  // 12 m to the left, and back.
                  arena.set_linear_velocity(winch, {t < 8 ? -1.5 : t < 12 ? 0 : 1.5, 0});
                  highest = std::max(highest, arena.position(load).y);
                  longest = std::max(longest, rope_length() - whole);
                  if (t >= 11 && t < 12) tension += arena.reaction(rope).force.y / 2 / 60;
              });
    film.fact("container lifted by, m", highest - 1);
    film.fact("rope longer than it is by at most, mm", 1000 * longest);
    film.fact("half the weight of hook and container, N", 2100 * gravity / 2);
    film.fact("pull of the rope while it hangs, mean of 1 s, N", tension);
    film.fact("container back from where it stood, mm", 1000 * std::fabs(arena.position(load).x - 7));
}

}  // namespace

int main() {
    samples::film film("Mechanisms", "motions that are known, and how near the joints come",
                       "samples/out/mechanisms.html");
    pendulum_wave(film);
    cradle(film);
    bridge(film);
    scissor_lift(film);
    crane(film);
    return film.finish();
}
