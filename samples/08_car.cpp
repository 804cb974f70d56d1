// A car on four sprung wheels that drives, steers and brakes: over bumps, and round in a circle.
#include <physics.hpp>

#include <algorithm>
#include <cmath>

#include "filming.hpp"
#include "scenes.hpp"

namespace {

struct garage : physics::recipe<float, 3, physics::joints<physics::wheel_joint>> {};
using world = physics::world<garage>;
using rotation = physics::rotation<float, 3>;

/// A chassis of 1,200 kg that looks along x, and four wheels of 0.35 m and 23 kg; 2.6 m from axle to axle.
class car {
public:
    car(world& arena, const world::vec& at) : arena_(arena) {
        chassis_ = arena.create_body({.position = at});
        arena.create_shape(chassis_, world::box{{2, 0.25f, 0.75f}}, {.density = 400});
        arena.create_shape(chassis_, world::box{{0.9f, 0.25f, 0.65f}}, {.position = {-0.3f, 0.5f, 0}, .density = 0});
        for (int i = 0; i < 4; ++i) {
            const world::vec place = {i < 2 ? 1.3f : -1.3f, -0.4f, i % 2 == 0 ? 0.85f : -0.85f};
            wheels_[i] = arena.create_body({.position = at + place});
            arena.create_shape(wheels_[i], world::ball{radius}, {.density = 128, .material = {.friction = 1}});
            // The suspension's axis is up, that of the wheel is z.
            const rotation upright = rotation::from_axes({0, 1, 0}, {0, 0, 1});
            joints_[i] = arena.create_joint(chassis_, wheels_[i],
                                            world::wheel_joint{.frame_a = {place, upright},
                                                               .frame_b = {{}, upright},
                                                               .min_translation = -0.2f,
                                                               .max_translation = 0.2f,
                                                               .frequency = 5,
                                                               .damping_ratio = 1.2f,
                                                               .rest_translation = -0.12f});
        }
    }
    /// Front wheels go to this angle (rad, to the left), all are driven to this speed (m/s).
    void drive(float angle, float speed) {
        for (int i = 0; i < 4; ++i) {
            auto wheel = arena_.joint<world::wheel_joint>(joints_[i]);
            wheel.steering_angle = i < 2 ? angle : 0;
            wheel.motor_speed = -speed / radius;
            wheel.max_motor_torque = 400;
            arena_.set_joint(joints_[i], wheel);
        }
    }
    [[nodiscard]] world::vec position() const { return arena_.position(chassis_); }
    [[nodiscard]] float speed() const { return length(arena_.linear_velocity(chassis_)); }
    /// Where the middle of the rear axle is.
    [[nodiscard]] world::vec rear() const { return arena_.pose(chassis_) * world::vec{-1.3f, 0, 0}; }
    /// How far a wheel is off the axis of its suspension (m).
    [[nodiscard]] float slack() const {
        float worst = 0;
        for (int i = 0; i < 4; ++i) {
            const auto joint = arena_.joint<world::wheel_joint>(joints_[i]);
            const world::vec off =
                inverse(arena_.pose(chassis_)) * arena_.position(wheels_[i]) - joint.frame_a.position;
            worst = std::max(worst, std::hypot(off.x, off.z));
        }
        return worst;
    }

private:
    static constexpr float radius = 0.35f;
    world& arena_;
    physics::body_id chassis_, wheels_[4];
    physics::joint_id joints_[4];
};

void slalom(samples::film& film) {
    world arena = scenes::grounded<world>();
    for (int i = 0; i < 8; ++i) {
        const physics::body_id bump = arena.create_body({
            .type = physics::body_type::static_body,
            .position = {2.5f * static_cast<float>(i) - 8, -0.06f,
                         i % 3 == 0   ? 0
                         : i % 3 == 1 ? 1.6f
                                      : -1.6f},
            .rotation = rotation::from_axis_angle({0, 1, 0}, 1.5707963f),
        });
        arena.create_shape(bump, world::capsule{i % 3 == 0 ? 4.0f : 1.4f, 0.16f});
    }
    car it(arena, {-14, 0.85f, 0});
    float slack = 0, fastest = 0;
    film.play("over bumps", arena, samples::joints_of<physics::wheel_joint>(arena), 7, [&](double t) {
        it.drive(static_cast<float>(0.12 * std::sin(2 * t)), t < 4.5 ? 6 : 0);
        slack = std::max(slack, it.slack());
        fastest = std::max(fastest, it.speed());
    });
    film.fact("way, m", it.position().x + 14);
    film.fact("top speed, m/s (driven to 6)", fastest);
    film.fact("speed after braking for 2.5 s, m/s", it.speed());
    film.fact("wheels off their axes, mm", 1000 * slack);
}

void circle(samples::film& film) {
    world arena = scenes::grounded<world>();
    scenes::square_pyramid(arena, 4);
    const float angle = 0.4f, radius = 2.6f / std::tan(angle);
    car it(arena, {1.3f, 0.85f, radius});
    world::vec least = {1e9f, 0, 1e9f}, most = {-1e9f, 0, -1e9f};
    film.play("turning circle", arena, samples::joints_of<physics::wheel_joint>(arena), 20, [&](double t) {
        it.drive(angle, 2);
        if (t < 5) return;
        least = min(least, it.rear());
        most = max(most, it.rear());
    });
    film.fact("radius of the rear axle, m", (most.x - least.x + most.z - least.z) / 4);
    film.fact("axles' distance over the tangent of the steering angle, m", radius);
}

}  // namespace

int main() {
    samples::film film("Car", "a chassis, four wheels, and what is between them", "samples/out/car.html");
    slalom(film);
    circle(film);
    return film.finish();
}
