// How a recipe becomes a column.
#pragma once

#include "../../tests/extremes/rows.hpp"
#include "column.hpp"

namespace bench {

template <class S, int D, class Solver>
struct recipe_of_column : physics::recipe<S, D, physics::shapes<physics::ball, physics::capsule, physics::box>, Solver,
                                          physics::joints<physics::ball_joint>> {};

template <class World>
double measure(std::size_t row, const extremes::work& with, std::string& refusal) {
    const extremes::row<World>& r = extremes::rows<World>()[row];
    try {
        return r.measure(r.parameter, with);
    } catch (const physics::error& e) {
        refusal = e.what();
        return extremes::refused;
    }
}
template <class World>
void add_cells(std::vector<cell>& to) {
    const auto& rows = extremes::rows<World>();
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& r = rows[i];
        if (r.dimension != 0 && r.dimension != World::dimension) continue;
        to.push_back({r.name, r.played, r.metric, r.why, r.probe, r.pass, r.degrade, World::dimension, r.budget, r.most,
                      measure<World>, i});
    }
}
template <class S, class Solver>
std::vector<cell> cells_of() {
    std::vector<cell> all;
    add_cells<physics::world<recipe_of_column<S, 2, Solver>>>(all);
    add_cells<physics::world<recipe_of_column<S, 3, Solver>>>(all);
    return all;
}

}  // namespace bench
