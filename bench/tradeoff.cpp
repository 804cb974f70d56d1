// What accuracy costs: CPU seconds a simulated second against error, of this library's solvers and of other engines
//
//   tradeoff tasks [--quick]         lists all that can be played, a line each: SCENE ENGINE RATE SUBSTEPS ITERATIONS;
//                                    RATE: steps a second; SUBSTEPS and ITERATIONS: 0 as the engine ships
//   tradeoff play SCENE ENGINE RATE SUBSTEPS ITERATIONS
//                                    plays one of them and prints a line of CSV
//   tradeoff references              lists the scenes of which no closed form is known
//   tradeoff reference SCENE         plays one of them with 64 times the most work of a task and twice the digits of a
//                                    double, and prints where bodies are; first how far they are with half of that work
//                                    from there. What it prints belongs in references/SCENE.film beside this program.
//   tradeoff scenes                  lists the scenes: name, dimension, what is visible, what is played, what is judged
//   tradeoff scene SCENE             one of them as JSON
//   tradeoff judge SCENE ENGINE RATE SUBSTEPS ITERATIONS < FILM
//                                    the line of CSV of what another program has played (bench/tradeoff/outside.hpp)
//
// Engines that run under node are listed in node/engines.txt beside this program, where bench/run puts the scripts of
// bench/tradeoff/node; play leaves them to node/play.mjs, which asks for the scene and for the judge.
//
// bench/tradeoff.py runs it. The error of a run is judged in double from poses and velocities alone. Its time is CPU
// time of this thread in steps alone, minimum and median of at least 3 runs and 0.2 s; a run of over 2 s is played
// once. Each run has to end with the same state. A task is measured again where a loop that always does the same has
// taken a twentieth more time after it than before it, twice at most.
#include <unistd.h>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "scenes/run.hpp"
#include "tradeoff/outside.hpp"

namespace {

using bench::contestant;
using bench::question;

struct task {
    int rate, substeps, iterations;
};

/// What an engine is asked to play a scene with: all is tried in one dimension, and the corners of the rest.
std::vector<task> tasks_of(const contestant& who, bool quick) {
    std::vector<task> all;
    const bool has_substeps = who.settings.rfind("substeps", 0) == 0;
    const bool has_iterations =
        has_substeps ? who.settings == "substeps iterations" : who.settings != bench::no_settings;
    for (const int rate : {30, 60, 120, 240, 480, 960, 1920}) {
        if (has_substeps && rate > 960) continue;
        for (const int substeps : {0, 1, 2, 4, 8, 16, 32, 64}) {
            if (has_substeps != (substeps > 0)) continue;
            // Beside 60 Hz substeps are tried that give a rate of them which 60 Hz has too.
            if (has_substeps && rate != 60 && (rate * substeps > 3840 || substeps > 16)) continue;
            if (quick && rate != 60 && (has_substeps || rate % 240 != 0 || rate > 960)) continue;
            for (const int iterations : {0, 4, 16, 64}) {
                if (iterations > 0 && (!has_iterations || quick)) continue;
                if (iterations > 0 && has_substeps && rate != 60) continue;
                all.push_back({rate, substeps, iterations});
            }
        }
    }
    return all;
}

std::uint64_t hash_of(const std::vector<bench::state>& states) {
    std::uint64_t hash = 1469598103934665603u;
    for (const bench::state& b : states)
        for (const double x : {b.at[0], b.at[1], b.at[2], b.velocity[0], b.velocity[1], b.velocity[2]}) {
            std::uint64_t bits;
            std::memcpy(&bits, &x, sizeof bits);
            hash = (hash ^ bits) * 1099511628211u;
        }
    return hash;
}

struct played {
    bench::film seen;
    double seconds = 0;
    std::uint64_t hash = 0;
    std::string complaint;
};

played play(const question& q, const contestant& who, const task& with) {
    bench::scene s = q.played;
    const double simulated = s.steps * bench::film::interval;
    s.dt = 1.0 / with.rate;
    s.substeps = with.substeps, s.iterations = with.iterations;
    played result;
    std::vector<bench::state> states;
    bench::run it(s, who);
    it.it().read(states);
    result.complaint = bench::judge(s).complaint(states, it.it().gravity());
    result.seen.frames.push_back(states);
    const int steps = with.rate / 30;
    for (int frame = 0; frame < q.played.steps; ++frame) {
        for (int i = 0; i < steps; ++i) {
            it.step();
            result.seconds += it.last_ms() / 1e3;
        }
        it.it().read(states);
        result.seen.frames.push_back(states);
    }
    result.seconds /= simulated;
    result.hash = hash_of(states);
    return result;
}

/// Nanoseconds of what always takes the same.
double calibration() {
    const bench::stopwatch clock;
    volatile double x = 1;
    for (int i = 0; i < 2'000'000; ++i) x = x * 0.999 + 0.001;
    return clock.ns();
}

/// Numbers of a reference's film: for each body of each frame where it is.
void print(const bench::film& seen) {
    for (const auto& states : seen.frames)
        for (const bench::state& b : states) std::printf("%.17g %.17g %.17g\n", b.at[0], b.at[1], b.at[2]);
}
/// Where the films of references are.
std::string references;
/// What print() and the number before it have written; empty if there are not as many frames.
bench::film reference_of(const question& q) {
    const std::string path = references + q.name + ".film";
    std::FILE* const file = std::fopen(path.c_str(), "r");
    if (file == nullptr) return {};
    bench::film right;
    double own = 0;
    bool good = std::fscanf(file, "%lf", &own) == 1;
    for (int i = 0; i <= q.played.steps && good; ++i) {
        auto& states = right.frames.emplace_back(q.played.bodies.size());
        for (bench::state& b : states)
            good = good && std::fscanf(file, "%lf %lf %lf", &b.at[0], &b.at[1], &b.at[2]) == 3;
    }
    std::fclose(file);
    return good ? right : bench::film{};
}
int print_reference(const question& q) {
    for (const contestant& who : bench::contestants()) {
        if (who.name != "reference") continue;
        const bench::film half = play(q, who, {3840, 32, 0}).seen, whole = play(q, who, {3840, 64, 0}).seen;
        std::printf("%.3g\n", bench::distance_of(half, whole));
        print(whole);
        return 0;
    }
    std::fprintf(stderr, "without libqd-dev there is no reference\n");
    return 1;
}

int print_row(const question& q, const std::string& engine, const task& with, const bench::film& seen,
              const bench::samples& seconds) {
    const bench::film right = q.error == nullptr ? reference_of(q) : bench::film{};
    if (q.error == nullptr && right.frames.empty()) {
        std::fprintf(stderr, "%s: there is no reference\n", q.name.c_str());
        return 1;
    }
    const double error = q.error != nullptr ? q.error(q.played, seen) : bench::distance_of(seen, right);
    const int sweeps = with.rate * (with.substeps > 0 ? with.substeps : 1);
    std::printf("%s,%s,%d,%d,%d,%d,%.9g,%d,%.6g,%.6g,%zu,%016" PRIx64 "\n", q.name.c_str(), engine.c_str(), with.rate,
                with.substeps, with.iterations, sweeps, error, error < q.broken, bench::minimum(seconds),
                bench::median(seconds), seconds.size(), hash_of(seen.last()));
    return 0;
}

int play_task(const question& q, const contestant& who, const task& with) {
    const double simulated = q.played.steps * bench::film::interval;
    bench::samples seconds;
    played first;
    for (int tries = 0; tries < 3; ++tries) {
        seconds.clear();
        double spent = 0;
        const double before = calibration();
        do {
            played next = play(q, who, with);
            if (!next.complaint.empty()) {
                std::fprintf(stderr, "%s, %s: it %s\n", q.name.c_str(), who.name.c_str(), next.complaint.c_str());
                return 1;
            }
            seconds.push_back(next.seconds);
            spent += next.seconds * simulated;
            if (seconds.size() > 1 && next.hash != first.hash) {
                std::fprintf(stderr, "%s %s: two runs differ\n", q.name.c_str(), who.name.c_str());
                return 1;
            }
            first = std::move(next);
        } while (spent < 2 && (seconds.size() < 3 || (spent < 0.2 && seconds.size() < 100)));
        if (spent >= 2 || calibration() < 1.05 * before) break;
    }
    return print_row(q, who.name, with, first.seen, seconds);
}

int judge_film(const question& q, const std::string& engine, const task& with) {
    bench::outside_run it;
    if (!bench::read(stdin, q.played, it)) {
        std::fprintf(stderr, "%s, %s: no film, or of another scene\n", q.name.c_str(), engine.c_str());
        return 1;
    }
    const std::string complaint = bench::judge(q.played).complaint(it.seen.frames.front(), it.gravity);
    if (!complaint.empty()) {
        std::fprintf(stderr, "%s, %s: it %s\n", q.name.c_str(), engine.c_str(), complaint.c_str());
        return 1;
    }
    return print_row(q, engine, with, it.seen, it.seconds);
}

/// Becomes node; returns if there is none.
int leave_to_node(const std::string& folder, char** words) {
    const std::string script = folder + "play.mjs";
    execlp("node", "node", "--single-threaded", "--no-liftoff", script.c_str(), words[2], words[3], words[4], words[5],
           words[6], static_cast<char*>(nullptr));
    std::perror("node");
    return 1;
}

}  // namespace

int main(int count, char** words) {
    const std::string what = count > 1 ? words[1] : "", self = words[0];
    const std::string folder = self.substr(0, self.rfind('/') + 1), node = folder + "node/";
    references = folder + "references/";
    const std::vector<contestant> under_node = bench::listed(node + "engines.txt");
    if (what == "scenes") {
        for (const question& q : bench::questions())
            std::printf("%s\t%d\t%g\t%s\t%s\n", q.name.c_str(), q.played.dimension, q.visible, q.about, q.metric);
        return 0;
    }
    if (what == "tasks") {
        const bool quick = count > 2 && std::strcmp(words[2], "--quick") == 0;
        std::vector<contestant> all = bench::contestants();
        all.insert(all.end(), under_node.begin(), under_node.end());
        for (const question& q : bench::questions())
            for (const contestant& who : all)
                if (who.joins(q.played) && !who.on_demand)
                    for (const task& t : tasks_of(who, quick))
                        std::printf("%s %s %d %d %d\n", q.name.c_str(), who.name.c_str(), t.rate, t.substeps,
                                    t.iterations);
        return 0;
    }
    if (what == "references") {
        for (const question& q : bench::questions())
            if (q.error == nullptr) std::printf("%s\n", q.name.c_str());
        return 0;
    }
    for (const question& q : bench::questions()) {
        if (count < 3 || q.name != words[2]) continue;
        if (what == "scene" && count == 3) {
            bench::write_json(stdout, q.played);
            return 0;
        }
        if (what == "reference" && count == 3) return print_reference(q);
        if (count != 7) break;
        const task with = {std::atoi(words[4]), std::atoi(words[5]), std::atoi(words[6])};
        if (what == "judge") return judge_film(q, words[3], with);
        if (what != "play") break;
        for (const contestant& who : bench::contestants())
            if (who.name == words[3] && who.joins(q.played)) return play_task(q, who, with);
        for (const contestant& who : under_node)
            if (who.name == words[3] && who.joins(q.played)) return leave_to_node(node, words);
    }
    std::fprintf(stderr,
                 "tradeoff tasks | scenes | scene SCENE | references | reference SCENE | "
                 "play|judge SCENE ENGINE RATE SUBSTEPS ITERATIONS\n");
    return 2;
}
