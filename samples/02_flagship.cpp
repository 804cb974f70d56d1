// A wrecking ball in 2D and ragdolls in 3D, in float, double and fixed point: a table, and a page that plays it.
#include <physics.hpp>

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <concepts>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "filming.hpp"
#include "scenes.hpp"

namespace {

constexpr int steps = 600;
constexpr const char* page = "samples/out/flagship.html";

template <class S, int D>
struct recipe_of : physics::recipe<S, D, scenes::joints> {};

void show_progress(const char* name, int done) {
    static const bool terminal = isatty(fileno(stderr));
    if (!terminal || done % 10 != 0) return;
    const int width = 30 * done / steps;
    std::fprintf(stderr, "\r%-22s [%.*s%*s]%s", name, width, "##############################", 30 - width, "",
                 done == steps ? "\r\033[K" : "");
}

template <class S, int D, class Build>
void run(samples::recording& film, const char* title, Build&& build) {
    using world = physics::world<recipe_of<S, D>>;
    using clock = std::chrono::steady_clock;
    const std::string name = std::string(title) + ", " + physics::scalar_traits<S>::name();
    // Debug drawing takes as much space as the motion: one run has it.
    constexpr bool draws = std::same_as<S, float>;
    samples::recorded_scene& scene =
        film.add_scene({.title = title, .scalar = physics::scalar_traits<S>::name(), .dimension = D, .drawing = draws});

    double deepest = 0, gap = 0, seconds = 0;
    std::vector<samples::held_points<world>> pins;
    samples::motion_track<world> track(draws);
    clock::time_point began{};
    const world last = scenes::flagship<world>(build, steps, [&](const world& w, int step) {
        if (step > 0) seconds += std::chrono::duration<double>(clock::now() - began).count();
        else pins = samples::joints_of<physics::ball_joint, physics::revolute_joint>(w);
        deepest = std::max(deepest, scenes::deepest_overlap(w));
        gap = std::max(gap, samples::largest_gap(w, pins));
        if (scene.due(step)) track.add_frame(w);
        show_progress(name.c_str(), step);
        began = clock::now();
    });
    track.write(scene, pins);

    const auto text = [](const char* format, auto value) {
        char line[40];
        std::snprintf(line, sizeof line, format, value);
        return std::string(line);
    };
    const std::string columns[] = {text("%.3f", seconds * 1000 / steps), text("%.1f", deepest * 1000),
                                   text("%.1f", scenes::deepest_overlap(last) * 1000), text("%.1f", gap * 1000),
                                   text("%016" PRIx64, last.state_hash())};
    std::printf("%-16s %-8s %dD %6u %6u %9s %9s %8s %8s  %s\n", title, physics::scalar_traits<S>::name(), D,
                last.body_count(), last.joint_count(), columns[0].c_str(), columns[1].c_str(), columns[2].c_str(),
                columns[3].c_str(), columns[4].c_str());
    const char* labels[] = {"ms a step", "deepest overlap, mm", "at the end, mm", "widest joint, mm", "state hash"};
    for (int i = 0; i < 5; ++i) scene.fact(labels[i], columns[i]);
}

template <int D, class Build>
void run_scalars(samples::recording& film, const char* title, Build&& build) {
    run<float, D>(film, title, build);
    run<double, D>(film, title, build);
    run<physics::fixed32, D>(film, title, build);
}

}  // namespace

int main() {
    samples::recording film("physics", "one header, one source, three scalars, two dimensions");
    std::printf("%-16s %-8s    %6s %6s %9s %9s %8s %8s  %s\n", "scene", "scalar", "bodies", "joints", "ms/step",
                "overlap", "at rest", "joint", "state hash");
    run_scalars<2>(film, "wrecking ball", [](auto& w) { scenes::wrecked_pyramid(w); });
    run_scalars<3>(film, "ragdoll tower", [](auto& w) { scenes::ragdoll_tower(w); });
    std::puts(
        "\noverlap: the deepest of all contacts and steps, in mm. What flies at 12 m/s goes 20 cm in a step, and is\n"
        "stopped short of static bodies only, unless it is made `continuous`: an overlap of that size is one of the\n"
        "step in which two moving bodies meet. at rest: the deepest at the end. joint: how far one has opened at "
        "most;\n"
        "a body that is stopped short, at a fall on the ground, is for one step apart from what it is joined to.");
    try {
        const std::size_t bytes = film.write_html(page);
        std::printf("\n%s plays the motion in any browser (%.1f MB, no network needed)\n", page,
                    static_cast<double>(bytes) / 1e6);
    } catch (const std::exception& failure) {
        std::fprintf(stderr, "%s\n", failure.what());
        return EXIT_FAILURE;
    }
}
