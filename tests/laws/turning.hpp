// Laws of how bodies turn in space by their own inertia.
#pragma once

#include <algorithm>
#include <vector>

#include "impulses.hpp"

#if CELL_DIMENSION == 3

namespace {
namespace turning_laws {

CELL_CASE("integrator: principal axes make an inertia diagonal, and its free spin knows the odd one") {
    cell::dice dice(206);
    for (int i = 0; i < 500; ++i) {
        const double size = std::exp2(dice.number(-20, 20));
        double moments[] = {size, size * dice.number(1, 2), 0};
        // One may equal another, and a needle has one that is tiny.
        if (i % 4 == 0) moments[1] = moments[0];
        moments[2] = i % 3 == 0 ? size * 0x1p-12 : size * dice.number(1, 2);
        const auto turn = normalized(physics::rotation<double, 3>{dice.number(-1, 1), dice.number(-1, 1),
                                                                  dice.number(-1, 1), dice.number(-1, 1)});
        const auto inertia =
            rotated(physics::symmetric<double>::diagonal(moments[0], moments[1], moments[2]), matrix(turn));
        const auto p = physics::detail::principal_axes_of(inertia);
        REQUIRE(std::abs(physics::detail::squared_norm(p.axes) - 1) <= 1e-15);
        const auto back =
            rotated(physics::symmetric<double>::diagonal(p.moments[0], p.moments[1], p.moments[2]), matrix(p.axes));
        const double most = 1e-14 * size;
        REQUIRE(std::abs(back.xx - inertia.xx) <= most);
        REQUIRE(std::abs(back.yy - inertia.yy) <= most);
        REQUIRE(std::abs(back.zz - inertia.zz) <= most);
        REQUIRE(std::abs(back.xy - inertia.xy) <= most);
        REQUIRE(std::abs(back.xz - inertia.xz) <= most);
        REQUIRE(std::abs(back.yz - inertia.yz) <= most);
    }
    // The axis about which a needle turns most easily is the third; the other two are alike.
    for (int axis = 0; axis < 3; ++axis) {
        physics::vec<S, 3> moments = physics::vec<S, 3>::filled(S(2));
        moments[axis] = S(1.0 / 64);
        const physics::solver_api::free_spin<S, 3> spin(
            physics::symmetric<S>::diagonal(moments.x, moments.y, moments.z));
        REQUIRE(std::abs(static_cast<double>(spin.first) - 0.5) <= 1e-5);
        REQUIRE(std::abs(static_cast<double>(spin.second)) <= 1e-5);
        REQUIRE(std::abs(static_cast<double>(spin.third) - 63.5) <= 1e-2);
        physics::vec<S, 3> third;
        third.z = S(1);
        REQUIRE(std::abs(cell::number((spin.axes * third)[axis])) >= 0.999);
    }
}

/// Bodies in space that turn by themselves or not, some of them so fast that it takes trigonometry.
struct turning_bodies {
    std::vector<physics::solver_api::body<S, 3>> tops;
    std::vector<physics::solver_api::solver_body<S, 3>> solved;
    std::vector<physics::solver_api::moving_body<S, 3>> moved;

    turning_bodies(cell::dice& dice, std::size_t count) : tops(count), solved(count + 2), moved(count) {
        for (std::size_t k = 0; k < count; ++k) {
            const auto turn = normalized(
                physics::rotation<S, 3>{dice.real(-1, 1), dice.real(-1, 1), dice.real(-1, 1), dice.real(-1, 1)});
            const double fast = dice.below(8) ? 4 : 400;
            solved[k].velocity = {dice.vec<vec>(-4, 4), dice.vec<vec>(-fast, fast)};
            solved[k].displacement = {dice.vec<vec>(-1, 1), dice.vec<vec>(-1, 1)};
            moved[k].rotation = turn;
            if (dice.below(3) == 0) continue;
            const double a = dice.number(0.5, 1), b = dice.below(3) ? dice.number(0.5, 1) : a;
            const auto diagonal = physics::symmetric<S>::diagonal(S(a), S(b), S(dice.number(0.5, 1)));
            tops[k].mass.inertia = rotated(diagonal, matrix(turn));
            tops[k].inverse_inertia = physics::inverted_inertia(tops[k].mass.inertia);
            tops[k].spin = physics::solver_api::free_spin<S, 3>(tops[k].mass.inertia);
            moved[k].gyroscopic = &tops[k];
        }
    }
    /// Some of them, in lanes; what their spins have changed by goes to `changed`.
    void advance_in_lanes(std::size_t first, std::size_t count, S h, std::vector<physics::twist<S, 3>>& changed,
                          int parts = 1) {
        std::vector<physics::solver_api::solver_body<S, 3>> some(count + 2);
        std::copy_n(solved.begin() + static_cast<std::ptrdiff_t>(first), count, some.begin());
        physics::arena scratch;
        scratch.reset();
        physics::detail::pose_lanes<S, 3, true> lanes({some.data(), static_cast<std::uint32_t>(count + 2)},
                                                      moved.data() + first, scratch);
        std::vector<physics::twist<S, 3>> begun(count + 2);
        physics::detail::task_runner alone;
        for (int i = 0; i < parts; ++i) lanes.advance(h, begun.data(), alone);
        lanes.finish(0, static_cast<std::uint32_t>(count));
        std::copy_n(some.begin(), count, solved.begin() + static_cast<std::ptrdiff_t>(first));
        changed.assign(begun.begin(), begun.end());
    }
};
/// What a body's motion has, in double.
struct spin_state {
    double energy, momentum;
};
spin_state state_of(const turning_bodies& b, std::size_t k) {
    const auto turn = [&](const reals& v, double displacement) {
        const auto& q = b.moved[k].rotation;
        const reals u = to_reals(q.imaginary()) * displacement;
        const double w = cell::number(q.w), unit = dot(u, u) + w * w;
        return v + (cross(u, v) * w + cross(u, cross(u, v))) * (2 / unit);
    };
    const reals spin = turn(to_reals(b.solved[k].velocity.angular), -1);
    const auto& i = b.tops[k].mass.inertia;
    const auto row = [&](S x, S y, S z) {
        return cell::number(x) * spin.x + cell::number(y) * spin.y + cell::number(z) * spin.z;
    };
    const reals momentum{row(i.xx, i.xy, i.xz), row(i.xy, i.yy, i.yz), row(i.xz, i.yz, i.zz)};
    return {dot(spin, momentum) / 2, size(momentum)};
}
CELL_CASE("integrator: free spins neither gain nor lose momentum in the mean, and no more with more substeps") {
    constexpr std::size_t count = 96;
    constexpr int steps = 60;
    std::vector<double> spread;
    // In lanes, in parts; and one by one.
    for (const int parts : {1, 4, 0}) {
        cell::dice dice(2050);
        turning_bodies b(dice, count);
        std::vector<double> start;
        for (std::size_t k = 0; k < count; ++k) {
            const auto diagonal = physics::symmetric<S>::diagonal(dice.real(1, 2), dice.real(1, 2), dice.real(1, 2));
            // Half of them with principal axes that are not the body's.
            b.tops[k].mass.inertia = k % 2 ? rotated(diagonal, matrix(b.moved[k].rotation)) : diagonal;
            b.tops[k].inverse_inertia = physics::inverted_inertia(b.tops[k].mass.inertia);
            b.tops[k].spin = physics::solver_api::free_spin<S, 3>(b.tops[k].mass.inertia);
            b.moved[k].gyroscopic = &b.tops[k];
            b.solved[k].velocity.angular = dice.vec<vec>(-4, 4);
            start.push_back(state_of(b, k).momentum);
        }
        const S h = S(1.0 / (64 * (parts > 0 ? parts : 1)));
        std::vector<physics::twist<S, 3>> changed;
        for (int i = 0; i < steps; ++i) {
            if (parts > 0) b.advance_in_lanes(0, count, h, changed, parts);
            else
                for (std::size_t k = 0; k < count; ++k)
                    physics::detail::turn_freely(b.moved[k], b.solved[k].velocity.angular, h);
        }
        double mean = 0, square = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const double change = state_of(b, k).momentum / start[k] - 1;
            mean += change / count;
            square += change * change / count;
        }
        CAPTURE(parts);
        // Of roundings to either side the mean is 0, up to five of its deviations.
        CHECK(std::abs(mean) <= 5 * std::sqrt(square / count));
        spread.push_back(std::sqrt(square));
    }
    for (const double s : spread) CHECK(s <= 4 * std::sqrt(double(steps)) * epsilon);
    CHECK(spread[1] <= 1.5 * spread[0]);
}
CELL_CASE("integrator: a spin about the middle axis keeps its energy, however far it turns in a step") {
    constexpr std::size_t count = 48;
    for (const double speed : {2.0, 20.0, 200.0, 2000.0, 10000.0}) {
        for (const bool one_by_one : {false, true}) {
            cell::dice dice(2055);
            turning_bodies b(dice, count);
            std::vector<spin_state> start;
            for (std::size_t k = 0; k < count; ++k) {
                // From rods to discs; some of them are symmetric, others almost.
                const double odd = dice.number(0.2, 1.9), other = k % 4 == 0 ? 1 : k % 4 == 1 ? 1.003 : 1.2;
                auto& inertia = b.tops[k].mass.inertia;
                inertia = physics::symmetric<S>::diagonal(S(odd), S(1), S(other));
                b.tops[k].inverse_inertia = physics::inverted_inertia(inertia);
                b.tops[k].spin = physics::solver_api::free_spin<S, 3>(inertia);
                b.moved[k].gyroscopic = &b.tops[k];
                b.moved[k].rotation = {};
                b.solved[k].velocity = {};
                b.solved[k].velocity.angular = dice.vec<vec>(-0.02 * speed, 0.02 * speed);
                b.solved[k].velocity.angular[static_cast<int>(k / 4 % 3)] = S(speed);
                start.push_back(state_of(b, k));
            }
            std::vector<physics::twist<S, 3>> changed;
            double gained = 0, lost = 0, sum = 0;
            for (int i = 0; i < 300; ++i) {
                for (std::size_t k = 0; one_by_one && k < count; ++k)
                    physics::detail::turn_freely(b.moved[k], b.solved[k].velocity.angular, S(1.0 / 64));
                if (!one_by_one) b.advance_in_lanes(0, count, S(1.0 / 64), changed);
                for (std::size_t k = 0; k < count; ++k) {
                    const spin_state now = state_of(b, k);
                    const double change = std::abs(now.energy / start[k].energy - 1);
                    gained = std::max(gained, change);
                    sum += change / (300 * count);
                    lost = std::max(lost, std::abs(now.momentum / start[k].momentum - 1));
                }
            }
            CAPTURE(speed);
            CAPTURE(one_by_one);
            // As far as its turns are not split by their half a radian squared; beyond, by that of an eighth.
            CHECK(gained <= 0.02);
            CHECK(sum <= 0.002);
            CHECK(lost <= 300 * 4 * epsilon);
        }
    }
}
CELL_CASE("integrator: the principal axes that spins keep are rounded without a stretch") {
    cell::dice dice(2060);
    double error[2]{};
    for (int i = 0; i < 300; ++i) {
        const auto a = normalized(physics::rotation<double, 3>{dice.number(-1, 1), dice.number(-1, 1),
                                                               dice.number(-1, 1), dice.number(-1, 1)});
        const physics::rotation<S, 3> nearest{S(a.x), S(a.y), S(a.z), S(a.w)};
        for (const bool fitted : {false, true}) {
            const auto r = fitted ? physics::detail::rounded_rotation<S>(a) : nearest;
            const double wanted[] = {a.x, a.y, a.z, a.w};
            const S got[] = {r.x, r.y, r.z, r.w};
            // The squares and what rounding has cut off them.
            double square = -1, rest = 0;
            for (int k = 0; k < 4; ++k) {
                const double x = cell::number(got[k]), xx = x * x, sum = square + xx;
                rest += std::fma(x, x, -xx) + (std::abs(square) > xx ? square - sum + xx : xx - sum + square);
                square = sum;
                REQUIRE(std::abs(x - wanted[k]) <= 2.5 * epsilon);
            }
            error[fitted] += std::abs(square + rest);
        }
    }
    CHECK(error[1] <= 0.2 * error[0]);
    // What is exact stays so.
    CHECK(physics::detail::rounded_rotation<S>({}) == physics::rotation<S, 3>{});
}
CELL_CASE("integrator: a flywheel keeps its spin, however large its moment is beside the others") {
    for (const double large : {0.3, 3.0, 30.0}) {
        cell::dice dice(2000);
        turning_bodies b(dice, 1);
        const auto inertia = physics::symmetric<S>::diagonal(S(0.011), S(large), S(0.017));
        b.tops[0].mass.inertia = inertia;
        b.tops[0].inverse_inertia = physics::inverted_inertia(inertia);
        b.tops[0].spin = physics::solver_api::free_spin<S, 3>(inertia);
        b.moved[0].gyroscopic = &b.tops[0];
        b.moved[0].rotation = {};
        b.solved[0].velocity = {{}, {S(0), S(0.5), S(0)}};
        std::vector<physics::twist<S, 3>> changed;
        for (int i = 0; i < 2400; ++i) b.advance_in_lanes(0, 1, S(1.0 / 256), changed);
        // Roundings of turns and products.
        CAPTURE(large);
        CHECK(std::abs(cell::number(b.solved[0].velocity.angular.y) / 0.5 - 1) <= 2400 * 4 * epsilon);
    }
}
CELL_CASE("integrator: in lanes poses advance as one by one, and nobody's bits depend on who shares the lanes") {
    using integrator = physics::semi_implicit_euler::in<cell::space>;
    const S h = S(1.0 / 256);
    for (int run = 0; run < 200; ++run) {
        const std::size_t count = static_cast<std::size_t>(1 + run % 21);
        const auto made = [&] {
            cell::dice dice(static_cast<std::uint64_t>(2100 + run));
            return turning_bodies(dice, count);
        };
        turning_bodies one_by_one = made(), in_lanes = made(), alone = made();
        std::vector<physics::twist<S, 3>> changed, changed_alone;
        in_lanes.advance_in_lanes(0, count, h, changed);
        for (std::size_t k = 0; k < count; ++k) {
            auto& body = one_by_one.solved[k];
            const auto start = body.velocity.angular;
            integrator::integrate_pose(one_by_one.moved[k], body.velocity, body.displacement, h);
            const auto& lane = in_lanes.solved[k];
            const double fast = 1 + cell::number(length(start)), near_to = 64 * epsilon;
            REQUIRE(lane.displacement == body.displacement);
            REQUIRE(lane.velocity.linear == body.velocity.linear);
            REQUIRE(cell::number(length(lane.velocity.angular - body.velocity.angular)) <= 4 * near_to * fast);
            const auto gap = in_lanes.moved[k].rotation * inverse(one_by_one.moved[k].rotation);
            REQUIRE(cell::number(length(gap.imaginary())) <= near_to * fast);
            REQUIRE(cell::number(norm_error(in_lanes.moved[k].rotation)) <= near_to);
            // What a spin changes by is told as seen from the body, drawn where it was turned at the start.
            const double told = cell::number(length(start + changed[k].angular));
            REQUIRE(std::abs(told - cell::number(length(lane.velocity.angular))) <= near_to * fast);
            if (!one_by_one.moved[k].gyroscopic) REQUIRE(lane.velocity.angular == start);

            alone.advance_in_lanes(k, 1, h, changed_alone);
            REQUIRE(alone.solved[k].velocity == lane.velocity);
            REQUIRE(alone.moved[k].rotation == in_lanes.moved[k].rotation);
            REQUIRE(changed_alone[0] == changed[k]);
        }
    }
}

}  // namespace turning_laws
}  // namespace

#endif
