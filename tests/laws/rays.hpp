// Laws of rays: closed forms of round solids against what points lie within them, and shapes of many parts against all
// their parts, one by one.
#pragma once

#include <algorithm>
#include <string>

#include "reals.hpp"

namespace {
namespace rays_laws {

using doubles = physics::vec<double, D>;
using local_ray = physics::detail::local_ray<D>;
using local_hit = physics::detail::local_hit<D>;

/// As S holds it. Through the library's own way, past an error of gcc that forgets such roundings.
inline double rounded(double x) { return physics::detail::to_double(S(x)); }
inline reals rounded(reals r) { return {rounded(r.x), rounded(r.y), rounded(r.z)}; }
inline doubles to_doubles(reals r) {
    doubles v;
    for (int i = 0; i < D; ++i) v[i] = r[i];
    return v;
}
const physics::aabb<double, D> everywhere{doubles::filled(-1e300), doubles::filled(1e300)};
inline reals to_reals_of(const doubles& v) {
    reals r;
    for (int i = 0; i < D; ++i) r[i] = v[i];
    return r;
}

#if CELL_DIMENSION == 3
/// A frustum by its half length and the radii of its lower and its upper end.
struct frustum {
    double half, low, high;

    [[nodiscard]] double size() const { return half + std::fmax(low, high); }
    [[nodiscard]] double slope() const { return (high - low) / (2 * half); }
    /// A convex function, negative within; outside it is at most the distance.
    [[nodiscard]] double depth(reals p) const {
        const double lean = 1 / std::hypot(1.0, slope()), radius = 0.5 * (low + high) + slope() * p.x;
        return std::fmax(std::abs(p.x) - half, (std::hypot(p.y, p.z) - radius) * lean);
    }
    /// How far it reaches along a direction.
    [[nodiscard]] double reach(reals n) const {
        const double across = std::hypot(n.y, n.z);
        return std::fmax(low * across - half * n.x, high * across + half * n.x);
    }
    template <class F>
    auto with_shape(F&& f) const {
        if (low == high) return f(physics::cylinder<S, 3>{S(half), S(low)});
        return f(physics::cone<S, 3>{S(half), S(low), S(high)});
    }
    [[nodiscard]] static frustum random(cell::dice& dice, double scale) {
        const auto number = [&](double from, double to) { return rounded(scale * dice.number(from, to)); };
        frustum f{number(0.1, 0.5), number(0.1, 0.5), number(0.1, 0.5)};
        switch (dice.below(6)) {
            case 0: f.high = f.low; break;
            case 1: f.high = 0; break;
            case 2: f.low = 0; break;
            case 3: f.half = number(0.001, 0.002); break;
            case 4: f.low = number(0.001, 0.002); break;
            default: break;
        }
        return f;
    }
};
/// The law that a ray breaks; empty if it keeps all.
inline std::string broken_law(const frustum& f, const physics::ray_hit<S, 3>& hit, reals from, reals displacement) {
    const auto says = [](const char* what, double x, double y) {
        char text[120];
        std::snprintf(text, sizeof text, "%s: %.17g, %.17g", what, x, y);
        return std::string(text);
    };
    const double reach = size(from) + size(displacement) + f.size();
    const double tolerance = 2 * epsilon * size(displacement) + 4e-15 * reach;
    const auto depth = [&](double t) { return f.depth(from + displacement * t); };
    if (!hit) {
        double low = 0, high = 1;
        for (int i = 0; i < 200; ++i) {
            const double a = low + (high - low) / 3, b = high - (high - low) / 3;
            if (depth(a) < depth(b)) high = b;
            else low = a;
        }
        const double least = std::fmin(depth(low), std::fmin(depth(0), depth(1)));
        return least < -tolerance ? says("missed", least, tolerance) : "";
    }
    const double t = cell::number(hit.fraction);
    const reals n = to_reals(hit.normal);
    if (!(t >= 0 && t <= 1)) return says("fraction", t, 0);
    if (size(n) == 0) return t == 0 && depth(0) <= tolerance ? "" : says("no normal", t, depth(0));
    if (!(std::abs(size(n) - 1) <= 8 * epsilon)) return says("unit", size(n), t);
    if (std::abs(depth(t)) > tolerance) return says("not on the surface", depth(t), t);
    for (int k = 0; k < 8; ++k)
        if (depth(t * k / 8) < -tolerance) return says("entered before", depth(t * k / 8), t * k / 8);
    if (dot(unit(n), displacement) > (4 * epsilon + 1e-8) * size(displacement))
        return says("leaves along the normal", t, dot(n, displacement));
    // A plane with this normal through the point has all of the solid behind it.
    const double above = f.reach(unit(n)) - dot(unit(n), from + displacement * t);
    const double lean = 8 * epsilon * f.size() + 64 * tolerance * f.size() / std::fmax(f.half, 1e-300);
    return above > tolerance + lean ? says("normal", above, t) : "";
}
/// From somewhere, or from within, or along the axis or a side, towards a point of it or past it.
inline void random_ray(const frustum& f, cell::dice& dice, int i, reals& from, reals& displacement) {
    const double angle = dice.number(0, 2 * M_PI), x = dice.number(-1, 1) * f.half;
    const double radius = 0.5 * (f.low + f.high) + f.slope() * x;
    const reals side{x, radius * std::cos(angle), radius * std::sin(angle)};
    const reals out = unit({-f.slope(), std::cos(angle), std::sin(angle)});
    const reals along = unit({2 * f.half, (f.high - f.low) * std::cos(angle), (f.high - f.low) * std::sin(angle)});
    reals direction = random_direction(dice), through = side * dice.number(0, 1.2);
    const double off[] = {0, 1e-9, -1e-9, 1e-5, -1e-5, 1e-2, -1e-2};
    if (i % 4 == 1) direction = unit(cross(out, direction)), through = side + out * (f.size() * off[dice.below(7)]);
    if (i % 8 == 2) direction = along, through = side + out * (f.size() * off[dice.below(7)]);
    if (i % 8 == 6) direction = {dice.below(2) ? 1.0 : -1.0, 0, 0};
    // An end's rim.
    if (i % 8 == 3)
        through = dice.below(2) ? reals{-f.half, f.low * std::cos(angle), f.low * std::sin(angle)}
                                : reals{f.half, f.high * std::cos(angle), f.high * std::sin(angle)};
    const double far = i % 11 == 0 ? 1e4 : dice.number(0, 4) * f.size(), onwards[] = {0.5, 1, 1.25, 2};
    from = rounded(through - direction * far);
    displacement = rounded(direction * (far * onwards[dice.below(4)]));
    if (i % 50 == 0) displacement = {};
}

CELL_CASE("rays: cylinders and cones are met where points are first within them") {
    cell::dice dice(101);
    int hits = 0;
    for (int i = 0; i < cell::draws(200000); ++i) {
        const frustum f = frustum::random(dice, i % 5 == 3 ? 1e-2 : 1);
        reals from, displacement;
        random_ray(f, dice, i, from, displacement);
        const auto hit = f.with_shape([&](const auto& shape) {
            return cast_ray(shape, transform{}, from_reals(from), from_reals(displacement));
        });
        const std::string broken = broken_law(f, hit, from, displacement);
        if (!broken.empty())
            FAIL_CHECK(broken << "\n"
                              << f.half << " " << f.low << " " << f.high << " from " << from.x << " " << from.y << " "
                              << from.z << " way " << displacement.x << " " << displacement.y << " " << displacement.z);
        hits += hit.hit;
    }
    CHECK(hits > cell::draws(60000));
    CHECK(hits < 160000);
}

CELL_CASE("rays: cylinders and cones are met where the general method says") {
    cell::dice dice(102);
    int hits = 0;
    for (int i = 0; i < cell::draws(20000); ++i) {
        const frustum f = frustum::random(dice, 1);
        reals from, displacement;
        random_ray(f, dice, i, from, displacement);
        f.with_shape([&](const auto& shape) {
            const local_ray ray{to_doubles(from), to_doubles(displacement)};
            const local_hit general = physics::detail::cast_on_core<double>(ray, core_of(shape));
            const local_hit closed = cast_on(shape, ray);
            // Those that graze it may be judged either way.
            if (closed.hit != general.hit) {
                const double t = closed.hit ? closed.fraction : general.fraction;
                REQUIRE(std::abs(f.depth(from + displacement * t)) <= 1e-8 * (f.size() + 1e-6 * size(displacement)));
                return;
            }
            hits += closed.hit;
            if (!closed.hit) return;
            const double between = std::abs(closed.fraction - general.fraction) * size(displacement);
            const double sine = std::abs(dot(to_reals_of(closed.normal), unit(displacement)));
            REQUIRE((size(displacement) == 0 || between * sine <= 1e-8 * (f.size() + 1e-6 * size(displacement)) ||
                     sine < 1e-3));
        });
    }
    CHECK(hits > cell::draws(6000));
}

CELL_CASE("rays: exact points of cylinders and cones") {
    const auto check = [](const auto& shape, reals from, reals displacement, double fraction, reals normal) {
        const auto hit = cast_ray(shape, transform{}, from_reals(from), from_reals(displacement));
        REQUIRE(hit.hit);
        CHECK(near(cell::number(hit.fraction), fraction, 2));
        CHECK(near(hit.normal, normal, 4));
        CHECK(near(hit.point, from + displacement * fraction, 8));
    };
    const auto misses = [](const auto& shape, reals from, reals displacement) {
        CHECK(!cast_ray(shape, transform{}, from_reals(from), from_reals(displacement)).hit);
    };
    const physics::cylinder<S, 3> drum{S(2), S(5)};
    check(drum, {1, 8, 0}, {0, -8, 0}, 0.375, {0, 1, 0});
    check(drum, {1, 3, 10}, {0, 0, -12}, 0.5, {0, 0.6, 0.8});
    check(drum, {8, 4, 3}, {-12, 0, 0}, 0.5, {1, 0, 0});
    check(drum, {-6, 0, 0}, {8, 1, 1}, 0.5, {-1, 0, 0});
    check(drum, {0, 0, 0}, {8, 0, 0}, 0, {});
    misses(drum, {2, 3, 4}, {1, 1, 1});
    misses(drum, {-2, 0, 0}, {});
    check(drum, {-2, 0, 0}, {8, 1, 1}, 0, {-1, 0, 0});
    check(drum, {1, 3, 4}, {1, -3, -4}, 0, {0, 0.6, 0.8});
    misses(drum, {1, 3, 4}, {1, 4, -3});
    // Along the side, along an end, and past them.
    check(drum, {-4, 3, 4}, {8, 0, 0}, 0.25, {-1, 0, 0});
    check(drum, {2, -8, 0}, {0, 16, 0}, 0.1875, {0, -1, 0});
    misses(drum, {-4, 3, 4.00001}, {8, 0, 0});
    misses(drum, {2.00001, -8, 0}, {0, 16, 0});
    misses(drum, {8, 0, 0}, {-5.9999, 0, 0});
    misses(drum, {8, 0, 0}, {8, 0, 0});
    misses(drum, {2.0001, 0, 0}, {});
    // A tip at x = 4, a base of the radius 3 at x = -4; and the other way round.
    const double lean = std::sqrt(73.0);
    const physics::cone<S, 3> hat{S(4), S(3), S(0)}, pit{S(4), S(0), S(3)};
    check(hat, {0, 4, 0}, {0, -4, 0}, 0.625, {3 / lean, 8 / lean, 0});
    check(pit, {0, 4, 0}, {0, -4, 0}, 0.625, {-3 / lean, 8 / lean, 0});
    check(hat, {-8, 1, 1}, {16, 0, 0}, 0.25, {-1, 0, 0});
    check(pit, {8, 1, 1}, {-16, 0, 0}, 0.25, {1, 0, 0});
    // Steeper than the side, so that the line meets both halves of the endless cone; and along a side.
    check(hat, {8, 1.5, 0}, {-16, 0, 0}, 0.5, {3 / lean, 8 / lean, 0});
    check(pit, {-8, 0, 1.5}, {16, 0, 0}, 0.5, {-3 / lean, 0, 8 / lean});
    check(hat, {8, 3.5, 0}, {-16, -4, 0}, 0.5, {3 / lean, 8 / lean, 0});
    misses(hat, {8, 1.5, 0}, {-7.9, 0, 0});
    misses(hat, {8, 0, 0}, {1, 0, 0});
    misses(hat, {8, -1.4, 0}, {-16, 0, 9.1});
    misses(pit, {-8, 0, 0.1}, {3, 0, 0});
    // Onto the tip.
    check(hat, {8, 0, 0}, {-16, 0, 0}, 0.25, {1, 0, 0});
    check(pit, {-8, 0, 0}, {16, 0, 0}, 0.25, {-1, 0, 0});
    check(hat, {4, 0, 0}, {-1, 0, 0}, 0, {1, 0, 0});
    // A frustum, from afar.
    const physics::cone<S, 3> bucket{S(2), S(1), S(3)};
    check(bucket, {0, 1002, 0}, {0, -1024, 0}, 1000.0 / 1024, {-1 / std::sqrt(5), 2 / std::sqrt(5), 0});
    misses(bucket, {-2, 1002, 1.01}, {0, -1024, 0});
}
#endif

/// Of a point on a shape's surface, given exactly, and the outward normal there: rays that begin at it.
template <class Shape>
void begin_on(const Shape& shape, reals at, reals out, bool is_solid = true) {
    const auto cast = [&](reals from, reals displacement) {
        return cast_ray(shape, transform{}, from_reals(from), from_reals(displacement));
    };
    CAPTURE(at.x);
    CAPTURE(at.y);
    // A tangent that is exact, as the normal is but for its length.
    reals along = {-out.y, out.x, 0};
    if (size(along) == 0) along = {1, 0, 0};
    for (const double length : {0.0625, 1.0, 64.0}) {
        for (const double lean : {0.0, 1.0, -2.0}) {
            const auto in = cast(at, (along * lean - out) * length);
            REQUIRE(in.hit);
            CHECK(cell::number(in.fraction) == 0);
            CHECK(near(in.normal, unit(out), 8));
            CHECK(near(in.point, at, 4));
            CHECK(!cast(at, (along * lean + out) * length).hit);
        }
        CHECK(!cast(at, along * length).hit);
        CHECK(!cast(at, along * -length).hit);
    }
    CHECK(!cast(at, {}).hit);
    if (!is_solid) return;
    const reals within = at - out * 0.0625;
    for (const reals displacement : {reals{}, out, out * -1, along * 0.25}) {
        const auto hit = cast(within, displacement);
        CHECK(hit.hit);
        CHECK(cell::number(hit.fraction) == 0);
        CHECK(hit.normal == vec{});
    }
}
CELL_CASE("rays: one that begins on a surface enters or misses, one that begins within has no normal") {
    begin_on(physics::ball<S, D>{S(2)}, {0, 2, 0}, {0, 1, 0});
    begin_on(physics::ball<S, D>{S(5)}, {3, -4, 0}, {3, -4, 0});
    begin_on(physics::capsule<S, D>{S(2), S(1)}, {1, 1, 0}, {0, 1, 0});
    begin_on(physics::capsule<S, D>{S(2), S(1)}, {-2, -1, 0}, {0, -1, 0});
    begin_on(physics::capsule<S, D>{S(2), S(5)}, {5, 4, 0}, {3, 4, 0});
    begin_on(physics::capsule<S, D>{S(2), S(1)}, {-3, 0, 0}, {-1, 0, 0});
    const physics::box<S, D> cube{vec::filled(S(1))};
    begin_on(cube, {0.5, 1, 0}, {0, 1, 0});
    begin_on(cube, {-1, 0.25, 0}, {-1, 0, 0});
    begin_on(physics::halfspace<S, D>{}, {3, 0, 0}, {0, 1, 0});
    std::vector<vec> corners;
    for (int i = 0; i < (1 << D); ++i) {
        vec c;
        for (int k = 0; k < D; ++k) c[k] = S((i >> k & 1) != 0 ? 1 : -1);
        corners.push_back(c);
    }
    const auto die = physics::hull_geometry<S, D>::build(corners.data(), static_cast<std::uint32_t>(corners.size()));
    begin_on(die.shape(), {0.5, 1, 0}, {0, 1, 0});
    begin_on(die.shape(), {1, -0.25, 0}, {1, 0, 0});
    const auto pair = physics::compound_geometry<S, D>::build({{cube, {}}, {cube, from_reals({8, 0.5, 0})}});
    begin_on(pair.shape(), {8.5, 1.5, 0}, {0, 1, 0});
    std::vector<S> heights(D == 2 ? 5 : 25, S(1));
#if CELL_DIMENSION == 2
    const auto field = physics::heightfield_geometry<S, 2>::build(heights.data(), 5, S(1));
    const auto both = physics::heightfield_geometry<S, 2>::build(heights.data(), 5, S(1), {.two_sided = true});
#else
    begin_on(physics::cylinder<S, 3>{S(2), S(5)}, {1, 3, 4}, {0, 3, 4});
    begin_on(physics::cylinder<S, 3>{S(2), S(5)}, {2, 1, 1}, {1, 0, 0});
    begin_on(physics::cone<S, 3>{S(1), S(2), S(0)}, {0, 1, 0}, {1, 1, 0});
    begin_on(physics::cone<S, 3>{S(1), S(2), S(0)}, {-1, 1, 0}, {-1, 0, 0});
    const auto field = physics::heightfield_geometry<S, 3>::build(heights.data(), 5, 5, S(1), S(1));
    const auto both = physics::heightfield_geometry<S, 3>::build(heights.data(), 5, 5, S(1), S(1), {.two_sided = true});
#endif
    const double z = D == 2 ? 0 : 1.25;
    for (const double x : {1.5, 2.0}) begin_on(field.shape(), {x, 1, z}, {0, 1, 0}, false);
    for (const double way : {1.0, -1.0})
        CHECK(!cast_ray(both.shape(), transform{}, from_reals({1.5, 1, z}), from_reals({0, way, 0})).hit);
}

/// A shape with the same parts as another, which rays search only by the box around them.
template <class Shape>
struct without_walk {
    using scalar = S;
    Shape shape;
    S radius{};
};
template <class Shape, class F>
void each_part(const without_walk<Shape>& s, const physics::aabb<double, D>& box, F&& f) {
    each_part(s.shape, box, f);
}
/// The same of compounds.
struct table_without_walk {
    using scalar = S;
    physics::compound<S, D> shape;
};
template <class F>
void each_child(const table_without_walk& s, const physics::aabb<double, D>& box, F&& f) {
    each_child(s.shape, box, f);
}

/// Checks that a ray meets what it meets of all the parts within its box, one by one.
template <class Shape, class Plain>
local_hit meet(const Shape& shape, const Plain& plain, reals from, reals displacement) {
    const local_ray ray{to_doubles(from), to_doubles(displacement)};
    const local_hit hit = cast_on(shape, ray), all = cast_on(plain, ray);
    INFO(from.x << " " << from.y << " " << from.z << " way " << displacement.x << " " << displacement.y << " "
                << displacement.z);
    REQUIRE(hit.hit == all.hit);
    if (hit.hit) REQUIRE(hit.fraction == all.fraction);
    if (hit.hit) REQUIRE(hit.normal == all.normal);
    return hit;
}
/// The first hit on any part by GJK.
template <class Plain>
local_hit meet_by_gjk(const Plain& plain, reals from, reals displacement) {
    const doubles origin = to_doubles(from);
    local_hit first;
    physics::detail::each_piece(
        plain, everywhere, [&](const auto& part) { return physics::detail::faces(part, origin); },
        [&](const auto& core, const auto& axes, const doubles& at, std::uint32_t) {
            const local_ray ray{transposed_times(axes, origin - at), transposed_times(axes, to_doubles(displacement))};
            const local_hit hit = physics::detail::cast_on_core<double>(ray, core);
            if (hit.hit && (!first.hit || hit.fraction < first.fraction)) first = hit;
        });
    return first;
}
/// Rays in all directions; along axes; from corners, along edges and sides, onto corners and edges; without length.
/// `corners` are some points of the shape, D for each of its parts.
template <class Shape, class Plain>
void meets_all(const Shape& shape, const Plain& plain, const std::vector<reals>& corners, double tolerance,
               std::uint64_t seed) {
    cell::dice dice(seed);
    int hits = 0, compared = 0, different = 0;
    for (int i = 0; i < cell::draws(3000); ++i) {
        const auto part = static_cast<std::size_t>(dice.below(static_cast<int>(corners.size()) / D)) * D;
        const reals a = corners[part], b = corners[part + 1], c = corners[part + D - 1];
        const double share = dice.number(0, 1);
        const reals edge = a + (b - a) * (i % 16 < 8 ? 0.25 * dice.below(5) : share);
        const reals inside = edge + (c - edge) * dice.number(0, 1);
        reals from = inside + random_direction(dice) * dice.number(0, 20), displacement = (inside - from) * 1.5;
        if (i % 8 == 1) displacement = {}, displacement[dice.below(D)] = dice.number(-20, 20);
        if (i % 8 == 2) from = edge, displacement = random_direction(dice) * dice.number(0, 20);
        if (i % 8 == 3) from = a + (b - a) * dice.number(-3, 0.5), displacement = (b - a) * dice.number(0, 5);
        if (i % 8 == 4) displacement = (edge - from) * (dice.below(2) ? 1 : 2);
        if (i % 8 == 5) from = inside + reals{0, 8, 0}, displacement = {0, -16, 0};
        if (i % 8 == 6) from = inside * 1e3, displacement = inside * -2e3;
        if (i % 64 == 0) displacement = {};
        const local_hit hit = meet(shape, plain, from, displacement);
        hits += hit.hit;
        if (i % 16 != 15) continue;
        // Those in general position: GJK is as exact, but where they graze an edge.
        const local_hit general = meet_by_gjk(plain, from, displacement);
        const double apart = std::abs(hit.fraction - general.fraction) * size(displacement);
        const double sine = hit.hit ? std::abs(dot(unit(displacement), to_reals_of(hit.normal))) : 1;
        different += hit.hit != general.hit || apart * sine > tolerance;
        ++compared;
    }
    CHECK(hits > cell::draws(800));
    CHECK(different * 100 <= compared);
}
template <class Shape>
void meets_all_parts(const Shape& shape, std::uint64_t seed) {
    std::vector<reals> corners;
    each_part(shape, everywhere, [&](const auto& part) {
        for (const doubles& c : part.corner) corners.push_back(to_reals_of(c));
    });
    meets_all(shape, without_walk<Shape>{shape, shape.radius}, corners, 1e-12, seed);
}

CELL_CASE("rays: surfaces are met where all of their parts are") {
    cell::dice dice(103);
    std::vector<S> heights;
    for (int i = 0; i < 400; ++i) heights.push_back(i % 7 ? dice.real(-1, 1) : S(0));
    std::vector<std::uint8_t> holes(400);
    for (auto& hole : holes) hole = static_cast<std::uint8_t>(dice.below(4) == 0);
    for (const bool two_sided : {false, true}) {
#if CELL_DIMENSION == 2
        std::vector<vec> points;
        for (int i = 0; i < 200; ++i)
            points.push_back(i % 5 ? dice.vec<vec>(-10, 10) : vec{S(dice.below(20) - 10), S(i % 3)});
        const auto line =
            physics::chain_geometry<S, 2>::build(points.data(), 200, {.loop = true, .two_sided = two_sided});
        meets_all_parts(line.shape(), 200);
        meets_all_parts(line.shape(S(0.125)), 201);
        const auto field = physics::heightfield_geometry<S, 2>::build(heights.data(), 400, S(0.25),
                                                                      {.holes = holes.data(), .two_sided = two_sided});
        meets_all_parts(field.shape(), 202);
        meets_all_parts(field.shape(S(0.125)), 203);
        const auto tiles = physics::tile_grid_geometry<S, 2>::build(holes.data(), 20, 20, S(0.5));
        meets_all_parts(tiles.shape(), 204);
#else
        std::vector<vec> points;
        std::vector<std::uint32_t> triangles;
        for (int i = 0; i < 200; ++i) {
            const vec at = dice.vec<vec>(-10, 10);
            for (int k = 0; k < 3; ++k) {
                triangles.push_back(static_cast<std::uint32_t>(points.size()));
                points.push_back(at + dice.vec<vec>(-1, 1) * S(i % 7 ? 1 : 8));
            }
        }
        const auto soup =
            physics::mesh_geometry<S, 3>::build(points.data(), 600, triangles.data(), 200, {.two_sided = two_sided});
        meets_all_parts(soup.shape(), 200);
        meets_all_parts(soup.shape(S(0.125)), 201);
        for (const bool alternating : {false, true}) {
            const auto field = physics::heightfield_geometry<S, 3>::build(
                heights.data(), 25, 16, S(0.25), S(0.5),
                {.holes = holes.data(), .alternating = alternating, .two_sided = two_sided});
            meets_all_parts(field.shape(), 202);
            meets_all_parts(field.shape(S(0.125)), 203);
        }
#endif
    }
}

CELL_CASE("rays: compounds are met where all of their children are") {
    cell::dice dice(104);
    std::vector<vec> points;
    for (int i = 0; i < 12; ++i) points.push_back(dice.vec<vec>(-1, 1));
    const auto rock = physics::hull_geometry<S, D>::build(points.data(), 12);
    std::vector<physics::compound_child<S, D>> children;
    std::vector<reals> corners;
    for (int i = 0; i < 60; ++i) {
        const transform at = random_transform(dice, 8);
        const vec half = dice.vec<vec>(0.25, 1);
        for (int k = 0; k < D; ++k) corners.push_back(to_reals(at.position) + random_direction(dice));
        const auto add = [&](const auto& shape) {
            children.push_back({shape, at.position, i % 3 ? at.rotation : rotation{}});
        };
        switch (i % 6) {
            case 0: add(physics::box<S, D>{half}); break;
            case 1: add(physics::ball<S, D>{half.x}); break;
            case 2: add(physics::capsule<S, D>{half.x, half.y}); break;
            case 3: add(rock.shape()); break;
            case 4: add(physics::rounded_box<S, D>{half, S(0.125)}); break;
#if CELL_DIMENSION == 3
            default: add(physics::cone<S, 3>{half.x, half.y, S(0)}); break;
#else
            default: add(physics::triangle<S, 2>{}); break;
#endif
        }
    }
    const auto table = physics::compound_geometry<S, D>::build(children.data(), 60);
    meets_all(table.shape(), table_without_walk{table.shape()}, corners, 1e-8, 300);
}

CELL_CASE("rays: none passes between the parts of a surface") {
    cell::dice dice(105);
    std::vector<S> heights;
    // So flat that every ray from above sees the fronts of all parts.
    for (int i = 0; i < 400; ++i) heights.push_back(dice.real(0, 0.05));
#if CELL_DIMENSION == 2
    const auto field = physics::heightfield_geometry<S, 2>::build(heights.data(), 400, S(0.3));
#else
    const auto field = physics::heightfield_geometry<S, 3>::build(heights.data(), 20, 20, S(0.3), S(0.7));
#endif
    std::vector<doubles> corners;
    physics::aabb<double, D> within = field.data()->box;
    for (int i = 0; i < D; i += 2) within.lower[i] += 0.1, within.upper[i] -= 0.1;
    each_part(field.shape(), everywhere, [&](const auto& part) {
        for (int i = 0; i < D; ++i)
            if (contains(within, {part.corner[i], part.corner[i]}))
                corners.insert(corners.end(), {part.corner[i], part.corner[i < D - 1 ? i + 1 : 0]});
    });
    for (int i = 0; i < cell::draws(40000); ++i) {
        const auto k = static_cast<std::size_t>(dice.below(static_cast<int>(corners.size()) / 2)) * 2;
        // Onto an edge, or onto the corner that two segments or several triangles share.
        const double share = D == 2 || i % 2 ? 0 : dice.number(0, 1);
        const doubles target = corners[k] + (corners[k + 1] - corners[k]) * share;
        const reals aside = random_direction(dice),
                    above = reals{aside.x, 1, aside.z} * dice.number(1, i % 5 ? 10 : 1e5);
        const local_ray ray{target + to_doubles(above), -to_doubles(above) * 2.0};
        const local_hit hit = cast_on(field.shape(), ray);
        REQUIRE(hit.hit);
        REQUIRE(hit.fraction <= 0.5 + 1e-12);
        REQUIRE(hit.normal.y > 0);
    }
}

}  // namespace rays_laws
}  // namespace
