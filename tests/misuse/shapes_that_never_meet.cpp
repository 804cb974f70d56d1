// expect: physics::shapes: two shapes of the set have no function collide(a, b, b_in_a, margin, manifold)
#include <physics.hpp>

template <class S, int D>
struct blob {
    S size{};
    template <class T>
    blob<T, D> as() const {
        return {static_cast<T>(size)};
    }
};
template <class S, int D>
bool check(const blob<S, D>&, const char*);
template <class S, int D>
physics::aabb<S, D> bounds(const blob<S, D>&, const physics::transform<S, D>&);
template <class S, int D>
void collide(const blob<S, D>&, const blob<S, D>&, const physics::transform<S, D>&, S, physics::manifold<S, D>&);
struct mine : physics::recipe<float, 2, physics::shapes<blob, physics::box>> {};

physics::world<mine> world;
