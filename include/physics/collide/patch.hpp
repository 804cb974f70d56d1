// Contact of any two convex shapes: the patch that their faces share, or the points where they are closest.
#pragma once

#include "physics/base/raw_array.hpp"
#include "physics/collide/bounding_half.hpp"
#include "physics/collide/convex.hpp"
#include "physics/collide/reduce2.hpp"
#include "physics/collide/reduce3.hpp"
#include "physics/collide/support_feature.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// What limits a patch: the roundings of the two shapes, how far apart their surfaces may be, and what deviation of
/// the cores is small (m).
struct patch_limits {
    double reference_radius, incident_radius, margin, slack;
};

inline std::uint32_t hash_mixed(std::uint32_t a, std::uint32_t b) {
    return (a ^ b * 0x9e3779b1u) * 0x85ebca6bu ^ a >> 15;
}

/// Adds the contact of a core point of the incident shape that lies `gap` beyond the reference's core, seen along n
/// from the reference.
template <int D>
manifold_point<double, D> touching(const point<D>& on_incident, const point<D>& n, double gap, const patch_limits& by,
                                   std::uint32_t feature) {
    const double surfaces = gap - by.reference_radius - by.incident_radius;
    return {on_incident - n * (by.incident_radius + surfaces * 0.5), surfaces, feature};
}

/// Whether a facet lies within five degrees of the plane across n. A round edge leads its surface along its own normal,
/// which n then misses by 1/255 of the radius at most: where it tilts more, only its deepest point touches.
template <int D>
bool lies_flat(const support_feature<D>& f, const point<D>& n) {
    if (f.flat) return dot(f.normal, n) < -1 + 1.0 / 256;
    const point<D> edge = f.corner[1] - f.corner[0];
    const double tilt = dot(edge, n);
    return tilt * tilt < dot(edge, edge) * (1.0 / 128) && !f.leans_out;
}

/// Keeps what the incident facet has within the sides of the reference facet, seen along n, and adds it to `out` where
/// it is within the margin; `gap` is how far n parts the cores. False, with nothing added, if what n finds closest was
/// cut off: then the two do not touch face to face. Seen in a frame of the caller's; `flip` says that the reference is
/// shape B. Source: Sutherland, Hodgman, Reentrant polygon clipping (1974).
inline bool clip_support_features(const support_feature<3>& reference, const point<3>& n, double gap,
                                  const support_feature<3>& incident, bool flip, const patch_limits& by,
                                  manifold<double, 3>& out) {
    struct corner {
        point<3> at;
        std::uint8_t before, after;
    };
    // Each cut adds a corner at most, and no more than three corners of a face are sharp.
    static_assert(2 * support_feature<3>::capacity + 3 <= max_candidates);
    raw_array<corner, max_candidates> rings[2];
    int count = incident.count, ring = 0;
    for (int i = 0; i < count; ++i)
        rings[0][i] = {incident.corner[i], static_cast<std::uint8_t>(i > 0 ? i - 1 : count - 1),
                       static_cast<std::uint8_t>(i)};
    // Keeps what lies within the limit along m.
    const auto cut = [&](const point<3>& m, const point<3>& from, double limit, int number) {
        const auto name = static_cast<std::uint8_t>(support_feature<3>::capacity + number);
        const auto& in = rings[ring];
        auto& kept = rings[1 - ring];
        int left = 0;
        double beyond = dot(m, in[count - 1].at - from) - limit;
        for (int i = 0; i < count; ++i) {
            const corner& a = in[i > 0 ? i - 1 : count - 1];
            const corner& b = in[i];
            const double next = dot(m, b.at - from) - limit;
            if ((beyond > 0) != (next > 0) && (count > 2 || i > 0)) {
                const point<3> at = a.at + (b.at - a.at) * (beyond / (beyond - next));
                kept[left++] = next > 0 ? corner{at, a.after, name} : corner{at, name, b.before};
            }
            if (!(next > 0)) kept[left++] = b;
            beyond = next;
        }
        count = left;
        ring = 1 - ring;
    };
    // The corners of a face may lie below it by rounding; and where equal boxes meet, rounding must not decide
    // whether corners are cut and named anew.
    const point<3>& base = reference.corner[0];
    point<3> before = base - reference.corner[reference.count - 1];
    for (int e = 0; e < reference.count && count > 0; ++e) {
        const point<3>& from = reference.corner[e];
        const point<3> edge = reference.corner[e + 1 < reference.count ? e + 1 : 0] - from;
        // Of a line only the ends limit; a face is limited by its edges.
        const point<3> m = reference.count == 2 ? n * dot(edge, n) - edge : cross(edge, n);
        cut(m, from, by.slack * length(m), e);
        // At a sharp corner the slack of both edges would lead far beyond it.
        const double turn = dot(before, edge), lengths = dot(before, before) * dot(edge, edge);
        if (reference.count > 2 && count > 0 && turn < 0 && turn * turn > 0.25 * lengths) {
            // Across n, since the facet that is cut may lie far below.
            const point<3> mean = normalized(before) - normalized(edge), tip = mean - n * dot(mean, n);
            cut(tip, from, by.slack * length(tip), support_feature<3>::capacity + e);
        }
        before = edge;
    }
    point<3> up = reference.normal, aside;
    if (!reference.flat) {
        const point<3> edge = reference.corner[1] - base;
        up = normalized(n - edge * (dot(n, edge) / dot(edge, edge)));
        aside = normalized(cross(edge, up));
    }
    const double steep = 1 / dot(up, n);
    raw_array<manifold_point<double, 3>, max_candidates> found;
    int candidates = 0;
    double deepest = gap + 3 * by.slack;
    const std::uint32_t faces = hash_mixed(reference.number << 1 | std::uint32_t{flip}, incident.number);
    for (int i = 0; i < count; ++i) {
        const corner& c = rings[ring][i];
        const double here = dot(up, c.at - base) * steep;
        deepest = min(deepest, here);
        // Two lines touch side by side only where one lies above the other.
        if (!reference.flat && abs(dot(aside, c.at - base)) > by.slack) return false;
        const std::uint32_t feature = hash_mixed(faces, static_cast<std::uint32_t>(c.before << 8 | c.after));
        const manifold_point<double, 3> p = touching(c.at, n, here, by, feature);
        if (!(p.separation > by.margin)) found[candidates++] = p;
    }
    if (deepest > gap + 2 * by.slack) return false;
    out.normal = flip ? -n : n;
    if (by.incident_radius > 0 && !lies_flat(incident, n)) {
        for (int i = 1; i < candidates; ++i)
            if (found[i].separation < found[0].separation) found[0] = found[i];
        candidates = candidates > 1 ? 1 : candidates;
    }
    reduce(found.items, candidates, n, by.slack, out);
    return true;
}

inline bool clip_support_features(const support_feature<2>& reference, const point<2>& n, double gap,
                                  const support_feature<2>& incident, bool flip, const patch_limits& by,
                                  manifold<double, 2>& out) {
    const point<2> from = reference.corner[0], edge = reference.corner[1] - from;
    const point<2> up = reference.normal;
    const double whole = dot(edge, edge), limit = by.slack * sqrt(whole), steep = 1 / dot(up, n);
    // Seen along n: along the edge, less what leans.
    const point<2> along = edge - up * (dot(edge, n) * steep);
    const double at[2] = {dot(along, incident.corner[0] - from), dot(along, incident.corner[1] - from)};
    const double low = -limit, high = whole + limit;
    if ((at[0] < low && at[1] < low) || (at[0] > high && at[1] > high)) return false;
    manifold_point<double, 2> found[2];
    double gaps[2];
    for (int k = 0; k < 2; ++k) {
        point<2> p = incident.corner[k];
        const double stop = at[k] < low ? low : at[k] > high ? high : at[k];
        if (stop != at[k]) p += (incident.corner[1 - k] - p) * ((stop - at[k]) / (at[1 - k] - at[k]));
        gaps[k] = dot(up, p - from) * steep;
        // Whether the end is a corner or a cut stays out of the name: of equal boxes it changes with rounding.
        const std::uint32_t feature = hash_mixed(
            hash_mixed(reference.number << 1 | std::uint32_t{flip}, incident.number), static_cast<std::uint32_t>(k));
        found[k] = touching(p, n, gaps[k], by, feature);
    }
    if (min(gaps[0], gaps[1]) > gap + 2 * by.slack) return false;
    const int deeper = gaps[1] < gaps[0] ? 1 : 0;
    const bool whole_edge = !(by.incident_radius > 0) || lies_flat(incident, n);
    out.normal = flip ? -n : n;
    for (int k = 0; k < 2; ++k)
        if (!(found[k].separation > by.margin) && (k == deeper || whole_edge)) out.points[out.count++] = found[k];
    return true;
}

/// What deviation of two cores is small (m): 1/512 of the smaller one's smallest half extent, or rounding.
template <class S, int D>
double slack_of(const core_pair<D>& pair) {
    const double size = extent_of(pair.a, pair.placed);
    // The extents add up all coordinates, which may be the root of D times too much.
    const double rounding = static_cast<double>(rounding_of(S(1))) * 0.5 * (is_fixed<S> ? max(size, 1.0) : size);
    const double smallest = min(pair.a.thickness + pair.a.radius, pair.b.thickness + pair.b.radius);
    return max(smallest * (1.0 / 512), rounding);
}

/// Contact of two cores with their roundings, in A's frame, once it is known how to part them: faces that all but face
/// each other share a patch, which is found by clipping; all others touch in the points that GJK or EPA found. To keep
/// the features of bodies at rest, contacts may deviate by two slacks, never more; points on a round side that leans by
/// up to five degrees by 1/255 of its radius as well, since it is taken for flat.
template <int D>
void find_separated_contacts(const core_pair<D>& pair, core_separation<D> s, double margin, double slack,
                             manifold<double, D>& out) {
    const support_feature<D> of_a = support_feature_of(pair.a, s.normal),
                             of_b = support_feature_of(pair.placed, -s.normal);
    const patch_limits from_a{pair.a.radius, pair.b.radius, margin, slack};
    const patch_limits from_b{pair.b.radius, pair.a.radius, margin, slack};
    const auto by_face_of_a = [&](const point<D>& n, double gap) {
        return of_b.count > 1 && clip_support_features(of_a, n, gap, of_b, false, from_a, out);
    };
    const auto by_face_of_b = [&](const point<D>& n, double gap) {
        return of_a.count > 1 && clip_support_features(of_b, n, gap, of_a, true, from_b, out);
    };
    // Faces before edges and a's before b's where they are alike, so that the choice does not flicker.
    const double gap_a =
        of_a.flat ? dot(of_a.normal, pair.placed.support(-of_a.normal).at - of_a.corner[0]) : -no_limit;
    const double gap_b = of_b.flat ? dot(of_b.normal, pair.a.support(-of_b.normal).at - of_b.corner[0]) : -no_limit;
    const bool use_b = gap_b > gap_a + 2 * slack;
    const bool facing = s.gap <= (use_b ? gap_b : gap_a) + 2 * slack;
    if (facing && !use_b && by_face_of_a(of_a.normal, gap_a)) return;
    if (facing && (use_b || gap_b > s.gap - 2 * slack) && by_face_of_b(of_b.normal, gap_b)) return;
    // Faces that all but face each other keep their points where an edge gives the normal; so do edges side by side.
    constexpr double nearly = 0.9986;
    if (of_a.flat && dot(of_a.normal, s.normal) > nearly && by_face_of_a(s.normal, s.gap)) return;
    if (of_b.flat && dot(of_b.normal, s.normal) < -nearly && by_face_of_b(-s.normal, s.gap)) return;
    if (!of_a.flat && !of_b.flat && of_a.count == 2 && lies_flat(of_a, s.normal) && by_face_of_a(s.normal, s.gap))
        return;

    locate(pair, s);
    std::uint32_t feature = 0x80000000u;
    for (int i = 0; i < s.name_count; ++i) feature += hash_mixed(s.names[i], 0x51u);
    out.normal = s.normal;
    out.points[out.count++] = touching<D>(s.on_a + s.normal * s.gap, s.normal, s.gap, from_a, feature);
}

/// Contact of two cores; what pairs without a function of their own get.
template <class S, int D>
void find_core_contacts(const core_pair<D>& pair, double margin, gjk_cache* cache, overlap_method method,
                        manifold<double, D>& out) {
    const double reach = pair.a.radius + pair.b.radius + margin;
    const core_separation<D> s = separate<S>(pair, reach, cache, method);
    if (!s.beyond && !(s.gap > reach)) find_separated_contacts(pair, s, margin, slack_of<S>(pair), out);
}

template <class S, int D>
void add_rounded_once(const manifold<double, D>& m, manifold<S, D>& out) {
    out.normal = from_point<S>(m.normal);
    for (int i = 0; i < m.count; ++i)
        out.add(from_point<S>(m.points[i].position), static_cast<S>(m.points[i].separation), m.points[i].feature);
}

/// The same for any two shapes that have cores.
template <class A, class B, class S, int D>
void collide_cores(const A& a, const B& b, const transform<S, D>& b_in_a, S margin, gjk_cache* cache,
                   overlap_method method, manifold<S, D>& out) {
    const core_pair<D> pair(a, b, b_in_a);
    manifold<double, D> m;
    find_core_contacts<S>(pair, detail::to_double(margin), cache, method, m);
    add_rounded_once(m, out);
}

/// Contact of a core with a halfspace: the corners of what the core turns towards it.
template <class S, int D>
void find_halfspace_contacts(const placed_core<D>& c, const bounding_half<D>& half, double margin,
                             manifold<double, D>& out) {
    const point<D>& n = half.normal;
    const support_feature<D> f = support_feature_of(c, -n);
    raw_array<manifold_point<double, D>, support_feature<D>::capacity + 1> found;
    const patch_limits by{0, c.shape->radius, margin, 0};
    int count = 0;
    const auto touch = [&](const point<D>& p, std::uint32_t feature) {
        const manifold_point<double, D> at = touching(p, n, half.height(p), by, feature);
        if (!(at.separation > by.margin)) found[count++] = at;
    };
    double deepest = no_limit;
    for (int i = 0; i < f.count; ++i) {
        deepest = min(deepest, dot(n, f.corner[i]));
        touch(f.corner[i], hash_mixed(f.number, static_cast<std::uint32_t>(i)));
    }
    // The lowest point may be none of the corners, of round shapes and of faces that were thinned out.
    const support_point<D> lowest = c.support(-n);
    const double slack =
        max(c.shape->thickness * (1.0 / 512), static_cast<double>(rounding_of(S(1))) * c.shape->extent);
    if (dot(n, lowest.at) < deepest - slack) touch(lowest.at, hash_mixed(0x80000000u, lowest.vertex));
    out.normal = -n;
    reduce(found.items, count, n, slack, out);
}
/// Contact of any shape that has a core with a halfspace.
template <class A, class S, int D>
void collide_with_plane(const A& a, const halfspace<S, D>& b, const transform<S, D>& b_in_a, S margin,
                        manifold<S, D>& out) {
    const core<D> c = core_of(a);
    manifold<double, D> m;
    find_halfspace_contacts<S>(placed_core<D>{&c, mat<double, D>::identity(), {}}, bounding_half<D>(b, b_in_a),
                               detail::to_double(margin), m);
    add_rounded_once(m, out);
}

}  // namespace detail

PHYSICS_HPP_END
