// Contact with surfaces made of flat parts, such as meshes and chains, without bumps where parts meet.
#pragma once

#include "physics/collide/contact_support_set.hpp"
#include "physics/collide/patch.hpp"
#include "physics/shape/surface_part.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The direction in the part's plane that leads out over end or edge i, of any length.
inline point<2> outwards(const surface_part<2>& p, int i) {
    const point<2> e = p.corner[1] - p.corner[0];
    return i == 0 ? -e : e;
}
inline point<3> outwards(const surface_part<3>& p, int i) {
    return cross(p.corner[i < 2 ? i + 1 : 0] - p.corner[i], p.normal);
}

inline void flipped_in_place(surface_part<2>& p) {
    std::swap(p.corner[0], p.corner[1]);
    std::swap(p.beyond[0], p.beyond[1]);
    std::swap(p.continues[0], p.continues[1]);
}
inline void flipped_in_place(surface_part<3>& p) {
    std::swap(p.corner[0], p.corner[1]);
    std::swap(p.beyond[1], p.beyond[2]);
    std::swap(p.continues[1], p.continues[2]);
}

/// Unit vectors may deviate by as much and count as the same.
inline constexpr double same_direction = 1e-4;

/// Whether the contact normal m lies in the part's own arc of normals: m does not lean out over an edge beyond which
/// the surface continues, unless that neighbour bends away and m lies before its normal. Prevents ghost collisions.
/// Source: ghost vertices, Catto, Box2D (2010).
template <int D>
bool in_normal_arc(const surface_part<D>& p, const point<D>& m) {
    constexpr double blur = same_direction;
    const double up = dot(m, p.normal);
    bool around_edge = false;
    for (int i = 0; i < D; ++i) {
        const point<D> out = unit(outwards(p, i));
        const double lean = dot(m, out);
        if (!(lean > blur)) continue;
        around_edge = true;
        if (!p.continues[i]) continue;
        const double bend = dot(p.beyond[i], out), beyond_up = dot(p.beyond[i], p.normal);
        if (!(bend > blur) || lean * beyond_up - up * bend > blur) return false;
    }
    return around_edge || up > 0;
}

template <int D>
core<D> core_of_part(const surface_part<D>& p, double radius) {
    core<D> c;
    c.kind = D == 2 ? core_kind::segment : core_kind::triangle;
    c.radius = radius;
    for (int i = 0; i < D; ++i) {
        c.corner[i] = p.corner[i];
        c.center += p.corner[i] * (1.0 / D);
        for (int k = 0; k < D; ++k) c.extent = max(c.extent, abs(p.corner[i][k]) * D);
    }
    // A surface has no thickness that would be small beside the body's.
    c.thickness = no_limit;
    return c;
}

/// What deviation is small where a body touches a part (m): that of slack_of(), since parts have no thickness.
template <class S, int D>
double slack_beside(const surface_part<D>& part, const placed_core<D>& body) {
    double size = body.shape->extent + largest(body.at);
    for (int i = 0; i < D; ++i) size = max(size, largest(part.corner[i]) * D);
    const double rounding = static_cast<double>(rounding_of(S(1))) * (is_fixed<S> ? max(size, 1.0) : size);
    return max((body.shape->thickness + body.shape->radius) * (1.0 / 512), rounding);
}

/// Adds the body's lowest point where it stands above the part and lies deeper than the points that were found: of
/// round shapes, of faces that were thinned out, and of hulls that turn another face to the part.
template <int D>
void touch_lowest(const surface_part<D>& p, const point<D>& lowest, const patch_limits& by, manifold<double, D>& out) {
    const manifold_point<double, D> found =
        touching(lowest, p.normal, dot(p.normal, lowest - p.corner[0]), by, 0x80000000u);
    double deepest = by.margin + by.slack;
    int shallowest = 0;
    for (int i = 0; i < out.count; ++i) {
        deepest = min(deepest, out.points[i].separation);
        if (out.points[i].separation > out.points[shallowest].separation) shallowest = i;
    }
    if (!(found.separation < deepest - by.slack)) return;
    for (int i = 0; i < D; ++i) {
        const point<D> over = outwards(p, i);
        const double beyond = dot(over, lowest - p.corner[i]);
        if (beyond > 0 && beyond * beyond > by.slack * by.slack * dot(over, over)) return;
    }
    out.normal = p.normal;
    out.points[out.count < manifold<double, D>::capacity ? out.count++ : shallowest] = found;
}

/// What a body turns towards parts, kept from part to part: most lie in few planes.
template <int D>
struct rotated_support_feature {
    support_feature<D> ground, above;
    /// The normal of the parts that `above` is for; null at first.
    point<D> normal;

    const support_feature<D>& of(const placed_core<D>& body, const point<D>& n) {
        if (n == normal) return above;
        normal = n;
        above = support_feature_of(body, -n);
        return above;
    }
};

/// What stands above a part, and how far.
template <int D>
void touch_above(const surface_part<D>& part, const placed_core<D>& body, const point<D>& lowest,
                 const patch_limits& by, rotated_support_feature<D>& facets, manifold<double, D>& out) {
    const support_feature<D>& above = facets.of(body, part.normal);
    if (above.count == 0) {
        touch_lowest(part, lowest, by, out);
        return;
    }
    support_feature<D>& ground = facets.ground;
    ground.count = D;
    ground.flat = true;
    ground.normal = part.normal;
    for (int i = 0; i < D; ++i) ground.corner[i] = part.corner[i];
    clip_support_features(ground, part.normal, no_limit, above, false, by, out);
    if constexpr (D == 3) touch_lowest(part, lowest, by, out);
}

/// Contact of one part of a surface, rounded by `radius`, with a core that stands in the surface's frame. The normal is
/// the part's own but where the core touches an end or an edge that stands out. False if the contact is in doubt: there
/// is a shorter way to part the two, over an edge that the surface goes on beyond, so that the body may as well stand
/// beside the part and touch a neighbour of it. Where the two overlap and nothing is found, `last_resort` becomes the
/// way to part them, if it holds no deeper one.
template <class S, int D>
bool touch_part(surface_part<D> part, double radius, const placed_core<D>& body, double margin, overlap_method method,
                rotated_support_feature<D>& facets, manifold<double, D>& out, manifold<double, D>& last_resort) {
    const point<D> center = body.axes * body.shape->center + body.at;
    if (dot(part.normal, center - part.corner[0]) < 0) {
        if (!part.two_sided) return true;
        flipped_in_place(part);
        part.normal = -part.normal;
        for (point<D>& n : part.beyond) n = -n;
    }
    const point<D> n = part.normal, lowest = body.support(-n).at;
    const double radii = radius + body.shape->radius, reach = radii + margin;
    const double height = dot(n, lowest - part.corner[0]);
    if (height > reach) return true;
    // The ways out over ends or edges, and whether the surface goes on there as it is or rises.
    double aside = -no_limit;
    bool closed = true;
    for (int i = 0; i < D; ++i) {
        const point<D> over = unit(outwards(part, i));
        aside = max(aside, dot(over, body.support(-over).at - part.corner[i]));
        closed = closed && part.continues[i] && !(dot(part.beyond[i], over) > same_direction);
    }
    if (aside > reach) return true;

    const double slack = slack_beside<S>(part, body);
    const patch_limits by{radius, body.shape->radius, margin, slack};
    touch_above(part, body, lowest, by, facets, out);
    double deepest = no_limit;
    for (int i = 0; i < out.count; ++i) deepest = min(deepest, out.points[i].separation);
    // Neighbours that rise leave a body no way out over an edge; and where its lowest point stands above the part, none
    // can be much shorter than a short way up.
    const bool upwards = height >= 0 || aside <= height + 2 * slack;
    const bool above = height >= -8 * slack && deepest <= height - radii + slack;
    if (closed || (upwards && above)) return upwards;

    const core_pair<D> pair(core_of_part(part, radius), *body.shape, body.axes, body.at);
    core_separation<D> s = separate<S>(pair, reach, nullptr, method);
    if (s.beyond || s.gap > reach) {
        out = {};
        return true;
    }
    const bool flat = height >= s.gap - 2 * slack, own = in_normal_arc(part, s.normal);
    const auto touch_once = [&](manifold<double, D>& m) {
        locate(pair, s);
        m = {};
        m.normal = s.normal;
        m.points[m.count++] = touching<D>(s.on_a + s.normal * s.gap, s.normal, s.gap, by, 0x80000000u);
    };
    if (!own) {
        const double depth = radii - s.gap;
        if (out.count == 0 && depth > 0 && (last_resort.count == 0 || depth > -last_resort.points[0].separation))
            touch_once(last_resort);
        return flat;
    }
    if (flat && deepest < s.gap - radii + 2 * slack) return true;
    out = {};
    find_separated_contacts(pair, s, margin, slack, out);
    if (out.count > 0 && in_normal_arc(part, out.normal)) return true;
    touch_once(out);
    return true;
}

/// Whether a part and a core that has moved are parted, or all but.
template <class S, int D>
bool separated(const surface_part<D>& part, double radius, const placed_core<D>& body, const point<D>& moved) {
    const core_pair<D> pair(core_of_part(part, radius), *body.shape, body.axes, body.at + moved);
    const double reach = radius + body.shape->radius;
    const gjk_result<D> r = gjk(pair.a, pair.placed, reach, relative_tolerance<S>(), nullptr);
    return r.beyond || (!r.overlapping && r.distance >= reach);
}

/// The parts of a surface that a body touches and that are in doubt; where there are more, the rest counts as certain.
template <int D>
struct doubtful_parts {
    static constexpr int capacity = 16;
    raw_array<surface_part<D>, capacity> part;
    std::uint32_t place[capacity];
    int count = 0;

    void add(const surface_part<D>& p, std::uint32_t in_list) {
        if (count == capacity) return;
        part[count] = p;
        place[count++] = in_list;
    }
    [[nodiscard]] bool holds(std::uint32_t in_list) const {
        for (int k = 0; k < count; ++k)
            if (place[k] == in_list) return true;
        return false;
    }
    void remove(int k) {
        part[k] = part[--count];
        place[k] = place[count];
    }
};

template <class S, int D>
double depth_of(const manifold<S, D>& m) {
    double depth = 0;
    for (int i = 0; i < m.count; ++i) depth = max(depth, -static_cast<double>(m.points[i].separation));
    return depth;
}

/// Drops the doubtful ones among the contacts of a body, from `first` on, that another contact undoes: with the body
/// moved out of that, it does not touch the part any more. The least deep ones are believed first.
template <class S, int D, class List>
void drop_doubtful(List& list, std::uint32_t first, doubtful_parts<D>& doubtful, double radius,
                   const placed_core<D>& body, double slack) {
    const auto other_way = [&](std::uint32_t i, std::uint32_t j) {
        return !(dot(list[i].contact.normal, list[j].contact.normal) > S(0.875));
    };
    bool one_way = true;
    for (std::uint32_t i = first; i < list.size(); ++i) one_way = one_way && !other_way(first, i);
    while (!one_way && doubtful.count > 0) {
        int minimum = 0;
        for (int k = 1; k < doubtful.count; ++k)
            if (depth_of(list[doubtful.place[k]].contact) < depth_of(list[doubtful.place[minimum]].contact))
                minimum = k;
        const std::uint32_t here = doubtful.place[minimum];
        auto& contact = list[here].contact;
        for (std::uint32_t i = first; i < list.size() && contact.count > 0; ++i) {
            const auto& other = list[i].contact;
            const double depth = depth_of(other);
            if (depth > 0 && other_way(i, here) && !doubtful.holds(i) &&
                separated<S>(doubtful.part[minimum], radius, body, to_point(other.normal) * (depth + 2 * slack)))
                contact.count = 0;
        }
        doubtful.remove(minimum);
    }
}

/// Joins the manifolds from `first` on whose normals are alike, and leaves as few points of them as hold what all do.
template <class S, int D, class List>
void join_alike(List& list, std::uint32_t first, S slack) {
    constexpr int capacity = manifold<S, D>::capacity;
    const S alike = S(0.9995);
    const std::uint32_t end = list.size();
    for (std::uint32_t i = first; i < end; ++i) {
        if (list[i].contact.count == 0) continue;
        auto joined = list[i];
        manifold_point<S, D> points[max_candidates];
        int count = 0;
        const auto thin_out = [&] { count = keep_supports(points, count, joined.contact.normal, slack); };
        for (std::uint32_t j = i; j < end; ++j) {
            auto& other = list[j].contact;
            if (other.count == 0 || !(dot(other.normal, joined.contact.normal) > alike)) continue;
            if (count + other.count > max_candidates) thin_out();
            for (int k = 0; k < other.count; ++k) points[count++] = other.points[k];
            joined.part = list[j].part < joined.part ? list[j].part : joined.part;
            other.count = 0;
        }
        if (count > capacity) thin_out();
        for (int from = 0; from < count; from += capacity) {
            joined.contact.count = count - from < capacity ? count - from : capacity;
            for (int k = 0; k < joined.contact.count; ++k) joined.contact.points[k] = points[from + k];
            list.push_back(joined);
        }
    }
    const std::uint32_t kept = list.size() - end;
    for (std::uint32_t k = 0; k < kept; ++k) list[first + k] = list[end + k];
    while (list.size() > first + kept) list.pop_back();
}

/// The box around a core that stands somewhere, grown by a margin.
template <int D>
aabb<double, D> bounds_of(const placed_core<D>& c, double margin) {
    aabb<double, D> box;
    for (int i = 0; i < D; ++i) {
        point<D> n;
        n[i] = 1;
        box.upper[i] = c.support(n).at[i] + c.shape->radius + margin;
        box.lower[i] = c.support(-n).at[i] - c.shape->radius - margin;
    }
    return box;
}

}  // namespace detail

PHYSICS_HPP_END
