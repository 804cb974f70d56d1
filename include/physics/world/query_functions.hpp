// What users ask a world for.
#pragma once

#include "physics/world/query_batches.hpp"
#include "physics/world/world_code.hpp"

PHYSICS_HPP_BEGIN

/// The queries of a world. They see shapes where they are now; the filter says which (see query_filter). O(log shapes)
/// where the broadphase answers queries, as those of the library do; else O(shapes). Visitors are called after all has
/// been found, so that they may change the world, or step it: what has been destroyed by then is left out.
template <class World, class Plan>
class query_functions {
    static constexpr int D = Plan::dimension;
    using S = typename Plan::scalar;

public:
    /// The first shape that a ray meets on its way from a point, along a translation (m); of several at once that of
    /// the least number.
    [[nodiscard]] world_hit<S, D> cast_ray(vec<S, D> origin, vec<S, D> translation,
                                           const query_filter& filter = {}) const {
        return detail::world_code<Plan>::cast_ray(state(), origin, translation, filter);
    }
    /// Calls visit(hit) for shapes that the ray meets, in their order along it. Where visit returns a bool, false ends
    /// the query. To find the first alone, cast_ray is faster.
    template <class Visit>
    void each_hit_along_ray(vec<S, D> origin, vec<S, D> translation, const query_filter& filter, Visit&& visit) const {
        detail::each_hit_along_ray(state(), origin, translation, filter, visit);
    }
    /// The first shape that a convex shape meets on its way from a pose along a translation, without turning.
    template <class Shape>
    [[nodiscard]] world_hit<S, D> cast_shape(const Shape& shape, const transform<S, D>& pose, vec<S, D> translation,
                                             const query_filter& filter = {}) const {
        return detail::scoped([&] { return detail::cast_shape(state(), shape, pose, translation, filter); });
    }
    /// Calls visit(shape_id) for every shape that a convex shape at that pose touches or overlaps, in ascending order
    /// of numbers. Where visit returns a bool, false ends the query.
    template <class Shape, class Visit>
    void each_overlapping(const Shape& shape, const transform<S, D>& pose, const query_filter& filter,
                          Visit&& visit) const {
        detail::each_overlapping(state(), "each_overlapping", shape, pose, filter, visit);
    }
    /// The same for shapes that hold a point.
    template <class Visit>
    void each_at(vec<S, D> point, const query_filter& filter, Visit&& visit) const {
        if (detail::check_bounded("each_at", "point", point))
            detail::each_overlapping(state(), "each_at", detail::point_shape<S, D>{}, {point, {}}, filter, visit);
    }
    /// Calls visit(shape_contact) for the contacts that a shape of the recipe's set would have at that pose: with all
    /// that is no farther than the margin (m), in ascending order of shapes' numbers and of their parts. Where visit
    /// returns a bool, false ends the query. Cost: that of their narrowphase.
    template <class Shape, class Visit>
    void collide_shape(const Shape& shape, const transform<S, D>& pose, S margin, const query_filter& filter,
                       Visit&& visit) const {
        if (!detail::scoped([&] { return check(shape, "collide_shape"); })) return;
        typename Plan::shape any;
        any = shape;
        buffer<shape_contact<S, D>> found;
        detail::world_code<Plan>::collide_shape(state(), any, pose, margin, filter, found);
        const std::uint16_t tag = state().tag;
        for (const auto& c : found) {
            // Another world may have taken its place.
            if (state().tag != tag) return;
            if (state().shapes.contains(c.shape.index, c.shape.generation) && !detail::go_on(visit, c)) return;
        }
    }
    /// The shape closest to a point, none farther than `reach` (m).
    [[nodiscard]] closest_hit<S, D> closest_shape(vec<S, D> point, S reach, const query_filter& filter = {}) const {
        return detail::world_code<Plan>::closest_shape(state(), point, reach, filter);
    }

    /// Many rays: writes what each meets first to hits, in their order, as cast_ray gives it. Both are arrays with
    /// data() and size(): of ray_query, and of as many world_hit at least. Refused as a whole, with nothing written,
    /// where one is. With an executor, such as a thread_pool, it shares them out; the world must not change meanwhile.
    template <class Rays, class Hits>
    void cast_rays(const Rays& rays, Hits&& hits) const {
        cast_rays_by({}, rays, hits);
    }
    template <class Rays, class Hits, executor Executor>
    void cast_rays(const Rays& rays, Hits&& hits, Executor& by) const {
        detail::with_tasks("cast_rays", by, [&](const auto& tasks) { cast_rays_by(tasks, rays, hits); });
    }
    /// The same for many casts of one shape: of shape_query.
    template <class Shape, class Casts, class Hits>
    void cast_shapes(const Shape& shape, const Casts& casts, Hits&& hits) const {
        cast_shapes_by({}, shape, casts, hits);
    }
    template <class Shape, class Casts, class Hits, executor Executor>
    void cast_shapes(const Shape& shape, const Casts& casts, Hits&& hits, Executor& by) const {
        detail::with_tasks("cast_shapes", by, [&](const auto& tasks) { cast_shapes_by(tasks, shape, casts, hits); });
    }

private:
    template <class Rays, class Hits>
    void cast_rays_by(const detail::task_runner& tasks, const Rays& rays, Hits& hits) const {
        const char* f = "cast_rays";
        const auto check = [&](const ray_query<S, D>& r) {
            return detail::scoped([&] { return detail::check_translation(f, "origin", r.origin, r.translation); }) &&
                   detail::check_filter(state(), f, r.filter);
        };
        detail::with_batch(f, rays, hits, check, [&](const auto* all, std::uint32_t count, auto* to) {
            detail::run_batch(f, all, count, to, tasks, [&](const ray_query<S, D>& r) {
                return detail::world_code<Plan>::cast_ray(state(), r.origin, r.translation, r.filter);
            });
        });
    }
    template <class Shape, class Casts, class Hits>
    void cast_shapes_by(const detail::task_runner& tasks, const Shape& shape, const Casts& casts, Hits& hits) const {
        const char* f = "cast_shapes";
        const auto may_cast = [&](const shape_query<S, D>& c) {
            return detail::scoped(
                [&] { return detail::check_cast(state(), f, shape, c.pose, c.translation, c.filter); });
        };
        detail::with_batch(f, casts, hits, may_cast, [&](const auto* all, std::uint32_t count, auto* to) {
            detail::run_batch(f, all, count, to, tasks, [&](const shape_query<S, D>& c) {
                return cast_shape(shape, c.pose, c.translation, c.filter);
            });
        });
    }
    const auto& state() const { return detail::world_access::state_of(static_cast<const World&>(*this)); }
};

PHYSICS_HPP_END
