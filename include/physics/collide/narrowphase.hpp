// The narrowphase policy: from pairs of shapes to manifolds.
#pragma once

#include "physics/base/stage.hpp"
#include "physics/collide/pairs2.hpp"
#include "physics/collide/pairs3.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Functions for every ordered pair of a closed set of shapes, by their numbers within it.
template <class S, int D, template <class, int> class... Shapes>
struct pair_table {
    using any = any_shape<S, D, Shapes...>;
    using function = void (*)(const any&, const any&, const transform<S, D>&, S, manifold<S, D>&);

    template <class A, class B>
    static void run(const any& a, const any& b, const transform<S, D>& b_in_a, S margin, manifold<S, D>& out) {
        const A& shape_a = a.template get<A>();
        const B& shape_b = b.template get<B>();
        if constexpr (requires { collide(shape_a, shape_b, b_in_a, margin, out); }) {
            collide(shape_a, shape_b, b_in_a, margin, out);
        } else {
            collide(shape_b, shape_a, inverse(b_in_a), margin, out);
            out.normal = -(b_in_a.rotation * out.normal);
            for (int i = 0; i < out.count; ++i) out.points[i].position = b_in_a * out.points[i].position;
        }
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

/// One pair of shapes to test.
template <class S, int D, template <class, int> class... Shapes>
struct narrowphase_query {
    const any_shape<S, D, Shapes...>* a;
    const any_shape<S, D, Shapes...>* b;
    transform<S, D> b_in_a;
};

/// True if a function collide(a, b, ...) exists for the pair in either order.
template <class A, class B, class S, int D>
concept collidable = requires(const A a, const B b, const transform<S, D> t, S margin, manifold<S, D> out) {
    collide(a, b, t, margin, out);
}
|| requires(const A a, const B b, const transform<S, D> t, S margin, manifold<S, D> out) {
    collide(b, a, t, margin, out);
};

/// A narrowphase policy: turns a batch of pairs into manifolds. Its in<S, D, Shapes...> has
///   collide(queries, count, margin, manifolds)   fills one manifold a query, empty where the shapes are
///                                                farther apart than margin (m)
template <class Policy, class S, int D, template <class, int> class... Shapes>
concept narrowphase_for = requires(const narrowphase_query<S, D, Shapes...>* queries, manifold<S, D>* out) {
    Policy::template in<S, D, Shapes...>::collide(queries, std::uint32_t{}, S(0), out);
};

/// The default narrowphase: for each pair of kinds the method that suits it best; today closed forms and
/// separating axes with clipping. Cost: 20-400 ns a pair.
struct best_per_pair {
    using stage = physics::stage::narrowphase;

    template <class S, int D, template <class, int> class... Shapes>
    struct in {
        static void collide(const narrowphase_query<S, D, Shapes...>* queries, std::uint32_t count, S margin,
                            manifold<S, D>* out) {
            for (std::uint32_t i = 0; i < count; ++i) {
                const auto& q = queries[i];
                out[i] = {};
                detail::pair_table<S, D, Shapes...>::table.entry[q.a->kind()][q.b->kind()](*q.a, *q.b, q.b_in_a, margin,
                                                                                           out[i]);
            }
        }
    };
};

PHYSICS_HPP_END
