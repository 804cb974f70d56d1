// expect: physics::recipe: no snapshot of the world can be made, as the broadphase does not name what lasts of it; its in<Space> needs a static each_member(self, f)
#include <physics.hpp>

struct boxes {
    using stage = physics::stage::broadphase;
    template <class Space>
    struct in {
        void insert(std::uint32_t, const typename Space::aabb&, const physics::proxy_filter&);
        void move(std::uint32_t, const typename Space::aabb&, const typename Space::vec&);
        void erase(std::uint32_t);
        template <class Accept>
        const physics::buffer<physics::proxy_pair>& pairs(Accept&&);
        physics::buffer<typename Space::aabb> all;
    };
};
struct mine : physics::recipe<float, 2, boxes> {};

using plan = physics::detail::plan_of<mine>::type;
bool there_and_back(physics::detail::raw_snapshot<plan>& snapshot, physics::detail::world_data<plan>& state) {
    snapshot.save(state);
    return snapshot.restore(state);
}
