// What shapes made of parts share: how their geometry is stored, checked and bounded.
#pragma once

#include "physics/shape/core.hpp"
#include "physics/shape/part_tree.hpp"
#include "physics/shape/surface_part.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// A shape for calculations with the scalar T where that stores geometry in other numbers: it goes back.
template <class T, class Shape>
struct foreign_shape {
    using scalar = T;
    Shape shape;

    template <class U>
    [[nodiscard]] constexpr auto as() const {
        return shape.template as<U>();
    }
};
/// Whether shapes for S and T can refer to the same geometry.
template <class S, class T>
constexpr bool same_storage = std::is_same_v<hull_real<S>, hull_real<T>>;

/// Mixes a word into a number that geometries of the same content share on every system.
inline void mix_digest(std::uint64_t& digest, std::uint64_t word) {
    digest = (digest ^ word) * 0xff51afd7ed558ccdu;
    digest ^= digest >> 32;
}
template <int D>
void mix_digest(std::uint64_t& digest, const vec<double, D>& p) {
    for (int i = 0; i < D; ++i) mix_digest(digest, scalar_traits<double>::bits(p[i]));
}

/// Coordinates that S can hold with room to spare, floats can bound and doubles can multiply.
template <class S>
bool check_reach(const char* function, double reach) {
    const double maximum = min(1e30, static_cast<double>(scalar_traits<S>::max()) * 0.25);
    return reach <= maximum || refuse(function, "largest coordinate", reach,
                                      "it must be at most 1e30, and a quarter of the scalar's range");
}
/// A distance between parts whose square is a number too.
template <class S>
bool check_spacing(const char* function, const char* field, S spacing) {
    if (!check_positive(function, field, spacing)) return false;
    const double exact = static_cast<double>(spacing);
    return exact >= 1e-30 || refuse(function, field, exact, "it must be at least 1e-30");
}
/// Refuses a number or a point of an array by its place where it is not finite.
template <class T>
bool check_item(const char* function, const char* name, std::uint32_t i, const T& item) {
    if (is_finite(item)) return true;
    char field[40];
    std::snprintf(field, sizeof field, "%s[%u]", name, static_cast<unsigned>(i));
    return check_finite(function, field, item);
}
/// Points in double; false after a refusal.
template <class S, int D>
bool take_points(const char* function, const char* name, const vec<S, D>* points, std::uint32_t count,
                 buffer<vec<double, D>>& taken) {
    if (!check_array(function, name, points, count)) return false;
    taken.reserve(count);
    double reach = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (!check_item(function, name, i, points[i])) return false;
        reach = max(reach, largest(taken.push_back(to_point(points[i]))));
    }
    return check_reach<S>(function, reach);
}

/// The box around points, at least one.
template <int D>
aabb<double, D> box_around(const buffer<vec<double, D>>& points) {
    aabb<double, D> box{points[0], points[0]};
    for (const vec<double, D>& p : points) box = {min(box.lower, p), max(box.upper, p)};
    return box;
}
/// The largest coordinate of a box by magnitude.
template <int D>
double reach_of(const aabb<double, D>& box) {
    return max(largest(box.lower), largest(box.upper));
}

/// Whether a shape's geometry was built, and its radius is one.
template <class Shape>
bool check_surface(const Shape& shape, const char* owner, const char* function) {
    if (shape.geometry == nullptr) return refuse(function, "geometry", "null", owner);
    return check_not_negative(function, "radius", shape.radius);
}

/// Collects points and boxes of a frame, and gives the box around them where the frame stands.
template <class S, int D>
class turned_bounds {
public:
    explicit turned_bounds(const transform<S, D>& at) : at_(at), axes_(to_matrix(at.rotation)) {
        for (int i = 0; i < D; ++i) low_[i] = 1e300, high_[i] = -1e300;
    }
    void add(const vec<double, D>& p) {
        const vec<double, D> q = axes_ * p;
        low_ = min(low_, q);
        high_ = max(high_, q);
    }
    template <class R>
    void add(const aabb<R, D>& box) {
        vec<double, D> middle, reach;
        for (int i = 0; i < D; ++i) {
            const double lower = static_cast<double>(box.lower[i]), upper = static_cast<double>(box.upper[i]);
            middle += axes_.column[i] * ((lower + upper) * 0.5);
            reach += abs(axes_.column[i]) * ((upper - lower) * 0.5);
        }
        low_ = min(low_, middle - reach);
        high_ = max(high_, middle + reach);
    }
    /// Grown by a radius and by what rounding to S does to coordinates as large as those of `around`.
    [[nodiscard]] aabb<S, D> box(S radius, const aabb<double, D>& around) const {
        S slack = S(4 * static_cast<double>(scalar_traits<S>::epsilon()) * reach_of(around));
        if (!(slack > S(0))) slack = scalar_traits<S>::epsilon();
        aabb<S, D> result;
        for (int i = 0; i < D; ++i) {
            result.lower[i] = S(low_[i]) - (radius + slack);
            result.upper[i] = S(high_[i]) + (radius + slack);
        }
        return {at_.position + result.lower, at_.position + result.upper};
    }

private:
    const transform<S, D>& at_;
    mat<double, D> axes_;
    vec<double, D> low_, high_;
};
/// From how many points on the boxes of the tree stand for them.
inline constexpr std::uint32_t points_to_bound = 64;

}  // namespace detail

PHYSICS_HPP_END
