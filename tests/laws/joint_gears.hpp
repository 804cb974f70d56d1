// Laws of racks and gears: on carriers that stand, turn and fly, over any number of turns.
#pragma once

#include "laws/joint_axes.hpp"

namespace {
namespace gear_laws {

using namespace axis_laws;
using rack_joint = physics::rack_joint<S, D>;
using gear_joint = physics::gear_joint<S, D>;
using revolute_joint = physics::revolute_joint<S, D>;
using prismatic_joint = physics::prismatic_joint<S, D>;

using plain = physics::world<joined<>>;
using hard = physics::world<joined<physics::sequential_impulse>>;

CELL_CASE("joint gears: rows are the derivatives of what they measure, and have no moment") {
    cell::dice dice(7);
    for (int i = 0; i < 200; ++i) {
        gear_joint gear;
        gear.frame_a = {dice.vec<vec>(-1, 1), random_rotation(dice)};
        gear.frame_b = {dice.vec<vec>(-1, 1), random_rotation(dice)};
        gear.ratio = S(dice.number(-3, 3));
        gear.phase = S(0);
        rows_are_derivatives(gear, dice, random_rotation(dice));
        rack_joint rack;
        rack.frame_a = gear.frame_a;
        rack.frame_b = gear.frame_b;
        rack.radius = S(dice.number(-1, 1));
        rack.offset = S(0);
        // A rack lies across the pinion's axis.
        rows_are_derivatives(rack, dice, by_angles(0, 0, dice.number(-3, 3)));
    }
}

/// The same body with another moment of inertia about z: a box of that mass.
template <class World>
body_id add_wheel(World& w, const vec& where, double mass, double inertia) {
    const double half = std::sqrt(1.5 * inertia / mass);
    const body_id b = w.create_body({.position = where});
    vec size = vec::filled(S(0.125));
    size[0] = size[1] = S(half);
    w.create_shape(b, typename World::box{size}, {.density = S(mass / (4 * half * half * (D == 2 ? 1 : 0.25)))});
    return b;
}
template <class World>
void a_gear_shares_a_torque(int substeps, bool swapped, double ratio) {
    CAPTURE(ratio);
    World w = falling<World>(substeps, 0);
    const body_id ground = add_anchor(w, at(0, 0)), a = add_wheel(w, at(0, 0), 1, 1), b = add_wheel(w, at(0, 3), 1, 4);
    w.create_joint(ground, a, revolute_joint{.motor_speed = S(1000), .max_motor_torque = S(3)});
    w.create_joint(ground, b, revolute_joint{.frame_a = frame(0, 3)});
    if (swapped) w.create_joint(b, a, gear_joint{.ratio = S(1 / ratio)});
    else w.create_joint(a, b, gear_joint{.ratio = S(ratio)});
    run(w, 64);
    const double speed = 3 / (1 + 4 / (ratio * ratio));
    CHECK(std::abs(z_of(w.angular_velocity(a)) - speed) < 2e-3 * speed);
    CHECK(std::abs(z_of(w.angular_velocity(b)) + speed / ratio) < 2e-3 * speed);
}
CELL_CASE("joint gears: a torque on one wheel drives both, by their ratio and inertias") {
    for (const int substeps : {1, 4})
        for (const bool swapped : {false, true})
            for (const double ratio : {2.0, -3.0, 0.4}) {
                CAPTURE(substeps);
                CAPTURE(swapped);
                a_gear_shares_a_torque<plain>(substeps, swapped, ratio);
                a_gear_shares_a_torque<hard>(substeps, swapped, ratio);
            }
}
CELL_CASE("joint gears: after a thousand turns the teeth are where they were") {
    plain w = falling<plain>(1, 0);
    const body_id ground = add_anchor(w, at(0, 0)), a = add_wheel(w, at(0, 0), 1, 1), b = add_wheel(w, at(3, 0), 1, 1);
    const joint_id drive =
        w.create_joint(ground, a, revolute_joint{.motor_speed = S(100), .max_motor_torque = S(1000)});
    const joint_id driven = w.create_joint(ground, b, revolute_joint{.frame_a = frame(3)});
    w.create_joint(a, b, gear_joint{.ratio = S(1.5)});
    double worst = 0;
    for (int i = 0; i < (cell::is_fixed ? 1024 : 4096); ++i) {
        run(w, 1);
        const double off = number(w.joint_angle(drive)) + 1.5 * number(w.joint_angle(driven));
        worst = std::max(worst, std::abs(off));
    }
    CHECK(number(w.joint_angle(drive)) > (cell::is_fixed ? 1500 : 6300));
    // To the rounding of their angles.
    CHECK(worst < 2e-3);
}

/// Bodies on a carrier that nothing holds.
template <class World>
struct free_train {
    World w;
    std::vector<body_id> all;
    explicit free_train(int substeps) : w(falling<World>(substeps, 0)) {}

    [[nodiscard]] vec momentum() const {
        vec sum;
        for (const body_id b : all) sum += w.linear_velocity(b) * w.mass(b).mass;
        return sum;
    }
    /// About the origin.
    [[nodiscard]] angular angular_momentum() const {
        angular sum{};
        for (const body_id b : all) {
            sum = sum + physics::cross(w.position(b), w.linear_velocity(b)) * w.mass(b).mass;
            sum = sum + spin_momentum(w.pose(b).rotation, w.mass(b).inertia, w.angular_velocity(b));
        }
        return sum;
    }
    static S spin_momentum(const physics::rotation<S, 2>&, S inertia, S spin) { return inertia * spin; }
    static physics::vec<S, 3> spin_momentum(const physics::rotation<S, 3>& r, const physics::symmetric<S>& m,
                                            const physics::vec<S, 3>& spin) {
        const physics::vec<S, 3> v = physics::inverse_rotate(r, spin);
        return r * physics::vec<S, 3>{m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
                                      m.xz * v.x + m.yz * v.y + m.zz * v.z};
    }
};
template <class World>
void a_planet_turns_on_its_arm(int substeps, double ratio) {
    CAPTURE(ratio);
    free_train<World> train(substeps);
    auto& w = train.w;
    const body_id arm = add_box(w, at(1, 0), 2, 0.25), sun = add_wheel(w, at(0, 0), 2, 1),
                  planet = add_wheel(w, at(2, 0), 1, 0.5);
    train.all = {arm, sun, planet};
    for (const body_id b : train.all) w.set_can_sleep(b, false);
    w.create_joint(arm, sun, revolute_joint{.frame_a = frame(-1)});
    w.create_joint(arm, planet, revolute_joint{.frame_a = frame(1)});
    w.create_joint(sun, planet, gear_joint{.ratio = S(ratio)});
    set_spin(w, sun, 3);
    run(w, 1);
    const vec momentum = train.momentum();
    const angular before = train.angular_momentum();
    double worst = 0;
    for (int i = 0; i < 256; ++i) {
        run(w, 1);
        const double carrier = z_of(w.angular_velocity(arm));
        worst = std::max(worst, std::abs(z_of(w.angular_velocity(sun)) - carrier +
                                         ratio * (z_of(w.angular_velocity(planet)) - carrier)));
    }
    CHECK(worst < 0.02 / substeps);
    // It turns all the time, and the arm with it, but for a pair of forces that the arm need not bear.
    CHECK(std::abs(z_of(w.angular_velocity(sun))) > 0.5);
    CHECK((std::abs(z_of(w.angular_velocity(arm))) > 0.05) == (ratio != -1));
    CHECK(length_of(train.momentum() - momentum) < number(cell::tolerance(1 << 14)));
    CHECK(size_of(train.angular_momentum() - before) < number(cell::tolerance(1 << 15)));
}
CELL_CASE("joint gears: planets turn on arms that fly, and keep the momentum and the angular one") {
    for (const int substeps : {1, 4})
        for (const double ratio : {2.0, -3.0, -1.0}) {
            CAPTURE(substeps);
            a_planet_turns_on_its_arm<plain>(substeps, ratio);
            a_planet_turns_on_its_arm<hard>(substeps, ratio);
        }
}
CELL_CASE("joint gears: bevel gears turn on a carrier that flies, and keep its angular momentum") {
#if CELL_DIMENSION == 3
    for (const int substeps : {1, 4}) {
        CAPTURE(substeps);
        free_train<plain> train(substeps);
        auto& w = train.w;
        // Wheels about z and about x, whose axes meet at the origin.
        const body_id frame_of = add_box(w, at(0, 0), 0.5, 0.5), a = add_wheel(w, at(0, 0, 1), 1, 0.5),
                      b = add_wheel(w, at(2, 0, 0), 1, 1);
        const rotation about_x = by_angles(0, pi / 2, 0);
        train.all = {frame_of, a, b};
        for (const body_id one : train.all) w.set_can_sleep(one, false);
        w.create_joint(frame_of, a, revolute_joint{.frame_a = {at(0, 0, 1), {}}});
        w.create_joint(frame_of, b, revolute_joint{.frame_a = {at(2), about_x}, .frame_b = {{}, about_x}});
        w.create_joint(a, b, gear_joint{.frame_b = {{}, about_x}, .ratio = S(2)});
        w.set_angular_velocity(a, at(0, 0, 4));
        run(w, 1);
        const angular before = train.angular_momentum();
        double worst = 0;
        for (int i = 0; i < 256; ++i) {
            run(w, 1);
            const vec carrier = w.angular_velocity(frame_of), z = w.pose(frame_of).rotation * at(0, 0, 1),
                      x = w.pose(frame_of).rotation * at(1);
            worst = std::max(worst, std::abs(number(dot(w.angular_velocity(a) - carrier, z)) +
                                             2 * number(dot(w.angular_velocity(b) - carrier, x))));
        }
        CHECK(worst < 0.1 / substeps);
        CHECK(length_of(w.angular_velocity(a)) > 0.5);
        CHECK(size_of(train.angular_momentum() - before) < 0.01 / substeps);
    }
#endif
}

template <class World>
void a_pinion_drives_its_rack(int substeps, double sign) {
    World w = falling<World>(substeps, 0);
    const body_id ground = add_anchor(w, at(0, 0)), pinion = add_wheel(w, at(0, 0), 1, 0.01),
                  rack = add_wheel(w, at(0, -sign), 2, 1);
    w.create_joint(ground, pinion, revolute_joint{.motor_speed = S(10000), .max_motor_torque = S(0.5)});
    w.create_joint(ground, rack, prismatic_joint{.frame_a = frame(0, -sign)});
    w.create_joint(pinion, rack, rack_joint{.radius = S(0.1 * sign)});
    run(w, 64);
    CHECK(std::abs(z_of(w.angular_velocity(pinion)) - 16.666667) < 0.03);
    CHECK(std::abs(number(w.linear_velocity(rack)[0]) - sign * 1.6666667) < 3e-3);
}
CELL_CASE("joint gears: a pinion drives its rack, to either side") {
    for (const int substeps : {1, 4})
        for (const double sign : {1.0, -1.0}) {
            CAPTURE(substeps);
            CAPTURE(sign);
            a_pinion_drives_its_rack<plain>(substeps, sign);
            a_pinion_drives_its_rack<hard>(substeps, sign);
        }
}
CELL_CASE("joint gears: a rack is where its pinion has turned it after a thousand turns") {
    plain w = falling<plain>(1, 0);
    const body_id ground = add_anchor(w, at(0, 0)), pinion = add_wheel(w, at(0, 0), 1, 0.01),
                  rack = add_wheel(w, at(0, -1), 2, 1);
    const joint_id drive =
        w.create_joint(ground, pinion, revolute_joint{.motor_speed = S(100), .max_motor_torque = S(1000)});
    w.create_joint(ground, rack, prismatic_joint{.frame_a = frame(0, -1)});
    w.create_joint(pinion, rack, rack_joint{.radius = S(0.01)});
    double worst = 0;
    for (int i = 0; i < (cell::is_fixed ? 1024 : 4096); ++i) {
        run(w, 1);
        worst = std::max(worst, std::abs(number(w.position(rack)[0]) - 0.01 * number(w.joint_angle(drive))));
    }
    CHECK(number(w.position(rack)[0]) > (cell::is_fixed ? 15 : 63));
    CHECK(worst < 1e-4);
}
CELL_CASE("joint gears: a pinion and its rack on a carrier that flies keep its momentum and angular momentum") {
    for (const int substeps : {1, 4}) {
        CAPTURE(substeps);
        free_train<plain> train(substeps);
        auto& w = train.w;
        const body_id carrier = add_box(w, at(0, 0), 2, 0.5), pinion = add_wheel(w, at(0, 0), 1, 0.5),
                      rack = add_box(w, at(0, -1), 1, 0.25);
        train.all = {carrier, pinion, rack};
        for (const body_id b : train.all) w.set_can_sleep(b, false);
        w.create_joint(carrier, pinion, revolute_joint{});
        w.create_joint(carrier, rack,
                       prismatic_joint{.frame_a = frame(0, -1), .min_translation = S(-1), .max_translation = S(1)});
        w.create_joint(pinion, rack, rack_joint{.radius = S(0.5)});
        set_spin(w, pinion, 3);
        set_spin(w, carrier, 0.5);
        run(w, 1);
        const vec momentum = train.momentum();
        const angular before = train.angular_momentum();
        run(w, 24);
        // The rack slides on the carrier as the pinion turns on it.
        const vec seen = inverse_transform(w.pose(carrier), w.position(rack));
        CHECK(number(seen[0]) > 0.1);
        run(w, 200);
        CHECK(length_of(train.momentum() - momentum) < number(cell::tolerance(1 << 14)));
        // But for what limits take back where they are hit: of second order in the substep.
        CHECK(size_of(train.angular_momentum() - before) <
              1e-4 / (substeps * substeps) + number(cell::tolerance(1 << 15)));
    }
}

CELL_CASE("joint gears: what they leave open is filled in as they are made and set") {
    plain w = falling<plain>();
    const body_id ground = add_anchor(w, at(0, 0)), a = add_wheel(w, at(0, 0), 1, 1), b = add_wheel(w, at(0, 3), 1, 1);
    w.create_joint(ground, a, revolute_joint{});
    w.create_joint(ground, b, revolute_joint{.frame_a = frame(0, 3)});
    const joint_id gear = w.create_joint(a, b, gear_joint{.ratio = S(2)});
    CHECK(std::abs(number(w.joint<gear_joint>(gear).phase) + 1.5 * pi) < 1e-5);
    run(w, 64);
    CHECK(length_of(w.pose(a).rotation * at(1) - at(1)) < 1e-5);
    // A phase that is told is kept to.
    w.set_joint(gear, gear_joint{.ratio = S(2), .phase = S(-1.5 * pi + 0.5)});
    run(w, 64);
    CHECK(std::abs(number(w.joint<gear_joint>(gear).phase) + 1.5 * pi - 0.5) < 1e-5);
    CHECK(length_of(w.pose(a).rotation * at(1) - at(1)) > 0.01);
    w.set_joint(gear, gear_joint{.ratio = S(2)});
    CHECK(std::abs(number(w.joint<gear_joint>(gear).phase) + 1.5 * pi - 0.5) < 1e-3);
    // Nor is an offset lost that a copy has.
    const gear_joint kept = w.joint<gear_joint>(gear);
    w.set_joint(gear, kept);
    CHECK(w.joint<gear_joint>(gear).phase == kept.phase);
    // Nor does what is filled in as it was wake what sleeps.
    for (int i = 0; i < 640 && !w.is_asleep(a); ++i) run(w, 1);
    REQUIRE(w.is_asleep(a));
    w.set_joint(gear, kept);
    CHECK(w.is_asleep(a));
}
CELL_CASE("joint gears: bad ones are refused by name") {
    plain w = falling<plain>();
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(1));
    const auto refuses = [&](const char* field, const auto& joint) { is_refused(w, a, b, field, joint); };
    rotation stretched = turn(0);
    stretch(stretched);
    refuses("frame_a.rotation", gear_joint{.frame_a = {{}, stretched}});
    refuses("frame_b.rotation", rack_joint{.frame_b = {{}, stretched}});
    refuses("ratio is 0", gear_joint{.ratio = S(0)});
    refuses("radius is 0", rack_joint{.radius = S(0)});
    if constexpr (!cell::is_fixed) {
        const S bad = S(0) / S(0);
        refuses("ratio", gear_joint{.ratio = bad});
        refuses("phase", gear_joint{.phase = bad});
        refuses("radius", rack_joint{.radius = bad});
        refuses("offset", rack_joint{.offset = bad});
    }
}

}  // namespace gear_laws
}  // namespace
