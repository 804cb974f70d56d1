// What only the inside of the library tells, apart from what only uses it.
#pragma once

#include <physics.hpp>

namespace bench {

/// Bytes of a contact that last from step to step: those of a snapshot of the world, less those of its snapshot without
/// contacts and what is remembered of pairs, for each contact that it holds. 0 where it holds none.
template <class Plan>
double bytes_a_contact(const physics::detail::state<Plan>& s) {
    std::uint32_t count = s.contacts.size();
    physics::detail::raw_snapshot<Plan> snapshot;
    snapshot.save(s);
    const std::size_t all = snapshot.size();
    physics::detail::state<Plan> without = s;
    without.contacts.clear();
    without.memories.clear();
    if constexpr (Plan::sleeps) {
        count += s.sleep.contacts.size();
        without.sleep.contacts.clear();
    }
    snapshot.save(without);
    return count > 0 ? static_cast<double>(all - snapshot.size()) / count : 0;
}
template <class Recipe>
double bytes_a_contact(const physics::world<Recipe>& w) {
    return bytes_a_contact(physics::detail::world_access::state_of(w));
}

}  // namespace bench
