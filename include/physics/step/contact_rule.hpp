// Contact rules: a recipe's own word on which contacts hold, and by what coefficients.
#pragma once

#include "physics/step/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The manifolds of one pair, of which nothing is remembered.
template <class Plan>
void collide_once(const typename Plan::query& query, typename Plan::scalar margin,
                  manifold_list<typename Plan::scalar, Plan::dimension>& to) {
    to.clear();
    if constexpr (Plan::remembers) Plan::narrowphase::collide(&query, 1, margin, nullptr, to);
    else Plan::narrowphase::collide(&query, 1, margin, to);
}

}  // namespace detail

/// One of the two shapes of a contact_candidate.
template <class S, int D>
struct contact_side {
    shape_id shape;
    body_id body;
    /// What users have given the shape and its body.
    std::uint64_t shape_data = 0, body_data = 0;
    body_type type = body_type::static_body;
    /// Of the shape, as the step begins.
    transform<S, D> pose;
    bool one_way = false;
};

/// A contact that a step has found and not solved yet, as a contact rule sees it: `static bool accept(candidate)` of a
/// policy says whether it holds. Several threads may ask at once, in no order: what it answers must follow from the
/// candidate alone, and it must not throw. A sweep asks about what a body would pass into within the step, at no
/// overlap and with the velocities of centres of mass.
template <class Plan>
class contact_candidate {
public:
    using scalar = typename Plan::scalar;
    static constexpr int dimension = Plan::dimension;
    using vec = physics::vec<scalar, dimension>;
    using side = contact_side<scalar, dimension>;
    /// What it is told from.
    struct context {
        const pool<typename Plan::body>& bodies;
        const detail::shape_pool<Plan>& shapes;
        /// What held before, in ascending order of pairs.
        const buffer<typename Plan::contact>& before;
        scalar margin, h;
        std::uint16_t tag;
        /// To look again; null of sweeps, which see what is met.
        manifold_list<scalar, dimension>* scratch = nullptr;
    };

    contact_candidate(const context& in, typename Plan::contact& c)
        : in_(in), contact_(&c), a_(c.shape_a), b_(c.shape_b), normal_(c.normal) {
        int deepest = 0;
        for (int k = 1; k < c.count; ++k)
            if (c.points[k].separation < c.points[deepest].separation) deepest = k;
        separation_ = c.points[deepest].separation;
        anchor_a_ = c.anchors(deepest).a;
        anchor_b_ = c.anchors(deepest).b;
    }
    /// Of a body that would pass into another within the step.
    contact_candidate(const context& in, std::uint32_t a, std::uint32_t b, vec normal, scalar separation)
        : in_(in), a_(a), b_(b), normal_(normal), separation_(separation) {}

    /// Both shapes, in no order.
    [[nodiscard]] side a() const { return side_of(a_); }
    [[nodiscard]] side b() const { return side_of(b_); }
    /// Unit normal from A to B.
    [[nodiscard]] vec normal() const { return normal_; }
    /// Distance of the surfaces along it at the deepest point (m); negative where they overlap.
    [[nodiscard]] scalar separation() const { return separation_; }
    /// How fast they approach each other there as the step begins (m/s).
    [[nodiscard]] scalar approach_speed() const {
        return dot(normal_, velocity_of(a_, anchor_a_) - velocity_of(b_, anchor_b_));
    }
    /// Whether the shapes had a contact in the step before.
    [[nodiscard]] bool is_persisted() const {
        const proxy_pair pair = a_ < b_ ? proxy_pair{a_, b_} : proxy_pair{b_, a_};
        const auto& list = in_.before;
        const std::uint32_t i = detail::count_before(list, [&](const auto& c) { return c.key() < pair; });
        return i < list.size() && list[i].key() == pair;
    }
    /// Calls f(normal, separation) for contacts that the shapes had a step ago, if they have moved since as they do now
    /// at the deepest point. One query of the narrowphase.
    template <class F>
    void each_before(F&& f) const {
        if (in_.scratch == nullptr) return;
        const auto &a = in_.shapes[a_], &b = in_.shapes[b_];
        const vec back = (velocity_of(a_, anchor_a_) - velocity_of(b_, anchor_b_)) * in_.h;
        auto there = b.pose;
        there.position += back;
        const typename Plan::query query{&a.shape, &b.shape, relative(a.pose, there)};
        detail::collide_once<Plan>(query, in_.margin + length(back), *in_.scratch);
        for (const auto& [number, part, m] : *in_.scratch)
            for (int k = 0; k < m.count; ++k) f(a.pose.rotation * m.normal, m.points[k].separation);
    }
    /// The step's length (s) and the world's contact margin (m).
    [[nodiscard]] scalar step_length() const { return in_.h; }
    [[nodiscard]] scalar contact_margin() const { return in_.margin; }

    /// Coefficients of both surfaces together, for this step only; at least 0, else the step is refused.
    void set_friction(scalar x) requires(Plan::features::materials&& Plan::features::friction) {
        if (contact_) contact_->friction = x;
    }
    void set_restitution(scalar x) requires(Plan::features::materials&& Plan::features::restitution) {
        if (contact_) contact_->restitution = x;
    }

private:
    [[nodiscard]] side side_of(std::uint32_t i) const {
        const auto& shape = in_.shapes[i];
        const auto& body = in_.bodies[shape.body];
        return {{i, in_.shapes.generation(i), in_.tag},
                {shape.body, in_.bodies.generation(shape.body), in_.tag},
                shape.user_data,
                body.user_data,
                body.type,
                shape.pose,
                shape.one_way};
    }
    [[nodiscard]] vec velocity_of(std::uint32_t shape, const vec& anchor) const {
        return velocity_at(in_.bodies[in_.shapes[shape].body].velocity, anchor);
    }

    const context& in_;
    /// None yet of what a sweep asks about.
    typename Plan::contact* contact_ = nullptr;
    std::uint32_t a_, b_;
    vec normal_, anchor_a_, anchor_b_;
    scalar separation_;
};

/// All contacts hold.
struct no_contact_rule {
    using stage = physics::stage::contact_rule;
    template <class Candidate>
    static constexpr bool accept(const Candidate&) {
        return true;
    }
};

/// Shapes that are one_way hold only what comes from their upper side, the y axis of their frame, and let all else
/// pass: what has come in from below or from the side passes until it has left them. What they hold they hold until it
/// leaves, however it is pressed. To drop through, change a filter for as long as it takes. Method: the normal of the
/// contact and how deep it is when it is first seen, or was a step ago; no memory besides the contacts.
struct one_way_platforms {
    using stage = physics::stage::contact_rule;
    template <class Candidate>
    static bool accept(const Candidate& c) {
        const auto a = c.a(), b = c.b();
        return (!a.one_way || holds(c, a, c.normal())) && (!b.one_way || holds(c, b, -c.normal()));
    }

    /// Whether a normal out of a platform that stands so is one of its upper side.
    template <class S, int D>
    static bool is_above(const transform<S, D>& platform, const vec<S, D>& outwards) {
        vec<S, D> up;
        up.y = S(1);
        return dot(outwards, platform.rotation * up) > S(1.0 / 8);
    }
    /// Whether what is so far from its surface has come from there.
    template <class S>
    static bool is_outside(S separation, S contact_margin) {
        return separation > contact_margin * S(-1.0 / 4);
    }

private:
    template <class Candidate, class Vec>
    static bool holds(const Candidate& c, const typename Candidate::side& platform, const Vec& outwards) {
        using S = typename Candidate::scalar;
        if (!is_above(platform.pose, outwards)) return false;
        if (c.is_persisted() || is_outside(c.separation(), c.contact_margin())) return true;
        // What falls fast may be in it at once: it is looked at where it came from.
        const S fallen = max(c.approach_speed(), S(0)) * c.step_length();
        if (!is_outside(c.separation() + fallen, c.contact_margin())) return false;
        const S side = dot(outwards, c.normal());
        bool any = false, came_from_above = true;
        c.each_before([&](const auto& normal, S separation) {
            any = true;
            came_from_above =
                came_from_above && is_above(platform.pose, normal * side) && is_outside(separation, c.contact_margin());
        });
        return any && came_from_above;
    }
};

namespace detail {

template <class Plan>
bool accepts(contact_candidate<Plan>& c) {
    constexpr bool known = requires {
        { Plan::contact_rule::accept(c) } -> std::same_as<bool>;
    };
    static_assert(known,
                  "physics::recipe: the contact rule has no static accept(candidate) that answers a bool; see "
                  "contact_candidate");
    if constexpr (known) return Plan::contact_rule::accept(c);
    else return true;
}

}  // namespace detail

PHYSICS_HPP_END
