// The contacts of a step: narrowphase, surfaces, and what is remembered of pairs.
#pragma once

#include "physics/step/contact_rule.hpp"
#include "physics/step/depths.hpp"
#include "physics/step/look_ahead.hpp"
#include "physics/step/touching.hpp"
#include "physics/step/warm_impulses.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// What the narrowphase reads of a world.
template <class Plan>
struct collide_input {
    using S = typename Plan::scalar;

    const pool<typename Plan::body>& bodies;
    const shape_pool<Plan>& shapes;
    const awake_list& awake;
    const sleep_of<Plan>& sleep;
    /// Of all surfaces, where shapes have none of their own.
    const combined_material<S, typename Plan::features>& material;
    S margin, h;
    std::uint64_t steps;
    std::uint16_t tag;
};

/// The narrowphase wants the shape of the lower kind first.
template <class Plan>
proxy_pair in_order_of_kinds(const shape_pool<Plan>& shapes, proxy_pair p) {
    return shapes[p.a].shape.kind() > shapes[p.b].shape.kind() ? proxy_pair{p.b, p.a} : p;
}

/// Some pairs in a row with what the narrowphase is to know of them: a query of each, and what the last step remembered
/// of those that it cares to remember.
template <class Plan>
class pair_queries {
    using query = typename Plan::query;
    using memory = typename Plan::pair_memory;

public:
    /// Both lists are in ascending order, so one walk along both finds what is remembered.
    pair_queries(const collide_input<Plan>& in, [[maybe_unused]] const pair_cache<Plan>& cache, const proxy_pair* pairs,
                 std::uint32_t count, arena& scratch, sweep_data_of<Plan>& near)
        : pairs_(pairs), count_(count), queries_(scratch.allocate<query>(count)) {
        if constexpr (Plan::remembers) {
            memories_ = scratch.allocate<memory>(count);
            owners_ = scratch.allocate<owner>(count);
        }
        [[maybe_unused]] std::uint32_t last = no_memory;
        for (std::uint32_t i = 0; i < count; ++i) {
            const proxy_pair p = in_order_of_kinds(in.shapes, pairs[i]);
            const auto& a = in.shapes[p.a];
            const auto& b = in.shapes[p.b];
            note_near<Plan>(in.awake, {a.body, b.body}, near);
            new (queries_ + i) query{&a.shape, &b.shape, relative(a.pose, b.pose)};
            if constexpr (Plan::remembers) {
                if (!Plan::narrowphase::remembers(a.shape.kind(), b.shape.kind())) continue;
                if (last == no_memory) last = cache.find(pairs[i]);
                while (last < cache.size() && cache.pair(last) < pairs[i]) ++last;
                const bool known = last < cache.size() && cache.pair(last) == pairs[i];
                if (known) cache.read(last, memories_[remembered_]);
                else cache.clear(memories_[remembered_]);
                owners_[remembered_] = {i, known ? last : no_memory};
                queries_[i].memory = remembered_++;
            }
        }
    }
    [[nodiscard]] const query* queries() const { return queries_; }
    [[nodiscard]] memory* memories() const { return memories_; }
    [[nodiscard]] const proxy_pair* pairs() const { return pairs_; }
    [[nodiscard]] std::uint32_t size() const { return count_; }

    /// Says which memories stay as they are, and adds the others to a list.
    void save_to_cache(const pair_cache<Plan>& before, bool* is_kept, pair_cache<Plan>& changes) const {
        for (std::uint32_t k = 0; k < remembered_; ++k) {
            const auto [i, known] = owners_[k];
            if (known != no_memory && before.is_unchanged(known, memories_[k])) is_kept[known] = true;
            else changes.add(pairs_[i], memories_[k]);
        }
    }

private:
    static constexpr std::uint32_t no_memory = query::no_memory;
    /// Whose memory it is, and which one of the last step, if any.
    struct owner {
        std::uint32_t pair, known;
    };

    const proxy_pair* pairs_;
    std::uint32_t count_, remembered_ = 0;
    query* queries_;
    memory* memories_ = nullptr;
    owner* owners_ = nullptr;
};

/// How running surfaces drive. Apart from the rest, since few do.
template <class Plan>
PHYSICS_HPP_NOINLINE void set_belt_velocity(typename Plan::contact& c, const shape_record<Plan>& a,
                                            const shape_record<Plan>& b) {
    c.surface_velocity =
        relative_surface_velocity(tangents<typename Plan::scalar, Plan::dimension>(c.normal), a.pose.rotation,
                                  a.material.surface_velocity, b.pose.rotation, b.material.surface_velocity);
}
template <class S>
bool is_valid_coefficient(S x) {
    return x >= S(0) && is_finite(x);
}
/// Writes down the coefficients of two materials together; false if the recipe's rule gives what no solver takes.
template <class Plan, class Coefficients>
bool combine_materials(Coefficients& c, const material<typename Plan::scalar, Plan::dimension>& of_a,
                       const material<typename Plan::scalar, Plan::dimension>& of_b) {
    using S = typename Plan::scalar;
    using features = typename Plan::features;
    bool good = true;
    if constexpr (features::friction) good = is_valid_coefficient<S>(c.friction = Plan::mixing::friction(of_a, of_b));
    if constexpr (features::restitution)
        good = is_valid_coefficient<S>(c.restitution = Plan::mixing::restitution(of_a, of_b)) && good;
    if constexpr (features::rolling_resistance)
        good = is_valid_coefficient<S>(c.rolling_resistance = Plan::mixing::rolling_resistance(of_a, of_b)) && good;
    return good;
}
/// What both surfaces make of a contact of A and B, unless that is the same for all.
template <class Plan>
bool combine_surface_materials([[maybe_unused]] typename Plan::contact& c, [[maybe_unused]] const shape_record<Plan>& a,
                               [[maybe_unused]] const shape_record<Plan>& b) {
    if constexpr (Plan::features::materials) {
        const material<typename Plan::scalar, Plan::dimension> of_a = a.material.whole(), of_b = b.material.whole();
        const bool good = combine_materials<Plan>(c, of_a, of_b);
        if constexpr (Plan::features::surface_velocity) {
            const surface_motion<typename Plan::scalar, Plan::dimension> at_rest{};
            if (of_a.surface_velocity != at_rest || of_b.surface_velocity != at_rest) set_belt_velocity(c, a, b);
        }
        return good;
    } else {
        return true;
    }
}
/// What all surfaces of this step make of each other, if they are of one material.
template <class Plan>
bool combine_common_materials([[maybe_unused]] const typename Plan::settings& settings,
                              [[maybe_unused]] combined_material<typename Plan::scalar, typename Plan::features>& to) {
    if constexpr (Plan::features::materials) {
        return true;
    } else {
        auto of_all = settings.material;
        // As materials of shapes, it lacks what the recipe leaves out.
        if constexpr (!Plan::features::friction) of_all.friction = {};
        return combine_materials<Plan>(to, of_all, of_all);
    }
}

/// Whether a contact rule has left coefficients that solvers take.
template <class Plan>
bool has_valid_coefficients([[maybe_unused]] const typename Plan::contact& c) {
    using S = typename Plan::scalar;
    bool good = true;
    if constexpr (Plan::features::materials && Plan::features::friction) good = is_valid_coefficient<S>(c.friction);
    if constexpr (Plan::features::materials && Plan::features::restitution)
        good = is_valid_coefficient<S>(c.restitution) && good;
    return good;
}

/// Adds the contacts of a manifold between the shapes of a pair. False if their surfaces do not mix.
template <class Plan, class Manifold>
bool add_contact(const shape_pool<Plan>& shapes, proxy_pair pair, std::uint32_t part, const Manifold& m,
                 buffer<typename Plan::contact>& to) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const proxy_pair p = in_order_of_kinds(shapes, pair);
    const auto& a = shapes[p.a];
    const auto& b = shapes[p.b];
    const rotation<S, D> turn = a.pose.rotation;
    auto& c = to.emplace_back(p.a, p.b, edge{a.body, b.body}, part, turn * m.normal, a.r,
                              b.r + (a.pose.position - b.pose.position), static_cast<std::uint8_t>(m.count));
    for (int k = 0; k < m.count; ++k) {
        c.points[k].position = turn * m.points[k].position;
        c.points[k].separation = m.points[k].separation;
        c.points[k].feature = m.points[k].feature;
    }
    return combine_surface_materials<Plan>(c, a, b);
}

/// Result flags of the narrowphase: all combined coefficients are valid; some contact is deep; an awake body is near a
/// sleeping one.
struct collide_result {
    bool materials_valid = true, deep = false, near_sleeper = false;
};
/// Adds the contacts of some pairs in a row.
template <class Plan>
collide_result collide_chunk(const collide_input<Plan>& in, const pair_queries<Plan>& of,
                             [[maybe_unused]] const sweep_data_of<Plan>& sweep,
                             manifold_list<typename Plan::scalar, Plan::dimension>& manifolds,
                             [[maybe_unused]] const buffer<typename Plan::contact>& before,
                             [[maybe_unused]] passing_pairs<Plan>& passing, buffer<typename Plan::contact>& to) {
    using S = typename Plan::scalar;
    manifolds.clear();
    const auto collide = [&](const auto* some, std::uint32_t count, S within) {
        if constexpr (Plan::remembers) Plan::narrowphase::collide(some, count, within, of.memories(), manifolds);
        else Plan::narrowphase::collide(some, count, within, manifolds);
    };
    if constexpr (Plan::looks_ahead)
        collide_ahead<Plan>(in.shapes, sweep.ahead, in.margin, of.queries(), of.memories(), of.pairs(), of.size(),
                            manifolds, collide);
    else collide(of.queries(), of.size(), in.margin);
    collide_result result;
    [[maybe_unused]]
    typename contact_candidate<Plan>::context context{in.bodies, in.shapes, before, in.margin, in.h, in.tag};
    if constexpr (Plan::has_contact_rule) context.scratch = &passing.again;
    for (const auto& [query, part, m] : manifolds) {
        const proxy_pair pair = of.pairs()[query];
        const std::uint32_t a = in.shapes[pair.a].body, b = in.shapes[pair.b].body;
        const std::uint32_t awake_a = in.awake.index_of[a], awake_b = in.awake.index_of[b];
        // Broadphases need not leave out pairs of two bodies that are static or asleep; such a pair needs no solving.
        if (awake_a == awake_b) continue;
        result.materials_valid = add_contact<Plan>(in.shapes, pair, part, m, to) && result.materials_valid;
        if constexpr (Plan::has_contact_rule) {
            contact_candidate<Plan> candidate(context, to.back());
            if (!accepts(candidate)) {
                passing.add(pair);
                to.pop_back();
                continue;
            }
            result.materials_valid = result.materials_valid && has_valid_coefficients<Plan>(to.back());
        }
        result.deep = result.deep || is_deep<Plan>(in.awake, in.margin, to.back());
        // Bodies that do not move or sleep have the last number.
        result.near_sleeper = result.near_sleeper || in.sleep.is_asleep(awake_a < awake_b ? b : a);
    }
    return result;
}

/// The contacts of a part of the pairs: where they lie among those that a worker has found.
struct contact_chunk {
    std::uint32_t worker, first, end;
    collide_result is;

    [[nodiscard]] std::uint32_t size() const { return end - first; }
};
/// Brings the pieces of several workers together, in their order, and notes which bodies they find deep in others.
template <class Plan>
collide_result join_chunks(const collide_input<Plan>& in, contact_chunk* pieces, std::uint32_t count,
                           step_data<Plan>& d, task_runner& tasks) {
    using contact = typename Plan::contact;
    collide_result all;
    std::uint32_t found = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
        all.materials_valid = all.materials_valid && pieces[k].is.materials_valid;
        all.deep = all.deep || pieces[k].is.deep;
        all.near_sleeper = all.near_sleeper || pieces[k].is.near_sleeper;
        found += pieces[k].size();
    }
    // What the caller has found first stays where it is.
    std::uint32_t kept = 0;
    if (!tasks.is_serial()) {
        auto& own = d.contacts_by_worker[0];
        std::uint32_t in_place = 0;
        for (; kept < count && pieces[kept].worker == 0 && pieces[kept].first == in_place; ++kept)
            in_place += pieces[kept].size();
        // The rest of it, if any, moves aside.
        d.new_contacts.clear();
        if (own.size() > in_place)
            std::memcpy(static_cast<void*>(d.new_contacts.extend(own.size() - in_place)), own.begin() + in_place,
                        (own.size() - in_place) * sizeof(contact));
        for (std::uint32_t k = kept; k < count; ++k)
            if (pieces[k].worker == 0) pieces[k].first -= in_place, pieces[k].end -= in_place;
        own.resize(in_place);
        d.new_contacts.swap(own);
        d.new_contacts.extend(found - in_place);
    }
    contact* to = d.new_contacts.begin();
    auto** places = d.scratch.template allocate<contact*>(count);
    for (std::uint32_t k = 0; k < count; ++k) {
        places[k] = to;
        to += pieces[k].size();
    }
    if (!tasks.is_serial())
        // Of all pieces, so that workers copy what they have found.
        tasks.parallel_tasks(kept < count ? count : 0, [&](std::uint32_t k, std::uint32_t) {
            const contact_chunk& of = pieces[k];
            if (k < kept || of.size() == 0) return;
            std::memcpy(static_cast<void*>(places[k]), d.contacts_by_worker[of.worker].begin() + of.first,
                        of.size() * sizeof(contact));
        });
    for (std::uint32_t k = 0; k < count; ++k) {
        if (!pieces[k].is.deep) continue;
        for (std::uint32_t i = 0; i < pieces[k].size(); ++i)
            if (is_deep<Plan>(in.awake, in.margin, places[k][i])) note_depth<Plan>(in.bodies, places[k][i], d.sweep);
    }
    return all;
}

/// Narrowphase: contacts of the pairs that touch or nearly do, in the order of the pairs, with the impulses that the
/// same features had in steps of those lengths, scaled to one of h: they hold loads, which a longer step holds by
/// larger ones. What it remembers of the pairs becomes the next step's, unless it is not to.
template <class Plan>
collide_result find_contacts(const buffer<proxy_pair>& pairs, const collide_input<Plan>& in,
                             const buffer<typename Plan::contact>& before, step_lengths<typename Plan::scalar> lengths,
                             [[maybe_unused]] pair_cache<Plan>& cache, step_data<Plan>& d, task_runner& tasks,
                             [[maybe_unused]] bool remembers = true) {
    // So many pairs that what is found of them is still in the caches when it becomes contacts.
    constexpr std::uint32_t share = 256;
    const std::uint32_t count = (pairs.size() + share - 1) / share;
    contact_chunk* pieces = d.scratch.template allocate<contact_chunk>(count);
    [[maybe_unused]] auto& changes = d.pair_cache_changes;
    if constexpr (Plan::remembers)
        if (remembers) changes.start(cache, count, tasks, d.scratch);
    d.new_contacts.clear();
    if (tasks.is_serial()) d.new_contacts.reserve(before.size());
    else
        for (std::uint32_t k = 0; k < tasks.workers(); ++k) d.contacts_by_worker[k].clear();
    tasks.parallel_chunks(pairs.size(), share, [&](std::uint32_t first, std::uint32_t end, std::uint32_t worker) {
        auto& to = tasks.is_serial() ? d.new_contacts : d.contacts_by_worker[worker];
        const std::uint32_t start = to.size();
        // Solvers come to it later in the step.
        arena& scratch = d.batch_scratch[worker];
        scratch.reset();
        const pair_queries<Plan> some(in, cache, pairs.begin() + first, end - first, scratch, d.sweep);
        const collide_result is =
            collide_chunk(in, some, d.sweep, d.manifolds[worker], before, d.passing_by_worker[worker], to);
        if constexpr (Plan::remembers)
            if (remembers) changes.add(some, cache, first / share, worker);
        inherit_impulses(before, to.begin() + start, to.end(), in.material);
        // What pushes overlaps apart is as large in a short step as in a long one. As long as a world is young that may
        // be most of its impulses, and must not be stretched.
        const int maximum = in.steps < 128 ? static_cast<int>(in.steps) : 128;
        rescale_impulses(to.begin() + start, to.end(), lengths, {in.h, in.h}, typename Plan::scalar(maximum));
        if constexpr (Plan::events::hits) note_loads(to.begin() + start, to.end());
        new (pieces + first / share) contact_chunk{worker, start, to.size(), is};
    });
    return join_chunks(in, pieces, count, d, tasks);
}

/// Adds the contacts of woken islands, found anew; `in` sees the awake list that has them. False if materials do not
/// combine.
template <class Plan>
bool find_contacts_of_woken(const collide_input<Plan>& in, pair_cache<Plan>& cache, step_data<Plan>& d,
                            task_runner& tasks) {
    d.woken_pairs.clear();
    // Kinematic bodies are always in the awake list, but wake no other body.
    const auto wakes = [&](std::uint32_t i) { return in.bodies[i].is_dynamic() && in.awake.has(i); };
    for (const auto& c : in.sleep.contacts) {
        if (!wakes(c.bodies.body_a) && !wakes(c.bodies.body_b)) continue;
        if (d.woken_pairs.empty() || d.woken_pairs.back() < c.key()) d.woken_pairs.push_back(c.key());
    }
    d.new_contacts.swap(d.woken_contacts);
    const step_lengths<typename Plan::scalar> lengths{in.sleep.step, in.sleep.step};
    const collide_result found = find_contacts(d.woken_pairs, in, in.sleep.contacts, lengths, cache, d, tasks, false);
    merge_contacts(d.woken_contacts, d.new_contacts);
    d.new_contacts.swap(d.woken_contacts);
    return found.materials_valid;
}

}  // namespace detail

PHYSICS_HPP_END
