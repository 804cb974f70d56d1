// Recipes: features left out, policies in any order, and policies and shapes that a user writes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include "world_cell.hpp"

namespace {
namespace world_recipes_laws {

// What a user writes stands in a namespace of the user's; the library finds the functions by their arguments.
namespace user {

/// A broadphase: a map of boxes, and no idea but to try all pairs.
struct address_book {
    using stage = physics::stage::broadphase;

    template <class Space>
    class in {
    public:
        using aabb = typename Space::aabb;

        void insert(std::uint32_t id, const aabb& box, const physics::proxy_filter& filter) {
            boxes_.insert_or_assign(id, entry{box, filter});
        }
        void move(std::uint32_t id, const aabb& box, const typename Space::vec&) { boxes_.at(id).box = box; }
        void erase(std::uint32_t id) { boxes_.erase(id); }
        template <class Accept>
        const physics::buffer<physics::proxy_pair>& pairs(Accept&& accept) {
            pairs_.clear();
            for (auto a = boxes_.begin(); a != boxes_.end(); ++a)
                for (auto b = std::next(a); b != boxes_.end(); ++b)
                    if (physics::overlap(a->second.box, b->second.box) &&
                        physics::may_meet(a->second.filter, b->second.filter) && accept(a->first, b->first))
                        pairs_.push_back({a->first, b->first});
            return pairs_;
        }

    private:
        struct entry {
            aabb box;
            physics::proxy_filter filter;
        };
        std::map<std::uint32_t, entry> boxes_;
        physics::buffer<physics::proxy_pair> pairs_;
    };
};

/// A narrowphase that sees nothing.
struct blind {
    using stage = physics::stage::narrowphase;

    template <class T, int D, template <class, int> class... Shapes>
    struct in {
        static void collide(const physics::narrowphase_query<T, D, Shapes...>*, std::uint32_t, T,
                            physics::manifold_list<T, D>&) {}
    };
};

/// An integrator under which everything falls upwards.
struct upside_down {
    using stage = physics::stage::integrator;

    template <class Space>
    struct in : physics::semi_implicit_euler::in<Space> {
        using T = typename Space::scalar;
        static constexpr int D = Space::dimension;
        static void integrate_velocity(physics::twist<T, D>& v, physics::solver_api::moving_body<T, D> b, T h) {
            b.acceleration = -b.acceleration;
            physics::semi_implicit_euler::in<Space>::integrate_velocity(v, b, h);
        }
    };
};

/// A solver that stops whatever is in contact, in as many substeps as its settings say.
struct glue {
    using stage = physics::stage::solver;
    struct settings {
        int substeps = 2;
    };

    template <class Space, class Features>
    struct in {
        using settings = glue::settings;
        using T = typename Space::scalar;
        static constexpr int D = Space::dimension;
        template <class Motion>
        static void solve(physics::solver_api::solver_bodies<T, D> bodies,
                          physics::solver_api::contact_constraints<T, D, Features> contacts, const settings& with, T h,
                          physics::arena&, Motion&& motion) {
            for (int i = 0; i < with.substeps; ++i) {
                motion.integrate_velocities(h / T(with.substeps));
                for (std::uint32_t k = 0; k < contacts.size(); ++k)
                    bodies[contacts.bodies(k).a].velocity = bodies[contacts.bodies(k).b].velocity = {};
                motion.integrate_positions(h / T(with.substeps));
            }
        }
    };
};
inline bool check(const glue::settings& with, const char* function) {
    return with.substeps > 0 || physics::refuse(function, "solver.substeps", with.substeps, "it must be at least 1");
}

/// A shape: a ball by another name.
template <class T, int D>
struct bubble {
    T size = T(0.5);

    template <class U>
    bubble<U, D> as() const {
        return {static_cast<U>(size)};
    }
    physics::ball<T, D> ball() const { return {size}; }
};
template <class T, int D>
bool check(const bubble<T, D>& b, const char* function) {
    return b.size > T(0) || physics::refuse(function, "size", static_cast<double>(b.size), "it must be greater than 0");
}
template <class T, int D>
physics::aabb<T, D> bounds(const bubble<T, D>& b, const physics::transform<T, D>& at) {
    return bounds(b.ball(), at);
}
template <class T, int D>
physics::vec<T, D> support(const bubble<T, D>& b, physics::vec<T, D> direction) {
    return support(b.ball(), direction);
}
template <class T, int D>
physics::mass_properties<T, D> mass_of(const bubble<T, D>& b, T density) {
    return mass_of(b.ball(), density);
}
template <class T, int D>
void collide(const bubble<T, D>& a, const bubble<T, D>& b, const physics::transform<T, D>& b_in_a, T margin,
             physics::manifold<T, D>& out) {
    collide(a.ball(), b.ball(), b_in_a, margin, out);
}
/// For sets in which the halfspace comes later, the library has to turn this one round.
template <class T, int D>
void collide(const physics::halfspace<T, D>& a, const bubble<T, D>& b, const physics::transform<T, D>& b_in_a, T margin,
             physics::manifold<T, D>& out) {
    collide(b.ball(), a, inverse(b_in_a), margin, out);
    out.normal = -(b_in_a.rotation * out.normal);
    for (int i = 0; i < out.count; ++i) out.points[i].position = b_in_a * out.points[i].position;
}

}  // namespace user

template <class... Policies>
struct of : physics::recipe<S, cell::dimension, Policies...> {};
template <class... Policies>
using made_of = physics::world<of<Policies...>>;

using physics::feature::friction;
using physics::feature::restitution;
using all_own = of<user::glue, physics::shapes<user::bubble, physics::halfspace>, user::upside_down, user::address_book,
                   user::blind>;

/// Balls thrown onto the ground beside a slope; the hash of every step.
template <class World, class Ball = typename World::ball>
std::vector<std::uint64_t> hashes(int steps = 60) {
    World w;
    const body_id ground = w.create_body({.type = body_type::static_body});
    w.create_shape(ground, typename World::halfspace{});
    for (int i = 0; i < 6; ++i) {
        const body_id id =
            w.create_body({.position = at(0.9 * (i % 3), 0.6 + 1.1 * (i / 3)), .linear_velocity = at(1, -i)});
        w.create_shape(id, Ball{S(0.5)}, {.material = {.restitution = S(0.25)}});
    }
    std::vector<std::uint64_t> all;
    for (int i = 0; i < steps; ++i) {
        w.step(S(1.0 / 64));
        all.push_back(w.state_hash());
    }
    CHECK(w.contacts().size() > 0);
    return all;
}

CELL_CASE("recipes: the order of policies does not matter, nor do shapes that nobody uses") {
    using a = made_of<physics::all_pairs, physics::soft_step, physics::without<>, physics::semi_implicit_euler>;
    using b = made_of<physics::semi_implicit_euler, physics::without<>, physics::best_per_pair, physics::soft_step>;
    const auto expected = hashes<world>();
    CHECK(hashes<a>() == expected);
    CHECK(hashes<b>() == expected);
    // Shapes are numbered as the set names them, so the same order gives the same hash.
    CHECK(hashes<made_of<physics::shapes<physics::ball, physics::capsule, physics::box, physics::halfspace>>>() ==
          expected);
    using two = made_of<physics::shapes<physics::ball, physics::halfspace>>;
    CHECK(hashes<two>() == hashes<made_of<physics::soft_step, physics::shapes<physics::ball, physics::halfspace>>>());
    CHECK(sizeof(typename made_of<physics::shapes<physics::ball>>::any_shape) < sizeof(world::any_shape));
}

CELL_CASE("recipes: a world without friction or restitution has none") {
    const auto run_with = [](auto& w, double angle, double restitution) {
        const body_id ground = w.create_body({.type = body_type::static_body});
        typename std::remove_cvref_t<decltype(w)>::halfspace slope;
        slope.normal = at(-std::sin(angle), std::cos(angle));
        const physics::material<S, cell::dimension> surface{.friction = S(1), .restitution = S(restitution)};
        w.create_shape(ground, slope, {.material = surface});
        const body_id box = w.create_body({.position = at(0, 1)});
        w.create_shape(box, typename std::remove_cvref_t<decltype(w)>::ball{S(0.5)}, {.material = surface});
        double highest = 0;
        for (int i = 0; i < 128; ++i) {
            w.step(S(1.0 / 64));
            if (i > 32) highest = std::max(highest, number(w.position(box).y));
        }
        return std::pair{highest, gap(w.angular_velocity(box), angular{})};
    };
    world full;
    made_of<physics::without<friction>> slippery;
    made_of<physics::without<restitution>> soft;
    made_of<physics::without<restitution, friction>> bare;
    CHECK(run_with(full, 0, 1).first > 0.9);
    CHECK(run_with(soft, 0, 0).first < 0.55);
    CHECK(run_with(bare, 0, 0).first < 0.55);
    CHECK(run_with(slippery, 0, 1).first > 0.9);
    world full_slope;
    made_of<physics::without<friction>> slippery_slope;
    CHECK(run_with(full_slope, 0.3, 1).second > 1);
    CHECK(run_with(slippery_slope, 0.3, 1).second <= 1e-5);
}

CELL_CASE("recipes: a user's broadphase gives what the library's gives") {
    CHECK((hashes<made_of<user::address_book>>() == hashes<world>()));
    made_of<user::address_book> w;
    cell::dice dice(1);
    std::vector<body_id> all;
    for (int i = 0; i < 200; ++i) {
        if (all.size() < 10 || dice.below(2) == 0) {
            all.push_back(w.create_body({.position = dice.vec<vec>(-2, 2)}));
            w.create_shape(all.back(), world::ball{});
        } else {
            const auto victim = all.begin() + dice.below(static_cast<int>(all.size()));
            w.destroy_body(*victim);
            all.erase(victim);
        }
        if (i % 8 == 0) w.step(S(1.0 / 64));
    }
    CHECK(w.body_count() == all.size());
}

CELL_CASE("recipes: a user's shape rolls, weighs and collides, also in a pair that is written the other way round") {
    using bubble = user::bubble<S, cell::dimension>;
    // What has no core is not swept.
    using unswept = physics::without<physics::feature::continuous>;
    using straight = made_of<physics::shapes<physics::halfspace, user::bubble>, unswept>;
    using same = made_of<physics::shapes<physics::halfspace, physics::ball>, unswept>;
    CHECK((hashes<straight, bubble>() == hashes<same>()));
    // Turned round and back, all is the same but for rounding.
    straight a;
    made_of<physics::shapes<user::bubble, physics::halfspace>, unswept> b;
    const auto rest = [](auto& w) {
        w.create_shape(w.create_body({.type = body_type::static_body}), physics::halfspace<S, cell::dimension>{});
        const body_id id = w.create_body({.position = at(1, 2), .linear_velocity = at(2, 0)});
        CHECK_THROWS_WITH(w.create_shape(id, bubble{S(-1)}),
                          "physics: create_shape: size is -1; it must be greater than 0");
        const shape_id shape = w.create_shape(id, bubble{S(0.25)});
        CHECK(w.shape(shape).template get<bubble>().size == S(0.25));
        for (int i = 0; i < 64; ++i) w.step(S(1.0 / 64));
        CHECK(w.contacts().size() == 1);
        return w.position(id);
    };
    const vec end = rest(a);
    CHECK(gap(rest(b), end) <= rounding(1000));
    CHECK(std::abs(number(end.y) - 0.25) <= 0.02);
}

CELL_CASE("recipes: a user's narrowphase, integrator and solver are used") {
    const auto height = [](auto&& w) {
        const body_id ground = w.create_body({.type = body_type::static_body});
        w.create_shape(ground, typename std::remove_cvref_t<decltype(w)>::halfspace{});
        const body_id ball = w.create_body({.position = at(0, 0.51)});
        w.create_shape(ball, physics::ball<S, cell::dimension>{S(0.5)});
        for (int i = 0; i < 64; ++i) w.step(S(1.0 / 64));
        return number(w.position(ball).y);
    };
    CHECK(std::abs(height(world()) - 0.5) <= 0.02);
    // Sweeps would stop it.
    using unswept = physics::without<physics::feature::continuous>;
    CHECK(height(made_of<user::blind, unswept>()) < -4);
    CHECK(height(made_of<user::upside_down>()) > 5);
    // Glued by the margin of contact, before it reaches the ground.
    CHECK(std::abs(height(made_of<user::glue>()) - 0.51) <= 1e-6);
    using glued = made_of<user::glue>;
    CHECK_THROWS_WITH(glued({.solver = {.substeps = 0}}),
                      "physics: world: solver.substeps is 0; it must be at least 1");
    // In substeps the fall is shorter by less: the error of the step is proportional to its length.
    const auto fall = [](int substeps) {
        glued w({.solver = {.substeps = substeps}});
        const body_id id = w.create_body();
        for (int i = 0; i < 64; ++i) w.step(S(1.0 / 64));
        return number(w.position(id).y) + 0.5 * 9.81;
    };
    CHECK(std::abs(fall(4) / fall(1) - 0.25) <= 0.01);
}

CELL_CASE("recipes: a refused step is undone in a solver of many substeps too") {
    if (cell::is_fixed) return;
    made_of<user::glue> w({.solver = {.substeps = 8}});
    const body_id good = w.create_body({.linear_velocity = along(0, 1)}),
                  bad = w.create_body({.linear_velocity = along(0, 1)});
    w.step(S(1.0 / 64));
    const std::uint64_t before = w.state_hash();
    const S most = cell::largest();
    w.set_linear_velocity(bad, along(0, number(most)));
    // Half of the substeps pass before the position is out of range.
    CHECK_THROWS_AS(w.step(S(2)), physics::error);
    w.set_linear_velocity(bad, w.linear_velocity(good));
    CHECK(w.state_hash() == before);
    w.step(S(1.0 / 64));
}

}  // namespace world_recipes_laws
}  // namespace

// Compiles every member.
template class physics::world<world_recipes_laws::all_own>;
template class physics::world<
    world_recipes_laws::of<physics::without<world_recipes_laws::friction, world_recipes_laws::restitution>>>;
