// Manifolds that gather one point a step.
#pragma once

#include "physics/collide/pair_memory.hpp"

PHYSICS_HPP_BEGIN

/// What an incremental narrowphase remembers of a pair: where GJK ended, and the deepest points of the last steps, each
/// in the frames of both shapes. Start with an empty one, and use it for one pair of shapes only.
template <class S, int D>
struct persistent_manifold {
    struct point {
        vec<S, D> on_a, on_b;
        std::uint32_t feature = 0;
    };
    gjk_cache cache;
    point points[manifold<S, D>::capacity];
    std::int32_t count = 0;
    /// How many points there have been, which names them.
    std::uint32_t named = 0;
};

namespace detail {

/// Where a remembered point lies now, seen from A along the normal.
template <class S, int D>
constexpr manifold_point<S, D> where_now(const typename persistent_manifold<S, D>::point& p,
                                         const transform<S, D>& b_in_a, vec<S, D> n) {
    const vec<S, D> apart = b_in_a * p.on_b - p.on_a;
    return {p.on_a + apart * S(0.5), dot(apart, n), p.feature};
}

/// Forgets the points that have parted, or slid aside, by more than they may.
template <class S, int D>
constexpr void drop_stale(persistent_manifold<S, D>& m, const transform<S, D>& b_in_a, vec<S, D> n, S margin, S far) {
    std::int32_t kept = 0;
    for (std::int32_t i = 0; i < m.count; ++i) {
        const vec<S, D> apart = b_in_a * m.points[i].on_b - m.points[i].on_a;
        const S along = dot(apart, n);
        if (!(along > margin) && !(largest(apart - n * along) > far)) m.points[kept++] = m.points[i];
    }
    m.count = kept;
}

/// Adds a point; one that lies as near as `far` to another takes its place and name. Where there is no room, what
/// spans least of the contact goes.
template <class S, int D>
constexpr void add_point(persistent_manifold<S, D>& m, vec<S, D> on_a, vec<S, D> on_b, const transform<S, D>& b_in_a,
                         vec<S, D> n, S far, S slack) {
    for (std::int32_t i = 0; i < m.count; ++i) {
        if (largest(m.points[i].on_a - on_a) > far && largest(m.points[i].on_b - on_b) > far) continue;
        m.points[i].on_a = on_a;
        m.points[i].on_b = on_b;
        return;
    }
    constexpr int maximum = manifold<S, D>::capacity;
    const typename persistent_manifold<S, D>::point added{on_a, on_b, m.named++};
    if (m.count < maximum) {
        m.points[m.count++] = added;
        return;
    }
    manifold_point<S, D> all[maximum + 1];
    all[0] = where_now<S, D>(added, b_in_a, n);
    for (int i = 0; i < maximum; ++i) all[i + 1] = where_now<S, D>(m.points[i], b_in_a, n);
    manifold<S, D> kept;
    reduce(all, maximum + 1, n, slack, kept);
    const auto is_kept = [&](std::uint32_t feature) {
        for (int i = 0; i < kept.count; ++i)
            if (kept.points[i].feature == feature) return true;
        return false;
    };
    for (auto& p : m.points) {
        if (is_kept(p.feature)) continue;
        p = added;
        return;
    }
}

/// Contact of two shapes by the deepest point of this step and those of the last ones that still hold. Source: van den
/// Bergen, Collision detection in interactive 3D environments (2003), 4.3.6; Coumans, Contact generation (GDC 2010).
template <class A, class B, class S, int D>
void gather_contact(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, overlap_method method,
                    persistent_manifold<S, D>& m, manifold<S, D>& out) {
    if (m.count == 0 && still_parted(a, b, b_in_a, margin, m.cache)) return;
    const core_pair<D> pair(a, b, b_in_a);
    const double reach = pair.a.radius + pair.b.radius + detail::to_double(margin);
    core_separation<D> s = separate<S>(pair, reach, &m.cache, method);
    if (s.beyond || s.gap > reach) {
        m.count = 0;
        m.cache.count = 0;
        return;
    }
    const closest_points<S, D> now = rounded<S>(pair, s);
    // A point holds while it slides by no more than a small part of the smaller shape.
    const S far = static_cast<S>(min(pair.a.extent + pair.a.radius, pair.b.extent + pair.b.radius) * (1.0 / 32));
    drop_stale(m, b_in_a, now.normal, margin, far);
    add_point(m, now.on_a, inverse_transform(b_in_a, now.on_b), b_in_a, now.normal, far,
              static_cast<S>(slack_of<S>(pair)));
    out.normal = now.normal;
    for (std::int32_t i = 0; i < m.count; ++i)
        out.points[out.count++] = where_now<S, D>(m.points[i], b_in_a, now.normal);
}

template <class S, int D>
struct kept_memory<persistent_manifold<S, D>> {
    using memory = persistent_manifold<S, D>;
    static constexpr std::uint32_t points = 0xff, any = 0x100;

    static bool has_changed(const memory&) { return true; }
    static std::uint32_t contents(const memory& m) {
        return m.named == 0 && is_fresh(m.cache) ? 0 : any | static_cast<std::uint32_t>(m.count);
    }
    template <class Self, class F>
    static void each_piece(Self& m, std::uint32_t contents, F&& f) {
        if (contents == 0) return;
        detail::each_piece(m.cache, f);
        f(&m.named, sizeof m.named);
        if ((contents & points) != 0) f(&m.points, sizeof m.points);
    }
    static void clear(memory& m) { m = {}; }
    static void complete(memory& m, std::uint32_t contents) { m.count = static_cast<std::int32_t>(contents & points); }
    static void tidy(memory& m) { tidy_points(m.points, m.count); }
};

}  // namespace detail

PHYSICS_HPP_END
