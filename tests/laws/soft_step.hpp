// Laws of the soft step solver: colours, lanes, conservation, and scenes with exact answers.
#pragma once

#include "../../samples/scenes.hpp"
#include "soft_contacts.hpp"

namespace {
namespace soft_step_laws {

using soft_contacts_laws::solve_softly;

struct soft : physics::recipe<S, D, physics::soft_step> {};
using soft_world = physics::world<soft>;
using physics::body_id;

CELL_CASE("colours: every contact has one, and no two of a colour push the same body but in the last") {
    cell::dice dice(400);
    for (int run = 0; run < 60; ++run) {
        const int body_count = 2 + dice.below(60), contact_count = dice.below(run % 3 == 0 ? 400 : 60);
        std::vector<physics::solver_api::solver_body<S, D>> bodies(static_cast<std::size_t>(body_count));
        for (auto& b : bodies)
            if (dice.below(4)) b.inverse_mass = physics::inverse_of<S>(1);
        // A body that all touch, in some: it has more contacts than there are colours.
        if (run % 3 == 0) bodies[0].inverse_mass = physics::inverse_of<S>(1);
        physics::buffer<contact> contacts;
        for (int i = 0; i < contact_count; ++i) {
            contact c{};
            auto& [a, b] = c.bodies;
            a = run % 3 == 0 ? 0u : static_cast<std::uint32_t>(dice.below(body_count));
            do b = static_cast<std::uint32_t>(dice.below(body_count));
            while (b == a);
            contacts.push_back(c);
        }
        physics::arena scratch;
        const physics::solver_api::solver_bodies<S, D> view{bodies.data(), static_cast<std::uint32_t>(body_count)};
        const auto colours =
            physics::detail::colour(physics::solver_api::contact_constraints<S, D>(contacts, scratch), view, scratch);
        std::vector<int> seen(static_cast<std::size_t>(contact_count));
        REQUIRE(colours.begin[colours.count] == contacts.size());
        for (std::uint32_t group = 0; group < colours.count; ++group) {
            const bool serial = colours.last_is_serial && group + 1 == colours.count;
            std::vector<int> pushed(bodies.size());
            REQUIRE(colours.begin[group] < colours.begin[group + 1]);
            for (std::uint32_t at = colours.begin[group]; at < colours.begin[group + 1]; ++at) {
                const contact& c = contacts[colours.order[at]];
                ++seen[colours.order[at]];
                for (const std::uint32_t b : {c.bodies.body_a, c.bodies.body_b}) {
                    if (!(bodies[b].inverse_mass > physics::inverse_of<S>(0))) continue;
                    REQUIRE((serial || pushed[b] == 0));
                    ++pushed[b];
                }
            }
        }
        for (const int times : seen) REQUIRE(times == 1);
        if (contact_count > 390 && run % 3 == 0) CHECK(colours.last_is_serial);
    }
}

CELL_CASE("batches: islands are whole, every edge is in one, in order, and names its bodies") {
    cell::dice dice(407);
    for (int run = 0; run < 40; ++run) {
        // Many small islands, one of which may hold most; some bodies only push, and some edges end at nobody that is
        // awake. Bodies have other numbers in the world.
        // No multiple of 7, so that the other numbers are all different.
        const int body_count = 7 * (43 + dice.below(86)) + 1;
        const int edge_count = 200 + dice.below(run % 2 == 0 ? 500 : 2000);
        std::vector<physics::solver_api::solver_body<S, D>> bodies(static_cast<std::size_t>(body_count));
        for (auto& b : bodies)
            if (dice.below(8)) b.inverse_mass = physics::inverse_of<S>(1);
        const int reach = run % 4 == 3 ? body_count : 1 + dice.below(6);
        std::vector<std::uint32_t> awake_index(2 * bodies.size(), static_cast<std::uint32_t>(body_count));
        const auto world_number = [&](std::uint32_t awake) {
            return awake * 7 % static_cast<std::uint32_t>(body_count) * 2;
        };
        for (std::uint32_t k = 0; k < bodies.size(); ++k) awake_index[world_number(k)] = k;
        physics::buffer<physics::solver_api::edge> edges;
        physics::buffer<physics::solver_api::body_pair> named;
        for (int i = 0; i < edge_count; ++i) {
            const auto a = static_cast<std::uint32_t>(dice.below(body_count));
            const int other = static_cast<int>(a) + 1 + dice.below(reach);
            const auto b = static_cast<std::uint32_t>(other < body_count ? other : body_count);
            const auto pushed = [&](std::uint32_t k) {
                return k < bodies.size() && bodies[k].inverse_mass > physics::inverse_of<S>(0);
            };
            if (!pushed(a) && !pushed(b)) continue;
            edges.push_back({world_number(a), b < bodies.size() ? world_number(b) : 1});
            named.push_back({a, b});
        }
        physics::arena scratch;
        bool* is_pushed = scratch.allocate<bool>(static_cast<std::uint32_t>(body_count) + 1);
        for (int i = 0; i < body_count; ++i)
            is_pushed[i] = bodies[static_cast<std::size_t>(i)].inverse_mass > physics::inverse_of<S>(0);
        is_pushed[body_count] = false;
        const auto parts = physics::detail::graph_builder(edges, awake_index.data(), is_pushed,
                                                          static_cast<std::uint32_t>(body_count), scratch)
                               .result();
        std::vector<int> times(edges.size());
        std::vector<std::uint32_t> home(bodies.size(), ~0u);
        std::uint32_t largest = 0;
        for (std::uint32_t k = 0; k < parts.count; ++k) {
            const auto& part = parts.first[k];
            const auto name_of = [&](std::uint32_t number) { return parts.body_at[part.bodies + number]; };
            REQUIRE(name_of(part.static_slot - part.bodies) == static_cast<std::uint32_t>(body_count));
            for (std::uint32_t i = part.edges; i < part.end; ++i) {
                const std::uint32_t n = parts.order[i];
                if (i > part.edges) REQUIRE(parts.order[i - 1] < n);
                ++times[n];
                REQUIRE(name_of(parts.ends[i].a) == named[n].a);
                REQUIRE(name_of(parts.ends[i].b) == named[n].b);
                for (const std::uint32_t b : {named[n].a, named[n].b}) {
                    if (!is_pushed[b]) continue;
                    if (home[b] == ~0u) home[b] = k;
                    REQUIRE(home[b] == k);
                }
            }
            largest = part.end - part.edges > largest ? part.end - part.edges : largest;
        }
        for (const int n : times) REQUIRE(n == 1);
        for (std::uint32_t i = 0; i < bodies.size(); ++i) REQUIRE(parts.body_at[parts.slot_of[i]] == i);
        // Unless one island holds nearly all, there are several batches, none much above the size that is aimed at.
        if (reach == 1) {
            CHECK(parts.count > 1);
            CHECK(largest <= physics::detail::graph_builder::target_weight);
        }
    }
}

CELL_CASE("soft step: impulses keep momentum, and angular momentum but for friction across gaps") {
    cell::dice dice(401);
    for (int run = 0; run < 40; ++run) {
        problem p = random_problem(dice, 6, 0.6, false);
        // Angular impulses against rolling come in pairs too.
        for (contact& c : p.contacts) c.rolling_resistance = run % 2 ? dice.real(0, 0.1) : S(0);
        const momenta before = momenta_of(p);
        if (run % 3) solve_softly<physics::detail::native_width<S>>(p, 1 + run % 8);
        else
            solve_softly<physics::detail::native_width<S>, complete, physics::soft_step_with<physics::point_friction>>(
                p, 1 + run % 8);
        const momenta after = momenta_of(p);
        // In 3D friction acts on each body at its own surface.
        reals across{};
        for (const contact& c : p.contacts) {
            if (cell::is_2d) break;
            reals friction{};
            double gap = 0;
            for (int k = 0; k < c.count; ++k) {
                friction = friction + to_reals(physics::tangents<S, D>(c.normal).combine(c.points[k].friction_impulse));
                gap += cell::number(c.points[k].separation) / c.count;
            }
            across = across + cross(to_reals(c.normal) * std::max(gap, 0.0), friction);
        }
        REQUIRE(size(after.linear - before.linear) <= 512 * epsilon);
        REQUIRE(size(after.angular - before.angular - across) <= 4096 * epsilon);
    }
}

/// Gravity 10 on a tilted plane.
soft_world soft_slope(double angle, double friction, double restitution = 0) {
    soft_world::settings_type settings;
    settings.gravity = {};
    settings.gravity.y = S(-10);
    settings.solver.restitution_threshold = S(0);
    soft_world w(settings);
    soft_world::halfspace ground;
    ground.normal.x = S(-std::sin(angle));
    ground.normal.y = S(std::cos(angle));
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), ground,
                   {.material = {.friction = S(friction), .restitution = S(restitution)}});
    return w;
}
body_id soft_block(soft_world& w, double angle, double friction, double restitution = 0) {
    soft_world::body_def def;
    def.position.x = S(-0.5 * std::sin(angle));
    def.position.y = S(0.5 * std::cos(angle));
    def.rotation = rotation_about({0, 0, 1}, angle);
    const body_id b = w.create_body(def);
    w.create_shape(b, soft_world::box{vec::filled(S(0.5))},
                   {.material = {.friction = S(friction), .restitution = S(restitution)}});
    return b;
}
inline void run(soft_world& w, int steps, double h = 1.0 / 60) {
    for (int i = 0; i < steps; ++i) w.step(S(h));
}

CELL_CASE("soft step: a block slips where the friction is below the tangent of the slope, as fast as it must") {
    const double angle = 0.4, g = 10;
    for (const double mu : {0.0, 0.2, 0.3}) {
        soft_world w = soft_slope(angle, mu);
        const body_id b = soft_block(w, angle, mu);
        run(w, 60);
        const double speed = size(to_reals(w.linear_velocity(b)));
        CHECK(std::abs(speed - g * (std::sin(angle) - mu * std::cos(angle))) <= 0.03);
    }
    soft_world w = soft_slope(angle, 0.6);
    const body_id b = soft_block(w, angle, 0.6);
    const vec start = w.position(b);
    run(w, 600);
    CHECK(size(to_reals(w.position(b) - start)) <= 0.005);
    CHECK(size(to_reals(w.linear_velocity(b))) <= 1e-3);
}

CELL_CASE("soft step: a cube stops after v^2 / (2 mu g), less half a substep's way") {
    soft_world w = soft_slope(0, 0.5);
    const body_id b = soft_block(w, 0, 0.5);
    run(w, 10);
    const double start = cell::number(w.position(b).x), v = 10;
    vec speed;
    speed.x = S(v);
    w.set_linear_velocity(b, speed);
    run(w, 240);
    const double displacement = cell::number(w.position(b).x) - start;
    CHECK(std::abs(displacement - (v * v / (2 * 5) - 0.5 * v / 240)) <= 0.001);
}

template <int N>
void spin_down() {
    if constexpr (N == 3) {
        soft_world w = soft_slope(0, 0.5);
        const body_id b = soft_block(w, 0, 0.5);
        run(w, 20);
        w.set_angular_velocity(b, to_angular(reals{0, 5, 0}));
        // Each corner carries a quarter, 0.707 m from the axis: torque mu m g r against an inertia of m / 6.
        const double slowing = 0.5 * 10 * std::sqrt(0.5) * 6;
        run(w, 6);
        CHECK(std::abs(to_reals(w.angular_velocity(b)).y - (5 - slowing * 0.1)) <= 0.15);
        run(w, 30);
        CHECK(std::abs(to_reals(w.angular_velocity(b)).y) <= 1e-3);
    }
}
CELL_CASE("soft step: friction stops a spin about the normal in the time that four loaded corners take") {
    spin_down<D>();
}

CELL_CASE("soft step: bounces give back their share, and none gains") {
    for (const double share : {0.0, 0.5, 1.0}) {
        soft_world w = soft_slope(0, 0.5, share);
        soft_world::body_def def;
        def.position.y = S(2.5);
        const body_id b = w.create_body(def);
        w.create_shape(b, soft_world::ball{S(0.5)});
        double before = 0, after = 0, fell = 0;
        for (int i = 0; i < 120; ++i) {
            const double y = cell::number(w.linear_velocity(b).y);
            w.step(S(1.0 / 120));
            const double now = cell::number(w.linear_velocity(b).y);
            if (fell == 0 && y < -1 && now > y + 1) before = y, after = now, fell = i;
        }
        CHECK(fell > 0);
        CHECK(std::abs(after + share * before) <= 0.15);
        CHECK(after <= -before + 0.1);
    }
}

/// How fast a ball leaves a wall that it met at speed v, in 16 phases of the step: the least and the most (1: as fast).
struct rebounds {
    double least = 10, most = 0;
};
inline rebounds rebounds_of(double h, int substeps, double v, double share, double margin) {
    rebounds r;
    for (int i = 0; i < 16; ++i) {
        soft_world::settings_type settings;
        settings.solver.substeps = substeps;
        settings.gravity = {};
        settings.contact_margin = S(margin);
        soft_world w(settings);
        const physics::material<S, D> bouncy{.friction = S(0), .restitution = S(share)};
        soft_world::body_def wall, ball;
        wall.type = physics::body_type::static_body;
        wall.position.y = S(-1);
        ball.position.y = S(0.1 + v * h * (1 + i / 16.0));
        ball.linear_velocity.y = S(-v);
        w.create_shape(w.create_body(wall), soft_world::box{vec::filled(S(1))}, {.material = bouncy});
        const body_id b = w.create_body(ball);
        w.create_shape(b, soft_world::ball{S(0.1)}, {.material = bouncy});
        for (int k = 0; k < 8; ++k) w.step(S(h));
        const double back = cell::number(w.linear_velocity(b).y) / v;
        r.least = std::min(r.least, back);
        r.most = std::max(r.most, back);
    }
    return r;
}
CELL_CASE(
    "soft step: bounces give back their share in every phase of a step, of any length, however far it looks ahead") {
    struct rate {
        double h;
        int substeps;
        double speed, margin;
    };
    for (const rate& of : {rate{1.0 / 60, 4, 1, 0.02}, rate{1.0 / 240, 4, 4, 0.02}, rate{1.0 / 120, 1, 4, 0.02},
                           rate{1.0 / 30, 16, 2, 0.02}, rate{1.0 / 4096, 4, 3, 0.02}, rate{1.0 / 60, 4, 3, 0.3}})
        for (const double share : {0.5, 1.0}) {
            CAPTURE(of.h);
            CAPTURE(of.substeps);
            const rebounds r = rebounds_of(of.h, of.substeps, of.speed, share, of.margin);
            CHECK(r.least >= 0.99 * share);
            CHECK(r.most <= share + 0.001);
        }
}
CELL_CASE("soft step: a ball that loses nothing comes back to where it fell from, and no higher") {
    for (const int rate : {60, 240, 1024}) {
        CAPTURE(rate);
        soft_world w = soft_slope(0, 0, 1);
        soft_world::body_def def;
        def.position.y = S(1.5);
        const body_id b = w.create_body(def);
        w.create_shape(b, soft_world::ball{S(0.5)}, {.material = {.friction = S(0), .restitution = S(1)}});
        double top = 0, before = 0;
        std::vector<double> tops;
        for (int i = 0; i < 10 * rate; ++i) {
            w.step(S(1.0 / rate));
            const double v = cell::number(w.linear_velocity(b).y);
            if (before < 0 && v > 0) tops.push_back(std::exchange(top, 0.0));
            top = std::max(top, cell::number(w.position(b).y));
            before = v;
        }
        CHECK(tops.size() >= 10);
        for (std::size_t i = 1; i < tops.size(); ++i) {
            CHECK(tops[i] >= 1.5 - 0.005);
            CHECK(tops[i] <= 1.5 + 0.001);
        }
    }
}

CELL_CASE("soft step: what stops a blow is no lasting load: two boxes that fall as a stack hardly spring apart") {
    for (const double speed : {1.0, 3.0, 10.0}) {
        soft_world w = scenes::grounded<soft_world>();
        std::vector<body_id> boxes;
        for (int i = 0; i < 2; ++i) {
            soft_world::body_def def;
            def.position.y = S(0.55 + i);
            def.linear_velocity.y = S(-speed);
            boxes.push_back(w.create_body(def));
            w.create_shape(boxes.back(), soft_world::box{vec::filled(S(0.5))});
        }
        double back = 0;
        for (int i = 0; i < 60; ++i) {
            w.step(S(1.0 / 60));
            for (const body_id b : boxes) back = std::max(back, cell::number(w.linear_velocity(b).y));
        }
        CAPTURE(speed);
        CHECK(back <= 0.2 * speed);
        CHECK(std::abs(cell::number(w.position(boxes[1]).y) - 1.5) <= 0.01);
    }
}

/// The greatest overlap of all contacts (m).
inline double deepest_overlap(const soft_world& w) {
    double deepest = 0;
    for (const auto& c : w.contacts())
        for (int k = 0; k < c.count; ++k) deepest = std::max(deepest, -cell::number(c.points[k].separation));
    return deepest;
}

CELL_CASE("soft step: piles stand still for 20 s, and do not lean") {
    for (const bool tower : {true, false}) {
        soft_world w = scenes::grounded<soft_world>();
        const body_id top = tower ? scenes::stack(w, 10) : scenes::pyramid(w, 10);
        const vec start = w.position(top);
        run(w, 1200);
        CHECK(size(to_reals(w.position(top) - start)) <= 0.04);
        CHECK(scenes::kinetic_energy(w) <= 1e-4);
        CHECK(deepest_overlap(w) <= 0.007);
        double weight = 0;
        for (const auto& c : w.contacts())
            if (w.type(c.body_a) == physics::body_type::static_body ||
                w.type(c.body_b) == physics::body_type::static_body)
                for (int k = 0; k < c.count; ++k)
                    weight += cell::number(c.points[k].normal_impulse) * std::abs(cell::number(c.normal.y));
        const double count = double(w.body_count() - 1);
        CHECK(std::abs(weight - count * 10 / 60) <= 0.01 * count * 10 / 60);
    }
}

CELL_CASE("soft step: work buys accuracy: overlaps shrink as substeps are added") {
    double last = HUGE_VAL;
    for (const int substeps : {2, 4, 8, 16}) {
        soft_world::settings_type settings;
        settings.solver.substeps = substeps;
        soft_world w = scenes::grounded<soft_world>(settings);
        scenes::stack(w, 8);
        run(w, 600);
        const double now = deepest_overlap(w);
        CHECK(now < 0.6 * last);
        last = now;
    }
}

CELL_CASE("soft step: a crate of 100 kg rests on one of 1 kg") {
    soft_world w = scenes::grounded<soft_world>();
    scenes::add_crate(w, 0, 0.5);
    soft_world::body_def def;
    def.position.y = S(1.5);
    const body_id heavy = w.create_body(def);
    w.create_shape(heavy, soft_world::box{vec::filled(S(0.5))}, {.density = S(100)});
    run(w, 600);
    CHECK(std::abs(cell::number(w.position(heavy).y) - 1.5) <= 0.08);
    CHECK(scenes::kinetic_energy(w) <= 1e-3);
}

CELL_CASE("soft step: refuses settings out of range") {
    const auto refused = [](auto&& change) {
        soft_world::settings_type settings;
        change(settings.solver);
        CHECK_THROWS_AS(soft_world{settings}, physics::error);
    };
    refused([](auto& s) { s.substeps = 0; });
    refused([](auto& s) { s.contact_frequency_ratio = S(0); });
    refused([](auto& s) { s.damping_ratio = S(-1); });
    refused([](auto& s) { s.frequency_cap = S(-1); });
    refused([](auto& s) { s.max_depenetration_speed = S(-1); });
    refused([](auto& s) { s.restitution_threshold = S(-1); });
}

}  // namespace soft_step_laws
}  // namespace
