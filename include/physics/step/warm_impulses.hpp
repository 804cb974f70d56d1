// What contacts hand on from step to step where these differ in length.
#pragma once

#include "physics/step/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A step hands on what its contacts gave, as the load that the next one begins with. Where steps differ, what a single
/// short one says of loads is noise; so what is handed on is what contacts gave within a usual step's time, to which
/// the last step adds its part. How long steps usually take follows their length by an eighth at a time. Steps of one
/// length hand on their impulses as they are, and cost nothing.
template <class Plan>
class warm_impulses {
    using S = typename Plan::scalar;

public:
    warm_impulses(state<Plan>& s, S h) : state_(s), step_(h) {}

    /// How long steps usually take once this one counts among them (s).
    [[nodiscard]] S next_usual_step() const {
        const S last = state_.step_lengths.usual;
        // A world's first steps may be shorter than those to come.
        const S longest = state_.steps < 8 ? step_ : last + last * S(0.125);
        return max(min(step_, longest), last - step_ * S(0.125));
    }
    /// Remembers with what impulses this step begins.
    void before_solve() {
        if (!is_shorter()) return;
        constexpr std::uint32_t capacity = manifold<S, Plan::dimension>::capacity;
        begun_with_ = state_.step.scratch.template allocate<S>(state_.step.new_contacts.size() * capacity);
        S* to = begun_with_;
        for (const auto& c : state_.step.new_contacts)
            for (int k = 0; k < c.count; ++k) *to++ = c.persisted(k) ? c.points[k].substep_impulse : S(0);
    }
    /// Turns this step's impulses into those of a usual one.
    void after_solve() {
        const S last = state_.step_lengths.usual, usual = next_usual_step();
        if (usual == step_ && !is_shorter()) return;
        const S ratio = impulse_ratio(last, step_), part = usual / max(step_, last);
        const S* from = begun_with_;
        for (auto& c : state_.step.new_contacts)
            for (int k = 0; k < c.count; ++k) {
                S& impulse = c.points[k].substep_impulse;
                if (is_shorter()) impulse += *from / ratio - *from, ++from;
                impulse *= part;
            }
    }

private:
    bool is_shorter() const { return step_ < state_.step_lengths.usual; }

    state<Plan>& state_;
    S step_;
    S* begun_with_ = nullptr;
};

}  // namespace detail

PHYSICS_HPP_END
