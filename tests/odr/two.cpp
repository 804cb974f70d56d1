// The other of two units in one program. It links where nothing in the library is defined twice.
#include <doctest/doctest.h>

#include "odr.hpp"

namespace {
struct recipe_of_two : physics::recipe<physics::fixed32, 2> {};
struct unturned : physics::recipe<float, 2, physics::without<physics::feature::rotation>> {};
}  // namespace

// one.cpp has another recipe of this name.
struct namesake : physics::recipe<double, 2> {};
template class physics::world<namesake>;

// In a unit that does both, and of a recipe that leaves functions out.
PHYSICS_HPP_EXTERN(unturned)
PHYSICS_HPP_INSTANTIATE(unturned)

template class physics::world<shared_recipe>;
template class physics::world<recipe_of_two>;

TEST_CASE("odr: two units share a recipe, and each has one of its own") {
    CHECK(shared_hash_in_one() == hash_of_landing<shared_recipe>());
    CHECK(own_hash_in_one() != shared_hash_in_one());
    CHECK(hash_of_landing<recipe_of_two>() != shared_hash_in_one());
    CHECK(hash_of_landing<unturned>() != shared_hash_in_one());
}

TEST_CASE("odr: two units have recipes of one name") {
    struct as_in_one : physics::recipe<float, 3, physics::without<physics::feature::sleeping>> {};
    struct as_here : physics::recipe<double, 2> {};
    CHECK(namesake_hash_in_one() == hash_of_fall<physics::world<as_in_one>>());
    CHECK(hash_of_fall<physics::world<namesake>>() == hash_of_fall<physics::world<as_here>>());
    CHECK(namesake_hash_in_one() != hash_of_fall<physics::world<as_here>>());
}

TEST_CASE("odr: a unit built with other options has types of its own, and the same results") {
    CHECK(overflows_in_audited() == 1);
    CHECK(shared_hash_in_audited() == shared_hash_in_one());
    const physics::fixed32 most = physics::fixed32::from_raw(INT64_MAX);
    CHECK(most + physics::fixed32(1) < physics::fixed32(0));
    CHECK(physics::overflow_count() == 0);
}
