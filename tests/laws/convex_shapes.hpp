// Laws of segments, triangles, rounded boxes, cylinders and cones: as shapes, and in the general kernels.
#pragma once

#include "pair_memories.hpp"

template struct physics::segment<cell::scalar, cell::dimension>;
template struct physics::triangle<cell::scalar, cell::dimension>;
template struct physics::rounded_box<cell::scalar, cell::dimension>;
template struct physics::cylinder<cell::scalar, 3>;
template struct physics::cone<cell::scalar, 3>;

namespace {
namespace convex_shapes_laws {

static_assert(physics::solid_shape_for<segment, S, D> && physics::solid_shape_for<triangle, S, D>);
static_assert(physics::solid_shape_for<rounded_box, S, D>);
static_assert(physics::solid_shape_for<cylinder<>, S, 3> && physics::solid_shape_for<cone<>, S, 3>);

/// Calls f with a body of each kind of this file and its shape in its own type, many times over.
template <class F>
void each_new_body(std::uint64_t seed, int times, F&& f) {
    cell::dice dice(seed);
    for (int i = 0; i < times; ++i)
        for (int kind = of::segment; kind < convex_set::kinds; ++kind) {
            CAPTURE(convex_name(kind));
            const convex_body b = random_body(kind, dice, i % 4 == 3 ? 10 : 1, {.thin = i % 8 == 7});
            b.shape.visit([&](const auto& shape) {
                using shape_type = std::remove_cvref_t<decltype(shape)>;
                if constexpr (physics::solid_shape_for<shape_type, S, D>) f(b, shape, dice);
            });
        }
}

CELL_CASE("convex shapes: support points are the farthest, bounds hold the shape and are tight") {
    each_new_body(200, 200, [](const convex_body& b, const auto& shape, cell::dice& dice) {
        const double size = b.extent(), allowed = 16 * epsilon * (size + (cell::is_fixed ? 1 : 0));
        REQUIRE(check(shape, "test"));
        const transform at = random_transform(dice, 4);
        const oracle::frame frame = to_frame(at);
        const auto around = bounds(shape, at);
        for (int i = 0; i < D; ++i) {
            const oracle::point row{frame.axis[0][i], frame.axis[1][i], frame.axis[2][i]};
            const double high = double(frame.origin[i]) + b.reach(row), low = double(frame.origin[i]) - b.reach(-row);
            REQUIRE(std::abs(cell::number(around.upper[i]) - high) <= allowed + 16 * epsilon * 4);
            REQUIRE(std::abs(cell::number(around.lower[i]) - low) <= allowed + 16 * epsilon * 4);
        }
        for (int i = 0; i < 12; ++i) {
            reals d = random_direction(dice);
            if (i < 2 * D) d = {}, d[i / 2] = i % 2 ? -1 : 1;
            if (i >= 8) d = d * (i % 2 ? 1.0 / 64 : 64);
            const vec direction = from_reals(d);
            const oracle::point n = wide(direction), p = wide(support(shape, direction));
            const double off = b.distance(p);
            REQUIRE(std::abs(off) <= 2 * allowed);
            REQUIRE(double(dot(n, p)) >= b.reach(n) - 2 * allowed * double(oracle::size(n)));
        }
        REQUIRE(b.distance(wide(support(shape, vec{}))) <= allowed);
        // With other scalars it is the same shape.
        REQUIRE(bounds(shape.template as<double>().template as<S>(), at) == around);
    });
}

using exact_mass = physics::mass_properties<double, D>;
/// The six entries of an inertia; in the plane the one.
template <class T>
std::vector<double> entries_of(const physics::symmetric<T>& i) {
    return {double(i.xx), double(i.yy), double(i.zz), double(i.xy), double(i.xz), double(i.yz)};
}
template <class T>
std::vector<double> entries_of(const T& i) {
    return {double(i)};
}
/// Whether masses agree, but for a part of their size.
template <class T>
bool alike(const physics::mass_properties<T, D>& a, const exact_mass& b, double size, double part) {
    double off = 0;
    for (int i = 0; i < D; ++i) off = std::fmax(off, std::abs(double(a.center[i]) - b.center[i]));
    double apart = 0;
    const std::vector<double> of_a = entries_of(a.inertia), of_b = entries_of(b.inertia);
    for (std::size_t i = 0; i < of_a.size(); ++i) apart = std::fmax(apart, std::abs(of_a[i] - of_b[i]));
    const bool good = std::abs(double(a.mass) - b.mass) <= part * b.mass && off <= part * size &&
                      apart <= part * b.mass * size * size;
    if (!good) MESSAGE("mass " << double(a.mass) << " " << b.mass << " center off " << off << " inertia off " << apart);
    return good;
}
inline physics::vec<double, D> in_double(vec v) {
    physics::vec<double, D> r;
    for (int i = 0; i < D; ++i) r[i] = cell::number(v[i]);
    return r;
}
/// By the hull of the points, rounded: other formulas than those of these shapes.
inline exact_mass hull_mass(const std::vector<physics::vec<double, D>>& points, double radius) {
    const auto g = physics::hull_geometry<double, D>::build(points.data(), std::uint32_t(points.size()));
    return mass_of(g.shape(radius), 1.0);
}
template <class T>
exact_mass numeric_mass(const physics::rounded_box<T, D>& b) {
    std::vector<physics::vec<double, D>> points;
    for (const vec& v : corners_of(b.half_extents)) points.push_back(in_double(v));
    return hull_mass(points, cell::number(b.radius));
}
template <class T>
exact_mass numeric_mass(const physics::triangle<T, D>& t) {
    std::vector<physics::vec<double, D>> points{in_double(t.a), in_double(t.b), in_double(t.c)};
    if (cell::is_3d) {
        // A plate of a millionth of its rounding.
        const reals n = unit(cross(to_reals(t.b) - to_reals(t.a), to_reals(t.c) - to_reals(t.a)));
        for (std::size_t i = 0; i < 3; ++i) {
            points.push_back(points[i]);
            for (int k = 0; k < D; ++k) points.back()[k] += n[k] * (1e-6 * cell::number(t.radius));
        }
    }
    return hull_mass(points, cell::number(t.radius));
}
/// That of a capsule whose axis lies along u.
inline double turned_inertia(double inertia, physics::vec<double, 2>) { return inertia; }
inline physics::symmetric<double> turned_inertia(const physics::symmetric<double>& i, physics::vec<double, 3> u) {
    const double across = i.yy, d = i.xx - across;
    return {across + d * u.x * u.x, across + d * u.y * u.y, across + d * u.z * u.z,
            d * u.x * u.y,          d * u.x * u.z,          d * u.y * u.z};
}
template <class T>
exact_mass numeric_mass(const physics::segment<T, D>& s) {
    const auto a = in_double(s.a), b = in_double(s.b);
    const auto m = mass_of(physics::capsule<double, D>{0.5 * length(b - a), cell::number(s.radius)}, 1.0);
    return {m.mass, (a + b) * 0.5, turned_inertia(m.inertia, normalized(b - a))};
}
/// By slices across the axis, whose radius a search finds. They crowd at the ends, which makes the sum smooth.
inline physics::mass_properties<double, 3> sliced_mass(const round_solid& d) {
    const int n = 4000;
    const double end = d.half + d.rounding;
    double mass = 0, first = 0, xx = 0, yy = 0;
    for (int i = 1; i < n; ++i) {
        const double x = -end * std::cos(M_PI * i / n), dx = end * std::sin(M_PI * i / n) * M_PI / n;
        const auto over = [&](double at) {
            const double up = d.rounding * d.rounding - (x - at) * (x - at);
            return (d.low * (d.half - at) + d.high * (d.half + at)) / (2 * d.half) + std::sqrt(std::fmax(up, 0));
        };
        double from = std::fmax(-d.half, x - d.rounding), to = std::fmin(d.half, x + d.rounding);
        for (int k = 0; k < 90; ++k) {
            const double third = (to - from) / 3;
            over(from + third) < over(to - third) ? from += third : to -= third;
        }
        const double r = over(0.5 * (from + to)), area = M_PI * r * r * dx;
        mass += area;
        first += area * x;
        xx += area * x * x;
        yy += area * r * r / 4;
    }
    const double c = first / mass, across = xx - mass * c * c + yy;
    return {mass, {c, 0.0, 0.0}, {2 * yy, across, across, 0, 0, 0}};
}

CELL_CASE("convex shapes: masses agree with other ways to add them up") {
    each_new_body(201, 60, [](const convex_body& b, const auto& shape, cell::dice&) {
        const double size = b.extent();
        const auto exact = mass_of(shape.template as<double>(), 1.0);
        const auto m = mass_of(shape, S(1));
        if (b.kind != of::rounded_box && !b.round && b.hull.radius == 0 && (cell::is_3d || b.kind == of::segment)) {
            REQUIRE(m.mass == S(0));
            return;
        }
        if constexpr (requires { numeric_mass(shape); }) {
            const bool plate = cell::is_3d && b.kind == of::triangle;
            REQUIRE(alike(exact, numeric_mass(shape), size, plate ? 3e-6 : 1e-12));
        } else {
            if constexpr (std::is_same_v<decltype(sliced_mass(b.discs)), exact_mass>)
                REQUIRE(alike(exact, sliced_mass(b.discs), size, 1e-6));
        }
        // Rounded once; of fixed point only where it is not too small.
        if (!cell::is_fixed || (exact.mass > 0.01 && size < 4))
            REQUIRE(alike(m, exact, size, cell::is_fixed ? 1e-6 : 2 * epsilon + 1e-15));
    });
}

CELL_CASE("convex shapes: masses of simple ones are those of the books") {
    const auto near_to = [](S x, double y) { return std::abs(cell::number(x) - y) <= 4 * epsilon * (1 + std::abs(y)); };
    const auto rod = mass_of(segment{from_reals({1, 1, 0}), from_reals({3, 1, 0}), S(0.5)}, S(2));
    CHECK(near_to(rod.mass, cell::is_2d ? 2 * (2 + M_PI / 4) : 2 * (M_PI / 2 + M_PI / 6)));
    CHECK(near(rod.center, reals{2, 1, 0}, 4));
    CHECK(mass_of(segment{}, S(1)).mass == S(0));
    const auto sheet = mass_of(triangle{from_reals({0, 0, 0}), from_reals({3, 0, 0}), from_reals({0, 3, 0})}, S(2));
    CHECK(near_to(sheet.mass, cell::is_2d ? 9 : 0));
    if (cell::is_2d) CHECK(near(sheet.center, reals{1, 1, 0}, 4));
    // In every cell, since these are of space whatever its dimension.
    const auto c = mass_of(cylinder<>{S(1), S(0.5), S(0)}, S(2));
    CHECK(near_to(c.mass, M_PI));
    CHECK(near_to(c.inertia.xx, M_PI / 8));
    CHECK(near_to(c.inertia.yy, M_PI * (0.25 / 4 + 1.0 / 3)));
    // The centre a quarter of the height from the base; 3/10 m r^2 along, 3/80 m (4 r^2 + h^2) across.
    const auto k = mass_of(cone<>{S(1), S(1), S(0), S(0)}, S(3));
    CHECK(near_to(k.mass, 2 * M_PI));
    CHECK(near_to(k.center.x, -0.5));
    CHECK(near_to(k.inertia.xx, 0.6 * M_PI));
    CHECK(near_to(k.inertia.yy, 0.6 * M_PI));
    CHECK(near_to(mass_of(cone<>{S(1), S(0), S(1), S(0)}, S(3)).center.x, 0.5));
}

/// What check() says of a shape; empty if it takes it.
template <class Shape>
std::string refusal(const Shape& shape) {
    try {
        return check(shape, "create_shape") ? "" : "false";
    } catch (const physics::error& e) {
        return e.what();
    }
}
/// Every bad number in a field is refused by its name.
template <class Shape, class Set>
void refuses(const char* field, double least_bad, Set&& set) {
    std::vector<double> bad{least_bad, -1};
    if (!cell::is_fixed) bad.insert(bad.end(), {std::nan(""), HUGE_VAL, -HUGE_VAL});
    for (const double value : bad) {
        Shape shape;
        CHECK(refusal(shape) == "");
        set(shape, S(value));
        char expected[100];
        std::snprintf(expected, sizeof expected, "physics: create_shape: %s is %.9g; ", field, value);
        const std::string said = refusal(shape);
        CHECK_MESSAGE(said.rfind(expected, 0) == 0, said);
    }
}

CELL_CASE("convex shapes: bad numbers are refused by name and value") {
    const double below = -0.25;
    refuses<segment>("radius", below, [](segment& s, S x) { s.radius = x; });
    refuses<triangle>("radius", below, [](triangle& t, S x) { t.radius = x; });
    refuses<rounded_box>("radius", 0, [](rounded_box& b, S x) { b.radius = x; });
    refuses<rounded_box>("half_extents.y", 0, [](rounded_box& b, S x) { b.half_extents.y = x; });
    refuses<cylinder<>>("half_length", 0, [](cylinder<>& c, S x) { c.half_length = x; });
    refuses<cylinder<>>("radius", 0, [](cylinder<>& c, S x) { c.radius = x; });
    refuses<cylinder<>>("rounding", below, [](cylinder<>& c, S x) { c.rounding = x; });
    refuses<cone<>>("half_length", 0, [](cone<>& c, S x) { c.half_length = x; });
    refuses<cone<>>("lower_radius", below, [](cone<>& c, S x) { c.lower_radius = x; });
    refuses<cone<>>("upper_radius", below, [](cone<>& c, S x) { c.upper_radius = x; });
    refuses<cone<>>("rounding", below, [](cone<>& c, S x) { c.rounding = x; });
    CHECK(refusal(cone<>{S(1), S(0), S(0), S(1)}) ==
          "physics: create_shape: upper_radius is 0; one of the radii must be greater than 0");
    CHECK(refusal(cone<>{S(1), S(0), S(1), S(0)}) == "");
    const vec a = from_reals({3, 1, 2});
    CHECK(refusal(segment{a, a, S(1)}) ==
          "physics: create_shape: length is 0; the ends must differ; a point is a ball");
    const char* const flat = "physics: create_shape: area is 0; the corners must not lie on one line";
    CHECK(refusal(triangle{a, a, from_reals({1, 2, 3}), S(1)}) == flat);
    CHECK(refusal(triangle{a, a, a, S(1)}) == flat);
    // Whatever the scale: what is flat by rounding alone, and what is thin on purpose.
    cell::dice dice(202);
    for (int i = 0; i < 300; ++i) {
        const double scale = cell::is_fixed ? 1 : std::pow(10, dice.number(-9, 9));
        const reals p = random_direction(dice) * scale, q = random_direction(dice) * scale;
        const double t = dice.number(0, 1);
        const std::string said = refusal(triangle{from_reals(p), from_reals(q), from_reals(p + (q - p) * t), S(0)});
        CHECK_MESSAGE(said.rfind("physics: create_shape: area is ", 0) == 0, said);
        const reals aside = unit(cell::is_2d ? reals{q.y - p.y, p.x - q.x, 0} : cross(q - p, {0.3, 0.4, 1}));
        const reals r = p + (q - p) * t + aside * (1e-5 * scale);
        if (size(q - p) > 0.1 * scale)
            CHECK(refusal(triangle{from_reals(p), from_reals(q), from_reals(r), S(0)}) == "");
    }
    if (cell::is_fixed) return;
    for (const char* field : {"a.x", "b.y", "c.x"}) {
        triangle t;
        segment s;
        (field[0] == 'a' ? t.a : field[0] == 'b' ? t.b : t.c)[field[2] == 'y'] = S(HUGE_VAL);
        (field[0] == 'a' ? s.a : s.b)[field[2] == 'y'] = S(std::nan(""));
        const std::string named = std::string("physics: create_shape: ") + field + " is ";
        CHECK(refusal(t).rfind(named + "inf", 0) == 0);
        if (field[0] != 'c') CHECK(refusal(s).rfind(named + "nan", 0) == 0);
    }
}

}  // namespace convex_shapes_laws
}  // namespace
