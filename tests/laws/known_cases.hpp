// Pairs, rays and casts that other libraries were reported to get wrong, each with the answer that its numbers imply.
#pragma once

#include "reals.hpp"

namespace {
namespace known_cases_laws {

using ball = physics::ball<S, D>;
using box = physics::box<S, D>;
using capsule = physics::capsule<S, D>;
using hull_geometry = physics::hull_geometry<S, D>;
using closest = physics::closest_points<S, D>;

/// A box by its full sizes, as issues state them.
inline box box_of(double x, double y, double z = 0) { return {from_reals({x / 2, y / 2, z / 2})}; }
inline hull_geometry hull_of(const std::vector<reals>& points) {
    std::vector<vec> rounded;
    for (const reals& p : points) rounded.push_back(from_reals(p));
    return hull_geometry::build(rounded.data(), static_cast<std::uint32_t>(rounded.size()));
}
inline transform at(double x, double y, double z = 0) { return {from_reals({x, y, z}), {}}; }
inline transform at(double x, double y, double z, reals axis, double angle) {
    return {from_reals({x, y, z}), rotation_about(axis, angle)};
}
template <class Shape>
constexpr bool is_round = false;
#if CELL_DIMENSION == 3
using cylinder = physics::cylinder<S, 3>;
using cone = physics::cone<S, 3>;
using triangle = physics::triangle<S, 3>;
template <>
constexpr bool is_round<cylinder> = true;
template <>
constexpr bool is_round<cone> = true;
#endif

/// Checks the signed distance of a pair, to rounding of sizes as large as `size`, in both orders and with any cache;
/// and the normal from A to B, unless that is null as there are several.
template <class A, class B>
void expect(const A& a, const B& b, const transform& b_in_a, double gap, reals normal, double size = 1) {
    const double rounding = 32 * std::fmax(epsilon, 1e-15) * (size + cell::is_fixed);
    const double tolerance = rounding + (is_round<A> || is_round<B> ? 1e-8 * size : 0);
    physics::gjk_cache cache;
    const auto judge = [&](const closest& c, reals wanted) {
        const double d = cell::number(c.distance);
        CHECK_MESSAGE(std::abs(d - gap) <= tolerance, "distance " << d << ", not " << gap);
        CHECK(std::abs(::size(to_reals(c.normal)) - 1) <= 32 * epsilon);
        const reals across = to_reals(c.on_b) - to_reals(c.on_a) - to_reals(c.normal) * d;
        CHECK_MESSAGE(::size(across) <= 8 * tolerance, "the points are off by " << ::size(across));
        if (::size(wanted) == 0) return;
        const double off = ::size(to_reals(c.normal) - unit(wanted));
        CHECK_MESSAGE(off <= (std::abs(gap) > 1e4 * tolerance ? 1e-3 : 1e-2), "the normal is off by " << off);
    };
    const auto judge_all = [&](const auto& first, const auto& second, const transform& pose, reals wanted) {
        for (const closest& c : {separation(first, second, pose), separation(first, second, pose, cache),
                                 separation(first, second, pose, cache)})
            judge(c, wanted);
        const closest apart = distance(first, second, pose);
        CHECK(std::abs(cell::number(apart.distance) - std::fmax(gap, 0)) <= tolerance);
        if (std::abs(gap) > tolerance) CHECK(overlap(first, second, pose) == (gap < 0));
    };
    judge_all(a, b, b_in_a, normal);
    const reals back = to_reals(inverse_rotate(b_in_a.rotation, from_reals(-normal)));
    judge_all(b, a, inverse(b_in_a), back);
}

CELL_CASE("known cases: whole shapes on and in each other") {
    // Coincident centres, where the difference of the two is symmetric about the origin.
    expect(ball{S(1)}, ball{S(2)}, {}, -3, {});
    expect(capsule{S(2), S(0.5)}, capsule{S(2), S(0.5)}, {}, -1, {});
    expect(box_of(1, 1, 1), box_of(1, 1, 1), {}, -1, {});
    expect(box_of(1, 2, 3), ball{S(0.25)}, {}, -0.75, {});
    // Bullet #1703, mujoco_warp #1430: a small box on a plate, the farther off the worse.
    for (const double half : {1.0, 10.0, 100.0, 1000.0}) {
        expect(box_of(2 * half, 0.5, 2 * half), box_of(0.25, 0.25, 0.25), at(0.5 * half, 0.375 - 0x1p-10, 0.25 * half),
               -0x1p-10, {0, 1, 0}, 2 * half);
        expect(box_of(2 * half, 0.5, 2 * half), box_of(0.25, 0.25, 0.25), at(0.5 * half, 0.375 + 0x1p-10, 0.25 * half),
               0x1p-10, {0, 1, 0}, 2 * half);
    }
    // Cubes of a millimetre to a kilometre that nearly touch: faces, and an edge above a face.
    for (const double side : {0.001, 1.0, 1000.0})
        for (const double gap : {0x1p-6, -0x1p-6}) {
            expect(box_of(side, side, side), box_of(side, side, side), at(side * 0.25, side * (1 + gap), 0), side * gap,
                   {0, 1, 0}, side);
            const double height = side * (0.5 + std::sqrt(0.5) + gap);
            expect(box_of(side, side, side), box_of(side, side, side), at(0, height, 0, {0, 0, 1}, M_PI / 4),
                   side * gap, {0, 1, 0}, side);
        }
    // collision-gjk-epa #4, scaled by 1/64: boxes side by side whose edges lie on one line.
    expect(box_of(938.72 / 64, 30.0 / 64, 1), box_of(60.0 / 64, 39.8 / 64, 1), at(-15.362 / 64, 34.9 / 64), 0,
           {0, 1, 0}, 16);
    // mujoco #2206: a sphere that is all within a box.
    expect(box_of(1, 0.5, 1), ball{S(0.005)}, at(0, 0.2415), -0.0135, {0, 1, 0});
}

CELL_CASE("known cases: capsules beside, across and in boxes and capsules") {
    const double turn = M_PI / 2;
    // cute_headers #10: ends that meet. FCL #225: centre lines that cross.
    expect(capsule{S(1), S(0.25)}, capsule{S(1), S(0.25)}, at(2, 0), -0.5, {});
    expect(capsule{S(1), S(0.25)}, capsule{S(1), S(0.25)}, at(1, 1, 0, {0, 0, 1}, turn), -0.5, {});
    if (cell::is_3d) {
        expect(capsule{S(1), S(0.25)}, capsule{S(2), S(0.5)}, at(0.5, 0.25, 0, {0, 0, 1}, turn), -0.75, {});
        expect(capsule{S(1), S(0.25)}, capsule{S(2), S(0.5)}, at(0.5, 0.25, 1, {0, 0, 1}, turn), 0.25, {0, 0, 1});
    }
    // DART #3343: a box beside the middle of a long capsule.
    expect(box_of(2, 2, 2), capsule{S(10), S(0.5)}, at(2, 2), 0.5, {0, 1, 0}, 12);
    // FCL #31: the end of a capsule that stands on a box.
    expect(box_of(2, 2, 2), capsule{S(0.5), S(0.25)}, at(0.5, 1.875, 0, {0, 0, 1}, turn), 0.125, {0, 1, 0});
    // cute_c2 #158: deep within a wedge the way out is across its longest side, not across the capsule.
    const auto wedge = hull_of({{0, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {0, 1, 2}, {-1, 1, 2}, {1, -1, 2}});
    expect(wedge.shape(), capsule{S(0.25), S(0.5)}, at(0, 0.25, 1, {0, 0, 1}, turn), -0.5 - std::sqrt(0.125),
           {-1, -1, 0}, 2);
    // parry #378: it stands on a long box, touching or in it by 1.09 cm; the points must not slip away.
    for (const double depth : {0.0, 0.0109}) {
        const transform pose = at(-1.25 + depth, 2.0373735, 0, {0, 0, 1}, turn);
        const closest c = separation(capsule{S(0.25), S(0.5)}, box_of(8, 1, 8), pose);
        CHECK(near(cell::number(c.distance), -depth, 32));
        CHECK(near(c.normal, {-1, 0, 0}, 64));
        CHECK(near(c.on_a, {-0.75, 0, 0}, 64));
        CHECK(near(c.on_b, {-0.75 + depth, 0, 0}, 64));
    }
}

CELL_CASE("known cases: casts") {
    const auto fraction = [](const auto& a, const auto& b, const transform& from, reals displacement) {
        const auto hit = cast_shape(a, b, from, from_reals(displacement));
        REQUIRE(hit.hit);
        return cell::number(hit.fraction);
    };
    // ncollide #214: the higher one was missed.
    CHECK(near(fraction(box_of(2, 2, 2), box_of(2, 2, 2), at(10, 0), {-16, 0, 0}), 0.5, 4));
    CHECK(near(fraction(box_of(2, 3, 2), box_of(2, 2, 2), at(10, 0), {-16, 0, 0}), 0.5, 4));
    // Box2D #625: they overlap by less than a slop.
    CHECK(fraction(box_of(1, 1, 1), ball{S(0.25)}, at(0.7475, 0.25), {-1, 0, 0}) == 0);
    CHECK(fraction(box_of(1, 1, 1), ball{S(0.25)}, at(0.7475, 0.25), {1, 0, 0}) == 0);
    CHECK(near(fraction(box_of(1, 1, 1), ball{S(0.25)}, at(0.7525, 0.25), {-1, 0, 0}), 0.0025, 4));
    // Box2D #50: an overlap at the start is no way without a hit.
    physics::sweep<S, D> still, moving;
    moving.start = from_reals({0.5, 0.25, 0});
    moving.end = from_reals({4, 0.25, 0});
    const auto met = time_of_impact(box_of(1, 1, 1), still, box_of(1, 1, 1), moving);
    CHECK(met.state == physics::impact_state::overlapping);
    CHECK(met.fraction == S(0));
    // Box2D #115: they end 6.82 m apart.
    still.start = still.end = from_reals({24, -60, 0});
    still.rotation = rotation_about({0, 0, 1}, 2.95);
    moving.start = from_reals({53.474274, -50.252514, 0});
    moving.end = from_reals({54.595478, -51.083473, 0});
    moving.rotation = rotation_about({0, 0, 1}, 4.428750118453536);
    moving.turn = to_angular({0, 0, 0.26105});
    CHECK(time_of_impact(box_of(50, 10, 10), still, box_of(5, 5, 5), moving).state == physics::impact_state::separated);
    CHECK(time_of_impact(box_of(50, 10, 10), still, box_of(5, 5, 5), moving, {S(6.81), S(0.001)}).state ==
          physics::impact_state::separated);
    CHECK(time_of_impact(box_of(50, 10, 10), still, box_of(5, 5, 5), moving, {S(6.82), S(0.001)}).state ==
          physics::impact_state::hit);
}

CELL_CASE("known cases: rays along faces, onto edges, from within") {
    const auto cast = [](const auto& shape, const transform& pose, reals from, reals displacement) {
        return cast_ray(shape, pose, from_reals(from), from_reals(displacement));
    };
    // jspatial #7: in the plane of a face.
    const auto along = cast(box_of(64, 64, 64), at(64, 64), {16, 32, 0}, {240, 0, 0});
    CHECK((along.hit && near(cell::number(along.fraction), 1.0 / 15, 2) && near(along.normal, {-1, 0, 0}, 1)));
    // bvh #140: a box without any size, and a ray past it.
    CHECK(!cast(box{}, at(5.69e-39, -5000, 5000), {-5000, -5000, 5000}, {7071, 7071, 0}));
    CHECK(!cast(box_of(0, 0, 0), at(5.69e-39, -5000, 5000), {-5000, -5000, 5000}, {7071, 7071, 0}));
    CHECK(cell::number(cast(box_of(0, 0, 0), at(0, -500, 500), {-500, -500, 500}, {1000, 0, 0}).fraction) == 0.5);
    // Drake #1712: rays nearly across a face, as of a lidar.
    for (int i = -90; i <= 90; ++i) {
        const double slope = i * (1.0 / 128);
        const auto hit = cast(box_of(1, 10, 1), at(2.5, 0), {}, {8, 8 * slope, 0});
        REQUIRE(hit.hit);
        REQUIRE(near(hit.point, {2, 2 * slope, 0}, 8));
        REQUIRE(hit.normal == from_reals({-1, 0, 0}));
    }
    // Parry #183, Godot #35845: begun within, there is a hit and no normal.
    for (const reals displacement : {reals{1, 0, 0}, reals{0, -5, 0}, reals{}}) {
        for (const auto& hit :
             {cast(box_of(2, 2, 2), {}, {0.5, 0, 0}, displacement), cast(ball{S(1)}, {}, {0.5, 0, 0}, displacement),
              cast(capsule{S(1), S(1)}, {}, {0.5, 0, 0}, displacement)})
            CHECK((hit.hit && hit.fraction == S(0) && hit.normal == vec{}));
    }
}

CELL_CASE("known cases: rays down on a heightfield, at its samples, borders and diagonals") {
    // Rapier #165.
    std::vector<S> heights;
    for (int i = 0; i < 81; ++i) heights.push_back(S(0.25 * ((i * 7) % 5)));
#if CELL_DIMENSION == 2
    const auto field = physics::heightfield_geometry<S, 2>::build(heights.data(), 81, S(0.5));
    for (int i = 0; i <= 160; ++i) {
        const auto hit = cast_ray(field.shape(), transform{}, {S(0.25 * i), S(8)}, {S(0), S(-16)});
        REQUIRE(hit.hit);
        const double height = 0.5 * cell::number(heights[std::size_t(i / 2)] + heights[std::size_t((i + 1) / 2)]);
        REQUIRE(near(hit.point, {0.25 * i, height, 0}, 2));
        REQUIRE(hit.normal.y > S(0));
    }
#else
    const auto field = physics::heightfield_geometry<S, 3>::build(heights.data(), 9, 9, S(0.5), S(0.5));
    for (int i = 0; i <= 16; ++i)
        for (int k = 0; k <= 16; ++k) {
            const auto hit =
                cast_ray(field.shape(), transform{}, {S(0.25 * i), S(8), S(0.25 * k)}, {S(0), S(-16), S(0)});
            REQUIRE(hit.hit);
            // Middles of sides and of diagonals are half-way between two samples.
            const auto height_of = [&](int x, int z) { return cell::number(heights[std::size_t(z * 9 + x)]); };
            const double height = 0.5 * (height_of(i / 2, k / 2) + height_of((i + 1) / 2, (k + 1) / 2));
            REQUIRE(near(hit.point, {0.25 * i, height, 0.25 * k}, 2));
            REQUIRE(hit.normal.y > S(0));
        }
#endif
}

#if CELL_DIMENSION == 2
CELL_CASE("known cases: rays on either side of a line") {
    // Box2D #95: the normal is that of the side.
    const physics::segment<S, 2> line;
    const auto above = cast_ray(line, transform{}, {S(0.25), S(2)}, {S(0), S(-4)});
    const auto below = cast_ray(line, transform{}, {S(0.25), S(-2)}, {S(0), S(4)});
    CHECK((above.hit && above.fraction == S(0.5) && above.normal == vec{S(0), S(1)}));
    CHECK((below.hit && below.fraction == S(0.5) && below.normal == vec{S(0), S(-1)}));
    // Godot #84108: from the corner of a room, into its walls.
    const auto room = physics::chain_geometry<S, 2>::build({{-1, -1}, {-1, 1}, {1, 1}, {1, -1}}, {.loop = true});
    for (const reals displacement : {reals{-1, 0, 0}, reals{0, -1, 0}, reals{-1, -1, 0}, reals{-1, 2, 0}}) {
        CHECK(cast_ray(room.shape(), transform{}, {-1, -1}, from_reals(displacement)).hit);
        CHECK(cast_ray(room.shape(), transform{}, {S(-1 + 0x1p-10), S(-1 + 0x1p-10)}, from_reals(displacement)).hit);
    }
}
#else
CELL_CASE("known cases: boxes whose faces or edges nearly touch") {
    // FCL #415: one deep in the other, all faces parallel.
    expect(box_of(0.02, 0.33, 0.02), box_of(0.452, 0.27, 0.42), at(0.067, -0.629605057504326826 + 0.772, -0.105),
           -0.115, {0, 0, -1});
    // FCL #399: sheets that are almost parallel.
    const transform sheet = at(0.29526406526565551758, -0.013230856508016586304, 0, {0, 0, 1},
                               std::atan2(-0.99504432079443971837, -0.099432387353076273628));
    const transform rod = at(0.22759585694545214629, 0.14974093549228112421, 0, {0, 0, 1},
                             std::atan2(-0.099215354901756730444, 0.99506598442099225554));
    expect(box_of(0.23768037557601928711, 0.15702305734157562256, 0.25),
           box_of(0.010000000000000000208, 0.78165709972381591797, 0.25), relative(sheet, rod), -3.38106439992e-5,
           to_reals(inverse_rotate(sheet.rotation, from_reals({-0.99506598442, 0.0992153549, 0}))));
    // FCL #390: 17 nm apart, tilted by 1e-7.
    const transform crate{from_reals({0.63499979627350811029, -0.48500002215636439651, 0.1553146458339641356}),
                          rotation_of(std::vector<S>{S(-3.31010088832e-8), S(1.26699616181e-8), S(0.707106792015158793),
                                                     S(0.707106770357935323)})};
    const transform wall = at(0.8, -0.4575, 0, {0, 0, 1}, M_PI / 2);
    expect(box_of(0.03, 0.12, 0.1), box_of(0.025, 0.35, 1.845), relative(crate, wall), 1.70821917097e-8, {}, 2);
    // mujoco_warp #1526: concentric cubes, 0.25 mm in each other.
    expect(box_of(0.2, 0.2, 0.2), box_of(0.2, 0.2, 0.2), at(0, 0, 0.19975), -0.00025, {0, 0, 1});
    // mujoco #3476: no point of flush boxes is a box's width deep.
    using any = physics::any_shape<S, 3, physics::box>;
    using narrow = physics::best_per_pair::in<S, 3, physics::box>;
    const any brick = box_of(0.142, 0.071, 0.04);
    for (const double tilt : {0.0, 1e-3, 1e-5, 1e-7}) {
        const physics::narrowphase_query<S, 3, physics::box> query{&brick, &brick,
                                                                   at(0, 0.071 - 0.00005, 0.001, {0, 0, 1}, tilt)};
        physics::manifold_list<S, 3> found;
        narrow::collide(&query, 1, S(0.001), found);
        REQUIRE(found.size() == 1);
        CHECK(found[0].contact.count == 4);
        CHECK(near(found[0].contact.normal, {0, 1, 0}, 1 + 2 * tilt / epsilon));
        for (int i = 0; i < found[0].contact.count; ++i) {
            const double depth = cell::number(found[0].contact.points[i].separation);
            CHECK(std::abs(depth + 0.00005) <= 0.072 * tilt + 64 * epsilon);
        }
    }
    // libccd #17: where a small box touches a large one.
    const closest c = separation(box_of(5, 5, 5), box_of(0.2, 0.2, 0.2), at(1.75, 2.59, -2.0));
    CHECK(near(cell::number(c.distance), -0.01, 64));
    CHECK((std::abs(cell::number(c.on_a.x) - 1.75) <= 0.1 + 64 * epsilon && near(cell::number(c.on_a.y), 2.5, 64) &&
           std::abs(cell::number(c.on_a.z) + 2) <= 0.1 + 64 * epsilon));
}

CELL_CASE("known cases: hulls with many coplanar points, triangles and needles") {
    // openGJK #54: a cube without its corners, and points around it.
    std::vector<reals> points;
    const double far = std::sqrt(2) - 1, near_by = far * far;
    for (int signs = 0; signs < 8; ++signs)
        for (int axis = 0; axis < 3; ++axis) {
            reals p;
            for (int i = 0; i < 3; ++i) p[i] = (signs >> i & 1 ? 1 : -1) * (i == axis ? near_by : far);
            points.push_back(p);
        }
    const auto stone = hull_of(points);
    expect(stone.shape(), ball{S(0)}, {}, -far, {});
    expect(stone.shape(), ball{S(0)}, at(1, 1, 1), (3 - (2 * far + near_by)) / std::sqrt(3), {1, 1, 1});
    expect(stone.shape(), ball{S(0)}, at(1, 1, 0), std::sqrt(2) * (1 - far), {1, 1, 0});
    expect(stone.shape(), stone.shape(), at(0.125, 2 * far + 0.0625, 0), 0.0625, {0, 1, 0});
    expect(stone.shape(), stone.shape(), at(0.125, 2 * far - 0.0625, 0), -0.0625, {0, 1, 0});
    // DOLFINx #3653: two points of the hull are almost the middles of its edges.
    const reals middle{46, 40, 18};
    const auto rock = hull_of({reals{46.0659, 38.6251, 16.3637} - middle, reals{44.2764, 42.3867, 18.239} - middle,
                               reals{50.0397, 38.4649, 19.9843} - middle, reals{47.1963, 40.4563, 19.1057} - middle,
                               reals{48.0266, 38.5593, 18.2475} - middle, reals{45.1735, 40.495, 17.3336} - middle,
                               reals{48.0415, 40.4456, 18.1963} - middle});
    const reals tip = reals{44.2919, 39.7508, 18.8208} - middle;
    expect(rock.shape(), ball{S(0)}, at(tip.x, tip.y, tip.z), 1.8134526453385,
           reals{44.2919, 39.7508, 18.8208} - reals{45.32838825, 40.76396152, 17.73093471}, 4);
    // openGJK #3, gjk.c #5: triangles in one plane: across, the same, nearly the same, beside each other.
    const triangle flat{vec{}, {S(4), S(0), S(0)}, {S(0), S(3), S(0)}};
    expect(flat, flat, {}, 0, {0, 0, 0}, 4);
    expect(flat, flat, at(1e-6, 1e-6, 0), 0, {0, 0, 0}, 4);
    expect(flat, flat, at(1, 0.5, 0, {0, 0, 1}, 1), 0, {0, 0, 0}, 4);
    expect(flat, flat, at(4.25, 0), 0.25, {1, 0, 0}, 4);
    // Coal #53: parallel ones, close to each other.
    expect(flat, flat, at(0.5, 0.25, 0x1p-10), 0x1p-10, {0, 0, 1}, 4);
    // A needle, thinner than its length by a million.
    const triangle needle{{S(-500), S(0), S(0)}, {S(500), S(0), S(0)}, {S(0), S(0.001), S(0)}};
    expect(needle, ball{S(0.5)}, at(300, 0, 0.75), 0.25, {0, 0, 1}, 500);
    expect(needle, ball{S(0.5)}, at(-200, -0.25, 0), -0.25, {0, -1, 0}, 500);
    // newton #3773: a small can, all but in the plane of a large triangle: 59 m.
    const triangle ground{{S(-60), S(0), S(-60)}, {S(60), S(0), S(-60)}, {S(0), S(0), S(80)}};
    for (const double height : {0.0003, 0.03})
        expect(ground, cylinder{S(0.0625), S(0.25)}, at(47, height, -40, {0, 0, 1}, M_PI / 2), height - 0.0625,
               {0, 1, 0}, 80);
}

CELL_CASE("known cases: cylinders and cones") {
    const double turn = M_PI / 2;
    const reals y{0, 1, 0}, z{0, 0, 1};
    expect(cylinder{S(1), S(0.25)}, cylinder{S(1), S(0.25)}, {}, -0.5, {});
    expect(cylinder{S(0.25), S(1)}, cylinder{S(0.25), S(1)}, {}, -0.5, {});
    // FCL #319: beside a plate.
    const transform plate = at(0.8, -0.385, 0.735, z, turn), drum = at(0.4, -0.4, 0.93, y, -turn);
    expect(box_of(0.05, 0.39, 1.47), cylinder{S(0.09), S(0.18)}, relative(plate, drum), 0.025, {0, 1, 0}, 2);
    // FCL #391: a ball that is in it by 0.15 um.
    expect(cylinder{S(0.325), S(0.03)}, ball{S(0.055)},
           relative(at(0, 0, 0, y, -turn), at(-0.0580205982, -0.0621175025, 0.2766236576)), -1.533394127e-7, {});
    // FCL #529: rods that cross.
    const double lean = std::atan2(0.070736898150081176095, 0.99749500812791291882);
    expect(cylinder{S(0.5), S(0.01)}, cylinder{S(0.5), S(0.01)},
           relative(at(0.24874750406395645941, 0, -0.035368449075040588048, y, lean),
                    at(-0.24874750406384882329, 0, -0.035368449075040588048, y, -lean)),
           -0.02, {});
    // Drake #21234: a rim that kisses an edge.
    const transform can = at(0.20238033346825459735, 0.027845683594011010065, 0.3114233939246693339, z,
                             std::atan2(-0.94939688083050233214, -0.31407891153229777759));
    expect(cylinder{S(0.085), S(0.041)}, box_of(0.3, 0.6, 0.016), relative(can, at(0.4, 0, 0.26885)), 0, {});
    // By certificates.hpp, which found normals that part them worse by 0.2 m: corners that touch a cone's side and a
    // cylinder's rim, within a few roundings.
    const triangle shard{from_reals({-0.056192891921601901, 0.055931205974521836, 0.30924006499562734}),
                         from_reals({0.086455638439032159, -0.20578844077202343, -0.021370520675451986}),
                         from_reals({0.047164438211688628, 0.22170934766464115, -0.15771544397220588}), S(0)};
    const transform stump{from_reals({0.60088423473429597, -0.44981130304494499, -0.41848428185730668}),
                          rotation_of(std::vector<S>{S(0.44429454513501271), S(0.46632576493775435),
                                                     S(0.45051352072102635), S(-0.6182072514667194)})};
    expect(shard, cone{S(0.27125381557910083), S(0.42599146827776291), S(0.63898720241664431), S(0)}, stump, 0, {});
    const physics::segment<S, 3> stick{from_reals({-0.37916505975198739, 0.36013107092124441, 0.21436966070429975}),
                                       from_reals({0.28378127625497551, -0.08422881824773909, -0.14523297857765721}),
                                       S(0)};
    const transform lying_drum{from_reals({0.5560321076909589, 0.14303472770709003, -0.18812454823167721}),
                               rotation_of(std::vector<S>{S(0.084064559996490568), S(0.51902863949607825),
                                                          S(0.67022742374906574), S(-0.52377249029529682)})};
    expect(stick, cylinder{S(0.28690759402065025), S(0.21282141287524234), S(0)}, lying_drum, 0, {});
    // On a rim many normals would do; each must part them as far as they are apart.
    const auto parts = [](const auto& a, const auto& b, const transform& pose) {
        const vec n = separation(a, b, pose).normal;
        const vec on_a = support(a, n), on_b = pose * support(b, inverse_rotate(pose.rotation, -n));
        CHECK(std::abs(dot(to_reals(n), to_reals(on_b) - to_reals(on_a))) <= 64 * epsilon + 1e-8);
    };
    parts(shard, cone{S(0.27125381557910083), S(0.42599146827776291), S(0.63898720241664431), S(0)}, stump);
    parts(stick, cylinder{S(0.28690759402065025), S(0.21282141287524234), S(0)}, lying_drum);
    // Coal #351: a ball beside the middle of a flat cylinder, in mm.
    expect(cylinder{S(50), S(136)}, ball{S(55)}, at(-45.449, 140.834, 128.932), -0.06106688262867,
           {0, 140.834, 128.932}, 200);
    // ncollide #157: it stands at the corner of a wall.
    expect(cylinder{S(0.925), S(0.5)}, box_of(1.5, 0.1, 1), at(-0.175, -0.53, -0.52), -0.01958351402142744,
           {0, -0.48, -0.02}, 2);
    // The tip of a cone on a face, and in it.
    for (const double gap : {0.0, -0.125, 0.125})
        expect(box_of(2, 2, 2), cone{S(0.5), S(0.5), S(0)}, at(0.25, 1.5 + gap, 0.25, z, -turn), gap, {0, 1, 0});
}

CELL_CASE("known cases: casts of and on round shapes") {
    // Jolt #2103: a cylinder that all but touches a capsule.
    const rotation upright = rotation_about({0, 0, 1}, M_PI / 2);
    const vec start = from_reals({-0.951660156, -2.09155273, -7.63574218});
    const vec displacement = from_reals({0.00244140625, -0.0068359375, 0.0029296875});
    const physics::capsule<S, 3> post{S(2.03114343), S(7.19732189)};
    const transform pose = relative(transform{{}, upright}, transform{start, upright});
    const auto touch = cast_shape(post, cylinder{S(0.3), S(0.4975)}, pose, inverse_rotate(upright, displacement));
    REQUIRE(touch.hit);
    CHECK(cell::number(touch.fraction) <= 0.001);
    CHECK(size(to_reals(upright * touch.normal) - reals{-0.1236754687625, 0, -0.9923227188905}) <= 1e-3);
    CHECK(size(to_reals(upright * touch.point) - reals{-0.89013, to_reals(upright * touch.point).y, -7.14206}) <= 1e-2);
    // Bullet #596: it begins in the box, by 0.26 m, and the point is on the box beside it.
    const transform slab{from_reals({0, 0, 120}),
                         normalized(rotation_of({S(-0.057141), S(0.572179), S(0.040011), S(0.817157)}))};
    const transform from = relative(slab, at(-27.449842, -2.994380, 109.886520));
    const vec along = inverse_rotate(slab.rotation, from_reals({-0.079466, -0.610439, -0.333244}));
    const auto hit = cast_shape(box_of(39.839996, 1.84, 99.839996), ball{S(0.45)}, from, along);
    REQUIRE(hit.hit);
    CHECK(hit.fraction == S(0));
    CHECK(near(hit.normal, {0, 1, 0}, 64));
    CHECK(near(hit.point, {to_reals(from.position).x, 0.92, to_reals(from.position).z}, 64));
    // bepuphysics2 #253, OSPRay #482, aardvark #123: rays within, across and along a cylinder.
    const cylinder drum{S(2), S(3)};
    const auto ray = [&](reals p, reals w) { return cast_ray(drum, transform{}, from_reals(p), from_reals(w)); };
    CHECK((ray({}, {1, 0, 0}).hit && ray({}, {1, 0, 0}).fraction == S(0)));
    CHECK((ray({}, {0, 0, 1}).hit && ray({}, {0, 0, 1}).fraction == S(0)));
    CHECK(near(ray({1, 0, 8}, {0, 0, -10}).point, {1, 0, 3}, 8));
    CHECK(near(ray({1, 0, 8}, {0, 0, -10}).normal, {0, 0, 1}, 8));
    CHECK(near(ray({8, 1, 2}, {-10, 0, 0}).point, {2, 1, 2}, 8));
    CHECK(near(ray({8, 1, 2}, {-10, 0, 0}).normal, {1, 0, 0}, 8));
    CHECK(!ray({8, 3.01, 0}, {-16, 0, 0}));
}

CELL_CASE("known cases: rays on the edges and corners of meshes") {
    using mesh = physics::mesh_geometry<S, 3>;
    const auto build = [](const std::vector<reals>& points, const std::vector<std::uint32_t>& triangles,
                          bool two_sided = false) {
        std::vector<vec> p;
        for (const reals& q : points) p.push_back(from_reals(q));
        return mesh::build(p.data(), static_cast<std::uint32_t>(p.size()), triangles.data(),
                           static_cast<std::uint32_t>(triangles.size() / 3), {.two_sided = two_sided});
    };
    // Oblikovati #2146, trimesh #1766: on the diagonal of a square.
    const mesh square = build({{-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}}, {0, 1, 2, 0, 2, 3});
    const double t = 10 / 0.9024725;
    const vec sweep_against = from_reals(reals{0.30458447, 0.30458447, -0.9024725} * 16);
    const auto seam = cast_ray(square.shape(), transform{}, from_reals({0, 0, 10}), sweep_against);
    REQUIRE(seam.hit);
    CHECK(near(seam.point, reals{0.30458447 * t, 0.30458447 * t, 0}, 64));
    for (int x = -20; x <= 20; ++x)
        for (int y = -20; y <= 20; ++y) {
            const reals target{0.25 * x, 0.25 * y, 0};
            for (const reals from : {reals{0, 0, 10}, reals{8, -3, 1}, reals{0.25 * x, 0.25 * y, 3}}) {
                const vec begin = from_reals(from), displacement = (from_reals(target) - begin) * S(2);
                const auto hit = cast_ray(square.shape(), transform{}, begin, displacement);
                REQUIRE_MESSAGE(hit.hit, x << " " << y);
                REQUIRE(near(hit.point, target, 64));
                REQUIRE(near(hit.normal, {0, 0, 1}, 64));
            }
        }
    // three-mesh-bvh #684: onto the lower edge of a triangle that stands.
    const mesh standing = build({{-1.3836679458618164, -4.480311870574951, 2},
                                 {3.9273109436035156, 5.897944450378418, 0},
                                 {-1.3836679458618164, -4.480311870574951, 0}},
                                {0, 1, 2}, true);
    const auto edge =
        cast_ray(standing.shape(), transform{}, from_reals({-0.028221702575683627, -2.5058889150619503, 0}),
                 from_reals({-0.16852837373762, 0.9856968028990217, 0}));
    REQUIRE(edge.hit);
    CHECK(near(cell::number(edge.fraction), 0.512747213598814, 128));
    // ncollide #335: what skims a ridge never meets the inside of the roof.
    const mesh roof = build({{-2, 0, -4}, {0, 1, -4}, {2, 0, -4}, {-2, 0, 4}, {0, 1, 4}, {2, 0, 4}},
                            {0, 3, 4, 0, 4, 1, 1, 4, 5, 1, 5, 2});
    for (const double z : {0.0, 0.25, 3.5}) {
        const vec displacement = from_reals({16, 0, 0});
        const auto hit = cast_ray(roof.shape(), transform{}, from_reals({-8, 1, z}), displacement);
        REQUIRE(hit.hit);
        CHECK(near(hit.point, {0, 1, z}, 64));
        CHECK(!(dot(hit.normal, displacement) > S(0)));
        CHECK(!cast_ray(roof.shape(), transform{}, from_reals({-8, 1.001, z}), displacement));
    }
    // Godot #84108: from where a floor and a wall meet, into the wall.
    const mesh room =
        build({{0, 0, 0}, {4, 0, 0}, {4, 0, 4}, {0, 0, 4}, {0, 4, 0}, {0, 4, 4}}, {0, 3, 2, 0, 2, 1, 0, 4, 5, 0, 5, 3});
    for (const double off : {0.0, 0x1p-20, 0x1p-10})
        for (const reals displacement :
             {reals{-1, 0, 0}, reals{0, -1, 0}, reals{-1, -1, 0}, reals{-1, 2, 0}, reals{-2, 1, 1}})
            CHECK(cast_ray(room.shape(), transform{}, from_reals({off, off, 2}), from_reals(displacement)).hit);
}
#endif

}  // namespace known_cases_laws
}  // namespace
