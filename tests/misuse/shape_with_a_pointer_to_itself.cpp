// expect: physics::shapes: a type of the set does not model physics::shape_for; it needs check, bounds and as<T>()
#include <physics.hpp>

template <class S, int D>
struct chain {
    chain() = default;
    chain(const chain& other) : head(this), size(other.size) {}
    template <class T>
    chain<T, D> as() const {
        return {};
    }
    chain* head = this;
    S size{};
};
template <class S, int D>
bool check(const chain<S, D>&, const char*);
template <class S, int D>
physics::aabb<S, D> bounds(const chain<S, D>&, const physics::transform<S, D>&);
struct mine : physics::recipe<float, 2, physics::shapes<chain>> {};

physics::world<mine> world;
