// The sequential impulse solver: one constraint at a time, impulses accumulated and clamped.
#pragma once

#include "physics/dynamics/batches.hpp"
#include "physics/dynamics/friction.hpp"
#include "physics/dynamics/integrator.hpp"
#include "physics/dynamics/restitution.hpp"
#include "physics/space/check.hpp"

PHYSICS_HPP_BEGIN

/// Numbers of the sequential impulse solver; lengths in metres, speeds in m/s.
template <class S>
struct sequential_impulse_settings {
    /// Rounds over all contacts; more make tall stacks and heavy loads stiffer. At least 1.
    int iterations = 20;
    /// Share of an overlap that one step takes back (the factor beta of Baumgarte), 0 to 1.
    S baumgarte = S(0.2);
    /// Overlap that is left alone, so that resting contacts persist.
    S penetration_slop = S(0.005);
    /// Speed at which overlaps are pushed apart, at most.
    S max_push_speed = S(3);
    /// Approaches slower than this do not bounce.
    S restitution_slop = S(0.5);
};

template <class S>
bool check(const sequential_impulse_settings<S>& with, const char* function) {
    if (with.iterations < 1)
        return detail::refuse(function, "solver.iterations", with.iterations, "it must be at least 1");
    if (with.baumgarte > S(1))
        return detail::refuse(function, "solver.baumgarte", static_cast<double>(with.baumgarte),
                              "it must be at most 1");
    return detail::check_not_negative(function, "solver.baumgarte", with.baumgarte) &&
           detail::check_not_negative(function, "solver.penetration_slop", with.penetration_slop) &&
           detail::check_not_negative(function, "solver.max_push_speed", with.max_push_speed) &&
           detail::check_not_negative(function, "solver.restitution_slop", with.restitution_slop);
}

/// Sequential impulses (projected Gauss-Seidel on velocities): accumulated impulses clamped to what contact
/// can give, warm starting of points that outlive a step, Baumgarte's term with a penetration slop,
/// restitution with its slop, Coulomb friction on a circular cone, resistance to rolling. Error: of order h;
/// stacks settle into the slop, mass ratios beyond 1:10 need more iterations. Cost: iterations x points.
/// Source: Catto, Iterative Dynamics with Temporal Coherence (2005); Catto, Modeling and Solving
/// Constraints (2009); Baumgarte (1972).
struct sequential_impulse {
    using stage = physics::stage::solver;

    template <class Space, class Features>
    class in {
    public:
        using S = typename Space::scalar;
        static constexpr int D = Space::dimension;
        using settings = sequential_impulse_settings<S>;
        using contact = physics::contact<S, D, Features>;
        using body = solver_body<S, D, Features::rotation>;
        using bodies_type = solver_bodies<S, D, Features::rotation>;

        /// Advances velocities and poses by h: `motion` offers advance_velocities(h) and advance_poses(h).
        template <class Motion>
        static void solve(bodies_type bodies, contact_list<S, D, Features> contacts, const settings& with, S h,
                          arena& scratch, Motion&& motion) {
            const surfaces of = contacts.surfaces();
            block* blocks = scratch.template take<block>(contacts.size());
            for (std::uint32_t i = 0; i < contacts.size(); ++i)
                new (blocks + i) block(contacts[i], of, bodies, with, h);
            motion.advance_velocities(h);
            for (std::uint32_t i = 0; i < contacts.size(); ++i) warm_start(contacts[i], of, blocks[i], bodies);
            // Forth and back in turns: loads and corrections travel as far one way as the other.
            for (int round = 0; round < with.iterations; ++round) {
                const bool back = round % 2 != 0;
                for (std::uint32_t i = 0; i < contacts.size(); ++i) {
                    const std::uint32_t at = back ? contacts.size() - 1 - i : i;
                    solve_contact(contacts[at], of, blocks[at], bodies, back);
                }
            }
            motion.advance_poses(h);
        }

    private:
        using surfaces = detail::mixture<S, Features>;

        struct no_friction {
            constexpr no_friction() = default;
            constexpr no_friction(const body&, const body&, const levers<S, D>&,
                                  const tangents<S, D>&) {}
        };
        struct no_rolling {};
        /// What one point needs while iterating; target_speed is the speed along the normal with which the
        /// surfaces must part, at least.
        struct row {
            [[no_unique_address]] std::conditional_t<Features::friction, friction_at<S, D>, no_friction> friction;
            S normal_mass;
            S target_speed;
        };
        struct block {
            tangents<S, D> frame;
            [[no_unique_address]] std::conditional_t<Features::rolling_resistance, rolling_at<S, D>, no_rolling>
                rolling{};
            row rows[manifold<S, D>::capacity];

            block(const contact& c, surfaces of, bodies_type bodies, const settings& with, S h)
                : frame(c.normal) {
                const body& a = bodies[c.body_a];
                const body& b = bodies[c.body_b];
                if constexpr (Features::rolling_resistance)
                    if (of.rolling_resistance_of(c) > S(0)) rolling = {a, b, frame};
                for (int k = 0; k < c.count; ++k) {
                    const levers<S, D> to = c.levers(k);
                    rows[k] = {{a, b, to, frame},
                               detail::effective_mass(a, b, to, c.normal),
                               target_speed(c, k, of, a, b, with, h)};
                }
            }
        };

        /// Apart, the surfaces may close the gap; overlapping, they part slowly; a bounce parts them with its
        /// share of the approach.
        static S target_speed(const contact& c, int k, [[maybe_unused]] surfaces of, const body& a, const body& b,
                              const settings& with, S h) {
            const S separation = c.points[k].separation;
            S target = -separation / h;
            if (separation < S(0)) {
                const S overlap = max(-separation - with.penetration_slop, S(0));
                target = min(overlap * with.baumgarte / h, with.max_push_speed);
            }
            if constexpr (Features::restitution) {
                const S bounce = detail::bounce_of(c, k, of.restitution_of(c), a, b, with.restitution_slop, h);
                if (bounce > S(0)) target = max(target, bounce);
            }
            return target;
        }

        static void warm_start(const contact& c, [[maybe_unused]] surfaces of, const block& with,
                               bodies_type bodies) {
            for (int k = 0; k < c.count; ++k) {
                const auto& p = c.points[k];
                const auto [to_a, to_b] = c.levers(k);
                if (!c.persisted(k)) continue;
                vec<S, D> impulse = c.normal * p.normal_impulse;
                if constexpr (Features::friction) impulse += with.frame.combine(p.friction_impulse);
                bodies[c.body_a].apply(-impulse, to_a);
                bodies[c.body_b].apply(impulse, to_b);
            }
            if constexpr (Features::rolling_resistance)
                if (of.rolling_resistance_of(c) > S(0))
                    turn(with, c.rolling_impulse, bodies[c.body_a], bodies[c.body_b]);
        }
        /// An angular impulse against rolling, from A on B.
        static void turn(const block& with, tangential<S, D> impulse, body& a, body& b) {
            const angular<S, D> moment = with.rolling.combine(with.frame, impulse);
            a.velocity.angular -= times(a.inverse_inertia, moment);
            b.velocity.angular += times(b.inverse_inertia, moment);
        }
        static void resist_rolling(contact& c, S resistance, const block& with, body& a, body& b) {
            S load = S(0);
            for (int k = 0; k < c.count; ++k) load += c.points[k].normal_impulse;
            const auto w = with.rolling.components(with.frame, b.velocity.angular - a.velocity.angular);
            const auto impulse = with.rolling.next(c.rolling_impulse, w, resistance * load);
            turn(with, impulse - c.rolling_impulse, a, b);
            c.rolling_impulse = impulse;
        }

        static void solve_contact(contact& c, [[maybe_unused]] surfaces of, const block& with, bodies_type bodies,
                                  bool back) {
            body& a = bodies[c.body_a];
            body& b = bodies[c.body_b];
            if constexpr (Features::rolling_resistance)
                if (const S resistance = of.rolling_resistance_of(c); resistance > S(0))
                    resist_rolling(c, resistance, with, a, b);
            if constexpr (Features::friction) {
                const auto& frame = with.frame;
                for (int i = 0; i < c.count; ++i) {
                    const int k = back ? c.count - 1 - i : i;
                    auto& p = c.points[k];
                    const auto [to_a, to_b] = c.levers(k);
                    const vec<S, D> v = velocity_at(b.velocity, to_b) - velocity_at(a.velocity, to_a);
                    auto slip = frame.components(v);
                    if constexpr (Features::surface_velocity) slip -= c.surface_velocity;
                    const auto impulse =
                        with.rows[k].friction.next(p.friction_impulse, slip, of.friction_of(c) * p.normal_impulse);
                    const vec<S, D> change = frame.combine(impulse - p.friction_impulse);
                    p.friction_impulse = impulse;
                    a.apply(-change, to_a);
                    b.apply(change, to_b);
                }
            }
            // Normals last: not sinking in matters more than not sliding. Across and back, because the points of
            // one contact depend on each other the most: what they leave open lets a stack sway.
            const int visits = 2 * c.count - 1;
            for (int i = 0; i < visits; ++i) {
                const int across = i < c.count ? i : visits - 1 - i;
                const int k = back ? c.count - 1 - across : across;
                auto& p = c.points[k];
                const auto [to_a, to_b] = c.levers(k);
                const vec<S, D> v = velocity_at(b.velocity, to_b) - velocity_at(a.velocity, to_a);
                const S impulse = max(
                    p.normal_impulse + with.rows[k].normal_mass * (with.rows[k].target_speed - dot(c.normal, v)), S(0));
                const vec<S, D> change = c.normal * (impulse - p.normal_impulse);
                p.normal_impulse = impulse;
                a.apply(-change, to_a);
                b.apply(change, to_b);
            }
        }
    };
};

PHYSICS_HPP_END
