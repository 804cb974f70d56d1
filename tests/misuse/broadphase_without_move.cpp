// expect: physics::recipe: the broadphase does not model physics::broadphase_for; its in<Space> needs insert, move, erase and pairs
#include <physics.hpp>

struct grid {
    using stage = physics::stage::broadphase;
    template <class Space>
    struct in {
        void insert(std::uint32_t, const typename Space::aabb&, const physics::proxy_filter&);
        void erase(std::uint32_t);
        template <class Accept>
        const physics::buffer<physics::proxy_pair>& pairs(Accept&&);
    };
};
struct mine : physics::recipe<float, 2, grid> {};

physics::world<mine> world;
