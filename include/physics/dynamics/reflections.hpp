// Impacts of surfaces with restitution: all that approach are reflected at once, again until none does.
#pragma once

#include <bit>

#include "physics/base/arena.hpp"
#include "physics/dynamics/friction.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A sum of doubles that does not depend on their order, so that what is symmetric stays so: whole multiples of a power
/// of two far below the largest one. First show() all terms, then add() them. Source: Demmel, Nguyen, Fast Reproducible
/// Floating-Point Summation (2013).
class unordered_sum {
public:
    void show(double x) {
        maximum_ = max(maximum_, abs(x));
        ++count_;
    }
    void add(double x) {
        const double share = x / unit() * multiples();
        if (abs(share) < 0x1p62) sum_ += static_cast<std::int64_t>(share < 0 ? share - 0.5 : share + 0.5);
    }
    /// Not a number where a term is none.
    [[nodiscard]] double total() const {
        return is_finite(maximum_) ? static_cast<double>(sum_) / multiples() * unit() : maximum_ - maximum_;
    }

private:
    /// The power of two below the largest term; where that is so small that quotients overflow, a larger one.
    [[nodiscard]] double unit() const {
        constexpr std::uint64_t exponent = 0x7ff0000000000000;
        return detail::bit_cast<double>(detail::bit_cast<std::uint64_t>(max(maximum_, 0x1p-500)) & exponent);
    }
    /// All terms together stay below 2^62.
    [[nodiscard]] double multiples() const {
        return static_cast<double>(std::uint64_t{1} << (61 - std::bit_width(count_)));
    }

    double maximum_ = 0;
    std::int64_t sum_ = 0;
    std::uint32_t count_ = 0;
};

/// What bounces do to a point in a substep: their impulses along the normal, and how fast the surfaces may still
/// approach, since that is rounding.
template <class S>
struct bounce {
    S impulse{}, rounding{};
};

/// The phase of a substep in which surfaces bounce. Points that approach faster than the slop, and would meet within
/// the substep, are taken together where they share bodies: each wishes for the impulse that would stop it alone, and
/// the sum acts, scaled so that restitution 1 keeps the kinetic energy exactly. That is repeated with whatever
/// approaches then, until nothing does or for some rounds; the rest is left to the solver of resting contacts.
/// Momentum, angular momentum and mirror symmetry are kept to rounding, whatever the order of contacts; energy never
/// rises. Bodies meet at the velocities of the middle of the substep, with half of its acceleration, so that bounces
/// are exact in free fall. Cost: a walk over the points with restitution a round. Source: Smith, Kaufman, Vouga,
/// Tamstorf, Grinspun, Reflections on Simultaneous Impact (SIGGRAPH 2012), with the answer to one Jacobi step in place
/// of a projection.
template <class S, int D, class Features>
class reflections {
    static constexpr bool rotates = Features::rotation;
    using body = solver_body<S, D, rotates>;
    using bodies_type = solver_bodies<S, D, rotates>;
    using contact = solver_api::contact<S, D, Features>;
    using twist_type = twist_of<S, D, rotates>;

public:
    reflections(bodies_type bodies, std::uint32_t capacity, arena& scratch) : bodies_(bodies) {
        if (capacity == 0) return;
        points_ = scratch.template allocate<point>(capacity);
        hits_ = scratch.template allocate<std::uint32_t>(capacity);
        touched_ = scratch.template allocate<std::uint32_t>(bodies.count);
        responses_ = scratch.template allocate<twist_type>(bodies.count);
        nodes_ = scratch.template allocate<node>(bodies.count);
        for (std::uint32_t i = 0; i < bodies.count; ++i) new (nodes_ + i) node{};
    }
    /// Point k of a contact bounces with this restitution; `given` tells in each substep what that does.
    void add(const contact& c, const body_pair& bodies, int k, S restitution, S effective_mass, bounce<S>& given) {
        const anchors<S, D> to = c.anchors(k);
        const bool driven = drives(bodies_[bodies.a]) || drives(bodies_[bodies.b]);
        new (points_ + count_++) point{&c,
                                       bodies,
                                       &given,
                                       k,
                                       {without_noise(to.a, c.normal), without_noise(to.b, c.normal)},
                                       effective_mass,
                                       restitution,
                                       {},
                                       {},
                                       {},
                                       {},
                                       driven,
                                       c.persisted(k) && c.points[k].separation < S(0)};
    }
    [[nodiscard]] bool any() const { return count_ > 0; }
    /// After velocities have advanced by a substep of h, and by as much as that drives bodies.
    void solve(const twist_type* driven, S slop, S h, int rounds) {
        for (std::uint32_t i = 0; i < count_; ++i) begin(points_[i], driven);
        for (round_ = 1; round_ <= static_cast<std::uint32_t>(rounds) && find_hits(slop, h); ++round_) reflect();
        for (std::uint32_t i = 0; i < bodies_.count; ++i) nodes_[i].round = 0;
    }

    /// Whether a body pushes without being pushed.
    [[nodiscard]] static bool drives(const body& b) {
        return !(b.inverse_mass > inverse_of<S>(0)) && !(b.velocity == twist_type{});
    }
    /// How far apart the surfaces are at point k of a contact, as its bodies have come in this step.
    [[nodiscard]] static S separation_of(const contact& c, const body_pair& of, int k, bodies_type bodies) {
        const auto [to_a, to_b] = c.anchors(k);
        const vec<S, D> shift =
            velocity_at(bodies[of.b].displacement, to_b) - velocity_at(bodies[of.a].displacement, to_a);
        return c.points[k].separation + dot(c.normal, shift);
    }

private:
    struct point {
        const contact* of;
        body_pair bodies;
        bounce<S>* given;
        int number;
        anchors<S, D> to;
        S mass, restitution;
        /// The gap, and how much half of the substep's acceleration adds to the speed of parting.
        S gap, half_acceleration;
        S approach, impulse;
        /// One of the bodies drives the other: it strikes once a step, and not what it already has in its jaws.
        bool driven, struck;
    };
    /// What one round needs to know of a body, and of the group of bodies that it stands for.
    struct node {
        std::uint32_t round, parent, hits;
        double share;
        unordered_sum linear[D], angular[D == 2 ? 1 : 3];
        /// The work of the impulses that would stop each point alone, of those that act, and of their answers.
        unordered_sum stopping, acting, response_work;
    };

    /// A lever along the normal turns nothing: what rounding makes of it would.
    static vec<S, D> without_noise(vec<S, D> anchor, vec<S, D> normal) {
        const S reach = dot(anchor, normal);
        const vec<S, D> across = anchor - normal * reach;
        S maximum = S(0);
        for (int i = 0; i < D; ++i) maximum = max(maximum, abs(across[i]));
        return maximum > scalar_traits<S>::epsilon() * S(32) * max(abs(reach), S(1)) ? anchor : vec<S, D>{};
    }
    [[nodiscard]] vec<S, D> slip(const point& p, const twist_type& a, const twist_type& b) const {
        return velocity_at(b, p.to.b) - velocity_at(a, p.to.a);
    }
    void begin(point& p, const twist_type* driven) {
        *p.given = {};
        p.gap = separation_of(*p.of, p.bodies, p.number, bodies_);
        p.half_acceleration = dot(p.of->normal, slip(p, driven[p.bodies.a], driven[p.bodies.b])) * S(0.5);
    }
    bool find_hits(S slop, S h) {
        hit_count_ = 0;
        for (std::uint32_t i = 0; i < count_; ++i) {
            point& p = points_[i];
            const vec<S, D> v = slip(p, bodies_[p.bodies.a].velocity, bodies_[p.bodies.b].velocity);
            const S parting = dot(p.of->normal, v);
            if (!(p.gap + parting * h < S(0)) || (p.driven && p.struck)) continue;
            p.approach = p.half_acceleration - parting;
            S size = S(0);
            for (int k = 0; k < D; ++k) size += abs(v[k]);
            p.given->rounding = size * (scalar_traits<S>::epsilon() * S(64));
            // What acceleration brings about within a substep is rest, no impact.
            if (!(p.approach > max(max(slop, p.given->rounding), p.half_acceleration * S(-2)))) continue;
            hits_[hit_count_++] = i;
            p.struck = true;
        }
        return hit_count_ > 0;
    }

    [[nodiscard]] bool moves(std::uint32_t i) const { return bodies_[i].inverse_mass > inverse_of<S>(0); }
    std::uint32_t root_of(std::uint32_t i) {
        while (nodes_[i].parent != i) i = nodes_[i].parent = nodes_[nodes_[i].parent].parent;
        return i;
    }
    node& group_of(const point& p) { return nodes_[root_of(moves(p.bodies.a) ? p.bodies.a : p.bodies.b)]; }
    void touch(std::uint32_t i) {
        if (nodes_[i].round == round_) return;
        nodes_[i] = node{};
        nodes_[i].round = round_;
        nodes_[i].parent = i;
        touched_[touched_count_++] = i;
    }
    /// Calls f with the sums of both bodies of a point, and the terms that its impulse adds to them.
    template <class F>
    void each_term(const point& p, F&& f) {
        const vec<S, D> impulse = p.of->normal * p.impulse;
        for (const bool is_b : {false, true}) {
            const std::uint32_t i = is_b ? p.bodies.b : p.bodies.a;
            if (!moves(i)) continue;
            node& n = nodes_[i];
            const double sign = is_b ? 1 : -1;
            for (int k = 0; k < D; ++k) f(n.linear[k], sign * to_double(impulse[k]));
            if constexpr (rotates) {
                const auto moment = cross(is_b ? p.to.b : p.to.a, impulse);
                if constexpr (D == 2) f(n.angular[0], sign * to_double(moment));
                else
                    for (int k = 0; k < 3; ++k) f(n.angular[k], sign * to_double(moment[k]));
            }
        }
    }
    /// The change of a body's velocity by a share of the impulses that it is given.
    [[nodiscard]] twist_type response_of(std::uint32_t i, double share) const {
        const node& n = nodes_[i];
        body b{};
        b.inverse_mass = bodies_[i].inverse_mass;
        vec<S, D> impulse;
        for (int k = 0; k < D; ++k) impulse[k] = S(n.linear[k].total() * share);
        b.apply(impulse, {});
        if constexpr (rotates) {
            const auto& inverse = bodies_[i].inverse_inertia;
            if constexpr (D == 2) {
                b.velocity.angular = times(inverse, S(n.angular[0].total() * share));
            } else {
                vec<S, 3> moment;
                for (int k = 0; k < 3; ++k) moment[k] = S(n.angular[k].total() * share);
                b.velocity.angular = times(inverse, moment);
            }
        }
        return b.velocity;
    }
    /// Calls f with the sums of a point's group, and the terms that the point adds to them.
    template <class F>
    void each_work(const point& p, F&& f) {
        const twist_type none{};
        const std::uint32_t a = p.bodies.a, b = p.bodies.b;
        const S response = dot(p.of->normal, slip(p, moves(a) ? responses_[a] : none, moves(b) ? responses_[b] : none));
        const double impulse = to_double(p.impulse), work = impulse * to_double(p.approach);
        node& group = group_of(p);
        f(group.stopping, 2 * work / (1 + to_double(p.restitution)));
        f(group.acting, work);
        f(group.response_work, impulse * to_double(response));
    }
    /// Where all of a group have the same restitution, its impulses leave as much energy as that says; else no more
    /// than before.
    static void find_share(node& group) {
        const double response_work = group.response_work.total(), stopping = group.stopping.total();
        const double acting = group.acting.total();
        if (group.hits == 1) group.share = 2;
        else group.share = response_work > 0 && stopping > 0 ? 2 * (acting / response_work) * (acting / stopping) : 0;
    }
    /// Reflects all hits at once.
    void reflect() {
        touched_count_ = 0;
        for (std::uint32_t i = 0; i < hit_count_; ++i) {
            point& p = points_[hits_[i]];
            p.impulse = p.mass * p.approach * (S(0.5) + p.restitution * S(0.5));
            const std::uint32_t a = p.bodies.a, b = p.bodies.b;
            if (moves(a)) touch(a);
            if (moves(b)) touch(b);
            if (moves(a) && moves(b)) nodes_[root_of(a)].parent = root_of(b);
            each_term(p, [](unordered_sum& sum, double x) { sum.show(x); });
        }
        for (std::uint32_t i = 0; i < hit_count_; ++i)
            each_term(points_[hits_[i]], [](unordered_sum& sum, double x) { sum.add(x); });
        for (std::uint32_t i = 0; i < touched_count_; ++i) responses_[touched_[i]] = response_of(touched_[i], 1);
        for (std::uint32_t i = 0; i < hit_count_; ++i) {
            ++group_of(points_[hits_[i]]).hits;
            each_work(points_[hits_[i]], [](unordered_sum& sum, double x) { sum.show(x); });
        }
        for (std::uint32_t i = 0; i < hit_count_; ++i)
            each_work(points_[hits_[i]], [](unordered_sum& sum, double x) { sum.add(x); });
        for (std::uint32_t i = 0; i < touched_count_; ++i) find_share(nodes_[touched_[i]]);
        for (std::uint32_t i = 0; i < touched_count_; ++i) {
            const std::uint32_t k = touched_[i];
            auto& v = bodies_[k].velocity;
            v = v + response_of(k, nodes_[root_of(k)].share);
        }
        for (std::uint32_t i = 0; i < hit_count_; ++i) {
            const point& p = points_[hits_[i]];
            p.given->impulse += S(to_double(p.impulse) * group_of(p).share);
        }
    }

    bodies_type bodies_;
    point* points_ = nullptr;
    std::uint32_t *hits_ = nullptr, *touched_ = nullptr;
    twist_type* responses_ = nullptr;
    node* nodes_ = nullptr;
    std::uint32_t count_ = 0, hit_count_ = 0, touched_count_ = 0, round_ = 0;
};

}  // namespace detail

PHYSICS_HPP_END
