// How many substeps a world says that it needs, and whether these are enough.
#pragma once

#include "refusal.hpp"
#include "stability_scenes.hpp"

namespace {
namespace substep_laws {

/// What stands, of some kind, after 20 s.
world rested(int kind, int substeps, double rate = 64) {
    world w(pulled(substeps));
    if (kind == 0) stand_stack(w, 10);
    if (kind == 1) lay_pyramid(w, 6);
    if (kind == 2) {
        // One crate beside the middle of another, with a heavy one on it.
        stand_stack(w, 1);
        add_cube(w, at(0.4, 1.5));
        add_cube(w, at(-0.2, 2.5), 3);
    }
    if (kind == 3) {
        add_floor(w);
        const body_id ball = w.create_body({.position = at(0, 0.5)});
        w.create_shape(ball, world::ball{S(0.5)}, {.density = S(20)});
    }
    if (kind == 4) {
        stand_stack(w, 1);
        add_slab(w, at(0, 2), vec::filled(S(1)), 8, 0.6);
    }
    // What falls asleep stops sinking on the way.
    for (const body_id b : w.bodies()) w.set_can_sleep(b, false);
    for (int i = 0; i < 20 * rate; ++i) w.step(S(1 / rate));
    return w;
}
double deepest_at_rest(const world& w) {
    double deepest = 0;
    for (const auto& c : w.contacts())
        for (int i = 0; i < c.count; ++i) deepest = std::max(deepest, -number(c.points[i].separation));
    return deepest;
}

CELL_CASE("substeps: a world at rest knows how far its contacts give way") {
    for (int kind = 0; kind < 5; ++kind)
        for (const int substeps : {1, 2, 4}) {
            if (kind == 4 && substeps < 4) continue;
            CAPTURE(kind);
            CAPTURE(substeps);
            const world w = rested(kind, substeps);
            const double deepest = deepest_at_rest(w), rounding = 2 * number(cell::traits::epsilon());
            CAPTURE(deepest);
            CHECK(substeps_for(w, S(1.05 * deepest + rounding)) <= substeps);
            if (deepest > 100 * rounding) CHECK(substeps_for(w, S(0.95 * deepest - rounding)) == substeps + 1);
        }
}
CELL_CASE("substeps: as many as it says are enough, and one less is not") {
    for (int kind = 0; kind < 5; ++kind) {
        CAPTURE(kind);
        // From crude steps of another length.
        const world crude = rested(kind, 4, 32);
        const double tolerance = 1e-3;
        const int needed = substeps_for(crude, S(tolerance));
        CAPTURE(needed);
        CHECK(deepest_at_rest(rested(kind, needed, 32)) < 1.03 * tolerance);
        if (needed > 1) CHECK(deepest_at_rest(rested(kind, needed - 1, 32)) > 0.97 * tolerance);
    }
}
CELL_CASE("substeps: ten crates of any mass ask for six at 60 Hz, to give way by a millimetre") {
    CHECK(substeps_for(rested(0, 4, 60), S(0.001)) == 6);
}
CELL_CASE("substeps: nothing that pushes needs one; a cap may leave none; bad tolerances are refused") {
    world w(pulled());
    CHECK(substeps_for(w, S(0.001)) == 1);
    w = rested(0, 4);
    world::settings_type capped = w.settings();
    capped.solver.frequency_cap = S(10);
    w.set_settings(capped);
    CHECK(substeps_for(w, S(0.001)) == 0);
    // Ten crates press on the lowest by g at 10 Hz: 0.25 m.
    CHECK(substeps_for(w, S(0.5)) == 1);
    refuses_number(w, "substeps_for", "tolerance", rule::positive, [&](S bad) { (void)substeps_for(w, bad); });
}

}  // namespace substep_laws
}  // namespace
