// expect: physics::recipe: the narrowphase does not model physics::narrowphase_for; its in<S, D, Shapes...> needs collide
#include <physics.hpp>

struct mystery {
    using stage = physics::stage::narrowphase;
    template <class S, int D, template <class, int> class... Shapes>
    struct in {};
};
struct mine : physics::recipe<float, 2, mystery> {};

physics::world<mine> world;
