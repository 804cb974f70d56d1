// Fixed point out of range, with the audit on: ordinary scenes never are, and what would be is refused.
#define PHYSICS_HPP_AUDIT
#include <doctest/doctest.h>

#include <physics.hpp>

#include <cstdint>

namespace {

using scalar = physics::fixed32;
template <int Dimension>
struct audited : physics::recipe<scalar, Dimension> {};

template <class World>
void add_crates(World& w, int count) {
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), typename World::halfspace{});
    for (int i = 0; i < count; ++i) {
        typename World::body_def def;
        def.position.x = scalar(0.1 * (i % 2));
        def.position.y = scalar(0.5 + 1.05 * i);
        const auto id = w.create_body(def);
        if (i % 3 == 0) w.create_shape(id, typename World::capsule{});
        else w.create_shape(id, typename World::box{});
    }
}

template <int Dimension>
void check() {
    using world = physics::world<audited<Dimension>>;
    physics::reset_overflow_count();
    world w;
    add_crates(w, 8);
    for (int i = 0; i < 240; ++i) w.step(scalar(1.0 / 60));
    CHECK(w.contacts().size() > 0);
    CHECK(physics::overflow_count() == 0);

    // What would leave the range is refused before it wraps: forces and impulses at once, what forces do in the step.
    const auto feather = w.create_body({.linear_velocity = {}});
    w.create_shape(feather, typename world::ball{}, {.density = scalar(0.01)});
    const auto push = [](double size) {
        typename world::vec force;
        force.x = scalar(size);
        return force;
    };
    CHECK_THROWS_AS(w.apply_force(feather, push(2e9)), physics::error);
    w.apply_force(feather, push(1e9));
    CHECK_THROWS_AS(w.apply_force(feather, push(1e9)), physics::error);
    CHECK(physics::overflow_count() == 0);
    const std::uint64_t steps = w.steps();
    CHECK_THROWS_AS(w.step(scalar(1.0 / 60)), physics::error);
    CHECK(w.steps() == steps);
    w.clear_forces(feather);
    CHECK_THROWS_AS(w.apply_impulse(feather, push(1e9)), physics::error);
    CHECK(w.linear_velocity(feather) == typename world::vec{});
    w.destroy_body(feather);
    physics::reset_overflow_count();
    for (int i = 0; i < 60; ++i) w.step(scalar(1.0 / 60));
    CHECK(physics::overflow_count() == 0);
}

}  // namespace

TEST_CASE("overflow: fixed32 stays in range in ordinary scenes, and leaving it is refused, in the plane") {
    check<2>();
}
TEST_CASE("overflow: fixed32 stays in range in ordinary scenes, and leaving it is refused, in space") { check<3>(); }
