// Aims a throw through a bounce by Newton's method: dual numbers as the scalar of a world tell how its end depends on
// it.
#include <cmath>
#include <cstdio>

#include "dual.hpp"

// Swept motion finds times of impact in doubles, where derivatives are lost: what is thrown here is slow enough.
struct yard : physics::recipe<dual, 2, physics::shapes<physics::ball, physics::halfspace>,
                              physics::without<physics::feature::continuous>> {};
using world = physics::world<yard>;

// Where a ball with backspin is after 3 s that is thrown at 9 m/s and that angle, and bounces.
static dual thrown(dual angle) {
    world::settings_type settings;
    settings.gravity = {dual(0), dual(-10)};
    world w(settings);
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), world::halfspace{{dual(0), dual(1)}},
                   {.material = {.friction = dual(0.5), .restitution = dual(0.5)}});
    const dual speed(9);
    const physics::body_id ball =
        w.create_body({.position = {dual(0), dual(1)},
                       .linear_velocity = {speed * physics::cos(angle), speed * physics::sin(angle)},
                       .angular_velocity = dual(10)});
    w.create_shape(ball, world::ball{dual(0.2)}, {.material = {.friction = dual(0.5)}});
    for (int i = 0; i < 180; ++i) w.step(dual(1.0 / 60));
    return w.position(ball).x;
}

int main() {
    constexpr double target = 9;
    double angle = 1.1;
    std::printf("a ball is to be at %g m after 3 s\n\n angle (rad)     is at (m)     off (m)   slope (m/rad)\n",
                target);
    for (int i = 0; i < 10; ++i) {
        const dual end = thrown({angle, 1});
        std::printf("%12.9f  %12.9f  %10.1e  %14.6f\n", angle, end.value, end.value - target, end.slope);
        if (std::abs(end.value - target) < 1e-12) break;
        angle -= (end.value - target) / end.slope;
    }
    const double step = 1e-6, up = thrown(dual(angle + step)).value, down = thrown(dual(angle - step)).value;
    std::printf("\nby differences the slope there is %.6f\n", (up - down) / (2 * step));
}
