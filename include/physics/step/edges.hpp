// What holds bodies together in a step.
#pragma once

#include "physics/step/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Contacts -> edges, in the order of the contacts: what islands, batches and colours are made of.
template <class Plan>
void list_edges(state<Plan>& s, task_runner& tasks) {
    constexpr std::uint32_t share = 1024;
    const std::uint32_t count = s.step.new_contacts.size();
    s.step.edges.clear();
    s.step.edges.extend(count);
    tasks.parallel_for(count, share, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
        // Copies, as what is written may be anything to the compiler.
        const auto* const from = s.step.new_contacts.begin();
        edge* const to = s.step.edges.begin();
        for (std::uint32_t n = first; n < end; ++n) to[n] = from[n].bodies;
    });
}

}  // namespace detail

PHYSICS_HPP_END
