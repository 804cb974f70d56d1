// Ragdolls: limp ones that tumble down stairs, and puppets that dance by springs in their knees and elbows.
#include <physics.hpp>

#include <cmath>

#include "filming.hpp"
#include "scenes.hpp"

namespace {

struct limbs : physics::recipe<float, 3, scenes::joints> {};
using world = physics::world<limbs>;
using rotation = physics::rotation<float, 3>;

void stairs(samples::film& film) {
    world arena = scenes::grounded<world>();
    for (int i = 0; i < 16; ++i) {
        const float half = 0.15f * static_cast<float>(16 - i);
        const physics::body_id step = arena.create_body({
            .type = physics::body_type::static_body,
            .position = {0, half, 0.4f * static_cast<float>(i)},
        });
        arena.create_shape(step, world::box{{3, half, 0.2f}});
    }
    for (int i = 0; i < 6; ++i) {
        const world::vec feet = {1.4f * static_cast<float>(i % 3 - 1), 4.9f, 0.8f * static_cast<float>(i / 3 - 1)};
        const rotation forward = rotation::from_axis_angle({1, 0, 0}, 0.4f);
        arena.set_linear_velocity(scenes::ragdoll(arena, {feet, forward}, 1000), {0, 0, 4});
    }
    const auto pins = samples::joints_of<physics::ball_joint, physics::revolute_joint>(arena);
    double widest = 0;
    film.play("stairs", arena, pins, 10, [&](double) { widest = std::max(widest, samples::largest_gap(arena, pins)); });

    float bent = 0;
    for (const physics::joint_id j : arena.joints()) bent = std::max(bent, std::fabs(arena.joint_angle(j)));
    film.fact("most bent joint at the end, rad (limit 2.3)", bent);
    film.fact("energy of motion at the end, J", scenes::kinetic_energy(arena), "%.1e");
    film.fact("widest joint, mm", 1000 * widest);
}

void puppets(samples::film& film) {
    world arena = scenes::grounded<world>();
    const physics::body_id beam =
        arena.create_body({.type = physics::body_type::static_body, .position = {0, 3.2f, 0}});
    arena.create_shape(beam, world::box{{4, 0.1f, 0.1f}});
    for (int i = 0; i < 5; ++i) {
        const float x = 1.5f * static_cast<float>(i - 2);
        const physics::body_id trunk = scenes::ragdoll(arena, {{x, 0.5f, 0}, {}}, 1000);
        for (const float side : {-0.15f, 0.15f})
            arena.create_joint(beam, trunk, world::distance_joint{{x + side, 0, 0}, {side, 0.2f, 0}, 1.23f});
    }
    // Knees and elbows go to this part of the angle that they can be bent.
    const auto pose = [&](float part) {
        for (const physics::joint_id j : arena.joints()) {
            if (arena.user_data(j) == 0) continue;
            auto hinge = arena.joint<world::revolute_joint>(j);
            hinge.frequency = 3;
            hinge.damping_ratio = 1;
            hinge.rest_angle = part * (hinge.min_angle + hinge.max_angle);
            arena.set_joint(j, hinge);
        }
    };
    const auto pins = samples::joints_of<physics::ball_joint, physics::revolute_joint>(arena);
    auto ropes = samples::joints_of<physics::distance_joint>(arena);
    std::erase_if(ropes, [&](const auto& rope) { return rope.body_a != beam; });
    double widest = 0;
    film.play("puppets", arena, ropes, 10, [&](double t) {
        if (std::fmod(t, 1) == 0) pose(std::fmod(t, 2) == 0 ? 0.7f : 0.1f);
        widest = std::max(widest, samples::largest_gap(arena, pins));
    });
    film.fact("widest joint, mm", 1000 * widest);
}

}  // namespace

int main() {
    samples::film film("Ragdolls", "eleven bodies each, of hinges, ball joints and ropes", "samples/out/ragdolls.html");
    stairs(film);
    puppets(film);
    return film.finish();
}
