// The soft step: many small steps, each with one round over the contacts in lanes.
#pragma once

#include "physics/base/handle.hpp"
#include "physics/base/stage.hpp"
#include "physics/base/task_runner.hpp"
#include "physics/dynamics/joint_solver.hpp"
#include "physics/dynamics/soft_kernels.hpp"
#include "physics/space/check.hpp"

PHYSICS_HPP_BEGIN

/// Numbers of the soft step solver; lengths in metres, speeds in m/s.
template <class S>
struct soft_step_settings {
    /// Parts of a step, each with its own round; more make contacts stiffer and heavy loads safer. At least 1.
    int substeps = 4;
    /// Frequency of the springs that push overlaps apart, as a part of the substeps' rate (of usual ones, where steps
    /// differ in length): work buys stiffness. With less a column of 15 crates buckles at 4 substeps, with more heavy
    /// loads and wide piles tremble.
    S contact_frequency_ratio = S(0.2);
    /// Their damping ratio. With less, large piles breathe for longer; with more, columns that lean right themselves
    /// too late.
    S damping_ratio = S(10);
    /// The frequency is no higher than this (Hz); 0: no limit.
    S frequency_cap = S(0);
    /// Speed at which overlaps are pushed apart, at most.
    S max_depenetration_speed = S(3);
    /// Surfaces that meet faster than this within a substep begin the next one with no more than they held before.
    /// The higher it is, the less piles overlap that are hit, and the more they spring back.
    S impact_speed = S(0.5);
    /// Approaches slower than this do not bounce. Nor do points that bear a load already, or that were in contact in
    /// the last step and overlap by more than this speed makes in a step.
    S restitution_threshold = S(0.5);
    /// Joints that hold some bodies together are solved all at once where that takes up to so many multiplications a
    /// row: trees, and loops that are not too wide. 0: never.
    int max_direct_cost = 1024;
};

template <class S>
bool check(const soft_step_settings<S>& with, const char* function) {
    if (!detail::check_count(function, "solver.substeps", with.substeps) ||
        !detail::check_limit(function, "solver.max_direct_cost", with.max_direct_cost))
        return false;
    return detail::check_positive(function, "solver.contact_frequency_ratio", with.contact_frequency_ratio) &&
           detail::check_positive(function, "solver.damping_ratio", with.damping_ratio) &&
           detail::check_not_negative(function, "solver.frequency_cap", with.frequency_cap) &&
           detail::check_not_negative(function, "solver.max_depenetration_speed", with.max_depenetration_speed) &&
           detail::check_not_negative(function, "solver.impact_speed", with.impact_speed) &&
           detail::check_not_negative(function, "solver.restitution_threshold", with.restitution_threshold);
}

/// Small steps with soft contacts: in each substep velocities advance, bodies get what contacts gave in the last one, a
/// round pushes overlaps apart by damped springs, poses advance, and a round without springs takes back the speed that
/// they gave. Where all points of a contact go on pushing they are answered at once, exactly; others are visited one by
/// one. Bounces come last. Normals act per manifold, friction on a circular cone per manifold (patch_friction) or per
/// point (point_friction). Error: of order h / substeps; the springs follow the substep, so that more work always means
/// less error. Momentum is kept to rounding, angular momentum but for how far bodies that collide move past each other
/// within the step, and in 3D for friction across their gap, which each has at its own surface as the step begins.
/// Cost: 2 rounds a substep, 3 over joints that are not solved directly; contacts of one colour in lanes. Source:
/// Macklin et al., Small Steps in Physics Simulation (2019); Catto, Soft constraints (GDC 2011), Solver2D (2024).
template <class Friction>
struct soft_step_with {
    using stage = physics::stage::solver;
    static constexpr bool solves_joints = true;

    /// Width: how many contacts go in lanes at a time; every width gives the same bits.
    template <class Space, class Features, int Width = detail::native_width<typename Space::scalar>,
              template <class> class Kernels = detail::soft_kernels>
        requires(std::same_as<Friction, patch_friction> || std::same_as<Friction, point_friction>)
    class in {
    public:
        using S = typename Space::scalar;
        static constexpr int D = Space::dimension;
        static constexpr bool rotates = Features::rotation;
        using settings = soft_step_settings<S>;
        using bodies_type = solver_api::solver_bodies<S, D, rotates>;
        /// Advances velocities and poses by h: `motion` offers integrate_velocities(h) and integrate_positions(h),
        /// which adds to their ways; where it takes the velocities with which the substep began as well (see
        /// substep_start), it saves rounds over the bodies; where it tells a usual_step(), contacts are no stiffer than
        /// in steps of that length. With several hands, contacts of a colour are shared out.
        template <class Constraints = solver_api::contact_constraints<S, D, Features>, class Motion>
        static void solve(bodies_type all, const Constraints& contacts, const settings& with, S h, arena& scratch,
                          Motion&& motion, detail::task_runner& tasks) {
            const detail::colours_of_contacts colours =
                detail::colour(contacts, all, detail::bodies_of_joints(contacts, all, scratch), scratch, tasks);
#if PHYSICS_HPP_AVX2_KERNELS
            if constexpr (Width > 1 && Width == detail::native_width<S>) {
                using wide = in<Space, Features, 2 * Width, detail::avx2_kernels>;
                // A block of twice the width takes one and a half times as long: colours of few contacts fill too few
                // of its lanes.
                if (detail::has_avx2() && 3 * wide::blocks_of(colours) < 2 * blocks_of(colours))
                    return wide::solve(colours, all, contacts, with, h, scratch, motion, tasks);
            }
#endif
            solve(colours, all, contacts, with, h, scratch, motion, tasks);
        }
        template <class Constraints = solver_api::contact_constraints<S, D, Features>, class Motion>
        static void solve(bodies_type all, const Constraints& contacts, const settings& with, S h, arena& scratch,
                          Motion&& motion) {
            detail::task_runner serial;
            solve(all, contacts, with, h, scratch, motion, serial);
        }
        /// The same at this very width, for contacts that have their colours.
        template <class Constraints = solver_api::contact_constraints<S, D, Features>, class Motion>
        static void solve(const detail::colours_of_contacts& colours, bodies_type all, const Constraints& contacts,
                          const settings& with, S h, arena& scratch, Motion&& motion, detail::task_runner& tasks) {
            solver_api::solver_body<S, D, rotates>* const bodies = all.first;
            const S h_sub = h / S(with.substeps);
            S usual = h;
            if constexpr (requires { motion.usual_step(); }) usual = motion.usual_step();
            solver_api::joint_solver<Constraints, detail::native_width<S>> joints(
                contacts, all, motion, h_sub, S(joint_frequency_ratio) / (usual / S(with.substeps)),
                S(joint_damping_ratio), with.max_direct_cost, scratch, tasks);
            const detail::prepare_input<S, D, Features> prepare_with{
                S(1) / S(with.substeps), h, with.restitution_threshold * h, accelerations(motion, all, scratch),
                contacts.surfaces()};
            const contact_blocks blocks = pack(colours, contacts, all, prepare_with, scratch, tasks);
            block* const first = blocks.first;
            const S frequency = with.contact_frequency_ratio / (usual / S(with.substeps));
            const bool capped = with.frequency_cap > S(0) && with.frequency_cap < frequency;
            detail::substep_start<S, D, rotates> start(all, scratch);
            detail::contact_pass<S, D, rotates> biased{
                S(1) / h_sub,
                detail::softness<S>::of(capped ? with.frequency_cap : frequency, with.damping_ratio, h_sub),
                with.max_depenetration_speed,
                with.impact_speed,
                with.restitution_threshold,
                h_sub,
                true,
                false,
                start.velocities()};
            detail::contact_pass<S, D, rotates> relaxed = biased;
            relaxed.use_bias = false;
            detail::contact_pass<S, D, rotates> released = biased;
            released.spring = {S(0), S(1), S(0)};
            for (int i = 0; i < with.substeps; ++i) {
                biased.elapsed = relaxed.elapsed = released.elapsed = h_sub * (S(i) + S(0.5));
                start.integrate_velocities(motion, h_sub);
                if (i == 0) {
                    joints.warm_start(tasks);
                    blocks.each(tasks, [bodies, first](std::uint32_t k) { kernels::warm_start(first[k], bodies); });
                }
                if constexpr (Features::restitution)
                    if (blocks.bounce)
                        blocks.each(tasks, [bodies, &biased, &blocks](std::uint32_t k) {
                            if (!blocks.bounces[k].ever) return;
                            kernels::note_approaches(blocks.first[k], bodies, biased);
                            blocks.bounces[k].now = blocks.first[k].bounces_now;
                        });
                joints.solve_before_contacts(tasks);
                blocks.each(tasks,
                            [bodies, first, &biased](std::uint32_t k) { kernels::solve(first[k], bodies, biased); });
                joints.solve_after_contacts(tasks);
                start.integrate_positions(motion, h_sub);
                relaxed.over_relaxes = i + 1 < with.substeps;
                joints.update_rows(tasks, start.velocities());
                // What kept corrections of joints from pushing bodies into others goes, before joints spread it.
                if constexpr (requires { Constraints::joint_kinds; })
                    blocks.each_of_joints(tasks, [bodies, first, &released](std::uint32_t k) {
                        kernels::solve(first[k], bodies, released);
                    });
                joints.relax(tasks, 1);
                blocks.each(tasks,
                            [bodies, first, &relaxed](std::uint32_t k) { kernels::solve(first[k], bodies, relaxed); });
                if constexpr (Features::restitution)
                    if (blocks.bounce)
                        blocks.each(tasks, [bodies, &relaxed, &blocks](std::uint32_t k) {
                            if (blocks.bounces[k].now && blocks.first[k].bounces_now)
                                blocks.first[k].bounce(bodies, relaxed);
                        });
            }
            joints.store_impulses(tasks);
            blocks.each_at_once(
                tasks, [&](std::uint32_t k, std::uint32_t, std::uint32_t) { blocks.store_impulses(k, contacts); });
        }
        /// Blocks that contacts of these colours fill.
        static std::uint32_t blocks_of(const detail::colours_of_contacts& colours) {
            return detail::blocks_by_colour(colours, width).count();
        }

    private:
        static constexpr int width = Width;
        static constexpr std::uint32_t none = detail::null_index;
        /// As what springs rigid joints take errors back: the frequency as a part of the substeps' rate.
        static constexpr double joint_frequency_ratio = 0.25, joint_damping_ratio = 2;
        using turning_block = detail::soft_contact<S, D, width, Features, Friction>;
        using block = std::conditional_t<rotates, turning_block, detail::soft_linear_contact<S, D, width, Features>>;
        using kernels = Kernels<block>;

        struct contact_blocks : detail::blocks_by_colour {
            block* first;
            /// Of each lane of each block its contact.
            std::uint32_t* numbers;
            /// Whether any contact can bounce.
            bool bounce = false;
            /// Whether those of a block can, and whether some are about to: so that no other blocks are read for it.
            struct bouncing {
                bool ever, now;
            };
            bouncing* bounces = nullptr;

            explicit contact_blocks(const detail::colours_of_contacts& of) : blocks_by_colour(of, width) {}

            /// Hands a block's impulses to its contacts.
            void store_impulses(std::uint32_t k,
                                const solver_api::contact_constraints<S, D, Features>& contacts) const {
                for (int lane = 0; lane < width; ++lane)
                    if (const std::uint32_t n = numbers[k * width + static_cast<std::uint32_t>(lane)]; n != none)
                        first[k].store_impulses(lane, contacts[n]);
            }
        };
        /// What drives bodies, if the motion tells: bounces start at the end of the gap, not where a substep ends.
        template <class Motion>
        static const vec<S, D>* accelerations([[maybe_unused]] Motion& motion, [[maybe_unused]] bodies_type all,
                                              [[maybe_unused]] arena& scratch) {
            if constexpr (Features::restitution && requires { motion.acceleration(0u); }) {
                auto* result = scratch.template allocate<vec<S, D>>(all.count);
                for (std::uint32_t k = 0; k < all.count; ++k)
                    new (result + k) vec<S, D>(k < all.static_body() ? motion.acceleration(k) : vec<S, D>{});
                return result;
            } else {
                return nullptr;
            }
        }
        static contact_blocks pack(const detail::colours_of_contacts& colours,
                                   const solver_api::contact_constraints<S, D, Features>& contacts, bodies_type bodies,
                                   const detail::prepare_input<S, D, Features>& with, arena& scratch,
                                   detail::task_runner& tasks) {
            contact_blocks result(colours);
            const std::uint32_t count = result.count();
            result.first = scratch.template allocate<block>(count);
            result.numbers = scratch.template allocate<std::uint32_t>(count * width);
            result.each_at_once(tasks, [&](std::uint32_t k, std::uint32_t group, std::uint32_t worker) {
                const std::uint32_t lanes = result.lanes_of(group);
                const std::uint32_t at = colours.begin[group] + (k - result.begin[group]) * lanes;
                const std::uint32_t rest = colours.begin[group + 1] - at;
                fill(result.first[k], result.numbers + k * width, colours.order + at, rest < lanes ? rest : lanes,
                     contacts, bodies, with, tasks.scratch_of(worker, scratch));
            });
            if constexpr (Features::restitution) {
                result.bounces = scratch.template allocate<typename contact_blocks::bouncing>(count);
                for (std::uint32_t k = 0; k < count; ++k) {
                    const bool ever = result.first[k].bounce_to.at != nullptr;
                    result.bounces[k] = {ever, false};
                    result.bounce = result.bounce || ever;
                }
            }
            return result;
        }
        static void fill(block& place, std::uint32_t* numbers, const std::uint32_t* order, std::uint32_t used,
                         const solver_api::contact_constraints<S, D, Features>& contacts, bodies_type bodies,
                         const detail::prepare_input<S, D, Features>& with, arena& scratch) {
            block& to = *new (&place) block{};
            typename block::gathering gathered;
            for (int lane = 0; lane < width; ++lane) {
                const bool has = static_cast<std::uint32_t>(lane) < used;
                numbers[lane] = has ? order[lane] : none;
                if (has)
                    to.put(lane, contacts[order[lane]], contacts.bodies(order[lane]), bodies.first, with, gathered,
                           scratch);
                else to.a[lane] = to.b[lane] = bodies.dummy_body();
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
