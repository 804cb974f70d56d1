// Laws of symmetric matrices, mass and inertia.
#pragma once

#include "reals.hpp"

template struct physics::symmetric<cell::scalar>;
template struct physics::mass_properties<cell::scalar, cell::dimension>;

namespace {

using mass_properties = cell::space::mass_properties;
using physics::times;

/// A symmetric matrix by its axes (a rotation) and the entries along them.
template <class Rotation>
physics::symmetric<S> symmetric_of(const Rotation& axes, reals diagonal) {
    return rotated(physics::symmetric<S>::diagonal(S(diagonal.x), S(diagonal.y), S(diagonal.z)), matrix(axes));
}
template <class I>
reals times(const physics::symmetric<I>& m, reals v) {
    const auto number = [](I x) { return static_cast<double>(x); };
    return {number(m.xx) * v.x + number(m.xy) * v.y + number(m.xz) * v.z,
            number(m.xy) * v.x + number(m.yy) * v.y + number(m.yz) * v.z,
            number(m.xz) * v.x + number(m.yz) * v.y + number(m.zz) * v.z};
}

CELL_CASE("symmetric: times, rotated and inverse") {
    cell::dice dice(6);
    using vec3 = physics::vec<S, 3>;
    using inverse_type = cell::space::inverse;
    for (int i = 0; i < 1000; ++i) {
        const auto axes = random_rotation<3>(dice);
        const reals diagonal{dice.number(0.25, 8), dice.number(0.25, 8), dice.number(0.25, 8)};
        const auto m = symmetric_of(axes, diagonal);
        const vec3 v = dice.vec<vec3>(-2, 2);
        const reals x{cell::number(v.x), cell::number(v.y), cell::number(v.z)};
        const auto product = times(m, v);
        REQUIRE(size(reals{cell::number(product.x), cell::number(product.y), cell::number(product.z)} - times(m, x)) <=
                64 * epsilon * (1 + size(x)));

        // Rotated: its axes are the rotation's, its trace stays.
        const vec3 e = axes * vec3{S(1), S(0), S(0)};
        const reals along{cell::number(e.x), cell::number(e.y), cell::number(e.z)};
        REQUIRE(size(times(m, along) - along * diagonal.x) <= 128 * epsilon);
        REQUIRE(std::abs(cell::number(m.xx + m.yy + m.zz) - (diagonal.x + diagonal.y + diagonal.z)) <= 128 * epsilon);

        // Inverse: the condition is at most 32, and the inverse at most 4.
        const auto inverted = physics::inverse<inverse_type>(m);
        REQUIRE(size(times(inverted, times(m, x)) - x) <= 2048 * epsilon * size(x));
    }
    using physics::symmetric;
    const auto inverse_of = [](const symmetric<S>& m) { return physics::inverse<inverse_type>(m); };
    CHECK(inverse_of(symmetric<S>::diagonal(S(2), S(4), S(0.5))) ==
          symmetric<inverse_type>::diagonal(inverse_type(0.5), inverse_type(0.25), inverse_type(2)));
    CHECK(inverse_of({}) == symmetric<inverse_type>{});
    CHECK(inverse_of(symmetric<S>::diagonal(S(1), S(1), S(0))) == symmetric<inverse_type>{});
    CHECK(inverse_of(symmetric<S>::diagonal(S(1), S(-1), S(1))) == symmetric<inverse_type>{});
    CHECK(inverse_of({S(1), S(1), S(1), S(1), S(0), S(0)}) == symmetric<inverse_type>{});
    CHECK(inverse_of({S(1), S(2), S(1), S(0), S(2), S(0)}) == symmetric<inverse_type>{});
}

/// A body of point masses, and what is known of it by direct sums.
struct points {
    std::vector<double> mass;
    std::vector<reals> at;

    double total() const {
        double sum = 0;
        for (const double m : mass) sum += m;
        return sum;
    }
    reals center() const {
        reals sum;
        for (std::size_t i = 0; i < mass.size(); ++i) sum = sum + at[i] * mass[i];
        return sum * (1 / total());
    }
    /// The moment of momentum about the centre while it turns with w.
    reals momentum(reals w) const {
        reals sum;
        for (std::size_t i = 0; i < mass.size(); ++i) {
            const reals r = at[i] - center();
            sum = sum + cross(r, cross(w, r)) * mass[i];
        }
        return sum;
    }
};
/// The same in the plane, for inertias and their inverses.
template <physics::scalar_type I>
reals times(I inertia, reals w) {
    return w * static_cast<double>(inertia);
}

CELL_CASE("inertia: combined masses are the sum of their points") {
    cell::dice dice(10);
    for (int i = 0; i < 300; ++i) {
        points body;
        mass_properties forwards, backwards;
        std::vector<mass_properties> single;
        const int count = 2 + dice.below(8);
        for (int k = 0; k < count; ++k) {
            const S mass = dice.real(0.1, 4);
            const vec at = dice.vec<vec>(-2, 2);
            single.push_back({mass, at, {}});
            body.mass.push_back(cell::number(mass));
            body.at.push_back(to_reals(at));
        }
        for (int k = 0; k < count; ++k) {
            forwards = combined(forwards, single[static_cast<std::size_t>(k)]);
            backwards = combined(single[static_cast<std::size_t>(count - 1 - k)], backwards);
        }
        const transform t = random_transform(dice, 2);
        const mass_properties moved = transformed(forwards, t);
        for (int k = 0; k < 3; ++k) {
            const reals w = random_axis(dice);
            const double allowed = 256 * epsilon * (1 + body.total()) * 16;
            REQUIRE(near(cell::number(forwards.mass), body.total(), 16));
            REQUIRE(near(forwards.center, body.center(), 64));
            REQUIRE(size(times(forwards.inertia, w) - body.momentum(w)) <= allowed);
            REQUIRE(near(backwards.center, body.center(), 64));
            REQUIRE(size(times(backwards.inertia, w) - body.momentum(w)) <= allowed);
            points elsewhere = body;
            for (reals& p : elsewhere.at) p = to_pose(t).apply(p);
            REQUIRE(near(moved.center, elsewhere.center(), 96));
            REQUIRE(size(times(moved.inertia, w) - elsewhere.momentum(w)) <= 2 * allowed);
        }
    }
    const mass_properties nothing, something{S(2), vec::filled(S(1)), {}};
    CHECK(combined(nothing, something).mass == S(2));
    CHECK(combined(nothing, something).center == something.center);
    CHECK(combined(something, nothing).center == something.center);
    CHECK(combined(nothing, nothing).mass == S(0));
}

CELL_CASE("inertia: the inverse undoes it, in the body's axes and in the world's") {
    cell::dice dice(11);
    for (int i = 0; i < 500; ++i) {
        // A body of four points is as stiff about one axis as about any other, within a factor of about ten.
        mass_properties m;
        for (int k = 0; k < 4; ++k) {
            vec at = dice.vec<vec>(-0.5, 0.5);
            at[k % D] = at[k % D] + S(k < 2 ? 2 : -2);
            m = combined(m, {S(1), at, {}});
        }
        const auto inverse = physics::inverted_inertia(m.inertia);
        const reals w = random_axis(dice) * 2;
        REQUIRE(size(times(inverse, times(m.inertia, w)) - w) <= 1024 * epsilon);
        const transform t{{}, random_rotation(dice)};
        const auto turned_inverse = physics::in_world<S>(inverse, t.rotation);
        REQUIRE(size(times(turned_inverse, times(transformed(m, t).inertia, w)) - w) <= 1024 * epsilon);
        const cell::space::angular moment = to_angular(w);
        REQUIRE(size(to_reals(times(turned_inverse, moment)) - times(turned_inverse, to_reals(moment))) <=
                16 * epsilon);
    }
    CHECK(physics::inverted_inertia(S(4)) == cell::space::inverse(0.25));
    CHECK(physics::inverted_inertia(S(0)) == cell::space::inverse(0));
    CHECK(physics::inverted_inertia(S(-1)) == cell::space::inverse(0));
}

}  // namespace
