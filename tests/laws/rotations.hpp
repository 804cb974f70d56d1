// Laws of rotations.
#pragma once

#include "reals.hpp"

template struct physics::rotation<cell::scalar, cell::dimension>;

namespace {

CELL_CASE("rotation: a group of isometries") {
    cell::dice dice(20);
    for (int i = 0; i < 2000; ++i) {
        const rotation a = random_rotation(dice), b = random_rotation(dice), c = random_rotation(dice);
        const vec v = dice.vec<vec>(-4, 4), w = dice.vec<vec>(-4, 4);
        REQUIRE(norm_error(a) <= cell::tolerance(4));
        REQUIRE(near(inverse(a) * (a * v), to_reals(v), 24));
        REQUIRE(near(inverse_rotate(a, v), to_reals(inverse(a) * v), 24));
        REQUIRE(near_rotation(inverse(a) * a, rotation{}, 8));
        REQUIRE(near_rotation(a * inverse(a), rotation{}, 8));
        REQUIRE(near_rotation((a * b) * c, a * (b * c), 16));
        REQUIRE(near((a * b) * v, to_reals(a * (b * v)), 24));
        REQUIRE(rotation{} * v == v);
        REQUIRE(a * rotation{} == a);
        REQUIRE(near(cell::number(length(a * v)), size(to_reals(v)), 12));
        REQUIRE(near(cell::number(dot(a * v, a * w)), dot(to_reals(v), to_reals(w)), 128));
        const reals crossed = cross(to_reals(v), to_reals(w));
        REQUIRE(near(to_reals(cross(a * v, a * w)), cell::is_2d ? crossed : to_pose({{}, a}).rotate(crossed), 128));
        REQUIRE(is_finite(a));
    }
}

CELL_CASE("rotation: the matrix says the same") {
    cell::dice dice(21);
    for (int i = 0; i < 1000; ++i) {
        const rotation a = random_rotation(dice), b = random_rotation(dice);
        const vec v = dice.vec<vec>(-4, 4);
        const auto m = matrix(a);
        REQUIRE(near(m * v, to_reals(a * v), 24));
        REQUIRE(near(transposed_times(m, v), to_reals(inverse_rotate(a, v)), 24));
        const auto product = m * matrix(b);
        for (int k = 0; k < D; ++k) {
            REQUIRE(near(product.column[k], to_reals(matrix(a * b).column[k]), 12));
            for (int j = 0; j < D; ++j)
                REQUIRE(std::abs(dot(to_reals(m.column[k]), to_reals(m.column[j])) - (j == k ? 1 : 0)) <= 12 * epsilon);
        }
        // Right-handed.
        const reals last = cell::is_2d ? reals{0, 0, 1} : to_reals(m.column[D - 1]);
        REQUIRE(near(to_reals(cross(m.column[0], m.column[1])), last, 12));
    }
}

CELL_CASE("rotation: counter-clockwise, by the angle given") {
    cell::dice dice(22);
    vec x, y;
    x.x = S(1);
    y.y = S(1);
    CHECK(near(rotation_about({0, 0, 1}, M_PI / 2) * x, to_reals(y), 4));
    for (int i = 0; i < 1000; ++i) {
        const reals axis = random_axis(dice);
        const double angle = cell::number(dice.real(-20, 20));
        const vec v = dice.vec<vec>(-1, 1);
        REQUIRE(near(rotation_about(axis, angle) * v, turn(to_reals(v), axis, angle), 24));
    }
}

CELL_CASE("rotation: turned goes by the angle given, in all its ranges") {
    cell::dice dice(23);
    const double limit = cell::is_fixed ? 10000 : 1e6;
    // At half a radian in 2D and one in 3D the method changes.
    std::vector<double> angles{0, 0.4999, 0.5001, 0.9999, 1.0001, M_PI, 3.2, 2 * M_PI, 6.3, 100, limit};
    for (double angle = 0.7; angle > epsilon * 16; angle *= 0.7) angles.push_back(angle);
    for (const double angle : angles)
        for (int i = 0; i < 8; ++i) {
            CAPTURE(angle);
            const rotation a = random_rotation(dice);
            const reals axis = random_axis(dice);
            const cell::space::angular turn_by = to_angular(axis * angle);
            const rotation b = turned(a, turn_by);
            const vec v = from_reals(random_direction(dice));
            const reals w = to_reals(turn_by);
            const double exact = size(w), half = exact / (cell::is_2d ? 2 : 4);
            const reals expected = turn(to_reals(a * v), exact > 0 ? unit(w) : reals{0, 0, 1}, exact);
            // The series' rest: the next term's coefficient is 1382 / 155925.
            const double series = half > 0.2501 ? 0 : exact * 0.0095 * std::pow(half * half, 5);
            // In space the length of a rotation vector is rounded, in the plane the angle is given.
            const double rounded = cell::is_3d ? exact * 2 * epsilon : 0;
            REQUIRE(size(to_reals(b * v) - expected) <= 24 * epsilon + series + rounded);
            REQUIRE(norm_error(b) <= cell::tolerance(6));
        }
}

CELL_CASE("rotation: a hundred thousand turns keep length 1 and lose no angle") {
    cell::dice dice(24);
    for (const double angle : {0.001, 0.1, 0.7, 3.0}) {
        CAPTURE(angle);
        const int turns = 100000;
        const reals axis = cell::is_2d ? reals{0, 0, 1} : reals{0.6, -0.48, 0.64};
        const cell::space::angular turn_by = to_angular(axis * angle);
        const reals w = to_reals(turn_by);
        rotation r;
        S worst(0);
        for (int i = 0; i < turns; ++i) {
            r = turned(r, turn_by);
            worst = physics::max(worst, norm_error(r));
        }
        CHECK(worst <= cell::tolerance(8));
        const double half = size(w) / (cell::is_2d ? 2 : 4);
        const double series = half > 0.25 ? 0 : size(w) * 0.0095 * std::pow(half * half, 5);
        const double expected = size(w) * turns;
        vec v;
        v.x = S(1);
        const reals at = turn({1, 0, 0}, unit(w), expected);
        // Roundings are at most 4 spacings a turn.
        CHECK(size(to_reals(r * v) - at) <= turns * (4 * epsilon + series));
    }
}

CELL_CASE("rotation: the rotation vector leads back") {
    cell::dice dice(25);
    for (int i = 0; i < 2000; ++i) {
        const rotation r = random_rotation(dice);
        const reals w = to_reals(rotation_vector(r));
        REQUIRE(size(w) <= M_PI * (1 + 4 * epsilon) + 4 * epsilon);
        REQUIRE(near_rotation(rotation_about(size(w) > 0 ? unit(w) : reals{0, 0, 1}, size(w)), r, 24));
    }
    for (double angle = 3; angle > 64 * epsilon; angle *= 0.5) {
        CAPTURE(angle);
        const reals axis = random_axis(dice);
        const reals w = to_reals(rotation_vector(rotation_about(axis, angle)));
        CHECK(size(w - axis * angle) <= 8 * epsilon * (cell::is_fixed ? 1 : angle));
    }
    CHECK(size(to_reals(rotation_vector(rotation{}))) == 0);
    // Half a turn: either sign of the axis is right.
    const reals half = to_reals(rotation_vector(rotation_about({0, 0, 1}, M_PI)));
    CHECK(std::abs(size(half) - M_PI) <= 4 * epsilon);
}

CELL_CASE("rotation: normalized repairs any length") {
    cell::dice dice(26);
    for (int power = -12; power <= 12; ++power) {
        CAPTURE(power);
        const rotation r = random_rotation(dice);
        std::vector<S> scaled = parts_of(r);
        for (S& part : scaled) part *= S(std::ldexp(1.0, power));
        const rotation wrong = rotation_of(scaled);
        if (power != 0) CHECK(norm_error(wrong) > cell::tolerance(64));
        const rotation repaired = normalized(wrong);
        CHECK(norm_error(repaired) <= cell::tolerance(4));
        const double lost = cell::is_fixed && power < 0 ? std::ldexp(1.0, -power) : 1;
        CHECK(near_rotation(repaired, r, 8 * lost));
    }
    // Nothing to go by: the identity.
    CHECK(normalized(rotation_of(std::vector<S>(4, S(0)))) == rotation{});
}

CELL_CASE("rotation: is_finite finds every bad component") {
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL})
        for (std::size_t i = 0; i < parts_of(rotation{}).size() && !cell::is_fixed; ++i) {
            std::vector<S> parts = parts_of(rotation{});
            parts[i] = S(bad);
            CHECK(!is_finite(rotation_of(parts)));
        }
}

inline vec axis_of(double x, double y, double z) {
    vec v;
    const double all[] = {x, y, z};
    for (int i = 0; i < cell::dimension; ++i) v[i] = S(all[i]);
    return v;
}
template <class F>
std::string refused_axis(F&& make) {
    try {
        make();
    } catch (const physics::error& error) {
        return error.what();
    }
    return "";
}
CELL_CASE("rotation: axes go where they are told, by the shortest turn") {
    cell::dice dice(27);
    const vec x = axis_of(1, 0, 0);
    for (int i = 0; i < 1000; ++i) {
        const vec v = dice.vec<vec>(-4, 4);
        if (size(to_reals(v)) < 0.25) continue;
        const rotation r = rotation::from_x_axis(v);
        CHECK(norm_error(r) <= cell::tolerance(4));
        CHECK(near(r * x, unit(to_reals(v)), 32));
        const double cosine = unit(to_reals(v)).x;
        CHECK(std::abs(size(to_reals(rotation_vector(r))) - std::acos(cosine)) < 1e-3);
#if CELL_DIMENSION == 3
        const vec z = axis_of(0, 0, 1), other = dice.vec<vec>(-4, 4);
        CHECK(near(rotation::from_z_axis(v) * z, unit(to_reals(v)), 32));
        if (size(cross(to_reals(v), to_reals(other))) < 1) continue;
        const rotation both = rotation::from_axes(v, other);
        CHECK(near(both * x, unit(to_reals(v)), 64));
        // No nearer to the other than in its plane.
        const reals across = cross(unit(to_reals(v)), unit(to_reals(other)));
        CHECK(std::abs(dot(to_reals(both * z), across)) < 512 * epsilon);
        CHECK(dot(to_reals(both * z), to_reals(other)) > 0);
#endif
    }
    for (const vec& v : {x, axis_of(-1, 0, 0), axis_of(-64, 0, 0), axis_of(-1, 1.0 / 1024, 0)})
        CHECK(near(rotation::from_x_axis(v) * x, unit(to_reals(v)), 32));
    CHECK(rotation::from_x_axis(x) == rotation{});
}
CELL_CASE("rotation: axes without a direction are refused by name") {
    CHECK(refused_axis([] { (void)rotation::from_x_axis(vec{}); }) ==
          "physics: from_x_axis: axis is 0; it must have a length");
    if constexpr (!cell::is_fixed)
        CHECK(refused_axis([] { (void)rotation::from_x_axis(axis_of(0, std::nan(""), 0)); }) ==
              "physics: from_x_axis: axis.y is nan; it must be finite");
#if CELL_DIMENSION == 3
    const vec z = axis_of(0, 0, 1);
    CHECK(refused_axis([] { (void)rotation::from_z_axis(vec{}); }).find("axis is 0") != std::string::npos);
    CHECK(refused_axis([&] { (void)rotation::from_axes(vec{}, z); }).find("x_axis is 0") != std::string::npos);
    CHECK(refused_axis([&] { (void)rotation::from_axes(z, vec{}); }).find("z_axis is 0") != std::string::npos);
    CHECK(refused_axis([&] { (void)rotation::from_axes(z, axis_of(0, 0, -2)); }).find("along x_axis") !=
          std::string::npos);
#endif
}

}  // namespace
