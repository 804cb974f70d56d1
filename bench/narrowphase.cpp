// CPU time of the narrowphase, a pair: distance, overlap, penetration, manifold; and how wrong the answers are
//
//     bash bench/run narrowphase [--quick] [2d] [3d] [PAIR ...]    PAIR: box-box, hull32-hull32, ...
//
// 256 random pairs a set (96 of the largest hulls), sizes 0.25 to 1 m, A at the origin. Cold: nothing is known of a
// pair. Warm: 16 frames of 1 cm and 0.01 rad, at rest a thousandth of it, for those who remember something. Contestants
// take turns within each round. Answers to two frames 4 cm and 0.04 rad apart are judged by the exhaustive search that
// the tests use.
// Compiled with those that are installed; what Debian packages, bench/run installs and links:
// peer: bullet/LinearMath/btScalar.h=libbullet-dev -I/usr/include/bullet -lBulletCollision -lLinearMath
// peer: fcl/config.h=libfcl-dev -I/usr/include/eigen3 -lfcl -lccd
// peer: ccd/ccd.h=libccd-dev -lccd
// peer: box2d/b2_distance.h=libbox2d-dev -lbox2d
#include <physics.hpp>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "narrowphase/ours.hpp"
#include "narrowphase/peers.hpp"
#include "narrowphase/report.hpp"
#include "narrowphase/scene.hpp"

namespace bench {

template <class S, int D>
void add_ours(std::vector<contestant>& to, const char* scalar) {
    to.push_back({"physics", scalar, std::make_unique<ours<physics::best_per_pair, S, D>>()});
    if (!std::is_same_v<S, float>) return;
    to.push_back({"physics_gjk_epa", scalar, std::make_unique<ours<physics::gjk_epa, S, D>>()});
    to.push_back({"physics_gjk_mpr", scalar, std::make_unique<ours<physics::gjk_mpr, S, D>>()});
}

inline std::vector<contestant> contestants() {
    std::vector<contestant> all;
    add_ours<float, 3>(all, "float");
    add_ours<double, 3>(all, "double");
    add_ours<physics::fixed32, 3>(all, "fixed32");
    add_ours<float, 2>(all, "float");
    add_ours<double, 2>(all, "double");
    add_ours<physics::fixed32, 2>(all, "fixed32");
    add_peers(all);
    return all;
}

struct plan {
    bool quick = false, flat = true, space = true;
    std::vector<std::string> wanted;

    [[nodiscard]] int rounds() const { return quick ? 7 : 31; }
    [[nodiscard]] int pairs(const std::string& of) const {
        return of == "hull128" ? quick ? 16 : 96 : quick ? 64 : 256;
    }
    [[nodiscard]] bool wants(int D, const std::string& a, const std::string& b) const {
        return (D == 2 ? flat : space) &&
               (wanted.empty() || std::find(wanted.begin(), wanted.end(), a + "-" + b) != wanted.end());
    }
};

/// One task on one set of pairs.
inline void play(const pair_set& s, task t, const plan& p, std::vector<contestant>& all, report& out) {
    struct entry {
        contestant* who;
        samples cold, warm;
    };
    std::vector<entry> able;
    for (contestant& c : all)
        if (c.it->can(s, t)) {
            c.it->load(s);
            able.push_back({&c, {}, {}});
        }
    std::vector<outcome> answers(s.pairs());
    const auto pairs = static_cast<double>(s.pairs());
    for (int round = 0; round < p.rounds(); ++round)
        for (std::size_t i = 0; i < able.size(); ++i) {
            // Everybody is first in some rounds.
            entry& e = able[(i + static_cast<std::size_t>(round)) % able.size()];
            // The others have filled the processor's caches; to those who take long it makes no difference.
            const bool slow = round > 0 && minimum(e.cold) > 5000;
            if (!slow) e.who->it->run(t, 0, false, answers.data());
            const stopwatch first;
            const int frames = slow ? 1 : 4;
            for (int k = 0; k < frames; ++k) e.who->it->run(t, k * (pair_set::frames / 4), false, answers.data());
            e.cold.push_back(first.ns() / pairs / frames);
            if (!e.who->it->remembers(t)) continue;
            e.who->it->run(t, pair_set::frames - 1, true, answers.data());
            const stopwatch second;
            for (int frame = 0; frame < pair_set::frames; ++frame) e.who->it->run(t, frame, true, answers.data());
            e.warm.push_back(second.ns() / pairs / pair_set::frames);
        }
    for (entry& e : able) {
        quality cold, warm;
        for (int k = 0; k < 2; ++k)
            for (quality* q : {&cold, &warm}) {
                if (q == &warm && !e.who->it->remembers(t)) continue;
                std::fill(answers.begin(), answers.end(), outcome{});
                e.who->it->run(t, pair_set::judged[k], q == &warm, answers.data());
                for (std::size_t i = 0; i < s.pairs(); ++i) q->judge(t, s, k, i, answers[i]);
            }
        out.add(s, t, *e.who, e.cold, e.warm, cold, warm);
    }
}

/// Without a report: counts the sets.
inline int run(const plan& p, progress& bar, report* out) {
    struct kinds {
        int dimension;
        const char *a, *b;
    };
    const kinds all_kinds[] = {{3, "box", "box"},         {3, "hull8", "hull8"}, {3, "hull32", "hull32"},
                               {3, "hull128", "hull128"}, {3, "capsule", "box"}, {3, "sphere", "hull32"},
                               {2, "box", "box"},         {2, "hull8", "hull8"}};
    std::vector<contestant> all = contestants();
    int sets = 0;
    for (const auto& [D, a, b] : all_kinds) {
        if (!p.wants(D, a, b)) continue;
        for (const state in : {state::apart, state::shallow, state::deep, state::stacked, state::resting}) {
            if (in >= state::stacked && a != std::string("box")) continue;
            ++sets;
            if (!out) continue;
            const std::string what = std::to_string(D) + "D " + a + "-" + b + ", " + name_of(in);
            bar.show(what);
            const pair_set s(D, a, b, in, p.pairs(a));
            if (in == state::apart) play(s, task::distance, p, all, *out);
            if (in == state::apart || in == state::shallow) play(s, task::boolean, p, all, *out);
            if (in == state::shallow || in == state::deep) play(s, task::penetration, p, all, *out);
            if (in == state::shallow || in >= state::stacked) play(s, task::manifold, p, all, *out);
        }
    }
    return sets;
}

}  // namespace bench

int main(int count, char** arguments) {
    bench::plan plan;
    bool flat = false, space = false;
    for (int i = 1; i < count; ++i) {
        const std::string a = arguments[i];
        if (a == "--quick") plan.quick = true;
        else if (a == "2d") flat = true;
        else if (a == "3d") space = true;
        else if (a.find('-', 1) != std::string::npos && a[0] != '-') plan.wanted.push_back(a);
        else return std::fprintf(stderr, "what is %s?\n", a.c_str()), 2;
    }
    if (flat != space) plan.flat = flat, plan.space = space;
    bench::progress bar;
    bar.total = bench::run(plan, bar, nullptr);
    if (bar.total == 0) return std::fputs("no such pair\n", stderr), 2;
    bench::report out("bench/out/narrowphase.csv");
    bench::run(plan, bar, &out);
    bar.clear();
    out.print();
    return 0;
}
