// Seams: where static shapes lie flush, what slides over them does not push at the next one's edge.
#pragma once

#include "physics/step/collide.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Leaves out contacts that a body would make with a static shape that is flush with the one it rests on. Where a body
/// sinks in by a hair, or contacts are looked for ahead of it, it would be stopped by the side or the corner of the
/// next shape; lifted out, it would pass. So those contacts go that a body would not have up to the end of the step if
/// it were lifted by what it has sunk in, and 1/512 of its thickness. O(contacts), and some queries of the narrowphase
/// for each in question.
template <class Plan>
class seam_contacts {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;
    using contact = typename Plan::contact;
    /// A body that goes farther in a step, in thicknesses, keeps its contacts.
    static constexpr int max_tests = 16;

public:
    seam_contacts(const collide_input<Plan>& in, const buffer<body_extent<S>>& extents, buffer<contact>& contacts,
                  manifold_list<S, D>& manifolds, arena& scratch)
        : in_(in), extents_(extents), contacts_(contacts), manifolds_(manifolds), scratch_(scratch) {}

    void drop() {
        const std::uint32_t count = in_.awake.size();
        support_ = scratch_.template allocate<std::uint32_t>(count);
        for (std::uint32_t i = 0; i < count; ++i) support_[i] = null_index;
        // Most bodies touch one static shape, or none.
        bool any = false;
        for (std::uint32_t i = 0; i < contacts_.size(); ++i) {
            const contact& c = contacts_[i];
            const auto [a, b] = awake_pair(c);
            if ((a < count) == (b < count)) continue;
            std::uint32_t& first = support_[a < count ? a : b];
            if (first == null_index) first = i;
            else any = any || other_shape(c) != other_shape(contacts_[first]);
        }
        if (!any) return;
        for (std::uint32_t i = 0; i < count; ++i) support_[i] = null_index;
        for (std::uint32_t i = 0; i < contacts_.size(); ++i) {
            const contact& c = contacts_[i];
            const std::uint32_t body = pushed_body(c);
            if (body == null_index || !(load_of(c) > S(0))) continue;
            std::uint32_t& support = support_[body];
            if (support == null_index || load_of(c) > load_of(contacts_[support])) support = i;
        }
        remove();
    }

private:
    [[nodiscard]] body_pair awake_pair(const contact& c) const {
        return {in_.awake.index_of[c.bodies.body_a], in_.awake.index_of[c.bodies.body_b]};
    }
    /// The number among awake bodies of the dynamic one, where the other is static; else null.
    [[nodiscard]] std::uint32_t pushed_body(const contact& c) const {
        const std::uint32_t count = in_.awake.size();
        const auto [a, b] = awake_pair(c);
        if ((a < count) == (b < count)) return null_index;
        const std::uint32_t other = a < count ? c.bodies.body_b : c.bodies.body_a;
        const std::uint32_t body = a < count ? a : b;
        if (in_.bodies[other].type != body_type::static_body || !in_.bodies[in_.awake[body]].is_dynamic())
            return null_index;
        return body;
    }
    [[nodiscard]] static S load_of(const contact& c) {
        S load = S(0);
        for (int k = 0; k < c.count; ++k)
            if (c.persisted(k)) load = max(load, c.points[k].normal_impulse);
        return load;
    }
    /// Out of the static shape.
    [[nodiscard]] vec<S, D> outwards(const contact& c) const {
        return in_.awake.has(c.bodies.body_a) ? -c.normal : c.normal;
    }
    [[nodiscard]] static S deepest(const contact& c) {
        S separation = c.points[0].separation;
        for (int k = 1; k < c.count; ++k) separation = min(separation, c.points[k].separation);
        return separation;
    }
    void remove() {
        // All are looked at before any moves.
        bool* const is_seam = scratch_.template allocate<bool>(contacts_.size());
        for (std::uint32_t i = 0; i < contacts_.size(); ++i) is_seam[i] = lies_on_seam(i);
        partition_contacts(
            contacts_, [&](const contact& c) { return !is_seam[&c - contacts_.begin()]; }, [](const contact&) {});
    }
    [[nodiscard]] bool lies_on_seam(std::uint32_t i) {
        const contact& c = contacts_[i];
        const std::uint32_t body = pushed_body(c);
        if (body == null_index || support_[body] == null_index || support_[body] == i) return false;
        const contact& support = contacts_[support_[body]];
        if (other_shape(c) == other_shape(support)) return false;
        const vec<S, D> up = outwards(support), n = outwards(c);
        // Alike, both carry it.
        const S alike = dot(n, up);
        const vec<S, D> across = n - up * alike;
        if (!(largest(across) > S(1.0 / 256)) || alike < S(-1.0 / 64)) return false;
        const vec<S, D> v = in_.bodies[in_.awake[body]].velocity_ahead(in_.h).linear;
        if (!(deepest(c) + min(dot(n, v), S(0)) * in_.h < S(0))) return false;
        const S thickness = extents_[in_.awake[body]].thickness;
        const vec<S, D> along = v * in_.h - up * min(dot(v, up) * in_.h, S(0));
        const S distance = length(along);
        if (!(distance * S(1.0 / max_tests) < thickness)) return false;
        const S lift = max(-deepest(support), S(0)) + thickness * S(1.0 / 512);
        // No thin shape is between two places.
        for (S at = min(distance, thickness);; at = min(at + thickness, distance)) {
            if (would_touch(c, (distance > S(0) ? along * (at / distance) : along) + up * lift)) return false;
            if (!(at < distance)) break;
        }
        // Nor farther on, where a shape that rises from the other one, however slowly, would stop it.
        return !would_touch(c, along + up * lift - normalized(across) * min(lift * S(256), thickness));
    }
    [[nodiscard]] std::uint32_t other_shape(const contact& c) const {
        return in_.awake.has(c.bodies.body_a) ? c.shape_b : c.shape_a;
    }
    [[nodiscard]] bool would_touch(const contact& c, const vec<S, D>& shift) {
        const auto& a = in_.shapes[c.shape_a];
        const auto& b = in_.shapes[c.shape_b];
        auto at_a = a.pose, at_b = b.pose;
        (in_.awake.has(c.bodies.body_a) ? at_a : at_b).position += shift;
        const typename Plan::query query{&a.shape, &b.shape, relative(at_a, at_b)};
        auto& found = manifolds_;
        collide_once<Plan>(query, S(0), found);
        for (const auto& [number, part, m] : found)
            for (int k = 0; k < m.count; ++k)
                if (m.points[k].separation < S(0)) return true;
        return false;
    }

    const collide_input<Plan>& in_;
    const buffer<body_extent<S>>& extents_;
    buffer<contact>& contacts_;
    manifold_list<S, D>& manifolds_;
    arena& scratch_;
    std::uint32_t* support_ = nullptr;
};

/// Contacts -> the same without those on seams. Thickness is known of bodies that may be swept; others keep all.
template <class Plan, class Continuous>
void drop_seam_contacts([[maybe_unused]] const collide_input<Plan>& in, [[maybe_unused]] const Continuous& continuous,
                        [[maybe_unused]] step_data<Plan>& d) {
    if constexpr (Plan::is_continuous)
        seam_contacts<Plan>(in, continuous.extents, d.new_contacts, d.manifolds[0], d.scratch).drop();
}

}  // namespace detail

PHYSICS_HPP_END
