// What each pair of kinds of shapes does to meet.
#pragma once

#include "physics/base/handle.hpp"
#include "physics/collide/hull2.hpp"
#include "physics/collide/pair_memory.hpp"
#include "physics/collide/pairs2.hpp"
#include "physics/collide/pairs3.hpp"
#include "physics/collide/parts.hpp"
#include "physics/collide/persistent_manifold.hpp"

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
    /// Which of the memories is this pair's.
    std::uint32_t memory = no_memory;

    static constexpr std::uint32_t no_memory = detail::null_index;
};

namespace detail {

/// True if the general kernels serve a pair, in this order.
template <class A, class B>
concept collides_by_cores = has_core<A> &&(has_core<B> || is_halfspace<B>);

/// True if a pair meets part by part, in this order. Surfaces and halfspaces carry no mass and never meet.
template <class A, class B, int D>
concept collides_by_parts = (is_surface<A, D> &&
                             (has_core<B> || is_compound<B, D> || is_surface<B, D> || is_halfspace<B>)) ||
                            (is_compound<A, D> && (has_core<B> || is_compound<B, D> || is_halfspace<B>));

/// How a narrowphase treats pairs of convex shapes.
struct pair_methods {
    /// Whether closed forms serve pairs that the general kernels could.
    bool closed_forms = true;
    /// Whether a manifold gathers the deepest points of several steps; otherwise each step finds all of it.
    bool persistent = false;
    overlap_method overlaps = overlap_method::epa;
};

/// Whether a closed form serves a pair, in either order.
template <pair_methods Methods, class A, class B, class S, int D>
constexpr bool is_closed = (Methods.closed_forms || !(collides_by_cores<A, B> || collides_by_cores<B, A>)) &&
                           (collides_by_itself<A, B, S, D> || collides_by_itself<B, A, S, D>);

/// Whether a closed form costs more than to carry along what it found.
template <class A, class B>
constexpr bool is_dear = false;
template <class S>
constexpr bool is_dear<box<S, 3>, box<S, 3>> = true;
template <class S>
constexpr bool is_dear<capsule<S, 3>, box<S, 3>> = true;
template <class A, class S>
constexpr bool is_dear<A, hull<S, 2>> = true;

/// Whether it pays to remember what was found of a pair.
template <pair_methods Methods, class A, class B, class S, int D>
constexpr bool is_remembered = has_core<A>&& has_core<B> &&
                               (!is_closed<Methods, A, B, S, D> || is_dear<A, B> || is_dear<B, A>);

/// Functions for every ordered pair of a closed set of shapes, by their numbers within it.
template <pair_methods Methods, class S, int D, template <class, int> class... Shapes>
struct pair_table {
    using any = any_shape<S, D, Shapes...>;
    using query = narrowphase_query<S, D, Shapes...>;
    using memory = std::conditional_t<Methods.persistent, persistent_manifold<S, D>, pair_memory<S, D>>;
    using function = void (*)(const query&, std::uint32_t, S, memory*, manifold_list<S, D>&);

    /// What is remembered of a query's pair; null if nothing is.
    static memory* recalled(const query& q, memory* memories) {
        return memories != nullptr && q.memory != query::no_memory ? memories + q.memory : nullptr;
    }
    /// Adds what query q, of that number, finds; with what is remembered of the pair, if it is worth it.
    template <class A, class B>
    static void run(const query& q, std::uint32_t number, S margin, memory* m, manifold_list<S, D>& out) {
        const A& a = q.a->template get<A>();
        const B& b = q.b->template get<B>();
        if constexpr (collides_by_parts<A, B, D>) {
            run_parts(a, b, q.b_in_a, number, margin, out);
        } else if constexpr (collides_by_parts<B, A, D>) {
            const std::uint32_t first = out.size();
            run_parts(b, a, inverse(q.b_in_a), number, margin, out);
            for (std::uint32_t i = first; i < out.size(); ++i) flipped_in_place(out[i].contact, q.b_in_a);
        } else {
            found_manifold<S, D>& found = out.emplace_back(number, 0u);
            run_convex(a, b, q.b_in_a, margin, m, found.contact);
            if (found.contact.count == 0) out.pop_back();
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
    static void flipped_in_place(manifold<S, D>& m, const transform<S, D>& b_in_a) {
        m.normal = -(b_in_a.rotation * m.normal);
        for (int i = 0; i < m.count; ++i) m.points[i].position = b_in_a * m.points[i].position;
    }
    template <class A, class B>
    static void run_convex(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, memory* m,
                           manifold<S, D>& out) {
        if constexpr (!is_remembered<Methods, A, B, S, D>) {
            run(a, b, b_in_a, margin, nullptr, out);
        } else if constexpr (Methods.persistent) {
            memory none;
            gather_contact(a, b, b_in_a, margin, Methods.overlaps, m != nullptr ? *m : none, out);
        } else if (m == nullptr) {
            run(a, b, b_in_a, margin, nullptr, out);
        } else if (is_still(*m, b_in_a)) {
            carry_along(*m, b_in_a, margin, out);
        } else {
            if (m->contact.count == 0 && still_parted(a, b, b_in_a, margin, m->cache)) return;
            run(a, b, b_in_a, margin, &m->cache, out);
            remember(a, b, b_in_a, out, *m);
        }
    }
    template <class A, class B>
    static void run(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, gjk_cache* cache,
                    manifold<S, D>& out) {
        if constexpr (is_closed<Methods, A, B, S, D>) {
            if constexpr (collides_by_itself<A, B, S, D>) collide(a, b, b_in_a, margin, out);
            else run_swapped(a, b, b_in_a, margin, cache, out);
        } else if constexpr (has_core<A> && has_core<B>) {
            // One order is made of the other, so that both say the same.
            if constexpr (any::template kind_of<A>() > any::template kind_of<B>())
                run_swapped(a, b, b_in_a, margin, cache, out);
            else collide_cores(a, b, b_in_a, margin, cache, Methods.overlaps, out);
        } else if constexpr (has_core<A> && is_halfspace<B>) {
            collide_with_plane(a, b, b_in_a, margin, out);
        } else {
            run_swapped(a, b, b_in_a, margin, cache, out);
        }
    }
    template <class A, class B>
    static void run_swapped(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, gjk_cache* cache,
                            manifold<S, D>& out) {
        run(b, a, inverse(b_in_a), margin, cache, out);
        flipped_in_place(out, b_in_a);
    }
    template <class A>
    static constexpr void fill_row(function* row, bool* remembered) {
        int i = 0;
        ((row[i] = run<A, Shapes<S, D>>, remembered[i++] = is_remembered<Methods, A, Shapes<S, D>, S, D>), ...);
    }
    struct rows {
        function entry[sizeof...(Shapes)][sizeof...(Shapes)];
        bool remembered[sizeof...(Shapes)][sizeof...(Shapes)];
    };
    static constexpr rows make() {
        rows t{};
        int i = 0;
        ((fill_row<Shapes<S, D>>(t.entry[i], t.remembered[i]), ++i), ...);
        return t;
    }
    static constexpr rows table = make();
};

}  // namespace detail

PHYSICS_HPP_END
