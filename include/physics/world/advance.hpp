// Steps as a world asks for them: what is refused, and what is said then.
#pragma once

#include "physics/step/step.hpp"
#include "physics/world/check.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

inline void report(step_result result) {
    if (result == step_result::out_of_range)
        refuse("step", "a velocity, a position or an impulse", "beyond the scalar's range",
               "use smaller forces, speeds and masses, or other units");
    if (result == step_result::bad_executor)
        refuse("step", "executor", "left parts out, or did parts twice",
               "it must have a worker at least, and call the work once with every part, as a worker below workers()");
    if (result == step_result::bad_mixing_rule)
        refuse("step", "a coefficient of two surfaces", "out of range",
               "the mixing rule must give friction, restitution and rolling_resistance that are finite and at least 0");
}

/// Sets the mark that a step is under way, as long as the scope lives.
class step_scope {
public:
    explicit step_scope(step_flag& mark) : mark_(mark) { mark_.on = true; }
    step_scope(const step_scope&) = delete;
    step_scope& operator=(const step_scope&) = delete;
    ~step_scope() { mark_.on = false; }

private:
    step_flag& mark_;
};

template <class Plan>
step_result step_in_scope(world_data<Plan>& s, typename Plan::scalar h, const task_runner& tasks) {
    const step_scope mark(s.step.in_step);
    return step<Plan>(s, s.step, h, tasks);
}
template <class Plan>
void advance(world_data<Plan>& s, typename Plan::scalar h, const task_runner& tasks) {
    if (!check_positive("step", "dt", h) || !check_not_in_step(s, "step")) return;
    const float_control_scope control;
    report(step_in_scope(s, h, tasks));
}

}  // namespace detail

PHYSICS_HPP_END
