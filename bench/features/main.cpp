// Plays the scenes in all worlds that are linked in, and prints a line of CSV for each; see bench/features.py.
//
//     features [--quick] [--rounds N]
#include <malloc.h>

#include <cstdlib>
#include <cstring>

#include "../timing.hpp"
#include "scenes.hpp"
#include "subject.hpp"

namespace bench {

namespace {

double held_bytes() {
    const struct mallinfo2 m = mallinfo2();
    return static_cast<double>(m.uordblks + m.hblkhd);
}

/// The friction of all surfaces of a scene: worlds without materials know no other.
double friction_of(const scene& s) {
    const double first = s.bodies.front().shapes.front().friction;
    for (const body& b : s.bodies)
        for (const shape& each : b.shapes)
            if (each.friction != first) {
                std::fprintf(stderr, "%s: its surfaces are not alike\n", s.name.c_str());
                std::exit(1);
            }
    return first;
}

class run {
public:
    run(const subject& who, const scene& s) : who_(who), world_(who.make(s.gravity.data(), friction_of(s))) {
        std::vector<plain_shape> shapes;
        for (const body& b : s.bodies) {
            shapes.clear();
            for (const shape& each : b.shapes) {
                plain_shape to{each.kind == form::ball, {}, each.radius, {}, each.density, each.friction};
                std::copy(each.half.begin(), each.half.end(), to.half);
                std::copy(each.at.begin(), each.at.end(), to.at);
                shapes.push_back(to);
            }
            plain_body to{b.kind == role::fixed    ? 0
                          : b.kind == role::driven ? 1
                                                   : 2,
                          {},
                          {},
                          {},
                          {},
                          shapes.data(),
                          static_cast<int>(shapes.size())};
            std::copy(b.at.begin(), b.at.end(), to.at);
            std::copy(b.rotation.begin(), b.rotation.end(), to.rotation);
            std::copy(b.velocity.begin(), b.velocity.end(), to.velocity);
            std::copy(b.spin.begin(), b.spin.end(), to.spin);
            who.add(world_, to);
        }
    }
    run(const run&) = delete;
    run& operator=(const run&) = delete;
    ~run() { who_.drop(world_); }

    double step_ns(double dt) {
        const stopwatch clock;
        who_.step(world_, dt);
        return clock.ns();
    }
    [[nodiscard]] const void* it() const { return world_; }

private:
    const subject& who_;
    void* world_;
};

struct score {
    const subject* who;
    /// Of each step over all rounds.
    samples least;
    samples means;
    double contacts = 0, bytes_of_copy = 0, bytes_at_work = 0;
    std::uint64_t places = 0;
};

void play(const timed_scene& s, score& to, bool first) {
    const double before = held_bytes();
    run r(*to.who, s.it);
    samples times;
    for (int i = 0; i < s.it.steps; ++i) {
        const double ns = r.step_ns(s.it.dt);
        if (i >= s.before) times.push_back(ns);
        if (first && i >= s.before) to.contacts += to.who->contacts(r.it()) / double(s.it.steps - s.before);
    }
    to.means.push_back(mean(times));
    if (to.least.empty()) to.least = times;
    for (std::size_t i = 0; i < times.size(); ++i) to.least[i] = std::min(to.least[i], times[i]);
    if (!first) return;
    to.places = to.who->places(r.it());
    const double held = held_bytes();
    to.bytes_at_work = held - before;
    void* const copy = to.who->copy(r.it());
    to.bytes_of_copy = held_bytes() - held;
    to.who->drop(copy);
}

int main_of(bool quick, int rounds) {
    std::vector<const subject*> all;
    for (const subject* s = subject::first; s; s = s->next) all.push_back(s);
    std::vector<std::pair<int, timed_scene>> scenes;
    progress bar;
    for (const int dimension : {2, 3}) {
        const auto count = std::count_if(all.begin(), all.end(), [&](auto s) { return s->dimension == dimension; });
        if (count == 0) continue;
        for (const timed_scene& s : feature_scenes(dimension, quick)) scenes.emplace_back(dimension, s);
        bar.total += static_cast<int>(count) * rounds * 3;
    }
    std::puts("dimension,scene,bodies,left_out,ns,ns_median,contacts,bytes_of_copy,bytes_at_work,places");
    for (const auto& [dimension, s] : scenes) {
        std::vector<score> scores;
        for (const subject* who : all)
            if (who->dimension == dimension) scores.push_back({who, {}, {}, 0, 0, 0, 0});
        for (int round = 0; round < rounds; ++round)
            for (std::size_t i = 0; i < scores.size(); ++i) {
                score& next = scores[(i + static_cast<std::size_t>(round)) % scores.size()];
                bar.show(std::to_string(dimension) + "D " + s.what + " without " + next.who->left_out + ", round " +
                         std::to_string(round + 1));
                play(s, next, round == 0);
            }
        const double bodies = s.it.free_bodies();
        for (const score& c : scores)
            std::printf("%d,%s,%.0f,%s,%.6g,%.6g,%.6g,%.0f,%.0f,%016llx\n", dimension, s.what, bodies, c.who->left_out,
                        mean(c.least) / bodies, median(c.means) / bodies, c.contacts, c.bytes_of_copy, c.bytes_at_work,
                        static_cast<unsigned long long>(c.places));
    }
    bar.clear();
    return 0;
}

}  // namespace

}  // namespace bench

int main(int count, char** arguments) {
    bool quick = false;
    int rounds = 0;
    for (int i = 1; i < count; ++i) {
        if (std::strcmp(arguments[i], "--quick") == 0) quick = true;
        else if (std::strcmp(arguments[i], "--rounds") == 0 && i + 1 < count) rounds = std::atoi(arguments[++i]);
        else return std::fprintf(stderr, "what is %s?\n", arguments[i]), 2;
    }
    return bench::main_of(quick, rounds > 0 ? rounds : quick ? 25 : 9);
}
