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

/// Some pairs in a row with what the narrowphase is to know of them: a query of each, and what the last step remembered
/// of those that it cares to remember.
template <class Plan>
class recalled_pairs {
    using query = typename Plan::query;
    using memory = typename Plan::pair_memory;

public:
    /// Both lists are in ascending order, so one walk along both finds what is remembered.
    recalled_pairs(state<Plan>& s, const proxy_pair* pairs, std::uint32_t count, arena& scratch)
        : pairs_(pairs), count_(count), queries_(scratch.take<query>(count)) {
        if constexpr (Plan::remembers) {
            memories_ = scratch.take<memory>(count);
            owners_ = scratch.take<owner>(count);
        }
        [[maybe_unused]] std::uint32_t last = no_memory;
        for (std::uint32_t i = 0; i < count; ++i) {
            const proxy_pair p = in_order_of_kinds(s, pairs[i]);
            const auto& a = s.shapes[p.a];
            const auto& b = s.shapes[p.b];
            note_near(s, a.body, b.body);
            new (queries_ + i) query{&a.shape, &b.shape, relative(a.pose, b.pose)};
            if constexpr (Plan::remembers) {
                if (!Plan::narrowphase::remembers(a.shape.kind(), b.shape.kind())) continue;
                if (last == no_memory) last = s.memories.find(pairs[i]);
                while (last < s.memories.size() && s.memories.pair(last) < pairs[i]) ++last;
                const bool known = last < s.memories.size() && s.memories.pair(last) == pairs[i];
                if (known) s.memories.read(last, memories_[remembered_]);
                else s.memories.clear(memories_[remembered_]);
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
    void hand_on(const pair_memories<Plan>& before, bool* is_kept, pair_memories<Plan>& news) const {
        for (std::uint32_t k = 0; k < remembered_; ++k) {
            const auto [i, known] = owners_[k];
            if (known != no_memory && before.is_as_it_was(known, memories_[k])) is_kept[known] = true;
            else news.add(pairs_[i], memories_[k]);
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
PHYSICS_HPP_NOINLINE void drive(typename Plan::contact& c, const shape_record<Plan>& a, const shape_record<Plan>& b) {
    c.surface_velocity = driven(tangents<typename Plan::scalar, Plan::dimension>(c.normal), a.pose.rotation,
                                a.material.surface_velocity, b.pose.rotation, b.material.surface_velocity);
}
/// Writes down the coefficients of two materials together; false if the recipe's rule gives what no solver takes.
template <class Plan, class Coefficients>
bool mix(Coefficients& c, const material<typename Plan::scalar, Plan::dimension>& of_a,
         const material<typename Plan::scalar, Plan::dimension>& of_b) {
    using S = typename Plan::scalar;
    using features = typename Plan::features;
    const auto is_good = [](S x) { return x >= S(0) && is_finite(x); };
    bool good = true;
    if constexpr (features::friction) good = is_good(c.friction = Plan::mixing::friction(of_a, of_b));
    if constexpr (features::restitution) {
        c.restitution = Plan::mixing::restitution(of_a, of_b);
        good = good && is_good(c.restitution) && !(c.restitution > S(1));
    }
    if constexpr (features::rolling_resistance)
        good = is_good(c.rolling_resistance = Plan::mixing::rolling_resistance(of_a, of_b)) && good;
    return good;
}
/// What both surfaces make of a contact of A and B, unless that is the same for all.
template <class Plan>
bool mix_surfaces([[maybe_unused]] typename Plan::contact& c, [[maybe_unused]] const shape_record<Plan>& a,
                  [[maybe_unused]] const shape_record<Plan>& b) {
    if constexpr (Plan::features::materials) {
        const material<typename Plan::scalar, Plan::dimension> of_a = a.material.whole(), of_b = b.material.whole();
        const bool good = mix<Plan>(c, of_a, of_b);
        if constexpr (Plan::features::surface_velocity) {
            const surface_motion<typename Plan::scalar, Plan::dimension> still{};
            if (of_a.surface_velocity != still || of_b.surface_velocity != still) drive(c, a, b);
        }
        return good;
    } else {
        return true;
    }
}
/// What all surfaces of this step make of each other, if they are of one material.
template <class Plan>
bool mix_common_surface([[maybe_unused]] state<Plan>& s) {
    if constexpr (Plan::features::materials) {
        return true;
    } else {
        auto of_all = s.settings.material;
        // As materials of shapes, it lacks what the recipe leaves out.
        if constexpr (!Plan::features::friction) of_all.friction = {};
        return mix<Plan>(s.found_surfaces, of_all, of_all);
    }
}

/// Adds the contacts of a manifold between the shapes of a pair. False if their surfaces do not mix.
template <class Plan, class Manifold>
bool add_contact(const state<Plan>& s, proxy_pair pair, std::uint32_t part, const Manifold& m,
                 buffer<typename Plan::contact>& to) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const proxy_pair p = in_order_of_kinds(s, pair);
    const auto& a = s.shapes[p.a];
    const auto& b = s.shapes[p.b];
    const rotation<S, D> turn = a.pose.rotation;
    auto& c = to.emplace(p.a, p.b, s.mover_of[a.body], s.mover_of[b.body], part, turn * m.normal, a.arm,
                         b.arm + (a.pose.position - b.pose.position), static_cast<std::uint8_t>(m.count));
    for (int k = 0; k < m.count; ++k) {
        c.points[k].position = turn * m.points[k].position;
        c.points[k].separation = m.points[k].separation;
        c.points[k].feature = m.points[k].feature;
    }
    return mix_surfaces(c, a, b);
}

/// What the search of pairs has come to: whether all surfaces mix, some shape is deep in another, and somebody who is
/// awake comes near a sleeper.
struct search_result {
    bool mixed = true, deep = false, disturbs = false;
};
/// Adds the contacts of some pairs in a row.
template <class Plan>
search_result search_pairs(state<Plan>& s, const recalled_pairs<Plan>& of,
                           manifold_list<typename Plan::scalar, Plan::dimension>& manifolds,
                           buffer<typename Plan::contact>& to) {
    using S = typename Plan::scalar;
    manifolds.clear();
    const auto collide = [&](const auto* some, std::uint32_t count, S within) {
        if constexpr (Plan::remembers) Plan::narrowphase::collide(some, count, within, of.memories(), manifolds);
        else Plan::narrowphase::collide(some, count, within, manifolds);
    };
    if constexpr (Plan::looks_ahead)
        collide_ahead(s, of.queries(), of.memories(), of.pairs(), of.size(), manifolds, collide);
    else collide(of.queries(), of.size(), s.settings.contact_margin);
    search_result result;
    for (const auto& [query, part, m] : manifolds) {
        const proxy_pair pair = of.pairs()[query];
        const std::uint32_t a = s.shapes[pair.a].body, b = s.shapes[pair.b].body;
        // Broadphases need not report two that stand; if one does, nobody has to solve it.
        if (s.mover_of[a] == s.mover_of[b]) continue;
        result.mixed = add_contact(s, pair, part, m, to) && result.mixed;
        result.deep = result.deep || is_deep(s, to.back());
        // Who stands or sleeps has the last number.
        result.disturbs = result.disturbs || s.is_asleep(s.mover_of[a] < s.mover_of[b] ? b : a);
    }
    return result;
}

/// The contacts of a part of the pairs: where they lie among those that a worker has found.
struct found_piece {
    std::uint32_t worker, first, end;
    search_result is;

    [[nodiscard]] std::uint32_t size() const { return end - first; }
};
/// Brings the pieces of several workers together, in their order, and notes which bodies they find deep in others.
template <class Plan>
search_result join_pieces(state<Plan>& s, found_piece* pieces, std::uint32_t count, crew& hands) {
    using contact = typename Plan::contact;
    search_result all;
    std::uint32_t found = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
        all.mixed = all.mixed && pieces[k].is.mixed;
        all.deep = all.deep || pieces[k].is.deep;
        all.disturbs = all.disturbs || pieces[k].is.disturbs;
        found += pieces[k].size();
    }
    // What the caller has found first stays where it is.
    std::uint32_t kept = 0;
    if (!hands.is_alone()) {
        auto& own = s.found_by[0];
        std::uint32_t in_place = 0;
        for (; kept < count && pieces[kept].worker == 0 && pieces[kept].first == in_place; ++kept)
            in_place += pieces[kept].size();
        // The rest of it, if any, moves aside.
        s.found.clear();
        if (own.size() > in_place)
            std::memcpy(static_cast<void*>(s.found.extend(own.size() - in_place)), own.begin() + in_place,
                        (own.size() - in_place) * sizeof(contact));
        for (std::uint32_t k = kept; k < count; ++k)
            if (pieces[k].worker == 0) pieces[k].first -= in_place, pieces[k].end -= in_place;
        own.resize(in_place);
        s.found.swap(own);
        s.found.extend(found - in_place);
    }
    contact* to = s.found.begin();
    auto** places = s.scratch.template take<contact*>(count);
    for (std::uint32_t k = 0; k < count; ++k) {
        places[k] = to;
        to += pieces[k].size();
    }
    if (!hands.is_alone())
        // Of all pieces, so that workers copy what they have found.
        hands.each(kept < count ? count : 0, [&](std::uint32_t k, std::uint32_t) {
            const found_piece& of = pieces[k];
            if (k < kept || of.size() == 0) return;
            std::memcpy(static_cast<void*>(places[k]), s.found_by[of.worker].begin() + of.first,
                        of.size() * sizeof(contact));
        });
    for (std::uint32_t k = 0; k < count; ++k) {
        if (!pieces[k].is.deep) continue;
        for (std::uint32_t i = 0; i < pieces[k].size(); ++i) note_depth(s, places[k][i]);
    }
    return all;
}

/// Narrowphase: contacts of the pairs that touch or nearly do, in the order of the pairs, with the impulses that the
/// same features had in a step of length `last`, scaled to one of h: they hold loads, which a longer step holds by
/// larger ones. What it remembers of the pairs becomes the next step's, unless it is not to.
template <class Plan>
search_result find_contacts(state<Plan>& s, const buffer<proxy_pair>& pairs,
                            const buffer<typename Plan::contact>& before, typename Plan::scalar last,
                            typename Plan::scalar h, crew& hands, [[maybe_unused]] bool remembers = true) {
    // So many pairs that what is found of them is still in the caches when it becomes contacts.
    constexpr std::uint32_t share = 256;
    const std::uint32_t count = (pairs.size() + share - 1) / share;
    found_piece* pieces = s.scratch.template take<found_piece>(count);
    [[maybe_unused]] auto& news = s.memory_changes;
    if constexpr (Plan::remembers)
        if (remembers) news.start(s.memories, count, hands, s.scratch);
    s.found.clear();
    if (hands.is_alone()) s.found.reserve(before.size());
    else
        for (std::uint32_t k = 0; k < hands.workers(); ++k) s.found_by[k].clear();
    hands.each_part(pairs.size(), share, [&](std::uint32_t first, std::uint32_t end, std::uint32_t worker) {
        auto& to = hands.is_alone() ? s.found : s.found_by[worker];
        const std::uint32_t start = to.size();
        // Solvers come to it later in the step.
        arena& scratch = s.batch_scratch[worker];
        scratch.reset();
        const recalled_pairs<Plan> some(s, pairs.begin() + first, end - first, scratch);
        const search_result is = search_pairs(s, some, s.manifolds[worker], to);
        if constexpr (Plan::remembers)
            if (remembers) news.add(some, s.memories, first / share, worker);
        inherit_impulses(before, to.begin() + start, to.end(), s.found_surfaces);
        stretch(to.begin() + start, to.end(), last, h);
        new (pieces + first / share) found_piece{worker, start, to.size(), is};
    });
    return join_pieces(s, pieces, count, hands);
}

/// Who is woken brings contacts along: they are found anew, and join the others. False if surfaces do not mix.
template <class Plan>
bool find_contacts_of_woken(state<Plan>& s, typename Plan::scalar h, crew& hands) {
    find_numbers(s);
    for (auto& c : s.found) {
        c.body_a = s.mover_of[body_a(s, c)];
        c.body_b = s.mover_of[body_b(s, c)];
    }
    s.woken_pairs.clear();
    // Kinematic bodies always count among those that move, but wake nobody.
    const auto wakes = [&](std::uint32_t i) { return s.bodies[i].is_dynamic() && s.mover_of[i] < s.movers.size(); };
    for (const auto& c : s.sleep.contacts) {
        if (!wakes(body_a(s, c)) && !wakes(body_b(s, c))) continue;
        if (s.woken_pairs.empty() || s.woken_pairs.back() < c.key()) s.woken_pairs.push(c.key());
    }
    s.found.swap(s.woken_contacts);
    const bool good = find_contacts(s, s.woken_pairs, s.sleep.contacts, s.sleep.step, h, hands, false).mixed;
    merge_contacts(s.woken_contacts, s.found);
    s.found.swap(s.woken_contacts);
    return good;
}

}  // namespace detail

PHYSICS_HPP_END
