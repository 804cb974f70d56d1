// The sequential impulse solver: one constraint at a time, impulses accumulated and clamped; bounces all at once.
#pragma once

#include "physics/dynamics/friction.hpp"
#include "physics/dynamics/graph.hpp"
#include "physics/dynamics/integrator.hpp"
#include "physics/dynamics/joint_solver.hpp"
#include "physics/dynamics/reflections.hpp"
#include "physics/dynamics/running_surface.hpp"
#include "physics/space/check.hpp"

PHYSICS_HPP_BEGIN

/// Numbers of the sequential impulse solver; lengths in metres, speeds in m/s.
template <class S>
struct sequential_impulse_settings {
    /// Parts of a step, each with its own rounds; more make tall stacks and heavy loads stiffer. At least 1.
    int substeps = 4;
    /// Rounds over all contacts in a substep. At least 1.
    int iterations = 8;
    /// Share of an overlap that one substep takes back (the factor beta of Baumgarte), 0 to 1.
    S baumgarte = S(0.2);
    /// Overlap that is left alone, so that resting contacts persist.
    S penetration_slop = S(0.005);
    /// Speed at which overlaps are pushed apart, at most.
    S max_depenetration_speed = S(3);
    /// Approaches slower than this do not bounce, nor those that acceleration brings about within a substep.
    S restitution_threshold = S(0.5);
    /// See soft_step_settings.
    int max_direct_cost = 1024;
    /// Rounds of bounces in a substep, at most: an impact passes one contact in a round. What approaches after them
    /// stops.
    int reflections = 64;
};

template <class S>
bool check(const sequential_impulse_settings<S>& with, const char* function) {
    if (!detail::check_count(function, "solver.substeps", with.substeps) ||
        !detail::check_limit(function, "solver.max_direct_cost", with.max_direct_cost) ||
        !detail::check_count(function, "solver.iterations", with.iterations) ||
        !detail::check_count(function, "solver.reflections", with.reflections))
        return false;
    if (with.baumgarte > S(1))
        return detail::refuse(function, "solver.baumgarte", double(with.baumgarte), "it must be at most 1");
    return detail::check_not_negative(function, "solver.baumgarte", with.baumgarte) &&
           detail::check_not_negative(function, "solver.penetration_slop", with.penetration_slop) &&
           detail::check_not_negative(function, "solver.max_depenetration_speed", with.max_depenetration_speed) &&
           detail::check_not_negative(function, "solver.restitution_threshold", with.restitution_threshold);
}

/// Sequential impulses in small steps (projected Gauss-Seidel on velocities). In each substep surfaces with restitution
/// bounce first, all that meet at once (detail::reflections); then rounds go over all contacts, with accumulated
/// impulses clamped to what contacts can give, warm starting, Coulomb friction on a circular cone and resistance to
/// rolling; then overlaps beyond the slop are pushed apart by velocities that only last for the substep, no faster than
/// max_depenetration_speed, so that no overlap becomes speed. Contacts are rigid: nothing springs, and no energy is
/// made. Good for what bounces, since crowds of elastic bodies keep energy, momentum and mirror symmetry (with
/// restitution_threshold 0), for deep overlaps and squeezes, and for columns of 30 crates and loads of 100:1 at the
/// defaults; more substeps bear more. Not for large piles: it works on one contact at a time, where soft_step works in
/// lanes and by several threads. Needles thinner than 1:500 want a single substep of 20 iterations. Error: of order h;
/// stacks settle into the slop. Momentum is kept to rounding where no gravity pulls; where it does, what pushes lift is
/// taken from speeds. Cost: substeps x iterations x points, and for bounces a walk over the points with restitution for
/// each contact that an impact passes. Source: Catto, Iterative Dynamics with Temporal Coherence (2005), Solver2D
/// (2024, "TGS"); Macklin et al., Small Steps (2019); Guendelman et al., Nonconvex Rigid Bodies with Stacking (2003).
struct sequential_impulse {
    using stage = physics::stage::solver;
    static constexpr bool solves_joints = true;

    template <class Space, class Features>
    class in {
    public:
        using S = typename Space::scalar;
        static constexpr int D = Space::dimension;
        static constexpr bool rotates = Features::rotation;
        using settings = sequential_impulse_settings<S>;
        using contact = solver_api::contact<S, D, Features>;
        using body = solver_api::solver_body<S, D, rotates>;
        using bodies_type = solver_api::solver_bodies<S, D, rotates>;

        /// Advances velocities and poses by h: `motion` offers integrate_velocities(h) and integrate_positions(h).
        template <class Constraints = solver_api::contact_constraints<S, D, Features>, class Motion>
        static void solve(bodies_type bodies, const Constraints& contacts, const settings& with, S h, arena& scratch,
                          Motion&& motion) {
            const S h_sub = h / S(with.substeps), share = S(1) / S(with.substeps);
            detail::task_runner serial;
            solver_api::joint_solver<Constraints> joints(contacts, bodies, motion, h_sub, S(0.25) / h_sub, S(2),
                                                         with.max_direct_cost, scratch, serial);
            const surfaces of = contacts.surfaces();
            const bool* const has_joint = detail::bodies_of_joints(contacts, bodies, scratch);
            block* blocks = scratch.template allocate<block>(contacts.size());
            for (std::uint32_t i = 0; i < contacts.size(); ++i)
                new (blocks + i) block(contacts[i], contacts.bodies(i), of, bodies, h, share);
            bounces impacts = bounces_of(contacts, of, blocks, bodies, scratch);
            twist_type* const velocity_change = scratch.template allocate<twist_type>(bodies.count);
            twist_type* const position_velocities = scratch.template allocate<twist_type>(bodies.count);
            for (int i = 0; i < with.substeps; ++i) {
                for (std::uint32_t k = 0; k < bodies.count; ++k) velocity_change[k] = bodies[k].velocity;
                motion.integrate_velocities(h_sub);
                for (std::uint32_t k = 0; k < bodies.count; ++k)
                    velocity_change[k] = bodies[k].velocity - velocity_change[k];
                if (impacts.any()) impacts.solve(velocity_change, with.restitution_threshold, h_sub, with.reflections);
                for (std::uint32_t k = 0; k < contacts.size(); ++k) {
                    set_targets(contacts[k], blocks[k], bodies, with, h_sub);
                    warm_start(contacts[k], of, blocks[k], bodies);
                }
                joints.warm_start(serial);
                const auto solve_one = [&](contact& c, std::uint32_t k, bool back) {
                    solve_contact(c, of, blocks[k], bodies, with, back);
                    return true;
                };
                alternating_passes(
                    with.iterations, contacts, [&](bool back) { return joints.solve_speeds(serial, back); }, solve_one);
                for (int round = 0; round < with.iterations; ++round) joints.correct(serial, round % 2 != 0);
                for (std::uint32_t k = 0; k < bodies.count; ++k) position_velocities[k] = {};
                const auto push_one = [&](const contact& c, std::uint32_t k, bool back) {
                    return solve_position(c, blocks[k], bodies, position_velocities, back);
                };
                alternating_passes(
                    with.iterations, contacts, [](bool) { return false; }, push_one);
                integrate_positions(bodies, has_joint, velocity_change, position_velocities,
                                    with.max_depenetration_speed, h_sub, motion);
                joints.update_rows(serial, nullptr);
                joints.relax(serial, with.iterations);
                for (std::uint32_t k = 0; k < contacts.size(); ++k) blocks[k].add_up(contacts[k].count);
            }
            for (std::uint32_t i = 0; i < contacts.size(); ++i) blocks[i].store(contacts[i]);
            joints.store_impulses(serial);
        }

    private:
        using surfaces = detail::combined_material<S, Features>;
        using bounces = detail::reflections<S, D, Features>;
        using twist_type = solver_api::twist_of<S, D, rotates>;

        struct no_friction {
            constexpr no_friction() = default;
            constexpr no_friction(const body&, const body&, const solver_api::anchors<S, D>&, const tangents<S, D>&) {}
        };
        struct no_rolling {};
        /// What one point needs while iterating.
        struct row {
            [[no_unique_address]] std::conditional_t<Features::friction, solver_api::friction_at<S, D>, no_friction>
                with_friction;
            S mass;
            /// Of this substep: impulses along the normal and, apart, by bounces; and along the tangents.
            S normal{};
            detail::bounce<S> bounce{};
            [[no_unique_address]] detail::optional_member<Features::friction, tangential<S, D>, feature::friction>
                friction{};
            /// The speed along the normal with which the surfaces must part at least, and that with pushes.
            S target{}, position_target{};
            S position_impulse{};
            /// Of the whole step.
            S total{};
            [[no_unique_address]] detail::optional_member<Features::friction, tangential<S, D>, feature::friction, 1>
                total_friction{};
        };
        struct block {
            tangents<S, D> frame;
            solver_api::body_pair ends;
            [[no_unique_address]] std::conditional_t<Features::rolling_resistance, solver_api::rolling_at<S, D>,
                                                     no_rolling>
                with_rolling{};
            [[no_unique_address]] detail::optional_member<Features::rolling_resistance, tangential<S, D>,
                                                          feature::rolling_resistance, 1>
                rolling{};
            [[no_unique_address]] detail::optional_member<Features::rolling_resistance, tangential<S, D>,
                                                          feature::rolling_resistance, 2>
                total_rolling{};
            [[no_unique_address]] detail::running_surface<S, D, Features> surface;
            bool yields;
            row rows[manifold<S, D>::capacity];

            block(const contact& c, const solver_api::body_pair& pair, surfaces of, bodies_type bodies, S h, S share)
                : frame(c.normal), ends(pair), surface(c, bodies[pair.a], bodies[pair.b], h, share) {
                const body& a = bodies[ends.a];
                const body& b = bodies[ends.b];
                yields = bounces::drives(a) || bounces::drives(b);
                if constexpr (Features::rolling_resistance)
                    if (of.rolling_resistance_of(c) > S(0)) {
                        with_rolling = {a, b, frame};
                        rolling = c.rolling_impulse * share;
                    }
                for (int k = 0; k < c.count; ++k) {
                    const solver_api::anchors<S, D> to = c.anchors(k);
                    row& r = *new (rows + k) row{{a, b, to, frame}, detail::effective_mass(a, b, to, c.normal)};
                    if (!c.persisted(k)) continue;
                    r.normal = c.points[k].substep_impulse;
                    if constexpr (Features::friction) r.friction = c.points[k].friction_impulse * share;
                }
            }
            void add_up(int count) {
                surface.advance();
                for (int k = 0; k < count; ++k) {
                    rows[k].total = solver_api::added_load(rows[k].total, rows[k].normal + rows[k].bounce.impulse);
                    if constexpr (Features::friction) rows[k].total_friction += rows[k].friction;
                }
                if constexpr (Features::rolling_resistance) total_rolling += rolling;
            }
            void store(contact& c) const {
                for (int k = 0; k < c.count; ++k) {
                    c.points[k].normal_impulse = rows[k].total;
                    c.points[k].substep_impulse = rows[k].normal;
                    if constexpr (Features::friction) c.points[k].friction_impulse = rows[k].total_friction;
                }
                if constexpr (Features::rolling_resistance) c.rolling_impulse = total_rolling;
            }
        };
        static bounces bounces_of(const solver_api::contact_constraints<S, D, Features>& contacts,
                                  [[maybe_unused]] const surfaces& of, [[maybe_unused]] block* blocks,
                                  bodies_type bodies, arena& scratch) {
            std::uint32_t capacity = 0;
            if constexpr (Features::restitution)
                for (std::uint32_t i = 0; i < contacts.size(); ++i)
                    if (of.restitution_of(contacts[i]) > S(0)) capacity += contacts[i].count;
            bounces result(bodies, capacity, scratch);
            if constexpr (Features::restitution)
                for (std::uint32_t i = 0; i < contacts.size(); ++i) {
                    const S restitution = of.restitution_of(contacts[i]);
                    for (int k = 0; restitution > S(0) && k < contacts[i].count; ++k)
                        result.add(contacts[i], blocks[i].ends, k, restitution, blocks[i].rows[k].mass,
                                   blocks[i].rows[k].bounce);
                }
            return result;
        }

        /// Apart, the surfaces may close the gap; overlapping, they must not approach. Beyond the slop they are pushed
        /// apart slowly.
        static void set_targets(const contact& c, block& with, bodies_type bodies, const settings& numbers, S h) {
            for (int k = 0; k < c.count; ++k) {
                row& r = with.rows[k];
                const S separation = bounces::separation_of(c, with.ends, k, bodies);
                r.target = min(-separation / h, S(0)) - r.bounce.rounding;
                const S beyond = -separation - numbers.penetration_slop;
                r.position_target =
                    beyond > S(0) ? min(beyond * numbers.baumgarte / h, numbers.max_depenetration_speed) : beyond / h;
                r.position_impulse = S(0);
            }
        }

        static void warm_start(const contact& c, [[maybe_unused]] surfaces of, block& with, bodies_type bodies) {
            for (int k = 0; k < c.count; ++k) {
                row& r = with.rows[k];
                const auto [to_a, to_b] = c.anchors(k);
                vec<S, D> impulse = c.normal * r.normal;
                if constexpr (Features::friction) {
                    // Of what a bounce has borne, nothing is left.
                    r.friction = r.with_friction.next(r.friction, {}, of.friction_of(c) * r.normal);
                    impulse += with.frame.combine(r.friction);
                }
                bodies[with.ends.a].apply(-impulse, to_a);
                bodies[with.ends.b].apply(impulse, to_b);
            }
            if constexpr (Features::rolling_resistance)
                if (of.rolling_resistance_of(c) > S(0))
                    turn(with, with.rolling, bodies[with.ends.a], bodies[with.ends.b]);
        }
        /// An angular impulse against rolling, from A on B.
        static void turn(const block& with, tangential<S, D> impulse, body& a, body& b) {
            const angular<S, D> moment = with.with_rolling.combine(with.frame, impulse);
            a.velocity.angular -= times(a.inverse_inertia, moment);
            b.velocity.angular += times(b.inverse_inertia, moment);
        }
        static void resist_rolling(const contact& c, S resistance, block& with, body& a, body& b) {
            S load = S(0);
            for (int k = 0; k < c.count; ++k) load += with.rows[k].normal + with.rows[k].bounce.impulse;
            const auto w = with.with_rolling.components(with.frame, b.velocity.angular - a.velocity.angular);
            const auto impulse = with.with_rolling.next(with.rolling, w, resistance * load);
            turn(with, impulse - with.rolling, a, b);
            with.rolling = impulse;
        }

        /// Passes over all contacts in alternating directions, so that impulses and corrections propagate equally both
        /// ways; before each, joints, in its direction. Ends after `rounds`, or after one in which both return false.
        template <class Joints, class F>
        static void alternating_passes(int rounds, const solver_api::contact_constraints<S, D, Features>& contacts,
                                       Joints&& joints, F&& f) {
            bool changed = true;
            for (int round = 0; round < rounds && changed; ++round) {
                const bool back = round % 2 != 0;
                changed = joints(back);
                for (std::uint32_t i = 0; i < contacts.size(); ++i) {
                    const std::uint32_t at = back ? contacts.size() - 1 - i : i;
                    changed = f(contacts[at], at, back) || changed;
                }
            }
        }
        /// Calls f with the numbers of a contact's points, across and back, because the points of one contact depend
        /// on each other the most: what they leave open lets a stack sway.
        template <class F>
        static void symmetric_pass(int count, bool back, F&& f) {
            const int visits = 2 * count - 1;
            for (int i = 0; i < visits; ++i) {
                const int across = i < count ? i : visits - 1 - i;
                f(back ? count - 1 - across : across);
            }
        }

        static void solve_contact(const contact& c, [[maybe_unused]] surfaces of, block& with, bodies_type bodies,
                                  const settings& numbers, bool back) {
            body& a = bodies[with.ends.a];
            body& b = bodies[with.ends.b];
            if constexpr (Features::rolling_resistance)
                if (const S resistance = of.rolling_resistance_of(c); resistance > S(0))
                    resist_rolling(c, resistance, with, a, b);
            if constexpr (Features::friction) {
                const auto& frame = with.frame;
                for (int i = 0; i < c.count; ++i) {
                    const int k = back ? c.count - 1 - i : i;
                    row& r = with.rows[k];
                    const auto [to_a, to_b] = c.anchors(k);
                    const vec<S, D> v = velocity_at(b.velocity, to_b) - velocity_at(a.velocity, to_a);
                    auto slip = frame.components(v);
                    with.surface.take_from(slip);
                    const auto impulse =
                        r.with_friction.next(r.friction, slip, of.friction_of(c) * (r.normal + r.bounce.impulse));
                    const vec<S, D> change = frame.combine(impulse - r.friction);
                    r.friction = impulse;
                    a.apply(-change, to_a);
                    b.apply(change, to_b);
                }
            }
            // Normals last: not sinking in matters more than not sliding.
            symmetric_pass(c.count, back, [&](int k) {
                row& r = with.rows[k];
                const auto [to_a, to_b] = c.anchors(k);
                const vec<S, D> v = velocity_at(b.velocity, to_b) - velocity_at(a.velocity, to_a);
                S impulse = max(r.normal + r.mass * (r.target - dot(c.normal, v)), S(0));
                if (with.yields) impulse = yielding(impulse, r.mass * numbers.max_depenetration_speed);
                const vec<S, D> change = c.normal * (impulse - r.normal);
                r.normal = impulse;
                a.apply(-change, to_a);
                b.apply(change, to_b);
            });
        }
        /// What drives without being pushed gives way beyond some impulse: else impulses between two of them would grow
        /// without end, and throw what is between once it is free.
        static S yielding(S impulse, S maximum) {
            return impulse > maximum ? maximum + (impulse - maximum) * S(0.25) : impulse;
        }

        /// Pushes overlaps apart by velocities of their own, which last for this substep: they move bodies and leave
        /// nothing behind. True if something has changed.
        static bool solve_position(const contact& c, block& with, bodies_type bodies, twist_type* position_velocities,
                                   bool back) {
            bool changed = false;
            body& a = bodies[with.ends.a];
            body& b = bodies[with.ends.b];
            symmetric_pass(c.count, back, [&](int k) {
                row& r = with.rows[k];
                const auto [to_a, to_b] = c.anchors(k);
                const vec<S, D> v = velocity_at(b.velocity + position_velocities[with.ends.b], to_b) -
                                    velocity_at(a.velocity + position_velocities[with.ends.a], to_a);
                const S impulse = max(r.position_impulse + r.mass * (r.position_target - dot(c.normal, v)), S(0));
                if (impulse == r.position_impulse) return;
                const vec<S, D> change = c.normal * (impulse - r.position_impulse);
                r.position_impulse = impulse;
                apply_position_impulse(position_velocities[with.ends.a], a, -change, to_a);
                apply_position_impulse(position_velocities[with.ends.b], b, change, to_b);
                changed = true;
            });
            return changed;
        }
        static void apply_position_impulse(twist_type& of, const body& b, vec<S, D> impulse, vec<S, D> anchor) {
            body pushed = b;
            pushed.velocity = of;
            pushed.apply(impulse, anchor);
            of = pushed.velocity;
        }
        template <class Motion>
        static void integrate_positions(bodies_type bodies, const bool* has_joint, const twist_type* velocity_change,
                                        twist_type* position_velocities, S fastest, S h, Motion& motion) {
            for (std::uint32_t i = 0; i < bodies.count; ++i) {
                if (position_velocities[i] == twist_type{}) continue;
                // What keeps joints from pushing bodies into others is as fast as they are.
                if (has_joint == nullptr || !has_joint[i]) limit(position_velocities[i], fastest);
                take_from_speed(bodies[i].velocity, position_velocities[i], velocity_change[i]);
                bodies[i].velocity = bodies[i].velocity + position_velocities[i];
            }
            motion.integrate_positions(h);
            for (std::uint32_t i = 0; i < bodies.count; ++i)
                if (!(position_velocities[i] == twist_type{}))
                    bodies[i].velocity = bodies[i].velocity - position_velocities[i];
        }
        /// No faster than that, or turning as its share.
        static void limit(twist_type& position_impulse, S fastest) {
            if (!(length_squared(position_impulse.linear) > product(fastest, fastest))) return;
            const S share = fastest / length(position_impulse.linear);
            position_impulse.linear *= share;
            if constexpr (rotates) position_impulse.angular *= share;
        }
        /// Takes the potential energy that a position correction adds from the body's speed, else coins would spin up
        /// and elastic boxes bounce higher and higher; at most a sixteenth of the speed a substep.
        static void take_from_speed(twist_type& v, const twist_type& push, const twist_type& change) {
            const S gain = -dot(push.linear, change.linear) * S(2), square = dot(v.linear, v.linear);
            if (gain > S(0) && square > S(0)) v.linear *= sqrt(S(1) - min(gain / square, S(0.125)));
        }
    };
};

PHYSICS_HPP_END
