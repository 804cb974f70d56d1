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

CELL_CASE("extremes: rows of the table that pass go on passing") {
    const std::vector<held> rows = {{"M1 100:1", 16}, {"S2 creep", 4}};
    hold<world>(rows);
    hold<physics::world<step_lengths_laws::one_by_one>>(rows);
}

}  // namespace extreme_rows_laws
}  // namespace
