// Laws of joints in scenes whose motion is known exactly: pendulums, a cradle, springs, a top.
#pragma once

#include <algorithm>

#include "laws/joint_kinds.hpp"

namespace {
namespace joint_scene_laws {

using namespace kind_laws;
using ball_joint = physics::ball_joint<S, D>;
/// Of worlds in which impacts are exact.
using bouncing = physics::world<joined<physics::sequential_impulse>>;

/// Of a pendulum that is let go at an angle (s).
inline double period_of(double length, double g, double angle) {
    double a = 1, b = std::cos(angle / 2);
    for (int i = 0; i < 6; ++i) {
        const double mean = (a + b) / 2;
        b = std::sqrt(a * b);
        a = mean;
    }
    return 2 * pi * std::sqrt(length / g) / a;
}

/// A body on a hinge at the origin, `down` below it where it hangs straight, let go at an angle.
template <class World>
struct pendulum {
    World w;
    body_id body;
    joint_id hinge;
    double down, angle, time = 0, gap = 0, highest = -10;

    pendulum(int substeps, double g, double down_, double angle_, double half_x, double half_y)
        : w(falling<World>(substeps, g)), down(down_), angle(angle_) {
        const body_id a = add_anchor(w, at(0, 0));
        body = add_box(w, at(down * std::sin(angle), -down * std::cos(angle)), half_x, half_y);
        w.set_pose(body, {w.position(body), turn(angle)});
        w.set_can_sleep(body, false);
        hinge = w.create_joint(a, body, revolute_joint{.frame_b = frame(0, down)});
    }
    /// Of the pendulum with all its mass in one point that swings as it does.
    [[nodiscard]] double length() const { return down + joint_laws::about_z(w.mass(body).inertia) / down; }
    void step(double h) {
        w.step(S(h));
        time += h;
        gap = std::max(gap, length_of(w.pose(body) * at(0, down)));
        highest = std::max(highest, number(w.position(body)[1]));
        angle = number(w.joint_angle(hinge));
    }
    /// When it passes below the hinge the next time.
    double next_crossing(double h) {
        for (;;) {
            const double before = angle;
            step(h);
            if (before * angle < 0 || time > 100) return time - h * angle / (angle - before);
        }
    }
};
template <class World>
double period_error(int substeps, double degrees) {
    pendulum<World> p(substeps, 9.81, 1, degrees * pi / 180, 0.0625, 0.125);
    const double exact = period_of(p.length(), 9.81, degrees * pi / 180);
    const double first = p.next_crossing(1.0 / 60);
    p.next_crossing(1.0 / 60);
    return (p.next_crossing(1.0 / 60) - first) / exact - 1;
}

template <class World>
void has_its_period(int substeps, double degrees) {
    CAPTURE(substeps);
    CAPTURE(degrees);
    const double half = degrees * pi / 360, h = 1.0 / 60 / substeps;
    // What a step of h makes of the frequency of small swings, and of the largest angular velocity; the nearer to the
    // top it starts the more that tells, as does rounding.
    const double small = 9.81 * h * h / 24, large = 4 * small * std::sin(half) * std::sin(half);
    const double near = std::cos(half), rounding = number(cell::tolerance(64));
    CHECK(std::abs(period_error<World>(substeps, degrees)) < 2 * (small + large) / near + rounding / (near * near));
}
CELL_CASE("joint scenes: a pendulum on a hinge has its period, however far it swings") {
    for (const double degrees : {10.0, 45.0, 90.0, 170.0})
        for (const int substeps : {1, 4}) has_its_period<plain>(substeps, degrees);
    has_its_period<bouncing>(4, 90);
}
CELL_CASE("joint scenes: a box on a hinge at its end rises as high as it fell for 20 s") {
    for (const int substeps : {1, 4}) {
        CAPTURE(substeps);
        pendulum<plain> p(substeps, gravity, 1, pi / 2, 0.05, 1);
        const double h = 1.0 / 60, first = p.next_crossing(h), omega = std::sqrt(3 * gravity / 2);
        p.next_crossing(h);
        const double sub = h / substeps, exact = 2.708895531;
        CHECK(std::abs(p.next_crossing(h) - first - exact) < exact * omega * omega * sub * sub / 6 + 1e-5);
        while (p.time < 20 - exact) p.step(h);
        p.highest = -1;
        while (p.time < 20) p.step(h);
        // It is let go half a substep late, and seen once a step, which at the top is at most h / 2 late.
        CHECK(p.highest < 1e-4 + gravity * sub * sub / 8);
        CHECK(p.highest > -1e-4 - gravity * sub * sub / 8 - 0.75 * gravity * h * h / 8);
        CHECK(p.gap < 5 * sub * sub * sub * omega * omega * omega + number(cell::tolerance(256)));
    }
}

/// Two points of 1 kg on rods of 1 m, let go level: where the rods point after a second and after two.
template <class World>
void double_pendulum(int substeps, double (&angles)[2][2], double& gap) {
    World w = falling<World>(substeps, 9.81);
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(1, 0)), c = add_ball(w, at(2, 0));
    w.create_joint(a, b, distance_joint{.length = S(1)});
    w.create_joint(b, c, distance_joint{.length = S(1)});
    gap = 0;
    for (auto& of_second : angles) {
        run(w, 60, 1.0 / 60);
        const vec one = w.position(b), other = w.position(c) - one;
        of_second[0] = std::atan2(number(one[0]), -number(one[1]));
        of_second[1] = std::atan2(number(other[0]), -number(other[1]));
        gap = std::max({gap, std::abs(length_of(one) - 1), std::abs(length_of(other) - 1)});
    }
}

CELL_CASE("joint scenes: a double pendulum goes where it should, first order in the substep") {
    const double exact[2][2] = {{-0.625087700, -1.034585086}, {-0.482971534, -1.324048712}};
    double coarse[2][2], fine[2][2];
    for (const int substeps : {4, 8}) {
        CAPTURE(substeps);
        auto& angles = substeps == 4 ? coarse : fine;
        double gap;
        double_pendulum<plain>(substeps, angles, gap);
        const double h = 1.0 / 60 / substeps;
        CHECK(gap < 100 * h * h * h + number(cell::tolerance(64)));
        // It is let go half a substep late, at some 4 rad/s later on.
        for (int i = 0; i < 2; ++i)
            for (int k = 0; k < 2; ++k) CHECK(std::abs(angles[i][k] - exact[i][k]) < 4 * h);
    }
    // What is left without the first order.
    for (int i = 0; i < 2; ++i)
        for (int k = 0; k < 2; ++k)
            CHECK(std::abs(2 * fine[i][k] - coarse[i][k] - exact[i][k]) < 30.0 / 240 / 240 + 1e-4);
}

/// Rods on hinges that tumble over each other: what a substep misses of their turns must not add up.
CELL_CASE("joint scenes: two rods on hinges keep their energy") {
    plain w = falling<plain>(4);
    const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0.125), 0.125, 0.03),
                  c = add_box(w, at(0.375), 0.125, 0.03);
    w.create_joint(a, b, revolute_joint{.frame_b = frame(-0.125)});
    w.create_joint(b, c, revolute_joint{.frame_a = frame(0.125), .frame_b = frame(-0.125)});
    double sum = 0;
    const int steps = cell::is_fixed ? 500 : 1000;
    for (int i = 0; i < steps; ++i) {
        run(w, 1, 1.0 / 60);
        for (const body_id rod : {b, c}) {
            const double v = length_of(w.linear_velocity(rod)), spin = z_of(w.angular_velocity(rod));
            sum += (v * v + joint_laws::about_z(w.mass(rod).inertia) * spin * spin) / 2 +
                   gravity * number(w.position(rod)[1]);
        }
    }
    // Of the 5 J by which they could fall, on average.
    CHECK(std::abs(sum / steps) < 0.02);
}

/// Five balls on strings of 5 m, of which the first comes at 7 m/s where it hangs straight.
struct cradle {
    bouncing w;
    std::vector<body_id> balls;

    cradle(double spacing, int substeps) : w(falling<bouncing>(substeps)) {
        auto settings = w.settings();
        settings.solver.restitution_threshold = S(0);
        w.set_settings(settings);
        const body_id beam = add_anchor(w, at(0, 5));
        for (int i = 0; i < 5; ++i) {
            const double x = spacing * i;
            const body_id b = w.create_body({.position = at(x, 0), .rotation_locked = true, .can_sleep = false});
            w.create_shape(b, bouncing::ball{S(0.5)}, {.material = {.friction = S(0), .restitution = S(1)}});
            w.create_joint(beam, b, distance_joint{.anchor_a = at(x), .length = S(5)});
            balls.push_back(b);
        }
        w.set_linear_velocity(balls[0], at(7));
    }
    [[nodiscard]] double rest() const {
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i) sum += length_of(w.linear_velocity(balls[i]));
        return sum;
    }
};
CELL_CASE("joint scenes: the speed of a cradle's first ball goes to the last one, whether strings are apart or not") {
    for (const double spacing : {1.0, 1.01})
        for (const int substeps : {1, 4}) {
            CAPTURE(spacing);
            CAPTURE(substeps);
            cradle c(spacing, substeps);
            run(c.w, 4, 1.0 / 60);
            const double rise = number(c.w.position(c.balls[4])[1]), h = 1.0 / 60 / substeps;
            // A string is a tangent while a ball moves on: of the speed that leaves the square of its turn.
            const double turn = 7.0 / 5 * h;
            CHECK(length_of(c.w.linear_velocity(c.balls[4])) ==
                  doctest::Approx(std::sqrt(49 - 2 * gravity * rise)).epsilon(2 * turn * turn + 1e-3));
            // The others are where they were hit, at most the gap of each aside.
            CHECK(c.rest() < 4 * (spacing - 1) * std::sqrt(gravity / 5) + 1e-3);
            if (spacing > 1 || substeps == 1) continue;
            // A swing or two on.
            const int steps = cell::is_fixed ? 300 : 600;
            double first = 0, last = 0, others = 0;
            for (int i = 0; i < steps; ++i) {
                run(c.w, 1, 1.0 / 60);
                if (i < steps - 300) continue;
                first = std::max(first, number(c.w.position(c.balls[0])[1]));
                last = std::max(last, number(c.w.position(c.balls[4])[1]));
                for (std::size_t k = 1; k < 4; ++k) others = std::max(others, number(c.w.position(c.balls[k])[1]));
            }
            for (const double height : {first, last}) {
                CHECK(height < 2.45 + 1e-3);
                CHECK(height > 2.45 * (1 - 30 * turn * turn) - 2e-3);
            }
            CHECK(others < 1e-3);
        }
}

/// A point on a spring without gravity, let go 1 m off: its places in `count` steps.
template <class World>
std::vector<double> places_on_spring(int substeps, double frequency, double damping_ratio, double mass, double h,
                                     int count) {
    World w = falling<World>(substeps, 0);
    const body_id a = add_anchor(w, at(0, 0)), b = w.create_body({.position = at(5), .can_sleep = false});
    w.create_shape(b, typename World::ball{S(0.25)}, {.density = S(mass / (D == 2 ? pi / 16 : pi / 48))});
    w.create_joint(
        a, b, prismatic_joint{.frequency = S(frequency), .damping_ratio = S(damping_ratio), .rest_translation = S(4)});
    std::vector<double> result;
    for (int i = 0; i < count; ++i) {
        run(w, 1, h);
        result.push_back(number(w.position(b)[0]) - 4);
    }
    return result;
}
/// The decay (1/s) and frequency (Hz) of x[i + 1] = p x[i] - q x[i - 1], by least squares.
inline std::pair<double, double> oscillation_of(const std::vector<double>& x, double h) {
    double aa = 0, ab = 0, bb = 0, ac = 0, bc = 0;
    for (std::size_t i = 1; i + 1 < x.size(); ++i) {
        aa += x[i] * x[i], ab -= x[i] * x[i - 1], bb += x[i - 1] * x[i - 1];
        ac += x[i] * x[i + 1], bc -= x[i - 1] * x[i + 1];
    }
    const double p = (ac * bb - ab * bc) / (aa * bb - ab * ab), q = (aa * bc - ab * ac) / (aa * bb - ab * ab);
    return {-std::log(q) / (2 * h), std::acos(std::clamp(p / (2 * std::sqrt(q)), -1.0, 1.0)) / (2 * pi * h)};
}

CELL_CASE("joint scenes: springs have their frequency and decay, whatever the mass") {
    for (const double frequency : {1.0, 5.0, 30.0, 120.0})
        for (const double damping_ratio : {0.0, 0.1, 1.0})
            for (const int substeps : {1, 4}) {
                CAPTURE(frequency);
                CAPTURE(damping_ratio);
                CAPTURE(substeps);
                const double h = std::min(1.0 / 60, 1 / (16 * frequency)), omega = 2 * pi * frequency,
                             angle = omega * h / substeps;
                const auto x = places_on_spring<plain>(substeps, frequency, damping_ratio, 1, h, 40),
                           heavy = places_on_spring<plain>(substeps, frequency, damping_ratio, 50, h, 40);
                const double rounding = number(cell::tolerance(1 << 10));
                for (std::size_t i = 0; i < x.size(); ++i) CHECK(std::abs(x[i] - heavy[i]) < rounding);
                if (damping_ratio == 1) {
                    for (std::size_t i = 0; i < x.size(); ++i) {
                        const double t = omega * h * double(i + 1);
                        CHECK(std::abs(x[i] - (1 + t) * std::exp(-t)) < angle / 2);
                    }
                    continue;
                }
                const auto [decay, found] = oscillation_of(x, h);
                // A step of symplectic Euler swings faster by angle^2 / 24, and is slowed by its damping.
                const double exact = frequency * std::sqrt(1 - damping_ratio * damping_ratio),
                             off = angle * angle / 24 - damping_ratio * angle / 2;
                CHECK(std::abs(found / exact - 1 - off) < 0.1 * std::abs(off) + rounding);
                // Without damping it is 1e-12 of the speed a substep.
                CHECK(std::abs(decay / omega - damping_ratio) <
                      damping_ratio * angle * angle / 6 + 1e-12 / angle + rounding);
            }
}
CELL_CASE("joint scenes: a spring too fast for its substeps is damped, and does not throw what it holds") {
    for (const double frequency : {30.0, 120.0, 1000.0})
        for (const int substeps : {1, 4}) {
            CAPTURE(frequency);
            CAPTURE(substeps);
            const auto x = places_on_spring<plain>(substeps, frequency, 0, 1, 1.0 / 60, 60);
            for (const double place : x) CHECK(std::abs(place) < 1);
            CHECK(std::abs(x.back()) < 1e-3);
        }
}

#if CELL_DIMENSION == 3
/// A top on its foot, set to turn steadily about the vertical.
CELL_CASE("joint scenes: a top goes round by its rate, and does not nod") {
    for (const int substeps : {4, 16}) {
        CAPTURE(substeps);
        plain w = falling<plain>(substeps);
        const double tilt = pi / 6, high = 0.25, spin = 60, n = 64;
        const body_id a = add_anchor(w, at(0, 0)), b = w.create_body({.can_sleep = false});
        w.create_shape(b, plain::box{at(0.25, 0.0625, 0.25)}, {.density = S(n / 2)});
        const double mass = number(w.mass(b).mass), about_axis = number(w.mass(b).inertia.yy),
                     across = number(w.mass(b).inertia.xx) + mass * high * high;
        // across rate^2 cos(tilt) - about_axis spin rate + m g high = 0
        const double half = about_axis * spin / (2 * across * std::cos(tilt)),
                     rate = half - std::sqrt(half * half - mass * gravity * high / (across * std::cos(tilt)));
        const auto axis = [&] { return w.pose(b).rotation * at(0, 1); };
        w.set_pose(b, {at(high * std::sin(tilt), high * std::cos(tilt)), turn(-tilt)});
        w.create_joint(a, b, ball_joint{.anchor_b = at(0, -high)});
        const vec turning = axis() * S(spin - rate * std::cos(tilt)) + at(0, rate);
        w.set_angular_velocity(b, turning);
        w.set_linear_velocity(b, cross(turning, axis() * S(high)));
        double lowest = 1, highest = 0, turned = 0, last = 0;
        for (int i = 0; i < 120; ++i) {
            run(w, 1, 1.0 / 60);
            const vec now = axis();
            const double angle = std::acos(number(now[1])), round = std::atan2(-number(now[2]), number(now[0]));
            lowest = std::min(lowest, angle);
            highest = std::max(highest, angle);
            turned += std::remainder(round - last, 2 * pi);
            last = round;
        }
        // Its weight acts from half a substep on, so that it nods by what it goes round in that.
        const double h = 1.0 / 60 / substeps;
        CHECK(std::abs(turned / 2 / rate - 1) < h / 2);
        CHECK(highest - lowest < rate * h);
        CHECK(length_of(w.pose(b) * at(0, -high)) < 2 * rate * high * spin * spin * h * h * h + 1e-5);
    }
}
#endif

/// A motor of a hinge that drives a box of 1 kg, `arm` from the hinge, from the level on.
template <class World>
struct driven_arm {
    World w;
    joint_id hinge;
    double inertia;

    driven_arm(int substeps, double arm, double speed, double torque) : w(falling<World>(substeps)) {
        const body_id box = add_box(w, at(arm), 0.25, 0.125);
        w.set_can_sleep(box, false);
        inertia = arm * arm + joint_laws::about_z(w.mass(box).inertia);
        hinge = w.create_joint(
            add_anchor(w, at(0, 0)), box,
            revolute_joint{.frame_b = frame(-arm), .motor_speed = S(speed), .max_motor_torque = S(torque)});
    }
    double angle_after(double h) {
        w.step(S(h));
        return number(w.joint_angle(hinge));
    }
};
template <class World>
void motor_gives_its_torque(int substeps) {
    CAPTURE(substeps);
    const double h = 1.0 / 60;
    // 5 N m a kg m^2 take it to 10 rad/s in 2 s, and hold that.
    driven_arm<World> rotor(substeps, 0, 10, 0);
    auto motor = rotor.w.template joint<revolute_joint>(rotor.hinge);
    motor.max_motor_torque = S(5 * rotor.inertia);
    rotor.w.set_joint(rotor.hinge, motor);
    double angle = 0, speed = 0, worst = 0;
    for (int i = 1; i <= 180; ++i) {
        const double next = rotor.angle_after(h);
        speed = (next - angle) / h;
        angle = next;
        // As fast as it is in the middle of a step, in whose substeps speeds are those of their ends.
        worst = std::max(worst, std::abs(speed - std::min(5 * (i - 0.5 + 0.5 / substeps) * h, 10.0)));
    }
    CHECK(worst < 0.03);
    CHECK(std::abs(speed - 10) < 0.002);
    CHECK(std::abs(angle - 20) < 0.01 + 5 * h / substeps);
    // A load of 10 N m: a motor of 1/49 more lifts it over the top, and is never faster than it should be.
    driven_arm<World> lifts(substeps, 1, 2, 10 * 5 / 4.9), stalls(substeps, 1, 2, 10 * 5 / 5.1);
    double fastest = 0, highest = -1, lowest = 1;
    angle = 0;
    for (int i = 0; i < 600; ++i) {
        const double next = lifts.angle_after(h);
        fastest = std::max(fastest, (next - angle) / h);
        angle = next;
        // One of 1/51 less sinks to where its torque has given what the load has lost, and comes back.
        const double now = stalls.angle_after(h);
        highest = std::max(highest, now);
        lowest = std::min(lowest, now);
    }
    CHECK(angle > pi / 2);
    CHECK(fastest < 2.01);
    CHECK(highest < 0.01);
    double end = -0.35;
    for (int i = 0; i < 20; ++i) end -= (5 * end - 5.1 * std::sin(end)) / (5 - 5.1 * std::cos(end));
    CHECK(std::abs(lowest - end) < 0.01);
}
CELL_CASE("joint scenes: a motor speeds up, lifts and stalls by its torque") {
    for (const int substeps : {1, 4, 16}) motor_gives_its_torque<plain>(substeps);
    motor_gives_its_torque<bouncing>(4);
}

}  // namespace joint_scene_laws
}  // namespace
