// Laws of worlds without a material a shape: all surfaces are of the one that the settings name.
#pragma once

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "cell.hpp"

namespace {
namespace left_out_laws {

using S = cell::scalar;
constexpr int D = cell::dimension;
using physics::body_id;
using physics::body_type;
using physics::shape_id;
using physics::without;
using vec = physics::vec<S, D>;
using material = physics::material<S, D>;
using physics::feature::friction;
using physics::feature::materials;
using physics::feature::restitution;
using physics::feature::rolling_resistance;
using physics::feature::sleeping;
using point_step = physics::soft_step_with<physics::point_friction>;

/// Half the shapes, for the compiler's sake.
using few = physics::shapes<physics::ball, physics::box, physics::halfspace>;
template <class... Policies>
struct of : physics::recipe<S, D, few, Policies...> {};
template <class... Policies>
using made_of = physics::world<of<Policies...>>;
using common = made_of<without<materials>>;
template <class World>
constexpr bool has_materials = requires(World& w, shape_id id) {
    w.set_material(id, material{});
};

template <class World>
constexpr bool turns = requires(World& w, body_id id, typename World::angular spin) {
    w.set_angular_velocity(id, spin);
};

inline vec along(int axis, double size) {
    vec v;
    v[axis] = S(size);
    return v;
}
template <class Angular = physics::angular<S, D>>
Angular spin(double size) {
    if constexpr (cell::is_2d) return S(size);
    else return {S(0.5 * size), S(-0.25 * size), S(size)};
}
template <class Motion = physics::surface_motion<S, D>>
Motion running(double speed) {
    if constexpr (cell::is_2d) return S(speed);
    else return along(0, speed);
}

/// A world all of whose surfaces are of one material, in either way.
template <class World>
class pile {
public:
    explicit pile(const material& m) : material_(m) {
        typename World::settings_type settings;
        if constexpr (!has_materials<World>) settings.material = m;
        if constexpr (requires { settings.sleeping.time; }) settings.sleeping.time = S(0.25);
        w.set_settings(settings);
        ids.push_back(w.create_body({.type = body_type::static_body}));
        add(typename World::halfspace{});
        for (const double side : {-1.0, 1.0})
            for (int axis = 0; axis < D; axis += 2) {
                ids.push_back(w.create_body({.type = body_type::static_body, .position = along(axis, 3 * side)}));
                vec half = vec::filled(S(3));
                half[axis] = S(0.5);
                add(typename World::box{half});
            }
        cell::dice dice(513);
        for (int i = 0; i < 24; ++i) {
            vec place = dice.vec<vec>(-1.75, 1.75);
            place.y = S(1 + 0.5 * i);
            const vec velocity = dice.vec<vec>(-2, 2);
            const auto angular = spin(dice.number(-3, 3));
            ids.push_back(w.create_body({.position = place, .linear_velocity = velocity}));
            if constexpr (turns<World>) w.set_angular_velocity(ids.back(), angular);
            if (i % 2) add(typename World::ball{dice.real(0.25, 0.5)});
            else add(typename World::box{dice.vec<vec>(0.2, 0.5)});
        }
    }
    void change(const material& m) {
        material_ = m;
        auto settings = w.settings();
        if constexpr (has_materials<World>)
            for (const shape_id id : shapes) w.set_material(id, m);
        else settings.material = m;
        w.set_settings(settings);
    }
    void step() { w.step(S(1.0 / 64)); }

    World w;
    std::vector<body_id> ids;
    std::vector<shape_id> shapes;

private:
    template <class Shape>
    void add(const Shape& shape) {
        typename World::shape_def def;
        if constexpr (has_materials<World>) def.material = material_;
        shapes.push_back(w.create_shape(ids.back(), shape, def));
    }

    material material_;
};

/// Whether all bodies are in the same state, to the bit, and all contacts are reported alike.
template <class A, class B>
bool same(const pile<A>& a, const pile<B>& b) {
    bool same = a.w.contacts().size() == b.w.contacts().size();
    for (std::size_t i = 0; i < a.ids.size() && same; ++i) {
        const body_id p = a.ids[i], q = b.ids[i];
        same = a.w.pose(p) == b.w.pose(q) && a.w.linear_velocity(p) == b.w.linear_velocity(q) &&
               a.w.angular_velocity(p) == b.w.angular_velocity(q) && a.w.is_asleep(p) == b.w.is_asleep(q);
    }
    auto other = b.w.contacts().begin();
    for (const auto& c : a.w.contacts()) {
        if (!same) break;
        const auto d = *other;
        same = c.shape_a.index == d.shape_a.index && c.friction == d.friction && c.restitution == d.restitution &&
               c.rolling_resistance == d.rolling_resistance && c.rolling_impulse == d.rolling_impulse &&
               c.points[0].normal_impulse == d.points[0].normal_impulse &&
               c.points[0].friction_impulse == d.points[0].friction_impulse;
        ++other;
    }
    return same;
}
/// Plays a pile that falls, comes to rest, is hit, and whose surfaces then change: with a material a shape and with one
/// for all. Says whether anybody slept meanwhile.
template <class Policy, class... LeftOut>
bool moves_alike(const material& first, const material& then) {
    pile<made_of<Policy, without<LeftOut...>>> each(first);
    pile<made_of<Policy, without<materials, LeftOut...>>> all(first);
    bool slept = false, alike = true;
    const auto play = [&](int steps) {
        for (int i = 0; i < steps && alike; ++i) {
            each.step();
            all.step();
            alike = same(each, all);
            for (const body_id id : all.ids) slept = slept || all.w.is_asleep(id);
        }
    };
    play(256);
    for (int i = 5; i < 12; ++i) {
        const auto at = static_cast<std::size_t>(i);
        for (int axis = 0; axis < D; ++axis) {
            each.w.apply_impulse(each.ids[at], along(axis, 4));
            all.w.apply_impulse(all.ids[at], along(axis, 4));
        }
    }
    play(32);
    each.change(then);
    all.change(then);
    play(96);
    CHECK(alike);
    // Whoever sleeps is woken by a change of surfaces.
    all.change(first);
    for (const body_id id : all.ids) CHECK(!all.w.is_asleep(id));
    return slept;
}
const material rubber{.friction = S(0.7), .restitution = S(0.3), .rolling_resistance = S(0.03)};
const material ice{.friction = S(0.05), .restitution = S(0.1), .rolling_resistance = S(0)};

CELL_CASE("materials: one for all surfaces gives the bits of shapes that all have it, with any solver and friction") {
    CHECK(moves_alike<physics::soft_step>(rubber, ice));
    CHECK(moves_alike<point_step>(rubber, ice));
    CHECK(moves_alike<physics::sequential_impulse>(rubber, ice));
}
CELL_CASE("materials: the same where the recipe leaves out more, and surfaces begin to resist rolling") {
    const material dull{.friction = S(0.4)}, bouncy{.friction = S(0.2), .restitution = S(0.6)};
    moves_alike<physics::soft_step, restitution, rolling_resistance>(dull, {.friction = S(0.1)});
    moves_alike<physics::soft_step, friction, sleeping>({.restitution = S(0.5), .rolling_resistance = S(0.01)}, bouncy);
    moves_alike<physics::sequential_impulse, friction, restitution>(dull, {.rolling_resistance = S(0.125)});
    moves_alike<physics::product_mixing, sleeping>(bouncy, rubber);
    CHECK(moves_alike<physics::soft_step, physics::feature::rotation>(dull, bouncy));
    CHECK(moves_alike<physics::sequential_impulse, physics::feature::rotation>(dull, bouncy));
}

/// A rule that counts its calls, and gives a friction that no solver takes for rough surfaces.
struct counting {
    using stage = physics::stage::mixing;
    static inline int calls = 0;
    template <class Space>
    struct in : physics::minimum_mixing::in<Space> {
        using T = typename Space::scalar;
        using surface = physics::material<T, Space::dimension>;
        static T friction(const surface& a, const surface& b) {
            ++calls;
            return a.friction > T(0.75) || b.friction > T(0.75) ? T(-1) : a.friction + b.friction;
        }
    };
};
CELL_CASE("materials: the rule is asked once a step for all, and the step refuses what no solver takes") {
    using World = made_of<counting, without<materials>>;
    pile<World> p({.friction = S(0.25)});
    for (int i = 0; i < 64; ++i) p.step();
    REQUIRE(p.w.contacts().size() > 4);
    counting::calls = 0;
    p.step();
    CHECK(counting::calls == 1);
    for (const auto& c : p.w.contacts()) CHECK(c.friction == S(0.5));
    p.change({.friction = S(1)});
    const std::uint64_t before = p.w.state_hash();
    CHECK_THROWS_WITH(p.step(),
                      "physics: step: a coefficient of two surfaces is out of range; the mixing rule must "
                      "give friction, restitution and rolling_resistance that are finite and at least 0");
    CHECK(p.w.state_hash() == before);
    // They are those of the last step.
    for (const auto& c : p.w.contacts()) CHECK(c.friction == S(0.5));
    p.change({.friction = S(0.5)});
    p.step();
    for (const auto& c : p.w.contacts()) CHECK(c.friction == S(1));
}

CELL_CASE("materials: settings change that of all surfaces from the next step on") {
    common w({.gravity = along(1, -8)});
    const body_id ground = w.create_body({.type = body_type::static_body});
    const shape_id floor = w.create_shape(ground, common::halfspace{});
    const body_id box = w.create_body({.position = along(1, 0.5)});
    w.create_shape(box, common::box{vec::filled(S(0.5))}, {.density = S(2)});
    CHECK(w.material(floor) == material{});
    const auto run = [&](int steps) {
        for (int i = 0; i < steps; ++i) w.step(S(1.0 / 64));
    };
    const auto speed = [&] { return cell::number(w.linear_velocity(box).x); };
    const auto slide_on = [&](double mu) {
        auto with = w.settings();
        with.material.friction = S(mu);
        w.set_settings(with);
        CHECK(w.material(floor).friction == S(mu));
    };
    run(16);
    w.set_linear_velocity(box, along(0, 8));
    slide_on(0);
    run(32);
    CHECK(std::abs(speed() - 8) <= 0.01);
    slide_on(0.5);
    run(32);
    // mu g for half a second.
    CHECK(std::abs(speed() - 6) <= 0.05);
    slide_on(0);
    const double left = speed();
    run(32);
    CHECK(std::abs(speed() - left) <= 0.01);
    CHECK_THROWS(static_cast<void>(w.material({})));
}

/// What a call is refused with.
template <class F>
std::string refusal(F&& f) {
    try {
        f();
    } catch (const physics::error& e) {
        return e.what();
    }
    return "not refused";
}
CELL_CASE("materials: settings refuse bad ones by name, and leave the world as it was") {
    pile<common> p(rubber);
    for (int i = 0; i < 40; ++i) p.step();
    const std::uint64_t before = p.w.state_hash();
    const auto refuses = [&](const std::string& sentence, const material& m) {
        common::settings_type with = p.w.settings();
        with.material = m;
        with.gravity = {};
        CHECK(refusal([&] { p.w.set_settings(with); }) == "physics: set_settings: " + sentence);
        CHECK(refusal([&] { common w(with); }) == "physics: world: " + sentence);
        CHECK(p.w.state_hash() == before);
        CHECK(p.w.settings().material == rubber);
        CHECK(p.w.settings().gravity != vec{});
    };
    refuses("material.friction is -1; it must not be negative", {.friction = S(-1)});
    refuses("material.restitution is -0.5; it must not be negative", {.restitution = S(-0.5)});
    refuses("material.rolling_resistance is -2; it must not be negative", {.rolling_resistance = S(-2)});
    refuses(std::string("material.surface_velocity") + (cell::is_2d ? "" : ".x") + " is 5; the recipe leaves it out",
            {.surface_velocity = running(5)});
    if constexpr (!cell::is_fixed) {
        const S huge = cell::traits::max();
        refuses("material.friction is inf; it must be finite", {.friction = huge + huge});
    }
    made_of<without<materials, restitution>> dull;
    auto with = dull.settings();
    with.material.restitution = S(0.5);
    CHECK(refusal([&] { dull.set_settings(with); }) ==
          "physics: set_settings: material.restitution is 0.5; the recipe leaves it out");
}

CELL_CASE("materials: copies and snapshots go on by the same bits, with the coefficients of the last step") {
    using Recipe = of<without<materials>>;
    pile<common> p(rubber);
    for (int i = 0; i < 100; ++i) p.step();
    using physics::detail::world_access;
    physics::detail::raw_snapshot<physics::detail::plan_of<Recipe>::type> snapshot;
    snapshot.save(world_access::state_of(p.w));
    // What they are to become is no part of them yet.
    p.change(ice);
    pile<common> q = p;
    CHECK(q.w.state_hash() == p.w.state_hash());
    for (const auto& c : q.w.contacts()) CHECK(c.restitution == rubber.restitution);
    for (int i = 0; i < 50; ++i) p.step(), q.step();
    CHECK(same(p, q));
    REQUIRE(snapshot.restore(world_access::data_of(q.w)));
    CHECK(q.w.settings().material == rubber);
    CHECK(q.w.contacts().size() > 0);
    for (const auto& c : q.w.contacts()) CHECK(c.restitution == rubber.restitution);
    pile<common> again(rubber);
    for (int i = 0; i < 100; ++i) again.step();
    CHECK(same(again, q));
    for (int i = 0; i < 50; ++i) again.step(), q.step();
    CHECK(same(again, q));
    CHECK(again.w.state_hash() == q.w.state_hash());
}

// What is not there does not compile.
template <class World>
constexpr bool settings_have_one = requires(typename World::settings_type with) {
    with.material.friction;
};
template <class World>
constexpr bool shapes_have_one = requires(typename World::shape_def def) {
    def.material;
};
static_assert(has_materials<made_of<>> && shapes_have_one<made_of<>> && !settings_have_one<made_of<>>);
static_assert(!has_materials<common> && !shapes_have_one<common> && settings_have_one<common>);
static_assert(std::is_same_v<made_of<>::shape_def, physics::shape_def<S, D>>);
/// A solver that looks for a coefficient where it is not.
template <class Features>
constexpr bool contacts_tell = requires(const physics::solver_api::contact<S, D, Features>& c) {
    physics::detail::value_of(c.friction) * S(2);
};
static_assert(contacts_tell<without<>> && contacts_tell<without<friction>> && !contacts_tell<without<materials>>);

// And takes no byte of shapes, contacts and blocks; the settings of others take none for it.
template <class Features>
using contact_of = physics::solver_api::contact<S, D, Features>;
template <class... Features>
using shape_of = physics::detail::shape_record<typename physics::detail::plan_of<of<without<Features...>>>::type>;
template <class Features, class Friction = physics::patch_friction>
using block_of = physics::detail::soft_contact<S, D, 4, Features, Friction>;
template <class Features>
using extras_of = physics::detail::soft_extras<S, 4, D, Features>;
static_assert(sizeof(contact_of<without<materials>>) + sizeof(S) * (D == 2 ? 4 : 5) == sizeof(contact_of<without<>>));
static_assert(std::is_empty_v<physics::detail::stored_material<S, D, without<materials>>>);
static_assert(sizeof(shape_of<materials>) <= sizeof(shape_of<>) - sizeof(material) + alignof(std::uint64_t) / 2);
static_assert(sizeof(block_of<without<materials>>) < sizeof(block_of<without<physics::feature::surface_velocity>>));
static_assert(D == 2 || sizeof(block_of<without<materials>, physics::point_friction>) <
                            sizeof(block_of<without<>, physics::point_friction>));
static_assert(sizeof(extras_of<without<materials>>) + sizeof(S) * 3 ==
              sizeof(extras_of<without<physics::feature::surface_velocity>>));
static_assert(sizeof(typename made_of<>::settings_type) + sizeof(material) <=
              sizeof(common::settings_type) + alignof(S));
using bare = without<materials, friction, restitution, rolling_resistance>;
static_assert(std::is_empty_v<physics::detail::combined_material<S, without<>>>);
static_assert(std::is_empty_v<physics::detail::combined_material<S, bare>>);

}  // namespace left_out_laws
}  // namespace
