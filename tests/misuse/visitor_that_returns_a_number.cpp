// expect: physics: a visitor of a query answers with a number; let it return nothing, or a bool: false ends the query
#include <physics.hpp>

struct mine : physics::recipe<float, 2> {};

void look(const physics::world<mine>& w) {
    w.each_hit_along_ray({}, {1, 0}, {}, [](const auto&) { return -1.0f; });
}
