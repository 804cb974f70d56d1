// On which side of a line or plane a point lies: never wrong, so that what is built on it never breaks.
#pragma once

#include "physics/space/vec.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The smallest power of two above |x|; x finite and normal, or 0, which gives the smallest of all.
inline double power_above(double x) {
    const std::uint64_t exponent = detail::bit_cast<std::uint64_t>(x) >> 52 & 0x7ff;
    return detail::bit_cast<double>((exponent < 2046 ? exponent + 1 : exponent) << 52);
}

/// high * 2^64 + low, of which the sign is wanted.
struct sum192 {
    int128 high, low;

    /// Adds m * d, |d| < 2^61, for |m| < 2^122.
    void add(int128 m, std::int64_t d) {
        high = high + product128((m >> 64).low(), d);
        const int128 rest(product128(static_cast<std::uint64_t>(m.low()), magnitude64(d)));
        low = d < 0 ? low - rest : low + rest;
    }
    [[nodiscard]] int sign() const {
        const int128 top = high + (low >> 64);
        if (top.negative()) return -1;
        return top == int128{} && low.low() == 0 ? 0 : 1;
    }
};

/// Orientation of points whose coordinates are below `size` in magnitude: the exact answer for the points' places on
/// a grid of size * 2^-59, which is finer than the spacing of numbers near size. As a function of fixed points it has
/// no contradictions, whatever rounding does. Cost: 2 ns where doubles decide, 20-40 ns where integers have to.
/// Source: the idea of filters is Shewchuk's, Adaptive precision floating-point arithmetic and fast robust geometric
/// predicates (1997); integers take the place of his expansions.
class orientation {
public:
    /// size: a power of two from 2^-900 to 2^900.
    explicit orientation(double size) : scale_(0x1p59 / size), step_(size * 0x1p-59) {}

    /// 1 if d lies where (b - a) x (c - a) points, -1 on the other side, 0 in the plane.
    [[nodiscard]] int of(const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c,
                         const vec<double, 3>& d) const {
        return side(plane(*this, a, b, c), a, b, c, d);
    }
    /// 1 if c lies to the left of the line from a to b, -1 to its right, 0 on it.
    [[nodiscard]] int of(const vec<double, 2>& a, const vec<double, 2>& b, const vec<double, 2>& c) const {
        const vec<double, 2> e = b - a, f = c - a;
        const double det = e.x * f.y - e.y * f.x, le = largest(e), lf = largest(f);
        const double error = 0x1p-49 * le * lf + 8 * step_ * (le + lf + step_);
        if (det > error) return 1;
        if (det < -error) return -1;
        const int128 exact =
            product128(at(b.x) - at(a.x), at(c.y) - at(a.y)) - product128(at(b.y) - at(a.y), at(c.x) - at(a.x));
        return exact.negative() ? -1 : exact == int128{} ? 0 : 1;
    }

    /// A plane through three points, to be asked about many. The points are its caller's.
    class plane {
    public:
        plane() = default;
        plane(const orientation& grid, const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c)
            : normal_(cross(b - a, c - a)) {
            const double e = largest(b - a), f = largest(c - a), step = grid.step_;
            // Rounding of 6 products of three differences, and differences that the grid moves by up to 2 steps.
            constant_ = 16 * step * (e * f + step * (e + f + step));
            slope_ = 0x1p-46 * e * f + 16 * step * (e + f + step);
        }
        /// (b - a) x (c - a).
        [[nodiscard]] const vec<double, 3>& normal() const { return normal_; }

    private:
        friend class orientation;
        vec<double, 3> normal_;
        double constant_ = 0, slope_ = 0;
    };
    /// On which side of the plane through a, b and c the point p lies: 1 where the normal points, 0 in the plane.
    [[nodiscard]] int side(const plane& through, const vec<double, 3>& a, const vec<double, 3>& b,
                           const vec<double, 3>& c, const vec<double, 3>& p) const {
        const vec<double, 3> q = p - a;
        const double det = dot(through.normal_, q), error = through.constant_ + through.slope_ * largest(q);
        if (det > error) return 1;
        if (det < -error) return -1;
        return exact_side(a, b, c, p);
    }
    /// The same without asking doubles first.
    [[nodiscard]] PHYSICS_HPP_COLD int exact_side(const vec<double, 3>& a, const vec<double, 3>& b,
                                                  const vec<double, 3>& c, const vec<double, 3>& p) const {
        std::int64_t e[3], f[3], q[3];
        for (int i = 0; i < 3; ++i) {
            const std::int64_t from = at(a[i]);
            e[i] = at(b[i]) - from;
            f[i] = at(c[i]) - from;
            q[i] = at(p[i]) - from;
        }
        sum192 det{};
        for (int i = 0; i < 3; ++i) {
            const int j = i < 2 ? i + 1 : 0, k = i > 0 ? i - 1 : 2;
            det.add(product128(e[j], f[k]) - product128(e[k], f[j]), q[i]);
        }
        return det.sign();
    }

private:
    [[nodiscard]] std::int64_t at(double x) const { return static_cast<std::int64_t>(x * scale_); }

    double scale_, step_;
};

}  // namespace detail

PHYSICS_HPP_END
