// Laws of derivatives: in dual numbers a world tells how its motion depends on what it began with.
#include <doctest/doctest.h>
#include <array>
#include <cmath>

#include "../../samples/dual.hpp"

namespace {

/// What is thrown, and on what it lands.
struct scene {
    bool is_box, on_box;
    double height, restitution;
    int substeps, steps;
};

// Swept motion finds times of impact in doubles.
template <class S, int D>
struct throws : physics::recipe<S, D, physics::shapes<physics::ball, physics::box, physics::halfspace>,
                                physics::without<physics::feature::continuous>> {};

template <int D, class S>
physics::vec<S, D> sideways(S x) {
    physics::vec<S, D> v;
    v[0] = x;
    return v;
}

/// Where a body is and how fast, and in 2D how it is turned, that begins with that speed sideways.
template <class S, int D>
std::array<S, 6> thrown(const scene& of, S speed) {
    using world = physics::world<throws<S, D>>;
    using vec = physics::vec<S, D>;
    const auto up = [](double y) {
        vec v;
        v[1] = S(y);
        return v;
    };
    typename world::settings_type settings;
    settings.gravity = up(-10);
    settings.solver.substeps = of.substeps;
    world w(settings);
    const physics::body_id ground = w.create_body({.type = physics::body_type::static_body, .position = up(-1)});
    typename world::shape_def def;
    def.material = {S(0.6), S(of.restitution)};
    if (of.on_box) {
        vec half = vec::filled(S(20));
        half[1] = S(1);
        w.create_shape(ground, typename world::box{half}, def);
    } else {
        def.position = up(1);
        w.create_shape(ground, typename world::halfspace{up(1)}, def);
        def.position = {};
    }
    const physics::body_id body =
        w.create_body({.position = up(of.height), .linear_velocity = sideways<D>(speed) + up(2), .can_sleep = false});
    if (of.is_box) w.create_shape(body, typename world::box{vec::filled(S(0.5))}, def);
    else w.create_shape(body, typename world::ball{S(0.5)}, def);
    w.set_damping(body, S(0.1), S(0.2));
    for (int i = 0; i < of.steps; ++i) w.step(S(1.0 / 64));
    const auto pose = w.pose(body);
    const vec v = w.linear_velocity(body);
    std::array<S, 6> result{pose.position[0], pose.position[1], v[0], v[1]};
    if constexpr (D == 2) result[4] = pose.rotation.sine, result[5] = w.angular_velocity(body);
    return result;
}

template <int D>
void slopes_are_right(const scene& of) {
    CAPTURE(of.is_box);
    CAPTURE(of.on_box);
    CAPTURE(of.height);
    CAPTURE(of.restitution);
    CAPTURE(of.substeps);
    CAPTURE(of.steps);
    constexpr double speed = 3, by = 1e-5;
    const auto exact = thrown<dual, D>(of, {speed, 1});
    const auto same = thrown<double, D>(of, speed);
    const auto more = thrown<double, D>(of, speed + by), less = thrown<double, D>(of, speed - by);
    for (std::size_t i = 0; i < exact.size(); ++i) {
        CAPTURE(i);
        CHECK(exact[i].value == same[i]);
        CHECK(std::abs(exact[i].slope - (more[i] - less[i]) / (2 * by)) < 1e-6);
    }
}

TEST_CASE("derivatives: of what flies, falls, bounces, rolls and slides they are those of differences") {
    for (const bool is_box : {false, true})
        for (const bool on_box : {false, true})
            for (const double restitution : {0.0, 0.6})
                // In the air, after a landing, and long after.
                for (const int steps : {64, 96, 160}) {
                    slopes_are_right<2>({is_box, on_box, 5, restitution, 4, steps});
                    // A cube that has tumbled comes to rest flat, in jumps: there differences do not converge.
                    if (is_box && restitution == 0 && steps == 160) continue;
                    slopes_are_right<3>({is_box, on_box, 5, restitution, 4, steps});
                }
}

template <class S, int D>
struct hangs : physics::recipe<S, D, physics::shapes<physics::box>,
                               physics::joints<physics::ball_joint, physics::revolute_joint>> {};
/// Where the end of two boxes on joints is after a second, that begins with that speed.
template <class S, int D>
std::array<S, 2> swung(bool direct, S speed) {
    using world = physics::world<hangs<S, D>>;
    typename world::settings_type settings;
    settings.gravity[1] = S(-10);
    if (!direct) settings.solver.max_direct_cost = 0;
    world w(settings);
    const auto half = sideways<D>(S(0.5)), whole = half + half;
    const auto add = [&](const auto& where) {
        const physics::body_id body = w.create_body({.position = where, .can_sleep = false});
        w.set_mass(body, physics::mass_of(typename world::box{physics::vec<S, D>::filled(S(0.25))}, S(2)));
        return body;
    };
    const physics::body_id a = add(half), b = add(whole + half);
    w.create_joint(w.create_body({.type = physics::body_type::static_body}), a,
                   typename world::revolute_joint{.frame_b = {-half, {}}});
    w.create_joint(a, b, typename world::ball_joint{half, -half});
    physics::vec<S, D> v;
    v[1] = speed;
    w.set_linear_velocity(b, v);
    for (int i = 0; i < 60; ++i) w.step(S(1.0 / 60));
    return {w.position(b)[0], w.position(b)[1]};
}
template <int D>
void swings_have_their_slopes(bool direct) {
    const auto exact = swung<dual, D>(direct, {1, 1});
    const auto same = swung<double, D>(direct, 1.0);
    const auto more = swung<double, D>(direct, 1 + 1e-5), less = swung<double, D>(direct, 1 - 1e-5);
    for (std::size_t i = 0; i < exact.size(); ++i) {
        CHECK(exact[i].value == same[i]);
        if (!direct) CHECK(std::abs(exact[i].slope - (more[i] - less[i]) / 2e-5) < 1e-6);
    }
}
TEST_CASE("derivatives: joints have the bits of doubles, and by iterations the slopes of differences") {
    for (const bool direct : {false, true}) {
        swings_have_their_slopes<2>(direct);
        swings_have_their_slopes<3>(direct);
    }
}

TEST_CASE("derivatives: dual numbers that change by nothing have the bits of doubles") {
    const scene of{true, true, 0.5, 0.2, 2, 128};
    const auto still = thrown<dual, 3>(of, dual(3.0));
    const auto plain = thrown<double, 3>(of, 3.0);
    for (std::size_t i = 0; i < plain.size(); ++i) {
        CHECK(still[i].value == plain[i]);
        CHECK(still[i].slope == 0);
    }
}

}  // namespace
