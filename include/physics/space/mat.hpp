// Square matrices, by columns, and symmetric 3x3 matrices.
#pragma once

#include "physics/space/vec.hpp"

PHYSICS_HPP_BEGIN

/// A D x D matrix, stored by columns.
template <class S, int D>
struct mat {
    vec<S, D> column[D];

    static constexpr mat identity() {
        mat m{};
        for (int i = 0; i < D; ++i) m.column[i][i] = S(1);
        return m;
    }
};

template <class S, int D>
constexpr vec<S, D> operator*(const mat<S, D>& m, vec<S, D> v) {
    vec<S, D> result;
    for (int i = 0; i < D; ++i) {
        wide_of<S> sum = product(m.column[0][i], v[0]) + product(m.column[1][i], v[1]);
        if constexpr (D == 3) sum = sum + product(m.column[2][i], v[2]);
        result[i] = narrow<S>(sum);
    }
    return result;
}
template <class S, int D>
constexpr mat<S, D> operator*(const mat<S, D>& a, const mat<S, D>& b) {
    mat<S, D> m{};
    for (int i = 0; i < D; ++i) m.column[i] = a * b.column[i];
    return m;
}
template <class S, int D>
constexpr bool operator==(const mat<S, D>& a, const mat<S, D>& b) {
    for (int i = 0; i < D; ++i)
        if (!(a.column[i] == b.column[i])) return false;
    return true;
}

/// The transposed matrix times v: the dot products of the columns with v.
template <class S>
constexpr vec<S, 2> transposed_times(const mat<S, 2>& m, vec<S, 2> v) {
    return {dot(m.column[0], v), dot(m.column[1], v)};
}
template <class S>
constexpr vec<S, 3> transposed_times(const mat<S, 3>& m, vec<S, 3> v) {
    return {dot(m.column[0], v), dot(m.column[1], v), dot(m.column[2], v)};
}
template <class S, int D>
constexpr mat<S, D> transposed(const mat<S, D>& m) {
    mat<S, D> t{};
    for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) t.column[i][j] = m.column[j][i];
    return t;
}

/// A symmetric 3x3 matrix by its six entries.
template <class S>
struct symmetric {
    S xx{}, yy{}, zz{}, xy{}, xz{}, yz{};

    static constexpr symmetric diagonal(S x, S y, S z) { return {x, y, z, S(0), S(0), S(0)}; }
    friend bool operator==(const symmetric&, const symmetric&) = default;
};

template <class S>
constexpr symmetric<S> operator+(const symmetric<S>& a, const symmetric<S>& b) {
    return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
}
template <class S>
constexpr symmetric<S> operator*(const symmetric<S>& a, std::type_identity_t<S> s) {
    return {a.xx * s, a.yy * s, a.zz * s, a.xy * s, a.xz * s, a.yz * s};
}

/// Matrix times vector; the matrix may be of a finer format than the vector.
template <class I, class S>
constexpr vec<S, 3> times(const symmetric<I>& m, vec<S, 3> v) {
    return {narrow<S>(product(m.xx, v.x) + product(m.xy, v.y) + product(m.xz, v.z)),
            narrow<S>(product(m.xy, v.x) + product(m.yy, v.y) + product(m.yz, v.z)),
            narrow<S>(product(m.xz, v.x) + product(m.yz, v.y) + product(m.zz, v.z))};
}

/// r * m * r^T for a rotation matrix r: m as seen from the frame that r leads to.
template <class I, class S>
constexpr symmetric<I> rotated(const symmetric<I>& m, const mat<S, 3>& r) {
    const auto row = [&](int i) {
        const S x = r.column[0][i], y = r.column[1][i], z = r.column[2][i];
        struct {
            I x, y, z;
        } result{narrow<I>(product(m.xx, x) + product(m.xy, y) + product(m.xz, z)),
                 narrow<I>(product(m.xy, x) + product(m.yy, y) + product(m.yz, z)),
                 narrow<I>(product(m.xz, x) + product(m.yz, y) + product(m.zz, z))};
        return result;
    };
    const auto entry = [&](const auto& a, int j) {
        return narrow<I>(product(a.x, r.column[0][j]) + product(a.y, r.column[1][j]) + product(a.z, r.column[2][j]));
    };
    const auto x = row(0), y = row(1), z = row(2);
    return {entry(x, 0), entry(y, 1), entry(z, 2), entry(x, 1), entry(x, 2), entry(y, 2)};
}

/// The inverse of a positive definite matrix in the finer format I; all zero if it is not positive
/// definite. By L D L^T, which needs no determinant: that would leave a fixed-point range.
template <class I, class S>
constexpr symmetric<I> inverse(const symmetric<S>& m) {
    const S d1 = m.xx;
    if (!(d1 > S(0))) return {};
    const S l21 = m.xy / d1, l31 = m.xz / d1;
    const S d2 = m.yy - l21 * m.xy;
    if (!(d2 > S(0))) return {};
    const S l32 = (m.yz - l21 * m.xz) / d2;
    const S d3 = m.zz - l31 * m.xz - l32 * (l32 * d2);
    if (!(d3 > S(0))) return {};
    const I e1 = reciprocal<I>(d1), e2 = reciprocal<I>(d2), e3 = reciprocal<I>(d3);
    const S m31 = l21 * l32 - l31;
    const I xy2 = -mul<I>(e2, l21), yz3 = -mul<I>(e3, l32), xz3 = mul<I>(e3, m31);
    return {e1 - mul<I>(xy2, l21) + mul<I>(xz3, m31), e2 - mul<I>(yz3, l32), e3, xy2 - mul<I>(xz3, l32), xz3, yz3};
}

PHYSICS_HPP_END
