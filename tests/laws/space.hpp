// Laws of vectors, matrices, transforms and boxes; those of rotations and of inertia are next door.
#pragma once

#include "inertias.hpp"
#include "reals.hpp"
#include "rotations.hpp"

template struct physics::vec<cell::scalar, cell::dimension>;
template struct physics::mat<cell::scalar, cell::dimension>;
template struct physics::transform<cell::scalar, cell::dimension>;
template struct physics::twist<cell::scalar, cell::dimension>;
template struct physics::aabb<cell::scalar, cell::dimension>;
template struct physics::space<cell::scalar, cell::dimension>;

namespace {
namespace space_laws {

using aabb = cell::space::aabb;

CELL_CASE("vec: components, literals and operators") {
    vec v = vec::filled(S(2));
    for (int i = 0; i < D; ++i) CHECK(v[i] == S(2));
    v[1] = S(-3);
    CHECK(v.y == S(-3));
    CHECK(largest(v) == S(3));
    CHECK(abs(v).y == S(3));
    CHECK(vec{} == vec::filled(S(0)));
    CHECK(v + (-v) == vec{});
    CHECK(v - v == vec{});
    CHECK(v * S(0.5) + S(0.5) * v == v);
    CHECK((v / S(2)) * S(2) == v);
    vec w = v;
    w += v;
    w -= v * S(3);
    w *= S(-1);
    CHECK(w == v);
    CHECK(min(v, vec{}).y == S(-3));
    CHECK(max(v, vec{}).y == S(0));
    CHECK(max(v, vec{}).x == S(2));
    CHECK(physics::vec<S, 2>{0, -10} == physics::vec<S, 2>(S(0), S(-10)));
    CHECK(physics::vec<S, 3>{0, -10.0, 0.5f} == physics::vec<S, 3>(S(0), S(-10), S(0.5)));
}

template <class T, int Size>
struct by_members;
template <class T>
struct by_members<T, 2> {
    T x, y;
};
template <class T>
struct by_members<T, 3> {
    T x, y, z;
};
/// As std::array and Eigen's.
template <class T>
struct by_index {
    enum { SizeAtCompileTime = D };
    T values[D];
    T& operator[](int i) { return values[i]; }
    const T& operator[](int i) const { return values[i]; }
};
template <class T>
struct quaternion {
    T x, y, z, w;
};
template <class V>
void check_foreign() {
    V v{};
    if constexpr (requires { v[0]; }) {
        for (int i = 0; i < D; ++i) v[i] = static_cast<std::remove_cvref_t<decltype(v[0])>>(i + 2);
    } else {
        v.x = static_cast<decltype(v.x)>(2);
        v.y = static_cast<decltype(v.x)>(3);
        if constexpr (D == 3) v.z = static_cast<decltype(v.x)>(4);
    }
    const vec own(v);
    for (int i = 0; i < D; ++i) CHECK(own[i] == S(i + 2));
    CHECK(vec(physics::to<V>(own)) == own);
}
CELL_CASE("vec: vectors of other libraries become vectors and back, by themselves where no number changes") {
    check_foreign<by_members<S, D>>();
    check_foreign<by_index<S>>();
    if constexpr (std::constructible_from<S, float> && std::constructible_from<float, S>) {
        check_foreign<by_members<float, D>>();
        check_foreign<by_index<double>>();
    }
    static_assert(std::convertible_to<by_members<S, D>, vec>);
    static_assert(std::convertible_to<by_index<S>, vec>);
    static_assert(!std::convertible_to<by_members<int, D>, vec>);
    static_assert(!std::constructible_from<vec, by_members<S, 5 - D>>);
    static_assert(!std::constructible_from<vec, quaternion<S>>);
    static_assert(!std::constructible_from<vec, S*>);
}

CELL_CASE("vec: dot and cross products obey their identities") {
    cell::dice dice(1);
    for (int i = 0; i < 2000; ++i) {
        const vec a = dice.vec<vec>(-4, 4), b = dice.vec<vec>(-4, 4), c = dice.vec<vec>(-4, 4);
        const reals x = to_reals(a), y = to_reals(b), z = to_reals(c);
        REQUIRE(dot(a, b) == dot(b, a));
        REQUIRE(near(cell::number(dot(a, b)), dot(x, y), 64));
        REQUIRE(near(cell::number(dot(a + b, c)), dot(x, z) + dot(y, z), 96));
        REQUIRE(near(cell::number(length(a)), size(x), 4));
        REQUIRE(cross(a, b) == -cross(b, a));
        REQUIRE(size(to_reals(cross(a, a))) == 0);
        REQUIRE(near(to_reals(cross(a, b)), cross(x, y), 64));
        // Lagrange: |a x b|^2 + (a . b)^2 = |a|^2 |b|^2.
        const double both = std::hypot(size(to_reals(cross(a, b))), cell::number(dot(a, b)));
        REQUIRE(near(both, size(x) * size(y), 64));
        const cell::space::angular w = to_angular({0, 0, dice.number(-4, 4)});
        REQUIRE(near(cross(w, a), cross(to_reals(w), x), 4));
    }
}

CELL_CASE("vec: fixed-point products are rounded once") {
    cell::dice dice(2);
    for (int i = 0; cell::is_fixed && i < 2000; ++i) {
        vec a, b;
        double exact = 0;
        // Few enough bits for a double to hold the exact sum.
        for (int k = 0; k < D; ++k) {
            a[k] = S(dice.below(1 << 19) * 0x1p-16 - 4);
            b[k] = S(dice.below(1 << 19) * 0x1p-16 - 4);
            exact += cell::number(a[k]) * cell::number(b[k]);
        }
        REQUIRE(dot(a, b) == S(exact));
        REQUIRE(physics::sum_of_products(a.x, b.x, a.y, b.y) ==
                S(cell::number(a.x) * cell::number(b.x) + cell::number(a.y) * cell::number(b.y)));
        REQUIRE(physics::difference_of_products(a.x, b.x, a.y, b.y) ==
                S(cell::number(a.x) * cell::number(b.x) - cell::number(a.y) * cell::number(b.y)));
    }
}

/// The smallest and the largest power of two of which a vector may be made.
struct powers {
    int least, most;
};
powers range_of_scalar() {
    const int most = std::ilogb(cell::number(cell::traits::max())) - 1;
    return {cell::is_fixed ? std::ilogb(epsilon) : most < 200 ? -126 : -1022, most};
}

CELL_CASE("vec: split finds direction and length of tiny and of huge vectors") {
    cell::dice dice(3);
    const auto [least, most] = range_of_scalar();
    for (int power = least; power <= most; ++power)
        for (int i = 0; i < 8; ++i) {
            CAPTURE(power);
            const vec v = from_reals(random_direction(dice) * std::ldexp(1.0, power));
            reals exact = to_reals(v);
            if (exact.x == 0 && exact.y == 0 && exact.z == 0) continue;
            exact = exact * std::ldexp(1.0, -power);
            const auto [direction, length] = direction_and_length_of(v);
            REQUIRE(std::abs(size(to_reals(direction)) - 1) <= 3 * epsilon);
            REQUIRE(near(direction, unit(exact), 4));
            const double step = cell::is_fixed ? epsilon * std::ldexp(1.0, -power) : 0;
            REQUIRE(std::abs(cell::number(length) * std::ldexp(1.0, -power) - size(exact)) <=
                    4 * epsilon * size(exact) + step);
            REQUIRE(normalized(v) == direction);
        }
    for (int i = 0; i < D; ++i)
        for (const double sign : {-1.0, 1.0}) {
            vec v;
            v[i] = S(sign) * cell::traits::max();
            CHECK(to_reals(normalized(v))[i] == sign);
            v[i] = S(sign * std::ldexp(1.0, least));
            CHECK(to_reals(normalized(v))[i] == sign);
            // The same with a neighbour of rounding size: nothing overflows on the way.
            v[(i + 1) % D] = v[i];
            v[i] = S(sign) * cell::traits::max();
            CHECK(to_reals(normalized(v))[i] == sign);
        }
    CHECK(normalized(vec{}) == vec{});
    CHECK(direction_and_length_of(vec{}).length == S(0));
    vec huge = vec::filled(cell::traits::max());
    CHECK(near(normalized(huge), unit(reals{1, 1, cell::is_3d ? 1.0 : 0}), 4));
}

CELL_CASE("vec: perpendicular is a unit vector across") {
    cell::dice dice(4);
    for (int i = 0; i < 1000; ++i) {
        vec n = from_reals(random_direction(dice));
        if (i < 6) {
            n = {};
            n[i % D] = S(i < 3 ? 1 : -1);
        }
        const vec p = perpendicular(n);
        REQUIRE(std::abs(size(to_reals(p)) - 1) <= 4 * epsilon);
        REQUIRE(std::abs(dot(to_reals(n), to_reals(p))) <= 4 * epsilon);
        if (cell::is_2d) REQUIRE(near(cross(to_reals(n), to_reals(p)).z, -1, 8));
    }
}

template <class Mat = physics::mat<S, D>>
Mat random_matrix(cell::dice& dice) {
    Mat m{};
    for (int i = 0; i < D; ++i) m.column[i] = dice.vec<vec>(-2, 2);
    return m;
}

CELL_CASE("mat: products, identity, transposition") {
    cell::dice dice(5);
    using mat = physics::mat<S, D>;
    for (int i = 0; i < 500; ++i) {
        const mat a = random_matrix(dice), b = random_matrix(dice);
        const vec v = dice.vec<vec>(-2, 2), w = dice.vec<vec>(-2, 2);
        reals exact;
        for (int k = 0; k < D; ++k) exact = exact + to_reals(a.column[k]) * cell::number(v[k]);
        REQUIRE(near(a * v, exact, 16));
        REQUIRE(mat::identity() * v == v);
        REQUIRE(mat::identity() * a == a);
        REQUIRE(a * mat::identity() == a);
        REQUIRE(transposed(transposed(a)) == a);
        REQUIRE(transposed_times(a, v) == transposed(a) * v);
        REQUIRE(near((a * b) * v, to_reals(a * (b * v)), 64));
        REQUIRE(near(cell::number(dot(w, a * v)), cell::number(dot(transposed_times(a, w), v)), 128));
    }
    CHECK(!(mat::identity() == mat{}));
}

CELL_CASE("transform: a group, and points go there and back") {
    cell::dice dice(7);
    for (int i = 0; i < 1000; ++i) {
        const transform a = random_transform(dice, 4), b = random_transform(dice, 4), c = random_transform(dice, 4);
        const vec p = dice.vec<vec>(-4, 4);
        REQUIRE(near(a * p, to_pose(a).apply(to_reals(p)), 24));
        REQUIRE(near((a * b) * p, to_reals(a * (b * p)), 48));
        REQUIRE(near((a * (b * c)) * p, to_reals(((a * b) * c) * p), 96));
        REQUIRE(near(inverse(a) * (a * p), to_reals(p), 48));
        REQUIRE(near(inverse_transform(a, a * p), to_reals(p), 48));
        REQUIRE(near((inverse(a) * a).position, reals{}, 48));
        REQUIRE(near((a * relative(a, b)) * p, to_reals(b * p), 64));
        REQUIRE(transform{} * p == p);
        REQUIRE(a * transform{} == a);
        REQUIRE(relative(transform{}, a) == a);
        REQUIRE(is_finite(a));
    }
}

CELL_CASE("transform: relative keeps its precision far from the origin") {
    cell::dice dice(8);
    // A power of two, so that the sums below are exact and all error is that of relative().
    const double far = cell::is_fixed ? 8192 : 0x1p20 * epsilon * 0x1p23;
    for (int i = 0; i < 500; ++i) {
        transform a{{}, random_rotation(dice)}, b{{}, random_rotation(dice)};
        reals offset;
        for (int k = 0; k < D; ++k) {
            offset[k] = dice.below(9) - 4;
            a.position[k] = S(k == 0 ? far : -far);
            b.position[k] = a.position[k] + S(offset[k]);
        }
        const transform t = relative(a, b);
        REQUIRE(near(t.position, to_pose(a).unrotate(offset), 24));
        REQUIRE(t.rotation == inverse(a.rotation) * b.rotation);
    }
}

CELL_CASE("twist: the velocity at a point is that of the turning frame") {
    cell::dice dice(9);
    using twist = cell::space::twist;
    for (int i = 0; i < 200; ++i) {
        const double speed = dice.number(0, 2);
        const reals w = random_axis(dice) * speed;
        const twist v{dice.vec<vec>(-2, 2), to_angular(w)};
        const vec r = dice.vec<vec>(-2, 2);
        REQUIRE(near(velocity_at(v, r), to_reals(v.linear) + cross(to_reals(v.angular), to_reals(r)), 16));
        REQUIRE(near(velocity_at(v + v, r), to_reals(velocity_at(v, r)) * 2, 8));
    }
}

CELL_CASE("aabb: overlap, contains, merged and grown agree with their points") {
    cell::dice dice(12);
    const auto holds = [](const aabb& box, const vec& p) { return contains(box, aabb{p, p}); };
    for (int i = 0; i < 2000; ++i) {
        // Few values, so that boxes often share faces, edges and corners; some are flat.
        aabb a, b;
        vec p;
        for (int k = 0; k < D; ++k) {
            a.lower[k] = S(dice.below(5));
            a.upper[k] = a.lower[k] + S(dice.below(3));
            b.lower[k] = S(dice.below(5));
            b.upper[k] = b.lower[k] + S(dice.below(3));
            p[k] = S(dice.below(7));
        }
        bool share = false, inside = true;
        // Every point of the lattice; corners lie on it, so it decides.
        for (int n = 0; n < (cell::is_2d ? 49 : 343); ++n) {
            const vec q = from_reals({double(n % 7), double(n / 7 % 7), double(n / 49)});
            share = share || (holds(a, q) && holds(b, q));
            inside = inside && (!holds(b, q) || holds(a, q));
        }
        REQUIRE(overlap(a, b) == share);
        REQUIRE(overlap(b, a) == share);
        REQUIRE(contains(a, b) == inside);
        bool within = true;
        for (int k = 0; k < D; ++k) within = within && p[k] >= a.lower[k] && p[k] <= a.upper[k];
        REQUIRE(holds(a, p) == within);
        const aabb both = merged(a, b);
        REQUIRE(contains(both, a));
        REQUIRE(contains(both, b));
        REQUIRE(both == merged(b, a));
        for (int k = 0; k < D; ++k) {
            REQUIRE((both.lower[k] == a.lower[k] || both.lower[k] == b.lower[k]));
            REQUIRE((both.upper[k] == a.upper[k] || both.upper[k] == b.upper[k]));
        }
        REQUIRE(overlap(grown(a, S(3)), grown(b, S(3))));
        REQUIRE(grown(grown(a, S(2)), S(-2)) == a);
        REQUIRE(grown(a, S(1)).upper - grown(a, S(1)).lower == a.upper - a.lower + vec::filled(S(2)));
    }
}

}  // namespace space_laws
}  // namespace
