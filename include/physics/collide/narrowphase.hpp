// The narrowphase policy: from pairs of shapes to manifolds.
#pragma once

#include "physics/base/stage.hpp"
#include "physics/collide/box_batch.hpp"

PHYSICS_HPP_BEGIN

/// True if the pair can meet: a function collide(a, b, ...) exists in either order, or the general kernels serve it, as
/// both have a core (see core.hpp) or consist of parts (see parts.hpp).
template <class A, class B, class S, int D>
concept collidable =
    collides_by_itself<A, B, S, D> || collides_by_itself<B, A, S, D> || detail::collides_by_cores<A, B> ||
    detail::collides_by_cores<B, A> || detail::collides_by_parts<A, B, D> || detail::collides_by_parts<B, A, D>;

/// A narrowphase policy: turns a batch of pairs into manifolds. Its in<S, D, Shapes...> has
///   collide(queries, count, margin, list)   adds to a manifold_list where shapes touch that are within margin (m)
///                                           of each other
/// and, if it remembers something of pairs from step to step,
///   memory                                  what it remembers of one pair; trivially copyable, new ones are made by
///                                           memory{}, digest() is 64 bits of it for world.state_hash()
///   remembers(kind, kind)                   whether it does so of shapes of those kinds
///   collide(queries, count, margin, memories, list)
///                                           the same; queries name their memory among these
/// What it remembers of pairs that do not touch must not bear on any result, and have the digest 0: which of these
/// there are depends on the broadphase.
template <class Policy, class S, int D, template <class, int> class... Shapes>
concept narrowphase_for = requires(const narrowphase_query<S, D, Shapes...>* queries, manifold_list<S, D> found) {
    Policy::template in<S, D, Shapes...>::collide(queries, std::uint32_t{}, S(0), found);
};

namespace detail {

/// A narrowphase that treats each pair with the function that its table has for it; pairs of boxes several at a time.
template <pair_methods Methods>
struct pairwise_narrowphase {
    using stage = physics::stage::narrowphase;

    template <class S, int D, template <class, int> class... Shapes>
    struct in {
        using query = narrowphase_query<S, D, Shapes...>;
        using pairs = pair_table<Methods, S, D, Shapes...>;
        using memory = typename pairs::memory;

        static constexpr bool remembers(int kind_a, int kind_b) { return pairs::table.remembered[kind_a][kind_b]; }
        static void collide(const query* queries, std::uint32_t count, S margin, memory* memories,
                            manifold_list<S, D>& found) {
            using boxes = box_batch<Methods, S, D, Shapes...>;
            if constexpr (boxes::is_used) {
                for (std::uint32_t first = 0; first < count; first += boxes::capacity) {
                    const std::uint32_t chunk = count - first < boxes::capacity ? count - first : boxes::capacity;
                    const boxes batch(queries + first, chunk, margin, memories);
                    for (std::uint32_t i = 0; i < chunk; ++i)
                        if (!batch.add(i, first + i, found)) collide_one(queries, first + i, margin, memories, found);
                }
            } else {
                for (std::uint32_t i = 0; i < count; ++i) collide_one(queries, i, margin, memories, found);
            }
        }
        static void collide(const query* queries, std::uint32_t count, S margin, manifold_list<S, D>& found) {
            collide(queries, count, margin, nullptr, found);
        }

    private:
        static void collide_one(const query* queries, std::uint32_t i, S margin, memory* memories,
                                manifold_list<S, D>& found) {
            const query& q = queries[i];
            pairs::table.entry[q.a->kind()][q.b->kind()](q, i, margin, pairs::recalled(q, memories), found);
        }
    };
};

}  // namespace detail

/// The default narrowphase: for each pair of kinds the method that suits it best: closed forms, separating axes with
/// clipping, and for all others GJK, EPA and clipping. Manifolds that are dear to find are carried along while their
/// pair moves by less than 1/512 of its smaller half extent. Cost: 0.1-0.5 us a pair; 0.3-7 us by GJK and EPA.
struct best_per_pair : detail::pairwise_narrowphase<detail::pair_methods{}> {};
/// GJK and EPA for all pairs of convex shapes, also where a closed form is faster.
struct gjk_epa : detail::pairwise_narrowphase<detail::pair_methods{.closed_forms = false}> {};
/// GJK while shapes are apart, MPR where they overlap: faster than EPA, and deep overlaps may be parted by a longer way
/// than the shortest.
struct gjk_mpr : detail::pairwise_narrowphase<detail::pair_methods{.closed_forms = false,
                                                                   .overlaps = detail::overlap_method::mpr}> {};
/// GJK and EPA, which add their one deepest point a step to a manifold that persists: no clipping, and a face that
/// lands has all its points after some steps only. Pairs without memory get one point.
struct incremental_manifolds
    : detail::pairwise_narrowphase<detail::pair_methods{.closed_forms = false, .persistent = true}> {};

PHYSICS_HPP_END
