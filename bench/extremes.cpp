// The stability table: extremes of mass, size, speed, distance and time, by solver and scalar
//
//   extremes rows                    lists the rows, a line each and with tabs between: name, dimension, what is
//   played,
//                                    metric, pass, degrade, why, probe, substeps of the target, most substeps
//   extremes columns                 lists the columns
//   extremes play COLUMN DIMENSION ROW [SUBSTEPS]
//                                    plays a cell, with so many substeps or with 1, 2, 4... up to the row's most, and
//                                    prints a line of CSV for each: row, dimension, column, substeps, figure, verdict,
//                                    and what the library says where it refuses the scene; ROW: all for all
//
// bench/extremes.py runs it. Rows are described in tests/extremes/rows.hpp, for this table and for the tests.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "extremes/column.hpp"

namespace {

const char* name_of(extremes::verdict v) {
    return v == extremes::verdict::pass ? "pass" : v == extremes::verdict::degrade ? "degrade" : "FAIL";
}
void play(const bench::cell& c, const bench::column& by, int substeps) {
    std::string refusal;
    const double figure = c.measure(c.row, {substeps}, refusal);
    std::printf("\"%s\",%d,%s,%d,%.4g,%s,\"%s\"\n", c.name.c_str(), c.dimension, by.name.c_str(), substeps, figure,
                name_of(extremes::judge(figure, c.pass, c.degrade)), refusal.c_str());
    std::fflush(stdout);
}

}  // namespace

int main(int count, char** words) {
    auto& columns = bench::columns();
    std::sort(columns.begin(), columns.end(), [](const auto& a, const auto& b) { return a.order < b.order; });
    const std::string what = count > 1 ? words[1] : "";
    if (what == "rows") {
        for (const bench::cell& c : columns.front().cells())
            std::printf("%s\t%d\t%s\t%s\t%g\t%g\t%s\t%s\t%d\t%d\n", c.name.c_str(), c.dimension, c.played.c_str(),
                        c.metric.c_str(), c.pass, c.degrade, c.why.c_str(), c.probe.c_str(), c.budget, c.most);
        return 0;
    }
    if (what == "columns") {
        for (const bench::column& it : columns) std::printf("%s\n", it.name.c_str());
        return 0;
    }
    if (what == "play" && (count == 5 || count == 6)) {
        const int dimension = std::atoi(words[3]), asked = count == 6 ? std::atoi(words[5]) : 0;
        const std::string name = words[4];
        bool played = false;
        for (const bench::column& it : columns) {
            if (it.name != words[2]) continue;
            for (const bench::cell& c : it.cells()) {
                if (c.dimension != dimension || (name != "all" && c.name != name)) continue;
                for (int substeps = 1; substeps <= c.most; substeps *= 2)
                    if (asked == 0 || asked == substeps) play(c, it, substeps), played = true;
            }
        }
        if (played) return 0;
    }
    std::fprintf(stderr, "extremes rows | columns | play COLUMN DIMENSION ROW [SUBSTEPS]\n");
    return 2;
}
