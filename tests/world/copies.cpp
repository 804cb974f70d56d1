// Worlds are copied, moved and assigned with the geometry that their shapes share.
#include <doctest/doctest.h>

#include <physics.hpp>
#include <utility>

namespace {

struct quarry : physics::recipe<float, 3, physics::shapes<physics::ball, physics::hull>> {};
using world = physics::world<quarry>;
using geometry = world::hull_geometry;

geometry rock() { return geometry::build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.7f, 0.7f, 0.7f}}); }

/// A world with a ball and so many shapes of a hull.
world with(const geometry& g, int count) {
    world w;
    const auto body = w.create_body();
    static_cast<void>(w.create_shape(body, world::ball{}));
    for (int i = 0; i < count; ++i) static_cast<void>(w.create_shape(body, g.shape()));
    return w;
}

TEST_CASE("copies: worlds own the geometry of their shapes, and nothing longer than they have it") {
    const geometry a = rock(), b = rock();
    const auto owners = [&] { return std::pair(a.data()->owners, b.data()->owners); };
    const auto are = [](std::uint32_t of_a, std::uint32_t of_b) {
        return std::pair<decltype(a.data()->owners), decltype(b.data()->owners)>(of_a, of_b);
    };
    {
        world w = with(a, 3), v = with(b, 5);
        CHECK(owners() == are(4, 6));
        const std::uint64_t of_w = w.state_hash(), of_v = v.state_hash();
        world copy = w;
        CHECK(owners() == are(7, 6));
        // To a world with other shapes, more and fewer of them, the same ones, itself.
        copy = v;
        CHECK(owners() == are(4, 11));
        CHECK(copy.state_hash() == of_v);
        copy = w;
        CHECK(owners() == are(7, 6));
        CHECK(copy.state_hash() == of_w);
        copy = w;
        const world& itself = copy;
        copy = itself;
        CHECK(owners() == are(7, 6));
        CHECK(copy.state_hash() == of_w);
        copy = std::move(v);
        CHECK(owners() == are(4, 6));
        CHECK(copy.state_hash() == of_v);
        CHECK(v.shape_count() == 0);
        v = with(a, 1);
        CHECK(owners() == are(5, 6));
        copy = world();
        CHECK(owners() == are(5, 1));
        CHECK(copy.shape_count() == 0);
    }
    CHECK(owners() == are(1, 1));
}

TEST_CASE("copies: the last owner of geometry may be a world that was assigned to") {
    world w;
    {
        const world first = with(rock(), 2);
        w = first;
    }
    CHECK(w.shape_count() == 3);
    CHECK(w.cast_ray({0.2f, 0.2f, -3}, {0, 0, 6}));
    const world& itself = w;
    w = itself;
    CHECK(w.cast_ray({0.2f, 0.2f, -3}, {0, 0, 6}));
}

}  // namespace
