// Bodies as they move through a step: copies in tight arrays, which become the world's when the step has succeeded.
#pragma once

#include "physics/dynamics/batches.hpp"
#include "physics/world/edit.hpp"
#include "physics/world/overflow.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The number of each body among those that move.
template <class Plan>
void find_numbers(state<Plan>& s) {
    s.mover_of.clear();
    s.mover_of.resize(s.bodies.slots(), s.movers.size());
    for (std::uint32_t k = 0; k < s.movers.size(); ++k) s.mover_of[s.movers[k]] = k;
}
/// Finds which bodies move, where that has changed.
template <class Plan>
void number_movers(state<Plan>& s) {
    if (!s.movers_changed) return;
    s.movers.clear();
    s.bodies.each([&](std::uint32_t i, const auto& b) {
        if (b.type != body_type::static_body && !s.is_asleep(i)) s.movers.push(i);
    });
    find_numbers(s);
}

/// Whether an integrator advances poses in lanes: not one that derives from such, and may have poses of its own.
template <class Integrator, bool Turns>
concept advances_in_lanes = requires {
    requires std::same_as<typename Integrator::owner_of_lanes, Integrator>;
    requires Integrator::template lanes<Turns>::serves;
};
template <class Integrator, bool Turns>
struct pose_lanes_of {
    struct type {};
};
template <class Integrator, bool Turns>
    requires advances_in_lanes<Integrator, Turns>
struct pose_lanes_of<Integrator, Turns> {
    using type = typename Integrator::template lanes<Turns>;
};

/// How the solver moves a batch: it asks for velocities and poses to advance, once or in substeps.
template <class Plan>
class batch_motion {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;
    static constexpr bool turns = Plan::turns;
    using integrator = typename Plan::integrator;
    static constexpr bool in_lanes = advances_in_lanes<integrator, turns>;
    using lanes = typename pose_lanes_of<integrator, turns>::type;

public:
    /// Copies the bodies of a part into their slots.
    batch_motion(const state<Plan>& s, const batches& parts, const batch& part, moved_bodies<S, D, turns> slots, S h,
                 arena& scratch, crew& hands)
        : state_(s),
          members_(parts.body_at + part.bodies),
          bodies_(slots.solved + part.bodies),
          moving_(slots.moved + part.bodies),
          count_(part.nobody - part.bodies),
          step_(h),
          hands_(hands),
          tally_(scratch.template take<std::uint32_t>(hands.workers())) {
        free_count_ = count_of([&](std::uint32_t k) { return gather(k); });
        if constexpr (is_fixed<S>)
            starts_well_ = count_of([&](std::uint32_t k) {
                               return !stays_in_range(s.settings.gravity, member(k), bodies_[k], h,
                                                      parts_of_step(s.settings.solver));
                           }) == 0;
        for (std::uint32_t k = count_; k < part.nobody - part.bodies + 2; ++k)
            new (bodies_ + k) solver_body<S, D, turns>{};
        if (free_count_ > 0) find_free(parts, part, scratch);
        if constexpr (in_lanes) lanes_ = new (scratch.template take<lanes>(1)) lanes(bodies(), moving_, scratch);
    }

    /// What the solver sees of the bodies; the last two are nobody.
    [[nodiscard]] solver_bodies<S, D, turns> bodies() const { return {bodies_, count_ + 2}; }

    /// By gravity and forces (m/s^2); nothing drives what is not dynamic.
    [[nodiscard]] const vec<S, D>& acceleration(std::uint32_t k) const { return moving_[k].acceleration; }

    void advance_velocities(S h) {
        if (free_count_ > 0) thrust(step_ / h);
        each([&](std::uint32_t k) { advance_velocity(k, h); });
        if (free_count_ > 0) thrust(S(0));
    }
    /// The same; what bodies have come to beyond their velocities in `begun` they get again, and those become the ones
    /// before that.
    void advance_velocities(S h, twist_of<S, D, turns>* begun) {
        if (free_count_ > 0) thrust(step_ / h);
        each([&](std::uint32_t k) {
            auto& v = bodies_[k].velocity;
            const auto got = v - begun[k];
            advance_velocity(k, h);
            begun[k] = v;
            v = v + got;
        });
        if (free_count_ > 0) thrust(S(0));
    }
    void advance_poses(S h) { advance_poses(h, nullptr); }
    /// The same; what velocities change by as bodies turn, they change in `begun` too.
    void advance_poses(S h, twist_of<S, D, turns>* begun) {
        if constexpr (in_lanes) {
            lanes_->advance(h, begun, hands_);
            return;
        }
        each([&](std::uint32_t k) {
            turning_velocity<S, D, turns>& v = bodies_[k].velocity;
            const auto before = v;
            integrator::advance_pose(moving_[k], v, bodies_[k].way, h);
            if constexpr (D == 3 && turns)
                if (begun != nullptr && !(v == before)) begun[k] = begun[k] + (v - before);
        });
    }

    /// Ends the step. False if something that moved is where numbers do not reach.
    [[nodiscard]] bool finish() {
        const std::uint32_t lost = count_of([&](std::uint32_t k) {
            if constexpr (in_lanes) lanes_->finish(k, k + 1);
            const auto& way = bodies_[k].way;
            moving_[k].center += way.linear;
            if constexpr (D == 2 && turns)
                if (way.angular != S(0)) moving_[k].rotation = turned(moving_[k].rotation, way.angular);
            return !is_where_numbers_reach(moving_[k], bodies_[k].velocity);
        });
        return lost == 0 && starts_well_;
    }

private:
    /// Calls f(k) for all bodies.
    template <class F>
    void each(F&& f) {
        hands_.each_range(count_, enough, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
            for (std::uint32_t k = first; k < end; ++k) f(k);
        });
    }
    /// For how many of them f(k) is true.
    template <class F>
    std::uint32_t count_of(F&& f) {
        for (std::uint32_t k = 0; k < hands_.workers(); ++k) tally_[k] = 0;
        hands_.each_range(count_, enough, [&](std::uint32_t first, std::uint32_t end, std::uint32_t worker) {
            std::uint32_t count = 0;
            for (std::uint32_t k = first; k < end; ++k) count += f(k);
            tally_[worker] += count;
        });
        for (std::uint32_t k = 1; k < hands_.workers(); ++k) tally_[0] += tally_[k];
        return tally_[0];
    }
    void advance_velocity(std::uint32_t k, S h) {
        if (!(bodies_[k].inverse_mass > inverse_of<S>(0))) return;
        integrator::advance_velocity(bodies_[k].velocity, moving_[k], h);
        // -0 becomes 0, which no impulse of 0 changes: so the bits are the same whether solvers give it or not.
        bodies_[k].velocity.linear += vec<S, D>{};
        if constexpr (turns) bodies_[k].velocity.angular += angular<S, D>{};
    }
    [[nodiscard]] const typename Plan::body& member(std::uint32_t k) const {
        return state_.bodies[state_.movers[members_[k]]];
    }
    /// Says whether a force acts on it.
    bool gather(std::uint32_t k) {
        const auto& b = member(k);
        auto& seen = *new (bodies_ + k) solver_body<S, D, turns>{b.velocity_ahead(step_), {}, b.inverse_mass, {}};
        auto& m = *new (moving_ + k) moving_body<S, D, turns>{};
        m.center = b.center;
        if constexpr (turns) {
            seen.inverse_inertia = in_world(b.inverse_inertia, b.rotation);
            m.rotation = b.rotation;
        }
        if (!b.is_dynamic()) return false;
        m.acceleration = state_.settings.gravity * b.gravity_scale;
        m.linear_damping = b.linear_damping;
        if constexpr (turns) {
            m.angular_damping = b.angular_damping;
            if (b.is_gyroscopic) m.top = &b;
        }
        if (!b.is_pushed()) return false;
        add_force(k, S(1));
        return true;
    }
    /// Lets `share` of the force on a body act.
    void add_force(std::uint32_t k, S share) {
        const auto& b = member(k);
        for (int i = 0; i < D; ++i) moving_[k].acceleration[i] += mul<S>(b.inverse_mass, b.force[i] * share);
        if constexpr (turns) moving_[k].angular_acceleration += times(bodies_[k].inverse_inertia, b.torque * share);
    }
    /// Bodies that are pushed and touch nothing.
    void find_free(const batches& parts, const batch& part, arena& scratch) {
        auto* touches = scratch.template take<bool>(count_ + 1);
        for (std::uint32_t k = 0; k <= count_; ++k) touches[k] = false;
        for (std::uint32_t n = part.contacts; n < part.end; ++n) {
            const auto& c = state_.found[parts.order[n]];
            touches[c.body_a] = touches[c.body_b] = true;
        }
        free_ = scratch.template take<std::uint32_t>(free_count_);
        free_count_ = 0;
        for (std::uint32_t k = 0; k < count_; ++k)
            if (!touches[k] && member(k).is_pushed()) free_[free_count_++] = k;
    }
    /// Forces on them act at once, as the solver's first part of the step begins: spread over the parts, springs that
    /// users make of forces would gain energy.
    void thrust(S share) {
        for (std::uint32_t n = 0; n < free_count_; ++n) {
            const std::uint32_t k = free_[n];
            moving_[k].acceleration = state_.settings.gravity * member(k).gravity_scale;
            if constexpr (turns) moving_[k].angular_acceleration = {};
            if (share > S(0)) add_force(k, share);
        }
        if (!(share > S(0))) free_count_ = 0;
    }

    const state<Plan>& state_;
    const std::uint32_t* members_;
    solver_body<S, D, turns>* bodies_;
    moving_body<S, D, turns>* moving_;
    std::uint32_t count_;
    S step_;
    crew& hands_;
    std::uint32_t* tally_;  ///< What each worker has counted.
    std::uint32_t* free_ = nullptr;
    std::uint32_t free_count_ = 0;
    bool starts_well_ = true;
    lanes* lanes_ = nullptr;
    static constexpr std::uint32_t enough = 128;  ///< So many bodies are worth handing to somebody else.
};

/// How a step moves the world, batch by batch. Nothing of the world changes before place_shapes.
template <class Plan>
class motion {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;
    static constexpr bool turns = Plan::turns;

public:
    motion(state<Plan>& s, S h, crew& hands) : state_(s), parts_(parts_of(s, hands)), step_(h) {
        moved_ = {s.scratch.template take<solver_body<S, D, turns>>(parts_.slots),
                  s.scratch.template take<moving_body<S, D, turns>>(parts_.slots), parts_.slot_of};
    }

    /// Solves the contacts: giants one after the other, with all hands, then the other batches side by side. False if
    /// something has left the range of numbers.
    bool solve(crew& hands) {
        bool* good = state_.scratch.template take<bool>(parts_.count);
        for (std::uint32_t k = 0; k < parts_.count; ++k) good[k] = false;
        const auto is_giant = [&](std::uint32_t k) {
            return !hands.is_alone() && parts_.first[k].weight() > giant * batch_maker::enough;
        };
        crew alone;
        for (std::uint32_t k = 0; k < parts_.count; ++k)
            if (is_giant(k)) good[k] = solve(parts_.first[k], state_.batch_scratch[0], hands);
        hands.each(parts_.count, [&](std::uint32_t k, std::uint32_t worker) {
            if (!is_giant(k)) good[k] = solve(parts_.first[k], state_.batch_scratch[worker], alone);
        });
        for (std::uint32_t k = 0; k < parts_.count; ++k)
            if (!good[k]) return false;
        return true;
    }
    /// Where bodies have come.
    [[nodiscard]] moved_bodies<S, D, turns> moved() const { return moved_; }

    /// Puts shapes where their bodies are now, and tells the broadphase, and where they are heading; bodies with a
    /// target are there, to the bit. False, and all shapes where they were, if a box is beyond the scalar's range, or
    /// the executor fails.
    bool place_shapes(crew& hands) {
        const std::uint32_t count = state_.movers.size();
        bool fit = true;
        if (hands.is_alone()) {
            for (std::uint32_t k = 0; k < count && fit; ++k)
                locate_shapes(k, [&](std::uint32_t n, const aabb<S, D>& box) {
                    if (fit = fit && is_box(box); fit) move_box(k, n, box);
                });
        } else {
            // Boxes that are left move one by one: what the broadphase makes of them may depend on their order.
            enum : std::uint8_t { keeps = 0, leaves = 1, lost = 2 };
            auto* fates = state_.scratch.template take<std::uint8_t>(count);
            hands.each_range(count, 128, [&](std::uint32_t first, std::uint32_t end, std::uint32_t) {
                for (std::uint32_t k = first; k < end; ++k) {
                    fates[k] = keeps;
                    locate_shapes(k, [&](std::uint32_t n, const aabb<S, D>& box) {
                        if constexpr (requires { state_.broadphase.holds(n, box); })
                            if (state_.broadphase.holds(n, box)) return;
                        fates[k] = !is_box(box) || fates[k] == lost ? lost : leaves;
                    });
                }
            });
            fit = hands.is_sound();
            for (std::uint32_t k = 0; k < count; ++k) fit = fit && fates[k] != lost;
            for (std::uint32_t k = 0; k < count && fit; ++k)
                if (fates[k] == leaves)
                    each_shape(state_, state_.movers[k],
                               [&](std::uint32_t n, const auto& shape) { move_box(k, n, needed_box(state_, shape)); });
        }
        if (!fit)
            for (const std::uint32_t i : state_.movers) refresh_boxes(state_, i);
        else update_broadphase(state_);
        return fit;
    }

    /// Stores what the step found: poses, velocities, contacts with their impulses. Forces act for one step, and so do
    /// targets.
    void finish() {
        if (std::exchange(state_.movers_changed, false))
            state_.bodies.each([&](std::uint32_t i, const auto& b) {
                if (!state_.is_asleep(i)) state_.contact_starts[i] = {b.center, b.rotation};
            });
        for (std::uint32_t k = 0; k < state_.movers.size(); ++k) {
            const std::uint32_t i = state_.movers[k];
            auto& b = state_.bodies[i];
            state_.contact_starts[i] = {b.center, b.rotation};
            b.center = moved_[k].center;
            if constexpr (turns) b.rotation = moved_[k].rotation;
            b.velocity = moved_.velocity(k);
            b.force = {};
            b.torque = {};
            b.at_target = b.has_target;
            if (!b.has_target) continue;
            b.set_pose(b.target);
            b.has_target = false;
        }
        state_.contacts.swap(state_.found);
        state_.surfaces = state_.found_surfaces;
        if constexpr (Plan::remembers) state_.memory_changes.finish(state_.memories);
        ++state_.steps;
        state_.last_step = step_;
        if constexpr (Plan::sleeps) {
            wake_disturbed(state_);
            for (const std::uint32_t i : state_.movers) rouse_ahead(i);
            falling_asleep<Plan>(state_, step_);
        }
    }

private:
    /// Puts the shapes of a body where it is now, and calls f(shape's number, box) for each.
    template <class F>
    void locate_shapes(std::uint32_t k, F&& f) {
        const std::uint32_t i = state_.movers[k];
        const auto& b = state_.bodies[i];
        const transform<S, D> pose = pose_of(k);
        const vec<S, D> center = b.has_target ? pose * b.mass.center : moved_[k].center;
        each_shape(state_, i, [&](std::uint32_t n, auto& shape) {
            locate(shape, pose, center);
            f(n, needed_box(state_, shape));
        });
    }
    void move_box(std::uint32_t k, std::uint32_t n, const aabb<S, D>& box) {
        state_.broadphase.move(n, box, moved_.velocity(k).linear * step_);
    }
    /// Wakes what a kinematic body is going to run into.
    void rouse_ahead(std::uint32_t i) {
        const auto& b = state_.bodies[i];
        if (b.is_dynamic() || b.at_target || b.velocity == twist_of<S, D, turns>{}) return;
        rotation<S, D> turn = b.rotation;
        if constexpr (turns) turn = turned(turn, b.velocity.angular * step_);
        rouse_near(state_, i, {b.center + b.velocity.linear * step_ - turn * b.mass.center, turn});
    }
    static batches parts_of(state<Plan>& s, crew& hands) {
        // On one thread, what goes into the second cache is not worth taking apart.
        const std::uint32_t in_one = hands.is_alone() ? (D == 2 ? 8 : 2) * batch_maker::enough : batch_maker::enough;

        const std::uint32_t count = s.movers.size();
        bool* is_pushed = s.scratch.template take<bool>(count + 1);
        for (std::uint32_t k = 0; k < count; ++k) is_pushed[k] = s.bodies[s.movers[k]].inverse_mass > inverse_of<S>(0);
        is_pushed[count] = false;
        return batch_maker(s.found, is_pushed, count, s.scratch, in_one, &hands).result();
    }
    bool solve(const batch& part, arena& scratch, crew& hands) {
        scratch.reset();
        for (std::uint32_t k = 1; k < hands.workers(); ++k) state_.batch_scratch[k].reset();
        batch_motion<Plan> moving(state_, parts_, part, moved_, step_, scratch, hands);
        const contact_list<S, D, typename Plan::features> contacts(state_.found.begin(), parts_.order + part.contacts,
                                                                   part.end - part.contacts, state_.found_surfaces);
        const auto& with = state_.settings.solver;
        if constexpr (requires { Plan::solver::solve(moving.bodies(), contacts, with, step_, scratch, moving, hands); })
            Plan::solver::solve(moving.bodies(), contacts, with, step_, scratch, moving, hands);
        else Plan::solver::solve(moving.bodies(), contacts, with, step_, scratch, moving);
        return moving.finish();
    }
    [[nodiscard]] transform<S, D> pose_of(std::uint32_t k) const {
        const auto& b = state_.bodies[state_.movers[k]];
        if (b.has_target) return b.target;
        const rotation<S, D>& turn = rotation_after(moved_[k], b);
        return {moved_[k].center - turn * b.mass.center, turn};
    }

    /// An island that is so many times as large as a batch is wide enough for several workers.
    static constexpr std::uint32_t giant = 4;

    state<Plan>& state_;
    batches parts_;
    moved_bodies<S, D, turns> moved_;
    S step_;
};

}  // namespace detail

PHYSICS_HPP_END
