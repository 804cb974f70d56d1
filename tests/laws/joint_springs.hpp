// Laws of springs that are given by a stiffness and a damping: whatever the masses are, in all kinds that have springs.
#pragma once

#include "laws/joint_axes.hpp"

namespace {
namespace spring_laws {

using namespace axis_laws;
using prismatic_joint = physics::prismatic_joint<S, D>;
using revolute_joint = physics::revolute_joint<S, D>;
using weld_joint = physics::weld_joint<S, D>;
using wheel_joint = physics::wheel_joint<S, D>;
using motor_joint = physics::motor_joint<S, D>;
using target_joint = physics::target_joint<S, D>;

using plain = physics::world<joined<>>;
using hard = physics::world<joined<physics::sequential_impulse>>;

/// Kinds whose spring holds B at (0, -1) in the frame of A.
constexpr int lengths = 7;
template <class World>
joint_id hold(World& w, body_id a, body_id b, int kind, double stiffness, double damping) {
    const S k = S(stiffness), c = S(damping);
    const transform there{at(0, -1), {}}, down = frame(0, -1, -pi / 2), turned = frame(0, 0, -pi / 2);
    six_degrees_joint axes;
    axes.frame_a = there;
    axes.x = joint_axis::locked();
    axes.y.stiffness = k;
    axes.y.damping = c;
    switch (kind) {
        case 0: return w.create_joint(a, b, distance_joint{.stiffness = k, .damping = c});
        case 1:
            return w.create_joint(a, b,
                                  prismatic_joint{.frame_a = down, .frame_b = turned, .stiffness = k, .damping = c});
        case 2:
            return w.create_joint(a, b, wheel_joint{.frame_a = down, .frame_b = turned, .stiffness = k, .damping = c});
        case 3: return w.create_joint(a, b, weld_joint{.frame_a = there, .linear_stiffness = k, .linear_damping = c});
        case 4: return w.create_joint(a, b, motor_joint{.frame_a = there, .linear_stiffness = k, .linear_damping = c});
        case 5: return w.create_joint(a, b, target_joint{.target = at(0, -1), .stiffness = k, .damping = c});
        default: return w.create_joint(a, b, axes);
    }
}
/// A box of that mass.
template <class World>
body_id add_mass(World& w, const vec& where, double mass) {
    const body_id b = w.create_body({.position = where});
    w.create_shape(b, typename World::box{vec::filled(S(0.25))}, {.density = S(mass / (D == 2 ? 0.25 : 0.125))});
    return b;
}

template <class World>
void it_sags_by_its_load(int kind, double mass, int substeps, bool direct) {
    World w = falling_by<World>(substeps, direct);
    const body_id a = add_anchor(w, at(0, 0)), b = add_mass(w, at(0, -1), mass);
    const double stiffness = 400;
    const joint_id j = hold(w, a, b, kind, stiffness, std::sqrt(stiffness * mass));
    run(w, 640);
    CHECK(length_of(w.position(b) - at(0, -1 - mass * gravity / stiffness)) < 1e-3);
    CHECK(std::abs(number(w.reaction(j).force[1]) - mass * gravity) < 2e-3 * mass * gravity);
}
CELL_CASE("joint springs: a load sags by its weight and the stiffness, in all kinds of springs") {
    for (int kind = 0; kind < lengths; ++kind)
        for (const double mass : {0.25, 1.0, 16.0})
            for (const int substeps : {1, 4})
                for (const bool direct : {true, false}) {
                    CAPTURE(kind);
                    CAPTURE(mass);
                    CAPTURE(substeps);
                    CAPTURE(direct);
                    it_sags_by_its_load<plain>(kind, mass, substeps, direct);
                    if (kind == 0) it_sags_by_its_load<hard>(kind, mass, substeps, direct);
                }
}

/// Along the spring, from where it rests; half of a second later than it was let go from 0.125 m.
inline double after_half_a_second(double stiffness, double damping, double mass) {
    const double decay = damping / (2 * mass), omega = std::sqrt(stiffness / mass - decay * decay);
    return 0.125 * std::exp(-decay / 2) * (std::cos(omega / 2) + decay / omega * std::sin(omega / 2));
}
CELL_CASE("joint springs: a mass swings by the root of stiffness over mass, and decays by damping over mass") {
    for (int kind = 0; kind < lengths; ++kind)
        for (const double mass : {0.25, 1.0, 16.0})
            for (const double damping : {0.0, 2.0})
                for (const bool direct : {true, false}) {
                    CAPTURE(kind);
                    CAPTURE(mass);
                    CAPTURE(damping);
                    CAPTURE(direct);
                    const int substeps = 16;
                    plain w = falling_by<plain>(substeps, direct);
                    auto settings = w.settings();
                    settings.gravity = {};
                    w.set_settings(settings);
                    const body_id a = add_anchor(w, at(0, 0)), b = add_mass(w, at(0, -1.125), mass);
                    hold(w, a, b, kind, 100, damping);
                    run(w, 32);
                    // A mass is let go half of a substep early.
                    const double expected = after_half_a_second(100, damping, mass),
                                 slack = 0.125 * std::sqrt(100 / mass) / 64 / substeps;
                    CHECK(std::abs(-1 - number(w.position(b)[1]) - expected) < 0.75 * slack);
                }
}
CELL_CASE("joint springs: two bodies swing by their reduced mass") {
    plain w = falling<plain>(16, 0);
    const body_id a = add_mass(w, at(0, 0), 1), b = add_mass(w, at(0, -1.125), 3);
    w.create_joint(a, b, distance_joint{.stiffness = S(100)});
    run(w, 32);
    CHECK(std::abs(distance_of(w, a, b) - 1 - after_half_a_second(100, 0, 0.75)) < 1.5e-3);
}

CELL_CASE("joint springs: a damper without a stiffness lets fall at a speed") {
    for (const double mass : {0.5, 2.0})
        for (const int substeps : {1, 4}) {
            plain w = falling<plain>(substeps);
            const body_id a = add_anchor(w, at(0, 0)), b = add_mass(w, at(0, -1), mass);
            w.create_joint(a, b, distance_joint{.damping = S(10)});
            run(w, 192);
            CHECK(std::abs(number(w.linear_velocity(b)[1]) + mass) < 1e-3);
        }
}

/// Kinds whose spring turns B about z.
constexpr int angles = D == 3 ? 5 : 4;
template <class World>
void hold_turned(World& w, body_id a, body_id b, int kind, double stiffness, double damping) {
    const S k = S(stiffness), c = S(damping);
    six_degrees_joint axes;
    axes.angle_z.stiffness = k;
    axes.angle_z.damping = c;
    axes.x = axes.y = joint_axis::locked();
    switch (kind) {
        case 0: w.create_joint(a, b, revolute_joint{.stiffness = k, .damping = c}); return;
        case 1: w.create_joint(a, b, weld_joint{.angular_stiffness = k, .angular_damping = c}); return;
        case 2: w.create_joint(a, b, motor_joint{.angular_stiffness = k, .angular_damping = c}); return;
#if CELL_DIMENSION == 3
        case 4: w.create_joint(a, b, physics::swing_twist_joint<S, 3>{.stiffness = k, .damping = c}); return;
#endif
        default:
#if CELL_DIMENSION == 3
            axes.angle_x = axes.angle_y = joint_axis::locked();
#endif
            w.create_joint(a, b, axes);
    }
}
CELL_CASE("joint springs: a wheel turns by the root of stiffness over inertia, in all kinds of springs") {
    for (int kind = 0; kind < angles; ++kind)
        for (const double damping : {0.0, 2.0})
            for (const bool direct : {true, false}) {
                CAPTURE(kind);
                CAPTURE(damping);
                CAPTURE(direct);
                plain w = falling_by<plain>(16, direct);
                const body_id a = add_anchor(w, at(0, 0)), b = add_flywheel(w, at(0, 0));
                w.set_pose(b, at(0, 0), turn(0.125));
                auto settings = w.settings();
                settings.gravity = {};
                w.set_settings(settings);
                hold_turned(w, a, b, kind, 100, damping);
                run(w, 32);
                const vec x = w.pose(b).rotation * at(1);
                CHECK(std::abs(std::atan2(number(x[1]), number(x[0])) - after_half_a_second(100, damping, 1)) < 1.5e-3);
            }
}

CELL_CASE("joint springs: both spellings at once are refused, and bad ones, by name") {
    plain w = falling<plain>();
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(1));
    const auto refuses = [&](const char* field, const auto& joint) { is_refused(w, a, b, field, joint); };
    const S one = S(1), bad = S(-1);
    refuses("stiffness is 1; beside frequency and", distance_joint{.frequency = one, .stiffness = one});
    refuses("damping is 1; beside frequency and damping_ratio", revolute_joint{.damping_ratio = one, .damping = one});
    refuses("stiffness is 1; beside frequency", prismatic_joint{.frequency = one, .stiffness = one});
    refuses("stiffness is 1; beside frequency", wheel_joint{.frequency = one, .stiffness = one});
    refuses("stiffness is 1; beside frequency", target_joint{.stiffness = one, .frequency = one});
    refuses("linear_stiffness is 1; beside linear_frequency",
            weld_joint{.linear_frequency = one, .linear_stiffness = one});
    refuses("angular_damping is 1; beside angular_frequency",
            motor_joint{.angular_frequency = one, .angular_damping = one});
    six_degrees_joint axes;
    axes.y.frequency = axes.y.stiffness = one;
    refuses("y.stiffness is 1; beside frequency", axes);
    axes.y.frequency = S(0);
    axes.y.damping = bad;
    refuses("y.damping is -1", axes);
    refuses("stiffness is -1", distance_joint{.stiffness = bad});
    refuses("damping is -1", wheel_joint{.damping = bad});
    refuses("angular_stiffness is -1", weld_joint{.angular_stiffness = bad});
    refuses("frequency is 0", target_joint{.frequency = S(0)});
    if constexpr (!cell::is_fixed) {
        refuses("stiffness is nan", distance_joint{.stiffness = S(std::nan(""))});
        refuses("linear_damping is inf", motor_joint{.linear_damping = S(1) / S(0)});
    }
}

}  // namespace spring_laws
}  // namespace
