// Laws of joints in worlds: islands, sleep, workers, the hash, snapshots, and what is refused.
#pragma once

#include "joint_cell.hpp"
#include "laws/members.hpp"

namespace {
namespace joint_laws {

using own_joints::pin;

/// A net of balls that falls on the ground, over a bar in the air.
template <class World>
World net(int size = 12) {
    World w = falling<World>();
    // By iterations: few bodies would make one group of the direct solve.
    auto settings = w.settings();
    settings.solver.max_direct_cost = 0;
    w.set_settings(settings);
    vec up;
    up[1] = S(1);
    w.create_shape(add_anchor(w, at(0, 0)), typename World::halfspace{up});
    w.create_shape(add_anchor(w, at(1.5, 1.5)), typename World::box{vec::filled(S(0.25))});
    std::vector<body_id> all;
    for (int i = 0; i < size * size; ++i) {
        all.push_back(add_ball(w, at(0.3 * (i % size), 2.5 + 0.3 * (i / size)), 0.1));
        if (i % size > 0)
            w.create_joint(all[static_cast<std::size_t>(i) - 1], all.back(), distance_joint{.length = S(0.3)});
        if (i >= size)
            w.create_joint(all[static_cast<std::size_t>(i - size)], all.back(),
                           i % 2 ? distance_joint{.length = S(0.3), .min_length = S(0)}
                                 : distance_joint{.length = S(0.3), .frequency = S(4), .damping_ratio = S(1)});
    }
    return w;
}

struct backwards {
    [[nodiscard]] std::uint32_t workers() const { return 3; }
    template <class Task>
    void run(std::uint32_t count, const Task& task) const {
        for (std::uint32_t k = count; k-- > 0;) task(k, k % 3);
    }
};

template <class Recipe>
void any_workers_and_copies_agree() {
    using World = physics::world<Recipe>;
    World one = net<World>(), three = one;
    backwards by;
    for (int i = 0; i < 100; ++i) {
        one.step(S(1.0 / 64));
        three.step(S(1.0 / 64), by);
        REQUIRE(one.state_hash() == three.state_hash());
    }
    physics::detail::raw_snapshot<typename physics::detail::plan_of<Recipe>::type> saved;
    saved.save(physics::detail::world_access::state_of(one));
    const std::uint64_t then = one.state_hash();
    run(one, 20);
    const std::uint64_t later = one.state_hash();
    REQUIRE(saved.restore(physics::detail::world_access::data_of(one)));
    CHECK(one.state_hash() == then);
    run(one, 20);
    CHECK(one.state_hash() == later);
    // Over a world of another history.
    World other = net<World>(3);
    run(other, 5);
    REQUIRE(saved.restore(physics::detail::world_access::data_of(other)));
    run(other, 20);
    CHECK(other.state_hash() == later);
}
CELL_CASE("joints: workers, copies and snapshots go on by the same bits") {
    SUBCASE("soft_step") { any_workers_and_copies_agree<soft>(); }
    SUBCASE("sequential_impulse") { any_workers_and_copies_agree<hard>(); }
}

/// A chain that hangs from an anchor at (0, 10), asleep.
struct sleeping_chain {
    world w = falling<world>();
    body_id anchor = add_anchor(w, at(0, 10)), kinematic;
    std::vector<body_id> balls;
    std::vector<joint_id> rods;

    sleeping_chain() {
        kinematic = w.create_body({.type = body_type::kinematic_body, .position = at(3, 10)});
        for (int side = 0; side < 2; ++side) {
            body_id above = side == 0 ? anchor : kinematic;
            for (int i = 1; i <= 3; ++i) {
                balls.push_back(add_ball(w, at(3 * side, 10 - 0.5 * i)));
                rods.push_back(w.create_joint(above, balls.back(), distance_joint{.length = S(0.5)}));
                above = balls.back();
            }
        }
        for (int i = 0; i < 600 && !asleep(0, 6); ++i) run(w, 1);
        REQUIRE(asleep(0, 6));
    }
    [[nodiscard]] bool asleep(std::size_t from, std::size_t end) const {
        for (std::size_t i = from; i < end; ++i)
            if (!w.is_asleep(balls[i])) return false;
        return true;
    }
    [[nodiscard]] bool awake(std::size_t from, std::size_t end) const {
        for (std::size_t i = from; i < end; ++i)
            if (w.is_asleep(balls[i])) return false;
        return true;
    }
};
CELL_CASE("joints: what hangs together sleeps and wakes together") {
    sleeping_chain c;
    const std::uint64_t before = c.w.state_hash();
    const auto where = c.w.position(c.balls[2]);
    run(c.w, 100);
    CHECK(c.w.position(c.balls[2]) == where);
    CHECK(c.w.state_hash() != before);
    CHECK(number(c.w.reaction(c.rods[0]).force[1]) > 0.9 * 3 * gravity);
    SUBCASE("wake") { c.w.wake(c.balls[2]); }
    SUBCASE("impulse") { c.w.apply_impulse(c.balls[1], at(1)); }
    SUBCASE("set_joint") { c.w.set_joint(c.rods[0], distance_joint{.length = S(0.75)}); }
    SUBCASE("disabled") { c.w.set_joint_enabled(c.rods[0], false); }
    SUBCASE("destroyed") { c.w.destroy_joint(c.rods[0]); }
    SUBCASE("another joint") { c.w.create_joint(c.anchor, c.balls[2], distance_joint{.length = S(2)}); }
    SUBCASE("the anchor goes") { c.w.destroy_body(c.anchor); }
    SUBCASE("the anchor is moved") { c.w.set_pose(c.anchor, at(0, 10.5), {}); }
    SUBCASE("the anchor becomes dynamic") { c.w.set_type(c.anchor, body_type::dynamic_body); }
    CHECK(c.awake(0, 3));
    CHECK(c.asleep(3, 6));
    run(c.w, 1);
    CHECK(c.awake(0, 3));
}
CELL_CASE("joints: what is set to what it is sleeps on, and what changes wakes") {
    sleeping_chain c;
    const distance_joint now = c.w.joint<distance_joint>(c.rods[0]);
    c.w.set_joint(c.rods[0], now);
    c.w.set_joint(c.rods[0], distance_joint{.length = S(0.5)});
    c.w.set_joint_enabled(c.rods[0], true);
    CHECK(c.asleep(0, 6));
    distance_joint other = now;
    SUBCASE("an anchor") { other.anchor_b = at(0, 0.125); }
    SUBCASE("a limit") { other.max_length = S(0.625); }
    SUBCASE("a damping without effect") { other.damping_ratio = S(1); }
    c.w.set_joint(c.rods[0], other);
    CHECK(c.awake(0, 3));
    CHECK(c.asleep(3, 6));
}
CELL_CASE("joints: their kind is told") {
    using both = physics::recipe<S, D, few, physics::joints<physics::ball_joint, physics::distance_joint>>;
    physics::world<both> v;
    using ball_joint = physics::ball_joint<S, D>;
    const body_id a = add_anchor(v, at(0, 0)), b = add_ball(v, at(1));
    const joint_id ball = v.create_joint(a, b, ball_joint{.anchor_a = at(1)}),
                   rod = v.create_joint(a, b, distance_joint{});
    CHECK(v.is_joint<ball_joint>(ball));
    CHECK_FALSE(v.is_joint<distance_joint>(ball));
    CHECK(v.is_joint<distance_joint>(rod));
    CHECK_FALSE(v.is_joint<ball_joint>(rod));
    v.destroy_joint(rod);
    CHECK(refusal([&] { (void)v.is_joint<ball_joint>(rod); }).find("is_joint") != std::string::npos);
}
CELL_CASE("joints: a kinematic body that moves wakes what hangs on it, and keeps it awake") {
    sleeping_chain c;
    SUBCASE("by its velocity") { c.w.set_linear_velocity(c.kinematic, at(0.25)); }
    SUBCASE("to a target") { c.w.move_to(c.kinematic, at(3.25, 10), {}); }
    CHECK(c.awake(3, 6));
    CHECK(c.asleep(0, 3));
    if (number(c.w.linear_velocity(c.kinematic)[0]) == 0) return;
    run(c.w, 200);
    CHECK(c.awake(3, 6));
    CHECK(number(c.w.position(c.balls[5])[0]) > 3.3);
}
CELL_CASE("joints: what hits a sleeping chain wakes all of it") {
    sleeping_chain c;
    const body_id b = add_ball(c.w, at(-1, 8.5));
    c.w.set_gravity_scale(b, S(0));
    c.w.set_linear_velocity(b, at(4));
    for (int i = 0; i < 64 && c.asleep(0, 3); ++i) run(c.w, 1);
    CHECK(c.awake(0, 3));
    CHECK(c.asleep(3, 6));
}

CELL_CASE("joints: their bodies collide only where they are told to") {
    for (const bool collide : {false, true}) {
        CAPTURE(collide);
        world w = falling<world>(4, 0);
        const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(0.5, 0), 0.3);
        w.create_shape(a, world::ball{S(0.3)});
        run(w, 2);
        const joint_id rope =
            w.create_joint(a, b, distance_joint{.length = S(1), .min_length = S(0)}, {.collide_connected = collide});
        w.set_linear_velocity(b, at(-16));
        run(w, 1);
        CHECK((w.contacts().size() > 0) == collide);
        run(w, 8);
        CHECK((number(w.position(b)[0]) < 0) == !collide);
        if (collide) continue;
        // Bodies that lie in each other collide once the joint is gone, or disabled.
        w.set_pose(b, at(0.25, 0), {});
        w.set_linear_velocity(b, at(0));
        if (D == 2) w.set_joint_enabled(rope, false);
        else w.destroy_joint(rope);
        run(w, 1);
        CHECK(w.contacts().size() > 0);
    }
}

CELL_CASE("joints: they go with their bodies, and their handles know it") {
    world w = falling<world>();
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(1)), c = add_ball(w, at(2));
    const joint_id ab = w.create_joint(a, b, distance_joint{}, {.user_data = 7}),
                   bc = w.create_joint(b, c, distance_joint{}),
                   ca = w.create_joint(c, a, distance_joint{.length = S(2)});
    CHECK(w.joint_count() == 3);
    CHECK(w.user_data(ab) == 7);
    CHECK(w.body_a(bc) == b);
    CHECK(w.body_b(bc) == c);
    CHECK(w.joint<distance_joint>(ca).length == S(2));
    std::vector<joint_id> all;
    for (const joint_id j : w.joints()) all.push_back(j);
    CHECK(all == std::vector<joint_id>{ab, bc, ca});
    w.destroy_body(b);
    CHECK(!w.contains(ab));
    CHECK(!w.contains(bc));
    CHECK(w.contains(ca));
    CHECK(w.joint_count() == 1);
    run(w, 8);
    // A new body in the old one's slot has none of them.
    const body_id d = add_ball(w, at(5));
    CHECK(d.index == b.index);
    run(w, 8);
    CHECK(std::abs(number(w.position(d)[0]) - 5) < 1e-6);
    w.destroy_joint(ca);
    CHECK(w.joint_count() == 0);
    run(w, 8);
    for (const joint_id j : w.joints()) CHECK(!w.contains(j));
    // Slots are used again; old handles stay dead.
    const joint_id again = w.create_joint(a, d, distance_joint{.length = S(5)});
    CHECK(!w.contains(ab));
    CHECK(!w.contains(ca));
    CHECK(w.contains(again));
}

CELL_CASE("joints: bad ones are refused by name, and nothing changes") {
    world w = falling<world>(), other = falling<world>();
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(1)), foreign = add_ball(other, at(0));
    const joint_id j = w.create_joint(a, b, distance_joint{});
    run(w, 3);
    const std::uint64_t before = w.state_hash();
    const auto says = [&](const char* field, auto&& call) {
        const std::string text = refusal(call);
        CAPTURE(text);
        CHECK(text.find(field) != text.npos);
        CHECK(w.state_hash() == before);
    };
    const auto refuses = [&](const char* field, const distance_joint& bad) {
        says(field, [&] { w.create_joint(a, b, bad); });
        says(field, [&] { w.set_joint(j, bad); });
    };
    refuses("length is -1", {.length = S(-1)});
    refuses("length is 0", {.length = S(0)});
    refuses("frequency", {.frequency = S(-1)});
    refuses("damping_ratio", {.damping_ratio = S(-1)});
    refuses("min_length", {.length = S(1), .min_length = S(-1)});
    refuses("min_length", {.length = S(1), .min_length = S(2), .max_length = S(1.5)});
    if constexpr (!cell::is_fixed) {
        distance_joint bad;
        bad.anchor_b[1] = S(0) / S(0);
        refuses("anchor_b.y", bad);
        bad.anchor_b[1] = cell::largest() * S(1.01);
        refuses("anchor_b.y", bad);
    }
    says("body_b is the same", [&] { w.create_joint(b, b, distance_joint{}); });
    says("body_a is null", [&] { w.create_joint({}, b, distance_joint{}); });
    says("body_b is #0", [&] { w.create_joint(a, foreign, distance_joint{}); });
    says("joint is null", [&] { w.destroy_joint({}); });
    says("another world", [&] { other.destroy_joint(j); });
    w.destroy_joint(j);
    const std::string text = refusal([&] { (void)w.reaction(j); });
    CHECK(text.find("destroyed") != text.npos);
}

CELL_CASE("joints: the hash knows each number of them, or says that it leaves it out") {
    world w = falling<world>();
    add_chain(w, 3, at(0, 5));
    run(w, 20);
    auto& joints = physics::detail::world_access::state_of(w).joints;
    for (std::uint32_t i = 0; i < 3; ++i) {
        members_laws::every_member_is_hashed_or_said_not_to(w, joints.records[i]);
        auto& stored = joints.of_kind<distance_joint>()[i];
        members_laws::every_member_is_hashed_or_said_not_to(w, stored);
        const std::uint64_t before = w.state_hash();
        for (S& impulse : stored.impulse) {
            const S kept = impulse;
            impulse += S(1);
            CHECK(w.state_hash() != before);
            impulse = kept;
        }
        distance_joint::each_member(stored.joint, [&](auto& member) {
            members_laws::with_each_number_changed(member, [&] { CHECK(w.state_hash() != before); });
        });
    }
}

struct pinned : physics::recipe<S, D, few, physics::joints<physics::distance_joint, pin>> {};

CELL_CASE("joints: a kind of a user's own swings, sleeps, hashes and is copied as those of the library") {
    using World = physics::world<pinned>;
    World w = falling<World>(8);
    const body_id a = add_anchor(w, at(0, 2)), rod = w.create_body({.position = at(0.5, 2)}),
                  ball = add_ball(w, at(1, 1.5));
    vec half = vec::filled(S(0.125));
    half[0] = S(0.5);
    w.create_shape(rod, typename World::box{half}, {.density = S(D == 2 ? 4 : 16)});
    const joint_id hinge = w.create_joint(a, rod, pin<S, D>{{}, at(-0.5)});
    const joint_id rope = w.create_joint(rod, ball, distance_joint{.anchor_a = at(0.5), .length = S(0.5)});
    CHECK(w.joint<pin<S, D>>(hinge).anchor_b == at(-0.5));
    CHECK_THROWS((void)w.joint<distance_joint>(hinge));
    CHECK_THROWS((void)w.joint<pin<S, D>>(rope));
    CHECK_THROWS(w.set_joint(rope, pin<S, D>{}));
    double worst = 0, lowest = 2, longest = 0;
    const auto step = [&](World& of) {
        run(of, 1, 1.0 / 60);
        const auto pose = of.pose(rod);
        worst = std::max(worst, length_of(pose * at(-0.5) - at(0, 2)));
        longest = std::max(longest, std::abs(length_of(pose * at(0.5) - of.position(ball)) - 0.5));
        lowest = std::min(lowest, number((pose * at(0.5))[1]));
    };
    for (int i = 0; i < 120; ++i) step(w);
    CHECK(worst < 2e-3);
    CHECK(longest < 2e-3);
    CHECK(lowest < 1.01);
    World copy = w;
    for (int i = 0; i < 30; ++i) {
        step(w);
        step(copy);
        CHECK(copy.state_hash() == w.state_hash());
    }
    w.set_damping(rod, S(4), S(4));
    w.set_damping(ball, S(4), S(4));
    for (int i = 0; i < 900 && !w.is_asleep(rod); ++i) step(w);
    CHECK(w.is_asleep(rod));
    CHECK(w.is_asleep(ball));
    // It bears both.
    CHECK(std::abs(number(w.reaction(hinge).force[1]) - gravity * (number(w.mass(rod).mass) + 1)) < 0.3);
    w.destroy_body(rod);
    CHECK(w.joint_count() == 0);
}

CELL_CASE("joints: steps that differ in length shake nothing that hangs") {
    world w = falling<world>();
    body_id above = add_anchor(w, at(0, 10)), last;
    for (int i = 1; i <= 8; ++i) {
        last = add_ball(w, at(0, 10 - 0.5 * i));
        w.create_joint(above, last, distance_joint{.length = S(0.5)});
        above = last;
    }
    w.set_can_sleep(last, false);
    run(w, 128);
    cell::dice dice(5);
    double fastest = 0;
    for (int i = 0; i < 400; ++i) {
        const double lengths[] = {1.0 / 60, 1.0 / 30, 1.0 / 240, 1.0 / 1000, i % 50 == 0 ? 1e-5 : 1.0 / 60};
        w.step(S(lengths[dice.below(5)]));
        fastest = std::max(fastest, length_of(w.linear_velocity(last)));
    }
    // It stretches with the square of the substep, by 15 mm for the longest ones, and moves as that changes.
    CHECK(fastest < 0.4);
    CHECK(std::abs(number(w.position(last)[1]) - 6) < 0.025);
}

}  // namespace joint_laws
}  // namespace
