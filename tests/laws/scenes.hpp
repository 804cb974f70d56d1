// Scenes with exact answers: free motion, impact, friction, rest.
#pragma once

#include <cmath>
#include <vector>

#include "../../samples/scenes.hpp"
#include "cell.hpp"

namespace {
namespace scenes_laws {

struct scene : physics::recipe<cell::scalar, cell::dimension> {};
using world = physics::world<scene>;
using S = cell::scalar;
using vec = world::vec;

double number(S x) { return cell::number(x); }
vec along(int axis, double size) {
    vec v;
    v[axis] = S(size);
    return v;
}
/// The part of an angular velocity that turns x towards y, and a rotation that does so.
template <class Angular>
double about_z(const Angular& w) {
    if constexpr (cell::is_2d) return number(w);
    else return number(w.z);
}
template <class Rotation = world::rotation_type>
Rotation turned_about_z(double angle) {
    if constexpr (cell::is_2d) return Rotation::from_angle(S(angle));
    else return Rotation::from_axis_angle({S(0), S(0), S(1)}, S(angle));
}
/// Settings of all scenes: nobody sleeps, so that what stands does so of itself.
world::settings_type wakeful() {
    world::settings_type settings;
    settings.sleeping.enabled = false;
    return settings;
}
/// Settings for scenes that have to bounce at any speed.
world::settings_type weightless() {
    world::settings_type settings = wakeful();
    settings.gravity = {};
    settings.solver.restitution_threshold = S(0);
    return settings;
}
world::settings_type bouncing() {
    world::settings_type settings = weightless();
    settings.gravity.y = S(-10);
    return settings;
}
const int substeps = world::settings_type{}.solver.substeps;

/// Rounding of n additions to numbers as large as size.
double drift(double n, double size) { return n * std::max(1.0, size) * number(cell::traits::epsilon()); }

/// A world of one surface with friction and bounce, tilted by an angle about z (0: level).
world slope(double angle, double friction, double restitution = 0, world::settings_type settings = bouncing()) {
    world w(settings);
    world::halfspace ground;
    ground.normal.x = S(-std::sin(angle));
    ground.normal.y = S(std::cos(angle));
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), ground,
                   {.material = {.friction = S(friction), .restitution = S(restitution)}});
    return w;
}

CELL_CASE("F1 projectile: symplectic Euler is off by g t h / 2 of a substep, not more") {
    world w(bouncing());
    const S h(1.0 / 64);
    const int steps = 640;
    world::body_def def;
    def.linear_velocity = along(0, 10) + along(1, 10);
    const auto b = w.create_body(def);
    for (int i = 0; i < steps; ++i) w.step(h);
    const double t = 10;
    const vec p = w.position(b);
    CHECK(std::abs(number(p.x) - 100) <= drift(steps, 100));
    CHECK(std::abs(number(p.y) - (10 * t - 5 * t * t - 5 * t / 64 / substeps)) <= drift(steps, 400));
    CHECK(std::abs(number(w.linear_velocity(b).y) + 90) <= drift(steps, 90));
}

CELL_CASE("F1 projectile: damping converges to the exact decay and stays bounded for any rate") {
    for (const double c : {0.1, 1.0, 1000.0}) {
        CAPTURE(c);
        double error[2] = {};
        for (int fine = 0; fine < 2; ++fine) {
            world w(bouncing());
            const double h = fine ? 1.0 / 256 : 1.0 / 64;
            world::body_def def;
            def.linear_velocity = along(1, 10);
            def.linear_damping = S(c);
            const auto b = w.create_body(def);
            for (int i = 0; i < (fine ? 2560 : 640); ++i) {
                w.step(S(h));
                REQUIRE(std::abs(number(w.linear_velocity(b).y)) <= 100 + 10 * h);
            }
            const double end = -10 / c;
            error[fine] = std::abs(number(w.linear_velocity(b).y) - (end + (10 - end) * std::exp(-c * 10)));
        }
        // First order in h, while the rate is small against the steps.
        if (c <= 1) CHECK(error[1] <= 0.3 * error[0] + drift(2560, 100));
        CHECK(error[1] <= 10.0 / 256 + drift(2560, 100));
    }
}

CELL_CASE("F2 oscillator: energy stays bounded, its error falls with the first order of h, the phase is the scheme's") {
    const double pi = 3.14159265358979323846, omega = 2 * pi;
    double worst[2] = {};
    for (int fine = 0; fine < 2; ++fine) {
        const double h = fine ? 1.0 / 256 : 1.0 / 64;
        const int steps = static_cast<int>(20 / h);
        world w(weightless());
        world::body_def def;
        def.position = along(0, 1);
        const auto b = w.create_body(def);
        const double cosine = 1 - 0.5 * std::pow(omega * h, 2);
        double before = 1, last = 1;
        for (int i = 0; i < steps; ++i) {
            const double x = number(w.position(b).x);
            // x'' = -omega^2 x in symplectic Euler is the recurrence x+ = 2 cos(phi) x - x-, cos(phi) = 1 - (omega h)^2
            // / 2.
            if (i > 0)
                CHECK(std::abs(x - (i == 1 ? cosine * 2 * last - before : 2 * cosine * last - before)) <=
                      (i == 1 ? 0.51 * std::pow(omega * h, 2) : 0) + 64 * drift(1, 1));
            before = i == 0 ? 1 : last;
            last = x;
            w.apply_force(b, w.position(b) * S(-omega * omega));
            w.step(S(h));
            const double v = number(w.linear_velocity(b).x), y = number(w.position(b).x);
            worst[fine] = std::max(worst[fine], std::abs((v * v / (omega * omega) + y * y) - 1));
        }
    }
    CHECK(worst[0] <= 0.55 * omega / 64);
    CHECK(worst[1] <= 0.3 * worst[0] + drift(5120, 1));
}

#if CELL_DIMENSION == 3
CELL_CASE("F4 torque-free box: angular momentum is kept to rounding, energy to a thousandth, and it tips over") {
    using vec3 = physics::vec<S, 3>;
    world w(weightless());
    const auto b = w.create_body({.angular_velocity = vec3{S(0.1), S(5), S(0.1)}});
    const auto i = [](double p, double q) { return S(10.0 / 12 * (p * p + q * q)); };
    w.set_mass(b, {S(10), {}, physics::symmetric<S>::diagonal(i(0.4, 0.9), i(0.1, 0.9), i(0.1, 0.4))});
    const auto spin = [&] { return inverse_rotate(w.rotation(b), w.angular_velocity(b)); };
    const auto momentum = [&] { return w.rotation(b) * times(w.mass(b).inertia, spin()); };
    const auto energy = [&] { return number(dot(times(w.mass(b).inertia, spin()), spin())) / 2; };
    const vec3 momentum0 = momentum();
    const double energy0 = energy();
    bool tipped = false;
    double most_lost = 0, most_gained = 0;
    for (int k = 1; k <= 6000; ++k) {
        w.step(S(1.0 / 60));
        // Roundings add up as a random walk does.
        const double walk = drift(16 * std::sqrt(double(k)), number(length(momentum0)));
        most_lost = std::max(most_lost, number(length(momentum() - momentum0)) / walk);
        most_gained = std::max(most_gained, std::abs(energy() / energy0 - 1));
        tipped = tipped || spin().y < S(-4);
    }
    CHECK(most_lost <= 1);
    CHECK(most_gained <= 1e-3);
    CHECK(tipped);
}

CELL_CASE("X5 spin: a rod as thin as a needle keeps its energy and momentum") {
    for (const double speed : {20.0, 1e2, 1e4}) {
        CAPTURE(speed);
        world w(weightless());
        const auto b = w.create_body({.angular_velocity = physics::vec<S, 3>{S(0), S(0.25 * speed), S(speed)}});
        w.create_shape(b, world::box{{S(2), S(0.02), S(0.02)}});
        const auto spin = [&] { return inverse_rotate(w.rotation(b), w.angular_velocity(b)); };
        const auto momentum = [&] { return w.rotation(b) * times(w.mass(b).inertia, spin()); };
        const auto energy = [&] { return number(dot(times(w.mass(b).inertia, spin()), spin())); };
        const auto momentum0 = momentum();
        const double energy0 = energy();
        for (int k = 0; k < 600; ++k) w.step(S(1.0 / 60));
        // What is lost of it is rounding, of products with a unit of it.
        const double loss = drift(16 * 600, 1) * (cell::is_fixed ? 4 : 1);
        CHECK(number(length(momentum() - momentum0)) <= loss * number(length(momentum0)));
        CHECK(std::abs(energy() / energy0 - 1) <= 2 * loss);
    }
}

CELL_CASE("X5 spin: no energy is gained up to 10^4 rad/s") {
    for (const double speed : {1e2, 1e3, 1e4}) {
        CAPTURE(speed);
        world w(weightless());
        const auto b =
            w.create_body({.angular_velocity = physics::vec<S, 3>{S(0.1 * speed), S(speed), S(0.2 * speed)}});
        w.create_shape(b, world::box{{S(0.05), S(0.2), S(0.45)}});
        const double limit = number(physics::length(w.angular_velocity(b)));
        const auto inertia = w.mass(b).inertia;
        // With the momentum kept, spin can grow at most to that about the axis of least inertia.
        const double most = limit * number(physics::max(inertia.xx, physics::max(inertia.yy, inertia.zz))) /
                            number(physics::min(inertia.xx, physics::min(inertia.yy, inertia.zz)));
        const auto momentum = [&] {
            const auto r = w.rotation(b);
            return number(physics::length(r * times(inertia, inverse_rotate(r, w.angular_velocity(b)))));
        };
        const double momentum0 = momentum();
        for (int k = 0; k < 600; ++k) {
            w.step(S(1.0 / 60));
            CHECK(number(physics::length(w.angular_velocity(b))) <= most);
        }
        CHECK(std::abs(momentum() / momentum0 - 1) <= drift(16 * 600, 1));
        CHECK(number(norm_error(w.rotation(b))) <= 16 * number(cell::traits::epsilon()));
    }
}
#endif

CELL_CASE("C1 off-centre impact: impulse, momentum and spin are exact for every restitution") {
    for (const double e : {0.0, 0.5, 1.0}) {
        CAPTURE(e);
        world w(weightless());
        const auto a = w.create_body();
        vec half = vec::filled(S(0.5));
        half.x = S(1);
        const physics::material<S, cell::dimension> surface{.friction = S(0), .restitution = S(e)};
        w.create_shape(a, world::box{half}, {.density = S(1), .material = surface});
        world::body_def def;
        def.position = along(0, 0.75) + along(1, 1);
        def.linear_velocity = along(1, -5);
        const auto b = w.create_body(def);
        w.create_shape(b, world::ball{S(0.5)}, {.material = surface});
        auto mass = w.mass(b);
        mass.mass = S(1);
        w.set_mass(b, mass);
        w.step(S(1.0 / 64));
        const double j = (1 + e) * 5 / (0.5 + 1 + 0.75 * 0.75 / (2 * 5.0 / 12));
        const double close = drift(64, 5);
        CHECK(std::abs(number(w.linear_velocity(a).y) + j / 2) <= close);
        CHECK(std::abs(number(w.linear_velocity(b).y) - (j - 5)) <= close);
        CHECK(std::abs(about_z(w.angular_velocity(a)) + 0.75 * j / (2 * 5.0 / 12)) <= close);
        CHECK(std::abs(2 * number(w.linear_velocity(a).y) + number(w.linear_velocity(b).y) + 5) <= close);
    }
}

CELL_CASE("C2 bounce: heights fall with the square of the restitution, and no bounce gains height") {
    for (const double e : {0.0, 0.5, 0.9, 1.0})
        for (const double h : {1.0 / 64, 1.0 / 256}) {
            CAPTURE(e);
            CAPTURE(h);
            world w = slope(0, 0, e);
            const auto b = w.create_body({.position = along(1, 5.1)});
            w.create_shape(b, world::ball{S(0.1)}, {.material = {.restitution = S(e)}});
            std::vector<double> peaks;
            double before = 0, settled = 0;
            const double end = e == 0.5 ? 5 : 7;
            for (double t = 0; t < end; t += h) {
                w.step(S(h));
                const double v = number(w.linear_velocity(b).y);
                if (before > 0 && v <= 0 && peaks.size() < 4) peaks.push_back(number(w.position(b).y) - 0.1);
                before = v;
                if (std::abs(v) > 0.1) settled = t + h;
            }
            for (std::size_t n = 0; n < peaks.size(); ++n) {
                CAPTURE(n);
                // A bounce is seen up to one step early or late: v h of way, once a bounce.
                CHECK(std::abs(peaks[n] - 5 * std::pow(e, 2.0 * double(n + 1))) <= 10 * h * double(n + 1));
                CHECK(peaks[n] <= 5 * 1.001);
            }
            if (e == 1) CHECK(peaks.size() == 3);
            if (e == 0) CHECK(std::abs(number(w.position(b).y) - 0.1) <= 0.006);
            // Rest after (1 + e) / (1 - e) seconds.
            if (e == 0.5) CHECK(std::abs(settled - 3) <= 16 * h);
        }
}

CELL_CASE("S1 slide: a cube stops after v^2 / (2 mu g) less half a substep, in every direction") {
    const int directions = cell::is_2d ? 2 : 12;
    const double h = 1.0 / 64;
    for (int k = 0; k < directions; ++k) {
        CAPTURE(k);
        world w = slope(0, 0.5);
        const double angle = 2 * 3.14159265358979323846 * k / directions;
        world::body_def def;
        def.position = along(1, 0.5);
        def.linear_velocity = along(0, 10 * std::cos(angle));
        if constexpr (cell::is_3d) def.linear_velocity = def.linear_velocity + along(2, 10 * std::sin(angle));
        const auto b = w.create_body(def);
        w.create_shape(b, world::box{vec::filled(S(0.5))}, {.material = {.friction = S(0.5)}});
        for (int i = 0; i < 192; ++i) w.step(S(h));
        const vec displacement = w.position(b) - along(1, 0.5);
        const double x = number(displacement.x), z = cell::is_3d ? number(displacement[cell::dimension - 1]) : 0;
        const double distance = std::sqrt(x * x + z * z);
        CHECK(std::abs(distance - (10 - 0.5 * 10 * h / substeps)) <= 0.01);
        CHECK(std::abs(x * std::sin(angle) - z * std::cos(angle)) <= 0.01);
    }
}

CELL_CASE("S2 incline: a block slips where mu < tan(angle), and does not creep where it holds") {
    const double angle = 20 * 3.14159265358979323846 / 180;
    const auto slip = [&](double mu, int steps) {
        world w = slope(angle, mu);
        world::body_def def;
        def.position = along(0, -0.25 * std::sin(angle)) + along(1, 0.25 * std::cos(angle));
        def.rotation = turned_about_z(angle);
        const auto b = w.create_body(def);
        vec half = vec::filled(S(0.25));
        half.x = S(0.5);
        w.create_shape(b, world::box{half}, {.material = {.friction = S(mu)}});
        const vec start = w.position(b);
        for (int i = 0; i < 60; ++i) w.step(S(1.0 / 60));
        const vec settled = w.position(b);
        for (int i = 60; i < steps; ++i) w.step(S(1.0 / 60));
        return std::pair{number(physics::length(w.position(b) - start)),
                         number(physics::length(w.position(b) - settled))};
    };
    double low = 0.9 * std::tan(angle), high = 1.1 * std::tan(angle);
    CHECK(slip(low, 300).first > 0.1);
    CHECK(slip(high, 600).second <= 0.001);
    for (int i = 0; i < 6; ++i) {
        const double mu = 0.5 * (low + high);
        (slip(mu, 300).first > 0.1 ? low : high) = mu;
    }
    CHECK(std::abs(0.5 * (low + high) / std::tan(angle) - 1) <= 0.005);
}

CELL_CASE("S3 rolling: a sliding ball ends at 5/7 (2D: 2/3) of its speed, an incline rolls it at 5/7 (2/3) of g sin") {
    const double share = cell::is_2d ? 2.0 / 3 : 5.0 / 7;
    const double h = 1.0 / 64;
    const auto roller = [&](world& w, vec at, double speed) {
        world::body_def def;
        def.position = at;
        def.linear_velocity = along(0, speed);
        const auto b = w.create_body(def);
        w.create_shape(b, world::ball{S(0.5)}, {.material = {.friction = S(0.5)}});
        return b;
    };
    world level = slope(0, 0.5);
    const auto b = roller(level, along(1, 0.5), 10);
    for (int i = 0; i < 64; ++i) level.step(S(h));
    CHECK(std::abs(number(level.linear_velocity(b).x) - 10 * share) <= 0.01);
    const vec bottom = level.velocity_at(b, level.position(b) - along(1, 0.5));
    CHECK(std::abs(number(bottom.x)) <= 0.01);

    const double angle = 20 * 3.14159265358979323846 / 180;
    world steep = slope(angle, 0.5);
    const auto c = roller(steep, along(0, -0.5 * std::sin(angle)) + along(1, 0.5 * std::cos(angle)), 0);
    for (int i = 0; i < 128; ++i) steep.step(S(h));
    CHECK(std::abs(number(physics::length(steep.linear_velocity(c))) - 2 * share * 10 * std::sin(angle)) <= 0.02);
}

/// Steps for 20 s and checks that the scene stands: nothing overlaps deeply, nothing wanders, all is calm.
void stands(world& w) {
    std::vector<vec> start;
    for (const auto id : w.bodies()) start.push_back(w.position(id));
    for (int i = 0; i < 1200; ++i) {
        w.step(S(1.0 / 60));
        if (i % 60 == 0) REQUIRE(scenes::deepest_overlap(w) <= 0.02);
    }
    double farthest = 0;
    std::size_t k = 0;
    for (const auto id : w.bodies())
        farthest = std::max(farthest, number(physics::length(w.position(id) - start[k++])));
    CHECK(farthest <= 0.05);
    CHECK(scenes::kinetic_energy(w) <= 1e-3 * double(start.size()));
}

CELL_CASE("a stack of 10 boxes stands for 20 s") {
    world w = scenes::grounded<world>(wakeful());
    scenes::stack(w, 10);
    stands(w);
}

CELL_CASE("a pyramid of 10 rows stands for 20 s") {
    world w = scenes::grounded<world>(wakeful());
    scenes::pyramid(w, 10);
    stands(w);
}

}  // namespace scenes_laws
}  // namespace
