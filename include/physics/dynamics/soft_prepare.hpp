// What preparing the soft solver's contacts in lanes is made of.
#pragma once

#include <cstddef>

#include "physics/dynamics/body_lanes.hpp"
#include "physics/dynamics/contact.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// What contacts are prepared in: scalars that hold no inverse masses by way of double, which has room for their
/// products; others as they are.
template <class S, int W>
using preparing = kernel_pack<std::conditional_t<std::is_same_v<inverse_of<S>, S>, S, double>, W>;

/// W contacts that are prepared together, some of which may be none. Contacts are rows of scalars, which lanes read
/// faster than one by one.
template <class S, int D, int W, class Features>
class contact_gather {
    using contact = solver_api::contact<S, D, Features>;
    using P = kernel_pack<S, W>;

public:
    static constexpr int capacity = manifold<S, D>::capacity;

    contact_gather() {
        for (const contact*& one : at_) one = &none;
    }
    void add(int lane, const contact& c) { at_[lane] = &c; }

    /// Where points are from their middles, in world axes, 1 for each point that there is, and how many there are.
    S offset[capacity][D][W], there[capacity][W], count[W];

    /// Reads where contacts with up to `maximum` points lie, and writes that to their frames and points.
    template <class Frame, class Point>
    PHYSICS_HPP_ALWAYS_INLINE void read(Frame& to, Point* to_points, int maximum) {
        const S* rows[W];
        for (int lane = 0; lane < W; ++lane) {
            rows[lane] = &at_[lane]->normal[0];
            count[lane] = S(int{at_[lane]->count});
        }
        P frame[3 * D], place[capacity][D + 1], middle[D];
        read_rows(frame, rows);
        const P zero = P::broadcast(S(0)), one = P::broadcast(S(1)), points = P::load(count);
        for (int i = 0; i < D; ++i) middle[i] = zero;
        for (int k = 0; k < maximum; ++k) {
            for (int lane = 0; lane < W; ++lane) rows[lane] = &at_[lane]->points[k].position[0];
            read_rows(place[k], rows);
            const P is = select_greater(points, P::broadcast(S(k)), one, zero);
            is.store(there[k]);
            for (P& component : place[k]) component = select_greater(is, zero, component, zero);
            place[k][D].store(to_points[k].separation);
            for (int i = 0; i < D; ++i) middle[i] = k == 0 ? place[0][i] : middle[i] + place[k][i];
        }
        const P share = one / max(points, one);
        // In 3D friction has its lever from each body's own surface: from halfway between them, that of a needle which
        // is tilted over the ground would be many times as long as the one about its own axis is.
        P half_gap = zero;
        if constexpr (D == 3) {
            for (int k = 0; k < maximum; ++k) half_gap = half_gap + place[k][D];
            half_gap = max(half_gap, zero) * share * P::broadcast(S(0.5));
        }
        for (int i = 0; i < D; ++i) {
            middle[i] = middle[i] * share;
            frame[i].store(to.normal[i]);
            P on_a = middle[i], on_b = middle[i];
            if constexpr (D == 3) {
                on_a = on_a - half_gap * frame[i];
                on_b = on_b + half_gap * frame[i];
            }
            (frame[D + i] + on_a).store(to.r_a[i]);
            (frame[2 * D + i] + on_b).store(to.r_b[i]);
            for (int k = 0; k < maximum; ++k)
                select_greater(P::load(there[k]), zero, place[k][i] - middle[i], zero).store(offset[k][i]);
        }
    }

private:
    struct rows_from {
        const S* const* first;
        int skipped;

        PHYSICS_HPP_ALWAYS_INLINE const S* operator[](int lane) const { return first[lane] + skipped; }
        PHYSICS_HPP_ALWAYS_INLINE rows_from from(int lane) const { return {first + lane, skipped}; }
    };
    /// The first N scalars of each row. Lanes read on to a multiple of four, which is still within the contact.
    template <int N>
    PHYSICS_HPP_ALWAYS_INLINE static void read_rows(P (&to)[N], const S* const (&rows)[W]) {
        if constexpr (W == 1) {
            for (int i = 0; i < N; ++i) to[i] = {rows[0][i]};
        } else {
            for (int i = 0; i < N; i += 4) {
                const quad<P> four = load4<P>(rows_from{rows, i});
                to[i] = four.x;
                if (i + 1 < N) to[i + 1] = four.y;
                if (i + 2 < N) to[i + 2] = four.z;
                if (i + 3 < N) to[i + 3] = four.w;
            }
        }
    }
    static_assert(offsetof(contact, r_a) == offsetof(contact, normal) + D * sizeof(S) &&
                  offsetof(contact, r_b) == offsetof(contact, r_a) + D * sizeof(S) &&
                  sizeof(contact) >= offsetof(contact, normal) + (D == 2 ? 8 : 12) * sizeof(S));
    using point = contact_point<S, D, Features>;
    static_assert(offsetof(point, separation) == offsetof(point, position) + D * sizeof(S) &&
                  sizeof(point) >= offsetof(point, position) + 4 * sizeof(S));

    static inline const contact none{};
    const contact* at_[W];
};

}  // namespace detail

PHYSICS_HPP_END
