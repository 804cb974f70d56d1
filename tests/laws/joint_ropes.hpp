// Laws of pulleys among others: in lanes, beside other kinds, and what is refused.
#pragma once

#include "laws/joint_pulleys.hpp"

namespace {
namespace pulley_laws {

/// Pulleys of other masses and ratios side by side, in lanes of one solve.
template <class World>
std::vector<vec> many(int first, int end, bool direct) {
    World w = falling_by<World>(4, direct);
    std::vector<body_id> all;
    for (int i = first; i < end; ++i) {
        const double x = 4 * i;
        const body_id a = add_box(w, at(x - 1, -3), 0.25 + 0.03125 * i, 0.25),
                      b = add_box(w, at(x + 1, -3 - 0.125 * i), 0.25, 0.25);
        w.set_linear_velocity(a, at(0.25 * i));
        pulley_joint j{.anchor_a = at(0.125, 0.25), .ground_a = at(x - 1), .ground_b = at(x + 1)};
        j.ratio = S(1 + 0.25 * i);
        if (i % 3 == 0) j.min_length = pulley_joint::as_it_stands;
        w.create_joint(a, b, j);
        all.push_back(a);
        all.push_back(b);
    }
    run(w, 48);
    std::vector<vec> places;
    for (const body_id b : all) places.push_back(w.position(b));
    return places;
}
template <class World>
void each_moves_as_alone(bool direct) {
    const std::vector<vec> together = many<World>(0, 9, direct);
    for (int i = 0; i < 9; ++i) {
        CAPTURE(i);
        const std::vector<vec> alone = many<World>(i, i + 1, direct);
        CHECK(alone[0] == together[static_cast<std::size_t>(2 * i)]);
        CHECK(alone[1] == together[static_cast<std::size_t>(2 * i + 1)]);
    }
}
CELL_CASE("joint pulleys: each of many moves as it does alone, by the same bits") {
    for (const bool direct : {true, false}) {
        CAPTURE(direct);
        each_moves_as_alone<plain>(direct);
        each_moves_as_alone<hard>(direct);
    }
}
template <class Recipe>
std::vector<vec> places_of_a_net() {
    physics::world<Recipe> w = falling<physics::world<Recipe>>();
    std::vector<body_id> all{add_anchor(w, at(0, 0))};
    for (int i = 1; i <= 8; ++i) {
        all.push_back(add_box(w, at(0.5 * i), 0.2, 0.1));
        w.create_joint(all[all.size() - 2], all.back(), ball_joint{.anchor_a = at(0.25), .anchor_b = at(-0.25)});
    }
    run(w, 100);
    std::vector<vec> places;
    for (const body_id b : all) places.push_back(w.position(b));
    return places;
}
template <class... Policies>
struct balls : physics::recipe<S, D, few, physics::joints<physics::ball_joint>, Policies...> {};
CELL_CASE("joint pulleys: recipes that know them move other joints by the same bits") {
    CHECK(places_of_a_net<balls<>>() == places_of_a_net<joined<>>());
    CHECK(places_of_a_net<balls<physics::sequential_impulse>>() ==
          places_of_a_net<joined<physics::sequential_impulse>>());
}

CELL_CASE("joint pulleys: bad ones are refused by name") {
    plain w = falling<plain>();
    const body_id a = add_ball(w, at(-1, -3)), b = add_ball(w, at(1, -3));
    const auto refuses = [&](const char* field, auto change) {
        pulley_joint j{.ground_a = at(-1), .ground_b = at(1)};
        change(j);
        is_refused(w, a, b, field, j);
    };
    refuses("ratio is 0", [](pulley_joint& j) { j.ratio = S(0); });
    refuses("ratio is -1", [](pulley_joint& j) { j.ratio = S(-1); });
    refuses("min_length is -1", [](pulley_joint& j) { j.min_length = S(-1); });
    refuses("max_length is 0", [](pulley_joint& j) { j.max_length = S(0); });
    refuses("min_length is 3", [](pulley_joint& j) { j.min_length = S(3), j.max_length = S(2); });
    refuses("min_length is 7", [](pulley_joint& j) { j.min_length = S(7); });
    refuses("min_length is 6", [](pulley_joint& j) { j.min_length = pulley_joint::as_it_stands, j.max_length = S(5); });
    refuses("ground_a is where anchor_a is", [](pulley_joint& j) { j.ground_a = at(-1, -3); });
    refuses("ground_b is where anchor_b is", [](pulley_joint& j) { j.ground_b = at(1, -2), j.anchor_b = at(0, 1); });
    if constexpr (!cell::is_fixed) {
        const S bad = S(0) / S(0);
        refuses("ratio is nan", [&](pulley_joint& j) { j.ratio = bad; });
        refuses("min_length is nan", [&](pulley_joint& j) { j.min_length = bad; });
        refuses("max_length is nan", [&](pulley_joint& j) { j.max_length = bad; });
        refuses("anchor_a.y is nan", [&](pulley_joint& j) { j.anchor_a[1] = bad; });
        refuses("anchor_b.x is nan", [&](pulley_joint& j) { j.anchor_b[0] = bad; });
        refuses("ground_a.x is nan", [&](pulley_joint& j) { j.ground_a[0] = bad; });
        refuses("ground_b.y is inf", [&](pulley_joint& j) { j.ground_b[1] = S(1) / S(0); });
    }
    // As it stands when it is set, too.
    const joint_id rope = w.create_joint(a, b, pulley_joint{.ground_a = at(-1), .ground_b = at(1)});
    CHECK(w.joint<pulley_joint>(rope).max_length == S(6));
    w.set_joint(rope, pulley_joint{.ground_a = at(-1), .ground_b = at(1), .ratio = S(2)});
    CHECK(w.joint<pulley_joint>(rope).max_length == S(9));
    CHECK(refusal([&] { w.set_joint(rope, pulley_joint{.ground_a = at(-1, -3)}); }).find("ground_a") !=
          std::string::npos);
}

}  // namespace pulley_laws
}  // namespace
