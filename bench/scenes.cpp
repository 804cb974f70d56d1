// CPU time of whole steps, and what they are worth: overlaps, sag, rest, by one judge for all engines
//
//     bash bench/run scenes [--quick] [2d] [3d] [SCENE ...]     all scenes, or these; --quick: small ones
//         [--only ENGINE,...]   these engines      [--rounds N]   timed rounds (3)     [--steps N]   so many steps
//         [--stages]            one line more: ours by stage     [--list]   scenes and engines
//         [--scaling]           many pyramids from 1,000 to 100,000 bodies: what a body costs
//
// Scenes are told to all engines in the same plain numbers (scenes/scene.hpp). Every adapter says what the engine made
// of them, and the masses, poses, velocities and the gravity are compared before the first step. Sleeping and damping
// are off, all else is as it ships: the settings are printed. The first run of an engine is for the judge (see
// scenes/judge.hpp), the others are for the clock, and engines take turns within each round. Bytes a body are what the
// engine has taken of the heap by the end; bytes a contact are those of an image of the world, less those of the image
// without contacts and what is remembered of pairs, for each contact that there is. Peers do not tell.
// Each unit of scenes/ that begins with `// peer:` is compiled if what it names is there or can be had. An engine
// takes part by being linked in (scenes/engine.hpp).
#include <malloc.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "scenes/engine.hpp"
#include "scenes/judge.hpp"
#include "scenes/makers.hpp"
#include "scenes/report.hpp"

namespace bench {

double held_bytes() {
    const struct mallinfo2 m = mallinfo2();
    return static_cast<double>(m.uordblks + m.hblkhd);
}

struct plan {
    bool quick = false, stages = false, scaling = false, list = false, flat = false, solid = false;
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

/// An engine in the middle of a scene.
class run {
public:
    run(const scene& s, const contestant& c) : scene_(s), engine_(c.make(s.dimension)) {
        engine_->begin(s);
        born();
    }
    void step() {
        for (const swing& w : scene_.swings)
            engine_->drive(w.body, {w.speed(done_ * scene_.dt, scene_.dt), 0, 0}, {});
        const stopwatch clock;
        engine_->step(scene_.dt);
        last_ = clock.ns() / 1e6;
        ++done_;
        born();
    }
    [[nodiscard]] double last_ms() const { return last_; }
    [[nodiscard]] const engine& it() const { return *engine_; }

private:
    void born() {
        while (next_ < scene_.bodies.size() && scene_.bodies[next_].born <= done_) engine_->add(scene_.bodies[next_++]);
    }
    const scene& scene_;
    std::unique_ptr<engine> engine_;
    std::size_t next_ = 0;
    int done_ = 0;
    double last_ = 0;
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

int list(const std::vector<contestant>& all) {
    for (const maker& m : makers()) std::printf("%-16s%dD  %s\n", m.name, m.dimension, m.about);
    std::puts("");
    for (const contestant& c : all) std::printf("%-16s%s\n", c.name.c_str(), c.settings.c_str());
    return 0;
}

int main_of(const plan& p) {
    std::vector<contestant> all = contestants();
    std::stable_sort(all.begin(), all.end(), [](const contestant& a, const contestant& b) {
        return a.order != b.order ? a.order < b.order : a.name < b.name;
    });
    if (p.list) return list(all);
    all.erase(std::remove_if(all.begin(), all.end(), [&](const contestant& c) { return !p.wants(c); }), all.end());
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
        else if (a == "--list") plan.list = true;
        else if (a == "2d") plan.flat = true;
        else if (a == "3d") plan.solid = true;
        else if (a == "--rounds") plan.rounds = std::max(1, std::atoi(value)), ++i;
        else if (a == "--steps") plan.steps = std::atoi(value), ++i;
        else if (a == "--only") {
            for (const char* c = value; *c; c += std::strcspn(c, ","), c += *c == ',')
                plan.only.emplace_back(c, std::strcspn(c, ","));
            ++i;
        } else if (std::any_of(bench::makers().begin(), bench::makers().end(),
                               [&](const bench::maker& m) { return m.name == a; }))
            plan.scenes.push_back(a);
        else return std::fprintf(stderr, "what is %s? --list says which scenes there are\n", a.c_str()), 2;
    }
    return bench::main_of(plan);
}
