// Pinball: flippers on motors, bumpers that give back more than they get, a plunger, and a tilt; a minute of play, by a
// script.
#include <physics.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "filming.hpp"

namespace {

struct table : physics::recipe<float, 2, physics::shapes<physics::ball, physics::capsule, physics::box, physics::chain>,
                               physics::joints<physics::revolute_joint, physics::prismatic_joint>,
                               physics::events<physics::event::hit, physics::event::sensor>> {};
using world = physics::world<table>;
using vec = world::vec;

constexpr float wide = 0.6f, high = 1.1f, lane = 0.06f, radius = 0.0135f;

enum points : std::uint64_t { none = 0, slingshot = 10, bumper = 100 };

/// A table of 0.6 by 1.1 m that is tilted by 6.5 degrees.
class machine {
public:
    world arena{settings()};
    physics::body_id ball;
    physics::shape_id drain, shot;

    machine() {
        // The outline with a round top, clockwise: its solid is outside.
        const float left = -wide / 2, right = wide / 2;
        vec outline[19] = {{left, -0.1f}};
        for (int i = 0; i <= 16; ++i) {
            const float angle = 3.14159265f * (1 - static_cast<float>(i) / 16);
            outline[i + 1] = {right * std::cos(angle), high - right + right * std::sin(angle)};
        }
        outline[18] = {right, -0.1f};
        frame_ = arena.create_body({.type = physics::body_type::static_body});
        add_chain(outline, true);
        arena.create_shape(frame_, world::capsule::between({right - lane, -0.1f}, {right - lane, 0.68f}, 0.004f));
        // Inlanes, which lead to the flippers.
        arena.create_shape(frame_, world::capsule::between({left, 0.3f}, {left + 0.16f, 0.19f}, 0.006f));
        arena.create_shape(frame_,
                           world::capsule::between({right - lane, 0.3f}, {right - lane - 0.16f, 0.19f}, 0.006f));
        for (const vec& at : {vec{-0.14f, 0.74f}, vec{0.1f, 0.74f}, vec{-0.02f, 0.88f}, vec{-0.02f, 0.6f}})
            arena.create_shape(frame_, world::ball{0.035f},
                               {.position = at, .material = {.restitution = 1.1f}, .user_data = bumper});
        for (const float side : {-1.0f, 1.0f})
            arena.create_shape(
                frame_,
                world::capsule::between({-lane / 2 + side * 0.2f, 0.42f}, {-lane / 2 + side * 0.17f, 0.34f}, 0.008f),
                {.material = {.restitution = 1.05f}, .user_data = slingshot});
        drain = arena.create_shape(frame_, world::box{{wide / 2, 0.01f}}, {.position = {0, -0.09f}, .sensor = true});
        const vec hinges[] = {{left + 0.16f, 0.18f}, {right - lane - 0.16f, 0.18f}};
        for (int i = 0; i < 2; ++i) {
            const float side = i == 0 ? 1.0f : -1.0f;
            const physics::body_id flipper = arena.create_body({.position = hinges[i], .continuous = true});
            arena.create_shape(flipper, world::capsule::between({}, {side * 0.072f, 0}, 0.009f), {.density = 20});
            flippers_[i] = arena.create_joint(
                frame_, flipper,
                world::revolute_joint{
                    .frame_a = {hinges[i], {}}, .min_angle = -0.5f, .max_angle = 0.5f, .max_motor_torque = 1});
        }
        const vec rest = {right - lane / 2, 0.02f};
        const physics::body_id plunger = arena.create_body({.position = rest});
        arena.create_shape(plunger, world::box{{lane / 2 - 0.006f, 0.01f}}, {.density = 200});
        plunger_ = arena.create_joint(frame_, plunger,
                                      world::prismatic_joint{.frame_a = {rest, upwards()},
                                                             .frame_b = {{}, upwards()},
                                                             .min_translation = -0.06f,
                                                             .max_translation = 0.02f,
                                                             .max_motor_force = 50});
        ball = arena.create_body({.position = rest + vec{0, 0.03f}, .continuous = true});
        arena.create_shape(ball, world::ball{radius},
                           {.density = 140, .material = {.friction = 0.2f, .restitution = 0.4f}});
    }
    void flip(int side, bool up) { drive(flippers_[side], side == 0 ? up : !up); }
    /// Draws the plunger back, or lets it go.
    void plunge(bool back) {
        auto joint = arena.joint<world::prismatic_joint>(plunger_);
        joint.motor_speed = back ? -0.1f : 3.2f;
        arena.set_joint(plunger_, joint);
    }
    /// Pushes the table aside: to the ball that is a pull.
    void push(float acceleration) {
        auto with = settings();
        with.gravity.x = acceleration;
        arena.set_settings(with);
    }
    void serve() {
        arena.set_pose(ball, {wide / 2 - lane / 2, 0.06f}, {});
        arena.set_linear_velocity(ball, {});
        arena.set_angular_velocity(ball, 0);
    }

private:
    static world::settings_type settings() {
        world::settings_type s{.gravity = {0, -9.81f * 0.1132f}, .contact_margin = 0.002f};
        s.broadphase.margin = 0.005f;
        s.events.hit_speed = 0.1f;
        s.solver.restitution_threshold = 0.05f;
        return s;
    }
    static physics::rotation<float, 2> upwards() { return physics::rotation<float, 2>::from_angle(1.5707963f); }
    template <std::size_t N>
    void add_chain(const vec (&points)[N], bool loop) {
        const auto chain = physics::chain_geometry<float, 2>::build(points, {.loop = loop});
        arena.create_shape(frame_, chain.shape(), {.material = {.restitution = 0.3f}});
    }
    void drive(physics::joint_id id, bool counter_clockwise) {
        auto joint = arena.joint<world::revolute_joint>(id);
        joint.motor_speed = counter_clockwise ? 25.0f : -25.0f;
        arena.set_joint(id, joint);
    }

    physics::body_id frame_;
    physics::joint_id flippers_[2], plunger_;
};

}  // namespace

int main() {
    samples::film film("Pinball", "two flippers, four bumpers, two slingshots, a plunger", "samples/out/pinball.html");
    machine it;
    std::uint64_t score = 0;
    int hits = 0, served = 1, outside = 0;
    float fastest = 0, pushed_by = 0;
    double served_at = 0, tilted_at = -1, tilted_for = 0, now = 0;
    // A third push within 2 s tilts the table: the flippers are dead until the ball is lost.
    const double pushes[] = {15, 16, 30, 31, 31.5};
    film.play(
        "a minute", it.arena, {}, 60,
        [&](double t) {
            now = t;
            it.plunge(t - served_at < 1);
            // Each flipper goes up when the ball is near, and down again.
            const vec at = it.arena.position(it.ball), v = it.arena.linear_velocity(it.ball);
            const bool is_dead = tilted_at >= 0;
            const bool low = !is_dead && at.y < 0.24f && at.y > 0.1f && v.y < 0.2f;
            it.flip(0, low && at.x < -lane / 2 && at.x > -0.13f);
            it.flip(1, low && at.x > -lane / 2 && at.x < 0.08f);
            int lately = 0;
            float push = 0;
            for (const double pushed : pushes) {
                lately += t >= pushed && t < pushed + 2;
                if (t >= pushed && t < pushed + 0.1) push = at.x > 0 ? -4.0f : 4.0f;
            }
            if ((push != 0) != (pushed_by != 0)) it.push(pushed_by = push);
            if (lately > 2 && !is_dead) tilted_at = t;
        },
        [&] {
            for (const auto& h : it.arena.hit_events()) {
                const std::uint64_t points = std::max(it.arena.user_data(h.shape_a), it.arena.user_data(h.shape_b));
                score += points;
                hits += points > 0;
            }
            const vec at = it.arena.position(it.ball);
            fastest = std::max(fastest, length(it.arena.linear_velocity(it.ball)));
            const float round = std::hypot(at.x, std::max(at.y - (high - wide / 2), 0.0f));
            outside += round > wide / 2 || at.y < -0.1f;
            for (const auto& e : it.arena.sensor_begin_events())
                if (e.sensor == it.drain && e.visitor_body == it.ball) {
                    it.serve();
                    ++served, served_at = now;
                    if (tilted_at >= 0) tilted_for += now - std::exchange(tilted_at, -1);
                }
        });
    film.expect("steps with the ball off the table", outside, 0);
    film.expect("hits of bumpers and slingshots", hits, 10, 1000);
    film.expect("score, more than 10 for each hit", static_cast<double>(score), 10 * hits, 1e6);
    film.expect("balls served", served, 1, 20);
    film.expect("seconds from the tilt to the loss of the ball", tilted_for, 0.1, 20);
    film.fact("fastest, m/s", fastest);
    return film.finish();
}
