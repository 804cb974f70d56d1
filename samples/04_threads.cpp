// The same world on one thread, on our thread pool, by OpenMP and by TBB: other times, the same bits.
// flags: -fopenmp -ltbb
// needs: tbb/parallel_for.h=libtbb-dev
#define PHYSICS_HPP_THREADS
#include <physics.hpp>

#include <omp.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <vector>

// An executor says how many workers it has, and runs each task once: that is all.
struct openmp {
    [[nodiscard]] std::uint32_t workers() const { return static_cast<std::uint32_t>(omp_get_max_threads()); }
    void run(std::uint32_t count, const physics::task_set& tasks) const {
#pragma omp parallel for schedule(dynamic)
        for (std::int64_t task = 0; task < count; ++task)
            tasks(static_cast<std::uint32_t>(task), static_cast<std::uint32_t>(omp_get_thread_num()));
    }
};

struct threading_building_blocks {
    tbb::task_arena arena;

    [[nodiscard]] std::uint32_t workers() const { return static_cast<std::uint32_t>(arena.max_concurrency()); }
    void run(std::uint32_t count, const physics::task_set& tasks) {
        arena.execute([&] {
            tbb::parallel_for(std::uint32_t{0}, count, [&](std::uint32_t task) {
                tasks(task, static_cast<std::uint32_t>(tbb::this_task_arena::current_thread_index()));
            });
        });
    }
};

struct yard : physics::recipe<float, 3> {};
using world = physics::world<yard>;

// 400 stacks of ten crates, and a pyramid that is one island.
world filled_yard() {
    world w{{.gravity = {0, -10, 0}, .sleeping = {.enabled = false}}};
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), world::halfspace{{0, 1, 0}});
    const auto add = [&](float x, float y, float z) {
        w.create_shape(w.create_body({.position = {x, y, z}}), world::box{{0.5, 0.5, 0.5}});
    };
    for (int stack = 0; stack < 400; ++stack)
        for (int i = 0; i < 10; ++i)
            add(3.0f * static_cast<float>(stack % 20), 0.5f + static_cast<float>(i),
                3.0f * static_cast<float>(stack / 20));
    for (int row = 0; row < 12; ++row)
        for (int i = 0; i < 12 - row; ++i)
            for (int k = 0; k < 12 - row; ++k)
                add(-20 + 1.1f * static_cast<float>(i) + 0.55f * static_cast<float>(row),
                    0.5f + static_cast<float>(row), 1.1f * static_cast<float>(k) + 0.55f * static_cast<float>(row));
    return w;
}

template <class Step>
void measure(const char* name, Step&& step) {
    world w = filled_yard();
    std::vector<double> ms;
    for (int i = 0; i < 120; ++i) {
        const auto start = std::chrono::steady_clock::now();
        step(w);
        ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(ms.begin(), ms.end());
    std::printf("%-12s %7.2f ms a step at best, %7.2f in the middle   %016" PRIx64 "\n", name, ms[0], ms[ms.size() / 2],
                w.state_hash());
}

int main(int count, char** arguments) {
    const auto workers = static_cast<std::uint32_t>(count > 1 ? std::atoi(arguments[1]) : 2);
    measure("one thread", [](world& w) { w.step(1.0f / 60); });
    physics::thread_pool pool(workers);
    measure("thread_pool", [&](world& w) { w.step(1.0f / 60, pool); });
    omp_set_num_threads(static_cast<int>(workers));
    openmp by_openmp;
    measure("OpenMP", [&](world& w) { w.step(1.0f / 60, by_openmp); });
    threading_building_blocks by_tbb{tbb::task_arena(static_cast<int>(workers))};
    measure("TBB", [&](world& w) { w.step(1.0f / 60, by_tbb); });
}
