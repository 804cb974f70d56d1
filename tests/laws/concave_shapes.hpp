// Laws of concave shapes by themselves: what they are made of, where it is found, what they refuse.
#pragma once

#include <algorithm>
#include <set>
#include <string>

#include "reals.hpp"

namespace {

inline double number(S x) { return cell::number(x); }
inline vec point(double x, double y, double z = 0) { return from_reals({x, y, z}); }

using points = std::vector<vec>;
using compound_geometry = physics::compound_geometry<S, D>;
using hull_geometry = physics::hull_geometry<S, D>;

#if CELL_DIMENSION == 3
/// The mesh of a heightfield, each second cell cut along the other diagonal if `alternating`.
inline physics::mesh_geometry<S, 3> mesh_of(const std::vector<S>& heights, std::uint32_t columns, std::uint32_t rows,
                                            double step_x, double step_z, bool alternating, bool two_sided = false) {
    points p;
    std::vector<std::uint32_t> t;
    for (std::uint32_t z = 0; z < rows; ++z)
        for (std::uint32_t x = 0; x < columns; ++x)
            p.push_back({S(x * step_x), heights[z * columns + x], S(z * step_z)});
    for (std::uint32_t z = 0; z + 1 < rows; ++z)
        for (std::uint32_t x = 0; x + 1 < columns; ++x) {
            const std::uint32_t a = z * columns + x, b = a + 1, c = a + columns, d = c + 1;
            if (alternating && (x + z) % 2) t.insert(t.end(), {a, c, b, b, c, d});
            else t.insert(t.end(), {a, c, d, a, d, b});
        }
    return physics::mesh_geometry<S, 3>::build(p.data(), columns * rows, t.data(),
                                               static_cast<std::uint32_t>(t.size() / 3), {.two_sided = two_sided});
}
#endif
inline const hull_geometry& cube_hull() {
    static const hull_geometry hull = [] {
        points p;
        for (int i = 0; i < 1 << D; ++i)
            p.push_back(from_reals({i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5}));
        return hull_geometry::build(p.data(), static_cast<std::uint32_t>(p.size()));
    }();
    return hull;
}
/// Two boxes side by side, 2 wide and 1 high together.
inline const compound_geometry& two_boxes() {
    static const compound_geometry pair = compound_geometry::build(
        {{physics::box<S, D>{}, from_reals({-0.5, 0, 0})}, {physics::box<S, D>{}, from_reals({0.5, 0, 0})}});
    return pair;
}

/// A box in double, and its parts that a shape finds there, in ascending order.
using box_of_doubles = physics::aabb<double, D>;
using part = physics::detail::surface_part<D>;
inline box_of_doubles around(const part& p) {
    box_of_doubles box{p.corner[0], p.corner[0]};
    for (const auto& c : p.corner) box = {min(box.lower, c), max(box.upper, c)};
    return box;
}
template <class Shape>
std::vector<part> parts_in(const Shape& shape, const box_of_doubles& box) {
    std::vector<part> found;
    each_part(shape, box, [&](const part& p) { found.push_back(p); });
    std::sort(found.begin(), found.end(), [](const part& a, const part& b) { return a.number < b.number; });
    return found;
}
inline const box_of_doubles everywhere = [] {
    box_of_doubles box;
    for (int i = 0; i < D; ++i) box.lower[i] = -1e300, box.upper[i] = 1e300;
    return box;
}();
template <class Shape>
std::vector<part> parts_of(const Shape& shape) {
    return parts_in(shape, everywhere);
}
inline double gap(const physics::vec<double, D>& a, const physics::vec<double, D>& b) { return length(a - b); }
/// How two parts differ; empty where they do not.
inline std::string difference(const part& a, const part& b) {
    if (a.number != b.number || a.two_sided != b.two_sided) return "number or sides";
    if (gap(a.normal, b.normal) > 1e-6) return "normal";
    for (int i = 0; i < D; ++i) {
        if (gap(a.corner[i], b.corner[i]) > 1e-6) return "corner";
        if (a.continues[i] != b.continues[i]) return "continues";
        if (a.continues[i] && gap(a.beyond[i], b.beyond[i]) > 1e-6) return "beyond";
    }
    return "";
}
/// Whether a function refuses its work with that sentence.
template <class F>
void check_refused(F&& build, const std::string& sentence) {
    try {
        build();
        FAIL_CHECK("not refused: " << sentence);
    } catch (const physics::error& e) {
        CHECK(std::string(e.what()) == "physics: " + sentence);
    }
}
/// Any shape with that many parts, small and large ones, here and there.
#if CELL_DIMENSION == 2
inline physics::chain_geometry<S, 2> random_surface(cell::dice& dice, int parts) {
    points p;
    for (int i = 0; i <= parts; ++i) p.push_back(dice.vec<vec>(-5, 5));
    return physics::chain_geometry<S, 2>::build(p.data(), static_cast<std::uint32_t>(p.size()));
}
#else
inline physics::mesh_geometry<S, 3> random_surface(cell::dice& dice, int parts) {
    points p;
    std::vector<std::uint32_t> t;
    for (int i = 0; i < parts; ++i) {
        const vec at = dice.vec<vec>(-5, 5);
        for (int k = 0; k < 3; ++k) {
            t.push_back(static_cast<std::uint32_t>(p.size()));
            p.push_back(at + dice.vec<vec>(-1, 1) * S(i % 7 == 0 ? 3 : 0.25));
        }
    }
    return physics::mesh_geometry<S, 3>::build(p.data(), static_cast<std::uint32_t>(p.size()), t.data(),
                                               static_cast<std::uint32_t>(parts));
}
#endif

CELL_CASE("concave: the tree finds what a search over all parts finds") {
    cell::dice dice(1);
    for (const int n : {1, 2, 3, 4, 5, 6, 8, 9, 12, 13, 31, 100, 1000}) {
        CAPTURE(n);
        const auto g = random_surface(dice, n);
        const std::vector<part> all = parts_of(g.shape());
        REQUIRE(all.size() == static_cast<std::size_t>(n));
        for (std::size_t i = 0; i < all.size(); ++i) REQUIRE(all[i].number == i);
        for (int round = 0; round < 60; ++round) {
            box_of_doubles box;
            for (int i = 0; i < D; ++i) {
                const double a = dice.number(-6, 6), b = a + dice.number(0, round % 3 ? 1 : 6);
                box.lower[i] = round % 5 ? a : number(S(a));
                box.upper[i] = b;
            }
            std::vector<std::uint32_t> wanted, found;
            for (const part& p : all)
                if (overlap(around(p), box)) wanted.push_back(p.number);
            for (const part& p : parts_in(g.shape(), box)) found.push_back(p.number);
            REQUIRE(found == wanted);
        }
    }
}

CELL_CASE("concave: bounds contain every part however a surface is turned, and are tight") {
    cell::dice dice(2);
    for (const int n : {1, 3, 40, 3000}) {
        const auto g = random_surface(dice, n);
        const auto all = parts_of(g.shape());
        for (int round = 0; round < 20; ++round) {
            const transform at = random_transform(dice, 3);
            const pose where = to_pose(at);
            const physics::aabb<S, D> box = bounds(g.shape(S(0.125)), at);
            reals low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
            for (const part& p : all)
                for (const auto& c : p.corner) {
                    reals q;
                    for (int i = 0; i < D; ++i) q[i] = c[i];
                    q = where.apply(q);
                    for (int i = 0; i < D; ++i) low[i] = std::fmin(low[i], q[i]), high[i] = std::fmax(high[i], q[i]);
                }
            const double slack = n < 20 ? 200 * epsilon : 0.25 * (high.x - low.x);
            for (int i = 0; i < D; ++i) {
                CHECK(number(box.lower[i]) <= low[i] - 0.125);
                CHECK(number(box.upper[i]) >= high[i] + 0.125);
                CHECK(number(box.lower[i]) >= low[i] - 0.125 - slack);
                CHECK(number(box.upper[i]) <= high[i] + 0.125 + slack);
            }
        }
    }
}

CELL_CASE("concave: shapes go through double and back, and geometry lives as long as its last owner") {
    cell::dice dice(3);
    auto shape = decltype(random_surface(dice, 1))().shape();
    {
        const auto g = random_surface(dice, 5), copy = g;
        shape = copy.shape(S(0.5));
        CHECK(shape.geometry == g.data());
        const auto there = shape.template as<double>();
        const auto back = there.template as<S>();
        CHECK(std::is_same_v<std::remove_const_t<decltype(back)>, decltype(shape)>);
        CHECK(back.geometry == shape.geometry);
        CHECK(back.radius == shape.radius);
        CHECK(random_surface(dice, 5).data()->digest != g.data()->digest);
    }
    compound_geometry kept;
    {
        points p;
        for (int i = 0; i < 9; ++i) p.push_back(dice.vec<vec>(-1, 1));
        const auto hull = hull_geometry::build(p.data(), 9);
        kept = compound_geometry::build({{hull.shape()}, {hull.shape(S(0.25)), point(2, 0)}});
    }
    CHECK(number(mass_of(kept.shape(), S(1)).mass) > 0);
    CHECK(number(support(kept.shape(), point(1, 0)).x) > 1);
}

inline bool near_inertia(S a, double b) { return near(number(a), b, 32); }
inline bool near_inertia(const physics::symmetric<S>& a, const physics::symmetric<double>& b) {
    return near(number(a.xx), b.xx, 32) && near(number(a.yy), b.yy, 32) && near(number(a.zz), b.zz, 32) &&
           near(number(a.xy), b.xy, 32) && near(number(a.xz), b.xz, 32) && near(number(a.yz), b.yz, 32);
}
CELL_CASE("concave: a compound's mass, bounds and support points are those of its children") {
    cell::dice dice(4);
    for (const std::uint32_t n : {1u, 2u, 7u, 100u}) {
        std::vector<physics::compound_child<S, D>> children;
        std::vector<transform> places;
        std::vector<physics::box<S, D>> boxes;
        physics::mass_properties<double, D> sum;
        for (std::uint32_t i = 0; i < n; ++i) {
            places.push_back(random_transform(dice, 3));
            boxes.push_back({dice.vec<vec>(0.25, 1)});
            children.push_back({boxes[i], places[i].position, places[i].rotation});
            sum = combined(sum, physics::detail::placed_mass(mass_of(boxes[i].template as<double>(), 2.0),
                                                             physics::detail::to_matrix(places[i].rotation),
                                                             physics::detail::to_point(places[i].position)));
        }
        const auto g = compound_geometry::build(children.data(), n);
        const auto m = mass_of(g.shape(), S(2));
        CHECK(near(number(m.mass), sum.mass, 8));
        for (int i = 0; i < D; ++i) CHECK(near(number(m.center[i]), sum.center[i], 32));
        CHECK(near_inertia(m.inertia, sum.inertia));
        for (int round = 0; round < 20; ++round) {
            const transform at = random_transform(dice, 2);
            const physics::aabb<S, D> box = bounds(g.shape(), at);
            physics::aabb<S, D> exact = bounds(boxes[0], at * places[0]);
            for (std::uint32_t i = 1; i < n; ++i) exact = merged(exact, bounds(boxes[i], at * places[i]));
            for (int i = 0; i < D; ++i) {
                const double slack = n < 50 ? 200 * epsilon : 2;
                CHECK(number(box.lower[i]) <= number(exact.lower[i]) + 40 * epsilon);
                CHECK(number(box.upper[i]) >= number(exact.upper[i]) - 40 * epsilon);
                CHECK(number(box.lower[i]) >= number(exact.lower[i]) - slack);
                CHECK(number(box.upper[i]) <= number(exact.upper[i]) + slack);
            }
            const vec d = from_reals(random_direction(dice));
            double most = -1e9;
            for (std::uint32_t i = 0; i < n; ++i) {
                const vec p = places[i] * support(boxes[i], inverse_rotate(places[i].rotation, d));
                most = std::fmax(most, dot(to_reals(p), to_reals(d)));
            }
            CHECK(std::abs(dot(to_reals(support(g.shape(), d)), to_reals(d)) - most) < 100 * epsilon);
        }
        std::set<std::uint32_t> seen;
        each_child(g.shape(), everywhere, [&](const auto& child) { seen.insert(child.number); });
        CHECK(seen.size() == n);
    }
    using child = physics::compound_child<S, D>;
    using ball = physics::ball<S, D>;
    const std::string counted = " is null; it must point to as many values as are counted";
    check_refused([] { return compound_geometry::build(nullptr, 2); }, "compound_geometry::build: children" + counted);
    check_refused([] { return hull_geometry::build(nullptr, 9); }, "hull_geometry::build: points" + counted);
#if CELL_DIMENSION == 2
    check_refused([] { return physics::chain_geometry<S, 2>::build(nullptr, 3); },
                  "chain_geometry::build: points" + counted);
    check_refused([] { return physics::heightfield_geometry<S, 2>::build(nullptr, 3, S(1)); },
                  "heightfield_geometry::build: heights" + counted);
    check_refused([] { return physics::tile_grid_geometry<S, 2>::build(nullptr, 3, 3, S(1)); },
                  "tile_grid_geometry::build: cells" + counted);
#else
    const points p(3);
    check_refused([&] { return physics::mesh_geometry<S, 3>::build(nullptr, 3, nullptr, 1); },
                  "mesh_geometry::build: vertices" + counted);
    check_refused([&] { return physics::mesh_geometry<S, 3>::build(p.data(), 3, nullptr, 1); },
                  "mesh_geometry::build: triangles" + counted);
    check_refused([] { return physics::heightfield_geometry<S, 3>::build(nullptr, 3, 3, S(1), S(1)); },
                  "heightfield_geometry::build: heights" + counted);
#endif
    check_refused([] { return compound_geometry::build(nullptr, 0); },
                  "compound_geometry::build: number of children is 0; a compound needs at least 1");
    check_refused(
        [] {
            return compound_geometry::build({child{ball{}}, child{ball{S(-1)}}});
        },
        "compound_geometry::build: child 1: radius is -1; it must be greater than 0");
    if (!cell::is_fixed)
        check_refused(
            [] {
                return compound_geometry::build({child{ball{}, from_reals({0, NAN, 0})}});
            },
            "compound_geometry::build: child 0: position.y is nan; it must be finite");
    check_refused([] { check(physics::compound<S, D>{}, "create_shape"); },
                  "create_shape: geometry is null; it must be the shape of a compound_geometry that was built");
}

#if CELL_DIMENSION == 2
CELL_CASE("concave: segments of a chain know their normals, what follows, and their open ends") {
    using chain = physics::chain_geometry<S, 2>;
    const auto open = parts_of(chain::build({{2, 0}, {0, 0}, {0, 1}}).shape());
    REQUIRE(open.size() == 2);
    CHECK(gap(open[0].normal, {0, 1}) == 0);
    CHECK(gap(open[1].normal, {1, 0}) == 0);
    CHECK((!open[0].continues[0] && open[0].continues[1] && open[1].continues[0] && !open[1].continues[1]));
    CHECK(gap(open[0].beyond[1], {1, 0}) == 0);
    CHECK(gap(open[1].beyond[0], {0, 1}) == 0);
    // Around a square the solid is inside.
    const auto loop =
        parts_of(chain::build({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {.loop = true, .two_sided = true}).shape());
    REQUIRE(loop.size() == 4);
    const physics::vec<double, 2> out[] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(gap(loop[i].normal, out[i]) == 0);
        CHECK((loop[i].continues[0] && loop[i].continues[1] && loop[i].two_sided));
        CHECK(gap(loop[i].beyond[1], out[(i + 1) % 4]) == 0);
        CHECK(gap(loop[i].beyond[0], out[(i + 3) % 4]) == 0);
    }
    if (!cell::is_fixed)
        check_refused(
            [] {
                return chain::build({{0, 0}, vec{S(double(NAN)), S(0)}});
            },
            "chain_geometry::build: points[1].x is nan; it must be finite");
    check_refused(
        [] {
            return chain::build({{0, 0}});
        },
        "chain_geometry::build: number of points is 1; a chain needs at least 2");
    check_refused(
        [] {
            return chain::build({{0, 0}, {1, 0}}, {.loop = true});
        },
        "chain_geometry::build: number of points is 2; a loop needs at least 3");
    check_refused(
        [] {
            return chain::build({{0, 0}, {0.5, 0}, {0.5, 0}});
        },
        "chain_geometry::build: points[2].x is 0.5; it must not be the same point as the one before");
    check_refused(
        [] {
            return chain::build({{0.25, 0}, {1, 0}, {1, 1}, {0.25, 0}}, {.loop = true});
        },
        "chain_geometry::build: points[0].x is 0.25; it must not be the same point as the one before");
    check_refused([] { check(physics::chain<S, 2>{}, "create_shape"); },
                  "create_shape: geometry is null; it must be the shape of a chain_geometry that was built");
}

CELL_CASE("concave: the outline of tiles runs along every open side once, and knows what its corners are") {
    using tiles = physics::tile_grid_geometry<S, 2>;
    cell::dice dice(5);
    for (int round = 0; round < 60; ++round) {
        const int columns = 1 + dice.below(9), rows = 1 + dice.below(9);
        std::vector<std::uint8_t> cells;
        for (int i = 0; i < columns * rows; ++i) cells.push_back(static_cast<std::uint8_t>(dice.below(3) > 0 ? 7 : 0));
        cells[0] = 1;
        const auto solid = [&](int x, int y) {
            return x >= 0 && y >= 0 && x < columns && y < rows && cells[std::size_t(y * columns + x)] != 0;
        };
        const auto g =
            tiles::build(cells.data(), static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows), S(0.5));
        std::set<std::vector<int>> sides;
        for (const part& p : parts_of(g.shape())) {
            const int nx = static_cast<int>(p.normal.x), ny = static_cast<int>(p.normal.y);
            REQUIRE(std::abs(nx) + std::abs(ny) == 1);
            const auto from = p.corner[0] * 2, to = p.corner[1] * 2;
            const int length = static_cast<int>(std::abs(to.x - from.x) + std::abs(to.y - from.y));
            const int dx = -ny, dy = nx;
            REQUIRE((to.x - from.x == dx * length && to.y - from.y == dy * length && length > 0));
            const auto cell_at = [&](double x, double y) {
                return solid(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));
            };
            for (int i = 0; i < length; ++i) {
                const double x = from.x + dx * (i + 0.5), y = from.y + dy * (i + 0.5);
                REQUIRE(cell_at(x - 0.5 * nx, y - 0.5 * ny));
                REQUIRE(!cell_at(x + 0.5 * nx, y + 0.5 * ny));
                REQUIRE(sides.insert({static_cast<int>(2 * x), static_cast<int>(2 * y), nx, ny}).second);
            }
            for (int end = 0; end < 2; ++end) {
                REQUIRE(p.continues[end]);
                // Ahead of the end in the air: solid there is a wall, else the corner stands out.
                const int out = end == 0 ? -1 : 1;
                const auto at = end == 0 ? from : to;
                const bool wall = cell_at(at.x + 0.5 * (out * dx + nx), at.y + 0.5 * (out * dy + ny));
                const bool ahead = cell_at(at.x + 0.5 * (out * dx - nx), at.y + 0.5 * (out * dy - ny));
                REQUIRE((wall || !ahead));
                const int displacement = wall ? -1 : 1;
                REQUIRE(gap(p.beyond[end], {double(displacement * out * dx), double(displacement * out * dy)}) == 0);
            }
        }
        std::size_t open = 0;
        for (int y = -1; y <= rows; ++y)
            for (int x = -1; x <= columns; ++x) {
                open += solid(x, y) != solid(x + 1, y);
                open += solid(x, y) != solid(x, y + 1);
            }
        REQUIRE(sides.size() == open);
    }
    const std::uint8_t none[4] = {};
    check_refused([&] { return tiles::build(none, 2, 2, S(1)); },
                  "tile_grid_geometry::build: number of solid cells is 0; a tile grid needs at least 1");
    check_refused([&] { return tiles::build(none, 2, 2, S(0)); },
                  "tile_grid_geometry::build: cell_size is 0; it must be greater than 0");
}

CELL_CASE("concave: a heightfield in the plane is the chain of its samples, but for holes") {
    using heightfield = physics::heightfield_geometry<S, 2>;
    cell::dice dice(6);
    for (const std::uint32_t n : {2u, 3u, 9u, 200u}) {
        std::vector<S> heights;
        points p;
        for (std::uint32_t i = 0; i < n; ++i) {
            heights.push_back(dice.real(-2, 2));
            p.push_back({S(0.25 * i), heights[i]});
        }
        std::reverse(p.begin(), p.end());
        auto wanted = parts_of(physics::chain_geometry<S, 2>::build(p.data(), n).shape());
        for (part& q : wanted) q.number = n - 2 - q.number;
        std::reverse(wanted.begin(), wanted.end());
        const auto g = heightfield::build(heights.data(), n, S(0.25));
        const auto found = parts_of(g.shape());
        REQUIRE(found.size() == wanted.size());
        for (std::size_t i = 0; i < found.size(); ++i) REQUIRE(difference(found[i], wanted[i]) == "");
        for (int round = 0; round < 50; ++round) {
            const double x = dice.number(-1, 0.25 * n), y = dice.number(-3, 2);
            const box_of_doubles box{{x, y}, {x + dice.number(0, 1), y + dice.number(0, 1)}};
            std::set<std::uint32_t> numbers;
            for (const part& q : parts_in(g.shape(), box)) numbers.insert(q.number);
            for (const part& q : wanted)
                if (overlap(around(q), box)) REQUIRE(numbers.count(q.number) == 1);
        }
        std::vector<std::uint8_t> holes(n - 1, 0);
        holes[n / 2 - 1] = 1;
        const auto open = heightfield::build(heights.data(), n, S(0.25), {.holes = holes.data()});
        for (const part& q : parts_of(open.shape())) {
            REQUIRE(q.number != n / 2 - 1);
            REQUIRE(q.continues[1] == (q.number > 0 && q.number != n / 2));
            REQUIRE(q.continues[0] == (q.number + 2 < n && q.number + 2 != n / 2));
        }
        REQUIRE(open.data()->digest != g.data()->digest);
    }
    check_refused([] { return heightfield::build({S(1)}, S(1)); },
                  "heightfield_geometry::build: number of samples is 1; it must be at least 2");
    check_refused(
        [] {
            return heightfield::build({S(1), S(1)}, S(-1));
        },
        "heightfield_geometry::build: spacing is -1; it must be greater than 0");
    if (!cell::is_fixed)
        check_refused(
            [] {
                return heightfield::build({S(1), S(double(NAN))}, S(1));
            },
            "heightfield_geometry::build: heights[1] is nan; it must be finite");
}
#else
using mesh = physics::mesh_geometry<S, 3>;
const points corners_of_cube = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
const std::vector<std::uint32_t> sides_of_cube = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                                  2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
inline mesh build(const points& p, const std::vector<std::uint32_t>& t) {
    return mesh::build(p.data(), static_cast<std::uint32_t>(p.size()), t.data(),
                       static_cast<std::uint32_t>(t.size() / 3));
}
inline int free_edges(const mesh& m) {
    int n = 0;
    for (const part& p : parts_of(m.shape()))
        for (const bool continues : p.continues) n += !continues;
    return n;
}

CELL_CASE("concave: triangles of a mesh know their neighbours, also where vertices come more than once") {
    points soup;
    std::vector<std::uint32_t> in_order;
    for (const std::uint32_t i : sides_of_cube) {
        in_order.push_back(static_cast<std::uint32_t>(soup.size()));
        soup.push_back(corners_of_cube[i]);
    }
    const mesh cube = build(corners_of_cube, sides_of_cube), loose = build(soup, in_order);
    CHECK(cube.triangle_count() == 12);
    CHECK(cube.data()->digest != 0);
    const auto parts = parts_of(cube.shape()), same = parts_of(loose.shape());
    for (std::size_t i = 0; i < 12; ++i) {
        const int axis = static_cast<int>(i / 4);
        physics::vec<double, 3> out;
        out[axis] = i / 2 % 2 ? 1 : -1;
        CHECK(gap(parts[i].normal, out) == 0);
        CHECK(difference(parts[i], same[i]) == "");
        int flat = 0;
        for (int k = 0; k < 3; ++k) {
            CHECK(parts[i].continues[k]);
            // Beyond a diagonal the same side goes on, beyond the others another one, whose normal leads out there.
            const auto outwards = physics::detail::outwards(parts[i], k);
            flat += gap(parts[i].beyond[k], out) == 0;
            CHECK((gap(parts[i].beyond[k], out) == 0 || dot(parts[i].beyond[k], outwards) > 0.5));
        }
        CHECK(flat == 1);
    }
    CHECK(loose.data()->vertices.size() == 8);
    CHECK(free_edges(cube) == 0);

    // A triangle more at one edge, and one that is turned round: free edges.
    auto more = sides_of_cube;
    more.insert(more.end(), {1, 5, 2});
    CHECK(free_edges(build(corners_of_cube, more)) == 5);
    auto turned = sides_of_cube;
    std::swap(turned[0], turned[1]);
    CHECK(free_edges(build(corners_of_cube, turned)) == 6);
    auto less = sides_of_cube;
    less.resize(33);
    CHECK(free_edges(build(corners_of_cube, less)) == 3);
}

CELL_CASE("concave: triangles without area are dropped, and what they lay between become neighbours") {
    // Two squares, the left one in two triangles, the right one's side cut in two by a vertex: a sliver fills the seam.
    const points p = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0.5}, {2, 0, 0}, {2, 0, 1}};
    const std::vector<std::uint32_t> t = {0, 2, 3, 0, 3, 1, 1, 3, 4, 1, 4, 5, 4, 3, 6, 4, 6, 5, 3, 3, 6};
    const mesh m = build(p, t);
    CHECK(m.triangle_count() == 5);
    CHECK(m.dropped_triangles() == 2);
    int edges = 0;
    for (const part& q : parts_of(m.shape()))
        for (int k = 0; k < 3; ++k) {
            const auto a = q.corner[k], b = q.corner[k < 2 ? k + 1 : 0];
            const bool border = (a.x == b.x && (a.x == 0 || a.x == 2)) || (a.z == b.z && (a.z == 0 || a.z == 1));
            CHECK(q.continues[k] == !border);
            edges += border;
        }
    CHECK(edges == 6);
    CHECK(parts_of(m.shape())[2].number == 3);

    check_refused(
        [&] {
            return build(p, {0, 1, 1});
        },
        "mesh_geometry::build: number of triangles with an area is 0; a mesh needs at least 1");
    check_refused(
        [&] {
            return build(p, {0, 2, 3, 0, 3, 7});
        },
        "mesh_geometry::build: triangles[5] is 7; it must be less than the number of vertices");
    if (!cell::is_fixed)
        check_refused(
            [] {
                return build({{0, 0, 0}, {1, 0, 0}, vec{S(0), S(1), S(double(NAN))}}, {0, 1, 2});
            },
            "mesh_geometry::build: vertices[2].z is nan; it must be finite");
    check_refused([] { check(physics::mesh<S, 3>{}, "create_shape"); },
                  "create_shape: geometry is null; it must be the shape of a mesh_geometry that was built");
}

CELL_CASE("concave: a heightfield in space is the mesh of its samples, but for holes") {
    using heightfield = physics::heightfield_geometry<S, 3>;
    cell::dice dice(6);
    for (const std::uint32_t n : {2u, 3u, 6u, 20u})
        for (const bool alternating : {false, true}) {
            const std::uint32_t rows = n == 2 ? 3 : n - 1;
            std::vector<S> heights;
            for (std::uint32_t i = 0; i < n * rows; ++i) heights.push_back(dice.real(-2, 2));
            const auto wanted = parts_of(mesh_of(heights, n, rows, 0.25, 0.5, alternating).shape());
            const auto g = heightfield::build(heights.data(), n, rows, S(0.25), S(0.5), {.alternating = alternating});
            const auto found = parts_of(g.shape());
            REQUIRE(found.size() == wanted.size());
            for (std::size_t i = 0; i < found.size(); ++i) REQUIRE(difference(found[i], wanted[i]) == "");
            for (int round = 0; round < 50; ++round) {
                box_of_doubles box;
                for (int i = 0; i < 3; ++i) {
                    box.lower[i] = dice.number(-2, i == 1 ? 2 : 0.25 * n);
                    box.upper[i] = box.lower[i] + dice.number(0, 1);
                }
                std::set<std::uint32_t> numbers;
                for (const part& q : parts_in(g.shape(), box)) numbers.insert(q.number);
                for (const part& q : wanted)
                    if (overlap(around(q), box)) REQUIRE(numbers.count(q.number) == 1);
            }
            std::vector<std::uint8_t> holes((n - 1) * (rows - 1), 0);
            for (auto& hole : holes) hole = static_cast<std::uint8_t>(dice.below(3) == 0);
            const auto open = heightfield::build(heights.data(), n, rows, S(0.25), S(0.5),
                                                 {.holes = holes.data(), .alternating = alternating});
            std::size_t left = 0;
            for (const auto hole : holes) left += hole ? 0 : 2;
            const auto rest = parts_of(open.shape());
            REQUIRE(rest.size() == left);
            for (const part& q : rest) {
                REQUIRE(!holes[q.number / 2]);
                // The same edge of the whole field leads to the same neighbour, or to a hole.
                int gone = 0;
                for (int i = 0; i < 3; ++i) {
                    REQUIRE((!q.continues[i] || gap(q.beyond[i], wanted[q.number].beyond[i]) < 1e-6));
                    gone += wanted[q.number].continues[i] && !q.continues[i];
                }
                REQUIRE(gone <= 2);
            }
        }
    const S h[4] = {};
    check_refused([&] { return heightfield::build(h, 2, 1, S(1), S(1)); },
                  "heightfield_geometry::build: rows is 1; it must be at least 2");
    check_refused([&] { return heightfield::build(h, 2, 2, S(1), S(0)); },
                  "heightfield_geometry::build: spacing_z is 0; it must be greater than 0");
}
#endif

}  // namespace
