// Fixed point out of range, with the audit on: ordinary scenes never are, and a step that is gets counted.
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

    // A force at the end of the range is stored as it is; what it does to a light body is counted in the step.
    const auto feather = w.create_body({.linear_velocity = {}});
    w.create_shape(feather, typename world::ball{}, {.density = scalar(0.01)});
    typename world::vec force;
    force.x = scalar(2e9);
    w.apply_force(feather, force);
    CHECK(physics::overflow_count() == 0);
    const std::uint64_t steps = w.steps();
    w.step(scalar(1.0 / 60));
    CHECK(physics::overflow_count() > 0);
    CHECK(w.steps() == steps + 1);
    physics::reset_overflow_count();
    w.apply_force(feather, force);
    w.apply_force(feather, force);
    CHECK(physics::overflow_count() == 1);
    w.clear_forces(feather);
    physics::reset_overflow_count();
    w.apply_impulse(feather, force);
    CHECK(physics::overflow_count() > 0);
    w.destroy_body(feather);
    physics::reset_overflow_count();
    for (int i = 0; i < 60; ++i) w.step(scalar(1.0 / 60));
    CHECK(physics::overflow_count() == 0);
}

}  // namespace

TEST_CASE("overflow: fixed32 stays in range in ordinary scenes, and leaving it is counted, in the plane") {
    check<2>();
}
TEST_CASE("overflow: fixed32 stays in range in ordinary scenes, and leaving it is counted, in space") { check<3>(); }
