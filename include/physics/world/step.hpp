// One step of a world: the page to read first.
#pragma once

#include "physics/world/motion.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Broadphase: pairs of shapes whose boxes overlap, of two bodies of which one at least can be pushed: the filters that
/// shapes were inserted with say so.
template <class Plan>
const buffer<proxy_pair>& find_pairs(state<Plan>& s) {
    return s.broadphase.pairs([](std::uint32_t, std::uint32_t) { return true; });
}

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

/// Narrowphase: contacts of the pairs that touch or nearly do, in the order of the pairs.
template <class Plan>
void find_contacts(state<Plan>& s, const buffer<proxy_pair>& pairs) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const auto* queries = recall_pairs(s, pairs);
    const S margin = s.settings.contact_margin;
    s.manifolds.clear();
    if constexpr (Plan::remembers)
        Plan::narrowphase::collide(queries, pairs.size(), margin, s.found_memories.items.begin(), s.manifolds);
    else
        Plan::narrowphase::collide(queries, pairs.size(), margin, s.manifolds);

    s.found.clear();
    for (const auto& [query, part, m] : s.manifolds) {
        const proxy_pair p = in_order_of_kinds(s, pairs[query]);
        const auto& a = s.shapes[p.a];
        const auto& b = s.shapes[p.b];
        const rotation<S, D> turn = a.pose.rotation;
        const vec<S, D> from_b = b.arm + (a.pose.position - b.pose.position);
        contact<S, D> c{p.a,  p.b,     s.mover_of[a.body], s.mover_of[b.body], part, turn * m.normal, {},
                        m.count, S(0), S(0), S(0)};
        for (int k = 0; k < m.count; ++k) {
            const vec<S, D> at = turn * m.points[k].position;
            c.points[k].lever_a = a.arm + at;
            c.points[k].lever_b = from_b + at;
            c.points[k].separation = m.points[k].separation;
            c.points[k].feature = m.points[k].feature;
        }
        c.friction = root<S>(product(a.material.friction, b.material.friction));
        c.restitution = max(a.material.restitution, b.material.restitution);
        s.found.push(c);
    }
}

/// Who is woken brings contacts along: they are found anew, and join the others.
template <class Plan>
void find_contacts_of_woken(state<Plan>& s) {
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
    find_contacts(s, s.woken_pairs);
    inherit_impulses(s.sleep.contacts, s.found);
    merge_contacts(s.woken_contacts, s.found);
    s.found.swap(s.woken_contacts);
    s.found_memories.swap(s.woken_memories);
}

/// Advances a world by h seconds. Each stage reads and writes plain arrays; only this function knows their
/// order. False, and the world as it was, if a velocity or a position would leave the range of numbers.
/// Not inlined, so that no arithmetic moves out of the caller's float_control_scope.
template <class Plan>
PHYSICS_HPP_NOINLINE bool step(state<Plan>& s, typename Plan::scalar h) {
    s.scratch.reset();
    number_movers(s);                       // bodies            -> which of them move
    const auto& pairs = find_pairs(s);      // boxes             -> pairs, in order
    find_contacts(s, pairs);                // pairs and poses   -> contacts with feature ids
    if constexpr (Plan::sleeps)
        if (disturb_sleepers(s, h)) find_contacts_of_woken(s);  // -> contacts of islands that are touched
    inherit_impulses(s.contacts, s.found);  // last step's       -> warm impulses of what persists
    motion<Plan> moving(s, h);              // bodies, forces    -> what solver and integrator see of them
    Plan::solver::solve(moving.bodies, s.found, s.settings.solver, h, s.scratch, moving);  // -> velocities, poses
    if (!moving.is_finite()) return false;
    if (!moving.place_shapes()) return false;  // poses          -> boxes of what has moved
    moving.finish();                           // results        -> bodies and contacts
    return true;
}

}  // namespace detail

PHYSICS_HPP_END
