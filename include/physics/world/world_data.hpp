// What a world is: its state, and what its steps work with.
#pragma once

#include "physics/step/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The state is all that lasts; copies begin without the rest.
template <class Plan>
struct world_data : state<Plan> {
    step_scratch<step_data<Plan>> step;
};

/// Takes the memory for each_contact. O(bodies + contacts) after a step, then nothing.
template <class Plan>
PHYSICS_HPP_NOINLINE void index_contacts(const world_data<Plan>& s) {
    const buffer<typename Plan::contact>* asleep = nullptr;
    if constexpr (Plan::sleeps) asleep = &s.sleep.contacts;
    s.step.contacts_of.update(s.bodies.slots(), s.contacts, asleep);
}
/// Calls f(list, i) for the contacts of a body: list[i] is one of those that can be pushed, or of those of sleepers.
template <class World, class F>
void each_contact(World& s, std::uint32_t body, F&& f) {
    index_contacts(s);
    s.step.contacts_of.each(body, [&](std::uint32_t n) {
        const auto tell = [&](auto& list, std::uint32_t at) {
            if (!s.removed.in(list[at])) f(list, at);
        };
        if (n < s.contacts.size()) tell(s.contacts, n);
        else if constexpr (requires { s.sleep.contacts; }) tell(s.sleep.contacts, n - s.contacts.size());
    });
}

/// The inside of a world, for what stands beside it.
struct world_access {
    template <class World>
    static auto& data_of(World& w) {
        return w.data_;
    }
    template <class World>
    static auto& state_of(World& w) {
        return state_in(w.data_);
    }

private:
    template <class Plan>
    static state<Plan>& state_in(world_data<Plan>& data) {
        return data;
    }
    template <class Plan>
    static const state<Plan>& state_in(const world_data<Plan>& data) {
        return data;
    }
};

}  // namespace detail

PHYSICS_HPP_END
