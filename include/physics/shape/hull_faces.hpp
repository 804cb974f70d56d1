// From the triangles of a hull to its faces: what rounding bent is flat again.
#pragma once

#include "physics/base/handle.hpp"
#include "physics/base/sort.hpp"
#include "physics/shape/quickhull.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Finds the flat regions of a hull of triangles, the vertices that these make superfluous, and, once there are none,
/// the faces. All within a tolerance: corners of a face are at most that far apart across its plane, and vertices that
/// go were at most that far outside of what stays. Cost: O(n log n) on most input.
class hull_faces {
public:
    hull_faces(const vec<double, 3>* points, const buffer<hull_triangle>& triangles, double tolerance)
        : points_(points), triangles_(triangles), tolerance_(tolerance) {
        find_regions();
    }

    /// Marks of two vertices that nearly coincide one; or where there are none, the vertices within a region, and those
    /// on an edge of two regions near the line between its ends.
    bool drop_superfluous(std::uint32_t count, buffer<bool>& drop) {
        buffer<std::uint32_t> corner_of, links;
        corner_of.resize(count, none);
        links.resize(2 * count, none);
        buffer<std::uint8_t> borders;
        borders.resize(count, 0);
        drop.clear();
        drop.resize(count, false);
        bool any = false;
        for (const hull_triangle& t : triangles_)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t a = t.corner[k], b = t.corner[next_corner(k)];
                if (a < b && !drop[a] && !drop[b] && length(points_[a] - points_[b]) <= weld * tolerance_)
                    drop[b] = any = true;
            }
        // Alone: what else goes may hold on to one of these.
        if (any) return true;
        for (std::uint32_t t = 0; t < triangles_.size(); ++t)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t v = triangles_[t].corner[k];
                corner_of[v] = t;
                if (region_[t] == region_[triangles_[t].next[k]]) continue;
                // Each border edge leaves each of its ends once.
                if (borders[v] < 2) links[2 * v + borders[v]] = triangles_[t].corner[next_corner(k)];
                if (borders[v] < 3) ++borders[v];
            }
        for (std::uint32_t v = 0; v < count; ++v)
            if (corner_of[v] != none && borders[v] == 0) drop[v] = any = true;
        buffer<std::uint32_t> chain;
        buffer<bool> done;
        done.resize(count, false);
        for (std::uint32_t start = 0; start < count; ++start) {
            if (corner_of[start] == none || borders[start] != 3) continue;
            for (const std::uint32_t first : border_neighbours(start, corner_of[start])) {
                if (borders[first] != 2 || done[first]) continue;
                chain.clear();
                chain.push_back(start);
                for (std::uint32_t v = first, from = start; chain.back() != v;) {
                    chain.push_back(v);
                    if (borders[v] != 2) break;
                    done[v] = true;
                    const std::uint32_t to = links[2 * v] == from ? links[2 * v + 1] : links[2 * v];
                    from = v;
                    v = to;
                }
                simplify_chain(points_, chain.begin(), chain.size(), tolerance_, drop);
                for (const std::uint32_t v : chain) any = any || drop[v];
            }
        }
        return any;
    }

    /// Joins the triangles of each region to polygons, as far as these are convex, and writes the outline.
    void join(std::uint32_t count, hull_outline<3>& outline) {
        const std::uint32_t n = 3 * triangles_.size();
        degree_.resize(count, 0);
        for (std::uint32_t h = 0; h < n; ++h) {
            const std::uint32_t t = h / 3, k = h % 3;
            next_.push_back(3 * t + next_corner(k));
            previous_.push_back(3 * t + previous_corner(k));
            const hull_triangle& g = triangles_[triangles_[t].next[k]];
            twin_.push_back(3 * triangles_[t].next[k] + g.find(triangles_[t].corner[next_corner(k)]));
            ++degree_[origin(h)];
            if (k == 0) {
                polygon_.push_back(t);
                size_.push_back(3);
                bent_.push_back(false);
            }
        }
        gone_.resize(n, false);
        for (bool again = true; again;) {
            again = false;
            for (std::uint32_t h = 0; h < n; ++h)
                if (h < twin_[h] && !gone_[h] && join_across(h)) again = true;
        }
        write(count, outline);
    }

private:
    static constexpr std::uint32_t none = null_index;
    /// Vertices as near as so many tolerances count as one: faces of that size would point anywhere.
    static constexpr double weld = 4;

    [[nodiscard]] std::uint32_t origin(std::uint32_t h) const { return triangles_[h / 3].corner[h % 3]; }
    [[nodiscard]] const vec<double, 3>& point(std::uint32_t h) const { return points_[origin(h)]; }

    /// Grows regions from the largest triangles: the larger a region, the better its plane is known.
    void find_regions() {
        const std::uint32_t count = triangles_.size();
        struct entry {
            double size;
            std::uint32_t triangle;
        };
        buffer<entry> order, scratch;
        for (std::uint32_t t = 0; t < count; ++t) {
            const std::uint32_t* c = triangles_[t].corner;
            const vec<double, 3>&p = points_[c[0]], &q = points_[c[1]], &r = points_[c[2]];
            const double size = length(cross(q - p, r - p));
            const double longest = max(length(q - p), max(length(r - q), length(p - r)));
            area_.push_back(size > tolerance_ * longest ? triangle_normal(p, q, r) * size : vec<double, 3>{});
            order.push_back({size, t});
        }
        scratch.resize(count / 2 + 1);
        merge_sort(order.begin(), scratch.begin(), count,
                   [](const entry& a, const entry& b) { return a.size > b.size; });
        region_.resize(count, none);
        for (const entry& e : order)
            if (region_[e.triangle] == none && !is_needle(e.triangle)) grow(e.triangle);
        // A needle is flat with what lies across its longest edge. Those that share that edge have gone on other ways,
        // or stay alone.
        for (bool again = true; again;) {
            again = false;
            for (const entry& e : order) {
                if (region_[e.triangle] != none) continue;
                region_[e.triangle] = region_[triangles_[e.triangle].next[longest_edge(e.triangle)]];
                again = again || region_[e.triangle] != none;
            }
        }
        for (const entry& e : order)
            if (region_[e.triangle] == none) grow(e.triangle);
    }
    /// A triangle that is no wider than the tolerance may point anywhere: its area was set to 0.
    [[nodiscard]] bool is_needle(std::uint32_t t) const { return area_[t] == vec<double, 3>{}; }
    [[nodiscard]] std::uint32_t longest_edge(std::uint32_t t) const {
        std::uint32_t best = 0;
        double maximum = 0;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t* c = triangles_[t].corner;
            const double size = length(points_[c[next_corner(k)]] - points_[c[k]]);
            if (size > maximum) best = k;
            maximum = max(maximum, size);
        }
        return best;
    }
    void grow(std::uint32_t seed) {
        const std::uint32_t id = regions_.size();
        const std::uint32_t* c = triangles_[seed].corner;
        const vec<double, 3> base = points_[c[0]];
        vec<double, 3> sum = area_[seed], plane = normalized(sum);
        double low = 0, high = 0, radius = 0;
        corners_.clear();
        for (int k = 0; k < 3; ++k) {
            corners_.push_back(c[k]);
            radius = max(radius, length(points_[c[k]] - base));
        }
        todo_.clear();
        todo_.push_back(seed);
        region_[seed] = id;
        for (std::uint32_t i = 0; i < todo_.size() && !is_needle(seed); ++i)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t g = triangles_[todo_[i]].next[k];
                if (region_[g] != none || dot(sum, area_[g]) < 0) continue;
                const std::uint32_t edge_end = triangles_[todo_[i]].corner[k];
                const std::uint32_t apex = triangles_[g].corner[next_corner(triangles_[g].find(edge_end))];
                const vec<double, 3> q = points_[apex] - base;
                const double height = dot(plane, q), reach = max(radius, length(q));
                // A plane known from little says nothing of a needle that leads far away.
                if (is_needle(g) && reach > 2 * radius) continue;
                double from = min(low, height), to = max(high, height);
                if (to - from > tolerance_) {
                    // Another plane may fit all of them, unless it would have to turn too far.
                    const vec<double, 3> turned = normalized(sum + area_[g]);
                    if (to - from - tolerance_ > 2 * reach * length(turned - plane)) continue;
                    from = to = dot(turned, q);
                    for (const std::uint32_t v : corners_) {
                        const double other = dot(turned, points_[v] - base);
                        from = min(from, other);
                        to = max(to, other);
                    }
                    if (to - from > tolerance_) continue;
                    plane = turned;
                }
                low = from;
                high = to;
                radius = reach;
                sum += area_[g];
                region_[g] = id;
                corners_.push_back(apex);
                todo_.push_back(g);
            }
        regions_.push_back(normalized(sum));
    }

    struct few {
        std::uint32_t* first;
        std::uint32_t* last;
        [[nodiscard]] std::uint32_t* begin() const { return first; }
        [[nodiscard]] std::uint32_t* end() const { return last; }
    };
    /// The other ends of the edges at v between two regions.
    few border_neighbours(std::uint32_t v, std::uint32_t start) {
        todo_.clear();
        std::uint32_t t = start;
        do {
            const std::uint32_t k = triangles_[t].find(v), g = triangles_[t].next[k];
            if (region_[t] != region_[g]) todo_.push_back(triangles_[t].corner[next_corner(k)]);
            t = g;
        } while (t != start);
        return {todo_.begin(), todo_.end()};
    }

    std::uint32_t polygon_of(std::uint32_t h) {
        std::uint32_t t = h / 3;
        while (polygon_[t] != t) t = polygon_[t] = polygon_[polygon_[t]];
        return t;
    }
    /// How far b lies outside of the line from a to c, seen from the side to which n points.
    static double bulge(const vec<double, 3>& a, const vec<double, 3>& b, const vec<double, 3>& c,
                        const vec<double, 3>& n) {
        return dot(n, cross(b - a, normalized(c - a)));
    }
    /// Takes the edge of half-edge h away, if the polygons on its two sides make a convex one.
    bool join_across(std::uint32_t h) {
        const std::uint32_t t = twin_[h], a = polygon_of(h), b = polygon_of(t);
        if (a == b || region_[a] != region_[b] || degree_[origin(h)] < 4 || degree_[origin(t)] < 4) return false;
        const bool first_smaller = size_[a] < size_[b];
        const std::uint32_t smaller = first_smaller ? h : t, larger = first_smaller ? b : a;
        for (std::uint32_t e = next_[smaller]; e != smaller; e = next_[e])
            if (polygon_of(twin_[e]) == larger) return false;
        const vec<double, 3>& n = regions_[region_[a]];
        const double u = bulge(point(previous_[h]), point(h), point(next_[next_[t]]), n);
        const double v = bulge(point(previous_[t]), point(t), point(next_[next_[h]]), n);
        if (u < -tolerance_ || v < -tolerance_) return false;
        // Corners that hardly stick out are bent, on another plane through the same points; of many corners no plane
        // is in doubt.
        const double minimum = size_[a] + size_[b] < 64 ? tolerance_ : 0;
        const bool bent = bent_[a] || bent_[b] || !(u > minimum) || !(v > minimum);
        unlink(h, t);
        if (bent && !convex(next_[t])) {
            link(h, t);
            return false;
        }
        const std::uint32_t joined = first_smaller ? b : a;
        polygon_[a] = polygon_[b] = joined;
        size_[joined] = size_[a] + size_[b] - 2;
        bent_[joined] = bent;
        gone_[h] = gone_[t] = true;
        --degree_[origin(h)];
        --degree_[origin(t)];
        return true;
    }
    void unlink(std::uint32_t h, std::uint32_t t) {
        next_[previous_[h]] = next_[t];
        previous_[next_[t]] = previous_[h];
        next_[previous_[t]] = next_[h];
        previous_[next_[h]] = previous_[t];
    }
    /// Undoes unlink(h, t): both still know where they were.
    void link(std::uint32_t h, std::uint32_t t) {
        next_[previous_[h]] = previous_[next_[h]] = h;
        next_[previous_[t]] = previous_[next_[t]] = t;
    }
    /// Whether no corner of a polygon is farther than the tolerance outside of any of its edges' lines.
    [[nodiscard]] PHYSICS_HPP_COLD bool convex(std::uint32_t start) {
        corners_.clear();
        std::uint32_t e = start;
        do {
            corners_.push_back(origin(e));
            e = next_[e];
        } while (e != start);
        const vec<double, 3> n = hull_normal(points_, corners_.begin(), corners_.size());
        do {
            const vec<double, 3> a = point(e), along = point(next_[e]) - a;
            if (length(along) > tolerance_) {
                const vec<double, 3> inwards = cross(n, normalized(along));
                for (std::uint32_t i = next_[next_[e]]; i != e; i = next_[i])
                    if (dot(inwards, point(i) - a) < -tolerance_) return false;
            }
            e = next_[e];
        } while (e != start);
        return true;
    }

    void write(std::uint32_t count, hull_outline<3>& outline) {
        const std::uint32_t n = next_.size();
        buffer<std::uint32_t> number, face;
        number.resize(count, none);
        face.resize(n, none);
        outline.vertices.clear();
        for (std::uint32_t v = 0; v < count; ++v) {
            if (degree_[v] == 0) continue;
            number[v] = outline.vertices.size();
            outline.vertices.push_back(points_[v]);
        }
        if (outline.vertices.size() > hull_data<double, 3>::max_vertices) return;
        outline.face_begin.push_back(0);
        buffer<std::uint64_t> keys;
        for (std::uint32_t start = 0; start < n; ++start) {
            if (gone_[start] || face[start] != none) continue;
            std::uint32_t h = start;
            do {
                face[h] = outline.face_begin.size() - 1;
                outline.face_vertices.push_back(static_cast<std::uint16_t>(number[origin(h)]));
                const std::uint32_t from = number[origin(h)], to = number[origin(twin_[h])];
                if (from < to) keys.push_back(std::uint64_t{h} << 32 | from << 16 | to);
                h = next_[h];
            } while (h != start);
            outline.face_begin.push_back(outline.face_vertices.size());
        }
        buffer<std::uint64_t> scratch;
        scratch.resize(keys.size());
        const std::uint64_t* sorted = radix_sort(keys.begin(), scratch.begin(), keys.size(), 0, 32);
        for (std::uint32_t i = 0; i < keys.size(); ++i) {
            const std::uint32_t h = static_cast<std::uint32_t>(sorted[i] >> 32);
            outline.edges.push_back(
                {{static_cast<std::uint16_t>(sorted[i] >> 16 & 0xffff), static_cast<std::uint16_t>(sorted[i] & 0xffff)},
                 {face[h], face[twin_[h]]}});
        }
    }

    const vec<double, 3>* points_;
    const buffer<hull_triangle>& triangles_;
    double tolerance_;
    buffer<vec<double, 3>> area_, regions_;
    buffer<std::uint32_t> region_, corners_, todo_;
    buffer<std::uint32_t> next_, previous_, twin_, polygon_, size_, degree_;
    buffer<bool> gone_, bent_;
};

}  // namespace detail

PHYSICS_HPP_END
