// One of two units in one program: everything included, every member compiled, of a recipe that both use and of its
// own.
#include "odr.hpp"

namespace {
struct recipe_of_one : physics::recipe<double, 3> {};
}  // namespace

template class physics::world<shared_recipe>;
template class physics::world<recipe_of_one>;

// two.cpp has another recipe of this name.
struct namesake : physics::recipe<float, 3, physics::without<physics::feature::sleeping>> {};
template class physics::world<namesake>;

std::uint64_t namesake_hash_in_one() { return hash_of_fall<physics::world<namesake>>(); }

std::uint64_t shared_hash_in_one() { return hash_of_landing<shared_recipe>(); }

std::uint64_t own_hash_in_one() { return hash_of_landing<recipe_of_one>(); }
