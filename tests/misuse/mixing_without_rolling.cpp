// expect: physics::recipe: the mixing rule does not model physics::mixing_for; its in<Space> needs friction, restitution and rolling_resistance of two materials
#include <physics.hpp>

struct sticky {
    using stage = physics::stage::mixing;
    template <class Space>
    struct in {
        using material = physics::material<typename Space::scalar, Space::dimension>;
        static typename Space::scalar friction(const material& a, const material& b) { return a.friction + b.friction; }
        static typename Space::scalar restitution(const material&, const material&) { return 0; }
    };
};
struct mine : physics::recipe<float, 2, sticky> {};

physics::world<mine> world;
