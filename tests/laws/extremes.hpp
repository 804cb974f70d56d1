// Scenes that begin badly, lie far out, or are stepped unevenly.
#pragma once

#include <algorithm>
#include <vector>

#include "stability_scenes.hpp"

namespace {

/// Ten crates in a wall of four rows, which overlap by a part of their size in both directions.
inline void overlapping_pile(world& w, double overlap) {
    add_floor(w);
    for (int row = 0; row < 4; ++row)
        for (int i = 0; i < 4 - row; ++i)
            add_cube(w, at((1 - overlap) * (i - 0.5 * (3 - row)), 0.5 + (1 - overlap) * row));
}

CELL_CASE("X2: crates that overlap part within a second, and nobody is shot away") {
    // The best that is asked for is 1.1 times the speed: that of a pair. Rows that are pushed by rows are faster.
    for (const double push : {1.0, 3.0})
        for (const double overlap : {0.25, 0.5, 0.9, 1.0})
            for (const int substeps : {4, 16}) {
                CAPTURE(push);
                CAPTURE(overlap);
                CAPTURE(substeps);
                world::settings_type settings = pulled(substeps);
                settings.solver.max_depenetration_speed = S(push);
                world w(settings);
                overlapping_pile(w, overlap);
                const double room = overlap < 1 ? 1.9 : 2.6;
                const double time = overlap > 0.5 ? 1.25 : 1;
                const fate at_first = live(w, time);
                CHECK(at_first.fastest <= room * push + (push < 3 ? 0.3 : 0));
                if (substeps == 4 && overlap == 0.25) CHECK(at_first.upward <= 1.65 * push + (push < 3 ? 0.5 : 0));
                if (push == 3) CHECK(deepest_of(w) <= 0.02);
                const fate then = live(w, 20);
                CHECK(then.fastest <= room * push + (push < 3 ? 0.3 : 0));
                CHECK(deepest_of(w) <= 0.02);
                CHECK(then.asleep_after >= 0);
            }
}

/// How far out this cell's numbers are fine enough: their spacing there is a small part of a substep's way.
inline std::vector<double> distances() {
    if (cell::is_fixed || number(cell::traits::epsilon()) < 1e-12) return {1e3, 1e5, 1e7};
    return {1e3};
}
/// Half the spacing of numbers of that size.
inline double half_spacing(double size) {
    if (cell::is_fixed) return 0.5 * number(cell::traits::epsilon());
    return 0.5 * number(cell::traits::epsilon()) * std::exp2(std::floor(std::log2(size)));
}

CELL_CASE("X3: far from the origin a pyramid comes to rest as it does there") {
    const auto rest = [](double distance, std::vector<vec>& ends) {
        world w(pulled());
        const vec from = along(0, distance);
        lay_pyramid(w, 10, from);
        const fate f = live(w, 20);
        for (const body_id id : w.bodies()) ends.push_back(w.position(id) - from);
        CHECK(f.asleep_after > 0);
        CHECK(f.sideways <= 0.01);
        return f.asleep_after;
    };
    std::vector<vec> near;
    const int asleep = rest(0, near);
    for (const double distance : distances()) {
        CAPTURE(distance);
        std::vector<vec> far;
        const int asleep_there = rest(distance, far);
        double most = 0;
        for (std::size_t i = 0; i < near.size(); ++i) most = std::max(most, gap(near[i], far[i]));
        CHECK(most <= 0.001);
        // In float, 1 km out, the smallest way is a part in 250 of what sleep watches for.
        // Where the last bit decides, in which step a threshold is passed.
        if (half_spacing(distance) < 1e-6) CHECK(std::abs(asleep_there - asleep) <= 1);
        else CHECK(std::abs(asleep_there - asleep) <= 30);
    }
}

CELL_CASE("X3: far from the origin slow bodies still move, as fast as they are") {
    for (const double distance : distances())
        for (const double speed : {0.1, 0.5, 1.5, 3.0}) {
            CAPTURE(distance);
            CAPTURE(speed);
            world::settings_type settings = weightless();
            world w(settings);
            const body_id id = add_cube(w, along(0, distance));
            w.set_linear_velocity(id, along(0, speed));
            for (int i = 0; i < 600; ++i) w.step(S(1.0 / 60));
            const double displacement = number(w.position(id).x - S(distance));
            // A part is lost where a substep's way is rounded.
            const double lost = half_spacing(distance + 32) * 60 * settings.solver.substeps / speed;
            CHECK(std::abs(displacement / (10 * speed) - 1) <= (lost < 0.0025 ? 0.01 : lost));
        }
}

CELL_CASE("X3: far from the origin bodies fall as they do there") {
    for (const double distance : distances()) {
        CAPTURE(distance);
        world w(pulled());
        const body_id id = add_cube(w, along(1, distance));
        for (int i = 0; i < 60; ++i) w.step(S(1.0 / 60));
        const double displacement = number(w.position(id).y - S(distance));
        const double exact = -5 - 5.0 / 60 / w.settings().solver.substeps;
        CHECK(std::abs(displacement / exact - 1) <=
              0.001 + half_spacing(distance) * 60 * w.settings().solver.substeps / 5);
    }
}

CELL_CASE("X6: long steps with as many substeps a second are as good as short ones") {
    for (const int longer : {2, 4}) {
        CAPTURE(longer);
        for (const bool pyramid : {false, true}) {
            CAPTURE(pyramid);
            world w(pulled(8 * longer));
            pyramid ? lay_pyramid(w, 20) : stand_stack(w, 15);
            const fate f = live_by(w, 60, [&](int) { return longer / 60.0; });
            CHECK(f.sideways <= 0.02);
            CHECK(f.sunk <= 0.022);
            CHECK(f.fastest <= 0.3);
            CHECK(f.asleep_after > 0);
        }
    }
}

CELL_CASE("X6: long steps, uneven ones and a hitch throw nobody away") {
    // Springs follow the usual step. Where steps differ by a factor of four, rows that touch creep apart by 3 mm/s in
    // 2D.
    struct rhythm {
        doctest::String name;
        double (*step)(int);
        double sunk, sideways;
    };
    for (const rhythm& r :
         {rhythm{"1/30 s", [](int) { return 1.0 / 30; }, 0.05, 0.012},
          rhythm{"1/15 s", [](int) { return 1.0 / 15; }, 0.2, 0.05},
          rhythm{"1/72 to 1/50 s", [](int i) { return 1.0 / (50 + 22 * (i * 7 % 16) / 15.0); }, 0.02, 0.012},
          rhythm{"1/30 and 1/120 s", [](int i) { return i % 2 ? 1.0 / 120 : 1.0 / 30; }, 0.02, 0.08},
          rhythm{"a hitch of 0.25 s", [](int i) { return i == 90 ? 0.25 : 1.0 / 60; }, 0.02, 0.012}})
        for (const bool pyramid : {false, true}) {
            CAPTURE(r.name);
            CAPTURE(pyramid);
            world::settings_type settings = pulled();
            settings.sleeping.enabled = false;
            world w(settings);
            if (pyramid) {
                lay_pyramid(w, 5);
            } else {
                stand_stack(w, 5);
            }
            const fate f = live_by(w, 20, r.step);
            // As fast as gravity makes it in a substep of the longest step, and no faster.
            CHECK(f.fastest <= 0.8);
            CHECK(f.risen <= 0.02);
            CHECK(f.sunk <= r.sunk);
            CHECK(f.sideways <= r.sideways);
        }
}

#if CELL_DIMENSION == 3
/// The most energy that a box of some half extents has in 4 s, as a share of what it has 1 m above a floor on which it
/// falls, leaning and spinning.
struct needle_fall {
    int substeps;
    double friction, step, lean = 0.5, spin = 1;
};
inline double most_energy(vec half, const needle_fall& how) {
    world::settings_type settings = pulled(how.substeps);
    settings.sleeping.enabled = false;
    world w(settings);
    const physics::material<S, 3> rubs{.friction = S(how.friction)};
    w.create_shape(w.create_body({.type = body_type::static_body}), world::halfspace{along(1, 1)}, {.material = rubs});
    const body_id b = w.create_body({.position = at(0, 1),
                                     .rotation = turned_about_z(how.lean),
                                     .angular_velocity = {S(0.3 * how.spin), S(0.2 * how.spin), S(0)}});
    const double volume = 8 * number(half.x) * number(half.y) * number(half.z);
    w.create_shape(b, world::box{half}, {.density = S(1 / volume), .material = rubs});
    const auto square = [](S x) { return number(x) * number(x); };
    const auto energy = [&] {
        const vec v = w.linear_velocity(b), spin = inverse_rotate(w.rotation(b), w.angular_velocity(b));
        const double x = square(half.x), y = square(half.y), z = square(half.z);
        return 10 * number(w.position(b).y) + (square(v.x) + square(v.y) + square(v.z)) / 2 +
               ((y + z) * square(spin.x) + (x + z) * square(spin.y) + (x + y) * square(spin.z)) / 6;
    };
    const double start = energy();
    double most = 0;
    for (int i = 0; i * how.step < 4; ++i) {
        w.step(S(how.step));
        most = std::max(most, energy() / start);
    }
    return most;
}
CELL_CASE("X5: needles and plates, however thin, gain nothing as they fall, and lie down") {
    // Fixed point has no numbers for the moments of thinner ones.
    for (const double thin : {1e-2, 2e-3, 1e-3, 1e-4})
        for (const int substeps : {1, 2, 4, 16})
            for (const double friction : {0.0, 0.5})
                for (const double step : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
                    if (cell::is_fixed && thin < 1e-3) continue;
                    CAPTURE(thin);
                    CAPTURE(substeps);
                    CAPTURE(friction);
                    CAPTURE(step);
                    const needle_fall how{substeps, friction, step};
                    CHECK(most_energy({S(0.5), S(0.5 * thin), S(0.5 * thin)}, how) <= 1.02);
                    CHECK(most_energy({S(0.5), S(0.5 * thin), S(0.5)}, how) <= 1.02);
                }
}
CELL_CASE("X5: needles that roll on their edges by many turns a step gain nothing, at any angle") {
    for (const double thin : {5e-4, 2e-4, 1e-4})
        for (const int substeps : {1, 4, 16})
            for (int k = 0; k < 24; ++k) {
                if (cell::is_fixed) continue;
                CAPTURE(thin);
                CAPTURE(substeps);
                CAPTURE(k);
                const needle_fall how{substeps, k % 2 ? 1.0 : 0.5, k % 3 ? 1.0 / 60 : 1.0 / 90, 0.05 + 0.06 * k,
                                      1.0 + k % 4};
                CHECK(most_energy({S(0.5), S(0.5 * thin), S(0.75 * thin)}, how) <= 1.02);
            }
}
#endif

}  // namespace
