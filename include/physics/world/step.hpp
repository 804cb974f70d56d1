// One step of a world: the page to read first.
#pragma once

#include "physics/world/contacts.hpp"
#include "physics/world/motion.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Broadphase: pairs of shapes whose boxes overlap, of two bodies of which one at least can be pushed: the filters that
/// shapes were inserted with say so.
template <class Plan>
const buffer<proxy_pair>& find_pairs(state<Plan>& s) {
    const auto all = [](std::uint32_t, std::uint32_t) { return true; };
    if constexpr (requires { s.broadphase.pairs(all, s.scratch); }) return s.broadphase.pairs(all, s.scratch);
    else return s.broadphase.pairs(all);
}

/// Makes ready what a step works with.
template <class Plan>
void start_step(state<Plan>& s, const crew& hands) {
    s.scratch.reset();
    s.batch_scratch.prepare(hands.workers());
    s.manifolds.prepare(hands.workers());
    s.found_by.prepare(hands.workers());
    s.memory_changes.by.prepare(hands.workers());
}

/// How a step went; if not well, the world is as it was.
enum class step_result { done, bad_mixture, out_of_range, bad_executor };

inline void report(step_result result) {
    if (result == step_result::out_of_range)
        refuse("step", "a velocity", "not finite", "a force, a speed or a mass is beyond the scalar's range");
    if (result == step_result::bad_executor)
        refuse("step", "executor", "left parts out, or did parts twice",
               "it must have a worker at least, and call the work once with every part, as a worker below workers()");
    if (result == step_result::bad_mixture)
        refuse("step", "a coefficient of two surfaces", "out of range",
               "the mixing rule must give friction and rolling_resistance that are finite and at least 0, "
               "and a restitution of 0 to 1");
}

/// What a step consists of, for whoever measures it.
enum class step_stage { find_pairs, find_contacts, make_batches, solve, place_shapes, finish };

/// Told of each stage as it ends; this one is told in vain.
struct unwatched {
    void operator()(step_stage) const {}
};

/// Advances a world by h seconds. Each stage reads and writes plain arrays; only this function knows their
/// order. Refused if surfaces do not mix, or if a velocity or a position would leave the range of numbers.
/// Not inlined, so that no arithmetic moves out of the caller's float_control_scope.
template <class Plan, class Watch = unwatched>
PHYSICS_HPP_NOINLINE step_result step(state<Plan>& s, typename Plan::scalar h, crew hands, Watch done = {}) {
    if (hands.workers() == 0) return step_result::bad_executor;
    start_step(s, hands);
    // Settings -> what all surfaces make of each other, where no shape has a material of its own.
    if (!mix_common_surface(s)) return step_result::bad_mixture;
    watch_fast_bodies(s, h);            // velocities        -> boxes of bodies that look ahead
    number_movers(s);                   // bodies            -> which of them move
    const auto& pairs = find_pairs(s);  // boxes             -> pairs, in order
    done(step_stage::find_pairs);
    // Pairs, poses, last step's contacts -> contacts with feature ids and warm impulses.
    const search_result found = find_contacts(s, pairs, s.contacts, s.last_step, h, hands);
    if (!found.mixed) return step_result::bad_mixture;
    if constexpr (Plan::sleeps)
        // Blows -> contacts of the islands that they wake.
        if (disturb_sleepers(s, found.disturbs, h) && !find_contacts_of_woken(s, h, hands))
            return step_result::bad_mixture;
    done(step_stage::find_contacts);
    motion<Plan> moving(s, h, hands);  // contacts          -> islands, in batches
    done(step_stage::make_batches);
    const bool solved = moving.solve(hands);  // bodies, contacts  -> velocities, poses
    done(step_stage::solve);
    if (!hands.is_sound()) return step_result::bad_executor;
    if (!solved) return step_result::out_of_range;
    sweep_fast_bodies(s, moving.moved(), h);  // poses             -> poses short of what stops bodies
    // Poses -> boxes of what has moved.
    if (!moving.place_shapes(hands)) return hands.is_sound() ? step_result::out_of_range : step_result::bad_executor;
    done(step_stage::place_shapes);
    moving.finish();  // results           -> bodies and contacts
    done(step_stage::finish);
    return step_result::done;
}

/// Sets the mark that a step is under way, as long as the scope lives.
class mark_of_step {
public:
    explicit mark_of_step(step_mark& mark) : mark_(mark) { mark_.on = true; }
    mark_of_step(const mark_of_step&) = delete;
    mark_of_step& operator=(const mark_of_step&) = delete;
    ~mark_of_step() { mark_.on = false; }

private:
    step_mark& mark_;
};

template <class Plan>
step_result marked_step(state<Plan>& s, typename Plan::scalar h, const crew& hands) {
    const mark_of_step mark(s.in_step);
    return step(s, h, hands);
}
template <class Plan>
void advance(state<Plan>& s, typename Plan::scalar h, const crew& hands) {
    if (!check_positive("step", "dt", h) || !check_not_in_step(s, "step")) return;
    const float_control_scope control;
    report(marked_step(s, h, hands));
}

}  // namespace detail

PHYSICS_HPP_END
