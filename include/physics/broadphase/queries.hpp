// What can be asked of boxes: exact answers, the same from every broadphase.
#pragma once

#include "physics/base/handle.hpp"
#include "physics/broadphase/proxies.hpp"

PHYSICS_HPP_BEGIN

/// Which proxies a query sees: those whose category is in its mask and whose mask holds its category. Groups do not
/// matter to queries.
struct query_filter {
    std::uint32_t category = 1;
    std::uint32_t mask = all_categories;
    /// Of which kinds of bodies it sees the shapes.
    body_kinds kinds = all_bodies;
    /// Whose proxies it does not see, say of the body that asks; null: none. A broadphase looks at the index alone,
    /// which is the owner; a world refuses the handle of what is gone.
    body_id except = {};
    /// Whether categories and masks do not matter to it.
    bool any_category = false;
    /// Whether it sees sensors too.
    bool sensors = false;
    /// Whether rays in a world meet shapes within which they begin.
    bool inside = true;
    /// Whether casts of shapes and collide_shape in a world meet shapes that are one_way from their upper side only, as
    /// bodies do; rays and overlaps meet them whole.
    bool one_way = false;

    [[nodiscard]] constexpr bool sees(const proxy_filter& p) const {
        return (any_category || ((p.category & mask) != 0 && (category & p.mask) != 0)) && (kinds & p.kinds) != 0 &&
               (sensors || !p.sensor) && (!except || p.owner != except.index);
    }
};

/// A way through space: from an origin along a translation (m). A box of half size `extent` may be swept along it.
template <class S, int D>
struct ray {
    vec<S, D> origin;
    vec<S, D> translation;
    vec<S, D> extent = {};
};

/// The half of space where dot(normal, p) <= offset; the normal need not have length 1.
template <class S, int D>
struct bounding_plane {
    vec<S, D> normal;
    S offset;
};

/// Where a ray enters the box of a proxy: at `fraction` of its translation, 0 if it begins within.
template <class S>
struct proxy_hit {
    std::uint32_t id = detail::null_index;
    S fraction = S(1);

    explicit operator bool() const { return id != detail::null_index; }
};

namespace detail {

/// Whether a ray meets a closed box within `limit` of its translation, and where it enters. Along an axis in which it
/// does not move, it meets what it is within, faces included. Source: Kay, Kajiya, Ray tracing complex scenes (1986).
template <class S, int D>
constexpr bool meets(const ray<S, D>& r, const aabb<S, D>& box, S limit, S& fraction) {
    S near = S(0), far = limit;
    for (int i = 0; i < D; ++i) {
        // Wide, since boxes may be as large as the range.
        const wide_of<S> translation = widen(r.translation[i]), extent = widen(r.extent[i]),
                         origin = widen(r.origin[i]);
        const wide_of<S> to_lower = widen(box.lower[i]) - extent - origin;
        const wide_of<S> to_upper = widen(box.upper[i]) + extent - origin;
        if (r.translation[i] == S(0)) {
            if (to_lower > wide_of<S>{} || to_upper < wide_of<S>{}) return false;
            continue;
        }
        const bool forward = r.translation[i] > S(0);
        near = max(near, quotient<S>(forward ? to_lower : to_upper, translation));
        far = min(far, quotient<S>(forward ? to_upper : to_lower, translation));
        if (near > far) return false;
    }
    fraction = near;
    return true;
}

/// The box around a whole ray, no larger than the range, with room for what meets() rounds.
template <class S, int D>
constexpr aabb<S, D> around(const ray<S, D>& r) {
    const S maximum = scalar_traits<S>::max(), step = scalar_traits<S>::epsilon() * S(4);
    aabb<S, D> box;
    for (int i = 0; i < D; ++i) {
        const S end = r.origin[i] + r.translation[i], low = min(r.origin[i], end), high = max(r.origin[i], end);
        const S rounded = abs(r.translation[i]) * step + (abs(low) * step + abs(high) * step) + step;
        const S reach = r.extent[i] > maximum - rounded ? maximum : r.extent[i] + rounded;
        box.lower[i] = low < reach - maximum ? -maximum : low - reach;
        box.upper[i] = high > maximum - reach ? maximum : high + reach;
    }
    return box;
}

/// The square of the distance from a point to a box, without rounding where the scalar can; 0 within.
template <class S, int D>
constexpr wide_of<S> distance_squared(const aabb<S, D>& box, const vec<S, D>& point) {
    vec<S, D> apart;
    for (int i = 0; i < D; ++i) {
        const bool below = point[i] < box.lower[i];
        if (!below && !(point[i] > box.upper[i])) continue;
        apart[i] = below ? box.lower[i] - point[i] : point[i] - box.upper[i];
        // Farther than the range.
        if (apart[i] < S(0)) apart[i] = scalar_traits<S>::max();
    }
    return length_squared(apart);
}

/// Whether a box lies wholly beyond a plane.
template <class S, int D>
constexpr bool beyond(const bounding_plane<S, D>& plane, const aabb<S, D>& box) {
    wide_of<S> minimum{};
    for (int i = 0; i < D; ++i)
        minimum = minimum + product(plane.normal[i], plane.normal[i] > S(0) ? box.lower[i] : box.upper[i]);
    return minimum > widen(plane.offset);
}

/// Calls visit(found); where it returns a bool, false ends the query.
template <class Visit, class Found>
constexpr bool go_on(Visit& visit, const Found& found) {
    using answer = decltype(visit(found));
    static_assert(std::is_void_v<answer> || std::is_same_v<answer, bool>,
                  "physics: a visitor of a query answers with a number; let it return nothing, or a bool: false ends "
                  "the query");
    if constexpr (std::is_void_v<answer>) return visit(found), true;
    else return static_cast<bool>(visit(found));
}

/// Puts an item into a sorted list of at most `maximum`, before all that come after it by after(other); the last one is
/// lost where the list is full.
template <class T, class After>
constexpr void insert_sorted(T* list, std::uint32_t& count, std::uint32_t maximum, const T& item, After&& after) {
    std::uint32_t at = count;
    while (at > 0 && after(list[at - 1])) --at;
    if (at == maximum) return;
    if (count < maximum) ++count;
    for (std::uint32_t i = count - 1; i > at; --i) list[i] = list[i - 1];
    list[at] = item;
}

}  // namespace detail

PHYSICS_HPP_END
