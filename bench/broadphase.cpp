// CPU time of broadphases, a proxy: build, frames with 1, 10, 100 % moving, rays, regions; bytes a proxy
//
//     bash bench/run broadphase [--quick] [2d] [3d] [N ...]    --quick: 1,000 and 10,000 proxies, few frames
//
// A frame is move() for each that moves, then pairs(): margins, filters, begin and end included. It moves each mover by
// up to 5 cm along each axis; who moves is chosen anew. Contestants take turns within each round, and play the same
// frames. Rays look for the closest box up to 50 m away, regions for all in boxes of 2 to 4 m; the caller tests against
// the boxes without margins, so all must give the same answers, which is checked, as are the pairs of small worlds.
// Compiled with those that are installed; what Debian packages, bench/run installs and links:
// peer: bullet/LinearMath/btScalar.h=libbullet-dev -I/usr/include/bullet -lBulletCollision -lLinearMath
// peer: box2d/b2_broad_phase.h=libbox2d-dev -lbox2d
// peer: embree3/rtcore.h=libembree-dev -lembree3
#include <physics.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "broadphase/ours.hpp"
#include "broadphase/peers.hpp"
#include "broadphase/report.hpp"
#include "broadphase/scene.hpp"

namespace bench {

/// One line a contestant. Scalars other than float take part in one size only: they share all but the conversion.
template <int D>
std::vector<contestant> contestants() {
    using physics::fixed32;
    std::vector<contestant> all = {
        {"dynamic_tree", "float", 4'000'000, make<ours<physics::dynamic_tree, float, D>>},
        {"dynamic_tree", "double", 10'000, make<ours<physics::dynamic_tree, double, D>>},
        {"dynamic_tree", "fixed32", 10'000, make<ours<physics::dynamic_tree, fixed32, D>>},
        {"sweep_and_prune", "float", 100'000, make<ours<physics::sweep_and_prune, float, D>>},
        {"grid", "float", 4'000'000, make<ours<physics::grid, float, D>>},
        {"hash_grid", "float", 4'000'000, make<ours<physics::hash_grid, float, D>>},
        {"all_pairs", "float", 1'000, make<ours<physics::all_pairs, float, D>>},
    };
    add_peers<D>(all);
    return all;
}

/// How much to measure.
struct plan {
    bool quick = false;

    [[nodiscard]] int builds(std::uint32_t n) const { return quick || n > 200'000 ? 1 : n > 2'000 ? 3 : 7; }
    [[nodiscard]] int rounds_of_queries() const { return quick ? 5 : 15; }
    [[nodiscard]] std::uint32_t queries() const { return quick ? 1000 : 2000; }
    [[nodiscard]] int frames(std::uint32_t n, double part) const {
        const int most = part < 0.05 ? 400 : part < 0.5 ? 80 : 25;
        return quick ? most / 8 : n > 200'000 ? most / 5 : n > 20'000 ? most / 2 : most;
    }
};

/// One world, all contestants that can bear it.
template <int D>
class match {
public:
    match(layout kind, std::uint32_t n, const plan& p, progress& bar)
        : plan_(p), bar_(bar), scene_(kind, D, n), what_(std::to_string(D) + "D " + name_of(kind) + ", " + grouped(n)) {
        for (const contestant& c : contestants<D>())
            if (n <= c.most && (n == 10'000 || c.scalar == std::string("float"))) all_.push_back({c, nullptr, {}, 0});
    }
    void run(report& out) {
        build();
        still();
        if (scene_.boxes.size() <= 1000) check_pairs(out);
        play(1, 8, nullptr);
        play_part(0.01, &figures::frame_1);
        play_part(0.1, &figures::frame_10);
        play_part(1, &figures::frame_100);
        query(out);
        for (entry& e : all_) out.add(scene_, e.who, e.measured, e.held / static_cast<double>(size()));
    }
    /// Steps of the progress bar that run() takes.
    static int steps() { return 5; }

private:
    struct entry {
        contestant who;
        std::unique_ptr<broadphase> it;
        figures measured;
        double held;
    };
    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(scene_.boxes.size()); }

    void build() {
        bar_.show(what_ + ": build");
        for (int round = 0; round < plan_.builds(size()); ++round)
            for (entry& e : in_turn(round)) {
                e.it.reset();
                const double before = held_bytes();
                e.it = e.who.make();
                const stopwatch clock;
                e.it->build(scene_);
                e.measured.build.push_back(clock.ns() / size());
                e.held = held_bytes() - before;
            }
    }
    /// The first search, which finds all pairs.
    void still() {
        for (entry& e : all_)
            if (e.it->moving()) counted(e, [&] { e.it->frame({}); });
    }
    /// Against a slow count: with margins there may be more.
    void check_pairs(report& out) {
        for (const contestant& c : contestants<D>()) {
            const auto it = c.make();
            if (!it->moving()) continue;
            const bool exact = it->without_margins();
            scene world(scene_);
            it->build(world);
            it->frame({});
            for (int frame = 0; frame < 4; ++frame) {
                const std::size_t found = it->pairs(), expected = slow_pairs(world);
                if (exact ? found != expected : it->knows_pairs() && found < expected)
                    out.complain(what_ + ": " + c.name + " finds " + std::to_string(found) + " pairs of " +
                                 std::to_string(expected));
                moves m;
                world.step(0.5, m);
                it->frame(m);
            }
        }
    }
    /// The trees of yesterday's frames are not those of today's: some frames come first.
    void play_part(double part, samples figures::*into) {
        const int frames = plan_.frames(size(), part);
        play(part, frames / 3, nullptr);
        play(part, frames, into);
    }
    /// Frames in short blocks, each played by all in turn; only the first of a block finds the caches cold.
    void play(double part, int frames, samples figures::*into) {
        bar_.show(what_ + ": frames", into ? 1 : 0);
        const int block = std::clamp(static_cast<int>(4e6 / (part * size())), 1, std::max(10, frames / 10));
        std::vector<moves> ahead(static_cast<std::size_t>(block));
        for (int done = 0, round = 0; done < frames; done += block, ++round) {
            for (moves& m : ahead) scene_.step(part, m);
            for (entry& e : in_turn(round)) {
                if (!e.it->moving()) continue;
                counted(e, [&] {
                    for (const moves& m : ahead) {
                        const stopwatch clock;
                        e.it->frame(m);
                        const double ns = clock.ns() / size();
                        if (into) (e.measured.*into).push_back(ns);
                    }
                });
            }
        }
    }
    void query(report& out) {
        bar_.show(what_ + ": queries", 1);
        const questions asked(scene_, plan_.queries());
        std::vector<answers> given(all_.size());
        for (entry& e : all_)
            if (!e.it->moving()) e.it->build(scene_);
        for (int round = 0; round < plan_.rounds_of_queries(); ++round)
            for (entry& e : in_turn(round)) {
                answers& a = given[static_cast<std::size_t>(&e - all_.data())];
                const stopwatch first;
                a.fractions = e.it->cast(asked.rays, scene_.boxes.data());
                e.measured.ray.push_back(first.ns() / plan_.queries());
                if (!e.it->moving()) continue;
                const stopwatch second;
                a.found = e.it->search(asked.regions, scene_.boxes.data());
                e.measured.region.push_back(second.ns() / plan_.queries());
            }
        for (std::size_t i = 0; i < all_.size(); ++i) {
            const double off = given[i].fractions - given[0].fractions;
            if (off > 1e-4 * given[0].fractions || off < -1e-4 * given[0].fractions)
                out.complain(what_ + ": rays of " + all_[i].who.name + " end elsewhere");
            if (all_[i].it->moving() && given[i].found != given[0].found)
                out.complain(what_ + ": regions of " + all_[i].who.name + " hold others");
        }
    }
    struct answers {
        double fractions = 0;
        std::size_t found = 0;
    };
    template <class Run>
    void counted(entry& e, Run&& run) {
        const double before = held_bytes();
        run();
        e.held += held_bytes() - before;
    }
    /// Everybody is first in some rounds.
    auto in_turn(int round) {
        std::vector<std::reference_wrapper<entry>> order;
        for (std::size_t i = 0; i < all_.size(); ++i)
            order.emplace_back(all_[(i + static_cast<std::size_t>(round)) % all_.size()]);
        return order;
    }

    plan plan_;
    progress& bar_;
    scene scene_;
    std::string what_;
    std::vector<entry> all_;
};

template <int D>
int run(const plan& p, std::vector<std::uint32_t> sizes, progress& bar, report* out) {
    int steps = 0;
    for (const layout kind : {layout::uniform, layout::mixed, layout::corridor})
        for (const std::uint32_t n : sizes) {
            // The others are there for their shapes: two sizes say enough.
            if (kind != layout::uniform && n != 10'000 && n != 100'000) continue;
            steps += match<D>::steps();
            if (out) match<D>(kind, n, p, bar).run(*out);
        }
    return steps;
}

}  // namespace bench

int main(int count, char** arguments) {
    bench::plan plan;
    std::vector<std::uint32_t> sizes;
    bool flat = false, space = false;
    for (int i = 1; i < count; ++i) {
        const std::string a = arguments[i];
        if (a == "--quick") plan.quick = true;
        else if (a == "2d") flat = true;
        else if (a == "3d") space = true;
        else if (const int n = std::atoi(a.c_str()); n > 0) sizes.push_back(static_cast<std::uint32_t>(n));
        else return std::fprintf(stderr, "what is %s?\n", a.c_str()), 2;
    }
    if (!flat && !space) flat = space = true;
    if (sizes.empty()) {
        sizes = {1'000, 10'000};
        if (!plan.quick) sizes.insert(sizes.end(), {100'000, 1'000'000});
    }
    bench::progress bar;
    bench::report out("bench/out/broadphase.csv");
    if (space) bar.total += bench::run<3>(plan, sizes, bar, nullptr);
    if (flat) bar.total += bench::run<2>(plan, sizes, bar, nullptr);
    if (space) bench::run<3>(plan, sizes, bar, &out);
    if (flat) bench::run<2>(plan, sizes, bar, &out);
    bar.clear();
    return out.print();
}
