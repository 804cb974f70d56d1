// The narrowphase policy: from pairs of shapes to manifolds.
#pragma once

#include "physics/base/stage.hpp"
#include "physics/collide/hull2.hpp"
#include "physics/collide/pairs2.hpp"
#include "physics/collide/pairs3.hpp"
#include "physics/collide/parts.hpp"

PHYSICS_HPP_BEGIN

/// True if the pair has a function of its own, in this order.
template <class A, class B, class S, int D>
concept collides_by_itself = requires(const A a, const B b, const transform<S, D> t, S margin, manifold<S, D> out) {
    collide(a, b, t, margin, out);
};

/// One pair of shapes to test.
template <class S, int D, template <class, int> class... Shapes>
struct narrowphase_query {
    const any_shape<S, D, Shapes...>* a;
    const any_shape<S, D, Shapes...>* b;
    transform<S, D> b_in_a;
};

namespace detail {

template <class Shape>
constexpr bool is_halfspace = false;
template <class S, int D>
constexpr bool is_halfspace<halfspace<S, D>> = true;

/// True if the general kernels serve a pair, in this order.
template <class A, class B>
concept collides_by_cores = has_core<A> && (has_core<B> || is_halfspace<B>);

/// True if a pair meets part by part, in this order. Surfaces and halfspaces carry no mass and never meet.
template <class A, class B, int D>
concept collides_by_parts =
    (is_surface<A, D> && (has_core<B> || is_compound<B, D> || is_surface<B, D> || is_halfspace<B>)) ||
    (is_compound<A, D> && (has_core<B> || is_compound<B, D> || is_halfspace<B>));

/// How a narrowphase treats the pairs that both a closed form and the general kernels could.
struct pair_methods {
    bool closed_forms = true;
    overlap_method overlaps = overlap_method::epa;
};

/// Functions for every ordered pair of a closed set of shapes, by their numbers within it.
template <pair_methods Methods, class S, int D, template <class, int> class... Shapes>
struct pair_table {
    using any = any_shape<S, D, Shapes...>;
    using query = narrowphase_query<S, D, Shapes...>;
    using function = void (*)(const query&, std::uint32_t, S, manifold_list<S, D>&);

    /// Adds what query q, of that number, finds.
    template <class A, class B>
    static void run(const query& q, std::uint32_t number, S margin, manifold_list<S, D>& out) {
        const A& a = q.a->template get<A>();
        const B& b = q.b->template get<B>();
        if constexpr (collides_by_parts<A, B, D>) {
            run_parts(a, b, q.b_in_a, number, margin, out);
        } else if constexpr (collides_by_parts<B, A, D>) {
            const std::uint32_t first = out.size();
            run_parts(b, a, inverse(q.b_in_a), number, margin, out);
            for (std::uint32_t i = first; i < out.size(); ++i) turn_round(out[i].contact, q.b_in_a);
        } else {
            found_manifold<S, D>& found = out.push({number, 0, {}});
            run(a, b, q.b_in_a, margin, found.contact);
            if (found.contact.count == 0) out.pop();
        }
    }
    template <class A, class B>
    static void run_parts(const A& a, const B& b, const transform<S, D>& b_in_a, std::uint32_t number, S margin,
                          manifold_list<S, D>& out) {
        if constexpr (has_core<B> || is_compound<B, D>)
            collide_parts(a, b, b_in_a, margin, Methods.overlaps, number, out);
        else if constexpr (is_compound<A, D> && is_halfspace<B>)
            collide_children_with_plane(a, b, b_in_a, margin, number, out);
    }
    static void turn_round(manifold<S, D>& m, const transform<S, D>& b_in_a) {
        m.normal = -(b_in_a.rotation * m.normal);
        for (int i = 0; i < m.count; ++i) m.points[i].position = b_in_a * m.points[i].position;
    }
    template <class A, class B>
    static void run(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, manifold<S, D>& out) {
        constexpr bool general = has_core<A> && has_core<B>;
        constexpr bool closed = Methods.closed_forms || !(collides_by_cores<A, B> || collides_by_cores<B, A>);
        if constexpr (closed && collides_by_itself<A, B, S, D>) {
            collide(a, b, b_in_a, margin, out);
        } else if constexpr (closed && collides_by_itself<B, A, S, D>) {
            run_swapped(a, b, b_in_a, margin, out);
        } else if constexpr (general && any::template kind_of<A>() > any::template kind_of<B>()) {
            // One order is made of the other, so that both say the same.
            run_swapped(a, b, b_in_a, margin, out);
        } else if constexpr (has_core<A> && has_core<B>) {
            collide_cores(a, b, b_in_a, margin, nullptr, Methods.overlaps, out);
        } else if constexpr (has_core<A> && is_halfspace<B>) {
            collide_with_plane(a, b, b_in_a, margin, out);
        } else {
            run_swapped(a, b, b_in_a, margin, out);
        }
    }
    template <class A, class B>
    static void run_swapped(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, manifold<S, D>& out) {
        run(b, a, inverse(b_in_a), margin, out);
        turn_round(out, b_in_a);
    }
    template <class A>
    static constexpr void fill_row(function* row) {
        int i = 0;
        ((row[i++] = run<A, Shapes<S, D>>), ...);
    }
    struct rows {
        function entry[sizeof...(Shapes)][sizeof...(Shapes)];
    };
    static constexpr rows make() {
        rows t{};
        int i = 0;
        (fill_row<Shapes<S, D>>(t.entry[i++]), ...);
        return t;
    }
    static constexpr rows table = make();
};

}  // namespace detail

/// True if the pair can meet: a function collide(a, b, ...) exists in either order, or the general kernels serve it, as
/// both have a core (see core.hpp) or consist of parts (see parts.hpp).
template <class A, class B, class S, int D>
concept collidable = collides_by_itself<A, B, S, D> || collides_by_itself<B, A, S, D> ||
                     detail::collides_by_cores<A, B> || detail::collides_by_cores<B, A> ||
                     detail::collides_by_parts<A, B, D> || detail::collides_by_parts<B, A, D>;

/// A narrowphase policy: turns a batch of pairs into manifolds. Its in<S, D, Shapes...> has
///   collide(queries, count, margin, list)   adds to a manifold_list where shapes touch that are within margin (m)
///                                           of each other
template <class Policy, class S, int D, template <class, int> class... Shapes>
concept narrowphase_for =
    requires(const narrowphase_query<S, D, Shapes...>* queries, manifold_list<S, D> found) {
        Policy::template in<S, D, Shapes...>::collide(queries, std::uint32_t{}, S(0), found);
    };

namespace detail {
/// A narrowphase that treats each pair with the function that its table has for it.
template <pair_methods Methods>
struct pairwise_narrowphase {
    using stage = physics::stage::narrowphase;

    template <class S, int D, template <class, int> class... Shapes>
    struct in {
        static void collide(const narrowphase_query<S, D, Shapes...>* queries, std::uint32_t count, S margin,
                            manifold_list<S, D>& found) {
            for (std::uint32_t i = 0; i < count; ++i) {
                const auto& q = queries[i];
                pair_table<Methods, S, D, Shapes...>::table.entry[q.a->kind()][q.b->kind()](q, i, margin, found);
            }
        }
    };
};
}  // namespace detail

/// The default narrowphase: for each pair of kinds the method that suits it best: closed forms, separating axes with
/// clipping, and for all others GJK, EPA and clipping. Cost: 0.1-0.5 us a pair; 0.3-7 us by GJK and EPA.
struct best_per_pair : detail::pairwise_narrowphase<detail::pair_methods{}> {};
/// GJK and EPA for all pairs of convex shapes, also where a closed form is faster.
struct gjk_epa : detail::pairwise_narrowphase<detail::pair_methods{.closed_forms = false}> {};
/// GJK while shapes are apart, MPR where they overlap: faster than EPA, and deep overlaps may be parted by a longer way
/// than the shortest.
struct gjk_mpr : detail::pairwise_narrowphase<detail::pair_methods{.closed_forms = false,
                                                                    .overlaps = detail::overlap_method::mpr}> {};

PHYSICS_HPP_END
