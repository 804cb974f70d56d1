// The same scenes in float, double and fixed point, in 2D and 3D: a table, and a page that plays the motion.
#include <physics.hpp>

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "recording.hpp"
#include "scenes.hpp"

namespace {

constexpr int steps = 600;
constexpr const char* page = "samples/out/flagship.html";

template <class S, int D>
struct recipe_of : physics::recipe<S, D> {};

template <class S>
samples::pose pose_of(const physics::transform<S, 2>& t) {
    const auto n = [](S x) { return static_cast<double>(x); };
    return samples::flat(n(t.position.x), n(t.position.y), n(t.rotation.cosine), n(t.rotation.sine));
}
template <class S>
samples::pose pose_of(const physics::transform<S, 3>& t) {
    const auto n = [](S x) { return static_cast<double>(x); };
    return samples::solid(n(t.position.x), n(t.position.y), n(t.position.z), n(t.rotation.x), n(t.rotation.y),
                          n(t.rotation.z), n(t.rotation.w));
}

template <class S, int D>
samples::shape drawn(const physics::ball<S, D>& b, samples::pose at) {
    return samples::sphere(static_cast<double>(b.radius), at);
}
template <class S, int D>
samples::shape drawn(const physics::capsule<S, D>& c, samples::pose at) {
    return samples::capsule(static_cast<double>(c.radius), static_cast<double>(c.half_length), at);
}
template <class S, int D>
samples::shape drawn(const physics::box<S, D>& b, samples::pose at) {
    return samples::box(static_cast<double>(b.half_extents.x), static_cast<double>(b.half_extents.y),
                        D == 3 ? static_cast<double>(b.half_extents[D - 1]) : 0, at);
}
template <class S, int D>
samples::shape drawn(const physics::halfspace<S, D>& h, samples::pose at) {
    return samples::halfspace(static_cast<double>(h.normal.x), static_cast<double>(h.normal.y),
                              D == 3 ? static_cast<double>(h.normal[D - 1]) : 0, static_cast<double>(h.offset), at);
}

/// Tells a recording of all bodies of a world.
template <class World>
void cast(samples::recorded_scene& scene, const World& world) {
    for (const physics::body_id id : world.bodies()) {
        std::vector<samples::shape> shapes;
        for (const physics::shape_id s : world.shapes(id))
            world.shape(s).visit(
                [&](const auto& shape) { shapes.push_back(drawn(shape, pose_of(world.local_pose(s)))); });
        const bool fixed = world.type(id) == physics::body_type::static_body;
        scene.add_body(fixed ? samples::motion::fixed : samples::motion::dynamic, shapes, pose_of(world.pose(id)));
    }
}

/// Records where all bodies are, and their contacts.
template <class World>
void shoot(samples::recorded_scene& scene, const World& world) {
    const auto n = [](auto x) { return static_cast<double>(x); };
    const auto depth = [&](const typename World::vec& v) {
        return World::dimension == 3 ? n(v[World::dimension - 1]) : 0;
    };
    int number = 0;
    for (const physics::body_id id : world.bodies()) scene.place(number++, pose_of(world.pose(id)));
    for (const auto contact : world.contacts())
        for (int k = 0; k < contact.count; ++k) {
            const auto& p = contact.points[k];
            scene.add({n(p.position.x), n(p.position.y), depth(p.position), n(contact.normal.x), n(contact.normal.y),
                       depth(contact.normal), n(p.normal_impulse)});
        }
    scene.commit();
}

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
    samples::recorded_scene& scene =
        film.add_scene({.title = title, .scalar = physics::scalar_traits<S>::name(), .dimension = D});

    double deepest = 0, seconds = 0;
    clock::time_point began{};
    const world last = scenes::flagship<world>(build, steps, [&](const world& w, int step) {
        if (step > 0) seconds += std::chrono::duration<double>(clock::now() - began).count();
        else cast(scene, w);
        deepest = std::max(deepest, scenes::deepest_overlap(w));
        if (scene.due(step)) shoot(scene, w);
        show_progress(name.c_str(), step);
        began = clock::now();
    });

    const auto text = [](const char* format, auto value) {
        char line[40];
        std::snprintf(line, sizeof line, format, value);
        return std::string(line);
    };
    const std::string columns[] = {std::to_string(last.steps()), text("%.3f", seconds * 1000 / steps),
                                   text("%.1f", deepest * 1000), text("%.2e", scenes::kinetic_energy(last)),
                                   text("%016" PRIx64, last.state_hash())};
    std::printf("%-14s %-8s %dD %6u %6s %9s %12s %12s  %s\n", title, physics::scalar_traits<S>::name(), D,
                last.body_count(), columns[0].c_str(), columns[1].c_str(), columns[2].c_str(), columns[3].c_str(),
                columns[4].c_str());
    const char* labels[] = {"steps", "ms a step", "deepest overlap, mm", "kinetic energy, J", "state hash"};
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
    std::printf("%-14s %-8s    %6s %6s %9s %12s %12s  %s\n", "scene", "scalar", "bodies", "steps", "ms/step",
                "overlap, mm", "energy, J", "state hash");
    run_scalars<2>(film, "crate pyramid", [](auto& w) { scenes::pyramid(w, 10); });
    run_scalars<3>(film, "plank tower", [](auto& w) { scenes::tower(w, 10); });
    try {
        const std::size_t bytes = film.write_html(page);
        std::printf("\n%s plays the motion in any browser (%.1f MB, no network needed)\n", page,
                    static_cast<double>(bytes) / 1e6);
    } catch (const std::exception& failure) {
        std::fprintf(stderr, "%s\n", failure.what());
        return EXIT_FAILURE;
    }
}
