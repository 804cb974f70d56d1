// The soft step: many small steps, each with one round over the contacts in lanes.
#pragma once

#include "physics/base/stage.hpp"
#include "physics/dynamics/contact_graph.hpp"
#include "physics/dynamics/soft_contact2.hpp"
#include "physics/dynamics/soft_contact3.hpp"
#include "physics/space/check.hpp"

PHYSICS_HPP_BEGIN

/// Numbers of the soft step solver; lengths in metres, speeds in m/s.
template <class S>
struct soft_step_settings {
    /// Parts of a step, each with its own round; more make contacts stiffer and heavy loads safer. At least 1.
    int substeps = 4;
    /// Frequency of the springs that push overlaps apart, as a part of the substeps' rate: work buys stiffness. More
    /// than the default lets tall piles sway.
    S stiffness = S(0.125);
    /// Their damping ratio.
    S damping_ratio = S(10);
    /// The frequency is no higher than this (Hz); 0: no limit.
    S frequency_cap = S(0);
    /// Speed at which overlaps are pushed apart, at most.
    S max_push_speed = S(3);
    /// Points that meet faster than this within a substep do not push as much in the next one as a matter of course.
    S impact_speed = S(0.5);
    /// Approaches slower than this do not bounce.
    S restitution_slop = S(0.5);
};

template <class S>
bool check(const soft_step_settings<S>& with, const char* function) {
    if (with.substeps < 1) return detail::refuse(function, "solver.substeps", with.substeps, "it must be at least 1");
    return detail::check_positive(function, "solver.stiffness", with.stiffness) &&
           detail::check_positive(function, "solver.damping_ratio", with.damping_ratio) &&
           detail::check_not_negative(function, "solver.frequency_cap", with.frequency_cap) &&
           detail::check_not_negative(function, "solver.max_push_speed", with.max_push_speed) &&
           detail::check_not_negative(function, "solver.impact_speed", with.impact_speed) &&
           detail::check_not_negative(function, "solver.restitution_slop", with.restitution_slop);
}

/// Small steps with soft contacts: in each substep velocities advance, impulses of the last one are given at once, a
/// round pushes overlaps apart by damped springs, poses advance, and a round without springs takes back the speed that
/// they gave. Bounces come last. Normals act per manifold, friction on a circular cone per manifold (patch_friction) or
/// per point (point_friction). Error: of order h / substeps; the springs follow the substep, so that more work always
/// means less error. Momentum is kept to rounding, angular momentum but for how far bodies that collide move past
/// each other within the step. Cost: 2 rounds a substep, contacts of one colour in lanes. Source: Macklin et al., Small
/// Steps in Physics Simulation (2019); Catto, Soft constraints (GDC 2011), Solver2D (2024).
template <class Friction>
struct soft_step_with {
    using stage = physics::stage::solver;

    /// Width: how many contacts go in lanes at a time; every width gives the same bits.
    template <class Space, class Features, int Width = detail::native_width<typename Space::scalar>>
        requires(std::same_as<Friction, patch_friction> || std::same_as<Friction, point_friction>)
    class in {
    public:
        using S = typename Space::scalar;
        static constexpr int D = Space::dimension;
        using settings = soft_step_settings<S>;

        /// Advances velocities and poses by h: `motion` offers advance_velocities(h) and advance_poses(h).
        template <class Motion>
        static void solve(solver_bodies<S, D> all, contact_list<S, D> contacts, const settings& with, S h,
                          arena& scratch, Motion&& motion) {
            // Idle lanes push nobody.
            const std::uint32_t nobody = all.count - 1;
            solver_body<S, D>* const bodies = all.first;
            const detail::contact_colours colours = detail::colour(contacts, all, scratch);
            std::uint32_t count = 0;
            for (std::uint32_t k = 0; k < colours.count; ++k) count += blocks_of(colours, k);
            block* blocks = scratch.template take<block>(count);
            std::uint32_t* numbers = scratch.template take<std::uint32_t>(count * width);
            const detail::soft_start<S> start{h, S(1) / S(with.substeps), with.restitution_slop};
            pack_blocks(colours, contacts, bodies, nobody, start, scratch, blocks, numbers);

            const S part = h / S(with.substeps);
            const S frequency = with.stiffness / part;
            const bool capped = with.frequency_cap > S(0) && with.frequency_cap < frequency;
            const detail::soft_round<S> press{
                S(1) / part, detail::softness<S>::of(capped ? with.frequency_cap : frequency, with.damping_ratio, part),
                with.max_push_speed, with.impact_speed, true};
            detail::soft_round<S> relax = press;
            relax.pushes = false;
            for (int i = 0; i < with.substeps; ++i) {
                motion.advance_velocities(part);
                for (std::uint32_t k = 0; k < count; ++k) blocks[k].warm_start(bodies);
                for (std::uint32_t k = 0; k < count; ++k) blocks[k].solve(bodies, press);
                for (std::uint32_t k = 0; k < nobody; ++k) {
                    bodies[k].way.linear += bodies[k].velocity.linear * part;
                    bodies[k].way.angular += bodies[k].velocity.angular * part;
                }
                motion.advance_poses(part);
                for (std::uint32_t k = 0; k < count; ++k) blocks[k].solve(bodies, relax);
            }
            if constexpr (Features::restitution)
                for (std::uint32_t k = 0; k < count; ++k) blocks[k].bounce(bodies);
            for (std::uint32_t k = 0; k < count; ++k)
                for (int lane = 0; lane < width; ++lane)
                    if (const std::uint32_t n = numbers[k * width + static_cast<std::uint32_t>(lane)]; n != none)
                        blocks[k].take(lane, contacts[n]);
        }

    private:
        static constexpr int width = Width;
        static constexpr std::uint32_t none = 0xffffffffu;
        using block = std::conditional_t<D == 2, detail::soft_contact2<S, width, Features>,
                                         detail::soft_contact3<S, width, Features, Friction>>;

        /// Contacts of a block in one group: one where they may push the same body.
        static std::uint32_t share_of(const detail::contact_colours& colours, std::uint32_t group) {
            return colours.last_is_serial && group + 1 == colours.count ? 1 : std::uint32_t{width};
        }
        static std::uint32_t blocks_of(const detail::contact_colours& colours, std::uint32_t group) {
            const std::uint32_t share = share_of(colours, group);
            return (colours.begin[group + 1] - colours.begin[group] + share - 1) / share;
        }
        static void pack_blocks(const detail::contact_colours& colours, const contact_list<S, D>& contacts,
                                const solver_body<S, D>* bodies, std::uint32_t nobody,
                                const detail::soft_start<S>& with, arena& scratch, block* blocks,
                                std::uint32_t* numbers) {
            for (std::uint32_t group = 0; group < colours.count; ++group) {
                const std::uint32_t share = share_of(colours, group);
                for (std::uint32_t at = colours.begin[group]; at < colours.begin[group + 1]; at += share) {
                    block& to = *new (blocks++) block{};
                    for (std::uint32_t lane = 0; lane < std::uint32_t{width}; ++lane) {
                        const bool used = lane < share && at + lane < colours.begin[group + 1];
                        const std::uint32_t n = used ? colours.order[at + lane] : none;
                        *numbers++ = n;
                        const int at_lane = static_cast<int>(lane);
                        if (used) to.put(at_lane, contacts[n], bodies, with, scratch);
                        else to.a[lane] = to.b[lane] = nobody;
                    }
                }
            }
        }
    };
};

/// Small steps with friction per manifold.
struct soft_step : soft_step_with<patch_friction> {};

PHYSICS_HPP_END
