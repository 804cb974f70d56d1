// What is remembered of a pair of shapes from step to step, and contacts that are carried along while it rests.
#pragma once

#include <cstddef>
#include <cstring>

#include "physics/collide/patch.hpp"

PHYSICS_HPP_BEGIN

/// What a narrowphase remembers of a pair: where GJK ended, which axis parted it, its last manifold and how long that
/// stays good. Start with an empty one, and use it for one pair of shapes and one margin only.
template <class S, int D>
struct pair_memory {
    gjk_cache cache;
    /// Numbers the axis that parted two boxes; -1 if none did.
    std::int32_t parting = -1;
    /// Where B stood in A's frame when the manifold was found.
    transform<S, D> b_in_a;
    /// How far B reaches from its origin, and how far its points may move while the manifold is carried along (m).
    S reach{};
    S reuse_distance{};
    manifold<S, D> contact;
    /// Set by whatever changes it, and no part of what is remembered.
    bool changed = false;
};

namespace detail {

/// The largest component of what one rotation differs from another by, times the length of the arm that they turn.
template <class S>
constexpr S turned_by(rotation<S, 2> a, rotation<S, 2> b, S arm) {
    return max(abs(a.cosine - b.cosine), abs(a.sine - b.sine)) * arm;
}
template <class S>
constexpr S turned_by(rotation<S, 3> a, rotation<S, 3> b, S arm) {
    return max(largest(a.imaginary() - b.imaginary()), abs(a.w - b.w)) * (arm + arm);
}

/// Whether the pair has moved so little since its manifold was found that it may be carried along.
template <class S, int D>
constexpr bool is_still(const pair_memory<S, D>& m, const transform<S, D>& b_in_a) {
    return m.contact.count > 0 && !(largest(b_in_a.position - m.b_in_a.position) > m.reuse_distance) &&
           !(turned_by(b_in_a.rotation, m.b_in_a.rotation, m.reach) > m.reuse_distance);
}

/// The manifold that was remembered, its points carried along with their shapes: those of B by what it has moved in
/// A's frame, along a normal that stays. Exact but for products of small motions.
template <class S, int D>
constexpr void carry_along(const pair_memory<S, D>& m, const transform<S, D>& b_in_a, S margin, manifold<S, D>& out) {
    if (b_in_a == m.b_in_a) {
        out = m.contact;
        return;
    }
    const rotation<S, D> turn = b_in_a.rotation * inverse(m.b_in_a.rotation);
    const vec<S, D> shift = b_in_a.position - turn * m.b_in_a.position;
    const vec<S, D> n = out.normal = m.contact.normal;
    for (int i = 0; i < m.contact.count; ++i) {
        const manifold_point<S, D>& p = m.contact.points[i];
        const vec<S, D> half = n * (p.separation * S(0.5)), on_a = p.position - half;
        const vec<S, D> on_b = turn * (p.position + half) + shift;
        const S separation = dot(on_b - on_a, n);
        if (!(separation > margin)) out.add(on_a + (on_b - on_a) * S(0.5), separation, p.feature);
    }
}

/// Remembers what was found: contacts stay good while the pair moves by no more than they may deviate by anyway.
/// `reach`: of B from its origin; `thin`: the smallest half extent of both (m).
template <class S, int D>
void remember(const manifold<S, D>& found, const transform<S, D>& b_in_a, S reach, S thin, pair_memory<S, D>& m) {
    m.contact = found;
    m.b_in_a = b_in_a;
    m.reach = reach;
    m.reuse_distance = thin * S(1.0 / 512);
    m.changed = true;
}
template <class A, class B, class S, int D>
void remember(const A& a, const B& b, const transform<S, D>& b_in_a, const manifold<S, D>& found,
              pair_memory<S, D>& m) {
    if (found.count == 0) {
        m.contact.count = 0;
        m.cache.count = 0;
        m.changed = true;
        return;
    }
    const core<D> of_a = core_of(a), of_b = core_of(b);
    remember(found, b_in_a, static_cast<S>(of_b.extent + of_b.radius),
             static_cast<S>(min(of_a.thickness + of_a.radius, of_b.thickness + of_b.radius)), m);
}
template <class S>
void remember(const box<S, 3>& a, const box<S, 3>& b, const transform<S, 3>& b_in_a, const manifold<S, 3>& found,
              pair_memory<S, 3>& m) {
    const vec<S, 3> minimum = min(a.half_extents, b.half_extents), of_b = b.half_extents;
    remember(found, b_in_a, of_b.x + of_b.y + of_b.z, min(minimum.x, min(minimum.y, minimum.z)), m);
}

/// Of a pair that did not touch: true if the axis that parted it last parts it still, by more than the margin. Clearly
/// so, that a search from scratch would say the same; else the axis is forgotten, and such a search has to follow. So
/// what is remembered of pairs that do not touch bears on no result.
template <class A, class B, class S, int D>
bool still_parted(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, gjk_cache& cache) {
    point<D> axis;
    for (int i = 0; i < D; ++i) axis[i] = detail::to_double(cache.axis[i]);
    if (dot(axis, axis) > 0) {
        const core_pair<D> pair(a, b, b_in_a);
        const double reach = pair.a.radius + pair.b.radius + detail::to_double(margin);
        const double separated = dot(axis, support_along(pair.a, pair.placed, axis).w) / length(axis);
        if (separated > reach + 0x1p-30 * (reach + extent_of(pair.a, pair.placed))) return true;
    }
    cache = {};
    return false;
}

/// Which bytes of a memory are kept from step to step: contents(m) numbers what there is in it, 0 if nothing; and
/// each_piece(m, contents, f) calls f(address, bytes) for all of that. clear(m) makes of any bytes an empty one, of
/// which the rest does not matter; complete(m, contents) tells such a one, into which that was read, how much it was.
/// tidy(m) makes what means nothing of these bytes 0. has_changed(m): false if it is as it was read.
template <class Memory>
struct kept_memory {
    static bool has_changed(const Memory&) { return true; }
    static std::uint32_t contents(const Memory&) { return 1; }
    template <class Self, class F>
    static void each_piece(Self& m, std::uint32_t, F&& f) {
        f(&m, sizeof m);
    }
    static void clear(Memory& m) { m = {}; }
    static void complete(Memory&, std::uint32_t) {}
    static void tidy(Memory&) {}
};
inline bool is_fresh(const gjk_cache& c) { return c.count == 0 && c.axis[0] == 0 && c.axis[1] == 0 && c.axis[2] == 0; }
template <class Cache, class F>
void each_piece(Cache& c, F&& f) {
    f(&c, offsetof(gjk_cache, count) + sizeof c.count);
}
/// Makes all of an array of points 0 that is no part of the first `count`.
template <class Point, int N>
void tidy_points(Point (&points)[N], int count) {
    constexpr std::size_t used = offsetof(Point, feature) + sizeof(std::uint32_t);
    if constexpr (sizeof(Point) > used)
        for (int i = 0; i < count; ++i)
            std::memset(reinterpret_cast<unsigned char*>(points + i) + used, 0, sizeof(Point) - used);
    if (count < N)
        std::memset(static_cast<void*>(points + count), 0, static_cast<std::size_t>(N - count) * sizeof(Point));
}
/// Pairs that do not touch keep what parted them only.
template <class S, int D>
struct kept_memory<pair_memory<S, D>> {
    using memory = pair_memory<S, D>;
    static constexpr std::uint32_t points = 0xff, cached = 0x100, axis = 1 << 16;

    static bool has_changed(const memory& m) { return m.changed; }
    static std::uint32_t contents(const memory& m) {
        const auto count = static_cast<std::uint32_t>(m.contact.count);
        return (is_fresh(m.cache) ? 0 : cached) |
               (count > 0 ? count : axis * static_cast<std::uint32_t>(m.parting + 1));
    }
    template <class Self, class F>
    static void each_piece(Self& m, std::uint32_t contents, F&& f) {
        if ((contents & points) != 0)
            f(&m.b_in_a, offsetof(memory, contact) + offsetof(found, count) - offsetof(memory, b_in_a));
        if ((contents & cached) != 0) detail::each_piece(m.cache, f);
    }
    static void clear(memory& m) {
        m.cache = {};
        m.parting = -1;
        m.contact.count = 0;
        m.changed = false;
    }
    static void complete(memory& m, std::uint32_t contents) {
        m.contact.count = static_cast<int>(contents & points);
        m.parting = static_cast<std::int32_t>(contents / axis) - 1;
    }
    static void tidy(memory& m) { tidy_points(m.contact.points, m.contact.count); }

private:
    using found = manifold<S, D>;
};

}  // namespace detail

PHYSICS_HPP_END
