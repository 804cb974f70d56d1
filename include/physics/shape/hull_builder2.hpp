// Convex polygons from points, and what hulls of both dimensions begin with.
#pragma once

#include "physics/shape/hull_data.hpp"
#include "physics/space/orientation.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Sorts items[0] to before items[count] with room for as many, so that alike ones keep their order: merge sort.
template <class T, class Less>
void merge_sort(T* items, T* scratch, std::uint32_t count, Less&& less) {
    if (count < 2) return;
    const std::uint32_t half = count / 2;
    merge_sort(items, scratch, half, less);
    merge_sort(items + half, scratch, count - half, less);
    std::memcpy(static_cast<void*>(scratch), items, half * sizeof(T));
    std::uint32_t a = 0, b = half, to = 0;
    while (a < half && b < count) {
        if (less(items[b], scratch[a])) items[to++] = items[b++];
        else items[to++] = scratch[a++];
    }
    while (a < half) items[to++] = scratch[a++];
}

/// Points by x, then y (then z), each once: all that follows depends on the set of points only. By their places on the
/// grid of predicates about them, that is, lest these contradict the order; see orientation. Those at one place count
/// as one.
template <int D>
void sort_points(buffer<vec<double, D>>& points, double size) {
    const double scale = 0x1p59 / size;
    const auto place = [&](double x) { return static_cast<std::int64_t>(x * scale); };
    buffer<vec<double, D>> scratch;
    scratch.resize(points.size() / 2 + 1);
    merge_sort(points.begin(), scratch.begin(), points.size(), [&](const vec<double, D>& a, const vec<double, D>& b) {
        for (int i = 0; i < D; ++i)
            if (a[i] != b[i] && place(a[i]) != place(b[i])) return a[i] < b[i];
        for (int i = 0; i < D; ++i)
            if (a[i] != b[i]) return a[i] < b[i];
        return false;
    });
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        bool known = count > 0;
        for (int k = 0; k < D && known; ++k) known = place(points[count - 1][k]) == place(points[i][k]);
        if (!known) points[count++] = points[i];
    }
    points.resize(count);
}

/// The largest coordinate by magnitude.
template <int D>
double reach_of(const buffer<vec<double, D>>& points) {
    double maximum = 0;
    for (const auto& p : points) maximum = max(maximum, largest(p));
    return maximum;
}

/// The distance of p from the segment from a to b.
template <int D>
double segment_distance(const vec<double, D>& p, const vec<double, D>& a, const vec<double, D>& b) {
    const vec<double, D> along = b - a, q = p - a;
    const double t = dot(q, along), whole = dot(along, along);
    if (!(t > 0)) return length(q);
    return t < whole ? length(q - along * (t / whole)) : length(p - b);
}

/// Of a chain of points by their numbers, marks those to drop that lie within tolerance of the segments between those
/// that stay; the ends stay. Source: Ramer (1972), Douglas and Peucker (1973).
template <int D>
void simplify_chain(const vec<double, D>* points, const std::uint32_t* chain, std::uint32_t count, double tolerance,
                    buffer<bool>& drop) {
    struct range {
        std::uint32_t first, last;
    };
    buffer<range> todo;
    todo.push_back({0, count - 1});
    while (!todo.empty()) {
        const range r = todo.back();
        todo.pop_back();
        std::uint32_t farthest = r.first;
        double maximum = tolerance;
        for (std::uint32_t i = r.first + 1; i < r.last; ++i) {
            const double distance = segment_distance(points[chain[i]], points[chain[r.first]], points[chain[r.last]]);
            if (!(distance > maximum)) continue;
            maximum = distance;
            farthest = i;
        }
        if (farthest == r.first) {
            for (std::uint32_t i = r.first + 1; i < r.last; ++i) drop[chain[i]] = true;
        } else {
            todo.push_back({farthest, r.last});
            todo.push_back({r.first, farthest});
        }
    }
}

/// The farthest of the points from p; the first of equals.
template <int D>
std::uint32_t farthest_from(const vec<double, D>& p, const buffer<vec<double, D>>& points) {
    std::uint32_t best = 0;
    double maximum = -1;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const vec<double, D> d = points[i] - p;
        const double distance = dot(d, d);
        if (!(distance > maximum)) continue;
        maximum = distance;
        best = i;
    }
    return best;
}

template <int D>
bool refuse_thickness(const char* function, double thickness) {
    return refuse(function, "thickness of the points", thickness,
                  D == 2 ? "they must not lie on one line, to the rounding of their coordinates"
                         : "they must not lie in one plane, to the rounding of their coordinates");
}
template <int D>
bool check_hull_size(const char* function, std::uint32_t vertices) {
    return vertices <= hull_data<double, D>::max_vertices ||
           refuse(function, "number of vertices", static_cast<double>(vertices), "it must be at most 65535");
}

/// Thins out a convex polygon to so many corners: takes the one farthest outside of the others, again and again.
/// Returns how far the next one lies outside. Cost: O(n) a corner.
inline double keep_farthest(buffer<vec<double, 2>>& corners, std::uint32_t first, std::uint32_t maximum) {
    const std::uint32_t n = corners.size();
    buffer<bool> keep;
    keep.resize(n, false);
    keep[first] = keep[farthest_from(corners[first], corners)] = true;
    double distance = 0;
    for (std::uint32_t kept = 2;; ++kept) {
        std::uint32_t best = first;
        distance = 0;
        for (std::uint32_t i = 0, from = first, to = first; i < n; ++i) {
            const std::uint32_t at = first + i < n ? first + i : first + i - n;
            if (keep[at]) {
                from = at;
                do to = to + 1 < n ? to + 1 : 0;
                while (!keep[to]);
                continue;
            }
            const double d = segment_distance(corners[at], corners[from], corners[to]);
            if (!(d > distance)) continue;
            distance = d;
            best = at;
        }
        if (kept >= maximum || best == first) break;
        keep[best] = true;
    }
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < n; ++i)
        if (keep[i]) corners[count++] = corners[i];
    corners.resize(count);
    return distance;
}

/// The convex polygon around points that it sorts; empty after a refusal. Vertices within `tolerance` (m) of the line
/// between their neighbours are left out; what remains is strictly convex. most: if not 0, no more vertices than that.
/// Cost: O(n log n), 60 ns a point.
/// Source: monotone chains, Andrew (1979).
inline hull_outline<2> build_outline(buffer<vec<double, 2>>& points, double tolerance, std::uint32_t maximum,
                                     const char* function) {
    hull_outline<2> result;
    const double size = power_above(reach_of(points));
    sort_points(points, size);
    const orientation turn(size);
    buffer<std::uint32_t> chain;
    const auto advance = [&](std::uint32_t from, std::uint32_t i) {
        while (chain.size() >= from + 2 &&
               turn.of(points[chain[chain.size() - 2]], points[chain.back()], points[i]) <= 0)
            chain.pop_back();
        chain.push_back(i);
    };
    for (std::uint32_t i = 0; i < points.size(); ++i) advance(0, i);
    const std::uint32_t last = chain.size() - 1;
    for (std::uint32_t i = points.size() - 1; i-- > 0;) advance(last, i);
    if (chain.size() > 1) chain.pop_back();

    // Two vertices that stick out whatever rounding did: the farthest from the middle, and the farthest from that.
    buffer<vec<double, 2>> corners;
    for (const std::uint32_t i : chain) corners.push_back(points[i]);
    vec<double, 2> middle;
    for (const auto& p : corners) middle += (p - corners[0]) / corners.size();
    const std::uint32_t a = farthest_from(middle + corners[0], corners), b = farthest_from(corners[a], corners);
    double thickness = 0;
    if (corners.size() > 2) {
        const vec<double, 2> across = perpendicular(normalized(corners[b] - corners[a]));
        double low = 0, high = 0;
        for (const auto& p : corners) {
            const double height = dot(across, p - corners[a]);
            low = min(low, height);
            high = max(high, height);
        }
        thickness = high - low;
    }
    if (!(thickness > tolerance)) {
        refuse_thickness<2>(function, thickness);
        return result;
    }
    buffer<bool> drop;
    drop.resize(corners.size(), false);
    const auto simplify = [&](std::uint32_t from, std::uint32_t to) {
        chain.clear();
        for (std::uint32_t i = from; i != to; i = i + 1 < corners.size() ? i + 1 : 0) chain.push_back(i);
        chain.push_back(to);
        simplify_chain(corners.begin(), chain.begin(), chain.size(), tolerance, drop);
    };
    simplify(a, b);
    simplify(b, a);
    for (std::uint32_t i = 0; i < corners.size(); ++i)
        if (!drop[i]) result.vertices.push_back(corners[i]);
    if (maximum > 0 && result.vertices.size() > maximum)
        result.shortfall = keep_farthest(result.vertices, farthest_from(middle + corners[0], result.vertices), maximum);
    const std::uint32_t n = result.vertices.size();
    if (n < 3) refuse_thickness<2>(function, thickness);
    if (n < 3 || !check_hull_size<2>(function, n)) return {};
    for (std::uint32_t i = 0; i < n; ++i) {
        result.face_begin.push_back(2 * i);
        result.face_vertices.push_back(static_cast<std::uint16_t>(i));
        result.face_vertices.push_back(static_cast<std::uint16_t>(i + 1 < n ? i + 1 : 0));
    }
    result.face_begin.push_back(2 * n);
    result.tolerance = tolerance;
    return result;
}

}  // namespace detail

PHYSICS_HPP_END
