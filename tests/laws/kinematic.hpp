// Laws of bodies that targets move: how fast they say that they are, what rides on them, and what they push.
#pragma once

#include <string>

#include "refusal.hpp"
#include "world_cell.hpp"

namespace {
namespace kinematic_laws {

const double h = 1.0 / 64;

struct ride {
    world w;
    body_id floor, crate;

    explicit ride(double crate_at = 0) {
        auto settings = w.settings();
        settings.gravity = along(1, -10);
        w.set_settings(settings);
        floor = w.create_body({.type = body_type::kinematic_body});
        vec half = vec::filled(S(4));
        half.y = S(0.25);
        w.create_shape(floor, world::box{half});
        crate = add_box(w, at(crate_at, 0.75));
    }
    vec apart() const { return w.position(crate) - w.position(floor); }
    void move_to(vec position, const world::rotation_type& turn = {}) {
        w.move_to(floor, position, turn);
        run(w, 1);
    }
};

CELL_CASE("kinematic: a body that targets move says how fast, and that it stands once there are none") {
    world w(weightless());
    const body_id b = w.create_body({.type = body_type::kinematic_body, .position = at(1, 2)});
    w.create_shape(b, world::box{vec::filled(S(0.5))});
    for (int i = 1; i <= 16; ++i) {
        const auto turn = turned_about_z(i / 32.0);
        w.move_to(b, at(1 + i / 16.0, 2 - i / 32.0), turn);
        CHECK(gap(w.linear_velocity(b), at(i > 1 ? 4 : 0, i > 1 ? -2 : 0)) <= rounding(400, 4));
        run(w, 1);
        CHECK(gap(w.linear_velocity(b), at(4, -2)) <= rounding(400, 4));
        CHECK(gap(w.angular_velocity(b), about_z(2)) <= rounding(1000, 2));
        CHECK(gap(w.velocity_at(b, w.position(b) + along(0, 1)), at(4, 0)) <= rounding(2000, 4));
    }
    // What it stands by is the target, not the velocity.
    const auto stands = w.pose(b);
    for (int i = 0; i < 3; ++i) {
        run(w, 1);
        CHECK(w.linear_velocity(b) == vec{});
        CHECK(w.angular_velocity(b) == angular{});
        CHECK(w.position(b) == stands.position);
        CHECK(gap(w.rotation(b), stands.rotation) <= rounding(8));
    }
    // Told to stay, it stands too.
    w.move_to(b, stands);
    run(w, 1);
    CHECK(w.linear_velocity(b) == vec{});
    CHECK(w.angular_velocity(b) == angular{});
    // A velocity that is given it goes on with, and with nothing else.
    w.move_to(b, stands.position + along(0, 1), turned_about_z(1));
    run(w, 1);
    w.set_linear_velocity(b, along(1, 3));
    CHECK(w.angular_velocity(b) == angular{});
    const auto from = w.pose(b);
    run(w, 2);
    CHECK(w.linear_velocity(b) == along(1, 3));
    CHECK(gap(w.position(b), from.position + along(1, 6 * h)) <= rounding(8, 4));
    CHECK(w.rotation(b) == from.rotation);
    // Let go, it flies on as it moved.
    w.move_to(b, w.position(b) + along(0, h), w.rotation(b));
    run(w, 1);
    w.set_type(b, body_type::dynamic_body);
    run(w, 64);
    CHECK(gap(w.linear_velocity(b), along(0, 1)) <= rounding(400));
}

CELL_CASE("kinematic: whether a velocity is that of a target lasts in copies, and enters the hash") {
    world w(weightless());
    const body_id b = w.create_body({.type = body_type::kinematic_body});
    w.create_shape(b, world::box{});
    w.move_to(b, along(0, h), {});
    run(w, 1);
    world going = w;
    going.set_linear_velocity(b, w.linear_velocity(b));
    CHECK(going.state_hash() != w.state_hash());
    const world kept = w;
    run(w, 1);
    run(going, 1);
    const auto stood = w.state_hash();
    CHECK(w.linear_velocity(b) == vec{});
    CHECK(number(going.position(b).x) > 1.5 * h);
    going = kept;
    run(going, 1);
    CHECK(going.state_hash() == stood);
}

CELL_CASE("kinematic: a crate rides on what targets move along, up and down and around, and sleeps when it stands") {
    // To the side: at 2 m/s from standing, so that it slips first.
    {
        ride r;
        vec rests;
        for (int i = 1; i <= 192; ++i) {
            r.move_to(along(0, i * 2 * h));
            if (i == 64) rests = r.apart();
            if (i < 64) continue;
            CHECK(gap(r.w.linear_velocity(r.crate), along(0, 2)) <= 1e-2);
            CHECK(gap(r.apart(), rests) <= 4e-3);
        }
        CHECK(!r.w.is_asleep(r.crate));
        run(r.w, 256);
        CHECK(r.w.is_asleep(r.crate));
    }
    // Up and down with up to 2 m/s and 8 m/s^2, and so around a circle with a fifth of it.
    for (const bool around : {false, true}) {
        ride r;
        run(r.w, 32);
        const vec start = r.apart();
        for (int i = 1; i <= 256; ++i) {
            const double t = 4 * i * h;
            r.move_to(around ? at(0.1 * std::cos(t) - 0.1, 0.1 * std::sin(t)) : at(0, 0.25 - 0.25 * std::cos(t)));
            CHECK(gap(r.apart(), start) <= 1e-2);
        }
    }
#if CELL_DIMENSION == 3
    // On a carousel: 1 rad/s, 2 m from the axis.
    ride r(2);
    vec start;
    for (int i = 1; i <= 320; ++i) {
        const auto turn = world::rotation_type::from_axis_angle(along(1, 1), S(i * h));
        r.move_to({}, turn);
        if (i == 64) start = inverse_rotate(turn, r.apart());
        if (i < 64) continue;
        CHECK(gap(inverse_rotate(turn, r.apart()), start) <= 5e-3);
        CHECK(gap(r.w.linear_velocity(r.crate), r.w.velocity_at(r.floor, r.w.position(r.crate))) <= 5e-2);
    }
#endif
}

CELL_CASE("kinematic: what stands in the way of a target is taken along, however far the way") {
    // Ways of 0.5 to 5 m in one step; the crate's phase on them, its size, and whether it lies on a floor.
    for (const double far : {0.5, 1.0, 3.0, 5.0})
        for (const double size : {0.1, 0.25, 0.5})
            for (int phase = 0; phase < 5; ++phase) {
                CAPTURE(far);
                CAPTURE(size);
                CAPTURE(phase);
                const bool lies = phase % 2;
                world w(weightless());
                if (lies) {
                    auto settings = w.settings();
                    settings.gravity = along(1, -10);
                    w.set_settings(settings);
                    const body_id ground = w.create_body({.type = body_type::static_body});
                    w.create_shape(ground, world::halfspace{});
                }
                const body_id wall = w.create_body({.type = body_type::kinematic_body, .position = at(0, 1.5)});
                vec half = vec::filled(S(1.4375));
                half.x = S(0.25);
                w.create_shape(wall, world::box{half});
                // Not yet in touch.
                const double gap_before = 0.05 + phase * 0.2 * (far - 0.1);
                const body_id crate = add_box(w, at(0.25 + size + gap_before, lies ? size : 1.5), size);
                run(w, 1);
                w.move_to(wall, at(far, 1.5), {});
                run(w, 1);
                CHECK(w.position(wall) == at(far, 1.5));
                // In front of it, sunk in by no more than half of its size.
                const auto in_front = [&] { return number(w.position(crate).x) - far - 0.25; };
                CHECK(in_front() >= -0.01);
                CHECK(in_front() <= size + std::max(0.0, gap_before - far) + 0.05);
                run(w, 64);
                CHECK(in_front() >= size - 0.02);
                CHECK(number(length(w.linear_velocity(crate))) <= 4);
            }
}

CELL_CASE("kinematic: a paddle that a target turns takes along what it meets") {
    world w(weightless());
    const body_id paddle = w.create_body({.type = body_type::kinematic_body});
    vec half = vec::filled(S(0.125));
    half.x = S(2);
    w.create_shape(paddle, world::box{half});
    const body_id ball = add_ball(w, at(1, 1), 0.25);
    w.move_to(paddle, {}, turned_about_z(1.5));
    run(w, 1);
    // Ahead of the paddle, on the side towards which it turns.
    const vec seen = inverse_rotate(w.rotation(paddle), w.position(ball));
    CHECK(number(seen.y) >= 0.25);
    CHECK(number(length(w.position(ball))) <= 1.5);
    run(w, 32);
    CHECK(number(inverse_rotate(w.rotation(paddle), w.position(ball)).y) >= 0.36);
}

CELL_CASE(
    "kinematic: a step that would take a body out of the range is refused with nothing changed, by sleepers too") {
    ride r;
    run(r.w, 128);
    REQUIRE(r.w.is_asleep(r.crate));
    vec far, fast;
    far.y = cell::largest() * S(0.4);
    fast.y = cell::largest() * S(0.25);
    const body_id leaving =
        r.w.create_body({.type = body_type::kinematic_body, .position = far, .linear_velocity = fast});
    r.w.create_shape(leaving, world::ball{S(0.25)});
    bool refused = false;
    for (int i = 0; i < 64 && !refused; ++i) {
        const auto before = r.w.state_hash();
        refused = refusal([&] { r.w.step(S(0.125)); }).find("step: ") != std::string::npos;
        CHECK((r.w.state_hash() == before) == refused);
    }
    CHECK(refused);
    CHECK(r.w.is_asleep(r.crate));
}

}  // namespace kinematic_laws
}  // namespace
