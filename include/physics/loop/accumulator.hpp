// From the time of a frame to fixed steps: the accumulator.
#pragma once

#include "physics/world/world.hpp"

PHYSICS_HPP_BEGIN

/// Numbers of an accumulator, in seconds.
template <class S>
struct accumulator_settings {
    /// Length of one step.
    S step = S(1.0 / 60);
    /// Time that one call may consume at most; what a longer frame brings beyond it is dropped and reported.
    S longest_frame = S(0.25);
};

/// What one call of accumulator::advance did.
template <class S>
struct advance_report {
    /// Fixed steps taken.
    int steps = 0;
    /// Time that was dropped because the frame was too long (s); 0 in a healthy game.
    S dropped{};
};

/// Does nothing: the default of the hooks around a step.
struct no_hook {
    template <class World>
    void operator()(World&) const {}
};

/// Advances a world in fixed steps by whatever time has really passed, so that the motion does not depend
/// on the frame rate. Time that does not fill a step is carried over; interpolated() shows the world in
/// between. It remembers the poses before the last step: 16 to 32 bytes a body.
/// Source: Fiedler, Fix Your Timestep! (2004).
template <class World>
class accumulator {
public:
    using scalar = typename World::scalar;
    using transform = typename World::transform;
    using settings_type = accumulator_settings<scalar>;

    /// Refuses a step that is not positive and a longest frame that is shorter than a step.
    explicit accumulator(const settings_type& settings = {}) {
        if (!detail::check_positive("accumulator", "step", settings.step) ||
            !detail::check_finite("accumulator", "longest_frame", settings.longest_frame))
            return;
        if (settings.longest_frame < settings.step) {
            detail::refuse("accumulator", "longest_frame", static_cast<double>(settings.longest_frame), "it must not be below the step");
            return;
        }
        settings_ = settings;
    }

    /// Consumes `elapsed` seconds (at least 0) of real time: calls before(world), world.step and
    /// after(world) for every whole step, and keeps the rest for the next call.
    template <class Before = no_hook, class After = no_hook>
    advance_report<scalar> advance(World& world, scalar elapsed, Before&& before = {}, After&& after = {}) {
        if (!detail::check_not_negative("advance", "elapsed", elapsed)) return {};
        advance_report<scalar> report;
        if (elapsed > settings_.longest_frame) {
            report.dropped = elapsed - settings_.longest_frame;
            elapsed = settings_.longest_frame;
        }
        rest_ += elapsed;
        while (!(rest_ < settings_.step)) {
            before(world);
            remember(world);
            world.step(settings_.step);
            after(world);
            rest_ -= settings_.step;
            ++report.steps;
        }
        return report;
    }

    /// How far real time is ahead of the last step, as a share of a step: 0 up to 1.
    [[nodiscard]] scalar factor() const { return rest_ / settings_.step; }
    /// Real time that waits for the next step (s).
    [[nodiscard]] scalar rest() const { return rest_; }
    [[nodiscard]] const settings_type& settings() const { return settings_; }

    /// The pose to draw: between the poses before and after the last step, by factor(). Bodies that are newer
    /// than the last step stand where they are. Turns by the shorter way, at nearly constant speed.
    [[nodiscard]] transform interpolated(const World& world, body_id id) const {
        const transform now = world.pose(id);
        if (!(id.index < before_.size()) || !(before_[id.index].id == id)) return now;
        const transform& then = before_[id.index].pose;
        return {then.position + (now.position - then.position) * factor(), between(then.rotation, now.rotation, factor())};
    }

private:
    using S = scalar;
    struct memory {
        body_id id;
        transform pose;
    };

    void remember(const World& world) {
        before_.clear();
        for (const body_id id : world.bodies()) {
            before_.resize(id.index + 1);
            before_[id.index] = {id, world.pose(id)};
        }
    }
    static rotation<S, 2> between(const rotation<S, 2>& a, const rotation<S, 2>& b, S t) {
        return normalized(rotation<S, 2>{a.cosine + (b.cosine - a.cosine) * t, a.sine + (b.sine - a.sine) * t});
    }
    static rotation<S, 3> between(const rotation<S, 3>& a, const rotation<S, 3>& b, S t) {
        const bool opposite = dot(a.imaginary(), b.imaginary()) + a.w * b.w < S(0);
        const rotation<S, 3> c = opposite ? rotation<S, 3>{-b.x, -b.y, -b.z, -b.w} : b;
        return normalized(rotation<S, 3>{a.x + (c.x - a.x) * t, a.y + (c.y - a.y) * t, a.z + (c.z - a.z) * t, a.w + (c.w - a.w) * t});
    }

    settings_type settings_;
    scalar rest_{};
    buffer<memory> before_;
};

PHYSICS_HPP_END
