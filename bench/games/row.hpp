// What is measured, in turns: a row of the table of bench/games.cpp.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../timing.hpp"

namespace bench::games {

/// How large scenes are.
struct size {
    int rows = 40, things = 2000, queries = 2000, frames = 60;
};

/// One thing that an engine does, with what it is compared to; run() gives nanoseconds of CPU time for a unit of it.
struct row {
    std::string what, unit, engine;
    int dimension;
    std::function<double()> run;
    samples taken = {};
};

/// Units add their rows; those of peers are linked where the peer is installed.
using adder = void (*)(const size&, std::vector<row>&);
inline std::vector<adder>& adders() {
    static std::vector<adder> all;
    return all;
}
struct adds {
    explicit adds(adder a) { adders().push_back(a); }
};

/// Places of things that are strewn about, the same for all engines: each number from -1 to 1, of a linear
/// congruential generator.
class dice {
public:
    double number() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
    }

private:
    std::uint64_t state_ = 1;
};
/// They fill a square or a cube of this half width (m), and rays cross it.
constexpr double field = 60, ray_length = 20;

/// Many queries of a field, each from another place: ask(field) gives how much it found; a Field is made with the
/// number of things in it, and has a dice called random.
template <class Field, class Ask>
row query_row(const char* what, const char* engine, int dimension, const size& by, Ask&& ask) {
    auto f = std::make_shared<Field>(by.things);
    return {what, "query", engine, dimension, [f, ask, queries = by.queries] {
                f->random = {};
                long found = 0;
                const stopwatch clock;
                for (int i = 0; i < queries; ++i) found += ask(*f);
                const double ns = clock.ns() / queries;
                return found == 0 ? 0 : ns;
            }};
}

}  // namespace bench::games
