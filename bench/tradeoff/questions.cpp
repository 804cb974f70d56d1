// The questions. Where a scene has a name like S1, it is that of the literature: see bench/tradeoff/README.md.
#include "question.hpp"

#include <algorithm>
#include <cmath>

#include "../scenes/parts.hpp"

namespace bench {

namespace {

constexpr double pi = 3.14159265358979323846, g = 10;

/// A scene of so many seconds, in steps of a frame; whoever plays it sets the steps.
scene lasting(int dimension, double seconds) {
    scene s = named("", dimension, static_cast<int>(std::lround(seconds / film::interval)));
    s.lower = {-1e6, -1e6, -1e6};
    s.upper = {1e6, 1e6, 1e6};
    return s;
}
shape with(shape s, double density, double friction, double restitution = 0) {
    s.density = density, s.friction = friction, s.restitution = restitution;
    return s;
}
shape ball(double radius) {
    shape s;
    s.kind = form::ball;
    s.radius = radius;
    return s;
}
shape cube() { return box({0.5, 0.5, 0.5}); }
body moving(body b, const triple& velocity, const triple& spin = {}) {
    b.velocity = velocity, b.spin = spin;
    return b;
}
/// Its top is at y = 0.
void add_floor(scene& s, double friction, double restitution = 0) {
    s.add(ground({0, -1, 0}, with(box({100, 1, 100}), 1, friction, restitution)));
}
/// The density that makes a ball weigh 1.
double density_of_unit(int dimension, double radius) {
    return dimension == 2 ? 1 / (pi * radius * radius) : 3 / (4 * pi * radius * radius * radius);
}
double energy_of_spin(const scene& s, int dimension, const state& of, std::size_t i) {
    const mass m = mass_of(s.bodies[i], dimension);
    const triple w = rotated(inverse(of.rotation), of.spin);
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += w[k] * dot(m.inertia[k], w) / 2;
    return sum;
}
template <class F>
double largest(const film& seen, F&& of) {
    double most = 0;
    for (const auto& states : seen.frames) {
        const double x = of(states);
        if (!(x <= most)) most = x;
    }
    return most;
}

scene projectile(int d) {
    scene s = lasting(d, 10);
    s.add(moving(solid({0, 0, 0}, ball(0.5)), {10, 10, 0}));
    return s;
}
double miss_of_projectile(const scene&, const film& seen) {
    return length(seen.last()[0].at - triple{100, 100 - g * 50, 0});
}

scene tumble(int d) {
    scene s = lasting(d, 10);
    s.gravity = {};
    s.add(moving(solid({0, 0, 0}, with(box({0.05, 0.2, 0.45}), 10 / 0.036, 0)), {}, {0.1, 5, 0.1}));
    return s;
}
/// Of its energy and its angular momentum, which engines without gyroscopic torque do not keep.
double change_of_tumble(const scene& s, const film& seen) {
    const auto momentum = [&](const state& of) {
        const mass m = mass_of(s.bodies[0], 3);
        const triple w = rotated(inverse(of.rotation), of.spin);
        return rotated(of.rotation, {dot(m.inertia[0], w), dot(m.inertia[1], w), dot(m.inertia[2], w)});
    };
    const double energy = energy_of_spin(s, 3, seen.frames[0][0], 0);
    const triple start = momentum(seen.frames[0][0]);
    return largest(seen, [&](const auto& states) {
        const double turned = length(momentum(states[0]) - start) / length(start);
        return std::max(turned, std::abs(energy_of_spin(s, 3, states[0], 0) / energy - 1));
    });
}

scene impact(int d) {
    // Hits after 0.1 s, and again when the box has turned.
    scene s = lasting(d, 0.2);
    s.gravity = {};
    s.add(solid({0, 0, 0}, with(box({1, 0.5, 0.5}), 1, 0, 0.5)));
    s.add(moving(solid({0.75, 1.5, 0}, with(ball(0.5), density_of_unit(d, 0.5), 0, 0.5)), {0, -5, 0}));
    return s;
}
double spin_after_impact(const scene&, const film& seen) {
    const double inertia = 2 * 5 / 12.0, blow = 1.5 * 5 / (1 / 2.0 + 1 + 0.75 * 0.75 / inertia);
    return std::abs(seen.last()[0].spin[2] / (-0.75 * blow / inertia) - 1);
}

/// A ball that falls by 5 m.
scene bounce(int d, double restitution, double seconds) {
    scene s = lasting(d, seconds);
    add_floor(s, 0, restitution);
    s.add(solid({0, 5.1, 0}, with(ball(0.1), 1, 0, restitution)));
    return s;
}
scene lively_bounce(int d) { return bounce(d, 0.8, 8); }
scene elastic_bounce(int d) { return bounce(d, 1, 20); }
/// Height of the ball's lowest point after t seconds.
double height_of_bounce(double t, double restitution) {
    double until = std::sqrt(2 * 5 / g), speed = g * until;
    if (t <= until) return 5 - g * t * t / 2;
    for (;;) {
        t -= until;
        speed *= restitution;
        until = 2 * speed / g;
        if (until < 1e-9) return 0;
        if (t <= until) return speed * t - g * t * t / 2;
    }
}
double miss_of_bounce(const scene&, const film& seen) {
    double sum = 0;
    for (std::size_t i = 0; i < seen.frames.size(); ++i)
        sum += std::abs(seen.frames[i][1].at[1] - 0.1 - height_of_bounce(static_cast<double>(i) * film::interval, 0.8));
    return sum / static_cast<double>(seen.frames.size());
}
double energy_of_bounce(const scene&, const film& seen) {
    return largest(seen, [&](const auto& states) {
        const state& b = states[1];
        return std::abs((dot(b.velocity, b.velocity) / 2 + g * (b.at[1] - 0.1)) / (g * 5) - 1);
    });
}

scene slide(int d) {
    scene s = lasting(d, 3);
    add_floor(s, 0.5);
    s.add(moving(solid({-20, 0.5, 0}, with(cube(), 1, 0.5)), {10, 0, 0}));
    return s;
}
double miss_of_slide(const scene&, const film& seen) { return std::abs(seen.last()[1].at[0] + 20 - 10); }

scene roll(int d) {
    scene s = lasting(d, 2);
    add_floor(s, 0.5);
    s.add(moving(solid({-20, 0.5, 0}, with(ball(0.5), 1, 0.5)), {10, 0, 0}));
    return s;
}
double speed_of_roll(const scene& s, const film& seen) {
    const double right = s.dimension == 2 ? 20 / 3.0 : 50 / 7.0;
    return std::abs(seen.last()[1].velocity[0] / right - 1);
}

/// On a slope of 20 degrees, seen along it.
scene creep(int d) {
    scene s = lasting(d, 10);
    const double slope = pi / 9, friction = 1.1 * std::tan(slope);
    s.gravity = {g * std::sin(slope), -g * std::cos(slope), 0};
    add_floor(s, friction);
    s.add(solid({0, 0.25, 0}, with(box({0.5, 0.25, 0.5}), 1, friction)));
    return s;
}
double way_of_creep(const scene& s, const film& seen) { return std::abs(seen.last()[1].at[0] - s.bodies[1].at[0]); }

scene heavy_on_light(int d) {
    scene s = lasting(d, 10);
    add_floor(s, 0.6);
    s.add(solid({0, 0.5, 0}, cube()));
    s.tops = {s.add(solid({0, 1.5, 0}, with(cube(), 100, 0.6)))};
    return s;
}
scene heavy_top(int d) {
    scene s = lasting(d, 10);
    add_floor(s, 0.6);
    for (int i = 0; i < 10; ++i) s.add(solid({0, 0.5 + i, 0}, with(cube(), i == 9 ? 100 : 1, 0.6)));
    s.tops = {10};
    return s;
}
/// How far tops have moved in any direction, of all times.
double way_of_tops(const scene& s, const film& seen) {
    return largest(seen, [&](const auto& states) {
        double most = 0;
        for (const int top : s.tops) {
            const auto i = static_cast<std::size_t>(top);
            const double way = length(states[i].at - s.bodies[i].at);
            if (!(way <= most)) most = way;
        }
        return most;
    });
}

/// K1: gaps between cubes close as they fall.
scene stack(int d) {
    scene s = lasting(d, 20);
    add_floor(s, 0.6);
    for (int i = 0; i < 15; ++i) s.add(solid({i % 2 == 0 ? -0.01 : 0.01, 0.55 + 1.1 * i, 0}, with(cube(), 1, 0.6)));
    return s;
}
double miss_of_stack(const scene& s, const film& seen) {
    const triple right = {s.bodies[15].at[0], 14.5, 0};
    return length(seen.last()[15].at - right);
}

scene touching_pyramid(int d) {
    scene s = lasting(d, 10);
    add_floor(s, 0.6);
    constexpr int base = 20;
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            s.tops.push_back(s.add(solid({1.05 * (i - (base - row - 1) / 2.0), 0.5 + row, 0}, with(cube(), 1, 0.6))));
    return s;
}

/// A bar that falls from level about a hinge at its end.
scene pendulum(int d) {
    scene s = lasting(d, 10);
    s.add(ground({0, 3, 0}, with(box({0.01, 0.01, 0.01}), 1, 0)));
    s.add(solid({1, 0, 0}, with(box({1, 0.05, 0.05}), 1, 0)));
    s.pin(0, 1, {0, 0, 0});
    return s;
}
double miss_of_pendulum(const scene&, const film& seen) {
    // theta'' = -k cos(theta), by Runge and Kutta, 1000 steps a frame.
    const long double inertia = (4 + 0.01L) / 12 + 1, k = g / inertia,
                      h = static_cast<long double>(film::interval) / 1000;
    long double angle = 0, rate = 0;
    const auto turn_of = [&](long double a) { return -k * std::cos(a); };
    double most = 0;
    for (const auto& states : seen.frames) {
        const triple right = {static_cast<double>(std::cos(angle)), static_cast<double>(std::sin(angle)), 0};
        const double miss = length(states[1].at - right);
        if (!(miss <= most)) most = miss;
        for (int i = 0; i < 1000; ++i) {
            const long double a1 = turn_of(angle), r1 = rate, a2 = turn_of(angle + h / 2 * r1), r2 = rate + h / 2 * a1,
                              a3 = turn_of(angle + h / 2 * r2), r3 = rate + h / 2 * a2, a4 = turn_of(angle + h * r3),
                              r4 = rate + h * a3;
            angle += h / 6 * (r1 + 2 * r2 + 2 * r3 + r4);
            rate += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
        }
    }
    return most;
}

/// A rope of ten links that swings from level.
scene rope(int d) {
    scene s = lasting(d, 2);
    shape link;
    link.kind = form::capsule;
    link.half = {0.2, 0, 0};
    link.radius = 0.05;
    int before = s.add(ground({0, 2, 0}, with(box({0.01, 0.01, 0.01}), 1, 0)));
    for (int i = 0; i < 10; ++i) {
        const int next = s.add(solid({0.25 + 0.5 * i, 0, 0}, with(link, 20, 0)));
        s.pin(before, next, {0.5 * i, 0, 0});
        before = next;
    }
    return s;
}
/// A box that is thrown with a spin onto a floor without friction, restitution 0.5.
scene thrown_box(int d) {
    scene s = lasting(d, 2);
    add_floor(s, 0, 0.5);
    body b = moving(solid({0, 2, 0}, with(box({0.5, 0.25, 0.35}), 1, 0, 0.5)), {3, 2, d == 3 ? 1.0 : 0.0});
    b.spin = {d == 3 ? 1.0 : 0.0, d == 3 ? -2.0 : 0.0, 3};
    s.add(b);
    return s;
}
/// J1 without damping: a ball of 672 times (3D: of 2,000 times) the mass of a link.
scene ball_and_chain(int d) {
    scene s = lasting(d, 20);
    shape link;
    link.kind = form::capsule;
    link.half = {0.5, 0, 0};
    link.radius = 0.125;
    int before = s.add(ground({0, 2, 0}, with(box({0.01, 0.01, 0.01}), 1, 0)));
    for (int i = 0; i < 40; ++i) {
        const int next = s.add(solid({0.5 + i, 0, 0}, with(link, 20, 0)));
        s.pin(before, next, {static_cast<double>(i), 0, 0});
        before = next;
    }
    const int end = s.add(solid({48, 0, 0}, with(ball(8), d == 2 ? 20 : 2.0 / 3, 0)));
    s.pin(before, end, {40, 0, 0});
    return s;
}
double gap_of_chain(const scene& s, const film& seen) {
    return largest(seen, [&](const auto& states) {
        double most = 0;
        for (const joint& j : s.joints) {
            const state &a = states[static_cast<std::size_t>(j.a)], &b = states[static_cast<std::size_t>(j.b)];
            const double gap = length(b.at + rotated(b.rotation, j.point_b) - a.at - rotated(a.rotation, j.point_a));
            if (!(gap <= most)) most = gap;
        }
        return most;
    });
}

}  // namespace

double distance_of(const film& a, const film& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.frames.size(); ++i)
        for (std::size_t k = 0; k < a.frames[i].size(); ++k) {
            const double apart = length(a.frames[i][k].at - b.frames[i][k].at);
            if (!(apart <= most)) most = apart;
        }
    return most;
}

const std::vector<question>& questions() {
    struct row {
        const char *name, *about, *metric;
        double visible, broken;
        scene (*make)(int);
        double (*error)(const scene&, const film&);
        bool flat, solid;
    };
    static const row rows[] = {
        {"projectile", "a thrown ball, 10 s", "distance from the parabola's end (m)", 5e-3, 100, projectile,
         miss_of_projectile, true, true},
        {"tumble", "a free box that flips over (Dzhanibekov), 10 s",
         "largest relative error of its energy and angular momentum", 1e-2, 1, tumble, change_of_tumble, false, true},
        {"impact", "a ball hits a free box off its centre, restitution 0.5", "relative error of the box's spin", 1e-2,
         0.9, impact, spin_after_impact, true, true},
        {"bounce", "a ball falls by 5 m, restitution 0.8, 8 s", "mean distance from the right height (m)", 5e-3, 5,
         lively_bounce, miss_of_bounce, true, true},
        {"elastic_bounce", "the same, restitution 1, 20 s", "largest relative error of its energy", 1e-2, 0.9,
         elastic_bounce, energy_of_bounce, true, true},
        {"slide", "a cube slides until friction has stopped it", "error of its way of 10 m (m)", 5e-3, 5, slide,
         miss_of_slide, true, true},
        {"roll", "a ball slides until it rolls", "relative error of its speed", 1e-2, 0.3, roll, speed_of_roll, true,
         true},
        {"creep", "a block rests on a slope of 20 degrees, friction 1.1 of what it needs, 10 s",
         "how far it has crept (m)", 5e-3, 1, creep, way_of_creep, true, true},
        {"heavy_on_light", "a cube on one of a hundredth of its mass, 10 s", "largest displacement (m)", 5e-3, 0.5,
         heavy_on_light, way_of_tops, true, true},
        {"heavy_top", "ten cubes, the top one of 100 times the mass, 10 s", "its largest displacement (m)", 5e-3, 0.9,
         heavy_top, way_of_tops, true, true},
        {"stack", "15 cubes fall onto each other, 1 cm to the left and right, 20 s",
         "distance of the top one from where it belongs (m)", 5e-3, 0.9, stack, miss_of_stack, true, true},
        {"pyramid", "20 rows of cubes, 10 s", "largest displacement of any (m)", 5e-3, 0.9, touching_pyramid,
         way_of_tops, true, true},
        {"pendulum", "a bar falls from level about its end, 10 s", "largest distance from where it should be (m)", 5e-3,
         1.9, pendulum, miss_of_pendulum, true, true},
        {"ball_and_chain", "a chain of 40 links swings a ball of hundreds of times their mass, 20 s",
         "largest gap of any joint (m)", 5e-3, 1, ball_and_chain, gap_of_chain, true, true},
        {"rope", "a rope of ten links swings from level, 2 s", "largest distance of a link from the reference (m)",
         5e-3, 1, rope, nullptr, true, true},
        {"thrown_box", "a box is thrown with a spin onto a slippery floor, restitution 0.5, 2 s",
         "largest distance from the reference (m)", 5e-3, 1, thrown_box, nullptr, true, true},
    };
    static const std::vector<question> all = [] {
        std::vector<question> made;
        for (const row& r : rows)
            for (const int d : {2, 3}) {
                if (!(d == 2 ? r.flat : r.solid)) continue;
                question q{r.name, r.about, r.metric, r.visible, r.broken, r.make(d), r.error};
                if (d == 3) q.name += "3";
                q.played.name = q.name;
                made.push_back(q);
            }
        return made;
    }();
    return all;
}

}  // namespace bench
