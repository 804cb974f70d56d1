// Laws of joints that are solved directly: heavy loads on light chains, mechanisms, lanes, and what can't be met.
#pragma once

#include "joint_cell.hpp"

namespace {
namespace direct_laws {

using namespace joint_laws;
using ball_joint = physics::ball_joint<S, D>;

using world_type = physics::world<joined<>>;

/// A chain of capsules of 1 m, level from an anchor on, with a ball at its end; scenes "ball and chain" of Box2D.
template <class World>
struct ball_and_chain {
    static constexpr double ball_radius = 8;
    World w;
    std::vector<body_id> links;
    body_id ball;

    ball_and_chain(int length, double ratio, int substeps, double sideways) : w(falling<World>(substeps)) {
        body_id last = add_anchor(w, at(0, 0));
        double mass = 0;
        for (int i = 0; i < length; ++i) {
            const body_id link =
                w.create_body({.position = at(i + 0.5), .linear_damping = S(0.1), .angular_damping = S(0.1)});
            w.create_shape(link, typename World::capsule{S(0.5), S(0.125)}, {.density = S(1)});
            mass = number(w.mass(link).mass);
            w.create_joint(last, link, ball_joint{at(i == 0 ? 0 : 0.5), at(-0.5)});
            links.push_back(last = link);
        }
        ball =
            w.create_body({.position = at(length + ball_radius), .linear_damping = S(0.1), .angular_damping = S(0.1)});
        const double r = ball_radius, size = D == 2 ? 3.141592653589793 * r * r : 4.1887902047863905 * r * r * r;
        w.create_shape(ball, typename World::ball{S(r)}, {.density = S(ratio * mass / size)});
        w.create_joint(last, ball, ball_joint{at(0.5), at(-r)});
        if (D == 3) w.set_linear_velocity(ball, at(0, 0, sideways));
    }
    /// The widest gap.
    [[nodiscard]] double gap() const {
        double worst = length_of(w.pose(links[0]) * at(-0.5));
        for (std::size_t i = 1; i < links.size(); ++i)
            worst = std::max(worst, length_of(w.pose(links[i]) * at(-0.5) - w.pose(links[i - 1]) * at(0.5)));
        return std::max(worst, length_of(w.pose(ball) * at(-ball_radius) - w.pose(links.back()) * at(0.5)));
    }
    double worst_of(int steps, double h = 1.0 / 60) {
        double worst = 0;
        for (int i = 0; i < steps; ++i) {
            w.step(S(h));
            worst = std::max(worst, gap());
        }
        return worst;
    }
};

template <class World>
void carries(int steps) {
    for (const double ratio : {1.0, 672.0, 50000.0})
        for (const int substeps : {1, 2, 4, 8}) {
            CAPTURE(ratio);
            CAPTURE(substeps);
            const double worst = ball_and_chain<World>(40, ratio, substeps, 5).worst_of(steps);
            // With the square of the substep, to the rounding of places at 50 m. What is light whips.
            CHECK(worst < (ratio > 1 ? 0.006 : 1.2) / (substeps * substeps) + number(cell::tolerance(1024)));
            // README's figures.
            if (substeps == 4) CHECK(worst < (ratio > 1 ? 0.0005 : 0.06));
        }
}
CELL_CASE("direct joints: a chain of 40 links does not stretch under 50,000 times its links, at any substeps") {
    carries<world_type>(cell::is_fixed ? 150 : 480);
}
CELL_CASE("direct joints: nor does it in sequential_impulse, which stretches it if it may not solve directly") {
    using World = physics::world<joined<physics::sequential_impulse>>;
    CHECK(ball_and_chain<World>(20, 672, 4, 5).worst_of(200) < 0.0005);
    ball_and_chain<World> iterative(20, 672, 4, 5);
    auto settings = iterative.w.settings();
    settings.solver.max_direct_cost = 0;
    iterative.w.set_settings(settings);
    CHECK(iterative.worst_of(60) > 0.01);
}
CELL_CASE("direct joints: a step that grows, shrinks and stalls leaves the chain whole") {
    ball_and_chain<world_type> s(20, 5000, 4, 3);
    cell::dice dice(11);
    double worst = 0;
    for (int i = 0; i < 300; ++i) {
        const double lengths[] = {1.0 / 60, 1.0 / 30, 1.0 / 240, 1.0 / 1000, 1.0 / 144};
        worst = std::max(worst, s.worst_of(1, lengths[dice.below(5)]));
    }
    CHECK(worst < 0.005);
}

CELL_CASE("direct joints: a pendulum keeps its energy and its length, the better the shorter the substeps") {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        world_type w = falling<world_type>(substeps);
        const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(1, 0));
        w.create_joint(a, b, ball_joint{{}, at(-1)});
        const double inertia = about_z(w.mass(b).inertia);
        double lowest = 1e9, highest = -1e9, longest = 0;
        for (int i = 0; i < 1200; ++i) {
            w.step(S(1.0 / 60));
            const double v = length_of(w.linear_velocity(b));
            const double spin = size_of(w.angular_velocity(b));
            const double energy = v * v / 2 + inertia * spin * spin / 2 + gravity * number(w.position(b)[1]);
            lowest = std::min(lowest, energy);
            highest = std::max(highest, energy);
            longest = std::max(longest, std::abs(length_of(w.pose(b) * at(-1))));
        }
        // Of 10 J/kg. It sways with the substep, and does not drift.
        const double h = 1.0 / 60 / substeps;
        CHECK(highest < gravity * 4.5 * h + 1e-3);
        CHECK(lowest > -gravity * 4.5 * h - 1e-3);
        CHECK(longest < 20 * h * h * h * 4.5 * 4.5 * 4.5 + number(cell::tolerance(128)));
    }
}

inline std::uint32_t below(cell::dice& dice, std::uint32_t limit) {
    return static_cast<std::uint32_t>(dice.below(static_cast<int>(limit)));
}
/// Bodies and rods at random: rods from each body to one before it, and `loops` more.
struct mechanism {
    using constraints = physics::solver_api::constraints<S, D, physics::without<>,
                                                         physics::joints<physics::ball_joint, physics::distance_joint>>;
    using body = physics::solver_api::solver_body<S, D>;
    using step_rod = physics::solver_api::step_joint<distance_joint, S, D>;
    using step_ball = physics::solver_api::step_joint<ball_joint, S, D>;

    std::vector<body> bodies;
    std::vector<distance_joint> kinds;
    std::vector<vec> places;
    std::vector<step_rod> rods;
    std::vector<physics::solver_api::body_pair> ends;

    mechanism(cell::dice& dice, std::uint32_t count, std::uint32_t loops, std::uint32_t copies) {
        const auto first = below(dice, 1000);
        for (std::uint32_t copy = 0; copy < copies; ++copy) {
            cell::dice same(first);
            const auto from = static_cast<std::uint32_t>(bodies.size());
            for (std::uint32_t i = 0; i < count; ++i) {
                body b{};
                b.velocity.linear = dice.vec<vec>(-3, 3);
                if (i > 0) {
                    b.inverse_mass = physics::inverse_of<S>(dice.number(0.01, 2));
                    set_inertia(b.inverse_inertia, dice.number(0.5, 8));
                } else b.velocity.linear = {};
                bodies.push_back(b);
                places.push_back(dice.vec<vec>(-4, 4));
            }
            for (std::uint32_t i = 1; i < count + loops; ++i) {
                const auto b = i < count ? i : 1 + below(same, count - 1);
                const auto a = below(same, b);
                ends.push_back({from + a, from + b});
            }
        }
        for (int i = 0; i < 2; ++i) bodies.push_back({});
        kinds.resize(ends.size());
        for (std::size_t i = 0; i < ends.size(); ++i) {
            distance_joint& rod = kinds[i];
            rod.anchor_a = dice.vec<vec>(-0.5, 0.5);
            rod.anchor_b = dice.vec<vec>(-0.5, 0.5);
            const vec between = places[ends[i].b] - places[ends[i].a];
            rod.length = rod.min_length = rod.max_length = S(length_of(between + rod.anchor_b - rod.anchor_a));
            rods.push_back({&rod, {{}, {}, {}, {}, between}, {}, S(0), 0});
        }
    }
    template <int Width>
    void solve(bool use_bias, int max_cost) {
        std::vector<std::uint32_t> numbers;
        for (std::uint32_t i = 0; i < rods.size(); ++i) numbers.push_back(i);
        physics::arena scratch;
        physics::detail::task_runner alone;
        physics::buffer<physics::solver_api::contact<S, D, physics::without<>>> none;
        const physics::solver_api::joint_list<ball_joint, S, D> no_balls(nullptr, nullptr, 0, nullptr, 0);
        const constraints c({none, scratch}, no_balls,
                            {rods.data(), numbers.data(), 0, ends.data(), static_cast<std::uint32_t>(rods.size())});
        const physics::solver_api::solver_bodies<S, D> seen{bodies.data(), static_cast<std::uint32_t>(bodies.size())};
        physics::solver_api::joint_solver<constraints, Width> solver(c, seen, nullptr, S(1.0 / 256), S(64), S(2),
                                                                     max_cost, scratch, alone);
        solver.warm_start(alone);
        if (use_bias) solver.solve_before_contacts(alone), solver.solve_after_contacts(alone);
        else solver.relax(alone, 1);
        solver.store_impulses(alone);
    }
    /// The largest speed along a rod.
    [[nodiscard]] double worst_speed() const {
        double worst = 0;
        for (std::size_t i = 0; i < rods.size(); ++i) {
            const vec line = rods[i].start.between + kinds[i].anchor_b - kinds[i].anchor_a;
            const vec v = velocity_at(bodies[ends[i].b].velocity, kinds[i].anchor_b) -
                          velocity_at(bodies[ends[i].a].velocity, kinds[i].anchor_a);
            worst = std::max(worst, std::abs(number(dot(v, line))) / length_of(line));
        }
        return worst;
    }
};

CELL_CASE("direct joints: one pass ends all speeds along the rods of a tree or of loops at once") {
    cell::dice dice(3);
    for (int n = 0; n < 120; ++n) {
        CAPTURE(n);
        const std::uint32_t loops = n % 3 == 0 ? 0 : below(dice, 5);
        mechanism m(dice, 2 + below(dice, 12), loops, 1);
        m.solve<1>(false, 1 << 20);
        CHECK(m.worst_speed() < number(cell::tolerance(1 << 13)));
    }
}
CELL_CASE("direct joints: equal trees side by side in lanes have the bits of one at a time") {
    constexpr int width = physics::detail::native_width<S>;
    for (int n = 0; n < 40; ++n) {
        CAPTURE(n);
        cell::dice first(static_cast<std::uint64_t>(n)), second(static_cast<std::uint64_t>(n));
        mechanism one(first, 6, n % 3 == 0 ? 2 : 0, 7), many(second, 6, n % 3 == 0 ? 2 : 0, 7);
        one.solve<1>(n % 2 == 0, 1 << 20);
        many.solve<width>(n % 2 == 0, 1 << 20);
        bool same = true;
        for (std::size_t i = 0; i < one.bodies.size(); ++i)
            same = same && one.bodies[i].velocity == many.bodies[i].velocity;
        CHECK(same);
        CHECK(one.worst_speed() < number(cell::tolerance(1 << 14)) + (n % 2 == 0 ? 4 : 0));
    }
}

CELL_CASE("direct joints: what cannot be met pulls, and ends in no leap") {
    for (const int substeps : {1, 4, 16}) {
        CAPTURE(substeps);
        world_type w = falling<world_type>(substeps, 0);
        // A triangle of rods of 1, 1 and 3 m, and a body that two anchors want at two places.
        const body_id b[] = {add_ball(w, at(0, 0)), add_ball(w, at(1, 0)), add_ball(w, at(0.5, 0.75))};
        for (int i = 0; i < 3; ++i) w.create_joint(b[i], b[(i + 1) % 3], distance_joint{.length = S(i == 2 ? 3 : 1)});
        const body_id c = add_ball(w, at(10, 0));
        w.create_joint(add_anchor(w, at(9, 0)), c, ball_joint{});
        w.create_joint(add_anchor(w, at(11, 0)), c, ball_joint{});
        double fastest = 0;
        for (int i = 0; i < 256; ++i) {
            w.step(S(1.0 / 64));
            for (const body_id id : {b[0], b[1], b[2], c})
                fastest = std::max(fastest, length_of(w.linear_velocity(id)));
        }
        CHECK(fastest < 40);
        for (const body_id id : b) CHECK(length_of(w.position(id)) < 30);
        CHECK(length_of(w.position(c) - at(10)) < 1.01);
    }
}

CELL_CASE("direct joints: a body that two pins hold at the same place bears its load on both") {
    // Each of the rows is there twice.
    world_type w = falling<world_type>(4);
    const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(0.5, 0));
    const joint_id one = w.create_joint(a, b, ball_joint{{}, at(-0.5)}),
                   two = w.create_joint(a, b, ball_joint{{}, at(-0.5)});
    w.set_damping(b, S(2), S(2));
    w.set_can_sleep(b, false);
    double worst = 0;
    for (int i = 0; i < 600; ++i) {
        w.step(S(1.0 / 64));
        worst = std::max(worst, length_of(w.pose(b) * at(-0.5)));
    }
    CHECK(worst < 1e-3);
    w.set_damping(b, S(0), S(0));
    run(w, 64);
    const vec sum = w.reaction(one).force + w.reaction(two).force;
    CHECK(std::abs(number(sum[1]) - gravity) < 0.02);
}

CELL_CASE("direct joints: no load makes joints sag, nor what is solved round by round, and no substeps are asked for") {
    for (const int substeps : {1, 2, 4, 8})
        for (const int cost : {0, 1024}) {
            CAPTURE(substeps);
            CAPTURE(cost);
            world_type w = falling<world_type>(substeps);
            auto settings = w.settings();
            settings.solver.max_direct_cost = cost;
            w.set_settings(settings);
            // Two balls, one under the other, and one at the end of a rope.
            const body_id a = add_anchor(w, at(0, 0)), b = add_ball(w, at(0, -1)), c = add_ball(w, at(0, -2)),
                          d = add_ball(w, at(4, -1));
            w.create_joint(a, b, ball_joint{{}, at(0, 1)});
            w.create_joint(b, c, ball_joint{at(0, -0.5), at(0, 0.5)});
            w.create_joint(a, d, distance_joint{.anchor_a = at(4), .min_length = S(0), .max_length = S(1)});
            for (const body_id id : {b, c, d}) w.set_can_sleep(id, false);
            run(w, 1280);
            const double slack = number(cell::tolerance(1 << 12));
            CHECK(std::abs(number(w.position(b)[1]) + 1) < slack);
            CHECK(std::abs(number(w.position(c)[1]) + 2) < slack);
            CHECK(std::abs(number(w.position(d)[1]) + 1) < slack);
            CHECK(substeps_for(w, S(1e-4)) == 1);
        }
}

}  // namespace direct_laws
}  // namespace
