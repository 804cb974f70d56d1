// expect: physics::shapes: a type of the set does not model physics::shape_for; it needs check, bounds and as<T>()
#include <physics.hpp>

template <class S, int D>
struct blob;
struct mine : physics::recipe<float, 2, physics::shapes<blob>> {};

physics::world<mine> world;
