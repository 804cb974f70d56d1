// Many rays or casts at once, on one thread or on several.
#pragma once

#include "physics/world/world_code.hpp"

PHYSICS_HPP_BEGIN

/// One of many rays, see world::cast_rays: along a translation from a point (m).
template <class S, int D>
struct ray_query {
    vec<S, D> origin{}, translation{};
    query_filter filter{};
};
/// One of many casts of a shape, see world::cast_shapes: along a translation from a pose (m), without turning.
template <class S, int D>
struct shape_query {
    transform<S, D> pose{};
    vec<S, D> translation{};
    query_filter filter{};
};

namespace detail {

/// Calls cast(query) for each of the queries, which have been checked, and writes what it gives to the hits.
template <class Query, class Hit, class Cast>
void run_batch(const char* function, const Query* queries, std::uint32_t count, Hit* hits, task_runner tasks,
               Cast&& cast) {
    // So few that no worker waits long for the last, and none is dear to hand over.
    constexpr std::uint32_t share = 64;
    tasks.parallel_chunks(count, share, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
        for (std::uint32_t i = first; i < end; ++i) hits[i] = cast(queries[i]);
    });
    if (!tasks.ran_all_tasks())
        refuse(function, "executor", "left parts out, or did parts twice", "it must call each once");
}
/// Calls f(queries, count, hits) if the lists are long enough and check(query) is true of each query.
template <class Queries, class Hits, class Check, class F>
void with_batch(const char* function, const Queries& queries, Hits& hits, Check&& check, F&& f) {
    if (!check_count(function, "queries", queries)) return;
    if (hits.size() < queries.size()) {
        refuse(function, "hits", static_cast<double>(hits.size()), "there must be one for each query");
        return;
    }
    const auto* const first = queries.data();
    const std::uint32_t count = count_of(queries);
    for (std::uint32_t i = 0; i < count; ++i)
        if (!check(first[i])) return;
    f(first, count, hits.data());
}
/// Calls f(tasks) with what runs them by an executor.
template <class Executor, class F>
void with_tasks(const char* function, Executor& by, F&& f) {
    buffer<unsigned char> done;
    per_worker<arena> scratch;
    const task_runner tasks(by, done, scratch);
    if (tasks.workers() == 0) refuse(function, "executor", "without workers", "it must have one at least");
    else f(tasks);
}

}  // namespace detail

PHYSICS_HPP_END
