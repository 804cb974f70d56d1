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
