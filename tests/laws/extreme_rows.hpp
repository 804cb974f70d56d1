// Rows of the stability table (extremes/rows.hpp) that pass: they go on passing.
#pragma once

#include <string>

#include "../extremes/rows.hpp"
#include "step_lengths.hpp"

namespace {
namespace extreme_rows_laws {

/// A row, and the substeps with which it passes.
struct held {
    std::string name;
    int substeps;
};

template <class World>
void hold(const std::vector<held>& of) {
    std::size_t found = 0;
    for (const auto& row : extremes::rows<World>())
        for (const held& h : of) {
            if (h.name != row.name) continue;
            ++found;
            if (row.dimension != 0 && row.dimension != World::dimension) continue;
            CAPTURE(h.name);
            CAPTURE(h.substeps);
            const double measured = extremes::measured(row, {h.substeps});
            CHECK(measured >= 0);
            CHECK(measured <= row.pass);
        }
    CHECK(found == of.size());
}

/// Rows that pass in every scalar at the defaults, and those that do where numbers are finer than float's.
inline std::vector<held> at_the_defaults(const std::vector<const char*>& names, const std::vector<const char*>& fine) {
    std::vector<held> rows;
    for (const char* name : names) rows.push_back({name, 4});
    if (cell::is_fixed || number(cell::traits::epsilon()) < 1e-12)
        for (const char* name : fine) rows.push_back({name, 4});
    return rows;
}

CELL_CASE("extremes: rows of the table that pass by soft_step go on passing") {
    hold<world>(at_the_defaults(
        {"S2 creep",      "X1 1000 m/s",    "X1 movable",        "X1 rods",     "X2 25 % parts",   "X2 50 % parts",
         "X2 90 % parts", "X5 100 rad/s",   "X5 1e4 rad/s left", "F4 energy",   "F4 flips",        "C2 gain",
         "C2 loss",       "X8 friction 10", "X8 friction 1e6",   "thin 1:100",  "thin 1:1000",     "edge 1:10",
         "edge 1:100",    "X6 1 ms",        "X6 1 us falls",     "belt 1 cm/s", "belt 2 mm/s",     "roll 1 cm/s",
         "roll 2 mm/s",   "drift 1 cm/s",   "drift 2 mm/s",      "sleep 100:1", "sleep on a slope"},
        {"F4 momentum", "X3 100 km drift", "X3 10,000 km drift", "X6 1 us at 5 m"}));
    hold<world>({{"M1 100:1", 16}, {"M2 100:1", 16}, {"M2 300:1", 32}});
}

CELL_CASE("extremes: so do those that pass by sequential_impulse") {
    // Which is not optimised here: what takes long is left to bench/extremes.
    hold<physics::world<step_lengths_laws::one_by_one>>(
        at_the_defaults({"S2 creep", "X1 1000 m/s", "X5 100 rad/s", "X5 1e4 rad/s left", "F4 energy", "F4 flips",
                         "C2 gain", "C2 loss", "X8 friction 10", "X6 1 us falls", "belt 1 cm/s", "roll 1 cm/s",
                         "drift 1 cm/s", "sleep 100:1", "sleep on a slope"},
                        {"F4 momentum", "X3 100 km drift", "X3 10,000 km drift"}));
}

}  // namespace extreme_rows_laws
}  // namespace
