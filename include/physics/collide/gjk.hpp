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
    query_status status = query_status::converged;
};

/// Above the largest coordinate that any vertex of B - A can have.
template <int D>
double extent_of(const core<D>& a, const placed_core<D>& b) {
    return a.extent + b.shape->extent + largest(b.at);
}

template <int D>
PHYSICS_HPP_ALWAYS_INLINE cso_vertex<D> support_along(const core<D>& a, const placed_core<D>& b, const point<D>& v) {
    const support_point<D> on_a = a.support(v), on_b = b.support(-v);
    return {on_b.at - on_a.at, on_a.at, on_a.vertex << 16 | on_b.vertex};
}

template <int D>
void start_from(const gjk_cache& cache, const core<D>& a, const placed_core<D>& b, simplex<D>& s) {
    for (int i = 0; i < cache.count && s.count <= D; ++i) {
        const support_point<D> on_a = a.vertex(cache.vertex[i] >> 16), on_b = b.vertex(cache.vertex[i] & 0xffffu);
        s.vertex[s.count++] = {on_b.at - on_a.at, on_a.at, on_a.vertex << 16 | on_b.vertex};
    }
}

/// The normal and the distance that a simplex of fewer than D + 1 vertices gives, from the directions of its edges:
/// more exact than those of the closest point where that is near. Where the two disagree the cores touch, and the
/// closest point is what rounding left.
template <int D>
void measure(gjk_result<D>& r, point<D> v) {
    const auto& vertex = r.at.vertex;
    const double vv = dot(v, v);
    if (r.at.count == D) {
        const point<D> e = vertex[1].w - vertex[0].w;
        point<D> n;
        if constexpr (D == 2) n = perpendicular(e);
        else n = cross(e, vertex[2].w - vertex[0].w);
        const double along = dot(n, v);
        r.overlapping = !(along * along > 0.9 * dot(n, n) * vv);
        v = along < 0 ? -n : n;
    } else if (r.at.count == 2) {
        const point<D> e = vertex[1].w - vertex[0].w;
        const double along = dot(v, e), ee = dot(e, e);
        r.overlapping = !(along * along < 0.1 * vv * ee);
        v -= e * (along / ee);
    }
    r.normal = unit(v);
    r.distance = dot(r.normal, vertex[0].w);
    for (int i = 1; i < r.at.count; ++i) r.distance = min(r.distance, dot(r.normal, vertex[i].w));
    r.overlapping = r.overlapping || !(r.distance > 0);
    if (r.overlapping) r.normal = {}, r.distance = 0;
}

/// The distance of two cores, in A's frame; gives up as soon as it is known to exceed `most`, and ends where it is
/// known within the part `tolerance`. Source: Gilbert, Johnson, Keerthi (1988); van den Bergen, Collision detection in
/// interactive 3D environments (2003), 4.3. Cost: 4 to 10 supports of both, 1 or 2 with a cache.
template <int D>
gjk_result<D> gjk(const core<D>& a, const placed_core<D>& b, double most, double tolerance, gjk_cache* cache) {
    constexpr int most_iterations = 128, most_stalls = 4;
    gjk_result<D> r;
    int stalls = 0;
    // What rounding may do to a coordinate of the vertices.
    const double noise = 0x1p-51 * extent_of(a, b), squared_noise = noise * noise;
    const bool smooth = !a.has_vertices() || !b.shape->has_vertices();
    point<D> v = b.at;
    if (cache != nullptr && cache->count > 0) {
        point<D> axis;
        for (int i = 0; i < D; ++i) axis[i] = detail::to_double(cache->axis[i]);
        const double squared = dot(axis, axis);
        if (squared > 0) {
            v = axis;
            // What parted the two may part them still.
            const cso_vertex<D> next = support_along(a, b, v);
            const double along = dot(v, next.w);
            if (along > 0 && along * along > most * most * squared) {
                r.beyond = true;
                r.normal = unit(v);
                r.distance = dot(r.normal, next.w);
                r.at.vertex[0] = next;
                r.at.count = 1;
                return r;
            }
        }
        if (!smooth) {
            start_from(*cache, a, b, r.at);
            const closest_of<D> c = closest_of_simplex(r.at, false);
            if (c.count <= D) r.at.keep(c);
            v = c.at;
        }
    }
    if (!(dot(v, v) > 0) && r.at.count == 0) v = {}, v[0] = 1;

    const auto finish = [&] {
        if (cache == nullptr) return;
        cache->count = static_cast<std::uint8_t>(r.at.count);
        for (int i = 0; i < r.at.count; ++i) cache->vertex[i] = r.at.vertex[i].name;
        for (int i = 0; i < D; ++i) cache->axis[i] = static_cast<float>(r.normal[i]);
    };
    for (int iteration = 0;; ++iteration) {
        const double vv = dot(v, v);
        if (r.at.count > 0 && (r.at.count == D + 1 || vv <= squared_noise)) {
            r.overlapping = true;
            break;
        }
        cso_vertex<D>& next = r.at.vertex[r.at.count];
        next = support_along(a, b, v);
        const double vw = dot(v, next.w);
        if (vw > 0 && vw * vw > most * most * vv) {
            r.beyond = true;
            r.normal = unit(v);
            r.distance = dot(r.normal, next.w);
            if (r.at.count == 0) r.at.count = 1;
            break;
        }
        if (r.at.count > 0) {
            const double gap = vv - vw;
            bool known = gap <= tolerance * vv || gap * gap <= squared_noise * vv;
            for (int i = 0; i < r.at.count && !known; ++i)
                known = smooth ? r.at.vertex[i].w == next.w : r.at.vertex[i].name == next.name;
            if (known || iteration >= most_iterations) {
                measure(r, v);
                if (!known) r.status = query_status::iteration_limit;
                break;
            }
        }
        ++r.at.count;
        const closest_of<D> closest = closest_of_simplex(r.at, r.at.count > 1);
        if (r.at.count > 1 && closest.count <= D && !(dot(closest.at, closest.at) < vv)) {
            // Rounding lets it come no closer. The normal may still gain: the distance is flat where that is best.
            const bool taken = closest.vertex[closest.count - 1] == r.at.count - 1;
            if (!taken || ++stalls > most_stalls) {
                --r.at.count;
                measure(r, v);
                break;
            }
        }
        if (closest.count <= D) r.at.keep(closest);
        v = closest.at;
    }
    finish();
    return r;
}

}  // namespace detail

PHYSICS_HPP_END
