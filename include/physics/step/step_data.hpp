// What a step works with: nothing of it outlives the step, but its memory.
#pragma once

#include "physics/collide/narrowphase.hpp"
#include "physics/dynamics/body.hpp"
#include "physics/dynamics/contact.hpp"
#include "physics/dynamics/continuous.hpp"
#include "physics/step/contact_index.hpp"
#include "physics/step/events.hpp"
#include "physics/step/joints.hpp"
#include "physics/step/pair_cache.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A body that goes far in a step, and what stops it.
template <int D>
struct swept_body {
    /// Its number, and that among those that move.
    std::uint32_t body, number;
    sweep_target against = sweep_target::fixed;
    /// Whether it may pass through something, or only be in it at the end of the step.
    bool goes_far = true;
    bool stops = false, converged = true;
    /// Whether it was in touch with what stops it as the step began, and how far along the normal it must then be moved
    /// at the end of the step, to be no deeper.
    bool touching = false;
    double push_out = 0;
    /// Whether another body that it has stopped stops it too.
    bool cut = false;
    std::uint32_t other = 0;
    double time = 1, cut_time = 1;
    /// From what stops it towards it, and the gap there (m).
    point<D> normal;
    double gap = 0;

    swept_body(std::uint32_t b, std::uint32_t n, sweep_target a = sweep_target::fixed)
        : body(b), number(n), against(a) {}
};
/// What a moving body fills in a step.
template <int D>
struct swept_box {
    std::uint32_t body;
    aabb<double, D> box;
};
/// What continuous collision works with.
template <class Plan>
struct sweep_data {
    using S = typename Plan::scalar;

    /// How deep each body is in static ones, and which of them are: 0 of all others.
    buffer<S> depths;
    buffer<std::uint32_t> deep;
    /// Of every body, whether its boxes overlap those of something that stands.
    buffer<bool> near_static;
    buffer<swept_body<Plan::dimension>> swept_bodies;
    buffer<swept_box<Plan::dimension>> moving_bodies, pushers;
    buffer<std::uint64_t> candidates, spare;
    buffer<S> ahead;
};
struct no_sweep_data {};
template <class Plan>
using sweep_data_of = std::conditional_t<Plan::is_continuous, sweep_data<Plan>, no_sweep_data>;

template <class Plan>
using step_joints_of =
    std::conditional_t<Plan::has_joints, step_joints<typename Plan::scalar, Plan::dimension, typename Plan::joints>,
                       no_step_joints>;

/// Pairs of shapes that are near each other in a step, but let pass by the recipe's contact rule.
template <bool HasRule, class S, int D>
struct passing_list {
    buffer<proxy_pair> pairs;
    /// For rules that look again.
    manifold_list<S, D> again;

    void add(proxy_pair pair) { pairs.push_back(pair); }
    void clear() { pairs.clear(); }
    [[nodiscard]] bool has(proxy_pair pair) const {
        const std::uint32_t i = count_before(pairs, [&](proxy_pair p) { return p < pair; });
        return i < pairs.size() && pairs[i] == pair;
    }
    /// Takes over those of all workers.
    void take(per_worker<passing_list>& by, std::uint32_t workers) {
        pairs.clear();
        for (std::uint32_t k = 0; k < workers; ++k) {
            for (const proxy_pair pair : by[k].pairs) pairs.push_back(pair);
            by[k].clear();
        }
        sort_in_place(pairs.begin(), pairs.size(), [](proxy_pair x, proxy_pair y) { return x < y; });
    }
};
template <class S, int D>
struct passing_list<false, S, D> {
    void clear() {}
    void take(per_worker<passing_list>&, std::uint32_t) {}
};
template <class Plan>
using passing_pairs = passing_list<Plan::has_contact_rule, typename Plan::scalar, Plan::dimension>;

/// Whether a step is under way.
struct step_flag {
    bool on = false;
};

template <class Plan>
struct step_data {
    using S = typename Plan::scalar;
    static constexpr int D = Plan::dimension;
    using contact = typename Plan::contact;

    step_flag in_step;
    /// What the step finds, to become the state's.
    buffer<contact> new_contacts;
    [[no_unique_address]] combined_material<S, typename Plan::features> new_material;
    [[no_unique_address]] passing_pairs<Plan> passing;
    detail::pair_cache_changes<Plan> pair_cache_changes;
    /// All that holds bodies together: of contacts, in their order, behind them of joints.
    buffer<edge> edges;
    [[no_unique_address]] step_joints_of<Plan> joints;
    /// Bodies that are woken by the step, or by a change between steps; of the latter, and of what kinematic bodies run
    /// into, each is noted.
    buffer<std::uint32_t> woken;
    bit_array is_listed;
    buffer<proxy_pair> woken_pairs;
    buffer<contact> woken_contacts;
    [[no_unique_address]] sweep_data_of<Plan> sweep;
    /// What the last step told, and the contacts of each body: both follow from the state, and last until that changes.
    [[no_unique_address]] step_events_of<Plan> events;
    mutable contact_index contacts_of;

    arena scratch;
    per_worker<arena> batch_scratch;
    /// What each worker has found.
    per_worker<manifold_list<S, D>> manifolds;
    per_worker<buffer<contact>> contacts_by_worker;
    per_worker<passing_pairs<Plan>> passing_by_worker;
    buffer<unsigned char> tasks_done;

    /// Contacts have gone from the list of those that can be pushed to that of sleepers, or back.
    void note_contacts_moved() {
        contacts_of.is_stale = true;
        if constexpr (Plan::events::contacts) events.is_stale = true;
    }
    /// The world has come to another state than that which it stepped to.
    void forget() {
        events.forget();
        contacts_of.is_stale = true;
    }
};

/// The edges of a step's joints.
template <class Plan>
edge_range joint_edges(const step_data<Plan>& d) {
    if constexpr (Plan::has_joints) return {d.edges.begin() + d.joints.begin[0], d.edges.end()};
    else return {};
}

}  // namespace detail

PHYSICS_HPP_END
