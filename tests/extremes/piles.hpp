// What has to bear: heavy on light, stacks, cards, chains; overlaps; other sizes; steps of other lengths.
#pragma once

#include <string>
#include <utility>

#include "stage.hpp"

namespace extremes {

/// M1: how far a cube sinks that lies on one of a part of its mass, as a share of their size.
template <class World>
double sink_of_heavy(double ratio, const work& with) {
    stage<World> s(with);
    s.floor();
    s.cube({0, 0.5, 0});
    s.cube({0, 1.5, 0}, ratio);
    s.remember();
    return s.largest(10, [&] { return s.moved(); });
}

/// M2: how far any of ten cubes gets from its place whose top one is heavy (m).
template <class World>
double sink_of_heavy_top(double ratio, const work& with) {
    stage<World> s(with);
    s.floor();
    for (int i = 0; i < 10; ++i) s.cube({0, 0.5 + i, 0}, i == 9 ? ratio : 1);
    s.remember();
    return s.largest(10, [&] { return s.moved(); });
}

template <class World>
concept has_joints = requires(const World& w) {
    w.joints();
};
/// J1: the largest gap of any joint of a chain that swings a ball of so many times a link's mass (m).
template <class World>
double gap_of_chain_by(double ratio, const typename World::settings_type& with) {
    if constexpr (has_joints<World>) {
        using joint = typename World::ball_joint;
        stage<World> s(with);
        constexpr double r = 0.125;
        const bool flat = World::dimension == 2;
        const double link = 20 * (flat ? 2 * r + pi * r * r : pi * r * r + 4 * pi * r * r * r / 3);
        const double size = flat ? pi * 64 : 4 * pi * 512 / 3;
        solid b;
        b.type = body_type::static_body;
        b.half = {0.01, 0.01, 0.01};
        body_id before = s.box(b);
        struct pin {
            body_id a, b;
            triple at_a, at_b;
        };
        std::vector<pin> pins;
        for (int i = 0; i <= 40; ++i) {
            const bool end = i == 40;
            solid next;
            next.at = {i + (end ? 8 : 0.5), 0, 0};
            next.half = {8, 8, 8};
            next.damping = 0.1;
            next.density = end ? ratio * link / size : 20;
            body_id id;
            if (end) {
                id = s.ball(next);
            } else {
                id = s.body(next);
                static_cast<void>(s.world.create_shape(
                    id, typename World::capsule{typename World::scalar(0.5), typename World::scalar(r)},
                    s.surface(next)));
            }
            pins.push_back({before, id, {i == 0 ? 0 : 0.5, 0, 0}, {end ? -8 : -0.5, 0, 0}});
            static_cast<void>(s.world.create_joint(
                before, id, joint{stage<World>::to(pins.back().at_a), stage<World>::to(pins.back().at_b)}));
            before = id;
        }
        return s.largest(20, [&] {
            double most = 0;
            for (const pin& p : pins)
                most = worse(length(s.place(p.b) + s.out_of(p.b, p.at_b) - s.place(p.a) - s.out_of(p.a, p.at_a)), most);
            return most;
        });
    } else {
        static_cast<void>(ratio), static_cast<void>(with);
        return refused;
    }
}

template <class World>
double gap_of_chain(double ratio, const work& with) {
    return gap_of_chain_by<World>(ratio, stage<World>::settings_for(with));
}
/// The same where joints are solved by iterations.
template <class World>
double gap_of_iterated_chain(double ratio, const work& with) {
    auto settings = stage<World>::settings_for(with);
    settings.solver.max_direct_cost = 0;
    return gap_of_chain_by<World>(ratio, settings);
}

/// K1: cubes that fall onto each other, each a hundredth of its size aside and a tenth above of where it comes to rest.
template <class World>
void drop_stack(stage<World>& s, int height, double scale = 1, double density = 1) {
    s.floor(0.6, 0, {}, scale);
    for (int i = 0; i < height; ++i) {
        solid b;
        b.at = triple{i % 2 ? 0.01 : -0.01, 0.55 + 1.1 * i, 0} * scale;
        b.half = b.half * scale;
        b.friction = 0.3, b.density = density;
        s.box(b);
    }
    s.remember();
}
/// How far to the side any body is from where it began (m).
template <class World>
double lateral(const stage<World>& s) {
    double most = 0;
    for (std::size_t i = 0; i < s.start.size(); ++i) {
        triple way = s.place(s.bodies[i]) - s.start[i];
        way[1] = 0;
        most = worse(length(way), most);
    }
    return most;
}
template <class World>
double lean_of_stack(double seconds, const work& with) {
    stage<World> s(with);
    drop_stack(s, 15);
    const double most = s.largest(seconds, [&] { return lateral(s); });
    // The top one may not have got lower by more than the gaps and half a cube.
    return s.start.back()[1] - s.place(s.bodies.back())[1] < 2 ? most : infinity;
}

/// K2: cubes that touch, in rows, one fewer in each.
template <class World>
void lay_pyramid(stage<World>& s, int base, const triple& from = {}, double overlap = 0) {
    s.floor(0.6, 0, from);
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            s.cube(from + triple{(1 - overlap) * (i - 0.5 * (base - row - 1)), 0.5 + (1 - overlap) * row, 0});
    s.remember();
}
template <class World>
double shift_of_pyramid(double base, const work& with) {
    stage<World> s(with);
    lay_pyramid(s, static_cast<int>(base));
    return s.largest(10, [&] { return s.moved(); });
}

/// K5: cards of 40 cm and 2 mm, in pairs that lean 25 degrees on each other, and cards across the tops of the pairs.
template <class World>
double drop_of_cards(double floors, const work& with) {
    stage<World> s(with);
    s.floor(0.7);
    const int count = static_cast<int>(floors);
    const double lean = 25 * pi / 180, half = 0.2, pitch = 0.35;
    const auto card = [&](double x, double y, double angle) {
        solid b;
        b.at = {x, y, 0};
        b.half = {0.001, half, 0.15};
        b.friction = 0.7, b.angle = angle;
        s.box(b);
    };
    for (int floor = 0; floor < count; ++floor) {
        const double left = 0.5 * pitch * floor, y = half - 0.02 + floor * (2 * half - 0.03);
        for (int i = 0; i < count - floor; ++i) {
            const double x = left + i * pitch;
            if (i + 1 < count - floor) card(x + 0.25, y + half - 0.015, pi / 2);
            card(x, y, -lean);
            card(x + 0.5 * pitch, y, lean);
        }
    }
    s.remember();
    return s.largest(20, [&] { return s.moved(); });
}

/// X2: ten cubes in a wall that overlap by a part of their size: the highest speed by that at which overlaps are to be
/// pushed apart.
template <class World>
double speed_of_overlaps(double overlap, const work& with) {
    stage<World> s(with);
    lay_pyramid(s, 4, {}, overlap);
    const double push = static_cast<double>(s.world.settings().solver.max_depenetration_speed);
    return s.largest(5, [&] { return s.fastest(); }) / push;
}
/// The deepest point of one box in another, of corners and middles of edges, faces and the whole (m).
template <class World>
double overlap_of(const stage<World>& s, body_id a, body_id b, const triple& half) {
    double deepest = 0;
    for (int i = 0; i < (World::dimension == 2 ? 9 : 27); ++i) {
        const triple corner = {(i % 3 - 1) * half[0], (i / 3 % 3 - 1) * half[1],
                               World::dimension == 2 ? 0 : (i / 9 - 1) * half[2]};
        const triple in_b = s.into(b, s.place(a) + s.out_of(a, corner) - s.place(b));
        double depth = infinity;
        for (std::size_t k = 0; k < World::dimension; ++k) depth = std::fmin(depth, half[k] - std::abs(in_b[k]));
        deepest = worse(depth, deepest);
    }
    return deepest;
}
/// X2: the deepest overlap that is left after a second (m).
template <class World>
double overlap_left(double overlap, const work& with) {
    stage<World> s(with);
    lay_pyramid(s, 4, {}, overlap);
    for (int i = 0; i < 60; ++i) s.step();
    double deepest = 0;
    for (std::size_t i = 1; i < s.bodies.size(); ++i)
        for (std::size_t j = 1; j < s.bodies.size(); ++j)
            if (i != j) deepest = worse(overlap_of(s, s.bodies[i], s.bodies[j], {0.5, 0.5, 0.5}), deepest);
    return deepest;
}

/// Settings of a world whose lengths are so many times longer.
template <class World>
typename World::settings_type scaled_settings(const work& with, double scale) {
    using S = typename World::scalar;
    const S k = S(scale);
    auto of = stage<World>::settings_for(with, triple{0, -10, 0} * scale);
    of.contact_margin *= k;
    of.broadphase.margin *= k;
    of.solver.max_depenetration_speed *= k;
    if constexpr (requires { of.solver.impact_speed; }) of.solver.impact_speed *= k;
    if constexpr (requires { of.solver.penetration_slop; }) of.solver.penetration_slop *= k;
    return of;
}
/// X4: how far cubes of some size (m) get from where those of 1 m are at the same time, as a share of their size.
template <class World>
double unlike_of_scaled(double scale, const work& with) {
    const auto play = [&](double k) {
        stage<World> s(scaled_settings<World>(with, k));
        drop_stack(s, 10, k, 1000);
        std::vector<triple> places;
        for (int i = 0; i < 300; ++i) {
            s.step();
            for (const body_id id : s.bodies) places.push_back(s.place(id) * (1 / k));
        }
        return places;
    };
    const std::vector<triple> usual = play(1), other = play(scale);
    double most = 0;
    for (std::size_t i = 0; i < usual.size(); ++i) most = worse(length(usual[i] - other[i]), most);
    return most;
}
/// X4: how far the cubes of a stack get from their places, as a share of their size (m), under usual gravity and with
/// the settings as they ship.
template <class World>
double sink_of_small(double size, const work& with) {
    stage<World> s(with);
    s.floor();
    for (int i = 0; i < 5; ++i) {
        solid b;
        b.at = {0, (0.5 + i) * size, 0};
        b.half = b.half * size;
        b.density = 1000;
        s.box(b);
    }
    s.remember();
    return s.largest(5, [&] { return s.moved(); }) / size;
}

/// X6: how far the crates of a stack get from their places in steps of changing lengths (m); where one becomes faster
/// than overlaps are pushed apart, it is lost.
template <class World, class Step>
double moved_by_steps(const work& with, int steps, Step&& length_of_step) {
    stage<World> s(with);
    s.floor();
    for (int i = 0; i < 5; ++i) s.cube({0, 0.5 + i, 0});
    for (int i = 0; i < 60; ++i) s.step();
    s.remember();
    double most = 0;
    for (int i = 0; i < steps; ++i) {
        s.step(length_of_step(i));
        most = worse(s.moved(), most);
        if (!(s.fastest() <= 3)) return infinity;
    }
    return most;
}
/// 10 s of steps of one length, of 1,000 if they are shorter than 10 ms.
template <class World>
double moved_by_even(double dt, const work& with) {
    return moved_by_steps<World>(with, dt < 0.01 ? 1000 : static_cast<int>(10 / dt), [dt](int) { return dt; });
}
template <class World>
double moved_by_alternating(double ratio, const work& with) {
    return moved_by_steps<World>(with, 480, [ratio](int i) { return i % 2 ? 1 / 30.0 / ratio : 1 / 30.0; });
}
template <class World>
double moved_by_spike(double spike, const work& with) {
    return moved_by_steps<World>(with, 300, [spike](int i) { return i == 60 ? spike : frame; });
}

}  // namespace extremes
