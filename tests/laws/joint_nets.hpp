// Laws of joints in random nets: what cannot all be met, light bodies between heavy ones, limits, motors.
#pragma once

#include "joint_cell.hpp"

namespace {
namespace net_laws {

using namespace joint_laws;

using plain = physics::world<joined<>>;
using split = physics::world<joined<physics::sequential_impulse>>;

struct net {
    /// How far the places of a joint in its two bodies are apart, at most (m), and whether it is a tree.
    double apart = 0;
    bool is_tree = false, has_limits = false, has_motors = false, is_direct = true;
};

inline rotation any_turn(cell::dice& dice) {
    const rotation about_z = turn(dice.number(-3, 3));
    const auto tilted = [&]<class Rotation>(const Rotation& r) {
        if constexpr (D == 2) return r;
        else return r * Rotation::from_axis_angle({S(1), S(0), S(0)}, S(dice.number(-3, 3)));
    };
    return tilted(about_z);
}

/// Joins up to 12 boxes of masses up to 1 : 10,000 by pins up to 4 m off them.
template <class World>
std::vector<body_id> add_net(World& w, const net& of, int seed) {
    cell::dice dice(static_cast<std::uint64_t>(seed) + 1);
    auto settings = w.settings();
    settings.solver.max_direct_cost = of.is_direct ? 1 << 20 : 0;
    w.set_settings(settings);
    std::vector<body_id> all{add_anchor(w, at(0, 0)), add_anchor(w, at(3, 3))};
    const int count = 3 + seed % 10;
    for (int i = 0; i < count; ++i) {
        const body_id b = w.create_body({.position = dice.vec<vec>(-4, 4), .rotation = any_turn(dice)});
        vec half = vec::filled(S(0.15));
        half[0] = S(dice.number(0.2, 0.7));
        const physics::shape_id box =
            w.create_shape(b, typename World::box{half}, {.density = S(std::pow(10.0, dice.number(-2, 2)))});
        // It keeps its mass without its shape: contacts would hold the net in other places.
        w.set_mass(b, w.mass(b));
        w.destroy_shape(box);
        all.push_back(b);
    }
    const auto pick = [&](int from, int to) { return static_cast<int>(dice.number(from, to - 0.001)); };
    for (int i = 0; i < (of.is_tree ? count : 2 * count); ++i) {
        // The first ones hang each body on one before it.
        const int b = i < count ? 2 + i : pick(2, 2 + count), a = i < count ? pick(0, 2 + i) : pick(0, 2 + count);
        if (a == b) continue;
        const transform frame{dice.vec<vec>(-4, 4), any_turn(dice)};
        const auto one = static_cast<std::size_t>(a), other = static_cast<std::size_t>(b);
        const transform fa = relative(w.pose(all[one]), frame);
        transform fb = relative(w.pose(all[other]), frame);
        fb.position += dice.vec<vec>(-of.apart, of.apart + 1e-9);
        const S limit = of.has_limits ? S(dice.number(0.01, 1)) : physics::scalar_traits<S>::max();
        const S speed = S(dice.number(-10, 10)), force = of.has_motors ? S(std::pow(10.0, dice.number(0, 3))) : S(0);
        switch (pick(0, 5)) {
            case 0: w.create_joint(all[one], all[other], physics::ball_joint<S, D>{fa.position, fb.position}); break;
            case 1:
                w.create_joint(all[one], all[other],
                               physics::revolute_joint<S, D>{.frame_a = fa,
                                                             .frame_b = fb,
                                                             .min_angle = -limit,
                                                             .max_angle = limit,
                                                             .motor_speed = speed,
                                                             .max_motor_torque = force});
                break;
            case 2:
                w.create_joint(all[one], all[other],
                               physics::prismatic_joint<S, D>{.frame_a = fa,
                                                              .frame_b = fb,
                                                              .min_translation = -limit,
                                                              .max_translation = limit,
                                                              .motor_speed = speed,
                                                              .max_motor_force = force});
                break;
            case 3:
                w.create_joint(all[one], all[other], physics::weld_joint<S, D>{.frame_a = fa, .frame_b = fb});
                break;
            default:
                w.create_joint(all[one], all[other],
                               physics::wheel_joint<S, D>{.frame_a = fa,
                                                          .frame_b = fb,
                                                          .min_translation = -limit,
                                                          .max_translation = limit,
                                                          .motor_speed = speed,
                                                          .max_motor_torque = force});
        }
    }
    return all;
}

/// The largest speed of any body of a net in all steps and in the last ones.
template <class World>
std::pair<double, double> largest_speeds(const net& of, int seed, int substeps) {
    World w = falling<World>(substeps, 0);
    const std::vector<body_id> all = add_net(w, of, seed);
    double largest = 0, last = 0;
    for (int i = 0; i < 120; ++i) {
        w.step(S(i % 3 == 0 ? 1.0 / 30 : 1.0 / 60));
        for (const body_id b : all) {
            const double speed = length_of(w.linear_velocity(b));
            largest = std::max(largest, speed);
            if (i >= 100) last = std::max(last, speed);
        }
    }
    return {largest, last};
}

template <class World>
void nets_stay_bounded(const net& of, double bound, double bound_of_last) {
    for (int seed = 0; seed < 5; ++seed) {
        CAPTURE(seed);
        const auto [largest, last] = largest_speeds<World>(of, seed, 1 << seed % 5);
        CHECK(largest < bound);
        CHECK(last < bound_of_last);
    }
}
CELL_CASE("joint nets: what is met stays at rest, whatever the net") {
    // What rounding of places makes of itself as it is drawn together.
    const double rest = 1e-4 + number(cell::tolerance(1 << 16));
    SUBCASE("soft_step") { nets_stay_bounded<plain>({}, rest, rest); }
    SUBCASE("sequential_impulse") { nets_stay_bounded<split>({}, rest, rest); }
}
CELL_CASE("joint nets: what cannot all be met comes to no harm") {
    SUBCASE("soft_step") { nets_stay_bounded<plain>({.apart = 0.1}, 100, 20); }
    SUBCASE("sequential_impulse") { nets_stay_bounded<split>({.apart = 0.1}, 100, 20); }
    SUBCASE("with limits") { nets_stay_bounded<plain>({.apart = 0.1, .has_limits = true}, 100, 20); }
}
/// Nets that are solved round by round, at 1, 2, 4... substeps: so many rates of these, each for two nets; under
/// sanitizers, which the number of substeps says nothing new to, at few.
template <class World>
void rounds_stay_bounded(double apart, int rates, double bound) {
    if (cell::is_sanitized) rates = 3;
    for (int seed = 0; seed < 2 * rates; ++seed) {
        CAPTURE(seed);
        const auto [largest, last] =
            largest_speeds<World>({.apart = apart, .is_direct = false}, seed, 1 << seed % rates);
        CHECK(largest < bound);
    }
}
CELL_CASE("joint nets: what is met stays at rest round by round too") {
    const double rest = 2e-4 + number(cell::tolerance(1 << 16));
    SUBCASE("soft_step") { rounds_stay_bounded<plain>(0, 7, rest); }
    SUBCASE("sequential_impulse") { rounds_stay_bounded<split>(0, 7, rest); }
}
CELL_CASE("joint nets: what cannot all be met does not whirl round by round") {
    SUBCASE("soft_step") { rounds_stay_bounded<plain>(0.1, 7, 0.5); }
    SUBCASE("sequential_impulse") { rounds_stay_bounded<split>(0.1, 7, 0.5); }
}
/// By what factor the kinetic energy of a net grows at most that is struck along lines, and that nothing drives.
template <class World>
double energy_gain(int seed, int substeps) {
    World w = falling<World>(substeps, 0);
    std::vector<body_id> all = add_net(w, {.is_direct = false}, seed);
    auto settings = w.settings();
    settings.sleeping.enabled = false;
    if constexpr (requires { settings.solver.iterations; }) settings.solver.iterations = 1 + seed % 9;
    w.set_settings(settings);
    all.erase(all.begin(), all.begin() + 2);
    cell::dice dice(static_cast<std::uint64_t>(seed));
    for (const body_id b : all) w.set_linear_velocity(b, dice.vec<vec>(-0.01, 0.01));
    const double before = w.energy().kinetic;
    double most = 0;
    for (int i = 0; i < 120; ++i) {
        w.step(S(1.0 / 60));
        most = std::max(most, w.energy().kinetic);
    }
    return most / before;
}
template <class World>
void rounds_gain_nothing() {
    for (const int substeps : {1, 4, 16, 64})
        for (int seed = 0; seed < (cell::is_sanitized ? 3 : 20); ++seed) {
            CAPTURE(substeps);
            CAPTURE(seed);
            CHECK(energy_gain<World>(seed, substeps) < 1.001);
        }
}
CELL_CASE("joint nets: what is struck gains no energy round by round, at any substeps") {
    SUBCASE("soft_step") { rounds_gain_nothing<plain>(); }
    SUBCASE("sequential_impulse") { rounds_gain_nothing<split>(); }
}
template <class World>
void ground_stops_what_is_pulled_into_it() {
    for (const int substeps : {1, 4, 16})
        for (const bool is_direct : {true, false}) {
            CAPTURE(substeps);
            CAPTURE(is_direct);
            World w = falling<World>(substeps);
            auto settings = w.settings();
            settings.solver.max_direct_cost = is_direct ? 1 << 20 : 0;
            w.set_settings(settings);
            vec up;
            up[1] = S(1);
            w.create_shape(add_anchor(w, at(0, 0)), typename World::halfspace{up});
            const body_id b = w.create_body({.position = at(0, 0.5), .can_sleep = false});
            w.create_shape(b, typename World::ball{S(0.25)});
            w.create_joint(add_anchor(w, at(0, -0.1)), b, physics::ball_joint<S, D>{});
            run(w, 256, 1.0 / 64);
            CHECK(std::abs(number(w.position(b)[1]) - 0.25) < 0.01);
            CHECK(length_of(w.linear_velocity(b)) < 0.01);
        }
}
CELL_CASE("joint nets: what is pulled into the ground comes to rest on it") {
    SUBCASE("soft_step") { ground_stops_what_is_pulled_into_it<plain>(); }
    SUBCASE("sequential_impulse") { ground_stops_what_is_pulled_into_it<split>(); }
}
template <class World>
void motors_leave_gaps_to_others() {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        World w = falling<World>(substeps, 0);
        auto settings = w.settings();
        settings.solver.max_direct_cost = 0;
        w.set_settings(settings);
        const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(1, 0)), c = add_ball(w, at(2, 0));
        for (const body_id id : {b, c}) w.set_can_sleep(id, false);
        w.create_joint(a, b, physics::ball_joint<S, D>{at(0), at(-1)});
        // 0.3 m apart, and a motor that keeps the second one where it is.
        w.create_joint(b, c, physics::ball_joint<S, D>{at(0.5), at(-0.8)});
        physics::motor_joint<S, D> hold;
        hold.max_force = hold.max_torque = S(10000);
        w.create_joint(a, c, hold);
        run(w, 256, 1.0 / 64);
        CHECK(length_of(w.pose(b) * at(0.5) - w.pose(c) * at(-0.8)) < 1e-3);
        CHECK(length_of(w.linear_velocity(c)) < 1e-3);
    }
}
CELL_CASE("joint nets: motors do not keep gaps of other joints open") {
    SUBCASE("soft_step") { motors_leave_gaps_to_others<plain>(); }
    SUBCASE("sequential_impulse") { motors_leave_gaps_to_others<split>(); }
}
CELL_CASE("joint nets: motors go no faster than they drive the levers") {
    SUBCASE("trees") { nets_stay_bounded<plain>({.is_tree = true, .has_motors = true}, 1000, 1000); }
    SUBCASE("nets") { nets_stay_bounded<plain>({.has_motors = true}, 1000, 1000); }
    SUBCASE("nets with limits") { nets_stay_bounded<plain>({.has_limits = true, .has_motors = true}, 1000, 1000); }
}

template <class... Policies>
struct three_kinds
    : physics::recipe<S, D, few, physics::joints<physics::ball_joint, physics::revolute_joint, own_joints::pin>,
                      Policies...> {};
/// Balls and boxes that are joined to neighbours on a grid, two of them driven and fixed, over the ground.
template <class Joint, class World>
std::vector<body_id> add_grid(World& w) {
    cell::dice dice(3);
    vec up;
    up[1] = S(1);
    w.create_shape(add_anchor(w, at(0, 0)), typename World::halfspace{up});
    std::vector<body_id> all;
    constexpr int side = 7;
    for (int i = 0; i < side * side; ++i) {
        const vec place = at(0.5 * (i % side), 1 + 0.5 * (i / side));
        const bool is_end = i == side * side - 1 || i == side * (side - 1);
        all.push_back(w.create_body({.type = !is_end         ? body_type::dynamic_body
                                             : i % side == 0 ? body_type::static_body
                                                             : body_type::kinematic_body,
                                     .position = place,
                                     .rotation = any_turn(dice),
                                     .linear_velocity = is_end && i % side != 0 ? at(-0.1) : at(0)}));
        vec half = vec::filled(S(0.1));
        half[0] = S(dice.number(0.1, 0.2));
        if (i % 3 == 0) w.create_shape(all.back(), typename World::ball{S(0.1)});
        else w.create_shape(all.back(), typename World::box{half});
        const auto join = [&](int to) {
            const body_id a = all[static_cast<std::size_t>(to)], b = all.back();
            const vec middle = (w.position(a) + w.position(b)) * S(0.5);
            Joint joint;
            const vec in_a = inverse_transform(w.pose(a), middle), in_b = inverse_transform(w.pose(b), middle);
            if constexpr (requires { joint.anchor_a; }) joint.anchor_a = in_a, joint.anchor_b = in_b;
            else joint.frame_a.position = in_a, joint.frame_b.position = in_b;
            w.create_joint(a, b, joint);
        };
        if (i % side > 0) join(i - 1);
        if (i >= side && i != side * (side - 1)) join(i - side);
    }
    return all;
}
template <class Recipe>
void points_move_as_their_rows_say(bool direct) {
    using World = physics::world<Recipe>;
    World points = falling_by<World>(3, direct), rows = points, hinges = points;
    const auto all = add_grid<physics::ball_joint<S, D>>(points);
    add_grid<own_joints::pin<S, D>>(rows);
    if constexpr (D == 2) add_grid<physics::revolute_joint<S, D>>(hinges);
    else add_grid<physics::ball_joint<S, D>>(hinges);
    for (int i = 0; i < (cell::is_sanitized ? 30 : 150); ++i) {
        for (World* w : {&points, &rows, &hinges}) w->step(S(i % 4 == 0 ? 1.0 / 30 : 1.0 / 64));
        for (const body_id b : all) {
            REQUIRE(points.pose(b) == rows.pose(b));
            REQUIRE(points.pose(b) == hinges.pose(b));
        }
    }
    CHECK(points.position(all[0]) != at(0, 1));
}
CELL_CASE("joint nets: points are held in lanes to the bits that their rows say") {
    SUBCASE("soft_step") { points_move_as_their_rows_say<three_kinds<>>(false); }
    SUBCASE("soft_step, directly") { points_move_as_their_rows_say<three_kinds<>>(true); }
    SUBCASE("sequential_impulse") { points_move_as_their_rows_say<three_kinds<physics::sequential_impulse>>(false); }
    SUBCASE("bodies that do not turn") {
        points_move_as_their_rows_say<three_kinds<physics::without<physics::feature::rotation>>>(false);
    }
}
CELL_CASE("joint nets: turns are those that bring an angle nearest to where it was, and what it has turned") {
    const auto turns_after = [](double angle, int turns, double turned, double next) {
        return physics::counted_angle<S>{S(angle), turns}.after(turned, S(next)).turns;
    };
    CHECK(turns_after(3, 2, 0.5, 3.5 - 2 * pi) == 3);
    CHECK(turns_after(-3, 2, -0.5, 2 * pi - 3.5) == 1);
    CHECK(turns_after(1, 0, 100, 101 - 32 * pi) == 16);
    CHECK(turns_after(1, 0, -100, 32 * pi - 99) == -16);
    CHECK(turns_after(1, 5, 0, 1) == 5);
    // What is no number of turns leaves them as they are, and what has no room is not undefined.
    CHECK(turns_after(1, 5, 1e30, 1) == 5);
    CHECK(turns_after(1, 2147483647, 2 * pi, 1) == -2147483647 - 1);
}
CELL_CASE("joint nets: turns of what spins fast are counted, whoever solves it") {
    for (const bool direct : {false, true}) {
        CAPTURE(direct);
        auto w = falling_by<plain>(4, direct);
        const body_id rod = w.create_body({.position = at(0, 1), .can_sleep = false});
        w.create_shape(rod, plain::ball{S(0.5)});
        set_spin(w, rod, 400);
        const joint_id hinge = w.create_joint(add_anchor(w, at(0, 1)), rod, physics::revolute_joint<S, D>{});
        run(w, 64, 1.0 / 64);
        CHECK(std::abs(number(w.joint_angle(hinge)) - 400) < 0.1);
    }
}

}  // namespace net_laws
}  // namespace
