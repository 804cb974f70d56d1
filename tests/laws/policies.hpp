// Policies in combination: pairwise over broadphase, integrator, features and shapes, each against a law.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "../../samples/scenes.hpp"
#include "cell.hpp"

namespace {
namespace policies_laws {

using S = cell::scalar;
constexpr int D = cell::dimension;

/// A user's broadphase: keeps its boxes sorted along x and sweeps over them.
struct sweep_along_x {
    using stage = physics::stage::broadphase;
    template <class Space>
    class in {
    public:
        using aabb = typename Space::aabb;

        void insert(std::uint32_t id, const aabb& box, const physics::proxy_filter& filter) {
            boxes_.push_back({id, box, filter});
        }
        void move(std::uint32_t id, const aabb& box, const typename Space::vec&) {
            for (auto& b : boxes_)
                if (b.id == id) b.box = box;
        }
        void erase(std::uint32_t id) {
            std::erase_if(boxes_, [&](const entry& b) { return b.id == id; });
        }
        template <class Accept>
        const physics::buffer<physics::proxy_pair>& pairs(Accept&& accept) {
            std::stable_sort(boxes_.begin(), boxes_.end(),
                             [](const entry& a, const entry& b) { return a.box.lower.x < b.box.lower.x; });
            pairs_.clear();
            for (std::size_t i = 0; i < boxes_.size(); ++i)
                for (std::size_t k = i + 1; k < boxes_.size() && !(boxes_[k].box.lower.x > boxes_[i].box.upper.x);
                     ++k) {
                    const std::uint32_t a = std::min(boxes_[i].id, boxes_[k].id);
                    const std::uint32_t b = std::max(boxes_[i].id, boxes_[k].id);
                    if (overlap(boxes_[i].box, boxes_[k].box) && may_meet(boxes_[i].filter, boxes_[k].filter) &&
                        accept(a, b))
                        pairs_.push_back({a, b});
                }
            std::sort(pairs_.begin(), pairs_.end());
            return pairs_;
        }

    private:
        struct entry {
            std::uint32_t id;
            aabb box;
            physics::proxy_filter filter;
        };
        std::vector<entry> boxes_;
        physics::buffer<physics::proxy_pair> pairs_;
    };
};

/// A user's integrator: explicit Euler, which falls ahead of the exact parabola by half a step.
struct explicit_euler {
    using stage = physics::stage::integrator;
    template <class Space>
    struct in {
        using body = physics::solver_api::moving_body<S, D>;
        static void integrate_velocity(physics::twist<S, D>& v, const body& b, S h) { v.linear += b.acceleration * h; }
        static void integrate_pose(body& b, const physics::twist<S, D>& v, physics::twist<S, D>& displacement, S h) {
            // The velocity at the step's start: what gravity has added since is taken off again.
            displacement.linear += (v.linear - b.acceleration * h) * h;
            displacement.angular += v.angular * h;
            if constexpr (D == 3) b.rotation = turned(b.rotation, v.angular * h);
        }
    };
};

/// A user's integrator in space: the library's, under which velocities fade as poses advance.
struct fading {
    using stage = physics::stage::integrator;
    template <class Space>
    struct in : physics::semi_implicit_euler::in<Space> {
        using library = physics::semi_implicit_euler::in<Space>;
        template <class Body, class Twist, class Way>
        static void integrate_pose(Body& b, Twist& v, Way& displacement, S h) {
            library::integrate_pose(b, v, displacement, h);
            if constexpr (D == 3) {
                v.linear *= S(1) - h;
                v.angular *= S(1) - h;
            }
        }
    };
};

/// A user's narrowphase: the library's, one query at a time.
struct one_by_one {
    using stage = physics::stage::narrowphase;
    template <class Scalar, int Dimension, template <class, int> class... Shapes>
    struct in : physics::best_per_pair::in<Scalar, Dimension, Shapes...> {
        using library = physics::best_per_pair::in<Scalar, Dimension, Shapes...>;
        using query = physics::narrowphase_query<Scalar, Dimension, Shapes...>;
        using list = physics::manifold_list<Scalar, Dimension>;

        static void collide(const query* queries, std::uint32_t count, Scalar margin,
                            typename library::memory* memories, list& found) {
            for (std::uint32_t i = 0; i < count; ++i) {
                const std::uint32_t first = found.size();
                library::collide(queries + i, 1, margin, memories, found);
                for (std::uint32_t k = first; k < found.size(); ++k) found[k].query = i;
            }
        }
        static void collide(const query* queries, std::uint32_t count, Scalar margin, list& found) {
            collide(queries, count, margin, nullptr, found);
        }
    };
};

using physics::without;
using physics::feature::friction;
using physics::feature::restitution;
template <template <class, int> class... Shapes>
using only = physics::shapes<Shapes...>;

struct plain : physics::recipe<S, D> {};
struct swept : physics::recipe<S, D, sweep_along_x> {};
struct reordered : physics::recipe<S, D, one_by_one, sweep_along_x> {};
struct slippery : physics::recipe<S, D, without<friction>, only<physics::halfspace, physics::box>> {};
struct dull : physics::recipe<S, D, only<physics::ball, physics::box, physics::halfspace>, without<restitution>,
                              sweep_along_x> {};
struct bare : physics::recipe<S, D, one_by_one, without<restitution, friction>> {};
struct ahead : physics::recipe<S, D, explicit_euler, without<restitution>, one_by_one> {};
struct ahead_swept
    : physics::recipe<S, D, sweep_along_x, explicit_euler, without<friction>, only<physics::box, physics::halfspace>> {
};

template <class... Policies>
struct of : physics::recipe<S, D, Policies...> {};

template <class Recipe>
std::uint64_t hash_of_pyramid() {
    auto w = scenes::grounded<physics::world<Recipe>>();
    scenes::pyramid(w, 4);
    for (int i = 0; i < 60; ++i) w.step(S(1.0 / 60));
    return w.state_hash();
}

CELL_CASE("policies: a broadphase or a narrowphase that finds the same pairs gives the same bits") {
    CHECK(hash_of_pyramid<swept>() == hash_of_pyramid<plain>());
    CHECK(hash_of_pyramid<reordered>() == hash_of_pyramid<plain>());
}

/// Where nobody sleeps, so that what stands does so of itself.
template <class World>
World wakeful_ground() {
    typename World::settings_type settings;
    settings.sleeping.enabled = false;
    return scenes::grounded<World>(settings);
}

template <class Recipe>
void rests_on_the_ground() {
    auto w = wakeful_ground<physics::world<Recipe>>();
    const auto crate = scenes::add_crate(w, 0, 0.75);
    for (int i = 0; i < 120; ++i) w.step(S(1.0 / 60));
    CHECK(std::abs(cell::number(w.position(crate).y) - 0.5) <= 0.01);
    CHECK(scenes::kinetic_energy(w) <= 1e-4);
}

CELL_CASE("policies: a crate comes to rest in every combination") {
    rests_on_the_ground<plain>();
    rests_on_the_ground<swept>();
    rests_on_the_ground<reordered>();
    rests_on_the_ground<slippery>();
    rests_on_the_ground<dull>();
    rests_on_the_ground<bare>();
}

#if CELL_DIMENSION == 3
struct faded : physics::recipe<S, D, fading> {};
struct faded_one_by_one : physics::recipe<S, D, fading, physics::sequential_impulse> {};
/// What is left of its speeds after a second, of a ball and of a box that nothing touches.
template <class Recipe>
void fades(int substeps) {
    using world = physics::world<Recipe>;
    typename world::settings_type settings;
    settings.gravity = {};
    settings.solver.substeps = substeps;
    world w(settings);
    for (const bool is_ball : {true, false}) {
        const auto b = w.create_body({.position = {S(0), S(is_ball ? 0 : 9), S(0)},
                                      .linear_velocity = {S(1), S(0), S(0)},
                                      .angular_velocity = {S(0), S(1), S(0)}});
        if (is_ball) static_cast<void>(w.create_shape(b, typename world::ball{S(0.5)}));
        else static_cast<void>(w.create_shape(b, typename world::box{{S(0.5), S(0.25), S(0.125)}}));
    }
    for (int i = 0; i < 64; ++i) w.step(S(1.0 / 64));
    const double left = std::pow(1 - 1.0 / 64 / substeps, 64 * substeps);
    for (const physics::body_id b : w.bodies()) {
        CHECK(std::abs(cell::number(w.linear_velocity(b).x) - left) <= 1e-5);
        CHECK(std::abs(cell::number(w.angular_velocity(b).y) - left) <= 1e-5);
    }
}
CELL_CASE("policies: what an integrator does to velocities as poses advance, it does once") {
    fades<faded>(4);
    fades<faded_one_by_one>(1);
}
#endif

/// The speed along x that is left of 3 m/s after a second on the ground.
template <class Recipe>
double speed_after_slide() {
    auto w = scenes::grounded<physics::world<Recipe>>();
    const auto crate = scenes::add_crate(w, 0, 0.5);
    typename physics::world<Recipe>::vec v;
    v.x = S(3);
    w.set_linear_velocity(crate, v);
    for (int i = 0; i < 64; ++i) w.step(S(1.0 / 64));
    return cell::number(w.linear_velocity(crate).x);
}

CELL_CASE("policies: friction stops a crate, and without it nothing does") {
    CHECK(std::abs(speed_after_slide<plain>()) <= 1e-3);
    CHECK(std::abs(speed_after_slide<dull>()) <= 1e-3);
    const double rounding = 1024 * cell::number(cell::traits::epsilon());
    CHECK(std::abs(speed_after_slide<slippery>() - 3) <= rounding);
    CHECK(std::abs(speed_after_slide<bare>() - 3) <= rounding);
}

/// The highest point that a ball reaches again after a fall of 1 m.
template <class Recipe>
double height_after_bounce(double restitution) {
    using world = physics::world<Recipe>;
    auto w = scenes::grounded<world>();
    typename world::body_def def;
    def.position.y = S(1.5);
    const auto ball = w.create_body(def);
    w.create_shape(ball, typename world::ball{S(0.5)}, {.material = {.restitution = S(restitution)}});
    double highest = 0;
    for (int i = 0; i < 56; ++i) {
        w.step(S(1.0 / 64));
        if (cell::number(w.linear_velocity(ball).y) > 0) highest = std::max(highest, cell::number(w.position(ball).y));
    }
    return highest;
}

CELL_CASE("policies: restitution throws a ball back, and without it it stays down") {
    CHECK(height_after_bounce<plain>(1) >= 1.4);
    CHECK(height_after_bounce<dull>(0) <= 0.51);
    CHECK(height_after_bounce<bare>(0) <= 0.51);
}

template <class Recipe>
double fall_of_a_second() {
    using world = physics::world<Recipe>;
    auto w = scenes::grounded<world>();
    typename world::body_def def;
    def.position.y = S(100);
    const auto body = w.create_body(def);
    for (int i = 0; i < 64; ++i) w.step(S(1.0 / 64));
    return 100 - cell::number(w.position(body).y);
}

CELL_CASE(
    "policies: the integrator is the recipe's: explicit Euler lags by g t h / 2 of a substep, the symplectic one "
    "leads") {
    const double rounding = 64 * 128 * cell::number(cell::traits::epsilon());
    const double off = 5.0 / 64 / typename physics::world<plain>::settings_type{}.solver.substeps;
    CHECK(std::abs(fall_of_a_second<plain>() - (5 + off)) <= rounding);
    CHECK(std::abs(fall_of_a_second<ahead>() - (5 - off)) <= rounding);
    CHECK(std::abs(fall_of_a_second<ahead_swept>() - (5 - off)) <= rounding);
}

CELL_CASE("policies: the set of shapes decides what a shape's value costs") {
    using all = physics::world<plain>::any_shape;
    using few = physics::world<dull>::any_shape;
    CHECK(sizeof(few) <= sizeof(all));
    CHECK(few::kinds == 3);
    CHECK(few::kind_of<physics::capsule<S, D>>() == -1);
}

/// lasts: whether the same features touch in all steps.
template <class Narrowphase>
void check_stack(double drift, int points, bool lasts) {
    using world = physics::world<of<Narrowphase>>;
    world w = wakeful_ground<world>();
    const physics::body_id top = scenes::stack(w, 5);
    const auto start = w.position(top);
    for (int i = 0; i < 660; ++i) {
        w.step(S(1.0 / 60));
        if (i < 60) continue;
        for (const auto& c : w.contacts()) {
            REQUIRE(c.count >= points);
            for (int k = 0; k < c.count && lasts; ++k) REQUIRE(c.points[k].persisted);
        }
    }
    CHECK(cell::number(physics::length(w.position(top) - start)) < drift);
    CHECK(scenes::kinetic_energy(w) < 1e-3);
}

CELL_CASE("policies: a stack stands by every narrowphase") {
    check_stack<physics::best_per_pair>(0.02, 2 * (D - 1), true);
    check_stack<physics::gjk_epa>(0.02, 2 * (D - 1), true);
    check_stack<physics::gjk_mpr>(0.02, 2 * (D - 1), true);
    // Three corners hold a crate; the fourth never is the deepest. Points come and go.
    check_stack<physics::incremental_manifolds>(0.05, D, false);
}

CELL_CASE("policies: what a narrowphase remembers is the same with every broadphase") {
    CHECK(hash_of_pyramid<of<physics::gjk_epa, sweep_along_x>>() == hash_of_pyramid<of<physics::gjk_epa>>());
    CHECK(hash_of_pyramid<of<physics::incremental_manifolds, sweep_along_x>>() ==
          hash_of_pyramid<of<physics::incremental_manifolds>>());
}

}  // namespace policies_laws
}  // namespace
