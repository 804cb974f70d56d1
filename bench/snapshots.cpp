// Snapshots of whole worlds, as rollback needs them: bytes a body and of what, CPU time to save and to restore
//
//     bash bench/run snapshots [--quick]    --quick: small scenes, few rounds
//
// Each round takes a step, saves what came of it and restores it, scene after scene. Beside it a bare memcpy of as many
// bytes between two blocks of memory: what no snapshot can beat.
#include "timing.hpp"

#include <cstring>
#include <functional>
#include <memory>

#include "../samples/scenes.hpp"

namespace bench {

using physics::detail::each_value_of;
using physics::detail::world_access;

/// Bytes that last of some parts of a state.
template <class... Parts>
double bytes_of(const Parts&... parts) {
    double sum = 0;
    const auto add = [&](const auto& piece) {
        using T = std::remove_cvref_t<decltype(piece)>;
        if constexpr (physics::detail::is_buffer<T>) sum += static_cast<double>(piece.size() * sizeof *piece.begin());
        else sum += sizeof piece;
    };
    (each_value_of(parts, add), ...);
    return sum;
}

struct figures {
    std::string what;
    double bodies = 0, contacts = 0, bytes = 0;
    /// Of the bytes: what is kept by body, by shape, by contact, by pair of shapes, and of boxes.
    double of_bodies = 0, of_shapes = 0, of_contacts = 0, of_memories = 0, of_boxes = 0;
    samples save, restore, copy;
};

/// A scene that is under way.
class contestant {
public:
    virtual ~contestant() = default;
    virtual void play(figures& to) = 0;
};
template <class Recipe>
class on_stage final : public contestant {
public:
    using world = physics::world<Recipe>;

    template <class Build>
    on_stage(Build&& build, int steps) : world_(scenes::grounded<world>()) {
        build(world_);
        for (int i = 0; i < steps; ++i) step();
    }
    void play(figures& to) override {
        step();
        auto& s = world_access::data_of(world_);
        const double thousands = static_cast<double>(world_.body_count()) / 1000;
        const stopwatch first;
        snapshot_.save(s);
        to.save.push_back(first.ns() / 1000 / thousands);
        const stopwatch second;
        if (!snapshot_.restore(s)) std::fputs("not restored\n", stderr);
        to.restore.push_back(second.ns() / 1000 / thousands);
        from_.resize(snapshot_.size());
        to_.resize(snapshot_.size());
        const stopwatch third;
        std::memcpy(to_.data(), from_.data(), snapshot_.size());
        to.copy.push_back(third.ns() / 1000 / thousands);

        to.bodies = world_.body_count();
        to.contacts = world_.contacts().size();
        to.bytes = static_cast<double>(snapshot_.size());
        to.of_contacts = bytes_of(s.contacts, s.sleep.contacts);
        to.of_bodies =
            bytes_of(s.bodies, s.contact_starts, s.awake, s.sleep, s.continuous) - bytes_of(s.sleep.contacts);
        to.of_shapes = bytes_of(s.shapes);
        to.of_memories = bytes_of(s.memories);
        to.of_boxes = bytes_of(s.broadphase);
    }

private:
    void step() { world_.step(static_cast<typename world::scalar>(1.0 / 60)); }

    world world_;
    physics::detail::raw_snapshot<typename physics::detail::plan_of<Recipe>::type> snapshot_;
    std::vector<unsigned char> from_, to_;
};

struct entry {
    figures of;
    std::function<std::unique_ptr<contestant>()> make;
    std::unique_ptr<contestant> it;

    entry(std::string what, std::function<std::unique_ptr<contestant>()> how) : make(std::move(how)) {
        of.what = std::move(what);
    }
};

template <class S, int D>
struct crates : physics::recipe<S, D> {};

template <class S, int D>
entry pyramid(const char* scalar, int rows, int steps) {
    const auto build = [rows](auto& world) {
        if constexpr (D == 2) scenes::pyramid(world, rows);
        else scenes::square_pyramid(world, rows);
    };
    return {std::string(D == 2 ? "2D pyramid, " : "3D pyramid, ") + scalar,
            [=] { return std::make_unique<on_stage<crates<S, D>>>(build, steps); }};
}
/// Asleep, no pair is remembered and no body is listed as one that moves.
template <class S, int D>
entry at_rest(const char* scalar, int wide) {
    const auto build = [wide](auto& world) {
        for (int i = 0; i < wide * wide; ++i) scenes::add_crate(world, 2 * i % (2 * wide), 0.5, 2.0 * (i / wide));
    };
    return {std::string("3D asleep, ") + scalar, [=] { return std::make_unique<on_stage<crates<S, D>>>(build, 90); }};
}

}  // namespace bench

int main(int count, char** arguments) {
    bool quick = false;
    for (int i = 1; i < count; ++i) {
        if (arguments[i] != std::string("--quick")) return std::fprintf(stderr, "what is %s?\n", arguments[i]), 2;
        quick = true;
    }
    const int rows2 = quick ? 20 : 100, rows3 = quick ? 10 : 30, rounds = quick ? 20 : 60, steps = quick ? 10 : 30;
    bench::entry all[] = {
        bench::pyramid<float, 2>("float", rows2, steps), bench::pyramid<float, 3>("float", rows3, steps),
        bench::pyramid<double, 2>("double", rows2, steps), bench::pyramid<double, 3>("double", rows3, steps),
        bench::at_rest<float, 3>("float", quick ? 20 : 100)};
    bench::progress bar;
    bar.total = static_cast<int>(std::size(all)) + rounds;
    for (bench::entry& e : all) {
        bar.show(e.of.what);
        e.it = e.make();
    }
    for (int round = 0; round < rounds; ++round) {
        bar.show("rounds");
        for (bench::entry& e : all) e.it->play(e.of);
    }
    bar.clear();
    std::FILE* csv = std::fopen("bench/out/snapshots.csv", "w");
    if (csv)
        std::fputs(
            "scene,bodies,contacts,bytes,of_bodies,of_shapes,of_contacts,of_memories,of_boxes,save_min,"
            "save_median,restore_min,restore_median,memcpy_min,memcpy_median\n",
            csv);
    std::puts(
        "                            contacts         bytes a body                                      "
        "us per 1,000 bodies, minimum / median");
    std::puts(
        "scene               bodies    a body   all   bodies   shapes contacts memories    boxes           "
        "save        restore         memcpy");
    for (const bench::entry& e : all) {
        const bench::figures& f = e.of;
        using bench::median, bench::minimum;
        std::printf("%-18s %7.0f %9.2f %5.0f %8.0f %8.0f %8.0f %8.0f %8.0f", f.what.c_str(), f.bodies,
                    f.contacts / f.bodies, f.bytes / f.bodies, f.of_bodies / f.bodies, f.of_shapes / f.bodies,
                    f.of_contacts / f.bodies, f.of_memories / f.bodies, f.of_boxes / f.bodies);
        for (const auto* times : {&f.save, &f.restore, &f.copy})
            std::printf("  %5.0f / %5.0f", minimum(*times), median(*times));
        std::puts("");
        if (!csv) continue;
        std::fprintf(csv, "\"%s\",%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f", f.what.c_str(), f.bodies, f.contacts,
                     f.bytes, f.of_bodies, f.of_shapes, f.of_contacts, f.of_memories, f.of_boxes);
        for (const auto* times : {&f.save, &f.restore, &f.copy})
            std::fprintf(csv, ",%.2f,%.2f", minimum(*times), median(*times));
        std::fputs("\n", csv);
    }
    if (csv) std::fclose(csv);
}
