// CPU time of whole steps, and what they are worth: overlaps, sag, rest, by one judge for all engines
//
//     bash bench/run scenes [--quick] [2d] [3d] [SCENE ...]     all scenes, or these; --quick: small ones
//         [--only ENGINE,...]   these engines      [--rounds N]   timed rounds (3)     [--steps N]   so many steps
//         [--stages]            one line more: ours by stage     [--list]   scenes and engines
//         [--rest]              piles to rest instead, for up to 10,000 steps, each with sleeping off and on: an hour
//                               for all engines, ten minutes for one by --only
//         [--scaling]           many pyramids from 1,000 to 100,000 bodies: what a body costs
//
// Scenes with joints are those of Box2D v3, Box3D and Jolt, without springs, damping and filters of collisions, which
// not all engines have. The judge looks at their joints after each step.
// Scenes are told to all engines in the same plain numbers (scenes/scene.hpp). Every adapter says what the engine made
// of them, and the masses, poses, velocities and the gravity are compared before the first step. Damping is off, and so
// is sleeping but in --rest; all else is as it ships: the settings are printed. The first run of an engine is for the
// judge (see scenes/judge.hpp), the others are for the clock, and engines take turns within each round. Bytes a body
// are what the engine has taken of the heap by the end; bytes a contact are those of a snapshot of the world, less
// those of the snapshot without contacts and what is remembered of pairs, for each contact that there is. Peers do not
// tell. Each unit of scenes/ that begins with `// peer:` is compiled if what it names is there or can be had. An engine
// takes part by being linked in (scenes/engine.hpp).
#include <malloc.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "scenes/engine.hpp"
#include "scenes/judge.hpp"
#include "scenes/makers.hpp"
#include "scenes/report.hpp"
#include "scenes/rest.hpp"
#include "scenes/run.hpp"

namespace bench {

double held_bytes() {
    const struct mallinfo2 m = mallinfo2();
    return static_cast<double>(m.uordblks + m.hblkhd);
}

struct plan {
    bool quick = false, stages = false, scaling = false, rest = false, list = false, flat = false, solid = false;
    int rounds = 3, steps = 0;
    std::vector<std::string> scenes, only;

    [[nodiscard]] bool wants(const contestant& c) const {
        if (c.on_demand && stages) return true;
        if (only.empty()) return !c.on_demand;
        return std::find(only.begin(), only.end(), c.name) != only.end();
    }
    [[nodiscard]] bool wants(const maker& m) const {
        if (flat != solid && m.dimension != (flat ? 2 : 3)) return false;
        return scenes.empty() || std::find(scenes.begin(), scenes.end(), m.name) != scenes.end();
    }
};

void judge_run(const scene& s, score& to) {
    judge j(s);
    std::vector<state> states;
    states.reserve(s.bodies.size());
    const double before = held_bytes();
    run r(s, to.who);
    r.it().read(states);
    to.complaint = j.complaint(states, r.it().gravity());
    for (int i = 1; i <= s.steps; ++i) {
        r.step();
        if (!s.joints.empty()) {
            r.it().read(states);
            j.watch(states);
        }
        if (i % 20 != 0 && i != s.steps) continue;
        if (i == s.steps) {
            to.contacts = r.it().contacts();
            to.bytes = held_bytes() - before;
            to.contact_bytes = r.it().contact_bytes();
        }
        r.it().read(states);
        j.sample(states);
    }
    to.accuracy = j.result();
}
void timed_run(const scene& s, score& to) {
    run r(s, to.who);
    to.rounds.emplace_back();
    for (int i = 0; i < s.steps; ++i) {
        r.step();
        to.rounds.back().push_back(r.last_ms());
    }
    const auto stages = r.it().stages();
    if (to.stages.empty()) to.stages = stages;
    else
        for (std::size_t i = 0; i < stages.size(); ++i) to.stages[i].second += stages[i].second;
}

void play(const scene& s, const std::vector<contestant>& all, const plan& p, progress& bar, report& out) {
    std::vector<score> scores;
    for (const contestant& c : all)
        if (c.joins(s)) scores.push_back({c, {}, {}, 0, 0, 0, {}, {}});
    for (int round = 0; round <= p.rounds; ++round)
        for (std::size_t i = 0; i < scores.size(); ++i) {
            score& next = scores[(i + static_cast<std::size_t>(round)) % scores.size()];
            bar.show(s.name + ", round " + std::to_string(round) + ": " + next.who.name);
            if (round == 0) judge_run(s, next);
            else timed_run(s, next);
        }
    bar.clear();
    if (!scores.empty()) out.add(s, scores);
}

int rest_of(const std::vector<contestant>& all, const plan& p) {
    rest_report out("bench/out/rest.csv");
    progress bar;
    bool good = true;
    std::vector<scene> scenes;
    for (const maker& m : piles())
        if (p.wants(m)) scenes.push_back(m.make(p.quick));
    for (scene& s : scenes) {
        if (p.steps > 0) s.steps = p.steps;
        for (const contestant& c : all) bar.total += c.joins(s) * 2 * (s.steps / 10);
    }
    for (scene& s : scenes)
        for (const bool sleeps : {false, true}) {
            s.sleeps = sleeps;
            rest_report::head(s);
            for (const contestant& c : all) {
                if (!c.joins(s)) continue;
                std::string complaint;
                const rest found = play_to_rest(s, c, complaint, [&](int step) {
                    if (step % 10 == 0) bar.show(s.name + (sleeps ? ", sleeping: " : ": ") + c.name);
                });
                bar.clear();
                if (complaint.empty()) out.add(s, c, found);
                else std::printf("NOT THE SAME SCENE: %s %s\n", c.name.c_str(), complaint.c_str()), good = false;
            }
        }
    rest_report::legend();
    for (const contestant& c : all) std::printf("%-16s%s\n", c.name.c_str(), c.settings.c_str());
    return good ? 0 : 1;
}

int list(const std::vector<contestant>& all) {
    for (const maker& m : makers()) std::printf("%-16s%dD  %s\n", m.name, m.dimension, m.about);
    std::puts("\n--rest:");
    for (const maker& m : piles()) std::printf("%-16s%dD  %s\n", m.name, m.dimension, m.about);
    std::puts("");
    for (const contestant& c : all) std::printf("%-16s%s\n", c.name.c_str(), c.settings.c_str());
    return 0;
}

bool knows(const plan& p, const std::string& name) {
    for (const maker& m : p.rest ? piles() : makers())
        if (m.name == name) return true;
    return false;
}

int main_of(const plan& p) {
    std::vector<contestant> all = contestants();
    std::stable_sort(all.begin(), all.end(), [](const contestant& a, const contestant& b) {
        return a.order != b.order ? a.order < b.order : a.name < b.name;
    });
    if (p.list) return list(all);
    all.erase(std::remove_if(all.begin(), all.end(), [&](const contestant& c) { return !p.wants(c); }), all.end());
    if (p.rest) return rest_of(all, p);
    const std::string name = p.scaling ? "bench/out/scaling" : "bench/out/scenes";
    report out(name + ".csv", name + ".md");
    std::vector<scene> scenes;
    if (p.scaling) {
        for (const auto& [rows, columns] : {std::pair(2, 9), {5, 11}, {10, 18}, {20, 27}, {30, 60}})
            if (!p.quick || rows < 10)
                scenes.push_back(many_pyramids(rows, columns, std::max(20, 50'000 / (rows * columns * 5))));
    } else {
        for (const maker& m : makers())
            if (p.wants(m)) scenes.push_back(m.make(p.quick));
    }
    progress bar;
    for (scene& s : scenes) {
        if (p.steps > 0) s.steps = p.steps;
        for (const contestant& c : all) bar.total += c.joins(s) * (p.rounds + 1);
    }
    for (const scene& s : scenes) play(s, all, p, bar, out);
    return out.print(all);
}

}  // namespace bench

int main(int count, char** arguments) {
    bench::plan plan;
    for (int i = 1; i < count; ++i) {
        const std::string a = arguments[i];
        const char* const value = i + 1 < count ? arguments[i + 1] : "";
        if (a == "--quick") plan.quick = true;
        else if (a == "--stages") plan.stages = true;
        else if (a == "--scaling") plan.scaling = true;
        else if (a == "--rest") plan.rest = true;
        else if (a == "--list") plan.list = true;
        else if (a == "2d") plan.flat = true;
        else if (a == "3d") plan.solid = true;
        else if (a == "--rounds") plan.rounds = std::max(1, std::atoi(value)), ++i;
        else if (a == "--steps") plan.steps = std::atoi(value), ++i;
        else if (a == "--only") {
            for (const char* c = value; *c; c += std::strcspn(c, ","), c += *c == ',')
                plan.only.emplace_back(c, std::strcspn(c, ","));
            ++i;
        } else plan.scenes.push_back(a);
    }
    for (const std::string& name : plan.scenes)
        if (!bench::knows(plan, name))
            return std::fprintf(stderr, "what is %s? --list says which scenes there are\n", name.c_str()), 2;
    return bench::main_of(plan);
}
