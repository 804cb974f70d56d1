// Sleep: who falls asleep, who does not, what wakes whom, and that nothing of the motion is lost by it.
#pragma once

#include <functional>
#include <vector>

#include "world_cell.hpp"
#include "world_real.hpp"

namespace {
namespace sleeping_laws {

struct wakeful : physics::recipe<cell::scalar, cell::dimension, physics::without<physics::feature::sleeping>> {};

world::settings_type pulled() {
    world::settings_type settings;
    settings.gravity = along(1, -10);
    return settings;
}

/// A stack of boxes on the ground, and a single box 5 m to its right, all asleep.
struct bedroom {
    world w{pulled()};
    body_id ground = add_ground(w);
    std::vector<body_id> stack;
    body_id alone;

    explicit bedroom(int height = 3) {
        for (int i = 0; i < height; ++i) stack.push_back(add_box(w, at(0, 0.5 + i)));
        alone = add_box(w, at(5, 0.5));
        fall_asleep();
    }
    void fall_asleep() {
        for (int i = 0; i < 512 && w.awake_count() > 0; ++i) run(w, 1);
        REQUIRE(w.awake_count() == 0);
    }
    [[nodiscard]] bool stack_sleeps() const {
        for (const body_id id : stack)
            if (!w.is_asleep(id)) return false;
        return true;
    }
    [[nodiscard]] bool stack_is_awake() const {
        for (const body_id id : stack)
            if (w.is_asleep(id)) return false;
        return true;
    }
};

CELL_CASE("sleep: what rests sleeps, keeps its contacts and its place to the bit, and its state") {
    bedroom b;
    const auto contacts = b.w.contacts().size();
    CHECK(contacts == 4);
    std::vector<world::transform> poses;
    for (const body_id id : b.stack) poses.push_back(b.w.pose(id));
    run(b.w, 64);
    CHECK(b.w.awake_count() == 0);
    CHECK(b.w.contacts().size() == contacts);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        CHECK(b.w.pose(b.stack[i]) == poses[i]);
        CHECK(b.w.linear_velocity(b.stack[i]) == vec{});
        CHECK(b.w.angular_velocity(b.stack[i]) == angular{});
    }
    CHECK(!b.w.is_asleep(b.ground));
    for (const auto& c : b.w.contacts()) {
        CHECK(c.count > 0);
        for (int k = 0; k < c.count; ++k) CHECK(c.points[k].normal_impulse >= S(0));
    }
}

CELL_CASE("sleep: whatever happens to a body wakes its island, and no other") {
    const std::vector<std::function<void(bedroom&)>> deeds = {
        [](bedroom& b) { b.w.wake(b.stack[1]); },
        [](bedroom& b) { b.w.apply_impulse(b.stack[2], along(0, 1)); },
        [](bedroom& b) { b.w.apply_local_impulse_at(b.stack[0], along(0, 1), along(1, 0.25)); },
        [](bedroom& b) { b.w.apply_force(b.stack[2], along(0, 1)); },
        [](bedroom& b) { b.w.apply_torque(b.stack[1], about_z(1)); },
        [](bedroom& b) { b.w.apply_angular_impulse(b.stack[1], about_z(0.125)); },
        [](bedroom& b) { b.w.set_linear_velocity(b.stack[2], along(0, 0.25)); },
        [](bedroom& b) { b.w.set_angular_velocity(b.stack[2], about_z(0.25)); },
        [](bedroom& b) { b.w.set_pose(b.stack[2], at(0, 4), world::rotation_type{}); },
        [](bedroom& b) { b.w.set_gravity_scale(b.stack[0], S(2)); },
        [](bedroom& b) { b.w.set_rotation_locked(b.stack[0], true); },
        [](bedroom& b) { b.w.set_can_sleep(b.stack[0], false); },
        [](bedroom& b) { b.w.set_mass(b.stack[0], b.w.mass(b.stack[1])); },
        [](bedroom& b) { b.w.reset_mass(b.stack[1]); },
        [](bedroom& b) { b.w.set_material(*b.w.shapes(b.stack[1]).begin(), {.friction = S(0)}); },
        [](bedroom& b) { b.w.create_shape(b.stack[1], world::ball{S(0.25)}); },
        [](bedroom& b) { b.w.set_type(b.stack[0], body_type::static_body), b.stack.erase(b.stack.begin()); },
        [](bedroom& b) { b.w.destroy_body(b.stack[0]), b.stack.erase(b.stack.begin()); },
        [](bedroom& b) { b.w.destroy_shape(*b.w.shapes(b.stack[1]).begin()); },
    };
    for (std::size_t i = 0; i < deeds.size(); ++i) {
        CAPTURE(i);
        bedroom b;
        const auto contacts = b.w.contacts().size();
        deeds[i](b);
        CHECK(b.stack_is_awake());
        CHECK(b.w.is_asleep(b.alone));
        CHECK(b.w.contacts().size() <= contacts);
        run(b.w, 1);
        CHECK(b.stack_is_awake());
        CHECK(b.w.is_asleep(b.alone));
    }
    // What is nothing wakes nobody.
    bedroom b;
    b.w.apply_force(b.stack[0], vec{});
    b.w.apply_impulse(b.stack[0], vec{});
    b.w.set_linear_velocity(b.stack[0], vec{});
    b.w.clear_forces(b.stack[0]);
    CHECK(b.stack_sleeps());
}

CELL_CASE("sleep: what holds sleepers up wakes them as it goes, and what moves into them as it comes") {
    const auto wakes_all = [](const std::function<void(bedroom&)>& deed, int steps) {
        bedroom b;
        deed(b);
        run(b.w, steps);
        return b.stack_is_awake();
    };
    CHECK(wakes_all([](bedroom& b) { b.w.destroy_body(b.ground); }, 1));
    CHECK(wakes_all([](bedroom& b) { b.w.destroy_shape(*b.w.shapes(b.ground).begin()); }, 1));
    CHECK(wakes_all([](bedroom& b) { b.w.set_pose(b.ground, at(0, -1), world::rotation_type{}); }, 1));
    CHECK(wakes_all([](bedroom& b) { b.w.set_material(*b.w.shapes(b.ground).begin(), {.friction = S(0)}); }, 1));
    CHECK(wakes_all([](bedroom& b) { b.w.set_settings(world::settings_type{}); }, 1));
    // A wall that is built into the stack, one that is put there, and others that are driven or carried there.
    const auto wall = [](bedroom& b, body_type type, double x) {
        const body_id id = b.w.create_body({.type = type, .position = at(x, 1.5)});
        b.w.create_shape(id, world::box{vec::filled(S(0.25))});
        return id;
    };
    CHECK(wakes_all([&](bedroom& b) { wall(b, body_type::static_body, 0.5); }, 0));
    CHECK(!wakes_all([&](bedroom& b) { wall(b, body_type::static_body, -3); }, 64));
    CHECK(wakes_all(
        [&](bedroom& b) { b.w.set_pose(wall(b, body_type::static_body, -3), at(-0.5, 1.5), world::rotation_type{}); },
        0));
    CHECK(wakes_all([&](bedroom& b) { b.w.set_linear_velocity(wall(b, body_type::kinematic_body, -3), along(0, 2)); },
                    72));
    CHECK(wakes_all(
        [&](bedroom& b) { b.w.move_to(wall(b, body_type::kinematic_body, -3), at(-0.5, 1.5), world::rotation_type{}); },
        1));
}

CELL_CASE("sleep: on something that moves nobody sleeps; on what stands still they do") {
    world w(pulled());
    const body_id belt = w.create_body({.type = body_type::kinematic_body, .position = at(0, -0.5)});
    vec half = vec::filled(S(0.5));
    half.x = S(50);
    w.create_shape(belt, world::box{half});
    const body_id box = add_box(w, at(0, 0.5));
    w.set_linear_velocity(belt, along(0, 1.0 / 32));
    run(w, 256);
    CHECK(!w.is_asleep(box));
    w.set_linear_velocity(belt, vec{});
    run(w, 256);
    CHECK(w.is_asleep(box));
    w.set_linear_velocity(belt, along(0, 1));
    run(w, 128);
    CHECK(!w.is_asleep(box));
    CHECK(number(w.linear_velocity(box).x) > 0.9);
}

CELL_CASE("sleep: what is told to stay where it is wakes nobody, what is told to go on does") {
    bedroom b;
    const body_id shelf = b.w.create_body({.type = body_type::kinematic_body, .position = at(-5, 2)});
    b.w.create_shape(shelf, world::box{vec::filled(S(0.5))});
    const body_id sleeper = add_box(b.w, at(-5, 3));
    b.fall_asleep();
    REQUIRE(b.w.is_asleep(sleeper));
    for (int i = 0; i < 4; ++i) {
        b.w.move_to(shelf, b.w.pose(shelf));
        run(b.w, 1);
        CHECK(b.w.is_asleep(sleeper));
        CHECK(b.w.position(shelf) == at(-5, 2));
    }
    b.w.move_to(shelf, {at(-5, 1.9375), {}});
    CHECK(!b.w.is_asleep(sleeper));
    CHECK(b.stack_sleeps());
}

CELL_CASE("sleep: a slow drift in free space goes on for ever; what stands still in it sleeps") {
    world w(weightless());
    const body_id slow = add_ball(w, at(0, 0)), still = add_ball(w, at(0, 5)), spinning = add_ball(w, at(0, 10));
    w.set_linear_velocity(slow, along(0, 1.0 / 1024));
    w.set_angular_velocity(spinning, about_z(1.0 / 1024));
    run(w, 256);
    CHECK(!w.is_asleep(slow));
    CHECK(w.linear_velocity(slow) == along(0, 1.0 / 1024));
    CHECK(!w.is_asleep(spinning));
    CHECK(w.is_asleep(still));
}

CELL_CASE("sleep: one that may not sleep keeps its island awake") {
    world w(pulled());
    add_ground(w);
    const body_id low = add_box(w, at(0, 0.5));
    const body_id top = w.create_body({.position = at(0, 1.5), .can_sleep = false});
    w.create_shape(top, world::box{vec::filled(S(0.5))});
    CHECK(!w.can_sleep(top));
    run(w, 256);
    CHECK(!w.is_asleep(low));
    CHECK(!w.is_asleep(top));
    w.set_can_sleep(top, true);
    run(w, 256);
    CHECK(w.is_asleep(low));
    CHECK(w.is_asleep(top));
    world::settings_type never = w.settings();
    never.sleeping.enabled = false;
    w.set_settings(never);
    CHECK(!w.is_asleep(low));
    run(w, 256);
    CHECK(!w.is_asleep(low));
}

CELL_CASE("sleep: a blow is answered in the step in which it falls, as if nobody had slept") {
    for (const double speed : {1.0, 1.25, 8.0, 32.0}) {
        CAPTURE(speed);
        world::settings_type settings = weightless();
        std::vector<vec> velocities[2];
        for (const bool sleeps : {false, true}) {
            settings.sleeping.enabled = sleeps;
            world w(settings);
            const body_id target = add_ball(w, at(0, 0)), other = add_ball(w, at(0, 10));
            run(w, 64);
            REQUIRE(w.is_asleep(target) == sleeps);
            const body_id ball = add_ball(w, at(-3, 0.25));
            w.set_linear_velocity(ball, along(0, speed));
            const momentum before = momentum_of(w);
            for (int i = 0; i < 512 && w.linear_velocity(target) == vec{}; ++i) run(w, 1);
            for (int i = 0; i < 8; ++i) {
                run(w, 1);
                velocities[sleeps].push_back(w.linear_velocity(target));
                velocities[sleeps].push_back(w.linear_velocity(ball));
            }
            CHECK(spread((momentum_of(w) - before).linear, {}) <= rounding(256, 8 * speed));
            CHECK(number(w.linear_velocity(target).x) > 0.25 * speed);
            CHECK(w.is_asleep(other) == sleeps);
        }
        CHECK(velocities[0] == velocities[1]);
    }
}

CELL_CASE("sleep: a pile that is hit wakes with all its contacts, and none is lost or doubled") {
    bedroom b(5);
    const body_id ball = b.w.create_body({.position = at(-4, 2.5), .linear_velocity = along(0, 8)});
    b.w.create_shape(ball, world::ball{S(0.25)});
    int steps = 0;
    for (; steps < 128 && b.stack_sleeps(); ++steps) run(b.w, 1);
    REQUIRE(steps < 128);
    CHECK(b.stack_is_awake());
    // Five boxes stand on each other and the ground, one beside, and the ball touches one of them.
    CHECK(b.w.contacts().size() == 7);
    int of_stack = 0;
    for (const auto& c : b.w.contacts()) {
        int others = 0;
        for (const auto& d : b.w.contacts()) others += c.shape_a == d.shape_a && c.shape_b == d.shape_b;
        CHECK(others == 1);
        // Warm: nobody in the pile has forgotten what it carries.
        if (c.body_a == ball || c.body_b == ball || c.body_a == b.alone || c.body_b == b.alone) continue;
        ++of_stack;
        for (int k = 0; k < c.count; ++k) CHECK(c.points[k].persisted);
    }
    CHECK(of_stack == 5);
    // The ball rolls on for ever, but without the others.
    run(b.w, 512);
    CHECK(b.stack_sleeps());
}

CELL_CASE("sleep: steps of changing length pass sleepers by, and who wakes in one bears his load at once") {
    bedroom b(4);
    const auto loads = [&] {
        std::vector<double> all;
        for (const auto& c : b.w.contacts())
            for (int k = 0; k < c.count; ++k) all.push_back(number(c.points[k].normal_impulse));
        return all;
    };
    const auto before = loads();
    cell::dice dice(61);
    for (int i = 0; i < 256; ++i) b.w.step(S(1.0 / (32 << dice.below(3))));
    // To the bit: nobody has touched them.
    CHECK(loads() == before);
    // Woken between two steps, or by a blow within one, the ground bears what lies on it in the first step.
    const auto borne = [&](const std::vector<body_id>& by) {
        double sum = 0;
        for (const auto& c : b.w.contacts())
            for (const body_id id : by)
                if ((c.body_a == b.ground && c.body_b == id) || (c.body_b == b.ground && c.body_a == id))
                    for (int k = 0; k < c.count; ++k) sum += number(c.points[k].normal_impulse);
        return sum;
    };
    for (const double h : {1.0 / 32, 1.0 / 128}) {
        b.w.wake(b.stack[0]);
        b.w.step(S(h));
        CHECK(std::abs(borne(b.stack) / (40 * h) - 1) <= 0.3);
        b.fall_asleep();
        b.w.step(S(1.0 / 128));
        const body_id ball = b.w.create_body({.position = at(5, 1.4), .linear_velocity = along(1, -2)});
        b.w.create_shape(ball, world::ball{S(0.25)}, {.density = S(0.01)});
        while (b.w.is_asleep(b.alone)) b.w.step(S(h));
        CHECK(std::abs(borne({b.alone}) / (10 * h) - 1) <= 0.3);
        b.w.destroy_body(ball);
        b.fall_asleep();
    }
}

CELL_CASE(
    "sleep: who lies on what stands, though it could move, sleeps on when others wake, and has his contacts once") {
    bedroom b;
    const body_id shelf = b.w.create_body({.type = body_type::kinematic_body, .position = at(-5, 2)});
    b.w.create_shape(shelf, world::box{vec::filled(S(0.5))});
    const body_id sleeper = add_box(b.w, at(-5, 3));
    b.w.set_rotation_locked(sleeper, true);
    run(b.w, 256);
    REQUIRE(b.w.is_asleep(sleeper));
    REQUIRE(b.stack_sleeps());
    const body_id ball = b.w.create_body({.position = at(-2, 1.5), .linear_velocity = along(0, 8)});
    b.w.create_shape(ball, world::ball{S(0.25)});
    const auto contacts_of = [&](body_id id) {
        int count = 0;
        for (const auto& c : b.w.contacts()) count += c.body_a == id || c.body_b == id;
        return count;
    };
    bool woke = false;
    for (int i = 0; i < 256; ++i) {
        run(b.w, 1);
        woke = woke || b.stack_is_awake();
        REQUIRE(b.w.is_asleep(sleeper));
        REQUIRE(contacts_of(sleeper) == 1);
    }
    CHECK(woke);
}

CELL_CASE("sleep: contacts of a sleeper stay where they are on its surface when a new shape moves its centre of mass") {
    bedroom b;
    const auto points = [&] {
        std::vector<vec> all;
        for (const auto& c : b.w.contacts())
            for (int k = 0; k < c.count; ++k) {
                if (c.body_a != b.alone && c.body_b != b.alone) continue;
                all.push_back(c.body_a == b.alone ? c.points[k].local_a : c.points[k].local_b);
                all.push_back(c.points[k].position);
            }
        return all;
    };
    const std::vector<vec> before = points();
    REQUIRE(before.size() > 0);
    b.w.create_shape(b.alone, world::ball{S(0.25)}, {.position = at(0, 0.5)});
    const std::vector<vec> after = points();
    REQUIRE(after.size() == before.size());
    for (std::size_t i = 0; i < after.size(); ++i) CHECK(gap(after[i], before[i]) <= rounding(16, 8));
}

CELL_CASE("sleep: a step that is refused has woken nobody") {
    // Fixed point wraps where floats become infinite.
    if (cell::is_fixed) return;
    bedroom b;
    // It comes near enough for a contact, so that the step has found whom it hits before it is refused.
    const body_id ball = b.w.create_body({.position = at(-1.265, 1.5), .linear_velocity = along(0, 4)});
    b.w.create_shape(ball, world::ball{S(0.25)});
    run(b.w, 8);
    REQUIRE(b.stack_sleeps());
    const body_id far = add_ball(b.w, at(100, 100));
    b.w.set_linear_velocity(far, along(0, number(cell::largest()) / 2));
    const auto before = b.w.state_hash();
    bool refused = false;
    try {
        b.w.step(S(16));
    } catch (const physics::error&) {
        refused = true;
    }
    REQUIRE(refused);
    CHECK(b.stack_sleeps());
    CHECK(b.w.state_hash() == before);
    // Nor has it left word whom to wake.
    world other = b.w;
    other.wake(b.alone);
    for (const body_id id : b.stack) CHECK(other.is_asleep(id));
    b.w.destroy_body(far);
    run(b.w, 4);
    CHECK(b.stack_is_awake());
}

CELL_CASE("sleep: copies sleep and wake alike") {
    bedroom b;
    world copy = b.w;
    for (world* w : {&b.w, &copy}) {
        const body_id ball = w->create_body({.position = at(-2, 1.5), .linear_velocity = along(0, 6)});
        w->create_shape(ball, world::ball{S(0.25)});
    }
    for (int i = 0; i < 256; ++i) {
        run(b.w, 1);
        run(copy, 1);
        REQUIRE(b.w.state_hash() == copy.state_hash());
    }
}

CELL_CASE("sleep: a recipe without it has nobody asleep, and moves as one in which it is switched off") {
    using other = physics::world<wakeful>;
    static_assert(sizeof(other) < sizeof(world));
    other a(other::settings_type{.gravity = along(1, -10)});
    world::settings_type settings = pulled();
    settings.sleeping.enabled = false;
    world b(settings);
    const auto fill = [](auto& w) {
        using any = std::remove_reference_t<decltype(w)>;
        w.create_shape(w.create_body({.type = body_type::static_body}), typename any::halfspace{});
        body_id id;
        for (int i = 0; i < 4; ++i) {
            id = w.create_body({.position = at(0.125 * i, 0.5 + i)});
            w.create_shape(id, typename any::box{vec::filled(S(0.5))});
        }
        return id;
    };
    const body_id in_a = fill(a), in_b = fill(b);
    for (int i = 0; i < 256; ++i) {
        a.step(S(1.0 / 64));
        b.step(S(1.0 / 64));
    }
    CHECK(a.pose(in_a) == b.pose(in_b));
    CHECK(!a.is_asleep(in_a));
    a.wake(in_a);
    CHECK(a.awake_count() == 4);
}

CELL_CASE("sleep: sets of numbers are those that links make") {
    cell::dice dice(77);
    physics::arena scratch;
    for (int round = 0; round < 50; ++round) {
        scratch.reset();
        const auto some = [&](std::uint32_t n) { return static_cast<std::uint32_t>(dice.below(static_cast<int>(n))); };
        const std::uint32_t count = 1 + some(60);
        physics::detail::disjoint_sets sets(count, scratch);
        // The slow twin: everybody carries the least name that it can reach.
        std::vector<std::uint32_t> name(count);
        for (std::uint32_t i = 0; i < count; ++i) name[i] = i;
        for (std::uint32_t links = some(80); links > 0; --links) {
            const std::uint32_t a = some(count), b = some(count);
            sets.unite(a, b);
            const std::uint32_t least = std::min(name[a], name[b]), most = std::max(name[a], name[b]);
            for (std::uint32_t& n : name)
                if (n == most) n = least;
        }
        for (std::uint32_t i = 0; i < count; ++i) REQUIRE(sets.find(i) == name[i]);
    }
}

}  // namespace sleeping_laws
}  // namespace
