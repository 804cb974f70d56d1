// Piles played until they rest, or should: when they sleep, what still moves, and what that costs.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "judge.hpp"
#include "run.hpp"

namespace bench {

/// What became of a pile.
struct rest {
    /// CPU ms a step, on average over all steps and over the last hundredth.
    double ms = 0, last_ms = 0;
    /// The first step after which all bodies sleep to the end; 0 if they never do. How many are awake at the end.
    int asleep = 0, awake = -1;
    /// By the numbers of steps at which they were judged.
    std::vector<std::pair<int, verdict>> verdicts;
};

/// Calls tick() before each step.
template <class Tick>
rest play_to_rest(const scene& s, const contestant& c, std::string& complaint, Tick&& tick) {
    rest found;
    judge j(s);
    run r(s, c);
    std::vector<state> states;
    r.it().read(states);
    complaint = j.complaint(states, r.it().gravity());
    const int last = std::max(1, s.steps / 100);
    bool slept = false;
    for (int i = 1; i <= s.steps; ++i) {
        tick(i);
        r.step();
        found.ms += r.last_ms() / s.steps;
        if (i > s.steps - last) found.last_ms += r.last_ms() / last;
        if (s.sleeps) {
            found.awake = r.it().awake();
            if (found.awake == 0 && !slept) found.asleep = i;
            slept = found.awake == 0;
            if (!slept) found.asleep = 0;
        }
        bool judged = i == s.steps;
        for (const int mark : {250, 500, 1000, 1500, 2500, 5000}) judged = judged || i == mark;
        if (!judged) continue;
        r.it().read(states);
        j.sample(states);
        found.verdicts.emplace_back(i, j.result());
    }
    return found;
}

/// A table on the terminal, and a CSV with a row for each time that a pile was judged.
class rest_report {
public:
    explicit rest_report(const std::string& csv) : csv_(std::fopen(csv.c_str(), "w")) {
        if (csv_)
            std::fputs(
                "scene,sleep,bodies,engine,ms,last_ms,asleep_at,awake,step,energy_J,sag_m,drift_m,mean_m,last_m,"
                "deep,lost\n",
                csv_);
    }
    rest_report(const rest_report&) = delete;
    rest_report& operator=(const rest_report&) = delete;
    ~rest_report() {
        if (csv_) std::fclose(csv_);
    }

    static void head(const scene& s) {
        std::printf("\n%s: %dD, %d bodies, %d steps, sleeping %s\n", s.name.c_str(), s.dimension, s.free_bodies(),
                    s.steps, s.sleeps ? "on" : "off");
        std::printf("%-16s%9s%9s%8s%7s |%8s%10s%9s%9s%9s%9s%7s%6s\n", "", "ms", "last", "asleep", "awake", "step",
                    "energy", "sag", "drift", "mean", "deepest", ">5 mm", "lost");
    }
    void add(const scene& s, const contestant& c, const rest& found) const {
        char asleep[16] = "-", awake[16] = "-";
        if (found.asleep > 0) std::snprintf(asleep, sizeof asleep, "%d", found.asleep);
        if (found.awake >= 0) std::snprintf(awake, sizeof awake, "%d", found.awake);
        for (std::size_t i = 0; i < found.verdicts.size(); ++i) {
            const auto& [step, v] = found.verdicts[i];
            if (i == 0) std::printf("%-16s%9.3f%9.3f%8s%7s |", c.name.c_str(), found.ms, found.last_ms, asleep, awake);
            else std::printf("%-49s |", "");
            std::printf("%8d%10.3g%9.1f%9.1f%9.3f%9.2f%7d%6d\n", step, v.energy, 1e3 * v.sag, 1e3 * v.drift,
                        1e3 * v.mean, 1e3 * v.last, v.deep, v.lost);
            if (csv_)
                std::fprintf(csv_, "%s,%d,%d,%s,%.5g,%.5g,%d,%d,%d,%.5g,%.5g,%.5g,%.5g,%.5g,%d,%d\n", s.name.c_str(),
                             s.sleeps, s.free_bodies(), c.name.c_str(), found.ms, found.last_ms, found.asleep,
                             found.awake, step, v.energy, v.sag, v.drift, v.mean, v.last, v.deep, v.lost);
        }
        std::fflush(stdout);
        if (csv_) std::fflush(csv_);
    }
    static void legend() {
        std::puts(
            "\nms: CPU time a step, mean of one run to the end; last: of its last hundredth. asleep: the step after "
            "which\n"
            "all bodies sleep for good; awake: bodies that do not at the end. energy: kinetic, in J. sag, drift: of "
            "tops\n"
            "of structures, in mm. mean, deepest: of all overlaps in mm, as the judge finds them.");
    }

private:
    std::FILE* csv_;
};

}  // namespace bench
