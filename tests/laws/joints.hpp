// Laws of joints: what a distance joint holds, what that costs in energy and momentum, and that lanes, workers and
// solvers change none of it.
#pragma once

#include "joint_cell.hpp"

namespace {
namespace joint_laws {

/// The worst error of a pendulum of 1 m from level, and the most energy that it has gained (J/kg).
template <class Recipe>
struct swing {
    double error = 0, gain = 0, drop = 0;

    explicit swing(int substeps, double h = 1.0 / 60, double anchor = 0) {
        using World = physics::world<Recipe>;
        World w = falling<World>(substeps);
        const body_id a = add_anchor(w, at(anchor, 2)), b = add_ball(w, at(anchor + 1, 2));
        w.create_joint(a, b, distance_joint{});
        for (int i = 0; i < static_cast<int>(4 / h); ++i) {
            w.step(S(h));
            error = std::max(error, std::abs(distance_of(w, a, b) - 1));
            const double v = length_of(w.linear_velocity(b)), y = number(w.position(b)[1]);
            gain = std::max(gain, v * v / 2 + gravity * (y - 2));
            drop = std::max(drop, 2 - y);
        }
    }
};

template <class Recipe>
void a_rod_holds() {
    double last = 1;
    for (const int substeps : {1, 4, 16, 64}) {
        CAPTURE(substeps);
        const swing<Recipe> s(substeps);
        // The rows are tangents to the path: within a substep at v they miss it by (v h)^2 / 2, and a part of that is
        // left where the next one begins.
        const double h = 1.0 / 60 / substeps;
        CHECK(s.error < 3 * (2 * gravity) * h * h + 1e-4);
        CHECK(s.error < last);
        if (substeps <= 16) CHECK(s.error < (substeps == 1 ? 0.012 : substeps == 4 ? 0.0008 : 0.00006));
        // It swings through the lowest point, and gains nothing,
        CHECK(s.drop > 0.999);
        // but for what its energy sways with the substep.
        CHECK(s.gain < gravity * std::sqrt(2 * gravity) * h);
        last = s.error + 2e-5;
    }
    for (const double h : {1.0 / 30, 1.0 / 144, 1.0 / 1000}) {
        CAPTURE(h);
        CHECK(swing<Recipe>(4, h).error < 3 * (2 * gravity) * (h / 4) * (h / 4) + 1e-4);
    }
}
CELL_CASE("joints: a rod keeps its length, the better the more substeps, and gains no energy") {
    SUBCASE("soft_step") { a_rod_holds<soft>(); }
    SUBCASE("sequential_impulse") { a_rod_holds<hard>(); }
    SUBCASE("without rotation") { a_rod_holds<unturned>(); }
}

CELL_CASE("joints: what hangs pulls by its weight, and a chain by that of all below") {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        world w = falling<world>(substeps);
        std::vector<joint_id> rods;
        body_id above = add_anchor(w, at(0, 10));
        for (int i = 1; i <= 5; ++i) {
            const body_id b = add_ball(w, at(0, 10 - 0.5 * i));
            rods.push_back(w.create_joint(above, b, distance_joint{.length = S(0.5)}));
            above = b;
        }
        run(w, 256, 1.0 / 60);
        for (int i = 0; i < 5; ++i) {
            CAPTURE(i);
            const auto r = w.reaction(rods[static_cast<std::size_t>(i)]);
            // On B, which hangs on A.
            CHECK(std::abs(number(r.force[1]) - gravity * (5 - i)) < 0.02 * gravity);
            CHECK(std::abs(number(r.force[0])) < 1e-3);
        }
    }
}

template <class Recipe>
void a_rope_is_slack_or_taut() {
    using World = physics::world<Recipe>;
    World w = falling<World>(), free = falling<World>();
    const body_id a = add_anchor(w, at(0, 5)), b = add_ball(w, at(0.25, 5)), alone = add_ball(free, at(0.25, 5));
    const joint_id rope = w.create_joint(a, b, distance_joint{.length = S(1), .min_length = S(0)});
    // It falls for 0.43 s and 0.94 m before the rope is taut, as it would without. In other substeps: what touches
    // nothing has forces from its user only.
    for (int i = 0; i < 24; ++i) {
        w.step(S(1.0 / 64));
        free.step(S(1.0 / 64));
        CHECK(length_of(w.position(b) - free.position(alone)) <= number(cell::tolerance(16)));
        CHECK(length_of(w.reaction(rope).force) == 0);
    }
    double longest = 0;
    for (int i = 0; i < 640; ++i) {
        w.step(S(1.0 / 64));
        longest = std::max(longest, distance_of(w, a, b));
    }
    CHECK(longest < 1.002);
    CHECK(longest > 0.999);
    // It hangs, or swings a little yet.
    CHECK(std::abs(length_of(w.reaction(rope).force) - gravity) < 0.1 * gravity);
}
CELL_CASE("joints: a rope does nothing while it is slack, and stops what it holds when it is taut") {
    SUBCASE("soft_step") { a_rope_is_slack_or_taut<soft>(); }
    SUBCASE("sequential_impulse") { a_rope_is_slack_or_taut<hard>(); }
}

CELL_CASE("joints: a limit holds between a rope and a strut, from both sides") {
    world w = falling<world>(4, 0);
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(1, 0));
    w.create_joint(a, b, distance_joint{.length = S(1), .min_length = S(0.5), .max_length = S(1.5)});
    double shortest = 1, longest = 1;
    for (const double speed : {-3.0, 4.0}) {
        w.set_linear_velocity(b, at(speed));
        for (int i = 0; i < 128; ++i) {
            w.step(S(1.0 / 64));
            shortest = std::min(shortest, distance_of(w, a, b));
            longest = std::max(longest, distance_of(w, a, b));
        }
        // It stops there, and does not come back.
        CHECK(std::abs(distance_of(w, a, b) - (speed < 0 ? 0.5 : 1.5)) < 1e-3);
    }
    CHECK(shortest > 0.499);
    CHECK(longest < 1.501);
}

template <class Recipe>
void a_spring_swings_as_it_says() {
    // Hung on a spring of 2 Hz, 1 kg sags by g / (2 pi f)^2.
    const double sag = gravity / (4 * 3.141592653589793 * 3.141592653589793 * 4);
    {
        auto w = falling<physics::world<Recipe>>(16);
        const body_id a = add_anchor(w, at(0, 5)), b = add_ball(w, at(0, 4));
        w.create_joint(a, b, distance_joint{.length = S(1), .frequency = S(2), .damping_ratio = S(0.5)});
        run(w, 400, 1.0 / 100);
        CHECK(std::abs(distance_of(w, a, b) - 1 - sag) < 1e-3 * sag + number(cell::tolerance(256)));
    }
    // Without damping it is back after half a second; implicit steps lose energy in proportion to their length.
    auto w = falling<physics::world<Recipe>>(64, 0);
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(1.25, 0));
    w.create_joint(a, b, distance_joint{.length = S(1), .frequency = S(2)});
    run(w, 50, 1.0 / 200);
    CHECK(std::abs(distance_of(w, a, b) - 0.75) < 0.01);
    run(w, 50, 1.0 / 200);
    CHECK(std::abs(distance_of(w, a, b) - 1.25) < 0.02);
}
CELL_CASE("joints: a spring has its frequency, and sags by its load") {
    SUBCASE("soft_step") { a_spring_swings_as_it_says<soft>(); }
    SUBCASE("sequential_impulse") { a_spring_swings_as_it_says<hard>(); }
}

template <class Recipe>
void momentum_is_kept() {
    using World = physics::world<Recipe>;
    cell::dice dice(7);
    for (int n = 0; n < 20; ++n) {
        CAPTURE(n);
        World w = falling<World>(4, 0);
        const body_id b[] = {add_ball(w, at(0, 0)), add_ball(w, at(1, 0)), add_ball(w, at(0.5, 1))};
        for (int i = 0; i < 3; ++i) {
            w.set_linear_velocity(b[i], dice.vec<vec>(-2, 2));
            const double spring = n % 3 == 0 ? 3 : 0;
            const vec r_a = dice.vec<vec>(-0.2, 0.2), r_b = dice.vec<vec>(-0.2, 0.2);
            const double apart = length_of(w.position(b[(i + 1) % 3]) + r_b - w.position(b[i]) - r_a);
            w.create_joint(b[i], b[(i + 1) % 3],
                           distance_joint{.anchor_a = r_a,
                                          .anchor_b = r_b,
                                          .length = S(spring > 0 ? 0.9 * apart : apart),
                                          .frequency = S(spring),
                                          .damping_ratio = S(0.25)});
        }
        const auto momentum = [&] {
            vec sum;
            for (const body_id id : b) sum += w.linear_velocity(id);
            return sum;
        };
        const auto spin = [&] {
            // About z.
            double sum = 0;
            for (const body_id id : b) {
                const vec r = w.position(id), v = w.linear_velocity(id);
                sum += number(r[0]) * number(v[1]) - number(r[1]) * number(v[0]);
                if constexpr (D == 2) sum += number(w.mass(id).inertia) * number(w.angular_velocity(id));
                else sum += number(w.mass(id).inertia.zz) * number(w.angular_velocity(id)[2]);
            }
            return sum;
        };
        const vec before = momentum();
        const double spun = spin();
        run(w, 64);
        CHECK(length_of(momentum() - before) < number(cell::tolerance(4096)));
        // Rows are written where the bodies are, so that no pair of forces has a moment.
        CHECK(std::abs(spin() - spun) < number(cell::tolerance(1 << 14)));
    }
}
CELL_CASE("joints: among themselves they keep the momentum, and the angular one") {
    SUBCASE("soft_step") { momentum_is_kept<soft>(); }
    SUBCASE("sequential_impulse") { momentum_is_kept<hard>(); }
}

/// Bodies and joints at random, as a solver sees them.
template <int Width>
std::vector<physics::solver_api::solver_body<S, D>> solved(std::uint64_t seed, int max_direct_cost) {
    using constraints =
        physics::solver_api::constraints<S, D, physics::without<>, physics::joints<physics::distance_joint>>;
    constexpr std::uint32_t bodies = 24, joints = 60;
    cell::dice dice(seed);
    std::vector<physics::solver_api::solver_body<S, D>> b(bodies + 2);
    for (std::uint32_t i = 0; i < bodies; ++i) {
        b[i].velocity.linear = dice.vec<vec>(-3, 3);
        // Some are not pushed.
        if (i % 5 == 0) continue;
        b[i].inverse_mass = physics::inverse_of<S>(dice.number(0.5, 2));
        set_inertia(b[i].inverse_inertia, dice.number(0.5, 8));
    }
    std::vector<distance_joint> kinds(joints);
    std::vector<physics::solver_api::step_joint<distance_joint, S, D>> all;
    std::vector<physics::solver_api::body_pair> ends;
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < joints; ++i) {
        kinds[i].anchor_a = dice.vec<vec>(-0.5, 0.5);
        kinds[i].anchor_b = dice.vec<vec>(-0.5, 0.5);
        if (i % 3 == 1) kinds[i].frequency = S(3), kinds[i].min_length = S(0.25);
        if (i % 3 == 2) kinds[i].min_length = S(0);
        all.push_back(
            {&kinds[i], {{}, {}, {}, {}, dice.vec<vec>(-2, 2)}, {S(0.5), S(0.25), S(0.125)}, S(1.0 / 128), i});
        const auto a = static_cast<std::uint32_t>(dice.below(bodies));
        ends.push_back({a, (a + 1 + static_cast<std::uint32_t>(dice.below(bodies - 1))) % bodies});
        numbers.push_back(i);
    }
    physics::arena scratch;
    physics::detail::task_runner alone;
    physics::buffer<physics::solver_api::contact<S, D, physics::without<>>> none;
    const constraints c({none, scratch}, {all.data(), numbers.data(), 0, ends.data(), joints});
    const physics::solver_api::solver_bodies<S, D> seen{b.data(), bodies + 2};
    const S h(1.0 / 256);
    std::vector<physics::twist<S, D>> starts(bodies + 2);
    physics::solver_api::joint_solver<constraints, Width> solver(c, seen, nullptr, h, S(64), S(2), max_direct_cost,
                                                                 scratch, alone);
    for (int i = 0; i < 4; ++i) {
        if (i % 2 == 0) solver.warm_start(alone);
        solver.solve_before_contacts(alone);
        solver.solve_after_contacts(alone);
        for (auto& one : b) {
            one.displacement.linear += one.velocity.linear * h;
            one.displacement.angular += one.velocity.angular * h;
        }
        solver.update_rows(alone, i % 2 == 0 ? starts.data() : nullptr);
        solver.relax(alone, i);
    }
    solver.store_impulses(alone);
    for (const auto& start : starts) {
        physics::solver_api::solver_body<S, D> row;
        row.velocity = start;
        b.push_back(row);
    }
    // What they gave, as one more row.
    for (const auto& j : all) {
        physics::solver_api::solver_body<S, D> row;
        for (int k = 0; k < 2; ++k) row.velocity.linear[k] = j.impulse[k];
        row.displacement.linear[0] = j.impulse[2];
        b.push_back(row);
    }
    return b;
}
CELL_CASE("joints: lanes give the bits of one joint at a time") {
    constexpr int width = physics::detail::native_width<S>;
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        CAPTURE(seed);
        for (const int max_direct_cost : {0, 1 << 20}) {
            CAPTURE(max_direct_cost);
            const auto one = solved<1>(seed, max_direct_cost), many = solved<width>(seed, max_direct_cost);
            bool same = true;
            for (std::size_t i = 0; i < one.size(); ++i)
                same = same && one[i].velocity == many[i].velocity && one[i].displacement == many[i].displacement;
            CHECK(same);
        }
    }
}

CELL_CASE("joints: a pass without bias ends all speed along a rod, and nothing else") {
    using constraints =
        physics::solver_api::constraints<S, D, physics::without<>, physics::joints<physics::distance_joint>>;
    cell::dice dice(3);
    for (int n = 0; n < 200; ++n) {
        CAPTURE(n);
        physics::solver_api::solver_body<S, D> b[4];
        for (int i = 0; i < 2; ++i) {
            b[i].velocity.linear = dice.vec<vec>(-3, 3);
            b[i].inverse_mass = physics::inverse_of<S>(dice.number(0.1, 4));
            set_inertia(b[i].inverse_inertia, dice.number(0.1, 4));
        }
        distance_joint rod{.anchor_a = dice.vec<vec>(-1, 1), .anchor_b = dice.vec<vec>(-1, 1)};
        const vec between = dice.vec<vec>(-4, 4), line = between + rod.anchor_b - rod.anchor_a;
        if (length_of(line) < 0.125) continue;
        // Solved directly, what is off leaves of its speed the square of its error, as a part of what it measures.
        if (n % 2 == 1) rod.length = rod.min_length = rod.max_length = S(length_of(line) * 1.01);
        const vec before = velocity_at(b[1].velocity, rod.anchor_b) - velocity_at(b[0].velocity, rod.anchor_a);
        physics::solver_api::step_joint<distance_joint, S, D> j{&rod, {{}, {}, {}, {}, between}, {}, S(0), 0};
        const std::uint32_t number_of = 0;
        const physics::solver_api::body_pair ends{0, 1};
        physics::arena scratch;
        physics::detail::task_runner alone;
        physics::buffer<physics::solver_api::contact<S, D, physics::without<>>> none;
        const constraints c({none, scratch}, {&j, &number_of, 0, &ends, 1});
        physics::solver_api::joint_solver<constraints> solver(c, {b, 4}, nullptr, S(1.0 / 64), S(16), S(2),
                                                              n % 2 == 0 ? 0 : 256, scratch, alone);
        solver.warm_start(alone);
        solver.relax(alone, n / 2);
        const vec v = velocity_at(b[1].velocity, rod.anchor_b) - velocity_at(b[0].velocity, rod.anchor_a);
        const auto square = [](const vec& x) { return number(dot(x, x)); };
        const double speed = std::abs(number(dot(before, line))) / length_of(line),
                     part = 1e-4 * square(line) / (square(between) + square(rod.anchor_a) + square(rod.anchor_b)),
                     left = n % 2 == 1 ? 1.01 * part * speed : 0;
        CHECK(std::abs(number(dot(v, line))) / length_of(line) < number(cell::tolerance(512)) + left);
    }
}

CELL_CASE("joints: without rotation the bits are those of locked rotations") {
    physics::world<unturned> plain = falling<physics::world<unturned>>();
    world locked = falling<world>();
    const auto build = [](auto& w) {
        const body_id a = add_anchor(w, at(0, 3));
        body_id last = a;
        for (int i = 1; i < 6; ++i) {
            const body_id b = w.create_body({.position = at(0.5 * i, 3), .rotation_locked = true});
            w.create_shape(b, typename std::remove_cvref_t<decltype(w)>::ball{S(0.2)});
            w.create_joint(last, b, distance_joint{.anchor_b = at(0.1, 0.05), .length = S(0.5)});
            last = b;
        }
    };
    build(plain);
    build(locked);
    for (int i = 0; i < 128; ++i) {
        run(plain, 1);
        run(locked, 1);
    }
    auto other = locked.bodies().begin();
    for (const body_id b : plain.bodies()) {
        CHECK(plain.position(b) == locked.position(*other));
        CHECK(plain.linear_velocity(b) == locked.linear_velocity(*other));
        ++other;
    }
}

}  // namespace joint_laws
}  // namespace
