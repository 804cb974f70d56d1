// A column of the stability table: a solver and a scalar, which plays all rows.
#pragma once

#include <string>
#include <vector>

#include "../../tests/extremes/row.hpp"

namespace bench {

/// A row as a column plays it in one dimension.
struct cell {
    std::string name, played, metric, why, probe;
    double pass = 0, degrade = 0;
    int dimension = 2, budget = 64, most = 64;
    /// A figure for so many substeps, or why the library refuses the scene.
    double (*measure)(std::size_t row, const extremes::work& with, std::string& refusal) = nullptr;
    std::size_t row = 0;
};
struct column {
    std::string name;
    int order = 0;
    std::vector<cell> (*cells)() = nullptr;
};

inline std::vector<column>& columns() {
    static std::vector<column> all;
    return all;
}
/// Static objects of this type enlist columns before main() begins.
struct enlisted_column {
    explicit enlisted_column(const column& it) { columns().push_back(it); }
};

}  // namespace bench
