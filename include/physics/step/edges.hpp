// What holds bodies together in a step, and the islands that follow.
#pragma once

#include "physics/dynamics/contact.hpp"
#include "physics/dynamics/graph.hpp"
#include "physics/step/awake.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Contacts -> which bodies they hold together, in their order. O(contacts).
template <class S, int D, class Features>
void list_edges(const buffer<contact<S, D, Features>>& contacts, buffer<edge>& edges, task_runner& tasks) {
    constexpr std::uint32_t share = 1024;
    edges.clear();
    edges.extend(contacts.size());
    tasks.parallel_for(contacts.size(), share, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
        // Copies, as what is written may be anything to the compiler.
        const auto* const from = contacts.begin();
        edge* const to = edges.begin();
        for (std::uint32_t n = first; n < end; ++n) to[n] = from[n].bodies;
    });
}

/// Edges, and which bodies move -> islands, in batches. O(bodies + edges).
template <class S, int D, bool Rotates>
batches build_graph(const buffer<edge>& edges, const pool<body<S, D, Rotates>>& bodies, const awake_list& awake,
                    arena& scratch, task_runner& tasks) {
    // On one thread, what goes into the second cache is not worth taking apart.
    const std::uint32_t batch_limit = graph_builder::target_weight * (tasks.is_serial() ? (D == 2 ? 8 : 2) : 1);
    bool* is_pushed = scratch.template allocate<bool>(awake.size() + 1);
    for (std::uint32_t k = 0; k < awake.size(); ++k) is_pushed[k] = bodies[awake[k]].inverse_mass > inverse_of<S>(0);
    is_pushed[awake.size()] = false;
    return graph_builder(edges, awake.index_of.begin(), is_pushed, awake.size(), scratch, batch_limit, &tasks).result();
}

}  // namespace detail

PHYSICS_HPP_END
