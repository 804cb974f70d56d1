// Laws of kinds of joints: statics and motions that are known, in every cell, from one substep on.
#pragma once

#include "joint_cell.hpp"

namespace {
namespace kind_laws {

using namespace joint_laws;

using plain = physics::world<joined<>>;
using revolute_joint = physics::revolute_joint<S, D>;
using prismatic_joint = physics::prismatic_joint<S, D>;
using weld_joint = physics::weld_joint<S, D>;
using wheel_joint = physics::wheel_joint<S, D>;
using target_joint = physics::target_joint<S, D>;

template <class World>
void a_rod_swings_from_its_hinge(int substeps) {
    World w = falling<World>(substeps);
    const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0.5, 0), 0.5, 1.0 / 128);
    const joint_id hinge = w.create_joint(a, b, revolute_joint{.frame_b = frame(-0.5)});
    run(w, 1, 1.0 / 60);
    // A quarter of its weight at once, 5/2 of it below, at sqrt(3 g / L).
    CHECK(std::abs(number(w.reaction(hinge).force[1]) - gravity / 4) < 0.02);
    double fastest = 0, strongest = 0;
    for (int i = 0; i < 60; ++i) {
        run(w, 1, 1.0 / 60);
        fastest = std::max(fastest, std::abs(z_of(w.angular_velocity(b))));
        strongest = std::max(strongest, number(w.reaction(hinge).force[1]));
        CHECK(length_of(w.pose(b) * at(-0.5)) < 2e-4 / substeps);
    }
    CHECK(std::abs(fastest - std::sqrt(3 * gravity)) < 0.01);
    CHECK(std::abs(strongest - 2.5 * gravity) < 0.05);
}
CELL_CASE("joint kinds: a rod swings from its hinge as it should, and pulls") {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        a_rod_swings_from_its_hinge<plain>(substeps);
        a_rod_swings_from_its_hinge<physics::world<joined<physics::sequential_impulse>>>(substeps);
    }
}

CELL_CASE("joint kinds: a motor accelerates by its torque up to its speed, and turns are counted") {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        plain w = falling<plain>(substeps, 0);
        const body_id a = add_anchor(w, at(0, 0)), b = add_flywheel(w, at(0, 0));
        const joint_id motor = w.create_joint(a, b, revolute_joint{.motor_speed = S(10), .max_motor_torque = S(5)});
        int steps = 0;
        while (z_of(w.angular_velocity(b)) < 10 - 1e-4 && steps < 1000) run(w, 1), ++steps;
        CHECK(steps == 128);
        CHECK(std::abs(number(w.joint_angle(motor)) - 10 * (1 + 0.5 / 64 / substeps)) < 1e-3);
        run(w, 640);
        CHECK(std::abs(z_of(w.angular_velocity(b)) - 10) < 1e-4);
        CHECK(std::abs(number(w.joint_angle(motor)) - 110) < 0.1);
        // With a speed of 0 it is friction: stops it after another 50 rad at 1 N m.
        w.set_joint(motor, revolute_joint{.max_motor_torque = S(1)});
        steps = 0;
        while (std::abs(z_of(w.angular_velocity(b))) > 1e-4 && steps < 1000) run(w, 1), ++steps;
        CHECK(steps == 640);
        CHECK(std::abs(number(w.joint_angle(motor)) - 160) < 0.2);
    }
}
CELL_CASE("joint kinds: a motor lifts what its torque can, and drops what it cannot") {
    for (const double load : {4.9, 5.1}) {
        CAPTURE(load);
        plain w = falling<plain>(4);
        const body_id a = add_anchor(w, at(0, 0)), b = add_flywheel(w, at(load / gravity, 0));
        w.create_joint(
            a, b, revolute_joint{.frame_b = frame(-load / gravity), .motor_speed = S(1), .max_motor_torque = S(5)});
        run(w, 64);
        CHECK((number(w.position(b)[1]) > 0) == (load < 5));
    }
}
CELL_CASE("joint kinds: limits of several turns stop what is thrown at them") {
    for (const double speed : {5.0, 20.0, 100.0})
        for (const int substeps : {1, 4}) {
            CAPTURE(speed);
            CAPTURE(substeps);
            plain w = falling<plain>(substeps, 0);
            const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0.5, 0), 0.5, 0.125);
            const joint_id hinge =
                w.create_joint(a, b, revolute_joint{.frame_b = frame(-0.5), .min_angle = S(-1), .max_angle = S(7)});
            set_spin(w, b, speed);
            // What moves of itself keeps to the circle it is asked to.
            vec v;
            v[1] = S(speed / 2);
            w.set_linear_velocity(b, v);
            double farthest = 0;
            for (int i = 0; i < 256; ++i) {
                run(w, 1, 1.0 / 128);
                farthest = std::max(farthest, number(w.joint_angle(hinge)));
            }
            CHECK(farthest < 7 + 1e-3);
            CHECK(std::abs(number(w.joint_angle(hinge)) - 7) < 1e-3);
            CHECK(std::abs(z_of(w.angular_velocity(b))) < 1e-3);
        }
}
CELL_CASE("joint kinds: springs keep their amplitude and frequency, and sag by their load") {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        plain w = falling<plain>(substeps, 0);
        const body_id a = add_anchor(w, at(0, 0)), b = add_flywheel(w, at(0, 0)), c = add_flywheel(w, at(5, 0));
        const joint_id spring = w.create_joint(a, b, revolute_joint{.frequency = S(1), .rest_angle = S(1)});
        const joint_id slider = w.create_joint(a, c, prismatic_joint{.frequency = S(1), .rest_translation = S(4)});
        run(w, 640);
        // Ten swings on.
        CHECK(std::abs(number(w.joint_angle(spring))) < 0.02 + 1.0 / (substeps * substeps));
        CHECK(std::abs(number(w.position(c)[0]) - 5) < 0.02 + 1.0 / (substeps * substeps));
        double highest = 0, farthest = 0;
        for (int i = 0; i < 64; ++i) {
            run(w, 1);
            highest = std::max(highest, number(w.joint_angle(spring)));
            farthest = std::max(farthest, 5 - number(w.position(c)[0]));
        }
        CHECK(std::abs(highest - 2) < 0.01);
        CHECK(std::abs(farthest - 2) < 0.01);
        CHECK(length_of(w.reaction(slider).force) > 0);
    }
}

CELL_CASE("joint kinds: a slider runs down its slope, and tells its reaction") {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        plain w = falling<plain>(substeps);
        const body_id a = add_anchor(w, at(0, 0)), b = add_box(w, at(0, 0), 0.125, 0.125);
        const rotation down = turn(-pi / 6);
        // Its centre is 0.25 m ahead of the frame.
        vec behind;
        behind[0] = S(-0.25 * std::cos(pi / 6));
        behind[1] = S(0.25 * std::sin(pi / 6));
        const joint_id slider =
            w.create_joint(a, b, prismatic_joint{.frame_a = {behind, down}, .frame_b = {behind, down}});
        run(w, 64);
        CHECK(std::abs(length_of(w.linear_velocity(b)) - gravity / 2) < 1e-3);
        CHECK(std::abs(length_of(w.reaction(slider).force) - gravity * std::cos(pi / 6)) < 2e-3);
        CHECK(std::abs(std::abs(z_of(w.reaction(slider).torque)) - 0.25 * gravity * std::cos(pi / 6)) < 2e-3);
        // A limit stops it there.
        w.set_joint(slider,
                    prismatic_joint{.frame_a = {behind, down}, .frame_b = {behind, down}, .max_translation = S(10)});
        run(w, 256);
        CHECK(std::abs(length_of(w.position(b)) - 10) < 1e-3);
        CHECK(std::abs(length_of(w.reaction(slider).force) - gravity) < 2e-3);
    }
}

CELL_CASE("joint kinds: ten welds in a row bear 100 N and 500 N m, and do not bend") {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        plain w = falling<plain>(substeps);
        body_id last = add_anchor(w, at(0, 0));
        joint_id first;
        for (int i = 0; i < 10; ++i) {
            const body_id b = add_box(w, at(i + 0.5, 0), 0.5, 0.125);
            const joint_id weld =
                w.create_joint(last, b, weld_joint{.frame_a = frame(i == 0 ? 0 : 0.5), .frame_b = frame(-0.5)});
            if (i == 0) first = weld;
            last = b;
        }
        run(w, 256);
        CHECK(std::abs(number(w.reaction(first).force[1]) - 100) < 0.01);
        CHECK(std::abs(z_of(w.reaction(first).torque) - 500) < 0.02);
        CHECK(std::abs(number(w.position(last)[1])) < 1e-4);
        CHECK(w.is_asleep(last));
    }
}
CELL_CASE("joint kinds: a soft weld bends by its springs") {
    plain w = falling<plain>(8);
    const body_id a = add_anchor(w, at(0, 0)), b = add_flywheel(w, at(0.5, 0));
    w.create_joint(a, b, weld_joint{.frame_b = frame(-0.5), .angular_frequency = S(2), .angular_damping_ratio = S(1)});
    run(w, 640);
    // Its stiffness is I omega^2 with the I of the body about its centre.
    const double angle = std::asin(std::abs(number(w.position(b)[1])) / 0.5);
    CHECK(std::abs(16 * pi * pi * angle - gravity * 0.5 * std::cos(angle)) < 0.02 * gravity);
}

CELL_CASE("joint kinds: a wheel's suspension sags by its load, its motor spins it, and nothing else moves") {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        plain w = falling<plain>(substeps);
        const body_id a = add_anchor(w, at(0, 0)), wheel = add_box(w, at(0, -1), 1, std::sqrt(2.0));
        // The x axis of the suspension points down.
        const rotation down = turn(-pi / 2);
        const joint_id j = w.create_joint(a, wheel,
                                          wheel_joint{.frame_a = {at(0, -1), down},
                                                      .frequency = S(2),
                                                      .damping_ratio = S(1),
                                                      .motor_speed = S(4),
                                                      .max_motor_torque = S(2)});
        w.set_can_sleep(wheel, false);
        run(w, 64);
        CHECK(std::abs(z_of(w.angular_velocity(wheel)) - 2) < 0.01);
        run(w, 192);
        CHECK(std::abs(z_of(w.angular_velocity(wheel)) - 4) < 1e-3);
        CHECK(std::abs(number(w.position(wheel)[1]) + 1 + gravity / (16 * pi * pi)) < 1e-3);
        CHECK(std::abs(number(w.position(wheel)[0])) < 1e-4);
        CHECK(std::abs(number(w.reaction(j).force[1]) - gravity) < 0.02);
        // Limits bear it where there is no spring.
        w.set_joint(j,
                    wheel_joint{.frame_a = {at(0, -1), down}, .min_translation = S(-0.5), .max_translation = S(0.5)});
        run(w, 128);
        CHECK(std::abs(number(w.position(wheel)[1]) + 1.5) < 1e-3);
    }
}
CELL_CASE("joint kinds: a wheel is steered about its suspension, and spins about its axle") {
    if constexpr (D == 3) {
        plain w = falling<plain>(4, 0);
        const body_id a = add_anchor(w, at(0, 0)), wheel = add_flywheel(w, at(0, 0));
        wheel_joint joint{.motor_speed = S(3), .max_motor_torque = S(10)};
        const joint_id j = w.create_joint(a, wheel, joint);
        run(w, 64);
        joint.steering_angle = S(0.5);
        w.set_joint(j, joint);
        run(w, 128);
        const vec axle = w.pose(wheel).rotation * at(0, 0, 1), spin = spin_of(w.angular_velocity(wheel));
        CHECK(length_of(axle - at(0, -std::sin(0.5), std::cos(0.5))) < 1e-3);
        CHECK(length_of(spin - axle * S(3)) < 2e-2);
    }
}
CELL_CASE("joint kinds: a target draws by its spring, and by no more than its force") {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        plain w = falling<plain>(substeps, 0);
        const body_id world = add_anchor(w, at(0, 0)), b = add_ball(w, at(1, 0));
        const joint_id mouse = w.create_joint(world, b, target_joint{});
        run(w, 16, 0.1 / 16);
        // (1 + omega t) e^(-omega t) of the way is left.
        CHECK(std::abs(number(w.position(b)[0]) - 0.178976) < 0.06 / substeps);
        w.set_joint(mouse, target_joint{.target = at(-50, 0), .max_force = S(2)});
        w.set_linear_velocity(b, at(0, 0));
        const double from = number(w.position(b)[0]);
        run(w, 64);
        CHECK(std::abs(from - number(w.position(b)[0]) - 1) < 0.02);
        CHECK(std::abs(number(w.reaction(mouse).force[0]) + 2) < 1e-3);
    }
}

/// A mechanism of three kinds, with its bodies in either order, in a world that is moved, turned and mirrored.
struct crane {
    plain w;
    body_id tip;
    joint_id winch;

    crane(bool swapped, double x, double angle, bool mirrored) : w(falling<plain>(4, 0)) {
        typename plain::settings_type settings = w.settings();
        const double m = mirrored ? -1 : 1;
        const transform world{at(x, x / 2), turn(angle)};
        settings.gravity = world.rotation * at(0, -gravity);
        w.set_settings(settings);
        const auto put = [&](double px, double py) { return world * at(m * px, py); };
        const body_id a =
            w.create_body({.type = body_type::static_body, .position = put(0, 0), .rotation = world.rotation});
        const auto arm = [&](double px, double py) {
            const body_id b = w.create_body({.position = put(px, py), .rotation = world.rotation});
            vec half = vec::filled(S(0.125));
            half[0] = S(0.5);
            w.create_shape(b, plain::box{half}, {.density = S(D == 2 ? 8 : 32)});
            w.set_can_sleep(b, false);
            return b;
        };
        const body_id first = arm(0.5, 0), second = arm(1.5, 0), third = arm(1.5, -1);
        const auto join = [&](body_id one, body_id two, auto joint) {
            joint.frame_a.position[0] *= S(m);
            joint.frame_b.position[0] *= S(m);
            if (!swapped) return w.create_joint(one, two, joint);
            std::swap(joint.frame_a, joint.frame_b);
            return w.create_joint(two, one, joint);
        };
        winch = join(a, first, revolute_joint{.frame_b = frame(-0.5), .frequency = S(1), .damping_ratio = S(0.25)});
        join(first, second, weld_joint{.frame_a = frame(0.5), .frame_b = frame(-0.5)});
        join(second, third,
             revolute_joint{
                 .frame_a = frame(0.25), .frame_b = frame(0.25, 1), .min_angle = S(-0.5), .max_angle = S(0.5)});
        tip = third;
    }
    /// Where the tip is, as the plain one has it.
    [[nodiscard]] vec place(double x, double angle, bool mirrored) const {
        const transform world{at(x, x / 2), turn(angle)};
        vec p = inverse_transform(world, w.position(tip));
        if (mirrored) p[0] = -p[0];
        return p;
    }
};
CELL_CASE("joint kinds: bodies swapped, and worlds moved, turned and mirrored, move alike") {
    crane first(false, 0, 0, false);
    run(first.w, 96);
    const double tolerance = number(cell::tolerance(1 << 13));
    for (const bool swapped : {false, true})
        for (const bool mirrored : {false, true})
            for (const double angle : {0.0, 2.0}) {
                CAPTURE(swapped);
                CAPTURE(mirrored);
                CAPTURE(angle);
                crane other(swapped, 3, angle, mirrored);
                run(other.w, 96);
                CHECK(length_of(other.place(3, angle, mirrored) - first.place(0, 0, false)) < tolerance);
                CHECK(std::abs(std::abs(number(other.w.joint_angle(other.winch))) -
                               std::abs(number(first.w.joint_angle(first.winch)))) < tolerance);
            }
}

CELL_CASE("joint kinds: a four-bar linkage keeps its energy for a minute") {
    plain w = falling<plain>(4);
    // A crank of 0.5 m, a coupler of 2 m and a rocker of 1.5 m, on 2 m of ground.
    const double x = 1.7444, y = 1.4781;
    const body_id ground = add_anchor(w, at(0, 0));
    const auto bar = [&](double x0, double y0, double x1, double y1) {
        const double half = std::hypot(x1 - x0, y1 - y0) / 2;
        const body_id b = add_box(w, at(0, 0), half, 0.0625);
        w.set_pose(b, {at((x0 + x1) / 2, (y0 + y1) / 2), turn(std::atan2(y1 - y0, x1 - x0))});
        w.set_can_sleep(b, false);
        return b;
    };
    const body_id crank = bar(0, 0, 0, 0.5), coupler = bar(0, 0.5, x, y), rocker = bar(2, 0, x, y);
    const joint_id shaft = w.create_joint(ground, crank, revolute_joint{.frame_b = frame(-0.25)});
    w.create_joint(crank, coupler, revolute_joint{.frame_a = frame(0.25), .frame_b = frame(-1)});
    w.create_joint(coupler, rocker, revolute_joint{.frame_a = frame(1), .frame_b = frame(0.75)});
    w.create_joint(ground, rocker, revolute_joint{.frame_a = frame(2), .frame_b = frame(-0.75)});
    set_spin(w, crank, 40);
    run(w, 1, 1.0 / 60);
    const auto energy = [&] {
        double sum = 0;
        for (const body_id b : {crank, coupler, rocker}) {
            const double v = length_of(w.linear_velocity(b)), spin = z_of(w.angular_velocity(b));
            sum += v * v / 2 + joint_laws::about_z(w.mass(b).inertia) * spin * spin / 2 +
                   gravity * number(w.position(b)[1]);
        }
        return sum;
    };
    // Energy sways with the crank by 1.5 %, and does not drift.
    const auto mean_of_seconds = [&](int seconds) {
        double sum = 0;
        for (int i = 0; i < 60 * seconds; ++i) {
            run(w, 1, 1.0 / 60);
            CHECK(length_of(w.pose(crank) * at(0.25) - w.pose(coupler) * at(-1)) < 2e-5);
            sum += energy();
        }
        return sum / (60 * seconds);
    };
    const double start = mean_of_seconds(10);
    mean_of_seconds(cell::is_fixed ? 5 : 40);
    CHECK(std::abs(mean_of_seconds(10) - start) < 0.01 * start);
    // It has turned all the time.
    CHECK(std::abs(number(w.joint_angle(shaft))) > 100);
}

CELL_CASE("joint kinds: bad ones are refused by name") {
    plain w = falling<plain>();
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(1));
    const auto refuses = [&](const char* field, const auto& joint) { is_refused(w, a, b, field, joint); };
    rotation stretched = turn(0);
    stretch(stretched);
    refuses("frame_a.rotation", revolute_joint{.frame_a = {{}, stretched}});
    refuses("frame_b.rotation", weld_joint{.frame_b = {{}, stretched}});
    refuses("min_angle", revolute_joint{.min_angle = S(1), .max_angle = S(0)});
    refuses("max_motor_torque", revolute_joint{.max_motor_torque = S(-1)});
    refuses("frequency", revolute_joint{.frequency = S(-1)});
    refuses("damping_ratio", revolute_joint{.frequency = S(1), .damping_ratio = S(-1)});
    refuses("min_translation", prismatic_joint{.min_translation = S(1), .max_translation = S(0)});
    refuses("max_motor_force", prismatic_joint{.max_motor_force = S(-1)});
    refuses("min_translation", wheel_joint{.min_translation = S(1), .max_translation = S(0)});
    refuses("steering_angle", wheel_joint{.steering_angle = S(1.6)});
    if constexpr (D == 2) refuses("steering_angle", wheel_joint{.steering_angle = S(0.5)});
    refuses("frequency", target_joint{.frequency = S(0)});
    refuses("max_force", target_joint{.max_force = S(-1)});
    refuses("linear_frequency", weld_joint{.linear_frequency = S(-1)});
    refuses("angular_damping_ratio", weld_joint{.angular_damping_ratio = S(-1)});
    if constexpr (!cell::is_fixed) {
        const S bad = S(0) / S(0);
        refuses("motor_speed", revolute_joint{.motor_speed = bad});
        refuses("rest_angle", revolute_joint{.rest_angle = bad});
        refuses("min_angle", revolute_joint{.min_angle = bad});
        refuses("rest_translation", prismatic_joint{.rest_translation = bad});
        transform frame;
        frame.position[1] = bad;
        refuses("frame_b.position.y", prismatic_joint{.frame_b = frame});
        frame.position[1] = cell::largest() * S(1.01);
        refuses("frame_b.position.y", prismatic_joint{.frame_b = frame});
    }
}

}  // namespace kind_laws
}  // namespace
