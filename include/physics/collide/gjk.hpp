// The distance of two convex sets: GJK.
#pragma once

#include "physics/collide/simplex.hpp"

PHYSICS_HPP_BEGIN

/// How a query ended.
enum class query_status : std::uint8_t {
    /// The answer is as exact as the numbers allow.
    converged,
    /// The limit of iterations was reached: the answer is the best one found, and its distance too long by an
    /// unknown part.
    iteration_limit,
};

/// What a query of two shapes leaves for the next one of the same pair: the simplex by vertices, and an axis. Start
/// with an empty one. Any content is safe, also that of another pair: it costs time, never a wrong answer.
struct gjk_cache {
    std::uint32_t vertex[4] = {};
    float axis[3] = {};
    std::uint8_t count = 0;
};

namespace detail {

inline constexpr double no_limit = 1e300;

/// Where GJK ended.
template <int D>
struct gjk_result {
    /// The simplex; of D + 1 vertices around the origin where the cores overlap.
    simplex<D> at;
    /// From A to B, of unit length where the cores are apart; else null.
    point<D> normal;
    /// Of the cores; 0 where they overlap. A lower bound where they are `beyond`.
    double distance = 0;
    /// The cores overlap, or touch within rounding.
    bool overlapping = false;
    /// The search ended since the distance exceeds what was asked for.
    bool beyond = false;
    /// normal_inexact: the separation along `normal` may be smaller than `distance`. If it is, cores that are
    /// maybe_touching count as touching; others only if that separation is not positive.
    bool normal_inexact = false, maybe_touching = false;
    query_status status = query_status::converged;
};

/// Above the largest coordinate that any vertex of B - A can have.
template <int D>
double extent_of(const core<D>& a, const placed_core<D>& b) {
    return a.extent + b.shape->extent + largest(b.at);
}

/// The vertex of B - A that a point of A and one of B, in its own frame, make. The products with matrices are written
/// out here and below: calls, which take vectors in memory, would cost a fifth of a search.
template <int D>
PHYSICS_HPP_ALWAYS_INLINE cso_vertex<D> difference(const support_point<D>& on_a, const support_point<D>& on_b,
                                                   const placed_core<D>& b) {
    const auto& column = b.axes.column;
    point<D> at = column[0] * on_b.at[0] + column[1] * on_b.at[1];
    if constexpr (D == 3) at += column[2] * on_b.at[2];
    return {at + b.at - on_a.at, on_a.at, on_a.vertex << 16 | on_b.vertex};
}
template <int D>
PHYSICS_HPP_ALWAYS_INLINE cso_vertex<D> support_along(const core<D>& a, const placed_core<D>& b, const point<D>& v) {
    point<D> in_b;
    for (int i = 0; i < D; ++i) in_b[i] = dot(b.axes.column[i], -v);
    return difference(a.quick_support(v), b.shape->quick_support(in_b), b);
}

template <int D>
PHYSICS_HPP_ALWAYS_INLINE void start_from(const gjk_cache& cache, const core<D>& a, const placed_core<D>& b,
                                          simplex<D>& s) {
    const int count = cache.count <= D ? cache.count : D + 1;
    for (; s.count < count; ++s.count) {
        const std::uint32_t name = cache.vertex[s.count];
        s.vertex[s.count] = difference(a.quick_vertex(name >> 16), b.shape->quick_vertex(name & 0xffffu), b);
    }
}

/// The normal and the distance that a simplex of fewer than D + 1 vertices gives, of which v is the closest point.
template <int D>
void measure(gjk_result<D>& r, point<D> v) {
    const auto& vertex = r.at.vertex;
    if constexpr (D == 3)
        if (r.at.count == 3) {
            // More exact than the closest point, where one corner is far away. Where the two disagree the cores touch,
            // and the closest point is what rounding left.
            const point<3> n = normal_by_shorter_edges(vertex[0].w, vertex[1].w, vertex[2].w);
            const double along = dot(n, v);
            r.overlapping = !(along * along > 0.9 * dot(n, n) * dot(v, v));
            v = along < 0 ? -n : n;
            correct_weights(vertex[0].w, vertex[1].w, vertex[2].w, n, r.at.weight);
        }
    const point<D> normal = unit(v);
    double distance = dot(normal, vertex[0].w);
    for (int i = 1; i < r.at.count; ++i) distance = min(distance, dot(normal, vertex[i].w));
    r.overlapping = r.overlapping || !(distance > 0);
    if (r.overlapping) return;
    r.normal = normal;
    r.distance = distance;
}

/// Results of one search for cores so near that rounding may have turned its direction: of normals that part them by
/// less than they say.
template <int D>
struct inexact_normals {
    static constexpr int max_refinements = 8;

    /// How far apart cores must be for such a normal to count (m).
    double trusted;
    /// The result whose normal parts them most, and by how much.
    raw_array<gjk_result<D>, 1> best;
    double separated = 0;
    int refinements = 0;

    // Braces alone would clear the memory of `best`.
    explicit inexact_normals(double trusted_from) : trusted(trusted_from) {}
    /// Of a normal that does not part the cores its own support tells more, and is added to the simplex; one that never
    /// does is none, and they touch. True if the search has to go on from there.
    PHYSICS_HPP_COLD bool refine(const core<D>& a, const placed_core<D>& b, double noise, bool smooth,
                                 gjk_result<D>& r) {
        const cso_vertex<D> farther = support_along(a, b, r.normal);
        const double here = dot(r.normal, farther.w);
        if (!(here < r.distance - 4 * noise)) return false;
        // Beside edges of B - A that all but touch, as near the tip of a cone, the next may part them less.
        if (refinements == 0 || here > separated) {
            separated = here;
            best[0] = r;
        }
        if (r.at.count <= D && refinements++ < max_refinements) {
            r.at.vertex[r.at.count++] = farther;
            r.normal = {};
            r.distance = 0;
            return true;
        }
        r = best[0];
        r.normal_inexact = true;
        r.maybe_touching = r.distance < trusted || (smooth && !(separated > 0));
        return false;
    }
};

/// Where a search by gjk() is: the result so far, and v, the point of its simplex that is closest to the origin.
template <int D>
struct gjk_search {
    static constexpr int max_iterations = 128, max_stalls = 8;

    const core<D>& a;
    const placed_core<D>& b;
    double maximum, tolerance;
    gjk_result<D>& r;
    /// What rounding may do to a coordinate of the vertices.
    double noise = 0x1p-51 * extent_of(a, b);
    bool smooth = !a.has_vertices() || !b.shape->has_vertices();
    point<D> v = b.at;
    double vv = dot(v, v);
    /// The least part of the distance that was unknown (m, squared), and how often it has not been halved since.
    double minimum_unknown = no_limit;
    int stalls = 0;

    PHYSICS_HPP_ALWAYS_INLINE void run(gjk_cache* cache) {
        if (cache != nullptr && cache->count > 0 && !seed(*cache)) return;
        inexact_normals<D> inexact((smooth ? 0x1p20 : 0x1p10) * noise);
        if (!(vv > 0) && r.at.count == 0) v = {}, v[0] = vv = 1;
        for (int iteration = 0;; ++iteration) {
            if (reaches_origin()) break;
            cso_vertex<D>& w = r.at.vertex[r.at.count];
            w = support_along(a, b, v);
            const double vw = dot(v, w.w);
            if (exceeds_maximum(w, vw)) break;
            if (!is_closest(w, vv - vw, iteration) && reduce(vv - vw)) continue;
            if (accept(vw, inexact)) break;
        }
        // Rounding can't bring together what a normal was seen to part.
        if (r.overlapping && inexact.separated > inexact.trusted) [[unlikely]]
            r = inexact.best[0];
        if (cache != nullptr) store(*cache);
    }

private:
    /// Begins where an earlier search ended. False if that is the answer: what parted the two may part them still.
    PHYSICS_HPP_ALWAYS_INLINE bool seed(const gjk_cache& cache) {
        point<D> axis;
        for (int i = 0; i < D; ++i) axis[i] = detail::to_double(cache.axis[i]);
        const double squared = dot(axis, axis);
        if (squared > 0 && (smooth || maximum < no_limit)) {
            v = axis;
            vv = squared;
            cso_vertex<D>& w = r.at.vertex[0];
            w = support_along(a, b, v);
            if (exceeds_maximum(w, dot(v, w.w))) return false;
        }
        if (!smooth) {
            start_from(cache, a, b, r.at);
            move_to(closest_of_simplex(r.at, false));
        }
        return true;
    }
    PHYSICS_HPP_ALWAYS_INLINE void store(gjk_cache& cache) const {
        cache.count = static_cast<std::uint8_t>(r.at.count);
        for (int i = 0; i < r.at.count; ++i) cache.vertex[i] = r.at.vertex[i].name;
        for (int i = 0; i < D; ++i) cache.axis[i] = static_cast<float>(r.normal[i]);
    }
    PHYSICS_HPP_ALWAYS_INLINE void move_to(const closest_of<D>& c) {
        if (c.count <= D) r.at.keep(c);
        v = c.at;
        vv = dot(v, v);
    }

    PHYSICS_HPP_ALWAYS_INLINE bool reaches_origin() {
        r.overlapping = r.at.count > 0 && (r.at.count == D + 1 || vv <= noise * noise);
        return r.overlapping;
    }
    /// Whether the plane through the support point w, across v, parts the cores by more than was asked for.
    PHYSICS_HPP_ALWAYS_INLINE bool exceeds_maximum(const cso_vertex<D>& w, double vw) {
        if (!(vw > 0 && vw * vw > maximum * maximum * vv)) return false;
        r.beyond = true;
        r.normal = unit(v);
        r.distance = dot(r.normal, w.w);
        if (r.at.count == 0) r.at.count = 1;
        return true;
    }
    /// Whether nothing of B - A lies closer than v, but for the tolerance; `gap` is by how much w does along v, times
    /// the length of v.
    PHYSICS_HPP_ALWAYS_INLINE bool is_closest(const cso_vertex<D>& w, double gap, int iteration) {
        if (r.at.count == 0) return false;
        if (gap <= tolerance * vv || gap * gap <= noise * noise * vv) return true;
        for (int i = 0; i < r.at.count; ++i)
            if (smooth ? r.at.vertex[i].w == w.w : r.at.vertex[i].name == w.name) return true;
        if (iteration < max_iterations) return false;
        r.status = query_status::iteration_limit;
        return true;
    }
    /// Adds the support point, and drops what the new v does not need. False, and all as it was, if v gets no closer.
    PHYSICS_HPP_ALWAYS_INLINE bool reduce(double gap) {
        ++r.at.count;
        closest_of<D> closest = closest_of_simplex(r.at, r.at.count > 1);
        const bool closer = r.at.count == 1 || closest.count > D || dot(closest.at, closest.at) < vv;
        if (!closer && !may_gain(closest, gap)) {
            --r.at.count;
            return false;
        }
        move_to(closest);
        return true;
    }
    /// Rounding lets v come no closer. The normal may still gain: the distance is flat where that is best.
    PHYSICS_HPP_ALWAYS_INLINE bool may_gain(closest_of<D>& closest, double gap) {
        // It grew, so it can't have moved away: rounding chose the side.
        if (dot(closest.at, closest.at) > 2 * vv) [[unlikely]]
            closest = closest_of_simplex(r.at, true, true);
        if (gap * gap < 0.5 * minimum_unknown * vv) {
            minimum_unknown = gap * gap / vv;
            stalls = 0;
        }
        return closest.vertex[closest.count - 1] == r.at.count - 1 && ++stalls <= max_stalls;
    }
    /// Takes v as the answer, unless its normal has to be refined.
    PHYSICS_HPP_ALWAYS_INLINE bool accept(double vw, inexact_normals<D>& inexact) {
        measure(r, v);
        const bool leaves_before = vw < vv * (1 - 2 * tolerance) - 4 * noise * r.distance;
        if (!r.overlapping && r.distance < 0x1p30 * noise && inexact.refine(a, b, noise, smooth, r)) [[unlikely]] {
            move_to(closest_of_simplex(r.at, true));
            return false;
        }
        r.normal_inexact = !r.overlapping && (r.normal_inexact || leaves_before);
        return true;
    }
};

template <int D>
gjk_result<D> search(const core<D>& a, const placed_core<D>& b, double maximum, double tolerance, gjk_cache* cache) {
    gjk_result<D> r;
    gjk_search<D>{a, b, maximum, tolerance, r}.run(cache);
    return r;
}

/// Mends a normal that rounding turned, as what parts the two is short beside them: parted farther along it, the normal
/// between the same features is told by a longer vector. Each step is as long as the last one was exact. Takes how far
/// a normal is wanted to part them, and how far this one does, which grows.
inline void refine_normal(const core<3>& a, const placed_core<3>& b, double wanted, double& separated,
                          gjk_result<3>& r) {
    constexpr double longer = 0x1p8;
    const double maximum = max(0.25 * extent_of(a, b), r.distance);
    gjk_cache near;
    near.count = static_cast<std::uint8_t>(r.at.count);
    for (int i = 0; i < r.at.count; ++i) near.vertex[i] = r.at.vertex[i].name;
    point<3> n = r.normal;
    for (double step = r.distance * longer; separated < wanted; step *= longer) {
        placed_core<3> apart = b;
        apart.at += n * min(step, maximum);
        for (int i = 0; i < 3; ++i) near.axis[i] = static_cast<float>(n[i]);
        const gjk_result<3> found = search(a, apart, no_limit, 0x1p-54, &near);
        if (found.overlapping) return;
        n = found.normal;
        const double here = dot(n, support_along(a, b, n).w);
        if (here > separated) separated = here, r.normal = n;
        if (step >= maximum) return;
    }
}
/// The same in 2D: across the edge from what lies before the normal to the end below the origin, or the farther
/// one.
inline void refine_normal(const core<2>& a, const placed_core<2>& b, double wanted, double& separated,
                          gjk_result<2>& r) {
    constexpr int max_steps = 8;
    point<2> from = r.at.vertex[0].w, to = r.at.vertex[r.at.count > 1 ? 1 : 0].w, n = r.normal;
    for (int i = 0; i < max_steps && separated < wanted; ++i) {
        const point<2> before = support_along(a, b, n).w, e = before - from, f = before - to;
        const bool below_e = dot(before, e) > 0, below_f = dot(before, f) > 0;
        const bool keeps_from = below_e != below_f ? below_e : dot(e, e) > dot(f, f);
        const point<2> across = unit(perpendicular(keeps_from ? e : f));
        n = dot(across, n) < 0 ? -across : across;
        (keeps_from ? to : from) = before;
        const double here = dot(n, support_along(a, b, n).w);
        if (here > separated) separated = here, r.normal = n;
    }
}

/// The distance of two cores, in A's frame; gives up as soon as it is known to exceed `maximum`, and ends where it is
/// known within the part `tolerance`. Source: Gilbert, Johnson, Keerthi (1988); van den Bergen, Collision detection in
/// interactive 3D environments (2003), 4.3. Cost: 4 to 10 supports of both, 1 or 2 with a cache.
template <int D>
gjk_result<D> gjk(const core<D>& a, const placed_core<D>& b, double maximum, double tolerance, gjk_cache* cache) {
    gjk_result<D> r = search(a, b, maximum, tolerance, cache);
    if (r.normal_inexact) [[unlikely]] {
        const double wanted = r.distance - 0x1p-49 * extent_of(a, b);
        double separated = dot(r.normal, support_along(a, b, r.normal).w);
        if (separated < wanted) refine_normal(a, b, wanted, separated, r);
        if (separated >= wanted) r.distance = min(r.distance, separated);
        else if (r.maybe_touching || !(separated > 0)) r.overlapping = true, r.normal = {}, r.distance = 0;
    }
    return r;
}

}  // namespace detail

PHYSICS_HPP_END
