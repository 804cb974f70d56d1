// The same as worlds.cpp by other policies: in space, and in fixed point.
#define PHYSICS_HPP_THREADS

#include "world_changes.hpp"

namespace {

struct solid : physics::recipe<double, 3, fuzz::all_shapes, fuzz::all_events, physics::hash_grid,
                               physics::joints<physics::ball_joint, physics::weld_joint, physics::motor_joint>> {
    template <class S, int D>
    using kinds = fuzz::other_joints<S, D>;
};
struct exact
    : physics::recipe<physics::fixed32, 2, fuzz::all_shapes, fuzz::all_events, physics::grid,
                      physics::sequential_impulse, physics::joints<physics::distance_joint, physics::revolute_joint>> {
    template <class S, int D>
    using kinds = fuzz::few_joints<S, D>;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    fuzz::input in(bytes, size);
    if (in.below(2)) fuzz::play<solid>(in);
    else fuzz::play<exact>(in);
    return 0;
}
