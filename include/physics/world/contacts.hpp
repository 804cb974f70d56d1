// The contacts of a step: narrowphase, surfaces, and what is remembered of pairs.
#pragma once

#include "physics/world/look_ahead.hpp"
#include "physics/world/motion.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The narrowphase wants the shape of the lower kind first.
template <class Plan>
proxy_pair in_order_of_kinds(const state<Plan>& s, proxy_pair p) {
    return s.shapes[p.a].shape.kind() > s.shapes[p.b].shape.kind() ? proxy_pair{p.b, p.a} : p;
}

/// Hands on what the last step remembered of the pairs that are still there. Both lists are in ascending order, so one
/// walk along both finds it. Gives the query of each pair.
template <class Plan>
auto* recall_pairs(state<Plan>& s, const buffer<proxy_pair>& pairs) {
    using narrowphase = typename Plan::narrowphase;
    auto* queries = s.scratch.template take<typename Plan::query>(pairs.size());
    s.found_memories.clear();
    std::uint32_t last = 0;
    for (std::uint32_t i = 0; i < pairs.size(); ++i) {
        const proxy_pair p = in_order_of_kinds(s, pairs[i]);
        const auto& a = s.shapes[p.a];
        const auto& b = s.shapes[p.b];
        new (queries + i) typename Plan::query{&a.shape, &b.shape, relative(a.pose, b.pose)};
        if constexpr (Plan::remembers) {
            if (!narrowphase::remembers(a.shape.kind(), b.shape.kind())) continue;
            const auto& [before, items] = s.memories;
            while (last < before.size() && before[last] < pairs[i]) ++last;
            const bool known = last < before.size() && before[last] == pairs[i];
            queries[i].memory = s.found_memories.pairs.size();
            s.found_memories.add(pairs[i], known ? items[last] : typename Plan::pair_memory{});
        }
    }
    return queries;
}

/// How running surfaces drive. Apart from the rest, since few do.
template <class Plan>
PHYSICS_HPP_NOINLINE void drive(contact<typename Plan::scalar, Plan::dimension>& c, const shape_record<Plan>& a,
                                const shape_record<Plan>& b) {
    c.surface_velocity = driven(tangents<typename Plan::scalar, Plan::dimension>(c.normal), a.pose.rotation,
                                a.material.surface_velocity, b.pose.rotation, b.material.surface_velocity);
}
/// What both surfaces make of a contact of A and B; false if the recipe's rule gives what no solver takes.
template <class Plan>
bool mix_surfaces(contact<typename Plan::scalar, Plan::dimension>& c, const shape_record<Plan>& a,
                  const shape_record<Plan>& b) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const auto is_good = [](S x) { return x >= S(0) && is_finite(x); };
    c.friction = Plan::mixing::friction(a.material, b.material);
    c.restitution = Plan::mixing::restitution(a.material, b.material);
    if constexpr (Plan::features::rolling_resistance)
        c.rolling_resistance = Plan::mixing::rolling_resistance(a.material, b.material);
    if constexpr (Plan::features::surface_velocity) {
        const surface_motion<S, D> still{};
        if (a.material.surface_velocity != still || b.material.surface_velocity != still) drive(c, a, b);
    }
    return is_good(c.friction) && is_good(c.restitution) && !(c.restitution > S(1)) && is_good(c.rolling_resistance);
}

/// Narrowphase: contacts of the pairs that touch or nearly do, in the order of the pairs. False if surfaces do not mix.
template <class Plan>
bool find_contacts(state<Plan>& s, const buffer<proxy_pair>& pairs) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const auto* queries = recall_pairs(s, pairs);
    const S margin = s.settings.contact_margin;
    s.manifolds.clear();
    const auto collide = [&](const auto* first, std::uint32_t count, S within) {
        if constexpr (Plan::remembers)
            Plan::narrowphase::collide(first, count, within, s.found_memories.items.begin(), s.manifolds);
        else
            Plan::narrowphase::collide(first, count, within, s.manifolds);
    };
    if constexpr (Plan::looks_ahead) collide_ahead(s, queries, pairs, collide);
    else collide(queries, pairs.size(), margin);

    s.found.clear();
    bool mixed = true;
    for (const auto& [query, part, m] : s.manifolds) {
        const proxy_pair p = in_order_of_kinds(s, pairs[query]);
        const auto& a = s.shapes[p.a];
        const auto& b = s.shapes[p.b];
        const rotation<S, D> turn = a.pose.rotation;
        const vec<S, D> from_b = b.arm + (a.pose.position - b.pose.position);
        contact<S, D>& c =
            s.found.emplace(p.a, p.b, s.mover_of[a.body], s.mover_of[b.body], part, turn * m.normal);
        c.count = m.count;
        for (int k = 0; k < m.count; ++k) {
            const vec<S, D> at = turn * m.points[k].position;
            c.points[k].lever_a = a.arm + at;
            c.points[k].lever_b = from_b + at;
            c.points[k].separation = m.points[k].separation;
            c.points[k].feature = m.points[k].feature;
        }
        mixed = mix_surfaces(c, a, b) && mixed;
        note_depth(s, c);
    }
    return mixed;
}

/// Who is woken brings contacts along: they are found anew, and join the others.
template <class Plan>
bool find_contacts_of_woken(state<Plan>& s) {
    find_numbers(s);
    for (auto& c : s.found) {
        c.body_a = s.mover_of[body_a(s, c)];
        c.body_b = s.mover_of[body_b(s, c)];
    }
    s.woken_pairs.clear();
    for (const auto& c : s.sleep.contacts) {
        const bool wakes = s.mover_of[body_a(s, c)] < s.movers.size() || s.mover_of[body_b(s, c)] < s.movers.size();
        if (wakes && (s.woken_pairs.empty() || s.woken_pairs.back() < c.key())) s.woken_pairs.push(c.key());
    }
    // What is remembered of the other pairs waits meanwhile.
    s.found.swap(s.woken_contacts);
    s.found_memories.swap(s.woken_memories);
    const bool good = find_contacts(s, s.woken_pairs);
    inherit_impulses(s.sleep.contacts, s.found);
    merge_contacts(s.woken_contacts, s.found);
    s.found.swap(s.woken_contacts);
    s.found_memories.swap(s.woken_memories);
    return good;
}

}  // namespace detail

PHYSICS_HPP_END
