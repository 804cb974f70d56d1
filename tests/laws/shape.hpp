// Laws of shapes: bounds, support points, masses, refusals, and the closed set.
#pragma once

#include <algorithm>
#include <limits>

#include "figures.hpp"

template struct physics::ball<cell::scalar, cell::dimension>;
template struct physics::capsule<cell::scalar, cell::dimension>;
template struct physics::box<cell::scalar, cell::dimension>;
template struct physics::halfspace<cell::scalar, cell::dimension>;
template class physics::any_shape<cell::scalar, cell::dimension, physics::ball, physics::capsule, physics::box,
                                  physics::halfspace>;

namespace {
namespace shape_laws {

using aabb = cell::space::aabb;
using mass_properties = cell::space::mass_properties;

static_assert(physics::solid_shape_for<ball, S, D> && physics::solid_shape_for<capsule, S, D>);
static_assert(physics::solid_shape_for<box, S, D>);
static_assert(physics::shape_for<halfspace, S, D> && !physics::solid_shape_for<halfspace, S, D>);
static_assert(std::is_trivially_copyable_v<any_shape>);

/// Calls f with a solid shape of every kind, many times over.
template <class F>
void each_solid(std::uint64_t seed, int times, double least, double most, F&& f) {
    cell::dice dice(seed);
    for (int i = 0; i < times; ++i)
        for (int kind = 0; kind < 3; ++kind) {
            CAPTURE(kind);
            const any_shape shape = random_shape(kind, dice, least, most);
            if (kind == 0) f(shape.get<ball>(), dice);
            else if (kind == 1) f(shape.get<capsule>(), dice);
            else f(shape.get<box>(), dice);
        }
}

CELL_CASE("shape: the support point is the farthest of the shape") {
    each_solid(1, 300, 0.1, 2, [](const auto& shape, cell::dice& dice) {
        const figure exact = to_figure(shape);
        for (int i = 0; i < 12; ++i) {
            reals direction = random_direction(dice);
            // Along axes, with zeros of either sign, short and long.
            if (i < 3) direction = {double(i == 0), double(i == 1 || cell::is_2d), double(i == 2 && cell::is_3d)};
            if (i >= 3 && i < 6) direction[i % D] = -0.0;
            if (i >= 6 && i < 9) direction = -direction * (i == 6 ? 1.0 / 64 : i == 7 ? 1 : 64);
            const vec d = from_reals(direction);
            const reals n = to_reals(d), p = to_reals(support(shape, d));
            REQUIRE(exact.distance(p) <= 16 * epsilon);
            REQUIRE(near(dot(unit(n), p), exact.reach(unit(n)), 32));
            for (int k = 0; k < 20; ++k) {
                reals q;
                for (int j = 0; j < D; ++j) q[j] = dice.number(-1, 1) * (exact.half[j] + exact.radius);
                if (exact.distance(q) <= 0) REQUIRE(dot(unit(n), q) <= dot(unit(n), p) + 32 * epsilon);
            }
        }
        REQUIRE(exact.distance(to_reals(support(shape, vec{}))) <= 16 * epsilon);
    });
}

CELL_CASE("shape: bounds hold the shape and are tight") {
    each_solid(2, 500, 0.1, 2, [](const auto& shape, cell::dice& dice) {
        const figure exact = to_figure(shape);
        const transform at = random_transform(dice, 8);
        const pose frame = to_pose(at);
        const aabb around = bounds(shape, at);
        for (int i = 0; i < D; ++i) {
            reals e;
            e[i] = 1;
            const double reach = exact.reach(frame.unrotate(e));
            REQUIRE(near(cell::number(around.upper[i]), frame.origin[i] + reach, 16));
            REQUIRE(near(cell::number(around.lower[i]), frame.origin[i] - reach, 16));
        }
        for (int i = 0; i < 8; ++i) {
            const vec p = at * support(shape, from_reals(random_direction(dice)));
            REQUIRE(contains(grown(around, cell::tolerance(64)), aabb{p, p}));
        }
    });
}

CELL_CASE("shape: the bounds of a halfspace hold it, and end at its surface where that lies along the axes") {
    cell::dice dice(3);
    const double far = std::min(cell::number(cell::traits::max()), 1e75) / 8;
    for (int i = 0; i < 500; ++i) {
        halfspace h = random_shape(3, dice, 0, 4).get<halfspace>();
        transform at = random_transform(dice, 8);
        const bool along = i % 2 == 0;
        if (along) {
            h.normal = {};
            h.normal[i / 2 % D] = S(i % 4 ? 1 : -1);
            at.rotation = {};
        }
        // Not quite of length 1, as in a literal of four digits.
        h.normal *= S(1 + 1e-5 * (dice.below(19) - 9));
        REQUIRE(check(h, "test"));
        const pose frame = to_pose(at);
        const figure exact = to_figure(h);
        const aabb around = bounds(h, at);
        for (int k = 0; k < 20; ++k) {
            reals p;
            for (int j = 0; j < D; ++j) p[j] = dice.number(-1, 1) * (k < 10 ? 16 : far);
            if (exact.distance(frame.undo(p)) > 0) continue;
            for (int j = 0; j < D; ++j) {
                REQUIRE(p[j] <= cell::number(around.upper[j]) + 128 * epsilon);
                REQUIRE(p[j] >= cell::number(around.lower[j]) - 128 * epsilon);
            }
        }
        if (!along) continue;
        const int axis = i / 2 % D;
        const bool upwards = exact.normal[axis] > 0;
        const double surface = cell::number(upwards ? around.upper[axis] : around.lower[axis]);
        REQUIRE(near(surface, frame.origin[axis] + exact.offset * exact.normal[axis], 64));
        // With room to grow a margin.
        REQUIRE(contains(grown(around, S(100)), around));
    }
}

/// Mass and principal inertias by slices across x, summed with Simpson's rule; the caps of round shapes by
/// the angle, which makes the sum smooth.
struct mass_oracle {
    double mass = 0, xx = 0, yy = 0, zz = 0;

    mass_oracle(const figure& f, double density) {
        const bool round = f.radius > 0;
        sum(-f.half.x, f.half.x, [&](double x) { return slice(f, x, f.radius, 1); });
        for (const double sign : {-1.0, 1.0}) {
            if (!round) continue;
            sum(0, M_PI / 2, [&](double angle) {
                const double x = f.half.x + f.radius * std::sin(angle), r = f.radius * std::cos(angle);
                return slice(f, sign * x, r, r);
            });
        }
        mass *= density;
        xx *= density;
        yy *= density;
        zz *= density;
    }

private:
    struct moments {
        double mass, xx, yy, zz;
    };
    /// A slice at x, times the width dx belongs to: a rectangle or disc (in the plane a chord) of the core's
    /// half extents grown by r.
    static moments slice(const figure& f, double x, double r, double dx) {
        double area = 0, across_y = 0, across_z = 0;
        if (cell::is_2d) {
            const double y = f.half.y + r;
            area = 2 * y;
            across_y = 2 * y * y * y / 3;
        } else if (f.radius > 0) {
            area = M_PI * r * r;
            across_y = across_z = area * r * r / 4;
        } else {
            area = 4 * f.half.y * f.half.z;
            across_y = area * f.half.y * f.half.y / 3;
            across_z = area * f.half.z * f.half.z / 3;
        }
        return {area * dx, (across_y + across_z) * dx, (area * x * x + across_z) * dx, (area * x * x + across_y) * dx};
    }
    template <class F>
    void sum(double from, double to, F&& f) {
        const int n = 256;
        for (int i = 0; i <= n; ++i) {
            const double weight = (i == 0 || i == n ? 1 : i % 2 ? 4 : 2) * (to - from) / n / 3;
            const moments m = f(from + (to - from) * i / n);
            mass += m.mass * weight;
            xx += m.xx * weight;
            yy += m.yy * weight;
            zz += m.zz * weight;
        }
    }
};
/// Principal inertias; in the plane only the one about z.
inline reals principal(S inertia) { return {0, 0, cell::number(inertia)}; }
inline reals principal(const physics::symmetric<S>& i) {
    return {cell::number(i.xx), cell::number(i.yy), cell::number(i.zz)};
}
inline bool is_diagonal(S) { return true; }
inline bool is_diagonal(const physics::symmetric<S>& i) { return i.xy == S(0) && i.xz == S(0) && i.yz == S(0); }

CELL_CASE("shape: masses agree with an integral over slices") {
    const bool narrow = cell::number(cell::traits::max()) < 1e6;
    for (const double heavy : {1.0, narrow ? 4.0 : 1000.0})
        each_solid(4, 100, 0.1, 1.5, [&](const auto& shape, cell::dice& dice) {
            const S density = dice.real(0.5 * heavy, 2 * heavy);
            const mass_properties m = mass_of(shape, density);
            const figure f = to_figure(shape);
            const mass_oracle exact(f, cell::number(density));
            // A spacing's error of a size of this shape, or of its square.
            const double spread = 1 + f.largest() * f.largest();
            const double allowed =
                12 * epsilon * (cell::is_fixed ? 1 + cell::number(density) * spread * spread : exact.mass);
            REQUIRE(std::abs(cell::number(m.mass) - exact.mass) <= allowed + 1e-9 * exact.mass);
            REQUIRE(m.center == vec{});
            REQUIRE(is_diagonal(m.inertia));
            const reals i = principal(m.inertia);
            const double wide = allowed * spread;
            REQUIRE(std::abs(i.z - exact.zz) <= wide + 1e-9 * exact.zz);
            if (cell::is_2d) return;
            REQUIRE(std::abs(i.x - exact.xx) <= wide + 1e-9 * exact.xx);
            REQUIRE(std::abs(i.y - exact.yy) <= wide + 1e-9 * exact.yy);
            // No axis is stiffer than the two others together.
            for (int k = 0; k < 3; ++k) REQUIRE(i[k] <= i[(k + 1) % 3] + i[(k + 2) % 3] + wide);
        });
}

CELL_CASE("shape: a box is its two halves, and a very short capsule a ball") {
    cell::dice dice(5);
    for (int i = 0; i < 200; ++i) {
        const S density = dice.real(0.5, 4);
        const box whole{dice.vec<vec>(0.25, 1.5)};
        const int cut = i % D;
        box half = whole;
        half.half_extents[cut] = half.half_extents[cut] * S(0.5);
        transform left, right;
        left.position[cut] = -half.half_extents[cut];
        right.position[cut] = half.half_extents[cut];
        const mass_properties part = mass_of(half, density), all = mass_of(whole, density);
        const mass_properties joined = combined(transformed(part, left), transformed(part, right));
        const double allowed = 64 * epsilon * (1 + cell::number(density)) * 8;
        REQUIRE(std::abs(cell::number(joined.mass - all.mass)) <= allowed);
        REQUIRE(near(joined.center, reals{}, 8));
        REQUIRE(size(principal(joined.inertia) - principal(all.inertia)) <= 4 * allowed);

        const S radius = dice.real(0.25, 1.5);
        const mass_properties round = mass_of(ball{radius}, density);
        const mass_properties nearly = mass_of(capsule{cell::traits::epsilon(), radius}, density);
        REQUIRE(std::abs(cell::number(round.mass - nearly.mass)) <= 4 * allowed);
        REQUIRE(size(principal(round.inertia) - principal(nearly.inertia)) <= 16 * allowed);
    }
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
/// Checks that every bad number in one field is refused with its name; `set` puts a number there.
template <class Shape, class Set>
void refuses(const char* field, bool only_positive, Set&& set) {
    std::vector<double> bad;
    if (only_positive) bad = {0, -1, -0.5};
    if (!cell::is_fixed) bad.insert(bad.end(), {std::nan(""), HUGE_VAL, -HUGE_VAL});
    for (const double value : bad) {
        CAPTURE(value);
        Shape shape;
        CHECK(refusal(shape) == "");
        set(shape, S(value));
        char expected[100];
        std::snprintf(expected, sizeof expected, "physics: create_shape: %s is %.9g; ", field, value);
        const std::string said = refusal(shape);
        CHECK_MESSAGE(said.rfind(expected, 0) == 0, said);
    }
}

CELL_CASE("shape: bad numbers are refused by name and value") {
    refuses<ball>("radius", true, [](ball& b, S x) { b.radius = x; });
    refuses<capsule>("half_length", true, [](capsule& c, S x) { c.half_length = x; });
    refuses<capsule>("radius", true, [](capsule& c, S x) { c.radius = x; });
    const char* const extents[] = {"half_extents.x", "half_extents.y", "half_extents.z"};
    const char* const normals[] = {"normal.x", "normal.y", "normal.z"};
    for (int i = 0; i < D; ++i) {
        refuses<box>(extents[i], true, [&](box& b, S x) { b.half_extents[i] = x; });
        refuses<halfspace>(normals[i], false, [&](halfspace& h, S x) { h.normal[i] = x; });
    }
    refuses<halfspace>("offset", false, [](halfspace& h, S x) { h.offset = x; });
    cell::dice dice(6);
    for (const double length : {0.0, 0.5, 0.99, 1.01, 2.0, 100.0}) {
        CAPTURE(length);
        const halfspace h{from_reals(random_direction(dice) * length), S(1)};
        CHECK(refusal(h).rfind("physics: create_shape: length of normal is ", 0) == 0);
    }
    for (int i = 0; i < 100; ++i) {
        const halfspace h{from_reals(random_direction(dice)), dice.real(-9, 9)};
        CHECK(refusal(h) == "");
    }
}

CELL_CASE("shape: a value of the closed set is the shape that went in") {
    using other = physics::ball<S, 5 - D>;
    static_assert(any_shape::kinds == kinds);
    static_assert(any_shape::kind_of<ball>() == 0 && any_shape::kind_of<halfspace>() == 3);
    static_assert(any_shape::kind_of<other>() == -1 && !std::constructible_from<any_shape, other>);
    constexpr std::size_t largest = sizeof(halfspace) > sizeof(box) ? sizeof(halfspace) : sizeof(box);
    static_assert(sizeof(any_shape) <= largest + (alignof(S) > 4 ? alignof(S) : 4));
    CHECK(any_shape{}.kind() == 0);
    CHECK(any_shape{}.get<ball>().radius == ball{}.radius);
    cell::dice dice(7);
    for (int i = 0; i < 200; ++i) {
        const transform at = random_transform(dice, 4);
        const auto holds = [&](const auto& shape, int kind) {
            using shape_type = std::remove_cvref_t<decltype(shape)>;
            any_shape any = shape, copy;
            copy = any;
            any = ball{S(9)};
            REQUIRE(copy.kind() == kind);
            REQUIRE(bounds(copy, at) == bounds(shape, at));
            const bool same =
                copy.visit([](const auto& s) { return std::same_as<std::remove_cvref_t<decltype(s)>, shape_type>; });
            REQUIRE(same);
            // The same shape with other scalars; doubles and these floats lose nothing.
            const auto wide = shape.template as<double>();
            REQUIRE(bounds(any_shape(wide.template as<S>()), at) == bounds(shape, at));
        };
        holds(random_shape(0, dice, 0.1, 2).get<ball>(), 0);
        holds(random_shape(1, dice, 0.1, 2).get<capsule>(), 1);
        holds(random_shape(2, dice, 0.1, 2).get<box>(), 2);
        holds(random_shape(3, dice, 0.1, 2).get<halfspace>(), 3);
    }
}

}  // namespace shape_laws
}  // namespace
