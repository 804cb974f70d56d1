// One step of a world: the page to read first.
#pragma once

#include "physics/world/edit.hpp"

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
        new (queries + i) typename Plan::query{&a.shape, &b.shape, relative(world_pose(s, a), world_pose(s, b))};
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
        const transform<S, D> pose = world_pose(s, a);
        const vec<S, D> from_a = pose.position - s.bodies[a.body].center;
        const vec<S, D> from_b = pose.position - s.bodies[b.body].center;
        contact<S, D> c{p.a, p.b, a.body, b.body, part, pose.rotation * m.normal, {}, m.count, S(0), S(0), S(0)};
        for (int k = 0; k < m.count; ++k) {
            const vec<S, D> at = pose.rotation * m.points[k].position;
            c.points[k].lever_a = from_a + at;
            c.points[k].lever_b = from_b + at;
            c.points[k].separation = m.points[k].separation;
            c.points[k].feature = m.points[k].feature;
        }
        c.friction = root<S>(product(a.material.friction, b.material.friction));
        c.restitution = max(a.material.restitution, b.material.restitution);
        s.found.push(c);
    }
}

/// Where bodies are as the step begins: what contacts refer to, and what a refused step goes back to.
template <class Plan>
void remember_poses(state<Plan>& s) {
    s.starts.resize(s.bodies.slots());
    s.bodies.each([&](std::uint32_t i, const auto& b) { s.starts[i] = {b.center, b.rotation}; });
}
template <class Plan>
void restore_poses(state<Plan>& s) {
    s.bodies.each([&](std::uint32_t i, auto& b) {
        b.center = s.starts[i].position;
        b.rotation = s.starts[i].rotation;
        refresh_boxes(s, i);
    });
}

/// What the solver sees of the bodies; bodies with a target pose get the velocity that reaches it.
template <class Plan>
auto gather_bodies(state<Plan>& s, typename Plan::scalar h) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const std::uint32_t count = s.bodies.slots() + 1;
    const solver_bodies<S, D> bodies{s.scratch.template take<solver_body<S, D>>(count), count};
    for (std::uint32_t i = 0; i < count; ++i) new (bodies.first + i) solver_body<S, D>{};
    s.bodies.each([&](std::uint32_t i, const body<S, D>& b) {
        bodies[i] = {b.velocity, {}, b.inverse_mass, in_world(b.inverse_inertia, b.rotation)};
        if (!b.has_target) return;
        bodies[i].velocity.linear = (b.target * b.mass.center - b.center) / h;
        bodies[i].velocity.angular = rotation_vector(b.target.rotation * inverse(b.rotation)) / h;
    });
    return bodies;
}

/// How the solver moves the world: it asks for velocities and poses to advance, once or in substeps.
template <class Plan>
struct motion {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;

    state<Plan>& s;
    solver_bodies<S, D> bodies;
    bool finite = true;

    void advance_velocities(S h) {
        s.bodies.each([&](std::uint32_t i, const body<S, D>& b) {
            if (b.is_dynamic()) Plan::integrator::advance_velocity(bodies[i], b, s.settings.gravity, h);
        });
    }
    void advance_poses(S h) {
        s.bodies.each([&](std::uint32_t i, body<S, D>& b) {
            twist<S, D>& v = bodies[i].velocity;
            if (b.type != body_type::static_body) Plan::integrator::advance_pose(b, v, h);
            finite =
                finite && is_finite(b.center) && is_finite(b.rotation) && is_finite(v.linear) && is_finite(v.angular);
        });
    }
};

/// Stores what the step found: velocities, contacts with their impulses. Forces act for one step, and bodies
/// that had a target stand still.
template <class Plan>
void finish(state<Plan>& s, solver_bodies<typename Plan::scalar, Plan::dimension> bodies) {
    s.bodies.each([&](std::uint32_t i, auto& b) {
        b.velocity = bodies[i].velocity;
        b.force = {};
        b.torque = {};
        if (!b.has_target) return;
        b.velocity = {};
        b.has_target = false;
    });
    s.contacts.swap(s.found);
    s.contact_starts.swap(s.starts);
    s.memories.swap(s.found_memories);
    ++s.steps;
}

/// Bounds: tells the broadphase where shapes are and where they are heading; bodies with a target are there, to the
/// bit. False if a box is beyond the scalar's range.
template <class Plan>
bool update_boxes(state<Plan>& s, solver_bodies<typename Plan::scalar, Plan::dimension> bodies,
                  typename Plan::scalar h) {
    bool fit = true;
    s.bodies.each([&](std::uint32_t i, auto& b) {
        if (b.type == body_type::static_body) return;
        if (b.has_target) b.set_pose(b.target);
        each_shape(s, i, [&](std::uint32_t k, const auto& shape) {
            const auto box = needed_box(s, shape);
            if (fit = fit && is_box(box); fit) s.broadphase.move(k, box, bodies[i].velocity.linear * h);
        });
    });
    update_broadphase(s);
    return fit;
}

/// Advances a world by h seconds. Each stage reads and writes plain arrays; only this function knows their
/// order. False, and the world as it was, if a velocity or a position would leave the range of numbers.
/// Not inlined, so that no arithmetic moves out of the caller's float_control_scope.
template <class Plan>
PHYSICS_HPP_NOINLINE bool step(state<Plan>& s, typename Plan::scalar h) {
    s.scratch.reset();
    const auto& pairs = find_pairs(s);        // boxes             -> pairs, in order
    find_contacts(s, pairs);                  // pairs and poses   -> contacts with feature ids
    inherit_impulses(s.contacts, s.found);    // last step's       -> warm impulses of what persists
    remember_poses(s);                        // poses             -> where the step began
    const auto bodies = gather_bodies(s, h);  // bodies            -> what the solver sees of them
    motion<Plan> moving{s, bodies};
    Plan::solver::solve(bodies, s.found, s.settings.solver, h, s.scratch, moving);  // -> velocities, poses
    if (!moving.finite) return restore_poses(s), false;
    if (!update_boxes(s, bodies, h)) return restore_poses(s), false;  // poses -> boxes of what has moved
    finish(s, bodies);                                                // results           -> bodies and contacts
    return true;
}

}  // namespace detail

PHYSICS_HPP_END
