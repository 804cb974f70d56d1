// The soft step: many small steps, each with one round over the contacts in lanes.
#pragma once

#include "physics/base/crew.hpp"
#include "physics/base/stage.hpp"
#include "physics/dynamics/contact_graph.hpp"
#include "physics/dynamics/soft_kernels.hpp"
#include "physics/space/check.hpp"

PHYSICS_HPP_BEGIN

/// Numbers of the soft step solver; lengths in metres, speeds in m/s.
template <class S>
struct soft_step_settings {
    /// Parts of a step, each with its own round; more make contacts stiffer and heavy loads safer. At least 1.
    int substeps = 4;
    /// Frequency of the springs that push overlaps apart, as a part of the substeps' rate: work buys stiffness. With
    /// less a column of 15 crates buckles at 4 substeps, with more heavy loads and wide piles tremble.
    S stiffness = S(0.2);
    /// Their damping ratio. With less, large piles breathe for longer; with more, columns that lean right themselves
    /// too late.
    S damping_ratio = S(10);
    /// The frequency is no higher than this (Hz); 0: no limit.
    S frequency_cap = S(0);
    /// Speed at which overlaps are pushed apart, at most.
    S max_push_speed = S(3);
    /// Surfaces that meet faster than this within a substep begin the next one with no more than they held before.
    /// The higher it is, the less piles overlap that are hit, and the more they spring back.
    S impact_speed = S(0.5);
    /// Approaches slower than this do not bounce. Nor do points that bear a load already, or that were in contact in
    /// the last step and overlap by more than this speed makes in a step.
    S restitution_slop = S(0.5);
};

template <class S>
bool check(const soft_step_settings<S>& with, const char* function) {
    if (!detail::check_count(function, "solver.substeps", with.substeps)) return false;
    return detail::check_positive(function, "solver.stiffness", with.stiffness) &&
           detail::check_positive(function, "solver.damping_ratio", with.damping_ratio) &&
           detail::check_not_negative(function, "solver.frequency_cap", with.frequency_cap) &&
           detail::check_not_negative(function, "solver.max_push_speed", with.max_push_speed) &&
           detail::check_not_negative(function, "solver.impact_speed", with.impact_speed) &&
           detail::check_not_negative(function, "solver.restitution_slop", with.restitution_slop);
}

/// Small steps with soft contacts: in each substep velocities advance, bodies get what contacts gave in the last one, a
/// round pushes overlaps apart by damped springs, poses advance, and a round without springs takes back the speed that
/// they gave. Where all points of a contact go on pushing they are answered at once, exactly; others are visited one by
/// one. Bounces come last. Normals act per manifold, friction on a circular cone per manifold (patch_friction) or per
/// point (point_friction). Error: of order h / substeps; the springs follow the substep, so that more work always means
/// less error. Momentum is kept to rounding, angular momentum but for how far bodies that collide move past each other
/// within the step. Cost: 2 rounds a substep, contacts of one colour in lanes. Source: Macklin et al., Small Steps in
/// Physics Simulation (2019); Catto, Soft constraints (GDC 2011), Solver2D (2024).
template <class Friction>
struct soft_step_with {
    using stage = physics::stage::solver;

    /// Width: how many contacts go in lanes at a time; every width gives the same bits.
    template <class Space, class Features, int Width = detail::native_width<typename Space::scalar>,
              template <class> class Kernels = detail::soft_kernels>
        requires(std::same_as<Friction, patch_friction> || std::same_as<Friction, point_friction>)
    class in {
    public:
        using S = typename Space::scalar;
        static constexpr int D = Space::dimension;
        static constexpr bool turns = Features::rotation;
        using settings = soft_step_settings<S>;
        using bodies_type = solver_bodies<S, D, turns>;

        /// Advances velocities and poses by h: `motion` offers advance_velocities(h) and advance_poses(h), which adds
        /// to their ways; where it takes the velocities with which the substep began as well (see substep_start), it
        /// saves rounds over the bodies. With several hands, contacts of a colour are shared out.
        template <class Motion>
        static void solve(bodies_type all, contact_list<S, D, Features> contacts, const settings& with, S h,
                          arena& scratch, Motion&& motion, detail::crew& hands) {
            const detail::contact_colours colours = detail::colour(contacts, all, scratch, hands);
#if PHYSICS_HPP_AVX2_KERNELS
            if constexpr (Width > 1 && Width == detail::native_width<S>) {
                using wide = in<Space, Features, 2 * Width, detail::avx2_kernels>;
                // A block of twice the width takes one and a half times as long: colours of few contacts fill too few
                // of its lanes.
                if (detail::has_avx2() && 3 * wide::blocks_of(colours) < 2 * blocks_of(colours))
                    return wide::solve(colours, all, contacts, with, h, scratch, motion, hands);
            }
#endif
            solve(colours, all, contacts, with, h, scratch, motion, hands);
        }
        template <class Motion>
        static void solve(bodies_type all, contact_list<S, D, Features> contacts, const settings& with, S h,
                          arena& scratch, Motion&& motion) {
            detail::crew nobody_else;
            solve(all, contacts, with, h, scratch, motion, nobody_else);
        }
        /// The same at this very width, for contacts that have their colours.
        template <class Motion>
        static void solve(const detail::contact_colours& colours, bodies_type all,
                          contact_list<S, D, Features> contacts, const settings& with, S h, arena& scratch,
                          Motion&& motion, detail::crew& hands) {
            solver_body<S, D, turns>* const bodies = all.first;
            const detail::soft_start<S, D, Features> how{S(1) / S(with.substeps), with.restitution_slop * h,
                                                         accelerations(motion, all, scratch), contacts.surfaces()};
            const blocks_in_colours blocks = pack(colours, contacts, all, how, scratch, hands);
            const S part = h / S(with.substeps);
            const S frequency = with.stiffness / part;
            const bool capped = with.frequency_cap > S(0) && with.frequency_cap < frequency;
            detail::substep_start<S, D, turns> start(all, scratch);
            const detail::soft_round<S, D, turns> press{
                S(1) / part,
                detail::softness<S>::of(capped ? with.frequency_cap : frequency, with.damping_ratio, part),
                with.max_push_speed,
                with.impact_speed,
                with.restitution_slop,
                part,
                true,
                false,
                start.velocities()};
            detail::soft_round<S, D, turns> relax = press;
            relax.pushes = false;
            for (int i = 0; i < with.substeps; ++i) {
                start.advance_velocities(motion, part);
                if (i == 0) blocks.each(hands, [bodies](block& b) { kernels::warm_start(b, bodies); });
                if constexpr (Features::restitution)
                    if (blocks.bounce)
                        blocks.each_number(hands, [bodies, &press, &blocks](std::uint32_t k) {
                            if (!blocks.bounces[k].ever) return;
                            kernels::note_approaches(blocks.first[k], bodies, press);
                            blocks.bounces[k].now = blocks.first[k].bounces_now;
                        });
                blocks.each(hands, [bodies, &press](block& b) { kernels::solve(b, bodies, press); });
                start.advance_poses(motion, part);
                relax.over_relaxes = i + 1 < with.substeps;
                blocks.each(hands, [bodies, &relax](block& b) { kernels::solve(b, bodies, relax); });
                if constexpr (Features::restitution)
                    if (blocks.bounce)
                        blocks.each_number(hands, [bodies, &relax, &blocks](std::uint32_t k) {
                            if (blocks.bounces[k].now && blocks.first[k].bounces_now)
                                blocks.first[k].bounce(bodies, relax);
                        });
            }
            blocks.each_at_once(hands,
                                [&](std::uint32_t k, std::uint32_t, std::uint32_t) { blocks.take(k, contacts); });
        }
        /// Blocks that contacts of these colours fill.
        static std::uint32_t blocks_of(const detail::contact_colours& colours) {
            std::uint32_t count = 0;
            for (std::uint32_t group = 0; group < colours.count; ++group) count += blocks_of(colours, group);
            return count;
        }

    private:
        static constexpr int width = Width;
        static constexpr std::uint32_t none = 0xffffffffu;
        using turning_block = std::conditional_t<D == 2, detail::soft_contact2<S, width, Features>,
                                                 detail::soft_contact3<S, width, Features, Friction>>;
        using block = std::conditional_t<turns, turning_block, detail::soft_linear_contact<S, D, width, Features>>;
        using kernels = Kernels<block>;

        /// So many blocks are worth handing to somebody else.
        static constexpr std::uint32_t share = 16;

        struct blocks_in_colours {
            block* first;
            /// Of each lane of each block its contact.
            std::uint32_t* numbers;
            /// Where the blocks of each colour begin, and after the last one.
            std::uint32_t begin[detail::contact_colours::most + 1];
            std::uint32_t colours;
            bool last_is_serial;
            /// Whether any contact can bounce.
            bool bounce = false;
            /// Whether those of a block can, and whether some are about to: so that no other blocks are read for it.
            struct bouncing {
                bool ever, now;
            };
            bouncing* bounces = nullptr;

            [[nodiscard]] std::uint32_t count() const { return begin[colours]; }

            template <class F>
            void each(detail::crew& hands, F&& f) const {
                each_number(hands, [&](std::uint32_t k) { f(first[k]); });
            }
            template <class F>
            void each_number(detail::crew& hands, F&& f) const {
                if (hands.is_alone()) {
                    for (std::uint32_t k = 0; k < count(); ++k) f(k);
                    return;
                }
                for (std::uint32_t group = 0; group < colours; ++group) {
                    const std::uint32_t from = begin[group], size = begin[group + 1] - from;
                    const bool is_serial = last_is_serial && group + 1 == colours;
                    hands.each_range(size, is_serial ? size : share,
                                     [&](std::uint32_t start, std::uint32_t end, std::uint32_t) {
                                         for (std::uint32_t k = start; k < end; ++k) f(from + k);
                                     });
                }
            }
            /// Calls f(block's number, colour, worker) for all of them in any order: each is for the worker who has it
            /// in the rounds.
            template <class F>
            void each_at_once(detail::crew& hands, F&& f) const {
                hands.each_share(count() / share, [&](const detail::crew::equal_part& of, std::uint32_t worker) {
                    for (std::uint32_t group = 0; group < colours; ++group) {
                        const std::uint32_t from = begin[group], size = begin[group + 1] - from;
                        const std::uint32_t last = from + of.end_in(size);
                        for (std::uint32_t k = from + of.begin_in(size); k < last; ++k) f(k, group, worker);
                    }
                });
            }
            /// Hands a block's impulses to its contacts.
            void take(std::uint32_t k, const contact_list<S, D, Features>& contacts) const {
                for (int lane = 0; lane < width; ++lane)
                    if (const std::uint32_t n = numbers[k * width + static_cast<std::uint32_t>(lane)]; n != none)
                        first[k].take(lane, contacts[n]);
            }
        };
        /// What drives bodies, if the motion tells: bounces start at the end of the gap, not where a substep ends.
        template <class Motion>
        static const vec<S, D>* accelerations([[maybe_unused]] Motion& motion, [[maybe_unused]] bodies_type all,
                                              [[maybe_unused]] arena& scratch) {
            if constexpr (Features::restitution && requires { motion.acceleration(0u); }) {
                auto* result = scratch.template take<vec<S, D>>(all.count);
                for (std::uint32_t k = 0; k < all.count; ++k)
                    new (result + k) vec<S, D>(k < all.nobody() ? motion.acceleration(k) : vec<S, D>{});
                return result;
            } else {
                return nullptr;
            }
        }
        /// Contacts of a block of this colour: one where they may push the same body.
        static std::uint32_t lanes_of(const detail::contact_colours& colours, std::uint32_t group) {
            return colours.last_is_serial && group + 1 == colours.count ? 1 : width;
        }
        static std::uint32_t blocks_of(const detail::contact_colours& colours, std::uint32_t group) {
            const std::uint32_t lanes = lanes_of(colours, group);
            return (colours.begin[group + 1] - colours.begin[group] + lanes - 1) / lanes;
        }
        static blocks_in_colours pack(const detail::contact_colours& colours,
                                      const contact_list<S, D, Features>& contacts, bodies_type bodies,
                                      const detail::soft_start<S, D, Features>& with, arena& scratch,
                                      detail::crew& hands) {
            blocks_in_colours result;
            result.colours = colours.count;
            result.last_is_serial = colours.last_is_serial;
            std::uint32_t count = 0;
            for (std::uint32_t group = 0; group < colours.count; ++group) {
                result.begin[group] = count;
                count += blocks_of(colours, group);
            }
            result.begin[colours.count] = count;
            result.first = scratch.template take<block>(count);
            result.numbers = scratch.template take<std::uint32_t>(count * width);
            result.each_at_once(hands, [&](std::uint32_t k, std::uint32_t group, std::uint32_t worker) {
                const std::uint32_t lanes = lanes_of(colours, group);
                const std::uint32_t at = colours.begin[group] + (k - result.begin[group]) * lanes;
                const std::uint32_t rest = colours.begin[group + 1] - at;
                fill(result.first[k], result.numbers + k * width, colours.order + at, rest < lanes ? rest : lanes,
                     contacts, bodies, with, hands.scratch_of(worker, scratch));
            });
            if constexpr (Features::restitution) {
                result.bounces = scratch.template take<typename blocks_in_colours::bouncing>(count);
                for (std::uint32_t k = 0; k < count; ++k) {
                    const bool ever = result.first[k].bounce_to.at != nullptr;
                    result.bounces[k] = {ever, false};
                    result.bounce = result.bounce || ever;
                }
            }
            return result;
        }
        static void fill(block& place, std::uint32_t* numbers, const std::uint32_t* order, std::uint32_t used,
                         const contact_list<S, D, Features>& contacts, bodies_type bodies,
                         const detail::soft_start<S, D, Features>& with, arena& scratch) {
            block& to = *new (&place) block{};
            typename block::gathering gathered;
            for (int lane = 0; lane < width; ++lane) {
                const bool has = static_cast<std::uint32_t>(lane) < used;
                numbers[lane] = has ? order[lane] : none;
                if (has) to.put(lane, contacts[order[lane]], bodies.first, with, gathered, scratch);
                else to.a[lane] = to.b[lane] = bodies.spare();
            }
            kernels::prepare(to, bodies.first, gathered);
            to.moves_a = bodies[to.a[0]].inverse_mass > inverse_of<S>(0);
            to.moves_b = bodies[to.b[0]].inverse_mass > inverse_of<S>(0);
        }
    };
};

/// Small steps with friction per manifold.
struct soft_step : soft_step_with<patch_friction> {};

PHYSICS_HPP_END
