// What games ask of a world: events, filters, sensors, queries, characters, beside Box2D 2.4 and Bullet
//
//     bash bench/run games [--quick] [--rounds N]    --quick: small scenes; N: timed rounds (15)
//
// CPU time of one thread, minimum and median of all rounds, in which rows and engines take turns. Steps: a pyramid of
// boxes at rest that is kept awake, a second of it in each round, bare and with one thing more at a time: what it costs
// is the ratio to the bare one. Queries: boxes strewn over a field; rays of 20 m that find the closest, boxes that are
// swept as far, boxes in which all is looked for, points. Box2D 2.4 has no sweeps and finds boxes of shapes only, to
// which its own test of overlap is added; Bullet's rays and sweeps are its rayTest and convexSweepTest. Characters walk
// on a floor of tiles with steps. Bodies: those of such pyramids, each destroyed by its own call.
#include <cstdlib>
#include <cstring>
#include <map>

#include "games/row.hpp"

int main(int count, char** arguments) {
    using namespace bench;
    games::size size;
    int rounds = 15;
    for (int i = 1; i < count; ++i) {
        if (std::strcmp(arguments[i], "--quick") == 0) {
            size = {20, 500, 500, 30};
        } else if (std::strcmp(arguments[i], "--rounds") == 0 && i + 1 < count) {
            rounds = std::max(1, std::atoi(arguments[++i]));
        } else {
            std::fprintf(stderr, "what is %s? bash bench/run games --help\n", arguments[i]);
            return 2;
        }
    }
    std::vector<games::row> rows;
    for (const auto add : games::adders()) add(size, rows);
    progress bar;
    bar.total = rounds * static_cast<int>(rows.size());
    // A first run to warm up.
    for (games::row& r : rows) r.run();
    for (int round = 0; round < rounds; ++round)
        for (games::row& r : rows) {
            bar.show(r.engine + " " + r.what);
            r.taken.push_back(r.run());
        }
    bar.clear();
    std::stable_sort(rows.begin(), rows.end(), [](const games::row& a, const games::row& b) {
        return a.dimension != b.dimension ? a.dimension < b.dimension : a.unit < b.unit;
    });
    std::FILE* csv = std::fopen("bench/out/games.csv", "w");
    if (csv) std::fputs("dimension,what,unit,engine,minimum_ns,median_ns\n", csv);
    // The bare step of each engine.
    std::map<std::string, double> bare;
    for (const games::row& r : rows)
        if (r.what == "bare") bare[r.engine + std::to_string(r.dimension)] = minimum(r.taken);
    std::string unit;
    for (const games::row& r : rows) {
        const std::string title = std::to_string(r.dimension) + "D, ns a " + r.unit;
        if (title != unit)
            std::printf("\n%-44s %-12s %12s %12s %8s\n", (unit = title).c_str(), "", "minimum", "median", "x bare");
        std::printf("  %-42s %-12s %12.0f %12.0f", r.what.c_str(), r.engine.c_str(), minimum(r.taken), median(r.taken));
        const double base = bare[r.engine + std::to_string(r.dimension)];
        if (r.unit == "step" && base > 0) std::printf(" %8.3f", minimum(r.taken) / base);
        std::putchar('\n');
        if (csv)
            std::fprintf(csv, "%d,%s,%s,%s,%.1f,%.1f\n", r.dimension, r.what.c_str(), r.unit.c_str(), r.engine.c_str(),
                         minimum(r.taken), median(r.taken));
    }
    if (csv) std::fclose(csv);
}
