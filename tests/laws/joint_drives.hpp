// Laws of joints that drive and limit: filters, motors, and what turns in several ways.
#pragma once

#include "joint_cell.hpp"

namespace {
namespace drive_laws {

using namespace joint_laws;

template <class... Policies>
struct drives : physics::recipe<S, D, physics::shapes<physics::ball, physics::box, physics::halfspace>,
                                physics::joints<physics::filter_joint, physics::distance_joint>, Policies...> {};
using plain = physics::world<drives<>>;
using filter_joint = physics::filter_joint<S, D>;

template <class World>
void a_filter_only_keeps_bodies_from_colliding() {
    World w = falling<World>(4, 0);
    const body_id a = add_ball(w, at(0, 0), 0.25), b = add_ball(w, at(1, 0), 0.25), c = add_ball(w, at(2, 0), 0.25);
    const joint_id filter = w.create_joint(a, b, filter_joint{});
    w.set_linear_velocity(a, at(2, 0));
    run(w, 64);
    // Through one ball into the next.
    CHECK(number(w.position(a)[0]) > 1.25);
    CHECK(length_of(w.position(b) - at(1, 0)) == 0);
    CHECK(length_of(w.linear_velocity(c)) > 0.1);
    CHECK(length_of(w.reaction(filter).force) == 0);
    // Without it they push each other.
    w.destroy_joint(filter);
    w.set_pose(a, at(0, 0), {});
    w.set_linear_velocity(a, at(2, 0));
    run(w, 64);
    CHECK(number(w.position(b)[0] - w.position(a)[0]) > 0.49);
}
CELL_CASE("joint drives: a filter keeps its bodies from colliding, and is no force") {
    SUBCASE("soft_step") { a_filter_only_keeps_bodies_from_colliding<plain>(); }
    SUBCASE("sequential_impulse") {
        a_filter_only_keeps_bodies_from_colliding<physics::world<drives<physics::sequential_impulse>>>();
    }
}
CELL_CASE("joint drives: bodies of a filter sleep and wake apart, and go apart") {
    plain w = falling<plain>();
    vec up;
    up[1] = S(1);
    w.create_shape(add_anchor(w, at(0, 0)), plain::halfspace{up});
    const body_id a = add_box(w, at(0, 0.25), 0.25, 0.25), b = add_box(w, at(3, 0.25), 0.25, 0.25),
                  c = add_box(w, at(6, 0.25), 0.25, 0.25);
    w.create_joint(a, b, filter_joint{});
    w.create_joint(b, c, filter_joint{});
    w.set_can_sleep(a, false);
    run(w, 128);
    CHECK(!w.is_asleep(a));
    CHECK(w.is_asleep(b));
    CHECK(w.is_asleep(c));
    w.wake(b);
    CHECK(!w.is_asleep(b));
    CHECK(w.is_asleep(c));
    // A change wakes both: they may lie on each other.
    run(w, 128);
    const std::uint64_t before = w.state_hash();
    const joint_id filter = w.create_joint(a, c, filter_joint{});
    CHECK(!w.is_asleep(c));
    CHECK(w.state_hash() != before);
    w.destroy_body(a);
    CHECK(!w.contains(filter));
    CHECK(w.joint_count() == 1);
}

}  // namespace drive_laws
}  // namespace
