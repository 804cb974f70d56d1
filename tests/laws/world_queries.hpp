// Queries of worlds: the answers of the shapes themselves, one by one, whatever the broadphase.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "world_cell.hpp"

namespace {
namespace world_queries_laws {

template <class Broadphase>
struct asked : physics::recipe<
                   S, cell::dimension, Broadphase,
                   physics::shapes<physics::ball, physics::capsule, physics::box, physics::halfspace, physics::hull>> {
};

template <class World>
struct crowd {
    World world;
    std::vector<shape_id> shapes;

    crowd(int count, cell::dice& dice) {
        const body_id ground = world.create_body({.type = body_type::static_body});
        shapes.push_back(world.create_shape(ground, typename World::halfspace{}));
        std::vector<vec> corners;
        for (int i = 0; i < 12; ++i) corners.push_back(dice.vec<vec>(-0.6, 0.6));
        const auto rock = World::hull_geometry::build(corners.data(), static_cast<std::uint32_t>(corners.size()));
        for (int i = 0; i < count; ++i) {
            vec position = dice.vec<vec>(-8, 8);
            position.y = dice.real(0, 8);
            const auto orientation = random_rotation(dice);
            const body_id b = world.create_body({.type = i % 3 ? body_type::dynamic_body : body_type::static_body,
                                                 .position = position,
                                                 .rotation = orientation});
            const S size = dice.real(0.1, 0.6), other = dice.real(0.1, 0.6);
            switch (i % 4) {
                case 0: shapes.push_back(world.create_shape(b, typename World::ball{size})); break;
                case 1: shapes.push_back(world.create_shape(b, typename World::capsule{size, other})); break;
                case 2: shapes.push_back(world.create_shape(b, typename World::box{vec::filled(size)})); break;
                default: shapes.push_back(world.create_shape(b, rock.shape()));
            }
        }
        // Away from where they were created, and back into the broadphase.
        for (int i = 0; i < 3; ++i) world.step(S(1.0 / 64));
    }
    auto pose(shape_id id) const { return world.pose(world.body(id)) * world.local_pose(id); }
};

template <class World>
void agrees_with_each_shape(std::uint64_t seed) {
    cell::dice dice(seed);
    const crowd<World> c(120, dice);
    const World& w = c.world;
    int hits = 0;
    for (int i = 0; i < 200; ++i) {
        const vec origin = dice.vec<vec>(-9, 9);
        vec displacement = dice.vec<vec>(-12, 12);
        // So short along an axis that the origin's number does not change.
        if (i % 4 == 3) displacement[dice.below(cell::dimension)] = cell::real(i % 8 == 3 ? 1e-20 : -1e-40);
        typename World::world_hit best;
        std::vector<shape_id> expected;
        for (const shape_id id : c.shapes) {
            const auto hit = cast_ray(w.shape(id), c.pose(id), origin, displacement);
            if (!hit) continue;
            expected.push_back(id);
            if (!best || hit.fraction < best.fraction || (hit.fraction == best.fraction && id.index < best.shape.index))
                best = {id, w.body(id), hit.fraction, hit.point, hit.normal};
        }
        const auto found = w.cast_ray(origin, displacement);
        REQUIRE(found.shape == best.shape);
        if (best) {
            ++hits;
            REQUIRE(found.body == best.body);
            REQUIRE(found.fraction == best.fraction);
            REQUIRE(found.point == best.point);
            REQUIRE(found.normal == best.normal);
        }
        std::vector<shape_id> all;
        w.each_hit_along_ray(origin, displacement, {}, [&](const auto& hit) { all.push_back(hit.shape); });
        const auto by_number = [](shape_id a, shape_id b) { return a.index < b.index; };
        std::sort(all.begin(), all.end(), by_number);
        std::sort(expected.begin(), expected.end(), by_number);
        REQUIRE(all == expected);
    }
    CHECK(hits > 100);

    int overlaps = 0, casts = 0;
    const physics::box<S, cell::dimension> probe{vec::filled(S(0.75))};
    for (int i = 0; i < 100; ++i) {
        const typename World::transform pose{dice.vec<vec>(-8, 8), random_rotation(dice)};
        vec displacement = dice.vec<vec>(-6, 6);
        if (i % 4 == 3) displacement[dice.below(cell::dimension)] = cell::real(i % 8 == 3 ? 1e-20 : -1e-40);
        std::vector<shape_id> expected, all;
        S first(2), nearest(0);
        shape_id closest;
        for (const shape_id id : c.shapes) {
            const auto local = relative(c.pose(id), pose);
            w.shape(id).visit([&](const auto& shape) {
                if (!(separation(shape, probe, local).distance > S(0))) expected.push_back(id);
                const auto hit = cast_shape(shape, probe, local, inverse_rotate(c.pose(id).rotation, displacement));
                if (hit && hit.fraction < first) first = hit.fraction;
                const physics::ball<S, cell::dimension> tip{S(0)};
                const S d = separation(shape, tip, relative(c.pose(id), {pose.position, {}})).distance;
                if (!closest || d < nearest) nearest = d, closest = id;
            });
        }
        w.each_overlapping(probe, pose, {}, [&](shape_id id) { all.push_back(id); });
        std::sort(all.begin(), all.end(), [](shape_id a, shape_id b) { return a.index < b.index; });
        std::sort(expected.begin(), expected.end(), [](shape_id a, shape_id b) { return a.index < b.index; });
        REQUIRE(all == expected);
        overlaps += static_cast<int>(all.size());
        const auto cast = w.cast_shape(probe, pose, displacement);
        REQUIRE(static_cast<bool>(cast) == !(first > S(1)));
        if (cast) REQUIRE(cast.fraction == first);
        casts += static_cast<bool>(cast);
        const auto near = w.closest_shape(pose.position, S(2));
        REQUIRE(static_cast<bool>(near) == !(nearest > S(2)));
        if (near) REQUIRE(near.distance == nearest);
        if (near) REQUIRE(near.shape == closest);
        bool inside = false;
        w.each_at(pose.position, {}, [&](shape_id) { inside = true; });
        REQUIRE(inside == !(nearest > S(0)));
    }
    CHECK(overlaps > 50);
    CHECK(casts > 30);
}

CELL_CASE("world queries: no ray passes between boxes that abut on one body, however it is turned") {
    cell::dice dice(612);
    for (int run = 0; run < 24; ++run) {
        world w;
        const body_id floor = w.create_body(
            {.type = body_type::static_body, .position = dice.vec<vec>(-20, 20), .rotation = random_rotation(dice)});
        // A row of them in 2D, in 3D a square.
        const int across = cell::is_2d ? 1 : 6;
        for (int x = 0; x < 6; ++x)
            for (int z = 0; z < across; ++z) {
                vec local = at(x, 0);
                local[cell::dimension - 1] += S(cell::is_2d ? 0 : z);
                w.create_shape(floor, world::box{vec::filled(S(0.5))}, {.position = local});
            }
        const auto pose = w.pose(floor);
        for (int seam = 0; seam < 5; ++seam)
            for (int i = 0; i < 8; ++i) {
                // Down at a seam, or at a corner of four, from straight above or from along the seam.
                vec from = at(seam + 0.5, 4), down = at(0, -8);
                if (cell::is_3d) {
                    from[cell::dimension - 1] = i % 2 ? S(seam + 0.5) : dice.real(0, 5);
                    if (i % 4 > 1) down[cell::dimension - 1] = dice.real(-1, 1);
                }
                CAPTURE(run);
                CAPTURE(seam);
                CAPTURE(i);
                CHECK(w.cast_ray(pose * from, pose.rotation * down));
            }
    }
}
CELL_CASE("world queries: as each shape would answer") {
    agrees_with_each_shape<physics::world<asked<physics::dynamic_tree>>>(70);
}
CELL_CASE("world queries: under any broadphase") {
    agrees_with_each_shape<physics::world<asked<physics::sweep_and_prune>>>(70);
    agrees_with_each_shape<physics::world<asked<physics::hash_grid>>>(71);
}

CELL_CASE("world queries: exact answers") {
    world w;
    add_ground(w);
    const body_id box = add_box(w, at(0, 2));
    const auto hit = w.cast_ray(at(0, 10), at(0, -16));
    CHECK(hit.body == box);
    CHECK(number(hit.fraction) == 7.5 / 16);
    CHECK(hit.point == at(0, 2.5));
    CHECK(hit.normal == at(0, 1));
    CHECK(w.cast_ray(at(2, 10), at(0, -16)).point == at(2, 0));
    CHECK_FALSE(w.cast_ray(at(2, 10), at(0, -8)));
    // Down a wheel's axis that rounding has tilted.
    for (const double aside : {1e-8, -1e-20, 1e-42}) {
        CHECK(std::abs(number(w.cast_ray(at(5, 10), at(aside, -20)).fraction) - 0.5) <= rounding(1));
        CHECK(number(w.cast_shape(world::ball{S(0.5)}, {at(5, 10), {}}, at(aside, -20)).fraction) > 0.4);
    }
    // It begins within: a hit at once, without a normal.
    const auto within = w.cast_ray(at(0, 2), at(4, 0));
    CHECK(within.body == box);
    CHECK(number(within.fraction) == 0);
    CHECK(within.normal == vec{});
    // Filters see the categories of the broadphase's proxies, which are all 1 so far.
    CHECK_FALSE(w.cast_ray(at(0, 10), at(0, -16), {.mask = 2}));
    const auto cast = w.cast_shape(world::ball{S(0.5)}, {at(0, 10), {}}, at(0, -16));
    CHECK(cast.body == box);
    CHECK(std::abs(number(cast.fraction) - 7.0 / 16) <= rounding(4));
    const auto near = w.closest_shape(at(0, 4), S(3));
    CHECK(near.body == box);
    CHECK(std::abs(number(near.distance) - 1.5) <= rounding(4));
    CHECK_FALSE(w.closest_shape(at(0, 4), S(1)));
}

CELL_CASE("world queries: a shape collides with what a body of that shape has contacts with") {
    using hulls = physics::world<asked<physics::dynamic_tree>>;
    cell::dice dice(23);
    const crowd<hulls> all(60, dice);
    std::size_t compared = 0;
    std::vector<vec> corners;
    for (int i = 0; i < 8; ++i) corners.push_back(dice.vec<vec>(-0.6, 0.6));
    const auto rock = hulls::hull_geometry::build(corners.data(), 8);
    for (int i = 0; i < 120; ++i) {
        hulls w = all.world;
        auto settings = w.settings();
        settings.gravity = {};
        w.set_settings(settings);
        vec where = dice.vec<vec>(-4, 4);
        where.y = dice.real(0, 3);
        const hulls::transform pose{where, random_rotation(dice)};
        const auto check_shape = [&](const auto& shape) {
            std::vector<hulls::shape_contact> found;
            w.collide_shape(shape, pose, settings.contact_margin, {}, [&](const auto& c) { found.push_back(c); });
            const body_id b = w.create_body({.position = pose.position, .rotation = pose.rotation});
            w.create_shape(b, shape);
            w.step(S(1.0 / 65536));
            std::size_t k = 0;
            for (const auto& c : w.contacts(b)) {
                REQUIRE(k < found.size());
                const auto& mine = found[k++];
                CHECK(mine.body == c.other(b));
                CHECK(gap(mine.normal, c.normal_on(b)) <= rounding(64));
                REQUIRE(mine.count == c.count);
                for (int j = 0; j < c.count; ++j) {
                    CHECK(gap(mine.points[j].separation, c.points[j].separation) <= rounding(256, 8));
                    CHECK(gap(mine.points[j].position, c.points[j].position) <= 0.01);
                }
            }
            CHECK(k == found.size());
            compared += k;
        };
        if (i % 4 == 0) check_shape(hulls::ball{S(1)});
        else if (i % 4 == 1) check_shape(hulls::capsule{S(0.5), S(0.5)});
        else if (i % 4 == 2) check_shape(hulls::box{vec::filled(S(0.75))});
        else check_shape(rock.shape(S(0.25)));
    }
    CHECK(compared > 40);
}

CELL_CASE("world queries: what is bad is refused by name") {
    if constexpr (!cell::is_fixed) {
        world w;
        add_ground(w);
        const S nan = S(std::nan(""));
        const auto says = [&](auto&& call, const char* what) {
            std::string text;
            try {
                call();
            } catch (const physics::error& e) {
                text = e.what();
            }
            CHECK_MESSAGE(text == what, text);
        };
        says([&] { (void)w.cast_ray(along(0, 1) * nan, at(0, 1)); },
             "physics: cast_ray: origin.x is nan; it must be finite");
        says([&] { (void)w.cast_ray(at(0, 0), along(1, 1) * nan); },
             "physics: cast_ray: translation.x is nan; it must be finite");
        says([&] { (void)w.cast_shape(world::ball{S(-1)}, {}, at(0, 1)); },
             "physics: cast_shape: radius is -1; it must be greater than 0");
        const auto collide = [&](const world::ball& ball, S margin) {
            w.collide_shape(ball, {}, margin, {}, [](const auto&) {});
        };
        says([&] { collide(world::ball{S(-1)}, S(0)); },
             "physics: collide_shape: radius is -1; it must be greater than 0");
        says([&] { collide(world::ball{}, S(-1)); }, "physics: collide_shape: margin is -1; it must not be negative");
        says([&] { (void)w.closest_shape(at(0, 0), S(-1)); },
             "physics: closest_shape: reach is -1; it must not be negative");
    }
}

}  // namespace world_queries_laws
}  // namespace
