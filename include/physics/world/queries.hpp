// What can be asked of a world: rays, casts, overlaps, the closest thing.
#pragma once

#include "physics/base/small_buffer.hpp"
#include "physics/base/sort.hpp"
#include "physics/collide/part_queries.hpp"
#include "physics/step/collide.hpp"
#include "physics/step/nearby.hpp"
#include "physics/world/check.hpp"

PHYSICS_HPP_BEGIN

/// The shape that a ray or a moving shape meets first, and where, in world axes.
template <class S, int D>
struct world_hit {
    shape_id shape;
    body_id body;
    /// The part of the translation up to there; 0 if it begins in touch.
    S fraction = S(1);
    /// On the shape's surface.
    vec<S, D> point;
    /// Unit vector out of the shape; null where a ray begins within.
    vec<S, D> normal;

    /// Whether the ray begins strictly within the shape.
    [[nodiscard]] bool inside() const { return *this && normal == vec<S, D>{}; }
    /// True if anything is hit.
    explicit operator bool() const { return static_cast<bool>(shape); }
};

/// The shape closest to a point.
template <class S, int D>
struct closest_hit {
    shape_id shape;
    body_id body;
    /// From the surface to the point (m); negative within.
    S distance{};
    /// On the surface.
    vec<S, D> point;
    /// Unit vector out of the shape.
    vec<S, D> normal;

    explicit operator bool() const { return static_cast<bool>(shape); }
};

/// A contact that a shape would have with one of a world's, or with a part of that.
template <class S, int D>
struct shape_contact {
    struct point {
        /// Halfway between the surfaces (m).
        vec<S, D> position;
        /// Distance of the surfaces along the normal (m); negative is the depth of their overlap.
        S separation;
    };

    shape_id shape;
    body_id body;
    /// Which part of a concave shape; 0 of convex ones.
    std::uint32_t part;
    /// Unit vector out of the world's shape.
    vec<S, D> normal;
    point points[manifold<S, D>::capacity];
    int count;

    /// That of the point which is deepest.
    [[nodiscard]] S separation() const {
        S deepest = points[0].separation;
        for (int k = 1; k < count; ++k) deepest = min(deepest, points[k].separation);
        return deepest;
    }
};

namespace detail {

/// A point, as a shape to ask with.
template <class S, int D>
struct point_shape {};
template <class S, int D>
bool check(const point_shape<S, D>&, const char*) {
    return true;
}
template <class S, int D>
aabb<S, D> bounds(const point_shape<S, D>&, const transform<S, D>& at) {
    return {at.position, at.position};
}
// The one below must not hide those of shapes.
using physics::core_of;
template <class S, int D>
core<D> core_of(const point_shape<S, D>&) {
    return {};
}

template <class Plan>
shape_id id_of_shape(const state<Plan>& s, std::uint32_t i) {
    return {i, s.shapes.generation(i), s.tag};
}
template <class Plan>
body_id body_of_shape(const state<Plan>& s, std::uint32_t i) {
    const std::uint32_t b = s.shapes[i].body;
    return {b, s.bodies.generation(b), s.tag};
}

/// Calls f(shape's number) for shapes whose boxes a ray meets; f returns the fraction up to which it goes on.
template <class Plan, class F>
void each_on(const state<Plan>& s, const ray<typename Plan::scalar, Plan::dimension>& r, const query_filter& filter,
             F&& f) {
    using S = typename Plan::scalar;
    if constexpr (requires { s.broadphase.each_along(r, filter, [](const proxy_hit<S>&) { return S(1); }); }) {
        s.broadphase.each_along(r, filter, [&](const proxy_hit<S>& hit) { return f(hit.id); });
    } else {
        S limit(1), at{};
        s.shapes.each([&](std::uint32_t i, const auto& shape) {
            if (limit >= S(0) && filter.sees(filter_of(s, shape)) && meets(r, query_bounds(s, shape), limit, at))
                limit = min(limit, f(i));
        });
    }
}
template <class Plan>
bool check_filter(const state<Plan>& s, const char* function, const query_filter& filter) {
    return !filter.except || find(s, s.bodies, filter.except, function, "except");
}
template <class S, int D>
bool check_translation(const char* function, const char* from, vec<S, D> origin, vec<S, D> translation) {
    if (!check_bounded(function, from, origin) || !check_bounded(function, "translation", translation)) return false;
    const vec<S, D> end = origin + translation;
    // In fixed point a sum beyond the range comes out on the other side.
    if constexpr (!std::is_floating_point_v<S>)
        for (int i = 0; i < D; ++i) {
            const char component[] = {'.', "xyz"[i], '\0'};
            if (translation[i] > S(0) ? end[i] < origin[i] : end[i] > origin[i])
                return refuse(function, "end of the way", component, to_double(origin[i]) + to_double(translation[i]),
                              "it must lie within the scalar's range");
        }
    return check_bounded(function, "end of the way", end);
}

/// Calls visit(hit) for shapes that a ray meets, in any order; it must not change the world. visit returns the fraction
/// up to which the ray goes on.
template <class Plan, class Visit>
void cast_ray(const state<Plan>& s, const char* function, vec<typename Plan::scalar, Plan::dimension> origin,
              vec<typename Plan::scalar, Plan::dimension> translation, const query_filter& filter, Visit&& visit) {
    using S = typename Plan::scalar;
    if (!check_translation(function, "origin", origin, translation) || !check_filter(s, function, filter)) return;
    S limit(1);
    each_on(s, {origin, translation}, filter, [&](std::uint32_t i) {
        const auto& shape = s.shapes[i];
        const auto hit = cast_ray(shape.shape, s.bodies[shape.body].pose(), shape.local, origin, translation);
        if (hit && !(hit.fraction > limit) && (filter.inside || !(hit.normal == decltype(hit.normal){})))
            limit = min(limit, visit(world_hit<S, Plan::dimension>{id_of_shape(s, i), body_of_shape(s, i), hit.fraction,
                                                                   hit.point, hit.normal}));
        return limit;
    });
}

/// Whether the first of two hits comes first: the numbers of shapes decide where both come at once.
template <class Hit>
bool comes_first(const Hit& a, const Hit& b) {
    return !b || a.fraction < b.fraction || (a.fraction == b.fraction && a.shape.index < b.shape.index);
}

/// Whether a query passes a shape that is one_way, which it meets by a normal out of it; separation() says how far it
/// is from that there.
template <class Plan, class Separation>
bool passes([[maybe_unused]] const state<Plan>& s, [[maybe_unused]] const shape_record<Plan>& shape,
            [[maybe_unused]] const query_filter& filter,
            [[maybe_unused]] const vec<typename Plan::scalar, Plan::dimension>& normal,
            [[maybe_unused]] Separation&& separation) {
    if constexpr (Plan::has_contact_rule)
        return filter.one_way && shape.one_way &&
               !(one_way_platforms::is_above(shape.pose, normal) &&
                 one_way_platforms::is_outside(separation(), s.settings.contact_margin));
    else return false;
}

/// The separation of any shape and a convex one, if it is at most `reach`; else more than that.
template <class A, class B, class S, int D>
closest_points<S, D> separation_within(const A& a, const B& b, const transform<S, D>& b_in_a, S reach) {
    if constexpr (has_parts<A, D>) return separation(a, b, b_in_a, reach);
    else return separation(a, b, b_in_a);
}

template <class S, int D>
vec<S, D> middle_of(const aabb<S, D>& box) {
    return box.lower + (box.upper - box.lower) * S(0.5);
}
template <class Plan, class Shape>
bool check_cast(const state<Plan>& s, const char* f, const Shape& shape,
                const transform<typename Plan::scalar, Plan::dimension>& pose,
                vec<typename Plan::scalar, Plan::dimension> translation, const query_filter& filter) {
    if (!check(shape, f) || !check_pose(f, pose.position, pose.rotation) ||
        !check_translation(f, "position", pose.position, translation) || !check_filter(s, f, filter))
        return false;
    const auto box = bounds(shape, pose);
    return check_extent(f, box) && check_translation(f, "middle", middle_of(box), translation);
}
template <class Plan, class Shape>
world_hit<typename Plan::scalar, Plan::dimension> cast_shape(
    const state<Plan>& s, const Shape& shape, const transform<typename Plan::scalar, Plan::dimension>& pose,
    vec<typename Plan::scalar, Plan::dimension> translation, const query_filter& filter) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    world_hit<S, D> first;
    if (!check_cast(s, "cast_shape", shape, pose, translation, filter)) return first;
    const aabb<S, D> box = bounds(shape, pose);
    each_on(s, {middle_of(box), translation, (box.upper - box.lower) * S(0.5)}, filter, [&](std::uint32_t i) {
        const transform<S, D> at = s.shapes[i].pose;
        s.shapes[i].shape.visit([&](const auto& other) {
            const auto hit = cast_shape(other, shape, relative(at, pose), inverse_rotate(at.rotation, translation));
            const world_hit<S, D> found{id_of_shape(s, i), body_of_shape(s, i), hit.fraction, at * hit.point,
                                        at.rotation * hit.normal};
            // What it does not touch from the start it meets at the surface.
            const auto start = [&] {
                return hit.fraction > S(0) ? S(0) : separation_within(other, shape, relative(at, pose), S(0)).distance;
            };
            if (hit && comes_first(found, first) && !passes(s, s.shapes[i], filter, found.normal, start)) first = found;
        });
        return first ? first.fraction : S(1);
    });
    return first;
}

/// Calls found(shape's number) for shapes that a shape touches, in any order; it must not change the world.
template <class Plan, class Shape, class Found>
void find_touched(const state<Plan>& s, const char* f, const Shape& shape,
                  const transform<typename Plan::scalar, Plan::dimension>& pose, const query_filter& filter,
                  Found&& found) {
    using S = typename Plan::scalar;
    if (!check(shape, f) || !check_pose(f, pose.position, pose.rotation) || !check_filter(s, f, filter)) return;
    const auto box = bounds(shape, pose);
    if (!check_extent(f, box)) return;
    each_near(s, box, filter, [&](std::uint32_t i) {
        const auto at = relative(s.shapes[i].pose, pose);
        const bool touches = s.shapes[i].shape.visit(
            [&](const auto& other) { return !(separation_within(other, shape, at, S(0)).distance > S(0)); });
        if (touches) found(i);
    });
}
/// Calls visit(id) for them in ascending order of their numbers; it may change the world. What it has destroyed is left
/// out.
template <class Plan, class Shape, class Visit>
void each_overlapping(const state<Plan>& s, const char* f, const Shape& shape,
                      const transform<typename Plan::scalar, Plan::dimension>& pose, const query_filter& filter,
                      Visit&& visit) {
    small_buffer<std::uint64_t, 48> touched;
    scoped([&] {
        find_touched(s, f, shape, pose, filter,
                     [&](std::uint32_t i) { touched.push_back(std::uint64_t{s.shapes.generation(i)} << 32 | i); });
    });
    buffer<std::uint64_t> spare;
    // Fewer are sorted in place.
    if (touched.size() > 48) spare.resize(touched.size());
    const int bits = static_cast<int>(std::bit_width(s.shapes.slots()));
    const std::uint64_t* const sorted = radix_sort(touched.begin(), spare.begin(), touched.size(), 0, bits);
    const std::uint16_t tag = s.tag;
    // Another world may have taken its place.
    for (std::uint32_t k = 0; k < touched.size() && s.tag == tag; ++k) {
        const shape_id id{static_cast<std::uint32_t>(sorted[k]), static_cast<std::uint16_t>(sorted[k] >> 32), tag};
        if (s.shapes.contains(id.index, id.generation) && !go_on(visit, id)) return;
    }
}

/// Finds the contacts that a shape would have at a pose within a margin, in ascending order of shapes and parts.
template <class Plan>
void collide_shape(const state<Plan>& s, const typename Plan::shape& shape,
                   const transform<typename Plan::scalar, Plan::dimension>& pose, typename Plan::scalar margin,
                   const query_filter& filter, buffer<shape_contact<typename Plan::scalar, Plan::dimension>>& to) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const char* f = "collide_shape";
    if (!check_pose(f, pose.position, pose.rotation) || !check_not_negative(f, "margin", margin) ||
        !check_filter(s, f, filter))
        return;
    const auto box = grown(bounds(shape, pose), margin);
    if (!check_extent(f, box)) return;
    manifold_list<S, D> found;
    each_near(s, box, filter, [&](std::uint32_t i) {
        const auto& other = s.shapes[i];
        // The narrowphase wants the shape of the lower kind first.
        const bool is_first = other.shape.kind() <= shape.kind();
        const auto &a = is_first ? other.shape : shape, &b = is_first ? shape : other.shape;
        const auto &at_a = is_first ? other.pose : pose, &at_b = is_first ? pose : other.pose;
        const typename Plan::query query{&a, &b, relative(at_a, at_b)};
        collide_once<Plan>(query, margin, found);
        for (const auto& [number, part, m] : found) {
            const vec<S, D> normal = at_a.rotation * m.normal;
            shape_contact<S, D> c{
                id_of_shape(s, i), body_of_shape(s, i), part, is_first ? normal : -normal, {}, m.count};
            for (int k = 0; k < m.count; ++k) c.points[k] = {at_a * m.points[k].position, m.points[k].separation};
            if (!passes(s, other, filter, c.normal, [&] { return c.separation(); })) to.push_back(c);
        }
    });
    sort_in_place(to.begin(), to.size(), [](const auto& x, const auto& y) {
        return x.shape.index != y.shape.index ? x.shape.index < y.shape.index : x.part < y.part;
    });
}

/// All within a distance of a point, as far as numbers go.
template <class S, int D>
aabb<S, D> around(vec<S, D> point, S reach) {
    const S maximum = scalar_traits<S>::max();
    aabb<S, D> box;
    for (int i = 0; i < D; ++i) {
        box.lower[i] = point[i] > reach - maximum ? point[i] - reach : -maximum;
        box.upper[i] = point[i] < maximum - reach ? point[i] + reach : maximum;
    }
    return box;
}

template <class Plan>
closest_hit<typename Plan::scalar, Plan::dimension> closest_shape(const state<Plan>& s,
                                                                  vec<typename Plan::scalar, Plan::dimension> point,
                                                                  typename Plan::scalar reach,
                                                                  const query_filter& filter) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const char* f = "closest_shape";
    closest_hit<S, D> best;
    if (!check_bounded(f, "point", point) || !check_not_negative(f, "reach", reach) || !check_filter(s, f, filter))
        return best;
    each_near(s, around(point, reach), filter, [&](std::uint32_t i) {
        const transform<S, D> at = s.shapes[i].pose;
        s.shapes[i].shape.visit([&](const auto& other) {
            const auto c =
                separation_within(other, point_shape<S, D>{}, relative(at, transform<S, D>{point, {}}), reach);
            const bool nearer =
                !best || c.distance < best.distance || (c.distance == best.distance && i < best.shape.index);
            if (c.distance > reach || !nearer) return;
            best = {id_of_shape(s, i), body_of_shape(s, i), c.distance, at * c.on_a, at.rotation * c.normal};
        });
    });
    return best;
}

}  // namespace detail

PHYSICS_HPP_END
