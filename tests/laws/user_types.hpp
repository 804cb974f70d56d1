// Laws of values that a world keeps for its user.
#pragma once

#include <map>
#include <vector>

#include "refusal.hpp"
#include "world_cell.hpp"

namespace {
namespace user_types_laws {

struct actor {
    int health = 100;
    double armour[3] = {1, 2, 3};
};
enum class surface : unsigned char { stone, ice };
struct lock {
    std::uint64_t key = 7;
};

struct kept : physics::recipe<S, cell::dimension, physics::joints<physics::distance_joint>,
                              physics::user_types<actor, surface, lock>> {};
struct without_any : physics::recipe<S, cell::dimension, physics::joints<physics::distance_joint>> {};
struct of_shapes : physics::recipe<S, cell::dimension, physics::user_types<physics::no_user_type, surface>> {};
using place = physics::world<kept>;

template <class World, class Id>
concept keeps = requires(World& w, Id id) {
    w.data(id);
};
static_assert(keeps<place, body_id> && keeps<place, shape_id> && keeps<place, physics::joint_id>);
static_assert(!keeps<physics::world<without_any>, body_id> && !keeps<physics::world<without_any>, physics::joint_id>);
static_assert(keeps<physics::world<of_shapes>, shape_id> && !keeps<physics::world<of_shapes>, body_id>);
// Recipes without them keep nothing.
static_assert(sizeof(physics::world<without_any>) + 3 * sizeof(physics::buffer<int>) <= sizeof(place));

CELL_CASE("user types: what is created begins with its default, and keeps what it is given, whatever comes and goes") {
    cell::dice dice(5);
    place w;
    std::map<body_id, int> health;
    std::map<shape_id, surface> surfaces;
    const auto check = [&](const place& of) {
        for (const auto& [b, value] : health) CHECK(of.data(b)->health == value);
        for (const auto& [s, value] : surfaces) CHECK(*of.data(s) == value);
    };
    for (int i = 0; i < 300; ++i) {
        if (health.size() < 5 || dice.below(3)) {
            const body_id b = w.create_body({.position = at(2 * i, 0)});
            CHECK(w.data(b)->health == 100);
            CHECK(w.data(b)->armour[2] == 3);
            w.data(b)->health = health[b] = i;
            w.data(b)->armour[2] = 0;
            for (int k = dice.below(3); k > 0; --k) {
                const shape_id s = w.create_shape(b, place::ball{S(0.5)});
                CHECK(*w.data(s) == surface::stone);
                if (dice.below(2)) *w.data(s) = surface::ice;
                surfaces[s] = *w.data(s);
            }
        } else {
            auto gone = health.begin();
            std::advance(gone, dice.below(static_cast<int>(health.size())));
            for (const shape_id s : w.shapes(gone->first)) surfaces.erase(s);
            w.destroy_body(gone->first);
            health.erase(gone);
        }
        if (i % 16 == 0) w.step(S(1.0 / 64));
        if (i % 50 == 0) {
            const place copy = w;
            check(copy);
            physics::detail::raw_snapshot<physics::detail::plan_of<kept>::type> image;
            image.save(physics::detail::world_access::state_of(w));
            place other;
            other.create_body();
            CHECK(image.restore(physics::detail::world_access::data_of(other)));
            check(w);
        }
    }
    check(w);
    const auto a = health.begin()->first, b = health.rbegin()->first;
    const physics::joint_id j = w.create_joint(a, b, place::distance_joint{});
    CHECK(w.data(j)->key == 7);
    w.data(j)->key = 8;
    w.destroy_joint(j);
    CHECK(w.data(w.create_joint(a, b, place::distance_joint{}))->key == 7);
    // They bear on nothing.
    place as_it_was = w;
    w.data(a)->health = -1;
    CHECK(w.state_hash() == as_it_was.state_hash());
    w.destroy_body(a);
    CHECK(refusal([&] { (void)w.data(a); }).find("data: body is #") != std::string::npos);
}

}  // namespace user_types_laws
}  // namespace
