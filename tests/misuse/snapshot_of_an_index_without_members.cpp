// expect: physics::recipe: no snapshot of the world can be made, as the broadphase does not name what lasts of it; its in<Space> needs a static each_member(self, f)
#include <physics.hpp>

template <class Space>
struct list {
    template <class Table>
    void insert(const Table&, std::uint32_t id) {
        all.push_back(id);
    }
    template <class Table>
    void erase(const Table&, std::uint32_t);
    template <class Table>
    void update(const Table&, const std::uint32_t*, std::uint32_t);
    template <class Table, class Emit>
    bool find(const Table&, Emit&&);
    template <class Table, class Visit>
    void each_near(const Table&, const typename Space::aabb&, Visit&&) const;
    physics::buffer<std::uint32_t> all;
};
struct listed {
    using stage = physics::stage::broadphase;
    template <class Space>
    using in = physics::indexed_broadphase<Space, list<Space>>;
};
struct mine : physics::recipe<float, 2, listed> {};

using plan = physics::detail::plan_of<mine>::type;
bool there_and_back(physics::detail::raw_snapshot<plan>& snapshot, physics::detail::world_data<plan>& state) {
    snapshot.save(state);
    return snapshot.restore(state);
}
