// Where a ray meets a shape.
#pragma once

#include "physics/collide/shape_cast.hpp"

PHYSICS_HPP_BEGIN

/// Where a ray enters a shape, in the frame that both are given in.
template <class S, int D>
struct ray_hit {
    bool hit = false;
    /// The part of the ray's translation up to there; 0 if it begins within, or on the surface.
    S fraction = S(1);
    /// Unit vector outwards; null if the ray begins within.
    vec<S, D> normal;
    vec<S, D> point;

    explicit operator bool() const { return hit; }
};

namespace detail {

/// A ray in a shape's frame, and where it meets the shape; the normal stays null where it begins within.
template <int D>
struct local_ray {
    point<D> origin, way;
};
template <int D>
struct local_hit {
    bool hit = false;
    double fraction = 0;
    point<D> normal;
};

/// The times at which a ray that moves is within r of the frame's origin, ends included; those may lie before its
/// start. Source: Haines et al., Precision improvements for ray/sphere intersection, Ray Tracing Gems (2019), 7.
template <int D>
bool ball_span(const local_ray<D>& ray, double r, double& near, double& far) {
    const auto [direction, length] = split(ray.way);
    const double along = -dot(ray.origin, direction), from = physics::length(ray.origin);
    const double aside = physics::length(ray.origin + direction * along);
    if (!(length > 0) || aside > r) return false;
    const double half = physics::sqrt((r - aside) * (r + aside)), c = (from - r) * (from + r);
    // Of each pair of roots the one that does not cancel gives the other.
    near = (along > 0 ? c / (along + half) : along - half) / length;
    far = (along > 0 ? along + half : along - half < 0 ? c / (along - half) : 0) / length;
    return true;
}

template <int D>
local_hit<D> cast_on_ball(const local_ray<D>& ray, double r) {
    if (dot(ray.origin, ray.origin) <= r * r) return {true, 0, {}};
    double near = 0, far = 0;
    if (!ball_span(ray, r, near, far) || near < 0 || near > 1) return {};
    return {true, near, normalized(ray.origin + ray.way * near)};
}

/// First the endless cylinder around the axis, then the side or the ball at the end where the ray enters that.
template <int D>
local_hit<D> cast_on_capsule(const local_ray<D>& ray, double half_length, double r) {
    local_ray<D> across = ray;
    across.origin.x = across.way.x = 0;
    double near = 0, far = 0;
    const bool begins_beside = dot(across.origin, across.origin) <= r * r;
    if (!begins_beside && (!ball_span(across, r, near, far) || near < 0 || near > 1)) return {};
    const double x = ray.origin.x + ray.way.x * near;
    if (abs(x) <= half_length) {
        if (begins_beside) return {true, 0, {}};
        return {true, near, normalized(across.origin + across.way * near)};
    }
    local_ray<D> to_end = ray;
    to_end.origin.x -= x < 0 ? -half_length : half_length;
    return cast_on_ball(to_end, r);
}

/// The part of a ray that is left after clipping by halfspaces.
template <int D>
struct clipped_ray {
    double near = 0, far = 1;
    point<D> normal;

    /// Keeps what lies on the inner side of a plane: `height` is how far outside the ray begins, `climb` how fast it
    /// moves outwards. False if nothing is left.
    bool keep(double height, double climb, const point<D>& n) {
        if (climb < 0) {
            if (height > -climb * near) near = height / -climb, normal = n;
        } else if (climb > 0) {
            if (-height < climb * far) far = -height / climb;
        } else if (height > 0) {
            return false;
        }
        return near <= far;
    }
    [[nodiscard]] local_hit<D> hit() const { return {true, near, normal}; }
};

template <int D>
local_hit<D> cast_on_box(const local_ray<D>& ray, const point<D>& half) {
    clipped_ray<D> left;
    for (int i = 0; i < D; ++i)
        for (const double side : {1.0, -1.0}) {
            point<D> n;
            n[i] = side;
            if (!left.keep(side * ray.origin[i] - half[i], side * ray.way[i], n)) return {};
        }
    return left.hit();
}

template <class R, int D>
local_hit<D> cast_on_hull(const local_ray<D>& ray, const hull_data<R, D>& h) {
    clipped_ray<D> left;
    for (std::uint32_t i = 0; i < h.face_count; ++i) {
        const point<D>& n = h.normal(i);
        if (!left.keep(dot(n, ray.origin) - h.offset(i), dot(n, ray.way), n)) return {};
    }
    return left.hit();
}

template <class S, int D>
local_hit<D> cast_on_core(const local_ray<D>& ray, const core<D>& shape) {
    const core<D> tip;
    const core_cast<D> c = cast(shape, placed_core<D>{&tip, mat<double, D>::identity(), ray.origin}, ray.way, 1.0,
                                cast_precision::of<S>(shape, tip));
    if (c.ended == core_cast<D>::outcome::missed) return {};
    return {true, c.fraction, c.ended == core_cast<D>::outcome::hit ? c.normal : point<D>{}};
}

// What ray_cast() calls, by the kind of shape.
template <class S, int D>
local_hit<D> cast_on(const ball<S, D>& b, const local_ray<D>& ray) {
    return cast_on_ball(ray, detail::to_double(b.radius));
}
template <class S, int D>
local_hit<D> cast_on(const capsule<S, D>& c, const local_ray<D>& ray) {
    return cast_on_capsule(ray, detail::to_double(c.half_length), detail::to_double(c.radius));
}
template <class S, int D>
local_hit<D> cast_on(const box<S, D>& b, const local_ray<D>& ray) {
    return cast_on_box(ray, to_point(b.half_extents));
}
template <class S, int D>
local_hit<D> cast_on(const halfspace<S, D>& h, const local_ray<D>& ray) {
    const bounding_half<D> half(h);
    clipped_ray<D> left;
    if (!left.keep(dot(half.normal, ray.origin) - half.offset, dot(half.normal, ray.way), half.normal)) return {};
    return left.hit();
}
template <class S, int D>
local_hit<D> cast_on(const hull<S, D>& h, const local_ray<D>& ray) {
    return h.radius > S(0) ? cast_on_core<S>(ray, core_of(h)) : cast_on_hull(ray, *h.geometry);
}
template <template <class, int> class Shape, class S, int D>
    requires has_core<Shape<S, D>>
local_hit<D> cast_on(const Shape<S, D>& shape, const local_ray<D>& ray) {
    return cast_on_core<S>(ray, core_of(shape));
}

}  // namespace detail

/// Where a ray, from `origin` along `translation` (m), first meets a shape that stands at `at`. Surfaces belong to
/// shapes: a ray that begins on one hits at 0, one in the plane of a face at its edge, one without length hits what it
/// is in. Exact to a few roundings of double, of the sizes and of the distance: only rays that graze the shape by less
/// may be judged either way. Cost: 15 to 75 ns; hulls 3 ns a face; rounded hulls, boxes
/// and other shapes 0.3 to 1.5 us, round cores near a hit up to 8.
template <class Shape, class S, int D>
    requires requires(const Shape& s, const detail::local_ray<D>& r) { cast_on(s, r); }
ray_hit<S, D> ray_cast(const Shape& shape, const transform<S, D>& at, std::type_identity_t<vec<S, D>> origin,
                       std::type_identity_t<vec<S, D>> translation) {
    const mat<double, D> axes = detail::to_matrix(at.rotation);
    const detail::point<D> from = detail::to_point(origin), way = detail::to_point(translation);
    const detail::local_hit<D> h =
        cast_on(shape, detail::local_ray<D>{transposed_times(axes, from - detail::to_point(at.position)),
                                                    transposed_times(axes, way)});
    if (!h.hit) return {};
    return {true, static_cast<S>(h.fraction), detail::from_point<S>(axes * h.normal),
            detail::from_point<S>(from + way * h.fraction)};
}
/// The same for a shape of a set.
template <class S, int D, template <class, int> class... Shapes>
ray_hit<S, D> ray_cast(const any_shape<S, D, Shapes...>& shape, const transform<S, D>& at,
                       std::type_identity_t<vec<S, D>> origin, std::type_identity_t<vec<S, D>> translation) {
    return shape.visit([&](const auto& s) { return ray_cast(s, at, origin, translation); });
}

PHYSICS_HPP_END
