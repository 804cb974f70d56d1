// From the time of a frame to fixed steps: the accumulator.
#pragma once

#include "physics/world/world.hpp"

PHYSICS_HPP_BEGIN

/// Numbers of an accumulator, in seconds.
template <class S>
struct accumulator_settings {
    /// Length of one step.
    S step = S(1.0 / 60);
    /// Time that one call may consume at most, 1 to 65536 steps; what a longer frame brings beyond it is dropped and
    /// reported.
    S longest_frame = S(0.25);
};

/// What one call of accumulator::advance did.
template <class S>
struct advance_report {
    /// Fixed steps taken.
    int steps = 0;
    /// Time that was dropped because the frame was too long or a step was refused (s); 0 in a healthy game.
    S dropped{};
};

namespace detail {
template <class World>
concept world_like = requires {
    typename World::scalar;
    typename World::transform;
};
}  // namespace detail

/// Does nothing: the default of the hooks around a step.
struct no_hook {
    template <class World>
    void operator()(World&) const {}
};

/// Advances a world in fixed steps by whatever time has really passed, so that the motion does not depend
/// on the frame rate. Time that does not fill a step is carried over; interpolated() shows the world in
/// between. It remembers the poses before and after the last step: 40 to 120 bytes a body.
/// Source: Fiedler, Fix Your Timestep! (2004).
template <class World>
class accumulator {
    static constexpr bool of_world = detail::world_like<World>;
    static_assert(
        of_world,
        "physics::accumulator: the argument is not a world; write physics::accumulator<physics::world<mine>>");
    // Any world does after the sentence above, so that it stays the only error.
    using world_type = std::conditional_t<of_world, World, world<recipe<float, 2>>>;

public:
    using scalar = typename world_type::scalar;
    using transform = typename world_type::transform;
    using settings_type = accumulator_settings<scalar>;

    /// Refuses a step that is not positive and a longest frame that is not 1 to 65536 steps.
    explicit accumulator(const settings_type& settings = {}) {
        if (!detail::check_positive("accumulator", "step", settings.step) ||
            !detail::check_finite("accumulator", "longest_frame", settings.longest_frame))
            return;
        if (settings.longest_frame < settings.step || settings.longest_frame / S(65536) > settings.step) {
            detail::refuse("accumulator", "longest_frame", static_cast<double>(settings.longest_frame),
                           "it must be 1 to 65536 steps");
            return;
        }
        settings_ = settings;
    }

    /// Consumes `elapsed` seconds (at least 0) of real time: calls before(world), world.step and
    /// after(world) for every whole step, and keeps the rest for the next call. A step that is refused, or a hook that
    /// throws, ends the call, and the time of the steps that were due is dropped: they are not tried again.
    template <class Before = no_hook, class After = no_hook>
    advance_report<scalar> advance(World& world, scalar elapsed, Before&& before = {}, After&& after = {}) {
        return advance_by(world, elapsed, before, after, [](World& w, scalar dt) { w.step(dt); });
    }
    /// The same, with the work of the steps shared out by an executor.
    template <executor Executor, class Before = no_hook, class After = no_hook>
    advance_report<scalar> advance(World& world, scalar elapsed, Executor& by, Before&& before = {},
                                   After&& after = {}) {
        return advance_by(world, elapsed, before, after, [&by](World& w, scalar dt) { w.step(dt, by); });
    }

    /// How far real time is ahead of the last step, as a share of a step: 0 up to 1.
    [[nodiscard]] scalar factor() const { return rest_ / settings_.step; }
    /// Real time that waits for the next step (s).
    [[nodiscard]] scalar rest() const { return rest_; }
    [[nodiscard]] const settings_type& settings() const { return settings_; }

    /// Forgets the time that waits and the poses that are remembered: for another world, or another scene in it.
    void reset() {
        rest_ = {};
        before_.clear();
    }

    /// The pose to draw: between the poses before and after the last step, by factor(). Bodies that are newer than the
    /// last step, that have been put elsewhere since, or whose world has been brought back to another state, stand
    /// where they are. Turns by the shorter way, at constant speed.
    [[nodiscard]] transform interpolated(const World& world, body_id id) const {
        const transform now = world.pose(id);
        if (!(id.index < before_.size()) || !(before_[id.index].id == id) || !world.contains(id)) return now;
        if (!(before_[id.index].after == now) || world.steps() != steps_) return now;
        const transform& then = before_[id.index].pose;
        const auto turn = rotation_vector(now.rotation * inverse(then.rotation));
        return {then.position + (now.position - then.position) * factor(), turned(then.rotation, turn * factor())};
    }

private:
    using S = scalar;
    struct memory {
        body_id id;
        transform pose, after;
    };

    template <class Before, class After, class Step>
    advance_report<scalar> advance_by(World& world, scalar elapsed, Before& before, After& after, Step&& step) {
        if (!detail::check_not_negative("advance", "elapsed", elapsed)) return {};
        advance_report<scalar> report;
        if (elapsed > settings_.longest_frame) {
            report.dropped = elapsed - settings_.longest_frame;
            elapsed = settings_.longest_frame;
        }
        int due = 0;
        for (rest_ += elapsed; !(rest_ < settings_.step); rest_ -= settings_.step) ++due;
        for (; report.steps < due; ++report.steps) {
            before(world);
            remember(world);
            const std::uint64_t steps = world.steps();
            step(world, settings_.step);
            if (world.steps() == steps) {  // refused, in a build without exceptions
                report.dropped += settings_.step * S(due - report.steps);
                break;
            }
            remember_end(world);
            after(world);
        }
        return report;
    }
    void remember(const World& world) {
        before_.clear();
        for (const body_id id : world.bodies()) {
            before_.resize(id.index + 1);
            before_[id.index] = {id, world.pose(id), {}};
        }
    }
    void remember_end(const World& world) {
        steps_ = world.steps();
        for (memory& m : before_)
            if (m.id && world.contains(m.id)) m.after = world.pose(m.id);
    }

    settings_type settings_;
    scalar rest_{};
    buffer<memory> before_;
    /// How many steps the world had taken then.
    std::uint64_t steps_ = 0;
};

PHYSICS_HPP_END
