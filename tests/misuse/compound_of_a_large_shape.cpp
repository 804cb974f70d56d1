// expect: physics::compound_child: the shape is larger than 64 bytes
#include <physics.hpp>

template <class S, int D>
struct cloud {
    using scalar = S;
    physics::vec<S, D> points[8];
    template <class T>
    cloud<T, D> as() const;
};
template <class S, int D>
bool check(const cloud<S, D>&, const char*);
template <class S, int D>
physics::aabb<S, D> bounds(const cloud<S, D>&, const physics::transform<S, D>&);
template <class S, int D>
physics::vec<S, D> support(const cloud<S, D>&, physics::vec<S, D>);

physics::compound_child<float, 3> child(cloud<float, 3>{});
