// Contacts: manifolds in the world, with what is remembered of them from step to step.
#pragma once

#include "physics/base/buffer.hpp"
#include "physics/broadphase/concept.hpp"
#include "physics/collide/manifold.hpp"
#include "physics/dynamics/edge.hpp"
#include "physics/dynamics/material.hpp"

PHYSICS_HPP_BEGIN

/// What acts along the tangents of a contact: one number in 2D, two in 3D.
template <class S, int D>
using tangential = std::conditional_t<D == 2, S, vec<S, 2>>;

namespace solver_api {

/// Levers from the centres of mass of A and B to a point, in world axes (m).
template <class S, int D>
struct anchors {
    vec<S, D> a, b;
};

/// One point of a contact.
template <class S, int D, class Features = without<>>
struct contact_point {
    /// From the origin of shape A, in world axes (m).
    vec<S, D> position;
    /// Distance of the surfaces along the normal (m); negative where they overlap.
    S separation{};
    /// Sum of the impulses of the last step along the normal, at least 0, and along the tangents (N s).
    S normal_impulse{};
    [[no_unique_address]] detail::optional_member<Features::friction, tangential<S, D>, feature::friction>
        friction_impulse{};
    /// What the next step begins with: the impulse along the normal of the last substep, where a solver takes several;
    /// of a usual one, where steps differ in length (N s).
    S substep_impulse{};
    std::uint32_t feature = 0;
    PHYSICS_HPP_MEMBERS(position, separation, normal_impulse, friction_impulse, substep_impulse, feature)
};

/// Two shapes of different bodies that touch or are about to. Without a feature it lacks what belongs to that.
template <class S, int D, class Features = without<>>
struct contact {
    /// Numbers of the shapes; the normal points from A to B.
    std::uint32_t shape_a, shape_b;
    edge bodies;
    /// Which part of a concave shape touches; 0 of convex ones.
    std::uint32_t part = 0;
    vec<S, D> normal;
    /// From the centre of mass of either body to the origin of shape A, in world axes (m).
    vec<S, D> r_a, r_b;
    std::uint8_t count = 0;
    /// Of each point a bit: 1 if the same features touched in the step before.
    std::uint8_t persisted_mask = 0;
    /// Whether the shapes touch as the step ends, and of each point a bit: 1 if it bore something as the step began.
    /// Known where the recipe asks for such events.
    bool touching = false;
    std::uint8_t loaded_mask = 0;
    contact_point<S, D, Features> points[manifold<S, D>::capacity] = {};
    /// Of both surfaces together. A contact_constraints tells them also where all contacts have them in common.
    [[no_unique_address]] detail::coefficient_of_contact<Features::friction, S, feature::friction, Features> friction{};
    [[no_unique_address]] detail::coefficient_of_contact<Features::restitution, S, feature::restitution, Features>
        restitution{};
    [[no_unique_address]] detail::coefficient_of_contact<Features::rolling_resistance, S, feature::rolling_resistance,
                                                         Features>
        rolling_resistance{};
    /// How fast B slides over A along the tangents where the surfaces themselves do not slip (m/s).
    [[no_unique_address]] detail::optional_member<Features::surface_velocity, tangential<S, D>,
                                                  feature::surface_velocity>
        surface_velocity{};
    /// Angular impulse of friction about the normal, where the solver lets contacts resist twisting (N m s).
    [[no_unique_address]] detail::optional_member<Features::friction && D == 3, S, feature::friction, 1>
        twist_impulse{};
    /// In 2D, friction of the last substep, where a solver takes several: what the next step begins with (N s).
    [[no_unique_address]] detail::optional_member<Features::friction && D == 2, S, feature::friction, 2>
        substep_friction{};
    /// Angular impulse that resists rolling: about z in 2D, about both tangents in 3D (N m s).
    [[no_unique_address]] detail::optional_member<Features::rolling_resistance, tangential<S, D>,
                                                  feature::rolling_resistance, 1>
        rolling_impulse{};
    PHYSICS_HPP_MEMBERS(shape_a, shape_b, bodies, part, normal, r_a, r_b, count, persisted_mask, touching, loaded_mask,
                        points, friction, restitution, rolling_resistance, surface_velocity, twist_impulse,
                        substep_friction, rolling_impulse)

    [[nodiscard]] constexpr solver_api::anchors<S, D> anchors(int k) const {
        return {r_a + points[k].position, r_b + points[k].position};
    }
    [[nodiscard]] constexpr bool persisted(int k) const { return (persisted_mask >> k & 1) != 0; }
    [[nodiscard]] constexpr proxy_pair key() const {
        return shape_a < shape_b ? proxy_pair{shape_a, shape_b} : proxy_pair{shape_b, shape_a};
    }
};

}  // namespace solver_api

/// The tangent of a contact normal in 2D.
template <class S>
struct tangents2 {
    vec<S, 2> t;

    constexpr explicit tangents2(vec<S, 2> normal) : t(perpendicular(normal)) {}
    [[nodiscard]] constexpr S components(vec<S, 2> v) const { return dot(t, v); }
    [[nodiscard]] constexpr vec<S, 2> combine(S along) const { return t * along; }
};
/// The same in 3D.
template <class S>
struct tangents3 {
    vec<S, 3> t, u;

    constexpr explicit tangents3(vec<S, 3> n) {
        // The branch keeps the longer of two candidates, so that its length is at least sqrt(1/2).
        const bool flat = abs(n.x) > abs(n.z);
        const S from = flat ? n.y : n.z, to = flat ? n.x : n.y;
        const S size = root<S>(product(from, from) + product(to, to)), back = -from / size, on = to / size;
        t = flat ? vec<S, 3>{back, on, S(0)} : vec<S, 3>{S(0), back, on};
        u = cross(n, t);
    }
    [[nodiscard]] constexpr vec<S, 2> components(vec<S, 3> v) const { return {dot(t, v), dot(u, v)}; }
    [[nodiscard]] constexpr vec<S, 3> combine(vec<S, 2> along) const { return t * along.x + u * along.y; }
};
/// The tangents of a contact normal in D dimensions.
template <class S, int D>
using tangents = std::conditional_t<D == 2, tangents2<S>, tangents3<S>>;

namespace solver_api {

/// How fast B slides over A along the tangents where neither surface slips, of how the surfaces run and are turned.
template <class S>
constexpr S relative_surface_velocity(const tangents2<S>&, const rotation<S, 2>&, S of_a, const rotation<S, 2>&,
                                      S of_b) {
    // Seen from outside of B, the tangent points the other way.
    return of_a + of_b;
}
template <class S>
constexpr vec<S, 2> relative_surface_velocity(const tangents3<S>& frame, const rotation<S, 3>& turn_a, vec<S, 3> of_a,
                                              const rotation<S, 3>& turn_b, vec<S, 3> of_b) {
    return frame.components(turn_a * of_a - turn_b * of_b);
}

/// Hands the impulse of the same feature in an old contact to a point; true if there is one.
template <class S, int D, class Features>
bool inherit_impulse(const contact<S, D, Features>& old, const tangents<S, D>& old_frame, const tangents<S, D>& frame,
                     contact_point<S, D, Features>& point) {
    for (int j = 0; j < old.count; ++j) {
        if (old.points[j].feature != point.feature) continue;
        point.normal_impulse = old.points[j].normal_impulse;
        point.substep_impulse = old.points[j].substep_impulse;
        if constexpr (Features::friction)
            point.friction_impulse = frame.components(old_frame.combine(old.points[j].friction_impulse));
        return true;
    }
    return false;
}

/// What resisted rolling about old tangents, about new ones; in 2D they all turn about z.
template <class S>
constexpr S same_moment(const tangents2<S>&, const tangents2<S>&, S moment) {
    return moment;
}
template <class S>
constexpr vec<S, 2> same_moment(const tangents3<S>& old, const tangents3<S>& frame, vec<S, 2> moment) {
    return frame.components(old.combine(moment));
}

/// Hands the impulses of the same features in an old contact to a contact, whose surfaces resist rolling or do not.
template <class S, int D, class Features>
void inherit_impulses(const contact<S, D, Features>& old, const tangents<S, D>& frame, contact<S, D, Features>& c,
                      [[maybe_unused]] const detail::combined_material<S, Features>& surfaces) {
    const tangents<S, D> old_frame(old.normal);
    const std::uint8_t before = c.persisted_mask;
    for (int k = 0; k < c.count; ++k)
        if (!c.persisted(k) && inherit_impulse(old, old_frame, frame, c.points[k]))
            c.persisted_mask = static_cast<std::uint8_t>(c.persisted_mask | 1 << k);
    if (c.persisted_mask == before) return;
    if constexpr (Features::friction && D == 3) c.twist_impulse = old.twist_impulse;
    if constexpr (Features::friction && D == 2) {
        // Of points that are gone the friction is gone too, as their load is.
        S kept = S(0), all = S(0);
        for (int k = 0; k < c.count; ++k)
            if (((c.persisted_mask & ~before) >> k & 1) != 0) kept += c.points[k].substep_impulse;
        for (int k = 0; k < old.count; ++k) all += old.points[k].substep_impulse;
        const S share = kept < all ? kept / all : S(1);
        c.substep_friction += frame.components(old_frame.combine(old.substep_friction)) * share;
    }
    if constexpr (Features::rolling_resistance)
        if (surfaces.rolling_resistance_of(c) > S(0))
            c.rolling_impulse = same_moment(old_frame, frame, old.rolling_impulse);
}

/// The load of a step with that of one more substep, or less what a bounce took of it. In fixed point, less than 0 for
/// good once it has left the range.
template <class S>
constexpr S added_load(S total, S load) {
    const S sum = total + load;
    if constexpr (detail::is_fixed<S>)
        if (total < S(0) || (load > S(0) && sum < total)) return S(-1);
    return sum;
}

/// What impulses of a step of one length are multiplied with to begin one of another, at most by so much: they hold
/// loads, which a longer step holds by larger ones. Never nothing, so that loads outlive steps of microseconds.
template <class S>
constexpr S impulse_ratio(S from, S to, S maximum = S(128)) {
    if (to >= from) return to > from * maximum ? maximum : to / from;
    const S minimum = S(0x1p-20);
    return to > from * minimum ? to / from : minimum;
}

/// Of what length the steps are in which impulses act (s): loads in usual ones, all others in the last one.
template <class S>
struct step_lengths {
    S usual{}, last{};

    friend bool operator==(step_lengths, step_lengths) = default;
};

/// Scales the impulses of contacts from a step of one length to one of another, loads at most by so much.
template <class S, int D, class Features>
void rescale_impulses(contact<S, D, Features>* first, const contact<S, D, Features>* end, step_lengths<S> from,
                      step_lengths<S> to, S maximum = S(128)) {
    if (!(from.usual > S(0)) || from == to) return;
    const S ratio = impulse_ratio(from.usual, to.usual, maximum);
    // Friction and resistance to rolling of a single short step are noise, and not scaled up.
    const S others = min(impulse_ratio(from.last, to.last, maximum), max(ratio, S(1)));
    for (; first != end; ++first) {
        // A substep's friction is noisier than its load: where that is scaled up, columns are shaken.
        if constexpr (Features::friction && D == 2) first->substep_friction *= min(others, S(1));
        if constexpr (Features::friction && D == 3) first->twist_impulse *= others;
        if constexpr (Features::rolling_resistance) first->rolling_impulse *= others;
        for (int k = 0; k < first->count; ++k) {
            contact_point<S, D, Features>& p = first->points[k];
            p.normal_impulse *= others;
            if constexpr (Features::friction) p.friction_impulse *= others;
            p.substep_impulse *= ratio;
        }
    }
}

/// Hands the impulses of last step's contacts to the same features of some of this step's. Both lists are in ascending
/// order of their pairs, so one walk along both finds the matches: O(n), no hashing; a pair of several contacts is
/// searched whole. Points that are new start from zero: only what outlives a step is warm.
template <class S, int D, class Features>
void inherit_impulses(const buffer<contact<S, D, Features>>& before, contact<S, D, Features>* first,
                      const contact<S, D, Features>* end, const detail::combined_material<S, Features>& surfaces = {}) {
    if (first == end) return;
    std::uint32_t i = detail::count_before(before, [&](const auto& c) { return c.key() < first->key(); });
    for (; first != end; ++first) {
        while (i < before.size() && before[i].key() < first->key()) ++i;
        if (i == before.size()) return;
        const tangents<S, D> frame(first->normal);
        for (std::uint32_t n = i; n < before.size() && before[n].key() == first->key(); ++n)
            inherit_impulses(before[n], frame, *first, surfaces);
    }
}

}  // namespace solver_api

PHYSICS_HPP_END
