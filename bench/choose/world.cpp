// A unit that makes, fills, steps and reads a world: what a recipe costs in machine code and compile time. DIMENSION,
// SCALAR, SOLVER: of the recipe; HAS_JOINTS: whether it has joints.
#include <physics.hpp>

namespace {

using S = SCALAR;
constexpr int D = DIMENSION;
#if HAS_JOINTS
struct recipe : physics::recipe<S, D, physics::SOLVER, physics::joints<physics::ball_joint>> {};
#else
struct recipe : physics::recipe<S, D, physics::SOLVER> {};
#endif

}  // namespace

double play(int steps) {
    physics::world<recipe> w;
    const auto floor = w.create_body({.type = physics::body_type::static_body});
    const auto box = w.create_body({});
    static_cast<void>(w.create_shape(floor, physics::ball<S, D>{S(1)}));
    static_cast<void>(w.create_shape(box, physics::box<S, D>{physics::vec<S, D>::filled(S(1))}));
#if HAS_JOINTS
    w.create_joint(floor, box, physics::ball_joint<S, D>{});
#endif
    for (int i = 0; i < steps; ++i) w.step(S(1.0 / 60));
    return static_cast<double>(w.position(box)[1]);
}
