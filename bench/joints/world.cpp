// One world of the benchmark of joints: its DIMENSION, and the KINDS of joints that its recipe names, if any.
#include <physics.hpp>

#include "world.hpp"

namespace bench {

namespace {

#ifdef KINDS
struct of_kinds : physics::recipe<float, DIMENSION, physics::shapes<physics::ball, physics::box>, physics::KINDS> {};
#else
struct of_kinds : physics::recipe<float, DIMENSION, physics::shapes<physics::ball, physics::box>> {};
#endif
using world = physics::world<of_kinds>;
using vec = world::vec;

world& of(void* w) { return *static_cast<world*>(w); }

#ifdef KINDS
/// Holds B where it stands, 1 m to the right of A, as the kind does by default.
template <template <class, int> class Kind>
void join(world& w, physics::body_id a, physics::body_id b, const physics::joints<Kind>&) {
    using joint = Kind<float, DIMENSION>;
    vec place = w.position(b);
    if constexpr (requires(joint j) { j.ground_a; }) {
        vec up;
        up[1] = 2;
        w.create_joint(a, b, joint{.ground_a = w.position(a) + up, .ground_b = place + up});
    } else if constexpr (
        requires(joint j) { j.ratio; } || requires(joint j) { j.radius; } || requires(joint j) { j.length; }) {
        w.create_joint(a, b, joint{});
    } else if constexpr (requires(joint j) { j.target; }) {
        w.create_joint(a, b, joint{.target = place - w.position(a)});
    } else if constexpr (requires { w.create_joint_at(a, b, world::transform{place, {}}, joint{}); }) {
        w.create_joint_at(a, b, world::transform{place, {}}, joint{});
    } else {
        w.create_joint(a, b, joint{});
    }
}
/// Of several kinds only the code is asked for.
template <template <class, int> class First, template <class, int> class Second, template <class, int> class... Others>
void join(world& w, physics::body_id a, physics::body_id b, const physics::joints<First, Second, Others...>&) {
    join(w, a, b, physics::joints<First>{});
    join(w, a, b, physics::joints<Second, Others...>{});
}
#endif

}  // namespace

void* make(int pairs, [[maybe_unused]] bool joined) {
    auto* const w = new world;
    for (int i = 0; i < pairs; ++i) {
        vec at;
        at[0] = 4.0f * static_cast<float>(i);
        const physics::body_id a = w->create_body({.type = physics::body_type::static_body, .position = at});
        at[0] += 1;
        const physics::body_id b = w->create_body({.position = at, .can_sleep = false});
        w->create_shape(b, world::ball{0.25f});
#ifdef KINDS
        if (joined) join(*w, a, b, physics::KINDS{});
#else
        static_cast<void>(a);
#endif
    }
    return w;
}
void step(void* w) { of(w).step(1.0f / 60); }
void* copy(void* w) { return new world(of(w)); }
void drop(void* w) { delete &of(w); }

}  // namespace bench
