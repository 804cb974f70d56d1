// Rows of four scalars into lanes and back: how kernels read and write bodies.
#pragma once

#include <cstdint>

#include "physics/base/pack.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Four packs that come from, or go to, W rows of four scalars: x holds the rows' first scalars.
template <class P>
struct quad {
    P x, y, z, w;
};

/// Rows of Stride scalars one after the other; lane i stands for the first four of row index[i]. Add 4 to base for the
/// next four. S is const where the rows are only read. (The stride is known here, since from one at run time clang
/// computes addresses in vectors and takes them apart again: 1.4 times slower.)
template <class S, int Stride>
struct indexed_rows {
    S* base;
    const std::uint32_t* index;

    using row = S[Stride];
    PHYSICS_HPP_ALWAYS_INLINE S* operator[](int lane) const { return reinterpret_cast<row*>(base)[index[lane]]; }
    PHYSICS_HPP_ALWAYS_INLINE indexed_rows from(int lane) const { return {base, index + lane}; }
};

/// Rows of Stride scalars one after the other; lane i stands for the first four of row i.
template <class S, int Stride>
struct consecutive_rows {
    S* base;

    PHYSICS_HPP_ALWAYS_INLINE S* operator[](int lane) const { return base + Stride * lane; }
    PHYSICS_HPP_ALWAYS_INLINE consecutive_rows from(int lane) const { return {base + Stride * lane}; }
};

#if PHYSICS_HPP_VECTOR_BYTES > 0

/// The transpose of four rows of four scalars; eight floats are two such rows side by side. Its own inverse. The order
/// of the shuffles is the one that stays within 16 bytes as long as possible.
template <class P>
PHYSICS_HPP_ALWAYS_INLINE quad<P> transposed(const P& r0, const P& r1, const P& r2, const P& r3) {
    if constexpr (P::width == 8) {
        const P a{PHYSICS_HPP_SHUFFLE(r0.value, r1.value, 0, 8, 1, 9, 4, 12, 5, 13)};
        const P b{PHYSICS_HPP_SHUFFLE(r2.value, r3.value, 0, 8, 1, 9, 4, 12, 5, 13)};
        const P c{PHYSICS_HPP_SHUFFLE(r0.value, r1.value, 2, 10, 3, 11, 6, 14, 7, 15)};
        const P d{PHYSICS_HPP_SHUFFLE(r2.value, r3.value, 2, 10, 3, 11, 6, 14, 7, 15)};
        return {{PHYSICS_HPP_SHUFFLE(a.value, b.value, 0, 1, 8, 9, 4, 5, 12, 13)},
                {PHYSICS_HPP_SHUFFLE(a.value, b.value, 2, 3, 10, 11, 6, 7, 14, 15)},
                {PHYSICS_HPP_SHUFFLE(c.value, d.value, 0, 1, 8, 9, 4, 5, 12, 13)},
                {PHYSICS_HPP_SHUFFLE(c.value, d.value, 2, 3, 10, 11, 6, 7, 14, 15)}};
    } else if constexpr (sizeof(P) == 16) {
        const P a{PHYSICS_HPP_SHUFFLE(r0.value, r1.value, 0, 4, 1, 5)};
        const P b{PHYSICS_HPP_SHUFFLE(r2.value, r3.value, 0, 4, 1, 5)};
        const P c{PHYSICS_HPP_SHUFFLE(r0.value, r1.value, 2, 6, 3, 7)};
        const P d{PHYSICS_HPP_SHUFFLE(r2.value, r3.value, 2, 6, 3, 7)};
        return {{PHYSICS_HPP_SHUFFLE(a.value, b.value, 0, 1, 4, 5)},
                {PHYSICS_HPP_SHUFFLE(a.value, b.value, 2, 3, 6, 7)},
                {PHYSICS_HPP_SHUFFLE(c.value, d.value, 0, 1, 4, 5)},
                {PHYSICS_HPP_SHUFFLE(c.value, d.value, 2, 3, 6, 7)}};
    } else {
        const P a{PHYSICS_HPP_SHUFFLE(r0.value, r1.value, 0, 4, 2, 6)};
        const P b{PHYSICS_HPP_SHUFFLE(r0.value, r1.value, 1, 5, 3, 7)};
        const P c{PHYSICS_HPP_SHUFFLE(r2.value, r3.value, 0, 4, 2, 6)};
        const P d{PHYSICS_HPP_SHUFFLE(r2.value, r3.value, 1, 5, 3, 7)};
        return {{PHYSICS_HPP_SHUFFLE(a.value, c.value, 0, 1, 4, 5)},
                {PHYSICS_HPP_SHUFFLE(b.value, d.value, 0, 1, 4, 5)},
                {PHYSICS_HPP_SHUFFLE(a.value, c.value, 2, 3, 6, 7)},
                {PHYSICS_HPP_SHUFFLE(b.value, d.value, 2, 3, 6, 7)}};
    }
}

#endif

/// Reads a row of four scalars for each lane: load4<P>(indexed_rows<const S, 8>{base, index}). Vectors transpose,
/// which takes half the time of picking scalars.
template <class P, class Rows>
PHYSICS_HPP_ALWAYS_INLINE quad<P> load4(Rows rows) {
    using S = typename P::scalar;
    if constexpr (P::width == 1) {
        const S* row = rows[0];
        return {{row[0]}, {row[1]}, {row[2]}, {row[3]}};
    } else if constexpr (requires { typename P::half; }) {
        const auto low = load4<typename P::half>(rows);
        const auto high = load4<typename P::half>(rows.from(P::width / 2));
        return {{low.x, high.x}, {low.y, high.y}, {low.z, high.z}, {low.w, high.w}};
#if PHYSICS_HPP_VECTOR_BYTES > 0
    } else if constexpr (P::width == 8) {
        using row = pack<S, 4, 16>;
        return transposed(
            join<P>(row::load(rows[0]), row::load(rows[4])), join<P>(row::load(rows[1]), row::load(rows[5])),
            join<P>(row::load(rows[2]), row::load(rows[6])), join<P>(row::load(rows[3]), row::load(rows[7])));
    } else if constexpr (P::width == 4) {
        return transposed(P::load(rows[0]), P::load(rows[1]), P::load(rows[2]), P::load(rows[3]));
    } else {
        const P a = P::load(rows[0]), b = P::load(rows[1]), c = P::load(rows[0] + 2), d = P::load(rows[1] + 2);
        return {{PHYSICS_HPP_SHUFFLE(a.value, b.value, 0, 2)},
                {PHYSICS_HPP_SHUFFLE(a.value, b.value, 1, 3)},
                {PHYSICS_HPP_SHUFFLE(c.value, d.value, 0, 2)},
                {PHYSICS_HPP_SHUFFLE(c.value, d.value, 1, 3)}};
#endif
    }
}

/// Writes a row of four scalars for each lane, in the order of the lanes: where two lanes stand for one row, the later
/// one stays.
template <class P, class Rows>
PHYSICS_HPP_ALWAYS_INLINE void store4(Rows rows, const quad<P>& columns) {
    if constexpr (P::width == 1) {
        auto* row = rows[0];
        row[0] = columns.x.value;
        row[1] = columns.y.value;
        row[2] = columns.z.value;
        row[3] = columns.w.value;
    } else if constexpr (requires { typename P::half; }) {
        using half = typename P::half;
        store4(rows, quad<half>{columns.x.low, columns.y.low, columns.z.low, columns.w.low});
        store4(rows.from(P::width / 2), quad<half>{columns.x.high, columns.y.high, columns.z.high, columns.w.high});
#if PHYSICS_HPP_VECTOR_BYTES > 0
    } else if constexpr (P::width == 2) {
        const auto x = columns.x.value, y = columns.y.value, z = columns.z.value, w = columns.w.value;
        P{PHYSICS_HPP_SHUFFLE(x, y, 0, 2)}.store(rows[0]);
        P{PHYSICS_HPP_SHUFFLE(z, w, 0, 2)}.store(rows[0] + 2);
        P{PHYSICS_HPP_SHUFFLE(x, y, 1, 3)}.store(rows[1]);
        P{PHYSICS_HPP_SHUFFLE(z, w, 1, 3)}.store(rows[1] + 2);
    } else {
        const quad<P> r = transposed(columns.x, columns.y, columns.z, columns.w);
        if constexpr (P::width == 4) {
            r.x.store(rows[0]);
            r.y.store(rows[1]);
            r.z.store(rows[2]);
            r.w.store(rows[3]);
        } else {
            half_of<false>(r.x).store(rows[0]);
            half_of<false>(r.y).store(rows[1]);
            half_of<false>(r.z).store(rows[2]);
            half_of<false>(r.w).store(rows[3]);
            half_of<true>(r.x).store(rows[4]);
            half_of<true>(r.y).store(rows[5]);
            half_of<true>(r.z).store(rows[6]);
            half_of<true>(r.w).store(rows[7]);
        }
#endif
    }
}

}  // namespace detail

PHYSICS_HPP_END
